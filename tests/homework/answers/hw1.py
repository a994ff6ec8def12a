"""Homework 1: signs."""

from decimal import Decimal, localcontext
from fractions import Fraction
from math import hypot, prod

import numpy as np

# ---- orient, right -------------------------------------------------------------------------------------


def by_fractions(a, b, c):
    (ax, ay), (bx, by), (cx, cy) = ([Fraction(v) for v in p] for p in (a, b, c))
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


def by_whole_numbers(a, b, c):
    """All coordinates as multiples of the least power of two there is."""
    (ax, ay), (bx, by), (cx, cy) = ([int(Fraction(v) * 2**1074) for v in p] for p in (a, b, c))
    det = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (det > 0) - (det < 0)


def by_decimals(a, b, c):
    with localcontext() as context:
        context.prec = 1000
        (ax, ay), (bx, by), (cx, cy) = ([Decimal(float(v)) for v in p] for p in (a, b, c))
        return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


def by_an_array_of_fractions(a, b, c):
    exact = np.array([[Fraction(v) for v in p] for p in (a, b, c)])
    (ux, uy), (vx, vy) = exact[1] - exact[0], exact[2] - exact[0]
    return float(np.sign(float(ux * vy > uy * vx) - float(ux * vy < uy * vx)))


def by_recursion(a, b, c):
    return laplace([[Fraction(x), Fraction(y), 1] for x, y in (a, b, c)])


def laplace(rows):
    """A determinant, by its first column."""
    if not rows:
        return 1
    rest = [row[1:] for row in rows]
    return sum((-1) ** i * row[0] * laplace(rest[:i] + rest[i + 1 :]) for i, row in enumerate(rows))


# ---- in_circle, right ----------------------------------------------------------------------------------


def by_translation(a, b, c, d):
    dx, dy = map(Fraction, d)
    rows = [(Fraction(x) - dx, Fraction(y) - dy) for x, y in (a, b, c)]
    return laplace([[x, y, x * x + y * y] for x, y in rows]) > 0


def by_four_rows(a, b, c, d):
    rows = [[Fraction(v) for v in p] for p in (a, b, c, d)]
    return laplace([[x, y, x * x + y * y, 1] for x, y in rows]) > 0


def by_the_exact_centre(a, b, c, d):
    ax, ay = map(Fraction, a)
    (bx, by), (cx, cy), (dx, dy) = ((Fraction(x) - ax, Fraction(y) - ay) for x, y in (b, c, d))
    bb, cc, twice = bx * bx + by * by, cx * cx + cy * cy, 2 * (bx * cy - by * cx)
    x, y = (bb * cy - cc * by) / twice, (cc * bx - bb * cx) / twice
    return (dx - x) ** 2 + (dy - y) ** 2 < x * x + y * y


def by_integers_in_an_array(a, b, c, d):
    whole = np.array([[int(Fraction(float(v)) * 2**1074) for v in p] for p in (a, b, c, d)], dtype=object)
    x, y = (whole[:3] - whole[3]).T
    lift = x * x + y * y
    return bool(np.dot(lift, np.roll(x, -1) * np.roll(y, -2) - np.roll(x, -2) * np.roll(y, -1)) > 0)


# ---- quick_in_circle, right ----------------------------------------------------------------------------


def by_a_filter(a, b, c, d):
    det, permanent = det_and_permanent(a, b, c, d)
    return det > 0 if abs(det) > 2e-15 * permanent else by_translation(a, b, c, d)


def by_an_array_filter(a, b, c, d):
    x, y = np.subtract([a, b, c], d).T
    lift, there, back = x * x + y * y, np.roll(x, -1) * np.roll(y, -2), np.roll(x, -2) * np.roll(y, -1)
    det, bound = lift @ (there - back), 2e-15 * (lift @ (abs(there) + abs(back)))
    return bool(det > 0) if abs(det) > bound else by_four_rows(a, b, c, d)


def by_a_careful_filter(a, b, c, d):
    """A larger bound costs time, never a sign."""
    det, permanent = det_and_permanent(a, b, c, d)
    if det > 1e-6 * permanent:
        return True
    if -det > 1e-6 * permanent:
        return False
    return by_the_exact_centre(a, b, c, d)


def det_and_permanent(a, b, c, d, products=True):
    points = [(x - d[0], y - d[1]) for x, y in (a, b, c)]
    det = permanent = 0.0
    for i in range(3):
        (px, py), (qx, qy), (rx, ry) = points[i], points[(i + 1) % 3], points[(i + 2) % 3]
        det += (px * px + py * py) * (qx * ry - rx * qy)
        permanent += (px * px + py * py) * (abs(qx * ry) + abs(rx * qy) if products else abs(qx * ry - rx * qy))
    return det, permanent


# ---- wrong ---------------------------------------------------------------------------------------------


def in_floats(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def with_a_tolerance(a, b, c):
    det = in_floats(a, b, c)
    return 0 if abs(det) < 1e-12 else det


def turned_round(a, b, c):
    return -by_fractions(a, b, c)


def printed(a, b, c):
    print(by_fractions(a, b, c))


def in_words(a, b, c):
    return "left" if by_fractions(a, b, c) > 0 else "right"


def through_text(a, b, c):
    (ax, ay), (bx, by), (cx, cy) = ([Fraction(str(float(v))) for v in p] for p in (a, b, c))
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


def fractions_too_late(a, b, c):
    return Fraction(in_floats(a, b, c))


def by_angles(a, b, c):
    first, second = (np.arctan2(p[1] - a[1], p[0] - a[0]) for p in (b, c))
    return np.sin(second - first)


def only_true_or_false(a, b, c):
    return by_fractions(a, b, c) > 0


def circle_in_floats(a, b, c, d):
    return det_and_permanent(a, b, c, d)[0] > 0


def circle_with_a_tolerance(a, b, c, d):
    return det_and_permanent(a, b, c, d)[0] > 1e-12


def circle_not_strict(a, b, c, d):
    return laplace([[x, y, x * x + y * y, 1] for x, y in ([Fraction(v) for v in p] for p in (a, b, c, d))]) >= 0


def circle_by_distance(a, b, c, d):
    (bx, by), (cx, cy) = ((p[0] - a[0], p[1] - a[1]) for p in (b, c))
    bb, cc, twice = bx * bx + by * by, cx * cx + cy * cy, 2 * (bx * cy - by * cx)
    x, y = a[0] + (bb * cy - cc * by) / twice, a[1] + (cc * bx - bb * cx) / twice
    return hypot(d[0] - x, d[1] - y) < hypot(a[0] - x, a[1] - y)


def circle_as_a_number(a, b, c, d):
    return laplace([[x, y, x * x + y * y, 1] for x, y in ([Fraction(v) for v in p] for p in (a, b, c, d))])


def inside_the_triangle(a, b, c, d):
    return all(by_fractions(p, q, d) > 0 for p, q in ((a, b), (b, c), (c, a)))


def filter_without_scale(a, b, c, d):
    det, _ = det_and_permanent(a, b, c, d)
    return det > 0 if abs(det) > 1e-12 else by_translation(a, b, c, d)


def filter_by_the_det(a, b, c, d):
    """The error is measured against the determinant itself, which says nothing."""
    det, _ = det_and_permanent(a, b, c, d)
    return det > 0 if abs(det) > 2e-15 * abs(det) else by_translation(a, b, c, d)


def filter_without_the_fallback(a, b, c, d):
    det, permanent = det_and_permanent(a, b, c, d)
    return det > 2e-15 * permanent


def filter_by_a_product(a, b, c, d):
    det, _ = det_and_permanent(a, b, c, d)
    return det > 0 if abs(det) > 2e-15 * abs(prod([*a, *b])) else by_translation(a, b, c, d)


def filter_of_differences(a, b, c, d):
    """The likeliest misreading: |bx cy - cx by| for |bx cy| + |cx by|."""
    det, permanent = det_and_permanent(a, b, c, d, products=False)
    return det > 0 if abs(det) > 2e-15 * permanent else by_translation(a, b, c, d)


RIGHT = {
    "orient": [by_fractions, by_whole_numbers, by_decimals, by_an_array_of_fractions, by_recursion],
    "in_circle": [by_translation, by_four_rows, by_the_exact_centre, by_integers_in_an_array],
    "in_circle quick": [by_a_filter, by_an_array_filter, by_a_careful_filter],
}
ROUNDED = "which rounding or a tolerance hides"
WRONG = [
    ("orient", in_floats, ROUNDED),
    ("orient", with_a_tolerance, ROUNDED),
    ("orient", turned_round, "orient((0, 0), (1, 0), (0, 1)) must be positive, since c lies to the left"),
    ("orient", printed, "not None: is a `return` missing?"),
    ("orient", in_words, "must return a number, whose sign counts, not the text 'left'"),
    ("orient", through_text, ROUNDED),
    ("orient", fractions_too_late, ROUNDED),
    ("orient", by_angles, "must be 0, since c lies on the line"),
    ("orient", only_true_or_false, "must return a number, whose sign counts, not True"),
    ("in_circle", circle_in_floats, ROUNDED),
    ("in_circle", circle_with_a_tolerance, ROUNDED),
    ("in_circle", circle_not_strict, "must be False, since d lies exactly on the circle, not inside"),
    ("in_circle", circle_by_distance, "since d lies "),
    ("in_circle", circle_as_a_number, "must return True or False, not"),
    ("in_circle", inside_the_triangle, "must be True, since d lies inside the circle"),
    ("in_circle", filter_without_scale, "since d lies "),
    ("in_circle", filter_by_the_det, "since d lies "),
    ("in_circle", filter_without_the_fallback, ROUNDED),
    ("in_circle", filter_by_a_product, "since d lies "),
    ("in_circle", filter_of_differences, 'case "points nearly on a line": in_circle('),
]
