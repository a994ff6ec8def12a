"""Where segments cross or overlap: exact signs, on the pairs that a sweep over their extents finds."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.kernel import call, kernel
from fem_mesh.mesh.quality import turn

CROSS, OVERLAP = 1, 2
MOST_MEETINGS = 1_000_000  # more crossings than this are no drawing
ROOM = 4  # meetings a segment that are kept at the first attempt


def find_meetings(points: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """All pairs of segments that cross or overlap: int64 (m, 3), rows (i, j, CROSS or OVERLAP) with i < j, sorted.

    Segments cross where their interiors share one point, and overlap where they share more than one. An
    end that lies on another segment is neither. Takes n log n + p steps, with p pairs of segments whose
    extents overlap along x, y or a diagonal, whichever is least. Raises MeshError beyond a million.

    >>> points = np.array([(0, 0), (2, 2), (2, 0), (0, 2), (1, 1)], float)
    >>> find_meetings(points, np.array([(0, 1), (2, 3), (3, 4)])).tolist()
    [[0, 1, 1], [1, 2, 2]]
    """
    x, y = points[pairs].transpose(2, 0, 1)
    extents = np.array([x, y, x + y, x - y])  # rounding keeps order: who meets in a point overlaps in all of them
    low, high = extents.min(axis=2), extents.max(axis=2)
    sweeps = [_sweep(low[axis], high[axis]) for axis in range(4)]
    axis = min(range(4), key=lambda axis: sweeps[axis][1])
    order, tests = sweeps[axis]
    axes = np.roll(np.arange(4), -axis)
    low, high = low[np.ix_(axes, order)], high[np.ix_(axes, order)]
    room = ROOM * len(pairs) + ROOM
    while True:
        found = np.empty((room, 3), np.int64)
        count = call(list_meetings, points, pairs[order].astype(np.int64), order, low, high, found, size=tests)
        if count <= room:
            break
        if count > MOST_MEETINGS:
            raise MeshError(f"segments cross or overlap {count:,} times, more than {MOST_MEETINGS:,}: is this an outline?")
        room = count
    found = found[:count]
    found[:, :2].sort(axis=1)
    return found[np.lexsort((found[:, 1], found[:, 0]))]


def _sweep(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, int]:
    """The order of a sweep along one axis, and the number of pairs it looks at."""
    order = np.argsort(low, kind="stable")
    last = np.searchsorted(low[order], high[order], side="right")
    return order, int((last - np.arange(1, len(low) + 1)).sum())


@kernel
def list_meetings(points, pairs, order, low, high, found):
    """Note the meetings of segments sorted by ``low[0]``, as far as there is room; returns how many there are."""
    count = 0
    for i in range(len(pairs)):
        a, b, right = pairs[i, 0], pairs[i, 1], high[0, i]
        for j in range(i + 1, len(pairs)):
            if low[0, j] > right:
                break
            if low[1, j] > high[1, i] or high[1, j] < low[1, i]:
                continue
            if low[2, j] > high[2, i] or high[2, j] < low[2, i] or low[3, j] > high[3, i] or high[3, j] < low[3, i]:
                continue
            kind = meeting(points, a, b, pairs[j, 0], pairs[j, 1])
            if kind != 0:
                if count < len(found):
                    found[count, 0], found[count, 1], found[count, 2] = order[i], order[j], kind
                count += 1
    return count


@kernel
def meeting(points, a, b, c, d):
    """How the segments ab and cd meet: CROSS, OVERLAP, or 0: not at all, or in an end of one."""
    abc, abd = turn(points, a, b, c), turn(points, a, b, d)
    if abc == 0 and abd == 0:  # on one line
        for k in range(2):
            left = max(min(points[a, k], points[b, k]), min(points[c, k], points[d, k]))
            right = min(max(points[a, k], points[b, k]), max(points[c, k], points[d, k]))
            if left < right:
                return OVERLAP
        return 0
    if abc * abd < 0 and turn(points, c, d, a) * turn(points, c, d, b) < 0:
        return CROSS
    return 0


def crossing_place(points: np.ndarray, ab: Iterable[int], cd: Iterable[int]) -> tuple[Fraction, Fraction, Fraction]:
    """The share of ab at which it crosses cd, and the point (x, y): exact."""
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = ([Fraction(v) for v in points[p].tolist()] for p in (*ab, *cd))
    ux, uy, vx, vy = bx - ax, by - ay, dx - cx, dy - cy
    share = ((cx - ax) * vy - (cy - ay) * vx) / (ux * vy - uy * vx)
    return share, ax + share * ux, ay + share * uy
