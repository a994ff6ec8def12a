"""Bad triangles, and the points that mend them."""

from __future__ import annotations

import math

from fem_mesh.algorithms.refining.encroachment import OFFSET, SHARP, SHORTEST, in_range
from fem_mesh.algorithms.refining.worklists import OFFCENTER
from fem_mesh.kernel import index, inlined_kernel, kernel
from fem_mesh.mesh.halfedge import next_edge, prev_edge
from fem_mesh.predicates import LARGEST

# The columns of `bounds`, one row a label
COSINE = 0  # squared cosine of the smallest angle wanted
MAX_AREA = 1  # largest area wanted
MAX_EDGE = 2  # squared length of the longest edge wanted

NO_ANGLE, UNBOUNDED = 2.0, math.inf  # what they hold where there is no bound

FINE, SKINNY, LARGE, LONG = 0, 1, 2, 3  # verdicts on a triangle
SAME_SHELL = 2.0**-9  # two squared lengths that differ by a smaller part count as one: the split points are rounded


@inlined_kernel
def judge(t, xy, origin, label, bounds, wanted):
    """The verdict on triangle ``t``, and its shortest edge: the half-edge and the squared length."""
    h = index(3 * t)
    a, b, c = origin[h], origin[h + 1], origin[h + 2]
    abx, aby = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
    bcx, bcy = xy[c, 0] - xy[b, 0], xy[c, 1] - xy[b, 1]
    cax, cay = xy[a, 0] - xy[c, 0], xy[a, 1] - xy[c, 1]
    ab, bc, ca = abx * abx + aby * aby, bcx * bcx + bcy * bcy, cax * cax + cay * cay
    if ab <= bc and ab <= ca:  # the smallest angle lies opposite the shortest edge
        shortest, square, dot, product, longest = h, ab, -(bcx * cax + bcy * cay), bc * ca, max(bc, ca)
    elif bc <= ca:
        shortest, square, dot, product, longest = index(h + 1), bc, -(cax * abx + cay * aby), ca * ab, max(ca, ab)
    else:
        shortest, square, dot, product, longest = index(h + 2), ca, -(abx * bcx + aby * bcy), ab * bc, max(ab, bc)
    row = label[t]
    if dot * dot > bounds[row, COSINE] * product:
        return SKINNY, shortest, square
    if 0.5 * (abx * bcy - aby * bcx) > bounds[row, MAX_AREA]:
        return LARGE, shortest, square
    if longest > bounds[row, MAX_EDGE] or (len(wanted) > 0 and longest > wanted[t] * wanted[t]):
        return LONG, shortest, square
    return FINE, shortest, square


@kernel
def place_steiner_point(v, h, xy, origin, limits, state):
    """Put ``v`` in the circumcentre of the triangle whose shortest edge is ``h``; or, if that is far, on the way to it.

    The off-center lies on the bisector of ``h``, where the triangle that it makes with ``h`` just keeps the bound.
    Rounded: whoever inserts ``v`` checks it. Returns whether it is a point at all.
    """
    a, b, c = origin[h], origin[next_edge(h)], origin[prev_edge(h)]
    bx, by = xy[b, 0] - xy[a, 0], xy[b, 1] - xy[a, 1]
    cx, cy = xy[c, 0] - xy[a, 0], xy[c, 1] - xy[a, 1]
    square = bx * bx + by * by
    # The circumcentre is at (b/2) + height x (b turned left), seen from a.
    cross = bx * cy - by * cx
    if not cross > 0.0:
        return False
    height = 0.5 * ((cx - bx) * cx + (cy - by) * cy) / cross
    if state[OFFCENTER] != 0 and height > limits[OFFSET]:
        height = limits[OFFSET]
    x = xy[a, 0] + (0.5 * bx - height * by)
    y = xy[a, 1] + (0.5 * by + height * bx)
    xy[v, 0], xy[v, 1] = in_range(x), in_range(y)
    return square > limits[SHORTEST] and abs(x) <= LARGEST and abs(y) <= LARGEST


@kernel
def is_excused(h, xy, origin, segment, place, ends):
    """Whether the triangle whose shortest edge is ``h`` is skinny for a small input angle, so that nothing can mend it.

    The ends of ``h`` lie on two segments that meet in a sharp corner, on one circle around it.
    """
    u, v = origin[h], origin[next_edge(h)]
    corner = common_corner(u, v, place, ends)
    if corner == 0:  # or the triangle lies in the corner itself, between two sub-segments
        up, vp = next_edge(h), prev_edge(h)
        if segment[up] == 0 or segment[vp] == 0 or place[origin[vp]] != SHARP:
            return False
        corner = origin[vp]
    ux, uy = xy[u, 0] - xy[corner, 0], xy[u, 1] - xy[corner, 1]
    vx, vy = xy[v, 0] - xy[corner, 0], xy[v, 1] - xy[corner, 1]
    p, q = ux * ux + uy * uy, vx * vx + vy * vy
    dx, dy = ux - vx, uy - vy
    return abs(p - q) <= SAME_SHELL * p and dx * dx + dy * dy < p


@kernel
def common_corner(u, v, place, ends):
    """The sharp corner where the segments end that ``u`` and ``v`` lie within, or the ghost vertex."""
    j, k = place[u] - 1, place[v] - 1
    if j >= 0 and k >= 0 and j != k:
        for a in range(2):
            for b in range(2):
                if ends[j, a] == ends[k, b] and place[ends[j, a]] == SHARP:
                    return index(ends[j, a])
    return index(0)
