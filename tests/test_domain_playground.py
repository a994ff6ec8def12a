"""The domain playground in Python: what the browser asks, what it is told, and the code that makes a mesh again."""

import math
import os
import pickle
import subprocess
import sys
import threading
import time
from pathlib import Path

import ipywidgets
import listening
import numpy as np
import pytest
import traitlets
from hypothesis import given, settings
from hypothesis import strategies as st

import fem_mesh as fm
from fem_mesh import kernel
from fem_mesh.algorithms import ahead
from fem_mesh.watch.domain_playground import widget as module
from fem_mesh.watch.domain_playground.sketch import SHAPES, Sketch
from fem_mesh.watch.domain_playground.tell import encroached_segments

TRIANGLE = [[0, 0], [4, 0], [0, 3]]
LOOP = [[0, 1, -1, False], [1, 2, -1, False], [2, 0, -1, False]]
CROSSED = [[0, 0], [2, 2], [2, 0], [0, 2]]
GIVEN = {
    "with holes and regions": lambda: fm.Domain(
        [(0, 0), (8, 0), (8, 8), (0, 8), (2, 2), (4, 2), (4, 4)],
        [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 4)],
        [(3.5, 2.5)],
        names=["bottom side", "it's", 'a "wall"', "", "hole", "hole", "hole"],
        regions=[fm.Region(1, 1, "some steel", max_area=0.7)],
    ),
    "with several circles": lambda: fm.gear(8),
    "with one circle": lambda: fm.disk(n=7),
    "with a loose point": lambda: fm.Domain.from_loops([(0, 0), (4, 0), (4, 4)], points=[(3, 1)]),
    "with a crack": lambda: fm.Domain([(0, 0), (4, 0), (4, 4), (1, 0.5), (2, 1)], [(0, 1), (1, 2), (2, 0), (3, 4)]),
}


class Heard(listening.Heard):
    kind = fm.DomainPlayground

    def say(self, type, **rest):
        return super().say(type, **{"serial": "me 1", **rest})

    def draw(self, points, segments, start="", **rest):
        return self.say("ask", drawn={"start": start, "points": points, "segments": segments}, **rest)


def loop(*corners):
    n = len(corners)
    return [list(corner) for corner in corners], [[k, (k + 1) % n, -1, False] for k in range(n)]


def run(code):
    names = {}
    exec(code, names)
    return names["domain"], names["mesh"]


def assert_made_again(playground):
    domain, mesh = run(playground.as_code())
    for name in ("points", "triangles", "segments", "regions"):
        assert np.array_equal(getattr(mesh, name), getattr(playground.mesh, name)), name
    assert domain.names == playground.domain.names
    assert list(mesh.boundaries) == list(playground.mesh.boundaries)


# ---- in Python -------------------------------------------------------------------------------------


def test_what_it_says_of_itself_is_the_same_everywhere():
    code = "import fem_mesh as fm; p = fm.DomainPlayground(fm.star(), size=0.2, spots=[(0, 0, 0.05)]); print(p, p.still('k'))"
    said = {subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout for _ in range(2)}
    assert len(said) == 1
    assert said.pop().startswith("DomainPlayground: 10 corners, 328 triangles, smallest angle 26.3 degrees <style>")


def test_the_still_picture_shows_the_mesh_and_says_how_to_wake_it():
    still = fm.DomainPlayground(fm.l_shape(), min_angle=30).still("me")
    assert 'data-stands-in="me"' in still
    assert "data:image/svg+xml" in still
    assert "6 corners, 4 triangles, smallest angle 45.0 degrees; complete: 0 points added" in still
    assert "run" in still
    assert "nothing is drawn yet" in fm.DomainPlayground().still("me")


def test_bounds_can_be_set_observed_and_linked():
    playground = fm.DomainPlayground(fm.l_shape())
    seen = []
    playground.observe(lambda change: seen.append((playground.min_angle, len(change["new"].triangles))), "mesh")
    playground.size = 0.5
    slider = ipywidgets.FloatSlider(max=36)
    traitlets.link((playground, "min_angle"), (slider, "value"))
    assert slider.value == 20
    slider.value = 33
    assert playground.mesh.min_angle >= 33
    assert seen[0] == (20, 52)
    assert seen[-1] == (33, len(playground.mesh.triangles))
    playground.size, playground.min_angle = None, 0
    assert playground.mesh.refinement is None
    assert len(playground.mesh.triangles) == 4


@pytest.mark.parametrize(
    "wrong", [{"min_angle": -1}, {"min_angle": 37}, {"size": 0}, {"size": math.inf}, {"spots": [(0, 0, 0)]}]
)
def test_bounds_that_make_no_sense_are_refused_and_change_nothing(wrong):
    playground = fm.DomainPlayground(fm.l_shape())
    before = playground.mesh
    for name, value in wrong.items():
        with pytest.raises(traitlets.TraitError):
            setattr(playground, name, value)
    assert playground.mesh is before
    assert (playground.min_angle, playground.size, playground.spots) == (20, None, [])


def test_it_begins_with_a_domain_and_nothing_else():
    with pytest.raises(fm.MeshError, match="begins with a Domain"):
        fm.DomainPlayground([(0, 0), (1, 0), (0, 1)])


def test_a_domain_may_be_put_into_it_and_taken_out():
    heard = Heard()
    playground = heard.playground
    assert (playground.domain, playground.mesh, playground.trace) == (None, None, None)
    playground.domain = fm.gear()
    assert playground.mesh.domain is playground.domain
    content, buffers = heard.messages[-1]
    assert (content["drawn"]["start"], len(content["drawn"]["points"]), content["serial"]) == ("gear", 80, None)
    assert len(buffers[0]) == 16 * len(playground.mesh.points)
    playground.domain = None
    assert playground.mesh is None
    assert heard.messages[-1][0]["drawn"]["points"] == []


def test_spots_ask_for_small_triangles_around_them():
    playground = fm.DomainPlayground(fm.square(), spots=[(0.25, 0.5, 0.01)])
    mesh = playground.mesh
    ends = np.concatenate([mesh.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    lengths = np.hypot(*(mesh.points[ends[:, 0]] - mesh.points[ends[:, 1]]).T)
    away = np.hypot(*(mesh.points[ends] - [0.25, 0.5]).transpose(2, 0, 1)).min(axis=1)
    assert (lengths <= (0.01 + 0.3 * away) * (1 + 1e-12)).all()
    assert lengths[away < 0.05].max() < 0.03 < 0.15 < lengths.max()


# ---- what the browser asks -------------------------------------------------------------------------


def test_a_triangle_drawn_in_the_browser_is_a_domain():
    heard = Heard()
    content, buffers = heard.draw(TRIANGLE, LOOP, min_angle=0)
    playground = heard.playground
    assert playground.domain.points.tolist() == TRIANGLE
    assert playground.domain.names == ("outer",) * 3
    assert (content["serial"], content["triangles"], content["refusal"]) == ("me 1", 1, "")
    xy, triangles, segments, encroached, smallest = (
        np.frombuffer(buffer, kind) for buffer, kind in zip(buffers, ("<f8", "<i4", "<i4", "<i4", "<f4"), strict=True)
    )
    assert xy.tolist() == [0, 4, 0, 0, 0, 3]
    assert (len(triangles), len(segments), len(encroached)) == (3, 6, 0)
    assert smallest[0] == pytest.approx(playground.mesh.min_angle)
    assert sum(content["histogram"]) == 3
    assert content["histogram"][18] == 1
    assert "drawn" not in content


def test_the_first_loop_is_the_outline_and_others_are_holes_and_islands():
    corners, segments = [], []
    for k, side in enumerate((8, 6, 4)):
        more, around = loop((-side, -side), (side, -side), (side, side), (-side, side))
        corners += more
        segments += [[a + 4 * k, b + 4 * k, -1, False] for a, b, _, _ in around]
    heard = Heard()
    heard.draw(corners, segments)
    assert heard.playground.mesh.areas().sum() == pytest.approx(16**2 - 12**2 + 8**2)
    assert_made_again(heard.playground)


def test_a_crossing_is_refused_with_its_place_and_the_next_answer_may_be_a_mesh():
    heard = Heard(fm.square())
    content, buffers = heard.draw(*loop(*CROSSED))
    playground = heard.playground
    assert (playground.domain, playground.mesh) == (None, None)
    assert playground.refusal == content["refusal"]
    assert "cross at (1, 1)" in content["refusal"]
    assert content["where"] == [1, 1] == list(playground.where)
    assert buffers == []
    assert playground.as_code() == "import fem_mesh as fm"
    assert repr(playground).startswith("DomainPlayground: 4 corners, refused: segment 0")
    content, _ = heard.draw(TRIANGLE, LOOP)
    assert (content["refusal"], content["where"], playground.refusal) == ("", None, "")


def test_an_outline_without_an_inside_is_a_mesh_without_triangles():
    heard = Heard()
    content, buffers = heard.draw([[0, 0], [1, 0], [2, 0]], LOOP)
    assert (content["triangles"], content["refusal"], sum(content["histogram"])) == (0, "", 0)
    assert content["state"] == "no triangles: all 3 points lie on one line"
    assert repr(heard.playground) == "DomainPlayground: 3 corners, 0 triangles"
    assert [len(buffer) for buffer in buffers] == [48, 0, 0, 0, 0]
    assert "<img" in heard.playground.still("me")  # its corners


def test_points_without_a_segment_are_a_domain_whose_points_may_move():
    heard = Heard(fm.Domain([(0, 0), (1, 0), (0, 1)], []))
    assert repr(heard.playground) == "DomainPlayground: 3 corners, 1 triangle, smallest angle 45.0 degrees"
    heard.draw([[0, 0], [1, 0], [0, 2]], [], start="domain 1")
    assert heard.playground.mesh.areas().tolist() == [1]
    assert_made_again(heard.playground)


def test_whatever_goes_wrong_the_browser_gets_an_answer():
    heard = Heard(fm.square())
    with pytest.raises(traitlets.TraitError):
        heard.say("ask", min_angle=50)
    content, _ = heard.messages[-1]
    assert content["serial"] == "me 1"
    assert "TraitError" in content["refusal"]
    assert heard.say("ask", min_angle=30)[0]["refusal"] == ""


@pytest.mark.parametrize("start", SHAPES)
def test_it_starts_from_each_shape(start):
    heard = Heard()
    content, _ = heard.say("ask", drawn={"start": start})
    assert content["drawn"]["start"] == start
    assert len(heard.playground.mesh.triangles) > 0
    left, right, bottom, top = content["box"]
    x, y = np.array(content["drawn"]["points"]).T
    assert left < x.min() < x.max() < right
    assert bottom < y.min() < y.max() < top
    assert_made_again(heard.playground)
    again = fm.DomainPlayground(heard.playground.domain)
    assert again.as_code() == heard.playground.as_code()
    assert "fm.Domain" not in again.as_code()


def test_a_changed_bound_makes_one_mesh_and_tells_the_observers_when_all_is_done():
    heard, seen = Heard(fm.l_shape()), []
    playground = heard.playground
    playground.observe(lambda _: seen.append((playground.min_angle, playground.size, len(playground.mesh.triangles))))
    heard.say("ask", min_angle=30, size=0.5, spots=[[0, 0, 0.1]], encroachment="circle")
    assert len(heard.messages) == 1
    assert set(seen) == {(30, 0.5, len(playground.mesh.triangles))}


def test_a_corner_that_moved_leaves_its_curves_and_the_others_stay_on_theirs():
    heard = Heard(fm.disk(n=8))
    playground, (content, _) = heard.playground, heard.say("hello")
    corners, segments = content["drawn"]["points"], content["drawn"]["segments"]
    corners[0] = [1.25, 0.25]
    heard.draw(
        corners, [[a, b, row, curved and 0 not in (a, b)] for a, b, row, curved in segments], start="domain 1", min_angle=30
    )
    assert sorted(playground.domain.curves) == [1, 2, 3, 4, 5, 6]
    assert_made_again(playground)


# ---- as code ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("make", GIVEN.values(), ids=GIVEN)
def test_code_makes_a_given_domain_again(make):
    playground = fm.DomainPlayground(make(), min_angle=25)
    assert_made_again(playground)
    assert max(map(len, playground.as_code().splitlines())) <= 120


@pytest.mark.parametrize("start", SHAPES)
def test_code_makes_a_shape_again_whose_corner_was_moved_and_another_one_removed(start):
    sketch, heard = Sketch.of_shape(start), Heard()
    heard.say("ask", drawn={"start": start})
    corners = [list(corner) for corner in sketch.points]
    corners[1] = [corners[1][0] * 1.0625, corners[1][1] * 1.0625]
    segments = [[a, b, row, curved and 1 not in (a, b)] for a, b, row, curved in sketch.segments]
    last = [s for s in segments if max(s[:2]) == len(corners) - 1]
    if len(last) == 2 and len(corners) > 4:  # as the browser does it
        (a, b), kept = [min(s[:2]) for s in last], [s for s in segments if s not in last]
        corners, segments = corners[:-1], [*kept, [b, a, last[0][2], False]]
    heard.draw(corners, segments, start=start, min_angle=20)
    assert heard.playground.refusal == ""
    assert_made_again(heard.playground)


@pytest.mark.parametrize(
    "bounds",
    [
        {"min_angle": 0},
        {"min_angle": 0, "size": 0.3},
        {"min_angle": 33.5, "size": 0.125},
        {"encroachment": "circle"},
        {"spots": [(0.1, 0.2, 0.03), (0.7, -0.3, 0.01)]},
        {"spots": [(0.1, 0.2, 0.03)], "size": 0.1},
        {"size": 0.01},
    ],
    ids=str,
)
def test_code_makes_a_mesh_again(bounds):
    playground = fm.DomainPlayground(fm.star(), **bounds)
    assert_made_again(playground)
    assert ("max_points" in playground.as_code()) == ("size" in bounds and bounds["size"] == 0.01)


numbers = st.floats(-1e6, 1e6, allow_nan=False).map(lambda v: float(f"{v:.12g}"))


@given(st.lists(st.tuples(numbers, numbers), min_size=3, max_size=6, unique=True))
@settings(max_examples=60, deadline=None)
def test_code_of_any_drawn_polygon_holds_its_corners_to_the_last_bit(corners):
    points, segments = loop(*corners)
    sketch = Sketch().edited(points, segments)
    names = {"fm": fm}
    try:
        domain = sketch.to_domain()
    except fm.MeshError:
        return
    exec(sketch.as_code(), names)
    assert np.array_equal(names["domain"].points, domain.points)
    assert np.array_equal(names["domain"].segments, domain.segments)


# ---- what it tells ---------------------------------------------------------------------------------


def brute_force(mesh, lens=None):
    """Segments with a corner of an adjacent triangle in their diametral circle, or lens."""
    found = []
    for a, b in mesh.segments.tolist():
        for t in mesh.triangles.tolist():
            if a in t and b in t:
                (v,) = set(t) - {a, b}
                p, q, r = (mesh.points[i] for i in (a, b, v))
                u, w = p - r, q - r
                angle = math.degrees(math.acos(max(-1, u @ w / math.sqrt((u @ u) * (w @ w)))))
                if fm.in_diametral_circle(p, q, r) and (lens is None or angle >= 180 - 2 * lens):
                    found.append((a, b))
                    break
    return found


@pytest.mark.parametrize("start", SHAPES)
def test_encroached_segments_are_those_with_a_corner_in_their_circle(start):
    domain = Sketch.of_shape(start).given
    plain = fm.constrained_delaunay(domain)
    assert list(map(tuple, encroached_segments(plain).tolist())) == brute_force(plain)
    assert list(map(tuple, encroached_segments(plain, lens=20).tolist())) == brute_force(plain, lens=20)
    circle = fm.refine(domain, min_angle=20, encroachment="circle")
    lens = fm.refine(domain, min_angle=20)
    assert len(encroached_segments(circle)) == len(encroached_segments(lens, lens=20)) == 0


def test_what_could_not_be_mended_is_told_with_the_reason():
    heard = Heard(fm.Domain.from_loops([(0, 0), (8, 0), (8, 1)]), min_angle=30)
    assert heard.say("hello")[0]["state"] == "complete: 8 points added, 2 triangles left (small input angle)"
    assert heard.say("ask", min_angle=0)[0]["state"] == "no bounds: constrained Delaunay, no points added"


def test_the_steps_are_recorded_when_they_are_asked_for_and_cut_where_there_are_many():
    heard = Heard(fm.l_shape(), size=0.5)
    content, _ = heard.say("steps")
    playground = heard.playground
    assert (content["type"], content["cut"]) == ("steps", "")
    assert len(content["data"]["steps"]) == len(playground.trace)
    assert np.array_equal(playground.trace.mesh.points, playground.mesh.points)
    first = playground.trace
    assert playground.trace is first
    playground.size = 0.04
    content, _ = heard.say("steps")
    assert content["cut"] == "the first 5,000 steps of it: the run goes on"
    assert len(playground.trace) == module.MOST_STEPS
    playground.size, playground.min_angle = None, 0
    assert {"start", "done"} <= set(playground.trace.counts) <= {"start", "segment", "cross", "carve", "done"}


def test_another_view_gets_all_of_it():
    heard = Heard(fm.l_shape())
    heard.draw(TRIANGLE, LOOP, min_angle=30)
    content, buffers = heard.say("hello")
    assert (content["to"], content["drawn"]["points"], content["shapes"]) == ("hello", TRIANGLE, list(SHAPES))
    assert len(buffers) == 5


# ---- compiling ahead -------------------------------------------------------------------------------


def test_while_compiling_goes_on_meshes_are_small_and_then_whole(monkeypatch):
    heard = Heard(fm.l_shape())
    monkeypatch.setattr(ahead, "is_ready", lambda: False)
    content, _ = heard.say("ask", size=0.05)
    assert heard.playground.mesh.refinement.added == module.FEW_POINTS
    assert content["provisional"]
    assert content["state"].endswith("; more of them as soon as that is compiled")
    assert_made_again(heard.playground)
    assert heard.say("steps")[0]["cut"] == f"a run that may add {module.FEW_POINTS} points; more when that is compiled"
    monkeypatch.setattr(ahead, "is_ready", lambda: True)
    content, _ = heard.say("ask", size=0.05)
    assert heard.playground.mesh.refinement.complete
    assert not content["provisional"]


def test_a_thread_that_wants_nothing_compiled_runs_plain_python_however_large_the_input(monkeypatch):
    def fail(*_):
        raise AssertionError("compiled")

    monkeypatch.setattr(kernel, "_compile", fail)
    monkeypatch.setattr(kernel, "_compiled", {})
    monkeypatch.setattr(kernel, "SMALL", 0)
    monkeypatch.setattr(kernel, "EVENTS_IN_PYTHON", 1)
    with kernel.compiling(False):
        mesh = fm.refine(fm.letter("A"), min_angle=30)
    assert mesh.min_angle >= 30
    with pytest.raises(AssertionError, match="compiled"):
        fm.refine(fm.letter("A"), min_angle=30)


AHEAD = """
import threading
from fem_mesh import kernel
from fem_mesh.algorithms import ahead
{before}
ahead.compile_ahead()
ahead.compile_ahead()
ahead._thread.join(60)
assert sum(t.name.startswith("fem_mesh") for t in threading.enumerate()) == 0
assert ahead.is_ready() and kernel.is_compiled(ahead.refine_mesh) == {compiled} and ahead._child is None
"""


def runs_in_silence(code, **environment):
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=os.environ | environment)
    assert (ran.returncode, ran.stderr) == (0, "")
    return ran.stdout


def test_where_nothing_can_be_compiled_nothing_is_waited_for():
    code = AHEAD.format(before="ahead.sys.executable = '/nowhere/else'", compiled=False)
    assert runs_in_silence(code, NUMBA_DISABLE_JIT="1") == ""


@pytest.mark.exhaustive
def test_compiling_ahead_takes_what_is_kept_and_says_nothing():
    code = AHEAD.format(before="kernel.is_kept(ahead.refine_mesh) or ahead.compile_now()", compiled=True)
    assert runs_in_silence(code) == ""


@pytest.mark.parametrize("seconds", [0.0, 0.5])
def test_a_process_that_ends_while_its_compiling_goes_on_ends_at_once_and_alone(tmp_path, seconds):
    code = f"""
import time
from fem_mesh.algorithms import ahead
ahead.compile_ahead()
time.sleep({seconds})
print(ahead._child.pid if ahead._child else 0)
"""
    begin = time.monotonic()
    child = int(runs_in_silence(code, NUMBA_CACHE_DIR=str(tmp_path / "numba")))
    assert time.monotonic() - begin < 15
    command = Path(f"/proc/{child}/cmdline")
    assert not (command.exists() and b"compile_now" in command.read_bytes())


def test_an_error_keeps_its_place_in_a_pickle():
    with pytest.raises(fm.MeshError) as caught:
        fm.Domain(CROSSED, [(0, 1), (2, 3)])
    again = pickle.loads(pickle.dumps(caught.value))
    assert (str(again), again.where) == (str(caught.value), (1.0, 1.0))
    assert fm.MeshError("no").where is None


# ---- what goes wrong -----------------------------------------------------------------------------------


def test_an_interrupt_is_answered_and_leaves_no_old_mesh_behind(monkeypatch):
    heard = Heard(fm.l_shape())

    def interrupted(*arguments, **options):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("fem_mesh.watch.domain_playground.widget.refine", interrupted)
        with pytest.raises(KeyboardInterrupt):
            heard.say("ask", size=0.25)
    assert "KeyboardInterrupt" in heard.messages[-1][0]["refusal"]
    message, _ = heard.say("ask", size=0.25)
    assert (message["refusal"], message["triangles"] > 100) == ("", True)


def test_steps_that_cannot_be_had_are_answered(monkeypatch):
    heard = Heard()
    assert heard.say("steps")[0]["refusal"] == "there is no domain to play the steps of"

    def broken(*arguments, **options):
        raise RuntimeError("no steps")

    heard = Heard(fm.l_shape())
    monkeypatch.setattr("fem_mesh.watch.domain_playground.widget.record", broken)
    with pytest.raises(RuntimeError):
        heard.say("steps")
    assert heard.messages[-1][0]["refusal"] == "RuntimeError: no steps"


@pytest.mark.parametrize("spots", [[1], [(1, 2)], [("a", 1, 1)], 5])
def test_spots_that_are_no_triples_are_refused(spots):
    with pytest.raises(traitlets.TraitError):
        fm.DomainPlayground(spots=spots)


def test_a_bound_that_a_cell_sets_waits_for_the_answer_to_a_page(monkeypatch):
    """JupyterLab hands messages over in a thread of their own."""
    playground, begun = fm.DomainPlayground(fm.square()), threading.Event()

    def slow(*arguments, **options):
        begun.set()
        time.sleep(0.2)
        return fm.refine(*arguments, **options)

    monkeypatch.setattr(module, "refine", slow)
    ask = {"type": "ask", "serial": "a 1", "min_angle": 25}
    page = threading.Thread(target=playground._answer, args=(playground, ask, []))
    page.start()
    assert begun.wait(10)
    playground.size = 0.1
    assert len(playground.mesh.triangles) > 100
    page.join()
    assert (playground.min_angle, playground.size) == (25, 0.1)
