"""From what a user gives to what a mesher takes, and a sentence on everything that changes on the way."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fem_mesh.domain.crossings import CROSS, OVERLAP, crossing_place, find_meetings
from fem_mesh.domain.curves import check_ends, cut_gently, halve
from fem_mesh.domain.loops import find_outline, find_toggling
from fem_mesh.domain.reading import place, some
from fem_mesh.errors import MeshError
from fem_mesh.predicates import SMALLEST, orient_sign

CLOSE = 1e-9  # of the domain's size: how far off its curve a point may be
ROUNDS = 20  # of splitting: rounded crossing points can make new crossings


@dataclass
class Draft:
    """A domain in the making. Arrays have one row a segment as it is now; ``given`` are the user's."""

    points: np.ndarray
    given: np.ndarray
    names: list[str]
    curves: dict[int, Any]
    pairs: np.ndarray = field(init=False)
    source: np.ndarray = field(init=False)
    times: np.ndarray = field(init=False)  # how often each was given
    toggles: np.ndarray = field(init=False)
    block: np.ndarray = field(init=False)  # of segments that divide loops, -1 for all others
    merged_into: np.ndarray = field(init=False)
    report: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        k = len(self.given)
        self.merged_into = first_equal(self.points)
        self.pairs, self.source, self.times = self.merged_into[self.given], np.arange(k), np.ones(k, np.int64)
        self.toggles, self.block = np.zeros(k, bool), np.full(k, -1)
        self._user_points = len(self.points)
        self._numbers: dict[tuple[float, float], int] = {}

    # ---- one change after the other ----------------------------------------------------------------

    def finish(self, split: bool) -> Draft:
        """All changes in their order; ``split`` says whether segments that cross are split."""
        self._say_merged()
        self._drop_points()
        if self.curves:
            self._cut_curves()
            self._part_parallel_curves()
        self._drop_repeated()
        self.toggles, self.block = find_toggling(self.pairs, self.times, len(self.points))
        self._resolve_meetings(split)
        self._check_chords()
        for block in np.unique(self.block[self.block >= 0]):
            rows = np.flatnonzero(self.block == block)
            self.toggles[rows] ^= find_outline(self.points, self.pairs[rows])
        return self

    def _say_merged(self) -> None:
        doubles = np.flatnonzero(self.merged_into != np.arange(len(self.points))).tolist()
        if doubles:
            v, few = doubles[0], len(doubles) == 1
            first = f"{'' if few else 'the first, '}{place(self.points, v)}, into point {self.merged_into[v]}"
            said = "equals another and was" if few else "equal others and were"
            self.report.append(f"{some(doubles, 'point')} {said} merged: {first}")

    def _drop_points(self) -> None:
        a, b = self.pairs.T
        rows = np.flatnonzero(a == b).tolist()
        if rows:
            few = len(rows) == 1
            where = f"{'' if few else 'the first '}at {place(self.points, a[rows[0]])}"
            self.report.append(f"{some(rows, 'segment')}, {where}, {'has' if few else 'have'} no length: dropped")
            self._keep(a != b)

    def _cut_curves(self) -> None:
        size = float(np.ptp(self.points, axis=0).max())
        ends = self.points[self.pairs].tolist()
        new, chains, curves, rows = len(self.points), {}, {}, []
        for i in sorted(self.curves):
            a, b = map(tuple, ends[i])
            try:
                check_ends(self.curves[i], a, b, CLOSE * size)
                points, curves[i] = cut_gently(self.curves[i], a, b)
            except MeshError as error:
                raise MeshError(f"{self._row(i)} {error}") from None
            if points:
                chains[i] = self._add_points(points)
                rows.append(self.source.item(i))
        self._replace(chains, curves)
        self._say_cut(rows, "turns" if len(rows) == 1 else "turn", "by more than 60 degrees", new)

    def _part_parallel_curves(self) -> None:
        """Curves between the same two points get a point of their own: as segments they would be one."""
        new, chains, curves, rows = len(self.points), {}, {}, []
        for same in self._groups():
            alike = [self.curves.get(i) for i in same]
            for i in same if any(curve != alike[0] for curve in alike) else ():
                if i in self.curves:
                    a, b = (tuple(self.points[v].tolist()) for v in self.pairs[i])
                    middle, *curves[i] = halve(self.curves[i], a, b)
                    chains[i] = self._add_points([middle])
                    rows.append(self.source.item(i))
        self._replace(chains, curves)
        self._say_cut(rows, "joins" if len(rows) == 1 else "join", "the same points as another one", new)

    def _say_cut(self, rows: list[int], verb: str, why: str, new: int) -> None:
        if rows:
            added = some(range(new, len(self.points)), "point")
            self.report.append(f"{some(sorted(set(rows)), 'segment')} {verb} {why} along the curve: split at {added}")

    def _drop_repeated(self, what: str = "") -> None:
        """Keep one of equal segments: its name, its curve, how often it was given, whether it toggles."""
        keep = np.ones(len(self.pairs), bool)
        said: dict[int, str] = {}
        lost: list[str] = []
        for first, *others in self._groups():
            for i in others:
                self.times[first] += self.times[i]
                self.toggles[first] ^= self.toggles[i]
                self.names[first] = self.names[first] or self.names[i]
                said.setdefault(self.source.item(i), f"{what}{self._row(i)} repeats {what}segment {self.source[first]}")
                if self.names[i] not in ("", self.names[first]):
                    lost.append(f"{what}segment {self.source[i]} loses its name {self.names[i]!r} to {self.names[first]!r}")
            keep[others] = False
        if said:
            self.report.append(f"{_first(next(iter(said.values())), len(said), 'repeated segment')}: dropped")
            self.report += [_first(lost[0], len(lost), "name")] if lost else []
            self._keep(keep)

    def _resolve_meetings(self, split: bool) -> None:
        splits: list[str] = []
        for attempt in itertools.count():
            meetings = find_meetings(self.points, self.pairs)
            crossings = meetings[meetings[:, 2] == CROSS, :2].tolist()
            if not crossings:
                break
            if not split:
                way_out = 'mend them, or say crossings="split"'
                told = _first(f"{self._say_crossing(*crossings[0])}: {way_out}", len(crossings), "crossing")
                raise MeshError(told, self._crossing(*crossings[0]))
            if attempt == ROUNDS:
                raise MeshError(
                    f"{self._say_crossing(*crossings[0])}, even after {ROUNDS} rounds of splitting: there is no room "
                    "between the doubles here, and crossing points are rounded; round the points to a coarser grid",
                    self._crossing(*crossings[0]),
                )
            splits += self._split(crossings)
        if splits:
            self.report.append(_first(splits[0], len(splits), "crossing"))
        overlaps = meetings[meetings[:, 2] == OVERLAP, :2].tolist()
        if overlaps:
            self.report.append(_first(self._say_overlap(*overlaps[0]), len(overlaps), "overlap"))

    def _check_chords(self) -> None:
        """No vertex lies on the chord of a curve: the chord would be split there, and the curve would have a dent."""
        used = np.flatnonzero(self.merged_into == np.arange(len(self.points)))
        order = used[np.argsort(self.points[used, 0], kind="stable")]
        x = self.points[order, 0]
        for i in self.curves:
            ends = self.points[self.pairs[i]]
            low, high = ends.min(axis=0), ends.max(axis=0)
            near = order[np.searchsorted(x, low[0]) : np.searchsorted(x, high[0], side="right")]
            near = near[(self.points[near, 1] >= low[1]) & (self.points[near, 1] <= high[1])]
            for v in np.setdiff1d(near, self.pairs[i]).tolist():
                if orient_sign(*ends[0].tolist(), *ends[1].tolist(), *self.points[v].tolist()) == 0:
                    x, y = self.points[v].tolist()
                    raise MeshError(
                        f"point {v} at {place(self.points, v)} lies on the chord of {self._row(i)}, which is curved: "
                        "move it, or put it on the curve and end the segment there",
                        (x, y),
                    )

    def _split(self, crossings: list[list[int]]) -> list[str]:
        """Split segments at the points where they cross, rounded; returns what was done."""
        on_row: dict[int, list[tuple[Any, int]]] = {}
        said = []
        for i, j in crossings:
            share, x, y = crossing_place(self.points, self.pairs[i], self.pairs[j])
            (v,) = self._add_points([(float(x), float(y))])
            on_row.setdefault(i, []).append((share, v))
            on_row.setdefault(j, []).append((crossing_place(self.points, self.pairs[j], self.pairs[i])[0], v))
            said.append(f"{self._say_crossing(i, j)}: split there, at point {v}")
        straightened = sorted({self.source.item(i) for i in on_row if i in self.curves})
        if straightened:
            verb = "is" if len(straightened) == 1 else "are"
            self.report.append(f"{some(straightened, 'segment')}, where others cross, {verb} split: these pieces are straight")
        chains = {i: [v for _, v in sorted(places)] for i, places in on_row.items()}
        self._replace(chains, {i: [None] * (len(chain) + 1) for i, chain in chains.items()})
        self._drop_repeated("a piece of ")
        return said

    # ---- rows and points -----------------------------------------------------------------------------

    def _keep(self, keep: np.ndarray) -> None:
        number = np.cumsum(keep) - 1
        self.curves = {int(number[i]): curve for i, curve in self.curves.items() if keep[i]}
        self.names = [name for name, kept in zip(self.names, keep.tolist(), strict=True) if kept]
        for array in ("pairs", "source", "times", "toggles", "block"):
            setattr(self, array, getattr(self, array)[keep])

    def _replace(self, chains: dict[int, list[int]], curves: dict[int, list[Any]]) -> None:
        """Put the pieces of each row i in its place: it now passes through the points ``chains[i]``."""
        if not chains:
            return
        pairs: list[tuple[int, int]] = []
        old: list[int] = []
        new_curves: dict[int, Any] = {}
        for i, (a, b) in enumerate(self.pairs.tolist()):
            stops = [a, *chains.get(i, ()), b]
            for p, q, curve in zip(stops[:-1], stops[1:], curves.get(i, [self.curves.get(i)]), strict=True):
                if p != q:
                    if curve is not None:
                        new_curves[len(pairs)] = curve
                    pairs.append((p, q))
                    old.append(i)
        self.pairs, self.curves = np.array(pairs, np.int64).reshape(-1, 2), new_curves
        self.names = [self.names[i] for i in old]
        for array in ("source", "times", "toggles", "block"):
            setattr(self, array, getattr(self, array)[old])

    def _add_points(self, new: Iterable[tuple[float, float]]) -> list[int]:
        """The numbers of points at these places: of those that are there, or new ones."""
        if not self._numbers:
            backwards = range(len(self.points) - 1, -1, -1)
            self._numbers = {tuple(self.points[v].tolist()): v for v in backwards}
        count = len(self.points)
        added: list[tuple[float, float]] = []
        numbers = []
        for x, y in new:
            spot = (0.0 if abs(x) < SMALLEST else x, 0.0 if abs(y) < SMALLEST else y)
            if spot not in self._numbers:
                self._numbers[spot] = count + len(added)
                added.append(spot)
            numbers.append(self._numbers[spot])
        if added:
            self.points = np.concatenate([self.points, np.array(added)])
            self.merged_into = np.concatenate([self.merged_into, np.arange(count, len(self.points), dtype=np.int32)])
        return numbers

    def _groups(self) -> list[list[int]]:
        """The rows that join the same two points, where there are several."""
        low, high = self.pairs.min(axis=1), self.pairs.max(axis=1)
        order = np.lexsort((high, low))
        same = (low[order][1:] == low[order][:-1]) & (high[order][1:] == high[order][:-1])
        starts = np.flatnonzero(np.concatenate([[True], ~same]))
        lengths = np.diff(starts, append=len(order))
        return [order[s : s + n].tolist() for s, n in zip(starts[lengths > 1], lengths[lengths > 1], strict=True)]

    # ---- words -----------------------------------------------------------------------------------------

    def _row(self, i: int) -> str:
        a, b = self.given[self.source[i]].tolist()
        return f"segment {self.source[i]} = ({a}, {b}) from {place(self.points, a)} to {place(self.points, b)}"

    def _say_crossing(self, i: int, j: int) -> str:
        x, y = self._crossing(i, j)
        return f"{self._row(i)} and {self._row(j)} cross at ({x:.6g}, {y:.6g})"

    def _crossing(self, i: int, j: int) -> tuple[float, float]:
        _, x, y = crossing_place(self.points, self.pairs[i], self.pairs[j])
        return float(x), float(y)

    def _say_overlap(self, i: int, j: int) -> str:
        ends = sorted({*self.pairs[i].tolist(), *self.pairs[j].tolist()}, key=lambda v: self.points[v].tolist())
        p, q = (ends[-3], ends[-2]) if len(ends) == 4 else self._shared_part(i, j)
        return f"{self._row(i)} and {self._row(j)} overlap between {place(self.points, p)} and {place(self.points, q)}"

    def _shared_part(self, i: int, j: int) -> list[int]:
        """The shorter of two segments on one line that share an end."""
        return min((self.pairs[r].tolist() for r in (i, j)), key=lambda r: float(np.abs(np.diff(self.points[r], axis=0)).sum()))


def _first(sentence: str, n: int, thing: str) -> str:
    """The first of ``n`` sentences, and how many more there are."""
    return f"{sentence} (and {n - 1:,} more {thing}{'s' * (n > 2)})" if n > 1 else sentence


def first_equal(points: np.ndarray) -> np.ndarray:
    """The lowest number of a point with the same coordinates, for each point: int32 (n,)."""
    order = np.lexsort((points[:, 1], points[:, 0]))  # stable: equal points stay in the user's order
    ordered = points[order]
    new = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(axis=1)])[: len(points)]
    first = order[new] if len(points) else order
    result = np.empty(len(points), np.int32)
    result[order] = first[np.cumsum(new) - 1]
    return result
