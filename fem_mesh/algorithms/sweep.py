"""A deliberately bad, but valid, triangulation: what Lawson's flips start from.

    sort the points by x, then y
    join each point to every hull edge that it sees

The next point is to the right of all before it, so it lies outside their hull and sees a chain of its
edges. The triangles that come out are slivers, all fanned from the left. Ends because each point is taken
once, and each hull edge that is covered was made once: O(n log n).
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.mesh.points import as_points
from fem_mesh.predicates import orient_sign


def any_triangulation(points: Any) -> np.ndarray:
    """A valid triangulation with many slivers, int32 (m, 3), counter-clockwise: a start for ``lawson``.

    Covers the convex hull and uses every point (of equal points the first). Raises MeshError where no
    triangle exists: fewer than 3 points, or all on one line.

    >>> any_triangulation([(0, 0), (1, 2), (2, 1), (3, 3)]).tolist()
    [[1, 0, 2], [1, 2, 3]]
    """
    points = as_points(points)
    line, triangles, rest = _first_fan(points)
    # The hull from the left end to the newest point and back: `lower` runs along its bottom, `upper`
    # along its top; both end at the newest point.
    apex = triangles[0][2] if triangles else -1
    if apex < 0:
        raise MeshError(f"no triangulation: all {len(points)} points lie on one line, or are fewer than 3")
    above = orient_sign(*points[line[0]], *points[line[1]], *points[apex]) > 0
    lower, upper = ([*line, apex], [line[0], apex]) if above else ([line[0], apex], [*line, apex])
    for p in rest:
        while len(lower) > 1 and _turn(points, lower[-2], lower[-1], p) < 0:  # p sees the last lower edge
            triangles.append((lower[-2], p, lower[-1]))
            lower.pop()
        while len(upper) > 1 and _turn(points, upper[-2], upper[-1], p) > 0:
            triangles.append((upper[-2], upper[-1], p))
            upper.pop()
        lower.append(p)
        upper.append(p)
    return np.array(triangles, np.int32)


def _first_fan(points: np.ndarray) -> tuple[list[int], list[tuple[int, int, int]], list[int]]:
    """The points on the first line, left to right; triangles from the first point off it to them; the rest."""
    order = np.lexsort((np.arange(len(points)), points[:, 1], points[:, 0])).tolist()
    order = [v for i, v in enumerate(order) if i == 0 or (points[v] != points[order[i - 1]]).any()]
    line = order[:2]
    for i in range(2, len(order)):
        p = order[i]
        side = _turn(points, line[0], line[1], p)
        if side:
            return line, [(a, b, p) if side > 0 else (b, a, p) for a, b in pairwise(line)], order[i + 1 :]
        line.append(p)
    return line, [], []


def _turn(points: np.ndarray, a: int, b: int, c: int) -> float:
    return float(orient_sign(*points[a].tolist(), *points[b].tolist(), *points[c].tolist()))
