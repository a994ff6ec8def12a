"""Moving a vertex instead of adding one: Erten, Uengoer 2009.

A bad triangle may be mended by a vertex that was added before, if that finds a place in its *star*, the
triangles around it, where all of them keep the bounds. Each edge around the star asks that the angles at its
two ends be large enough: two half-planes. What all of them leave is convex; its middle is tried.
"""

from __future__ import annotations

from fem_mesh.algorithms.refining.encroachment import CORNERS, COSINE_T, FREE, SINE_T, SPOT_X, SPOT_Y, encroaches, in_range
from fem_mesh.algorithms.refining.steiner import FINE, judge
from fem_mesh.algorithms.refining.worklists import LENS
from fem_mesh.kernel import index, kernel
from fem_mesh.mesh.constrained import dig_from, holds
from fem_mesh.mesh.halfedge import is_right_of, next_edge, prev_edge, triangle_of

MOST_CORNERS = 40  # of each of the two polygons in `limits`
MOST_AROUND = 16  # triangles in a star: each adds at most two corners to the four of the box to begin with
LIMITS = CORNERS + 4 * MOST_CORNERS


@kernel
def find_movable(h, xy, origin, twin, segment, place, label, wanted, bounds, limits, state):
    """Whether a free corner of h's triangle has a better place, which is left in ``limits``; and a half-edge from it."""
    for g in (h, next_edge(h), prev_edge(h)):
        found = place[origin[g]] == FREE and find_place(g, xy, origin, twin, limits)
        if found and is_better(g, xy, origin, twin, segment, label, wanted, bounds, limits, state):
            return True, g
    return False, index(h)


@kernel
def find_place(g, xy, origin, twin, limits):
    """The middle of all places of the vertex that ``g`` leaves which keep the angles at the edges around its star."""
    c, s = limits[COSINE_T], limits[SINE_T]
    n, now = surround_star(g, xy, origin, twin, limits), 0
    f = g
    for _ in range(MOST_AROUND):  # around the star
        a, b = origin[next_edge(f)], origin[prev_edge(f)]
        dx, dy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
        n = clip(now, n, xy[a, 0], xy[a, 1], c * dx - s * dy, s * dx + c * dy, limits)
        n = clip(1 - now, n, xy[b, 0], xy[b, 1], c * dx + s * dy, c * dy - s * dx, limits)
        if n < 3:
            return False
        f = twin[prev_edge(f)]
        if f == g:
            x, y = 0.0, 0.0
            for i in range(CORNERS, CORNERS + 2 * n, 2):
                x += limits[i]
                y += limits[i + 1]
            limits[SPOT_X], limits[SPOT_Y] = in_range(x / n), in_range(y / n)
            return True
    return False


@kernel
def surround_star(g, xy, origin, twin, limits):
    """Begin with a box around the star; returns the number of its corners."""
    v = origin[g]
    left, right, bottom, top = xy[v, 0], xy[v, 0], xy[v, 1], xy[v, 1]
    f = g
    while True:  # once around the vertex
        a = origin[next_edge(f)]
        left, right = min(left, xy[a, 0]), max(right, xy[a, 0])
        bottom, top = min(bottom, xy[a, 1]), max(top, xy[a, 1])
        f = twin[prev_edge(f)]
        if f == g:
            break
    limits[CORNERS], limits[CORNERS + 1], limits[CORNERS + 2], limits[CORNERS + 3] = left, bottom, right, bottom
    limits[CORNERS + 4], limits[CORNERS + 5], limits[CORNERS + 6], limits[CORNERS + 7] = right, top, left, top
    return 4


@kernel
def clip(now, n, px, py, ux, uy, limits):
    """Cut polygon ``now`` (0 or 1) of ``n`` corners to what lies left of the line through p along u, as the other polygon.

    Returns its number of corners (Sutherland, Hodgman 1974).
    """
    source = CORNERS + 2 * MOST_CORNERS * now
    target = CORNERS + 2 * MOST_CORNERS * (1 - now)
    m = 0
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        ax, ay, bx, by = (
            limits[source + 2 * i], limits[source + 2 * i + 1], limits[source + 2 * j], limits[source + 2 * j + 1],
        )  # fmt: skip
        p, q = ux * (ay - py) - uy * (ax - px), ux * (by - py) - uy * (bx - px)
        if p >= 0.0:
            limits[target + 2 * m], limits[target + 2 * m + 1] = ax, ay
            m += 1
        if (p >= 0.0) != (q >= 0.0):
            r = p / (p - q)
            limits[target + 2 * m], limits[target + 2 * m + 1] = ax + r * (bx - ax), ay + r * (by - ay)
            m += 1
    return m


@kernel
def is_better(g, xy, origin, twin, segment, label, wanted, bounds, limits, state):
    """Whether all triangles of the star would keep their bounds, with the vertex that ``g`` leaves in its new place."""
    v = origin[g]
    x, y = xy[v, 0], xy[v, 1]
    xy[v, 0], xy[v, 1] = limits[SPOT_X], limits[SPOT_Y]
    f, better = g, True
    while better:  # once around the vertex
        outer = next_edge(f)
        verdict, _, _ = judge(triangle_of(f), xy, origin, label, bounds, wanted)
        better = verdict == FINE and not is_right_of(outer, xy[v, 0], xy[v, 1], xy, origin)
        if segment[outer] != 0 and encroaches(v, outer, state[LENS], xy, origin, limits):
            better = False
        f = twin[prev_edge(f)]
        if f == g:
            break
    xy[v, 0], xy[v, 1] = x, y
    return better


@kernel
def dig_landing(degree, v, xy, origin, twin, segment, limits, cavity, ring):
    """Put ``v``, which was taken out, into its new place, and dig its cavity; returns the number of triangles.

    The place lies in the hole that ``v`` left, so one of the triangles that fill it is in conflict with it.
    """
    px, py = limits[SPOT_X], limits[SPOT_Y]
    xy[v, 0], xy[v, 1] = px, py
    i = 2
    while not holds(index(3 * cavity[i]), px, py, xy, origin) and i + 1 < degree:
        i += 1
    dug, _ = dig_from(index(3 * cavity[i]), True, 0, 0, px, py, xy, origin, twin, segment, cavity, ring)
    return dug
