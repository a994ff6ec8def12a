"""Opening a finished mesh again, to go on working on it: its half-edges, its segments, and constrained Delaunay."""

from __future__ import annotations

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.kernel import call
from fem_mesh.mesh import validators
from fem_mesh.mesh.constrained import restore_delaunay
from fem_mesh.mesh.locator import Locator
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.segmented import NO_PIECE, Names, Segmented
from fem_mesh.mesh.workspace import FLIPPED, NEXT, Workspace


def reopen(mesh: Mesh, chosen: np.ndarray | None = None) -> tuple[Segmented, np.ndarray | None]:
    """The workspace of ``mesh``, made constrained Delaunay by flips; and the mask ``chosen`` of its triangles.

    Its segments, its boundary and the edges between regions stay edges. Raises MeshError where it is no valid mesh.
    """
    points, triangles = mesh.points, mesh.triangles
    validators.check_elements(points, triangles)
    twins = validators.check_edges(points, triangles)
    validators.check_realization(points, triangles)
    n = len(points)
    name = np.arange(-1, n, dtype=np.int32)
    xy = np.concatenate([np.zeros((1, 2)), points])
    work = Workspace._with_room(points.copy(), name, xy)
    work.merged[1:] = mesh.merged_into + 1
    work.state[NEXT] = n + 1
    work.note = mesh.note if mesh.refinement is None or not len(triangles) else ""
    ends, names, piece_of_row = chains_of(mesh)
    segment, piece_of = mark_edges(mesh, twins, piece_of_row)
    parts = Segmented(
        work, ends + 1, segment=np.empty(0, np.uint32), edge_of=np.empty(0, np.uint32), piece_of=piece_of,
        region=mesh.regions.astype(np.int32), names=names,
        region_names=mesh.region_names + ("",) * (int(mesh.regions.max(initial=0)) + 1 - len(mesh.region_names)),
    )  # fmt: skip
    parts.rebuild(triangles.ravel() + 1, twins.ravel(), segment)
    m = len(triangles)
    parts.region = np.pad(parts.region, (0, parts.count - m))
    every = np.arange(m, dtype=np.uint32)
    arrays = (work.xy, work.origin, work.twin, parts.segment, parts.edge_of)
    flips = call(restore_delaunay, 0, m, *arrays, every, size=m)
    work.state[FLIPPED] = flips
    if flips and chosen is not None:  # a triangle is chosen if its middle lies in one that was
        corners = work.xy[work.origin[: 3 * m].reshape(-1, 3)]
        chosen = Locator(points, triangles[chosen]).find(corners.mean(axis=1)) >= 0
    return parts, None if chosen is None else np.pad(chosen, (0, parts.count - m))


def chains_of(mesh: Mesh) -> tuple[np.ndarray, tuple[Names, ...], np.ndarray]:
    """The segments as they were asked for: their ends (rows, 2) and names; and the row of each of ``mesh.segments``.

    Those of its domain; else what ``segment_of`` puts together; else each is one of its own.
    """
    if mesh.domain is not None:
        return mesh.domain.segments.astype(np.int64), mesh.domain.names, mesh.segment_of.astype(np.int64)
    whole = mesh.segment_of.astype(np.int64)
    alone = whole < 0
    _, edge = np.unique(np.sort(mesh.segments, axis=1), axis=0, return_inverse=True)
    whole[alone] = whole.max(initial=-1) + 1 + edge.reshape(-1)[alone]  # an edge that is listed twice is one
    _, row = np.unique(whole, return_inverse=True)
    row = row.reshape(-1)
    k = int(row.max(initial=-1)) + 1
    names: list[tuple[str, ...]] = [()] * k
    for label, rows in mesh.boundaries.items():
        for i in np.unique(row[rows]).tolist():
            names[i] = (*names[i], label)
    ends = np.empty((k, 2), np.int64)
    order = np.argsort(row, kind="stable")
    starts = np.searchsorted(row[order], np.arange(k + 1))
    for i in range(k):
        chain = np.unique(np.sort(mesh.segments[order[starts[i] : starts[i + 1]]], axis=1), axis=0)
        used, times = np.unique(chain, return_counts=True)
        tips = used[times == 1]
        if len(tips) != 2:
            raise MeshError(f"segment_of {i}: its {len(chain)} pieces make no chain from one end to another")
        ends[i] = tips if tips[0] in mesh.segments[order[starts[i] : starts[i + 1]], 0] else tips[::-1]
    return ends, tuple(names), row


def mark_edges(mesh: Mesh, twins: np.ndarray, row: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The sub-segment of each half-edge, (3 m,); and the row of ``chains_of`` that each sub-segment lies on."""
    n = len(mesh.points)
    start, end = mesh.triangles.ravel().astype(np.int64), np.roll(mesh.triangles, -1, axis=1).ravel().astype(np.int64)
    key = np.minimum(start, end) * n + np.maximum(start, end)
    low, high = mesh.segments.min(axis=1, initial=n).astype(np.int64), mesh.segments.max(axis=1, initial=-1).astype(np.int64)
    asked = low * n + high
    order = np.argsort(asked, kind="stable")
    segment = np.zeros(len(key), np.int64)
    if len(asked):
        at = np.minimum(np.searchsorted(asked[order], key), len(asked) - 1)
        found = asked[order][at] == key
        segment[found] = order[at[found]] + 1
    flat = twins.ravel()
    region = np.repeat(mesh.regions, 3)
    border = np.flatnonzero((flat >= 0) & (segment == 0) & (region != region[flat]) & (np.arange(len(flat)) < flat))
    segment[border] = segment[flat[border]] = len(row) + 1 + np.arange(len(border))
    return segment, np.concatenate([[NO_PIECE], row, np.full(len(border), NO_PIECE)]).astype(np.int32)
