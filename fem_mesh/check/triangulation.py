"""Triangulations as judges see them: few points, every test exact, and the first offender named."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from fem_mesh.check.reading import Row
from fem_mesh.check.verdict import Wrong
from fem_mesh.errors import MeshError
from fem_mesh.mesh.validators import check_realization, check_topology
from fem_mesh.predicates import in_circle, orient

Triangle = tuple[int, int, int]
Edge = tuple[int, int]


class Triangulation:
    """Triangles over points (n, 2): counter-clockwise, the lowest number first, whatever the order they came in.

    All numbers are there, and no triangle names one twice; for all else see ``check_valid``.
    """

    def __init__(self, points: np.ndarray, rows: Iterable[Row]) -> None:
        self.points = points
        rows = list(rows)
        if len(rows) > 2 * len(points):
            raise Wrong(f"there are {len(rows)} triangles, but {len(points)} points cannot have more than {2 * len(points)}")
        for row in rows:
            check_numbers(row, len(points))
        self.triangles: list[Triangle] = [self._turned(row) for row in rows]
        self.all = frozenset(self.triangles)

    def _turned(self, row: Row) -> Triangle:
        a, b, c = row
        if orient(*(self.points[v].tolist() for v in row)) < 0:
            b, c = c, b
        return min((a, b, c), (b, c, a), (c, a, b))

    def at(self, *vertices: int) -> list[Any]:
        """Where vertices are."""
        return [self.points[v].tolist() for v in vertices]

    @cached_property
    def apex(self) -> dict[Edge, int]:
        """The third vertex of the triangle on the left of each directed edge. Raises Wrong where there are two."""
        apex: dict[Edge, int] = {}
        for a, b, c in self.triangles:
            for edge, tip in (((a, b), c), ((b, c), a), ((c, a), b)):
                if edge in apex:
                    raise Wrong(
                        f"triangles {(*edge, apex[edge])} and {(*edge, tip)} overlap: "
                        f"both lie on the same side of edge {say_edge(*edge)}"
                    )
                apex[edge] = tip
        return apex

    @property
    def edges(self) -> set[Edge]:
        """All edges, the lower number first."""
        return edges_of(self.triangles)


def check_numbers(row: Row, n: int) -> None:
    """A row names points that are there, and none twice."""
    for v in row:
        if not 0 <= v < n:
            raise Wrong(f"triangle {row} names point {v}, but the points are numbered from 0 to {n - 1}")
    if len(set(row)) < len(row):
        raise Wrong(f"triangle {row} names a point twice")


def check_once(mesh: Triangulation) -> None:
    """No triangle is there twice."""
    for triangle, times in Counter(mesh.triangles).items():
        if times > 1:
            raise Wrong(f"triangle {triangle} is there {'twice' if times == 2 else f'{times} times'}")


def check_valid(mesh: Triangulation) -> None:
    """No triangle is there twice, none is flat, and none overlap."""
    check_once(mesh)
    for a, b, c in mesh.triangles:
        if orient(*mesh.at(a, b, c)) == 0:
            raise Wrong(f"triangle {(a, b, c)} is flat: its three corners lie on one line")
    assert mesh.apex is not None
    rows = np.array(mesh.triangles, np.int32).reshape(-1, 3)
    try:
        check_topology(mesh.points, rows, touching=True)
        check_realization(mesh.points, rows)
    except MeshError as error:
        raise Wrong(str(error)) from None


def check_whole(mesh: Triangulation) -> None:
    """Every point is used, and the convex hull is covered."""
    used = {v for triangle in mesh.triangles for v in triangle}
    hull = hull_edges(mesh.points)
    for a, b in missing_hull(mesh):
        raise Wrong(f"edge {say_edge(a, b)} of the convex hull is missing: the triangles must cover the hull")
    for v in range(len(mesh.points) if hull else 0):
        if v not in used:
            raise Wrong(f"point {v} is in no triangle")
    for a, b in sorted(mesh.apex):
        if (b, a) not in mesh.apex and (a, b) not in hull:
            raise Wrong(f"there is a hole beside edge {say_edge(a, b)}: no triangle lies on its other side")


def missing_hull(mesh: Triangulation) -> list[Edge]:
    """The edges of the convex hull that have no triangle beside them."""
    return [edge for edge in hull_edges(mesh.points) if edge not in mesh.apex]


def bad_edges(mesh: Triangulation, kept: Iterable[Edge] = ()) -> Iterable[tuple[int, int, int, int]]:
    """All (a, b, c, d) such that d, across edge ab, lies strictly inside the circle of triangle abc; ``kept`` edges aside."""
    kept = set(kept)
    for (a, b), c in sorted(mesh.apex.items()):
        d = mesh.apex.get((b, a))
        if d is not None and a < b and (a, b) not in kept and in_circle(*mesh.at(a, b, c, d)):
            yield a, b, c, d


def hull_edges(points: np.ndarray) -> list[Edge]:
    """The edges of the convex hull, counter-clockwise, between all points on it; none if all points lie on a line.

    Andrew's monotone chain (1979).

    >>> hull_edges(np.array([(0, 0), (2, 0), (1, 0), (1, 1.0)]))
    [(0, 2), (2, 1), (1, 3), (3, 0)]
    """
    places = points.tolist()
    order = sorted(range(len(places)), key=places.__getitem__)
    lower, upper = _chain(places, order), _chain(places, order[::-1])
    if lower == upper[::-1]:
        return []
    ring = lower[:-1] + upper[:-1]
    return list(zip(ring, ring[1:] + ring[:1], strict=True))


def _chain(places: Sequence[Any], order: Sequence[int]) -> list[int]:
    chain: list[int] = []
    for v in order:
        while len(chain) > 1 and orient(places[chain[-2]], places[chain[-1]], places[v]) < 0:
            chain.pop()
        chain.append(v)
    return chain


def edges_of(triangles: Iterable[Row]) -> set[Edge]:
    """The edges of triangles, the lower number first."""
    return {edge_of(u, v) for a, b, c in triangles for u, v in ((a, b), (b, c), (c, a))}


def edge_of(a: int, b: int) -> Edge:
    """An edge, the lower number first."""
    return (a, b) if a < b else (b, a)


def say_edge(a: int, b: int) -> str:
    """ "3-9" for the edge between 9 and 3."""
    return f"{min(a, b)}-{max(a, b)}"
