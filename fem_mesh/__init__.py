from fem_mesh.algorithms.bowyer_watson import bowyer_watson
from fem_mesh.algorithms.delaunay import delaunay
from fem_mesh.steps import record, Step, Trace
from fem_mesh.mesh.points import *
from fem_mesh.predicates import orient, in_circle, in_diametral_circle
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.algorithms.lawson import lawson
from fem_mesh.algorithms.sweep import any_triangulation
