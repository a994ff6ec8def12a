"""Homework 4: constrained edges, and carving."""

from collections import deque
from fractions import Fraction

import numpy as np

import fem_mesh as fm
from answers import given_in

GIVEN = given_in("hw4_constrained")
SOLVED = given_in("hw4_constrained", solved=True)
edges_of, across, cross, is_illegal, flip, on_loops = (
    GIVEN[name] for name in ("edges_of", "across", "cross", "is_illegal", "flip", "on_loops")
)

# ---- segments, right -----------------------------------------------------------------------------------


def with_a_queue(points, triangles, segments):
    yield from SOLVED["segments"](points, triangles, segments)


def mended_after_each_segment(points, triangles, segments):
    """In sets, and a state for each segment rather than for each flip."""
    done, random = set(), np.random.default_rng(1)
    for s in map(frozenset, segments):
        while True:
            crossing = sorted((e for e in edges_of(triangles) if cross(points, s, e)), key=sorted)
            possible = [e for e in crossing if cross(points, e, across(triangles, e))]
            if not crossing:
                break
            fewer = [e for e in possible if not cross(points, s, across(triangles, e))]
            triangles = flip(triangles, fewer[0] if fewer else possible[random.integers(len(possible))])
        done.add(s)
        triangles = mended(points, triangles, done)
        yield {frozenset(t) for t in triangles}


def mended(points, triangles, kept):
    while bad := [e for e in sorted(edges_of(triangles) - kept, key=sorted) if is_illegal(points, triangles, e)]:
        triangles = flip(triangles, bad[0])
    return triangles


def with_polygons(points, triangles, segments):
    """What a segment crosses is taken out; each bank is filled again, by recursion."""
    done = set()
    for s in map(frozenset, segments):
        done.add(s)
        if s in edges_of(triangles):
            continue
        a, b = s
        hit = [t for t in triangles if any(cross(points, s, e) for e in edges_of([t]))]
        triangles = [t for t in triangles if t not in hit]
        right, left = banks(points, hit, a, b)
        triangles += filled(points, [a, *right, b]) + filled(points, [b, *left[::-1], a])
        yield np.array(triangles)
        triangles = mended(points, triangles, done)
        yield np.array(triangles)


def banks(points, hit, a, b):
    """The vertices on both sides of a segment, from triangle to triangle; one that juts out may come twice."""
    left, right, waiting, front = [], [], list(hit), {a}
    while True:
        triangle = next(t for t in waiting if front <= set(t))
        waiting.remove(triangle)
        for v in set(triangle) - front:
            if v == b:
                return right, left
            (left if fm.orient(points[a], points[b], points[v]) > 0 else right).append(v)
        front = {left[-1], right[-1]}


def filled(points, chain):
    """A polygon whose last side leads back to its start: the corner whose circle is empty, then what is left on both sides."""
    first, last = chain[0], chain[-1]
    if len(chain) < 3:
        return []
    k = 1
    for i in range(2, len(chain) - 1):
        if fm.in_circle(points[last], points[first], points[chain[k]], points[chain[i]]):
            k = i
    return [(last, first, chain[k]), *filled(points, chain[: k + 1]), *filled(points, chain[k:])]


# ---- carve, right --------------------------------------------------------------------------------------


def by_flood(points, triangles, segments):
    return SOLVED["carve"](points, triangles, segments)


def by_a_ray(points, triangles, segments):
    """From the middle of each triangle to the left, in fractions."""
    walls = [[[Fraction(x) for x in points[v]] for v in s] for s in on_loops(segments)]
    kept = set()
    for t in triangles:
        x, y = (sum(map(Fraction, values)) / 3 for values in zip(*(points[v] for v in t), strict=True))
        crossed = [a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]) < x for a, b in walls if (a[1] <= y) != (b[1] <= y)]
        if sum(crossed) % 2 or not walls:
            kept.add(t)
    return kept


def by_layers(points, triangles, segments):
    """Layer after layer, in arrays: each layer is all that can be reached without crossing one wall more."""
    walls, rows = on_loops(segments), np.array(triangles)
    side = np.full(len(rows), -1)
    beside = {}
    for i, t in enumerate(triangles):
        for e in edges_of([t]):
            beside.setdefault(e, []).append(i)
    queue = deque((pair[0], int(e in walls)) for e, pair in beside.items() if len(pair) == 1)
    while queue:
        i, k = queue.popleft()
        if side[i] < 0:
            side[i] = k
            for e in edges_of([triangles[i]]):
                queue.extend((j, k ^ (e in walls)) for j in beside[e] if j != i)
    return rows[side == 1] if walls else rows


def by_recursion(points, triangles, segments):
    walls = on_loops(segments)
    inside = {}

    def flood(t, is_in):
        if t not in inside:
            inside[t] = is_in
            for e in edges_of([t]):
                for other in triangles:
                    if other != t and e <= set(other):
                        flood(other, is_in != (e in walls))

    for t in triangles:
        for e in edges_of([t]):
            if len(across(triangles, e)) == 1:
                flood(t, e in walls)
    return [t for t in triangles if inside[t] or not walls]


# ---- mesh_of, right ------------------------------------------------------------------------------------


def in_two_steps(points, triangles, outline):
    return SOLVED["mesh_of"](points, triangles, outline)


def in_a_loop(points, triangles, outline):
    states = mended_after_each_segment(points, triangles, outline)
    while (state := next(states, None)) is not None:
        triangles = [tuple(t) for t in state]
    return by_a_ray(points, triangles, outline)


def in_one_line(points, triangles, outline):
    return by_layers(points, [*map(tuple, [*with_polygons(points, triangles, outline)][-1].tolist())], outline)


# ---- wrong ---------------------------------------------------------------------------------------------


def segments_not_mended(points, triangles, segments):
    for s in map(frozenset, segments):
        crossing = deque(e for e in edges_of(triangles) if cross(points, s, e))
        while crossing:
            e = crossing.popleft()
            if cross(points, e, across(triangles, e)):
                other = frozenset(across(triangles, e))
                triangles = flip(triangles, e)
                yield triangles
                e = other
            if cross(points, s, e):
                crossing.append(e)


def segments_mended_away(points, triangles, segments):
    """Legal again, but the segments are flipped away too."""
    *states, last = triangles, *segments_not_mended(points, triangles, segments)
    yield from states[1:]
    yield mended(points, last, set())


def segments_of_any_shape(points, triangles, segments):
    """Flips without asking whether the quadrilateral is convex."""
    for s in map(frozenset, segments):
        crossing = deque(e for e in edges_of(triangles) if cross(points, s, e))
        while crossing:
            e = crossing.popleft()
            other = frozenset(across(triangles, e))
            triangles = flip(triangles, e)
            yield triangles
            if cross(points, s, other):
                crossing.append(other)


def segments_given_up(points, triangles, segments):
    """An edge that cannot be flipped now is not tried again."""
    for s in map(frozenset, segments):
        for e in [e for e in edges_of(triangles) if cross(points, s, e)]:
            if cross(points, e, across(triangles, e)):
                triangles = flip(triangles, e)
                yield triangles
    yield mended(points, triangles, set(map(frozenset, segments)))


def segments_waited_for(points, triangles, segments):
    """The same edge again and again, if it cannot be flipped yet."""
    for s in map(frozenset, segments):
        crossing = [e for e in edges_of(triangles) if cross(points, s, e)]
        while crossing:
            e = crossing.pop()
            if cross(points, e, across(triangles, e)):
                other = frozenset(across(triangles, e))
                triangles = flip(triangles, e)
                yield triangles
                e = other
            if cross(points, s, e):
                crossing.append(e)


def segments_mended_once(points, triangles, segments):
    """Every edge is looked at once; what a flip makes illegal again is left."""
    last = triangles
    for last in segments_not_mended(points, triangles, segments):
        yield last
    for e in sorted(edges_of(last) - set(map(frozenset, segments)), key=sorted):
        if e in edges_of(last) and is_illegal(points, last, e):
            last = flip(last, e)
            yield last


def segments_as_pairs(points, triangles, segments):
    """Compares pairs with edges, which are frozensets: all segments are mended away again."""
    *states, last = triangles, *segments_not_mended(points, triangles, segments)
    yield from states[1:]
    yield mended(points, last, set(map(tuple, segments)))


def segments_only_listed(points, triangles, segments):
    yield segments


def segments_at_once(points, triangles, segments):
    *_, last = [triangles, *with_a_queue(points, triangles, segments)]
    return last


def segments_that_forget(points, triangles, segments):
    """The pieces around a segment only."""
    for state in with_a_queue(points, triangles, segments):
        yield [t for t in state if set(t) & {v for s in segments for v in s}][:3]


def segments_carved_too(points, triangles, segments):
    last = triangles
    for last in with_a_queue(points, triangles, segments):
        yield last
    yield by_flood(points, [tuple(t) for t in last], segments)


def segments_left_out(points, triangles, segments):
    if False:
        yield triangles


def carve_by_corners(points, triangles, segments):
    """Inside are those with all corners on loops: notches stay."""
    on = {v for s in on_loops(segments) for v in s}
    return [t for t in triangles if set(t) <= on]


def carve_the_hull(points, triangles, segments):
    """Only what can be reached from outside goes: holes stay."""
    walls, out = on_loops(segments), set()
    waiting = [t for t in triangles for e in edges_of([t]) if len(across(triangles, e)) == 1 and e not in walls]
    while waiting:
        t = waiting.pop()
        if t not in out:
            out.add(t)
            waiting += [o for o in triangles for e in edges_of([t]) - walls if e <= set(o)]
    return [t for t in triangles if t not in out]


def carve_over_cracks(points, triangles, segments):
    """Every segment counts as a wall."""
    walls = [[points[v] for v in s] for s in segments]
    kept = []
    for t in triangles:
        x, y = (sum(values) / 3 for values in zip(*(points[v] for v in t), strict=True))
        crossed = [a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]) < x for a, b in walls if (a[1] <= y) != (b[1] <= y)]
        if sum(crossed) % 2:
            kept.append(t)
    return kept


def carve_the_rest(points, triangles, segments):
    inside = set(by_flood(points, triangles, segments))
    return [t for t in triangles if t not in inside]


def carve_by_number(points, triangles, segments):
    inside = set(by_flood(points, triangles, segments))
    return [i for i, t in enumerate(triangles) if t in inside]


def carve_with_pairs(points, triangles, segments):
    """Walls that are pairs, compared with edges, which are frozensets: no wall stops the flood."""
    walls, out = set(map(tuple, segments)), set()
    waiting = [t for t in triangles for e in edges_of([t]) if len(across(triangles, e)) == 1 and e not in walls]
    while waiting:
        t = waiting.pop()
        if t not in out:
            out.add(t)
            waiting += [o for o in triangles for e in edges_of([t]) - walls if e <= set(o)]
    return [t for t in triangles if t not in out]


def carve_all(points, triangles, segments):
    return triangles


def carve_nothing_without_loops(points, triangles, segments):
    return by_flood(points, triangles, segments) if on_loops(segments) else []


def carve_in_place(points, triangles, segments):
    inside = set(by_flood(points, triangles, segments))
    triangles[:] = [t for t in triangles if t in inside]


RIGHT = {
    "segments": [with_a_queue, mended_after_each_segment, with_polygons],
    "carve": [by_flood, by_a_ray, by_layers, by_recursion],
}
MESHES = [in_two_steps, in_a_loop, in_one_line]
WRONG = [
    (
        "segments",
        segments_not_mended,
        "which is no segment, should be flipped: vertex ",
    ),
    ("segments", segments_mended_away, "it ended, but segment 0-1 is no edge: edge 2-3 crosses it"),
    (
        "segments",
        segments_of_any_shape,
        'case "a segment across many edges", step 4: you flipped edge 14-15, but its quadrilateral 14, 17, 15, 13 is not',
    ),
    ("segments", segments_mended_once, "which is no segment, should be flipped: vertex "),
    ("segments", segments_as_pairs, "it ended, but segment 0-1 is no edge: edge 2-3 crosses it"),
    ("carve", carve_with_pairs, "triangle (0, 1, 3) lies inside, but you carved it away"),
    ("segments", segments_given_up, "it ended, but segment 0-1 is no edge: edges "),
    ("segments", segments_waited_for, "more than it can need: when does its loop end?"),
    ("segments", segments_only_listed, "step 1: you yielded a list that holds (1, 3), which is no triangle (a, b, c)"),
    ("segments", segments_at_once, "returned a list of length 2, but it is to be a generator: `yield` the current state"),
    ("segments", segments_that_forget, "of the convex hull is missing: the triangles must cover the hull"),
    ("segments", segments_carved_too, "of the convex hull is missing: the triangles must cover the hull"),
    ("segments", segments_left_out, "it ended, but segment 0-1 is no edge: edge 2-3 crosses it"),
    ("carve", carve_by_corners, "triangle (2, 4, 3) lies outside or in a hole, but you kept it"),
    ("carve", carve_the_hull, 'case "a square with a hole": triangle (4, 5, 6) lies outside or in a hole, but you kept it'),
    ("carve", carve_over_cracks, 'case "loose points and a crack": triangle (1, 2, 4) lies inside, but you carved it away'),
    ("carve", carve_the_rest, "triangle (0, 1, 3) lies inside, but you carved it away"),
    ("carve", carve_by_number, "you returned a list that holds 0 where a triangle (a, b, c) should be"),
    ("carve", carve_all, "triangle (2, 4, 3) lies outside or in a hole, but you kept it"),
    (
        "carve",
        carve_nothing_without_loops,
        'case "segments, but no loop": triangle (0, 1, 4) lies inside, but you carved it away',
    ),
    ("carve", carve_in_place, "you returned None, not the list of all triangles"),
]
