"""Curves that straight segments stand for: where a segment is split, the new point goes onto its curve.

A curve is any object with ``between(a, b)``, which returns a point of the curve about half-way between
its points a and b. The two here give the same bits on every machine, if a user's function does.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fem_mesh.errors import MeshError
from fem_mesh.predicates import LARGEST

Point = tuple[float, float]

SAMPLES = 8  # chords by which the turn of a piece is measured
TURN = 1.3032253728412058  # tan 52.5 degrees: where a curve turns by 60 degrees, its 8 chords do by 7/8 of that
SLACK = 1 + 2.0**-20  # of that measure: points are rounded
DEEPEST = 12  # a segment is halved this often before its curve is said to have a corner
LARGEST_ARC = 2 * (1 - 1e-6)  # chord over radius: beyond it is half a circle, and which half nobody knows
STEPS = 100  # of the search for the point half-way; each halves the bracket or does better
FINE = 2.0**40  # points of a user's curve are multiples of 2^-40 of their size: other machines' sines give the same


@dataclass(frozen=True)
class Circle:
    """The circle of ``radius`` about ``center``. A segment with both ends on it stands for the shorter arc.

    >>> Circle((0, 0), 5).between((3, 4), (-3, 4))
    (0.0, 5.0)
    """

    center: Point
    radius: float

    def __post_init__(self) -> None:
        x, y = (float(v) for v in self.center)
        if not (math.isfinite(x) and math.isfinite(y) and 0 < self.radius < math.inf):
            raise MeshError(f"a circle needs a finite center and a radius > 0, not {self.center!r} and {self.radius!r}")
        object.__setattr__(self, "center", (x, y))
        object.__setattr__(self, "radius", float(self.radius))

    def between(self, a: Point, b: Point) -> Point:
        """The middle of the shorter arc from a to b: the chord's middle, pushed out to the radius."""
        x, y = self.center
        u, v = (a[0] - x) + (b[0] - x), (a[1] - y) + (b[1] - y)
        stretch = self.radius / math.sqrt(u * u + v * v)
        return x + stretch * u, y + stretch * v

    def miss(self, a: Point, b: Point) -> float:
        """How far a or b lies off the circle."""
        x, y = self.center
        return max(abs(math.sqrt((p[0] - x) ** 2 + (p[1] - y) ** 2) - self.radius) for p in (a, b))

    def is_gentle(self, a: Point, b: Point) -> bool:
        u, v = a[0] - b[0], a[1] - b[1]
        return u * u + v * v <= self.radius * self.radius * SLACK


@dataclass(frozen=True)
class Parametric:
    """The points ``function(t)``, pairs (x, y), for t from ``start`` to ``end``: smooth, without corners.

    >>> Parametric(lambda t: (t, t * t), start=-1, end=3).between((-1, 1), (1, 1))
    (0.0, 0.0)
    """

    function: Callable[[float], Any]
    start: float = 0.0
    end: float = 1.0

    def at(self, t: float) -> Point:
        """The point at the parameter ``t``."""
        point = self.function(t)
        try:
            x, y = (float(v) for v in point)
        except (TypeError, ValueError):
            raise MeshError(f"a curve's function must return a pair (x, y), but at t = {t:.6g} it returns {point!r}") from None
        if not (abs(x) <= LARGEST and abs(y) <= LARGEST):
            raise MeshError(f"a curve's function must return finite numbers, but at t = {t:.6g} it returns ({x}, {y})")
        return x, y

    def between(self, a: Point, b: Point) -> Point:
        """The point of the curve that is equally far from a and b."""
        x, y, u, v = (a[0] + b[0]) / 2, (a[1] + b[1]) / 2, b[0] - a[0], b[1] - a[1]

        def ahead(t: float) -> float:
            point = self.at(t)
            return (point[0] - x) * u + (point[1] - y) * v

        return _rounded(self.at(_find_zero(ahead, self.start, self.end)), a, b)

    def halves(self) -> tuple[Point, Parametric, Parametric]:
        """The point at the middle of the parameters, and the curves before and after it."""
        t = (self.start + self.end) / 2
        ends = self.at(self.start), self.at(self.end)
        return _rounded(self.at(t), *ends), Parametric(self.function, self.start, t), Parametric(self.function, t, self.end)

    def miss(self, a: Point, b: Point) -> float:
        """How far the curve's ends lie from a and b."""
        return max(math.dist(self.at(self.start), a), math.dist(self.at(self.end), b))

    def is_gentle(self, a: Point, b: Point) -> bool:
        step = (self.end - self.start) / SAMPLES
        return turns_little([a, *(self.at(self.start + i * step) for i in range(1, SAMPLES)), b])


def as_curve(curve: Any) -> Any:
    """``curve`` itself if it has ``between``; a function of t in [0, 1] as a :class:`Parametric`."""
    if hasattr(curve, "between"):
        return curve
    if callable(curve):
        return Parametric(curve)
    raise MeshError(f"a curve is a Circle, a function t -> (x, y) or an object with between(a, b), not {curve!r}")


def check_ends(curve: Any, a: Point, b: Point, tolerance: float) -> None:
    """MeshError unless ``curve`` passes from a to b, to within ``tolerance``."""
    miss = curve.miss(a, b) if hasattr(curve, "miss") else 0.0
    if miss <= tolerance:
        if isinstance(curve, Circle) and math.dist(a, b) > LARGEST_ARC * curve.radius:
            raise MeshError("spans half of its circle, and which half is not said: put a point in the middle of the arc")
        return
    if isinstance(curve, Parametric) and curve.miss(b, a) <= tolerance:
        raise MeshError("runs against its curve: swap its end points, or start and end of the curve")
    off = f"is off its curve by {miss:.3g}, and {tolerance:.3g} is allowed"
    if isinstance(curve, Parametric):
        first, last = curve.at(curve.start), curve.at(curve.end)
        off += f": the curve runs from ({first[0]:.6g}, {first[1]:.6g}) to ({last[0]:.6g}, {last[1]:.6g})"
    raise MeshError(off)


def cut_gently(curve: Any, a: Point, b: Point) -> tuple[list[Point], list[Any]]:
    """Points that cut the curve from a to b into pieces which turn by at most 60 degrees, and those pieces.

    Raises MeshError where it has a corner.
    """
    return _cut(curve, a, b, 0)


def _cut(curve: Any, a: Point, b: Point, depth: int) -> tuple[list[Point], list[Any]]:
    gentle = curve.is_gentle(a, b) if hasattr(curve, "is_gentle") else turns_little(_samples(curve, a, b, SAMPLES))
    if gentle:
        return [], [curve]
    if depth == DEEPEST:
        raise MeshError(f"has a corner in its curve near ({a[0]:.6g}, {a[1]:.6g}), or is not continuous: put a point there")
    middle, before, after = halve(curve, a, b)
    points, curves = _cut(before, a, middle, depth + 1)
    more_points, more_curves = _cut(after, middle, b, depth + 1)
    return [*points, middle, *more_points], curves + more_curves


def halve(curve: Any, a: Point, b: Point) -> tuple[Point, Any, Any]:
    """A point of the curve between a and b, and the curves before and after it."""
    if hasattr(curve, "halves"):
        middle, before, after = curve.halves()
        return middle, before, after
    return as_pair(curve.between(a, b)), curve, curve


def turns_little(points: list[Point]) -> bool:
    """Whether a polygon's turns, whatever their sides, sum to at most 52.5 degrees. Takes no arc tangent:
    complex numbers with these angles are multiplied, until the product leaves the sector.
    """
    real, imaginary = 1.0, 0.0
    sides = [(q[0] - p[0], q[1] - p[1]) for p, q in itertools.pairwise(points) if p != q]
    for (ux, uy), (vx, vy) in itertools.pairwise(sides):
        dot, cross = ux * vx + uy * vy, abs(ux * vy - uy * vx)
        real, imaginary = real * dot - imaginary * cross, real * cross + imaginary * dot
        if not imaginary <= TURN * SLACK * real or dot < 0:
            return False
        size = real + imaginary
        if size > 0:
            real, imaginary = real / size, imaginary / size
    return True


def _samples(curve: Any, a: Point, b: Point, n: int) -> list[Point]:
    if n == 1:
        return [a, b]
    middle = as_pair(curve.between(a, b))
    return [*_samples(curve, a, middle, n // 2)[:-1], *_samples(curve, middle, b, n // 2)]


def as_pair(point: Any) -> Point:
    """What a curve's ``between`` returned, as a pair of finite numbers."""
    try:
        x, y = (float(v) for v in point)
    except (TypeError, ValueError):
        raise MeshError(f"a segment has a curve whose between(a, b) returns {point!r}, not a pair (x, y)") from None
    if not (abs(x) <= LARGEST and abs(y) <= LARGEST):
        raise MeshError(f"a segment has a curve whose between(a, b) returns ({x}, {y}), which is not finite")
    return x, y


def _rounded(point: Point, *others: Point) -> Point:
    """``point`` as multiples of 2^-40 of the size of coordinates here."""
    size = max(abs(v) for p in (point, *others) for v in p)
    grain = FINE / 2.0 ** math.frexp(size)[1]
    return round(point[0] * grain) / grain, round(point[1] * grain) / grain


def _find_zero(function: Callable[[float], float], low: float, high: float) -> float:
    """Where ``function`` changes sign between low and high: secants, kept in the bracket (the Illinois rule)."""
    at_low, at_high = function(low), function(high)
    if (at_low < 0) == (at_high < 0):
        return low if abs(at_low) < abs(at_high) else high
    for _ in range(STEPS):
        t = high - at_high * (high - low) / (at_high - at_low)
        if not min(low, high) < t < max(low, high):
            t = (low + high) / 2
        if t in (low, high):
            break
        value = function(t)
        if value == 0:
            return t
        if (value < 0) != (at_high < 0):
            low, at_low = high, at_high
        else:
            at_low /= 2
        high, at_high = t, value
    return high
