"""Sub-segments that are encroached upon, and where they are split."""

from __future__ import annotations

import math

from fem_mesh.algorithms.refining.worklists import GIVEN, LENS
from fem_mesh.kernel import kernel
from fem_mesh.mesh.halfedge import is_ghost, next_edge, prev_edge
from fem_mesh.predicates import LARGEST, SMALLEST, in_diametral_circle_sign

# What `limits` holds
LENS_COSINE = 0  # squared cosine of 180 - 2 T degrees, the angle under which a lens is seen; 0 from T = 45 on
OFFSET = 1  # the farthest Steiner point from the middle of the shortest edge, in lengths of that edge
SHORTEST = 2  # square of the length below which nothing is split
SPOT_X, SPOT_Y = 3, 4  # the point of a curve where the next sub-segment is to be split, or where a vertex moves
COSINE_T, SINE_T = 5, 6  # of the bound on angles, and a little more
WIDE = 7  # square of the length above which an edge is too long for the sizes asked for
CORNERS = 8  # from here on: two polygons, see relocation.py

# What `place` holds of a vertex: k + 1 > 0 within segment k of the domain, or one of these
FREE, CORNER, SHARP = 0, -1, -2  # inserted in the open; given; given, with an angle below 60 degrees
FIRST_UNUSED = -3  # - j: an unused slot, after which slot j is unused too


@kernel
def encroaches(v, h, lens, xy, origin, limits):
    """Whether vertex ``v`` encroaches upon the edge of ``h``: it lies inside its diametral circle, or lens.

    The circle is where the edge is seen under more than 90 degrees, exactly; the lens, under 180 - 2 T or more.
    """
    a, b = origin[h], origin[next_edge(h)]
    ax, ay, bx, by, px, py = xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[v, 0], xy[v, 1]
    if in_diametral_circle_sign(ax, ay, bx, by, px, py) <= 0.0:
        return False
    if not lens:
        return True
    ax, ay, bx, by = ax - px, ay - py, bx - px, by - py
    dot = ax * bx + ay * by
    return dot * dot >= limits[LENS_COSINE] * (ax * ax + ay * ay) * (bx * bx + by * by)


@kernel
def is_encroached(h, xy, origin, twin, limits, state):
    """Whether the apex on either side encroaches upon sub-segment ``h``: no other vertex sees it under a wider angle."""
    v, w = origin[prev_edge(h)], origin[prev_edge(twin[h])]
    if not is_ghost(v) and encroaches(v, h, state[LENS], xy, origin, limits):
        return True
    return not is_ghost(w) and encroaches(w, h, state[LENS], xy, origin, limits)


@kernel
def find_free_vertex_inside(h, xy, origin, twin, place, state):
    """A half-edge from a free vertex inside the diametral circle of sub-segment ``h``, or ``h`` if there is none.

    Such a vertex goes before the sub-segment is split at a lens (Chew 1993), where the two halves would only be
    encroached again; or at a curve, where it might be in the way.
    """
    if state[LENS] == 0 and state[GIVEN] == 0:
        return h
    a, b = origin[h], origin[next_edge(h)]
    for side in (h, twin[h]):
        v = origin[prev_edge(side)]
        free = not is_ghost(v) and place[v] == FREE
        if free and in_diametral_circle_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[v, 0], xy[v, 1]) > 0.0:
            return prev_edge(side)
    return h


@kernel
def place_split_point(v, h, xy, origin, place):
    """Put ``v`` in the middle of ``h``; if one end is a sharp corner, at a power of two from there instead.

    So the sub-segments around a corner end on common circles, and do not encroach upon each other in turn. Of all
    powers of two just one lies between a third and two thirds of the length.
    """
    a, b = origin[h], origin[next_edge(h)]
    if place[b] == SHARP and place[a] != SHARP:
        a, b = b, a
    dx, dy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
    part = 0.5
    if place[a] == SHARP and place[b] != SHARP:
        part = shell(dx * dx + dy * dy)
    xy[v, 0] = in_range(xy[a, 0] + part * dx)
    xy[v, 1] = in_range(xy[a, 1] + part * dy)


@kernel
def shell(square):
    """Which part of an edge of this squared length ends at a power of two between its thirds."""
    length = math.sqrt(square)
    power = 1.0
    while power * 3.0 > 2.0 * length:  # lengths are finite and positive: doubles of some 700 powers of two
        power *= 0.5
    while power * 3.0 <= length:
        power *= 2.0
    return power / length


@kernel
def in_range(x):
    """``x``, or 0 if it is so small that signs would no longer be exact."""
    return x if abs(x) >= SMALLEST else 0.0


@kernel
def is_between(v, a, b, xy):
    """Whether vertex ``v`` may split the edge ab: strictly inside its diametral circle, so strictly between its ends."""
    x, y = xy[v, 0], xy[v, 1]
    if not (abs(x) <= LARGEST and abs(y) <= LARGEST):
        return False
    return in_diametral_circle_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], x, y) > 0.0


@kernel
def squared_length(h, xy, origin):
    a, b = origin[h], origin[next_edge(h)]
    dx, dy = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
    return dx * dx + dy * dy
