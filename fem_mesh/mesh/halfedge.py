"""Connectivity: triangles as half-edges in two flat arrays, and what can be done to them.

Triangle ``t`` owns the half-edges ``3t, 3t + 1, 3t + 2``, counter-clockwise::

                 c                 origin[3t]     = a      the vertex that a half-edge leaves
               /   \\               origin[3t + 1] = b
       3t + 2 /  t  \\ 3t + 1       origin[3t + 2] = c
             /       \\
            a ------- b            twin[h]: the half-edge on the other side of h, in the
               3t                  neighbouring triangle, running the other way

Vertex ``v`` is row ``v`` of ``xy``; row 0 is the *ghost vertex*, a vertex at infinity. Every hull edge
has a ghost triangle outside it, so each half-edge has a twin and no algorithm needs a case for the hull.
The circle of a ghost triangle is the open half-plane outside its hull edge, and the open edge itself.
"""

from __future__ import annotations

from fem_mesh.kernel import index, inlined_kernel, kernel
from fem_mesh.predicates import in_circle_sign, in_diametral_circle_sign, orient_sign

GHOST = 0


@kernel
def is_ghost(v):
    return v == GHOST


@kernel
def next_edge(h):
    """The half-edge after ``h`` in its triangle, counter-clockwise."""
    return index(h - 2 if h % 3 == 2 else h + 1)


@kernel
def prev_edge(h):
    """The half-edge before ``h`` in its triangle."""
    return index(h + 2 if h % 3 == 0 else h - 1)


@kernel
def triangle_of(h):
    return index(h // 3)


@kernel
def link(twin, g, h):
    """Make ``g`` and ``h`` twins."""
    twin[g] = h
    twin[h] = g


@kernel
def place_triangle(origin, t, a, b, c):
    """Write abc into the slot of triangle ``t``; returns its first half-edge, which leaves a."""
    h = index(3 * t)
    origin[h] = a
    origin[h + 1] = b
    origin[h + 2] = c
    return h


@kernel
def ghost_edge(h, origin):
    """The half-edge of h's triangle that faces its ghost vertex; ``h`` itself if there is none."""
    if is_ghost(origin[h]):
        return next_edge(h)
    if is_ghost(origin[next_edge(h)]):
        return prev_edge(h)
    return h


@kernel
def is_ghost_triangle(h, origin):
    """Whether the triangle of half-edge ``h`` lies outside the hull."""
    return is_ghost(origin[h]) or is_ghost(origin[next_edge(h)]) or is_ghost(origin[prev_edge(h)])


@kernel
def start_triangulation(xy, origin, twin, a, b, c):
    """The first triangle abc, made counter-clockwise, and its three ghost triangles: slots 0 to 3."""
    if orient_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1]) < 0.0:
        b, c = c, b
    place_triangle(origin, 0, a, b, c)
    place_triangle(origin, 1, b, a, GHOST)
    place_triangle(origin, 2, c, b, GHOST)
    place_triangle(origin, 3, a, c, GHOST)
    for k in range(3):  # the ghost of edge k lies outside it; its neighbours are the other ghosts
        link(twin, index(k), index(3 * (k + 1)))
        link(twin, index(3 * (k + 1) + 2), index(3 * ((k + 1) % 3 + 1) + 1))


# ---- where a point lies ----------------------------------------------------------------------------


@kernel
def is_right_of(h, px, py, xy, origin):
    """Whether p lies strictly to the right of half-edge ``h``, outside its triangle."""
    a, b = origin[h], origin[next_edge(h)]
    return orient_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py) < 0.0


@inlined_kernel
def locate(h, px, py, xy, origin, twin):
    """Walk from the triangle of ``h`` to p, always across an edge that has p beyond it.

    Returns a half-edge of the triangle that p lies in or on, or of a ghost triangle if p lies outside
    the hull; and the number of triangles crossed. In a Delaunay triangulation each triangle on the way
    has a smaller power with respect to p, so the walk ends (Edelsbrunner 1990).
    """
    h = ghost_edge(h, origin)
    if is_ghost_triangle(h, origin):
        h = twin[h]
    if is_right_of(h, px, py, xy, origin):
        h = twin[h]
    steps = 0
    while not is_ghost_triangle(h, origin):  # p is not right of h, where the walk came in
        if is_right_of(next_edge(h), px, py, xy, origin):
            h = twin[next_edge(h)]
        elif is_right_of(prev_edge(h), px, py, xy, origin):
            h = twin[prev_edge(h)]
        else:
            return h, steps
        steps += 1
    return h, steps


@kernel
def vertex_at(h, px, py, xy, origin):
    """The corner of h's triangle that has exactly the coordinates of p, or the ghost vertex."""
    for g in (h, next_edge(h), prev_edge(h)):
        v = origin[g]
        if not is_ghost(v) and xy[v, 0] == px and xy[v, 1] == py:
            return v
    return index(GHOST)


@inlined_kernel
def in_conflict(h, px, py, xy, origin):
    """Whether p lies strictly inside the circle of h's triangle (for a ghost: beyond its hull edge)."""
    a, b, c = origin[h], origin[next_edge(h)], origin[prev_edge(h)]
    if is_ghost(a) or is_ghost(b) or is_ghost(c):
        return is_beyond(ghost_edge(h, origin), px, py, xy, origin)
    return in_circle_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1], px, py) > 0.0


@kernel
def is_beyond(h, px, py, xy, origin):
    """Whether p lies strictly left of ``h``, the hull edge of a ghost triangle, or on the open edge."""
    return is_beyond_edge(origin[h], origin[next_edge(h)], px, py, xy)


@kernel
def is_beyond_edge(a, b, px, py, xy):
    side = orient_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py)
    if side != 0.0:
        return side > 0.0
    return in_diametral_circle_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], px, py) > 0.0


# ---- changes ---------------------------------------------------------------------------------------


@inlined_kernel
def dig_cavity(h, px, py, xy, origin, twin, cavity, ring):
    """Collect the triangles in conflict with p, and the half-edges around them seen from outside.

    The cavity is star-shaped as seen from p and no vertex lies within it, so it is a tree of
    triangles: a depth-first search needs no marks, and meets its ``ring`` in counter-clockwise order.
    Returns the number of triangles; the ring has two edges more.
    """
    h = index(h)
    cavity[0] = triangle_of(h)
    dug, around = 1, 0
    # The far end of `ring` serves as the stack: triangles dug, edges around and edges to visit
    # together never exceed its length.
    top = len(ring)
    ring[top - 1], ring[top - 2], ring[top - 3] = prev_edge(h), next_edge(h), h
    top -= 3
    while top < len(ring):  # each turn pops one edge; every triangle pushes its edges once
        g = twin[ring[top]]
        top += 1
        if in_conflict(g, px, py, xy, origin):
            cavity[dug] = triangle_of(g)
            dug += 1
            ring[top - 1], ring[top - 2] = prev_edge(g), next_edge(g)
            top -= 2
        else:
            ring[around] = g
            around += 1
    return dug


@inlined_kernel
def fan_cavity(p, count, dug, origin, twin, cavity, ring):
    """Replace the cavity by triangles from ``p`` to each edge of its ring.

    They take the slots of the cavity and the two slots from ``count`` on; ``cavity`` then lists them.
    """
    cavity[dug], cavity[dug + 1] = index(count), index(count + 1)
    last = index(3 * cavity[dug + 1])
    for i in range(dug + 2):
        g = ring[i]
        h = place_triangle(origin, cavity[i], origin[next_edge(g)], origin[g], p)
        link(twin, g, h)
        link(twin, index(h + 2), index(last + 1))
        last = h


@kernel
def flip(h, origin, twin):
    r"""Replace the edge of ``h`` by the other diagonal, cd, of its two triangles; returns its half-edge at c.

    ::
              c                    c
            / ^ \                /   \
          /   |   \            /   h   \        h: a -> b becomes d -> b
        d   g | h   ...      d --------- b      g: b -> a becomes c -> a
          \   |   /            \   g   /
            \ | /                \   /
              a                    a
    """
    g = twin[h]
    hp, gp = prev_edge(h), prev_edge(g)
    c, d = origin[hp], origin[gp]
    link(twin, h, twin[gp])
    link(twin, g, twin[hp])
    link(twin, hp, gp)
    origin[h], origin[g] = d, c
    return hp
