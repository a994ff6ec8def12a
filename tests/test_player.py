"""A trace as a page and as a widget: readable as it stands, deterministic, small; its traits follow and lead."""

import html
import itertools
import json
import re
import subprocess
import sys

import ipywidgets
import numpy as np
import pytest

import fem_mesh as fm
from fem_mesh.watch import player as player_module
from fem_mesh.watch.page import MOST_EMBEDDED, html_of_trace
from fem_mesh.watch.wire import UNIT, as_data


def flips():
    points = fm.random_points(16, seed=1)
    return fm.record(fm.lawson(points, fm.any_triangulation(points)))


def endless():
    points = [(0, 0), (1, 0), (0, 1)]
    for k in itertools.count():
        yield fm.Step("count", f"this is {k}", points=points, triangles=[(0, 1, 2)])


def vanishing():
    yield fm.Step("start", "", points=[(0, 0), (1, 0), (0, 1), (1, 1)], triangles=[(0, 1, 2), (1, 3, 2)])
    yield fm.Step("move", "", points=[(0, 0), (1, 0), (0, 1), (2, 2)], triangles=[(0, 1, 2), (1, 3, 2)])
    yield fm.Step("go", "", points=[(0, 0), (1, 0), (0, 1)], triangles=[(0, 1, 2)])


TRACES = {
    "flips": flips,
    "insertion": lambda: fm.record(fm.bowyer_watson(fm.grid_points(4))),
    "flood": lambda: fm.record(fm.insert_segments(fm.letter("G"))),
    "refinement": lambda: fm.record(fm.ruppert(fm.plate_with_hole(), min_angle=28)),
    "no triangle": lambda: fm.record(fm.bowyer_watson([(0, 0), (1, 1)])),
    "one step": lambda: fm.record([fm.Step("look", "", points=[(0, 0)], triangles=[])]),
    "vanishing": lambda: fm.record(vanishing()),
    "far away": lambda: fm.record(fm.bowyer_watson(fm.random_points(6) + 1e6)),
}


@pytest.fixture(scope="module", params=TRACES, name="trace")
def any_trace(request):
    return TRACES[request.param]()


# ---- the table that travels --------------------------------------------------------------------------


def alive(table, k, width):
    born, lived = np.cumsum(table["born"], dtype=int), np.array(table["lived"], dtype=int)
    died = np.where(lived > 0, born + lived, np.iinfo(int).max)
    rows = np.array(table["rows"], dtype=int).reshape(-1, width)
    here = (born <= k) & (k < died)
    return rows[here], np.array(table["numbers"], dtype=int)[here]


def test_every_frame_can_be_read_off_the_table_that_travels(trace):
    data = json.loads(json.dumps(as_data(trace)))
    left, right, bottom, _ = data["box"]
    for k in range(len(trace)):
        points, triangles = trace.frame(k)
        assert sorted(alive(data["triangles"], k, 3)[0].tolist()) == sorted(triangles.tolist())
        assert sorted(alive(data["segments"], k, 2)[0].tolist()) == sorted(trace.segments(k).tolist())
        rows, numbers = alive(data["points"], k, 2)
        assert sorted(numbers) == np.flatnonzero(~np.isnan(points[:, 0])).tolist()
        places = rows * UNIT * (right - left) + (left, bottom)
        assert np.allclose(places, points[numbers], rtol=0, atol=0.51 * UNIT * (right - left))


def test_the_beginning_of_a_trace_is_the_trace_of_its_beginning():
    trace = flips()
    for n in (1, 7, len(trace)):
        part = fm.record(trace[:n], view=trace.view_box())
        assert as_data(trace, n) | {"more": None} == as_data(part) | {"more": None}


def test_steps_say_what_they_show(trace):
    for step, told in zip(trace, as_data(trace)["steps"], strict=True):
        for name in ("doomed", "visited", "asked", "encroached", "edges"):
            assert told.get(name, []) == list(itertools.chain(*getattr(step, name)))
        assert told.get("circles", told.get("doomed", [])) == list(itertools.chain(*step.circles))


# ---- pages -------------------------------------------------------------------------------------------


def rows_of(page):
    return re.findall(r"<tr><td>(\d+)<td>(.*?)<td>(.*)", page)


def test_a_page_tells_each_step_in_words(trace):
    told = [(k, kind, html.unescape(caption)) for k, kind, caption in rows_of(html_of_trace(trace))]
    assert told == [(str(k), step.kind, step.caption) for k, step in enumerate(trace)][: len(told)]
    assert len(told) == len(trace) or "more steps" in html_of_trace(trace)


def test_a_page_asks_nobody_for_anything(trace, tmp_path):
    trace.save(tmp_path / "steps.html")
    page = (tmp_path / "steps.html").read_text(encoding="utf-8")
    links = set(re.findall(r"https?://[^\s\"'`)]*", page))
    assert links <= {"http://www.w3.org/2000/svg"}  # a name, not a place


def test_a_cell_never_embeds_more_than_60_kilobytes():
    assert len(html_of_trace(flips()).encode()) <= MOST_EMBEDDED == 60_000
    assert "fem-data" in html_of_trace(flips())
    long = fm.record(fm.bowyer_watson(fm.random_points(500)))
    assert len(html_of_trace(long).encode()) <= MOST_EMBEDDED
    assert "fem-data" not in html_of_trace(long)
    assert "trace.save(&quot;steps.html&quot;)" in html_of_trace(long)


def test_a_thousand_steps_are_a_page_of_at_most_400_kilobytes(tmp_path):
    trace = fm.record(fm.bowyer_watson(fm.random_points(340, seed=1)))
    assert len(trace) >= 1000
    trace.save(tmp_path / "steps.html")
    assert (tmp_path / "steps.html").stat().st_size <= 400_000


def test_what_a_cell_shows_is_the_same_in_every_process():
    code = """
import fem_mesh as fm
points = fm.random_points(16, seed=1)
trace = fm.record(fm.lawson(points, fm.any_triangulation(points)))
print(hash_of := __import__("zlib").crc32(str(trace._repr_mimebundle_()).encode()))
"""
    outputs = {
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout for _ in range(2)
    }
    assert len(outputs) == 1


def test_captions_cannot_leave_their_place(tmp_path):
    step = fm.Step("<b>", "</td></table></script><script>alert(1)</script> & done", points=[(0, 0)], triangles=[])
    page = html_of_trace(fm.record([step]))
    assert page.count("<script") == 2
    assert "<b>" not in page
    assert rows_of(page)[0][1:] == (html.escape(step.kind), html.escape(step.caption))


def test_an_empty_trace_cannot_be_saved_or_played(tmp_path):
    with pytest.raises(fm.MeshError, match="trace is empty"):
        fm.record([]).save(tmp_path / "steps.html")
    with pytest.raises(fm.MeshError, match="trace is empty"):
        fm.play([])
    with pytest.raises(fm.MeshError, match="leave out steps"):
        flips().save(tmp_path / "steps.html", steps=[1])


# ---- the widget --------------------------------------------------------------------------------------


def shown(widget, monkeypatch):
    """What a notebook's cell gets when the widget is its result."""
    displayed = []
    monkeypatch.setattr("fem_mesh.watch.live.display", lambda data, raw: displayed.append(data))
    widget._ipython_display_()
    return displayed


def test_a_player_is_shown_twice_as_a_page_and_as_a_widget(monkeypatch):
    page, widget = shown(fm.play(flips()), monkeypatch)
    assert page["text/plain"] == "Player of 87 steps"
    assert 'data-stands-in="Player-' in page["text/html"]
    assert list(widget) == ["application/vnd.jupyter.widget-view+json"]


def test_players_of_the_same_trace_show_the_same_page(monkeypatch):
    (first, _), (second, _) = (shown(fm.play(flips()), monkeypatch) for _ in range(2))
    assert first == second


def test_a_player_stays_within_its_trace():
    player = fm.play(flips())
    for asked, got in ((5, 5), (1000, 86), (-3, 0)):
        player.step = asked
        assert player.step == got
    assert fm.play(flips(), step=-1).step == 0


def test_a_player_can_be_linked_with_a_slider():
    player, slider = fm.play(flips()), ipywidgets.IntSlider(max=86)
    ipywidgets.link((player, "step"), (slider, "value"))
    slider.value = 12
    assert player.step == 12
    player.step = 3
    assert slider.value == 3


def test_an_endless_generator_is_played_as_far_as_it_came(monkeypatch):
    player = fm.play(endless())
    n = len(player.trace)
    assert 0 < n < 10_000
    assert player.data["more"]
    player.load()
    assert len(player.trace) == len(player.data["steps"]) == n + 500
    player._answer(player, {"type": "more"}, [])
    assert len(player.trace) == n + 1000
    assert player.trace[-1].caption == f"this is {n + 999}"


def test_a_slow_generator_is_shown_before_it_ends(monkeypatch):
    monkeypatch.setattr("fem_mesh.watch.player.PATIENCE", 0.0)
    player = fm.play(iter(flips()))
    assert len(player.trace) == 1
    for _ in range(2):
        player.load(50)
    assert len(player.trace) == 87
    assert not player.data["more"]
    assert player.trace.complete


def test_a_long_trace_travels_in_parts(monkeypatch):
    monkeypatch.setattr("fem_mesh.watch.player.MOST_SENT", 50)
    player = fm.play(flips())
    assert len(player.data["steps"]) == 50
    player.step = 80
    assert player.step == 49
    player.load()
    assert len(player.data["steps"]) == 87
    assert not player.data["more"]


def test_a_generator_that_yields_something_else_is_told_so():
    with pytest.raises(fm.MeshError, match=r"must yield fm\.Step"):
        fm.play(iter([1, 2]))


def test_a_recording_goes_on_where_it_stopped():
    whole = flips()
    limited = fm.record(iter(whole), limit=10)
    assert len(limited) == 10
    assert not limited.complete
    assert fm.record(iter(whole), limit=len(whole)).complete


# ---- what goes wrong -----------------------------------------------------------------------------------


@pytest.mark.parametrize("source", [5, None, fm.bowyer_watson])
def test_only_steps_are_played(source):
    with pytest.raises(fm.MeshError, match="a generator of steps is wanted"):
        fm.play(source)


@pytest.mark.parametrize("view", [(0, 0, 0, 0), (1, 0, 0, 1), (0, float("nan"), 0, 1), (0, 1), "abcd", 5])
def test_a_view_is_a_box(view):
    with pytest.raises(fm.MeshError, match="view is left, right, bottom, top"):
        fm.play(fm.bowyer_watson([(0, 0), (4, 0), (0, 3)]), view=view)


def test_a_trace_has_a_view_of_its_own():
    with pytest.raises(fm.MeshError, match=r"trace\.view"):
        fm.play(flips(), view=(0, 1, 0, 1))


def test_a_generator_that_fails_is_not_one_that_ended():
    def failing():
        for k in range(player_module.AT_ONCE + 7):
            yield fm.Step("look", f"{k}", points=[(0, 0), (1, 0), (k, 1)], triangles=[])
        raise ZeroDivisionError("at last")

    player, heard = fm.play(failing()), []
    player.send = lambda content, buffers=None: heard.append(content)
    assert len(player.trace) == player_module.AT_ONCE
    for _ in range(2):
        with pytest.raises(ZeroDivisionError):
            player._answer(player, {"type": "more"}, [])
        assert heard[-1] == {"type": "failed", "said": "the generator failed: ZeroDivisionError: at last"}
    assert len(player.data["steps"]) == player_module.AT_ONCE + 7
    assert not player.trace.complete


def test_no_steps_are_not_further_steps():
    with pytest.raises(fm.MeshError, match="at least one"):
        fm.play(flips()).load(0)
