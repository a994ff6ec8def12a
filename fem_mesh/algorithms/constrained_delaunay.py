"""From a domain to its constrained Delaunay triangulation: points first, then segments, then what lies outside goes.

The three stages are the kernels of ``bowyer_watson``, ``segments`` and ``carving``; here they follow each
other, watched (``insert_segments``) or at full speed (``constrained_delaunay``).
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
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
from fem_mesh.algorithms.segments import BLOCKED, CROSSED, LAID, insert_pieces, note_leaving
from fem_mesh.domain.domain import Domain
from fem_mesh.errors import MeshError
from fem_mesh.kernel import call, run, watch
from fem_mesh.mesh.locator import Locator
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.order import insertion_order
from fem_mesh.mesh.quality import turns_of
from fem_mesh.mesh.segmented import Segmented
from fem_mesh.mesh.workspace import FLOODED, FROM, NEXT, PIECE, REACHED, SEGMENTS, Workspace
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
        work.note = f"outside the domain, and gone: segment{'s' * (len(lost) > 1)} {_rows(domain, lost)}"


def ghosts(parts: Segmented) -> np.ndarray:
    """Which triangles are ghosts: bool (count,)."""
    return np.asarray((parts.work.origin[: 3 * parts.count].reshape(-1, 3) == 0).any(axis=1))


def locate_seeds(domain: Domain, parts: Segmented) -> list[int]:
    """The triangle of each hole seed, then of each region's. Raises MeshError for one on a segment or beyond the hull."""
    places = [*map(tuple, domain.holes.tolist()), *((region.x, region.y) for region in domain.regions)]
    if not places:
        return []
    work = parts.work
    real = np.flatnonzero(~ghosts(parts))
    triangles = work.origin[: 3 * parts.count].reshape(-1, 3)[real].astype(np.int64)
    found = Locator(work.xy, triangles).find(np.array(places))
    for i, (t, place) in enumerate(zip(found.tolist(), places, strict=True)):
        what = _seed(domain, i)
        if t < 0:
            raise MeshError(f"{what} at {place} lies outside the domain: put it inside, or drop it")
        for k in range(3):
            h = 3 * int(real[t]) + k
            a, b = triangles[t, k], triangles[t, (k + 1) % 3]
            corners = np.array([work.xy[a], work.xy[b], place])
            if parts.segment[h] and turns_of(corners, np.array([[0, 1, 2]]))[0] == 0:
                row = int(parts.piece_of[parts.segment[h]])
                raise MeshError(f"{what} at {place} lies on segment {_rows(domain, [row])}: move it to one side")
    return [int(t) for t in real[found]]


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


def begin_at_seed(domain: Domain, parts: Segmented, side: np.ndarray, i: int, t: int, from_hull: int) -> None:
    """Let the flood in at hole seed ``i``, in triangle ``t``, unless another seed of the same hole did."""
    work = parts.work
    if side[t] == UNKNOWN:
        side[t] = OUTSIDE
        work.cavity[work.state[REACHED]] = t
        work.state[REACHED] += 1
    elif t in work.cavity[:from_hull]:
        place = tuple(domain.holes[i].tolist())
        raise MeshError(f"{_seed(domain, i)} at {place} lies outside the domain: the flood from its boundary is there already")


def color_regions(domain: Domain, parts: Segmented, side: np.ndarray, seeds: list[int]) -> None:
    """Number the triangles of each region, from its seed up to the segments around it: 1, 2, ..."""
    work, m = parts.work, parts.count
    parts.region = np.zeros(m, np.int32)
    twin, segment = work.twin[: 3 * m].reshape(-1, 3), parts.segment[: 3 * m].reshape(-1, 3)
    for i, t in enumerate(seeds):
        what = _seed(domain, len(domain.holes) + i)
        place = (domain.regions[i].x, domain.regions[i].y)
        if side[t] == OUTSIDE:
            raise MeshError(f"{what} at {place} lies outside the domain or in a hole: put it inside, or drop it")
        if parts.region[t]:
            other = domain.regions[int(parts.region[t]) - 1].name
            raise MeshError(f"{what} at {place} lies in the same part as region {other!r}: a segment must part them")
        front = np.array([t])
        while len(front):  # each turn colours triangles that had no colour
            parts.region[front] = i + 1
            across = (twin[front] // 3)[segment[front] == 0]
            front = np.unique(across[(parts.region[across] == 0) & (side[across] != OUTSIDE)]).astype(np.int64)
    parts.region[ghosts(parts)] = 0


def _seed(domain: Domain, i: int) -> str:
    j = len(domain.holes)
    return f"hole seed {i}" if i < j else f"region {domain.regions[i - j].name!r}"


def _rows(domain: Domain, rows: list[int]) -> str:
    """The user's rows of segments, with their end points."""
    shown = []
    for row in rows[:5]:
        (ax, ay), (bx, by) = domain.points[domain.segments[row]].tolist()
        shown.append(f"{int(domain.source[row])} from ({ax:.6g}, {ay:.6g}) to ({bx:.6g}, {by:.6g})")
    return ", ".join(shown) + (f" and {len(rows) - 5} more" if len(rows) > 5 else "")


def _say_crossing(domain: Domain, row: int, other: int) -> str:
    return f'segments {_rows(domain, [row])} and {_rows(domain, [other])} cross: mend them, or say crossings="split"'


def _say_conflict(domain: Domain, row: int) -> str:
    return (
        f"whether a place is inside depends on the way there: segment {_rows(domain, [row])} is part of loops that do "
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
    segment - edge 0-1 is there: 2 triangles come, 2 go
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
            yield Step("cross", say_cross, doomed=doomed, asked=(way,), row=int(domain.source[row]), way=way)
        elif event == LAID:
            edge = work.edge(where)
            added = tuple(t for t in map(work.corners, work.cavity[: len(doomed)].tolist()) if t)
            yield Step("segment", say_segment, added=added, removed=doomed, new_segments=(edge,), edge=edge)
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
    return f"edge {u}-{v} is there: {many(len(step.added), 'triangle')} come, {len(step.removed)} go"


def say_carve(step: Step) -> str:
    a, b, c = step.facts["t"]
    if step.facts["seeds"]:
        return f"the flood reaches triangle {a}, {b}, {c} without crossing a segment: it goes"
    return f"from outside, an even number of outlines is crossed on the way to triangle {a}, {b}, {c}: it goes"


def say_done(step: Step) -> str:
    m, n, k = (many(step.facts[key], thing) for key, thing in (("m", "triangle"), ("n", "point"), ("k", "segment")))
    return f"{m} on {n}, {k}: every circle is empty of the points that its triangle sees"
