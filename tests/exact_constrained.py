"""What makes a mesh of a domain right, in Python's integers and fractions: slow, and independent of fem_mesh.

``domain`` is anything with ``points``, ``segments``, ``toggles`` and ``holes``: a Recipe of ours or a fem_mesh.Domain.
``mesh`` is anything with ``points``, ``triangles``, ``neighbors``, ``segments`` (and, after refinement, ``refinement``).
"""

import functools
import math
from collections import defaultdict
from fractions import Fraction
from itertools import pairwise

import exact
import numpy as np
import triangle as shewchuk
from faces import Faces

NEAR = 2.0**-45  # points made on a segment lie within this share of the domain's size of it, or
ROUNDING = 2.0**-49  # this share of the largest coordinate: sixteen roundings, far from the origin
BRUTE = 200  # up to so many points every vertex is tried against every circle
EYES = 51  # numbers are multiplied by this, so that the points looked from are whole
LATITUDE = 1e-7  # degrees, for angles measured in floats
SAME_AREA = 2.0**-40  # relative, after refinement
SHARP = 60  # degrees: corners below it are small input angles
SHELL = 2e-3  # relative: "at equal distance from their corner"


# --- a triangulation ---


def check_realisation(mesh, closed=True):
    """Counter-clockwise triangles, side by side around each vertex; neighbors and segments tell of them truly.

    ``closed``: whether the boundary is made of segments, as it is of all but a convex hull without loops.
    """
    triangles, segments = mesh.triangles.tolist(), [tuple(s) for s in mesh.segments.tolist()]
    left = check_triangles(mesh.points, triangles)
    owner = {edge: t for t, abc in enumerate(triangles) for edge in edges_of(abc)}
    expected = [[owner.get(edge[::-1], -1) for edge in edges_of(abc)[1:] + edges_of(abc)[:1]] for abc in triangles]
    assert mesh.neighbors.tolist() == expected, "neighbors are not those of the triangles"
    unordered = [frozenset(s) for s in segments]
    assert len(set(unordered)) == len(unordered), "a segment is listed twice"
    for a, b in segments:
        assert (a, b) in left or (b, a) in left, f"segment {a}-{b} is no edge"
    boundary = [edge for edge in left if edge[::-1] not in left]
    assert not closed or {frozenset(edge) for edge in boundary} <= set(unordered), "part of the boundary is no segment"
    check_no_crossings(mesh.points, segments)


def check_triangles(points, triangles):
    """Counter-clockwise, and disjoint around each vertex. Returns the apex on the left of each directed edge."""
    whole = exact.integers(np.nan_to_num(points).tolist())
    for abc in triangles:
        assert exact.turn(*(whole[v] for v in abc)) > 0, f"triangle {tuple(abc)} is not counter-clockwise"
    around = defaultdict(list)
    for abc in triangles:
        for (a, b), (_, c) in zip(edges_of(abc), edges_of(abc)[1:] + edges_of(abc)[:1], strict=True):
            around[a].append((difference(whole[b], whole[a]), difference(whole[c], whole[a])))
    for v, wedges in around.items():
        wedges.sort(key=functools.cmp_to_key(lambda one, other: by_angle(one[0], other[0])))
        for (start, end), (other, _) in zip(wedges, wedges[1:] + wedges[:1], strict=True):
            inside = cross(start, other) > 0 and cross(other, end) > 0
            same = cross(start, other) == 0 and dot(start, other) > 0
            assert len(wedges) == 1 or not (inside or same), f"triangles overlap at vertex {v}"
    return exact.apexes(triangles)


def edges_of(abc):
    a, b, c = abc
    return [(a, b), (b, c), (c, a)]


def difference(a, b):
    return a[0] - b[0], a[1] - b[1]


def cross(u, v):
    return u[0] * v[1] - u[1] * v[0]


def dot(u, v):
    return u[0] * v[0] + u[1] * v[1]


def by_angle(u, v):
    """Compare directions by their angle in 0 .. 360 degrees."""
    halves = [w[1] < 0 or (w[1] == 0 and w[0] < 0) for w in (u, v)]
    return halves[0] - halves[1] or -exact.sign(cross(u, v))


def check_no_crossings(points, edges):
    """No two edges meet but in a common end: a sweep over their extents."""
    whole = exact.integers(points.tolist())
    spans = sorted((*sorted((whole[a], whole[b])), a, b) for a, b in edges)
    active = []
    for p, q, a, b in spans:
        active = [other for other in active if other[1][0] >= p[0]]
        for r, s, c, d in active:
            if max(p[1], q[1]) < min(r[1], s[1]) or max(r[1], s[1]) < min(p[1], q[1]):
                continue
            turns = [exact.sign(exact.turn(*abc)) for abc in ((p, q, r), (p, q, s), (r, s, p), (r, s, q))]
            apart = turns[0] * turns[1] > 0 or turns[2] * turns[3] > 0
            shared = len({p, q} & {r, s}) == 1 and (any(turns) or q == r or s == p)
            assert apart or shared, f"segments {a}-{b} and {c}-{d} meet"
        active.append((p, q, a, b))


def check_constrained_delaunay(points, triangles, segments):
    """No circle holds a vertex that can be seen from inside its triangle past the segments.

    Across each edge that is no segment, it is enough to look at the next vertex (Lee and Lin 1986). Small
    sets are tried again by force: every vertex inside a circle is looked at from points of the triangle.
    """
    whole, left, fixed = exact.integers(points.tolist()), exact.apexes(triangles), {frozenset(s) for s in segments}
    for (a, b), c in left.items():
        if a < b and (b, a) in left and frozenset((a, b)) not in fixed:
            d = left[b, a]
            assert exact.inside(*(whole[v] for v in (a, b, c, d))) <= 0, f"the circle of {(a, b, c)} holds {d} across {a}-{b}"
    if len(points) <= BRUTE:
        check_every_visible_vertex(whole, triangles, segments)


def check_every_visible_vertex(whole, triangles, segments):
    used = sorted({v for abc in triangles for v in abc})
    whole = [(EYES * x, EYES * y) for x, y in whole]
    walls = [(whole[a], whole[b]) for a, b in segments]
    for abc in triangles:
        corners = [whole[v] for v in abc]
        p, q, r, s = exact.plane(*corners)
        for v in used:
            x, y = whole[v]
            if v not in abc and p * x + q * y + r * exact.lift((x, y)) < s:
                for eye in eyes(corners):
                    assert not sees(eye, (x, y), walls), f"the circle of {tuple(abc)} holds {v}, which can be seen from it"


def eyes(corners):
    """Points inside a triangle: its centroid, and one near the middle of each side."""
    for weights in ((17, 17, 17), (24, 24, 3), (24, 3, 24), (3, 24, 24)):
        yield tuple(sum(w * c[k] for w, c in zip(weights, corners, strict=True)) // EYES for k in (0, 1))


def sees(eye, vertex, walls):
    """Whether nothing of any wall lies between, not even an end (unless it is the vertex)."""
    for a, b in walls:
        if vertex in (a, b):
            other = b if vertex == a else a
            if exact.turn(eye, vertex, other) != 0 or dot(difference(other, eye), difference(other, vertex)) > 0:
                continue
            return False
        sides = exact.sign(exact.turn(a, b, eye)) * exact.sign(exact.turn(a, b, vertex))
        if sides <= 0 and exact.sign(exact.turn(eye, vertex, a)) * exact.sign(exact.turn(eye, vertex, b)) <= 0:
            return False
    return True


# --- a domain ---


def area_of(mesh):
    """The sum of the triangles' areas, a fraction."""
    whole = exact.integers(mesh.points.tolist())
    twice = sum(exact.turn(*(whole[v] for v in abc)) for abc in mesh.triangles.tolist())
    return Fraction(twice, 2 * whole_unit(mesh.points) ** 2)


def check_area(domain, mesh):
    """The triangles cover exactly what the segments enclose."""
    expected, found = Faces(domain).area, area_of(mesh)
    assert found == expected, f"the mesh has area {float(found)}, the domain {float(expected)}"


def check_points(domain, mesh):
    """Of the points given, those in the domain and on its boundary are vertices, and no others."""
    faces = Faces(domain)
    given = dict(zip(map(tuple, domain.points.tolist()), faces.whole, strict=True))
    expected, used = {p for p, w in given.items() if faces.holds(w)}, set(vertices(mesh))
    assert expected <= used, f"points {sorted(expected - used)[:3]} of the domain are in no triangle"
    assert used & set(given) <= expected, f"points {sorted(used & set(given) - expected)[:3]} lie outside"


def vertices(mesh):
    """The number of each vertex in use, by its coordinates."""
    return {tuple(mesh.points[v].tolist()): v for v in np.unique(mesh.triangles).tolist()}


def pieces_of(domain, faces):
    """For each row its pieces between given points that lie on it: triples (start, end, whether the domain has it)."""
    low = {p: i for i, p in reversed(list(enumerate(faces.whole)))}
    result = []
    for i, j in domain.segments.tolist():
        a, b = faces.whole[i], faces.whole[j]
        on = {q for q in low if exact.turn(a, b, q) == 0 and dot(difference(q, a), difference(q, b)) < 0} | {a, b}
        chain = sorted(on, key=lambda q: dot(difference(q, a), difference(b, a)))
        result.append([(low[p], low[q], any(map(faces.kept, faces.beside(*sorted((p, q)))))) for p, q in pairwise(chain)])
    return result


def check_boundary_chains(domain, mesh):
    """Each segment of the domain is there, as chains of the mesh's segments; and the mesh has no others.

    A chain goes from one end to the other, always forward, within 2^-45 of the domain's size of the segment. Returns
    the vertices of each row's chains, a list of lists.
    """
    faces, number = Faces(domain), vertices(mesh)
    near, whole = defaultdict(list), exact.integers(mesh.points.tolist())
    for a, b in mesh.segments.tolist():
        near[a].append(b)
        near[b].append(a)
    reach = latitude(domain) * Fraction(whole_unit(mesh.points))
    curved = getattr(domain, "curves", None) or {}
    chains, used = [], set()
    for row, pieces in enumerate(pieces_of(domain, faces)):
        chains.append([])
        for start, end, there in pieces:
            if there:
                start, end = (number.get(tuple(domain.points[v].tolist()), -1) for v in (start, end))
                assert min(start, end) >= 0, f"an end of row {row} is no vertex"
                chain = straight_chain(whole, near, start, end, reach)
                chain = curved_chain(mesh, row, start, end) if row in curved and not chain else chain
                assert chain, f"row {row}: no chain of segments leads from point {start} to {end}"
            chains[-1] += chain if there else []
            used |= {frozenset(edge) for edge in pairwise(chain)} if there else set()
    extra = [tuple(s) for s in mesh.segments.tolist() if frozenset(s) not in used]
    assert not extra, f"segments {extra[:3]} of the mesh lie on no segment of the domain"
    return chains


def latitude(domain):
    """How far from its segment a made point may lie: 2^-45 of the domain's size, or a few roundings of its coordinates."""
    size, far = np.ptp(domain.points, axis=0).max(), np.abs(domain.points).max()
    return Fraction(max(size * NEAR, far * ROUNDING))


def whole_unit(points):
    """What exact.integers multiplies by."""
    return max((x.as_integer_ratio()[1] for x in points.ravel().tolist()), default=1)


def straight_chain(whole, near, start, end, reach):
    """The vertices of a chain of segments from ``start`` forward to ``end`` close to the line between them, or []."""
    a, along = whole[start], difference(whole[end], whole[start])
    square, allowed = dot(along, along), reach * reach * dot(along, along)
    stack, seen = [[start]], {start}
    while stack:
        chain = stack.pop()
        if chain[-1] == end:
            return chain
        ahead = [w for w in near[chain[-1]] if w not in seen and dot(difference(whole[w], whole[chain[-1]]), along) > 0]
        ahead = [w for w in ahead if dot(difference(whole[w], a), along) <= square]
        off = {w: abs(cross(along, difference(whole[w], a))) for w in ahead}
        ahead = [w for w in ahead if off[w] ** 2 <= allowed]
        seen.update(ahead)
        stack += [[*chain, w] for w in sorted(ahead, key=lambda w: -off[w])]
    return []


def curved_chain(mesh, row, start, end):
    """The chain of the mesh's segments that say they lie on ``row``."""
    near = defaultdict(list)
    for (a, b), own in zip(mesh.segments.tolist(), mesh.segment_of.tolist(), strict=True):
        if own == row:
            near[a].append(b)
            near[b].append(a)
    chain = [start]
    while chain[-1] != end:
        onward = [w for w in near[chain[-1]] if w not in chain[-2:]]
        assert len(onward) == 1, f"row {row}: its curve does not lead from point {chain[-1]} to {end}"
        chain.append(onward[0])
    return chain


def triangle_count(domain, flags="pQ"):
    """How many triangles Triangle makes of the domain; what has even parity is given to it as holes."""
    return len(triangulated(domain, flags)["triangles"])


def triangulated(domain, flags="pQ"):
    """Triangle's own mesh of the domain. Its C code ends the process on what it cannot do."""
    points, segments = distinct(domain)
    seeds = Faces(domain).seeds()
    given = {"vertices": points, "segments": segments}
    return shewchuk.triangulate(given | ({"holes": np.array(seeds)} if seeds else {}), flags)


def distinct(domain):
    """Points and rows without equal ones, which Triangle takes badly."""
    given = list(map(tuple, domain.points.tolist()))
    number = {p: i for i, p in enumerate(dict.fromkeys(given))}
    segments = [tuple(sorted(number[given[v]] for v in row)) for row in domain.segments.tolist()]
    return np.array(list(number)), np.array([row for row in dict.fromkeys(segments) if row[0] != row[1]])


# --- refinement ---


def validate_refinement(
    domain, mesh, *, min_angle, max_area=None, size=None, max_points=None, encroachment="lens", base=None, everywhere=True
):
    """All that a refined mesh must be, in nine points. ``base``: the points refined, if not the domain's.

    ``everywhere``: False where only a part was refined, so that bounds hold nowhere else.
    """
    base = domain.points if base is None else base
    check_realisation(mesh)  # 1
    check_constrained_delaunay(mesh.points, mesh.triangles.tolist(), mesh.segments.tolist())  # 2
    chains = check_boundary_chains(domain, mesh)  # 3
    check_area_after_splits(domain, mesh)  # 4
    if everywhere:
        check_angles(mesh, min_angle)  # 5
        check_sizes(mesh, max_area, size)  # 6
        check_no_segment_is_encroached(mesh, min_angle, encroachment)  # 7
    check_budget(domain, mesh, base, max_points)  # 8
    check_excuses(domain, mesh, chains)  # 9


def check_area_after_splits(domain, mesh):
    """The boundary is made of pieces that toggle; the area of a straight domain is within 2^-40 of the domain's."""
    if getattr(domain, "curves", None):
        return
    expected, found = Faces(domain).area, area_of(mesh)
    left = exact.apexes(mesh.triangles.tolist())
    boundary = np.array([edge for edge in left if edge[::-1] not in left]).reshape(-1, 2)
    length = np.hypot(*(mesh.points[boundary[:, 0]] - mesh.points[boundary[:, 1]]).T).sum()
    rounding = 4 * np.spacing(np.abs(domain.points).max()) * length
    error = abs(found - expected)
    assert error <= SAME_AREA * float(expected) + rounding, f"the area is off by {float(error)} of {float(expected)}"


def angles_of(mesh):
    """The angles in degrees, (m, 3)."""
    corners = mesh.points[mesh.triangles]
    u, v = np.roll(corners, -1, axis=1) - corners, np.roll(corners, -2, axis=1) - corners
    return np.degrees(np.arctan2(np.abs(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]), (u * v).sum(axis=-1)))


def sides_of(mesh):
    """The length of the side opposite each corner, (m, 3)."""
    corners = mesh.points[mesh.triangles]
    across = np.roll(corners, -1, axis=1) - np.roll(corners, -2, axis=1)
    return np.hypot(across[..., 0], across[..., 1])


def not_left(mesh):
    left = np.zeros(len(mesh.triangles), bool)
    left[mesh.refinement.left] = True
    return ~left


def check_angles(mesh, min_angle):
    smallest = angles_of(mesh).min(axis=1)
    bad = np.flatnonzero(not_left(mesh) & (smallest < min_angle - LATITUDE))
    assert not len(bad), f"triangle {bad[0]} has an angle of {smallest[bad[0]]} and is not among those left"


def check_sizes(mesh, max_area, size):
    corners, bound = mesh.points[mesh.triangles], not_left(mesh)
    if max_area is not None:
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        areas = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
        bad = np.flatnonzero(bound & (areas > max_area * (1 + 1e-12)))
        assert not len(bad), f"triangle {bad[0]} has area {areas[bad[0]]}, more than {max_area}"
    if size is not None:
        wanted = size if callable(size) else lambda x, y: np.full(x.shape, float(size))
        places = np.concatenate([corners, corners.mean(axis=1, keepdims=True)], axis=1)
        least = wanted(places[..., 0], places[..., 1]).min(axis=1)
        bad = np.flatnonzero(bound & (sides_of(mesh).max(axis=1) > least * (1 + 1e-12)))
        assert not len(bad), f"triangle {bad[0]} has a longer edge than {least[bad[0]]}"


def check_no_segment_is_encroached(mesh, min_angle, encroachment):
    """By the vertices on its two sides: if any visible vertex encroaches, one of these does."""
    if not mesh.refinement.complete:
        return
    whole, left = exact.integers(mesh.points.tolist()), exact.apexes(mesh.triangles.tolist())
    for s in mesh.segments.tolist():
        for a, b in (s, s[::-1]):
            if (a, b) in left:
                apex, points = left[a, b], mesh.points
                if encroachment == "circle":
                    assert exact.sees_wide(whole[a], whole[b], whole[apex]) <= 0, f"{apex} encroaches segment {a}-{b}"
                else:
                    seen = angle_at(points[apex], points[a], points[b])
                    assert seen < 180 - 2 * min_angle + 1e-9, f"{apex} sees segment {a}-{b} under {seen} degrees"


def angle_at(p, a, b):
    """The angle, in degrees, under which p sees a and b."""
    u, v = a - p, b - p
    return math.degrees(math.atan2(abs(u[0] * v[1] - u[1] * v[0]), float(u @ v)))


def check_budget(domain, mesh, base, max_points):
    added = mesh.refinement.added
    assert len(mesh.points) == len(base) + added, f"{len(mesh.points)} points are not {len(base)} + {added}"
    assert mesh.points[: len(base)].tobytes() == np.asarray(base).tobytes(), "the points given are not as they were"
    assert max_points is None or added <= max_points, f"{added} points added, more than {max_points}"
    check_points(domain, mesh)
    unused = set(range(len(base), len(mesh.points))) - set(mesh.triangles.ravel().tolist())
    assert not unused, f"added points {sorted(unused)[:5]} are in no triangle"


def check_excuses(domain, mesh, chains):
    """What is left for a small input angle is excused by one; and only then is the refinement complete."""
    refinement = mesh.refinement
    assert len(refinement.left) == len(refinement.why)
    assert len(set(np.asarray(refinement.left).tolist())) == len(refinement.left)
    assert set(refinement.why) <= {"small input angle", "budget", "precision"}
    excused = all(why == "small input angle" for why in refinement.why)
    assert refinement.complete == excused, f"complete is {refinement.complete}, with {set(refinement.why)} left"
    rows_at = defaultdict(set)
    for row, chain in enumerate(chains):
        for v in chain:
            rows_at[v].add(row)
    given = {v for p, v in vertices(mesh).items() if p in set(map(tuple, domain.points.tolist()))}
    segments = {frozenset(s) for s in mesh.segments.tolist()}
    for t, why in zip(np.asarray(refinement.left).tolist(), refinement.why, strict=True):
        if why == "small input angle":
            assert is_excused(mesh, t, chains, rows_at, given, segments), f"triangle {t} is not excused by a small input angle"


def is_excused(mesh, t, chains, rows_at, given, segments):
    """Whether the smallest angle is one between segments, or faces an edge between two shells of a sharp corner."""
    abc, lengths = mesh.triangles[t].tolist(), sides_of(mesh)[t]
    k = int(np.argmin(lengths))
    r, p, q = abc[k], abc[(k + 1) % 3], abc[(k + 2) % 3]
    if {frozenset((r, p)), frozenset((r, q))} <= segments:
        return True
    for one in rows_at[p]:
        for other in rows_at[q] - {one}:
            for corner in set(chains[one]) & set(chains[other]) & given - {p, q}:
                u, v = np.hypot(*(mesh.points[p] - mesh.points[corner])), np.hypot(*(mesh.points[q] - mesh.points[corner]))
                sharp = angle_at(mesh.points[corner], mesh.points[p], mesh.points[q]) < SHARP + 1e-9
                if sharp and abs(u - v) <= SHELL * max(u, v):
                    return True
    return False


def check_regions(mesh, seeds):
    """``regions`` is 1 + k on all that can be reached from seed k without crossing a segment, 0 elsewhere."""
    fixed, whole = {frozenset(s) for s in mesh.segments.tolist()}, exact.integers([*mesh.points.tolist(), *seeds])
    expected = [0] * len(mesh.triangles)
    for k, seed in enumerate(whole[len(mesh.points) :]):
        corners = ((t, [whole[v] for v in abc]) for t, abc in enumerate(mesh.triangles.tolist()))
        start = next(
            t for t, (a, b, c) in corners if min(exact.turn(a, b, seed), exact.turn(b, c, seed), exact.turn(c, a, seed)) >= 0
        )
        stack, seen = [start], {start}
        while stack:
            t = stack.pop()
            expected[t] = k + 1
            a, b, c = mesh.triangles[t].tolist()
            for other, edge in zip(mesh.neighbors[t].tolist(), ((b, c), (c, a), (a, b)), strict=True):
                if other >= 0 and other not in seen and frozenset(edge) not in fixed:
                    seen.add(other)
                    stack.append(other)
    assert mesh.regions.tolist() == expected
