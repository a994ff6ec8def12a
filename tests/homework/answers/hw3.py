"""Homework 3: Bowyer and Watson."""

from itertools import combinations, pairwise

import numpy as np

import fem_mesh as fm
from answers import given_in

GHOST = -1
SOLVED = given_in("hw3_bowyer_watson", solved=True)

# ---- cavity, right -------------------------------------------------------------------------------------


def cavity_in_lists(points, triangles, p):
    return [t for t in triangles if fm.in_circle(*(points[v] for v in t), p)]


def cavity_in_sets(points, triangles, p):
    return {frozenset(t) for t in triangles} - {frozenset(t) for t in triangles if not holds(points, t, p)}


def cavity_in_an_array(points, triangles, p):
    rows = np.array(triangles).reshape(-1, 3)
    return rows[[holds(points, row, p) for row in rows.tolist()]] if len(rows) else rows


def cavity_by_growing(points, triangles, p):
    """From neighbour to neighbour, since a cavity hangs together."""
    found = []

    def grow(t):
        if t not in found and holds(points, t, p):
            found.append(t)
            for other in triangles:
                if len(set(other) & set(t)) == 2:
                    grow(other)

    for t in triangles:
        grow(t)
    return found


def holds(points, t, p):
    return fm.in_circle(*(points[v] for v in t), p)


# ---- bowyer_watson, right ------------------------------------------------------------------------------


def sides(t):
    a, b, c = t
    return [(a, b), (b, c), (c, a)]


def rim_of(gone):
    edges = [edge for t in gone for edge in sides(t)]
    return [(u, v) for u, v in edges if (v, u) not in edges]


def on_a_line(points):
    return all(fm.orient(points[0], points[1], p) == 0 for p in points)


def with_ghosts(points):
    return SOLVED["bowyer_watson"](points)


def with_a_triangle_at_the_horizon(points, far=2.0**80, strict=True):
    """A super-triangle so far away that no circle of doubles as they are here reaches it; signs are exact."""
    n, places = len(points), [*points, (-far, -far), (far, -far), (0, far)]
    triangles = [(n, n + 1, n + 2)]
    for p in range(n):
        gone = [t for t in triangles if holds(places, t, places[p])]
        triangles = [t for t in triangles if t not in gone] + [(u, v, p) for u, v in rim_of(gone)]
        yield [t for t in triangles if max(t) < n] if strict else triangles


def with_flips(points):
    """Join the new point to what it sees, in an array, then flip: Lawson's way to insert."""
    triangles = set()
    for n in range(3, len(points) + 1):
        if not triangles:
            if on_a_line(points[:n]):
                yield np.zeros((0, 3), int)
                continue
            *line, tip = *sorted(range(n - 1), key=lambda v: points[v]), n - 1
            triangles = {frozenset((u, v, tip)) for u, v in pairwise(line)}
        else:
            triangles = joined(points, triangles, n - 1)
        for s, t in flips_needed(points, triangles):
            triangles = triangles - {s, t} | {(s ^ t) | {v} for v in s & t}
        yield np.array([sorted(t) for t in triangles])


def flips_needed(points, triangles):
    """Pairs to flip, one after the other."""
    now, again = set(triangles), True
    while again:
        again = False
        for s, t in combinations(sorted(now, key=sorted), 2):
            if len(s & t) == 2 and {s, t} <= now and illegal(points, *(s & t), *(s ^ t)):
                now = now - {s, t} | {(s ^ t) | {v} for v in s & t}
                again = True
                yield s, t


def illegal(points, a, b, c, d):
    a, b, c, d = (points[v] for v in (a, b, c, d))
    return fm.in_circle(a, b, c, d) if fm.orient(a, b, c) > 0 else fm.in_circle(b, a, c, d)


def joined(points, triangles, new):
    """With the new point joined: inside a triangle, on an edge, or outside to each hull edge that it sees."""
    turned = [t if fm.orient(*(points[v] for v in t)) > 0 else t[::-1] for t in map(tuple, triangles)]
    p = points[new]
    hit = [t for t in turned if all(fm.orient(points[u], points[v], p) >= 0 for u, v in sides(t))]
    if hit:
        rim = [(u, v) for u, v in rim_of(hit) if fm.orient(points[u], points[v], p)]
        return {frozenset(t) for t in turned if t not in hit} | {frozenset((u, v, new)) for u, v in rim}
    seen = [(u, v) for u, v in rim_of(turned) if fm.orient(points[u], points[v], p) < 0]
    return {frozenset(t) for t in turned} | {frozenset((u, v, new)) for u, v in seen}


def with_empty_circles(points):
    """No insertion at all: of every three corners the circle is tried; ties are broken by flips of a first guess."""
    for n in range(3, len(points) + 1):
        *_, last = [None, *with_flips(points[:n])]
        yield fm.Step("insert", f"point {n - 1}", points=points, triangles=[tuple(t) for t in last.tolist()])


# ---- wrong ---------------------------------------------------------------------------------------------


def cavity_of_the_triangle(points, triangles, p):
    return [t for t in triangles if all(fm.orient(points[u], points[v], p) > 0 for u, v in sides(t))]


def cavity_of_numbers(points, triangles, p):
    return [i for i, t in enumerate(triangles) if holds(points, t, p)]


def cavity_kept(points, triangles, p):
    return [t for t in triangles if not holds(points, t, p)]


def cavity_only_first(points, triangles, p):
    return next((t for t in triangles if holds(points, t, p)), None)


def cavity_with_room(points, triangles, p):
    """A tolerance on the generous side: what lies on a circle is dug too."""
    return [t for t in triangles if fm.textbook.in_circle(*(points[v] for v in t), p, tolerance=-1e-9)]


def cavity_with_a_tolerance(points, triangles, p):
    return [t for t in triangles if fm.textbook.in_circle(*(points[v] for v in t), p)]


def cavity_changed(points, triangles, p):
    for t in triangles:
        if holds(points, t, p):
            triangles.remove(t)
    return triangles


def near_super_triangle(points):
    return with_a_triangle_at_the_horizon(points, far=100.0)


def far_super_triangle(points):
    return with_a_triangle_at_the_horizon(points, far=1e4)


def super_triangle_a_million_times_as_large(points):
    return with_a_triangle_at_the_horizon(points, far=1e6)


def super_triangle_a_billion_times_as_large(points):
    return with_a_triangle_at_the_horizon(points, far=1e9)


def super_triangle_left_in(points):
    return with_a_triangle_at_the_horizon(points, strict=False)


def bowyer_watson_of_the_first(points):
    """Only the triangle that holds the point goes, not the others whose circles hold it."""
    n, far = len(points), 2.0**80
    places = [*points, (-far, -far), (far, -far), (0, far)]
    triangles = [(n, n + 1, n + 2)]
    for p in range(n):
        gone = [t for t in triangles if all(fm.orient(places[u], places[v], places[p]) >= 0 for u, v in sides(t))][:1]
        triangles = [t for t in triangles if t not in gone] + [(u, v, p) for u, v in rim_of(gone)]
        yield [t for t in triangles if max(t) < n]


def bowyer_watson_of_all_edges(points):
    """Edges between two triangles that go are joined too."""
    n, far = len(points), 2.0**80
    places = [*points, (-far, -far), (far, -far), (0, far)]
    triangles = [(n, n + 1, n + 2)]
    for p in range(n):
        gone = [t for t in triangles if holds(places, t, places[p])]
        triangles = [t for t in triangles if t not in gone] + [(u, v, p) for t in gone for u, v in sides(t)]
        yield [t for t in triangles if max(t) < n]


def bowyer_watson_that_keeps(points):
    """What should go stays."""
    n, far = len(points), 2.0**80
    places = [*points, (-far, -far), (far, -far), (0, far)]
    triangles = [(n, n + 1, n + 2)]
    for p in range(n):
        gone = [t for t in triangles if holds(places, t, places[p])]
        triangles += [(u, v, p) for u, v in rim_of(gone)]
        yield [t for t in triangles if max(t) < n]


def bowyer_watson_with_a_tolerance(points):
    n, far = len(points), 1e15
    places = [*points, (-far, -far), (far, -far), (0, far)]
    triangles = [(n, n + 1, n + 2)]
    for p in range(n):
        gone = [t for t in triangles if fm.textbook.in_circle(*(places[v] for v in t), places[p])]
        triangles = [t for t in triangles if t not in gone] + [(u, v, p) for u, v in rim_of(gone)]
        yield [t for t in triangles if max(t) < n]


def ghosts_closed(points):
    """The ghost's half-plane with its whole line: a point in line with a hull edge, beyond it, is in."""

    def hit(t, p):
        while GHOST in t[:2]:
            t = t[1:] + t[:1]
        a, b = points[t[0]], points[t[1]]
        return fm.in_circle(a, b, points[t[2]], p) if t[2] != GHOST else fm.orient(a, b, p) >= 0

    return grown(points, hit)


def ghosts_open(points):
    """The ghost's open half-plane only: a point on a hull edge is not outside of it."""

    def hit(t, p):
        while GHOST in t[:2]:
            t = t[1:] + t[:1]
        a, b = points[t[0]], points[t[1]]
        return fm.in_circle(a, b, points[t[2]], p) if t[2] != GHOST else fm.orient(a, b, p) > 0

    return grown(points, hit)


def no_outside(points):
    """No ghosts: a point outside all circles is lost."""

    def hit(t, p):
        return GHOST not in t and fm.in_circle(*(points[v] for v in t), p)

    return grown(points, hit)


def grown(points, hit):
    if on_a_line(points):
        return
    k = next(k for k in range(2, len(points)) if fm.orient(points[0], points[1], points[k]))
    a, b = (0, 1) if fm.orient(points[0], points[1], points[k]) > 0 else (1, 0)
    triangles = [(a, b, k), (b, a, GHOST), (k, b, GHOST), (a, k, GHOST)]
    for p in range(2, len(points)):
        if p != k:
            gone = [t for t in triangles if hit(t, points[p])]
            triangles = [t for t in triangles if t not in gone] + [(u, v, p) for u, v in rim_of(gone)]
        if p >= k:
            yield [t for t in triangles if GHOST not in t]


def starts_with_the_first_three(points):
    """Whatever they are: on a line they make a flat triangle."""
    triangles = [(0, 1, 2), (1, 0, GHOST), (2, 1, GHOST), (0, 2, GHOST)]
    yield [(0, 1, 2)]
    for p in range(3, len(points)):
        gone = [t for t in triangles if SOLVED["in_conflict"](points, t, points[p])]
        triangles = [t for t in triangles if t not in gone] + [(u, v, p) for u, v in rim_of(gone)]
        yield [t for t in triangles if GHOST not in t]


def forgets_the_line(points):
    """Of the points on the first line only two get a triangle."""
    k = next((k for k, p in enumerate(points) if fm.orient(points[0], points[1], p)), None)
    if k is None:
        return
    a, b = (0, 1) if fm.orient(points[0], points[1], points[k]) > 0 else (1, 0)
    triangles = [(a, b, k), (b, a, GHOST), (k, b, GHOST), (a, k, GHOST)]
    for p in range(k, len(points)):
        if p > k:
            gone = [t for t in triangles if SOLVED["in_conflict"](points, t, points[p])]
            triangles = [t for t in triangles if t not in gone] + [(u, v, p) for u, v in rim_of(gone)]
        yield [t for t in triangles if GHOST not in t]


def ghosts_only_last(points):
    """Looks for the ghost in the last place only."""

    def hit(t, p):
        a, b = points[t[0]], points[t[1]]
        return fm.in_circle(a, b, points[t[2]], p) if t[2] != GHOST else SOLVED["in_conflict"](points, t, p)

    return grown(points, hit)


def only_the_last(points):
    *_, last = [[], *with_ghosts(points)]
    yield last


def sorted_first(points):
    """Another order than the given one."""
    order = sorted(range(len(points)), key=lambda v: points[v])
    for triangles in with_ghosts([points[v] for v in order]):
        yield [tuple(order[v] for v in t) for t in triangles]


def all_at_once(points):
    return [*with_ghosts(points)][-1]


RIGHT = {
    "cavity": [cavity_in_lists, cavity_in_sets, cavity_in_an_array, cavity_by_growing],
    "bowyer_watson": [with_ghosts, with_a_triangle_at_the_horizon, with_flips, with_empty_circles],
}
WRONG = [
    ("cavity", cavity_of_the_triangle, "is missing: the point (2.5, 1) lies inside its circle"),
    ("cavity", cavity_of_numbers, "you returned a list that holds 0 where a triangle (a, b, c) should be"),
    ("cavity", cavity_kept, "triangle (0, 1, 3) is missing: the point"),
    ("cavity", cavity_only_first, "where a triangle (a, b, c) should be"),
    ("cavity", cavity_with_room, "is too much: the point (0, 0) lies on its circle, not inside"),
    (
        "cavity",
        cavity_with_a_tolerance,
        "triangle (0, 1, 2) is missing: the point (0, -4.999999999999998) lies inside its circle",
    ),
    ("cavity", cavity_changed, "triangle (0, 1, 3) is missing: the point"),
    (
        "bowyer_watson",
        near_super_triangle,
        'case "a flat hull: the circles there are huge", step 3: edge 0-1 of the convex hull is missing',
    ),
    (
        "bowyer_watson",
        far_super_triangle,
        'case "a flat hull: the circles there are huge", step 3: edge 0-1 of the convex hull is missing',
    ),
    (
        "bowyer_watson",
        super_triangle_a_million_times_as_large,
        "step 3: edge 0-1 of the convex hull is missing: the triangles must cover the hull: if you use a super-triangle, it is",
    ),
    (
        "bowyer_watson",
        super_triangle_a_billion_times_as_large,
        "step 3: edge 0-1 of the convex hull is missing: the triangles must cover the hull: if you use a super-triangle, it is",
    ),
    (
        "bowyer_watson",
        forgets_the_line,
        'case "the first points on a line", step 1: edge 3-4 of the convex hull is missing: the triangles must cover the hull: '
        "if you use a super-triangle, it is too near; if ghosts, an edge of the hull has none",
    ),
    ("bowyer_watson", ghosts_only_last, "raised MeshError: in_circle needs a counter-clockwise triangle"),
    (
        "bowyer_watson",
        super_triangle_left_in,
        "has corner 3, but the points are numbered from 0 to 2: leave out the triangles that hang on a super-triangle",
    ),
    ("bowyer_watson", bowyer_watson_of_the_first, "of the convex hull is missing: the triangles must cover the hull"),
    ("bowyer_watson", bowyer_watson_of_all_edges, "raised MeshError: in_circle needs a counter-clockwise triangle"),
    ("bowyer_watson", bowyer_watson_that_keeps, "triangle (0, 1, 2) should have gone: the new point 3 lies inside its circle"),
    (
        "bowyer_watson",
        bowyer_watson_with_a_tolerance,
        "triangle (0, 2, 1) should have gone: the new point 4 lies inside its circle",
    ),
    ("bowyer_watson", ghosts_closed, 'case "the first points on a line", step 1: '),
    (
        "bowyer_watson",
        ghosts_open,
        "triangle (1, 2, 3) is flat: the new point 3 lies on the line through 1 and 2, so this edge must not be joined to it",
    ),
    ("bowyer_watson", no_outside, "triangles (2, 3, 1) and (2, 3, 0) overlap: both lie on the same side of edge 2-3"),
    ("bowyer_watson", starts_with_the_first_three, "raised MeshError: in_circle needs a counter-clockwise triangle"),
    ("bowyer_watson", only_the_last, "uses point 3, but the points so far are 0 to 2: each yield has one more"),
    ("bowyer_watson", sorted_first, "uses point 3, but the points so far are 0 to 2: each yield has one more"),
    ("bowyer_watson", all_at_once, "returned a list of length 1, but it is to be a generator: `yield` the current state"),
]
