"""The Voronoi diagram: for each point the places nearer to it than to any other. The dual of a Delaunay mesh.

Its vertices are the centres of the triangles' circles. Triangles on one circle have one vertex together: whether
they are is an exact sign, so a grid of squares has the diagram of a grid, without edges of no length.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from fem_mesh.kernel import view
from fem_mesh.mesh.quality import circumcenters, ties
from fem_mesh.mesh.validators import connect

if TYPE_CHECKING:
    from fem_mesh.mesh.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Voronoi:
    """A Voronoi diagram, as ``mesh.voronoi()`` gives it. Its arrays are read-only.

    mesh : the Delaunay mesh whose points are the sites
    vertices : float64 (k, 2), each as far from three sites or more, and no nearer to any other; rounded
    vertex_of : int32 (m,), the vertex in the centre of each triangle's circle; triangles on one circle share it
    edges : int32 (e, 2), pairs of vertices; -1 is infinitely far away
    sites : int32 (e, 2), the two points between which each edge runs: the first lies on its left
    directions : float64 (e, 2), the unit direction in which an edge goes to infinity; nan for edges that end

    An edge from -1 to -1 is a whole line, between two sites in the middle: points that all lie on one line have these.

    >>> import fem_mesh as fm
    >>> diagram = fm.delaunay([(0, 0), (2, 0), (2, 2), (0, 2), (1, 4)]).voronoi()
    >>> diagram
    Voronoi: 2 vertices, 6 edges
    >>> diagram.vertices.tolist()
    [[1.0, 1.0], [1.0, 2.75]]
    >>> diagram.cell(4).tolist()
    [1, -1]
    """

    mesh: Mesh = field(repr=False)
    vertices: np.ndarray
    vertex_of: np.ndarray
    edges: np.ndarray
    sites: np.ndarray
    directions: np.ndarray

    def __post_init__(self) -> None:
        for array in (self.vertices, self.vertex_of, self.edges, self.sites, self.directions):
            array.flags.writeable = False

    @property
    def note(self) -> str:
        """Why there is no vertex, else ""."""
        return self.mesh.note

    def cell(self, i: int) -> np.ndarray:
        """The vertices around the cell of point ``i``, counter-clockwise: int32 (j,); -1, once, where it is open.

        Equal points have one cell. That of the only point, or of one between parallel lines, is [-1].
        """
        triangles, neighbors, vertex_of = view(self.mesh.triangles), view(self.mesh.neighbors), view(self.vertex_of)
        around: list[int] = []
        i = self._representatives[i].item()
        t = first = self._first_triangles.item(i)
        while t >= 0:  # counter-clockwise around the point, once or until the hull
            if not around or around[-1] != vertex_of[t]:
                around.append(vertex_of[t])
            corner = 0 if triangles[t, 0] == i else 1 if triangles[t, 1] == i else 2
            t = neighbors[t, (corner + 1) % 3]
            if t == first:
                break
        else:
            around.append(-1)
        if len(around) > 1 and around[0] == around[-1]:  # the triangles begin in the middle of a circle
            around.pop()
        return np.array(around, np.int32)

    def cells(self) -> list[np.ndarray]:
        """The cell of each point (see ``cell``)."""
        return [self.cell(i) for i in range(len(self.mesh.points))]

    def ends(self, reach: float) -> np.ndarray:
        """The two ends of each edge, to draw it: float64 (e, 2, 2). One that is infinitely far away is put at ``reach``.

        >>> import fem_mesh as fm
        >>> fm.delaunay([(0, 0), (2, 0)]).voronoi().ends(5).tolist()
        [[[1.0, 5.0], [1.0, -5.0]]]
        """
        ends = np.empty((len(self.edges), 2, 2))
        middles = self.mesh.points[self.sites].mean(axis=1)
        for i, far in ((0, -reach), (1, reach)):
            open_, other = self.edges[:, i] < 0, self.edges[:, 1 - i]
            ends[~open_, i] = self.vertices[self.edges[~open_, i]]
            begin = middles.copy()
            begin[other >= 0] = self.vertices[other[other >= 0]]
            ends[open_, i] = begin[open_] + far * self.directions[open_]
        return ends

    @cached_property
    def _representatives(self) -> np.ndarray:
        """For each point the equal one that is in a triangle; itself where none is."""
        n, used = len(self.mesh.points), np.unique(self.mesh.triangles)
        _, place = np.unique(self.mesh.points, axis=0, return_inverse=True)
        there = np.full(n, -1)
        there[place.ravel()[used]] = used
        found = there[place.ravel()]
        return np.where(found < 0, np.arange(n), found)

    @cached_property
    def _first_triangles(self) -> np.ndarray:
        """A triangle at each point, the first of them counter-clockwise if it lies on the hull; -1 if there is none."""
        triangles, first = self.mesh.triangles, np.full(len(self.mesh.points), -1)
        first[triangles] = np.arange(len(triangles))[:, None]
        t, i = np.nonzero(self.mesh.neighbors < 0)
        first[triangles[t, (i + 1) % 3]] = t
        return first

    def __repr__(self) -> str:
        k, e = len(self.vertices), len(self.edges)
        facts = [f"{k:,} {'vertex' if k == 1 else 'vertices'}", f"{e:,} edge{'s' * (e != 1)}"]
        return "Voronoi: " + ", ".join(facts + [self.note] * bool(self.note))


def voronoi_of(mesh: Mesh) -> Voronoi:
    """The Voronoi diagram of a mesh that is Delaunay: this is not checked."""
    points, triangles, neighbors = mesh.points, mesh.triangles, mesh.neighbors
    if not len(triangles):
        return _of_line(mesh)
    t, i = ties(points, triangles, neighbors)
    lowest, vertex_of = np.unique(connect(len(triangles), t, neighbors[t, i]), return_inverse=True)
    t, i = np.nonzero((neighbors < 0) | (neighbors > np.arange(len(triangles))[:, None]))  # each edge once
    edges = np.column_stack([vertex_of[t], np.where(neighbors[t, i] < 0, -1, vertex_of[neighbors[t, i]])])
    sites = np.column_stack([triangles[t, (i + 2) % 3], triangles[t, (i + 1) % 3]])
    real = edges[:, 0] != edges[:, 1]
    edges, sites = edges[real].astype(np.int32), sites[real]
    directions = np.full((len(edges), 2), np.nan)
    open_ = edges[:, 1] < 0
    directions[open_] = _between(points, sites[open_])
    return Voronoi(mesh, circumcenters(points, triangles[lowest]), vertex_of.astype(np.int32), edges, sites, directions)


def _of_line(mesh: Mesh) -> Voronoi:
    """The lines between neighbours among points that all lie on one line: sorted along it."""
    _, order = np.unique(mesh.points, axis=0, return_index=True)
    sites = np.column_stack([order[1:], order[:-1]]).astype(np.int32)
    edges = np.full((len(sites), 2), -1, np.int32)
    return Voronoi(mesh, np.empty((0, 2)), np.empty(0, np.int32), edges, sites, _between(mesh.points, sites))


def _between(points: np.ndarray, sites: np.ndarray) -> np.ndarray:
    """The unit directions that have the first of two sites on their left, the second on their right."""
    x, y = (points[sites[:, 1]] - points[sites[:, 0]]).T
    return np.asarray(np.column_stack([-y, x]) / np.hypot(x, y)[:, None] + 0.0)  # -0.0 is 0.0
