"""Forcing segments through a triangulation: Chew 1989; the chains as in Anglada 1997.

    for each segment uv:
        walk from u towards v, to the next vertex w on the segment
        if the edge uw is there: it is a sub-segment
        else: the edges crossed by uw go, and leave a hole on either side of it;
            fill each hole: join its base to the vertex whose circle holds no other of them, and go on
            with the two smaller holes beside that triangle

Before and after each piece the triangulation is constrained Delaunay: other triangles than those crossed
see less than before, and no more. Every vertex of a hole sees its base through an edge that was crossed;
so it lies strictly on the inner side of the base, and the empty circle gives a triangle that nothing cuts.
Ends because each turn reaches a further vertex of a segment, and each triangle leaves smaller holes.
"""

from __future__ import annotations

from fem_mesh.kernel import LAST, SETTLED, index, kernel
from fem_mesh.mesh.constrained import mark
from fem_mesh.mesh.halfedge import is_ghost, link, next_edge, place_triangle, prev_edge, triangle_of
from fem_mesh.mesh.workspace import FROM, PIECE, SEGMENTS
from fem_mesh.predicates import in_circle_sign, in_diametral_circle_sign, orient_sign

ALONG, CROSSED = 1, 2
LAID, BLOCKED = SETTLED + 1, LAST


@kernel
def insert_pieces(
    xy, origin, twin, segment, edge_of, piece_of, parity, leaving, ends, toggles, cavity, ring, state
):  # fmt: skip
    while state[PIECE] < len(ends):  # each turn lays a segment up to the next vertex on it
        k = state[PIECE]
        u, v = index(ends[k, 0] if state[FROM] == 0 else state[FROM]), index(ends[k, 1])
        h = find_way(u, v, xy, origin, twin, leaving)
        if origin[h] == u:
            yield ALONG, h
        else:
            crossed, right, left = collect_crossed(h, u, v, xy, origin, twin, segment, cavity)
            if crossed == 0:
                yield BLOCKED, index(left)
                return
            yield CROSSED, index(crossed)
            h = fill_both_chains(right, left, origin, twin, segment, edge_of, xy, leaving, cavity, ring)
        s = segment[h]
        if s == 0:
            state[SEGMENTS] += 1
            s = index(state[SEGMENTS])
            mark(h, s, twin, segment, edge_of)
            piece_of[s], parity[s] = k, 0
        parity[s] ^= toggles[k]
        state[FROM] = origin[next_edge(h)]
        if state[FROM] == v:
            state[PIECE], state[FROM] = k + 1, 0
        yield LAID, h


@kernel
def note_leaving(count, origin, leaving):
    """``leaving[v]``: some half-edge that leaves vertex v."""
    for h in range(3 * count):
        leaving[origin[h]] = h


@kernel
def side_of(u, v, w, xy):
    """> 0 if w lies left of the line from u to v, < 0 if right."""
    return orient_sign(xy[u, 0], xy[u, 1], xy[v, 0], xy[v, 1], xy[w, 0], xy[w, 1])


@kernel
def find_way(u, v, xy, origin, twin, leaving):
    """The edge on which the segment from u to v leaves u: one from u itself, or the first one that it crosses."""
    first = index(leaving[u])
    h = first
    while True:  # once around u
        a, b = origin[next_edge(h)], origin[prev_edge(h)]
        if not is_ghost(a):
            side = side_of(u, v, a, xy)
            if side == 0.0 and in_diametral_circle_sign(xy[a, 0], xy[a, 1], xy[v, 0], xy[v, 1], xy[u, 0], xy[u, 1]) < 0.0:
                return h
            if side < 0.0 and not is_ghost(b) and side_of(u, v, b, xy) > 0.0:
                return next_edge(h)
        h = twin[prev_edge(h)]
        if h == first:
            return first  # never: one of the triangles around u holds the way


@kernel
def collect_crossed(h, u, v, xy, origin, twin, segment, cavity):
    """The triangles that the segment from u towards v crosses, the first across ``h``, up to the next vertex on it.

    They are listed in ``cavity``. The edges around them become two chains of half-edges at the far end of the
    arrays, where there is room: right of the segment from u on, upwards; left of it back to u, downwards.
    Edges that the hole touches from both sides stay twins. Returns the number of triangles, the end of the right
    chain and the start of the left one; (0, 0, s) if sub-segment s is in the way.
    """
    right, left = first_of_chains(cavity), index(len(origin) - 1)
    origin[left] = u
    left = index(left - 1)
    move_to_chain(next_edge(h), left, origin, twin, segment)
    move_to_chain(prev_edge(h), right, origin, twin, segment)
    cavity[0] = triangle_of(h)
    crossed = 1
    while True:  # each turn crosses an edge nearer to v
        if segment[h] != 0:
            return 0, index(0), index(segment[h])
        g = twin[h]
        cavity[crossed] = triangle_of(g)
        crossed += 1
        w = origin[prev_edge(g)]
        side = side_of(u, v, w, xy)
        if side >= 0.0:
            left = index(left - 1)
            move_to_chain(prev_edge(g), left, origin, twin, segment)
        if side <= 0.0:
            right = index(right + 1)
            move_to_chain(next_edge(g), right, origin, twin, segment)
        if side == 0.0:
            right = index(right + 1)
            origin[right] = w
            return crossed, right, left
        h = next_edge(g) if side > 0.0 else prev_edge(g)


@kernel
def first_of_chains(cavity):
    """Where the room for chains begins: behind the half-edges of all triangles (see ``Workspace.of_points``)."""
    return index(3 * (len(cavity) - 2))


@kernel
def move_to_chain(h, x, origin, twin, segment):
    """Let half-edge ``x`` of a chain stand for ``h``."""
    origin[x] = origin[h]
    segment[x] = segment[h]
    link(twin, x, twin[h])


@kernel
def fill_both_chains(right, left, origin, twin, segment, edge_of, xy, leaving, cavity, ring):
    """Fill the holes on both sides of the new edge; returns its half-edge that has the left hole on its left."""
    used = fill_chain(left, len(origin) - 1, 0, origin, twin, segment, edge_of, xy, leaving, cavity, ring)
    fill_chain(first_of_chains(cavity), right, used, origin, twin, segment, edge_of, xy, leaving, cavity, ring)
    h = index(3 * cavity[0] + 2)
    link(twin, h, index(3 * cavity[used] + 2))
    return h


@kernel
def fill_chain(first, last, used, origin, twin, segment, edge_of, xy, leaving, cavity, ring):
    """Triangulate the hole between a chain and its base, from the chain's last vertex to its first.

    The triangles take the slots ``cavity[used:]``, that on the base the first of them. Returns the slots used.
    """
    ring[0], ring[1], ring[2] = first, last, last  # `last` stands for no edge: let it be the base's other side
    top = 3
    while top > 0:  # each turn makes a triangle, and a chain of m edges has room for m - 1
        top -= 3
        low, high, outside = ring[top], ring[top + 1], ring[top + 2]
        apex = choose_apex(low, high, xy, origin)
        h = place_triangle(origin, cavity[used], origin[low], origin[apex], origin[high])
        used += 1
        for k in range(3):
            segment[h + k] = 0
            leaving[origin[h + k]] = h + k
        link(twin, index(h + 2), outside)
        for k in range(2):  # the chains on the two other sides
            start, end = (low, apex) if k == 0 else (apex, high)
            if end == start + 1:
                close_chain(start, index(h + k), twin, segment, edge_of)
            else:
                ring[top], ring[top + 1], ring[top + 2] = start, end, h + k
                top += 3
    return used


@kernel
def choose_apex(low, high, xy, origin):
    """The vertex between ``low`` and ``high`` of a chain whose circle with these two holds none of the others."""
    a, c = origin[low], origin[high]
    apex = index(low + 1)
    for i in range(low + 2, high):
        b, d = origin[apex], origin[i]
        if in_circle_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1], xy[d, 0], xy[d, 1]) > 0.0:
            apex = index(i)
    return apex


@kernel
def close_chain(x, h, twin, segment, edge_of):
    """Let half-edge ``h`` take the place of ``x`` of a chain."""
    link(twin, h, twin[x])
    s = segment[x]
    segment[h] = s
    if s != 0:
        edge_of[s] = h
