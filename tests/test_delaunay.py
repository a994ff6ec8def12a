"""Every way to the Delaunay triangulation, on every point set that broke others, against exact brute force."""

import itertools
import warnings
from collections import Counter
from fractions import Fraction

import exact
import numpy as np
import pytest
import triangle as shewchuk
from corpus import CORPUS, EXHAUSTIVE, for_all, on_circle, random
from hypothesis import assume
from hypothesis import strategies as st
from scipy.spatial import Delaunay as Qhull

import fem_mesh as fm


def play(steps):
    return fm.record(steps, limit=None).mesh


WAYS = {
    "delaunay": fm.delaunay,
    "bowyer_watson, points as given": lambda points: play(fm.bowyer_watson(points, order="given")),
    "lawson from any triangulation": lambda points: play(fm.lawson(points, fm.any_triangulation(points))),
}
NO_TIES = ["uniform", "clusters", "aspect_a_million", "spiral", "two_parallel_lines", "points_at_1e38", "points_at_1e_40"]
SQUARE = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 1)]
FAN = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]


def as_set(triangles):
    return {frozenset(triangle) for triangle in np.asarray(triangles).tolist()}


def lowest_equal(points):
    first = {}
    return [first.setdefault(point, i) for i, point in enumerate(map(tuple, np.asarray(points, float).tolist()))]


def check_mesh(points, mesh, check_circles=exact.check_every_circle):
    """All that makes ``mesh`` a Delaunay triangulation of ``points``, exactly."""
    triangles, merged_into = mesh.triangles.tolist(), lowest_equal(points)
    exact.check_triangulation(points, triangles)
    check_circles(points, triangles)
    assert np.array_equal(mesh.points, points)
    assert mesh.merged_into.tolist() == merged_into
    assert {v for triangle in triangles for v in triangle} == set(merged_into)
    assert mesh.unused.tolist() == [i for i, kept in enumerate(merged_into) if kept != i]


# --- the corpus ---


@pytest.mark.parametrize("n", [300, pytest.param(1000, marks=EXHAUSTIVE)])
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", CORPUS)
def test_every_circle_is_empty_of_every_point(name, way, n):
    points = CORPUS[name](n)
    check_mesh(points, WAYS[way](points))


@pytest.mark.parametrize("n", [300, pytest.param(10_000, marks=EXHAUSTIVE)])
@pytest.mark.parametrize("name", CORPUS)
def test_any_triangulation_covers_the_hull_with_all_points(name, n):
    points = CORPUS[name](n)
    exact.check_triangulation(points, fm.any_triangulation(points).tolist())


@pytest.mark.parametrize("n", [5000, pytest.param(50_000, marks=EXHAUSTIVE)])
@pytest.mark.parametrize("name", CORPUS)
def test_large_sets_have_empty_circles_and_as_many_triangles_as_in_triangle(name, n):
    points = CORPUS[name](n)
    mesh = fm.delaunay(points)
    check_mesh(points, mesh, exact.check_across_edges)
    assert len(mesh.triangles) == len(shewchuk.triangulate({"vertices": points})["triangles"])


@pytest.mark.parametrize(
    ("name", "n"),
    [(name, 5000) for name in NO_TIES]
    + [pytest.param(name, 50_000, marks=EXHAUSTIVE) for name in ("uniform", "spiral", "points_at_1e38", "points_at_1e_40")],
)
def test_without_ties_the_triangles_are_those_of_qhull(name, n):
    points = CORPUS[name](n)
    mesh = fm.delaunay(points)
    assert exact.is_unique(points, mesh.triangles.tolist())
    assert as_set(mesh.triangles) == as_set(Qhull(points).simplices)


@pytest.mark.parametrize("n", [5000, pytest.param(20_000, marks=EXHAUSTIVE)])
@pytest.mark.parametrize("name", CORPUS)
def test_flips_alone_get_there_on_large_sets(name, n):
    points = CORPUS[name](n)
    mesh = fm.delaunay(points, triangles=fm.any_triangulation(points))
    exact.check_triangulation(points, mesh.triangles.tolist())
    exact.check_across_edges(points, mesh.triangles.tolist())


# --- properties ---

lattice_points = (
    st.integers(1, 8)
    .flatmap(lambda side: st.lists(st.tuples(*2 * [st.integers(0, side)]), min_size=3, max_size=40))
    .filter(lambda points: any(exact.turn(points[0], q, r) for q, r in itertools.combinations(points, 2)))
)
float_points = st.lists(st.tuples(*2 * [st.floats(-1, 1).map(lambda x: x if abs(x) > 1e-40 else 0.0)]), min_size=3, max_size=25)
some_points = st.one_of(lattice_points, float_points).filter(
    lambda points: exact.hull_area(points) > 0 if len(set(points)) > 2 else False
)
randoms = st.randoms(use_true_random=False)


@for_all(60, points=some_points)
def test_lattices_and_floats_with_ties_and_duplicates_anywhere(points):
    for way in WAYS.values():
        check_mesh(points, way(points))


@for_all(60, points=some_points, shuffle=randoms)
def test_the_order_of_the_points_changes_neither_which_are_used_nor_the_hull(points, shuffle):
    order = list(range(len(points)))
    shuffle.shuffle(order)
    shuffled = [points[i] for i in order]
    mesh, other = fm.delaunay(points), fm.delaunay(shuffled)
    check_mesh(shuffled, other)
    assert len(other.triangles) == len(mesh.triangles)
    assert exact_area(other) == exact_area(mesh)
    assert used(other) == used(mesh)
    assert other.merged_into.tolist() == lowest_equal(shuffled)


@for_all(60, points=some_points, shuffle=randoms)
def test_any_order_of_insertion_gives_a_delaunay_triangulation(points, shuffle):
    points = list(dict.fromkeys(points))  # of equal points the one inserted first stays
    order = list(range(len(points)))
    shuffle.shuffle(order)
    mesh, inserted = fm.delaunay(points), play(fm.bowyer_watson(points, order=order))
    check_mesh(points, inserted)
    if exact.is_unique(points, mesh.triangles.tolist()):
        assert as_set(inserted.triangles) == as_set(mesh.triangles)


def exact_area(mesh):
    """Twice the area, in the units of ``exact.integers``."""
    whole = exact.integers(mesh.points.tolist())
    return sum(exact.turn(*(whole[v] for v in triangle)) for triangle in mesh.triangles.tolist())


def used(mesh):
    return set(map(tuple, mesh.points[mesh.triangles.ravel()].tolist()))


@for_all(60, points=some_points, power=st.integers(-8, 60))
def test_scaling_by_a_power_of_two_gives_the_same_triangles_bit_for_bit(points, power):
    mesh, scaled = fm.delaunay(points), fm.delaunay(np.array(points) * 2.0**power)
    assert np.array_equal(mesh.triangles, scaled.triangles)
    assert np.array_equal(mesh.neighbors, scaled.neighbors)


@for_all(60, points=lattice_points, dx=st.integers(-(2**40), 2**40), dy=st.integers(-(2**40), 2**40))
def test_ties_stay_ties_when_the_points_move_together(points, dx, dy):
    moved = [(x + dx, y + dy) for x, y in points]
    mesh, other = fm.delaunay(points), fm.delaunay(moved)
    check_mesh(moved, other)
    if exact.is_unique(points, mesh.triangles.tolist()):
        assert as_set(other.triangles) == as_set(mesh.triangles)


@for_all(60, points=some_points)
def test_a_mirror_mirrors_the_triangles(points):
    mesh = fm.delaunay(points)
    for mirrored in ([(-x, y) for x, y in points], [(y, x) for x, y in points]):
        other = fm.delaunay(mirrored)
        check_mesh(mirrored, other)
        assert len(other.triangles) == len(mesh.triangles)
        if exact.is_unique(points, mesh.triangles.tolist()):
            assert as_set(other.triangles) == as_set(mesh.triangles)


@for_all(60, points=some_points)
def test_flips_lead_from_any_start_to_the_same_triangles(points):
    mesh = fm.delaunay(points)
    unique = exact.is_unique(points, mesh.triangles.tolist())
    for turned in ([(x, y) for x, y in points], [(-y, x) for x, y in points], [(-x, -y) for x, y in points]):
        flipped = fm.delaunay(points, triangles=fm.any_triangulation(turned))
        check_mesh(points, flipped)
        assert not unique or as_set(flipped.triangles) == as_set(mesh.triangles)


@for_all(60, points=some_points)
def test_a_start_with_a_notch_is_refused(points):
    start = fm.any_triangulation(points).tolist()
    left = exact.apexes(start)
    outside = {v for a, b in left if (b, a) not in left for v in (a, b)}
    notches = [{a, b, apex} for (a, b), apex in left.items() if (b, a) not in left and apex not in outside]
    assume(notches)
    notched = [triangle for triangle in start if set(triangle) != notches[0]]
    with pytest.raises(fm.MeshError, match=r"hull is not covered|hole|triangles only touch|in no triangle"):
        fm.delaunay(points, triangles=notched)


@for_all(60, points=some_points)
def test_the_same_points_give_the_same_mesh_bit_for_bit(points):
    assert np.array_equal(fm.delaunay(points).triangles, fm.delaunay(points).triangles)
    recorded = play(fm.bowyer_watson(points, order="brio"))
    assert np.array_equal(fm.delaunay(points).triangles, recorded.triangles)


# --- input ---


@pytest.mark.parametrize(
    ("points", "note"),
    [
        ([], "0 points"),
        (np.empty((0, 2)), "0 points"),
        ([(1, 2)], "1 point,"),
        ([(1, 2), (3, 4)], "2 points"),
        ([(1, 2), (3, 4), (1, 2)], "line|equal|needs 3"),
        ([(7, 7)] * 5, "equal"),
        ([(0, 0), (1, 1), (2, 2), (5, 5)], "one line"),
        ([(0, i / 10) for i in range(50)], "one line"),
        ([(x, 3 * x) for x in random(2000).astype(np.float32).tolist()], "one line"),
    ],
    ids=["empty list", "empty array", "one", "two", "two and a copy", "all equal", "diagonal", "upright", "many"],
)
def test_points_that_make_no_triangle_give_a_mesh_that_says_why(points, note):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for mesh in (fm.delaunay(points), play(fm.bowyer_watson(points))):
            assert mesh.triangles.shape == mesh.neighbors.shape == (0, 3)
            assert pytest.approx(np.array(points, float).reshape(-1, 2)) == mesh.points
            assert mesh.merged_into.tolist() == lowest_equal(points)
            assert any(word in mesh.note for word in note.split("|"))
            assert mesh.find(0, 0) == -1
            assert np.isnan(mesh.interpolate(np.zeros(len(points)), 0, 0))
    with pytest.raises(fm.MeshError, match="no triang"):
        fm.any_triangulation(points)


@pytest.mark.parametrize("make", [list, tuple, np.array, np.float32, np.int16, lambda p: [np.array(q) for q in p]])
def test_lists_tuples_integers_and_arrays_are_points(make):
    mesh = fm.delaunay(make(SQUARE))
    assert mesh.points.dtype == np.float64
    assert mesh.triangles.dtype == mesh.neighbors.dtype == np.int32
    assert mesh.note == ""
    check_mesh(SQUARE, mesh)


NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([(0, 0), (1, NAN)], r"point 1 = \(1.0, nan\) is not finite"),
        ([(0, 0), (1, 0), (-INF, 0)], r"point 2 = \(-inf, 0.0\) is not finite"),
        ([(0, 0), (1, None)], "point 1"),
        ([(0, 0), (1,)], r"point 1 is \(1,\), not a pair"),
        ([(0, 0), (1, 2), (3, 4, 5)], r"point 2 is \(3, 4, 5\), not a pair"),
        ([1, 2, 3], "point 0 is 1, not a pair"),
        ([(0, 0), (0, 1e-300)], r"point 1 .* outside 2\^-142 .. 2\^201"),
        ([(0, 0), (0, 1), (2.0**202, 0)], r"point 2 .* outside 2\^-142 .. 2\^201"),
        ([(0, 0), (2**54 + 1, 1)], "point 1 .* 18014398509481985|point 1 = .18014398509481985"),
        ([(0, 0), (10**400, 1)], "point 1"),
        ([(0, 0), ("a", 1)], "real numbers"),
        ([(0, 0), ("1", 1)], "real numbers"),
        ([(0, 0), (1, 1j)], "real numbers"),
        ("abc", "point 0 is 'a'"),
        (["ab", "cd"], r"shape \(n, 2\)"),
        (None, r"shape \(n, 2\)"),
        (5, r"shape \(n, 2\)"),
        (np.zeros((4, 3)), r"shape \(n, 2\), not \(4, 3\)"),
        (np.zeros((2, 2, 2)), r"shape \(n, 2\), not \(2, 2, 2\)"),
    ],
    ids=lambda value: str(value)[:40],
)
def test_what_are_no_points_is_refused_with_the_row(points, message):
    for way in WAYS.values():
        with pytest.raises(fm.MeshError, match=message):
            way(points)


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ([], "no triangle to start from"),
        ("abc", r"shape \(m, 3\)"),
        ([(0, 1)], r"shape \(m, 3\)"),
        ([(0.5, 1, 2)], "integers"),
        ([*FAN[:3], (3, 0, 9)], r"triangle 3 = \(3, 0, 9\)"),
        ([*FAN, FAN[0]], "triangles 0 .* and 4 .* same side"),
        ([(0, 1, 2), (0, 2, 3)], r"point 4 .* in no triangle"),
        ([FAN[0], FAN[2]], "touch|no triangle"),
    ],
    ids=["none", "word", "pairs", "floats", "bad index", "twice", "unused point", "pinch"],
)
def test_a_start_that_is_no_triangulation_is_refused(start, message):
    with pytest.raises(fm.MeshError, match=message):
        fm.delaunay(SQUARE, triangles=start)


@pytest.mark.parametrize("order", [[0, 1, 2], [0, 1, 2, 3, 3], [0, 1, 2, 3, 9], [0.5] * 5, "sorted"])
def test_an_order_must_name_each_point_once(order):
    with pytest.raises(fm.MeshError, match="order must"):
        play(fm.bowyer_watson(SQUARE, order=order))


# --- the mesh ---

THIN = ["nearly_flat", "grid_turned_by_302_degrees", "vertex_1e_15_into_the_bottom_side", "triangle_2e_6_by_53"]
ROUND = ["uniform", "grid_of_ties", "duplicates", "ring_with_centre", "points_at_1e38", "star_outline", "signed_zeros"]
SIZES = [100, pytest.param(1000, marks=EXHAUSTIVE)]


def queries(mesh):
    """Points inside and outside; all vertices; a rounded middle of an edge of each triangle."""
    low, size = mesh.points.min(axis=0), np.ptp(mesh.points, axis=0)
    middles = mesh.points[mesh.triangles[:, :2]].mean(axis=1)
    result = np.vstack([low + size * (1.2 * random(100, 2, seed=4) - 0.1), mesh.points, middles])
    return np.where(np.abs(result) < 2.0**-142, 0, result).T


def look_everywhere(mesh, x, y):
    """For each query the first triangle that holds it, or -1, and the share of each vertex there, as fractions."""
    whole = exact.integers([*mesh.points.tolist(), *zip(x, y, strict=True)])
    corners = [[whole[v] for v in triangle] for triangle in mesh.triangles.tolist()]
    for q in whole[len(mesh.points) :]:
        weights = ((exact.turn(b, c, q), exact.turn(c, a, q), exact.turn(a, b, q)) for a, b, c in corners)
        t, found = next(((t, w) for t, w in enumerate(weights) if min(w) >= 0), (-1, ()))
        yield t, [Fraction(w, sum(found)) for w in found]


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("name", ROUND + THIN)
def test_a_point_is_found_in_the_first_triangle_that_holds_it(name, n):
    mesh = fm.delaunay(CORPUS[name](n))
    x, y = queries(mesh)
    expected = [t for t, _ in look_everywhere(mesh, x, y)]
    assert -1 in expected
    assert mesh.find(x, y).tolist() == expected


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("name", ROUND)
def test_interpolation_weighs_the_three_vertices_around(name, n):
    mesh = fm.delaunay(CORPUS[name](n))
    values, (x, y) = random(n, seed=5)[: len(mesh.points)], queries(mesh)
    expected = [
        float(sum(share * Fraction(values[v]) for share, v in zip(shares, mesh.triangles[t].tolist(), strict=True)))
        if t >= 0
        else NAN
        for t, shares in look_everywhere(mesh, x, y)
    ]
    assert mesh.interpolate(values, x, y) == pytest.approx(expected, rel=1e-9, abs=1e-9, nan_ok=True)


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("name", THIN)
def test_interpolated_values_lie_between_those_at_the_vertices_however_thin_the_triangle(name, n):
    mesh = fm.delaunay(CORPUS[name](n))
    values, (x, y) = random(n, seed=5)[: len(mesh.points)], queries(mesh)
    t = mesh.find(x, y)
    corners, result = values[mesh.triangles[t]], mesh.interpolate(values, x, y)
    inside = t >= 0
    assert np.isnan(result[~inside]).all()
    assert (corners.min(axis=1) - 1e-9 <= result)[inside].all()
    assert (corners.max(axis=1) + 1e-9 >= result)[inside].all()


def test_find_and_interpolate_take_numbers_and_arrays_of_any_shape():
    mesh = fm.delaunay(SQUARE)
    values = [2 * x - 3 * y + 1 for x, y in SQUARE]
    x, y = np.meshgrid([0.25, 0.5, 1.75], [0.5, 1.5])
    assert isinstance(mesh.find(1, 0.5), int)
    assert mesh.find(x, y).shape == (2, 3)
    assert mesh.interpolate(values, x, y) == pytest.approx(2 * x - 3 * y + 1)
    assert mesh.interpolate(values, 1, 0.5) == pytest.approx(1.5)
    assert mesh.find([], []).shape == (0,)
    with pytest.raises(fm.MeshError, match=r"shape \(5,\), not \(2,\)"):
        mesh.interpolate([1, 2], 1, 1)
    with pytest.raises(fm.MeshError, match="not finite"):
        mesh.find(NAN, 1)


@pytest.mark.parametrize("name", CORPUS)
def test_neighbors_lie_opposite_the_corners_and_name_each_other(name):
    mesh = fm.delaunay(CORPUS[name](300))
    owner = {}
    for t, (a, b, c) in enumerate(mesh.triangles.tolist()):
        owner |= {(b, c): t, (c, a): t, (a, b): t}
    expected = [[owner.get((c, b), -1), owner.get((a, c), -1), owner.get((b, a), -1)] for a, b, c in mesh.triangles.tolist()]
    assert mesh.neighbors.tolist() == expected
    assert all(t in expected[other] for t, row in enumerate(expected) for other in row if other >= 0)


def test_a_mesh_cannot_be_changed():
    points = np.array(SQUARE, dtype=float)
    mesh = fm.delaunay(points)
    for name in ("points", "triangles", "neighbors", "merged_into", "segments", "note", "unused", "colour"):
        with pytest.raises(AttributeError):
            setattr(mesh, name, None)
    for array in (mesh.points, mesh.triangles, mesh.neighbors, mesh.merged_into, mesh.segments):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 0
    with pytest.raises(TypeError):
        mesh.work["flips"] = 0
    points[:] = 0
    assert mesh.points.tolist() == np.array(SQUARE, float).tolist()


def test_no_part_of_a_mesh_can_be_deleted():
    mesh = fm.delaunay(SQUARE)
    with pytest.raises(AttributeError):
        del mesh.points


def test_angles_and_areas_are_those_of_the_right_triangle():
    mesh = fm.delaunay([(0, 0), (4, 0), (0, 4)])
    assert sorted(mesh.angles().ravel()) == pytest.approx([45, 45, 90])
    assert mesh.areas() == pytest.approx([8])
    assert mesh.min_angle == pytest.approx(45)
    assert np.isnan(fm.delaunay([]).min_angle)


@pytest.mark.parametrize("name", CORPUS)
def test_angles_sum_to_180_degrees_and_every_mesh_is_valid(name):
    mesh = fm.delaunay(CORPUS[name](300))
    assert mesh.validate(delaunay=True) is mesh
    assert mesh.is_delaunay()
    assert mesh.angles().min() >= 0
    if name not in ("nearly_flat", "grid_turned_by_302_degrees"):  # where differences lose all digits
        assert mesh.angles().sum(axis=1) == pytest.approx(180)


# --- broken meshes ---

NOT_A_TRIANGULATION = {  # points, triangles, what validate says
    "a bad index": (SQUARE, [*FAN[:3], (3, 0, 5)], r"triangle 3 = \(3, 0, 5\) names a point that is not there"),
    "a negative index": (SQUARE, [*FAN[:3], (3, 0, -1)], r"triangle 3 = \(3, 0, -1\) names a point that is not there"),
    "a vertex twice": (SQUARE, [*FAN[:3], (3, 3, 4)], r"triangle 3 = \(3, 3, 4\) names a point twice"),
    "a triangle twice": (SQUARE, [*FAN, (1, 4, 0)], "triangles 0 .* and 4 .* same side of edge 0-1"),
    "one clockwise": (SQUARE, [(0, 4, 1), *FAN[1:]], "triangles 0 .* same side of edge 0-4"),
    "all clockwise": (SQUARE, [t[::-1] for t in FAN], "triangle 0 .* clockwise"),
    "a fold": ([(0, 0), (4, 0), (4, 4), (3, 1)], [(0, 1, 2), (0, 2, 3)], "triangle 1 .* clockwise"),
    "a flat triangle": ([(0, 0), (1, 0), (2, 0), (1, 1)], [(0, 1, 2), (0, 2, 3)], "triangle 0 .* flat"),
    "a pinch": (SQUARE, [FAN[0], FAN[2]], r"passes point 4 at \(1, 1\) 2 times"),
    "two that overlap": (
        [(0, 0), (4, 0), (0, 4), (1, 1), (5, 1), (1, 5)],
        [(0, 1, 2), (3, 4, 5)],
        "edges 1-2 and 3-4 cross .* overlap",
    ),
    "one inside another": ([(0, 0), (9, 0), (0, 9), (1, 1), (2, 1), (1, 2)], [(0, 1, 2), (3, 4, 5)], "overlap|inside"),
    "a fan that goes round twice": (
        np.vstack([[(0, 0)], on_circle(np.pi * np.arange(12) / 3) * np.repeat([1, 2], 6)[:, None]]),
        [(0, 1 + i, 1 + (i + 1) % 12) for i in range(12)],
        "cross .* overlap",
    ),
    "floats": (SQUARE, [(0.5, 1, 4)], "integers"),
    "pairs": (SQUARE, [(0, 1)], r"shape \(m, 3\)"),
    "nan": ([(0, 0), (1, 0), (0, NAN)], [(0, 1, 2)], "point 2 .* not finite"),
}
NOT_DELAUNAY = {
    "a circle that holds a point": (
        [(0, 0), (4, 0), (5, 3), (1, 2)],
        [(0, 1, 2), (0, 2, 3)],
        "circle of triangle 0 .* point 3",
    ),
    "a notch": (SQUARE, FAN[:3], r"hull is not covered: .* point 4, \(1, 1\)"),
    "a missing point": (SQUARE, [(0, 1, 2), (0, 2, 3)], r"point 4 at \(1, 1\) is in no triangle"),
    "two pieces": ([(0, 0), (1, 0), (0, 1), (5, 0), (6, 0), (5, 1)], [(0, 1, 2), (3, 4, 5)], "hull is not covered|pieces"),
    "no triangle": (SQUARE, [], "no triangle|not covered"),
    "a hole": (
        [(0, 0), (9, 0), (0, 9), (2, 2), (3, 2), (2, 3)],
        [(0, 1, 3), (1, 4, 3), (1, 2, 4), (2, 5, 4), (2, 0, 5), (0, 3, 5)],
        "circle|hull is not covered|hole",
    ),
}


@pytest.mark.parametrize("flaw", NOT_A_TRIANGULATION)
def test_a_broken_mesh_is_refused(flaw):
    points, triangles, message = NOT_A_TRIANGULATION[flaw]
    for delaunay in (False, True):
        with pytest.raises(fm.MeshError, match=message):
            fm.validate(points, triangles, delaunay=delaunay)


@pytest.mark.parametrize("flaw", NOT_DELAUNAY)
def test_a_mesh_that_is_not_delaunay_is_refused_only_as_such(flaw):
    points, triangles, message = NOT_DELAUNAY[flaw]
    fm.validate(points, triangles, delaunay=False)
    assert fm.Mesh(points, triangles).validate() is not None
    assert not fm.Mesh(points, triangles).is_delaunay()
    with pytest.raises(fm.MeshError, match=message):
        fm.validate(points, triangles)
    with pytest.raises(fm.MeshError, match=message):
        fm.Mesh(points, triangles).validate(delaunay=True)


@for_all(150, points=some_points, shuffle=randoms)
def test_whatever_is_done_to_one_triangle_is_noticed(points, shuffle):
    triangles = fm.delaunay(points).triangles.tolist()
    t, i, stranger = shuffle.randrange(len(triangles)), shuffle.randrange(3), shuffle.choice(triangles)[0]
    a, b, c = triangles[t][i:] + triangles[t][:i]
    rest = triangles[:t] + triangles[t + 1 :]
    exact.check_triangulation(points, triangles)
    fm.validate(points, triangles)
    for flaw in ([], [(a, c, b)], [(a, b, a)], [(a, b, c), (b, c, a)], [(a, b, len(points))], [(a, b, stranger)]):
        if flaw != [(a, b, c)]:
            with pytest.raises(fm.MeshError):
                fm.validate(points, rest + flaw)


@for_all(60, points=some_points, shuffle=randoms)
def test_a_flip_is_noticed_unless_the_four_points_share_a_circle(points, shuffle):
    triangles = fm.delaunay(points).triangles.tolist()
    left, whole = exact.apexes(triangles), exact.integers(points)
    convex = [
        (a, b, c, left[b, a])
        for (a, b), c in left.items()
        if (b, a) in left and min(exact.turn(*(whole[v] for v in t)) for t in ((c, left[b, a], b), (left[b, a], c, a))) > 0
    ]
    assume(convex)
    a, b, c, d = shuffle.choice(convex)
    flipped = [t for t in triangles if set(t) not in ({a, b, c}, {a, b, d})] + [(c, d, b), (d, c, a)]
    exact.check_triangulation(points, flipped)
    fm.validate(points, flipped, delaunay=False)
    assert fm.Mesh(points, flipped).is_delaunay() == (exact.inside(*(whole[v] for v in (a, b, c, d))) == 0)


def test_the_corpus_holds_what_its_names_say():
    """A recipe that rounding has made harmless would test nothing."""
    ring = CORPUS["ring_exact"](300)
    assert len({x * x + y * y for x, y in ring.astype(int).tolist()}) == 1
    assert len(set(map(tuple, ring.tolist()))) == 300
    assert Counter(lowest_equal(CORPUS["duplicates"](300))).most_common(1)[0][1] > 1
    assert lowest_equal(CORPUS["ring_with_last_vertex_repeated"](300))[-1] == 0
    assert lowest_equal(CORPUS["points_2e_17_apart_astride_an_edge"](0)) == list(range(6))
    for name in NO_TIES:
        assert exact.is_unique(CORPUS[name](300), fm.delaunay(CORPUS[name](300)).triangles.tolist())
