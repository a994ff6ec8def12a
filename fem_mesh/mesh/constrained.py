"""Half-edges some of which are *segments*: edges that must stay, and beyond which no triangle sees.

Sub-segment ``s`` (from 1; 0 is none) marks both its half-edges, ``segment[h] = s``, and ``edge_of[s]`` is one
of them. A triangulation is *constrained Delaunay* if no triangle's circle holds a vertex that can be seen
from inside the triangle; it is enough that this is so across each edge that is no segment (Lee, Lin 1986).
"""

from __future__ import annotations

from fem_mesh.kernel import index, inlined_kernel, kernel
from fem_mesh.mesh.halfedge import (
    GHOST,
    flip,
    is_ghost,
    is_ghost_triangle,
    is_right_of,
    link,
    next_edge,
    place_triangle,
    prev_edge,
    triangle_of,
)
from fem_mesh.predicates import in_circle_sign, orient_sign


@inlined_kernel
def holds(h, px, py, xy, origin):
    """Whether p lies strictly inside the circle of h's triangle, which is no ghost."""
    a, b, c = origin[h], origin[next_edge(h)], origin[prev_edge(h)]
    return in_circle_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1], px, py) > 0.0


@kernel
def mark(h, s, twin, segment, edge_of):
    """Make the edge of ``h`` the sub-segment ``s``."""
    segment[h] = s
    segment[twin[h]] = s
    edge_of[s] = h


# ---- cavities that end at segments -----------------------------------------------------------------


@inlined_kernel
def dig_from(h, across, dug, around, px, py, xy, origin, twin, segment, cavity, ring):
    """Dig h's triangle, and all in conflict with p that it reaches without crossing a segment.

    Does not look across ``h`` itself unless ``across``. Adds to the ``dug`` triangles in ``cavity`` and the
    ``around`` half-edges in ``ring``, counter-clockwise; returns the new numbers. Star-shaped as seen from p, as
    ``halfedge.dig_cavity``, up to the segments.
    """
    h = index(h)
    cavity[dug] = triangle_of(h)
    dug += 1
    top = len(ring)
    ring[top - 1], ring[top - 2] = prev_edge(h), next_edge(h)
    top -= 2
    if across:
        top -= 1
        ring[top] = h
    while top < len(ring):  # each turn pops one edge; every triangle pushes its edges once
        g = twin[ring[top]]
        top += 1
        if segment[g] == 0 and holds(g, px, py, xy, origin):
            cavity[dug] = triangle_of(g)
            dug += 1
            ring[top - 1], ring[top - 2] = prev_edge(g), next_edge(g)
            top -= 2
        else:
            ring[around] = g
            around += 1
    return dug, around


@kernel
def dig_side(h, dug, around, px, py, xy, origin, twin, segment, cavity, ring):
    """Dig on the side of sub-segment ``h`` for a point p that is to split it.

    A ghost goes alone. Where p lies beyond ``h`` its triangle may stay, and then joins p as another; else it
    goes, and must be in conflict. Returns the new numbers, (-1, -1) where it is not.
    """
    if is_ghost_triangle(h, origin):
        cavity[dug] = triangle_of(h)
        ring[around], ring[around + 1] = twin[next_edge(h)], twin[prev_edge(h)]
        return dug + 1, around + 2
    if not holds(h, px, py, xy, origin):
        if not is_right_of(h, px, py, xy, origin):
            return -1, -1
        ring[around] = h
        return dug, around + 1
    return dig_from(h, False, dug, around, px, py, xy, origin, twin, segment, cavity, ring)


@kernel
def sees_ring(first, around, px, py, xy, origin, ring):
    """Whether every edge of the ring from ``first`` on has p strictly inside, so that the fan is made of triangles."""
    for i in range(first, around):
        a, b = origin[next_edge(ring[i])], origin[ring[i]]
        if not (is_ghost(a) or is_ghost(b)) and orient_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py) <= 0.0:
            return False
    return True


@inlined_kernel
def fan_around(p, triangles, origin, twin, segment, edge_of, cavity, ring):
    """Join ``p`` to each edge of the ring; the ``triangles`` new ones take the slots that ``cavity`` lists."""
    last = index(3 * cavity[triangles - 1])
    for i in range(triangles):
        g = ring[i]
        h = place_triangle(origin, cavity[i], origin[next_edge(g)], origin[g], p)
        link(twin, g, h)
        link(twin, index(h + 2), index(last + 1))
        s = segment[g]
        segment[h], segment[h + 1], segment[h + 2] = s, 0, 0
        if s != 0:
            edge_of[s] = g
        last = h


@kernel
def mark_spoke(a, s, triangles, origin, twin, segment, edge_of, cavity):
    """Make the edge from ``a`` to the centre of the fan the sub-segment ``s``."""
    for i in range(triangles):
        h = index(3 * cavity[i])
        if origin[h] == a:
            mark(index(h + 2), s, twin, segment, edge_of)


# ---- flips that keep segments ----------------------------------------------------------------------


@kernel
def flip_beside_segments(h, origin, twin, segment, edge_of):
    """``halfedge.flip`` of an edge that is no segment; the marks of the edges around it move along."""
    g = twin[h]
    hp, gp = prev_edge(h), prev_edge(g)
    s, r = segment[gp], segment[hp]
    flip(h, origin, twin)
    segment[h], segment[g], segment[hp], segment[gp] = s, r, 0, 0
    if s != 0:
        edge_of[s] = h
    if r != 0:
        edge_of[r] = g


@kernel
def restore_delaunay(first, last, xy, origin, twin, segment, edge_of, triangles):
    """Flip until every edge of the ``triangles[first:last]`` is locally Delaunay or a segment; returns the flips.

    Each flip lowers the surface of the lifted triangles (see ``lawson``), so the sweeps end.
    """
    flips, before = 0, -1
    while flips > before:
        before = flips
        for i in range(3 * first, 3 * last):
            h = index(3 * triangles[i // 3] + i % 3)
            if h < twin[h] and is_illegal(h, xy, origin, twin, segment):
                flip_beside_segments(h, origin, twin, segment, edge_of)
                flips += 1
    return flips


@kernel
def is_illegal(h, xy, origin, twin, segment):
    """Whether the circle of h's triangle holds the vertex across ``h``, which is no segment."""
    g = twin[h]
    if segment[h] != 0 or is_ghost_triangle(h, origin) or is_ghost_triangle(g, origin):
        return False
    v = origin[prev_edge(g)]
    return holds(h, xy[v, 0], xy[v, 1], xy, origin)


@kernel
def remove_free_vertex(h, xy, origin, twin, segment, edge_of, cavity):
    """Take out the vertex that ``h`` leaves, which is on no segment and not on the hull.

    Its edges are flipped away until it has three, its last three triangles become one, and the hole is made
    Delaunay again. Returns how many triangles it had: the first two that ``cavity`` lists are free, the others
    fill the hole.
    """
    degree, first = 0, index(h)
    while True:  # once around the vertex
        cavity[degree] = triangle_of(h)
        degree += 1
        h = twin[prev_edge(h)]
        if h == first:
            break
    left = degree
    while left > 3:  # a star-shaped polygon always has an ear that its centre is not in; it may be on its base
        g = next_edge(h)  # before the flip of h: v -> b
        a, v, b, c = origin[prev_edge(twin[h])], origin[h], origin[g], origin[prev_edge(h)]
        if (
            orient_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1]) > 0.0
            and orient_sign(xy[a, 0], xy[a, 1], xy[c, 0], xy[c, 1], xy[v, 0], xy[v, 1]) >= 0.0
        ):
            after = twin[prev_edge(h)]
            flip_beside_segments(h, origin, twin, segment, edge_of)
            h = after
            left -= 1
        else:
            h = twin[prev_edge(h)]
    close_last_three(h, origin, twin, segment, edge_of, cavity, degree)
    restore_delaunay(2, degree, xy, origin, twin, segment, edge_of, cavity)
    return degree


@kernel
def close_last_three(h, origin, twin, segment, edge_of, cavity, degree):
    """Replace the three triangles around the vertex that ``h`` leaves by one; the two free ones go first in ``cavity``."""
    keep = triangle_of(h)
    second = twin[prev_edge(h)]
    third = twin[prev_edge(second)]
    outer1, outer2, outer3 = twin[next_edge(h)], twin[next_edge(second)], twin[next_edge(third)]
    e = place_triangle(origin, keep, origin[next_edge(h)], origin[next_edge(second)], origin[next_edge(third)])
    for k in range(3):
        g = outer1 if k == 0 else outer2 if k == 1 else outer3
        link(twin, index(e + k), g)
        segment[e + k] = segment[g]
        if segment[g] != 0:
            edge_of[segment[g]] = g
    free = 0
    for i in range(degree):
        t = cavity[i]
        if t == triangle_of(second) or t == triangle_of(third):
            cavity[i] = cavity[free]
            cavity[free] = t
            free += 1
            place_triangle(origin, t, GHOST, GHOST, GHOST)


@kernel
def close_boundaries(boundary, m, origin, twin):
    """Put a ghost triangle, in the slots from ``m`` on, outside each boundary half-edge, whose twin is itself.

    Two ghosts are neighbours if a turn around their common vertex, through triangles, leads from one to the other.
    """
    for i in range(len(boundary)):
        h = index(boundary[i])
        place_triangle(origin, m + i, origin[next_edge(h)], origin[h], GHOST)
        twin[h] = 3 * (m + i)
    for i in range(len(boundary)):
        g, h = index(3 * (m + i)), index(boundary[i])
        twin[g] = h
        f = prev_edge(h)
        while twin[f] < 3 * m:  # to the boundary half-edge that ends where h starts
            f = prev_edge(twin[f])
        link(twin, index(g + 1), index(twin[f] + 2))
