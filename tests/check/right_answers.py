"""Right answers of several kinds: with sets, with arrays, with recursion, in another order."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

import fem_mesh as fm

# ---- predicates --------------------------------------------------------------------------------------


def orient_in_fractions(a, b, c):
    (ax, ay), (bx, by), (cx, cy) = ((Fraction(x), Fraction(y)) for x, y in (a, b, c))
    return (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)


def orient_as_sign(a, b, c):
    return np.sign(float(np.sign(orient_in_fractions(a, b, c))))


def orient_in_integers(a, b, c):
    ratios = [value.as_integer_ratio() for point in (a, b, c) for value in point]
    scale = max(bottom for _, bottom in ratios)
    ax, ay, bx, by, cx, cy = (top * (scale // bottom) for top, bottom in ratios)
    return (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)


def orient_as_infinities(a, b, c):
    turn = orient_in_fractions(a, b, c)
    return float("inf") if turn > 0 else -float("inf") if turn < 0 else 0.0


def in_circle_in_fractions(a, b, c, d):
    rows = []
    for p in (a, b, c):
        x, y = Fraction(p[0]) - Fraction(d[0]), Fraction(p[1]) - Fraction(d[1])
        rows.append((x, y, x * x + y * y))
    (ax, ay, al), (bx, by, bl), (cx, cy, cl) = rows
    return ax * (by * cl - bl * cy) - ay * (bx * cl - bl * cx) + al * (bx * cy - by * cx) > 0


def in_circle_as_numpy(a, b, c, d):
    return np.bool_(fm.in_circle(a, b, c, d))


def in_circle_by_centre(a, b, c, d):
    """Compares squared distances from the centre, in fractions."""
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = ((Fraction(x), Fraction(y)) for x, y in (a, b, c, d))
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    twice = 2 * (ux * vy - uy * vx)
    u, v = ux * ux + uy * uy, vx * vx + vy * vy
    x, y = (vy * u - uy * v) / twice, (ux * v - vx * u) / twice
    return (dx - ax - x) ** 2 + (dy - ay - y) ** 2 < x * x + y * y


# ---- Lawson ------------------------------------------------------------------------------------------


def apexes(triangles):
    apex = {}
    for a, b, c in triangles:
        apex[a, b], apex[b, c], apex[c, a] = c, a, b
    return apex


def lawson_with_lists(points, triangles, backwards=False, kept=()):
    triangles = list(triangles)
    while True:
        for (a, b), c in sorted(apexes(triangles).items(), reverse=backwards):
            d = apexes(triangles).get((b, a))
            if d is None or (a, b) in kept or (b, a) in kept:
                continue
            if fm.in_circle(points[a], points[b], points[c], points[d]):
                triangles = [t for t in triangles if not {a, b} <= set(t)] + [(a, d, c), (d, b, c)]
                yield triangles
                break
        else:
            return


def lawson_backwards(points, triangles):
    for state in lawson_with_lists(points, triangles, backwards=True):
        yield [(c, b, a) for a, b, c in state[::-1]]


def lawson_with_sets(points, triangles):
    """A work list of edges; yields one and the same set, which it changes."""
    triangles = {frozenset(t) for t in triangles}
    waiting = [frozenset(e) for t in triangles for e in edges_of(t)]
    while waiting:
        edge = waiting.pop()
        pair = [t for t in triangles if edge <= t]
        if len(pair) < 2:
            continue
        a, b = edge
        (c,), (d,) = (t - edge for t in pair)
        if fm.orient(points[a], points[b], points[c]) < 0:
            a, b = b, a
        if fm.in_circle(points[a], points[b], points[c], points[d]):
            triangles -= set(pair)
            triangles |= {frozenset((a, c, d)), frozenset((b, c, d))}
            waiting += [frozenset(e) for e in ((a, c), (c, b), (b, d), (d, a))]
            yield triangles


def edges_of(triangle):
    a, b, c = triangle
    return (a, b), (b, c), (c, a)


def lawson_recursive(points, triangles):
    triangles = np.array(triangles)

    def legalize(a, b):
        apex = apexes(triangles.tolist())
        c, d = apex.get((a, b)), apex.get((b, a))
        if c is None or d is None or not fm.in_circle(points[a], points[b], points[c], points[d]):
            return
        rows = [i for i, t in enumerate(triangles.tolist()) if {a, b} <= set(t)]
        triangles[rows[0]], triangles[rows[1]] = (a, d, c), (d, b, c)
        yield triangles
        for edge in ((a, d), (d, b), (b, c), (c, a)):
            yield from legalize(*edge)

    for a, b in list(apexes(triangles.tolist())):
        yield from legalize(a, b)


def lawson_with_steps(points, triangles):
    for state in lawson_with_lists(points, triangles):
        yield fm.Step("flip", points=points, triangles=state)
        last = state
    return last if "last" in locals() else triangles


def lawson_that_returns_its_flips(points, triangles):
    flips = []
    for state in lawson_with_lists(points, triangles):
        yield state
        flips.append((0, 1))
    return flips


def flip_with_lists(points, triangles, edge):
    a, b = edge
    apex = apexes(triangles)
    c, d = apex.get((a, b)), apex.get((b, a))
    if c is None or d is None or not crosses(points, a, b, c, d):
        return None
    return [t for t in triangles if not {a, b} <= set(t)] + [(a, d, c), (d, b, c)]


def flip_with_sets(points, triangles, edge):
    """By areas: the new triangles must both turn left."""
    a, b = edge
    triangles = {frozenset(t) for t in triangles}
    pair = [t for t in triangles if {a, b} <= t]
    if len(pair) == 2:
        (c,), (d,) = (t - {a, b} for t in pair)
        if fm.orient(points[c], points[d], points[a]) * fm.orient(points[c], points[d], points[b]) < 0:
            return triangles - set(pair) | {frozenset((a, c, d)), frozenset((b, c, d))}


def flip_in_an_array(points, triangles, edge):
    flipped = flip_with_lists(points, triangles, edge)
    return None if flipped is None else np.array(flipped)[::-1, ::-1]


def cavity_with_lists(points, triangles, p):
    return [t for t in triangles if fm.in_circle(*(points[v] for v in t), p)]


def cavity_with_sets(points, triangles, p):
    return {frozenset(t) for t in cavity_with_lists(points, triangles, p)}


def cavity_as_array(points, triangles, p):
    rows = np.array(triangles)
    return rows[[in_circle_in_fractions(*(points[v] for v in t), p) for t in triangles]]


# ---- Bowyer and Watson -------------------------------------------------------------------------------

GHOST = -1


def bowyer_watson_with_ghosts(points):
    triangles, waiting = set(), []
    for p in range(len(points)):
        if triangles:
            insert(p, points, triangles)
        else:
            waiting.append(p)
            begin(waiting, points, triangles)
        yield {t for t in triangles if GHOST not in t}


def begin(waiting, points, triangles):
    a, p = waiting[0], waiting[-1]
    for b in waiting[1:-1]:
        turn = fm.orient(points[a], points[b], points[p])
        if turn:
            a, b = (a, b) if turn > 0 else (b, a)
            triangles |= {(a, b, p), (b, a, GHOST), (p, b, GHOST), (a, p, GHOST)}
            for q in waiting:
                if q not in (a, b, p):
                    insert(q, points, triangles)
            return


def insert(p, points, triangles):
    cavity = {t for t in triangles if is_in_conflict(t, p, points)}
    sides = {e for t in cavity for e in edges_of(t)}
    triangles -= cavity
    triangles |= {(a, b, p) for a, b in sides if (b, a) not in sides}


def is_in_conflict(t, p, points):
    if GHOST not in t:
        return fm.in_circle(*(points[v] for v in t), points[p])
    i = t.index(GHOST)
    a, b = points[t[(i + 1) % 3]], points[t[(i + 2) % 3]]
    turn = fm.orient(a, b, points[p])
    return turn > 0 or (turn == 0 and fm.in_diametral_circle(a, b, points[p]))


def bowyer_watson_super_triangle(points):
    n, far = len(points), 2.0**60
    places = [*points, (-far, -far), (far, -far), (0.0, far)]
    triangles = [(n, n + 1, n + 2)]
    for p in range(n):
        cavity = [t for t in triangles if fm.in_circle(*(places[v] for v in t), places[p])]
        sides = [e for t in cavity for e in edges_of(t)]
        triangles = [t for t in triangles if t not in cavity]
        triangles += [(a, b, p) for a, b in sides if (b, a) not in sides]
        yield np.array([t for t in triangles if max(t) < n], int).reshape(-1, 3)


def bowyer_watson_by_recursion(points):
    """Digs from triangle to triangle; yields nothing until there is a triangle."""
    triangles, waiting = set(), []
    for p in range(len(points)):
        if not triangles:
            waiting.append(p)
            begin(waiting, points, triangles)
        else:
            apex = apexes(triangles)
            start = next(t for t in triangles if is_in_conflict(t, p, points))
            cavity, ring = set(), []

            def dig(t, cavity=cavity, ring=ring, apex=apex, p=p):
                cavity.add(frozenset(t))
                for a, b in edges_of(t):
                    across = (b, a, apex[b, a])
                    if frozenset(across) not in cavity:
                        if is_in_conflict(across, p, points):
                            dig(across)
                        else:
                            ring.append((a, b))

            dig(start)
            triangles -= {t for t in triangles if frozenset(t) in cavity}
            triangles |= {(a, b, p) for a, b in ring if frozenset((b, a, apex[b, a])) not in cavity}
        if triangles:
            yield fm.Step("insert", points=points, triangles=[list(t) for t in triangles if GHOST not in t])


# ---- segments ----------------------------------------------------------------------------------------


def crosses(points, a, b, c, d):
    if {a, b} & {c, d}:
        return False
    turns = [fm.orient(*(points[v] for v in t)) for t in ((a, b, c), (a, b, d), (c, d, a), (c, d, b))]
    return turns[0] * turns[1] < 0 and turns[2] * turns[3] < 0


def segments_by_flips(points, triangles, segments):
    """Sloan 1993: flip what crosses, then what is not Delaunay, segment by segment."""
    kept = []
    for a, b in segments:
        waiting = [e for e in apexes(triangles) if e[0] < e[1] and crosses(points, a, b, *e)]
        while waiting:
            u, v = waiting.pop(0)
            apex = apexes(triangles)
            c, d = apex[u, v], apex[v, u]
            if not crosses(points, u, v, c, d):
                waiting.append((u, v))
                continue
            triangles = [t for t in triangles if not {u, v} <= set(t)] + [(u, d, c), (d, v, c)]
            yield triangles
            if crosses(points, a, b, c, d):
                waiting.append((c, d))
        kept.append((a, b))
        states = [triangles, *lawson_with_lists(points, triangles, kept=kept)]
        yield from states[1:]
        triangles = states[-1]


def segments_at_once(points, triangles, segments):
    """Yields the end only, as an array."""
    *_, last = [triangles, *segments_by_flips(points, triangles, segments)]
    yield np.array(last)


def segments_by_holes(points, triangles, segments):
    """Anglada 1997: take out what a segment crosses, and fill both holes by recursion."""
    triangles = {tuple(t) for t in triangles}

    def fill(chain):
        if len(chain) < 3:
            return
        a, b = chain[0], chain[-1]
        best = 1
        for i in range(2, len(chain) - 1):
            if fm.in_circle(points[a], points[chain[best]], points[b], points[chain[i]]):
                best = i
        triangles.add((a, chain[best], b))
        fill(chain[: best + 1])
        fill(chain[best:])

    for a, b in segments:
        apex = apexes(triangles)
        start = [(u, v) for (u, v), w in apex.items() if w == a and crosses(points, a, b, u, v)]
        for u, v in start:
            right, left = [a, u], [a, v]
            triangles.remove(next(t for t in triangles if set(t) == {a, u, v}))
            while (w := apex[v, u]) != b:
                triangles.remove(next(t for t in triangles if set(t) == {w, u, v}))
                if fm.orient(points[a], points[b], points[w]) > 0:
                    v = w
                    left.append(w)
                else:
                    u = w
                    right.append(w)
            triangles.remove(next(t for t in triangles if set(t) == {b, u, v}))
            fill([*right, b])
            fill([b, *left[::-1]])
        yield triangles


# ---- carving -----------------------------------------------------------------------------------------


def carve_by_rays(points, triangles, segments):
    loops = on_loops(segments)
    if not loops:
        return triangles
    inside = []
    for t in triangles:
        x, y = (sum(Fraction(points[v][k]) for v in t) / 3 for k in (0, 1))
        crossed = 0
        for a, b in loops:
            (ax, ay), (bx, by) = ([Fraction(value) for value in points[v]] for v in (a, b))
            crossed += (ay <= y) != (by <= y) and x < ax + (y - ay) * (bx - ax) / (by - ay)
        if crossed % 2:
            inside.append(t)
    return inside


def on_loops(segments):
    """Without the open chains: what has a free end goes, again and again."""
    segments = list(segments)
    while True:
        ends = [v for s in segments for v in s]
        left = [s for s in segments if all(ends.count(v) > 1 for v in s)]
        if left == segments:
            return segments
        segments = left


def carve_by_flood(points, triangles, segments):
    loops = {frozenset(s) for s in on_loops(segments)}
    if not loops:
        return np.array(triangles)
    beside = {}
    for t in triangles:
        for e in edges_of(t):
            beside.setdefault(frozenset(e), []).append(t)
    depth, queue = {}, []
    for e, pair in beside.items():
        if len(pair) == 1:
            queue.append((pair[0], int(e in loops)))
    while queue:
        t, d = queue.pop()
        if t not in depth:
            depth[t] = d
            for e in map(frozenset, edges_of(t)):
                queue += [(s, d ^ (e in loops)) for s in beside[e] if s != t]
    return np.array([t for t in triangles if depth[t]])


def carve_as_a_set(points, triangles, segments):
    return {(c, a, b) for a, b, c in carve_by_rays(points, triangles, segments)}


# ---- Ruppert -----------------------------------------------------------------------------------------


def encroached_with_lists(points, segments):
    return [(a, b) for a, b in segments if any(fm.in_diametral_circle(points[a], points[b], p) for p in others(points, a, b))]


def others(points, a, b):
    return [p for v, p in enumerate(points) if v not in (a, b)]


def encroached_by_distance(points, segments):
    found = set()
    for a, b in segments:
        (ax, ay), (bx, by) = ([Fraction(x) for x in points[v]] for v in (a, b))
        for x, y in others(points, a, b):
            x, y = Fraction(x), Fraction(y)
            if (2 * x - ax - bx) ** 2 + (2 * y - ay - by) ** 2 < (bx - ax) ** 2 + (by - ay) ** 2:
                found.add((b, a))
    return found


def encroached_as_array(points, segments):
    return np.array(encroached_with_lists(points, segments)[::-1]).reshape(-1, 2)


def cdt(points, pieces, carved=True):
    if not carved:
        return [tuple(t) for t in fm.delaunay(points).triangles.tolist()]
    return [tuple(t) for t in fm.constrained_delaunay(fm.Domain(points, pieces)).triangles.tolist()]


def smallest_angle(points, t):
    return angle_of(*(np.array(points[v]) for v in t))


def angle_of(a, b, c):
    def at(p, q, r):
        u, v = q - p, r - p
        return np.degrees(np.arccos(np.clip(u @ v / np.sqrt((u @ u) * (v @ v)), -1, 1)))

    return min(at(a, b, c), at(b, c, a), at(c, a, b))


def center_of(a, b, c):
    (ax, ay), (bx, by), (cx, cy) = (a, b, c)
    d = 2 * (ax * (by - cy) + bx * (cy - ay) + cx * (ay - by))
    x = ((ax * ax + ay * ay) * (by - cy) + (bx * bx + by * by) * (cy - ay) + (cx * cx + cy * cy) * (ay - by)) / d
    y = ((ax * ax + ay * ay) * (cx - bx) + (bx * bx + by * by) * (ax - cx) + (cx * cx + cy * cy) * (bx - ax)) / d
    return x, y


def ruppert_from_scratch(points, segments, min_angle, carved=True, first=True, worst=True):
    points, pieces = list(points), list(segments)
    triangles = cdt(points, pieces, carved)
    if first:
        yield points, triangles
    while True:
        new = next_vertex(points, pieces, triangles, min_angle, worst)
        if new is None:
            return
        points = [*points, new]
        triangles = cdt(points, pieces, carved)
        yield points, triangles


def next_vertex(points, pieces, triangles, min_angle, worst):
    hit = encroached_with_lists(points, pieces)
    if not hit:
        bad = [(smallest_angle(points, t), t) for t in triangles]
        bad = sorted(pair for pair in bad if pair[0] < min_angle)
        if not bad:
            return None
        x, y = center_of(*(points[v] for v in bad[0 if worst else -1][1]))
        hit = [(a, b) for a, b in pieces if fm.in_diametral_circle(points[a], points[b], (x, y))]
        if not hit:
            return x, y
    a, b = hit[0 if worst else -1]
    pieces.remove((a, b))
    pieces += [(a, len(points)), (len(points), b)]
    (ax, ay), (bx, by) = points[a], points[b]
    return (ax + bx) / 2, (ay + by) / 2


def ruppert_other_order(points, segments, min_angle):
    for places, triangles in ruppert_from_scratch(points, segments, min_angle, first=False, worst=False):
        yield np.array(places), np.array(triangles)


def ruppert_with_steps(points, segments, min_angle):
    for places, triangles in ruppert_from_scratch(points, segments, min_angle):
        yield fm.Step("insert", points=places, triangles=set(triangles))


RIGHT = {
    "orient": [fm.orient, orient_in_fractions, orient_as_infinities, orient_as_sign, orient_in_integers],
    "in_circle": [fm.in_circle, in_circle_in_fractions, in_circle_as_numpy, in_circle_by_centre],
    "flip": [flip_with_lists, flip_with_sets, flip_in_an_array],
    "cavity": [cavity_with_lists, cavity_with_sets, cavity_as_array],
    "lawson": [
        lawson_with_lists,
        lawson_backwards,
        lawson_with_sets,
        lawson_recursive,
        lawson_with_steps,
        lawson_that_returns_its_flips,
    ],
    "bowyer_watson": [bowyer_watson_with_ghosts, bowyer_watson_super_triangle, bowyer_watson_by_recursion],
    "segments": [segments_by_flips, segments_at_once, segments_by_holes],
    "carve": [carve_by_rays, carve_by_flood, carve_as_a_set],
    "encroached": [encroached_with_lists, encroached_by_distance, encroached_as_array],
    "ruppert": [ruppert_from_scratch, ruppert_other_order, ruppert_with_steps],
}
