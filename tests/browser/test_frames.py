"""What a trace is in the browser, step by step: the frames that Python gives, after their travel in whole numbers."""

import json

import numpy as np
import pytest

import fem_mesh as fm
from fem_mesh.watch.front import PLAYER, module
from fem_mesh.watch.layers import layers_of, legend_of
from fem_mesh.watch.wire import UNIT, as_data

READ = """data => {
    const trace = new Trace(data), canvas = document.querySelector("canvas"), view = new View(canvas, STYLE, data.box);
    return trace.steps.map((_, k) => {
        const frame = trace.frame(k);
        return {
            kind: trace.kind(k), points: [...frame.x].map((x, i) => [x, frame.y[i]]), there: [...frame.there],
            triangles: [...frame.triangles, ...frame.fresh], fresh: frame.fresh, segments: frame.segments,
            waiting: frame.waiting, point: frame.point ?? null, roles: view.draw(frame),
        };
    });
}"""


@pytest.fixture(scope="module")
def reader(browser, tmp_path_factory):
    """A page with all of the player up to the table of lifetimes, which does nothing by itself."""
    names = PLAYER[: PLAYER.index("trace.js") + 1]
    code = module(names, "Object.assign(window, {Trace, View, STYLE});")
    path = tmp_path_factory.mktemp("frames") / "reader.html"
    path.write_text(f'<canvas style="width: 300px; height: 200px"></canvas><script type="module">{code}</script>')
    page = browser.new_page()
    page.goto(path.as_uri())
    page.wait_for_function("() => window.Trace")
    yield page
    page.close()


def by_hand():
    """Full lists, as a lecturer yields them: points move, vanish and come again, in arrays that go on changing."""
    points, triangles = np.array([(0.0, 0), (1, 0), (0, 1), (1, 1)]), np.array([(0, 1, 2), (1, 3, 2)], np.int32)
    yield fm.Step("start", "two triangles", points=points, triangles=triangles)
    points[3] = 2.0, 1.5
    yield fm.Step("stretch", "point 3 moves", points=points, triangles=triangles, point=points[3])
    look = {"doomed": [tuple(t) for t in triangles], "edges": [(triangles[0, 1], 2)]}  # numbers of NumPy's
    yield fm.Step("look", "", points=points, triangles=triangles, **look)
    yield fm.Step("drop", "point 3 goes", points=points[:3], triangles=triangles[:1])
    yield fm.Step("wait", "nothing happens", points=points[:3], triangles=triangles[:1], point=(np.nan, np.inf))
    more = [*points[:3].tolist(), (0.25, 0.25), (-1, 2)]
    yield fm.Step("split", "two points come", points=more, triangles=[(0, 1, 3), (1, 2, 3), (2, 0, 3), (0, 2, 4)])
    look = {"circles": [(0, 1, 2)], "visited": [(0, 1, 3)]}
    yield fm.Step("turn", "", points=more, triangles=[(3, 0, 1), (1, 2, 3), (3, 2, 0)], **look)
    yield fm.Step("segments", "", new_segments=[(0, 1), (2, 1)], asked=[(0, 2)], encroached=[(0, 1)])
    yield fm.Step("clear", "", triangles=[], gone_segments=[(1, 0)])
    yield fm.Step("end", "", points=[], gone_segments=[(1, 2)])


def cloud(n, seed=3):
    return fm.random_points(n, seed=seed) * (3, 2) - (100, 0.5)


def flips():
    points = cloud(20)
    return fm.lawson(points, fm.any_triangulation(points))


RUNS = {
    "lawson": flips,
    "bowyer_watson": lambda: fm.bowyer_watson([*cloud(25), *fm.ring_points(12), *cloud(3)]),
    "insert_segments": lambda: fm.insert_segments(fm.plate_with_hole()),
    "ruppert": lambda: fm.ruppert(fm.l_shape(), min_angle=25, max_area=0.1),
    "ruppert moves points": lambda: fm.ruppert(fm.disk(), min_angle=28, steiner="relocation"),
    "by hand": by_hand,
    "a line": lambda: fm.bowyer_watson([(0, 0), (1, 1), (2, 2)]),
    "a point": lambda: fm.bowyer_watson([(7, 7)]),
    "nothing": lambda: [fm.Step("wait", "there is nothing yet")],
    "a playground": lambda: list(played().trace),
}


def played():
    playground = fm.Playground(cloud(9), seed=1)
    playground.move(3, -99, 0.6)
    for i in (0, 5, 2):
        playground.remove(i)
    playground.add(-98.5, 0.75)
    return playground


def in_browser(reader, trace, n=None):
    return reader.evaluate(READ, json.loads(json.dumps(as_data(trace, n), allow_nan=False)))


def whole_rows(flat, width):
    """Rows of point numbers, each turned so that its lowest comes first (pairs: sorted), in order."""
    rows = np.array(flat, int).reshape(-1, width).tolist()
    turned = [sorted(row) if width == 2 else min(row[i:] + row[:i] for i in range(3)) for row in rows]
    return sorted(turned)


def same(found, trace, k):
    points, triangles = trace.frame(k)
    there = ~np.isnan(points[:, 0])
    near = trace.view_box()
    within = 0.51 * UNIT * (near[1] - near[0])
    places = np.array(found["points"], float).reshape(-1, 2)
    assert np.flatnonzero(found["there"]).tolist() == np.flatnonzero(there).tolist()
    np.testing.assert_allclose(places[: len(there)][there], points[there], rtol=0, atol=within)
    assert whole_rows(found["triangles"], 3) == whole_rows(triangles, 3)
    assert whole_rows(found["fresh"], 3) == whole_rows(trace[k].added if k else [], 3)
    assert whole_rows(found["segments"], 2) == whole_rows(trace.segments(k), 2)
    waiting = np.array(found["waiting"]).reshape(-1, 2)
    np.testing.assert_allclose(waiting, trace.points_to_come(k), rtol=0, atol=within)
    assert found["kind"] == trace[k].kind
    if found["point"] is None:
        assert trace[k].point is None or not np.isfinite(trace[k].point).all()
    else:
        np.testing.assert_allclose(found["point"], trace[k].point, rtol=0, atol=within)


@pytest.mark.parametrize("run", RUNS)
def test_every_frame_is_the_one_that_python_gives(run, reader):
    trace = fm.record(RUNS[run]())
    frames = in_browser(reader, trace)
    assert len(frames) == len(trace)
    for k, found in enumerate(frames):
        same(found, trace, k)
        shown = [layer for layer in layers_of(trace, k) if np.isfinite(layer.places).all()]
        assert set(found["roles"]) == set(legend_of(shown)), f"legend of step {k}"


def test_the_first_part_of_a_trace_has_the_same_frames(reader):
    for run in ("ruppert moves points", "by hand"):
        trace = fm.record(RUNS[run]())
        for n in (1, len(trace) // 2, len(trace) - 1):
            frames = in_browser(reader, trace, n)
            assert len(frames) == n
            part = fm.record(RUNS[run](), limit=n, view=trace.view_box())
            for k, found in enumerate(frames):
                same(found, part, k)
