"""A Delaunay triangulation that stays open: points come, go and move, one by one.

Point ``i`` is vertex ``i + 1`` of the half-edges, so no names are needed. An insertion is the engine's own
(``bowyer_watson.insert_points``), a removal the kernel of ``mesh/removal.py``, a move is both. What changed is
read off the slots that differ from before. While all points lie on one line there is no triangle.
"""

from __future__ import annotations

import operator
from collections.abc import Iterator
from typing import Any

import numpy as np

from fem_mesh.algorithms.bowyer_watson import insert_points, insertion_state, say_merge, say_start, tell_insertions
from fem_mesh.algorithms.delaunay import delaunay
from fem_mesh.algorithms.refining.captions import change
from fem_mesh.errors import MeshError
from fem_mesh.kernel import SETTLED, view, watch
from fem_mesh.mesh.halfedge import GHOST, is_ghost, next_edge, prev_edge, start_triangulation
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.order import insertion_order
from fem_mesh.mesh.points import as_points
from fem_mesh.mesh.removal import remove_vertex
from fem_mesh.mesh.workspace import COUNT, LAST, NEXT, Workspace, find_first_triangle
from fem_mesh.steps import Step, Triangle, many

ROOM = 32  # points that it has room for at first
Snapshot = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


class LiveDelaunay:
    """A Delaunay triangulation that points are added to, taken out of and moved in, each change told as steps.

    points : (n, 2) to begin with, numbered in their order; of equal points only the first is taken

    Points keep their numbers, 0 to n - 1; when one is taken out the last takes its number. No two are equal:
    a point that would be comes or moves in vain, and a step "merge" says so. Steps put into a ``Trace`` give the
    frames of all that happened, if it begins with those of an empty triangulation, or with ``start()``.

    Raises MeshError for points that are no finite pairs of numbers.

    >>> live = LiveDelaunay([(0, 0), (4, 0), (0, 3)])
    >>> for step in [*live.add(1, 1), *live.move(3, 2, 2), *live.remove(0)]:
    ...     print(step.kind, "-", step.caption)
    locate - point 3 lies in triangle 0, 1, 2, reached by crossing 0 triangles
    cavity - 1 circle holds point 3: 1 triangle will go
    insert - point 3 is joined to the 3 edges around the cavity: 3 triangles come, 1 goes
    move - point 3 moves: 0 triangles come, 1 goes
    remove - point 0 is taken out: 2 triangles go, 1 comes; point 3 is now point 0
    >>> live.triangles.tolist()
    [[1, 0, 2]]
    """

    def __init__(self, points: Any = ()) -> None:
        points = as_points(points)
        _, first = np.unique(points, axis=0, return_index=True)
        points = points[np.sort(first)]
        self._n = len(points)
        self._work = Workspace.with_room(max(self._n, ROOM))
        self._work.xy[1 : self._n + 1] = points
        self._begin()

    # ---- what there is ---------------------------------------------------------------------------

    @property
    def points(self) -> np.ndarray:
        """A copy of the points, float64 (n, 2)."""
        return self._work.xy[1 : self._n + 1].copy()

    @property
    def triangles(self) -> np.ndarray:
        """The triangles, counter-clockwise, int32 (m, 3)."""
        return np.asarray(self._corners[self._is_real] - 1, np.int32)

    def mesh(self) -> Mesh:
        """The triangulation as it stands, as a Mesh of its own."""
        real = self._is_real
        if not real.any():
            return delaunay(self.points)
        number = np.where(real, np.cumsum(real) - 1, -1).astype(np.int32)
        across = self._work.twin[: 3 * len(real)].reshape(-1, 3)[real] // 3
        return Mesh._of(self.points, self.triangles, number[across][:, [1, 2, 0]])

    def start(self) -> Step:
        """A step that brings all there is, for a trace to begin with."""
        points, added = self.points.tolist(), self.triangles.tolist()
        places = [(i, x, y) for i, (x, y) in enumerate(points)]
        return Step("start", say_beginning, added=added, new_points=places, makes_points=True)

    def __repr__(self) -> str:
        return f"LiveDelaunay: {many(self._n, 'point')}, {many(len(self.triangles), 'triangle')}"

    @property
    def _corners(self) -> np.ndarray:
        """The vertices of each slot in use, uint32 (count, 3), ghosts among them."""
        return self._work.origin[: 3 * int(self._work.state[COUNT])].reshape(-1, 3)

    @property
    def _is_real(self) -> np.ndarray:
        a, b, c = self._corners.T
        return np.asarray((a != GHOST) & (b != GHOST) & (c != GHOST))

    # ---- changes ---------------------------------------------------------------------------------

    def add(self, x: float, y: float) -> list[Step]:
        """Add a point, with the number n: the steps that the engine tells."""
        i = self._n
        x, y = _as_point(x, y, i)
        self._make_room(i + 1)
        work = self._work
        work.xy[i + 1] = x, y
        if not work.state[COUNT]:
            return [self._add_to_line(i, x, y)]
        steps = list(tell_insertions(work, self._insertion(i + 1)))
        self._n += steps[-1].kind == "insert"
        return steps

    def remove(self, i: int) -> list[Step]:
        """Take point ``i`` out; the last point takes its number."""
        i = self._number(i)
        work, v, last, before = self._work, i + 1, self._n - 1, self._corners.copy()
        point = tuple(work.xy[v].tolist())
        self._take_out(v)
        gone, come = _difference(before, self._corners)
        work.xy[v] = work.xy[last + 1]
        self._corners[self._corners == last + 1] = v
        self._n = last
        removed, added = _difference(before, self._corners)
        renamed = [(i, *work.xy[v].tolist())] if i < last else []
        return [
            Step(
                "remove", say_remove, removed=removed, added=added, point=point, new_points=renamed, gone_points=(last,),
                i=i, last=last, goes=len(gone), comes=len(come),
            )
        ]  # fmt: skip

    def move(self, i: int, x: float, y: float) -> list[Step]:
        """Put point ``i`` at (x, y), unless another point is there."""
        i = self._number(i)
        x, y = _as_point(x, y, i)
        equal, before = self._number_at(x, y), self._corners.copy()
        if equal not in (None, i):
            return [Step("merge", say_stay, point=(x, y), i=i, other=equal)]
        if equal is None:
            self._relocate(i + 1, x, y)
        removed, added = _difference(before, self._corners)
        return [Step("move", say_move, removed=removed, added=added, point=(x, y), new_points=[(i, x, y)], i=i)]

    def snapshot(self) -> Snapshot:
        """A copy of all that ``restore`` needs to come back here."""
        work, used = self._work, 3 * int(self._work.state[COUNT])
        return work.xy[: self._n + 1].copy(), work.origin[:used].copy(), work.twin[:used].copy(), work.state.copy()

    def restore(self, snapshot: Snapshot) -> None:
        """Make it the triangulation of which ``snapshot`` was taken, to the last index."""
        xy, origin, twin, state = snapshot
        self._make_room(len(xy) - 1)
        work, self._n = self._work, len(xy) - 1
        work.xy[: len(xy)], work.origin[: len(origin)], work.twin[: len(twin)], work.state[:] = xy, origin, twin, state

    # ---- what they stand on ----------------------------------------------------------------------

    def _begin(self) -> None:
        """Triangulate the points anew; where all lie on one line, without a triangle."""
        work, n = self._work, self._n
        b, c = find_first_triangle(view(work.xy[: n + 1]))
        work.state[COUNT] = work.state[LAST] = 0
        if is_ghost(c):
            return
        start_triangulation(view(work.xy), view(work.origin), view(work.twin), 1, b, c)
        work.state[COUNT] = 4
        for v in (insertion_order(work.xy[1 : n + 1]) + 1).tolist():
            if v not in (1, b, c):
                for _ in self._insertion(v):
                    pass

    def _insertion(self, v: int) -> Iterator[tuple[int, int]]:
        """The engine's insertion of vertex ``v``, dropped when that has settled."""
        self._work.state[NEXT] = v
        for event, where in watch(insert_points, insertion_state(self._work)):
            yield event, where
            if event >= SETTLED:
                return

    def _add_to_line(self, i: int, x: float, y: float) -> Step:
        """Add a point, already in its row, while there is no triangle."""
        equal = self._number_at(x, y)
        if equal is not None:
            return Step("merge", say_merge, point=(x, y), p=i, v=equal)
        self._n += 1
        self._begin()
        added = self.triangles.tolist()
        kind, say = ("start", say_beginning if len(added) > 1 else say_start) if added else ("insert", say_on_line)
        return Step(kind, say, added=added, point=(x, y), new_points=((i, x, y),), i=i, makes_points=True)

    def _take_out(self, v: int) -> None:
        """Take vertex ``v`` out of the triangulation: without it there may be no triangle."""
        work, count = self._work, int(self._work.state[COUNT])
        if not count:
            return
        h = int(np.flatnonzero(work.origin[: 3 * count] == v)[0])
        neighbor = max(work.origin[next_edge(h)], work.origin[prev_edge(h)])  # not the ghost, which is 0
        arrays = map(view, (work.xy, work.origin, work.twin, work.cavity, work.ring))
        work.state[COUNT] = count - 2 if remove_vertex(h, count, *arrays) else 0
        if work.state[COUNT]:  # the next walk starts here
            work.state[LAST] = np.flatnonzero(self._corners.ravel() == neighbor)[0]

    def _relocate(self, v: int, x: float, y: float) -> None:
        self._take_out(v)
        self._work.xy[v] = x, y
        if self._work.state[COUNT]:
            for _ in self._insertion(v):
                pass
        else:
            self._begin()

    def _make_room(self, n: int) -> None:
        if n > len(self._work.points):
            kept = self.snapshot()
            self._work = Workspace.with_room(2 * n)
            self.restore(kept)

    def _number_at(self, x: float, y: float) -> int | None:
        xs, ys = self._work.points[: self._n].T
        found = np.flatnonzero((xs == x) & (ys == y))
        return int(found[0]) if len(found) else None

    def _number(self, i: int) -> int:
        if not 0 <= i < self._n:
            raise MeshError(f"there is no point {i}: there are {many(self._n, 'point')}, numbered from 0")
        return operator.index(i)


def _as_point(x: Any, y: Any, i: int) -> tuple[float, float]:
    """The place of point ``i``, checked."""
    try:
        ((x, y),) = as_points([(x, y)]).tolist()
    except MeshError as error:
        raise MeshError(str(error).replace("point 0", f"point {i}", 1)) from None
    return x, y


def _difference(before: np.ndarray, after: np.ndarray) -> tuple[list[Triangle], list[Triangle]]:
    """The triangles only in ``before`` and those only in ``after``: the corners of each slot, ghosts among them."""
    shared = min(len(before), len(after))
    changed = (before[:shared] != after[:shared]).any(axis=1)
    old, new = (_real(corners[shared:]) | _real(corners[:shared][changed]) for corners in (before, after))
    return sorted(old - new), sorted(new - old)


def _real(corners: np.ndarray) -> set[Triangle]:
    """The real triangles among them by number of points, each with its lowest corner first."""
    found = set()
    for a, b, c in corners.tolist():
        if not (is_ghost(a) or is_ghost(b) or is_ghost(c)):
            a, b, c = (a, b, c) if a < b and a < c else (b, c, a) if b < c else (c, a, b)
            found.add((a - 1, b - 1, c - 1))
    return found


# ---- captions --------------------------------------------------------------------------------------


def say_beginning(step: Step) -> str:
    m, i = len(step.added), step.facts.get("i")
    if i is not None:
        return f"point {i} is the first that lies off the line of the others: {many(m, 'triangle')} come"
    return f"{many(m, 'triangle')} on {many(len(step.new_points), 'point')}"


def say_on_line(step: Step) -> str:
    i = step.facts["i"]
    if i < 2:
        return f"point {i} is there; a triangle needs {2 - i} more"
    return f"point {i} lies on one line with all the others: there is no triangle yet"


def say_remove(step: Step) -> str:
    i, last, goes, comes = (step.facts[name] for name in ("i", "last", "goes", "comes"))
    counts = f": {many(goes, 'triangle')} go{'es' * (goes == 1)}, {comes} come{'s' * (comes == 1)}" if goes else ""
    return f"point {i} is taken out{counts}" + (f"; point {last} is now point {i}" if i < last else "")


def say_move(step: Step) -> str:
    return f"point {step.facts['i']} moves: " + (change(step) if step.added or step.removed else "its triangles stay")


def say_stay(step: Step) -> str:
    return f"point {step.facts['i']} stays where it was: point {step.facts['other']} is there already"
