"""Sketch: an outline as it is being edited, and the lines of Python that make its domain."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from itertools import groupby
from textwrap import wrap
from typing import Any

import numpy as np

from fem_mesh.domain import shapes
from fem_mesh.domain.curves import Circle
from fem_mesh.domain.domain import Domain
from fem_mesh.domain.reading import Region

SHAPES: dict[str, tuple[Callable[..., Domain], tuple[Any, ...]]] = {  # to start from: by name, what makes them
    "square": (shapes.square, ()),
    "L-shape": (shapes.l_shape, ()),
    "plate with a hole": (shapes.plate_with_hole, (2.0, 2.0, 0.5, 32)),
    "disk": (shapes.disk, ()),
    "annulus": (shapes.annulus, ()),
    "cracked square": (shapes.cracked_square, ()),
    "star": (shapes.star, ()),
    "gear": (shapes.gear, ()),
    "airfoil": (shapes.airfoil, ()),
    "turbine blade": (shapes.turbine_blade, ()),
    "letter A": (shapes.letter, ("A",)),
    "letter B": (shapes.letter, ("B",)),
    "letter S": (shapes.letter, ("S",)),
}
DRAWN = -1  # the row of a segment that was drawn by hand
NAME = "drawn"  # of such segments, beside those of a shape
WIDTH = 116  # of a line of code
HARD = "\xa0"  # stands for a blank at which no line is broken

Segment = tuple[int, int, int, bool]  # its ends, its row in the domain begun with, and whether it has kept its curve


@dataclass(frozen=True)
class Sketch:
    """Corners, and segments between them.

    start : the name of the shape that it began with (see SHAPES), any other for a domain that was given, or "" for none
    given : that shape or domain, or None
    """

    points: tuple[tuple[float, float], ...] = ()
    segments: tuple[Segment, ...] = ()
    start: str = ""
    given: Domain | None = None

    @classmethod
    def of(cls, domain: Domain, start: str = "given") -> Sketch:
        points = tuple((x, y) for x, y in domain.points.tolist())
        rows = enumerate(domain.segments.tolist())
        return cls(points, tuple((a, b, row, row in domain.curves) for row, (a, b) in rows), start, domain)

    @classmethod
    def begun_with(cls, domain: Domain, name: str) -> Sketch:
        """The sketch of a domain that was given: of the shape, if it is one, else under this name."""
        for shape, drawn in _sketched_shapes().items():
            if drawn.given is not None and _are_equal(drawn.given, domain):
                return cls.of(domain, shape)
        return cls.of(domain, name)

    @classmethod
    def of_shape(cls, name: str) -> Sketch:
        return _sketched_shapes()[name]

    def edited(self, points: Iterable[Any], segments: Iterable[Any]) -> Sketch:
        """The same sketch with these corners and segments."""
        rows = [(int(a), int(b), int(row), bool(curved)) for a, b, row, curved in segments]
        return Sketch(tuple((float(x), float(y)) for x, y in points), tuple(rows), self.start, self.given)

    @property
    def is_untouched(self) -> bool:
        return self.given is not None and self == Sketch.of(self.given, self.start)

    def to_domain(self) -> Domain | None:
        """The domain, or None while there is no corner. Raises MeshError as ``Domain`` does."""
        if self.is_untouched:
            return self.given
        if not self.points:
            return None
        loops = self._loops()
        if loops is not None:
            return Domain.from_loops(*loops)
        given, pairs = self._given, [(a, b) for a, b, _, _ in self.segments]
        curves = {k: given.curves[row] for k, row in self._curved}
        return Domain(self.points, pairs, given.holes, names=self._names, curves=curves, regions=given.regions)

    @property
    def _given(self) -> Domain:
        return Domain((), ()) if self.given is None else self.given

    @property
    def _names(self) -> list[str]:
        return [NAME if row == DRAWN else self._given.names[row] for _, _, row, _ in self.segments]

    @property
    def _curved(self) -> list[tuple[int, int]]:
        """The rows that have kept a curve, each with its row in what was given."""
        return [(k, row) for k, (_, _, row, curved) in enumerate(self.segments) if curved]

    def _loops(self) -> list[list[tuple[float, float]]] | None:
        """What was drawn as closed loops, corner after corner, if it is no more than that."""
        if any(row != DRAWN for _, _, row, _ in self.segments) or len(self._given.holes) or self._given.regions:
            return None
        after = {a: b for a, b, _, _ in self.segments}
        if len(after) != len(self.segments) or set(after) != set(after.values()) or len(after) != len(self.points):
            return None
        loops = []
        while after:
            a = next(iter(after))
            loop = []
            while a in after:
                loop.append(self.points[a])
                a = after.pop(a)
            loops.append(loop)
        return loops

    # ---- as code ---------------------------------------------------------------------------------

    def as_code(self) -> str:
        """Lines of Python after which ``domain`` is this domain. ``fm`` is fem_mesh."""
        if self._shape and self.is_untouched:
            return f"domain = {self._shape}"
        loops = self._loops()
        if loops is not None:
            return f"domain = fm.Domain.from_loops(\n{''.join(wrapped(f'    {places(loop)},') + chr(10) for loop in loops)})"
        names, (curves, before) = self._names, self._curves_as_code()
        options = [f"names={_names(names)}"] if any(names) else []
        options += [f"curves={curves}"] if curves else []
        options += [f"holes={places(self._given.holes.tolist())}"] if len(self._given.holes) else []
        options += [f"regions=[{', '.join(map(_region, self._given.regions))}]"] if self._given.regions else []
        lines = [
            *before,
            f"points = {places(self.points)}",
            f"segments = {places((a, b) for a, b, _, _ in self.segments)}",
            f"domain = fm.Domain({', '.join(['points', 'segments', *options])})",
        ]
        return "\n".join(map(wrapped, lines))

    @property
    def _shape(self) -> str:
        """The call that makes the shape it began with, if it was one."""
        if self.start not in SHAPES:
            return ""
        make, arguments = SHAPES[self.start]
        return f"fm.{make.__name__}({', '.join(map(repr, arguments))})"

    def _curves_as_code(self) -> tuple[str, list[str]]:
        """The curves as an option of ``Domain``, and the lines that come before."""
        kept = {k: self._given.curves[row] for k, row in self._curved}
        if not kept:
            return "", []
        if all(type(curve) is Circle for curve in kept.values()):
            alike = {circle: [k for k in kept if kept[k] == circle] for circle in kept.values()}
            curves = [f"dict.fromkeys({_rows(rows)}, {_circle(circle)})" for circle, rows in alike.items()]
            return "curves", [f"curves = {' | '.join(curves)}"]
        given = f"given = {self._shape}" if self._shape else "# given: the domain that the playground began with"
        if all(k == row for k, row in self._curved):
            return f"{{k: given.curves[k] for k in {_rows(list(kept))}}}", [given]
        rows = places(self._curved)
        return "{k: given.curves[row] for k, row in rows}", [given, f"rows = {rows}"]


@cache
def _sketched_shapes() -> dict[str, Sketch]:
    return {name: Sketch.of(make(*arguments), name) for name, (make, arguments) in SHAPES.items()}


def _are_equal(one: Domain, other: Domain) -> bool:
    """Whether two domains are the same, to the last bit."""
    arrays = ((one.points, other.points), (one.segments, other.segments), (one.holes, other.holes))
    if not all(np.array_equal(mine, theirs) for mine, theirs in arrays) or one.names != other.names:
        return False
    return one.curves == other.curves and one.regions == other.regions


def places(points: Iterable[Iterable[float]]) -> str:
    """Pairs or triples of numbers, to be ``wrapped``."""
    return "[" + ", ".join(f"({f',{HARD}'.join(map(number, point))})" for point in points) + "]"


def _rows(rows: list[int]) -> str:
    """Numbers of rows that grow."""
    first, last = rows[0], rows[-1]
    return f"range({first},{HARD}{last + 1})" if len(rows) == last - first + 1 > 2 else f"[{', '.join(map(str, rows))}]"


def _names(names: list[str]) -> str:
    runs = [(repr(name).replace(" ", HARD), len(list(run))) for name, run in groupby(names)]
    if len(runs) == 1:
        return runs[0][0]
    if len(runs) == len(names):
        return f"[{', '.join(name for name, _ in runs)}]"
    return " + ".join(f"[{name}]" + f" * {n}" * (n > 1) for name, n in runs)


def _circle(circle: Circle) -> str:
    x, y = map(number, circle.center)
    return f"fm.Circle(({x},{HARD}{y}),{HARD}{number(circle.radius)})"


def _region(region: Region) -> str:
    return f"fm.{region!r}".replace(" ", HARD)


def wrapped(line: str) -> str:
    """A line of brackets, names and numbers, in several lines if it is long."""
    lines = wrap(line, WIDTH, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False)
    return "\n".join(lines).replace(HARD, " ")


def number(value: float) -> str:
    """A number as short as it can be written without losing a bit.

    >>> number(2.0), number(0.1)
    ('2', '0.1')
    """
    return repr(float(value)).removesuffix(".0")
