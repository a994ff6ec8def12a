"""fem_mesh: Delaunay mesh generation, to watch step by step and to run at full speed.

>>> import fem_mesh as fm
>>> points = fm.random_points(16, seed=1)
>>> mesh = fm.delaunay(points)
>>> mesh
Mesh: 16 points, 21 triangles, smallest angle 1.6 degrees
>>> trace = fm.record(fm.lawson(points, fm.any_triangulation(points)))
>>> trace.counts["flip"]
18
"""

from typing import TYPE_CHECKING, Any

from fem_mesh import textbook
from fem_mesh.algorithms.bowyer_watson import bowyer_watson
from fem_mesh.algorithms.constrained_delaunay import constrained_delaunay, insert_segments
from fem_mesh.algorithms.delaunay import delaunay
from fem_mesh.algorithms.lawson import lawson
from fem_mesh.algorithms.refine import refine
from fem_mesh.algorithms.sweep import any_triangulation
from fem_mesh.domain.domain import Domain
from fem_mesh.errors import MeshError
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.points import grid_points, random_points, ring_points
from fem_mesh.mesh.validators import validate
from fem_mesh.predicates import in_circle, in_diametral_circle, orient
from fem_mesh.steps import Step
from fem_mesh.trace import Trace, record

if TYPE_CHECKING:
    from fem_mesh.watch.picture import Picture

__version__ = "0.1.0"

__all__ = [
    "Domain",
    "Mesh",
    "MeshError",
    "Picture",
    "Step",
    "Trace",
    "any_triangulation",
    "bowyer_watson",
    "constrained_delaunay",
    "delaunay",
    "grid_points",
    "in_circle",
    "in_diametral_circle",
    "insert_segments",
    "lawson",
    "orient",
    "random_points",
    "record",
    "refine",
    "ring_points",
    "textbook",
    "validate",
]


def __getattr__(name: str) -> Any:
    if name == "Picture":  # Matplotlib is imported when it is first needed
        from fem_mesh.watch.picture import Picture

        return Picture
    raise AttributeError(f"module 'fem_mesh' has no attribute {name!r}")
