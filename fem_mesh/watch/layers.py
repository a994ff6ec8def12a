"""What the picture of a step shows, as data: layers of things of one role each, from the ground up, for any renderer."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from fem_mesh.mesh.quality import circumcircle
from fem_mesh.watch.style import FULL_SIZE, MOST_MARKED, MOST_NUMBERS, ROLES, THINNEST, VIEWS

if TYPE_CHECKING:
    from fem_mesh.mesh.mesh import Mesh
    from fem_mesh.trace import Trace

FAR = 3.0  # how far Voronoi edges without an end are drawn, as a part of the points' extent
HOLLOW = ("waiting", "point")  # markers that are rings
CORE = 3.5  # the dot inside the ring of a point, in points
LEGEND = (  # the order of a step's legend
    "visited", "doomed", "new", "gone", "segment", "asked", "circle", "diametral", "encroached", "edge", "voronoi",
    "waiting", "point",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Layer:
    """Things of one role.

    role : a name in ROLES
    what : what they are, and so what a row of ``places`` holds: three corners, two ends, centre and radius, or a place
    places : float64 (n, 3, 2), (n, 2, 2), (n, 3) or (n, 2), in the coordinates of the points
    listed : whether the legend lists the role
    scale : how large markers and thick lines are, as a part of their size
    words : of texts

    >>> Layer("vertex", "markers", np.array([(0, 0), (1, 0)]))
    Layer: 2 markers, vertex
    """

    role: str
    what: Literal["polygons", "lines", "circles", "markers", "texts"]
    places: np.ndarray
    listed: bool = True
    scale: float = 1.0
    words: tuple[str, ...] = ()

    @property
    def width(self) -> float:
        """Of its lines, in points."""
        width = ROLES[self.role].width
        return max(width * self.scale, min(width, THINNEST))

    @property
    def size(self) -> float:
        """Of its markers, in points."""
        return self.scale * ROLES[self.role].size

    def __repr__(self) -> str:
        return f"Layer: {len(self.places)} {self.what}, {self.role}"


def layers_of(trace: Trace, k: int, circles: bool = True, numbers: bool | None = None) -> list[Layer]:
    """What the picture of step ``k`` shows, from the ground up; what it has none of is left out.

    circles : show circumcircles where the step has some
    numbers : write the vertices' numbers (None: if there are not many)

    >>> import fem_mesh as fm
    >>> trace = fm.record(fm.bowyer_watson([(0, 0), (4, 0), (0, 3), (3, 2)]))
    >>> layers_of(trace, 2, numbers=False)
    [Layer: 1 polygons, mesh, Layer: 1 polygons, doomed, Layer: 2 lines, edge, Layer: 1 circles, circle, \
Layer: 3 markers, vertex, Layer: 1 markers, point]
    """
    k = range(len(trace))[k]
    step = trace[k]
    points, triangles = trace.frame(k)
    there = ~np.isnan(points[:, 0])
    everything = trace.all_points()  # a step may speak of points that have gone
    everything[: len(points)] = np.where(np.isnan(points), everything[: len(points)], points)
    new = step.added if k else ()  # the first frame is there from the beginning
    fresh = set(new)
    old = [t for t in map(tuple, triangles.tolist()) if t not in fresh]
    scale = scale_for(len(points))
    shown = [
        Layer("mesh", "polygons", _at(everything, old, 3), listed=False),
        Layer("visited", "polygons", _at(everything, step.visited, 3)),
        Layer("doomed", "polygons", _at(everything, step.doomed, 3)),
        Layer("new", "polygons", _at(everything, new, 3)),
        Layer("segment", "lines", _at(everything, trace.segments(k).tolist(), 2), scale=scale),
        Layer("asked", "lines", _at(everything, step.asked, 2)),
        Layer("encroached", "lines", _at(everything, step.encroached, 2)),
        Layer("edge", "lines", _at(everything, step.edges, 2)),
        Layer("gone", "lines", _at(everything, _vanished(step.removed, triangles.tolist()), 2)),
    ]
    if circles:
        shown.append(Layer("circle", "circles", _circumcircles(_at(everything, step.circles, 3))))
        shown.append(Layer("diametral", "circles", _diametral_circles(_at(everything, step.encroached, 2))))
    if there.sum() <= MOST_MARKED:
        shown.append(Layer("vertex", "markers", points[there], listed=False, scale=scale))
    shown.append(Layer("waiting", "markers", trace.points_to_come(k)))
    shown.append(Layer("point", "markers", np.array([] if step.point is None else [step.point]).reshape(-1, 2)))
    if numbers or (numbers is None and len(everything) <= MOST_NUMBERS):
        shown.append(numbers_of(points if trace.makes_points else everything))
    return [layer for layer in shown if len(layer.places)]


def layers_of_mesh(mesh: Mesh, circles: bool = False, numbers: bool | None = None, voronoi: bool = False) -> list[Layer]:
    """What the picture of a mesh shows, as ``layers_of`` says it; with ``voronoi`` the edges of its Voronoi diagram.

    >>> import fem_mesh as fm
    >>> layers_of_mesh(fm.delaunay([(0, 0), (4, 0), (0, 3), (3, 2)]), numbers=False)
    [Layer: 2 polygons, mesh, Layer: 4 markers, vertex]
    """
    scale = scale_for(len(mesh.points))
    corners = _at(mesh.points, mesh.triangles, 3)
    shown = [
        Layer("mesh", "polygons", corners),
        Layer("segment", "lines", _at(mesh.points, mesh.segments, 2), scale=scale),
        Layer("circle", "circles", _circumcircles(corners if circles else corners[:0])),
    ]
    if voronoi and len(mesh.points) > 1:
        shown.append(Layer("voronoi", "lines", mesh.voronoi().ends(FAR * float(np.ptp(mesh.points, axis=0).max()))))
    if len(mesh.points) <= MOST_MARKED:
        shown.append(Layer("vertex", "markers", mesh.points, scale=scale))
    if numbers or (numbers is None and len(mesh.points) <= MOST_NUMBERS):
        shown.append(numbers_of(mesh.points))
    return [layer for layer in shown if len(layer.places)]


def legend_of(layers: Iterable[Layer]) -> list[str]:
    """The roles that a step's legend lists, in its order."""
    listed = {layer.role for layer in layers if layer.listed}
    return [name for name in LEGEND if name in listed]


def numbers_of(points: np.ndarray) -> Layer:
    """The vertices' numbers, where the vertices are."""
    there = np.flatnonzero(~np.isnan(points[:, 0]))
    return Layer("vertex", "texts", points[there], listed=False, words=tuple(map(str, there.tolist())))


def scale_for(n: int) -> float:
    """How large markers and thick lines are drawn, as a part of their size, among ``n`` vertices."""
    return min(1.0, math.sqrt(FULL_SIZE / max(n, 1)))


def _at(points: np.ndarray, rows: Any, width: int) -> np.ndarray:
    """Where the points of rows of ``width`` point numbers are: float64 (n, width, 2)."""
    return np.asarray(points[np.array(rows, np.int64).reshape(-1, width)])


def _vanished(removed: Sequence[Any], triangles: Iterable[Any]) -> list[tuple[int, ...]]:
    """The edges of removed triangles that no triangle has any more."""
    return sorted(tuple(sorted(edge)) for edge in _sides(removed) - _sides(triangles)) if removed else []


def _sides(triangles: Iterable[Any]) -> set[frozenset[int]]:
    return {frozenset(side) for a, b, c in triangles for side in ((a, b), (b, c), (c, a))}


# ---- circles -----------------------------------------------------------------------------------------


def _circumcircles(corners: np.ndarray) -> np.ndarray:
    """Centre and radius of those that are circles: the corners may lie on a line."""
    circles = np.array([circumcircle(*corner) for corner in corners.reshape(-1, 6).tolist()]).reshape(-1, 3)
    return circles[circles[:, 2] < math.inf]


def _diametral_circles(ends: np.ndarray) -> np.ndarray:
    across = ends[:, 1] - ends[:, 0]
    return np.column_stack([ends.mean(axis=1), np.hypot(*across.T) / 2])


def rings_of(circles: np.ndarray, center: tuple[float, float], reach: float) -> tuple[np.ndarray, list[np.ndarray]]:
    """Circles as they are drawn in a view of this half diagonal: whole, or the arcs near it of those much larger than it.

    Renderers would dash all of a huge circle, for ever. An arc is 65 places, from end to end.
    """
    small = circles[:, 2] <= VIEWS * reach
    return circles[small], [_arc(x, y, radius, center, reach) for x, y, radius in circles[~small].tolist()]


def _arc(x: float, y: float, radius: float, center: tuple[float, float], reach: float) -> np.ndarray:
    away = np.array([center[0] - x, center[1] - y])
    normal = away / max(float(np.hypot(*away)), 1e-300)
    angle = np.linspace(-2, 2, 65) * reach / radius
    foot = np.array([x, y]) + radius * normal
    along, inward = radius * np.sin(angle), -2 * radius * np.sin(angle / 2) ** 2
    return np.asarray(foot + along[:, None] * np.array([-normal[1], normal[0]]) + inward[:, None] * normal)
