"""``ruppert``, watched: the events of its kernel told as steps."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterable
from typing import Any

import numpy as np

from fem_mesh.algorithms.constrained_delaunay import watched
from fem_mesh.algorithms.refine import as_bounds, begin_refinement, refinement_events
from fem_mesh.algorithms.refining.captions import (
    VERDICTS,
    angle_over,
    measures,
    say_clear,
    say_done,
    say_encroached,
    say_excused,
    say_insert,
    say_lift,
    say_move,
    say_refused,
    say_reject,
    say_spent,
    say_split,
    say_start,
    say_steiner,
    say_taken,
    say_whole,
)
from fem_mesh.algorithms.refining.cavities import next_vertex
from fem_mesh.algorithms.refining.encroachment import SHARP, is_encroached
from fem_mesh.algorithms.refining.refiner import Refiner
from fem_mesh.algorithms.refining.steiner import judge
from fem_mesh.algorithms.refining.worklists import ADDED, MOST, OFF_CURVE, QUEUED, STATUS, TAKEN
from fem_mesh.algorithms.ruppert import (
    CAVITY,
    CLEARED,
    CLEARING,
    ENCROACHED,
    EXCUSED,
    FROZEN_WHOLE,
    INSERTED,
    LANDING,
    LIFTED,
    MOVED,
    MOVING,
    REFUSED,
    REJECTED,
    SPENT,
    SPLIT,
    SPLITTING,
)
from fem_mesh.domain.domain import Domain
from fem_mesh.kernel import view
from fem_mesh.mesh.halfedge import prev_edge
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.quality import circumcircle
from fem_mesh.mesh.workspace import SEGMENTS
from fem_mesh.steps import Step, Triangle

Edge = tuple[int, int]


def ruppert(
    domain: Domain | Mesh,
    min_angle: float = 20.0,
    max_area: float | None = None,
    size: float | Callable[..., Any] | None = None,
    max_points: int | None = None,
    where: Any = None,
    encroachment: str = "lens",
    steiner: str = "relocation",
) -> Generator[Step, None, Mesh]:
    """``refine``, step by step: yields every encroachment, split, bad triangle, Steiner point and rejection; returns the Mesh.

    Takes the arguments of ``refine``, and raises as it does. Ruppert's own algorithm is
    ``encroachment="circle", steiner="circumcenter"``. Source: Ruppert 1995; see ``refine`` for the others.

    >>> import fem_mesh as fm
    >>> flat = fm.Domain.from_loops([(0, 0), (4, 0), (4, 1), (0, 1)])
    >>> for step in fm.ruppert(flat, min_angle=20):
    ...     print(step.kind, "-", step.caption)
    start - 2 triangles on 4 points, 4 sub-segments; asked for: angles of 20 degrees or more
    skinny - triangle 2, 0, 1 is skinny: its smallest angle, 14 degrees, is below 20
    steiner - the circumcentre of 2, 0, 1 would lie in 2 circles: 2 triangles would go
    reject - the point is not inserted: it encroaches upon 0-1, 2-3, which are split first
    encroached - sub-segment 2-3 is encroached by the point that was to mend triangle 2, 0, 1
    split - sub-segment 2-3 is split in the middle, at the new vertex 4: 3 triangles come, 2 go
    encroached - sub-segment 0-1 is encroached by the point that was to mend triangle 2, 0, 1
    split - sub-segment 0-1 is split in the middle, at the new vertex 5: 2 triangles come, 1 goes
    done - Refinement: complete, 2 points added: 4 triangles, smallest angle 26.6 degrees
    """
    bounds = as_bounds(min_angle, max_area, size, max_points, encroachment, steiner)
    return _Watcher(begin_refinement(domain, bounds, where)).steps()


class _Watcher:
    """Turns events into steps. From the event before a change it remembers what the change is about."""

    def __init__(self, refiner: Refiner) -> None:
        self.refiner, self.work, self.parts = refiner, refiner.parts.work, refiner.parts
        self.doomed: tuple[Triangle, ...] = ()
        self.triangle: Triangle = (0, 0, 0)  # the bad one
        self.edge: Edge = (0, 0)  # the sub-segment
        self.cause: dict[int, Triangle] = {}  # the bad triangle whose Steiner point encroached upon each sub-segment
        self.vertex = -1  # the one to be cleared
        self.dug = 0  # triangles in the cavity, ghosts among them
        self.curved = self.on_curve = False  # the sub-segment has a curve; is split on it
        self.off = 0  # split points off their curve, so far

    def steps(self) -> Generator[Step, None, Mesh]:
        yield self.start()
        before = 0
        for event, where in refinement_events(self.refiner, watched):
            if event in ABOUT_A_TRIANGLE and before != CAVITY:
                yield self.taken(self.work.state.item(TAKEN))
            tell = TELLERS.get(event)
            step = tell(self, where) if tell else None
            if step is not None:
                yield step
            before = event
        changes = self.renumbering()
        mesh = self.refiner.finish()
        yield Step("done", say_done, **changes, result=mesh.refinement, m=len(mesh.triangles), angle=mesh.min_angle)
        return mesh

    # ---- each event ------------------------------------------------------------------------------

    def start(self) -> Step:
        added = tuple(t for t in map(self.work.corners, range(self.parts.count)) if t)
        points = [(v, *point) for v, point in enumerate(self.work.points.tolist())]
        count = int(self.work.state[SEGMENTS])
        segments = tuple(self.work.edge(h) for h in self.parts.edge_of[1 : count + 1].tolist())
        bounds = self.refiner.bounds
        return Step("start", say_start, added=added, new_points=points, new_segments=segments, bounds=bounds, makes_points=True)

    def encroached(self, h: int) -> Step:
        self.edge = self.work.edge(h)
        self.curved = bool(self.refiner.curved[self.parts.piece_of[self.parts.segment[h]]])
        seen = [(angle_over(self.place(v), *map(self.place, self.edge)), v) for v in self.apexes(h)]
        angle, v = max(seen, default=(0.0, -1))
        cause = self.cause.pop(int(self.parts.segment[h]), None)
        arrays = map(view, (self.work.xy, self.work.origin, self.work.twin, self.refiner.limits, self.work.state))
        inside = is_encroached(h, *arrays)
        return Step(
            "encroached", say_encroached, encroached=(self.edge,), doomed=() if inside or not cause else (cause,),
            point=self.place(v) if inside else None, edge=self.edge, v=v, angle=angle, inside=inside, cause=cause,
        )  # fmt: skip

    def clearing(self, h: int) -> None:
        work, first, around = self.work, h, []
        self.vertex = work.edge(h)[0]
        while True:  # once around the vertex
            around.append(work.corners(h // 3))
            h = work.twin.item(prev_edge(h))
            if h == first:
                break
        self.doomed = tuple(t for t in around if t)

    def cleared(self, degree: int) -> Step:
        added = self.listed(range(2, degree))
        return Step(
            "clear", say_clear, added=added, removed=self.doomed, gone_points=(self.vertex,), encroached=(self.edge,),
            v=self.vertex, edge=self.edge,
        )  # fmt: skip

    def splitting(self, dug: int) -> None:
        off = int(self.work.state[OFF_CURVE])
        self.on_curve = self.curved and off == self.off
        self.off = off
        self.dug, self.doomed = dug, self.listed(range(dug))

    def split(self, v: int) -> Step:
        (a, b), name, point = self.edge, self.work.name.item(v), self.at(v)
        added = self.listed(range(self.dug + 2))
        ends = self.place(a), self.place(b)
        return Step(
            "split", say_split, added=added, removed=self.doomed, new_points=((name, *point),), point=point,
            gone_segments=(self.edge,), new_segments=((a, name), (name, b)), edge=self.edge, v=name,
            part=math.dist(ends[0], point) / math.dist(*ends), size=math.dist(*ends), on_curve=self.on_curve,
            sharp=[self.is_sharp(name) for name in self.edge],
        )  # fmt: skip

    def whole(self, h: int) -> Step:
        return Step("precision", say_whole, encroached=(self.edge,), edge=self.edge)

    def taken(self, h: int) -> Step:
        t = h // 3
        corners = self.work.corners(t)
        assert corners is not None
        self.triangle = corners
        refiner, work = self.refiner, self.work
        arrays = map(view, (work.xy, work.origin, refiner.label, refiner.limit, refiner.wanted))
        verdict, _, square = judge(t, *arrays)
        facts: Any = measures([self.place(v) for v in corners])
        return Step(
            VERDICTS[verdict], say_taken, doomed=(corners,), circles=(corners,), edges=(work.edge(h),), t=corners,
            verdict=verdict, shortest=math.sqrt(square), bounds=refiner.bounds, **facts,
        )  # fmt: skip

    def cavity(self, dug: int) -> Step:
        self.dug, self.doomed = dug, self.listed(range(dug))
        point = self.at(next_vertex(view(self.work.state)))
        x, y, radius = circumcircle(*(c for corner in self.triangle for c in self.place(corner)))
        at_centre = math.dist((x, y), point) <= 1e-6 * radius
        return Step(
            "steiner", say_steiner, point=point, doomed=self.doomed, circles=(self.triangle,), t=self.triangle,
            at_centre=at_centre, distance=math.dist((x, y), point), count=dug,
        )  # fmt: skip

    def inserted(self, v: int) -> Step:
        return self.joined("insert", say_insert, v)

    def moved(self, v: int) -> Step:
        return self.joined("move", say_move, v)

    def joined(self, kind: str, say: Callable[[Step], str], v: int) -> Step:
        name, point, added = self.work.name.item(v), self.at(v), self.listed(range(self.dug + 2))
        return Step(kind, say, added=added, removed=self.doomed, new_points=((name, *point),), point=point, v=name)

    def lifted(self, degree: int) -> Step:
        point = self.at(next_vertex(view(self.work.state)))  # its slot is free, and still holds where it was
        return Step(
            "lift", say_lift, added=self.listed(range(2, degree)), removed=self.doomed, gone_points=(self.vertex,),
            point=point, v=self.vertex, t=self.triangle,
        )  # fmt: skip

    def rejected(self, h: int) -> Step:
        waiting = self.refiner.waiting
        found = [s for s in range(1, int(self.work.state[SEGMENTS]) + 1) if waiting[s, STATUS] == QUEUED]
        for s in found:
            self.cause[s] = self.triangle
        edges = tuple(self.work.edge(int(self.parts.edge_of[s])) for s in found)
        point = self.at(next_vertex(view(self.work.state)))
        return Step("reject", say_reject, point=point, encroached=edges, doomed=(self.triangle,), t=self.triangle)

    def excused(self, h: int) -> Step:
        return Step("skip", say_excused, visited=(self.triangle,), edges=(self.work.edge(h),), t=self.triangle)

    def refused(self, h: int) -> Step:
        return Step("precision", say_refused, visited=(self.triangle,), t=self.triangle)

    def spent(self, _: int) -> Step:
        return Step("budget", say_spent, added_points=int(self.work.state[ADDED]), most=int(self.work.state[MOST]))

    # ---- what they read --------------------------------------------------------------------------

    def place(self, name: int) -> tuple[float, float]:
        """Where the point with this number is: points are numbered on in the order of their slots."""
        n = len(self.work.points)
        return (self.work.points.item(name, 0), self.work.points.item(name, 1)) if name < n else self.at(name + 1)

    def is_sharp(self, name: int) -> bool:
        """Whether this point is a corner of less than 60 degrees."""
        n = len(self.work.points)
        return name < n and bool(self.refiner.place[int(np.flatnonzero(self.work.name[: n + 1] == name)[0])] == SHARP)

    def at(self, v: int) -> tuple[float, float]:
        return self.work.xy.item(v, 0), self.work.xy.item(v, 1)

    def listed(self, places: Iterable[int]) -> tuple[Triangle, ...]:
        """The triangles that ``cavity`` lists, without ghosts."""
        corners = (self.work.corners(self.work.cavity.item(i)) for i in places)
        return tuple(t for t in corners if t)

    def apexes(self, h: int) -> list[int]:
        """The vertices opposite the edge of ``h``, without the ghost."""
        return [v for v in (self.work.apex(h), self.work.apex(self.work.twin.item(h))) if v >= 0]

    def renumbering(self) -> dict[str, Any]:
        """Where removed vertices have left gaps in the numbers, later ones move up: what changes for the trace."""
        work = self.work
        names = work.name.copy()
        self.refiner.name_new_vertices()
        moved = {int(old): int(new) for old, new in zip(names, work.name, strict=False) if new >= 0 and old != new}
        where = {int(name): v for v, name in enumerate(work.name.tolist()) if name >= 0}
        new = set(moved.values())
        triangles = [t for t in map(work.corners, range(self.parts.count)) if t and not new.isdisjoint(t)]
        old = {now: before for before, now in moved.items()}
        before = tuple(tuple(old.get(v, v) for v in t) for t in triangles)
        points = [(v, *self.at(where[v])) for v in moved.values()]
        gone = [v for v in moved if v not in new]
        return {"added": triangles, "removed": before, "new_points": points, "gone_points": gone, "gaps": len(gone)}


ABOUT_A_TRIANGLE = (EXCUSED, REFUSED, CAVITY, MOVING)  # the first event that says what becomes of a bad triangle
TELLERS: dict[int, Callable[[_Watcher, int], Step | None]] = {
    ENCROACHED: _Watcher.encroached,
    CLEARING: _Watcher.clearing,
    CLEARED: _Watcher.cleared,
    SPLITTING: _Watcher.splitting,
    SPLIT: _Watcher.split,
    FROZEN_WHOLE: _Watcher.whole,
    CAVITY: _Watcher.cavity,
    INSERTED: _Watcher.inserted,
    MOVING: _Watcher.clearing,
    LIFTED: _Watcher.lifted,
    LANDING: _Watcher.splitting,
    MOVED: _Watcher.moved,
    REJECTED: _Watcher.rejected,
    EXCUSED: _Watcher.excused,
    REFUSED: _Watcher.refused,
    SPENT: _Watcher.spent,
}
