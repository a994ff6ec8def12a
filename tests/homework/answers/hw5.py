"""Homework 5: Ruppert's refinement."""

from fractions import Fraction

import numpy as np

import fem_mesh as fm
from answers import given_in

GIVEN = given_in("hw5_ruppert")
SOLVED = given_in("hw5_ruppert", solved=True)
Delaunay, smallest_angle, inside, circumcenter = (
    GIVEN[name] for name in ("Delaunay", "smallest_angle", "inside", "circumcenter")
)

# ---- encroached, right ---------------------------------------------------------------------------------


def with_a_dot_product(points, segments):
    return SOLVED["encroached"](points, segments)


def with_an_array(points, segments):
    p, s = np.array(points), np.array(segments)
    dots = ((p[s[:, :1]] - p) * (p[s[:, 1:]] - p)).sum(axis=2)
    return s[(dots < 0).any(axis=1)]


def with_a_set_of_fractions(points, segments):
    exact = [tuple(map(Fraction, p)) for p in points]
    found = set()
    for s in segments:
        (ax, ay), (bx, by) = (exact[v] for v in s)
        middle, radius = ((ax + bx) / 2, (ay + by) / 2), ((ax - bx) ** 2 + (ay - by) ** 2) / 4
        if any((x - middle[0]) ** 2 + (y - middle[1]) ** 2 < radius for x, y in exact):
            found.add(frozenset(s))
    return found


def with_the_library(points, segments):
    return [s for s in segments if any(fm.in_diametral_circle(*(points[v] for v in s), p) for p in points)]


# ---- ruppert, right ------------------------------------------------------------------------------------


def as_handed_out(points, segments, min_angle):
    yield from SOLVED["ruppert"](points, segments, min_angle)


def midpoint(p, q):
    return (p[0] + q[0]) / 2, (p[1] + q[1]) / 2


def rounds(points, segments, min_angle, choose=min, split=max):
    """``choose`` picks a bad triangle by its angle, ``split`` a segment."""
    mesh, segments = Delaunay(points), {tuple(s) for s in segments}
    while True:
        hit = with_a_dot_product(mesh.points, sorted(segments))
        if not hit:
            corners = [[mesh.points[v] for v in t] for t in inside(mesh.points, mesh.triangles, segments)]
            bad = [t for t in corners if smallest_angle(*t) < min_angle]
            if not bad:
                return
            new = circumcenter(*choose(bad, key=lambda t: smallest_angle(*t)))
            hit = with_a_dot_product([*mesh.points, new], sorted(segments))
        if hit:
            a, b = split(hit)
            new, m = midpoint(mesh.points[a], mesh.points[b]), len(mesh.points)
            segments = segments - {(a, b)} | {(a, m), (m, b)}
        mesh.add(new)
        yield mesh


def the_worst_first(points, segments, min_angle):
    for mesh in rounds(points, segments, min_angle):
        yield fm.Step("insert", "one more", points=mesh.points, triangles=mesh.triangles)


def the_best_first_in_arrays(points, segments, min_angle):
    for mesh in rounds(points, segments, min_angle, choose=max, split=min):
        yield np.array(mesh.points), np.array(mesh.triangles)


def by_recursion(points, segments, min_angle):
    """Each round is a call; the triangulation is begun anew, in another way each time."""
    found = Delaunay(points)
    hit = with_a_dot_product(points, segments)
    if not hit:
        bad = [t for t in inside(points, found.triangles, segments) if smallest_angle(*(points[v] for v in t)) < min_angle]
        if not bad:
            return
        new = circumcenter(*(points[v] for v in bad[-1]))
        hit = with_a_dot_product([*points, new], segments)
    if hit:
        a, b = hit[-1]
        new = midpoint(points[a], points[b])
        segments = [s for s in segments if s != (a, b)] + [(a, len(points)), (len(points), b)]
    points = [*points, new]
    yield points, {frozenset(t) for t in Delaunay(points).triangles}
    yield from by_recursion(points, segments, min_angle)


def carved(points, segments, min_angle):
    """Yields what lies inside, once the segments are all there; before that the whole hull."""
    pieces = [tuple(s) for s in segments]
    for mesh in rounds(points, segments, min_angle):
        pieces = split_at(mesh.points, pieces)
        edges = {frozenset(e) for t in mesh.triangles for e in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))}
        whole = all(frozenset(s) in edges for s in pieces)
        yield mesh.points, inside(mesh.points, mesh.triangles, pieces) if whole else mesh.triangles


def split_at(points, pieces):
    m = len(points) - 1
    hit = [s for s in pieces if midpoint(points[s[0]], points[s[1]]) == points[m]]
    return [s for s in pieces if s not in hit] + [piece for a, b in hit for piece in ((a, m), (m, b))]


# ---- wrong ---------------------------------------------------------------------------------------------


def encroached_not_strict(points, segments):
    found = []
    for a, b in segments:
        (ax, ay), (bx, by) = points[a], points[b]
        others = [p for v, p in enumerate(points) if v not in (a, b)]
        if any((ax - x) * (bx - x) + (ay - y) * (by - y) <= 0 for x, y in others):
            found.append((a, b))
    return found


def encroached_with_its_ends(points, segments):
    found = []
    for a, b in segments:
        (ax, ay), (bx, by) = points[a], points[b]
        if any((ax - x) * (bx - x) + (ay - y) * (by - y) <= 0 for x, y in points):
            found.append((a, b))
    return found


def encroached_by_distance(points, segments):
    """Within a diameter of the middle, not within a radius."""
    found = []
    for a, b in segments:
        middle, length = midpoint(points[a], points[b]), np.hypot(*np.subtract(points[a], points[b]))
        if any(v not in (a, b) and np.hypot(*np.subtract(p, middle)) < length for v, p in enumerate(points)):
            found.append((a, b))
    return found


def encroached_with_a_tolerance(points, segments):
    found = []
    for a, b in segments:
        (ax, ay), (bx, by) = points[a], points[b]
        if any((ax - x) * (bx - x) + (ay - y) * (by - y) < -1e-12 for x, y in points):
            found.append((a, b))
    return found


def encroached_in_numbers(points, segments):
    found = with_a_dot_product(points, segments)
    return [i for i, s in enumerate(segments) if s in found]


def encroached_by_whom(points, segments):
    return [v for v, p in enumerate(points) if any(fm.in_diametral_circle(*(points[w] for w in s), p) for s in segments)]


def encroached_for_each_point(points, segments):
    """As often as there are points inside."""
    return [s for s in segments for p in points if fm.in_diametral_circle(*(points[v] for v in s), p)]


def encroached_or_not(points, segments):
    return bool(with_a_dot_product(points, segments))


def centres_only(points, segments, min_angle):
    """Without a rule: circumcenters leave the domain."""
    mesh = Delaunay(points)
    for _ in range(20):
        bad = [t for t in mesh.triangles if smallest_angle(*(mesh.points[v] for v in t)) < min_angle]
        if not bad:
            return
        mesh.add(circumcenter(*(mesh.points[v] for v in bad[0])))
        yield mesh.points, mesh.triangles


def centres_that_encroach(points, segments, min_angle):
    """Segments are split where a vertex encroaches, but nobody asks about the new centre."""
    mesh, segments = Delaunay(points), list(segments)
    for _ in range(60):
        hit = with_a_dot_product(mesh.points, segments)
        if hit:
            (a, b), m = hit[0], len(mesh.points)
            new = midpoint(mesh.points[a], mesh.points[b])
            segments = [s for s in segments if s != (a, b)] + [(a, m), (m, b)]
        else:
            found = inside(mesh.points, mesh.triangles, segments)
            bad = [t for t in found if smallest_angle(*(mesh.points[v] for v in t)) < min_angle]
            if not bad:
                return
            new = circumcenter(*(mesh.points[v] for v in bad[0]))
        mesh.add(new)
        yield mesh.points, mesh.triangles


def centroids(points, segments, min_angle):
    return with_centre(points, segments, min_angle, lambda a, b, c: tuple(np.mean([a, b, c], axis=0).tolist()))


def with_centre(points, segments, min_angle, centre, bound=None):
    mesh, segments = Delaunay(points), list(segments)
    for _ in range(60):
        hit = with_a_dot_product(mesh.points, segments)
        if not hit:
            found = inside(mesh.points, mesh.triangles, segments)
            bad = [t for t in found if smallest_angle(*(mesh.points[v] for v in t)) < (bound or min_angle)]
            if not bad:
                return
            new = centre(*(mesh.points[v] for v in bad[0]))
            hit = with_a_dot_product([*mesh.points, new], segments)
        if hit:
            (a, b), m = hit[0], len(mesh.points)
            new = midpoint(mesh.points[a], mesh.points[b])
            segments = [s for s in segments if s != (a, b)] + [(a, m), (m, b)]
        mesh.add(new)
        yield mesh.points, mesh.triangles


def a_wrong_determinant(points, segments, min_angle):
    """A sign is wrong in the formula of the centre."""

    def centre(a, b, c):
        (bx, by), (cx, cy) = ((p[0] - a[0], p[1] - a[1]) for p in (b, c))
        bb, cc, twice = bx * bx + by * by, cx * cx + cy * cy, 2 * (bx * cy + by * cx)
        return a[0] + (bb * cy - cc * by) / twice, a[1] + (cc * bx - bb * cx) / twice

    return with_centre(points, segments, min_angle, centre)


def keeps_the_segment(points, segments, min_angle):
    """A segment is split, but its halves do not take its place."""
    mesh = Delaunay(points)
    for _ in range(5):
        hit = with_a_dot_product(mesh.points, segments)
        if not hit:
            return
        mesh.add(midpoint(*(mesh.points[v] for v in hit[0])))
        yield mesh.points, mesh.triangles


def refines_outside(points, segments, min_angle):
    """`inside` is forgotten."""
    mesh, segments = Delaunay(points), list(segments)
    for _ in range(60):
        hit = with_a_dot_product(mesh.points, segments)
        if not hit:
            bad = [t for t in mesh.triangles if smallest_angle(*(mesh.points[v] for v in t)) < min_angle]
            if not bad:
                return
            new = circumcenter(*(mesh.points[v] for v in bad[0]))
            hit = with_a_dot_product([*mesh.points, new], segments)
        if hit:
            (a, b), m = hit[0], len(mesh.points)
            new = midpoint(mesh.points[a], mesh.points[b])
            segments = [s for s in segments if s != (a, b)] + [(a, m), (m, b)]
        mesh.add(new)
        yield mesh.points, mesh.triangles


def a_forgotten_factor(points, segments, min_angle):
    """2 is forgotten in the formula of the centre."""

    def centre(a, b, c):
        return tuple(2 * y - x for x, y in zip(a, circumcenter(a, b, c), strict=True))

    return with_centre(points, segments, min_angle, centre)


def twenty_built_in(points, segments, min_angle):
    return with_centre(points, segments, 20, circumcenter)


def only_segments_that_are_edges(points, segments, min_angle):
    """A segment that is no edge of the triangles is not split."""
    mesh, segments = Delaunay(points), list(segments)

    def hit_in(places):
        edges = {frozenset((t[i - 1], t[i])) for t in mesh.triangles for i in range(3)}
        return [s for s in with_a_dot_product(places, segments) if frozenset(s) in edges]

    for _ in range(60):
        hit = hit_in(mesh.points)
        if not hit:
            found = inside(mesh.points, mesh.triangles, segments)
            bad = [t for t in found if smallest_angle(*(mesh.points[v] for v in t)) < min_angle]
            if not bad:
                return
            new = circumcenter(*(mesh.points[v] for v in bad[0]))
            hit = hit_in([*mesh.points, new])
        if hit:
            (a, b), m = hit[0], len(mesh.points)
            new = midpoint(mesh.points[a], mesh.points[b])
            segments = [s for s in segments if s != (a, b)] + [(a, m), (m, b)]
        mesh.add(new)
        yield mesh.points, mesh.triangles


def too_modest(points, segments, min_angle):
    return with_centre(points, segments, min_angle, circumcenter, bound=min_angle / 2)


def too_eager(points, segments, min_angle):
    return with_centre(points, segments, min_angle, circumcenter, bound=min_angle + 12)


def splits_at_a_quarter(points, segments, min_angle):
    mesh, segments = Delaunay(points), list(segments)
    while hit := with_a_dot_product(mesh.points, segments):
        (a, b), m = hit[0], len(mesh.points)
        (ax, ay), (bx, by) = mesh.points[a], mesh.points[b]
        mesh.add((ax + (bx - ax) * 0.25, ay + (by - ay) * 0.25))
        segments = [s for s in segments if s != (a, b)] + [(a, m), (m, b)]
        yield mesh.points, mesh.triangles


def splits_everything(points, segments, min_angle):
    mesh = Delaunay(points)
    for a, b in segments:
        mesh.add(midpoint(mesh.points[a], mesh.points[b]))
        yield mesh.points, mesh.triangles


def only_the_segments(points, segments, min_angle):
    mesh, segments = Delaunay(points), list(segments)
    while hit := with_a_dot_product(mesh.points, segments):
        (a, b), m = hit[0], len(mesh.points)
        mesh.add(midpoint(mesh.points[a], mesh.points[b]))
        segments = [s for s in segments if s != (a, b)] + [(a, m), (m, b)]
        yield mesh.points, mesh.triangles


def two_at_a_time(points, segments, min_angle):
    states = [(list(mesh.points), mesh.triangles) for mesh in rounds(points, segments, min_angle)]
    yield from states[1::2]


def only_triangles(points, segments, min_angle):
    for mesh in rounds(points, segments, min_angle):
        yield mesh.triangles


def joined_without_delaunay(points, segments, min_angle):
    """The new point is joined to the triangle that it lies in, and that is all."""
    mesh, segments = Delaunay(points), list(segments)
    triangles = mesh.triangles
    for state in rounds(points, segments, min_angle):
        new = state.points[-1]
        m, hit = len(state.points) - 1, []
        for t in triangles:
            a, b, c = (state.points[v] for v in t)
            if all(fm.orient(u, v, new) >= 0 for u, v in ((a, b), (b, c), (c, a))):
                hit.append(t)
        edges = [e for a, b, c in hit for e in ((a, b), (b, c), (c, a))]
        rim = [(u, v) for u, v in edges if (v, u) not in edges and fm.orient(state.points[u], state.points[v], new)]
        triangles = [t for t in triangles if t not in hit] + [(u, v, m) for u, v in rim]
        yield state.points, triangles


RIGHT = {
    "encroached": [with_a_dot_product, with_an_array, with_a_set_of_fractions, with_the_library],
    "ruppert": [as_handed_out, the_worst_first, the_best_first_in_arrays, by_recursion, carved],
}
WRONG = [
    ("encroached", encroached_not_strict, "no point lies strictly inside the circle over segment 0-1, but you returned it"),
    ("encroached", encroached_with_its_ends, "no point lies strictly inside the circle over segment 0-1, but you returned it"),
    ("encroached", encroached_by_distance, "no point lies strictly inside the circle over segment 1-2, but you returned it"),
    (
        "encroached",
        encroached_with_a_tolerance,
        'case "a point on a circle but for a hair": point 2 lies inside the circle over segment 0-1, but you left it out',
    ),
    ("encroached", encroached_in_numbers, "you returned numbers: return the segments themselves, as pairs (a, b)"),
    ("encroached", encroached_by_whom, "you returned numbers: return the segments themselves, as pairs (a, b)"),
    ("encroached", encroached_for_each_point, "is there more than once: one point inside is enough"),
    ("encroached", encroached_or_not, "you returned False, not the list of all segments"),
    (
        "ruppert",
        centres_only,
        "step 1: you inserted the centre of a circle, but segment 0-1 is encroached upon by vertex 4: it is split first",
    ),
    ("ruppert", centres_that_encroach, "the new point 6 lies inside the circle of segment 1-5: split the segment instead"),
    ("ruppert", centroids, "but neither a vertex nor the centre of a bad triangle's circle lies inside its circle"),
    ("ruppert", a_wrong_determinant, "is neither the midpoint of a segment nor the centre of the circle of a triangle"),
    (
        "ruppert",
        keeps_the_segment,
        "step 2: the new point (2, 0) is vertex 5 again: once a segment is split, its halves take its place in the list",
    ),
    ("ruppert", refines_outside, ", which lies outside the domain: only triangles inside are refined"),
    ("ruppert", a_forgotten_factor, "step 2: the new point (2, 0.5) is vertex 4 again"),
    ("ruppert", twenty_built_in, 'case "two points close together", step '),
    ("ruppert", only_segments_that_are_edges, "segment 4-5 is encroached upon by vertex "),
    ("ruppert", too_modest, "it ended, but triangle (1, 4, 5) has an angle of 14.0 degrees, below 20"),
    ("ruppert", too_eager, "but neither a vertex nor the centre of a bad triangle's circle lies inside its circle"),
    ("ruppert", splits_at_a_quarter, "step 1: the new point (1, 0) is neither the midpoint of a segment nor the centre"),
    (
        "ruppert",
        splits_everything,
        'case "a square, with nothing to do", step 1: you split segment 0-1, but neither a vertex nor',
    ),
    ("ruppert", only_the_segments, "it ended, but triangle (1, 4, 5) has an angle of 14.0 degrees, below 20"),
    ("ruppert", two_at_a_time, "there are 7 points, after 5: each state has one more than the one before"),
    ("ruppert", only_triangles, "step 1: you yielded a list of length 5, not a pair (points, triangles)"),
    (
        "ruppert",
        joined_without_delaunay,
        "step 2: the circle of triangle (1, 4, 6) holds point 2, and no segment lies between them",
    ),
]
