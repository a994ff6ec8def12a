"""Bowyer and Watson, judged point by point: after each the triangles are Delaunay for the points so far."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from fem_mesh.algorithms.delaunay import delaunay
from fem_mesh.check.pictures import beside, panel
from fem_mesh.check.reading import Row, read_triangles
from fem_mesh.check.transcript import Run
from fem_mesh.check.triangulation import (
    Edge,
    Triangulation,
    bad_edges,
    check_valid,
    check_whole,
    edges_of,
    missing_hull,
)
from fem_mesh.check.verdict import Picture, Wrong, at_step
from fem_mesh.mesh.points import as_points
from fem_mesh.mesh.validators import on_a_line
from fem_mesh.predicates import in_circle, in_circle_sign, orient


def judge_bowyer_watson(case: dict[str, Any], run: Run) -> None:
    """Each state is Delaunay for one point more than the one before; empty ones come before there is a triangle."""
    points = as_points(case["points"])
    n = len(points)
    first = next((k for k in range(3, n + 1) if not on_a_line(points[:k])), n + 1)  # points with a triangle
    k, mesh = first - 1, Triangulation(points, [])
    for step, value in run.steps():
        with at_step(step, beside(points, panel("before the step", mesh.triangles))):
            rows = read_triangles(value)
            if not rows and k == first - 1 and step <= k:
                continue
            if not rows and k == first - 1 and first <= n < len(run.yields):
                raise Wrong(f"there are {len(run.yields)} states of {n} points: yield once after each point, not before")
            k += 1
            if k > n:
                raise Wrong("all points are in already: yield once after each point" if first <= n else _on_a_line(n, rows))
            mesh = judge_insertion(mesh, points, rows, k)
    run.finish()
    if k < n:
        raise Wrong(f"it ended with {max(k, 0) if k >= first else 0} of {n} points: yield the triangles after each point")


def judge_insertion(before: Triangulation, points: np.ndarray, rows: list[Row], k: int) -> Triangulation:
    """The triangles of the first ``k`` points, if they are Delaunay."""
    for row in rows:
        check_corners(row, len(points), k)
    mesh = Triangulation(points[:k], rows)
    new, at = k - 1, mesh.at
    for triangle in sorted(before.all & mesh.all):
        if in_circle(*at(*triangle, new)):
            raise Wrong(
                f"triangle {triangle} should have gone: the new point {new} lies inside its circle",
                _picture(mesh, wrong=[triangle], circles=[triangle]),
            )
    try:
        check_valid(mesh)
        check_whole(mesh)
    except Wrong as wrong:
        raise explain(wrong, before, mesh) from None
    for a, b, c, d in bad_edges(mesh):
        raise Wrong(
            f"the circle of triangle {(a, b, c)} holds point {d}: the triangles are not Delaunay",
            _picture(mesh, wrong=[(a, b, c)], circles=[(a, b, c)]),
        )
    return mesh


def check_corners(row: Row, n: int, k: int) -> None:
    """A triangle has corners among the first ``k`` of ``n`` points."""
    for v in row:
        if not 0 <= v < n:
            raise Wrong(
                f"triangle {row} has corner {v}, but the points are numbered from 0 to {n - 1}: "
                "leave out the triangles that hang on a super-triangle or ghost"
            )
        if v >= k:
            raise Wrong(f"triangle {row} uses point {v}, but the points so far are 0 to {k - 1}: each yield has one more")


def explain(wrong: Wrong, before: Triangulation, mesh: Triangulation) -> Wrong:
    """What is wrong with triangles, told by what was done for the newest point."""
    new = len(mesh.points) - 1
    p = mesh.points[new].tolist()
    for triangle in sorted(before.all - mesh.all):
        a, b, c = mesh.at(*triangle)
        if not in_circle(a, b, c, p):
            where = "outside its circle" if in_circle_sign(*a, *b, *c, *p) else "on its circle, not inside"
            return Wrong(
                f"triangle {triangle} has gone, but the new point {new} lies {where}, and {wrong.message}",
                _picture(mesh, wrong=mesh.all - before.all, circles=[triangle]),
            )
    for triangle in sorted(mesh.all - before.all):
        if before.all and new not in triangle:
            return Wrong(
                f"triangle {triangle} is new, but all that come with point {new} have it as a corner; and {wrong.message}",
                _picture(mesh, wrong=[triangle]),
            )
        if new in triangle and orient(*mesh.at(*triangle)) == 0:
            u, v = (w for w in triangle if w != new)
            return Wrong(
                f"triangle {triangle} is flat: the new point {new} lies on the line through {u} and {v}, "
                "so this edge must not be joined to it",
                _picture(mesh, wrong_edges=edges_of([triangle])),
            )
    lost = missing_hull(mesh) if "convex hull" in wrong.message else []
    more = ": if you use a super-triangle, it is too near; if ghosts, an edge of the hull has none" if lost else ""
    return Wrong(wrong.message + more, _picture(mesh, lost, wrong=mesh.all - before.all))


def _on_a_line(n: int, rows: list[Row]) -> str:
    more = f"triangle {rows[0]} is flat" if rows else "yield no more than once after each point"
    return f"all {n} points lie on one line, so there is no triangle: {more}"


def _picture(mesh: Triangulation, lost: Iterable[Edge] = (), **mine: Any) -> Picture:
    """Theirs beside a Delaunay triangulation of the same points, with edges that are lost; the newest one wears a ring."""
    new = [len(mesh.points) - 1]
    good = Triangulation(mesh.points, map(tuple, delaunay(mesh.points).triangles.tolist()))
    yours = panel("yours", mesh.triangles, point=new, **mine)
    return beside(mesh.points, yours, panel("Delaunay", good.triangles, right=good.all - mesh.all, right_edges=lost, point=new))
