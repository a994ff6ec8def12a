"""Carving: what lies outside the domain, or in a hole, goes. As water that comes in from the hull.

    flood from the ghost triangles, and from each hole's seed, and never across a segment

Or, where nobody said where the holes are, by parity: flood everything, and whoever crosses a segment that
closes a loop changes sides. Ends because each triangle is reached once.
"""

from __future__ import annotations

from fem_mesh.kernel import LAST, SETTLED, index, kernel
from fem_mesh.mesh.halfedge import is_ghost_triangle, triangle_of
from fem_mesh.mesh.workspace import COUNT, FLOODED, REACHED

UNKNOWN, OUTSIDE, INSIDE = 0, 1, 2  # what `side` holds
CARVED, CONFLICT = SETTLED + 1, LAST
BY_PARITY, BY_SEEDS = 1, 2


@kernel
def flood(origin, twin, segment, parity, side, queue, rule, state):
    """``side[t]`` becomes OUTSIDE or INSIDE. The triangles reached wait in ``queue``, first in, first out."""
    while state[FLOODED] < state[REACHED]:
        t = queue[state[FLOODED]]
        state[FLOODED] += 1
        for k in range(3):
            h = index(3 * t + k)
            g = triangle_of(twin[h])
            s = segment[h]
            if s != 0 and rule[0] == BY_SEEDS:
                continue
            other = side[t] if s == 0 or parity[s] == 0 else OUTSIDE + INSIDE - side[t]
            if side[g] == UNKNOWN:
                side[g] = other
                queue[state[REACHED]] = g
                state[REACHED] += 1
            elif side[g] != other:
                yield CONFLICT, s
                return
        if side[t] == OUTSIDE and not is_ghost_triangle(index(3 * t), origin):
            yield CARVED, t


@kernel
def flood_from_ghosts(origin, side, queue, state):
    """Every ghost triangle is outside, and has been reached."""
    for t in range(state[COUNT]):
        if is_ghost_triangle(index(3 * t), origin):
            side[t] = OUTSIDE
            queue[state[REACHED]] = t
            state[REACHED] += 1
