"""Incremental insertion: Bowyer 1981, Watson 1981.

    start with one triangle
    for each further point p:
        locate a triangle whose circle holds p, by walking there
        dig the cavity: all triangles whose circles hold p, grown from that one across their edges
        fan: join p to every edge around the cavity

Before and after each point every circle is empty. The cavity is star-shaped as seen from p because the
signs are exact; the ghost vertex makes points outside the hull no different from points inside.
Ends because each turn takes one point. Points in an order that keeps walks and cavities short: O(n)
expected, and the sort.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator
from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.kernel import SETTLED, index, kernel, watch
from fem_mesh.mesh.halfedge import dig_cavity, fan_cavity, is_ghost, locate, vertex_at
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.order import insertion_order
from fem_mesh.mesh.points import as_points
from fem_mesh.mesh.workspace import COUNT, LAST, NEXT, TESTED, WALKED, Workspace
from fem_mesh.steps import Step, Triangle, many

LOCATED, CAVITY = 1, 2
MERGED, INSERTED = SETTLED + 1, SETTLED + 2


@kernel
def insert_points(xy, origin, twin, merged, cavity, ring, state):
    while state[NEXT] < len(xy):  # each turn takes one point
        p = index(state[NEXT])
        px, py = xy[p, 0], xy[p, 1]
        h, steps = locate(index(state[LAST]), px, py, xy, origin, twin)
        state[WALKED] += steps
        yield LOCATED, h

        state[NEXT] += 1
        v = vertex_at(h, px, py, xy, origin)
        if not is_ghost(v):
            merged[p] = v
            yield MERGED, p
            continue

        dug = dig_cavity(h, px, py, xy, origin, twin, cavity, ring)
        state[TESTED] += 2 * dug + 1  # every edge of the cavity but the first was tested once
        yield CAVITY, index(dug)

        fan_cavity(p, state[COUNT], dug, origin, twin, cavity, ring)
        state[COUNT] += 2
        state[LAST] = 3 * cavity[0]
        yield INSERTED, p


def insertion_state(work: Workspace) -> tuple[np.ndarray, ...]:
    """The arrays of ``work`` that ``insert_points`` takes."""
    return work.xy, work.origin, work.twin, work.merged, work.cavity, work.ring, work.state


# ---- watched ---------------------------------------------------------------------------------------


def bowyer_watson(points: Any, order: str | Iterable[int] = "given") -> Generator[Step, None, Mesh]:
    """Delaunay triangulation, point by point: yields every locate, cavity and insertion; returns the Mesh.

    points : (n, 2) numbers
    order : "given" inserts point 0 first, as they come; "brio" is the order that ``delaunay`` uses;
        or a permutation of the point numbers

    Raises MeshError for points that are no finite pairs of numbers. Source: Bowyer 1981, Watson 1981.

    >>> for step in bowyer_watson([(0, 0), (4, 0), (0, 3), (1, 1)]):
    ...     print(step.kind, "-", step.caption)
    start - points 0, 1, 2 make the first triangle
    locate - point 3 lies in triangle 0, 1, 2, reached by crossing 0 triangles
    cavity - 1 circle holds point 3: 1 triangle will go
    insert - point 3 is joined to the 3 edges around the cavity: 3 triangles come, 1 goes
    done - 3 triangles on 4 points: every circle is empty
    """
    points = as_points(points)
    return _watch(Workspace.of_points(points, _order(points, order)))


def _order(points: np.ndarray, order: str | Iterable[int]) -> np.ndarray:
    if isinstance(order, str):
        if order == "given":
            return np.arange(len(points))
        if order == "brio":
            return insertion_order(points)
        raise MeshError(f'order must be "given", "brio" or a permutation, not {order!r}')
    permutation = np.array(list(order)) if isinstance(order, Iterable) else np.empty(0)
    if not np.array_equal(np.sort(permutation), np.arange(len(points))):
        raise MeshError(f"order must name each of the {len(points)} points exactly once")
    return permutation.astype(np.int64)


def _watch(work: Workspace) -> Generator[Step, None, Mesh]:
    if work.note:
        yield Step("done", work.note, new_points=[(v, *point) for v, point in enumerate(work.points.tolist())])
        return work.to_mesh()
    first = work.corners(0)
    assert first is not None
    yield Step("start", say_start, added=(first,), new_points=[(v, *work.points[v].tolist()) for v in sorted(first)])
    yield from tell_insertions(work, watch(insert_points, insertion_state(work)))
    mesh = work.to_mesh()
    yield Step("done", say_done, n=len(mesh.points) - len(mesh.unused), m=len(mesh.triangles))
    return mesh


def tell_insertions(work: Workspace, events: Iterator[tuple[int, int]]) -> Iterator[Step]:
    """The events of ``insert_points`` on ``work`` as steps: a locate, then a cavity and an insert, or a merge."""
    walked = work.state.item(WALKED)
    for event, where in events:
        if event == LOCATED:
            p = work.name.item(work.state.item(NEXT))
            point = tuple(work.points[p].tolist())
            corners = work.corners(where // 3)
            crossed, walked = work.state.item(WALKED) - walked, work.state.item(WALKED)
            visited = (corners,) if corners else ()
            beyond = () if corners else (_hull_edge(work, where // 3),)
            yield Step("locate", say_locate, point=point, visited=visited, edges=beyond, p=p, crossed=crossed)
        elif event == MERGED:
            v = work.name.item(work.merged.item(where))
            yield Step("merge", say_merge, point=point, p=p, v=v)
        elif event == CAVITY:
            around = where + 2
            doomed = _corners(work, where)
            edges = _ring_edges(work, around)
            outside = where - len(doomed)
            yield Step("cavity", say_cavity, point=point, doomed=doomed, circles=doomed, edges=edges, p=p, outside=outside)
        else:  # INSERTED
            yield Step(
                "insert", say_insert, point=point, added=_corners(work, around), removed=doomed, new_points=((p, *point),),
                p=p, around=len(edges),
            )  # fmt: skip


def _hull_edge(work: Workspace, t: int) -> tuple[int, int]:
    a, b = (work.name.item(v) for v in work.origin[3 * t : 3 * t + 3].tolist() if not is_ghost(v))
    return a, b


def _ring_edges(work: Workspace, around: int) -> tuple[tuple[int, int], ...]:
    edges = (work.edge(g)[::-1] for g in work.ring[:around].tolist())
    return tuple(edge for edge in edges if min(edge) >= 0)


def _corners(work: Workspace, k: int) -> tuple[Triangle, ...]:
    """The first ``k`` triangles that `cavity` lists, without the ghosts."""
    corners = (work.corners(t) for t in work.cavity[:k].tolist())
    return tuple(triangle for triangle in corners if triangle)


# ---- captions --------------------------------------------------------------------------------------


def say_start(step: Step) -> str:
    a, b, c = sorted(step.added[0])
    return f"points {a}, {b}, {c} make the first triangle"


def say_locate(step: Step) -> str:
    p, crossed = step.facts["p"], many(step.facts["crossed"], "triangle")
    if step.visited:
        a, b, c = step.visited[0]
        return f"point {p} lies in triangle {a}, {b}, {c}, reached by crossing {crossed}"
    a, b = sorted(step.edges[0])
    return f"point {p} lies outside the hull, beyond edge {a}-{b}, reached by crossing {crossed}"


def say_merge(step: Step) -> str:
    return f"point {step.facts['p']} equals point {step.facts['v']}: it is merged into it"


def say_cavity(step: Step) -> str:
    p, doomed = step.facts["p"], len(step.doomed)
    goes = f"{many(doomed, 'circle')} hold{'s' * (doomed == 1)} point {p}: {many(doomed, 'triangle')} will go"
    seen = f"it sees {many(step.facts['outside'], 'hull edge')}"
    if not step.facts["outside"]:
        return goes
    return f"{goes}, and {seen}" if doomed else f"no circle holds point {p}; {seen}"


def say_insert(step: Step) -> str:
    comes, goes = len(step.added), len(step.removed)
    change = f"{many(comes, 'triangle')} come{'s' * (comes == 1)}, {goes} go{'es' * (goes == 1)}"
    return f"point {step.facts['p']} is joined to the {many(step.facts['around'], 'edge')} around the cavity: {change}"


def say_done(step: Step) -> str:
    return f"{many(step.facts['m'], 'triangle')} on {many(step.facts['n'], 'point')}: every circle is empty"
