"""What a refinement works on: the arrays of ``ruppert.refine_mesh``, made, grown and read."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fem_mesh.algorithms.refining.corners import classify_vertices, list_left
from fem_mesh.algorithms.refining.curved import point_on_shell, way_is_free
from fem_mesh.algorithms.refining.encroachment import (
    COSINE_T,
    FIRST_UNUSED,
    LENS_COSINE,
    OFFSET,
    SHARP,
    SHORTEST,
    SINE_T,
    SPOT_X,
    SPOT_Y,
    WIDE,
    in_range,
)
from fem_mesh.algorithms.refining.relocation import LIMITS
from fem_mesh.algorithms.refining.steiner import COSINE, MAX_AREA, MAX_EDGE, NO_ANGLE, UNBOUNDED
from fem_mesh.algorithms.refining.worklists import (
    ADDED,
    BUCKETS,
    FRESH,
    GIVEN,
    HEAD,
    LABELLED,
    LEFT,
    LENS,
    LOWEST,
    MOST,
    NUMBER,
    OFF_CURVE,
    OFFCENTER,
    ON_CHORD,
    ON_CURVE,
    RELOCATE,
    UNSIZED,
)
from fem_mesh.domain.curves import as_pair
from fem_mesh.errors import MeshError
from fem_mesh.kernel import call
from fem_mesh.mesh.halfedge import GHOST, next_edge
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.refinement import Refinement
from fem_mesh.mesh.segmented import Segmented
from fem_mesh.mesh.workspace import NEXT, SEGMENTS

Size = Callable[[np.ndarray, np.ndarray], np.ndarray]
OFFCENTER_SHARE = 0.425  # at 0.5 the triangle that an off-center makes just keeps the bound; chosen by counting triangles
ROUNDING = 1e-9  # moved vertices keep the bound by so much more
SMALLEST_PART = 2.0**-40  # of the domain's size: no edge shorter than this is split
FEWEST = 100_000  # points that a refinement without a budget may always add
SPARE = 4  # times as many as it is expected to need
AT_ONCE = 2_000_000  # triangles to make room for, however many are expected
MOST_EVER = 200_000_000  # points: half-edges are numbered by 32 bits
EQUILATERAL = math.sqrt(3) / 4  # area over squared edge
USED = 0.6  # of a bound on areas and edges is what triangles use on average, roughly


@dataclass(frozen=True)
class Bounds:
    """What a refinement is asked for."""

    min_angle: float = 20.0
    max_area: float = math.inf
    max_edge: float = math.inf
    size: Size | None = None
    max_points: int | None = None
    lens: bool = True
    offcenter: bool = True
    relocate: bool = True


@dataclass
class Refiner:
    """The arrays of one refinement.

    The ``label`` of a triangle is its region; plus ``len(parts.region_names)``, if only its angles count, since it is made in
    place of one that was to be left alone; plus twice that number, if it is left alone.
    """

    parts: Segmented
    bounds: Bounds
    curves: Mapping[int, Any]
    limit: np.ndarray  # one row a label: see steiner.py
    label: np.ndarray
    place: np.ndarray
    curved: np.ndarray
    wanted: np.ndarray
    queue: np.ndarray
    waiting: np.ndarray
    limits: np.ndarray
    domain: Any
    expected: int = 0  # triangles, roughly
    spent: bool = False  # whether the budget stopped it
    bucket: np.ndarray = field(default_factory=lambda: np.zeros((BUCKETS, 2), np.uint32))

    @classmethod
    def of(
        cls, parts: Segmented, bounds: Bounds, curves: Mapping[int, Any], chosen: np.ndarray | None,
        regions: tuple[Any, ...], domain: Any,
    ) -> Refiner:  # fmt: skip
        work = parts.work
        kinds = len(parts.region_names)
        limit = np.full((3 * kinds, 3), UNBOUNDED)  # asked for; changed, so to keep the angles; left alone
        limit[:, COSINE] = NO_ANGLE
        for k in range(kinds):
            region = regions[k - 1] if 0 < k <= len(regions) else None
            limit[k] = row_of_bounds(bounds, region)
            limit[kinds + k, COSINE] = limit[k, COSINE]
        label = np.zeros(parts.count, np.int32)
        label[: len(parts.region)] = parts.region
        if chosen is not None:
            label[: len(chosen)] += 2 * kinds * ~chosen
        cosine = math.cos(math.radians(bounds.min_angle))
        limits = np.zeros(LIMITS)
        limits[LENS_COSINE] = max(0.0, 2 * cosine * cosine - 1) ** 2
        limits[OFFSET] = OFFCENTER_SHARE * math.sqrt((1 + cosine) / (1 - cosine)) if cosine < 1 else math.inf
        angle = math.radians(bounds.min_angle * (1 + ROUNDING))
        limits[COSINE_T], limits[SINE_T] = math.cos(angle), math.sin(angle)
        extent = float(np.ptp(work.xy[1:], axis=0).max()) if len(work.points) else 0.0
        limits[WIDE] = min(float(limit[:, MAX_AREA].min()) / EQUILATERAL, float(limit[:, MAX_EDGE].min()))
        limits[SHORTEST] = (SMALLEST_PART * extent) ** 2
        curved = np.zeros(len(parts.ends) + 1, bool)  # the last row is that of NO_PIECE
        curved[list(curves)] = True
        refiner = cls(
            parts, bounds, curves, limit, label, classify_vertices(parts, curved), curved,
            wanted=np.full(parts.count if bounds.size else 0, np.nan), queue=np.zeros((parts.count, 3), np.uint32),
            waiting=np.zeros((len(parts.edge_of), 2), np.uint32), limits=limits, domain=domain,
        )  # fmt: skip
        state = work.state
        state[LENS], state[OFFCENTER], state[RELOCATE] = bounds.lens, bounds.offcenter, bounds.relocate
        state[LABELLED] = kinds if label.any() else 0
        state[LOWEST], state[MOST] = BUCKETS - 1, bounds.max_points or 0
        real = ~ghosts_of(work.origin, parts.count) & (label < kinds)
        refiner.expect(np.flatnonzero(real), math.inf)
        refiner.grow()
        return refiner

    def grow(self) -> None:
        """Give the arrays that are full room for what is expected, or half as much again. Unused room takes no memory."""
        parts, work = self.parts, self.parts.work
        expected = min(self.expected, 2 * int(work.state[MOST]), max(4 * parts.count, AT_ONCE))
        count, vertices, segments = parts.count, int(work.state[NEXT]), int(work.state[SEGMENTS])
        if count + 2 > len(work.cavity) - 2 or len(self.queue) < 3 + count:
            triangles = max(int(1.5 * count), int(1.1 * expected)) + 200
            work.origin, work.twin, parts.segment = (
                longer(array, 3 * triangles) for array in (work.origin, work.twin, parts.segment)
            )
            work.cavity, work.ring = np.empty(triangles + 2, np.uint32), np.empty(3 * triangles + 3, np.uint32)
            self.label, self.queue = longer(self.label, triangles), longer(self.queue, triangles)
            if len(self.wanted):
                self.wanted = longer(self.wanted, triangles)
        if vertices == len(work.xy):
            more = max(int(1.5 * vertices), int(0.55 * expected)) + 100
            work.xy, self.place = longer(work.xy, more), longer(self.place, more)
            named = len(work.points) + 1
            work.name = np.concatenate([work.name[:named], np.arange(named - 1, more - 1, dtype=np.int32)])
        if segments + 1 >= len(parts.edge_of):
            more = max(2 * segments, int(8 * math.sqrt(expected))) + 100
            parts.edge_of, parts.piece_of = longer(parts.edge_of, more), longer(parts.piece_of, more)
            self.waiting = lengthen_ring(self.waiting, more, work.state)

    def state(self) -> tuple[np.ndarray, ...]:
        """The arrays that ``refine_mesh`` takes."""
        parts, work = self.parts, self.parts.work
        return (
            work.xy, work.origin, work.twin, parts.segment, parts.edge_of, parts.piece_of, self.place, parts.ends,
            self.curved, self.label, self.wanted, self.limit, self.queue, self.bucket, self.waiting, self.limits,
            work.cavity, work.ring, work.state,
        )  # fmt: skip

    def size_triangles(self) -> None:
        """Evaluate the size function where triangles wait for it, and let those that are too large be judged."""
        work, size, count = self.parts.work, self.bounds.size, self.parts.count
        assert size is not None
        corner = work.origin[: 3 * count].reshape(-1, 3)
        fresh = np.flatnonzero(np.isnan(self.wanted[:count]) & (corner != 0).all(axis=1))
        triangles = work.xy[corner[fresh]]
        places = np.concatenate([triangles, triangles.mean(axis=1, keepdims=True)], axis=1)
        sizes = evaluate_size(size, places.reshape(-1, 2)).reshape(-1, 4)
        edge = sizes.min(axis=1, initial=np.inf)
        edge[self.label[fresh] >= len(self.parts.region_names)] = np.inf
        self.wanted[fresh] = edge
        sides = triangles - np.roll(triangles, 1, axis=1)
        with np.errstate(over="ignore"):
            long = fresh[(sides * sides).sum(axis=2).max(axis=1, initial=0.0) > edge * edge]
        work.cavity[: len(long)] = long
        work.state[FRESH], work.state[UNSIZED] = len(long), 0
        with np.errstate(all="ignore"):  # sizes may be infinite
            average = (sizes**-2.0).mean(axis=1) ** -0.5
        self.expect(fresh, average)

    def expect(self, triangles: np.ndarray, edge: np.ndarray | float) -> None:
        """Raise the budget to some times the points that these triangles need, unless the user set it."""
        work, row = self.parts.work, self.label[triangles]
        areas = areas_of(work.xy[work.origin[: 3 * self.parts.count].reshape(-1, 3)[triangles]])
        with np.errstate(all="ignore"):  # bounds may be infinite, and their squares
            square = np.minimum(np.square(edge), self.limit[row, MAX_EDGE])
            need = float((areas / np.minimum(self.limit[row, MAX_AREA], EQUILATERAL * square)).sum()) / USED
        self.expected = max(self.expected, int(min(need, MOST_EVER)))
        if self.bounds.max_points is None:
            self.parts.work.state[MOST] = min(MOST_EVER, max(FEWEST, SPARE * self.expected // 2))

    def split_on_curve(self) -> None:
        """Find the point of a curve at which the next sub-segment is to be split."""
        work, parts = self.parts.work, self.parts
        s = int(self.waiting[work.state[HEAD], NUMBER])
        row, h = int(parts.piece_of[s]), int(parts.edge_of[s])
        a, b = int(work.origin[h]), int(work.origin[next_edge(h)])
        if self.place[b] == SHARP and self.place[a] != SHARP:
            a, b = b, a
        start, end = tuple(work.xy[a].tolist()), tuple(work.xy[b].tolist())
        sharp = self.place[a] == SHARP and self.place[b] != SHARP
        x, y = point_on_shell(self.curves[row], start, end) if sharp else as_pair(self.curves[row].between(start, end))
        self.limits[SPOT_X], self.limits[SPOT_Y] = in_range(x), in_range(y)
        work.state[GIVEN] = ON_CURVE if way_is_free(parts, h, self.limits[[SPOT_X, SPOT_Y]]) else ON_CHORD

    def finish(self) -> Mesh:
        """The mesh, with the report of what was achieved."""
        parts, work, bounds = self.parts, self.parts.work, self.bounds
        if work.state[UNSIZED]:
            self.size_triangles()
        left, excused = np.empty(parts.count, np.int32), np.empty(parts.count, bool)
        arrays = (work.xy, work.origin, parts.segment, self.place, parts.ends, self.label, self.wanted, self.limit)
        any_left = self.spent or work.state[LEFT] > 0
        k = call(list_left, *arrays, parts.count, left, excused, size=parts.count) if any_left else 0
        other = "budget" if self.spent else "precision"
        why = tuple("small input angle" if e else other for e in excused[:k].tolist())
        complete = bool(excused[:k].all())
        number = np.cumsum(~ghosts_of(work.origin, parts.count)) - 1
        refinement = Refinement(
            complete=complete, added=int(work.state[ADDED]), left=number[left[:k]].astype(np.int32), why=why,
            off_curve=int(work.state[OFF_CURVE]), min_angle=bounds.min_angle,
        )  # fmt: skip
        note = work.note if complete else f"not refined to the end ({other}): {k:,} triangle{'s' * (k != 1)} left"
        parts.region = self.label % len(parts.region_names)
        self.name_new_vertices()
        return parts.to_mesh(self.domain, refinement, note)

    def name_new_vertices(self) -> None:
        """Number the points added after those given, without gaps, in the order of their slots."""
        work, n = self.parts.work, len(self.parts.work.points)
        end = int(work.state[NEXT])
        work.name = work.name[:end].copy()
        used = self.place[n + 1 : end] > FIRST_UNUSED
        work.name[n + 1 : end] = np.where(used, n + np.cumsum(used) - 1, -1)


def row_of_bounds(bounds: Bounds, region: Any) -> tuple[float, float, float]:
    """The bounds of one label as steiner.py reads them."""
    cosine = math.cos(math.radians(bounds.min_angle)) if bounds.min_angle > 0 else math.inf
    size = min(bounds.max_edge, getattr(region, "size", None) or math.inf)
    area = min(bounds.max_area, getattr(region, "max_area", None) or math.inf)
    return min(cosine * cosine, NO_ANGLE), area, size * size


def evaluate_size(size: Size, places: np.ndarray) -> np.ndarray:
    """``size`` at ``places`` (k, 2). Raises MeshError where it is no positive number."""
    values = np.asarray(size(places[:, 0].copy(), places[:, 1].copy()))
    if values.dtype.kind not in "fiu" or values.shape not in ((), (len(places),)):
        raise MeshError(
            f"size(x, y) must return one number for each of the {len(places)} places in x, not {values.dtype} of shape "
            f"{values.shape}: write it for arrays, with np.hypot, np.where, ..."
        )
    values = np.broadcast_to(values, len(places)).astype(np.float64)
    for i in np.flatnonzero(~(values > 0))[:1]:
        raise MeshError(f"size({places[i, 0]:.6g}, {places[i, 1]:.6g}) is {values[i]}: an edge length must be greater than 0")
    return values


def ghosts_of(origin: np.ndarray, count: int) -> np.ndarray:
    return np.asarray((origin[: 3 * count].reshape(-1, 3) == GHOST).any(axis=1))


def areas_of(corners: np.ndarray) -> np.ndarray:
    """The areas of triangles given by their corners (m, 3, 2)."""
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2)


def longer(array: np.ndarray, n: int) -> np.ndarray:
    """``array`` with room for ``n`` rows, of which the new ones are 0."""
    result = np.zeros((n, *array.shape[1:]), array.dtype)
    result[: len(array)] = array[:n]
    return result


def lengthen_ring(waiting: np.ndarray, n: int, state: np.ndarray) -> np.ndarray:
    """The ring of sub-segments with room for ``n``, begun at its start again."""
    result = longer(waiting, n)
    result[: len(waiting), NUMBER] = np.roll(waiting[:, NUMBER], -int(state[HEAD]))
    state[HEAD] = 0
    return result
