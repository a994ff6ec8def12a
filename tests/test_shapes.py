"""Shapes are closed, have the area that a formula says, know their curves, and are as symmetric as they look."""

import inspect
import itertools
import math

import numpy as np
import pytest
from exact import integers
from test_domain import meetings_of

import fem_mesh as fm
from fem_mesh.domain import shapes
from fem_mesh.domain.curves import Circle, Parametric
from fem_mesh.domain.letters import OUTLINES

GRAIN = 2.0**30
SHAPES = [name for name, thing in vars(shapes).items() if inspect.isfunction(thing) and thing.__module__ == shapes.__name__]
SHAPES = sorted(name for name in SHAPES if not name.startswith("_"))
EVERY = [(name, getattr(shapes, name)()) for name in SHAPES] + [(f"letter {c}", shapes.letter(c)) for c in OUTLINES]
every = pytest.mark.parametrize("domain", [domain for _, domain in EVERY], ids=[name for name, _ in EVERY])


def area(domain):
    """What the loops enclose, by parity: each loop counts against those around it, whichever way it runs."""
    loops, segments = [], domain.segments[domain.toggles].tolist()
    after = dict(segments)
    assert len(after) == len(segments)
    while after:
        v = next(iter(after))
        loop = []
        while v in after:
            loop.append(v)
            v = after.pop(v)
        assert v == loop[0], "a loop is not closed"
        loops.append(domain.points[loop])
    sizes = [abs(np.sum(p[:, 0] * np.roll(p[:, 1], -1) - p[:, 1] * np.roll(p[:, 0], -1))) / 2 for p in loops]
    return max(sizes) - (sum(sizes) - max(sizes))  # here all other loops are holes


def polygon(n, radius=1.0):
    return n * radius**2 * math.sin(2 * math.pi / n) / 2


def test_all_shapes_are_here():
    wanted = "square l_shape disk annulus plate_with_hole airfoil turbine_blade gear letter cracked_square star"
    assert sorted(wanted.split()) == SHAPES


@every
def test_a_shape_has_closed_loops_names_and_nothing_to_report(domain):
    assert domain.report == ()
    assert all(domain.names)
    degree = np.bincount(domain.segments[domain.toggles].ravel(), minlength=len(domain.points))
    assert set(degree.tolist()) <= {0, 2}
    assert area(domain) > 0


@every
def test_a_shapes_coordinates_are_multiples_of_a_grain(domain):
    assert (domain.points * GRAIN == np.round(domain.points * GRAIN)).all()


@every
def test_a_shapes_segments_meet_in_their_ends_only(domain):
    assert meetings_of(domain.points, domain.segments.tolist()) == []


@every
def test_a_shapes_curves_pass_through_the_ends_and_stay_near(domain):
    for row, curve in domain.curves.items():
        a, b = map(tuple, domain.points[domain.segments[row]].tolist())
        chord = math.dist(a, b)
        assert curve.miss(a, b) <= 1e-9
        m = curve.between(a, b)
        assert math.dist(m, a) == pytest.approx(math.dist(m, b), rel=1e-6)
        assert chord / 2 <= math.dist(m, a) <= 0.6 * chord
        q = curve.between(a, m)
        assert math.dist(q, a) == pytest.approx(math.dist(q, m), rel=1e-6)
        if isinstance(curve, Circle):
            assert math.dist(m, curve.center) == pytest.approx(curve.radius, rel=1e-14)


@every
def test_all_segments_of_a_curved_part_are_curved(domain):
    curved = {domain.names[row] for row in domain.curves}
    straight = {name for row, name in enumerate(domain.names) if row not in domain.curves}
    assert curved & straight <= {"teeth"}  # whose flanks are straight


@pytest.mark.parametrize(
    ("domain", "expected"),
    [
        (shapes.square(), 1),
        (shapes.square(3), 9),
        (shapes.l_shape(), 3),
        (shapes.l_shape(4), 12),
        (shapes.cracked_square(), 4),
        (shapes.disk(), polygon(32)),
        (shapes.disk(0.001, 7), polygon(7, 0.001)),
        (shapes.disk(1e6, 100), polygon(100, 1e6)),
        (shapes.annulus(), polygon(48) - polygon(48, 0.5)),
        (shapes.annulus(1, 3, 6), polygon(6, 3) - polygon(6)),
        (shapes.plate_with_hole(), 4 - polygon(64, 0.5)),
        (shapes.plate_with_hole(3, 2, 0.1, 9), 6 - polygon(9, 0.1)),
        (shapes.star(), 10 * 0.5 * shapes.CLASSIC * math.sin(math.pi / 5)),
        (shapes.star(7, 2, 1), 14 * 0.5 * 2 * math.sin(math.pi / 7)),
        (shapes.letter("L"), (9 * 14 - 6 * 11) / 14**2),
        (shapes.letter("I"), (2 * 7 * 3 + 3 * 8) / 14**2),
    ],
)
def test_a_shape_has_the_area_of_its_formula(domain, expected):
    assert area(domain) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("make", [shapes.disk, shapes.annulus, shapes.plate_with_hole])
def test_round_shapes_come_nearer_to_their_area_with_the_square_of_n(make):
    limit = {"disk": math.pi, "annulus": math.pi * 0.75, "plate_with_hole": 4 - math.pi / 4}[make.__name__]
    off = [abs(area(make(n=n)) - limit) for n in (40, 80, 160)]
    assert off[0] / off[1] == pytest.approx(4, rel=0.01)
    assert off[1] / off[2] == pytest.approx(4, rel=0.01)


def test_the_air_around_a_foil_has_the_box_without_the_foil():
    for code, thickness in (("0012", 0.12), ("0006", 0.06)):
        s = np.linspace(0, 1, 100_001)
        half = 5 * thickness * (0.2969 * s - 0.1260 * s**2 - 0.3516 * s**4 + 0.2843 * s**6 - 0.1036 * s**8)
        foil = np.sum((half[1:] + half[:-1]) * np.diff(s**2))
        assert area(shapes.airfoil(code, n=400)) == pytest.approx(3.5 * 2.5 - foil, abs=2e-5)


def test_a_foil_begins_and_ends_on_its_chord_and_is_as_thick_as_its_code_says():
    foil = shapes.airfoil("2412", n=200)
    points = foil.points[4:]
    assert [0, 0] in points.tolist()
    assert [1, 0] in points.tolist()
    upper, lower = (np.array([[f(s)[1] for s in np.sqrt(np.linspace(0, 1, 2001))]]) for f in surfaces("2412"))
    assert (upper - lower).max() == pytest.approx(0.12, abs=5e-4)
    assert ((upper + lower) / 2).max() == pytest.approx(0.02, abs=2e-4)


def surfaces(code):
    return shapes._FoilSide(code, 1.0), shapes._FoilSide(code, -1.0)


@pytest.mark.parametrize("code", ["2412", "0012", "4415", "6321", "0001"])
def test_a_foils_nose_is_smooth(code):
    foil = shapes.airfoil(code, n=40)
    assert foil.report == ()
    upper, lower = surfaces(code)
    for s in (1e-3, 1e-6):
        (ax, ay), (bx, by) = upper(s), lower(s)
        assert abs(math.remainder(math.atan2(ay, ax) - math.atan2(-by, -bx), math.pi)) < 3 * s / (int(code[2:]) / 100)


def test_a_foils_segments_crowd_at_both_its_ends():
    foil = shapes.airfoil("0012", n=64)
    lengths = np.hypot(*np.diff(foil.points[foil.segments[4:]], axis=1)[:, 0].T)
    nose, middle, tail = lengths[31], lengths[16], lengths[0]
    assert nose < middle / 3
    assert tail < middle / 3


def test_a_blade_is_smooth_where_its_curves_meet():
    blade = shapes.turbine_blade()
    pieces = [blade.curves[row] for row in range(len(blade.segments))]
    assert all(isinstance(piece, Parametric) for piece in pieces)
    for one, other in zip(pieces, pieces[1:] + pieces[:1], strict=True):
        assert one.at(one.end) == pytest.approx(other.at(other.start), abs=1e-12)
        step = 1e-7
        p, q, r = one.at(one.end - step), one.at(one.end), other.at(other.start + step)
        before, after = (math.atan2(v[1] - u[1], v[0] - u[0]) for u, v in ((p, q), (q, r)))
        assert abs(math.remainder(before - after, 2 * math.pi)) < 1e-3


@pytest.mark.parametrize("n", [14, 15, 23, 40, 100])
def test_a_blade_can_have_fewer_and_more_chords(n):
    blade = shapes.turbine_blade(n)
    assert blade.report == ()
    assert n - 3 <= len(blade.points) <= n + 5


@pytest.mark.parametrize(
    ("domain", "mirrors"),
    [
        (shapes.disk(), "xyd"),
        (shapes.annulus(), "xyd"),
        (shapes.plate_with_hole(), "xyd"),
        (shapes.gear(), "xyd"),
        (shapes.cracked_square(), "y"),
        (shapes.star(), "x"),
        (shapes.star(6), "xy"),
        (shapes.airfoil("0012", box=(-1, 2, -1, 1)), "y"),
    ],
)
def test_what_looks_symmetric_is_so_to_the_last_bit(domain, mirrors):
    for mirror in mirrors:
        image = {"x": domain.points * (-1, 1), "y": domain.points * (1, -1), "d": domain.points[:, ::-1]}[mirror] + 0.0
        assert set(map(tuple, image.tolist())) == set(map(tuple, domain.points.tolist()))


def test_corners_to_refine_at_are_at_the_origin():
    for domain in (shapes.l_shape(), shapes.l_shape(7), shapes.cracked_square(3)):
        (v,) = np.flatnonzero((domain.points == 0).all(axis=1))
        name = "corner" if domain.toggles.all() else "crack"
        assert {domain.names[row] for row in np.flatnonzero((domain.segments == v).any(axis=1))} == {name}


def test_a_crack_starts_on_a_side_that_does_not_know_its_vertex():
    domain = shapes.cracked_square()
    assert not domain.toggles[-1]
    assert domain.toggles[:4].all()
    assert domain.points[4].tolist() == [-1, 0]


def test_a_gears_tips_and_roots_lie_on_their_circles():
    gear = shapes.gear(teeth=9, outer=2, root=1.5, bore=0.5)
    radius = np.hypot(*gear.points[:36].T)
    assert radius == pytest.approx(np.tile([1.5, 2, 2, 1.5], 9), abs=1e-8)
    assert {round(curve.radius, 3) for curve in gear.curves.values()} == {2.0, 1.5, 0.5}


def test_every_letter_has_its_holes():
    holes = {c: sum(name.startswith("hole") for name in set(shapes.letter(c).names)) for c in OUTLINES}
    assert "".join(OUTLINES) == "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
    assert {c: n for c, n in holes.items() if n} == {"A": 1, "B": 2, "D": 1, "O": 1, "P": 1, "Q": 1, "R": 1}


@pytest.mark.parametrize("side", [0.1, 1 / 3, 1e-6])
def test_lengths_that_are_given_are_kept_to_the_last_bit(side):
    assert shapes.square(side).points.max() == side
    assert shapes.l_shape(side).points.max() == side / 2
    assert shapes.plate_with_hole(side, side, side / 4).points.max() == side / 2


@pytest.mark.parametrize("scale", [1e-3, 0.3, 7, 1e5])
def test_shapes_of_any_size_fit_their_curves(scale):
    for domain in (
        shapes.disk(scale),
        shapes.annulus(scale / 3, scale),
        shapes.plate_with_hole(scale, scale, scale / 5),
        shapes.gear(20, scale, 0.9 * scale, 0.2 * scale),
    ):
        assert domain.report == ()
        for row, curve in domain.curves.items():
            assert curve.miss(*domain.points[domain.segments[row]].tolist()) < 1e-9 * 2 * scale
    assert shapes.square(scale).points.max() == pytest.approx(scale, rel=1e-8)


def test_integers_of_any_shape_are_small():
    for _, domain in EVERY:  # sums and products of a few of them are exact
        assert all(abs(v) < 2**32 for v in itertools.chain(*integers(domain.points)))


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: shapes.square(0), "side must be a number > 0, not 0"),
        (lambda: shapes.square(math.nan), "side must be a number > 0"),
        (lambda: shapes.disk("1"), "radius must be a number > 0, not '1'"),
        (lambda: shapes.disk(n=2), "n must be an integer from 3 on, not 2"),
        (lambda: shapes.disk(n=8.0), "n must be an integer"),
        (lambda: shapes.annulus(2, 1), "inner radius must be smaller"),
        (lambda: shapes.plate_with_hole(radius=1), "hole of radius 1 does not fit into a plate of 2.0 x 2.0"),
        (lambda: shapes.star(1), "points must be an integer from 2 on"),
        (lambda: shapes.gear(3), "teeth must be an integer from 4 on"),
        (lambda: shapes.gear(root=1), "bore < root < outer"),
        (lambda: shapes.letter("a"), "from A to Z, and no 'a'"),
        (lambda: shapes.letter("AB"), "no 'AB'"),
        (lambda: shapes.airfoil("24120"), "four digits"),
        (lambda: shapes.airfoil(2412), "four digits"),
        (lambda: shapes.airfoil("2400"), "thickness > 0"),
        (lambda: shapes.airfoil("2012"), "first two digits are both 0 or neither"),
        (lambda: shapes.airfoil(n=33), "n = 33 must be even"),
        (lambda: shapes.airfoil(n=4), "n must be an integer from 8 on"),
        (lambda: shapes.airfoil(box=(0, 2, -1, 1)), "does not fit into the box"),
        (lambda: shapes.turbine_blade(3), "n must be an integer from 14 on"),
    ],
)
def test_shapes_that_cannot_be_are_refused(call, match):
    with pytest.raises(fm.MeshError, match=match):
        call()
