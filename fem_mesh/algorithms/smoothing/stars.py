"""The *star* of a vertex, the triangles around it: where its vertex is drawn to, and where that may go."""

from __future__ import annotations

from fem_mesh.kernel import kernel
from fem_mesh.mesh.halfedge import next_edge, prev_edge, triangle_of
from fem_mesh.predicates import LARGEST, orient_sign


@kernel
def find_mean(h, xy, origin, twin, weight, odt):
    """Where the vertex that ``h`` leaves is drawn to, and the area of its star.

    The circumcentre of a triangle 0, a, b is |a|^2 b - |b|^2 a, turned right, over four times its area: with the area
    as its weight no division is left, and flat triangles do no harm.
    """
    v = origin[h]
    x, y = xy[v, 0], xy[v, 1]
    area, mass, sx, sy = 0.0, 0.0, 0.0, 0.0
    g = h
    while True:  # once around the vertex
        a, b, w = origin[next_edge(g)], origin[prev_edge(g)], weight[triangle_of(g)]
        ax, ay, bx, by = xy[a, 0] - x, xy[a, 1] - y, xy[b, 0] - x, xy[b, 1] - y
        cross = ax * by - ay * bx
        if odt:
            aa, bb = ax * ax + ay * ay, bx * bx + by * by
            sx += w * (0.5 * (aa * by - bb * ay))
            sy += w * (0.5 * (bb * ax - aa * bx))
        else:
            sx += w * (cross * (ax + bx)) / 3.0
            sy += w * (cross * (ay + by)) / 3.0
        area += 0.5 * cross
        mass += w * cross
        g = twin[prev_edge(g)]
        if g == h:
            break
    if not (mass > 0.0 and area > 0.0):  # so flat, or of so little weight, that rounding takes all
        return x, y, area
    return x + sx / mass, y + sy / mass, area


@kernel
def is_inside_star(h, x, y, xy, origin, twin):
    """Whether the triangles around the vertex that ``h`` leaves would all be counter-clockwise with it at (x, y)."""
    if not (abs(x) <= LARGEST and abs(y) <= LARGEST):
        return False
    g = h
    while True:  # once around the vertex
        a, b = origin[next_edge(g)], origin[prev_edge(g)]
        if not orient_sign(xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], x, y) > 0.0:
            return False
        g = twin[prev_edge(g)]
        if g == h:
            return True


@kernel
def worst_of_star(h, x, y, xy, origin, twin):
    """The squared cosine of the smallest angle around the vertex that ``h`` leaves, if it were at (x, y)."""
    worst = 0.0
    g = h
    while True:  # once around the vertex
        a, b = origin[next_edge(g)], origin[prev_edge(g)]
        ax, ay, bx, by = xy[a, 0] - x, xy[a, 1] - y, xy[b, 0] - x, xy[b, 1] - y
        cx, cy = bx - ax, by - ay
        aa, bb, cc = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
        if cc <= aa and cc <= bb:  # the smallest angle lies opposite the shortest edge
            dot, product = ax * bx + ay * by, aa * bb
        elif aa <= bb:
            dot, product = bx * cx + by * cy, bb * cc
        else:
            dot, product = -(ax * cx + ay * cy), aa * cc
        worst = max(worst, dot * dot / product)
        g = twin[prev_edge(g)]
        if g == h:
            return worst
