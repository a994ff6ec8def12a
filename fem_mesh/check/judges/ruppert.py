"""Ruppert's refinement, judged vertex by vertex: each is the midpoint of a segment or the centre of a bad triangle's circle.

What students compute in floats (centres, angles) is given some room, ROOM; what is exact (midpoints of such points as
the cases have, sides, circles) is not.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from fem_mesh.algorithms.constrained_delaunay import constrained_delaunay
from fem_mesh.algorithms.delaunay import delaunay
from fem_mesh.check.judges.segments import is_inside, toggling
from fem_mesh.check.pictures import beside, panel
from fem_mesh.check.reading import read_rows, read_state
from fem_mesh.check.transcript import Run
from fem_mesh.check.triangulation import (
    Edge,
    Triangulation,
    bad_edges,
    check_valid,
    check_whole,
    edge_of,
    hull_edges,
)
from fem_mesh.check.verdict import Picture, Wrong, at_step
from fem_mesh.domain.domain import Domain
from fem_mesh.mesh.points import as_points
from fem_mesh.mesh.quality import angles, circumcenters
from fem_mesh.predicates import in_diametral_circle, in_diametral_circle_sign, orient

ROOM = 1e-7  # in degrees, and as a share of lengths
Pieces = dict[Edge, bool]  # the sub-segments, and whether who crosses one changes sides


def judge_ruppert(case: dict[str, Any], run: Run) -> None:
    """Each state has one vertex more, which Ruppert's rules allow, and is constrained Delaunay; the last one is good."""
    points, bound = as_points(case["points"]), float(case["min_angle"])
    loops = set(toggling(points, case["segments"]))
    pieces = {edge_of(a, b): edge_of(a, b) in loops for a, b in case["segments"]}
    first = constrained_delaunay(Domain(points, case["segments"])).triangles.tolist()
    state = State(Triangulation(points, map(tuple, first)), pieces, bound)
    for step, value in run.steps():
        with at_step(step, beside(state.mesh.points, state.panel())):
            points, rows = read_state(value)
            if step == 1 and len(points) == len(state.mesh.points):
                check_prefix(state.mesh.points, points, 0)
                state = state.followed_by(points, rows, pieces, set())
                continue
            check_prefix(state.mesh.points, points, 1)
            state = judge_vertex(state, points, rows)
    run.finish()
    judge_end(state)


class State:
    """A triangulation, its sub-segments, and those that a rejected centre asked to split."""

    def __init__(self, mesh: Triangulation, pieces: Pieces, bound: float, asked: Iterable[Edge] = ()) -> None:
        self.mesh, self.pieces, self.bound = mesh, pieces, bound
        loops = [piece for piece, toggles in pieces.items() if toggles]
        covers = boundary_of(mesh) == set(loops)
        self.inside = [t for t in mesh.triangles if covers or is_inside(mesh.points, loops, t)]
        rows = np.array(self.inside, np.int64).reshape(-1, 3)
        self.angles = angles(mesh.points, rows).min(axis=1)
        self.centers = circumcenters(mesh.points, rows)
        self.asked = set(asked) & set(pieces)
        for x, y in self.centers[self.angles < bound + ROOM].tolist():
            for a, b in pieces:
                (ax, ay), (bx, by) = mesh.at(a, b)
                if in_diametral_circle_sign(ax, ay, bx, by, x, y) > 0:
                    self.asked.add((a, b))

    def followed_by(self, points: np.ndarray, rows: Any, pieces: Pieces, asked: set[Edge]) -> State:
        """The next state, if it is a constrained Delaunay triangulation of the domain."""
        mesh = Triangulation(points, rows)
        try:
            check_valid(mesh)
            check_covers(mesh, pieces)
        except Wrong as wrong:
            raise Wrong(wrong.message, self.picture(mesh, pieces, wrong=mesh.all - self.mesh.all)) from None
        for a, b, c, d in bad_edges(mesh, kept=pieces):
            raise Wrong(
                f"the circle of triangle {(a, b, c)} holds point {d}, and no segment lies between them: "
                "the triangles are not constrained Delaunay",
                self.picture(mesh, pieces, wrong=[(a, b, c)], circles=[(a, b, c)], point=[d]),
            )
        return State(mesh, pieces, self.bound, asked)

    def picture(self, mesh: Triangulation, pieces: Pieces, **mine: Any) -> Picture:
        """Theirs beside the state before."""
        yours = panel("yours", mesh.triangles, segments=pieces, **mine)
        return beside(mesh.points, yours, self.panel())

    def panel(self) -> dict[str, Any]:
        """This state, and what is to be split first."""
        first = [piece for piece, _ in self.encroached()]
        title = "before the step: to be split" if first else "before the step"
        return panel(title, self.mesh.triangles, points=self.mesh.points, segments=self.pieces, right_edges=first)

    def encroached(self) -> list[tuple[Edge, int]]:
        """The sub-segments with a vertex well inside their circles that sees them, from a triangle beside.

        Whether a vertex sees one that is no edge is not asked: it has to be split.
        """
        found = []
        for a, b in sorted(self.pieces):
            tips: Iterable[int] = [self.mesh.apex[e] for e in ((a, b), (b, a)) if e in self.mesh.apex]
            for tip in tips or sorted(set(range(len(self.mesh.points))) - {a, b}):
                if is_well_inside(*self.mesh.at(a, b, tip)):
                    found.append(((a, b), tip))
        return found


def check_prefix(before: np.ndarray, points: np.ndarray, more: int) -> None:
    """The points are those before, and so many more."""
    if len(points) != len(before) + more:
        raise Wrong(f"there are {len(points)} points, after {len(before)}: each state has one more than the one before")
    for v in np.flatnonzero((points[: len(before)] != before).any(axis=1))[:1]:
        raise Wrong(f"point {v} has moved, from {_at(before[v])} to {_at(points[v])}: new points come last")


def judge_vertex(state: State, points: np.ndarray, rows: Any) -> State:
    """The newest vertex splits a sub-segment that is encroached, or is the centre of a bad triangle's circle."""
    new, mesh = len(points) - 1, state.mesh
    p = points[new]
    piece = next((e for e in state.pieces if (mesh.points[list(e)].sum(axis=0) / 2 == p).all()), None)
    if piece is not None:
        a, b = piece
        if piece not in state.asked and not any(in_diametral_circle(*mesh.at(a, b, v)) for v in range(new) if v not in piece):
            yours = panel("yours", mesh.triangles, segments=state.pieces, wrong_edges=[piece], diametral=[piece])
            raise Wrong(
                f"you split segment {a}-{b}, but neither a vertex nor the centre of a bad triangle's circle "
                "lies inside its circle",
                beside(mesh.points, yours, state.panel()),
            )
        halves = {edge_of(a, new): state.pieces[piece], edge_of(b, new): state.pieces[piece]}
        pieces = {e: toggles for e, toggles in state.pieces.items() if e != piece} | halves
        return state.followed_by(points, rows, pieces, state.asked)
    judge_center(state, points)
    after = state.followed_by(points, rows, state.pieces, state.asked)
    for (a, b), tip in after.encroached():
        if tip == new:
            raise Wrong(
                f"the new point {new} lies inside the circle of segment {a}-{b}: split the segment instead",
                state.picture(after.mesh, state.pieces, wrong_edges=[(a, b)], diametral=[(a, b)], point=[new]),
            )
    return after


def judge_center(state: State, points: np.ndarray) -> None:
    """The newest point is the centre of a bad triangle's circle, and no segment has to be split first."""
    p, mesh, new = points[-1], state.mesh, [len(points) - 1]
    rows = np.array(state.inside, np.int64).reshape(-1, 3)
    radii = np.hypot(*(mesh.points[rows[:, 0]] - state.centers).T)
    hits = np.flatnonzero(np.hypot(*(state.centers - p).T) <= ROOM * radii)
    if not len(hits):
        raise no_center(state, points)
    best = hits[state.angles[hits].argmin()]
    triangle = tuple(state.inside[best])
    yours: dict[str, Any] = {"segments": state.pieces, "circles": [triangle], "point": new}
    if state.angles[best] > state.bound + ROOM:
        raise Wrong(
            f"the new point {_at(p)} is the centre of the circle of triangle {triangle}, whose smallest angle, "
            f"{state.angles[best]:.1f} degrees, is not below {state.bound:g}",
            beside(points, panel("yours", mesh.triangles, wrong=[triangle], **yours), state.panel()),
        )
    for (a, b), tip in state.encroached():
        raise Wrong(
            f"you inserted the centre of a circle, but segment {a}-{b} is encroached upon by vertex {tip}: it is split first",
            beside(points, panel("yours", mesh.triangles, **yours), {**state.panel(), "diametral": [[a, b]], "point": [tip]}),
        )


def no_center(state: State, points: np.ndarray) -> Wrong:
    """What the newest point is, if it is no centre of a triangle inside: there already, one of outside, or nothing."""
    p, mesh, new = points[-1], state.mesh, [len(points) - 1]
    yours: dict[str, Any] = {"segments": state.pieces, "point": new}
    for v in np.flatnonzero((mesh.points == p).all(axis=1))[:1].tolist():
        ends = [w for piece in state.pieces if v in piece for w in piece if w != v]
        is_split = len(ends) == 2 and orient(*mesh.at(ends[0], v, ends[1])) == 0
        more = ": once a segment is split, its halves take its place in the list" if is_split else ""
        return Wrong(
            f"the new point {_at(p)} is vertex {v} again{more}",
            beside(points, panel("yours", mesh.triangles, **yours), state.panel()),
        )
    loops = [piece for piece, toggles in state.pieces.items() if toggles]
    whole = Triangulation(mesh.points, map(tuple, delaunay(mesh.points).triangles.tolist()))  # of the hull
    for triangle in sorted(t for t in whole.triangles if not is_inside(mesh.points, loops, t)):
        center = circumcenters(mesh.points, np.array([triangle]))[0]
        if np.hypot(*(p - center)) <= ROOM * np.hypot(*(mesh.points[triangle[0]] - center)):
            return Wrong(
                f"the new point {_at(p)} is the centre of the circle of triangle {triangle}, which lies outside the domain: "
                "only triangles inside are refined",
                beside(points, panel("yours", mesh.triangles, wrong=[triangle], circles=[triangle], **yours), state.panel()),
            )
    return Wrong(
        f"the new point {_at(p)} is neither the midpoint of a segment nor the centre of the circle of a triangle",
        beside(points, panel("yours", mesh.triangles, **yours), state.panel()),
    )


def check_covers(mesh: Triangulation, pieces: Pieces) -> None:
    """The triangles cover the domain, with every sub-segment an edge; or the whole hull, Delaunay."""
    loops = {piece for piece, toggles in pieces.items() if toggles}
    boundary, edges = boundary_of(mesh), mesh.edges
    if boundary != loops:
        if loops and boundary == {edge_of(*e) for e in hull_edges(mesh.points)} and not list(bad_edges(mesh)):
            return
        if not loops:
            check_whole(mesh)
    for a, b in sorted(pieces):
        if (a, b) not in edges:
            raise Wrong(f"segment {a}-{b} is no edge of the triangles")
    for a, b in sorted(boundary - loops if loops else ()):
        raise Wrong(f"the domain is not covered: one side of edge {a}-{b} has no triangle, and it is no segment")
    for a, b in sorted(loops - boundary):
        raise Wrong(f"segment {a}-{b} bounds the domain, but has triangles on both sides")
    for v in sorted(set(range(len(mesh.points))) - {v for t in mesh.triangles for v in t}):
        raise Wrong(f"point {v} is in no triangle")


def boundary_of(mesh: Triangulation) -> set[Edge]:
    """The edges with one triangle."""
    return {edge_of(a, b) for a, b in mesh.apex if (b, a) not in mesh.apex}


def judge_end(state: State) -> None:
    """Nothing is left to do."""
    mesh = state.mesh
    for (a, b), tip in state.encroached():
        yours = panel("yours", mesh.triangles, segments=state.pieces, wrong_edges=[(a, b)], diametral=[(a, b)], point=[tip])
        raise Wrong(f"it ended, but segment {a}-{b} is encroached upon by vertex {tip}", beside(mesh.points, yours))
    for i in np.flatnonzero(state.angles < state.bound - ROOM)[:1]:
        triangle = tuple(state.inside[i])
        yours = panel("yours", mesh.triangles, segments=state.pieces, wrong=[triangle], circles=[triangle])
        raise Wrong(
            f"it ended, but triangle {triangle} has an angle of {state.angles[i]:.1f} degrees, below {state.bound:g}",
            beside(mesh.points, yours),
        )


def is_well_inside(a: Any, b: Any, p: Any) -> bool:
    """Whether p lies inside the circle over ab by more than rounding."""
    (ax, ay), (bx, by), (x, y) = a, b, p
    return bool((ax - x) * (bx - x) + (ay - y) * (by - y) < -ROOM * ((bx - ax) ** 2 + (by - ay) ** 2))


def _at(p: np.ndarray) -> str:
    return f"({p[0]:.6g}, {p[1]:.6g})"


# ---- the test alone ----------------------------------------------------------------------------------


def judge_encroached(case: dict[str, Any], run: Run) -> None:
    """What was returned are the segments that have a point strictly inside their circles."""
    run.finish()
    places, segments = [tuple(p) for p in case["points"]], [edge_of(a, b) for a, b in case["segments"]]
    if isinstance(run.returned, list) and any(isinstance(i, int) for i in run.returned):
        raise Wrong("you returned numbers: return the segments themselves, as pairs (a, b)")
    rows = [edge_of(*row) for row in read_rows(run.returned, "segment", 2, "returned")]
    found = set(rows)
    for edge in sorted(found - set(segments)):
        raise Wrong(f"{edge} is none of the segments")
    upon = {
        (a, b): [v for v, p in enumerate(places) if v not in (a, b) and in_diametral_circle(places[a], places[b], p)]
        for a, b in segments
    }
    truth = {edge for edge, vertices in upon.items() if vertices}
    for a, b in segments:
        inside = upon[a, b]
        if bool(inside) != ((a, b) in found):
            said = "you left it out" if inside else "you returned it"
            where = f"point {inside[0]} lies" if inside else "no point lies strictly"
            yours = panel("yours", segments=segments, wrong_edges=found ^ truth, diametral=[(a, b)], point=inside[:1])
            right = panel("expected", segments=segments, right_edges=truth, diametral=[(a, b)], point=inside[:1])
            raise Wrong(f"{where} inside the circle over segment {a}-{b}, but {said}", beside(places, yours, right))
        if rows.count((a, b)) > 1:
            raise Wrong(f"segment {a}-{b} is there more than once: one point inside is enough")
