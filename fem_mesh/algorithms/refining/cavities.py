"""Cavities of a refinement: dug for a new point, looked at, and filled or left alone."""

from __future__ import annotations

from fem_mesh.algorithms.refining.encroachment import (
    CORNER,
    FIRST_UNUSED,
    SHORTEST,
    SPOT_X,
    SPOT_Y,
    WIDE,
    encroaches,
    is_between,
    is_encroached,
    place_split_point,
    squared_length,
)
from fem_mesh.algorithms.refining.steiner import FINE, judge, place_steiner_point
from fem_mesh.algorithms.refining.worklists import (
    ADDED,
    BEYOND,
    FREE_TRIANGLE,
    FREE_VERTEX,
    GIVEN,
    IDLE,
    INSERTIONS,
    LABELLED,
    LENS,
    OFF_CURVE,
    ON_CURVE,
    STATUS,
    UNSIZED,
    bucket_of,
    drop_triangle,
    push_segment,
    push_triangle,
)
from fem_mesh.kernel import index, inlined_kernel, kernel
from fem_mesh.mesh.constrained import dig_from, dig_side, fan_around, holds, mark_spoke, remove_free_vertex, sees_ring
from fem_mesh.mesh.halfedge import (
    GHOST,
    is_ghost_triangle,
    is_right_of,
    next_edge,
    place_triangle,
    prev_edge,
    triangle_of,
)
from fem_mesh.mesh.workspace import COUNT, NEXT, SEGMENTS, TESTED


@kernel
def next_vertex(state):
    """The slot of the vertex to come."""
    return index(state[FREE_VERTEX] if state[FREE_VERTEX] != 0 else state[NEXT])


@kernel
def take_vertex(v, kind, place, state):
    """Vertex ``v``, which stands in the next slot, is there to stay."""
    if v == state[NEXT]:
        state[NEXT] += 1
    else:
        state[FREE_VERTEX] = FIRST_UNUSED - place[v]
    place[v] = kind
    state[ADDED] += 1
    state[INSERTIONS] += 1


@kernel
def free_vertex(v, place, state):
    place[v] = FIRST_UNUSED - state[FREE_VERTEX]
    state[FREE_VERTEX] = v
    state[ADDED] -= 1


@kernel
def take_two_slots(dug, origin, twin, cavity, state):
    """List two more slots of triangles in ``cavity``, behind those that were dug."""
    for i in range(dug, dug + 2):
        t = state[FREE_TRIANGLE] - 1
        if t >= 0:
            state[FREE_TRIANGLE] = twin[index(3 * t)]
        else:
            t = state[COUNT]
            state[COUNT] += 1
        cavity[i] = index(t)


@kernel
def free_triangle(t, origin, twin, state):
    """Make the slot of triangle ``t`` a ghost of nothing, to be used again."""
    h = place_triangle(origin, t, GHOST, GHOST, GHOST)
    twin[h] = state[FREE_TRIANGLE]
    state[FREE_TRIANGLE] = t + 1


# ---- dug -------------------------------------------------------------------------------------------


@inlined_kernel
def dig_point(h, v, xy, origin, twin, segment, limits, cavity, ring, state):
    """Put ``v`` in the Steiner point of the triangle whose shortest edge is ``h``, and dig its cavity from there.

    Returns the number of triangles; 0 if rounding brings the point out of the triangle's circle.
    """
    if not place_steiner_point(v, h, xy, origin, limits, state):
        return 0
    px, py = xy[v, 0], xy[v, 1]
    if not holds(h, px, py, xy, origin):
        return 0
    dug, _ = dig_from(h, True, 0, 0, px, py, xy, origin, twin, segment, cavity, ring)
    state[TESTED] += 2 * dug + 2
    state[BEYOND] = 0
    return dug


@kernel
def look_around(v, dug, skinny, xy, origin, segment, ring, limits, waiting, state):
    """Let the sub-segments around the cavity that ``v`` encroaches upon, or lies beyond, wait.

    Returns how many do; -1 if there are some, but all are frozen. Lenses are for skinny triangles. Where only size
    counts, and at edges that are too long anyway, circles leave fewer vertices to clear when the edge is split.
    """
    hits, frozen = 0, False
    px, py = xy[v, 0], xy[v, 1]
    for i in range(dug + 2):
        g = ring[i]
        s = segment[g]
        if s == 0:
            continue
        lens = skinny and state[LENS] != 0 and squared_length(g, xy, origin) <= limits[WIDE]
        if not is_right_of(g, px, py, xy, origin) or encroaches(v, g, lens, xy, origin, limits):
            if push_segment(s, waiting, state):
                hits += 1
            else:
                frozen = True
    return -1 if hits == 0 and frozen else hits


@kernel
def dig_split(h, v, xy, origin, twin, segment, place, limits, cavity, ring, state):
    """Put ``v`` where sub-segment ``h`` is to be split, and dig its cavity on both sides.

    On the curve, where a point of it was given and the way there is free; else on the chord. Returns the number of
    triangles; 0 if it is not split, since it is too short, or rounding would turn a triangle over.
    """
    given = state[GIVEN]
    state[GIVEN] = 0
    if squared_length(h, xy, origin) <= limits[SHORTEST]:
        return 0
    dug = 0
    if given == ON_CURVE:
        xy[v, 0], xy[v, 1] = limits[SPOT_X], limits[SPOT_Y]
        dug = dig_both_sides(h, v, xy, origin, twin, segment, cavity, ring, state)
    if given != 0 and dug == 0:
        state[OFF_CURVE] += 1
    if dug == 0:
        place_split_point(v, h, xy, origin, place)
        dug = dig_both_sides(h, v, xy, origin, twin, segment, cavity, ring, state)
    return dug


@kernel
def dig_both_sides(h, v, xy, origin, twin, segment, cavity, ring, state):
    if not is_between(v, origin[h], origin[next_edge(h)], xy):
        return 0
    px, py = xy[v, 0], xy[v, 1]
    dug, around = dig_side(h, 0, 0, px, py, xy, origin, twin, segment, cavity, ring)
    if dug >= 0:
        dug, around = dig_side(twin[h], dug, around, px, py, xy, origin, twin, segment, cavity, ring)
    if dug < 1 or not sees_ring(0, around, px, py, xy, origin, ring):
        return 0
    state[TESTED] += 2 * dug + 2
    state[BEYOND] = 0
    for i in range(around):
        if ring[i] == h or ring[i] == twin[h]:
            state[BEYOND] = ring[i] + 1
    return dug


@kernel
def clear_vertex(h, xy, origin, twin, segment, edge_of, place, label, wanted, bounds, queue, bucket, cavity, state):
    """Remove the free vertex that ``h`` leaves, and judge the triangles that fill its place; returns how many it had."""
    v, g = origin[h], index(h)
    while True:  # once around the vertex
        drop_triangle(triangle_of(g), queue, bucket, state)
        g = twin[prev_edge(g)]
        if g == h:
            break
    degree = remove_free_vertex(h, xy, origin, twin, segment, edge_of, cavity)
    for i in range(2):
        free_triangle(cavity[i], origin, twin, state)
    for i in range(2, degree):
        if state[LABELLED] != 0:
            label[cavity[i]] = touched(label[cavity[i]], state)
        push_if_bad(cavity[i], xy, origin, label, bounds, wanted, queue, bucket, state)
    free_vertex(v, place, state)
    return degree


# ---- filled ----------------------------------------------------------------------------------------


@kernel
def fill(v, dug, xy, origin, twin, segment, edge_of, label, wanted, bounds, queue, bucket, cavity, ring, state):
    """Join ``v`` to the ring around its cavity, and judge the new triangles."""
    for i in range(dug):
        drop_triangle(cavity[i], queue, bucket, state)
    take_two_slots(dug, origin, twin, cavity, state)
    if state[LABELLED] != 0:
        inherit_labels(dug, twin, label, cavity, ring, state)
    fan_around(v, dug + 2, origin, twin, segment, edge_of, cavity, ring)
    for i in range(dug + 2):
        push_if_bad(cavity[i], xy, origin, label, bounds, wanted, queue, bucket, state)


@kernel
def inherit_labels(dug, twin, label, cavity, ring, state):
    """Each new triangle gets the label of the one that it replaces at its edge of the ring."""
    end = len(ring) - 1  # the far end of the ring holds the labels meanwhile
    for i in range(dug + 2):
        g = ring[i]
        ring[end - i] = touched(label[triangle_of(g if g + 1 == state[BEYOND] else twin[g])], state)
    for i in range(dug + 2):
        label[cavity[i]] = ring[end - i]


@kernel
def touched(row, state):
    """The label of what is made in place of a triangle: nothing new is left alone (see ``Refiner``)."""
    return row - state[LABELLED] if row >= 2 * state[LABELLED] else row


@inlined_kernel
def push_if_bad(t, xy, origin, label, bounds, wanted, queue, bucket, state):
    if is_ghost_triangle(index(3 * t), origin):
        return
    if len(wanted) > 0:
        wanted[t] = float("nan")
        state[UNSIZED] = 1
    verdict, _, square = judge(t, xy, origin, label, bounds, wanted)
    if verdict != FINE:
        push_triangle(t, bucket_of(square), queue, bucket, state)


@kernel
def unmark(h, twin, segment):
    """Make sub-segment ``h`` an edge like others; returns its number."""
    s = segment[h]
    segment[h], segment[twin[h]] = 0, 0
    return index(s)


@kernel
def mark_halves(a, b, s, dug, origin, twin, segment, edge_of, piece_of, waiting, cavity, state):
    """The spokes of the new fan to ``a`` and ``b`` become the halves of sub-segment ``s``; returns the second's number."""
    state[SEGMENTS] += 1
    r = index(state[SEGMENTS])
    piece_of[r], waiting[r, STATUS] = piece_of[s], IDLE
    mark_spoke(a, s, dug + 2, origin, twin, segment, edge_of, cavity)
    mark_spoke(b, r, dug + 2, origin, twin, segment, edge_of, cavity)
    return r


@kernel
def push_encroached_ring(v, dug, xy, origin, segment, ring, limits, waiting, state):
    """Let the sub-segments around the fan of ``v`` wait that it encroaches upon."""
    for i in range(dug + 2):
        g = ring[i]
        if segment[g] != 0 and encroaches(v, g, state[LENS], xy, origin, limits):
            push_segment(segment[g], waiting, state)


@kernel
def split_segment(
    v, h, dug, xy, origin, twin, segment, edge_of, piece_of, place, label, wanted, bounds, queue, bucket, waiting,
    limits, cavity, ring, state,
):  # fmt: skip
    """Fill the cavity of ``v``, which splits sub-segment ``h``; let what is now encroached wait."""
    a, b, s = origin[h], origin[next_edge(h)], unmark(h, twin, segment)
    take_vertex(v, piece_of[s] + 1 if piece_of[s] >= 0 else CORNER, place, state)
    fill(v, dug, xy, origin, twin, segment, edge_of, label, wanted, bounds, queue, bucket, cavity, ring, state)
    r = mark_halves(a, b, s, dug, origin, twin, segment, edge_of, piece_of, waiting, cavity, state)
    for half in (s, r):
        if is_encroached(index(edge_of[half]), xy, origin, twin, limits, state):
            push_segment(half, waiting, state)
    push_encroached_ring(v, dug, xy, origin, segment, ring, limits, waiting, state)
