"""Pieces of algorithms, judged alone: one flip, one cavity."""

from __future__ import annotations

from typing import Any

from fem_mesh.check.pictures import beside, panel
from fem_mesh.check.reading import describe, read_triangles
from fem_mesh.check.transcript import Run
from fem_mesh.check.triangulation import Edge, Triangle, Triangulation, check_once, edge_of, say_edge
from fem_mesh.check.verdict import Wrong
from fem_mesh.mesh.points import as_points
from fem_mesh.predicates import in_circle, in_circle_sign, orient


def judge_flip(case: dict[str, Any], run: Run) -> None:
    """Each time all triangles came back, with the other diagonal; or None, where there is none."""
    for (places, rows, edge), returned in zip(case["calls"], run.yields, strict=False):
        judge_exchange(Triangulation(as_points(places), map(tuple, rows)), edge_of(*edge), returned)
    run.finish(len(case["calls"]))


def judge_exchange(before: Triangulation, edge: Edge, returned: Any) -> None:
    """One flip of ``edge``."""
    (a, b), name = edge, f"edge {say_edge(*edge)}"
    tips = before.apex.get((a, b)), before.apex.get((b, a))
    shown = panel(f"before: {name}", before.triangles, edges=[edge])
    if None in tips:
        _must_be_none(returned, f"{name} lies on the hull, so it cannot be flipped", before, shown)
        return
    c, d = (int(tip) for tip in tips if tip is not None)
    sides = orient(*before.at(c, d, a)) * orient(*before.at(c, d, b))
    if sides >= 0:
        why = "is not convex" if sides > 0 else "has three corners on one line"
        _must_be_none(
            returned, f"the quadrilateral {a}, {d}, {b}, {c} around {name} {why}, so it cannot be flipped", before, shown
        )
        return
    if returned is None:
        raise Wrong(
            f"{name} can be flipped, for its quadrilateral {a}, {d}, {b}, {c} is convex, but you returned None",
            beside(before.points, shown),
        )
    compare(before, edge, edge_of(c, d), Triangulation(before.points, read_triangles(returned, "returned")))


def _must_be_none(returned: Any, why: str, before: Triangulation, shown: dict[str, Any]) -> None:
    if returned is not None:
        raise Wrong(f"{why}: return None, not {describe(returned)}", beside(before.points, shown))


def compare(before: Triangulation, edge: Edge, other: Edge, after: Triangulation) -> None:
    """All triangles but two are there, and two new ones."""
    old = {t for t in before.all if set(edge) <= set(t)}
    new = Triangulation(before.points, [(v, *other) for v in edge]).all
    expected, (name, instead) = before.all - old | new, (say_edge(*edge), say_edge(*other))
    yours = panel("yours", after.triangles, wrong=after.all - expected)
    picture = beside(before.points, yours, panel("expected", expected, right=new, right_edges=[other]))
    for t in sorted(old & after.all):
        raise Wrong(f"triangle {t} is still there, but edge {name} has to go from it", picture)
    for t in sorted(before.all - old - after.all):
        raise Wrong(f"triangle {t} is missing: return all triangles, also those that stay as they are", picture)
    for t in sorted(after.all - expected):
        raise Wrong(f"triangle {t} should not be there: edge {name} becomes {instead}, which two new triangles share", picture)
    for t in sorted(expected - after.all):
        raise Wrong(f"triangle {t} is missing: edge {name} becomes {instead}, which two new triangles share", picture)


def judge_cavity(case: dict[str, Any], run: Run) -> None:
    """Each time those of the triangles came back whose circles hold the point."""
    for (places, rows, p), returned in zip(case["calls"], run.yields, strict=False):
        points = as_points(places)
        given = Triangulation(points, map(tuple, rows))
        found = Triangulation(points, read_triangles(returned, "returned"))
        check_once(found)
        for t in sorted(found.all - given.all):
            raise Wrong(f"triangle {t} is none of the given ones")
        right = {t for t in given.all if holds(given, t, p)}
        for t in sorted(found.all ^ right):
            raise _misjudged(given, found, right, t, p)
    run.finish(len(case["calls"]))


def holds(given: Triangulation, t: Triangle, p: list[float]) -> bool:
    """Whether a triangle's circle holds p."""
    a, b, c = given.at(*t)
    return in_circle(a, b, c, p)


def _misjudged(given: Triangulation, found: Triangulation, right: set[Triangle], t: Triangle, p: list[float]) -> Wrong:
    where = f"({', '.join(f'{x:g}' if float(f'{x:g}') == x else repr(x) for x in p)})"
    if t in right:
        message = f"triangle {t} is missing: the point {where} lies inside its circle"
    elif in_circle_sign(*(x for q in [*given.at(*t), p] for x in q)) == 0:
        message = f"triangle {t} is too much: the point {where} lies on its circle, not inside"
    else:
        message = f"triangle {t} is too much: the point {where} lies outside its circle"
    points = [*given.points.tolist(), p]
    looked: dict[str, Any] = {"circles": [t], "point": [len(points) - 1]}
    yours = panel("yours", given.triangles, wrong=found.all, **looked)
    return Wrong(message, beside(points, yours, panel("the cavity", given.triangles, right=right, **looked)))
