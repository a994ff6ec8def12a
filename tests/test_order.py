"""The insertion order is a permutation that keeps neighbours together, whatever the points."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fem_mesh as fm
from fem_mesh.mesh.order import LEVELS, curve_order, hilbert, insertion_order


def test_the_hilbert_curve_steps_from_each_cell_to_a_neighbour():
    size = 2**5
    shift = LEVELS - 5
    ranks = {hilbert(x << shift, y << shift) >> 2 * shift: (x, y) for x in range(size) for y in range(size)}
    assert sorted(ranks) == list(range(size * size))
    path = np.array([ranks[k] for k in range(size * size)])
    assert (np.abs(np.diff(path, axis=0)).sum(axis=1) == 1).all()


@given(st.integers(0, 10**6), st.integers(0, 400))
def test_every_point_is_inserted_exactly_once(seed, n):
    points = np.round(np.random.default_rng(seed).random((n, 2)) * 20)
    assert sorted(insertion_order(points).tolist()) == list(range(n))


@pytest.mark.parametrize("power", [-100, -1, 7, 90])
def test_scaling_by_a_power_of_two_does_not_change_the_order(power):
    points = fm.random_points(2000, seed=3)
    np.testing.assert_array_equal(insertion_order(points), insertion_order(points * 2.0**power))


def test_equal_points_come_in_the_users_order():
    points = np.tile(fm.random_points(50, seed=1), (80, 1))
    order = insertion_order(points)
    for k in range(50):
        copies = order[order % 50 == k]
        assert (np.diff(copies) > 0).all()


def test_a_cluster_far_from_one_outlier_is_still_ordered():
    cluster = fm.random_points(20_000, seed=2) * 1e-9
    order = curve_order(np.concatenate([cluster, [[1.0, 1.0]]]))
    path = cluster[order[order < 20_000]]
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert np.median(steps) < 5e-9 / np.sqrt(20_000)


def test_walks_stay_short_on_a_spiral_where_one_curve_alone_would_be_quadratic():
    s = np.linspace(0, 1, 16_000)
    mesh = fm.delaunay(np.column_stack([s * np.cos(40 * s), s * np.sin(40 * s)]))
    assert mesh.work["in_circle tests"] < 20 * len(s)
    assert mesh.work["walk steps"] < 20 * len(s)
