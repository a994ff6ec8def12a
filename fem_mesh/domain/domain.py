"""Domain: what is to be meshed, as its outlines, cracks and interfaces."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from fem_mesh.domain.draft import Draft
from fem_mesh.domain.loops import depths_of
from fem_mesh.domain.reading import Region, as_curves, as_names, as_regions, as_seeds, as_segments
from fem_mesh.errors import MeshError
from fem_mesh.mesh.points import as_points

CROSSINGS = ("error", "split")
MOST_NAMES = 6  # named in the line of facts


class Domain:
    """What is to be meshed: points, and segments between them that must be edges of the mesh. Its arrays are read-only.

    points : (n, 2), among them such that no segment uses
    segments : (k, 2), pairs of point numbers: outlines, holes, cracks, interfaces, in any order and direction
    holes : (j, 2), a place in each hole. Without any, loops nest by parity: whatever lies inside an odd
        number of closed loops is meshed, and segments that close no loop are cracks or interfaces
    names : a name for each segment; or one for all, or a mapping from rows of ``segments`` to names
    curves : a mapping from rows of ``segments`` to what they stand for: a ``Circle``, a ``Parametric``, a
        function of t in [0, 1] that runs from the segment's start to its end and returns (x, y), or any
        object with ``between(a, b)``. Where it turns by more than 60 degrees, the segment is split
    regions : a ``Region`` for each material; or tuples (x, y, name), or a mapping from names to (x, y)
    crossings : "error", or "split": segments that cross get a point there

    What it holds may differ from what was given, and ``report`` says how, a sentence a change:

    points : float64 (n, 2), the user's in the user's numbering; those that had to be made come last
    segments : int32 (k, 2), in the user's order and direction, between points with distinct coordinates
    source : int32 (k,), the user's row of each segment
    toggles : bool (k,), whether who crosses it changes sides, by parity
    names, curves, regions : as above, for these segments; "" is no name
    merged_into : int32 (n,), each point's representative: itself, or the equal point with the lowest number

    Segments may touch, end on each other and overlap. Raises MeshError where they cross, or where what is
    given makes no sense.

    >>> square = Domain([(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 1), (1, 2), (2, 3), (3, 0)], names="wall")
    >>> square
    Domain: 4 points, 4 segments (wall)
    >>> Domain([(0, 0), (2, 2), (2, 0), (0, 2)], [(0, 1), (2, 3)], crossings="split").segments.tolist()
    [[0, 4], [4, 1], [2, 4], [4, 3]]
    """

    points: np.ndarray
    segments: np.ndarray
    source: np.ndarray
    toggles: np.ndarray
    holes: np.ndarray
    names: tuple[str, ...]
    curves: Mapping[int, Any]
    regions: tuple[Region, ...]
    merged_into: np.ndarray
    report: tuple[str, ...]

    def __init__(
        self,
        points: Any,
        segments: Any,
        holes: Any = (),
        *,
        names: Any = None,
        curves: Any = None,
        regions: Any = None,
        crossings: str = "error",
    ) -> None:
        if crossings not in CROSSINGS:
            raise MeshError(f'crossings must be "error" or "split", not {crossings!r}')
        points = as_points(points)
        given = as_segments(segments, points)
        k = len(given)
        draft = Draft(points, given, as_names(names, k), as_curves(curves, k)).finish(crossings == "split")
        arrays = (draft.points, draft.pairs.astype(np.int32), draft.source.astype(np.int32), draft.toggles)
        names, report = tuple(draft.names), tuple(draft.report)
        self._fill(*arrays, as_seeds(holes), names, draft.curves, as_regions(regions), draft.merged_into, report)

    @classmethod
    def from_loops(
        cls,
        *loops: Any,
        points: Any = (),
        holes: Any = (),
        names: Any = None,
        curves: Any = None,
        regions: Any = None,
        crossings: str = "error",
    ) -> Domain:
        """A domain from closed outlines, each (n, 2): outer ones and holes, in any order and direction.

        The last vertex of a loop may repeat the first. Loops nest by parity. Their segments are numbered
        from 0, loop after loop, and are named "outer", "outer 1", ... where an even number of other loops
        lies around, "hole 0", "hole 1", ... where an odd number does, unless ``names`` has one name a loop.
        ``points`` (n, 2) are loose ones, numbered last; all else is as for ``Domain``.

        >>> Domain.from_loops([(0, 0), (4, 0), (4, 4), (0, 4)], [(1, 1), (2, 1), (2, 2)])
        Domain: 7 points, 7 segments (outer, hole 0)
        """
        outlines = [_as_loop(loop, i) for i, loop in enumerate(loops)]
        named = as_names(names, len(loops), "loop") if names is not None else _names_of(depths_of(outlines))
        starts = np.cumsum([0, *map(len, outlines)])
        rows = [np.column_stack([np.arange(len(r)), np.roll(np.arange(len(r)), -1)]) for r in outlines]
        segments = np.concatenate([np.empty((0, 2), np.int64), *(row + s for row, s in zip(rows, starts, strict=False))])
        every = [name for name, outline in zip(named, outlines, strict=True) for _ in outline]
        together = np.concatenate([*outlines, as_points(points)])
        return cls(together, segments, holes, names=every, curves=curves, regions=regions, crossings=crossings)

    @classmethod
    def _of(cls, *parts: Any) -> Domain:
        domain = object.__new__(cls)
        domain._fill(*parts)
        return domain

    def _fill(
        self,
        points: np.ndarray,
        segments: np.ndarray,
        source: np.ndarray,
        toggles: np.ndarray,
        holes: np.ndarray,
        names: tuple[str, ...],
        curves: Mapping[int, Any],
        regions: tuple[Region, ...],
        merged_into: np.ndarray,
        report: tuple[str, ...],
    ) -> None:
        arrays = {
            "points": points,
            "segments": segments,
            "source": source,
            "toggles": toggles,
            "holes": holes,
            "merged_into": merged_into,
        }
        for name, array in arrays.items():
            array.flags.writeable = False
            object.__setattr__(self, name, array.view())  # a view of it cannot be made writeable again
        object.__setattr__(self, "curves", MappingProxyType(dict(curves)))
        for name, value in (("names", names), ("regions", regions), ("report", report)):
            object.__setattr__(self, name, value)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"a Domain does not change: make a new one instead of setting {name!r}")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"a Domain does not change: {name!r} cannot be deleted")

    def __reduce__(self) -> Any:
        arrays = (array.copy() for array in (self.points, self.segments, self.source, self.toggles, self.holes))
        return Domain._of, (*arrays, self.names, dict(self.curves), self.regions, self.merged_into.copy(), self.report)

    def reporting(self, sentence: str) -> Domain:
        """The same domain with one more sentence in its report."""
        domain = object.__new__(Domain)
        domain.__dict__.update(self.__dict__, report=(*self.report, sentence))
        return domain

    # ---- showing -------------------------------------------------------------------------------------

    def write(self, path: Any) -> tuple[str, ...]:
        """Write the domain to ``path``, a .poly or .node file. Returns what that format cannot keep, in sentences."""
        from fem_mesh.files.endings import write

        return write(self, path)

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw the domain on Matplotlib axes ``ax``, or as a picture of its own (see ``fem_mesh.watch.outline``)."""
        from fem_mesh.watch.outline import plot_domain

        return plot_domain(self, ax, **options)

    def __repr__(self) -> str:
        named = list(dict.fromkeys(filter(None, self.names)))
        more = [f"{len(named) - MOST_NAMES} more"] if len(named) > MOST_NAMES else []
        listed = f" ({', '.join(named[:MOST_NAMES] + more)})" if named else ""
        facts = [_count(len(self.points), "point"), _count(len(self.segments), "segment") + listed]
        facts += [f"{len(self.curves):,} of them curved"] if self.curves else []
        facts += [_count(len(self.holes), "hole seed")] if len(self.holes) else []
        facts += [_count(len(self.regions), "region")] if self.regions else []
        facts += [f"{_count(len(self.report), 'note')} in its report"] if self.report else []
        return "Domain: " + ", ".join(facts)

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> Any:
        return self.plot()._repr_mimebundle_()


def _as_loop(loop: Any, i: int) -> np.ndarray:
    """A closed outline, its closing vertex not repeated."""
    try:
        outline = as_points(loop)
    except MeshError as error:
        raise MeshError(f"loop {i}: {error}") from None
    if len(outline) > 1 and (outline[0] == outline[-1]).all():
        outline = outline[:-1]
    if len(outline) < 3:
        raise MeshError(f"loop {i} has {_count(len(outline), 'point')}, and a closed outline needs 3")
    return outline


def _names_of(depths: list[int]) -> list[str]:
    names, outer, holes = [], 0, 0
    for depth in depths:
        names.append(f"hole {holes}" if depth % 2 else f"outer {outer}" if outer else "outer")
        outer, holes = outer + (depth % 2 == 0), holes + depth % 2
    return names


def _count(n: int, thing: str) -> str:
    return f"{n:,} {thing}{'s' * (n != 1)}"
