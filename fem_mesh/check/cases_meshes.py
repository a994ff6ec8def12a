"""Cases for what makes and changes triangulations of points."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem_mesh.algorithms.delaunay import delaunay
from fem_mesh.algorithms.sweep import any_triangulation
from fem_mesh.mesh.points import grid_points, random_points, ring_points

Case = dict[str, Any]
KITE = [(0, 0), (4, 0), (5, 3), (1, 2)]
SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]
DART = [(0, 0), (6, 0), (3, 5), (3, 1)]  # its last point lies inside the triangle of the others
CIRCLE = [(5, 0), (4, 3), (0, 5), (-3, 4), (-5, 0), (-3, -4), (0, -5), (4, -3)]  # exactly


def of_lawson(random: np.random.Generator) -> list[Case]:
    some = random.random((9, 2))
    return [
        _flips("a kite with the wrong diagonal", KITE, [(0, 1, 2), (0, 2, 3)]),
        _flips("a kite that is Delaunay already", KITE, [(0, 1, 3), (1, 2, 3)]),
        _flips("a square, whose diagonals tie", SQUARE, [(0, 1, 2), (0, 2, 3)]),
        _flips("three triangles around a point", DART),
        _flips("nine random points", some),
        _flips("points on a grid", grid_points(4)[random.permutation(16)]),
        _flips("points on a circle, and its centre", [*CIRCLE, (0, 0)]),
        _flips("a regular polygon, rounded", ring_points(14)),
        _flips("nine points, far from the origin and close together", np.round(some * 2**10) / 2**10 + 2.0**20),
        _flips("tiny triangles", some * 2.0**-40),
        _flips("twenty-five random points", random.random((25, 2))),
    ]


def _flips(name: str, points: Any, triangles: Any = None) -> Case:
    """From a bad triangulation to Delaunay. No edge is flipped twice, so n (n - 1) / 2 flips are enough (Lawson 1977)."""
    n = len(points)
    return meshed(name, points, any_triangulation(points) if triangles is None else triangles) | {"steps": n * (n - 1) // 2}


def of_bowyer_watson(random: np.random.Generator) -> list[Case]:
    outward = random_points(14, seed=3) * np.linspace(0.1, 8, 14)[:, None] ** 2
    return [
        _points("one triangle", [(0, 0), (4, 0), (1, 3)]),
        _points("a kite", KITE),
        _points("a point inside, then one outside", [*DART, (9, 9)]),
        _points("random points", random.random((15, 2))),
        _points("a point on an edge of the hull", [(0, 0), (4, 0), (0, 4), (2, 2), (0, 2), (2, 0), (1, 1)]),
        _points("the first points on a line", [(0, 0), (2, 2), (1, 1), (3, 3), (2, 0), (0, 2)]),
        _points("points on a grid", grid_points(4)[random.permutation(16)]),
        _points("points on a circle, and its centre", [*CIRCLE, (0, 0)]),
        _points("a flat hull: the circles there are huge", [(0, 0), (10, 0), (5, 2.0**-40), (5, -4), (2, -1), (8, -1)]),
        _points("points farther and farther out", outward),
        _points("points on a line", [(0, 0), (1, 2), (2, 4), (-1, -2)]),
        _points("a regular polygon, rounded", ring_points(16)[random.permutation(16)]),
        _points("random points, tiny and far from the origin", np.round(random.random((12, 2)) * 2**10) / 2**40 + 2.0**-4),
    ]


def _points(name: str, points: Any) -> Case:
    return {"name": name, "points": as_lists(points, float), "steps": len(points) + 1}


def meshed(name: str, points: Any, triangles: Any = None) -> Case:
    """Points and triangles, Delaunay if none are given."""
    rows = delaunay(points).triangles if triangles is None else triangles
    return {"name": name, "points": as_lists(points, float), "triangles": as_lists(rows, int)}


def as_lists(rows: Any, kind: type) -> list[list[Any]]:
    """Rows as lists of plain numbers."""
    return [[kind(value) for value in row] for row in rows]
