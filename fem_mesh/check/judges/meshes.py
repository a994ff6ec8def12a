"""A mesh given as arrays: valid, Delaunay, of good angles, and all of its domain, as far as each is asked for."""

from __future__ import annotations

import itertools
from collections import Counter
from typing import Any

import numpy as np

from fem_mesh.algorithms.constrained_delaunay import constrained_delaunay
from fem_mesh.check.pictures import beside, panel
from fem_mesh.check.reading import read_state
from fem_mesh.check.transcript import Run
from fem_mesh.check.triangulation import Edge, Triangulation, bad_edges, check_valid, check_whole, edge_of
from fem_mesh.check.verdict import Wrong
from fem_mesh.domain.domain import Domain
from fem_mesh.mesh.points import as_points
from fem_mesh.mesh.quality import angles

ROOM = 1e-9  # in degrees, and as a share of lengths


def mesh_case(delaunay: bool = True, min_angle: float | None = None, domain: Any = None, points: Any = None) -> dict[str, Any]:
    """What ``check.mesh`` asks for, as a case: plain JSON. ``points``, if given, are those that the mesh must have.

    ``domain`` is a Domain, or a pair (points, segments).

    >>> mesh_case(min_angle=20)
    {'name': 'mesh', 'delaunay': True, 'min_angle': 20.0, 'domain': None, 'points': None}
    """
    asked = None
    if domain is not None:
        domain = domain if isinstance(domain, Domain) else Domain(*domain)
        asked = {name: getattr(domain, name).tolist() for name in ("points", "segments", "holes")}
    fixed = None if points is None else as_points(points).tolist()
    bound = None if min_angle is None else float(min_angle)
    return {"name": "mesh", "delaunay": bool(delaunay), "min_angle": bound, "domain": asked, "points": fixed}


def judge_mesh(case: dict[str, Any], run: Run) -> None:
    """Climbs from cheap to dear: shape, numbers, valid, covering, Delaunay, angles."""
    run.finish()
    points, rows = read_state(run.returned, "gave")
    if case["points"] is not None and points.tolist() != case["points"]:
        raise Wrong("the points are not those that were to be meshed: keep them as they are, in their order")
    if not rows:
        raise Wrong("there are no triangles")
    mesh = Triangulation(points, rows)
    kept: set[Edge] = set()
    try:
        check_valid(mesh)
        if case["domain"] is not None:
            kept = check_domain(mesh, Domain(**case["domain"]))
        elif case["delaunay"]:
            check_whole(mesh)
    except Wrong as wrong:
        raise Wrong(wrong.message, wrong.picture or beside(points, panel("yours", mesh.triangles))) from None
    for a, b, c, d in bad_edges(mesh, kept) if case["delaunay"] else ():
        yours = panel("yours", mesh.triangles, wrong=[(a, b, c)], circles=[(a, b, c)], segments=kept, point=[d])
        rest = [t for t in mesh.triangles if not {a, b} <= set(t)]
        flipped = panel("after a flip", [*rest, (a, d, c), (d, b, c)], right_edges=[(c, d)], segments=kept)
        raise Wrong(f"the circle of triangle {(a, b, c)} holds point {d}: it is not Delaunay", beside(points, yours, flipped))
    if case["min_angle"] is not None:
        smallest = angles(points, np.array(mesh.triangles)).min(axis=1)
        worst = int(smallest.argmin())
        if smallest[worst] < case["min_angle"] - ROOM:
            yours = panel("yours", mesh.triangles, wrong=[mesh.triangles[worst]], segments=kept)
            raise Wrong(
                f"the smallest angle must be at least {case['min_angle']:g} degrees, "
                f"but that of triangle {mesh.triangles[worst]} is {smallest[worst]:.2f}",
                beside(points, yours),
            )


def check_domain(mesh: Triangulation, domain: Domain) -> set[Edge]:
    """Every segment is a chain of edges with as many triangles beside it as in the domain, and all else is filled.

    Returns the edges on segments.
    """
    beside_edge = Counter(edge_of(*edge) for edge in mesh.apex)
    used, kept = np.unique(np.array(mesh.triangles)), set()
    for (a, b), sides in zip(domain.segments.tolist(), sides_of_segments(domain), strict=True):
        p, q = domain.points[[a, b]]
        segment = f"the domain's segment from {_at(p)} to {_at(q)}"
        for u, v in itertools.pairwise(vertices_along(mesh.points, used, p, q, segment) if sides else ()):
            edge = edge_of(u, v)
            if edge not in beside_edge:
                raise not_covered(mesh, edge, f"{segment} is no chain of edges: {u}-{v} is missing")
            if beside_edge[edge] not in sides:
                found, wanted = ("both sides", "one") if beside_edge[edge] == 2 else ("one side only", "both")
                raise not_covered(
                    mesh, edge, f"edge {u}-{v} has triangles on {found}, but on {segment} the domain has {wanted}"
                )
            kept.add(edge)
    for u, v in sorted(edge for edge, triangles in beside_edge.items() if triangles == 1 and edge not in kept):
        raise not_covered(mesh, (u, v), f"one side of edge {u}-{v} has no triangle, and it lies on no segment of the domain")
    return kept


def not_covered(mesh: Triangulation, edge: Edge, message: str) -> Wrong:
    """What is wrong, and where."""
    return Wrong(message, beside(mesh.points, panel("yours", mesh.triangles, wrong_edges=[edge])))


def sides_of_segments(domain: Domain) -> list[set[int]]:
    """For each segment, on how many sides of its pieces the domain lies; nothing for a segment outside."""
    mesh = constrained_delaunay(domain)
    triangles = Counter(edge_of(t[i - 1], t[i]) for t in mesh.triangles.tolist() for i in range(3))
    sides: list[set[int]] = [set() for _ in domain.segments]
    for (a, b), row in zip(mesh.segments.tolist(), mesh.segment_of.tolist(), strict=True):
        sides[row].add(triangles[edge_of(a, b)])
    return sides


def vertices_along(points: np.ndarray, used: np.ndarray, p: np.ndarray, q: np.ndarray, segment: str) -> list[int]:
    """The vertices from p to q, in their order. Raises Wrong where an end is none."""
    to, along = points[used] - p, q - p
    square = float((along**2).sum())
    share = to @ along / square
    off = np.abs(to[:, 0] * along[1] - to[:, 1] * along[0]) / square
    on = (off <= ROOM) & (share >= -ROOM) & (share <= 1 + ROOM)
    if share[on].min(initial=1) > ROOM or share[on].max(initial=0) < 1 - ROOM:
        raise Wrong(f"an end of {segment} is no vertex of the mesh")
    chain: list[int] = used[on][share[on].argsort(kind="stable")].tolist()
    return chain


def _at(p: np.ndarray) -> str:
    return f"({p[0]:.6g}, {p[1]:.6g})"
