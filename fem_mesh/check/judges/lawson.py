"""Lawson's flips, judged one by one: each must be legal and needed, and when there are no more, the mesh is Delaunay."""

from __future__ import annotations

import functools
import operator
from collections import Counter
from collections.abc import Iterable
from typing import Any

from fem_mesh.check.pictures import beside, panel
from fem_mesh.check.reading import Row, read_triangles
from fem_mesh.check.transcript import Run
from fem_mesh.check.triangulation import (
    Edge,
    Triangle,
    Triangulation,
    bad_edges,
    check_valid,
    check_whole,
    edge_of,
    edges_of,
    say_edge,
)
from fem_mesh.check.verdict import Picture, Wrong, at_step
from fem_mesh.mesh.points import as_points
from fem_mesh.predicates import in_circle, in_circle_sign, orient


def judge_lawson(case: dict[str, Any], run: Run) -> None:
    """Each state is the one before with one edge flipped, which had to be; the last one is Delaunay."""
    points = as_points(case["points"])
    mesh = Triangulation(points, map(tuple, case["triangles"]))
    for step, value in run.steps():
        with at_step(step, beside(points, panel("before the step", mesh.triangles))):
            after = Triangulation(points, read_triangles(value))
            judge_change(mesh, after)
        mesh = after
    run.finish()
    for a, b, c, d in bad_edges(mesh):
        raise Wrong(
            f"it ended, but edge {a}-{b} should still be flipped: vertex {d} lies inside the circle of {a}, {b}, {c}",
            _still_bad(mesh, a, b, c, d),
        )


def judge_change(before: Triangulation, after: Triangulation) -> None:
    """What changed is one flip, legal and needed."""
    was, now = Counter(before.triangles), Counter(after.triangles)
    gone, come = [*(was - now).elements()], [*(now - was).elements()]
    if not gone and not come:
        raise Wrong("nothing has changed since the step before: yield after each flip, and only then")
    flip = find_flip(gone, come)
    if flip is None:
        picture = _changed(before, after, "before the step", before.edges - after.edges)
        try:
            check_valid(after)
            check_whole(after)
        except Wrong as wrong:
            raise Wrong(wrong.message, picture) from None
        raise Wrong(f"{len(gone)} triangles were replaced at once: yield after each single flip", picture)
    (a, b), (c, d) = flip
    edge, at = f"edge {say_edge(a, b)}", before.at
    sides = orient(*at(c, d, a)) * orient(*at(c, d, b))
    if sides >= 0:
        why = "is not convex" if sides > 0 else "has three corners on one line"
        raise Wrong(
            f"{edge} cannot be flipped: its quadrilateral {a}, {d}, {b}, {c} {why}, "
            f"so edge {say_edge(c, d)} is no diagonal of it",
            _changed(before, after, f"{edge} stays", [(a, b)]),
        )
    c, d = (c, d) if orient(*at(a, b, c)) > 0 else (d, c)
    if not in_circle(*at(a, b, c, d)):
        why = "but no vertex lies inside either circle"
        if in_circle_sign(*functools.reduce(operator.iadd, at(a, b, c, d), [])) == 0:
            why = f"but {a}, {b}, {c} and {d} lie on one circle: a tie is left as it is"
        raise Wrong(f"you flipped {edge}, {why}", _changed(before, after, f"{edge} stays", [(a, b)], [(a, b, c)]))


def find_flip(gone: list[Triangle], come: list[Triangle]) -> tuple[Edge, Edge] | None:
    """The edge that two triangles shared, and the one that the two in their place share: None if it is no flip."""
    if len(gone) != 2 or len(come) != 2:
        return None
    old, new = (set.intersection(*map(set, pair)) for pair in (gone, come))
    corners = set().union(*gone)
    if len(old) != 2 or len(new) != 2 or corners != set().union(*come) or old | new != corners or old & new:
        return None
    return edge_of(*old), edge_of(*new)


def _changed(
    before: Triangulation, after: Triangulation, title: str, stays: Iterable[Edge] = (), circles: Iterable[Row] = ()
) -> Picture:
    """What came, beside what was there."""
    new = {*(Counter(after.triangles) - Counter(before.triangles))}
    edges = edges_of(new) - before.edges
    yours = panel("yours", after.triangles, wrong=new, wrong_edges=edges)
    return beside(after.points, yours, panel(title, before.triangles, right_edges=stays, circles=circles))


def _still_bad(mesh: Triangulation, a: int, b: int, c: int, d: int) -> Picture:
    """An edge that should go, beside the flip."""
    bad, new = [(a, b, c), (b, a, d)], [(a, d, c), (d, b, c)]
    rest = [t for t in mesh.triangles if not {a, b} <= set(t)]
    yours = panel("yours", mesh.triangles, wrong=bad, wrong_edges=[(a, b)], circles=[(a, b, c)], point=[d])
    return beside(
        mesh.points, yours, panel("after this flip", [*rest, *new], right=new, right_edges=[(c, d)], circles=[(a, d, c)])
    )
