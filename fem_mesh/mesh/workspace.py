"""The arrays an algorithm works in, and the way from and to what a user holds.

While working, vertices are numbered in the order of their insertion, from 1 (0 is the ghost vertex):
what is near in space is near in memory. ``name[v]`` is the user's index of vertex ``v``.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.kernel import call, index, kernel, view
from fem_mesh.mesh.halfedge import (
    GHOST,
    is_ghost,
    is_ghost_triangle,
    link,
    next_edge,
    place_triangle,
    start_triangulation,
    triangle_of,
)
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.predicates import orient_sign

# What `state` holds
NEXT = 0  # the next vertex to insert
COUNT = 1  # triangles in use, ghosts among them
LAST = 2  # a half-edge of a triangle made last, where the next walk starts
WALKED = 3  # triangles crossed by walks
TESTED = 4  # circles tested
FLIPPED = 5  # edges flipped
STACKED = 6  # half-edges waiting on the stack
PIECE = 7  # the segment of the domain to insert next
FROM = 8  # the vertex up to which it is there; 0 if it is not begun
SEGMENTS = 9  # sub-segments
FLOODED = 10  # triangles that the flood has left
REACHED = 11  # triangles that it has reached
SLOTS = 40  # the rest is for algorithms


@dataclass
class Workspace:
    """The state of one run. Arrays of ``capacity`` vertices; see halfedge.py for what they mean."""

    points: np.ndarray  # the user's, (n, 2) float64
    name: np.ndarray  # (capacity + 1,) int32, user's index of each vertex; -1 for the ghost
    xy: np.ndarray  # (capacity + 1, 2) float64
    merged: np.ndarray  # (capacity + 1,) uint32, the vertex that each was merged into; itself otherwise
    origin: np.ndarray  # (6 x capacity,) uint32
    twin: np.ndarray  # (6 x capacity,) uint32
    cavity: np.ndarray  # scratch: triangles
    ring: np.ndarray  # scratch: half-edges
    state: np.ndarray = field(default_factory=lambda: np.zeros(SLOTS, np.int64))  # counters, see above
    note: str = ""

    @classmethod
    def _with_room(cls, points: np.ndarray, name: np.ndarray, xy: np.ndarray, chains: bool = False) -> Workspace:
        room = max(2 * len(points), 4)  # n vertices and the ghost on a sphere have 2n - 2 triangles
        beyond = room + 9 - room % 3 if chains else 0  # half-edges for the chains of segments.py
        return cls(
            points,
            name,
            xy,
            merged=np.arange(len(xy), dtype=np.uint32),
            origin=np.empty(3 * room + beyond, np.uint32),
            twin=np.empty(3 * room + beyond, np.uint32),
            cavity=np.empty(room + 2, np.uint32),
            ring=np.empty(3 * room + 3, np.uint32),
        )

    @classmethod
    def with_room(cls, n: int) -> Workspace:
        """Room for ``n`` points to come, and no triangle yet: vertex ``v`` will be point ``v - 1``."""
        xy = np.zeros((n + 1, 2))
        return cls._with_room(xy[1:], np.arange(-1, n, dtype=np.int32), xy)

    @classmethod
    def of_points(cls, points: np.ndarray, order: np.ndarray, chains: bool = False) -> Workspace:
        """Room to insert ``points`` one by one in ``order``, begun with the first triangle; ``chains``: segments too.

        That is the first triple in the order that is exactly non-collinear: points skipped on the way
        go in next. Without one nothing is begun, and ``note`` says why.
        """
        n = len(points)
        name = np.empty(n + 1, np.int32)
        name[GHOST], name[1:] = -1, order
        xy = np.empty((n + 1, 2))
        xy[GHOST] = 0.0
        np.take(points, order, axis=0, out=xy[1:])
        work = cls._with_room(points, name, xy, chains)
        work._begin(n)
        return work

    def _begin(self, n: int) -> None:
        if n < 3:
            self.note = f"no triangles: {n} point{'s' * (n != 1)}, and a triangle needs 3"
            return
        b, c = call(find_first_triangle, self.xy, size=n)
        if is_ghost(c):
            self.note = f"no triangles: all {n} points {'are equal' if is_ghost(b) else 'lie on one line'}"
            return
        for k, v in ((2, b), (3, c)):  # bring the triangle to the front, the rest moves up
            for array in (self.xy, self.name):
                array[k : v + 1] = np.roll(array[k : v + 1], 1, axis=0)
        start_triangulation(view(self.xy), view(self.origin), view(self.twin), 1, 2, 3)
        self.state[NEXT], self.state[COUNT] = 4, 4

    @classmethod
    def of_triangles(cls, points: np.ndarray, triangles: np.ndarray, twins: np.ndarray) -> Workspace:
        """The half-edges of given ``triangles`` (m, 3), counter-clockwise, closed by ghost triangles.

        ``twins`` (m, 3) holds the half-edge opposite each one, or -1 on the boundary, which must be
        one closed loop.
        """
        n, m = len(points), len(triangles)
        name = np.arange(-1, n, dtype=np.int32)
        xy = np.concatenate([np.zeros((1, 2)), points])
        work = cls._with_room(points, name, xy)
        work.origin[: 3 * m] = triangles.ravel() + 1
        flat = twins.ravel()
        work.twin[: 3 * m] = flat
        boundary = np.flatnonzero(flat < 0)
        call(close_boundary, boundary, m, work.origin, work.twin, np.zeros(n + 1, np.int64), size=m)
        work.state[NEXT], work.state[COUNT] = n + 1, m + len(boundary)
        return work

    def merge_unused(self, triangles: np.ndarray) -> None:
        """Merge each point in no triangle into the used point that equals it; MeshError where there is none."""
        used = np.unique(triangles)
        vertex = {tuple(self.points[v].tolist()): v + 1 for v in used[::-1].tolist()}
        for v in np.setdiff1d(np.arange(len(self.points)), used).tolist():
            point = tuple(self.points[v].tolist())
            if point not in vertex:
                raise MeshError(f"point {v} at {point} is in no triangle: add one, or drop the point")
            self.merged[v + 1] = vertex[point]

    def to_mesh(self) -> Mesh:
        """The mesh that stands in the arrays, under the user's numbers.

        It takes over the memory of the half-edges: this workspace is spent.
        """
        number = np.empty(int(self.state[COUNT]), np.int32)
        triangles, neighbors = (array.view(np.int32).reshape(-1, 3) for array in (self.origin, self.twin))
        arrays = (self.origin, self.twin, self.name, number, triangles, neighbors)
        m = call(list_triangles, *arrays, size=len(self.points))
        merged_into = self.merged_into() if m else _first_equal(self.points)
        found = triangles[:m], neighbors[:m]
        return Mesh._of(self.points, *found, merged_into=merged_into, note=self.note, work=self.counters())

    def merged_into(self) -> np.ndarray:
        """Each point's representative under the user's numbers, int32 (n,)."""
        n = len(self.points)
        result = np.arange(n, dtype=np.int32)
        doubles = np.flatnonzero(self.merged[: n + 1] != np.arange(n + 1))
        result[self.name[doubles]] = self.name[self.merged[doubles]]
        return result

    def counters(self) -> dict[str, int]:
        """What it took so far."""
        slots = {"in_circle tests": TESTED, "walk steps": WALKED, "flips": FLIPPED}
        return {what: int(self.state[slot]) for what, slot in slots.items()}

    def corners(self, t: int) -> tuple[int, int, int] | None:
        """The user's indices of triangle ``t``, counter-clockwise; None for a ghost triangle."""
        a, b, c = self.origin[3 * t : 3 * t + 3].tolist()
        if is_ghost(a) or is_ghost(b) or is_ghost(c):
            return None
        return self.name.item(a), self.name.item(b), self.name.item(c)

    def edge(self, h: int) -> tuple[int, int]:
        """The user's indices of the ends of half-edge ``h``; -1 for the ghost vertex."""
        return self.name.item(self.origin.item(h)), self.name.item(self.origin.item(next_edge(h)))

    def apex(self, h: int) -> int:
        """The user's index of the vertex opposite half-edge ``h`` in its triangle; -1 for the ghost."""
        return int(self.name[self.origin[next_edge(next_edge(h))]])


def _first_equal(points: np.ndarray) -> np.ndarray:
    _, first, inverse = np.unique(points, axis=0, return_index=True, return_inverse=True)
    return first[inverse.ravel()].astype(np.int32)


@kernel
def find_first_triangle(xy):
    """The first vertex that differs from vertex 1, and the first that is not collinear with both, or ghosts."""
    b = index(GHOST)
    for v in range(2, len(xy)):
        if is_ghost(b):
            if xy[v, 0] != xy[1, 0] or xy[v, 1] != xy[1, 1]:
                b = index(v)
        elif orient_sign(xy[1, 0], xy[1, 1], xy[b, 0], xy[b, 1], xy[v, 0], xy[v, 1]) != 0.0:
            return b, index(v)
    return b, index(GHOST)


@kernel
def close_boundary(boundary, m, origin, twin, ghost_of):
    """Put a ghost triangle, in the slots from ``m`` on, outside each boundary half-edge of one closed loop."""
    for i in range(len(boundary)):
        h = boundary[i]
        g = place_triangle(origin, m + i, origin[next_edge(h)], origin[h], GHOST)
        link(twin, g, index(h))
        ghost_of[origin[h]] = g  # the ghost of the one boundary edge that leaves this vertex
    for i in range(len(boundary)):
        g = index(3 * (m + i))  # b -> a -> ghost -> b, outside a -> b
        leaving = index(ghost_of[origin[g]])  # outside b -> c: c -> b -> ghost -> c
        link(twin, index(g + 2), index(leaving + 1))


@kernel
def list_triangles(origin, twin, name, number, triangles, neighbors):
    """Write out the real triangles under the user's names, and their neighbours; returns how many.

    ``triangles`` and ``neighbors`` may be the memory of ``origin`` and ``twin``: each triangle is read
    before it is written, to its own place or an earlier one.
    """
    m = 0
    for t in range(len(number)):
        if is_ghost_triangle(index(3 * t), origin):
            number[t] = -1
        else:
            number[t] = m
            m += 1
    for t in range(len(number)):
        if number[t] >= 0:
            row, h = index(number[t]), index(3 * t)
            a, b, c = origin[h], origin[index(h + 1)], origin[index(h + 2)]
            across_ab, across_bc, across_ca = twin[h], twin[index(h + 1)], twin[index(h + 2)]
            triangles[row, 0], triangles[row, 1], triangles[row, 2] = name[a], name[b], name[c]
            neighbors[row, 0] = number[triangle_of(across_bc)]
            neighbors[row, 1] = number[triangle_of(across_ca)]
            neighbors[row, 2] = number[triangle_of(across_ab)]
    return m
