"""From a domain to its constrained Delaunay triangulation: points first, then segments, then what lies outside goes.

The three stages are the kernels of ``bowyer_watson``, ``segments`` and ``carving``; here they follow each
other, watched (``insert_segments``) or at full speed (``constrained_delaunay``).
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from fem_mesh.algorithms.bowyer_watson import insert_points, insertion_state
from fem_mesh.algorithms.carving import (
    BY_PARITY,
    BY_SEEDS,
    CONFLICT,
    OUTSIDE,
    UNKNOWN,
    flood,
    flood_from_ghosts,
)
from fem_mesh.algorithms.seeds import begin_at_seed, color_regions, ghosts, locate_seeds, say_rows
from fem_mesh.algorithms.segments import BLOCKED, CROSSED, LAID, insert_pieces, note_leaving
from fem_mesh.domain.domain import Domain
from fem_mesh.errors import MeshError
from fem_mesh.kernel import call, run, watch
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.order import insertion_order
from fem_mesh.mesh.segmented import Segmented
from fem_mesh.mesh.workspace import FLOODED, FROM, NEXT, PIECE, REACHED, SEGMENTS, Workspace
from fem_mesh.predicates import in_circle_sign
from fem_mesh.steps import Step, Triangle, many

Events = Iterator[tuple[int, int]]
Driver = Callable[..., Events]


def constrained_delaunay(domain: Domain) -> Mesh:
    """The constrained Delaunay triangulation of ``domain``: every segment is a chain of edges, nothing lies outside.

    No triangle's circle holds a vertex that can be seen from inside the triangle, exactly. A vertex on a
    segment splits it (``mesh.segment_of`` says which segment each piece lies on). What lies in a hole goes;
    without seeds loops nest by parity; without any closed loop the domain is the convex hull. Runs
    ``insert_segments``, compiled where the input is large.

    Raises MeshError where two segments cross, a seed lies outside or on a segment, or the parity of a place
    depends on the way there. Sources: Chew 1989, Anglada 1997.

    >>> import fem_mesh as fm
    >>> outer, hole = [(0, 0), (4, 0), (4, 4), (0, 4)], [(1, 1), (3, 1), (3, 3), (1, 3)]
    >>> fm.constrained_delaunay(fm.Domain.from_loops(outer, hole))
    Mesh: 8 points, 8 triangles, 8 segments, smallest angle 18.4 degrees
    """
    parts = triangulate(as_domain(domain))
    for _ in constrain(domain, parts, drained):
        pass
    return parts.to_mesh(domain)


def as_domain(domain: Any) -> Domain:
    """``domain`` itself. Raises MeshError for anything that is no Domain."""
    if not isinstance(domain, Domain):
        raise MeshError(f"a Domain is needed, not {type(domain).__name__}: fm.Domain.from_loops(outline) makes one")
    return domain


def triangulate(domain: Domain) -> Segmented:
    """The Delaunay triangulation of the domain's points, with no segment inserted yet."""
    n = len(domain.points)
    work = Workspace.of_points(domain.points, insertion_order(domain.points), chains=True)
    if not work.note:
        run(insert_points, insertion_state(work), n, total=n, done=lambda: work.state.item(NEXT) - 1)
    vertex = np.empty(n, np.int64)
    vertex[work.name[1:]] = work.merged[1:]
    ends = vertex[domain.segments]
    return Segmented(
        work, ends, segment=np.zeros(len(work.origin), np.uint32), edge_of=np.zeros(3 * n + 3, np.uint32),
        piece_of=np.zeros(3 * n + 3, np.int32), names=domain.names,
        region_names=("", *(region.name for region in domain.regions)),
    )  # fmt: skip


def constrain(domain: Domain, parts: Segmented, drive: Driver) -> Iterator[tuple[str, int, int]]:
    """Insert the segments and carve, in place: yields ("segments" or "carving", event, where) of what ``drive`` hands on."""
    work = parts.work
    if work.note:
        parts.keep(np.zeros(parts.count, bool))
        return
    parity = np.zeros(len(parts.edge_of), np.uint8)
    leaving = np.zeros(len(work.xy), np.uint32)
    call(note_leaving, parts.count, work.origin, leaving, size=len(work.xy))
    toggles = domain.toggles.astype(np.uint8)
    state = (
        work.xy, work.origin, work.twin, parts.segment, parts.edge_of, parts.piece_of, parity, leaving, parts.ends, toggles,
        work.cavity, work.ring, work.state,
    )  # fmt: skip
    for event, where in drive(insert_pieces, state, len(work.xy), total=len(parts.ends), done=lambda: work.state.item(PIECE)):
        if event == BLOCKED:
            raise MeshError(_say_crossing(domain, work.state.item(PIECE), int(parts.piece_of[where])))
        yield "segments", event, where
    side = np.full(parts.count, UNKNOWN, np.uint8)
    seeds = locate_seeds(domain, parts)
    work.state[FLOODED] = work.state[REACHED] = 0
    if domain.toggles.any():  # else no loop is closed, and the domain is the convex hull
        call(flood_from_ghosts, work.origin, side, work.cavity, work.state, size=len(work.xy))
        yield from carve(domain, parts, parity, side, drive)
    from_hull = int(work.state[REACHED])
    for i in range(len(domain.holes)):
        begin_at_seed(domain, parts, side, i, seeds[i], from_hull)
        yield from carve(domain, parts, parity, side, drive)
    if len(domain.holes) and not (side[~ghosts(parts)] != OUTSIDE).any():
        raise MeshError(
            f"the floods from outside and from {many(len(domain.holes), 'hole seed')} leave no triangle: "
            "the outline, or that around a hole, is not closed"
        )
    color_regions(domain, parts, side, seeds[len(domain.holes) :])
    laid = parts.piece_of[1 : work.state[SEGMENTS] + 1]
    kept = side != OUTSIDE
    kept &= ~ghosts(parts)
    parts.keep(kept)
    left = parts.piece_of[1:]
    lost = [] if (left >= 0).sum() == len(laid) else np.setdiff1d(laid, left).tolist()
    if lost:
        work.note = f"outside the domain, and gone: segment{'s' * (len(lost) > 1)} {say_rows(domain, lost)}"


def carve(
    domain: Domain, parts: Segmented, parity: np.ndarray, side: np.ndarray, drive: Driver
) -> Iterator[tuple[str, int, int]]:
    """Let the flood go on from the triangles that it has reached, in place."""
    work = parts.work
    rule = np.array([BY_SEEDS if len(domain.holes) else BY_PARITY])
    state = (work.origin, work.twin, parts.segment, parity, side, work.cavity, rule, work.state)
    for event, where in drive(flood, state, len(work.xy)):
        if event == CONFLICT:
            raise MeshError(_say_conflict(domain, int(parts.piece_of[where])))
        yield "carving", event, where


def _say_crossing(domain: Domain, row: int, other: int) -> str:
    return f'segments {say_rows(domain, [row])} and {say_rows(domain, [other])} cross: mend them, or say crossings="split"'


def _say_conflict(domain: Domain, row: int) -> str:
    return (
        f"whether a place is inside depends on the way there: segment {say_rows(domain, [row])} is part of loops that do "
        "not nest. Name the holes by seeds (holes=...), or give each outline as a loop of its own"
    )


# ---- two drivers -----------------------------------------------------------------------------------


def drained(generator: Any, state: Any, size: int, **progress: Any) -> Events:
    """Run a kernel to its end: only its last event is handed on."""
    yield run(generator, state, size, **progress)


def watched(generator: Any, state: Any, size: int, **progress: Any) -> Events:
    return watch(generator, state)


def insert_segments(domain: Domain) -> Generator[Step, None, Mesh]:
    """Constrained Delaunay triangulation, segment by segment: yields every crossing, piece and carving; returns the Mesh.

    Begins with the Delaunay triangulation of the points. See ``constrained_delaunay`` for what is raised.

    >>> import fem_mesh as fm
    >>> for step in fm.insert_segments(fm.Domain([(0, 0), (4, 0), (2, 1), (2, -1)], [(0, 1)])):
    ...     print(step.kind, "-", step.caption)
    start - 2 triangles on 4 points, all circles empty; 1 segment to insert
    cross - segment 0 from 0 to 1 crosses 1 edge: its 2 triangles will go
    segment - edge 0-1 is there: 2 triangles come, 2 go; 2 points in their circles, none that its triangle sees
    done - 2 triangles on 4 points, 1 segment: every circle is empty of the points that its triangle sees
    """
    return _watch(domain, triangulate(as_domain(domain)))


def _watch(domain: Domain, parts: Segmented) -> Generator[Step, None, Mesh]:
    work = parts.work
    points = [(v, *point) for v, point in enumerate(domain.points.tolist())]
    if work.note:
        yield Step("done", work.note, new_points=points)
        for _ in constrain(domain, parts, watched):
            pass
        return parts.to_mesh(domain)
    start = tuple(t for t in map(work.corners, range(parts.count)) if t)
    yield Step("start", say_start, added=start, new_points=points, asked=domain.segments.tolist())
    doomed: tuple[Triangle, ...] = ()
    for stage, event, where in constrain(domain, parts, watched):
        if stage == "carving":
            yield _carve_step(work, where, seeds=bool(len(domain.holes)))
        elif event == CROSSED:
            row, begun = work.state.item(PIECE), work.state.item(FROM)
            doomed = tuple(t for t in map(work.corners, work.cavity[:where].tolist()) if t)
            way = (work.name.item(begun) if begun else domain.segments.item(row, 0), domain.segments.item(row, 1))
            crossed = [tuple(sorted(set(s) & set(t))) for s, t in pairwise(doomed)]
            yield Step("cross", say_cross, doomed=doomed, asked=(way,), edges=crossed, row=int(domain.source[row]), way=way)
        elif event == LAID:
            edge = work.edge(where)
            added = tuple(t for t in map(work.corners, work.cavity[: len(doomed)].tolist()) if t)
            yield Step(
                "segment", say_segment, added=added, removed=doomed, circles=added, new_segments=(edge,), edge=edge,
                points_there=domain.points,
            )  # fmt: skip
            doomed = ()
    mesh = parts.to_mesh(domain)
    yield Step("done", say_done, n=len(mesh.points) - len(mesh.unused), m=len(mesh.triangles), k=len(mesh.segments))
    return mesh


def _carve_step(work: Workspace, t: int, seeds: bool) -> Step:
    gone = work.corners(t)
    assert gone is not None
    return Step("carve", say_carve, removed=(gone,), doomed=(gone,), t=gone, seeds=seeds)


# ---- captions --------------------------------------------------------------------------------------


def say_start(step: Step) -> str:
    m, n = many(len(step.added), "triangle"), many(len(step.new_points), "point")
    return f"{m} on {n}, all circles empty; {many(len(step.asked), 'segment')} to insert"


def say_cross(step: Step) -> str:
    (u, v), m = step.facts["way"], len(step.doomed)
    return f"segment {step.facts['row']} from {u} to {v} crosses {many(m - 1, 'edge')}: its {m} triangles will go"


def say_segment(step: Step) -> str:
    u, v = step.facts["edge"]
    if not step.added:
        return f"edge {u}-{v} is there already: it becomes a segment"
    came = f"edge {u}-{v} is there: {many(len(step.added), 'triangle')} come, {len(step.removed)} go"
    hidden = len(points_in_circles(step.added, step.facts["points_there"]))
    return f"{came}; {many(hidden, 'point')} in their circles, none that its triangle sees" if hidden else came


def points_in_circles(triangles: Iterable[Triangle], points: np.ndarray) -> list[int]:
    """The points that lie strictly inside the circle of any of the ``triangles``: exact."""
    at = points.tolist()
    return [
        v for v, p in enumerate(at) if any(in_circle_sign(*at[a], *at[b], *at[c], *p) > 0 for a, b, c in triangles)
    ]  # fmt: skip


def say_carve(step: Step) -> str:
    a, b, c = step.facts["t"]
    if step.facts["seeds"]:
        return f"the flood reaches triangle {a}, {b}, {c} without crossing a segment: it goes"
    return f"from outside, an even number of outlines is crossed on the way to triangle {a}, {b}, {c}: it goes"


def say_done(step: Step) -> str:
    m, n, k = (many(step.facts[key], thing) for key, thing in (("m", "triangle"), ("n", "point"), ("k", "segment")))
    return f"{m} on {n}, {k}: every circle is empty of the points that its triangle sees"
