"""Mesh: the finished thing a user holds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.mesh import quality, validators
from fem_mesh.mesh.locator import Locator
from fem_mesh.mesh.points import as_coordinates, as_numbers, as_points
from fem_mesh.mesh.refinement import Refinement
from fem_mesh.mesh.voronoi import Voronoi, voronoi_of

MOST_REGIONS = 65_536  # numbers of regions stay below this


class Mesh:
    """A triangle mesh. Its arrays are read-only; the points keep the user's numbering.

    points : float64 (n, 2)
    triangles : int32 (m, 3), counter-clockwise (clockwise ones that you give are turned round)
    neighbors : int32 (m, 3), the triangle opposite corner i, -1 at the boundary
    segments : int32 (k, 2), edges that were asked for: a segment that was split is several, in its direction
    segment_of : int32 (k,), the row of ``domain.segments`` that each lies on; -1 if it is only a boundary
    boundaries : name -> rows of ``segments`` that carry it, int32
    merged_into : int32 (n,), each point's representative: itself, or the equal point with the lowest
        index (if you gave an order of insertion: the one inserted first)
    regions : int32 (m,), the material of each triangle, an index into ``region_names`` ("" is none)
    domain : the Domain that it is a mesh of, or None
    refinement : what ``refine`` achieved (see ``Refinement``); None for other meshes
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
    region_names: tuple[str, ...]
    segment_of: np.ndarray
    boundaries: Mapping[str, np.ndarray]
    domain: Any
    refinement: Refinement | None
    note: str
    work: Mapping[str, int]

    def __init__(
        self,
        points: Any,
        triangles: Any,
        *,
        segments: Any = None,
        regions: Any = None,
        segment_of: Any = None,
        boundaries: Mapping[str, Any] | None = None,
        region_names: Iterable[str] = ("",),
        note: str = "",
    ) -> None:
        points, triangles = as_points(points), quality.as_triangles(triangles)
        validators.check_elements(points, triangles)
        triangles = quality.counter_clockwise(points, triangles)
        twins = validators.check_edges(points, triangles)
        neighbors = np.where(twins < 0, -1, twins // 3)[:, [1, 2, 0]].astype(np.int32)
        segments = quality.as_rows(() if segments is None else segments, "segment", "(k, 2)", ("a", "b")).astype(np.int32)
        validators.check_segments(points, triangles, segments)
        k, m = len(segments), len(triangles)
        rows = {name: quality.numbers_below(rows, k, f"boundaries[{name!r}]") for name, rows in (boundaries or {}).items()}
        numbers = None if regions is None else quality.numbers_below(regions, MOST_REGIONS, "regions", m)
        self._fill(
            points, triangles, neighbors,
            segments=segments,
            segment_of=None if segment_of is None else quality.numbers_below(segment_of, 2**31 - 1, "segment_of", k, lowest=-1),
            boundaries=rows, regions=numbers, region_names=tuple(region_names), note=note,
        )  # fmt: skip

    @classmethod
    def _of(cls, points: np.ndarray, triangles: np.ndarray, neighbors: np.ndarray, **rest: Any) -> Mesh:
        """A mesh that takes over the arrays of an algorithm of ours, unchecked."""
        mesh = object.__new__(cls)
        mesh._fill(points, triangles, neighbors, **rest)
        return mesh

    def _fill(
        self,
        points: np.ndarray,
        triangles: np.ndarray,
        neighbors: np.ndarray,
        *,
        segments: np.ndarray | None = None,
        segment_of: np.ndarray | None = None,
        merged_into: np.ndarray | None = None,
        regions: np.ndarray | None = None,
        boundaries: Mapping[str, np.ndarray] | None = None,
        region_names: tuple[str, ...] = ("",),
        domain: Any = None,
        refinement: Refinement | None = None,
        note: str = "",
        work: Mapping[str, int] | None = None,
    ) -> None:
        segments = np.empty((0, 2), np.int32) if segments is None else segments
        arrays = {
            "points": points,
            "triangles": triangles,
            "neighbors": neighbors,
            "segments": segments,
            "segment_of": np.full(len(segments), -1, np.int32) if segment_of is None else segment_of,
            "merged_into": np.arange(len(points), dtype=np.int32) if merged_into is None else merged_into,
            "regions": np.zeros(len(triangles), np.int32) if regions is None else regions,
        }
        put = object.__setattr__
        for name, array in arrays.items():
            put(self, name, _sealed(array))
        put(self, "boundaries", MappingProxyType({name: _sealed(rows) for name, rows in (boundaries or {}).items()}))
        put(self, "region_names", region_names)
        put(self, "domain", domain)
        put(self, "refinement", refinement)
        put(self, "note", note)
        put(self, "work", MappingProxyType(dict(work or {})))

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"a Mesh does not change: make a new one instead of setting {name!r}")

    def __getstate__(self) -> dict[str, Any]:
        arrays = ("points", "triangles", "neighbors", "segments", "segment_of", "merged_into", "regions")
        state: dict[str, Any] = {name: getattr(self, name).copy() for name in arrays}
        state["boundaries"] = {name: rows.copy() for name, rows in self.boundaries.items()}
        for name in ("region_names", "domain", "refinement", "note"):
            state[name] = getattr(self, name)
        return {**state, "work": dict(self.work)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._fill(**state)

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
        validators.validate(self.points, self.triangles, delaunay=delaunay, touching=self.domain is not None)
        return self

    def cocircular_edges(self) -> np.ndarray:
        """The inner edges whose two triangles lie on one circle, exactly: int32 (j, 2). Either diagonal is Delaunay.

        >>> import fem_mesh as fm
        >>> fm.delaunay([(0, 0), (1, 0), (1, 1), (0, 1), (3, 0)]).cocircular_edges().tolist()
        [[2, 0]]
        """
        return quality.cocircular_edges(self.points, self.triangles, self.neighbors)

    def voronoi(self) -> Voronoi:
        """The Voronoi diagram of the points (see ``Voronoi``). Raises MeshError where the mesh is not Delaunay.

        >>> import fem_mesh as fm
        >>> fm.delaunay([(0, 0), (2, 0), (0, 2)]).voronoi().vertices.tolist()
        [[1.0, 1.0]]
        """
        self.validate(delaunay=True)
        return voronoi_of(self)

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
        x, y = as_coordinates(x, y)
        queries = as_points(np.column_stack([x.ravel(), y.ravel()]))
        found = self._locator.find(queries).reshape(x.shape)
        return int(found) if found.ndim == 0 else found

    def interpolate(self, values: Any, x: Any, y: Any) -> Any:
        """The piecewise linear function with ``values`` (n,) at the points, at (x, y); nan outside.

        >>> import fem_mesh as fm
        >>> fm.delaunay([(0, 0), (2, 0), (0, 2)]).interpolate([0, 2, 4], 0.5, 1.0)
        2.5
        """
        values = as_numbers(values, "values")
        if values.shape != (len(self.points),):
            raise MeshError(f"values must have one number a point, shape ({len(self.points)},), not {values.shape}")
        x, y = as_coordinates(x, y)
        t = np.asarray(self.find(x, y))
        inside = t >= 0
        result = np.full(x.shape, np.nan)
        corners = self.triangles[t[inside]]
        weights = quality.barycentric(self.points[corners], np.column_stack([x[inside], y[inside]]))
        result[inside] = (weights * values[corners]).sum(axis=1)
        return float(result) if result.ndim == 0 else result

    # ---- files ------------------------------------------------------------------------------------

    def write(self, path: Any) -> tuple[str, ...]:
        """Write the mesh to ``path``, whose ending says how. Returns what is lost, in sentences (``fm.write`` has a table)."""
        from fem_mesh.files.endings import write

        return write(self, path)

    def to_meshio(self) -> Any:
        """The mesh as a ``meshio.Mesh``, with its segments, boundaries and regions."""
        from fem_mesh.files.formats import to_meshio

        return to_meshio(self)

    @classmethod
    def from_meshio(cls, data: Any) -> Mesh:
        """The mesh that a ``meshio.Mesh`` holds (see ``fem_mesh.files.exchange``)."""
        from fem_mesh.files.formats import from_meshio

        return from_meshio(data)

    def to_skfem(self) -> Any:
        """The mesh as a ``skfem.MeshTri`` with boundaries and subdomains, on used points (see ``fem_mesh.files.solvers``)."""
        from fem_mesh.files.solvers import to_skfem

        return to_skfem(self)

    @classmethod
    def from_skfem(cls, m: Any) -> Mesh:
        """The mesh that a ``skfem.MeshTri`` holds: named facets are its segments, subdomains its regions."""
        from fem_mesh.files.solvers import from_skfem

        return from_skfem(m)

    def to_matplotlib(self) -> Any:
        """The mesh as a ``matplotlib.tri.Triangulation``: points and triangles."""
        from fem_mesh.files.solvers import to_matplotlib

        return to_matplotlib(self)

    @classmethod
    def from_matplotlib(cls, triangulation: Any) -> Mesh:
        """The mesh that a ``matplotlib.tri.Triangulation`` holds: the triangles that its mask leaves."""
        from fem_mesh.files.solvers import from_matplotlib

        return from_matplotlib(triangulation)

    # ---- showing ---------------------------------------------------------------------------------

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw the mesh on Matplotlib axes ``ax``, or as a picture of its own (see ``fem_mesh.watch.draw``)."""
        from fem_mesh.watch.draw import plot_mesh

        return plot_mesh(self, ax, **options)

    def __repr__(self) -> str:
        n, m = len(self.points), len(self.triangles)
        facts = [f"{n:,} point{'s' * (n != 1)}", f"{m:,} triangle{'s' * (m != 1)}"]
        k = len(self.segments)
        facts += [f"{k:,} segment{'s' * (k != 1)}"] if k else []
        doubles = int((self.merged_into != np.arange(n)).sum())
        facts += [f"{doubles:,} of the points merged"] if doubles else []
        facts += [f"smallest angle {self.min_angle:.1f} degrees"] if m else []
        facts += [self.note] if self.note else []
        return "Mesh: " + ", ".join(facts)

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> Any:
        from fem_mesh.watch.draw import picture_of_mesh

        return picture_of_mesh(self)._repr_mimebundle_()


def _sealed(array: np.ndarray) -> np.ndarray:
    """A view of ``array`` that cannot be made writeable again."""
    array.flags.writeable = False
    return array.view()
