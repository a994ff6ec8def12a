"""Point sets, each named by what it breaks; and how many random cases a property is tried on.

``CORPUS[name](n)`` gives about n points, the same ones each time. The docstring is the reason it is here.
"""

import inspect
import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings

CORPUS: dict[str, Callable[[int], np.ndarray]] = {}
EXHAUSTIVE = pytest.mark.exhaustive


def point_set(make: Callable[..., object]) -> Callable[..., object]:
    """Enter ``make(n)``, or a recipe ``make()`` that has its own number of points."""
    sized = bool(inspect.signature(make).parameters)
    CORPUS[make.__name__] = lambda n: np.array(make(n) if sized else make(), dtype=float)
    return make


def for_all(cases: int, **strategies: object) -> Callable[[Callable[..., None]], Callable[[int], None]]:
    """A property tried on ``cases`` random cases; under the mark exhaustive on ten times as many."""

    def decorate(check: Callable[..., None]) -> Callable[[int], None]:
        @pytest.mark.parametrize("cases", [cases, pytest.param(10 * cases, marks=EXHAUSTIVE)])
        def test(cases: int) -> None:
            settings(max_examples=cases, deadline=None)(given(**strategies)(check))()

        test.__name__, test.__doc__ = check.__name__, check.__doc__
        return test

    return decorate


def random(*shape: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random(shape)


def nudged(values: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Each value moved by so many of its ulps."""
    return values + steps * np.spacing(values)


def on_circle(angles: np.ndarray, radius: float = 1.0) -> np.ndarray:
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)


def grid(columns: np.ndarray, rows: np.ndarray) -> np.ndarray:
    return np.array(np.meshgrid(columns, rows)).reshape(2, -1).T


def square_grid(n: int) -> np.ndarray:
    return grid(*2 * [np.arange(math.isqrt(n), dtype=float)])


def pythagorean_circle(n: int) -> list[tuple[int, int]]:
    """At least n integer points exactly on one circle about the origin: products of Gaussian integers of equal norm."""
    circle = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    for x, y in [(2, 1), (3, 2), (4, 1), (5, 2), (6, 1), (5, 4), (7, 2), (6, 5)]:
        if len(circle) >= n:
            break
        turns = [(x * x - y * y, 2 * x * y), (x * x + y * y, 0), (x * x - y * y, -2 * x * y)]
        circle = [(a * u - b * v, a * v + b * u) for a, b in circle for u, v in turns]
    return circle


@point_set
def uniform(n):
    """What every mesher gets right first."""
    return random(n, 2)


@point_set
def clusters(n):
    """Triangles of very different size side by side; searches by buckets slow down."""
    return random(1 + n // 20, 2).repeat(20, axis=0)[:n] + 1e-4 * random(n, 2, seed=1)


@point_set
def grid_of_ties(n):
    """Every square may be cut along either diagonal; every hull side holds many points."""
    return square_grid(n)


@point_set
def grid_turned_by_302_degrees(n):
    """Rows that are collinear but for rounding: slivers of no computed area at the hull."""
    t = math.radians(302.328)
    return square_grid(n) @ np.array([[math.cos(t), math.sin(t)], [-math.sin(t), math.cos(t)]])


@point_set
def grid_in_quarters(n):
    """seq(0.25, 50, 0.25) x seq(0.5, 50, 0.25), its first rows and columns."""
    side = 1 + math.isqrt(n)
    return grid(np.arange(0.25, 50.1, 0.25)[:side], np.arange(0.5, 50.1, 0.25)[: side - 1])


@point_set
def ring_rounded(n):
    """Cocircular but for rounding: a float in-circle contradicts itself."""
    return on_circle(2 * np.pi * np.arange(n) / n)


@point_set
def ring_exact(n):
    """Exactly cocircular integers: all signs are 0, and every triangulation is right."""
    return pythagorean_circle(n)[:n]


@point_set
def ring_with_centre(n):
    """A fan whose circles all pass through the centre."""
    return np.vstack([on_circle(2 * np.pi * np.arange(n - 1) / (n - 1)), [(0, 0)]])


@point_set
def ring_with_last_vertex_repeated(n):
    """A closed outline as people store it."""
    ring = on_circle(2 * np.pi * np.arange(n - 1) / (n - 1))
    return np.vstack([ring, ring[:1]])


@point_set
def ring_of_radius_128(n):
    """Irregular angles: with a float in-circle Lawson's flips go round for ever."""
    return on_circle(2 * np.pi * random(n), 128)


@point_set
def nine_points_of_radius_128():
    """The smallest ring on which float flips go round for ever."""
    return on_circle(2 * np.pi * random(9, seed=9), 128)


@point_set
def seventeen_gon():
    """Regular, of radius 3 about (1, 1): nearly cocircular away from the origin."""
    return 1 + on_circle(2 * np.pi * np.arange(17) / 17, 3)


@point_set
def lattice_of_fifteenths(n):
    """2 (i / 15) - 1: a lattice that rounding has moved, nearly collinear and cocircular everywhere."""
    i, j = np.divmod(np.random.default_rng(0).permutation(2 * n)[:n], 16)
    return 2 * (np.column_stack([i, j]) / 15) - 1


@point_set
def twenty_points_of_fifteenths():
    """The same, as small as it was reported."""
    return 2 * (np.random.default_rng(3).integers(0, 16, (20, 2)) / 15) - 1


@point_set
def nearly_flat(n):
    """A few ulps off the line y = x: areas are all rounding, signs are not."""
    x = random(n)
    return np.column_stack([x, nudged(x, np.random.default_rng(1).integers(-2, 3, n))])


@point_set
def offset_a_million(n):
    """Differences keep a third of the digits."""
    return 1e6 + random(n, 2)


@point_set
def aspect_a_million(n):
    """Needles: searches that assume a round cloud slow down."""
    return random(n, 2) * (1e6, 1)


@point_set
def metres_of_a_survey(n):
    """x in [512700, 512834], y over 5.4e6: map coordinates."""
    return (512700, 5.4e6) + random(n, 2) * (134, 90)


@point_set
def duplicates(n):
    """Each point about three times."""
    return random(1 + n // 3, 2)[np.random.default_rng(1).integers(0, 1 + n // 3, n)]


@point_set
def signed_zeros():
    """0.0 and -0.0 are one coordinate."""
    return [(0.0, 0.0), (1, 0.0), (-0.0, 1), (-0.0, 0.0), (1, -0.0), (0.0, -0.0)]


@point_set
def all_on_a_parabola(n):
    """Every point on the hull, of every degree: the quadratic case of insertion along a curve."""
    x = np.arange(n) / n
    return np.column_stack([x, x * x])


@point_set
def spiral(n):
    """A curve again: a space-filling order alone is quadratic here."""
    t = np.arange(1, n + 1)
    return on_circle(0.1 * t) * t[:, None]


@point_set
def two_parallel_lines(n):
    """First all points on one line, so that the first triangle comes late."""
    return [(i, 0) for i in range(n // 2)] + [(3 * i + 0.5, 7) for i in range(n - n // 2)]


@point_set
def star_outline(n):
    """Deep notches that the hull must fill."""
    return on_circle(2 * np.pi * np.arange(n) / n) * np.where(np.arange(n) % 2, 0.4, 1.0)[:, None]


@point_set
def one_ulp_apart_near_1e5(n):
    """Neighbouring doubles: no point lies between them."""
    return nudged(np.full((n, 2), 1e5), np.random.default_rng(0).integers(0, 1 + math.isqrt(n), (n, 2)))


@point_set
def three_points_one_ulp_apart():
    """The same with nothing near: a triangle of area 1e-22, inside a big one."""
    up = np.nextafter(1e5, 2e5)
    return [(0, 0), (1e5, 1e5), (up, 1e5), (1e5, up), (3e5, 0), (0, 3e5)]


@point_set
def vertex_1e_15_into_the_bottom_side():
    """A hull side that is not one: a square's bottom side with a vertex that far inside."""
    return [(0, 0), (0.5, 1e-15), (1, 0), (1, 1), (0, 1)]


@point_set
def triangle_2e_6_by_53():
    """Too thin for an absolute tolerance."""
    return [(0, 0), (53, 0), (0, 2e-6)]


@point_set
def triangle_of_negative_computed_area():
    """Counter-clockwise as given; but the computed area is -7e-18."""
    x = np.array([float.fromhex(h) for h in ("0x1.003708ea1cc70p-5", "0x1.00046cb1ab034p-1", "0x1.002b633c36d7ep-2")])
    return np.column_stack([x, nudged(x, np.full(3, -2))])


@point_set
def corner_stored_twice():
    """Two squares that share a corner, which has two numbers."""
    return [(0, 0), (1, 0), (1, 1), (0, 1), (1, 1), (2, 1), (2, 2), (1, 2)]


@point_set
def points_2e_17_apart_astride_an_edge():
    """Merged by a tolerance, they would be on the wrong side."""
    return [(0, 0), (1, 0), (0.5, 1), (0.5, -1), (0.5, 1e-17), (0.5, -1e-17)]


@point_set
def points_at_1e38(n):
    """Products beyond single precision's range; the fourth powers need 2^506."""
    return 1e38 * (0.5 - random(n, 2))


@point_set
def points_at_1e_40(n):
    """An absolute tolerance takes all of them for one."""
    return 1e-40 * (0.1 + random(n, 2))


@point_set
def both_scales_at_once(n):
    """A cluster of size 1e-40 at the corner of a cloud of size 1e38."""
    return np.vstack([points_at_1e_40(n // 2), points_at_1e38(n - n // 2)])


@point_set
def leg_486_high_and_1_wide():
    """An L-shape whose leg is so thin that the hull's triangle dwarfs it."""
    return [(0, 0), (20, 0), (20, 1), (1, 1), (1, 486), (0, 486)]
