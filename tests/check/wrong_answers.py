"""Wrong answers of the kinds that students write, each with the message that it must get."""

from __future__ import annotations

import itertools
import math

import numpy as np
from right_answers import (
    GHOST,
    apexes,
    bowyer_watson_super_triangle,
    bowyer_watson_with_ghosts,
    carve_by_rays,
    cdt,
    center_of,
    crosses,
    edges_of,
    encroached_with_lists,
    flip_with_lists,
    lawson_with_lists,
    next_vertex,
    on_loops,
    ruppert_from_scratch,
    segments_by_flips,
    smallest_angle,
)

import fem_mesh as fm
from fem_mesh import textbook

WRONG = []


def wrong(check, message):
    """Enter an answer to ``check`` that must get a message with these words, which are in order, between "..."."""

    def enter(work):
        WRONG.append((check, work, message))
        return work

    return enter


# ---- orient ------------------------------------------------------------------------------------------


def det(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


wrong("orient", "is not written yet: line ... raises NotImplementedError")(lambda a, b, c: not_written())


def not_written():
    raise NotImplementedError


@wrong("orient", "must return a number, whose sign counts, not None: is a `return` missing?")
def forgotten_return(a, b, c):
    det(a, b, c)


@wrong("orient", "must return a number, whose sign counts, not the text 'left'")
def a_word(a, b, c):
    return "left"


wrong("orient", "a number, whose sign counts, not a list of length 1")(lambda a, b, c: np.array([det(a, b, c)]))
wrong("orient", "a number, whose sign counts, not True")(lambda a, b, c: det(a, b, c) > 0)
wrong("orient", "orient((0, 0), (1, 0), (0, 1)) must be positive, since c lies to the left; you returned -1")(
    lambda a, b, c: -det(a, b, c)
)
wrong("orient", "simple turns...must be negative, since c lies to the right; you returned")(lambda a, b, c: abs(det(a, b, c)))
wrong("orient", "tiny...determinant...which rounding or a tolerance hides")(
    lambda a, b, c: det(a, b, c) if abs(det(a, b, c)) > 1e-12 else 0
)
wrong("orient", "a hair beside a line...which rounding or a tolerance hides); you returned")(det)
wrong("orient", "line ..., `...`, raised IndexError: tuple index out of range")(lambda a, b, c: a[2])
wrong("orient", "takes 2 positional arguments but 3 were given")(lambda a, b: 1)
wrong("orient", "a number, whose sign counts, not nan")(lambda a, b, c: math.nan)


@wrong("orient", "no end after 0.3 seconds: the loop in line ..., `...`, was still running")
def endless(a, b, c):
    while True:
        pass


# ---- in_circle ---------------------------------------------------------------------------------------


def circle_det(a, b, c, d):
    rows = [(p[0] - d[0], p[1] - d[1], (p[0] - d[0]) ** 2 + (p[1] - d[1]) ** 2) for p in (a, b, c)]
    (ax, ay, al), (bx, by, bl), (cx, cy, cl) = rows
    return ax * (by * cl - bl * cy) - ay * (bx * cl - bl * cx) + al * (bx * cy - by * cx)


wrong("in_circle", "must return True or False, not ")(circle_det)
wrong("in_circle", "must return True or False, not None: is a `return` missing?")(lambda a, b, c, d: None)
wrong("in_circle", "since d lies inside the circle; you returned False")(lambda *p: circle_det(*p) < 0)
wrong("in_circle", "since d lies exactly on the circle, not inside; you returned True")(lambda *p: circle_det(*p) >= 0)
wrong("in_circle", "tiny triangle...which rounding or a tolerance hides); you returned False")(textbook.in_circle)
wrong("in_circle", "exactly on the circle, not inside; you returned True")(lambda *p: circle_det(*p) > -1e-12)
wrong("in_circle", "a hair inside...which rounding or a tolerance hides")(lambda *p: circle_det(*p) > 0)
wrong("in_circle", "must be False, since d lies outside the circle; you returned True")(
    lambda a, b, c, d: min(p[0] for p in (a, b, c)) <= d[0] <= max(p[0] for p in (a, b, c)) + 9
)


@wrong("in_circle", "line ..., `...`, raised ZeroDivisionError")
def by_slopes(a, b, c, d):
    slope = (b[0] - a[0]) / (b[1] - a[1])
    return slope > 0


@wrong("in_circle", "since d lies inside the circle; you returned False")
def in_triangle(a, b, c, d):
    return fm.orient(a, b, d) > 0 and fm.orient(b, c, d) > 0 and fm.orient(c, a, d) > 0


# ---- one flip, one cavity ----------------------------------------------------------------------------


def diagonals(points, triangles, edge):
    a, b = edge
    apex = apexes(triangles)
    c, d = apex.get((a, b)), apex.get((b, a))
    old = [t for t in triangles if {a, b} <= set(t)]
    return old, [] if None in (c, d) else [(a, d, c), (d, b, c)]


def exchanged(points, triangles, edge):
    old, new = diagonals(points, triangles, edge)
    return [t for t in triangles if t not in old] + new


wrong("flip", "edge 0-1 lies on the hull, so it cannot be flipped: return None, not a list of length")(exchanged)
wrong("flip", "the quadrilateral ... around edge 0-3 is not convex, so it cannot be flipped: return None, not a list")(
    lambda points, triangles, edge: exchanged(points, triangles, edge) if diagonals(points, triangles, edge)[1] else None
)
wrong("flip", "can be flipped, for its quadrilateral ... is convex, but you returned None")(lambda *given: None)
wrong("flip", "triangle (0, 1, 2) is still there, but edge 0-2 has to go from it")(lambda points, triangles, edge: triangles)
wrong("flip", "triangle ... is still there, but edge 0-2 has to go from it")(
    lambda points, triangles, edge: triangles[1:] + diagonals(points, triangles, edge)[1]
)
wrong("flip", "all edges of a triangulation...triangle ... is missing: return all triangles, also those that stay as they are")(
    lambda points, triangles, edge: (
        None if flip_with_lists(points, triangles, edge) is None else diagonals(points, triangles, edge)[1]
    )
)
wrong("flip", "a square...can be flipped, for its quadrilateral ... is convex, but you returned None")(
    lambda points, triangles, edge: (
        flip_with_lists(points, triangles, edge) if points[0] != (0.0, 0.0) or points[2] != (4.0, 4.0) else None
    )
)
wrong("flip", "line ..., `...`, raised KeyError")(
    lambda points, triangles, edge: (
        exchanged(points, triangles, edge) if apexes(triangles)[tuple(edge)] - apexes(triangles)[edge[1], edge[0]] else None
    )
)
wrong("flip", "a hair...is convex, but you returned None|three corners on a line|notch")(
    lambda points, triangles, edge: flip_with_lists([(round(x, 9), round(y, 9)) for x, y in points], triangles, edge)
)

wrong("cavity", "triangle (...) is missing: the point (0.5, 0.25) lies inside its circle")(lambda *given: [])
wrong("cavity", "triangle (...) is too much: the point (...) lies outside its circle")(lambda points, triangles, p: triangles)
wrong("cavity", "is too much: the point (...) lies on its circle, not inside")(
    lambda points, triangles, p: [t for t in triangles if circle_det(*(points[v] for v in t), p) >= 0]
)
wrong("cavity", "triangle (...) is missing: the point (...) lies inside its circle")(
    lambda points, triangles, p: [t for t in triangles if all(fm.orient(points[a], points[b], p) >= 0 for a, b in edges_of(t))]
)
wrong("cavity", "a hair...is missing|is too much")(
    lambda points, triangles, p: [t for t in triangles if textbook.in_circle(*(points[v] for v in t), p)]
)
wrong("cavity", "you returned a filter, not the list of all triangles")(lambda points, triangles, p: filter(None, triangles))
wrong("cavity", "you returned a list that holds 0 where a triangle (a, b, c) should be: return the list of all triangles")(
    lambda points, triangles, p: [i for i, _ in enumerate(triangles)]
)
wrong("cavity", "triangle (...) is none of the given ones|names point")(lambda points, triangles, p: [(0, 1, 2)])


# ---- Lawson ------------------------------------------------------------------------------------------


def flips(points, triangles, is_bad, most=400):
    triangles = list(triangles)
    for _ in range(most):
        apex = apexes(triangles)
        found = next(
            ((a, b, c, apex[b, a]) for (a, b), c in sorted(apex.items()) if (b, a) in apex and is_bad(a, b, c, apex[b, a])),
            None,
        )
        if found is None:
            return
        a, b, c, d = found
        triangles = [t for t in triangles if not {a, b} <= set(t)] + [(a, d, c), (d, b, c)]
        yield triangles


def convex(points, a, b, c, d):
    return crosses(points, a, b, c, d)


wrong("lawson", "step 1: you flipped edge 0-2, but 0, 2, 3 and 1 lie on one circle: a tie is left as it is")(
    lambda points, triangles: flips(points, triangles, lambda *v: in_or_on(points, *v))
)


def in_or_on(points, a, b, c, d):
    return convex(points, a, b, c, d) and circle_det(*(points[v] for v in (a, b, c, d))) >= 0


wrong("lawson", "step 1: you flipped edge 1-3, but no vertex lies inside either circle")(
    lambda points, triangles: (
        flips(points, triangles, lambda *v: convex(points, *v) and tuple(sorted(v[:2])) != (0, 2), 9)
        if len(triangles) > 1 and (1, 3) in apexes(triangles)
        else lawson_with_lists(points, triangles)
    )
)


@wrong("lawson", "step 1: edge ... cannot be flipped: its quadrilateral ... is not convex, so edge ... is no diagonal of it")
def flips_a_dart(points, triangles):
    if len(points) == 4 and len(triangles) == 3:
        yield from flips(points, triangles, lambda a, b, c, d: not convex(points, a, b, c, d), 1)
    yield from lawson_with_lists(points, triangles)


@wrong("lawson", "tiny triangles...it ended, but edge ... should still be flipped: vertex ... lies inside the circle of")
def with_a_tolerance(points, triangles):
    return flips(points, triangles, lambda *v: textbook.in_circle(*(points[u] for u in v)))


@wrong("lawson", "it ended, but edge ... should still be flipped")
def one_sweep_only(points, triangles):
    for a, b in [e for t in triangles for e in edges_of(t)]:
        apex = apexes(triangles)
        if (a, b) in apex and (b, a) in apex and fm.in_circle(*(points[v] for v in (a, b, apex[a, b], apex[b, a]))):
            c, d = apex[a, b], apex[b, a]
            triangles = [t for t in triangles if not {a, b} <= set(t)] + [(a, d, c), (d, b, c)]
            yield triangles


@wrong("lawson", "step 1: there is a hole beside edge ...: no triangle lies on its other side|is missing")
def forgets_a_triangle(points, triangles):
    for state in lawson_with_lists(points, triangles):
        yield state[:-1]


@wrong("lawson", "step 1: triangles ... and ... overlap: both lie on the same side of edge")
def keeps_the_old_ones(points, triangles):
    seen = list(triangles)
    for state in lawson_with_lists(points, triangles):
        seen += [t for t in state if t not in seen]
        yield seen


@wrong("lawson", "step 2: nothing has changed since the step before: yield after each flip, and only then")
def yields_at_the_end_too(points, triangles):
    yield from lawson_with_lists(points, triangles)
    yield [(0, 1, 3), (1, 2, 3)]


@wrong("lawson", "step 1: ... triangles were replaced at once: yield after each single flip")
def yields_the_end_only(points, triangles):
    *_, last = [triangles, *lawson_with_lists(points, triangles)]
    if last is not triangles:
        yield last


@wrong("lawson", "step 1: you yielded None, not the list of all triangles")
def yields_nothing(points, triangles):
    for _ in lawson_with_lists(points, triangles):
        yield


@wrong(
    "lawson", "step 1: you yielded a list that holds ... where a triangle (a, b, c) should be: yield the list of all triangles"
)
def yields_one_triangle(points, triangles):
    for state in lawson_with_lists(points, triangles):
        yield state[-1]


@wrong("lawson", "step 1: triangle (0.0, ...) must be made of point numbers, which are integers, not 0.0")
def yields_floats(points, triangles):
    for state in lawson_with_lists(points, triangles):
        yield np.array(state, float)[:1]


@wrong("lawson", "lawson returned a list of length 2, but it is to be a generator: `yield` the current state after each change")
def returns_the_end(points, triangles):
    return [triangles, *lawson_with_lists(points, triangles)][-1]


@wrong("lawson", "step 2: line ..., `raise KeyError(7)`, raised KeyError: 7")
def raises_on_the_way(points, triangles):
    for state in lawson_with_lists(points, triangles):
        yield state
        raise KeyError(7)


@wrong("lawson", "step 1: no end after 0.3 seconds: the loop in line ..., `...`, was still running")
def endless_before_the_first(points, triangles):
    for edge in iter(int, 1):  # noqa: B007
        pass
    yield triangles


@wrong("lawson", "step 1: triangle (0, 1, 4) names point 4, but the points are numbered from 0 to 3")
def counts_from_one(points, triangles):
    for state in lawson_with_lists(points, triangles):
        yield [(0, 1, 4), *state[1:]]


# ---- Bowyer and Watson -------------------------------------------------------------------------------


def super_triangle(points, far, inside=fm.in_circle, keep=False, remember=False):
    n = len(points)
    places = [*points, (-far, -far), (far, -far), (0.0, far)]
    triangles = [(n, n + 1, n + 2)]
    for p in range(n):
        cavity = [t for t in triangles if inside(*(places[v] for v in t), places[p])]
        sides = [e for t in cavity for e in edges_of(t)]
        if not remember:
            triangles = [t for t in triangles if t not in cavity]
        triangles += [(a, b, p) for a, b in sides if (b, a) not in sides]
        yield triangles if keep else [t for t in triangles if max(t) < n]


wrong("bowyer_watson", "edge ... of the convex hull is missing: ...: if you use a super-triangle, it is too near")(
    lambda points: super_triangle(points, 20.0, lambda *p: circle_det(*p) > 0)
)
wrong("bowyer_watson", "edge ... of the convex hull is missing: ...: if you use a super-triangle, it is too near")(
    lambda points: super_triangle(points, 1000.0)
)
wrong("bowyer_watson", "step 1: triangle (...) has corner 3, but the points are numbered from 0 to 2: leave out the triangles")(
    lambda points: super_triangle(points, 2.0**60, keep=True)
)
wrong("bowyer_watson", "step 4: triangle (...) should have gone: the new point 3 lies inside its circle")(
    lambda points: super_triangle(points, 2.0**60, remember=True)
)


@wrong("bowyer_watson", "triangle (...) has gone, but the new point ... lies outside its circle, and ")
def a_cavity_too_large(points):
    """Everything near, whether connected or not."""
    return super_triangle(
        points,
        2.0**60,
        lambda *p: fm.in_circle(*p) or (abs(p[0][0]) + abs(p[1][0]) + abs(p[2][0]) < 9 and circle_det(*p) > -0.05),
    )


@wrong("bowyer_watson", "step 4: triangle ... is flat: the new point 3 lies on the line through ... and ..., so this edge")
def flat_at_the_hull(points):
    """On an edge of the hull the new point is joined to that edge too."""
    for state in bowyer_watson_with_ghosts(points):
        if points[3:4] == [(2.0, 2.0)] and len({v for t in state for v in t}) == 4:
            state = state | {(1, 2, 3)}
        yield state


@wrong("bowyer_watson", "step 4: triangle (0, 1, 2) should have gone: the new point 3 lies inside its circle")
def only_splits_the_triangle(points):
    """No cavity: it only splits the triangle that holds the point, or adds outside."""
    triangles = []
    for p in range(len(points)):
        if p == 2:
            triangles = [(0, 1, 2)]
        elif p > 2:
            triangles = [*triangles, (0, 2, p)]
        yield triangles


@wrong(
    "bowyer_watson", "triangle ... should have gone: the new point ... lies inside its circle|is not Delaunay|are not Delaunay"
)
def with_a_large_tolerance(points):
    return super_triangle(points, 2.0**60, lambda a, b, c, d: circle_det(a, b, c, d) > 1e-3)


@wrong("bowyer_watson", "it ended with 0 of 3 points: yield the triangles after each point")
def yields_nothing_at_all(points):
    return
    yield


@wrong("bowyer_watson", "step 1: triangle (...) uses point 3, but the points so far are 0 to 2: each yield has one more")
def yields_only_the_end(points):
    *_, last = bowyer_watson_with_ghosts(points)
    yield last


@wrong("bowyer_watson", "triangle (...) uses point ..., but the points so far are 0 to")
def sorts_the_points(points):
    order = sorted(range(len(points)), key=points.__getitem__)
    for state in bowyer_watson_with_ghosts([points[v] for v in order]):
        yield [tuple(order[v] for v in t) for t in state]


@wrong("bowyer_watson", "step 4: all points are in already: yield once after each point")
def one_yield_too_many(points):
    yield from bowyer_watson_with_ghosts(points)
    yield [(0, 1, 2)]


@wrong("bowyer_watson", "step 3: there are 4 states of 3 points: yield once after each point, not before")
def one_yield_before_the_first(points):
    yield []
    yield from bowyer_watson_with_ghosts(points)


@wrong("bowyer_watson", "step 3: triangle (...) is there twice")
def duplicates(points):
    for state in bowyer_watson_with_ghosts(points):
        yield [*state, *(t[1:] + t[:1] for t in state)]


@wrong("bowyer_watson", "triangle ... has corner -1, but the points are numbered from 0 to 2: leave out")
def yields_ghosts(points):
    for state in bowyer_watson_with_ghosts(points):
        yield [*state, (0, 1, GHOST)] if state else state


@wrong("bowyer_watson", "the first points on a line, step 5: edge ... of the convex hull is missing")
def forgets_points_on_a_line(points):
    if points[1:3] != [(2.0, 2.0), (1.0, 1.0)]:
        yield from bowyer_watson_with_ghosts(points)
        return
    for _k in range(3):
        yield []
    yield []
    yield [(0, 1, 4)]


# ---- segments ----------------------------------------------------------------------------------------


@wrong("segments", "it ended, but segment 0-1 is no edge: edge 2-3 crosses it")
def does_nothing(points, triangles, segments):
    yield triangles


@wrong("segments", "it ended, but segment ... is no edge: edge")
def gives_up_where_it_is_not_convex(points, triangles, segments):
    for a, b in segments:
        for u, v in [e for e in apexes(triangles) if e[0] < e[1] and crosses(points, a, b, *e)]:
            apex = apexes(triangles)
            c, d = apex[u, v], apex[v, u]
            if crosses(points, u, v, c, d):
                triangles = [t for t in triangles if not {u, v} <= set(t)] + [(u, d, c), (d, v, c)]
                yield triangles


@wrong(
    "segments",
    "you flipped edge 8-9, but its quadrilateral 8, 10, 9, 6 is not strictly convex: leave this edge, and try it again",
)
def flips_what_is_not_convex(points, triangles, segments):
    for a, b in segments:
        for u, v in [e for e in apexes(triangles) if e[0] < e[1] and crosses(points, a, b, *e)]:
            apex = apexes(triangles)
            c, d = apex[u, v], apex[v, u]
            triangles = [t for t in triangles if not {u, v} <= set(t)] + [(u, d, c), (d, v, c)]
            yield triangles


@wrong("segments", "it ended, but edge ..., which is no segment, should be flipped: vertex ... lies inside the circle of")
def does_not_restore(points, triangles, segments):
    for state in segments_by_flips(points, triangles, segments):
        yield state
        if all(s in apexes(state) or s[::-1] in apexes(state) for s in segments):
            return


@wrong("segments", "it ended, but segment ... is no edge: edge ... crosses it|edges")
def restores_too_much(points, triangles, segments):
    for state in segments_by_flips(points, triangles, segments):  # noqa: B007
        pass
    yield from lawson_with_lists(points, locals().get("state", triangles))


@wrong("segments", "it ended, but segment ... is no edge")
def forgets_the_last(points, triangles, segments):
    yield from segments_by_flips(points, triangles, segments[:-1])


@wrong("segments", "step 1: there is a hole beside edge|of the convex hull is missing")
def leaves_a_hole(points, triangles, segments):
    for a, b in segments:
        triangles = [t for t in triangles if not any(crosses(points, a, b, *e) for e in edges_of(t))]
        yield triangles


@wrong("segments", "step 1: triangle (0, 1, 2) names point 2|overlap|is missing|hole")
def yields_the_segments_side_only(points, triangles, segments):
    for a, b in segments:
        yield [t for t in triangles if fm.orient(points[a], points[b], points[t[0]]) >= 0]


@wrong("segments", "step 1: triangle (0, 1) ...|which is no triangle (a, b, c)")
def yields_edges(points, triangles, segments):
    for s in segments:
        yield [s]


@wrong("segments", "no end after 0.3 seconds: the loop in line ..., `...`, was still running")
def flips_for_ever(points, triangles, segments):
    while True:
        for a, b in segments:
            for u, v in [e for e in apexes(triangles) if crosses(points, a, b, *e)][:1]:
                apex = apexes(triangles)
                if crosses(points, u, v, apex[u, v], apex[v, u]):
                    yield triangles


# ---- carving -----------------------------------------------------------------------------------------

wrong("carve", "triangle (...) lies outside or in a hole, but you kept it")(lambda points, triangles, segments: triangles)
wrong("carve", "you returned None, not the list of all triangles")(lambda points, triangles, segments: None)
wrong("carve", "triangle (...) lies inside, but you carved it away")(lambda points, triangles, segments: [])
wrong("carve", "a square with a hole...lies outside or in a hole, but you kept it")(
    lambda points, triangles, segments: outside_only(points, triangles, segments)
)
wrong("carve", "an island in a hole...lies inside, but you carved it away")(
    lambda points, triangles, segments: [t for t in carve_by_rays(points, triangles, segments) if min(t) < 8]
)
wrong("carve", "a crack...|segments, but no loop...lies inside, but you carved it away")(
    lambda points, triangles, segments: parity_of_all(points, triangles, segments)
)
wrong("carve", "an L-shape: triangle (0, 1, 2) is none of the given ones")(
    lambda points, triangles, segments: [(0, 1, 2), *carve_by_rays(points, triangles, segments)]
)
wrong("carve", "carve is to be|you returned a generator, not the list of all triangles")(
    lambda points, triangles, segments: (t for t in triangles)
)


def outside_only(points, triangles, segments):
    """Eats from the hull only, and so leaves holes full."""
    walls = {frozenset(s) for s in segments}
    left = list(triangles)
    while walls:
        count = [frozenset(e) for t in left for e in edges_of(t)]
        gone = [t for t in left if any(count.count(frozenset(e)) == 1 and frozenset(e) not in walls for e in edges_of(t))]
        if not gone:
            break
        left = [t for t in left if t not in gone]
    return left if on_loops(segments) else triangles


def parity_of_all(points, triangles, segments):
    """Counts cracks too."""
    inside = []
    for t in triangles:
        x, y = (sum(points[v][k] for v in t) / 3 for k in (0, 1))
        crossed = 0
        for a, b in segments:
            (ax, ay), (bx, by) = points[a], points[b]
            crossed += (ay <= y) != (by <= y) and x < ax + (y - ay) * (bx - ax) / (by - ay)
        if crossed % 2:
            inside.append(t)
    return inside


# ---- encroached --------------------------------------------------------------------------------------


def diametral(points, segments, test, skip_ends=True):
    result = []
    for a, b in segments:
        (ax, ay), (bx, by) = points[a], points[b]
        for v, (x, y) in enumerate(points):
            if (not skip_ends or v not in (a, b)) and test(
                (ax - x) * (bx - x) + (ay - y) * (by - y), (bx - ax) ** 2 + (by - ay) ** 2
            ):
                result.append((a, b))
                break
    return result


wrong("encroached", "a point near a side: point 4 lies inside the circle over segment 0-1, but you left it out")(
    lambda p, s: []
)
wrong("encroached", "no point lies strictly inside the circle over segment 0-1, but you returned it")(lambda p, s: s)
wrong("encroached", "no point lies strictly inside the circle over segment 0-1, but you returned it")(
    lambda p, s: diametral(p, s, lambda dot, square: dot <= 0, skip_ends=False)
)
wrong("encroached", "on all circles: no point lies strictly inside the circle over segment")(
    lambda p, s: diametral(p, s, lambda dot, square: dot <= 0)
)
wrong("encroached", "tiny segments: point ... lies inside the circle over segment ..., but you left it out|hair")(
    lambda p, s: diametral(p, s, lambda dot, square: dot < -1e-12)
)
wrong("encroached", "you returned numbers: return the segments themselves, as pairs (a, b)")(
    lambda p, s: [s.index(e) for e in encroached_with_lists(p, s)] or [0]
)
wrong("encroached", "a list that holds (0, 1, 4), which is no segment (a, b)")(
    lambda p, s: [(*e, 4) for e in encroached_with_lists(p, s)]
)
wrong("encroached", "(0, 3) is none of the segments|(0, 2) is none of the segments")(lambda p, s: [(0, 2)])
wrong("encroached", "segment ... is there more than once: one point inside is enough")(
    lambda p, s: [e for e in s for v in p if fm.in_diametral_circle(p[e[0]], p[e[1]], v)]
)
wrong("encroached", "you returned True, not the list of all segments")(lambda p, s: True)
wrong("encroached", "a point on a circle but for a hair: ...lies inside the circle over segment 0-1, but you left it out")(
    lambda p, s: diametral(p, s, lambda dot, square: dot < -1e-12 * max(square, 1e-20))
)


# ---- Ruppert -----------------------------------------------------------------------------------------


def refine(points, segments, min_angle, choose, most=60):
    points, pieces = list(points), list(segments)
    triangles = cdt(points, pieces)
    yield points, triangles
    for _ in range(most):
        new = choose(points, pieces, triangles, min_angle)
        if new is None:
            return
        points = [*points, new]
        triangles = cdt(points, pieces)
        yield points, triangles


def split(points, pieces, a, b, share=0.5):
    pieces.remove((a, b))
    pieces += [(a, len(points)), (len(points), b)]
    (ax, ay), (bx, by) = points[a], points[b]
    return ax + share * (bx - ax), ay + share * (by - ay)


def worst_of(points, triangles, below):
    bad = sorted((smallest_angle(points, t), t) for t in triangles)
    return bad[0][1] if bad[0][0] < below else None


def centre(points, t):
    return center_of(*(points[v] for v in t))


@wrong(
    "ruppert",
    "step 2: you inserted the centre of a circle, but segment ... is encroached upon by vertex ...: it is split first",
)
def segments_last(points, segments, min_angle):
    def choose(points, pieces, triangles, bound):
        t = worst_of(points, triangles, bound)
        if t:
            return centre(points, t)
        hit = encroached_with_lists(points, pieces)
        return split(points, pieces, *hit[0]) if hit else None

    return refine(points, segments, min_angle, choose, 4)


@wrong(
    "ruppert",
    "the new point ... lies inside the circle of segment ...: split the segment instead|is not covered|names point|is flat",
)
def centres_anywhere(points, segments, min_angle):
    def choose(points, pieces, triangles, bound):
        hit = encroached_with_lists(points, pieces)
        if hit:
            return split(points, pieces, *hit[0])
        t = worst_of(points, triangles, bound)
        return centre(points, t) if t else None

    return refine(points, segments, min_angle, choose, 20)


@wrong("ruppert", "step 2: you split segment ..., but neither a vertex nor the centre of a bad triangle's circle lies inside")
def splits_the_longest(points, segments, min_angle):
    def choose(points, pieces, triangles, bound):
        if not encroached_with_lists(points, pieces):
            return None
        return split(points, pieces, *max(pieces, key=lambda e: math.dist(points[e[0]], points[e[1]]) + e[0]))

    return refine(points, segments, min_angle, choose)


@wrong(
    "ruppert",
    "step 2: the new point (...) is neither the midpoint of a segment nor the centre of the circle of a triangle|is no edge",
)
def splits_at_a_third(points, segments, min_angle):
    def choose(points, pieces, triangles, bound):
        hit = encroached_with_lists(points, pieces)
        return split(points, pieces, *hit[0], share=0.25) if hit else None

    return refine(points, segments, min_angle, choose)


@wrong("ruppert", "the new point (...) is neither the midpoint of a segment nor the centre of the circle of a triangle")
def inserts_centroids(points, segments, min_angle):
    def choose(points, pieces, triangles, bound):
        hit = encroached_with_lists(points, pieces)
        if hit:
            return split(points, pieces, *hit[0])
        t = worst_of(points, triangles, bound)
        return None if t is None else (sum(points[v][0] for v in t) / 3 + 0.01, sum(points[v][1] for v in t) / 3)

    return refine(points, segments, min_angle, choose)


@wrong(
    "ruppert",
    "is the centre of the circle of triangle (...), whose smallest angle, ... degrees, is not below 20|nothing to do, step 2",
)
def refines_too_much(points, segments, min_angle):
    points = [*points]
    yield points, cdt(points, segments)
    t = cdt(points, segments)[0]
    x, y = centre(points, t)
    yield [*points, (x + 1e-12, y)], cdt([*points, (x + 1e-12, y)], segments)


@wrong("ruppert", "it ended, but segment ... is encroached upon by vertex")
def angles_only(points, segments, min_angle):
    yield points, cdt(points, segments)


@wrong("ruppert", "case a side that is no edge at first: it ended, but segment 4-5 is encroached upon by vertex 8")
def only_segments_that_are_edges(points, segments, min_angle):
    """A segment that is missing among the triangles of the hull is never split, so it stays missing."""
    points, pieces = [*points], [*segments]
    while True:
        triangles = cdt(points, pieces, carved=False)
        yield points, triangles
        edges = {frozenset(edge) for t in triangles for edge in edges_of(t)}
        missing = [piece for piece in pieces if frozenset(piece) not in edges]
        pieces = [piece for piece in pieces if piece not in missing]
        inside = carve_by_rays(points, triangles, pieces + missing)
        new = next_vertex(points, pieces, inside, min_angle, worst=True)
        if new is None:
            return
        points, pieces = [*points, new], pieces + missing


@wrong("ruppert", "it ended, but triangle (...) has an angle of ... degrees, below 20")
def encroachment_only(points, segments, min_angle):
    def choose(points, pieces, triangles, bound):
        hit = encroached_with_lists(points, pieces)
        return split(points, pieces, *hit[0]) if hit else None

    return refine(points, segments, min_angle, choose)


@wrong("ruppert", "it ended, but triangle (...) has an angle of ... degrees, below 20")
def radians(points, segments, min_angle):
    return ruppert_from_scratch(points, segments, math.radians(min_angle))


@wrong(
    "ruppert", "step 3: there are 7 points, after 5: each state has one more than the one before|there are ... points, after"
)
def two_at_once(points, segments, min_angle):
    yield from list(ruppert_from_scratch(points, segments, min_angle))[::2]


@wrong("ruppert", "you yielded a list of length ..., not a pair (points, triangles)|the points that you yielded")
def triangles_only(points, segments, min_angle):
    for _, triangles in ruppert_from_scratch(points, segments, min_angle):
        yield [*triangles, *triangles]


@wrong("ruppert", "point 0 has moved, from (0, 0) to (0.5, 0): new points come last|the circle of|there are|has moved")
def new_points_first(points, segments, min_angle):
    for places, triangles in ruppert_from_scratch(points, segments, min_angle):
        yield [*places[len(points) :], *places[: len(points)]], triangles


@wrong(
    "ruppert",
    "holds point ..., and no segment lies between them: the triangles are not constrained Delaunay|overlap|hull|no edge",
)
def only_splits_triangles(points, segments, min_angle):
    first = list(ruppert_from_scratch(points, segments, min_angle))
    yield first[0]
    for before, after in itertools.pairwise(first):
        yield after[0], before[1]


# ---- a mesh as arrays --------------------------------------------------------------------------------

MESHES = []
ELL = fm.l_shape()
FINE = fm.refine(ELL, min_angle=25, max_area=0.1)
KITE = [(0, 0), (4, 0), (5, 3), (1, 2)]
FRAME = [(0, 0), (9, 0), (9, 9), (0, 9), (3, 3), (6, 3), (6, 6), (3, 6)]
RING = [t for a in range(4) for b in [(a + 1) % 4] for t in [(a, b, a + 4), (b, b + 4, a + 4)]]


def wrong_mesh(message, points, triangles, **asked):
    """Enter arrays that ``check.mesh`` must refuse, with such a message."""
    MESHES.append((message, points, triangles, asked))


wrong_mesh("the circle of triangle (...) holds point ...: it is not Delaunay", KITE, [(0, 1, 2), (0, 2, 3)])
wrong_mesh("edge 1-2 of the convex hull is missing", KITE, [(0, 1, 3)])
wrong_mesh("triangle (0, 1, 4) names point 4, but the points are numbered from 0 to 3", KITE, [(0, 1, 4)])
wrong_mesh("triangles (0, 1, 2) and (0, 1, 3) overlap", KITE, [(0, 1, 2), (0, 1, 3)], delaunay=False)
wrong_mesh("there are no triangles", KITE, [])
wrong_mesh("point 1 is (4, inf), not a pair (x, y) of floats", [(0, 0), (4, math.inf)], [(0, 1, 2)])
wrong_mesh("the points that you gave are None, not a list of pairs (x, y)", None, [(0, 1, 2)])
wrong_mesh("you gave a zip, not the list of all triangles", KITE, zip([1]))
wrong_mesh(
    "the smallest angle must be at least 33 degrees, but that of triangle",
    FINE.points,
    FINE.triangles,
    min_angle=33,
    domain=ELL,
)
wrong_mesh("of the convex hull is missing", FINE.points, FINE.triangles)
wrong_mesh("one side of edge", FINE.points, FINE.triangles[1:], domain=ELL, delaunay=False)
wrong_mesh("an end of the domain's segment from (...) to (...) is no vertex", KITE, [(0, 1, 3), (1, 2, 3)], domain=fm.square())
wrong_mesh(
    "the domain's segment from (0, 0) to (5, 3) is no chain of edges: 0-2 is missing", KITE, [(0, 1, 3), (1, 2, 3)],
    domain=fm.Domain(KITE, [(0, 1), (1, 2), (2, 3), (3, 0), (0, 2)]),
)  # fmt: skip
wrong_mesh("there is a hole beside edge", FRAME, RING)
CELLS = [(a, b) for a in range(4) for b in range(2)]  # of a plate, its hole filled, and one as large elsewhere
PLATE = [t for a, b in CELLS if (a, b) != (2, 0) for v in [5 * b + a] for t in [(v, v + 1, v + 6), (v, v + 6, v + 5)]]
wrong_mesh(
    "edge ... has triangles on both sides, but on the domain's segment from (1, 0) to (1, 1) the domain has one",
    [(x, y) for y in range(3) for x in range(5)], PLATE,
    domain=fm.Domain.from_loops([(0, 0), (1, 0), (1, 1), (2, 1), (2, 0), (4, 0), (4, 2), (0, 2)]),
)  # fmt: skip


# ---- what all have in common: wrong in itself --------------------------------------------------------

wrong("lawson", "give the function itself, check.lawson(lawson) without a call, not a generator")(
    lawson_with_lists([(0, 0), (1, 0), (0, 1)], [(0, 1, 2)])
)
wrong("bowyer_watson", "give the function itself")(None)
wrong("bowyer_watson", "a list that holds")(lambda points: ([len(s)] for s in bowyer_watson_super_triangle(points)))
