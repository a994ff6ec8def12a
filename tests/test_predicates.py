"""The predicates never err: against Python's integers, on points made to mislead floats."""

import itertools
import re
from fractions import Fraction

import exact
import numpy as np
import pytest
from corpus import EXHAUSTIVE, for_all, nudged, on_circle, pythagorean_circle
from hypothesis import strategies as st

import fem_mesh as fm

SMALLEST, LARGEST = 2.0**-142, 2.0**201
UNIT_RIGHT = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]


# --- four points each, made to mislead ---


def in_range(points):
    """The points as pairs of floats, with magnitudes too small for exact signs set to 0."""
    return [tuple(x if SMALLEST <= abs(x) <= LARGEST else 0.0 for x in point) for point in np.asarray(points).tolist()]


unit = st.floats(-1, 1)
ulps = st.lists(st.integers(-3, 3), min_size=8, max_size=8).map(lambda steps: np.array(steps).reshape(4, 2))
four_numbers = st.lists(unit, min_size=4, max_size=4).map(lambda numbers: np.array(numbers)[:, None])
pairs = st.tuples(unit, unit).map(np.array)
scales = st.integers(-40, 40).map(lambda k: 2.0**k)
offsets = st.one_of(st.just(0.0), st.integers(0, 45).map(lambda k: 2.0**k), st.sampled_from([1e5, 5.4e6, 1e12]))
circle_points = st.sampled_from(pythagorean_circle(300))
wide_numbers = st.one_of(
    st.just(0.0),
    st.builds(
        lambda m, k, s: s * m * 2.0**k, st.floats(1, 2, exclude_max=True), st.integers(-142, 200), st.sampled_from([1, -1])
    ),
)

near_line = st.builds(
    lambda p, d, t, size, shift, k: in_range(nudged(size * (p + t * d) + shift, k)),
    *(pairs, pairs, four_numbers, scales, offsets, ulps),
)
near_circle = st.builds(
    lambda p, t, size, shift, k: in_range(nudged(size * (p + on_circle(np.pi * t[:, 0])) + shift, k)),
    *(pairs, four_numbers, scales, offsets, ulps),
)
fifteenths = st.lists(st.tuples(*2 * [st.integers(0, 15).map(lambda i: 2 * (i / 15) - 1)]), min_size=4, max_size=4)
exact_circle = st.builds(
    lambda points, dx, dy, x: [*((a + dx, b + dy) for a, b in points[:3]), (points[3][0] + dx + x, points[3][1] + dy)],
    st.lists(circle_points, min_size=4, max_size=4),
    *(st.integers(-(2**30), 2**30), st.integers(-(2**30), 2**30), st.integers(-1, 1)),
)
all_scales = st.lists(st.tuples(wide_numbers, wide_numbers), min_size=4, max_size=4)
four_points = st.one_of(near_line, near_circle, fifteenths, exact_circle, all_scales)


def is_odd(order):
    return sum(i > j for i, j in itertools.combinations(order, 2)) % 2 == 1


# --- signs ---


@for_all(600, points=four_points)
def test_the_side_of_a_line_is_exact(points):
    assert fm.orient(*points[:3]) == exact.sign(exact.turn(*exact.integers(points[:3])))


@for_all(300, points=four_points)
def test_two_swapped_points_turn_a_left_bend_into_a_right_one(points):
    sign = fm.orient(*points[:3])
    for order in itertools.permutations(range(3)):
        assert fm.orient(*(points[i] for i in order)) == (-sign if is_odd(order) else sign)


@for_all(300, points=four_points)
def test_each_of_four_points_tells_the_same_about_their_circles(points):
    """The in-circle determinant changes its sign with each swap: checked for all 24 orders at once."""
    whole = exact.integers(points)
    for order in itertools.permutations(range(4)):
        triangle, truth = [points[i] for i in order], [whole[i] for i in order]
        if exact.turn(*truth[:3]) > 0:
            assert fm.in_circle(*triangle) is (exact.inside(*truth) > 0)
        else:
            with pytest.raises(fm.MeshError, match=r"clockwise|one line"):
                fm.in_circle(*triangle)


@for_all(600, points=four_points)
def test_seeing_a_segment_under_more_than_90_degrees_is_exact(points):
    a, b, p = points[:3]
    truth = exact.sees_wide(*exact.integers([a, b, p])) > 0
    assert fm.in_diametral_circle(a, b, p) is truth
    assert fm.in_diametral_circle(b, a, p) is truth


@for_all(300, points=st.one_of(near_line, near_circle, fifteenths), power=st.integers(-85, 110))
def test_a_power_of_two_changes_no_sign(points, power):
    """Here magnitudes are 0 or within 2^-57 .. 2^90, so that they stay in range."""
    points = [tuple(x if abs(x) >= 2.0**-57 else 0.0 for x in point) for point in points]
    scaled = [(x * 2.0**power, y * 2.0**power) for x, y in points]
    a, b, c, d = (1, 2, 0, 3) if fm.orient(*points[:3]) > 0 else (1, 0, 2, 3)
    assert fm.orient(*scaled[:3]) == fm.orient(*points[:3])
    assert fm.in_diametral_circle(*scaled[:3]) == fm.in_diametral_circle(*points[:3])
    if fm.orient(*points[:3]):
        assert fm.in_circle(*(scaled[i] for i in (a, b, c, d))) == fm.in_circle(*(points[i] for i in (a, b, c, d)))


def test_the_reference_itself_agrees_with_determinants_of_fractions():
    for points in np.random.default_rng(0).integers(-3, 4, (500, 4, 2)).tolist():
        a, b, c, d = ([Fraction(x, 7) for x in point] for point in points)
        rows = [(p[0] - d[0], p[1] - d[1], (p[0] - d[0]) ** 2 + (p[1] - d[1]) ** 2) for p in (a, b, c)]
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = rows
        determinant = ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)
        assert exact.sign(exact.inside(*points)) == exact.sign(determinant)


# --- where plain floats err: a share that is measured ---


def float_orient(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def float_in_circle(a, b, c, d):
    (ax, ay), (bx, by), (cx, cy) = a - d, b - d, c - d
    left, middle, right = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    return left * (bx * cy - by * cx) + middle * (cx * ay - cy * ax) + right * (ax * by - ay * bx)


def float_sees_wide(a, b, p):
    return -((a - p) * (b - p)).sum(axis=0)


def nearly_on_a_line(random, n):
    """a, b, c with b and c = 2 b exact and a near 0, up to 2 ulps off their line: b - a loses what decides."""
    b = random.integers(8, 25, (n, 1, 2)).astype(float)
    a = nudged(b * random.random((n, 1, 1)) / 16, random.integers(-2, 3, (n, 1, 2)))
    return np.concatenate([a, b, 2 * b], axis=1)


def nearly_on_a_circle(random, n):
    """Counter-clockwise a, b, c and then d, up to an ulp off a circle about a point of the unit square."""
    angles = 2 * np.pi * (np.arange(4) + random.random((n, 4))) / 4
    return nudged(on_circle(angles) + random.random((n, 1, 2)), random.integers(-1, 2, (n, 4, 2)))


def nearly_under_a_right_angle(random, n):
    """The ends of a diameter and a third point of the circle, rounded."""
    a, p = on_circle(2 * np.pi * random.random((2, n)))
    return np.stack([a, -a, p], axis=1) + random.random((n, 1, 2)) / 2


@pytest.mark.parametrize("n", [12_000, pytest.param(120_000, marks=EXHAUSTIVE)])
@pytest.mark.parametrize(
    ("make", "by_floats", "predicate", "truth", "wrong_share"),
    [
        (nearly_on_a_line, float_orient, fm.orient, exact.turn, 0.50),
        (nearly_on_a_circle, float_in_circle, fm.in_circle, exact.inside, 0.20),
        (nearly_under_a_right_angle, float_sees_wide, fm.in_diametral_circle, exact.sees_wide, 0.10),
    ],
    ids=["orient: more than 50 %", "in_circle: more than 20 %", "in_diametral_circle: more than 10 %"],
)
def test_where_plain_floats_often_take_the_wrong_sign_the_predicates_never_do(
    make, by_floats, predicate, truth, wrong_share, n
):
    cases = make(np.random.default_rng(1), n)
    signs = np.array([exact.sign(truth(*exact.integers(points))) for points in cases.tolist()])
    by_floats = np.sign(by_floats(*cases.transpose(1, 2, 0)))
    assert np.mean(by_floats != signs) > wrong_share
    answers = np.array([predicate(*points) for points in cases.tolist()])
    assert np.array_equal(answers, signs if predicate is fm.orient else signs > 0)


# --- known cases ---


def test_a_point_on_a_circle_is_not_inside():
    circle = sorted(pythagorean_circle(100), key=lambda point: np.arctan2(point[1], point[0]))
    for a, b, c, (x, y) in zip(circle, circle[7:], circle[30:], circle[50:], strict=False):
        assert not fm.in_circle(a, b, c, (x, y))
        assert fm.in_circle(a, b, c, (x - np.sign(x), y - np.sign(y)))
        assert not fm.in_diametral_circle(a, (-a[0], -a[1]), (x, y))


def test_a_square_s_corner_does_not_encroach_upon_its_diagonal():
    for size in (0.1, 1 / 3, 1e30):
        assert not fm.in_diametral_circle((0, 0), (size, size), (size, 0))
        assert fm.in_diametral_circle((0, 0), (size, size), (np.nextafter(size, 0), 0))


def test_a_segment_of_no_length_has_nothing_inside_its_circle():
    assert not fm.in_diametral_circle((1, 2), (1, 2), (1, 2))
    assert not fm.in_diametral_circle((1, 2), (1, 2), (1, 2.5))


def test_numpy_points_and_integers_are_points():
    a, b, c, d = np.array([(0, 0), (4, 0), (0, 4), (1, 1)])
    assert fm.orient(a, b, c) == 1
    assert fm.in_circle(a, b, c, d)
    assert fm.in_diametral_circle(a.astype(np.float32), b, d)


def test_the_smallest_and_the_largest_numbers_allowed_give_exact_signs():
    a, b, c = (0, 0), (LARGEST, SMALLEST), (-LARGEST, -SMALLEST)
    assert fm.orient(a, b, c) == 0
    assert fm.orient(a, b, (-LARGEST, -SMALLEST * (1 + 2**-52))) == -1
    assert fm.in_circle((LARGEST, 0), (0, LARGEST), (-LARGEST, 0), (SMALLEST, np.nextafter(-LARGEST, 0)))
    assert not fm.in_circle((LARGEST, 0), (0, LARGEST), (-LARGEST, 0), (SMALLEST, -LARGEST))
    assert fm.in_diametral_circle((-SMALLEST, 0), (SMALLEST, 0), (0, 0))


# --- bad input ---


@pytest.mark.parametrize("predicate", [fm.orient, fm.in_circle, fm.in_diametral_circle])
@pytest.mark.parametrize(
    ("bad", "message"),
    [
        ((float("nan"), 0), r"nan.*no double"),
        ((0, float("inf")), r"inf.*2\^-142 \.\. 2\^201"),
        ((-float("inf"), 0), r"-inf.*2\^-142 \.\. 2\^201"),
        ((1e-300, 0), r"1e-300.*2\^-142 \.\. 2\^201"),
        ((0, np.nextafter(SMALLEST, 0)), r"2\^-142 \.\. 2\^201"),
        ((np.nextafter(LARGEST, np.inf), 0), r"2\^-142 \.\. 2\^201"),
        ((2**54 + 1, 0), "18014398509481985.*no double"),
        ((10**400, 0), "point [abcdp]"),
        (("1", 2), "'1'"),
        ((1, 2, 3), r"pair.*\(1, 2, 3\)"),
        ((1,), r"pair.*\(1,\)"),
        ((), "pair"),
        (3, "pair.*3"),
        (None, "pair.*None"),
        ("ab", "pair.*'ab'"),
        ((1, None), "pair.*None"),
        ((1j, 0), "pair.*1j"),
    ],
    ids=str,
)
def test_what_is_no_point_is_refused_by_name(predicate, bad, message):
    points = [*UNIT_RIGHT, (1.0, 1.0)][: 4 if predicate is fm.in_circle else 3]
    for i, name in enumerate("abcd" if predicate is fm.in_circle else "abp" if predicate is fm.in_diametral_circle else "abc"):
        with pytest.raises(fm.MeshError, match=re.compile(f"point {name}.*", re.DOTALL)) as error:
            predicate(*points[:i], bad, *points[i + 1 :])
        assert re.search(message, str(error.value))


def test_a_circle_needs_a_counter_clockwise_triangle():
    a, b, c = UNIT_RIGHT
    with pytest.raises(fm.MeshError, match="clockwise: swap two"):
        fm.in_circle(a, c, b, (2, 2))
    with pytest.raises(fm.MeshError, match="on one line, so no circle"):
        fm.in_circle((0, 0), (1, 1), (2, 2), (0, 1))
    with pytest.raises(fm.MeshError, match="on one line"):
        fm.in_circle(a, a, b, c)


def test_a_mesh_error_is_a_value_error():
    assert issubclass(fm.MeshError, ValueError)
