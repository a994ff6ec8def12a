"""The connectivity kernels keep the half-edge structure whole, the hull included."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fem_mesh as fm
from fem_mesh.algorithms.bowyer_watson import insert_points, insertion_state
from fem_mesh.kernel import watch
from fem_mesh.mesh.halfedge import (
    GHOST,
    flip,
    ghost_edge,
    is_ghost,
    is_ghost_triangle,
    locate,
    next_edge,
    prev_edge,
    triangle_of,
)
from fem_mesh.mesh.removal import remove_vertex
from fem_mesh.mesh.workspace import COUNT, Workspace


def triangulated(points):
    """A Delaunay triangulation in its working arrays, points in the order given."""
    work = Workspace.of_points(np.asarray(points, float), np.arange(len(points)))
    for _ in watch(insert_points, insertion_state(work)):
        pass
    return work


def check_whole(work):
    """Twins are mutual and run the other way; Euler's formula holds on the sphere."""
    count = int(work.state[COUNT])
    origin, twin = work.origin.tolist(), work.twin.tolist()
    for h in range(3 * count):
        assert twin[twin[h]] == h
        assert origin[h] == origin[next_edge(twin[h])]
        assert next_edge(prev_edge(h)) == h
        assert triangle_of(next_edge(h)) == triangle_of(h)
    assert count == 2 * len(set(origin[: 3 * count])) - 4


def real_triangles(work):
    return {frozenset(t) for t in map(work.corners, range(int(work.state[COUNT]))) if t}


@pytest.mark.parametrize("points", [fm.random_points(40, seed=2), fm.grid_points(6), fm.ring_points(17)])
def test_after_every_insertion_the_half_edges_are_whole(points):
    work = Workspace.of_points(points, np.arange(len(points)))
    check_whole(work)
    for event, _ in watch(insert_points, insertion_state(work)):
        if event > 2:
            check_whole(work)


def test_flipping_an_edge_four_times_brings_it_back():
    work = triangulated([(0, 0), (2, 0), (2, 2), (0, 2), (1, 0.5)])
    before = real_triangles(work)
    h = next(
        h
        for h in range(3 * int(work.state[COUNT]))
        if not is_ghost_triangle(h, work.origin) and not is_ghost_triangle(work.twin[h], work.origin)
    )
    edges = [frozenset(work.edge(h))]
    for _ in range(4):
        h = flip(h, work.origin, work.twin)
        check_whole(work)
        edges.append(frozenset(work.edge(h)))
    assert edges[0] == edges[2] == edges[4] != edges[1] == edges[3]
    assert real_triangles(work) == before


@given(st.integers(0, 10**6))
def test_a_walk_ends_in_the_triangle_that_holds_the_point(seed):
    random = np.random.default_rng(seed)
    points = np.round(random.random((30, 2)) * 8)
    work = triangulated(points)
    x, y = random.random(2) * 10 - 1
    h, _ = locate(int(random.integers(3 * work.state[COUNT])), x, y, work.xy, work.origin, work.twin)
    corners = work.corners(h // 3)
    if corners is None:
        hull = ghost_edge(h, work.origin)
        a, b = work.xy[work.origin[hull]], work.xy[work.origin[next_edge(hull)]]
        assert fm.orient(a, b, (x, y)) > 0
    else:
        a, b, c = points[list(corners)]
        assert min(fm.orient(a, b, (x, y)), fm.orient(b, c, (x, y)), fm.orient(c, a, (x, y))) >= 0


def leaving(work, v):
    """A half-edge that leaves the vertex named ``v``."""
    used = work.origin[: 3 * int(work.state[COUNT])]
    return int(np.flatnonzero(work.name[used] == v)[0])


def remove(work, v):
    count = int(work.state[COUNT])
    done = remove_vertex(leaving(work, v), count, work.xy, work.origin, work.twin, work.cavity, work.ring)
    if done:
        work.state[COUNT] -= 2
    return done


@given(st.integers(0, 10**6), st.sampled_from(["uniform", "lattice"]))
def test_removing_vertices_one_by_one_leaves_a_delaunay_triangulation_of_the_rest(seed, kind):
    random = np.random.default_rng(seed)
    points = np.unique(random.random((14, 2)) if kind == "uniform" else random.integers(0, 5, (16, 2)).astype(float), axis=0)
    random.shuffle(points)
    if not len(fm.delaunay(points).triangles):
        return
    work, left = triangulated(points), list(range(len(points)))
    while len(left) > 3:
        v = left[int(random.integers(len(left)))]
        before = real_triangles(work)
        rest = [u for u in left if u != v]
        if not remove(work, v):
            assert len(fm.delaunay(points[rest]).triangles) == 0
            assert real_triangles(work) == before
            break
        left = rest
        check_whole(work)
        triangles = [work.corners(t) for t in range(int(work.state[COUNT])) if work.corners(t)]
        renumber = {u: i for i, u in enumerate(left)}
        fm.validate(points[left], [[renumber[u] for u in t] for t in triangles])


def test_removing_the_centre_of_a_ring_leaves_the_ring():
    ring = fm.ring_points(12)
    work = triangulated(np.concatenate([ring, [[0.0, 0.0]]]))
    assert remove(work, 12)
    check_whole(work)
    fm.validate(ring, [work.corners(t) for t in range(int(work.state[COUNT])) if work.corners(t)])


def test_the_last_triangle_cannot_be_taken_away():
    work = triangulated([(0, 0), (1, 0), (0, 1)])
    assert not remove(work, 1)
    check_whole(work)


def test_only_one_vertex_is_the_ghost():
    assert [v for v in range(5) if is_ghost(v)] == [GHOST]
