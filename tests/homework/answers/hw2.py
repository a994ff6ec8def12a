"""Homework 2: flips."""

from itertools import combinations

import numpy as np

import fem_mesh as fm

# ---- flip, right ---------------------------------------------------------------------------------------


def flip_in_lists(points, triangles, edge):
    a, b = edge
    beside = [t for t in triangles if a in t and b in t]
    if len(beside) < 2:
        return None
    c, d = (v for t in beside for v in t if v not in edge)
    if not crossing(points, a, b, c, d):
        return None
    return [t for t in triangles if t not in beside] + [(a, d, c), (b, c, d)]


def flip_in_sets(points, triangles, edge):
    edge = frozenset(edge)
    whole = {frozenset(t) for t in triangles}
    pair = {t for t in whole if edge < t}
    if len(pair) != 2:
        return None
    other = frozenset.union(*pair) - edge
    if not crossing(points, *edge, *other):
        return None
    return {tuple(t) for t in whole - pair | {other | {v} for v in edge}}


def flip_in_an_array(points, triangles, edge):
    rows = np.array(triangles)
    beside = np.flatnonzero(np.isin(rows, edge).sum(axis=1) == 2)
    if len(beside) < 2:
        return None
    c, d = rows[beside][~np.isin(rows[beside], edge)]
    if not crossing(points, *edge, c, d):
        return None
    rows[beside] = [(edge[0], c, d), (edge[1], d, c)]
    return rows


def flip_in_place(points, triangles, edge):
    """Corners are exchanged: (a, b, c) becomes (d, b, c) and (b, a, d) becomes (c, a, d)."""
    beside = [i for i, t in enumerate(triangles) if set(edge) <= set(t)]
    if len(beside) < 2:
        return None
    first, second = beside
    (c,), (d,) = (set(triangles[i]) - set(edge) for i in (first, second))
    if not crossing(points, *edge, c, d):
        return None
    triangles[first], triangles[second] = (d, edge[1], c), (c, edge[0], d)
    return triangles


def crossing(points, a, b, c, d):
    a, b, c, d = (points[v] for v in (a, b, c, d))
    return fm.orient(a, b, c) * fm.orient(a, b, d) < 0 and fm.orient(c, d, a) * fm.orient(c, d, b) < 0


# ---- lawson, right -------------------------------------------------------------------------------------


def far_corners(triangles, a, b):
    return [v for t in triangles if a in t and b in t for v in t if v not in (a, b)]


def illegal(points, a, b, c, d):
    a, b, c, d = (points[v] for v in (a, b, c, d))
    return fm.in_circle(a, b, c, d) if fm.orient(a, b, c) > 0 else fm.in_circle(b, a, c, d)


def with_a_stack(points, triangles):
    waiting = [edge for t in triangles for edge in combinations(t, 2)]
    while waiting:
        a, b = waiting.pop()
        far = far_corners(triangles, a, b)
        if len(far) == 2 and illegal(points, a, b, *far):
            triangles = flip_in_lists(points, triangles, (a, b))
            waiting += [(u, v) for u in (a, b) for v in far]
            yield triangles


def with_sweeps(points, triangles):
    """All edges again and again, in sets, the first ones first."""
    triangles = {frozenset(t) for t in triangles}
    changed = True
    while changed:
        changed = False
        for s, t in combinations(sorted(triangles, key=sorted), 2):
            if len(s & t) == 2 and {s, t} <= triangles and illegal(points, *sorted(s & t), *(s ^ t)):
                triangles = triangles - {s, t} | {(s ^ t) | {v} for v in s & t}
                changed = True
                yield {tuple(t) for t in triangles}


def with_the_worst_first(points, triangles):
    """In an array, and in a random order: any order will do."""
    rows, random = np.array(triangles), np.random.default_rng(1)
    while True:
        edges = {tuple(sorted(edge)) for t in rows.tolist() for edge in combinations(t, 2)}
        bad = [e for e in sorted(edges) if len(far := far_corners(rows.tolist(), *e)) == 2 and illegal(points, *e, *far)]
        if not bad:
            return
        rows = flip_in_an_array(points, rows.tolist(), bad[random.integers(len(bad))])
        yield rows


def with_recursion(points, triangles):
    triangles = list(triangles)

    def legalise(a, b):
        far = far_corners(triangles, a, b)
        if len(far) == 2 and illegal(points, a, b, *far):
            triangles[:] = flip_in_lists(points, triangles, (a, b))
            yield fm.Step("flip", f"edge {a}-{b} goes", points=points, triangles=triangles)
            for u in (a, b):
                for v in far:
                    yield from legalise(u, v)

    for t in list(triangles):
        for edge in combinations(t, 2):
            yield from legalise(*edge)


# ---- wrong ---------------------------------------------------------------------------------------------


def flip_only_new(points, triangles, edge):
    found = flip_in_lists(points, triangles, edge)
    return found and found[-2:]


def flip_any(points, triangles, edge):
    far = far_corners(triangles, *edge)
    if len(far) < 2:
        return None
    return [t for t in triangles if not set(edge) <= set(t)] + [(edge[0], *far), (edge[1], *far)]


def flip_on_the_hull(points, triangles, edge):
    c, d = far_corners(triangles, *edge)
    return flip_in_lists(points, triangles, edge) if c != d else None


def flip_not_strictly(points, triangles, edge):
    far = far_corners(triangles, *edge)
    if len(far) < 2:
        return None
    a, b, c, d = (points[v] for v in (*edge, *far))
    if fm.orient(c, d, a) * fm.orient(c, d, b) > 0:
        return None
    return flip_any(points, triangles, edge)


def flip_keeps_old(points, triangles, edge):
    far = far_corners(triangles, *edge)
    if flip_in_lists(points, triangles, edge) is None:
        return None
    return [*triangles, (edge[0], *far), (edge[1], *far)]


def flip_back_again(points, triangles, edge):
    far = far_corners(triangles, *edge)
    if flip_in_lists(points, triangles, edge) is None:
        return None
    return [t for t in triangles if not set(edge) <= set(t)] + [(*edge, v) for v in far]


def flip_the_illegal(points, triangles, edge):
    far = far_corners(triangles, *edge)
    return flip_in_lists(points, triangles, edge) if len(far) == 2 and illegal(points, *edge, *far) else None


def flip_in_secret(points, triangles, edge):
    found = flip_in_lists(points, triangles, edge)
    if found:
        triangles[:] = found


def flip_turned_into_unchanged(points, triangles, edge):
    return flip_in_lists(points, triangles, edge) or triangles


def lawson_of_ties(points, triangles):
    """Flips whenever the other diagonal is legal; of a tie both are."""
    waiting = [edge for t in triangles for edge in combinations(t, 2)]
    while waiting:
        a, b = waiting.pop()
        far = far_corners(triangles, a, b)
        if len(far) == 2 and crossing(points, a, b, *far) and not illegal(points, *far, a, b):
            triangles = flip_in_lists(points, triangles, (a, b))
            waiting += [(u, v) for u in (a, b) for v in far]
            yield triangles


def lawson_once(points, triangles):
    """One pass: what a flip makes illegal again is left."""
    for edge in {tuple(sorted(edge)) for t in triangles for edge in combinations(t, 2)}:
        far = far_corners(triangles, *edge)
        if len(far) == 2 and illegal(points, *edge, *far):
            triangles = flip_in_lists(points, triangles, edge)
            yield triangles


def lawson_of_all_convex(points, triangles):
    for edge in {tuple(sorted(edge)) for t in triangles for edge in combinations(t, 2)}:
        flipped = flip_in_lists(points, triangles, edge)
        if flipped:
            triangles = flipped
            yield triangles


def lawson_at_the_end(points, triangles):
    *_, last = [triangles, *with_a_stack(points, triangles)]
    yield last


def lawson_returned(points, triangles):
    *_, last = [triangles, *with_a_stack(points, triangles)]
    return last


def lawson_of_turns(points, triangles):
    """As if every edge had its triangle on the left: half of the circles are asked the wrong way round."""
    waiting = [edge for t in triangles for edge in combinations(t, 2)]
    while waiting:
        a, b = waiting.pop()
        far = far_corners(triangles, a, b)
        if len(far) == 2 and fm.in_circle(*(points[v] for v in (a, b, *far))):
            triangles = flip_in_lists(points, triangles, (a, b))
            waiting += [(u, v) for u in (a, b) for v in far]
            yield triangles


def lawson_of_flips_that_turn(points, triangles):
    """A flip may turn its triangles either way, as Task 1 says; then they are asked as they are."""
    while True:
        for t in triangles:
            a, b, c = t
            for edge, far in (((a, b), c), ((b, c), a), ((c, a), b)):
                others = [v for v in far_corners(triangles, *edge) if v != far]
                if others and fm.in_circle(*(points[v] for v in t), points[others[0]]):
                    triangles = [s for s in triangles if not set(edge) <= set(s)]
                    triangles += [(edge[0], far, others[0]), (edge[1], far, others[0])]
                    yield triangles
                    break
            else:
                continue
            break
        else:
            return


def lawson_of_edges(points, triangles):
    for state in with_a_stack(points, triangles):
        yield {frozenset(edge) for t in state for edge in combinations(t, 2)}


def lawson_of_the_new(points, triangles):
    for state in with_a_stack(points, triangles):
        yield state[-2:]


def lawson_with_the_start(points, triangles):
    yield triangles
    yield from with_a_stack(points, triangles)


def lawson_past_the_end(points, triangles):
    edges = [edge for t in triangles for edge in combinations(t, 2)]
    for i in range(len(edges) + 1):
        far = far_corners(triangles, *edges[i])
        if len(far) == 2 and illegal(points, *edges[i], *far):
            triangles = flip_in_lists(points, triangles, edges[i])
            yield triangles


def lawson_without_end(points, triangles):
    edges = {tuple(sorted(edge)) for t in triangles for edge in combinations(t, 2)}
    while edges:
        for edge in edges:
            far = far_corners(triangles, *edge)
            if len(far) == 2 and illegal(points, *edge, *far):
                triangles = flip_in_lists(points, triangles, edge)
                yield triangles


def lawson_by_angles(points, triangles):
    """Flips for the shorter diagonal, which is another thing."""
    waiting = [edge for t in triangles for edge in combinations(t, 2)]
    while waiting:
        a, b = waiting.pop()
        far = far_corners(triangles, a, b)
        if len(far) == 2 and np.hypot(*np.subtract(points[far[0]], points[far[1]])) < np.hypot(
            *np.subtract(points[a], points[b])
        ):
            flipped = flip_in_lists(points, triangles, (a, b))
            if flipped:
                triangles = flipped
                waiting += [(u, v) for u in (a, b) for v in far]
                yield triangles


RIGHT = {
    "flip": [flip_in_lists, flip_in_sets, flip_in_an_array, flip_in_place],
    "lawson": [with_a_stack, with_sweeps, with_the_worst_first, with_recursion],
}
WRONG = [
    ("flip", flip_only_new, "is missing: return all triangles, also those that stay as they are"),
    ("flip", flip_any, "the quadrilateral 0, 1, 3, 2 around edge 0-3 is not convex, so it cannot be flipped: return None"),
    ("flip", flip_on_the_hull, 'case "edges of the hull": line '),
    ("flip", flip_not_strictly, "around edge 1-3 has three corners on one line, so it cannot be flipped: return None"),
    ("flip", flip_keeps_old, "triangle (0, 1, 2) is still there, but edge 0-2 has to go from it"),
    ("flip", flip_back_again, "triangle (0, 1, 2) is still there, but edge 0-2 has to go from it"),
    ("flip", flip_the_illegal, "edge 1-3 can be flipped, for its quadrilateral 1, 2, 3, 0 is convex, but you returned None"),
    ("flip", flip_in_secret, "edge 0-2 can be flipped, for its quadrilateral 0, 1, 2, 3 is convex, but you returned None"),
    (
        "flip",
        flip_turned_into_unchanged,
        "edge 0-1 lies on the hull, so it cannot be flipped: return None, not a list of length 2",
    ),
    ("lawson", lawson_of_ties, "lie on one circle: a tie is left as it is"),
    ("lawson", lawson_once, "should still be flipped: vertex "),
    ("lawson", lawson_of_all_convex, "you flipped edge 1-3, but no vertex lies inside either circle"),
    ("lawson", lawson_at_the_end, "nothing has changed since the step before: yield after each flip, and only then"),
    ("lawson", lawson_returned, "returned a list of length 2, but it is to be a generator: `yield` the current state"),
    ("lawson", lawson_of_turns, "raised MeshError: in_circle needs a counter-clockwise triangle, but points "),
    (
        "lawson",
        lawson_of_flips_that_turn,
        "in_circle needs a counter-clockwise triangle, but points 2, 1, 3 run clockwise: swap two of them",
    ),
    ("lawson", lawson_of_edges, "you yielded a list that holds (0, 1), which is no triangle (a, b, c)"),
    ("lawson", lawson_of_the_new, "of the convex hull is missing: the triangles must cover the hull"),
    ("lawson", lawson_with_the_start, "step 1: nothing has changed since the step before"),
    ("lawson", lawson_past_the_end, "`far = far_corners(triangles, *edges[i])`, raised IndexError: list index out of range"),
    ("lawson", lawson_without_end, "the loop in line"),
    ("lawson", lawson_by_angles, "but no vertex lies inside either circle"),
]
