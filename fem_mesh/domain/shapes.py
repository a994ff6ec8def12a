"""Domains to start from.

Where a coordinate takes a sine or a root it is rounded to a multiple of 2^-30 of the shape's size, so that
every machine has the same one.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem_mesh.domain.curves import Circle, Parametric
from fem_mesh.domain.domain import Domain
from fem_mesh.domain.letters import HEIGHT, OUTLINES, outlines_of
from fem_mesh.errors import MeshError
from fem_mesh.mesh.points import _round, ring_points

SIDES = ("bottom", "right", "top", "left")
CLASSIC = (3 - math.sqrt(5)) / 2  # the inner radius at which a star's sides are five lines

Loop = tuple[np.ndarray, list[str], list[Any]]  # points (n, 2), and the name and the curve of each side


def square(side: float = 1.0) -> Domain:
    """The square [0, side] x [0, side]. Its sides are named "bottom", "right", "top", "left".

    >>> square()
    Domain: 4 points, 4 segments (bottom, right, top, left)
    """
    _check_positive(side=side)
    return _domain(_polygon([(0, 0), (side, 0), (side, side), (0, side)], SIDES))


def l_shape(side: float = 2.0) -> Domain:
    """The square of ``side`` about the origin without its lower right quarter: the classic corner singularity.

    The re-entrant corner is the origin. The two segments that meet there are named "corner", all others
    "outer": u = r^(2/3) sin(2 t / 3) is harmonic and 0 on "corner" (t is the angle from the x axis).

    >>> l_shape()
    Domain: 6 points, 6 segments (corner, outer)
    """
    _check_positive(side=side)
    a = side / 2
    corners = [(0, 0), (a, 0), (a, a), (-a, a), (-a, -a), (0, -a)]
    return _domain(_polygon(corners, ["corner", "outer", "outer", "outer", "outer", "corner"]))


def disk(radius: float = 1.0, n: int = 32) -> Domain:
    """The disk of ``radius`` about the origin: ``n`` chords, named "outer", that know their circle.

    >>> disk(n=6)
    Domain: 6 points, 6 segments (outer), 6 of them curved
    """
    _check_positive(radius=radius)
    return _domain(_circle(radius, n, "outer"))


def annulus(inner: float = 0.5, outer: float = 1.0, n: int = 48) -> Domain:
    """The ring between two circles about the origin, "outer" and "inner", of ``n`` chords each that know their circle.

    >>> annulus(n=12)
    Domain: 24 points, 24 segments (outer, inner), 24 of them curved
    """
    _check_positive(inner=inner, outer=outer)
    if inner >= outer:
        raise MeshError(f"the inner radius must be smaller than the outer one: {inner!r} is not smaller than {outer!r}")
    return _domain(_circle(outer, n, "outer"), _circle(inner, n, "inner", outer))


def plate_with_hole(width: float = 2.0, height: float = 2.0, radius: float = 0.5, n: int = 64) -> Domain:
    """A plate about the origin with a round hole in its middle: ``n`` chords, named "hole", that know their circle.

    The sides are named "bottom", "right", "top", "left". Pulled at two of them, the stress at the hole is
    three times as high as far away, if the plate is wide (Kirsch 1898).

    >>> plate_with_hole(n=12)
    Domain: 16 points, 16 segments (bottom, right, top, left, hole), 12 of them curved
    """
    _check_positive(width=width, height=height, radius=radius)
    if radius >= min(width, height) / 2:
        raise MeshError(f"a hole of radius {radius!r} does not fit into a plate of {width!r} x {height!r}")
    return _domain(
        _box(-width / 2, width / 2, -height / 2, height / 2, SIDES), _circle(radius, n, "hole", max(width, height) / 2)
    )


def cracked_square(side: float = 2.0) -> Domain:
    """The square of ``side`` about the origin, slit from the middle of its left side to the origin.

    The slit is one open segment, named "crack"; it begins on the left side, in a vertex that the side does
    not know of. The sides are named "bottom", "right", "top", "left".

    >>> cracked_square().toggles.tolist()
    [True, True, True, True, False]
    """
    _check_positive(side=side)
    a = side / 2
    points = [(-a, -a), (a, -a), (a, a), (-a, a), (-a, 0), (0, 0)]
    return Domain(points, [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5)], names=[*SIDES, "crack"])


def star(points: int = 5, outer: float = 1.0, inner: float = CLASSIC) -> Domain:
    """A star about the origin with so many ``points``, the first one up: tips at the radius ``outer``, notches at ``inner``.

    >>> star()
    Domain: 10 points, 10 segments (outer)
    """
    _check_positive(outer=outer, inner=inner)
    _check_count(points, 2, "points")
    angle = np.pi / 2 + np.pi * np.arange(2 * points) / points
    radius = np.where(np.arange(2 * points) % 2, inner, outer)
    return _domain(_polygon(_polar(radius, angle), ["outer"] * len(angle)))


def gear(teeth: int = 12, outer: float = 1.0, root: float = 0.8, bore: float = 0.3, n: int = 32) -> Domain:
    """A gear wheel about the origin. Tips lie on the circle of radius ``outer``, roots on that of radius ``root``.

    Tips, roots and the ``n`` chords of the bore know their circles. Names: "teeth", "bore".

    >>> gear()
    Domain: 80 points, 80 segments (teeth, bore), 56 of them curved
    """
    _check_positive(outer=outer, root=root, bore=bore)
    _check_count(teeth, 4, "teeth")
    if not bore < root < outer:
        raise MeshError(f"a gear needs bore < root < outer, not {bore!r}, {root!r}, {outer!r}")
    share = np.array([-0.28, -0.13, 0.13, 0.28])  # of a pitch: where a flank starts, the tip, where the other one ends
    angle = np.pi / 2 + 2 * np.pi * (np.arange(teeth)[:, None] + share).ravel() / teeth
    radius = np.tile([root, outer, outer, root], teeth)
    curves = [None, Circle((0, 0), outer), None, Circle((0, 0), root)] * teeth
    return _domain((_polar(radius, angle), ["teeth"] * len(angle), curves), _circle(bore, n, "bore", outer))


def letter(character: str = "A") -> Domain:
    """A capital letter, 1 high, as a polygon. Names: "outer", and "hole 0", "hole 1" for its counters.

    >>> letter("B")
    Domain: 21 points, 21 segments (outer, hole 0, hole 1)
    """
    if character not in OUTLINES:
        raise MeshError(f"there are letters from A to Z, and no {character!r}")
    return Domain.from_loops(*(_round(loop / HEIGHT) for loop in outlines_of(character)))


# ---- curves of flight --------------------------------------------------------------------------------


def airfoil(code: str = "2412", n: int = 64, box: tuple[float, float, float, float] = (-1.0, 2.5, -1.25, 1.25)) -> Domain:
    """The air around a NACA four-digit airfoil from (0, 0) to (1, 0), inside a box.

    code : camber in percent of the chord, where it is largest in tenths, thickness in percent
    n : chords around the foil, even; cosine spacing, and they know their curve
    box : left, right, bottom, top

    Names: "outer" for the box, "airfoil". The trailing edge is closed (a last coefficient of -0.1036). The
    curves run in s = sqrt(x), in which they are smooth around the nose.

    >>> airfoil("0012")
    Domain: 68 points, 68 segments (outer, airfoil), 64 of them curved
    """
    if not (isinstance(code, str) and len(code) == 4 and code.isascii() and code.isdigit() and int(code[2:]) > 0):
        raise MeshError(f"an airfoil's code has four digits and a thickness > 0, like '2412'; {code!r} has not")
    if (int(code[0]) > 0) != (int(code[1]) > 0):
        raise MeshError(f"an airfoil's first two digits are both 0 or neither: {code!r} has camber nowhere, or none somewhere")
    _check_count(n, 8, "n")
    if n % 2:
        raise MeshError(f"an airfoil has as many chords above as below: n = {n} must be even")
    upper, lower = _FoilSide(code, 1.0), _FoilSide(code, -1.0)
    s = _round(np.sin(np.pi / 2 * np.linspace(0, 1, n // 2 + 1)))
    pieces = [Parametric(upper, b, a) for a, b in zip(s[-2::-1].tolist(), s[:0:-1].tolist(), strict=True)]
    pieces += [Parametric(lower, a, b) for a, b in zip(s[:-1].tolist(), s[1:].tolist(), strict=True)]
    foil = _round(np.array([piece.at(piece.start) for piece in pieces]))
    left, right, bottom, top = box
    low, high = foil.min(axis=0), foil.max(axis=0)
    if not (left < low[0] and high[0] < right and bottom < low[1] and high[1] < top):
        raise MeshError(f"the airfoil does not fit into the box {box!r} (left, right, bottom, top)")
    return _domain(_box(left, right, bottom, top, ["outer"] * 4), (foil, ["airfoil"] * n, pieces))


@dataclass(frozen=True)
class _FoilSide:
    """One surface of a NACA foil as a function of sqrt(x): side 1 is the upper one, -1 the lower."""

    code: str
    side: float

    def __call__(self, s: float) -> tuple[float, float]:
        code, side, x = self.code, self.side, s * s
        camber, place, thickness = int(code[0]) / 100, int(code[1]) / 10, int(code[2:]) / 100
        half = 5 * thickness * (0.2969 * s + x * (-0.1260 + x * (-0.3516 + x * (0.2843 - x * 0.1036))))
        height, slope = 0.0, 0.0
        if camber:
            part = place if x < place else 1 - place
            height = camber / (part * part) * (x * (2 * place - x) + (0 if x < place else 1 - 2 * place))
            slope = 2 * camber / (part * part) * (place - x)
        length = math.sqrt(1 + slope * slope)
        return x - side * half * slope / length, height + side * half / length


BLADE = (  # name, chords of forty and the fewest, control points of a cubic: counter-clockwise from the trailing edge
    ("suction side", 14, 2, ((0.984, -0.390), (0.860, -0.060), (0.620, 0.300), (0.330, 0.300))),
    ("leading edge", 6, 2, ((0.330, 0.300), (0.170, 0.300), (0.020, 0.200), (0.000, 0.060))),
    ("leading edge", 4, 4, ((0.000, 0.060), (-0.010, -0.010), (0.060, -0.040), (0.120, 0.000))),
    ("pressure side", 12, 2, ((0.120, 0.000), (0.360, 0.160), (0.720, 0.020), (0.960, -0.400))),
    ("trailing edge", 4, 4, ((0.960, -0.400), (0.968, -0.414), (0.9902, -0.4065), (0.984, -0.390))),
)


def turbine_blade(n: int = 40) -> Domain:
    """The section of a turbine blade: some ``n`` chords that know their curves, five cubics.

    Names: "suction side", "leading edge", "pressure side", "trailing edge".

    >>> turbine_blade()
    Domain: 40 points, 40 segments (suction side, leading edge, pressure side, trailing edge), 40 of them curved
    """
    _check_count(n, 14, "n")
    points, names, curves = [], [], []
    for name, share, fewest, control in BLADE:
        cubic, pieces = _Cubic(control), max(fewest, round(share * n / 40))
        stops = [i / pieces for i in range(pieces + 1)]
        for a, b in itertools.pairwise(stops):
            points.append(cubic(a))
            names.append(name)
            curves.append(Parametric(cubic, a, b))
    return _domain((_round(np.array(points)), names, curves))


@dataclass(frozen=True)
class _Cubic:
    """The cubic of four control points (Bezier, de Casteljau)."""

    control: Any

    def __call__(self, t: float) -> tuple[float, float]:
        x, y = (
            (1 - t) * (1 - t) * ((1 - t) * p + 3 * t * q) + t * t * (3 * (1 - t) * r + t * s)
            for p, q, r, s in zip(*self.control, strict=True)
        )
        return x, y


# ---- parts -------------------------------------------------------------------------------------------


def _domain(*loops: Loop) -> Domain:
    """A domain from loops whose every side has a name and a curve, or None."""
    points = np.concatenate([loop[0] for loop in loops])
    names = [name for loop in loops for name in loop[1]]
    curves = {row: curve for row, curve in enumerate(curve for loop in loops for curve in loop[2]) if curve is not None}
    segments: list[tuple[int, int]] = []
    for n in (len(loop[0]) for loop in loops):
        first = len(segments)
        segments += [(first + i, first + (i + 1) % n) for i in range(n)]
    return Domain(points, segments, names=names, curves=curves)


def _polygon(points: Any, names: Any) -> Loop:
    return np.array(points, float), list(names), [None] * len(points)


def _box(left: float, right: float, bottom: float, top: float, names: Any) -> Loop:
    return _polygon([(left, bottom), (right, bottom), (right, top), (left, top)], names)


def _circle(radius: float, n: int, name: str, size: float = 0.0) -> Loop:
    """``n`` chords of a circle in a shape of some ``size``, if that is larger than the circle."""
    _check_count(n, 3, "n")
    return _rounded(ring_points(n, radius), max(radius, size)), [name] * n, [Circle((0, 0), radius)] * n


def _polar(radius: np.ndarray, angle: np.ndarray) -> np.ndarray:
    directions = _round(np.column_stack([np.cos(angle), np.sin(angle)]))
    return _rounded(directions * radius[:, None], float(radius.max()))


def _rounded(points: np.ndarray, size: float) -> np.ndarray:
    """``points`` as multiples of 2^-30 of the power of two from ``size`` up."""
    mantissa, exponent = math.frexp(size)
    unit = 2.0 ** (exponent - (mantissa == 0.5))
    return unit * _round(points / unit)


def _check_positive(**lengths: Any) -> None:
    for name, value in lengths.items():
        if not (isinstance(value, int | float | np.number) and 0 < value < math.inf):
            raise MeshError(f"{name} must be a number > 0, not {value!r}")


def _check_count(n: Any, least: int, name: str) -> None:
    if not isinstance(n, int | np.integer) or n < least:
        raise MeshError(f"{name} must be an integer from {least} on, not {n!r}")
