"""Where a sub-segment that stands for a curve is split: on the curve, if the way from the chord to it is free."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fem_mesh.algorithms.refining.encroachment import shell
from fem_mesh.domain.curves import as_pair
from fem_mesh.mesh.halfedge import is_ghost_triangle, next_edge
from fem_mesh.mesh.quality import areas, turns_of
from fem_mesh.mesh.segmented import Segmented
from fem_mesh.mesh.validators import do_cross
from fem_mesh.mesh.workspace import SEGMENTS

BULGE = 0.29  # a curve that turns by 60 degrees is nowhere farther from its chord, in lengths of that: tan(30) / 2
HALVINGS = 60  # of an arc, to find a place on it to the last bit
ALL = np.array([[0, 1, 2]])  # the triangle that three points make


def point_on_shell(curve: Any, start: tuple[float, float], end: tuple[float, float]) -> tuple[float, float]:
    """The point of ``curve`` between its points ``start`` and ``end`` whose distance from ``start`` is a power of two."""
    wanted = shell((end[0] - start[0]) ** 2 + (end[1] - start[1]) ** 2) * math.dist(start, end)
    low, high = start, end
    best = as_pair(curve.between(low, high))
    for _ in range(HALVINGS):
        distance = math.dist(start, best)
        if abs(distance - wanted) <= 2.0**-40 * wanted:
            break
        low, high = (best, high) if distance < wanted else (low, best)
        best = as_pair(curve.between(low, high))
    return best


def way_is_free(parts: Segmented, h: int, spot: np.ndarray) -> bool:
    """Whether ``spot``, on the curve of sub-segment ``h``, is near its chord, and nothing lies between.

    Inside the mesh its cavity tells; here what counts is the outside, where another part of the domain may lie.
    """
    work = parts.work
    corners = np.array([work.xy[work.origin[h]], work.xy[work.origin[next_edge(h)]], spot])
    if not np.isfinite(spot).all() or abs(areas(corners, ALL)[0]) > BULGE / 2 * ((corners[1] - corners[0]) ** 2).sum():
        return False
    turn = turns_of(corners, ALL)[0]
    side = h if turn > 0 else int(work.twin[h])
    if turn == 0 or not is_ghost_triangle(side, work.origin):
        return True
    e = parts.edge_of[1 : int(work.state[SEGMENTS]) + 1].astype(np.int64)
    pairs = np.column_stack([work.origin[e], work.origin[np.where(e % 3 == 2, e - 2, e + 1)]])
    ends = work.xy[pairs]
    near = ((ends.min(axis=1) <= corners.max(axis=0)) & (ends.max(axis=1) >= corners.min(axis=0))).all(axis=1)
    own = {int(work.origin[h]), int(work.origin[next_edge(h)])}
    return not any(meets(ends[i], corners, [v in own for v in pairs[i].tolist()]) for i in np.flatnonzero(near))


def meets(segment: np.ndarray, triangle: np.ndarray, own: list[bool]) -> bool:
    """Whether a segment (2, 2) meets a triangle (3, 2) elsewhere than in its ends that are corners of it: exact."""
    points = np.concatenate([triangle, segment])
    if all(own):
        return False
    if turns_of(points, ALL)[0] < 0:
        points[[0, 1]] = points[[1, 0]]
    for v in (3, 4):  # an end in it
        sides = turns_of(points, np.array([[0, 1, v], [1, 2, v], [2, 0, v]]))
        if not own[v - 3] and (sides >= 0).all():
            return True
    for a, b in ((1, 2), (2, 0)):  # the two sides that are new
        if any(own) and (points[[a, b]][:, None] == segment[own]).all(axis=2).any():
            continue  # they share an end, and the other is not in the triangle
        if bool(do_cross(points, 3, 4, a, b)):
            return True
    return False
