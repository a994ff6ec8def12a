"""The playground in Python: what the pointer does, and what it tells the browser, without one."""

import itertools
import sys
import threading

import listening
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fem_mesh as fm
from fem_mesh.watch import playground as playground_module


class Heard(listening.Heard):
    kind = fm.Playground


def turned(triangles):
    return sorted(min((a, b, c), (b, c, a), (c, a, b)) for a, b, c in np.reshape(triangles, (-1, 3)).tolist())


def state(playground):
    return playground.points.tolist(), turned(playground.mesh.triangles)


def check(playground):
    """The mesh is Delaunay on the points, and the trace ends where the playground stands."""
    if len(playground.mesh.triangles):
        playground.mesh.validate(delaunay=True)
    if len(playground.trace):
        points, triangles = playground.trace.frame(-1)
        assert (points[: len(playground.points)].tolist(), turned(triangles)) == state(playground)


def test_each_thing_one_does_leaves_a_delaunay_mesh_and_a_trace_that_ends_in_it():
    heard = Heard()
    heard.say("random")
    heard.say("add", x=0.5, y=0.5)
    heard.say("more")
    heard.say("remove", i=3)
    for k in range(5):
        heard.say("move", i=7, x=0.1 * k, y=0.3)
    heard.say("move", i=7, x=0.9, y=0.3, last=True)
    playground = heard.playground
    assert len(playground.points) == 36
    assert playground.points[7].tolist() == [0.9, 0.3]
    check(playground)


places = st.integers(0, 6).map(lambda v: v / 8)
acts = st.one_of(
    st.tuples(st.just("add"), places, places),
    st.tuples(st.just("remove"), st.integers(0, 30)),
    st.tuples(st.just("move"), st.integers(0, 30), places, places),
    st.tuples(st.sampled_from(["undo", "redo", "ring", "grid", "clear"])),
)


@given(st.lists(acts, max_size=30))
def test_whatever_one_does_undo_goes_all_the_way_back_and_redo_forward_again(list_of_acts):
    heard = Heard()
    beginning = state(heard.playground)
    for name, *numbers in list_of_acts:
        keys = ("x", "y") if name == "add" else ("i", "x", "y")
        heard.say(name, **dict(zip(keys, numbers, strict=False)), **({"last": True} if name == "move" else {}))
        check(heard.playground)
    playground = heard.playground
    while heard.messages and playground._undone:  # to the last thing done
        playground.redo()
    end = state(playground)
    while playground._done:
        playground.undo()
        check(playground)
    assert state(playground) == beginning
    while playground._undone:
        playground.redo()
    assert state(playground) == end


def test_the_browser_can_follow_by_differences_alone():
    heard = Heard([(0, 0), (1, 0), (0, 1), (1, 1), (0.5, 0.4)])
    shown = set(turned(heard.playground.mesh.triangles))
    for name, rest in [
        ("add", {"x": 0.3, "y": 0.3}),
        ("add", {"x": 2.0, "y": 0.5}),
        ("remove", {"i": 1}),
        ("move", {"i": 0, "x": -0.5, "y": 0.2}),
        ("move", {"i": 0, "x": -0.5, "y": 0.3, "last": True}),
        ("add", {"x": 0.3, "y": 0.3}),
    ]:
        message, _ = heard.say(name, **rest)
        for step in message["steps"]:
            shown -= set(turned(step["removed"]))
            shown |= set(turned(step["added"]))
        assert sorted(shown) == turned(heard.playground.mesh.triangles)


def test_the_whole_mesh_travels_as_plain_numbers():
    heard = Heard(fm.random_points(50, seed=2))
    message, (points, triangles) = heard.say("all")
    assert message["type"] == "all"
    assert np.frombuffer(points, "<f8").reshape(-1, 2).tolist() == heard.playground.points.tolist()
    assert turned(np.frombuffer(triangles, "<i4")) == turned(heard.playground.mesh.triangles)


def test_a_click_on_a_point_that_is_there_adds_none():
    heard = Heard([(0, 0), (1, 0), (0, 1)])
    message, _ = heard.say("add", x=1, y=0)
    assert message["said"] == "point 3 equals point 1: it is merged into it"
    assert len(heard.playground.points) == 3
    assert not message["undo"]


def test_a_point_cannot_be_dragged_onto_another():
    heard = Heard([(0, 0), (1, 0), (0, 1)])
    message, _ = heard.say("move", i=2, x=1, y=0, last=True)
    assert message["said"] == "point 2 stays where it was: point 1 is there already"
    check(heard.playground)


def test_what_cannot_be_done_is_said_and_changes_nothing():
    heard = Heard([(0, 0), (1, 0), (0, 1)])
    before = state(heard.playground)
    for name, rest in (("add", {"x": float("nan"), "y": 0}), ("remove", {"i": 9}), ("move", {"i": 9, "x": 0, "y": 0})):
        message, _ = heard.say(name, **rest)
        assert "point" in message["said"]
        assert state(heard.playground) == before
    with pytest.raises(fm.MeshError, match="no point 9"):
        heard.playground.remove(9)


def test_a_drag_is_one_step_of_the_trace_and_one_undo():
    heard = Heard(fm.random_points(20, seed=4))
    before, steps = state(heard.playground), len(heard.playground.trace)
    for k in range(10):
        heard.say("move", i=4, x=0.1 * k, y=0.5)
    heard.say("move", i=4, x=0.95, y=0.5, last=True)
    assert len(heard.playground.trace) == steps + 1
    assert heard.playground.trace[-1].kind == "move"
    heard.say("undo")
    assert state(heard.playground) == before


def test_what_is_done_in_the_midst_of_a_drag_ends_it_first():
    for act in ("add", "undo", "random", "remove"):
        heard = Heard(fm.random_points(12, seed=4))
        heard.say("move", i=4, x=0.1, y=0.5)
        heard.say("move", i=4, x=0.2, y=0.5)
        heard.say(act, **{"add": {"x": 0.5, "y": 0.5}, "remove": {"i": 2}}.get(act, {}))
        check(heard.playground)
        while heard.playground._done:
            heard.playground.undo()
        assert state(heard.playground)[0] == fm.random_points(12, seed=4).tolist()


def test_the_ring_and_the_grid_are_full_of_exact_ties():
    heard = Heard(ties=True)
    ring, _ = heard.say("ring")
    assert len(heard.playground.points) == 12
    assert len(ring["ties"]) == 2 * 9  # every inner edge
    grid, _ = heard.say("grid")
    assert len(heard.playground.points) == 25
    assert len(grid["ties"]) == 2 * 16  # a diagonal in every square


@pytest.mark.parametrize("box", [(-0.06, 1.06, -0.06, 1.06), (-3, 300, 0.001, 1), (1e6, 1e6 + 1, 0, 1)])
def test_ties_are_exact_in_any_view(box):
    heard = Heard(box=box, ties=True)
    assert len(heard.say("ring")[0]["ties"]) == 18
    left, right, bottom, top = box
    x, y = heard.playground.points.T
    assert left < x.min() < x.max() < right
    assert bottom < y.min() < y.max() < top


def test_the_same_seed_makes_the_same_points():
    first, second, other = Heard(seed=5), Heard(seed=5), Heard(seed=6)
    for heard in (first, second, other):
        heard.say("random")
        heard.say("more")
    assert state(first.playground) == state(second.playground) != state(other.playground)
    assert len(first.playground.points) == 36


def test_copied_code_makes_the_same_points_again():
    heard = Heard()
    heard.say("random")
    for playground in (heard.playground, fm.Playground()):
        names = {}
        exec(playground.as_code(), names)
        assert names["playground"].points.tolist() == playground.points.tolist()


def test_whoever_observes_hears_of_every_change():
    playground, heard = fm.Playground(), []
    playground.observe(lambda change: heard.append(len(playground.points)), "version")
    playground.add(0, 0)
    playground.add(1, 0)
    playground.remove(0)
    playground.clear()
    playground.undo()
    assert heard == [1, 2, 1, 0, 1]


def test_a_playground_of_many_points_begins_at_once_and_goes_on():
    playground = fm.Playground(fm.random_points(2000, seed=1))
    playground.add(0.5, 0.5)
    playground.remove(17)
    check(playground)
    assert len(playground.trace) < 10


def test_what_stands_in_for_a_playground_says_what_it_is():
    for points in (None, [(0, 0)], fm.random_points(30, seed=1)):
        playground = fm.Playground(points)
        still = playground.still("key")
        assert repr(playground) in still
        assert ("<img" in still) == (points is not None)
        assert len(still) < 60_000
        assert still == fm.Playground(points).still("key")


def test_what_stands_in_for_a_playground_shows_what_it_shows():
    points = fm.random_points(12, seed=1)
    plain = fm.Playground(points).still("key")
    for shown, word in (("circles", "circumcircle"), ("voronoi", "Voronoi edge")):
        assert word not in plain
        assert word in fm.Playground(points, **{shown: True}).still("key")


def test_equal_points_to_begin_with_are_merged():
    playground = fm.Playground([(0, 0), (1, 0), (0, 1), (1, 0)])
    assert len(playground.points) == 3
    assert list(itertools.chain(playground.mesh.unused)) == []


# ---- drags -------------------------------------------------------------------------------------------


def test_a_drag_tells_what_all_of_it_changed():
    heard = Heard([(0, 0), (4, 0), (0, 4), (4, 4), (1, 1), (3, 2)])
    for x in (1.2, 2.0, 3.4):
        heard.say("move", i=4, x=x, y=1)
    heard.say("move", i=4, x=3.4, y=1, last=True)  # which changes no triangle any more
    step = heard.playground.trace[-1]
    assert (step.kind, len(step.added) > 0) == ("move", True)
    assert step.caption == f"point 4 moves: {len(step.added)} triangles come, {len(step.removed)} go"


def test_a_drag_whose_end_is_not_heard_is_not_lost():
    heard = Heard([(0, 0), (4, 0), (0, 4), (4, 4), (1, 1), (3, 2)])
    heard.say("move", i=4, x=2, y=1)
    heard.say("move", i=5, x=3, y=3)
    heard.say("move", i=5, x=3, y=3.5, last=True)
    check(heard.playground)
    heard.say("undo")
    assert heard.playground.points[4:].tolist() == [[2, 1], [3, 2]]
    heard.say("undo")
    assert heard.playground.points[4:].tolist() == [[1, 1], [3, 2]]


def test_a_drag_that_comes_back_is_nothing_to_undo():
    heard = Heard([(0, 0), (4, 0), (0, 4), (1, 1)])
    heard.playground.add(3, 3)
    heard.say("undo")
    steps = len(heard.playground.trace)
    for x in (2, 1):
        message, _ = heard.say("move", i=3, x=x, y=1, last=x == 1)
    assert message["redo"]
    assert len(heard.playground.trace) == steps


def test_what_can_be_undone_takes_a_bounded_room(monkeypatch):
    heard = Heard(fm.random_points(400, seed=1))
    for k in range(playground_module.MOST_UNDONE + 5):
        heard.say("move", i=k, x=0.5 + k / 1000, y=0.5, last=True)
    assert len(heard.playground._done) == playground_module.MOST_UNDONE
    monkeypatch.setattr(playground_module, "MOST_KEPT", 100_000)
    heard.playground.add(0.1, 0.1)
    assert 0 < sum(map(playground_module._weight, heard.playground._done)) <= 100_000


@pytest.mark.parametrize("points", [[(0, 0), (2, 0)], [(0, 0), (2, 0), (2, 2), (0, 2)], fm.random_points(20, seed=1)])
def test_the_voronoi_diagram_that_is_drawn_is_that_of_the_mesh(points):
    heard = Heard(points, voronoi=True)
    message, buffers = heard.say("all")
    lines = np.frombuffer(buffers[-1], "<f8").reshape(-1, 2, 2)
    assert message["voronoi"]
    assert len(lines) == len(heard.playground.mesh.voronoi().edges) > 0


def test_a_click_may_come_while_a_cell_adds_points():
    """JupyterLab hands messages over in a thread of their own."""
    playground, rng = fm.Playground(), np.random.default_rng(2)
    places = rng.random((2, 120, 2)).tolist()

    def click():
        for x, y in places[1]:
            playground._answer(playground, {"type": "add", "x": x, "y": y}, [])

    clicks = threading.Thread(target=click, daemon=True)
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-4)
    try:
        clicks.start()
        for x, y in places[0]:
            playground.add(x, y)
            playground.mesh.validate()
        clicks.join(60)
    finally:
        sys.setswitchinterval(before)
    assert not clicks.is_alive()
    assert sorted(playground.points.tolist()) == sorted(places[0] + places[1])
    playground.mesh.validate(delaunay=True)
