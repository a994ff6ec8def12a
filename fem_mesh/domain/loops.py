"""Which segments lead from outside to inside, and how deep loops lie in each other.

Segments form a graph on their end points. Its *blocks* are the largest parts that no single vertex cuts
in two (Hopcroft and Tarjan 1973). A block of one segment lies on no closed loop: a crack, an open chain,
a bridge. Every other block is made of loops, and who crosses one changes sides.
"""

from __future__ import annotations

import functools

import numpy as np

from fem_mesh.kernel import call, kernel
from fem_mesh.predicates import orient_sign


def find_toggling(pairs: np.ndarray, times: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Which of the segments ``pairs`` (k, 2), given ``times`` (k,) times each, change sides: bool (k,).

    All of a block, if then each vertex has an even number of them, as in a closed loop; else those given an
    odd number of times, if that does it (two loops that share a side). Where neither does, loops are
    divided by further segments, and :func:`find_outline` tells: the second array has the block of these
    segments, -1 for all others.
    """
    block, count = find_blocks(pairs, n)
    on_loop = np.bincount(block, minlength=count)[block] > 1
    odd = _have_odd_vertices(pairs, block, on_loop, n, count)
    chosen = on_loop & (~odd[block] | (times % 2 == 1))
    divided = _have_odd_vertices(pairs, block, chosen, n, count)
    return chosen & ~divided[block], np.where(on_loop & divided[block], block, -1)


def _have_odd_vertices(pairs: np.ndarray, block: np.ndarray, chosen: np.ndarray, n: int, count: int) -> np.ndarray:
    """Whether some vertex has an odd number of the chosen segments of a block: bool, one a block."""
    keys = (block[chosen, None] * n + pairs[chosen]).ravel()
    keys, degree = np.unique(keys, return_counts=True)
    odd = np.zeros(count, bool)
    odd[keys[degree % 2 == 1] // max(n, 1)] = True
    return odd


def find_blocks(pairs: np.ndarray, n: int) -> tuple[np.ndarray, int]:
    """The block of each segment, int64 (k,), and their number. No two ``pairs`` may join the same vertices.

    >>> find_blocks(np.array([(0, 1), (1, 2), (2, 0), (2, 3)]), 4)[0].tolist()  # a triangle, and a segment at its corner
    [1, 1, 1, 0]
    """
    k = len(pairs)
    starts = pairs.T.ravel()
    order = np.argsort(starts, kind="stable")  # the segments at each vertex, one after the other
    first = np.searchsorted(starts[order], np.arange(n + 1))
    other, row = pairs[:, ::-1].T.ravel()[order], order % max(k, 1)
    block, opened = np.full(k, -1), np.zeros(k, np.int64)
    depth, low, entry, path = (np.zeros(n, np.int64) for _ in range(4))
    arrays = (first, other, row, first[:-1].copy(), depth, low, entry, path, opened, block)
    return block, call(number_blocks, *arrays, size=k)


@kernel
def number_blocks(first, other, row, cursor, depth, low, entry, path, opened, block):
    """Depth-first search: ``low[v]`` is the least depth that the segments below v reach. Where they do not
    reach above u, u separates them from the rest, and the segments opened since form a block.
    """
    count, waiting = 0, 0
    for root in range(len(depth)):
        if depth[root] > 0 or first[root] == first[root + 1]:
            continue
        top = 1
        path[0], depth[root], low[root], entry[root] = root, 1, 1, -1
        while top > 0:  # each turn takes one segment at v, or leaves v
            v = path[top - 1]
            if cursor[v] < first[v + 1]:
                w, r = other[cursor[v]], row[cursor[v]]
                cursor[v] += 1
                if r == entry[v] or depth[w] >= depth[v]:  # the way we came; or seen from its other end
                    continue
                opened[waiting] = r
                waiting += 1
                if depth[w] > 0:
                    low[v] = min(low[v], depth[w])
                else:
                    path[top], depth[w], low[w], entry[w] = w, depth[v] + 1, depth[v] + 1, r
                    top += 1
                continue
            top -= 1
            if top == 0:
                break
            u = path[top - 1]
            low[u] = min(low[u], low[v])
            if low[v] >= depth[u]:
                last = -1
                while last != entry[v]:
                    waiting -= 1
                    last = opened[waiting]
                    block[last] = count
                count += 1
    return count


def find_outline(points: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """The segments around the outside of a connected, uncrossed drawing: bool (k,). Exact.

    Walks with the outer face on its right: at each vertex it takes the next segment counter-clockwise
    from the one it came by. A segment walked along on both its sides bounds nothing.

    >>> points = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
    >>> find_outline(points, np.array([(0, 1), (1, 2), (2, 3), (3, 0), (0, 2)])).tolist()
    [True, True, True, True, False]
    """
    if not len(pairs):
        return np.zeros(0, bool)
    xy = points.tolist()
    fan: dict[int, list[tuple[int, int]]] = {}
    for row, (a, b) in enumerate(pairs.tolist()):
        fan.setdefault(a, []).append((b, row))
        fan.setdefault(b, []).append((a, row))
    for v, around in fan.items():
        around.sort(key=functools.cmp_to_key(functools.partial(_comes_first, xy, v)))
    v = min(fan, key=lambda v: xy[v])  # the leftmost: the outer face lies to its left
    below = [spoke for spoke in fan[v] if xy[spoke[0]][1] < xy[v][1]]
    start = (v, *(below or fan[v])[0])
    walked = [0] * len(pairs)
    v, w, row = start
    for _ in range(2 * len(pairs)):
        walked[row] += 1
        i = fan[w].index((v, row))
        v, (w, row) = w, fan[w][(i + 1) % len(fan[w])]
        if (v, w, row) == start:
            break
    return np.asarray(np.array(walked) == 1)


def _comes_first(xy: list[list[float]], v: int, p: tuple[int, int], q: tuple[int, int]) -> int:
    """< 0 if the neighbour p comes before q, counter-clockwise around v from the direction of the x axis."""
    p_below, q_below = ((xy[r][1], xy[r][0]) < (xy[v][1], xy[v][0]) for r, _ in (p, q))
    turn = orient_sign(*xy[v], *xy[p[0]], *xy[q[0]])
    return p_below - q_below or (turn < 0) - (turn > 0)


# ---- nesting -----------------------------------------------------------------------------------------


def depths_of(loops: list[np.ndarray]) -> list[int]:
    """How many of the other closed ``loops``, each (n, 2), lie around each one. Exact; loops may touch.

    >>> outer, inner = np.array([(0, 0), (9, 0), (0, 9)], float), np.array([(1, 1), (2, 1), (1, 2)], float)
    >>> depths_of([inner, outer])
    [1, 0]
    """
    low = np.array([loop.min(axis=0) for loop in loops]).reshape(-1, 2)
    high = np.array([loop.max(axis=0) for loop in loops]).reshape(-1, 2)
    depths = []
    for i, loop in enumerate(loops):
        around = ((low <= low[i]) & (high >= high[i])).all(axis=1)
        around[i] = False
        depths.append(sum(_lies_within(loop, loops[j]) for j in np.flatnonzero(around)))
    return depths


def _lies_within(loop: np.ndarray, other: np.ndarray) -> bool:
    """Whether the first point of ``loop`` that is not on ``other`` lies inside it."""
    middles = (loop + np.roll(loop, -1, axis=0)) / 2
    for x, y in np.concatenate([loop, middles]).tolist():
        side = call(side_of_loop, other, x, y, size=len(other))
        if side != 0:
            return bool(side > 0)
    return False


@kernel
def side_of_loop(xy, x, y):
    """1 if (x, y) lies inside the closed loop, by parity; -1 outside, 0 on it: crossings of the ray to its right."""
    inside = False
    for i in range(len(xy)):
        j = (i + 1) % len(xy)
        ax, ay, bx, by = xy[i, 0], xy[i, 1], xy[j, 0], xy[j, 1]
        if max(ay, by) < y or min(ay, by) > y or max(ax, bx) < x:
            continue
        side = orient_sign(ax, ay, bx, by, x, y)
        if side == 0.0 and min(ax, bx) <= x:
            return 0
        if (ay <= y) != (by <= y) and (side > 0.0) == (by > ay):
            inside = not inside
    return 1 if inside else -1
