"""Flipping edges until every circle is empty: Lawson 1977.

    put every edge on a stack
    while the stack is not empty:
        take an edge off; if the circle of one of its triangles holds the vertex of the other:
            flip it to the other diagonal
            put the four edges around it on the stack again

Lift every point (x, y) to the height x^2 + y^2: each flip lowers the surface that the triangles form
there, and no edge that was flipped away ever comes back. So it ends, after at most n (n - 1) / 2 flips,
from any triangulation; but only if every sign is exact. With rounded signs it can run for ever.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.kernel import SETTLED, call, index, kernel, watch
from fem_mesh.mesh import quality, validators
from fem_mesh.mesh.halfedge import flip, in_conflict, is_ghost, next_edge, prev_edge
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.points import as_points
from fem_mesh.mesh.quality import circumcircle
from fem_mesh.mesh.workspace import COUNT, FLIPPED, STACKED, TESTED, Workspace
from fem_mesh.predicates import in_circle_sign
from fem_mesh.steps import Step, Triangle, many

ILLEGAL = 1
LEGAL, FLIP = SETTLED + 1, SETTLED + 2


@kernel
def flip_edges(xy, origin, twin, stack, waiting, state):
    while state[STACKED] > 0:  # each turn settles an edge or flips one, and flips are finitely many
        state[STACKED] -= 1
        h = stack[state[STACKED]]
        waiting[h] = False
        if not is_illegal(h, xy, origin, twin, state):
            yield LEGAL, h
            continue
        yield ILLEGAL, h

        g = twin[h]
        flip(h, origin, twin)
        state[FLIPPED] += 1
        for side in (h, next_edge(h), g, next_edge(g)):
            push_edge(side, twin, stack, waiting, state)
        yield FLIP, prev_edge(h)


@kernel
def is_illegal(h, xy, origin, twin, state):
    """Whether the circle of h's triangle holds the vertex across h. The ghost vertex lies in no circle."""
    apex = origin[prev_edge(twin[h])]
    if is_ghost(apex):
        return False
    state[TESTED] += 1
    return in_conflict(h, xy[apex, 0], xy[apex, 1], xy, origin)


@kernel
def push_edge(h, twin, stack, waiting, state):
    """Put the edge of ``h`` on the stack, unless it waits there already."""
    if not (waiting[h] or waiting[twin[h]]):
        waiting[h] = True
        stack[state[STACKED]] = h
        state[STACKED] += 1


@kernel
def push_all_edges(origin, twin, stack, waiting, state):
    """Put every edge on the stack, so that the lowest comes off first."""
    for i in range(3 * state[COUNT] - 1, -1, -1):
        push_edge(index(i), twin, stack, waiting, state)


def flip_state(work: Workspace) -> tuple[np.ndarray, ...]:
    """The arrays that ``flip_edges`` takes, with every edge of ``work`` on the stack."""
    room = len(work.origin)
    stack, waiting = np.empty(room, np.uint32), np.zeros(room, bool)
    work.state[STACKED] = 0
    call(push_all_edges, work.origin, work.twin, stack, waiting, work.state, size=len(work.points))
    return work.xy, work.origin, work.twin, stack, waiting, work.state


def begin_from(points: Any, triangles: Any) -> Workspace:
    """The half-edges of any valid triangulation of ``points``, checked; clockwise triangles are turned round.

    Raises MeshError where triangles overlap, are flat, or leave a hole, a notch or a point out.
    """
    points, triangles = as_points(points), quality.as_triangles(triangles)
    if not len(triangles):
        raise MeshError("there is no triangle to start from: any_triangulation(points) makes some")
    validators.check_elements(points, triangles)
    triangles = quality.counter_clockwise(points, triangles)
    twins = validators.check_edges(points, triangles)
    validators.check_topology(points, triangles)
    validators.check_realization(points, triangles)
    validators.check_hull(points, triangles)
    work = Workspace.of_triangles(points, triangles, twins)
    work.merge_unused(triangles)
    return work


# ---- watched ---------------------------------------------------------------------------------------


def lawson(points: Any, triangles: Any) -> Generator[Step, None, Mesh]:
    """Delaunay triangulation by flips, from any triangulation: yields every test and flip; returns the Mesh.

    points : (n, 2) numbers
    triangles : (m, 3) point numbers, any valid triangulation that uses all points and covers their
        convex hull; clockwise triangles are turned round

    Raises MeshError where the triangles are no triangulation, naming the first offender. Source: Lawson 1977.

    >>> for step in lawson([(0, 0), (4, 0), (5, 3), (1, 2)], [(0, 1, 2), (0, 2, 3)]):
    ...     print(step.kind, "-", step.caption)
    start - 2 triangles on 4 points: 5 edges to test
    test - edge 0-2 must go: vertex 1 lies inside the circle of 0, 2, 3 (0.678 from its centre, radius 3.84)
    flip - edge 0-2 is flipped to 1-3: vertex 1 lay inside the circle of 0, 2, 3
    done - 1 flip after 1 test: every circle is empty
    """
    return _watch(begin_from(points, triangles))


def _watch(work: Workspace) -> Generator[Step, None, Mesh]:
    start = tuple(t for t in map(work.corners, range(work.state.item(COUNT))) if t)
    used = sorted({v for t in start for v in t})
    edges = len({frozenset(e) for a, b, c in start for e in ((a, b), (b, c), (c, a))})
    yield Step("start", say_start, added=start, new_points=[(v, *work.points[v].tolist()) for v in used], edge_count=edges)
    before: tuple[Triangle, ...] = ()
    edge, left, right = (-1, -1), -1, -1
    flips = tests = 0
    for event, h in watch(flip_edges, flip_state(work)):
        if event == FLIP:
            flips += 1
            after = _sides(work, h)
            new = work.edge(h)
            yield Step(
                "flip",
                say_flip,
                added=after,
                removed=before,
                edges=(new,),
                old=edge,
                new=new,
                left=left,
                right=right,
            )
            continue
        edge, left, right = work.edge(h), work.apex(h), work.apex(work.twin.item(h))
        before = _sides(work, h)
        if -1 in (*edge, left, right) and event == LEGAL:
            continue  # a hull edge: nothing to test
        tests += 1
        verdict, distance, radius = _measure(work, edge, left, right)
        yield Step(
            "test", say_test, edges=(edge,), circles=before[:1], doomed=before if event == ILLEGAL else (),
            point=tuple(work.points[right].tolist()), edge=edge, left=left, right=right,
            verdict=verdict, distance=distance, radius=radius,
        )  # fmt: skip
    mesh = work.to_mesh()
    yield Step("done", say_done, flips=flips, tests=tests)
    return mesh


def _sides(work: Workspace, h: int) -> tuple[Triangle, ...]:
    """The triangles on the two sides of half-edge ``h``, without ghosts."""
    sides = (work.corners(h // 3), work.corners(work.twin.item(h) // 3))
    return tuple(t for t in sides if t)


def _measure(work: Workspace, edge: tuple[int, int], left: int, right: int) -> tuple[int, float, float]:
    """The exact verdict on ``right`` (1 inside, 0 on, -1 outside the circle), its distance from the centre, the radius."""
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = work.points[[*edge, left, right]].tolist()
    sign = in_circle_sign(ax, ay, bx, by, cx, cy, dx, dy)
    x, y, radius = circumcircle(ax, ay, bx, by, cx, cy)
    return (sign > 0) - (sign < 0), math.hypot(dx - x, dy - y), radius


# ---- captions --------------------------------------------------------------------------------------


def say_start(step: Step) -> str:
    n, m = len(step.new_points), len(step.added)
    return f"{many(m, 'triangle')} on {many(n, 'point')}: {many(step.facts['edge_count'], 'edge')} to test"


VERDICTS = {1: "must go: vertex {} lies inside", 0: "stays: vertex {} lies exactly on", -1: "stays: vertex {} lies outside"}


def say_test(step: Step) -> str:
    facts = step.facts
    (a, b), c = sorted(facts["edge"]), facts["left"]
    verdict = VERDICTS[facts["verdict"]].format(facts["right"])
    numbers = f"{facts['distance']:.3g} from its centre, radius {facts['radius']:.3g}"
    return f"edge {a}-{b} {verdict} the circle of {a}, {b}, {c} ({numbers})"


def say_flip(step: Step) -> str:
    (a, b), (c, d) = sorted(step.facts["old"]), sorted(step.facts["new"])
    left, right = step.facts["left"], step.facts["right"]
    return f"edge {a}-{b} is flipped to {c}-{d}: vertex {right} lay inside the circle of {a}, {b}, {left}"


def say_done(step: Step) -> str:
    return f"{many(step.facts['flips'], 'flip')} after {many(step.facts['tests'], 'test')}: every circle is empty"
