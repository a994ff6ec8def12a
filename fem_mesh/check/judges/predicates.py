"""orient and in_circle: every sign is worked out again, exactly."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from fem_mesh.check.reading import describe
from fem_mesh.check.transcript import Run
from fem_mesh.check.verdict import Picture, Wrong
from fem_mesh.predicates import in_circle, orient

SMALL = 1e-9  # a determinant below it is what tolerances and rounding hide
Point = Sequence[float]


def judge_orient(case: dict[str, Any], run: Run) -> None:
    """The sign of each number returned is that of the turn."""
    for given, returned in zip(case["calls"], run.yields, strict=False):
        turn = orient(*given)
        side = {1: "to the left", -1: "to the right", 0: "on the line"}
        word = {1: "positive", -1: "negative", 0: "0"}
        sign = sign_of(returned)
        if sign is None:
            raise Wrong(f"orient must return a number, whose sign counts, not {describe(returned)}{_forgotten(returned)}")
        if sign != turn:
            raise Wrong(
                f"{_call('orient', given)} must be {word[turn]}, since c lies {side[turn]}{_hint(turn_of(*given))}; "
                f"you returned {_shown(returned)}",
                _orient_picture(given, f"you: c lies {side[sign]}", f"c lies {side[turn]}"),
            )
    run.finish(len(case["calls"]))


def judge_in_circle(case: dict[str, Any], run: Run) -> None:
    """Each answer is whether d lies strictly inside, True or False."""
    for given, returned in zip(case["calls"], run.yields, strict=False):
        if not isinstance(returned, bool):
            raise Wrong(f"in_circle must return True or False, not {describe(returned)}{_forgotten(returned)}")
        inside = in_circle(*given)
        if returned != inside:
            det = circle_of(*given)
            where = "inside the circle" if inside else "outside the circle" if det else "exactly on the circle, not inside"
            raise Wrong(
                f"{_call('in_circle', given)} must be {inside}, since d lies {where}{_hint(det)}; you returned {returned}",
                _circle_picture(given, f"you: d lies {'inside' if returned else 'not inside'}", f"d lies {where}"),
            )
    run.finish(len(case["calls"]))


def sign_of(value: Any) -> int | None:
    """The sign of a number in a transcript, where numbers that are no doubles are told by theirs; None for all else.

    >>> sign_of(-2.5), sign_of({"type": "Fraction", "sign": 1}), sign_of(True), sign_of("1")
    (-1, 1, None, None)
    """
    if isinstance(value, dict):
        value = value.get("sign")
        if value not in (-1, 0, 1):
            return None
    if isinstance(value, bool) or not isinstance(value, int | float) or value != value:
        return None
    return int(value > 0) - int(value < 0)


# ---- the determinants, in fractions, for what they say of an answer's reason ---------------------------


def turn_of(a: Point, b: Point, c: Point) -> Fraction:
    """Twice the area of abc, negative if it is clockwise."""
    (ax, ay), (bx, by) = _from(c, a), _from(c, b)
    return ax * by - ay * bx


def circle_of(a: Point, b: Point, c: Point, d: Point) -> Fraction:
    """The determinant that is positive if d lies inside the circle of the counter-clockwise abc."""
    corners = [_from(d, p) for p in (a, b, c)]
    (ax, ay), (bx, by), (cx, cy) = corners
    lifts = [x * x + y * y for x, y in corners]
    return lifts[0] * (bx * cy - cx * by) + lifts[1] * (cx * ay - ax * cy) + lifts[2] * (ax * by - bx * ay)


def _from(origin: Point, p: Point) -> tuple[Fraction, Fraction]:
    return Fraction(p[0]) - Fraction(origin[0]), Fraction(p[1]) - Fraction(origin[1])


# ---- words and pictures ------------------------------------------------------------------------------


def _hint(det: Fraction) -> str:
    if not 0 < abs(det) < SMALL:
        return ""
    return f" (by a determinant of {float(det):.1e}, which rounding or a tolerance hides)"


def _forgotten(returned: Any) -> str:
    return ": is a `return` missing?" if returned is None else ""


def _call(name: str, given: Sequence[Point]) -> str:
    return f"{name}({', '.join(f'({_short(x)}, {_short(y)})' for x, y in given)})"


def _short(x: float) -> str:
    """The shortest text that is this very number."""
    return f"{x:g}" if float(f"{x:g}") == x else repr(float(x))


def _shown(returned: Any) -> str:
    told = isinstance(returned, dict) and "text" not in returned
    return f"{describe(returned)} of sign {returned['sign']}" if told else describe(returned)


def _orient_picture(given: Sequence[Point], yours: str, expected: str) -> Picture:
    words = ["a", "b", "c"]
    mine = {"title": yours, "edges": [[0, 1]], "point": [2], "words": words}
    return {"points": [list(p) for p in given], "panels": [mine, {**mine, "title": expected}]}


def _circle_picture(given: Sequence[Point], yours: str, expected: str) -> Picture:
    words = ["a", "b", "c", "d"]
    shown = {"triangles": [[0, 1, 2]], "circles": [[0, 1, 2]], "point": [3], "words": words}
    mine = {**shown, "title": yours, "wrong": [[0, 1, 2]]}
    return {"points": [list(p) for p in given], "panels": [mine, {**shown, "title": expected, "right": [[0, 1, 2]]}]}
