"""What a refinement has still to do: sub-segments to split, first come first served; bad triangles, shortest edge first.

Bad triangles wait in *buckets*, by the power of two of their shortest edge squared. A bucket is a list threaded
through ``queue``; so a triangle that vanishes leaves it at once, and nothing in it is ever stale. Within a
bucket the last comes first: it lies near the triangle before it, in the plane and in memory.
"""

from __future__ import annotations

import math

from fem_mesh.kernel import index, kernel

# What `state` holds, beside the slots of workspace.py
BEGUN = 12  # whether everything has been judged once
BAD = 13  # bad triangles waiting
LOWEST = 14  # no bucket below this one holds any
HEAD = 15  # where the sub-segments waiting begin
WAITING = 16  # how many of them there are
ADDED = 17  # points added, and not removed
INSERTIONS = 18  # points ever added
MOST = 19  # points that may be added
FREE_VERTEX = 20  # the first vertex slot to use again, or 0
FREE_TRIANGLE = 21  # the first triangle slot to use again, plus 1, or 0
UNSIZED = 22  # whether triangles wait for their size
FRESH = 23  # triangles in `cavity` that were given one, to be judged
LENS = 24  # whether encroachment is by lenses
OFFCENTER = 25  # whether Steiner points are off-centers
LABELLED = 26  # the number of regions, if triangles have bounds of their own; else 0
GIVEN = 27  # where the next sub-segment, which has a curve, is to be split; 0 if nobody knows yet
OFF_CURVE = 28  # split points that had to stay on a chord
BEYOND = 29  # the half-edge of a split sub-segment whose triangle stays, plus 1, or 0
RELOCATE = 30  # whether vertices are moved where that mends a triangle
MOVES = 31  # how many were
TAKEN = 32  # the shortest edge of the bad triangle in hand
LEFT = 33  # bad triangles that were left as they are

NONE = 0  # no triangle, where t + 1 stands for triangle t; no bucket
LOWEST_POWER = -400  # differences of doubles within 2^-142 .. 2^201 lie within 2^-194 .. 2^202, or are 0
BUCKETS = 820
AFTER, BEFORE, BUCKET = 0, 1, 2  # the columns of `queue`, one row a triangle
ON_CURVE, ON_CHORD = 1, 2  # what GIVEN says: at the spot in `limits`; as if it were straight
FIRST, LAST = 0, 1  # the columns of `bucket`
NUMBER, STATUS = 0, 1  # the columns of `waiting`: a ring of sub-segments; and the status of each sub-segment
IDLE, QUEUED, FROZEN = 0, 1, 2  # waits not, waits, cannot be split


@kernel
def bucket_of(square):
    """The bucket of a triangle whose shortest edge has this squared length."""
    return math.frexp(square)[1] - LOWEST_POWER  # the exponent: exact


@kernel
def push_triangle(t, b, queue, bucket, state):
    """Put triangle ``t`` at the front of bucket ``b``."""
    front, name = bucket[b, FIRST], t + 1
    queue[t, AFTER], queue[t, BEFORE], queue[t, BUCKET] = front, NONE, b
    if front == NONE:
        bucket[b, LAST] = name
    else:
        queue[index(front - 1), BEFORE] = name
    bucket[b, FIRST] = name
    state[BAD] += 1
    if b < state[LOWEST]:
        state[LOWEST] = b


@kernel
def drop_triangle(t, queue, bucket, state):
    """Take triangle ``t`` out of its bucket, if it is in one."""
    b = queue[t, BUCKET]
    if b == NONE:
        return
    queue[t, BUCKET] = NONE
    state[BAD] -= 1
    after, before = queue[t, AFTER], queue[t, BEFORE]
    if before == NONE:
        bucket[b, FIRST] = after
    else:
        queue[index(before - 1), AFTER] = after
    if after == NONE:
        bucket[b, LAST] = before
    else:
        queue[index(after - 1), BEFORE] = before


@kernel
def pop_triangle(queue, bucket, state):
    """Take out the bad triangle with the shortest edge. There is one, so the search upwards ends."""
    while bucket[state[LOWEST], FIRST] == NONE:
        state[LOWEST] += 1
    t = index(bucket[state[LOWEST], FIRST] - 1)
    drop_triangle(t, queue, bucket, state)
    return t


@kernel
def push_segment(s, waiting, state):
    """Let sub-segment ``s`` wait to be split, unless it does or cannot be. Returns whether it waits."""
    if waiting[s, STATUS] == IDLE:
        waiting[s, STATUS] = QUEUED
        end = state[HEAD] + state[WAITING]
        waiting[end if end < len(waiting) else end - len(waiting), NUMBER] = s
        state[WAITING] += 1
    return waiting[s, STATUS] == QUEUED


@kernel
def first_segment(waiting, state):
    """The sub-segment that has waited longest."""
    return index(waiting[state[HEAD], NUMBER])


@kernel
def pop_segment(status, waiting, state):
    """Take it out; what becomes of it is its new ``status``."""
    waiting[waiting[state[HEAD], NUMBER], STATUS] = status
    state[HEAD] = state[HEAD] + 1 if state[HEAD] + 1 < len(waiting) else 0
    state[WAITING] -= 1
