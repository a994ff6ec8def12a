"""The order in which points are inserted: short walks, small cavities, whatever their distribution.

Along a Hilbert curve each point is near the one before, so the walk to it is short. But points that lie
on a curve themselves would then always be inserted at its end, into an ever larger cavity; so they go
in random *rounds*, each some times larger than all before it, and along a Hilbert curve within each
(biased randomised insertion order: Amenta, Choi, Rote 2003).

"Random" is a hash of the point's cell: equal input gives an equal order, whatever its scale, and
duplicates follow each other in the user's order.
"""

from __future__ import annotations

import numpy as np

from fem_mesh.kernel import call, kernel

LEVELS = 16  # the curve visits 2^16 x 2^16 cells
ROUND_BITS = 2  # each round is 2^2 times as large as all before it
LARGEST_RUN = 64  # more points than this in one cell are ordered by a curve of their own
MASK = 0xFFFFFFFF


@kernel
def hilbert(x, y):
    """The rank of cell (x, y) on the Hilbert curve. Bit by bit, each quadrant is entered turned: its
    curve is swapped across the diagonal, or reversed, and the next bits are read that way.
    """
    rank, swap, turn = 0, 0, 0
    for level in range(LEVELS - 1, -1, -1):
        u = ((x >> level) & 1) ^ turn
        v = ((y >> level) & 1) ^ turn
        swapped = (u ^ v) & swap
        u ^= swapped
        v ^= swapped
        rank = rank << 2 | (3 * u ^ v)
        swap ^= v ^ 1
        turn ^= u & (v ^ 1)
    return rank


@kernel
def random_round(x, y, rounds):
    """The round of cell (x, y): the last one most often, each one before it 2^ROUND_BITS times more rarely."""
    bits = (x * 0x9E3779B1 + y * 0x85EBCA6B) & MASK
    bits = ((bits ^ bits >> 15) * 0x2C1B3C6D) & MASK
    bits = ((bits ^ bits >> 12) * 0x297A2D39) & MASK
    bits ^= bits >> 15
    last = rounds - 1
    while last > 0 and bits & (2**ROUND_BITS - 1) == 0:
        bits >>= ROUND_BITS
        last -= 1
    return last


@kernel
def fill_keys(xy, lower_x, lower_y, size, rounds, keys):
    """The sort key of each point: its round, then its cell's rank on the curve."""
    for i in range(len(keys)):
        # 26 bits of the coordinate for the hash, the upper 16 of them for the curve
        x = int((xy[i, 0] - lower_x) / size * 67108863.0)
        y = int((xy[i, 1] - lower_y) / size * 67108863.0)
        keys[i] = random_round(x, y, rounds) << 2 * LEVELS | hilbert(x >> 10, y >> 10)


def insertion_order(points: np.ndarray) -> np.ndarray:
    """The indices of ``points`` (n, 2) in an order that makes incremental insertion fast, as int64 (n,)."""
    rounds = 1 + max(0, len(points).bit_length() - 7) // ROUND_BITS
    return curve_order(points, rounds)


def curve_order(points: np.ndarray, rounds: int = 1) -> np.ndarray:
    """The indices of ``points`` (n, 2) in ``rounds`` along a Hilbert curve, as int64 (n,); equal points stay in order."""
    n = len(points)
    if n == 0:
        return np.empty(0, np.int64)
    keys = _keys(points, rounds)
    bits = n.bit_length()
    if 2 * LEVELS + 5 + bits < 63:  # one sort of (key, index) pairs packed into a word
        keys <<= bits
        keys |= np.arange(n)
        keys.sort()
        order = keys & ((1 << bits) - 1)
        keys >>= bits
    else:
        order = np.argsort(keys, kind="stable")
        keys = keys[order]
    _order_crowded_cells(points, order, keys, rounds)
    return order


def _keys(points: np.ndarray, rounds: int) -> np.ndarray:
    keys = np.empty(len(points), np.int64)
    (left, right), (bottom, top) = ((float(x.min()), float(x.max())) for x in points.T)
    size = max(right - left, top - bottom) or 1.0
    call(fill_keys, points, left, bottom, size, rounds, keys, size=len(points))
    return keys


def _order_crowded_cells(points: np.ndarray, order: np.ndarray, keys: np.ndarray, rounds: int) -> None:
    """Order the points of each crowded cell by a finer curve through that cell, and so on.

    Each turn narrows the cells 2^16-fold, so there are at most some twenty; equal points stay as they are.
    """
    starts = np.flatnonzero(np.concatenate(([True], keys[1:] != keys[:-1])))
    lengths = np.diff(starts, append=len(keys))
    for start, length in zip(starts[lengths > LARGEST_RUN], lengths[lengths > LARGEST_RUN], strict=True):
        members = order[start : start + length]
        cell = points[members]
        if (cell != cell[0]).any():
            order[start : start + length] = members[curve_order(cell, rounds)]
