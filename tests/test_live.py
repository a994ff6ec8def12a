"""A triangulation that stays open is Delaunay after every change, and its steps tell exactly what changed."""

import numpy as np
import pytest
from corpus import CORPUS, for_all, pythagorean_circle
from exact import check_every_circle, check_triangulation, integers, turn
from hypothesis import strategies as st

import fem_mesh as fm
from fem_mesh.algorithms.live import LiveDelaunay
from fem_mesh.mesh.halfedge import next_edge
from fem_mesh.mesh.workspace import COUNT

HALVES = [k / 2 for k in range(5)]
RING = [(3 + x / 25, 3 + y / 25) for x, y in pythagorean_circle(12)]
LINE = [(k, 2 * k) for k in range(6)]
PLACES = {
    "a lattice, all ties": st.tuples(st.sampled_from(HALVES), st.sampled_from(HALVES)),
    "a circle and its centre": st.sampled_from([*RING, (3.0, 3.0)]),
    "a line, and two places off it": st.sampled_from([*LINE, (1, 7), (4, 1)]),
    "anywhere": st.tuples(st.floats(-1, 1).filter(lambda x: x == 0 or abs(x) > 1e-30), st.floats(1, 2)),
}
PLACE = st.one_of(*PLACES.values())
CHANGE = st.tuples(st.sampled_from(["add", "add", "add", "remove", "move", "move", "undo"]), st.integers(0, 99), PLACE)


def turned(triangles):
    """Triangles as a set, each with its lowest corner first."""
    return {min((a, b, c), (b, c, a), (c, a, b)) for a, b, c in np.asarray(triangles).tolist()}


def check_whole(live):
    """Twins are mutual and run the other way, and every point has its triangles."""
    work, count = live._work, int(live._work.state[COUNT])
    for h in range(3 * count):
        assert work.twin[work.twin[h]] == h
        assert work.origin[h] == work.origin[next_edge(int(work.twin[h]))]
    assert not count or count == 2 * (len(live.points) + 1) - 4


def check_delaunay(live):
    points, triangles = live.points, live.triangles
    check_whole(live)
    if len(triangles):
        check_triangulation(points, triangles.tolist())
        check_every_circle(points, triangles.tolist())
    else:
        whole = integers(points)
        assert all(turn(min(whole), max(whole), p) == 0 for p in whole)
    assert len(np.unique(points, axis=0)) == len(points)


def check_same(trace, live):
    """The trace ends with exactly the points and the triangles of the live one."""
    points, triangles = trace.frame(-1)
    np.testing.assert_array_equal(points[~np.isnan(points[:, 0])], live.points)
    assert not np.isnan(points[: len(live.points), 0]).any()
    assert len(triangles) == len(live.triangles)
    assert turned(triangles) == turned(live.triangles)


def apply(live, change, i, place, snapshots):
    """The steps of one change; an undo gives none, and goes back some snapshots."""
    n = len(live.points)
    if change == "undo" and snapshots:
        del snapshots[i % len(snapshots) + 1 :]
        live.restore(snapshots[-1][0])
        return None
    if n == 0 or change in ("add", "undo"):
        return live.add(*place)
    return live.remove(i % n) if change == "remove" else live.move(i % n, *place)


@for_all(300, changes=st.lists(CHANGE, max_size=25), start=st.lists(PLACE, max_size=8))
def test_after_any_changes_every_circle_is_empty_and_the_steps_tell_the_same(changes, start):
    live, trace, snapshots = LiveDelaunay(start), fm.Trace(), []
    trace.append(live.start())
    check_delaunay(live)
    check_same(trace, live)
    for change in changes:
        snapshots.append((live.snapshot(), live.points, live.triangles))
        steps = apply(live, *change, snapshots)
        if steps is None:
            _, points, triangles = snapshots[-1]
            np.testing.assert_array_equal(live.points, points)
            np.testing.assert_array_equal(live.triangles, triangles)
            trace = fm.Trace()
            steps = [live.start()]
        for step in steps:
            assert step.caption
            assert not set(step.added) & set(step.removed)
            trace.append(step)
        check_delaunay(live)
        check_same(trace, live)


@for_all(40, places=st.sampled_from(sorted(PLACES)).flatmap(lambda kind: st.lists(PLACES[kind], max_size=20)))
def test_points_come_and_go_in_one_place_after_the_other(places):
    live, trace = LiveDelaunay(), fm.Trace()
    for x, y in places:
        for step in live.add(x, y):
            trace.append(step)
    check_delaunay(live)
    np.testing.assert_array_equal(live.points, np.array(list(dict.fromkeys(places)), float).reshape(-1, 2))
    while len(live.points):
        for step in live.remove(len(live.points) // 2):
            trace.append(step)
        check_delaunay(live)
        check_same(trace, live)


@pytest.mark.parametrize("name", sorted(CORPUS))
def test_hundreds_of_points_of_every_kind(name):
    random, points = np.random.default_rng(1), CORPUS[name](200)
    live = LiveDelaunay(points[:100])
    for x, y in points[100:].tolist():
        live.add(x, y)
    for x, y in points[random.integers(0, len(points), 60)].tolist():
        live.move(int(random.integers(len(live.points))), x, y)
        if len(live.points) > 3:
            live.remove(int(random.integers(len(live.points))))
    mesh = live.mesh()
    mesh.validate(delaunay=True)
    assert mesh.merged_into.tolist() == list(range(len(mesh.points)))
    assert {tuple(p) for p in mesh.points.tolist()} <= {tuple(p) for p in points.tolist()}


def test_every_frame_of_a_long_trace_is_delaunay():
    random, live, trace = np.random.default_rng(2), LiveDelaunay(), fm.Trace()
    for k in range(60):
        steps = live.add(*random.integers(0, 9, 2).tolist())
        if k % 3 == 2:
            steps += live.move(int(random.integers(len(live.points))), *random.integers(0, 9, 2).tolist())
        if k % 4 == 3:
            steps += live.remove(int(random.integers(len(live.points))))
        for step in steps:
            trace.append(step)
    for k in range(len(trace)):
        points, triangles = trace.frame(k)
        fm.validate(points[~np.isnan(points[:, 0])], triangles)
    assert trace.makes_points


def test_the_steps_of_an_insertion_are_those_of_bowyer_watson():
    points = fm.random_points(40, seed=3)
    live = LiveDelaunay()
    told = [step for x, y in points.tolist() for step in live.add(x, y)][2:]
    for step, other in zip(told, fm.bowyer_watson(points), strict=False):
        assert (step.kind, step.caption) == (other.kind, other.caption)
        assert (turned(step.added), turned(step.removed)) == (turned(other.added), turned(other.removed))
        assert (step.edges, step.visited, step.doomed) == (other.edges, other.visited, other.doomed)


def test_an_equal_point_is_not_added():
    for start in ([(0, 0), (1, 1)], [(0, 0), (1, 1), (2, 0)]):
        live = LiveDelaunay(start)
        before = live.snapshot()
        steps = live.add(1, 1)
        assert steps[-1].kind == "merge"
        assert steps[-1].caption == f"point {len(start)} equals point 1: it is merged into it"
        for array, other in zip(before[:3], live.snapshot()[:3], strict=True):
            np.testing.assert_array_equal(array, other)
        live.add(1, 5)
        check_delaunay(live)


def test_equal_points_are_left_out_of_those_it_begins_with():
    live = LiveDelaunay([(0, 1), (0.0, 0), (0, 1), (-0.0, 0), (1, 1)])
    assert live.points.tolist() == [[0, 1], [0, 0], [1, 1]]
    assert live.triangles.tolist() == [[0, 1, 2]]


def test_a_move_onto_another_point_leaves_everything_as_it_was():
    live = LiveDelaunay([(0, 0), (4, 0), (0, 4), (1, 1)])
    before = live.snapshot()
    (step,) = live.move(3, 4, 0)
    assert repr(step) == "Step merge: point 3 stays where it was: point 1 is there already"
    assert not step.new_points
    for array, other in zip(before, live.snapshot(), strict=True):
        np.testing.assert_array_equal(array, other)


def test_a_move_to_where_it_is_changes_no_triangle():
    live = LiveDelaunay(fm.grid_points(4))
    before = live.triangles
    (step,) = live.move(5, 1, 1)
    assert step.caption == "point 5 moves: its triangles stay"
    np.testing.assert_array_equal(live.triangles, before)


def test_the_last_point_takes_the_number_of_the_removed_one():
    live = LiveDelaunay([(0, 0), (4, 0), (4, 3), (0, 3), (1, 1), (3, 2)])
    (step,) = live.remove(4)
    assert step.caption == "point 4 is taken out: 4 triangles go, 2 come; point 5 is now point 4"
    assert step.new_points == ((4, 3.0, 2.0),)
    assert step.gone_points == (5,)
    assert step.point == (1.0, 1.0)
    (step,) = live.remove(4)
    assert step.caption == "point 4 is taken out: 4 triangles go, 2 come"
    assert not step.new_points
    assert live.points.tolist() == [[0, 0], [4, 0], [4, 3], [0, 3]]


def test_the_first_points_make_no_triangle_until_one_lies_off_their_line():
    live = LiveDelaunay()
    told = [live.add(*p)[-1] for p in [(0, 0), (2, 2), (1, 1), (3, 3), (0, 3)]]
    assert [step.kind for step in told] == ["insert"] * 4 + ["start"]
    assert [step.caption for step in told] == [
        "point 0 is there; a triangle needs 2 more",
        "point 1 is there; a triangle needs 1 more",
        "point 2 lies on one line with all the others: there is no triangle yet",
        "point 3 lies on one line with all the others: there is no triangle yet",
        "point 4 is the first that lies off the line of the others: 3 triangles come",
    ]
    assert LiveDelaunay([(0, 0), (1, 0)]).add(0, 1)[0].caption == "points 0, 1, 2 make the first triangle"


def test_taking_out_the_only_point_off_a_line_leaves_no_triangle():
    live = LiveDelaunay([(0, 0), (1, 2), (2, 0), (1, 0)])
    (step,) = live.remove(1)
    assert step.caption == "point 1 is taken out: 2 triangles go, 0 come; point 3 is now point 1"
    assert live.mesh().note == "no triangles: all 3 points lie on one line"
    (step,) = live.move(1, 1, -1)
    assert step.caption == "point 1 moves: 1 triangle comes, 0 go"
    check_delaunay(live)
    assert [len(live.remove(0)) for _ in range(3)] == [1, 1, 1]
    assert live.mesh().note == "no triangles: 0 points, and a triangle needs 3"


def test_its_mesh_is_a_copy_with_neighbors():
    live = LiveDelaunay(fm.random_points(50, seed=4))
    live.remove(7)
    mesh, points, triangles = live.mesh(), live.points, live.triangles
    np.testing.assert_array_equal(mesh.neighbors, fm.Mesh(points, triangles).neighbors)
    assert mesh.triangles.dtype == mesh.neighbors.dtype == np.int32
    live.move(3, 5, 5)
    live.points[:] = 0
    np.testing.assert_array_equal(mesh.points, points)
    np.testing.assert_array_equal(mesh.triangles, triangles)
    live.mesh().validate(delaunay=True)


def test_it_grows_beyond_its_room_and_a_snapshot_outlives_that():
    points = fm.random_points(300, seed=5)
    live = LiveDelaunay(points[:20])
    small = live.snapshot()
    for x, y in points[20:].tolist():
        live.add(x, y)
    large = live.snapshot()
    live.mesh().validate(delaunay=True)
    for state in (small, large, small):
        live.restore(state)
        for array, other in zip(live.snapshot(), state, strict=True):
            np.testing.assert_array_equal(array, other)
    other = LiveDelaunay()
    other.restore(large)
    assert [repr(step) for step in other.remove(5) + other.add(0.5, 0.5)] == [
        repr(step) for state in [live.restore(large)] for step in live.remove(5) + live.add(0.5, 0.5)
    ]


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda live: live.add(np.nan, 0), r"point 4 = \(nan, 0.0\) is not finite"),
        (lambda live: live.add(1e99, 0), "point 4 = .* outside 2.-142"),
        (lambda live: live.move(2, 0, np.inf), r"point 2 = \(0.0, inf\) is not finite"),
        (lambda live: live.add("a", 0), "point 4 is .* not a pair of real numbers"),
        (lambda live: live.move(4, 0, 0), "there is no point 4: there are 4 points"),
        (lambda live: live.remove(-1), "there is no point -1"),
        (lambda live: LiveDelaunay([(0, 0), (np.nan, 0)]), "point 1 = .* is not finite"),
    ],
)
def test_what_is_no_point_is_refused_and_changes_nothing(change, complaint):
    live = LiveDelaunay([(0, 0), (4, 0), (0, 4), (1, 1)])
    before = live.snapshot()
    with pytest.raises(fm.MeshError, match=complaint):
        change(live)
    for array, other in zip(before, live.snapshot(), strict=True):
        np.testing.assert_array_equal(array, other)
    check_delaunay(live)


def test_it_says_how_much_there_is():
    assert repr(LiveDelaunay([(0, 0), (1, 0), (0, 1)])) == "LiveDelaunay: 3 points, 1 triangle"
    assert LiveDelaunay(fm.grid_points(2)).start().caption == "2 triangles on 4 points"
