"""Smoothing: vertices move to better places, and flips keep the mesh Delaunay; Chen 2004, Alliez et al. 2005.

    in each sweep:
        move each vertex that is free to the mean of the circumcentres of the triangles around it ("odt"), or of
            their centroids ("centroid"), each with the weight of its triangle's area
        flip edges until the mesh is (constrained) Delaunay again

Lift every point (x, y) to the height x^2 + y^2. The mean of the circumcentres is where the surface through the lifted
points comes closest to the paraboloid, if all other vertices stay; and of all triangulations of these points the
Delaunay one comes closest. So moves and flips lower the same volume: optimal Delaunay triangulations, ODT.
Where small triangles are wanted each weighs more, and vertices move there.

No move turns a triangle over, by exact signs, or makes one worse than is allowed: it is halved until it does not, or
left out. The boundary and all segments stay. It ends after so many sweeps, or when all moves are small.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from typing import Any

import numpy as np

from fem_mesh.algorithms.refine import as_bounds
from fem_mesh.algorithms.refining.encroachment import in_range
from fem_mesh.algorithms.refining.refiner import evaluate_size, ghosts_of
from fem_mesh.algorithms.refining.reopening import reopen
from fem_mesh.algorithms.smoothing.stars import find_mean, is_inside_star, worst_of_star
from fem_mesh.errors import MeshError
from fem_mesh.kernel import SETTLED, call, index, kernel, run
from fem_mesh.mesh.constrained import flip_beside_segments, is_illegal
from fem_mesh.mesh.halfedge import is_ghost_triangle, prev_edge
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.segmented import Segmented
from fem_mesh.mesh.workspace import COUNT, FLIPPED
from fem_mesh.steps import Step, counted

METHODS = ("odt", "centroid")
MOVED, FLIP = SETTLED + 1, SETTLED + 2
FIXED = -1  # in place of a half-edge: the vertex stays
HALVINGS = 6  # of a move, before it is left out
STILL = 2.0**-10  # of its star's width: when no vertex has moved farther, it is over

# What `state` holds besides: where the sweep is
VERTEX = 12  # the next vertex to move
EDGE = 13  # the next half-edge to test
FLIPPED_BEFORE = 14  # flips, when this pass over the edges began
ODT = 15  # 1 if that is the method
MOVES = 16  # in this sweep

# What `measures` holds
FARTHEST = 0  # the longest move of this sweep: its square, over the area of its star
COSINE = 1  # squared, of the smallest angle that a move may make


@kernel
def sweep(xy, origin, twin, segment, edge_of, leaving, weight, measures, state):
    while state[VERTEX] < len(xy):
        v = index(state[VERTEX])
        state[VERTEX] += 1
        if leaving[v] != FIXED and move_vertex(index(leaving[v]), xy, origin, twin, weight, measures, state):
            state[MOVES] += 1
            yield MOVED, v
    while state[EDGE] < 3 * state[COUNT] or state[FLIPPED_BEFORE] < state[FLIPPED]:  # each pass but the last has flips
        if state[EDGE] == 3 * state[COUNT]:
            state[EDGE], state[FLIPPED_BEFORE] = 0, state[FLIPPED]
        h = index(state[EDGE])
        state[EDGE] += 1
        if h < twin[h] and is_illegal(h, xy, origin, twin, segment):
            flip_beside_segments(h, origin, twin, segment, edge_of)
            state[FLIPPED] += 1
            yield FLIP, prev_edge(h)


@kernel
def move_vertex(h, xy, origin, twin, weight, measures, state):
    """Move the vertex that ``h`` leaves towards the mean of its star, as far as that may be; whether it did.

    Beside a coarse boundary circumcentres may lie so far out that no part of the way is free: then the centroids.
    """
    v = origin[h]
    worst = max(worst_of_star(h, xy[v, 0], xy[v, 1], xy, origin, twin), measures[COSINE])
    for k in range(state[ODT], -1, -1):
        x, y, area = find_mean(h, xy, origin, twin, weight, k == 1)
        dx, dy = x - xy[v, 0], y - xy[v, 1]
        for _ in range(HALVINGS):
            x, y = in_range(xy[v, 0] + dx), in_range(xy[v, 1] + dy)
            if x == xy[v, 0] and y == xy[v, 1]:
                return False
            if is_inside_star(h, x, y, xy, origin, twin) and worst_of_star(h, x, y, xy, origin, twin) <= worst:
                xy[v, 0], xy[v, 1] = x, y
                measures[FARTHEST] = max(measures[FARTHEST], (dx * dx + dy * dy) / area)
                return True
            dx, dy = 0.5 * dx, 0.5 * dy
    return False


@kernel
def list_free(count, origin, segment, leaving):
    """A half-edge that leaves each vertex inside the mesh and on no segment; for all others FIXED."""
    for v in range(len(leaving)):
        leaving[v] = FIXED
    for i in range(3 * count):
        if not is_ghost_triangle(index(i), origin):
            leaving[origin[i]] = i
    for i in range(3 * count):
        if segment[i] != 0:
            leaving[origin[i]] = FIXED


# ---- sweep by sweep ----------------------------------------------------------------------------------


def smooth(
    mesh: Mesh,
    size: float | Callable[..., Any] | None = None,
    *,
    sweeps: int = 10,
    method: str = "odt",
    min_angle: float = 20.0,
) -> Generator[Step, None, Mesh]:
    """Move the inner vertices of ``mesh`` to better places, and flip edges, sweep by sweep: yields each; returns the Mesh.

    size : the edge length wanted, a function ``size(x, y)`` of arrays that returns an array: vertices move to where it
        is small. Only its proportions count, so a number changes nothing. None: triangles of one size
    sweeps : at most so many; it ends before if no vertex moves by more than a thousandth of what is around it
    method : "odt", or "centroid", which is the gentler beside a coarse boundary
    min_angle : in degrees: no move makes a smaller angle than this, or than the smallest that its triangles had

    The boundary, all segments, and borders between regions stay as they are; all other points move, those that you
    gave too, and keep their numbers. The mesh stays constrained Delaunay, or becomes it. After "start" come steps
    "sweep" and at last "done". Their ``facts``: mesh, sweep, min_angle, mean_angle, the mean of the triangles' smallest
    angles; from "sweep" on moves, flips, and farthest, the longest move over the root of the area around it.

    Raises MeshError for anything but a valid Mesh. Sources: Chen 2004, Alliez et al. 2005, Chen and Holst 2011.

    >>> import fem_mesh as fm
    >>> mesh = fm.delaunay([*fm.grid_points(5), *(4 * fm.random_points(20, seed=2))])
    >>> for step in fm.smooth(mesh, sweeps=2):
    ...     print(step.kind, "-", step.caption)
    start - 29 of 45 points are free to move; smallest angle 10.1 degrees, the triangles' mean 35.2
    sweep - sweep 1: 28 points move, 5 edges are flipped; smallest angle 17.6 degrees, the triangles' mean 43.7
    sweep - sweep 2: 29 points move, 0 edges are flipped; smallest angle 21.6 degrees, the triangles' mean 44.3
    done - after 2 sweeps: smallest angle 21.6 degrees (was 10.1), the triangles' mean 44.3 (was 35.2)
    """
    if not isinstance(mesh, Mesh):
        raise MeshError(f"smooth needs a Mesh, not {type(mesh).__name__}: refine(domain) makes one of a Domain")
    if method not in METHODS:
        raise MeshError(f'method must be "odt" or "centroid", not {method!r}')
    if isinstance(sweeps, bool) or not isinstance(sweeps, int | np.integer) or sweeps < 1:
        raise MeshError(f"sweeps must be a whole number, at least 1, not {sweeps!r}")
    bounds = as_bounds(min_angle, None, size, None, "lens", "relocation")
    if not len(mesh.triangles):
        raise MeshError(f"there is nothing to smooth: {mesh.note or 'the mesh has no triangles'}")
    return _sweeps(mesh, reopen(mesh)[0], bounds.size, int(sweeps), method, bounds.min_angle)


def _sweeps(
    mesh: Mesh, parts: Segmented, size: Callable[..., Any] | None, sweeps: int, method: str, min_angle: float
) -> Generator[Step, None, Mesh]:
    work = parts.work
    leaving, measures = np.empty(len(work.xy), np.int64), np.zeros(2)
    call(list_free, parts.count, work.origin, parts.segment, leaving, size=len(leaving))
    free, flips = int((leaving != FIXED).sum()), 0
    facts: dict[str, Any] = {"sweep": 0, "mesh": mesh, **_angles(mesh)}
    first = facts
    shown = {"points": mesh.points, "triangles": mesh.triangles, "new_segments": mesh.segments.tolist()}
    yield Step(
        "start", say_start, **shown, free=free, points_in_all=len(mesh.points) - len(mesh.unused), makes_points=True, **facts
    )
    work.state[ODT] = method == "odt"
    measures[COSINE] = math.cos(math.radians(min_angle)) ** 2
    for k in range(1, sweeps + 1):
        call(list_free, parts.count, work.origin, parts.segment, leaving, size=len(leaving))
        work.state[VERTEX], work.state[EDGE], work.state[MOVES] = 1, 0, 0
        work.state[FLIPPED_BEFORE], measures[FARTHEST] = work.state[FLIPPED], 0.0
        arrays = (work.xy, work.origin, work.twin, parts.segment, parts.edge_of)
        run(sweep, (*arrays, leaving, _weights(parts, size), measures, work.state), len(leaving))
        mesh = _moved(mesh, parts)
        facts = {
            "sweep": k, "mesh": mesh, "moves": int(work.state[MOVES]), "flips": int(work.state[FLIPPED]) - flips,
            "farthest": math.sqrt(measures[FARTHEST]), **_angles(mesh),
        }  # fmt: skip
        flips += facts["flips"]
        yield Step("sweep", say_sweep, points=mesh.points, triangles=mesh.triangles, **facts)
        if facts["farthest"] <= STILL:
            break
    yield Step("done", say_done, first=first, **facts)
    return mesh


def _weights(parts: Segmented, size: Callable[..., Any] | None) -> np.ndarray:
    """How much the area of each triangle counts: 1 / size^4 at its centroid, up to a factor.

    With that density centroidal Voronoi cells come out as wide as ``size``, in proportion (Du and Wang 2003).
    """
    weight = np.ones(parts.count)
    if size is not None:
        real = ~ghosts_of(parts.work.origin, parts.count)
        corners = parts.work.xy[parts.work.origin[: 3 * parts.count].reshape(-1, 3)[real]]
        sizes = evaluate_size(size, corners.mean(axis=1))
        if sizes.min() < np.inf:
            weight[real] = np.square(np.square(sizes.min() / sizes))
    return weight


def _moved(mesh: Mesh, parts: Segmented) -> Mesh:
    """``mesh`` as it stands in the arrays now: only points and triangles differ, in their places."""
    work, m = parts.work, len(mesh.triangles)
    across = (work.twin[: 3 * m].reshape(-1, 3)[:, [1, 2, 0]] // 3).astype(np.int32)
    return Mesh._of(
        work.xy[1:][mesh.merged_into], work.origin[: 3 * m].reshape(-1, 3).astype(np.int32) - 1,
        np.where(across < m, across, -1).astype(np.int32), segments=mesh.segments, segment_of=mesh.segment_of,
        merged_into=mesh.merged_into, regions=mesh.regions, boundaries=mesh.boundaries, region_names=mesh.region_names,
        domain=mesh.domain, note=mesh.note,
    )  # fmt: skip


def _angles(mesh: Mesh) -> dict[str, float]:
    smallest = mesh.angles().min(axis=1)
    return {"min_angle": float(smallest.min()), "mean_angle": float(smallest.mean())}


# ---- captions ----------------------------------------------------------------------------------------


def say_start(step: Step) -> str:
    free, n = step.facts["free"], step.facts["points_in_all"]
    return f"{free:,} of {counted(n, 'point')} {'is' if free == 1 else 'are'} free to move; {say_angles(step.facts)}"


def say_sweep(step: Step) -> str:
    facts = step.facts
    moves = f"{counted(facts['moves'], 'point')} move{'s' * (facts['moves'] == 1)}"
    flips = f"{counted(facts['flips'], 'edge')} {'is' if facts['flips'] == 1 else 'are'} flipped"
    return f"sweep {facts['sweep']}: {moves}, {flips}; {say_angles(facts)}"


def say_done(step: Step) -> str:
    facts, first = step.facts, step.facts["first"]
    smallest, mean = (f"{facts[key]:.1f}{{}} (was {first[key]:.1f})" for key in ("min_angle", "mean_angle"))
    sweeps = counted(facts["sweep"], "sweep")
    return f"after {sweeps}: smallest angle {smallest.format(' degrees')}, the triangles' mean {mean.format('')}"


def say_angles(facts: dict[str, Any]) -> str:
    return f"smallest angle {facts['min_angle']:.1f} degrees, the triangles' mean {facts['mean_angle']:.1f}"
