"""What a mesh is worth, and whether it is one: angles, areas, and validators from cheap to dear.

Each validator takes ``points`` (n, 2) and ``triangles`` (m, 3), returns None if all is well, and else
raises MeshError that names the first offender. Each relies on the ones before it:

1. :func:`check_elements`: indices in range, three distinct vertices a triangle
2. :func:`check_edges`: no edge is used twice in the same direction
3. :func:`check_topology`: the boundary passes each vertex at most once; Euler's formula
4. :func:`check_realization`: every triangle counter-clockwise, none overlap
5. :func:`check_delaunay`: no circle holds the vertex across an edge, and the hull is covered
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.kernel import call, kernel
from fem_mesh.mesh.points import as_points
from fem_mesh.predicates import in_circle_sign, orient_sign


def angles(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The angles at the corners, in degrees: float64 (m, 3), in the order of the corners.

    >>> angles(np.array([[0, 0], [1, 0], [0, 1]]), np.array([[0, 1, 2]])).tolist()
    [[90.0, 45.0, 45.0]]
    """
    result = np.empty((len(triangles), 3))
    for i in range(3):
        a, b, c = (points[triangles[:, (i + k) % 3]] for k in range(3))
        u, v = b - a, c - a
        cross = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        result[:, i] = np.degrees(np.arctan2(np.abs(cross), (u * v).sum(axis=1)))
    return result


def areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The areas, float64 (m,); negative where a triangle is clockwise. Rounded: never decide by them.

    >>> areas(np.array([[0, 0], [1, 0], [0, 1]]), np.array([[0, 1, 2]])).tolist()
    [0.5]
    """
    a, b, c = (points[triangles[:, k]] for k in range(3))
    u, v = b - a, c - a
    return np.asarray((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2)


def circumcircle(ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> tuple[float, float, float]:
    """Centre x, y and radius of the circle through a, b, c; infinite for points on one line. Rounded.

    >>> circumcircle(0, 0, 2, 0, 0, 2)
    (1.0, 1.0, 1.4142135623730951)
    """
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    twice = 2 * (ux * vy - uy * vx)
    if twice == 0:
        return math.inf, math.inf, math.inf
    u, v = ux * ux + uy * uy, vx * vx + vy * vy
    x, y = (vy * u - uy * v) / twice, (ux * v - vx * u) / twice
    return ax + x, ay + y, math.hypot(x, y)


# ---- the ladder ------------------------------------------------------------------------------------


def validate(points: Any, triangles: Any, delaunay: bool = True) -> None:
    """Climb the ladder of validators; raises MeshError at the first rung that gives way.

    >>> validate([(0, 0), (1, 0), (0, 1)], [(0, 2, 1)])
    Traceback (most recent call last):
    fem_mesh.errors.MeshError: triangle 0 = (0, 2, 1) runs clockwise: swap two of its vertices
    """
    points, triangles = as_points(points), as_triangles(triangles)
    check_elements(points, triangles)
    check_edges(points, triangles)
    check_topology(points, triangles)
    check_realization(points, triangles)
    if delaunay:
        check_delaunay(points, triangles)


def as_triangles(triangles: Any) -> np.ndarray:
    """``triangles`` as a new int32 array (m, 3). Raises MeshError where they are no triples of integers."""
    given = np.asarray(list(triangles) if not hasattr(triangles, "__len__") else triangles)
    if given.size == 0:
        return np.empty((0, 3), np.int32)
    if given.ndim != 2 or given.shape[1] != 3:
        raise MeshError(f"triangles must have the shape (m, 3), not {given.shape}: one row (a, b, c) a triangle")
    if given.dtype.kind not in "iu":
        raise MeshError(f"triangles must be triples of point numbers (integers), not {given.dtype}")
    if abs(given).max() > np.iinfo(np.int32).max:
        raise MeshError(f"triangles has the point number {given.max()}, which is no int32")
    return given.astype(np.int32)


def check_elements(points: np.ndarray, triangles: np.ndarray) -> None:
    """Every triangle names three distinct points that exist."""
    wrong = ((triangles < 0) | (triangles >= len(points))).any(axis=1)
    for t in np.flatnonzero(wrong)[:1]:
        raise MeshError(f"triangle {t} = {_row(triangles, t)} names a point that is not there: there are {len(points)}")
    a, b, c = triangles.T
    for t in np.flatnonzero((a == b) | (b == c) | (c == a))[:1]:
        raise MeshError(f"triangle {t} = {_row(triangles, t)} names a point twice")


def check_edges(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Every edge belongs to at most two triangles, which run along it in opposite directions.

    Returns the twin of each half-edge, int64 (m, 3): ``3 * triangle + corner``, -1 on the boundary.
    """
    n, flat = len(points), triangles.astype(np.int64)
    start, end = flat.ravel(), np.roll(flat, -1, axis=1).ravel()
    key, reverse = start * n + end, end * n + start
    order = np.argsort(key, kind="stable")
    found = key[order]
    for i in np.flatnonzero(found[1:] == found[:-1])[:1]:
        s, t = order[i] // 3, order[i + 1] // 3
        edge = f"{start[order[i]]}-{end[order[i]]}"
        raise MeshError(
            f"triangles {s} = {_row(triangles, s)} and {t} = {_row(triangles, t)} lie on the same side of edge "
            f"{edge}: one is clockwise, or they overlap"
        )
    at = np.minimum(np.searchsorted(found, reverse), max(len(found) - 1, 0))
    return np.where(found[at] == reverse, order[at], -1).reshape(-1, 3) if len(found) else flat


def check_topology(points: np.ndarray, triangles: np.ndarray) -> None:
    """The boundary passes each vertex at most once, and V - E + F fits its loops (Euler's formula)."""
    if len(triangles) == 0:
        return
    starts, ends = boundary_edges(points, triangles)
    times = np.bincount(starts, minlength=len(points))
    for v in np.flatnonzero(times > 1)[:1]:
        raise MeshError(f"the boundary passes point {v} at {_at(points, v)} {times[v]} times: triangles only touch there")
    loops, pieces = count_loops(starts, ends), _count_pieces(triangles, len(points))
    vertices, edges = len(np.unique(triangles)), (3 * len(triangles) + len(starts)) // 2
    euler = vertices - edges + len(triangles)
    if euler != 2 * pieces - loops:
        raise MeshError(
            f"V - E + F = {vertices} - {edges} + {len(triangles)} = {euler}, but {pieces} connected piece(s) with "
            f"{loops} boundary loop(s) have {2 * pieces - loops}: some triangles are glued together wrongly"
        )


def check_realization(points: np.ndarray, triangles: np.ndarray) -> None:
    """Every triangle is counter-clockwise, exactly; and none overlap: their areas sum to what the boundary encloses."""
    turns = np.empty(len(triangles), np.int8)
    call(fill_turns, points, triangles, turns, size=len(triangles))
    for t in np.flatnonzero(turns <= 0)[:1]:
        found = "runs clockwise: swap two of its vertices" if turns[t] < 0 else "is flat: its vertices lie on one line"
        raise MeshError(f"triangle {t} = {_row(triangles, t)} {found}")
    starts, ends = boundary_edges(points, triangles)
    crossing = find_crossing(points, starts, ends)
    if crossing is not None:
        (a, b), (c, d) = crossing
        raise MeshError(
            f"boundary edges {a}-{b} and {c}-{d} cross or touch, between {_at(points, a)} and {_at(points, b)}: "
            "triangles overlap there"
        )


def check_delaunay(points: np.ndarray, triangles: np.ndarray) -> None:
    """Every circle is empty of points, exactly. Locally, across each edge, is enough (Delaunay 1934), if the
    triangles cover the convex hull and use every point."""
    twins = check_edges(points, triangles)
    offender = np.full(2, -1)
    call(find_bad_edge, points, triangles, twins, offender, size=len(triangles))
    if offender[0] >= 0:
        t, v = offender.tolist()
        raise MeshError(f"the circle of triangle {t} = {_row(triangles, t)} holds point {v} at {_at(points, v)}")
    starts, ends = boundary_edges(points, triangles)
    after = np.full(len(points), -1)
    after[starts] = ends
    for a, b in zip(starts.tolist(), ends.tolist(), strict=True):
        c = int(after[b])
        if orient_sign(*points[a], *points[b], *points[c]) < 0:
            raise MeshError(f"the convex hull is not covered: the boundary turns right at point {b}, {_at(points, b)}")
    lost = np.setdiff1d(np.arange(len(points)), triangles)
    if len(lost) and len(triangles):
        used = {tuple(p) for p in points[np.unique(triangles)].tolist()}
        for v in lost.tolist():
            if tuple(points[v].tolist()) not in used:
                raise MeshError(f"point {v} at {_at(points, v)} is in no triangle")


# ---- what they stand on ------------------------------------------------------------------------------


def boundary_edges(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The starts and ends of the half-edges without a twin; the mesh lies on their left."""
    t, i = np.nonzero(check_edges(points, triangles) < 0)
    return triangles[t, i], triangles[t, (i + 1) % 3]


def find_crossing(points: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> tuple[Any, Any] | None:
    """Two boundary edges that share more than an end, or None: a sweep from left to right over their extents."""
    low = np.minimum(points[starts, 0], points[ends, 0])
    high = np.maximum(points[starts, 0], points[ends, 0])
    order = np.argsort(low, kind="stable")
    pair = np.full(2, -1)
    call(find_crossing_pair, points, starts[order], ends[order], low[order], high[order], pair, size=len(order))
    if pair[0] < 0:
        return None
    i, j = order[pair]
    return (starts[i].item(), ends[i].item()), (starts[j].item(), ends[j].item())


@kernel
def find_crossing_pair(points, starts, ends, low, high, pair):
    for i in range(len(starts)):
        for j in range(i + 1, len(starts)):
            if low[j] > high[i]:
                break
            if do_cross(points, starts[i], ends[i], starts[j], ends[j]):
                pair[0], pair[1] = i, j
                return


@kernel
def do_cross(points, a, b, c, d):
    """Whether segments ab and cd share a point that is not an end of both."""
    if max(points[a, 1], points[b, 1]) < min(points[c, 1], points[d, 1]):
        return False
    if max(points[c, 1], points[d, 1]) < min(points[a, 1], points[b, 1]):
        return False
    abc, abd = turn(points, a, b, c), turn(points, a, b, d)
    cda, cdb = turn(points, c, d, a), turn(points, c, d, b)
    if b == c:  # they meet end to start, and overlap only if the second turns back
        return abd == 0 and is_same_side(points, b, a, d)
    if a == d:
        return abc == 0 and is_same_side(points, a, b, c)
    if abc == 0 and abd == 0:  # on one line
        return max(points[a, 0], points[b, 0]) >= min(points[c, 0], points[d, 0])
    return abc * abd <= 0 and cda * cdb <= 0


@kernel
def is_same_side(points, o, p, q):
    """Whether p and q, on a line through o, lie on the same side of o."""
    x = (points[p, 0] - points[o, 0] > 0) == (points[q, 0] - points[o, 0] > 0)
    y = (points[p, 1] - points[o, 1] > 0) == (points[q, 1] - points[o, 1] > 0)
    return x and y


@kernel
def turn(points, a, b, c):
    s = orient_sign(points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1])
    return 1 if s > 0.0 else -1 if s < 0.0 else 0


@kernel
def fill_turns(points, triangles, turns):
    for t in range(len(turns)):
        turns[t] = turn(points, triangles[t, 0], triangles[t, 1], triangles[t, 2])


@kernel
def find_bad_edge(points, triangles, twins, offender):
    """The first triangle whose circle holds the vertex across one of its edges, and that vertex."""
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        for i in range(3):
            g = twins[t, i]
            if g >= 0:
                v = triangles[g // 3, (g + 2) % 3]
                if (
                    in_circle_sign(
                        points[a, 0], points[a, 1], points[b, 0], points[b, 1],
                        points[c, 0], points[c, 1], points[v, 0], points[v, 1],
                    ) > 0.0
                ):  # fmt: skip
                    offender[0], offender[1] = t, v
                    return


def exact_area(points: np.ndarray, triangles: np.ndarray) -> Fraction:
    """The sum of the areas as a fraction, without any rounding: slow, for checking.

    >>> exact_area(np.array([[0, 0], [1, 0], [0, 1.0]]), np.array([[0, 1, 2]]))
    Fraction(1, 2)
    """
    total = Fraction(0)
    for a, b, c in triangles.tolist():
        (ax, ay), (bx, by), (cx, cy) = ([Fraction(value) for value in points[v].tolist()] for v in (a, b, c))
        total += (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return total / 2


def count_loops(starts: np.ndarray, ends: np.ndarray) -> int:
    after = dict(zip(starts.tolist(), ends.tolist(), strict=True))
    loops = 0
    while after:  # each turn takes one loop out
        loops += 1
        v = next(iter(after))
        while v in after:
            v = after.pop(v)
    return loops


def _count_pieces(triangles: np.ndarray, n: int) -> int:
    """Connected pieces: labels spread along edges, halving the paths, until none changes."""
    label = np.arange(n)
    a, b = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    while True:  # labels only ever fall
        before = label.copy()
        np.minimum.at(label, a, label[b])
        np.minimum.at(label, b, label[a])
        label = label[label]
        if (label == before).all():
            return len(np.unique(label[a]))


def _row(triangles: np.ndarray, t: int) -> tuple[int, ...]:
    return tuple(triangles[t].tolist())


def _at(points: np.ndarray, v: int) -> str:
    return f"({points[v, 0]:.6g}, {points[v, 1]:.6g})"
