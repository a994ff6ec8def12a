"""Adaptive meshes: solve, estimate, mark, refine; Doerfler 1996.

    while the mesh is small enough:
        solve the problem on the mesh
        estimate how much each triangle adds to the error
        mark the fewest triangles that hold a given part of its square
        refine these to half their area

A corner, a layer, a front draws the points to itself. At the L-shape's inner corner the energy error of linear elements
falls as N^(-1/2) with N unknowns, as it does for smooth solutions, where equal triangles get N^(-1/3) (proved for
bisections: Stevenson 2007). ``ruppert`` refines: the points stay, and all angles keep their bound.

Each round adds points or is the last, and no round begins with more unknowns than allowed: so it ends.
"""

from __future__ import annotations

import numbers
from collections.abc import Callable, Generator
from typing import Any

import numpy as np

from fem_mesh.algorithms.refine import refine
from fem_mesh.domain.domain import Domain
from fem_mesh.errors import MeshError
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.points import as_numbers
from fem_mesh.steps import Step, counted

FINER = 0.5**0.5  # times its longest edge is wanted where a triangle is marked: half the area
COARSEST = 0.25  # of the domain's extent: the longest edge of the first mesh


def adapt(
    domain: Domain | Mesh,
    solve: Callable[[Mesh], Any],
    estimate: Callable[[Mesh, Any], Any],
    *,
    theta: float = 0.5,
    min_angle: float = 30.0,
    max_unknowns: int = 10_000,
    rounds: int | None = None,
    coarsest: float | Callable[..., Any] | None = None,
) -> Generator[Step, None, Mesh]:
    """Refine a mesh where a solution on it needs it, round by round: yields what each does; returns the last Mesh.

    domain : a Domain; or a Mesh to begin with
    solve : ``solve(mesh)`` returns a solution, anything; where it is an array, its length counts as the unknowns
    estimate : ``estimate(mesh, solution)`` returns an indicator >= 0 for each triangle, (m,), of what it adds to the error
    theta : the part of the squared error that the marked triangles are to hold: 1 marks all that have any
    min_angle : in degrees, which all triangles keep, see ``refine``
    max_unknowns : the first mesh that has so many is the last
    rounds : at most so many
    coarsest : the size of the first mesh, as ``refine`` takes it; a quarter of the domain's extent by default

    After "start" each round has the steps "solve", "estimate", "mark", which shows what is marked as about to go, and
    "refine". Their ``facts``: round, mesh, unknowns, elements (how many triangles), min_angle; after "solve" solution;
    after "estimate" indicators, and error, the root of the sum of their squares; in "mark" marked, how many. The
    last step, "done", has those of the last mesh.

    Raises MeshError as ``refine`` does, and for indicators that are none. What ``solve`` and ``estimate`` raise passes
    through, with a note. Sources: Babuska and Rheinboldt 1978, Doerfler 1996.

    >>> import fem_mesh as fm
    >>> from fem_mesh import poisson
    >>> def solve(mesh):
    ...     return poisson.solve(mesh, g=poisson.corner_solution)
    >>> for step in fm.adapt(fm.l_shape(), solve, poisson.indicators, rounds=2):
    ...     print(step.kind, "-", step.caption)
    start - the first mesh: 52 triangles on 36 points, smallest angle 34.3 degrees
    solve - round 1: solved for 36 unknowns on 52 triangles
    estimate - round 1: 36 unknowns, error estimate 0.683
    mark - round 1: 2 of 52 triangles hold 54 % of the squared error
    refine - round 1: 3 points come; 58 triangles, smallest angle 30.5 degrees
    solve - round 2: solved for 39 unknowns on 58 triangles
    estimate - round 2: 39 unknowns, error estimate 0.574
    done - after 2 rounds: 39 unknowns, error estimate 0.574; in round 1 it was 0.683 with 36
    """
    theta, limit = _as_part(theta), _as_count(max_unknowns, "max_unknowns")
    most = None if rounds is None else _as_count(rounds, "rounds")
    for name, callback in (("solve", solve), ("estimate", estimate)):
        if not callable(callback):
            raise MeshError(f"{name} must be a function, not {callback!r:.80}")
    if coarsest is None and isinstance(domain, Domain):
        coarsest = COARSEST * float(np.ptp(domain.points, axis=0).max()) or None
    mesh = refine(domain, min_angle, size=coarsest)
    if not len(mesh.triangles):
        raise MeshError(f"there is nothing to adapt: {mesh.note or 'the mesh has no triangles'}")
    return _rounds(mesh, solve, estimate, theta, min_angle, limit, most)


def mark(indicators: Any, theta: float = 0.5) -> np.ndarray:
    """The smallest set of triangles that holds the part ``theta`` of the squared error: bool (m,).

    indicators : (m,) numbers >= 0. Of equal ones the first are taken

    Raises MeshError for others, and for theta outside 0 < theta <= 1. Source: Doerfler 1996.

    >>> mark([1.0, 3.0, 2.0, 0.0], theta=0.8).tolist()
    [False, True, True, False]
    """
    theta = _as_part(theta)
    eta = as_numbers(indicators, "indicators")
    if eta.ndim != 1:
        raise MeshError(f"indicators must be one number for each triangle, shape (m,), not {eta.shape}")
    _check_indicators(eta)
    marked = np.zeros(len(eta), bool)
    if eta.any():
        order = np.argsort(-eta, kind="stable")
        held = np.cumsum(np.square(eta[order] / eta.max()))
        marked[order[: np.searchsorted(held, theta * held[-1]) + 1]] = True
    return marked


def _rounds(
    mesh: Mesh, solve: Callable[[Mesh], Any], estimate: Callable[[Mesh, Any], Any], theta: float, min_angle: float,
    limit: int, most: int | None,
) -> Generator[Step, None, Mesh]:  # fmt: skip
    facts = _facts(mesh, 0)
    first: dict[str, Any] = {}
    yield Step("start", say_start, **_frame(mesh, None), makes_points=True, **facts)
    while True:  # each turn adds points, of which there are at most `limit`, or is the last
        facts = _facts(mesh, facts["round"] + 1)
        solution = _called("solve", solve, facts, mesh)
        facts |= {"solution": solution, "unknowns": _unknowns(mesh, solution)}
        yield Step("solve", say_solve, **facts)
        indicators = _as_indicators(_called("estimate", estimate, facts, mesh, solution), mesh)
        facts |= {"indicators": indicators, "error": float(np.linalg.norm(indicators))}
        first = first or facts
        yield Step("estimate", say_estimate, **facts)
        if facts["error"] == 0 or facts["unknowns"] >= limit or facts["round"] == most:
            break
        marked = mark(indicators, theta)
        facts = facts | {"marked": int(marked.sum())}
        yield Step("mark", say_mark, doomed=mesh.triangles[marked], **facts)
        finer = refine_marked(mesh, marked, min_angle)
        added = len(finer.points) - len(mesh.points)
        if not added:  # where numbers have no room for smaller triangles
            break
        frame = _frame(finer, mesh)
        mesh = finer
        yield Step("refine", say_refine, **frame, added_points=added, **_facts(mesh, facts["round"]))
    yield Step("done", say_done, first=first, **facts)
    return mesh


def refine_marked(mesh: Mesh, marked: np.ndarray, min_angle: float = 30.0) -> Mesh:
    """A mesh in which the ``marked`` triangles are replaced by some of about half their area."""
    corners = mesh.points[mesh.triangles]
    longest = np.sqrt(np.square(corners - np.roll(corners, 1, axis=1)).sum(axis=2).max(axis=1))
    wanted = np.append(np.where(marked, FINER * longest, np.inf), np.inf)  # the last for -1: outside, behind a chord

    def size(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.asarray(wanted[mesh.find(x, y)])

    return refine(mesh, min_angle, size=size, where=marked)


# ---- what the steps tell -----------------------------------------------------------------------------


def _facts(mesh: Mesh, k: int) -> dict[str, Any]:
    return {
        "round": k, "mesh": mesh, "unknowns": len(mesh.points) - len(mesh.unused), "elements": len(mesh.triangles),
        "min_angle": mesh.min_angle,
    }  # fmt: skip


def _frame(mesh: Mesh, before: Mesh | None) -> dict[str, Any]:
    """What a step shows of ``mesh``: all of it, of which a trace keeps what changed; of its segments, what changed."""
    now, then = _edges(mesh), _edges(before) if before else set()
    segments = {"new_segments": sorted(now - then), "gone_segments": sorted(then - now)}
    return {"points": mesh.points, "triangles": mesh.triangles, **segments}


def _edges(mesh: Mesh) -> set[tuple[int, int]]:
    return set(map(tuple, np.sort(mesh.segments, axis=1).tolist()))


def _unknowns(mesh: Mesh, solution: Any) -> int:
    """Those of the solution; never fewer than points, since these are to come to an end."""
    points = len(mesh.points) - len(mesh.unused)
    return max(points, len(solution)) if isinstance(solution, np.ndarray) and solution.ndim else points


def _called(name: str, callback: Callable[..., Any], facts: dict[str, Any], *arguments: Any) -> Any:
    """What a user's function returns. What it raises says afterwards which it was, and on which mesh."""
    try:
        return callback(*arguments)
    except Exception as error:
        given = "mesh" if len(arguments) == 1 else "mesh, solution"
        error.add_note(f"raised by {name}({given}) in round {facts['round']} of adapt, on {facts['mesh']!r}")
        raise


# ---- what is asked, checked --------------------------------------------------------------------------


def _as_indicators(given: Any, mesh: Mesh) -> np.ndarray:
    m = len(mesh.triangles)
    try:
        eta = as_numbers(given, "indicators")
        if eta.shape != (m,):
            raise MeshError(f"indicators must be one number for each of the {m} triangles, shape ({m},), not {eta.shape}")
        _check_indicators(eta)
    except MeshError as error:
        raise MeshError(f"estimate(mesh, solution): {error}") from None
    return eta


def _check_indicators(eta: np.ndarray) -> None:
    for t in np.flatnonzero(~((eta >= 0) & (eta < np.inf)))[:1]:
        raise MeshError(f"the indicator of triangle {t} is {eta[t]}: it must be finite, and at least 0")


def _as_part(theta: Any) -> float:
    if isinstance(theta, bool) or not isinstance(theta, numbers.Real) or not 0 < float(theta) <= 1:
        raise MeshError(f"theta must be a part of the error, 0 < theta <= 1, not {theta!r}")
    return float(theta)


def _as_count(n: Any, name: str) -> int:
    if isinstance(n, bool) or not isinstance(n, int | np.integer) or n < 1:
        raise MeshError(f"{name} must be a whole number, at least 1, not {n!r}")
    return int(n)


# ---- captions ----------------------------------------------------------------------------------------


def say_start(step: Step) -> str:
    n, m, angle = step.facts["unknowns"], step.facts["elements"], step.facts["min_angle"]
    return f"the first mesh: {counted(m, 'triangle')} on {counted(n, 'point')}, smallest angle {angle:.1f} degrees"


def say_solve(step: Step) -> str:
    k, unknowns, m = (step.facts[key] for key in ("round", "unknowns", "elements"))
    return f"round {k}: solved for {counted(unknowns, 'unknown')} on {counted(m, 'triangle')}"


def say_estimate(step: Step) -> str:
    facts = step.facts
    return f"round {facts['round']}: {counted(facts['unknowns'], 'unknown')}, error estimate {facts['error']:.3g}"


def say_mark(step: Step) -> str:
    k, m, error, marked = (step.facts[key] for key in ("round", "elements", "error", "marked"))
    held = np.sort(step.facts["indicators"])[::-1][:marked] / error
    part = 100 * float(np.square(held).sum())
    return f"round {k}: {marked:,} of {counted(m, 'triangle')} hold{'s' * (marked == 1)} {part:.0f} % of the squared error"


def say_refine(step: Step) -> str:
    facts = step.facts
    here = f"{counted(facts['elements'], 'triangle')}, smallest angle {facts['min_angle']:.1f} degrees"
    return f"round {facts['round']}: {counted(facts['added_points'], 'point')} come; {here}"


def say_done(step: Step) -> str:
    facts, first = step.facts, step.facts["first"]
    now = f"{counted(facts['unknowns'], 'unknown')}, error estimate {facts['error']:.3g}"
    before = f"; in round 1 it was {first['error']:.3g} with {first['unknowns']:,}" if facts["round"] > 1 else ""
    stuck = "; what is marked has no room for smaller triangles" if "marked" in facts else ""
    return f"after {counted(facts['round'], 'round')}: {now}{before}{stuck}"
