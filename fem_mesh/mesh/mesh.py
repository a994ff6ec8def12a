"""Mesh: the finished thing a user holds."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.mesh import quality, validators
from fem_mesh.mesh.locator import Locator
from fem_mesh.mesh.points import as_points


class Mesh:
    """A triangle mesh. Its arrays are read-only; the points keep the user's numbering.

    points : float64 (n, 2)
    triangles : int32 (m, 3), counter-clockwise (clockwise ones that you give are turned round)
    neighbors : int32 (m, 3), the triangle opposite corner i, -1 at the boundary
    segments : int32 (k, 2), edges that were asked for
    merged_into : int32 (n,), each point's representative: itself, or the equal point with the lowest
        index (if you gave an order of insertion: the one inserted first)
    regions : int32 (m,), the material of each triangle
    note : why the mesh is empty or incomplete, else ""
    work : what it took: "in_circle tests", "walk steps", "flips"

    >>> import fem_mesh as fm
    >>> mesh = fm.delaunay([(0, 0), (2, 0), (2, 2), (0, 1)])
    >>> mesh
    Mesh: 4 points, 2 triangles, smallest angle 26.6 degrees
    """

    points: np.ndarray
    triangles: np.ndarray
    neighbors: np.ndarray
    segments: np.ndarray
    merged_into: np.ndarray
    regions: np.ndarray
    note: str
    work: Mapping[str, int]

    def __init__(self, points: Any, triangles: Any, *, segments: Any = None, regions: Any = None, note: str = "") -> None:
        points, triangles = as_points(points), quality.as_triangles(triangles)
        validators.check_elements(points, triangles)
        triangles = quality.counter_clockwise(points, triangles)
        twins = validators.check_edges(points, triangles)
        neighbors = np.where(twins < 0, -1, twins // 3)[:, [1, 2, 0]].astype(np.int32)
        segments = np.array([] if segments is None else segments, np.int32).reshape(-1, 2)
        regions = np.zeros(len(triangles), np.int32) if regions is None else np.array(regions, np.int32)
        self._fill(points, triangles, neighbors, segments, np.arange(len(points), dtype=np.int32), regions, note, {})

    @classmethod
    def _of(cls, points: np.ndarray, triangles: np.ndarray, neighbors: np.ndarray, *rest: Any) -> Mesh:
        """A mesh that takes over the arrays of an algorithm of ours, unchecked."""
        mesh = object.__new__(cls)
        mesh._fill(points, triangles, neighbors, *rest)
        return mesh

    def _fill(
        self,
        points: np.ndarray,
        triangles: np.ndarray,
        neighbors: np.ndarray,
        segments: np.ndarray,
        merged_into: np.ndarray,
        regions: np.ndarray,
        note: str,
        work: Mapping[str, int],
    ) -> None:
        arrays = {
            "points": points,
            "triangles": triangles,
            "neighbors": neighbors,
            "segments": segments,
            "merged_into": merged_into,
            "regions": regions,
        }
        for name, array in arrays.items():
            array.flags.writeable = False
            object.__setattr__(self, name, array.view())  # a view of it cannot be made writeable again
        object.__setattr__(self, "note", note)
        object.__setattr__(self, "work", MappingProxyType(dict(work)))

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"a Mesh does not change: make a new one instead of setting {name!r}")

    def __reduce__(self) -> Any:
        arrays = (self.points, self.triangles, self.neighbors, self.segments, self.merged_into, self.regions)
        return Mesh._of, (*(array.copy() for array in arrays), self.note, dict(self.work))

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"a Mesh does not change: {name!r} cannot be deleted")

    # ---- facts -----------------------------------------------------------------------------------

    @cached_property
    def unused(self) -> np.ndarray:
        """The points in no triangle, int64 (k,): duplicates among them."""
        used = np.zeros(len(self.points), bool)
        used[self.triangles] = True
        return np.flatnonzero(~used)

    def angles(self) -> np.ndarray:
        """The angle at each corner, in degrees: float64 (m, 3)."""
        return quality.angles(self.points, self.triangles)

    def areas(self) -> np.ndarray:
        """The area of each triangle: float64 (m,)."""
        return quality.areas(self.points, self.triangles)

    @cached_property
    def min_angle(self) -> float:
        """The smallest angle, in degrees; nan without triangles."""
        return float(self.angles().min()) if len(self.triangles) else float("nan")

    def is_delaunay(self) -> bool:
        """Whether this is a valid mesh whose every circle is empty and which covers the convex hull: exact."""
        try:
            self.validate(delaunay=True)
        except MeshError:
            return False
        return True

    def validate(self, delaunay: bool = False) -> Mesh:
        """Climb the ladder of validators (see ``fem_mesh.mesh.validators``): raises MeshError, or returns the mesh."""
        validators.validate(self.points, self.triangles, delaunay=delaunay)
        return self

    # ---- questions -------------------------------------------------------------------------------

    @cached_property
    def _locator(self) -> Locator:
        return Locator(self.points, self.triangles)

    def find(self, x: Any, y: Any) -> Any:
        """The triangle in or on which each point (x, y) lies, -1 outside: exact.

        Takes numbers or arrays of one shape; returns an int or an int32 array of that shape. On an edge
        or a vertex, the triangle with the lowest number.

        >>> import fem_mesh as fm
        >>> fm.delaunay([(0, 0), (2, 0), (0, 2)]).find([0.5, 2.0], [0.5, 2.0]).tolist()
        [0, -1]
        """
        x, y = _broadcast(x, y)
        queries = as_points(np.column_stack([x.ravel(), y.ravel()]))
        found = self._locator.find(queries).reshape(x.shape)
        return int(found) if found.ndim == 0 else found

    def interpolate(self, values: Any, x: Any, y: Any) -> Any:
        """The piecewise linear function with ``values`` (n,) at the points, at (x, y); nan outside.

        >>> import fem_mesh as fm
        >>> fm.delaunay([(0, 0), (2, 0), (0, 2)]).interpolate([0, 2, 4], 0.5, 1.0)
        2.5
        """
        values = _numbers(values, "values")
        if values.shape != (len(self.points),):
            raise MeshError(f"values must have one number a point, shape ({len(self.points)},), not {values.shape}")
        x, y = _broadcast(x, y)
        t = np.asarray(self.find(x, y))
        inside = t >= 0
        result = np.full(x.shape, np.nan)
        corners = self.triangles[t[inside]]
        weights = quality.barycentric(self.points[corners], np.column_stack([x[inside], y[inside]]))
        result[inside] = (weights * values[corners]).sum(axis=1)
        return float(result) if result.ndim == 0 else result

    # ---- showing ---------------------------------------------------------------------------------

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw the mesh on Matplotlib axes ``ax``, or as a picture of its own (see ``fem_mesh.watch.draw``)."""
        from fem_mesh.watch.draw import plot_mesh

        return plot_mesh(self, ax, **options)

    def __repr__(self) -> str:
        n, m = len(self.points), len(self.triangles)
        facts = [f"{n:,} point{'s' * (n != 1)}", f"{m:,} triangle{'s' * (m != 1)}"]
        doubles = int((self.merged_into != np.arange(n)).sum())
        facts += [f"{doubles:,} of the points merged"] if doubles else []
        facts += [f"smallest angle {self.min_angle:.1f} degrees"] if m else []
        facts += [self.note] if self.note else []
        return "Mesh: " + ", ".join(facts)

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> Any:
        from fem_mesh.watch.draw import picture_of_mesh

        return picture_of_mesh(self)._repr_mimebundle_()


def _numbers(values: Any, name: str) -> np.ndarray:
    try:
        array = np.asarray(values)
        if array.dtype.kind in "fiub":
            return array.astype(np.float64)
    except ValueError:
        pass
    raise MeshError(f"{name} must be real numbers, not {values!r}")


def _broadcast(x: Any, y: Any) -> tuple[np.ndarray, np.ndarray]:
    x, y = _numbers(x, "x"), _numbers(y, "y")
    try:
        x, y = np.broadcast_arrays(x, y)
    except ValueError:
        raise MeshError(f"x and y must have one shape, not {x.shape} and {y.shape}") from None
    return x, y
