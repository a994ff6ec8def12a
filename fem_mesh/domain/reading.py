"""What users say about a domain, checked at the door: segments, names, holes, regions, curves."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem_mesh.domain.curves import as_curve
from fem_mesh.errors import MeshError
from fem_mesh.mesh.points import as_points
from fem_mesh.mesh.quality import as_rows

SHOWN = 5  # rows named in a message, before "and 7 more"


@dataclass(frozen=True)
class Region:
    """A material: the part of the domain around (x, y) that segments enclose, and what is wanted there.

    size : the longest edge wanted, or None
    max_area : the largest triangle wanted, or None

    >>> Region(0.5, 0.5, "steel", size=0.1)
    Region(x=0.5, y=0.5, name='steel', size=0.1, max_area=None)
    """

    x: float
    y: float
    name: str
    size: float | None = None
    max_area: float | None = None

    def __post_init__(self) -> None:
        place = as_points([(self.x, self.y)])[0].tolist()
        object.__setattr__(self, "x", place[0])
        object.__setattr__(self, "y", place[1])
        if not isinstance(self.name, str):
            raise MeshError(f"the region at ({self.x:.6g}, {self.y:.6g}) must have a string as its name, not {self.name!r}")
        for bound in ("size", "max_area"):
            value = getattr(self, bound)
            if value is not None and not (_is_number(value) and value > 0):
                raise MeshError(f"region {self.name!r}: {bound} must be a number > 0 or None, not {value!r}")


def as_segments(segments: Any, points: np.ndarray) -> np.ndarray:
    """``segments`` as a new int64 array (k, 2). Raises MeshError where they are no pairs of point numbers."""
    given = as_rows(segments, "segment", "(k, 2)", ("a", "b"))
    wrong = np.flatnonzero(((given < 0) | (given >= len(points))).any(axis=1))
    for row in wrong[:1]:
        a, b = given[row].tolist()
        missing = b if 0 <= a < len(points) else a
        there = f"points have the numbers 0 to {len(points) - 1}" if len(points) else "there are no points"
        raise MeshError(f"segment {row} = ({a}, {b}) names point {missing}, which is not there: {there}")
    return given.astype(np.int64)


def as_names(names: Any, k: int, thing: str = "segment") -> list[str]:
    """One name a row. ``names`` is one for all, or a list of them, or a mapping from rows to names."""
    if names is None or isinstance(names, str):
        return [names or ""] * k
    if isinstance(names, Mapping):
        for row in names:
            _check_row(row, k, "names", thing)
        names = [names.get(row) for row in range(k)]
    if not isinstance(names, Iterable):
        raise MeshError(f"names must be a list of strings, one a {thing}, not {names!r}")
    names = ["" if name is None else name for name in names]
    for row, name in enumerate(names):
        if not isinstance(name, str):
            raise MeshError(f"the name of {thing} {row} must be a string, not {name!r}")
    if len(names) != k:
        raise MeshError(f"names must have one name a {thing}, {k} of them, not {len(names)}")
    return [str(name) for name in names]


def as_curves(curves: Any, k: int) -> dict[int, Any]:
    """A curve for some of the rows."""
    if curves is None:
        return {}
    if not isinstance(curves, Mapping):
        raise MeshError(f"curves must be a mapping from rows of segments to curves, not {curves!r:.80}")
    for row in curves:
        _check_row(row, k, "curves", "segment")
    found = {}
    for row, curve in curves.items():
        try:
            found[int(row)] = as_curve(curve)
        except MeshError as error:
            raise MeshError(f"curves[{row}]: {error}") from None
    return found


def as_seeds(holes: Any) -> np.ndarray:
    """Hole seeds as float64 (j, 2)."""
    try:
        return as_points([] if holes is None else holes)
    except MeshError as error:
        raise MeshError(f"holes, one seed (x, y) a hole: {str(error).replace('point ', 'hole ', 1)}") from None


def as_regions(regions: Any) -> tuple[Region, ...]:
    """Regions as such: given so, or as tuples (x, y, name, size, max_area), or as a mapping from names to places (x, y)."""
    if regions is None:
        return ()
    if isinstance(regions, Region):
        return (regions,)
    if isinstance(regions, Mapping):
        regions = [(*_as_place(place, name), name) for name, place in regions.items()]
    found = []
    for row, region in enumerate(regions):
        try:
            found.append(region if isinstance(region, Region) else Region(*region))
        except MeshError as error:
            raise MeshError(f"region {row}: {error}") from None
        except TypeError:
            raise MeshError(f"region {row} must be a Region or a tuple (x, y, name), not {region!r}") from None
    return tuple(found)


def _as_place(place: Any, name: Any) -> tuple[Any, Any]:
    try:
        x, y = place
    except (TypeError, ValueError):
        raise MeshError(f"region {name!r} must be at a place (x, y), not {place!r}") from None
    return x, y


def _check_row(row: Any, k: int, argument: str, thing: str) -> None:
    if isinstance(row, bool) or not isinstance(row, int | np.integer) or not 0 <= row < k:
        raise MeshError(f"{argument} speaks of {thing} {row!r}, which is not there: {thing}s have the rows 0 to {k - 1}")


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.integer | np.floating) and math.isfinite(value)


def place(points: np.ndarray, v: int) -> str:
    """The coordinates of a point, as messages give them."""
    return f"({points[v, 0]:.6g}, {points[v, 1]:.6g})"


def some(rows: Iterable[int], thing: str) -> str:
    """Things by number, the first few of them.

    >>> some([3, 4], "segment"), some(range(9), "point")
    ('segments 3 and 4', 'points 0, 1, 2, 3, 4 and 4 more')
    """
    rows = list(rows)
    named = [str(row) for row in rows[:SHOWN]]
    if len(rows) > SHOWN:
        named.append(f"{len(rows) - SHOWN:,} more")
    listed = " and ".join(filter(None, [", ".join(named[:-1]), named[-1]]))
    return f"{thing}{'s' * (len(rows) != 1)} {listed}"
