"""Whether a mesh is one: validators, from cheap to dear.

Each takes ``points`` (n, 2) and ``triangles`` (m, 3), returns if all is well, and else raises MeshError
that names the first offender. Each relies on the ones before it:

1. :func:`check_elements`: indices in range, three distinct vertices a triangle
2. :func:`check_edges`: no edge is used twice in the same direction
3. :func:`check_topology`: the boundary passes each vertex at most once; Euler's formula
4. :func:`check_realization`: every triangle counter-clockwise, none overlap
5. :func:`check_delaunay`: no circle holds the vertex across an edge, and the hull is covered
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.kernel import call, kernel
from fem_mesh.mesh.points import as_points
from fem_mesh.mesh.quality import as_triangles, turn, turns_of
from fem_mesh.predicates import in_circle_sign, orient_sign


def validate(points: Any, triangles: Any, delaunay: bool = True, touching: bool = False) -> None:
    """Climb the ladder of validators; raises MeshError at the first rung that gives way.

    ``touching``: the boundary may pass a vertex several times, as that of a domain may.

    >>> validate([(0, 0), (1, 0), (0, 1)], [(0, 2, 1)])
    Traceback (most recent call last):
    fem_mesh.errors.MeshError: triangle 0 = (0, 2, 1) runs clockwise: swap two of its vertices
    """
    points, triangles = as_points(points), as_triangles(triangles)
    check_elements(points, triangles)
    check_edges(points, triangles)
    check_topology(points, triangles, touching)
    check_realization(points, triangles)
    if delaunay:
        check_delaunay(points, triangles)


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
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    forward = start < end
    key = np.where(forward, start, end).astype(np.int64) * len(points) + np.where(forward, end, start)
    order = np.lexsort((forward, key))  # the half-edges of one edge side by side, those of one direction too
    first, second = order[:-1], order[1:]
    same = key[first] == key[second]
    for i in np.flatnonzero(same & (forward[first] == forward[second]))[:1]:
        s, t = first[i] // 3, second[i] // 3
        raise MeshError(
            f"triangles {s} = {_row(triangles, s)} and {t} = {_row(triangles, t)} lie on the same side of edge "
            f"{start[first[i]]}-{end[first[i]]}: one is clockwise, or they overlap"
        )
    twins = np.full(len(start), -1)
    twins[first[same]], twins[second[same]] = second[same], first[same]
    return twins.reshape(-1, 3)


def check_segments(points: np.ndarray, triangles: np.ndarray, segments: np.ndarray) -> None:
    """Every segment is an edge of a triangle."""
    low, high = np.minimum(triangles, np.roll(triangles, -1, axis=1)), np.maximum(triangles, np.roll(triangles, -1, axis=1))
    edges = low.ravel().astype(np.int64) * len(points) + high.ravel()
    asked = segments.min(axis=1, initial=len(points)).astype(np.int64) * len(points) + segments.max(axis=1, initial=-1)
    for i in np.flatnonzero(~np.isin(asked, edges))[:1]:
        a, b = segments[i].tolist()
        raise MeshError(f"segment {i} = ({a}, {b}) is no edge of a triangle: constrained_delaunay puts segments in")


def check_topology(points: np.ndarray, triangles: np.ndarray, touching: bool = False) -> None:
    """The boundary passes each vertex at most once, unless it may be ``touching``; V - E + F fits its loops (Euler)."""
    if len(triangles) == 0:
        return
    starts, ends = boundary_edges(points, triangles)
    times = np.bincount(starts, minlength=len(points))
    if touching and times.max() > 1:
        return  # Euler's formula is for boundaries that pass each vertex once
    for v in np.flatnonzero(times > 1)[:1]:
        raise MeshError(f"the boundary passes point {v} at {_at(points, v)} {times[v]} times: triangles only touch there")
    loops, pieces = len(trace_loops(starts, ends)), _count_pieces(triangles, len(points))
    vertices, edges = len(np.unique(triangles)), (3 * len(triangles) + len(starts)) // 2
    euler = vertices - edges + len(triangles)
    if euler != 2 * pieces - loops:
        raise MeshError(
            f"V - E + F = {vertices} - {edges} + {len(triangles)} = {euler}, but {pieces} connected piece(s) with "
            f"{loops} boundary loop(s) have {2 * pieces - loops}: some triangles are glued together wrongly"
        )


def check_realization(points: np.ndarray, triangles: np.ndarray) -> None:
    """Every triangle is counter-clockwise, exactly; and none overlap: their areas sum to what the boundary encloses."""
    turns = turns_of(points, triangles)
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
    if np.bincount(starts, minlength=1).max() == 1:  # loops that touch in a vertex are not told apart
        check_nesting(points, starts, ends)


def check_nesting(points: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> None:
    """No piece of the mesh lies upon another: around each outer boundary the others wind 0 times, around each hole once."""
    loops = trace_loops(starts, ends)
    which = np.empty(len(points), np.int64)
    for i, loop in enumerate(loops):
        which[loop] = i
    winding, is_hole = np.zeros(len(loops), np.int64), np.zeros(len(loops), bool)
    for i, loop in enumerate(loops if len(loops) > 1 else []):
        others = which[starts] != i
        winding[i] = call(winding_number, points, starts[others], ends[others], loop[0], size=len(starts))
        low = min(loop, key=lambda v: (points[v, 0], points[v, 1]))
        at = loop.index(low)
        is_hole[i] = orient_sign(*points[loop[at - 1]], *points[low], *points[loop[(at + 1) % len(loop)]]) < 0
    for i in np.flatnonzero(winding != is_hole)[:1]:
        v = loops[i][0]
        raise MeshError(f"the boundary through point {v} at {_at(points, v)} lies inside another: triangles overlap there")


def check_delaunay(points: np.ndarray, triangles: np.ndarray) -> None:
    """Every circle is empty of points, exactly. Locally, across each edge, is enough (Delaunay 1934), if the
    triangles cover the convex hull and use every point."""
    twins = check_edges(points, triangles)
    offender = np.full(2, -1)
    call(find_bad_edge, points, triangles, twins, offender, size=len(triangles))
    if offender[0] >= 0:
        t, v = offender.tolist()
        raise MeshError(f"the circle of triangle {t} = {_row(triangles, t)} holds point {v} at {_at(points, v)}")
    check_hull(points, triangles)
    if len(triangles) == 0 and not on_a_line(points):
        raise MeshError("the convex hull is not covered: there is no triangle, but the points do not lie on a line")
    lost = np.setdiff1d(np.arange(len(points)), triangles)
    if len(lost) and len(triangles):
        used = {tuple(p) for p in points[np.unique(triangles)].tolist()}
        for v in lost.tolist():
            if tuple(points[v].tolist()) not in used:
                raise MeshError(f"point {v} at {_at(points, v)} is in no triangle")


def check_hull(points: np.ndarray, triangles: np.ndarray) -> None:
    """The triangles cover the convex hull: one boundary, which never turns right."""
    starts, ends = boundary_edges(points, triangles)
    if len(trace_loops(starts, ends)) > 1:
        raise MeshError("the convex hull is not covered: the mesh has a hole, or more than one piece")
    after = np.full(len(points), -1)
    after[starts] = ends
    for a, b in zip(starts.tolist(), ends.tolist(), strict=True):
        c = int(after[b])
        if orient_sign(*points[a], *points[b], *points[c]) < 0:
            raise MeshError(f"the convex hull is not covered: the boundary turns right at point {b}, {_at(points, b)}")


# ---- what they stand on ------------------------------------------------------------------------------


def boundary_edges(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The starts and ends of the half-edges without a twin; the mesh lies on their left."""
    t, i = np.nonzero(check_edges(points, triangles) < 0)
    return triangles[t, i], triangles[t, (i + 1) % 3]


def find_crossing(points: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> tuple[Any, Any] | None:
    """Two boundary edges that share more than an end, or None: a sweep over their extents."""
    if not len(starts):
        return None
    low, high = np.minimum(points[starts], points[ends]), np.maximum(points[starts], points[ends])
    lengths, extent = (high - low).sum(axis=0), np.ptp(points, axis=0)
    axis = int(lengths[1] * extent[0] < lengths[0] * extent[1])  # the one along which fewer edges overlap
    low, high = low[:, axis], high[:, axis]
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
    if max(points[a, 0], points[b, 0]) < min(points[c, 0], points[d, 0]):
        return False
    if max(points[c, 0], points[d, 0]) < min(points[a, 0], points[b, 0]):
        return False
    if max(points[a, 1], points[b, 1]) < min(points[c, 1], points[d, 1]):
        return False
    if max(points[c, 1], points[d, 1]) < min(points[a, 1], points[b, 1]):
        return False
    abc, abd = turn(points, a, b, c), turn(points, a, b, d)
    cda, cdb = turn(points, c, d, a), turn(points, c, d, b)
    if b == c:  # they share an end, and more only if they leave it on the same side of one line
        return abd == 0 and is_same_side(points, b, a, d)
    if a == d:
        return abc == 0 and is_same_side(points, a, b, c)
    if a == c:
        return abd == 0 and is_same_side(points, a, b, d)
    if b == d:
        return abc == 0 and is_same_side(points, b, a, c)
    if abc == 0 and abd == 0:  # on one line
        return True
    return abc * abd <= 0 and cda * cdb <= 0


@kernel
def winding_number(points, starts, ends, v):
    """How often the edges wind around point v, which lies on none of them: crossings of the ray to its right."""
    turns = 0
    for i in range(len(starts)):
        a, b = starts[i], ends[i]
        if (points[a, 1] <= points[v, 1]) != (points[b, 1] <= points[v, 1]):
            side = turn(points, a, b, v)
            upward = points[a, 1] <= points[v, 1]
            if upward and side > 0:
                turns += 1
            elif not upward and side < 0:
                turns -= 1
    return turns


@kernel
def is_same_side(points, o, p, q):
    """Whether p and q, on a line through o, lie on the same side of o."""
    x = (points[p, 0] - points[o, 0] > 0) == (points[q, 0] - points[o, 0] > 0)
    y = (points[p, 1] - points[o, 1] > 0) == (points[q, 1] - points[o, 1] > 0)
    return x and y


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


def trace_loops(starts: np.ndarray, ends: np.ndarray) -> list[list[int]]:
    """The closed loops that boundary edges form, each a list of vertices."""
    after = dict(zip(starts.tolist(), ends.tolist(), strict=True))
    loops = []
    while after:  # each turn takes one loop out
        v = next(iter(after))
        loops.append([v])
        while (v := after.pop(v)) in after:
            loops[-1].append(v)
    return loops


def on_a_line(points: np.ndarray) -> bool:
    """Whether no three points span a triangle: exact."""
    first, *rest = points.tolist() or [[0.0, 0.0]]
    others = [p for p in rest if p != first]
    return all(orient_sign(*first, *others[0], *p) == 0 for p in others)


def _count_pieces(triangles: np.ndarray, n: int) -> int:
    return len(np.unique(connect(n, triangles.ravel(), np.roll(triangles, -1, axis=1).ravel())[triangles]))


def connect(n: int, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """For each of n things the lowest one that it is connected with, if each of ``a`` is with that of ``b``: int64 (n,)."""
    label = np.arange(n)
    while True:  # labels only ever fall: they spread along the pairs, halving the paths
        before = label.copy()
        np.minimum.at(label, a, label[b])
        np.minimum.at(label, b, label[a])
        label = label[label]
        if (label == before).all():
            return label


def _row(triangles: np.ndarray, t: int) -> tuple[int, ...]:
    return tuple(triangles[t].tolist())


def _at(points: np.ndarray, v: int) -> str:
    return f"({points[v, 0]:.6g}, {points[v, 1]:.6g})"
