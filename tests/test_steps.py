"""A trace goes forward and back, at random, and never holds more than the changes."""

import copy
import pickle
import subprocess
import sys
import tracemalloc

import numpy as np
import pytest

import fem_mesh as fm


def bowyer_watson_trace():
    return fm.record(fm.bowyer_watson(fm.random_points(40, seed=5)))


def lawson_trace():
    points = fm.random_points(25, seed=6)
    return fm.record(fm.lawson(points, fm.any_triangulation(points)))


def textbook_trace():
    return fm.record(fm.textbook.bowyer_watson([(0.1, 0.1), (0.9, 0.2), (0.4, 0.8), (0.5, 0.4)]))


TRACES = [bowyer_watson_trace, lawson_trace, textbook_trace]


def as_set(triangles):
    return {frozenset(map(int, t)) for t in triangles}


@pytest.mark.parametrize("make", TRACES)
def test_every_frame_is_the_frame_before_with_the_steps_changes(make):
    trace = make()
    mesh = set()
    for k, step in enumerate(trace):
        assert as_set(step.removed) <= mesh
        mesh = (mesh - as_set(step.removed)) | as_set(step.added)
        assert as_set(trace.frame(k)[1]) == mesh
    for k in reversed(range(len(trace))):  # undone one by one
        assert as_set(trace.frame(k)[1]) == mesh
        mesh = (mesh - as_set(trace[k].added)) | as_set(trace[k].removed)
    assert mesh == set()


@pytest.mark.parametrize("make", TRACES[:2])
def test_every_frame_is_a_valid_triangulation(make):
    trace = make()
    for k in range(len(trace)):
        points, triangles = trace.frame(k)
        there = ~np.isnan(points[:, 0])
        fm.validate(np.where(there[:, None], points, 0), triangles, delaunay=False)


def test_after_each_insertion_the_mesh_is_delaunay():
    trace = bowyer_watson_trace()
    for k, step in enumerate(trace):
        if step.kind in ("start", "insert"):
            points, triangles = trace.frame(k)
            used = np.unique(triangles)
            renumber = np.full(len(points), -1)
            renumber[used] = np.arange(len(used))
            fm.validate(points[used], renumber[triangles])


@pytest.mark.parametrize("seed", range(20))
def test_flipping_never_decreases_the_smallest_angle(seed):
    points = fm.random_points(40, seed=seed)
    angles = fm.record(fm.lawson(points, fm.any_triangulation(points))).min_angles()
    assert (np.diff(angles) >= -1e-9).all()


def test_min_angles_are_those_of_the_frames():
    trace = bowyer_watson_trace()
    angles = trace.min_angles()
    for k in range(0, len(trace), 7):
        assert angles[k] == pytest.approx(fm.Mesh(*map(np.nan_to_num, trace.frame(k))).min_angle)


def test_every_step_has_a_caption_of_one_sentence():
    for make in TRACES:
        for step in make():
            assert step.caption
            assert "\n" not in step.caption
            assert repr(step) == f"Step {step.kind}: {step.caption}"


def test_every_flip_is_preceded_by_the_test_that_asks_for_it():
    trace = lawson_trace()
    assert trace.counts["flip"] > 3
    for before, step in zip(trace, list(trace)[1:], strict=False):
        if step.kind == "flip":
            assert before.kind == "test"
            assert "must go" in before.caption
            assert as_set(before.doomed) == as_set(step.removed)


def test_cavities_are_star_shaped_and_all_their_circles_hold_the_point():
    points = fm.random_points(60, seed=8)
    trace = fm.record(fm.bowyer_watson(points))
    for step in trace:
        if step.kind == "cavity":
            assert all(fm.in_circle(*points[list(t)], step.point) for t in step.doomed)
            assert all(fm.orient(points[a], points[b], step.point) > 0 for a, b in step.edges)


def test_steps_do_not_change():
    step = fm.Step("flip", "why")
    with pytest.raises(AttributeError):
        step.kind = "cavity"


# ---- a lecturer's own generator -----------------------------------------------------------------------


def lecturers_own():
    points, triangles = [(0, 0), (4, 0), (0, 3)], [(0, 1, 2)]
    yield fm.Step("start", points=points, triangles=triangles)
    points.append((1, 1))
    yield fm.Step("cavity", "its circle holds the point", points=points, triangles=triangles, point=(1, 1), doomed=triangles)
    triangles.clear()
    yield fm.Step("dig", points=points, triangles=triangles)
    triangles += [(0, 1, 3), (1, 2, 3), [2, 0, 3]]
    yield fm.Step("fan", points=np.array(points), triangles=np.array(triangles))


def test_lists_that_change_after_the_yield_are_recorded_as_they_were():
    trace = fm.record(lecturers_own())
    assert [len(trace.frame(k)[1]) for k in range(4)] == [1, 1, 0, 3]
    assert [int((~np.isnan(trace.frame(k)[0][:, 0])).sum()) for k in range(4)] == [3, 4, 4, 4]
    assert trace[1].new_points == ((3, 1.0, 1.0),)
    assert trace[2].removed == ((0, 1, 2),)
    assert trace.mesh.triangles.shape == (3, 3)


def test_a_lecturers_points_may_vanish_and_move():
    def steps():
        yield fm.Step("many", points=[(0, 0), (1, 0), (0, 1), (5, 5)], triangles=[(0, 1, 3)])
        yield fm.Step("few", points=[(0, 0), (1, 0.5), (0, 1)], triangles=[(0, 1, 2)])

    trace = fm.record(steps())
    np.testing.assert_array_equal(trace.frame(0)[0][3], (5, 5))
    assert np.isnan(trace.frame(1)[0][3]).all()
    np.testing.assert_array_equal(trace.frame(1)[0][1], (1, 0.5))
    np.testing.assert_array_equal(trace.frame(0)[0][1], (1, 0))
    assert trace[1].gone_points == (3,)
    assert trace[1].new_points == ((1, 1.0, 0.5),)


def test_moving_points_are_measured_where_they_are():
    def steps():
        for height in (1, 9):
            yield fm.Step("move", points=[(0, 0), (1, 0), (0, height)], triangles=[(0, 1, 2)])

    assert fm.record(steps()).min_angles() == pytest.approx([45, np.degrees(np.arctan(1 / 9))])


def test_the_last_frame_of_the_textbook_has_only_the_points_that_are_left():
    points = [(0, 0), (1, 0), (0, 1), (1, 1)]
    mesh = fm.record(fm.textbook.bowyer_watson(points)).mesh
    assert len(mesh.points) == 4
    assert sorted(mesh.neighbors.ravel().tolist()) == [-1, -1, -1, -1, 0, 1]
    mesh.validate(delaunay=True)


@pytest.mark.parametrize(
    ("triangles", "message"),
    [([(0, 1, 3)], "point that is not there"), ([((0, 0), 1, 2)], "no triple of point numbers"), ([(0, 1)], "three corners")],
)
def test_a_lecturers_slip_is_named_with_its_step(triangles, message):
    with pytest.raises(fm.MeshError, match=rf"step 0 \(slip\): triangle .*{message}"):
        fm.record([fm.Step("slip", points=[(0, 0), (1, 0), (0, 1)], triangles=triangles)])


def test_adding_a_triangle_twice_is_an_error():
    with pytest.raises(fm.MeshError, match=r"step 1 \(again\) adds triangle .* there already"):
        fm.record([fm.Step("once", added=[(0, 1, 2)]), fm.Step("again", added=[(1, 2, 0)])])


def test_meshes_steps_and_traces_can_be_pickled_and_copied():
    trace = lawson_trace()
    for twin in (pickle.loads(pickle.dumps(trace)), copy.deepcopy(trace)):
        assert repr(twin) == repr(trace)
        assert [step.caption for step in twin] == [step.caption for step in trace]
        np.testing.assert_array_equal(twin.mesh.neighbors, trace.mesh.neighbors)
        assert dict(twin.mesh.work) == dict(trace.mesh.work)


def test_a_list_of_steps_is_recorded_like_a_generator():
    assert len(fm.record(list(lecturers_own()))) == 4


def test_an_endless_generator_is_recorded_up_to_the_limit():
    def endless():
        while True:
            yield fm.Step("again", points=[(0, 0)], triangles=[])

    trace = fm.record(endless(), limit=10)
    assert len(trace) == 10
    assert not trace.complete
    assert "stopped at the limit" in repr(trace)


def test_a_generator_that_yields_no_steps_is_told_what_to_yield():
    with pytest.raises(fm.MeshError, match=r"step 0 is 3: .* fm\.Step"):
        fm.record([3])


def test_removing_a_triangle_that_is_not_there_is_an_error():
    with pytest.raises(fm.MeshError, match=r"step 0 .flip. removes triangle"):
        fm.record([fm.Step("flip", removed=[(0, 1, 2)])])


def test_an_empty_trace_says_so():
    assert repr(fm.record([])) == "Trace: 0 steps"
    assert fm.record([]).mesh is None


def test_memory_grows_with_the_changes_and_not_with_the_mesh():
    tracemalloc.start()
    trace = fm.record(fm.bowyer_watson(fm.random_points(2000, seed=1)))
    used = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert used / len(trace) < 2500  # bytes a step: 200,000 steps fit in 500 MB


LONG = """
import psutil, fem_mesh as fm
points, process = fm.random_points(66_700, seed=1), psutil.Process()
fm.delaunay(points)  # Numba is not what is measured
before = process.memory_info().rss
trace = fm.record(fm.bowyer_watson(points), limit=None)
print(len(trace), process.memory_info().rss - before)
"""


@pytest.mark.exhaustive
def test_two_hundred_thousand_steps_fit_in_500_megabytes():
    told = subprocess.run([sys.executable, "-c", LONG], capture_output=True, text=True, check=True).stdout
    steps, used = map(int, told.split())
    assert steps > 200_000
    assert used < 500e6


@pytest.mark.parametrize(
    ("shown", "says"),
    [
        ({"edges": [(0, 7)]}, r"edges hold \(0, 7\), which are no 2 numbers of points: there are 3"),
        ({"circles": [(0, 1)]}, r"circles hold \(0, 1\), which are no 3 numbers"),
        ({"doomed": [(0, 1, -1)]}, "doomed hold"),
        ({"points": [(0, 0), (1, float("inf")), (0, 1)]}, r"point 1 = \(1\.0, inf\) is no pair of finite numbers"),
        ({"points": [(0, 0), (1, 2, 3), (0, 1)]}, r"point 1 = \(1\.0, 2\.0, 3\.0\)"),
    ],
)
def test_a_lecturers_slip_is_named_where_it_is_yielded(shown, says):
    step = fm.Step("look", **{"points": [(0, 0), (1, 0), (0, 1)], "triangles": [(0, 1, 2)], **shown})
    with pytest.raises(fm.MeshError, match=rf"step 0 \(look\): {says}"):
        fm.record([step])
