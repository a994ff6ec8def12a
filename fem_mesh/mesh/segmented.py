"""A workspace whose triangles know segments: the arrays beside it, what is carved out of it, the mesh it becomes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fem_mesh.kernel import call
from fem_mesh.mesh.constrained import close_boundaries
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.refinement import Refinement
from fem_mesh.mesh.workspace import COUNT, NEXT, SEGMENTS, Workspace, list_triangles

Names = str | tuple[str, ...]  # of a row: one, "" for none, or several
NO_PIECE = -1  # the row of a sub-segment that nobody asked for: a boundary


@dataclass
class Segmented:
    """A workspace, and its sub-segments: see ``constrained.py`` for what the arrays mean."""

    work: Workspace
    ends: np.ndarray  # (rows, 2) int64, the vertices of each segment of the domain
    segment: np.ndarray  # a half-edge's sub-segment, 0 for none
    edge_of: np.ndarray  # a half-edge of each sub-segment
    piece_of: np.ndarray  # int32, the row of ``ends`` that each sub-segment lies on, or NO_PIECE
    region: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int32))  # of each triangle
    names: tuple[Names, ...] = ()  # of the rows of ``ends``
    region_names: tuple[str, ...] = ("",)

    @property
    def count(self) -> int:
        """Triangles in use, ghosts among them."""
        return int(self.work.state[COUNT])

    def keep(self, inside: np.ndarray) -> None:
        """Keep the triangles for which ``inside`` is True, and put a ghost outside each of their boundary edges.

        A boundary edge that is no segment becomes one, of NO_PIECE. Sub-segments without a triangle go.
        """
        work = self.work
        kept = np.flatnonzero(inside)
        number = np.full(self.count, -1, np.int64)
        number[kept] = np.arange(len(kept))
        twin = work.twin[: 3 * self.count].reshape(-1, 3)[kept].ravel().astype(np.int64)
        across = number[twin // 3]
        twin = np.where(across < 0, -1, 3 * across + twin % 3)
        self.rebuild(
            work.origin[: 3 * self.count].reshape(-1, 3)[kept].ravel(),
            twin,
            self.segment[: 3 * self.count].reshape(-1, 3)[kept].ravel(),
        )
        if len(self.region):
            self.region = np.pad(self.region[kept], (0, self.count - len(kept)))

    def rebuild(self, origin: np.ndarray, twin: np.ndarray, segment: np.ndarray) -> None:
        """Fill the arrays anew from the half-edges of some triangles; ``twin`` is -1 on the boundary."""
        boundary = np.flatnonzero(twin < 0)
        bare = boundary[segment[boundary] == 0]
        segment = segment.astype(np.uint32)
        segment[bare] = len(self.piece_of) + np.arange(len(bare))
        piece_of = np.concatenate([self.piece_of, np.full(len(bare), NO_PIECE, np.int32)])
        present, compact = np.unique(segment, return_inverse=True)
        if not len(present) or present[0] != 0:
            present, compact = np.concatenate([[0], present]), compact + 1
        m, room = len(origin) // 3, len(origin) // 3 + len(boundary)
        work = self.work
        work.origin, work.twin = (np.empty(3 * room, np.uint32) for _ in range(2))
        work.origin[: 3 * m], work.twin[: 3 * m] = origin, twin
        self.segment = np.zeros(3 * room, np.uint32)
        self.segment[: 3 * m] = compact.ravel()
        call(close_boundaries, boundary, m, work.origin, work.twin, size=m)
        self.segment[work.twin[boundary]] = self.segment[boundary]
        self.edge_of = np.zeros(len(present), np.uint32)
        marked = np.flatnonzero(self.segment[: 3 * m])[::-1]
        self.edge_of[self.segment[marked]] = marked
        self.piece_of = piece_of[present]
        work.state[COUNT], work.state[SEGMENTS] = room, len(present) - 1

    def subsegments(self) -> tuple[np.ndarray, np.ndarray]:
        """The sub-segments that were asked for: their vertices (k, 2), along each segment in its direction; its row."""
        work, count = self.work, int(self.work.state[SEGMENTS])
        h = self.edge_of[1 : count + 1].astype(np.int64)
        pairs = np.column_stack([work.origin[h], work.origin[np.where(h % 3 == 2, h - 2, h + 1)]]).astype(np.int64)
        piece = self.piece_of[1 : count + 1]
        along = np.zeros((count, 2))
        asked = piece >= 0
        start, end = self.ends[piece[asked]].T if len(self.ends) else (np.empty(0, np.int64),) * 2
        way = work.xy[end] - work.xy[start]
        for i in range(2):
            along[asked, i] = ((work.xy[pairs[asked, i]] - work.xy[start]) * way).sum(axis=1)
        back = along[:, 0] > along[:, 1]
        pairs[back], along[back] = pairs[back, ::-1], along[back, ::-1]
        if (piece[1:] <= piece[:-1]).any():
            order = np.lexsort((pairs[:, 0], along[:, 0], piece))
            pairs, piece = pairs[order], piece[order]
        first = int(np.searchsorted(piece, 0))  # behind those of NO_PIECE
        return pairs[first:], piece[first:]

    def to_mesh(self, domain: Any = None, refinement: Refinement | None = None, note: str = "") -> Mesh:
        """The mesh that stands in the arrays, under the user's numbers. It takes over their memory."""
        work, n = self.work, len(self.work.points)
        pairs, piece = self.subsegments()
        segments = work.name[pairs].astype(np.int32).reshape(-1, 2)
        merged_into = work.merged_into()
        extra = work.name[n + 1 : int(work.state[NEXT])]
        points = work.points
        if len(extra):
            points = np.empty((n + int((extra >= 0).sum()), 2))
            points[:n] = work.points
            points[extra[extra >= 0]] = work.xy[n + 1 : n + 1 + len(extra)][extra >= 0]
            merged_into = np.concatenate([merged_into, np.arange(n, len(points), dtype=np.int32)])
        number = np.empty(self.count, np.int32)
        triangles, neighbors = (array.view(np.int32).reshape(-1, 3) for array in (work.origin, work.twin))
        m = call(list_triangles, work.origin, work.twin, work.name, number, triangles, neighbors, size=len(number))
        regions = np.zeros(m, np.int32)
        if len(self.region):
            regions[number[number >= 0]] = self.region[: self.count][number >= 0]
        return Mesh._of(
            points, _trimmed(triangles, m), _trimmed(neighbors, m), segments=segments, segment_of=piece.astype(np.int32),
            merged_into=merged_into, regions=regions, boundaries=rows_by_name(piece, self.names),
            region_names=self.region_names, domain=domain, refinement=refinement, note=note or work.note, work=work.counters(),
        )  # fmt: skip


def rows_by_name(piece: np.ndarray, names: tuple[Names, ...]) -> Mapping[str, np.ndarray]:
    """The rows of ``piece`` under each name, in the order of the names' first use."""
    kinds: dict[Names, int] = {"": 0}
    kind = np.array([kinds.setdefault(name, len(kinds)) for name in names] or [0])
    of_row = kind[piece]
    rows: dict[str, list[np.ndarray]] = {}
    parts = np.split(np.argsort(of_row, kind="stable"), np.cumsum(np.bincount(of_row, minlength=len(kinds)))[:-1])
    for name, found in zip(kinds, parts, strict=True):
        for one in name if isinstance(name, tuple) else (name,):
            if one and len(found):
                rows.setdefault(one, []).append(found)
    return {name: np.sort(np.concatenate(found)).astype(np.int32) for name, found in rows.items()}


def _trimmed(array: np.ndarray, m: int) -> np.ndarray:
    """The first m rows; a copy where much more than that would stay in memory."""
    return array[:m] if 4 * m >= 3 * len(array) else array[:m].copy()
