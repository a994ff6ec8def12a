"""Exact signs: on which side of a line, inside or outside a circle.

Every decision of a Delaunay algorithm is the sign of a small determinant. Rounding can flip it, and a
single wrong sign can break a mesh or make an algorithm run for ever. Here each sign is exact, in three
stages (Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates",
1997), each reached only where the one before cannot tell:

1. plain floats and a bound on their error: almost every call;
2. floats with their rounding errors carried along: the ties of grids and rings;
3. the determinant written out over the input and summed without any error.

Exact for all doubles that are 0 or have a magnitude between 2^-142 and 2^201. Wider, the products
under- or overflow; the public functions refuse such input.

The kernels take coordinates and return a float with the right sign; ``orient``, ``in_circle`` and
``in_diametral_circle`` take points, as in a formula.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fem_mesh.errors import MeshError
from fem_mesh.kernel import kernel, scratch

EPS = 2.0**-53  # half a unit in the last place of 1
ORIENT_BOUND = (3 + 16 * EPS) * EPS  # Shewchuk 1997, section 4.3
IN_CIRCLE_BOUND = (10 + 96 * EPS) * EPS  # and section 4.4
MIDDLE_BOUND = 2.0**-96  # two doubles a number: each of some 20 roundings loses at most 2^-104
SPLITTER = 2.0**27 + 1  # cuts a double into two halves of 26 bits
MOST_TERMS = 1024  # the third stage of in_circle sums at most 2 x (12 x 16) x 2 terms
SMALLEST, LARGEST = 2.0**-142, 2.0**201  # magnitudes for which no product under- or overflows


# ---- for points, as in a formula ---------------------------------------------------------------------


def orient(a: Sequence[float], b: Sequence[float], c: Sequence[float]) -> int:
    """On which side of the line from ``a`` to ``b`` the point ``c`` lies: 1 left, -1 right, 0 on it. Exact.

    Points are pairs of numbers. Raises MeshError for anything else, for NaN, infinities and magnitudes
    outside 2^-142 .. 2^201.

    >>> orient((0, 0), (1, 0), (0, 1))
    1
    >>> orient((0, 0), (1, 1), (2, 2))
    0
    """
    return _sign(orient_sign(*_pair(a, "a"), *_pair(b, "b"), *_pair(c, "c")))


def in_circle(a: Sequence[float], b: Sequence[float], c: Sequence[float], d: Sequence[float]) -> bool:
    """Whether ``d`` lies strictly inside the circle through the counter-clockwise triangle ``abc``. Exact.

    A point on the circle is not inside. Raises MeshError if a, b, c run clockwise or lie on one line,
    and for coordinates that are no numbers, infinite, or outside 2^-142 .. 2^201 in magnitude.

    >>> in_circle((0, 0), (1, 0), (0, 1), (0.5, 0.5))
    True
    >>> in_circle((0, 0), (1, 0), (0, 1), (1, 1))
    False
    """
    a, b, c, d = _pair(a, "a"), _pair(b, "b"), _pair(c, "c"), _pair(d, "d")
    turn = orient_sign(*a, *b, *c)
    if turn <= 0:
        found = "run clockwise: swap two of them" if turn < 0 else "lie on one line, so no circle passes through them"
        raise MeshError(f"in_circle needs a counter-clockwise triangle, but {a}, {b}, {c} {found}")
    return bool(in_circle_sign(*a, *b, *c, *d) > 0)


def in_diametral_circle(a: Sequence[float], b: Sequence[float], p: Sequence[float]) -> bool:
    """Whether ``p`` lies strictly inside the circle that has ``ab`` as its diameter. Exact.

    Then p sees the segment ab under more than 90 degrees, and is said to encroach upon it.

    >>> in_diametral_circle((0, 0), (2, 0), (1, 0.5))
    True
    >>> in_diametral_circle((0, 0), (2, 0), (1, 1))
    False
    """
    return bool(in_diametral_circle_sign(*_pair(a, "a"), *_pair(b, "b"), *_pair(p, "p")) > 0)


def _sign(value: float) -> int:
    return int(value > 0) - int(value < 0)


def _pair(point: Any, name: str) -> tuple[float, float]:
    try:
        x, y = point
        pair = float(x), float(y)
    except (TypeError, ValueError, OverflowError):
        raise MeshError(f"point {name} must be a pair of numbers (x, y), not {point!r}") from None
    for given, value in zip((x, y), pair, strict=True):
        if given != value:
            raise MeshError(f"point {name} = {point!r}: {given!r} is no double, so a sign would not be exact")
        if value and not SMALLEST <= abs(value) <= LARGEST:
            raise MeshError(f"point {name} = {point!r}: coordinates must be 0 or within 2^-142 .. 2^201 in magnitude")
    return pair


# ---- the signs -----------------------------------------------------------------------------------


@kernel
def orient_sign(ax, ay, bx, by, cx, cy):
    """> 0 if abc turns left, < 0 if it turns right, 0 if a, b, c lie on one line."""
    left = (ax - cx) * (by - cy)
    right = (ay - cy) * (bx - cx)
    det = left - right
    if abs(det) >= ORIENT_BOUND * (abs(left) + abs(right)):
        return det
    return exact_orient_sign(ax, ay, bx, by, cx, cy)


@kernel
def in_diametral_circle_sign(ax, ay, bx, by, px, py):
    """> 0 if p lies strictly inside the circle whose diameter is ab, < 0 outside, 0 on it."""
    x = (ax - px) * (bx - px)
    y = (ay - py) * (by - py)
    dot = x + y
    if abs(dot) >= ORIENT_BOUND * (abs(x) + abs(y)):
        return -dot
    return -exact_dot_sign(ax, ay, bx, by, px, py)


@kernel
def in_circle_sign(ax, ay, bx, by, cx, cy, dx, dy):
    """> 0 if d lies strictly inside the circle of the counter-clockwise triangle abc, < 0 outside, 0 on it."""
    adx, ady = ax - dx, ay - dy
    bdx, bdy = bx - dx, by - dy
    cdx, cdy = cx - dx, cy - dy
    bc1, bc2 = bdx * cdy, cdx * bdy
    ca1, ca2 = cdx * ady, adx * cdy
    ab1, ab2 = adx * bdy, bdx * ady
    a_lift = adx * adx + ady * ady
    b_lift = bdx * bdx + bdy * bdy
    c_lift = cdx * cdx + cdy * cdy
    det = a_lift * (bc1 - bc2) + b_lift * (ca1 - ca2) + c_lift * (ab1 - ab2)
    permanent = (abs(bc1) + abs(bc2)) * a_lift + (abs(ca1) + abs(ca2)) * b_lift + (abs(ab1) + abs(ab2)) * c_lift
    if abs(det) >= IN_CIRCLE_BOUND * permanent:
        return det
    return exact_in_circle_sign(ax, ay, bx, by, cx, cy, dx, dy)


# ---- sums and products with their rounding errors (Dekker 1971, Knuth) ------------------------------


@kernel
def two_sum(a, b):
    """a + b rounded, and what the rounding lost."""
    s = a + b
    bb = s - a
    return s, (a - (s - bb)) + (b - bb)


@kernel
def two_product(a, b):
    """a * b rounded, and what the rounding lost."""
    p = a * b
    c = SPLITTER * a
    ahi = c - (c - a)
    alo = a - ahi
    c = SPLITTER * b
    bhi = c - (c - b)
    blo = b - bhi
    return p, alo * blo - (((p - ahi * bhi) - alo * bhi) - ahi * blo)


@kernel
def exact_difference(a, b):
    """Whether a - b is a double."""
    return two_sum(a, -b)[1] == 0.0


@kernel
def compare_products(a, b, c, d):
    """The sign of ab - cd, exactly: rounding is monotonic, so the larger product never rounds below."""
    p, p_lost = two_product(a, b)
    q, q_lost = two_product(c, d)
    return p - q if p != q else p_lost - q_lost


# ---- the second stage ----------------------------------------------------------------------------


@kernel
def exact_orient_sign(ax, ay, bx, by, cx, cy):
    if exact_difference(ax, cx) and exact_difference(by, cy) and exact_difference(ay, cy) and exact_difference(bx, cx):
        return compare_products(ax - cx, by - cy, ay - cy, bx - cx)
    e = scratch(MOST_TERMS)
    return top(e, expand_cross(e, ax, ay, bx, by, cx, cy))


@kernel
def exact_dot_sign(ax, ay, bx, by, px, py):
    if exact_difference(ax, px) and exact_difference(bx, px) and exact_difference(ay, py) and exact_difference(by, py):
        return compare_products(ax - px, bx - px, -(ay - py), by - py)
    e = scratch(MOST_TERMS)
    return top(e, expand_dot(e, ax, ay, bx, by, px, py))


@kernel
def exact_in_circle_sign(ax, ay, bx, by, cx, cy, dx, dy):
    """The angles at c and d over the chord ab sum to more than 180 degrees exactly if d is inside:
    det = -(sin C cos D + cos C sin D), where sines and cosines stand for cross and dot products.
    On a rectangle whose diagonal is ab both cosines are exactly 0, whatever its coordinates.
    """
    if (
        exact_difference(ax, cx)
        and exact_difference(ay, cy)
        and exact_difference(bx, cx)
        and exact_difference(by, cy)
        and exact_difference(ax, dx)
        and exact_difference(ay, dy)
        and exact_difference(bx, dx)
        and exact_difference(by, dy)
    ):
        acx, acy, bcx, bcy = ax - cx, ay - cy, bx - cx, by - cy
        adx, ady, bdx, bdy = ax - dx, ay - dy, bx - dx, by - dy
        sin_c, sin_c_lost, sin_c_size, sin_c_fits = sum_of_products(acx, bcy, -acy, bcx)
        cos_c, cos_c_lost, cos_c_size, cos_c_fits = sum_of_products(acx, bcx, acy, bcy)
        sin_d, sin_d_lost, sin_d_size, sin_d_fits = sum_of_products(bdx, ady, -bdy, adx)
        cos_d, cos_d_lost, cos_d_size, cos_d_fits = sum_of_products(bdx, adx, bdy, ady)
        if cos_c_size == 0.0 and cos_d_size == 0.0:
            return 0.0
        if sin_c_fits and cos_c_fits and sin_d_fits and cos_d_fits:
            return compare_products(-sin_c, cos_d, cos_c, sin_d)
        p, p_lost = two_product(sin_c, cos_d)
        q, q_lost = two_product(cos_c, sin_d)
        s, s_lost = two_sum(p, q)
        s_lost += (p_lost + q_lost) + ((sin_c * cos_d_lost + sin_c_lost * cos_d) + (cos_c * sin_d_lost + cos_c_lost * sin_d))
        det = s + s_lost
        if abs(det) > MIDDLE_BOUND * (sin_c_size * cos_d_size + cos_c_size * sin_d_size):
            return -det
    return expanded_in_circle_sign(ax, ay, bx, by, cx, cy, dx, dy)


@kernel
def sum_of_products(a, b, c, d):
    """ab + cd as two doubles, the size |ab| + |cd| that bounds their error, and whether the first
    double is the whole sum. A sum of exactly 0 has size 0.
    """
    p, p_lost = two_product(a, b)
    q, q_lost = two_product(c, d)
    if p == -q and p_lost == -q_lost:
        return 0.0, 0.0, 0.0, True
    s, s_lost = two_sum(p, q)
    fits = s_lost == 0.0 and p_lost == 0.0 and q_lost == 0.0
    return s, s_lost + (p_lost + q_lost), abs(p) + abs(q), fits


# ---- the third stage: sums without error ---------------------------------------------------------------
# An expansion is an array of doubles, small to large, that do not overlap: its sum is exact and has the
# sign of its last term (Shewchuk 1997, section 2.3). It is passed on as (array, number of terms).


@kernel
def grow(e, n, b):
    """Add the double b to the expansion; returns its new length. Zero terms are dropped."""
    m = 0
    for i in range(n):
        b, lost = two_sum(e[i], b)
        if lost != 0.0:
            e[m] = lost
            m += 1
    if b != 0.0:
        e[m] = b
        m += 1
    return m


@kernel
def grow_by_product(e, n, a, b):
    """Add the product ab to the expansion."""
    p, lost = two_product(a, b)
    return grow(e, grow(e, n, lost), p)


@kernel
def top(e, n):
    """The last term of an expansion: it has the sign of the sum."""
    return e[n - 1] if n > 0 else 0.0


@kernel
def expand_cross(e, ax, ay, bx, by, cx, cy):
    """(a - c) x (b - c), without error."""
    n = 0
    for p, q in ((ax, by), (-ay, bx), (bx, cy), (-by, cx), (cx, ay), (-cy, ax)):
        n = grow_by_product(e, n, p, q)
    return n


@kernel
def expand_dot(e, ax, ay, bx, by, px, py):
    """(a - p) . (b - p), without error."""
    n = 0
    for p, q in ((ax, bx), (-ax, px), (-px, bx), (px, px), (ay, by), (-ay, py), (-py, by), (py, py)):
        n = grow_by_product(e, n, p, q)
    return n


@kernel
def expanded_in_circle_sign(ax, ay, bx, by, cx, cy, dx, dy):
    sine, cosine, det = scratch(MOST_TERMS), scratch(MOST_TERMS), scratch(MOST_TERMS)
    n = 0
    for px, py, qx, qy in ((cx, cy, dx, dy), (dx, dy, cx, cy)):  # sin C cos D, and sin D cos C with ab reversed
        sines = expand_cross(sine, ax, ay, bx, by, px, py)
        cosines = expand_dot(cosine, bx, by, ax, ay, qx, qy)
        for i in range(sines):
            for j in range(cosines):
                n = grow_by_product(det, n, sine[i], cosine[j])
        ax, ay, bx, by = bx, by, ax, ay
    return -top(det, n)
