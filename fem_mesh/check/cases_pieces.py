"""Cases for the pieces of algorithms: one flip, one cavity. A case holds calls, each with all arguments."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem_mesh.algorithms.sweep import any_triangulation
from fem_mesh.check.cases_meshes import CIRCLE, DART, KITE, SQUARE, as_lists, meshed
from fem_mesh.mesh.points import grid_points

Case = dict[str, Any]
HAIR = 2.0**-50


def of_flip(random: np.random.Generator) -> list[Case]:
    line = [(0, 0), (2, 0), (4, 0), (2, 3)]
    above, below = ([(0, 0), (1, 0), (2, by), (1, 3)] for by in (HAIR, -HAIR))
    two = [(0, 1, 3), (1, 2, 3)]
    return [
        _flips("a kite", KITE, [(0, 1, 2), (0, 2, 3)], [(0, 2)]),
        _flips("a kite, with its edge named from end to start", KITE, [(0, 1, 3), (1, 2, 3)], [(3, 1)]),
        _flips("a square: whether an edge is legal plays no part", SQUARE, [(0, 1, 2), (0, 2, 3)], [(0, 2)]),
        _flips("edges of the hull", KITE, [(0, 1, 2), (0, 2, 3)], [(0, 1), (2, 3)]),
        _flips("a quadrilateral with a notch", DART, any_triangulation(DART), [(0, 3), (3, 1), (2, 3)]),
        _flips("three corners on a line", line, two, [(1, 3)]),
        _flips("three corners on a line but for a hair: convex", above, two, [(1, 3)]),
        _flips("three corners on a line but for a hair: a notch", below, two, [(3, 1)]),
        _flips("all edges of a triangulation", some := random.random((9, 2)), rows := any_triangulation(some), _edges(rows)),
    ]


def _edges(rows: np.ndarray) -> list[tuple[int, int]]:
    return sorted({(int(min(u, v)), int(max(u, v))) for t in rows for u, v in zip(t, np.roll(t, 1), strict=True)})


def _flips(name: str, points: Any, triangles: Any, edges: Any) -> Case:
    given = [as_lists(points, float), as_lists(triangles, int)]
    return {"name": name, "calls": [[*given, list(edge)] for edge in edges]}


def of_cavity(random: np.random.Generator) -> list[Case]:
    some, at = random.random((12, 2)), random.random((5, 2)) * 1.4 - 0.2
    return [
        _digs("a point inside one circle", KITE, [(0.5, 0.25), (4.625, 2.0)]),
        _digs("a point inside both circles", KITE, [(2.5, 1.0), (2.6, 1.2)]),
        _digs("a point on an edge", SQUARE, [(2, 2), (2, 0), (1, 1), (3, 1)]),
        _digs("a point outside the hull, but inside a circle", KITE, [(4.9, 1.0), (2.0, -0.5)]),
        _digs("a point outside all circles", KITE, [(20, 20), (-3, 1)]),
        _digs("random points", some, at),
        _digs("a point that is there already", KITE, KITE),
        _digs("a grid: points exactly on circles", grid_points(4), [(0.5, 0.5), (1.5, 1.25), (2, 1), (3.5, 0.5)]),
        _digs("a point on a circle but for a hair", CIRCLE[::2][:3], [(0, -5), (0, -5 + 2 * HAIR), (0, -5 - 2 * HAIR)]),
    ]


def _digs(name: str, points: Any, at: Any) -> Case:
    case = meshed(name, points)
    return {"name": name, "calls": [[case["points"], case["triangles"], [float(x) for x in p]] for p in at]}
