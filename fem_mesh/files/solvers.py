"""To those who compute on a mesh and draw on it, and back: scikit-fem's ``MeshTri``, Matplotlib's ``Triangulation``.

Both are imported when they are first needed.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.files.names import name_regions, number_sets
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.quality import numbers_below

if TYPE_CHECKING:
    from matplotlib.tri import Triangulation

MISSING = "this needs scikit-fem: pip install scikit-fem"
STACK = 3  # a warning names the line that called the method of Mesh

# ---- scikit-fem -------------------------------------------------------------------------------------


def to_skfem(mesh: Mesh) -> Any:
    """The mesh as a ``skfem.MeshTri``, its triangles in the same order.

    boundaries : the facets of each of ``mesh.boundaries``, in the order of its rows, each once
    subdomains : the triangles of each region, by its name, or as "region 7" where it has none

    Each triangle's corners are sorted, as scikit-fem has them. Of the segments only those with a name are kept,
    without their direction. scikit-fem cannot have points that are in no triangle: they are left out with a
    warning, and the others are numbered in their order. Values there are values at ``mesh.points[used]`` with
    ``used = np.delete(np.arange(len(mesh.points)), mesh.unused)``.

    >>> import fem_mesh as fm
    >>> m = to_skfem(fm.refine(fm.square(), max_area=0.1))
    >>> sorted(m.boundaries)
    ['bottom', 'left', 'right', 'top']
    """
    try:
        from skfem import MeshTri
    except ImportError:
        raise ImportError(MISSING, name="skfem") from None
    if not len(mesh.triangles):
        raise MeshError("the mesh has no triangles, and scikit-fem's meshes have some")
    points, triangles = mesh.points, mesh.triangles
    if len(mesh.unused):
        warnings.warn(_left_out(len(mesh.unused), len(points)), stacklevel=STACK)
        used = np.ones(len(points), bool)
        used[mesh.unused] = False
        points, triangles = points[used], (np.cumsum(used) - 1)[triangles]
    found = MeshTri(np.ascontiguousarray(points.T), np.ascontiguousarray(triangles.T, np.int32))
    boundaries, subdomains = _facets_by_name(mesh), _triangles_by_name(mesh)
    found = found.with_boundaries(boundaries) if boundaries else found
    return found.with_subdomains(subdomains) if subdomains else found


def from_skfem(m: Any) -> Mesh:
    """The mesh that a ``skfem.MeshTri`` holds: its named facets are the segments, its subdomains the regions.

    Where subdomains overlap, the first has the triangle, and ``note`` says so. Raises MeshError where ``m``
    has cells that are no straight triangles.

    >>> import skfem
    >>> mesh = from_skfem(skfem.MeshTri().refined(2).with_defaults())
    >>> mesh
    Mesh: 25 points, 32 triangles, 16 segments, smallest angle 45.0 degrees
    >>> sorted(mesh.boundaries)
    ['bottom', 'left', 'right', 'top']
    """
    try:
        from skfem import ElementTriP1, MeshTri
    except ImportError:
        raise ImportError(MISSING, name="skfem") from None
    if not isinstance(m, MeshTri) or m.elem is not ElementTriP1:
        mend = "skfem.MeshTri1.from_mesh makes one of a MeshTri2, and a MeshQuad has to_meshtri"
        raise MeshError(f"from_skfem takes a skfem.MeshTri of straight triangles, not a {type(m).__name__}: {mend}")
    named = dict(m.boundaries or {})
    facets = {name: numbers_below(rows, m.nfacets, f"boundaries[{name!r}]") for name, rows in named.items()}
    rows = np.unique(np.concatenate([np.empty(0, np.int32), *facets.values()]))
    sets = dict(m.subdomains or {})
    regions, region_names, note = number_sets(
        {name: numbers_below(rows, m.nelements, f"subdomains[{name!r}]") for name, rows in sets.items()}, m.nelements
    )
    return Mesh(
        m.p.T,
        m.t.T,
        segments=m.facets[:, rows].T if len(rows) else None,
        boundaries={name: np.searchsorted(rows, some) for name, some in facets.items()},
        regions=regions,
        region_names=region_names,
        note=note,
    )


def _left_out(left: int, of: int) -> str:
    are = "is" if left == 1 else "are"
    return f"{left:,} of {of:,} points {are} in no triangle: scikit-fem has the other {of - left:,}, in their order"


def _facets_by_name(mesh: Mesh) -> dict[str, np.ndarray]:
    """For each boundary the numbers that scikit-fem gives its facets: edges in the order of their two ends."""
    if not mesh.boundaries:
        return {}
    n, m = len(mesh.points), len(mesh.triangles)
    once = mesh.neighbors < np.arange(m)[:, None]  # of the two triangles at an edge, the later lists it
    edges = [_keys(mesh.triangles[once[:, i], i - 2], mesh.triangles[once[:, i], i - 1], n) for i in range(3)]
    facets = np.searchsorted(np.sort(np.concatenate(edges)), _keys(mesh.segments[:, 0], mesh.segments[:, 1], n)).astype(
        np.int32
    )
    return {name: _each_once(facets[rows]) for name, rows in mesh.boundaries.items()}


def _keys(a: np.ndarray, b: np.ndarray, n: int) -> np.ndarray:
    keys: np.ndarray = np.minimum(a, b).astype(np.int64) * n + np.maximum(a, b)
    return keys


def _each_once(numbers: np.ndarray) -> np.ndarray:
    """The first of equal ones: a segment given twice is one facet."""
    first = np.unique(numbers, return_index=True)[1]
    return numbers[np.sort(first)]


def _triangles_by_name(mesh: Mesh) -> dict[str, np.ndarray]:
    """The triangles of each region that has a name or a number; regions of one name are together."""
    names = name_regions(mesh.region_names, mesh.regions)
    order = np.argsort(mesh.regions, kind="stable").astype(np.int32)
    starts = np.searchsorted(mesh.regions[order], np.arange(len(names) + 1))
    found: dict[str, np.ndarray] = {}
    for r, name in enumerate(names):
        if r and name:
            found[name] = np.sort(np.concatenate([found.get(name, order[:0]), order[starts[r] : starts[r + 1]]]))
    return found


# ---- Matplotlib -------------------------------------------------------------------------------------


def to_matplotlib(mesh: Mesh) -> Triangulation:
    """The mesh as a ``matplotlib.tri.Triangulation``, for ``tricontourf``, ``tripcolor``, interpolators.

    All points are there, in their order, and the triangles as they are; segments, boundaries and regions are not.

    >>> import fem_mesh as fm
    >>> mesh = fm.delaunay([(0, 0), (2, 0), (0, 2)])
    >>> to_matplotlib(mesh).triangles.tolist() == mesh.triangles.tolist()
    True
    """
    from matplotlib.tri import Triangulation

    if not len(mesh.triangles):
        raise MeshError("the mesh has no triangles, and Matplotlib's triangulations have some")
    return Triangulation(mesh.points[:, 0].copy(), mesh.points[:, 1].copy(), mesh.triangles.copy())


def from_matplotlib(triangulation: Triangulation) -> Mesh:
    """The mesh that a ``matplotlib.tri.Triangulation`` holds: the triangles that its mask leaves.

    >>> from matplotlib.tri import Triangulation
    >>> from_matplotlib(Triangulation([0, 1, 1, 0], [0, 0, 1, 1], [(0, 1, 2), (0, 2, 3)], mask=[False, True]))
    Mesh: 4 points, 1 triangle, smallest angle 45.0 degrees
    """
    from matplotlib.tri import Triangulation

    if not isinstance(triangulation, Triangulation):
        raise MeshError(f"from_matplotlib takes a matplotlib.tri.Triangulation, not a {type(triangulation).__name__}")
    return Mesh(np.column_stack([triangulation.x, triangulation.y]), triangulation.get_masked_triangles())
