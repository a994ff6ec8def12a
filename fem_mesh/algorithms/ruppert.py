"""Delaunay refinement: Ruppert 1995; with lenses (Chew 1993), off-centers (Uengoer 2004), moves (Erten, Uengoer 2009).

    while there is an encroached sub-segment or a bad triangle:
        if there is an encroached sub-segment:
            split it
        else take the bad triangle with the shortest edge:
            if moving one of its vertices mends it (if that is allowed): move it
            choose its Steiner point: the circumcentre, or a point on the way to it
            if the point would encroach upon sub-segments: these are encroached
            else insert the point

Encroached is a sub-segment that a vertex sees under a wide angle, or one in the way of a Steiner point. New
points keep away from all others in proportion to the edges around, so there is room for finitely many only.
At small angles of the input that fails: there, sub-segments are split on common circles around the corner,
and a triangle across two sub-segments whose ends lie on one such circle is left as it is (Miller, Pav,
Walkington 2003). Whatever else keeps on is stopped by the budget of points and by the smallest length.

Before and after each turn the mesh is constrained Delaunay: a point is looked at before it is inserted, and
the cavity grows from the bad triangle itself, so the point need not be located.
"""

from __future__ import annotations

from fem_mesh.algorithms.refining.cavities import (
    clear_vertex,
    dig_point,
    dig_split,
    fill,
    look_around,
    next_vertex,
    push_encroached_ring,
    push_if_bad,
    split_segment,
    take_vertex,
)
from fem_mesh.algorithms.refining.encroachment import FREE, find_free_vertex_inside, is_encroached
from fem_mesh.algorithms.refining.relocation import dig_landing, find_movable
from fem_mesh.algorithms.refining.steiner import (
    COSINE,
    FINE,
    MAX_AREA,
    MAX_EDGE,
    NO_ANGLE,
    SKINNY,
    UNBOUNDED,
    is_excused,
    judge,
)
from fem_mesh.algorithms.refining.worklists import (
    ADDED,
    BAD,
    BEGUN,
    BUCKET,
    FREE_VERTEX,
    FRESH,
    FROZEN,
    GIVEN,
    IDLE,
    INSERTIONS,
    LEFT,
    MOST,
    MOVES,
    NONE,
    RELOCATE,
    TAKEN,
    UNSIZED,
    WAITING,
    bucket_of,
    first_segment,
    pop_segment,
    pop_triangle,
    push_segment,
    push_triangle,
)
from fem_mesh.kernel import LAST, SETTLED, index, kernel
from fem_mesh.mesh.halfedge import triangle_of
from fem_mesh.mesh.workspace import COUNT, NEXT, SEGMENTS

ENCROACHED, SPLITTING, CLEARING, CAVITY, MOVING, LIFTED, LANDING = range(1, 8)
SPLIT, FROZEN_WHOLE, CLEARED, INSERTED, REJECTED, EXCUSED, REFUSED, MOVED = (SETTLED + i for i in range(1, 9))
FULL, SPENT, SIZES_WANTED, POINT_WANTED = range(LAST, LAST + 4)  # the last event: the caller has to act


@kernel
def refine_mesh(
    xy, origin, twin, segment, edge_of, piece_of, place, ends, curved, label, wanted, bounds, queue, bucket, waiting,
    limits, cavity, ring, state,
):  # fmt: skip
    begin(xy, origin, twin, segment, edge_of, label, wanted, bounds, queue, bucket, waiting, limits, cavity, state)
    while state[WAITING] + state[BAD] > 0:  # each turn adds a point, of which the budget has so many, or settles an entry
        stop = must_stop(xy, edge_of, piece_of, curved, waiting, cavity, state)
        if stop != 0:
            yield stop, index(0)
            return

        if state[WAITING] > 0:
            s = first_segment(waiting, state)
            yield ENCROACHED, index(edge_of[s])
            while True:  # each turn removes a vertex
                h = find_free_vertex_inside(index(edge_of[s]), xy, origin, twin, place, state)
                if h == edge_of[s]:
                    break
                yield CLEARING, h
                degree = clear_vertex(
                    h, xy, origin, twin, segment, edge_of, place, label, wanted, bounds, queue, bucket, cavity, state
                )
                yield CLEARED, index(degree)
            v = next_vertex(state)
            dug = dig_split(h, v, xy, origin, twin, segment, place, limits, cavity, ring, state)
            pop_segment(IDLE if dug > 0 else FROZEN, waiting, state)
            if dug == 0:
                yield FROZEN_WHOLE, h
                continue
            yield SPLITTING, index(dug)
            split_segment(
                v, h, dug, xy, origin, twin, segment, edge_of, piece_of, place, label, wanted, bounds, queue, bucket, waiting,
                limits, cavity, ring, state,
            )  # fmt: skip
            yield SPLIT, v
            continue

        t = pop_triangle(queue, bucket, state)
        verdict, h, square = judge(t, xy, origin, label, bounds, wanted)
        state[TAKEN] = h
        if verdict == SKINNY and is_excused(h, xy, origin, segment, place, ends):
            state[LEFT] += 1
            yield EXCUSED, h
            continue
        movable = False
        if verdict == SKINNY and may_move(t, label, bounds, wanted, state):
            movable, h = find_movable(h, xy, origin, twin, segment, place, label, wanted, bounds, limits, state)
        if movable:
            yield MOVING, h
            degree = clear_vertex(
                h, xy, origin, twin, segment, edge_of, place, label, wanted, bounds, queue, bucket, cavity, state
            )
            yield LIFTED, index(degree)
            v = next_vertex(state)
            dug = dig_landing(degree, v, xy, origin, twin, segment, limits, cavity, ring)
            yield LANDING, index(dug)
            take_vertex(v, FREE, place, state)
            fill(v, dug, xy, origin, twin, segment, edge_of, label, wanted, bounds, queue, bucket, cavity, ring, state)
            push_encroached_ring(v, dug, xy, origin, segment, ring, limits, waiting, state)
            state[MOVES] += 1
            yield MOVED, v
            continue
        v = next_vertex(state)
        dug = dig_point(h, v, xy, origin, twin, segment, limits, cavity, ring, state)
        hits = -1
        if dug > 0:
            yield CAVITY, index(dug)
            hits = look_around(v, dug, verdict == SKINNY, xy, origin, segment, ring, limits, waiting, state)
        if hits > 0:  # for another try, when they are split
            push_triangle(t, bucket_of(square), queue, bucket, state)
            yield REJECTED, h
        elif hits < 0:
            state[LEFT] += 1
            yield REFUSED, h
        else:
            take_vertex(v, FREE, place, state)
            fill(v, dug, xy, origin, twin, segment, edge_of, label, wanted, bounds, queue, bucket, cavity, ring, state)
            yield INSERTED, v
    if state[UNSIZED] != 0:
        yield SIZES_WANTED, index(0)


@kernel
def begin(xy, origin, twin, segment, edge_of, label, wanted, bounds, queue, bucket, waiting, limits, cavity, state):
    """Judge everything once; later only the triangles that got a size."""
    if state[BEGUN] == 0:
        state[BEGUN] = 1
        for s in range(1, state[SEGMENTS] + 1):
            h = index(edge_of[s])
            if is_asked_for(h, twin, label, bounds) and is_encroached(h, xy, origin, twin, limits, state):
                push_segment(index(s), waiting, state)
        for t in range(state[COUNT]):
            push_if_bad(index(t), xy, origin, label, bounds, wanted, queue, bucket, state)
    for i in range(state[FRESH]):
        t = cavity[i]
        verdict, _, square = judge(t, xy, origin, label, bounds, wanted)
        if verdict != FINE and queue[t, BUCKET] == NONE:
            push_triangle(t, bucket_of(square), queue, bucket, state)
    state[FRESH] = 0


@kernel
def is_asked_for(h, twin, label, bounds):
    """Whether a triangle on either side of ``h`` has any bound."""
    for g in (h, twin[h]):
        row = label[triangle_of(g)]
        if bounds[row, COSINE] < NO_ANGLE or bounds[row, MAX_AREA] < UNBOUNDED or bounds[row, MAX_EDGE] < UNBOUNDED:
            return True
    return False


@kernel
def may_move(t, label, bounds, wanted, state):
    """Whether vertices may be moved: where sizes are asked for it saves little, and there are never more moves than points."""
    row = label[t]
    return (
        state[RELOCATE] != 0
        and state[MOVES] < state[ADDED]
        and len(wanted) == 0
        and bounds[row, MAX_AREA] == UNBOUNDED
        and bounds[row, MAX_EDGE] == UNBOUNDED
    )


@kernel
def must_stop(xy, edge_of, piece_of, curved, waiting, cavity, state):
    """The event that hands over to the caller before the next turn, or 0."""
    if state[ADDED] >= state[MOST] or state[INSERTIONS] >= 4 * state[MOST]:
        return SPENT
    if (state[FREE_VERTEX] == 0 and state[NEXT] == len(xy)) or state[SEGMENTS] + 1 == len(edge_of):
        return FULL
    if state[COUNT] + 2 > len(cavity) - 2:
        return FULL
    if state[WAITING] > 0 and state[GIVEN] == 0 and curved[piece_of[first_segment(waiting, state)]]:
        return POINT_WANTED
    return 0
