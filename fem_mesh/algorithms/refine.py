"""The verb: a mesh whose triangles keep bounds on their angles and sizes. And what it is asked, checked at the door."""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from fem_mesh.algorithms.constrained_delaunay import Driver, constrain, drained, triangulate
from fem_mesh.algorithms.refining.refiner import MOST_EVER, Bounds, Refiner
from fem_mesh.algorithms.refining.reopening import reopen
from fem_mesh.algorithms.refining.worklists import ADDED
from fem_mesh.algorithms.ruppert import FULL, POINT_WANTED, SIZES_WANTED, SPENT, refine_mesh
from fem_mesh.domain.domain import Domain
from fem_mesh.errors import MeshError
from fem_mesh.mesh.mesh import Mesh

STEEPEST = 60.0  # degrees: no triangle has a larger smallest angle
PATIENT = 8  # so many triangles may be expected for each point that kernel.run takes for small: this compiles long
ENCROACHMENTS, STEINER_POINTS = ("lens", "circle"), ("relocation", "offcenter", "circumcenter")


def refine(
    domain: Domain | Mesh,
    min_angle: float = 20.0,
    max_area: float | None = None,
    size: float | Callable[..., Any] | None = None,
    max_points: int | None = None,
    where: Any = None,
    encroachment: str = "lens",
    steiner: str = "relocation",
) -> Mesh:
    """A mesh of ``domain`` whose angles are all at least ``min_angle``, and which is as fine as you ask.

    domain : a Domain; or a Mesh, whose points and segments stay
    min_angle : in degrees; beyond some 33 it need not end before the budget; 0 asks for nothing
    max_area : the largest area of a triangle
    size : the longest edge: a number, or a function ``size(x, y)`` of arrays that returns an array. No edge of a
        triangle is then longer than ``size`` at its corners and its centroid
    max_points : how many points may be added; by default some times what the sizes need, and at least 100,000
    where : bool (m,), with a Mesh: only these triangles, and what replaces them, are asked to keep the bounds. What
        else has to change keeps ``min_angle``; all others stay as they are
    encroachment : a segment is split if a vertex lies inside its diametral "circle" (Ruppert), or "lens" (Chew)
    steiner : skinny triangles are mended by their "circumcenter", or by an "offcenter" on the way to it (Uengoer), or
        by "relocation": where no sizes are asked for, a vertex added before is moved if that helps (Erten, Uengoer)

    Always returns a mesh that can be used: ``mesh.refinement`` says whether it is complete, and what was left
    and why: angles below 60 degrees in the input cannot be mended. Runs ``ruppert``, compiled where that is worth it.

    Raises MeshError for bounds that make no sense, and as ``constrained_delaunay`` does.
    Sources: Ruppert 1995, Chew 1993, Miller, Pav and Walkington 2003, Uengoer 2004, Erten and Uengoer 2009.

    >>> import fem_mesh as fm
    >>> mesh = fm.refine(fm.Domain.from_loops([(0, 0), (3, 0), (3, 1), (0, 1)]), min_angle=30, size=0.5)
    >>> mesh.min_angle >= 30, mesh.refinement.complete
    (True, True)
    """
    refiner = begin_refinement(domain, as_bounds(min_angle, max_area, size, max_points, encroachment, steiner), where)
    for _ in refinement_events(refiner, drained):
        pass
    return refiner.finish()


def begin_refinement(domain: Any, bounds: Bounds, where: Any) -> Refiner:
    """The constrained Delaunay triangulation to be refined."""
    if isinstance(domain, Mesh):
        parts, chosen = reopen(domain, _as_mask(where, domain))
        given = domain.domain
    elif isinstance(domain, Domain):
        if where is not None:
            raise MeshError("where is a mask of triangles, and a Domain has none yet: give a Mesh, or a size function")
        parts, chosen, given = triangulate(domain), None, domain
        for _ in constrain(domain, parts, drained):
            pass
    else:
        raise MeshError(f"refine needs a Domain or a Mesh, not {type(domain).__name__}: Domain.from_loops(outline) makes one")
    curves = given.curves if isinstance(given, Domain) else {}
    regions = given.regions if isinstance(given, Domain) else ()
    return Refiner.of(parts, bounds, curves, chosen, regions, given)


def refinement_events(refiner: Refiner, drive: Driver) -> Iterator[tuple[int, int]]:
    """Refine to the end, by turns of the kernel and of what only Python can do; yields what ``drive`` hands on.

    Each turn adds points, of which there is a budget, or sizes triangles made since the turn before.
    """
    work = refiner.parts.work
    while True:
        last = (0, 0)
        size = max(refiner.expected // PATIENT, len(work.points))
        for last in drive(refine_mesh, refiner.state(), size, done=lambda: work.state.item(ADDED)):
            yield last
        if last[0] == FULL:
            refiner.grow()
        elif last[0] == SIZES_WANTED:
            refiner.size_triangles()
        elif last[0] == POINT_WANTED:
            refiner.split_on_curve()
        else:
            refiner.spent = last[0] == SPENT
            return


def as_bounds(
    min_angle: Any, max_area: Any, size: Any, max_points: Any, encroachment: str, steiner: str
) -> Bounds:  # fmt: skip
    """What a user asks of a refinement, checked."""
    angle = _as_number(min_angle, "min_angle")
    if not 0 <= angle < STEEPEST:
        raise MeshError(f"min_angle must be at least 0 and below 60 degrees, not {min_angle!r}: no triangle has more")
    if encroachment not in ENCROACHMENTS:
        raise MeshError(f'encroachment must be "lens" or "circle", not {encroachment!r}')
    if steiner not in STEINER_POINTS:
        raise MeshError(f'steiner must be "relocation", "offcenter" or "circumcenter", not {steiner!r}')
    whole = isinstance(max_points, int | np.integer) and not isinstance(max_points, bool)
    if max_points is not None and not (whole and max_points >= 0):
        raise MeshError(f"max_points must be a whole number, at least 0, not {max_points!r}")
    area = math.inf if max_area is None else _as_number(max_area, "max_area")
    edge = math.inf if size is None or callable(size) else _as_number(size, "size")
    for name, value in (("max_area", area), ("size", edge)):
        if not value > 0:
            raise MeshError(f"{name} must be greater than 0, not {value!r}")
    return Bounds(
        min_angle=angle, max_area=area, max_edge=edge, size=size if callable(size) else None,
        max_points=None if max_points is None else min(int(max_points), MOST_EVER),
        lens=encroachment == "lens", offcenter=steiner != "circumcenter", relocate=steiner == "relocation",
    )  # fmt: skip


def _as_number(value: Any, name: str) -> float:
    if isinstance(value, bool | np.bool_) or not isinstance(value, numbers.Real) or math.isnan(value):
        raise MeshError(f"{name} must be a number, not {value!r}")
    return float(value)


def _as_mask(where: Any, mesh: Mesh) -> np.ndarray | None:
    if where is None:
        return None
    mask = np.asarray(where)
    m = len(mesh.triangles)
    if mask.dtype != bool or mask.shape != (m,):
        raise MeshError(f"where must be a mask of the {m} triangles, bool ({m},), not {mask.dtype} {mask.shape}")
    return mask
