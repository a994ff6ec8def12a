"""The model problem of lessons 06 and 07: -Laplace u = f inside, u = g on the boundary, by scikit-fem.

Elements of degree 1 or 2, a residual estimator of the error, the error itself where the solution is known,
and a solution with a singularity: that of the L-shape at its inner corner.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.mesh.mesh import Mesh

Function = float | Callable[..., Any]
SINGULAR = 2 / 3  # the power of r at a corner of 270 degrees
FINE = 16  # degree up to which the error is integrated exactly: at the L-shape's corner, it is found to 0.3 % with that
AT_ONCE = 20_000  # triangles on which it is integrated together: some 200 MB


def basis(mesh: Mesh, degree: int = 1) -> Any:
    """scikit-fem's ``Basis`` of the continuous piecewise polynomials of ``degree`` 1 or 2 on ``mesh``.

    Its unknowns are the values at the used points of the mesh, in their order; for degree 2, then those at the
    middles of edges.

    >>> import fem_mesh as fm
    >>> mesh = fm.constrained_delaunay(fm.square())
    >>> int(basis(mesh).N), int(basis(mesh, degree=2).N)
    (4, 9)
    """
    import skfem

    if degree not in (1, 2):
        raise MeshError(f"degree must be 1 or 2, not {degree!r}")
    if not len(mesh.triangles):
        raise MeshError(f"there is nothing to solve on: {mesh.note or 'the mesh has no triangles'}")
    element = skfem.ElementTriP1() if degree == 1 else skfem.ElementTriP2()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that unused points are left out is said above
        return skfem.Basis(mesh.to_skfem(), element)


def solve(mesh: Mesh, f: Function = 0.0, g: Function = 0.0, degree: int = 1) -> np.ndarray:
    """The finite element solution of -Laplace u = f in the mesh, u = g on its whole boundary: float64.

    f, g : numbers, or functions of arrays x, y that return an array
    degree : of the polynomials. With 1 the values at the points of the mesh come back, (n,): nan at those in no
        triangle, but for duplicates. With 2 all unknowns of ``basis(mesh, 2)``

    >>> import fem_mesh as fm
    >>> mesh = fm.refine(fm.l_shape(), max_area=0.002)
    >>> u = solve(mesh, g=corner_solution)
    >>> bool(abs(u - corner_solution(*mesh.points.T)).max() < 0.02)
    True
    """
    import skfem
    from skfem.models.poisson import laplace

    space = basis(mesh, degree)
    x, y = space.global_coordinates()
    load = skfem.LinearForm(lambda v, w: w.f * v).assemble(space, f=evaluate(f, x, y, "f"))
    boundary = space.get_dofs().all()
    values = space.zeros()
    x, y = space.doflocs[:, boundary]
    values[boundary] = evaluate(g, x, y, "g")
    values = skfem.solve(*skfem.condense(laplace.assemble(space), load, x=values, D=boundary))
    return _to_points(mesh, values) if degree == 1 else values


def indicators(mesh: Mesh, u: Any, f: Function = 0.0, degree: int = 1) -> np.ndarray:
    """How much each triangle T adds to the error of ``u``, from its residual: float64 (m,).

    The square of each is h_T^2 |f + Laplace u|^2 over T, and half of h_E |[du/dn]|^2 over each inner edge E: how far
    the equation fails inside, and how far the normal derivative jumps. The root of their sum bounds the energy error
    from above and below, up to constants of the smallest angle. Source: Babuska and Rheinboldt 1978, Verfuerth 1996.

    >>> import fem_mesh as fm
    >>> mesh = fm.refine(fm.square(), max_area=0.1)
    >>> bool(indicators(mesh, solve(mesh, g=lambda x, y: x + 2 * y)).max() < 1e-12)
    True
    """
    import skfem
    from skfem.helpers import dot, grad

    space = basis(mesh, degree)
    values = _to_unknowns(mesh, u, space, degree)
    x, y = space.global_coordinates()
    inside = skfem.Functional(lambda w: (w.f + w.laplacian) ** 2).elemental(
        space, f=evaluate(f, x, y, "f"), laplacian=_laplacian(space, values, degree)[:, None] + 0 * x
    )
    corners = mesh.points[mesh.triangles]
    longest = np.square(corners - np.roll(corners, 1, axis=1)).sum(axis=2).max(axis=1)
    sides = [skfem.InteriorFacetBasis(space.mesh, space.elem, side=side) for side in (0, 1)]
    left, right = (side.interpolate(values) for side in sides)
    jumps = skfem.Functional(lambda w: w.h * (dot(grad(w.left), w.n) - dot(grad(w.right), w.n)) ** 2)
    jump = jumps.elemental(sides[0], left=left, right=right)
    result = longest * inside
    for side in (0, 1):
        np.add.at(result, space.mesh.f2t[side, sides[0].find], jump / 2)
    return np.asarray(np.sqrt(result))


def energy_error(mesh: Mesh, u: Any, gradient: Callable[..., Any], degree: int = 1) -> float:
    """The root of the integral of |grad u - gradient|^2: how far ``u`` is from a solution whose gradient is known.

    gradient : a function of arrays x, y that returns the two arrays du/dx, du/dy

    >>> import fem_mesh as fm
    >>> mesh = fm.refine(fm.square(), max_area=0.1)
    >>> u = solve(mesh, f=-2.0, g=lambda x, y: x * x, degree=2)
    >>> bool(energy_error(mesh, u, lambda x, y: (2 * x, 0 * x), degree=2) < 1e-12)
    True
    """
    import skfem

    space = basis(mesh, degree)
    values, total = _to_unknowns(mesh, u, space, degree), 0.0
    for some in np.array_split(np.arange(space.nelems), -(-space.nelems // AT_ONCE)):
        part = skfem.Basis(space.mesh, space.elem, intorder=FINE, elements=some, dofs=space.dofs)
        found = part.interpolate(values).grad
        gx, gy = gradient(*map(np.asarray, part.global_coordinates()))
        total += float((((found[0] - gx) ** 2 + (found[1] - gy) ** 2) * part.dx).sum())
    return math.sqrt(total)


# ---- the L-shape ---------------------------------------------------------------------------------------


def corner_solution(x: Any, y: Any) -> Any:
    """r^(2/3) sin(2 t / 3), t from 0 to 270 degrees: harmonic, and 0 on both edges at the inner corner of ``fm.l_shape()``.

    >>> [round(float(corner_solution(x, y)), 6) for x, y in [(1, 0), (0, -1), (-1, 1)]]
    [0.0, 0.0, 1.259921]
    """
    r, t = _polar(x, y)
    return r**SINGULAR * np.sin(SINGULAR * t)


def corner_gradient(x: Any, y: Any) -> tuple[Any, Any]:
    """The derivatives of ``corner_solution``. Infinite at the corner itself.

    >>> [round(float(g), 6) for g in corner_gradient(1.0, 0.0)]
    [0.0, 0.666667]
    """
    r, t = _polar(x, y)
    size = SINGULAR * r ** (SINGULAR - 1)
    return size * np.sin(SINGULAR * t - t), size * np.cos(t - SINGULAR * t)


def _polar(x: Any, y: Any) -> tuple[Any, Any]:
    return np.hypot(x, y), np.mod(np.arctan2(y, x), 2 * np.pi)


# ---- between a mesh and scikit-fem ---------------------------------------------------------------------


def evaluate(function: Function, x: Any, y: Any, name: str) -> np.ndarray:
    """``function``, or the number it is, at the places x, y. Raises MeshError where that is no finite number for each."""
    x, y = np.asarray(x), np.asarray(y)
    values = np.asarray(function(x.copy(), y.copy()) if callable(function) else function)
    if values.dtype.kind not in "fiu" or values.shape not in ((), x.shape):
        raise MeshError(
            f"{name}(x, y) must return one number for each place in x, of shape {x.shape}, not {values.dtype} of shape "
            f"{values.shape}: write it for arrays, with np.hypot, np.where, ..."
        )
    values = np.broadcast_to(values, x.shape).astype(np.float64)
    for i in np.flatnonzero(~np.isfinite(values.ravel()))[:1]:
        raise MeshError(f"{name}({x.ravel()[i]:.6g}, {y.ravel()[i]:.6g}) is {values.ravel()[i]}, which is no finite number")
    return values


def _used(mesh: Mesh) -> np.ndarray:
    """Whether each point is a corner of a triangle: those are scikit-fem's, in their order."""
    used = np.ones(len(mesh.points), bool)
    used[mesh.unused] = False
    return used


def _to_points(mesh: Mesh, values: np.ndarray) -> np.ndarray:
    result = np.full(len(mesh.points), np.nan)
    result[_used(mesh)] = values
    return np.asarray(result[mesh.merged_into])


def _to_unknowns(mesh: Mesh, u: Any, space: Any, degree: int) -> np.ndarray:
    """``u`` as ``solve`` returns it, as scikit-fem wants it."""
    u = np.asarray(u, np.float64)
    n = len(mesh.points) if degree == 1 else space.N
    if u.shape != (n,):
        raise MeshError(f"u must be what solve(mesh, degree={degree}) returns, shape ({n},), not {u.shape}")
    return np.asarray(u[_used(mesh)] if degree == 1 else u)


def _laplacian(space: Any, values: np.ndarray, degree: int) -> np.ndarray:
    """The Laplacian of a piecewise polynomial in each triangle, where it is constant: the sum of its second differences."""
    if degree == 1:
        return np.zeros(space.nelems)
    import skfem

    corners = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    at_corners = skfem.Basis(space.mesh, space.elem, quadrature=(corners, np.full(3, 1 / 6))).interpolate(values).grad
    linear = skfem.Basis(space.mesh, skfem.ElementTriP1(), quadrature=(corners, np.full(3, 1 / 6)))
    slopes = [field[0].grad for field in linear.basis]  # of the three barycentric coordinates
    return np.asarray(
        sum(slopes[k][0, :, 0] * at_corners[0, :, k] + slopes[k][1, :, 0] * at_corners[1, :, k] for k in range(3))
    )
