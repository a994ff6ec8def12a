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

from importlib import import_module
from typing import TYPE_CHECKING, Any

from fem_mesh import textbook
from fem_mesh.algorithms.adapt import adapt, mark
from fem_mesh.algorithms.bowyer_watson import bowyer_watson
from fem_mesh.algorithms.constrained_delaunay import constrained_delaunay, insert_segments
from fem_mesh.algorithms.delaunay import delaunay
from fem_mesh.algorithms.lawson import lawson
from fem_mesh.algorithms.refine import refine
from fem_mesh.algorithms.refining.watched import ruppert
from fem_mesh.algorithms.smooth import smooth
from fem_mesh.algorithms.sweep import any_triangulation
from fem_mesh.domain.curves import Circle, Parametric
from fem_mesh.domain.domain import Domain
from fem_mesh.domain.reading import Region
from fem_mesh.domain.shapes import (
    airfoil,
    annulus,
    cracked_square,
    disk,
    gear,
    l_shape,
    letter,
    plate_with_hole,
    square,
    star,
    turbine_blade,
)
from fem_mesh.errors import MeshError
from fem_mesh.files.endings import read, write
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.points import grid_points, random_points, ring_points
from fem_mesh.mesh.refinement import Refinement
from fem_mesh.mesh.validators import validate
from fem_mesh.mesh.voronoi import Voronoi
from fem_mesh.predicates import in_circle, in_diametral_circle, orient
from fem_mesh.recording import record
from fem_mesh.steps import Step
from fem_mesh.trace import Trace

if TYPE_CHECKING:
    from fem_mesh import check
    from fem_mesh.watch.domain_playground.widget import DomainPlayground
    from fem_mesh.watch.picture import Picture
    from fem_mesh.watch.player import Player, play
    from fem_mesh.watch.playground import Playground

__version__ = "0.1.0"

__all__ = [
    "Circle",
    "Domain",
    "DomainPlayground",
    "Mesh",
    "MeshError",
    "Parametric",
    "Picture",
    "Player",
    "Playground",
    "Refinement",
    "Region",
    "Step",
    "Trace",
    "Voronoi",
    "adapt",
    "airfoil",
    "annulus",
    "any_triangulation",
    "bowyer_watson",
    "check",
    "constrained_delaunay",
    "cracked_square",
    "delaunay",
    "disk",
    "gear",
    "grid_points",
    "in_circle",
    "in_diametral_circle",
    "insert_segments",
    "l_shape",
    "lawson",
    "letter",
    "mark",
    "orient",
    "plate_with_hole",
    "play",
    "random_points",
    "read",
    "record",
    "refine",
    "ring_points",
    "ruppert",
    "smooth",
    "square",
    "star",
    "textbook",
    "turbine_blade",
    "validate",
    "write",
]


_SHOWN = {  # what draws and plays is imported when it is first needed: Matplotlib, the widgets
    "DomainPlayground": "domain_playground.widget",
    "Picture": "picture",
    "Player": "player",
    "Playground": "playground",
    "play": "player",
}


def __getattr__(name: str) -> Any:
    if name == "check":
        return import_module("fem_mesh.check")
    if name in _SHOWN:
        return getattr(import_module(f"fem_mesh.watch.{_SHOWN[name]}"), name)
    raise AttributeError(f"module 'fem_mesh' has no attribute {name!r}")
