"""Segments forced into a Delaunay triangulation, and what lies outside carved away."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import Any

import numpy as np

from fem_mesh.check.judges.lawson import find_flip
from fem_mesh.check.pictures import beside, panel
from fem_mesh.check.reading import read_triangles
from fem_mesh.check.transcript import Run
from fem_mesh.check.triangulation import (
    Edge,
    Triangle,
    Triangulation,
    bad_edges,
    check_once,
    check_valid,
    check_whole,
    edge_of,
    edges_of,
    say_edge,
)
from fem_mesh.check.verdict import Wrong, at_step
from fem_mesh.domain.domain import Domain
from fem_mesh.mesh.points import as_points
from fem_mesh.mesh.validators import do_cross
from fem_mesh.predicates import orient


def judge_segments(case: dict[str, Any], run: Run) -> None:
    """Each state is a triangulation of the points; the last one is constrained Delaunay."""
    points, segments = as_points(case["points"]), [edge_of(a, b) for a, b in case["segments"]]
    mesh = Triangulation(points, map(tuple, case["triangles"]))
    for step, value in run.steps():
        with at_step(step, beside(points, panel("before the step", mesh.triangles, segments=segments))):
            after = Triangulation(points, read_triangles(value))
            judge_state(mesh, after, segments)
        mesh = after
    run.finish()
    for a, b in segments:
        if (a, b) not in mesh.edges:
            across = [edge for edge in sorted(mesh.edges) if do_cross(points, a, b, *edge)]
            yours = panel("yours", mesh.triangles, wrong_edges=across, segments=segments)
            missing = panel("the segment that is missing", right_edges=[(a, b)], segments=segments)
            raise Wrong(
                f"it ended, but segment {a}-{b} is no edge: {_list(across)} it",
                beside(points, yours, missing),
            )
    for a, b, c, d in bad_edges(mesh, kept=segments):
        yours = panel("yours", mesh.triangles, wrong_edges=[(a, b)], circles=[(a, b, c)], segments=segments, point=[d])
        rest = [t for t in mesh.triangles if not {a, b} <= set(t)]
        flipped = panel("after this flip", [*rest, (a, d, c), (d, b, c)], right_edges=[(c, d)], segments=segments)
        raise Wrong(
            f"it ended, but edge {a}-{b}, which is no segment, should be flipped: "
            f"vertex {d} lies inside the circle of {a}, {b}, {c}",
            beside(points, yours, flipped),
        )


def judge_state(before: Triangulation, after: Triangulation, segments: Iterable[Edge]) -> None:
    """A triangulation of all points, whatever it is."""
    gone, new = before.all - after.all, after.all - before.all
    try:
        check_flip(before, sorted(gone), sorted(new))
        check_valid(after)
        check_whole(after)
    except Wrong as wrong:
        edges = edges_of(new) - before.edges
        yours = panel("yours", after.triangles, wrong=new, wrong_edges=edges, segments=segments)
        raise Wrong(
            wrong.message,
            beside(
                after.points,
                yours,
                panel("before the step", before.triangles, segments=segments, right_edges=before.edges - after.edges),
            ),
        ) from None


def check_flip(before: Triangulation, gone: list[Triangle], come: list[Triangle]) -> None:
    """If what changed is one flip, it was possible."""
    flip = find_flip(gone, come)
    if flip is None:
        return
    (a, b), (c, d) = flip
    if orient(*before.at(c, d, a)) * orient(*before.at(c, d, b)) >= 0:
        raise Wrong(
            f"you flipped edge {a}-{b}, but its quadrilateral {a}, {d}, {b}, {c} is not strictly convex: "
            "leave this edge, and try it again later"
        )


def _list(edges: list[Edge]) -> str:
    if not edges:
        return "nothing crosses"
    named = ", ".join(say_edge(*edge) for edge in edges[:4])
    more = f" and {len(edges) - 4} more" if len(edges) > 4 else ""
    return f"edge {named} crosses" if len(edges) == 1 else f"edges {named}{more} cross"


def judge_carve(case: dict[str, Any], run: Run) -> None:
    """What was returned are those of the given triangles that lie inside an odd number of loops."""
    run.finish()
    points, segments = as_points(case["points"]), case["segments"]
    given = Triangulation(points, map(tuple, case["triangles"]))
    kept = Triangulation(points, read_triangles(run.returned, "returned"))
    loops = toggling(points, segments)
    inside = {triangle for triangle in given.all if is_inside(points, loops, triangle)}
    for triangle in kept.triangles:
        if triangle not in given.all:
            raise Wrong(f"triangle {triangle} is none of the given ones")
    check_once(kept)
    wrong = sorted(kept.all ^ inside)
    if wrong:
        extra = wrong[0] in kept.all
        where = "lies outside or in a hole, but you kept it" if extra else "lies inside, but you carved it away"
        yours = panel("yours", kept.triangles, wrong=wrong, segments=segments)
        expected = panel("inside an odd number of loops", inside, right=inside - kept.all, segments=segments)
        raise Wrong(f"triangle {wrong[0]} {where}", beside(points, yours, expected))


def toggling(points: np.ndarray, segments: Any) -> list[Edge]:
    """The segments that lie on loops: who crosses one changes sides."""
    domain = Domain(points, segments)
    return [edge_of(a, b) for a, b in domain.segments[domain.toggles].tolist()]


def is_inside(points: np.ndarray, loops: Iterable[Edge], triangle: Iterable[int]) -> bool:
    """Whether a ray from the triangle's centre crosses the loops an odd number of times, in fractions; without loops, yes."""
    loops = list(loops)
    if not loops:
        return True
    places = [[Fraction(x) for x in points[v].tolist()] for v in triangle]
    x, y = (sum(values, Fraction(0)) / 3 for values in zip(*places, strict=True))
    crossed = 0
    for a, b in loops:
        (ax, ay), (bx, by) = ([Fraction(value) for value in points[v].tolist()] for v in (a, b))
        if (ay <= y) != (by <= y):
            crossed += x < ax + (y - ay) * (bx - ax) / (by - ay)
    return crossed % 2 == 1
