"""Small angles of the input: where they are, and which triangles they excuse."""

from __future__ import annotations

import numpy as np

from fem_mesh.algorithms.refining.encroachment import CORNER, SHARP
from fem_mesh.algorithms.refining.steiner import FINE, SKINNY, is_excused, judge
from fem_mesh.kernel import call, index, kernel
from fem_mesh.mesh.halfedge import is_ghost_triangle, next_edge, prev_edge
from fem_mesh.mesh.segmented import Segmented
from fem_mesh.mesh.workspace import SEGMENTS


def classify_vertices(parts: Segmented, curved: np.ndarray) -> np.ndarray:
    """What ``place`` holds of each vertex given: see encroachment.py."""
    work, count = parts.work, int(parts.work.state[SEGMENTS])
    place = np.full(len(work.xy), CORNER, np.int32)
    h = parts.edge_of[1 : count + 1].astype(np.int64)
    pairs = np.concatenate([work.origin[h], work.origin[np.where(h % 3 == 2, h - 2, h + 1)]])
    piece = np.tile(parts.piece_of[1 : count + 1], 2)
    low, high = np.full(len(place), len(parts.ends) + 1, np.int32), np.full(len(place), -1, np.int32)
    np.minimum.at(low, pairs, piece)
    np.maximum.at(high, pairs, piece)
    within = (low == high) & (low >= 0)
    within[parts.ends.ravel()] = False
    place[within] = low[within] + 1
    arrays = (work.xy, work.origin, work.twin, parts.segment, parts.piece_of, curved, place)
    call(find_sharp_corners, *arrays, parts.count, size=parts.count)
    return place


@kernel
def find_sharp_corners(xy, origin, twin, segment, piece_of, curved, place, count):
    """Mark the corners where two sub-segments, with only triangles between them, meet at less than 60 degrees.

    A curve leaves its chord at up to 30 degrees: then less than 90, or 120, by the chords may be so little. Where it is
    not, to be split at powers of two does no harm.
    """
    for i in range(3 * count):
        h = index(i)
        if segment[h] == 0 or is_ghost_triangle(h, origin) or place[origin[h]] > 0:
            continue
        g = prev_edge(h)
        while segment[g] == 0:  # counter-clockwise around the corner; each boundary edge is a segment
            g = prev_edge(twin[g])
        a, b, c = origin[h], origin[next_edge(h)], origin[g]
        bx, by, cx, cy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1], xy[c, 0] - xy[a, 0], xy[c, 1] - xy[a, 1]
        dot, quarter = bx * cx + by * cy, 0.25 * (bx * bx + by * by) * (cx * cx + cy * cy)
        curves = int(curved[piece_of[segment[h]]]) + int(curved[piece_of[segment[g]]])
        sharp = dot > 0.0 and (curves > 0 or dot * dot > quarter)
        sharp = sharp or (curves == 2 and dot * dot < quarter)
        if bx * cy > by * cx and sharp:
            place[a] = SHARP


@kernel
def list_left(xy, origin, segment, place, ends, label, wanted, limit, count, left, excused):
    """List the triangles that miss a bound, and whether a small angle of the input excuses it; returns how many."""
    k = 0
    for t in range(count):
        if is_ghost_triangle(index(3 * t), origin):
            continue
        verdict, h, _ = judge(index(t), xy, origin, label, limit, wanted)
        if verdict != FINE:
            left[k] = t
            excused[k] = verdict == SKINNY and is_excused(h, xy, origin, segment, place, ends)
            k += 1
    return k
