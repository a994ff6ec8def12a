"""What triangles measure: angles, areas, circles, turns."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.kernel import call, kernel
from fem_mesh.predicates import IN_CIRCLE_BOUND, in_circle_sign, orient_sign

THIN = 1e-6  # area to the square of the size: flatter triangles are measured in fractions


def as_triangles(triangles: Any) -> np.ndarray:
    """``triangles`` as a new int32 array (m, 3). Raises MeshError where they are no triples of integers."""
    given = as_rows(triangles, "triangle", "(m, 3)", ("a", "b", "c"))
    for v in given[(given < -1) | (given > np.iinfo(np.int32).max)][:1]:
        raise MeshError(f"triangles has the point number {v}, which names no point")
    return given.astype(np.int32)


def as_rows(rows: Any, thing: str, shape: str, row: tuple[str, ...]) -> np.ndarray:
    """Rows of point numbers, one a ``thing``, as an array of integers with as many columns as ``row``."""
    several = {2: ("two", "pairs"), 3: ("three", "triples")}[len(row)]
    try:
        given = np.asarray(rows if hasattr(rows, "__array__") else list(rows))
    except (TypeError, ValueError):
        raise MeshError(f"{thing}s must be rows of {several[0]} point numbers, not {rows!r:.80}") from None
    if given.size == 0:
        return np.empty((0, len(row)), np.int64)
    if given.ndim != 2 or given.shape[1] != len(row):
        raise MeshError(f"{thing}s must have the shape {shape}, not {given.shape}: one row ({', '.join(row)}) a {thing}")
    if given.dtype.kind not in "iu":
        raise MeshError(f"{thing}s must be {several[1]} of point numbers (integers), not {given.dtype}")
    return given


def numbers_below(given: Any, n: int, what: str, length: int | None = None, lowest: int = 0) -> np.ndarray:
    """``given`` as int32 numbers from ``lowest`` to below ``n``, as many as ``length`` says."""
    array = np.asarray(given)
    if array.size == 0:
        array = np.empty(0, np.int32)
    if array.dtype.kind not in "iu" or array.ndim != 1 or length not in (None, len(array)):
        raise MeshError(f"{what} must be {'' if length is None else f'{length} '}whole numbers, not {given!r:.80}")
    for i in np.flatnonzero((array < lowest) | (array >= n))[:1]:
        raise MeshError(f"{what} holds {array[i]} at place {i}: numbers there go from {lowest} to {n - 1}")
    return array.astype(np.int32)


def angles(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The angles at the corners, in degrees: float64 (m, 3), in the order of the corners.

    >>> angles(np.array([[0, 0], [1, 0], [0, 1]]), np.array([[0, 1, 2]])).tolist()
    [[90.0, 45.0, 45.0]]
    """
    result = np.empty((len(triangles), 3))
    for i in range(3):
        a, b, c = (points[triangles[:, (i + k) % 3]] for k in range(3))
        u, v = b - a, c - a
        cross = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        result[:, i] = np.degrees(np.arctan2(np.abs(cross), (u * v).sum(axis=1)))
    return result


def areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The areas, float64 (m,); negative where a triangle is clockwise. Rounded: never decide by them.

    >>> areas(np.array([[0, 0], [1, 0], [0, 1]]), np.array([[0, 1, 2]])).tolist()
    [0.5]
    """
    a, b, c = (points[triangles[:, k]] for k in range(3))
    u, v = b - a, c - a
    return np.asarray((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2)


def circumcircle(ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> tuple[float, float, float]:
    """Centre x, y and radius of the circle through a, b, c; infinite for points on one line. Rounded.

    >>> circumcircle(0, 0, 2, 0, 0, 2)
    (1.0, 1.0, 1.4142135623730951)
    """
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    twice = 2 * (ux * vy - uy * vx)
    if twice == 0:
        return math.inf, math.inf, math.inf
    u, v = ux * ux + uy * uy, vx * vx + vy * vy
    x, y = (vy * u - uy * v) / twice, (ux * v - vx * u) / twice
    return ax + x, ay + y, math.hypot(x, y)


def circumcenters(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The centre of each triangle's circle: float64 (m, 2). Rounded; those of thin triangles from fractions.

    >>> circumcenters(np.array([[0, 0], [2, 0], [0, 2]]), np.array([[0, 1, 2]])).tolist()
    [[1.0, 1.0]]
    """
    a, b, c = (points[triangles[:, k]] for k in range(3))
    u, v = b - a, c - a
    twice = 2 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    uu, vv = (u * u).sum(axis=1), (v * v).sum(axis=1)
    thin = np.abs(twice) < THIN * np.maximum(uu, vv)
    over = np.column_stack([v[:, 1] * uu - u[:, 1] * vv, u[:, 0] * vv - v[:, 0] * uu])
    centers = np.asarray(a + over / np.where(thin, 1.0, twice)[:, None])
    for t in np.flatnonzero(thin):
        centers[t] = _exact_center(points[triangles[t]])
    return centers


def _exact_center(corners: np.ndarray) -> tuple[float, float]:
    (ax, ay), (bx, by), (cx, cy) = ([Fraction(value) for value in corner] for corner in corners.tolist())
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    u, v, twice = ux * ux + uy * uy, vx * vx + vy * vy, 2 * (ux * vy - uy * vx)
    return float(ax + (vy * u - uy * v) / twice), float(ay + (ux * v - vx * u) / twice)


def exact_area(points: np.ndarray, triangles: np.ndarray) -> Fraction:
    """The sum of the areas as a fraction, without any rounding: slow, for checking.

    >>> exact_area(np.array([[0, 0], [1, 0], [0, 1.0]]), np.array([[0, 1, 2]]))
    Fraction(1, 2)
    """
    total = Fraction(0)
    for a, b, c in triangles.tolist():
        (ax, ay), (bx, by), (cx, cy) = ([Fraction(value) for value in points[v].tolist()] for v in (a, b, c))
        total += (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return total / 2


def barycentric(corners: np.ndarray, p: np.ndarray) -> np.ndarray:
    """The weights, summing to 1, of three ``corners`` (k, 3, 2) that give points ``p`` (k, 2) in them: float64 (k, 3).

    >>> barycentric(np.array([[[0, 0], [2, 0], [0, 2.0]]]), np.array([[0.5, 1.0]])).tolist()
    [[0.25, 0.25, 0.5]]
    """
    to = corners - p[:, None]
    across = [to[:, (i + 1) % 3, 0] * to[:, (i + 2) % 3, 1] - to[:, (i + 1) % 3, 1] * to[:, (i + 2) % 3, 0] for i in range(3)]
    weights = np.maximum(np.column_stack(across), 0.0)
    total = weights.sum(axis=1)
    longest = (np.abs(to).max(axis=(1, 2), initial=0.0)) ** 2
    for k in np.flatnonzero(total < THIN * longest):  # rounding spoils these: fractions do not
        weights[k] = _exact_weights(corners[k], p[k])
        total[k] = weights[k].sum()
    return np.asarray(weights / total[:, None])


def _exact_weights(corners: np.ndarray, p: np.ndarray) -> list[float]:
    x, y = (Fraction(float(value)) for value in p)
    to = [(Fraction(u) - x, Fraction(v) - y) for u, v in corners.tolist()]
    twice = [to[i - 2][0] * to[i - 1][1] - to[i - 2][1] * to[i - 1][0] for i in range(3)]
    return [float(weight / sum(twice)) for weight in twice]


def counter_clockwise(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """``triangles`` with the clockwise ones turned round.

    >>> counter_clockwise(np.array([[0, 0], [1, 0], [0, 1.0]]), np.array([[0, 2, 1]])).tolist()
    [[0, 1, 2]]
    """
    clockwise = turns_of(points, triangles) < 0
    return np.where(clockwise[:, None], triangles[:, [0, 2, 1]], triangles)


def turns_of(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """1 for each counter-clockwise triangle, -1 for a clockwise, 0 for a flat one, exactly: int8 (m,)."""
    turns = np.empty(len(triangles), np.int8)
    call(fill_turns, points, triangles, turns, size=len(triangles))
    return turns


@kernel
def turn(points, a, b, c):
    s = orient_sign(points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1])
    return 1 if s > 0.0 else -1 if s < 0.0 else 0


@kernel
def fill_turns(points, triangles, turns):
    for t in range(len(turns)):
        turns[t] = turn(points, triangles[t, 0], triangles[t, 1], triangles[t, 2])


# ---- ties ------------------------------------------------------------------------------------------


def cocircular_edges(points: np.ndarray, triangles: np.ndarray, neighbors: np.ndarray) -> np.ndarray:
    """The inner edges whose two triangles lie on one circle, exactly: int32 (j, 2). Either diagonal is Delaunay.

    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    >>> cocircular_edges(square, np.array([[0, 1, 2], [0, 2, 3]]), np.array([[-1, 1, -1], [-1, -1, 0]])).tolist()
    [[2, 0]]
    """
    t, i = ties(points, triangles, neighbors)
    return np.column_stack([triangles[t, (i + 1) % 3], triangles[t, (i + 2) % 3]])


def ties(points: np.ndarray, triangles: np.ndarray, neighbors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The triangles and their corners whose neighbour across from there lies on the same circle: each pair once."""
    t, i = np.nonzero(neighbors > np.arange(len(triangles))[:, None])
    a, b, c = (triangles[t, (i + k) % 3] for k in range(3))
    d = triangles[neighbors[t, i]].sum(axis=1) - b - c
    x, y = np.moveaxis(points[np.array([a, b, c])] - points[d], -1, 0)
    after, last = [1, 2, 0], [2, 0, 1]
    left, right, lift = x[after] * y[last], x[last] * y[after], x * x + y * y
    det, permanent = (lift * (left - right)).sum(axis=0), (lift * (np.abs(left) + np.abs(right))).sum(axis=0)
    open_ = np.flatnonzero(np.abs(det) <= IN_CIRCLE_BOUND * permanent)  # the others are no ties: see in_circle_sign
    corners, tied = np.column_stack([a, b, c, d])[open_], np.empty(len(open_), bool)
    call(find_ties, points, corners, tied, size=len(corners))
    return t[open_[tied]], i[open_[tied]]


@kernel
def find_ties(points, corners, tied):
    for k in range(len(corners)):
        a, b, c, d = corners[k, 0], corners[k, 1], corners[k, 2], corners[k, 3]
        tied[k] = (
            in_circle_sign(
                points[a, 0], points[a, 1], points[b, 0], points[b, 1],
                points[c, 0], points[c, 1], points[d, 0], points[d, 1],
            ) == 0.0
        )  # fmt: skip
