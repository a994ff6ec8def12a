"""Taking a vertex out again, and filling the hole with Delaunay triangles.

    while the hole has more than three corners:
        cut off an ear: a corner whose circle holds no other corner
    the rest is the last triangle

Ears with the ghost vertex follow the same rule, so hull vertices need no case. Each turn cuts one ear, so
it ends. Quadratic in the vertex's degree, in the worst case cubic (Devillers 1999 does better; degrees
are about 6).
"""

from __future__ import annotations

from fem_mesh.kernel import index, kernel
from fem_mesh.mesh.halfedge import (
    GHOST,
    is_beyond_edge,
    is_ghost,
    is_ghost_triangle,
    link,
    next_edge,
    place_triangle,
    prev_edge,
    triangle_of,
)
from fem_mesh.predicates import in_circle_sign, orient_sign


@kernel
def remove_vertex(h, count, xy, origin, twin, cavity, ring):
    """Remove the vertex that ``h`` leaves. The slots ``count - 2`` and ``count - 1`` are free afterwards.

    Returns False, and changes nothing, if no triangle would be left.
    """
    k = collect_ring(h, origin, twin, cavity, ring)
    if leaves_only_a_line(k, xy, origin, ring):
        return False
    used = 0
    while k > 3:  # each turn cuts one corner
        i = find_ear(k, xy, origin, ring)
        g, f = ring[i], ring[(i + 1) % k]  # seen from outside: b -> a and c -> b
        t = cavity[used]
        e = place_triangle(origin, t, origin[next_edge(g)], origin[g], origin[f])
        link(twin, e, g)
        link(twin, index(e + 1), f)
        used += 1
        ring[i] = index(e + 2)
        for j in range((i + 1) % k, k - 1):
            ring[j] = ring[j + 1]
        k -= 1
    g, f = ring[0], ring[1]
    e = place_triangle(origin, cavity[used], origin[next_edge(g)], origin[g], origin[f])
    for j in range(3):
        link(twin, index(e + j), ring[j])
    release_slots(count, used + 1, origin, twin, cavity)
    return True


@kernel
def collect_ring(h, origin, twin, cavity, ring):
    """List the triangles around the vertex that ``h`` leaves, and the half-edges around them seen from outside."""
    k, first = 0, h
    while True:  # once around the vertex
        cavity[k] = triangle_of(h)
        ring[k] = twin[next_edge(h)]
        k += 1
        h = twin[prev_edge(h)]
        if h == first:
            return k


@kernel
def find_ear(k, xy, origin, ring):
    """An index i such that the corner between ring edges i and i + 1 may be cut off."""
    for i in range(k):
        a, b, c = origin[next_edge(ring[i])], origin[ring[i]], origin[ring[(i + 1) % k]]
        if is_ear(a, b, c, k, xy, origin, ring):
            return i
    return -1  # never: a Delaunay triangulation of the hole exists, and has an ear


@kernel
def is_ear(a, b, c, k, xy, origin, ring):
    while is_ghost(a) or is_ghost(b):  # at most two turns: bring a ghost to the end
        a, b, c = b, c, a
    if not is_ghost(c) and orient_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1]) <= 0.0:
        return False
    for j in range(k):
        v = origin[ring[j]]
        if is_ghost(v) or v in (a, b, c):
            continue
        if is_ghost(c):
            if is_beyond_edge(a, b, xy[v, 0], xy[v, 1], xy):
                return False
        elif in_circle_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1], xy[v, 0], xy[v, 1]) > 0.0:
            return False
    return True


@kernel
def leaves_only_a_line(k, xy, origin, ring):
    """Whether only ghost triangles surround the hole, and its corners lie on one line."""
    for i in range(k):
        if not is_ghost_triangle(ring[i], origin):
            return False
    a, b = index(GHOST), index(GHOST)
    for i in range(k):
        v = origin[ring[i]]
        if is_ghost(v):
            continue
        if is_ghost(a):
            a = v
        elif is_ghost(b):
            b = v
        elif orient_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[v, 0], xy[v, 1]) != 0.0:
            return False
    return True


@kernel
def release_slots(count, used, origin, twin, cavity):
    """Free the last two slots: the triangles in them move into the two slots of the cavity left over."""
    low, high = cavity[used], cavity[used + 1]
    if low > high:
        low, high = high, low
    move_triangle(index(count - 1), high, origin, twin)
    move_triangle(index(count - 2), low, origin, twin)


@kernel
def move_triangle(source, target, origin, twin):
    """Move a triangle to a free slot."""
    if source == target:
        return
    for j in range(3):
        h = index(3 * target + j)
        origin[h] = origin[3 * source + j]
        link(twin, h, twin[3 * source + j])
