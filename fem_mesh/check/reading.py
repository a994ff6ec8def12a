"""What students yield, read from a transcript: type, then shape, then size, then values."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem_mesh.check.verdict import Wrong
from fem_mesh.errors import MeshError
from fem_mesh.mesh.points import as_points

MOST_ROWS = 20_000
Row = tuple[int, ...]


def describe(value: Any) -> str:
    """What a value of a transcript is, in a few words.

    >>> describe(None), describe([1, 2]), describe({"type": "zip"}), describe(2.5)
    ('None', 'a list of length 2', 'a zip', '2.5')
    """
    if isinstance(value, dict):
        name = value.get("type")
        if not isinstance(name, str):
            return "something else"
        if isinstance(value.get("text"), str):
            return str(value["text"])[:20]
        return f"{'an' if name[:1].lower() in 'aeiou' else 'a'} {name[:40]}"
    if isinstance(value, list):
        return f"a list of length {len(value)}"
    if isinstance(value, str):
        return f"the text {value[:40]!r}"
    return repr(value)[:60]


def read_triangles(value: Any, verb: str = "yielded") -> list[Row]:
    """The triples of point numbers that were yielded, as they are. Raises Wrong with what they are instead.

    >>> read_triangles([[0, 1, 2], [0, 2, 3]])
    [(0, 1, 2), (0, 2, 3)]
    >>> read_triangles([0, 1, 2])
    Traceback (most recent call last):
    fem_mesh.check.verdict.Wrong: you yielded a list that holds 0 where a triangle (a, b, c) should be: \
yield the list of all triangles
    """
    if isinstance(value, dict) and value.get("type") == "Step":
        value = value.get("triangles")
        if value is None:
            raise Wrong(f"you {verb} a Step without triangles: Step(..., triangles=the list of all of them)")
    return read_rows(value, "triangle", 3, verb)


def read_rows(value: Any, thing: str, width: int, verb: str = "yielded") -> list[Row]:
    """Rows of ``width`` point numbers, one a ``thing``."""
    row, all_of_them = f"{thing} {'(a, b, c)' if width == 3 else '(a, b)'}", f"the list of all {thing}s"
    if not isinstance(value, list):
        raise Wrong(f"you {verb} {describe(value)}, not {all_of_them}")
    if len(value) > MOST_ROWS:
        raise Wrong(f"you {verb} {len(value)} {thing}s, more than there can be")
    for found in value:
        if not isinstance(found, list):
            raise Wrong(f"you {verb} a list that holds {describe(found)} where a {row} should be: {_do(verb)} {all_of_them}")
        if len(found) != width:
            raise Wrong(f"you {verb} a list that holds {_shown(found)}, which is no {row}")
        for v in found:
            if isinstance(v, bool) or not isinstance(v, int):
                raise Wrong(f"{thing} {_shown(found)} must be made of point numbers, which are integers, not {describe(v)}")
    return [tuple(found) for found in value]


def read_state(value: Any, verb: str = "yielded") -> tuple[np.ndarray, list[Row]]:
    """Points and triangles, from a pair of them or a Step that has both.

    >>> read_state([[[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]])[1]
    [(0, 1, 2)]
    """
    if isinstance(value, dict) and value.get("type") == "Step":
        value = [value.get("points"), value.get("triangles")]
    if not isinstance(value, list) or len(value) != 2:
        raise Wrong(f"you {verb} {describe(value)}, not a pair (points, triangles)")
    points, triangles = value
    if not isinstance(points, list):
        raise Wrong(f"the points that you {verb} are {describe(points)}, not a list of pairs (x, y)")
    for v, point in enumerate(points[:MOST_ROWS]):
        if not isinstance(point, list) or len(point) != 2 or not all(is_number(x) for x in point):
            raise Wrong(
                f"point {v} is {_shown(point) if isinstance(point, list) else describe(point)}, not a pair (x, y) of floats"
            )
    try:
        return as_points(points[:MOST_ROWS]), read_triangles(triangles, verb)
    except MeshError as error:
        raise Wrong(str(error)) from None


def is_number(value: Any) -> bool:
    """Whether a value of a transcript is a number."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def _do(verb: str) -> str:
    return verb.removesuffix("ed")


def _shown(row: list[Any]) -> str:
    words = [describe(v) if isinstance(v, dict | list) else repr(v)[:30] for v in row[:4]]
    return f"({', '.join(words)}{', ...' if len(row) > 4 else ''})"
