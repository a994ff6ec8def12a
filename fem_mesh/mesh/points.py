"""Points as users give them, checked at the door; and a few ways to make some."""

from __future__ import annotations

import numbers
from collections.abc import Set
from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.predicates import LARGEST, SMALLEST

LARGEST_INTEGER = 2**53  # integers up to here are doubles
MARGIN = 0.06  # around the points, as a share of their extent
NARROWEST = 1e-10  # a view box, as a share of its distance from the origin: axes are drawn in rounded numbers
GRAIN = 2.0**30  # made points are multiples of 2^-30: other machines' sines give the same mesh


def as_points(points: Any) -> np.ndarray:
    """``points`` as a new float64 array (n, 2), without any change of value.

    Takes arrays, lists of pairs, integers. Raises MeshError, naming the row, where the shape is wrong
    or a coordinate is NaN, infinite, no double, or outside 2^-142 .. 2^201 in magnitude.

    >>> as_points([(0, 0), (1, 0)])
    array([[0., 0.],
           [1., 0.]])
    """
    points = points if hasattr(points, "__len__") or not hasattr(points, "__iter__") else list(points)
    given = _read(points)
    try:
        result = np.array(given, dtype=np.float64, order="C")
    except OverflowError:  # a Python integer beyond all doubles
        _refuse_large_integers(points, given)
        raise
    if given.dtype != np.float64:
        _refuse((given != result) & np.isfinite(result), given, "is no pair of doubles: round it, or scale the points")
    magnitude = np.abs(result)
    if not ((magnitude <= LARGEST) & ((magnitude >= SMALLEST) | (magnitude == 0))).all():
        _refuse(~np.isfinite(result), result, "is not finite: drop it, or repair what made it")
        outside = (magnitude > LARGEST) | ((magnitude < SMALLEST) & (magnitude != 0))
        _refuse(outside, result, "has a magnitude outside 2^-142 .. 2^201, where signs are not exact: scale the points")
    if (magnitude >= LARGEST_INTEGER).any():
        _refuse_large_integers(points, given)
    result += 0.0  # -0.0 is 0.0
    return result


def _read(points: Any) -> np.ndarray:
    """``points`` as an array (n, 2) of real numbers, of whatever type they are."""
    if isinstance(points, Set):
        raise MeshError("points must have an order, since triangles name them by number: give a list instead of a set")
    if np.ma.isMaskedArray(points):
        _refuse(np.ma.getmaskarray(points), np.asarray(points), "is masked: drop it first")
    try:
        given = np.asarray(points)
    except ValueError:  # rows of different lengths
        given = np.empty(0, object)
    if given.shape == (0,) and len(points) == 0:
        return np.empty((0, 2))
    if given.ndim != 2 or given.shape[1] != 2:
        raise MeshError(_shape_complaint(points, given))
    if given.dtype.kind not in "fiub":
        for row, (x, y) in enumerate(given if hasattr(points, "__array__") else points):
            if not (isinstance(x, numbers.Real) and isinstance(y, numbers.Real)):
                raise MeshError(f"point {row} is ({x!r}, {y!r}), not a pair of real numbers")
    return given


def _refuse_large_integers(points: Any, given: np.ndarray) -> None:
    if given.dtype.kind == "f" and hasattr(points, "__array__"):
        return
    rows = given if hasattr(points, "__array__") else points
    large = [[isinstance(v, numbers.Integral) and abs(int(v)) > LARGEST_INTEGER for v in pair] for pair in rows]
    _refuse(np.array(large), given, "has an integer above 2^53, which need not be a double: scale the points")


def _shape_complaint(points: Any, given: np.ndarray) -> str:
    if given.ndim == 2:
        return f"points must have the shape (n, 2), not {given.shape}: one row (x, y) a point"
    for row, point in enumerate(points if hasattr(points, "__iter__") else ()):
        if not hasattr(point, "__len__") or len(point) != 2:
            return f"point {row} is {point!r}, not a pair (x, y)"
    return f"points must have the shape (n, 2), not {given.shape}: one row (x, y) a point"


def _refuse(wrong: np.ndarray, points: np.ndarray, complaint: str) -> None:
    rows = np.flatnonzero(wrong.any(axis=1))
    if len(rows):
        more = f" (and {len(rows) - 1} more points)" if len(rows) > 1 else ""
        raise MeshError(f"point {rows[0]} = {tuple(points[rows[0]].tolist())} {complaint}{more}")


def as_numbers(values: Any, name: str) -> np.ndarray:
    """``values`` as a new float64 array of their shape."""
    try:
        array = np.asarray(values)
        if array.dtype.kind in "fiub":
            return array.astype(np.float64)
    except ValueError:
        pass
    raise MeshError(f"{name} must be real numbers, not {values!r}")


def as_coordinates(x: Any, y: Any) -> tuple[np.ndarray, np.ndarray]:
    """``x`` and ``y`` as float64 arrays of one shape."""
    x, y = as_numbers(x, "x"), as_numbers(y, "y")
    try:
        x, y = np.broadcast_arrays(x, y)
    except ValueError:
        raise MeshError(f"x and y must have one shape, not {x.shape} and {y.shape}") from None
    return x, y


def view_box(points: np.ndarray) -> tuple[float, float, float, float]:
    """left, right, bottom, top around points (n, 2), nan rows left out, with a margin."""
    points = points[~np.isnan(points[:, 0])]
    if not len(points):
        return -1.0, 1.0, -1.0, 1.0
    low, high = points.min(axis=0), points.max(axis=0)
    far = float(np.abs([low, high]).max())
    margin = max(MARGIN * float((high - low).max()), NARROWEST * far) or 1.0
    (left, bottom), (right, top) = (low - margin).tolist(), (high + margin).tolist()
    return left, right, bottom, top


# ---- made points -----------------------------------------------------------------------------------


def random_points(n: int, seed: int = 0) -> np.ndarray:
    """``n`` points, uniform in the unit square, the same for the same ``seed``: float64 (n, 2).

    >>> random_points(2, seed=1).round(3).tolist()
    [[0.512, 0.95], [0.144, 0.949]]
    """
    return _round(np.random.default_rng(seed).random((n, 2)))


def ring_points(n: int, radius: float = 1.0, center: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """``n`` points on a circle, to within 2^-30 of its radius: float64 (n, 2), counter-clockwise from the right.

    >>> ring_points(4).tolist()
    [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]
    """
    angle = 2 * np.pi * np.arange(n) / max(n, 1)
    ring = _round(np.column_stack([np.cos(angle), np.sin(angle)]))
    return np.asarray(radius * ring + np.asarray(center, float))


def grid_points(columns: int, rows: int | None = None) -> np.ndarray:
    """The points with integer coordinates 0 .. columns - 1, 0 .. rows - 1, row by row: float64 (n, 2).

    Every four neighbours lie on a circle: each square may be cut along either diagonal.

    >>> grid_points(2).tolist()
    [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
    """
    y, x = np.mgrid[: columns if rows is None else rows, :columns]
    return np.column_stack([x.ravel(), y.ravel()]).astype(np.float64)


def _round(points: np.ndarray) -> np.ndarray:
    return np.asarray(np.round(points * GRAIN) / GRAIN + 0.0)
