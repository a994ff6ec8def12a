"""Cases with segments: to force in, to carve along, to refine between.

Points lie on no segment but at its ends, and those to refine have few binary digits, so that midpoints are exact.
"""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np

from fem_mesh.algorithms.constrained_delaunay import insert_segments
from fem_mesh.check.cases_meshes import CIRCLE, SQUARE, as_lists, meshed
from fem_mesh.domain.domain import Domain
from fem_mesh.mesh.points import grid_points
from fem_mesh.mesh.validators import do_cross

Case = dict[str, Any]
COMB = [(0, 0), (12, 0), (12, 6), (11, 6), (10, 1), (9, 6), (8, 6), (7, 1), (6, 6), (0, 7)]
ELL = [(0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4)]


# ---- segments forced in ------------------------------------------------------------------------------


def of_segments(random: np.random.Generator) -> list[Case]:
    rows = np.column_stack([np.arange(16) // 2 + random.integers(1, 7, 16) / 16, np.tile([1, -1], 8)])
    some, few, many = random.random((12, 2)), random.random((9, 2)), random.random((24, 2))
    return [
        _forced("a segment that is there already", [(0, 0), (4, 0), (5, 3), (1, 2)], [(1, 3)]),
        _forced("a segment across one edge", [(0, 0), (9, 0), (4, 2), (5, -2)], [(0, 1)]),
        _forced("a segment across many edges", [(-1, 0.25), (9, -0.25), *rows], [(0, 1)]),
        _forced("a square with a diagonal that ties", SQUARE, [(0, 2), (1, 2)]),
        _forced("a diagonal of a polygon on a circle", [*CIRCLE, (0, 0.5)], [(0, 3), (3, 5), (5, 0)]),
        _forced("random segments", some, apart(some, random, 5)),
        _forced("a knight's moves on a grid", grid_points(4), [(0, 6), (6, 15), (15, 9), (9, 0)]),
        _forced("the outline of a comb", COMB, ring(0, len(COMB))),
        _forced(
            "a hair above a row of points",
            [*((x, 0) for x in range(8)), (-1, 2.0**-20), (8, 2.0**-20), (3, 4), (3, -4)],
            [(8, 9)],
        ),
        *(
            _forced(f"one flip makes the next edge illegal, cloud {k}", [(-0.25, 0.5), (1.25, 0.5), *cloud], [(0, 1)])
            for k, cloud in enumerate(map(_around_a_segment, (9, 42, 48, 84, 101)), start=1)
        ),
        _forced("tiny and crowded", few * 2.0**-40, apart(few, random, 9)),
        _forced("many random segments", many, apart(many, random, 20)),
    ]


def _around_a_segment(seed: int) -> np.ndarray:
    """Of those who look at each edge only once, each of these (found by search) catches two of three, by their order."""
    cloud = np.random.default_rng(seed).random((28, 2)) * [1, 0.5] + [0, 0.25]
    return np.round(cloud * 256) / 256 + [0, 2.0**-10]  # beside the segment at 0.5


def _forced(name: str, points: Any, segments: Any) -> Case:
    return {**meshed(name, points), "segments": as_lists(segments, int), "steps": 20 * len(points)}


def apart(points: np.ndarray, random: np.random.Generator, most: int) -> list[tuple[int, int]]:
    """At most so many pairs of points, at random, such that no segments between them cross."""
    pairs = list(combinations(range(len(points)), 2))
    kept: list[tuple[int, int]] = []
    for i in random.permutation(len(pairs)).tolist():
        a, b = pairs[i]
        if len(kept) < most and not any(do_cross(points, a, b, c, d) for c, d in kept):
            kept.append((a, b))
    return kept


def ring(first: int, n: int) -> list[tuple[int, int]]:
    """The segments of a loop through ``n`` points from ``first`` on."""
    return [(first + i, first + (i + 1) % n) for i in range(n)]


# ---- carving -----------------------------------------------------------------------------------------


def of_carve(random: np.random.Generator) -> list[Case]:
    hole, island = [(1, 1), (3, 1), (3, 3), (1, 3)], [(1.5, 1.5), (2.5, 1.5), (2, 2.5)]
    radius = random.integers(2, 9, 12)
    turn = 2 * np.pi * np.arange(12) / 12
    star = np.column_stack([np.cos(turn), np.sin(turn)]) * radius[:, None]
    return [
        _carved("an L-shape", [ELL]),
        _carved("a square with a hole", [SQUARE, hole]),
        _carved("an island in a hole", [SQUARE, hole, island]),
        _carved("loose points and a crack", [COMB], loose=[(1, 1), (3, 3), (8.5, 3), (2, 5)], more=[(10, 11)]),
        _carved("two pieces", [[(0, 0), (2, 0), (1, 2)], [(5, 1), (7, 1), (6, 3)]]),
        _carved("two loops that share a corner", [ELL], loose=[(3, 2.5), (2.5, 3)], more=[(3, 6), (6, 7), (7, 3)]),
        _carved("segments, but no loop", [], loose=[*SQUARE, (2, 1)], more=[(0, 4), (4, 2)]),
        _carved("a star", [star]),
    ]


def _carved(name: str, loops: Any, loose: Any = (), more: Any = ()) -> Case:
    """Loops, one after the other, then loose points; and segments between any of these."""
    points: list[Any] = []
    segments: list[tuple[int, int]] = []
    for loop in loops:
        segments += ring(len(points), len(loop))
        points += [tuple(p) for p in loop]
    points += [tuple(p) for p in loose]
    segments += more
    triangles = uncarved(Domain(points, segments))
    return {**meshed(name, points, triangles), "segments": as_lists(segments, int)}


def uncarved(domain: Domain) -> list[tuple[int, int, int]]:
    """The constrained triangulation of the whole hull: what ``insert_segments`` has before it carves."""
    triangles: set[tuple[int, int, int]] = set()
    for step in insert_segments(domain):
        if step.kind in ("carve", "done"):
            break
        triangles.difference_update(step.removed)
        triangles.update(step.added)
    return sorted(triangles)


# ---- refinement --------------------------------------------------------------------------------------


def of_encroached(random: np.random.Generator) -> list[Case]:
    some = np.round(random.random((14, 2)) * 64)
    outline = ring(0, 4)
    return [
        _between("points far from a segment", [(0, 0), (4, 0), (2, 5), (9, 1)], [(0, 1)]),
        _between("a point near a side", [*SQUARE, (1, 1)], outline),
        _between("a point exactly on all circles", [*SQUARE, (2, 2)], outline),
        _between(
            "two points exactly on a circle, one a hair inside",
            [(0, 0), (4, 0), (2, 2), (2, -2), (2, 2.0**-9 - 2)],
            [(0, 1), (0, 2)],
        ),
        _between("a point beside a segment's end", [(0, 0), (4, 0), (4, 1), (-1, 0), (5, 0)], [(0, 1)]),
        _between("a point on a circle but for a hair", [(0, 0), (10, 0), (1, 3 - 2.0**-50)], [(0, 1)]),
        _between("random segments", some, apart(some, random, 12)),
        _between("tiny segments", some * 2.0**-40, apart(some, random, 12)),
    ]


def of_ruppert(random: np.random.Generator) -> list[Case]:
    inner, slot = box(4, 4, 6, 6), box(2, 7, 14, 9)
    spots = np.unique(random.integers(2, 15, (6, 2)), axis=0)
    return [
        _refined("a square, with nothing to do", SQUARE, ring(0, 4)),
        _refined("a point near a side", [*SQUARE, (2, 0.5)], ring(0, 4)),
        _refined("a rectangle, long and low", box(0, 0, 8, 1), ring(0, 4)),
        _refined("an L-shape", [(0, 0), (8, 0), (8, 1), (3, 1), (3, 8), (0, 8)], ring(0, 6)),
        _refined("two points close together", [*box(0, 0, 8, 8), (4, 4), (4.5, 4)], ring(0, 4), min_angle=16),
        _refined("a square with a hole", [*box(0, 0, 16, 16), *inner], ring(0, 4) + ring(4, 4)),
        _refined("a side that is no edge at first", [*box(0, 0, 16, 16), *slot, (8, 6)], ring(0, 4) + ring(4, 4)),
        _refined("random points in a square", [*box(0, 0, 16, 16), *spots], ring(0, 4), min_angle=24),
    ]


def box(left: float, bottom: float, right: float, top: float) -> list[tuple[float, float]]:
    """The corners of a rectangle."""
    return [(left, bottom), (right, bottom), (right, top), (left, top)]


def _between(name: str, points: Any, segments: Any) -> Case:
    return {"name": name, "points": as_lists(points, float), "segments": as_lists(segments, int)}


def _refined(name: str, points: Any, segments: Any, min_angle: float = 20) -> Case:
    return {**_between(name, points, segments), "min_angle": float(min_angle), "steps": 100}
