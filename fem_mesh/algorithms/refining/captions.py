"""What the steps of ``ruppert`` say: the reasons, with the numbers that decided."""

from __future__ import annotations

import math

from fem_mesh.algorithms.refining.steiner import LARGE, LONG, SKINNY
from fem_mesh.steps import Step, Triangle, many

VERDICTS = {SKINNY: "skinny", LARGE: "large", LONG: "long"}


def say_start(step: Step) -> str:
    counts = (
        many(len(step.added), "triangle"),
        many(len(step.new_points), "point"),
        many(len(step.new_segments), "sub-segment"),
    )
    bounds = step.facts["bounds"]
    wanted = [f"angles of {bounds.min_angle:g} degrees or more"] if bounds.min_angle else []
    wanted += [f"areas up to {bounds.max_area:.3g}"] if bounds.max_area < math.inf else []
    wanted += [f"edges up to {bounds.max_edge:.3g}"] if bounds.max_edge < math.inf else []
    wanted += ["edges up to size(x, y)"] if bounds.size else []
    return f"{counts[0]} on {counts[1]}, {counts[2]}; asked for: {' and '.join(wanted) or 'nothing'}"


def say_encroached(step: Step) -> str:
    a, b = sorted(step.facts["edge"])
    if step.facts["inside"]:
        return f"sub-segment {a}-{b} is encroached: vertex {step.facts['v']} sees it under {step.facts['angle']:.4g} degrees"
    if step.facts["cause"]:
        return f"sub-segment {a}-{b} is encroached by the point that was to mend triangle {listing(step.facts['cause'])}"
    return f"sub-segment {a}-{b} is encroached by a point that was not inserted"


def say_clear(step: Step) -> str:
    (a, b), v = sorted(step.facts["edge"]), step.facts["v"]
    return f"vertex {v} lies inside the diametral circle of {a}-{b} and may go: it is removed before {a}-{b} is split"


def say_split(step: Step) -> str:
    (a, b), v, part = step.facts["edge"], step.facts["v"], step.facts["part"]
    where = "in the middle"
    if step.facts["on_curve"]:
        where = "on its curve"
    elif sum(step.facts["sharp"]) == 1:
        corner, length = (a, part) if step.facts["sharp"][0] else (b, 1 - part)
        where = f"at the distance {length * step.facts['size']:.4g}, a power of two, from its sharp corner {corner}"
    return f"sub-segment {min(a, b)}-{max(a, b)} is split {where}, at the new vertex {v}: {change(step)}"


def say_whole(step: Step) -> str:
    a, b = sorted(step.facts["edge"])
    return f"sub-segment {a}-{b} is not split: it is too short, or a rounded point would turn a triangle over"


def say_taken(step: Step) -> str:
    facts, bounds = step.facts, step.facts["bounds"]
    t = f"triangle {listing(facts['t'])}"
    if facts["verdict"] == SKINNY:
        return f"{t} is skinny: its smallest angle, {facts['angle']:.3g} degrees, is below {bounds.min_angle:g}"
    if facts["verdict"] == LARGE:
        return f"{t} is too large: its area is {facts['area']:.3g}"
    return f"{t} is too large: its longest edge is {facts['longest']:.3g}"


def say_steiner(step: Step) -> str:
    what = "the circumcentre" if step.facts["at_centre"] else "an off-center, nearer than the circumcentre,"
    n = step.facts["count"]
    return f"{what} of {listing(step.facts['t'])} would lie in {many(n, 'circle')}: {many(n, 'triangle')} would go"


def say_insert(step: Step) -> str:
    return f"no sub-segment is encroached: the point becomes vertex {step.facts['v']}, {change(step)}"


def say_lift(step: Step) -> str:
    return f"vertex {step.facts['v']} has a better place, where all angles around it keep the bound: it is taken out"


def say_move(step: Step) -> str:
    return f"vertex {step.facts['v']} is in its new place: {change(step)}"


def say_reject(step: Step) -> str:
    edges = ", ".join(f"{min(edge)}-{max(edge)}" for edge in step.encroached)
    one = len(step.encroached) == 1
    return f"the point is not inserted: it encroaches upon {edges}, {'which is' if one else 'which are'} split first"


def say_excused(step: Step) -> str:
    return f"triangle {listing(step.facts['t'])} stays: its shortest edge spans a small angle of the input, which stays too"


def say_refused(step: Step) -> str:
    return f"triangle {listing(step.facts['t'])} stays: rounded, its point would not lie where it must"


def say_spent(step: Step) -> str:
    return f"the budget is spent: {many(step.facts['added_points'], 'point')} added, and no more are allowed"


def say_done(step: Step) -> str:
    result, m = step.facts["result"], step.facts["m"]
    gaps = "; numbers move up to close gaps" if step.facts["gaps"] else ""
    return f"{result!r}: {many(m, 'triangle')}, smallest angle {step.facts['angle']:.1f} degrees{gaps}"


def listing(triangle: Triangle) -> str:
    return ", ".join(map(str, triangle))


def change(step: Step) -> str:
    comes, goes = len(step.added), len(step.removed)
    return f"{many(comes, 'triangle')} come{'s' * (comes == 1)}, {goes} go{'es' * (goes == 1)}"


def angle_over(p: tuple[float, float], a: tuple[float, float], b: tuple[float, float]) -> float:
    """The angle under which ``p`` sees ab, in degrees."""
    (ux, uy), (vx, vy) = ((q[0] - p[0], q[1] - p[1]) for q in (a, b))
    return math.degrees(math.atan2(abs(ux * vy - uy * vx), ux * vx + uy * vy))


def measures(corners: list[tuple[float, float]]) -> dict[str, float]:
    """The smallest angle, the area and the longest edge of a triangle."""
    a, b, c = corners
    angles = [angle_over(a, b, c), angle_over(b, c, a), angle_over(c, a, b)]
    area = abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2
    return {"angle": min(angles), "area": area, "longest": max(math.dist(a, b), math.dist(b, c), math.dist(c, a))}
