"""Every renderer shows the same of a step: the layers that Matplotlib draws, and that a still SVG is made of."""

import gc
import html
import itertools
import os
import re
import subprocess
import sys
import warnings
import xml.etree.ElementTree as ET
from html.parser import HTMLParser
from urllib.parse import unquote

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.colors import to_hex
from PIL import Image

import fem_mesh as fm
from fem_mesh.watch.layers import LEGEND, Layer, layers_of, layers_of_mesh, legend_of, scale_for
from fem_mesh.watch.paths import FAR, MARGIN
from fem_mesh.watch.style import PAPER, ROLES
from fem_mesh.watch.svg import POINT, data_uri, svg_of_layers, svg_of_step

SVG = "{http://www.w3.org/2000/svg}"
ALMOST_FLAT = [(0.1 * i, 1e-4 * (i % 3)) for i in range(6)] + [(0.3, 0.5)]
MIRROR = [(0.5, 1e-7), (0.0, 0.0), (1.0, 0.0), (0.5, -0.3)]


def of_points(algorithm, points):
    if algorithm is fm.lawson:
        return fm.record(fm.lawson(points, fm.any_triangulation(points)))
    return fm.record(algorithm(points))


def lecturers_own():
    points, triangles = [(0, 0), (4, 0), (0, 3)], [(0, 1, 2)]
    yield fm.Step("start", "1 < 2 & \x00\ud800 \"so\" 'so' <b>", points=points, triangles=triangles)
    points.append((1, 1))
    yield fm.Step("look", points=points, triangles=triangles, visited=triangles, circles=triangles, point=(1, 1))
    triangles[:] = [(0, 1, 3), (1, 2, 3)]
    yield fm.Step("fan", points=points, triangles=triangles, edges=[(0, 1)], asked=[(1, 2)], encroached=[(0, 2)])
    points.pop()
    triangles[:] = [(0, 1, 2)]
    yield fm.Step("back", points=points, triangles=triangles)


TRACES = {
    "insertions": lambda: of_points(fm.bowyer_watson, fm.random_points(16, seed=1)),
    "flips": lambda: of_points(fm.lawson, fm.random_points(9, seed=1)),
    "a grid": lambda: of_points(fm.bowyer_watson, fm.grid_points(3)),
    "almost flat": lambda: of_points(fm.bowyer_watson, ALMOST_FLAT),
    "nearly a line": lambda: of_points(fm.bowyer_watson, MIRROR),
    "segments": lambda: fm.record(fm.insert_segments(fm.letter("A"))),
    "refinement": lambda: fm.record(fm.ruppert(fm.plate_with_hole(), min_angle=20), limit=60),
    "one point": lambda: fm.record(fm.textbook.bowyer_watson([(0.5, 0.5)])),
    "a lecturer's own": lambda: fm.record(lecturers_own()),
    "far away": lambda: of_points(fm.bowyer_watson, fm.random_points(8) + 1e15),
    "huge": lambda: of_points(fm.bowyer_watson, fm.random_points(8) * 1e38),
    "tiny": lambda: of_points(fm.bowyer_watson, fm.random_points(8) * 1e-40),
}


@pytest.fixture(scope="module", params=TRACES, ids=str)
def trace(request):
    return TRACES[request.param]()


def tree(svg):
    return ET.fromstring(svg)


def groups(svg):
    """The elements of each role in a picture, in drawing order; the legend is none of them."""
    return [g for g in tree(svg).iter(SVG + "g") if g.get("data-role") not in (None, "legend")]


def legend_words(svg):
    (legend,) = (g for g in tree(svg).iter(SVG + "g") if g.get("data-role") == "legend")
    return [text.text for text in legend.iter(SVG + "text")]


def numbers_written(svg):
    return [text.text for g in groups(svg) for text in g.iter(SVG + "text")]


def numbers_of_layers(layers):
    return next(layer.words for layer in layers if layer.what == "texts")


def tenths(width):
    return round(POINT * width)


def looks_in_svg(svg):
    """Colour, width and dashes of every line."""
    drawn = [g for g in groups(svg) if g.get("stroke")]
    return {(g.get("stroke").lower(), int(g.get("stroke-width")), g.get("stroke-dasharray", "")) for g in drawn}


def looks_on_axes(ax):
    looks = set()
    for collection in ax.collections:
        if len(collection.get_edgecolor()) and not (isinstance(collection, LineCollection) and not collection.get_segments()):
            dashes = " ".join(str(tenths(length)) for length in collection.get_linestyle()[0][1] or ())
            looks.add((to_hex(collection.get_edgecolor()[0]), tenths(collection.get_linewidth()[0]), dashes))
    for line in ax.lines:
        dot = line.get_markerfacecolor() != "none"
        size = line.get_markersize() if dot else 0
        if not (dot and line.get_markersize() == 3.5):  # the core of the point's ring
            looks.add((to_hex(line.get_markeredgecolor()), tenths(line.get_markeredgewidth() + size), ""))
    return looks


def places_on(path):
    """The corners of each stroke of a path of M, l and z."""
    strokes = []
    for stroke in path.split("M")[1:]:
        begin, _, rest = stroke.rstrip("z").partition("l")
        at = np.array([int(n) for n in begin.split()])
        steps = np.array([int(n) for n in re.findall(r"-?\d+", rest)]).reshape(-1, 2)
        strokes.append(np.concatenate([[at], at + steps.cumsum(axis=0)]))
    return strokes


# ---- the same in every renderer -------------------------------------------------------------------------


@pytest.mark.parametrize("dark", [False, True])
def test_svg_and_matplotlib_draw_lines_of_the_same_looks_and_the_same_words(trace, dark):
    for k in range(dark, len(trace), 2):
        svg, ax = svg_of_step(trace, k, dark=dark), trace.draw(k, dark=dark).axes
        assert looks_in_svg(svg) == looks_on_axes(ax)
        legend = ax.get_legend()
        assert legend_words(svg) == ([] if legend is None else [text.get_text() for text in legend.get_texts()])
        assert numbers_written(svg) == [text.get_text() for text in ax.texts]


def test_svg_shows_the_roles_of_the_layers_in_their_order(trace):
    for k in range(len(trace)):
        assert [g.get("data-role") for g in groups(svg_of_step(trace, k))] == [layer.role for layer in layers_of(trace, k)]


def test_the_triangles_of_a_frame_are_either_old_or_new(trace):
    for k in range(len(trace)):
        count = sum(len(layer.places) for layer in layers_of(trace, k) if layer.role in ("mesh", "new"))
        assert count == len(trace.frame(k)[1])


def test_without_circles_all_else_is_the_same(trace):
    for k in range(len(trace)):
        with_circles, without = ([layer.role for layer in layers_of(trace, k, circles)] for circles in (True, False))
        assert without == [role for role in with_circles if role not in ("circle", "diametral")]


def test_the_traces_of_these_tests_show_every_role_of_a_step():
    shown = {layer.role for make in TRACES.values() for t in [make()] for k in range(len(t)) for layer in layers_of(t, k)}
    assert shown == {"mesh", "vertex", *LEGEND} - {"voronoi"}


def test_vertices_and_old_triangles_need_no_word():
    trace = TRACES["insertions"]()
    listed = [legend_of(layers_of(trace, k)) for k in range(len(trace))]
    assert all(set(names) <= set(LEGEND) and names == sorted(names, key=LEGEND.index) for names in listed)
    assert ["doomed", "circle", "edge", "waiting", "point"] in listed


def test_thick_lines_and_markers_grow_thinner_among_many_vertices_but_lines_not_too_thin():
    ends, places = np.zeros((1, 2, 2)), np.zeros((1, 2))
    assert [scale_for(n) for n in (0, 120, 480, 12_000)] == [1, 1, 0.5, 0.1]
    assert [Layer("segment", "lines", ends, scale=scale).width for scale in (1, 0.75, 0.1)] == pytest.approx([3.2, 2.4, 1.6])
    assert Layer("mesh", "polygons", ends, scale=0.1).width == 0.9
    assert [Layer("vertex", "markers", places, scale=scale).size for scale in (1, 0.5)] == [4.5, 2.25]


def test_edges_that_vanish_with_their_points_are_shown():
    points = [(0, 0), (4, 0), (0, 3), (1, 1)]
    more = fm.Step("more", points=points, triangles=[(0, 1, 3), (1, 2, 3)])
    less = fm.Step("less", points=points[:3], triangles=[(0, 1, 2)])
    (gone,) = (layer for layer in layers_of(fm.record([more, less]), 1) if layer.role == "gone")
    assert gone.places.tolist() == [[[0, 0], [1, 1]], [[4, 0], [1, 1]], [[0, 3], [1, 1]]]


def test_edges_are_drawn_between_points_where_they_are_now():
    move = ([(0, 0), (1, 0), (0, height)] for height in (1, 9))
    trace = fm.record(fm.Step("move", points=points, triangles=[(0, 1, 2)], edges=[(0, 2)]) for points in move)
    assert [layers_of(trace, k)[1].places.tolist() for k in (0, 1)] == [[[[0, 0], [0, 1]]], [[[0, 0], [0, 9]]]]


def test_points_on_a_line_have_no_circle_to_draw():
    trace = fm.record([fm.Step("look", points=[(0, 0), (1, 0), (2, 0), (0, 1)], triangles=[(0, 1, 3)], circles=[(0, 1, 2)])])
    assert "circle" not in {layer.role for layer in layers_of(trace, 0)}
    assert "data-role='circle'" not in svg_of_step(trace, 0)


# ---- SVG ------------------------------------------------------------------------------------------------


def assert_sound(svg):
    """Valid XML, in whole numbers not far from the page."""
    for element in tree(svg).iter():
        for name in ("d", "x", "y", "cx", "cy", "r", "stroke-width", "stroke-dasharray", "viewBox"):
            assert re.fullmatch(r"[MlhmzQ \d-]*|100%", element.get(name, ""))
            assert all(abs(int(n)) < 4 * FAR for n in re.findall(r"-?\d+", element.get(name, "")))


@pytest.mark.filterwarnings("error")
def test_every_step_is_valid_xml_in_whole_numbers_near_the_page(trace):
    for k in range(len(trace)):
        assert_sound(svg_of_step(trace, k, dark=k % 2 == 1))


def test_the_title_says_step_and_caption():
    trace = TRACES["a lecturer's own"]()
    assert tree(svg_of_step(trace, 0))[0].text == "step 0 of 3, start: 1 < 2 &  \"so\" 'so' <b>"
    assert tree(svg_of_step(trace, -1))[0].text.startswith("step 3 of 3, back")


def test_sixteen_points_take_less_than_8_kb_and_three_hundred_less_than_30():
    small = [TRACES["insertions"](), of_points(fm.lawson, fm.random_points(16, seed=1))]
    assert max(len(data_uri(svg_of_step(trace, k))) for trace in small for k in range(len(trace))) < 8_000
    trace = of_points(fm.bowyer_watson, fm.random_points(300, seed=2))
    assert max(len(data_uri(svg_of_step(trace, k))) for k in range(0, len(trace), 20)) < 30_000


def test_a_large_mesh_shows_a_part_around_the_point_of_its_step():
    mesh = fm.delaunay(fm.random_points(6_000, seed=4))
    look = {"points": mesh.points, "triangles": mesh.triangles}
    trace = fm.record([fm.Step("start", **look), fm.Step("look", point=(0.25, 0.75), **look)])
    for k in (0, 1):
        svg = svg_of_step(trace, k)
        assert tree(svg)[0].text.endswith("(a part of it)")
        assert 20_000 < len(data_uri(svg)) < 40_000
    (ring,) = (g for g in groups(svg) if g.get("data-role") == "point")
    page = tree(svg).find(SVG + "svg")
    assert 2 * int(ring[0].get("cx")) == pytest.approx(int(page.get("width")), abs=2)
    assert 2 * int(ring[0].get("cy")) == pytest.approx(int(page.get("height")), abs=2)


def test_twenty_thousand_points_to_come_take_no_more_room_than_the_page_has():
    trace = fm.record(fm.Step("grow", points=fm.random_points(n, seed=5), triangles=[(0, 1, 2)]) for n in (3, 20_000))
    assert len(data_uri(svg_of_step(trace, 0))) < 30_000


def test_another_process_writes_the_same_and_needs_no_matplotlib():
    program = (
        "import sys, fem_mesh as fm; from fem_mesh.watch.svg import svg_of_step\n"
        "trace = fm.record(fm.bowyer_watson(fm.random_points(16, seed=1)))\n"
        "sys.stdout.write('|'.join(svg_of_step(trace, k) for k in range(len(trace))))\n"
        "assert 'matplotlib' not in sys.modules"
    )
    trace = TRACES["insertions"]()
    here = "|".join(svg_of_step(trace, k) for k in range(len(trace)))
    for seed in ("1", "2"):
        done = subprocess.run([sys.executable, "-c", program], env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True)
        assert done.stdout.decode() == here, done.stderr.decode()


def test_every_edge_of_the_mesh_is_drawn_once():
    trace = of_points(fm.bowyer_watson, fm.random_points(60, seed=3))
    box = trace.view_box()
    (group,) = (g for g in groups(svg_of_step(trace, -1)) if g.get("data-role") == "mesh")
    drawn = [{tuple(a), tuple(b)} for stroke in places_on(group[0].get("d")) for a, b in itertools.pairwise(stroke)]
    page = tree(svg_of_step(trace, -1)).find(SVG + "svg")
    scale = min(
        (int(page.get("width")) - 2 * MARGIN) / (box[1] - box[0]), (int(page.get("height")) - 2 * MARGIN) / (box[3] - box[2])
    )
    dots = {}
    for (x, y), where in zip(trace.frame(-1)[0], trace.frame(-1)[0], strict=True):
        dots[tuple(where)] = (
            round(int(page.get("width")) / 2 + scale * (x - (box[0] + box[1]) / 2)),
            round(int(page.get("height")) / 2 - scale * (y - (box[2] + box[3]) / 2)),
        )
    points, triangles = trace.frame(-1)
    edges = {frozenset((int(t[i]), int(t[i - 1]))) for t in triangles for i in range(3)}
    expected = {frozenset(dots[tuple(points[v])] for v in edge) for edge in edges}
    assert len(drawn) == len(edges)
    assert {frozenset(edge) for edge in drawn} == expected


def test_fills_lie_below_all_lines_and_have_their_second_cue_above(trace):
    for k in range(len(trace)):
        svg, layers = svg_of_step(trace, k), layers_of(trace, k)
        page = list(tree(svg).find(SVG + "svg"))
        filled = [layer.role for layer in layers if layer.what == "polygons" and ROLES[layer.role].fill]
        assert [path.get("fill") for path in page[: len(filled)]] == [ROLES[name].color for name in filled]
        assert [float(path.get("fill-opacity")) for path in page[: len(filled)]] == [ROLES[name].fill for name in filled]
        assert not any(e.get("fill-opacity") for g in page[len(filled) :] for e in g.iter())
        hatched = {g.get("data-role") for g in groups(svg) for e in g if (e.get("fill") or "").startswith("url")}
        assert hatched == {name for name in filled if ROLES[name].hatch}


def test_every_point_has_its_mark_and_every_circle_goes_through_its_corners():
    trace, circles = TRACES["insertions"](), 0
    for k in range(len(trace)):
        drawn = {g.get("data-role"): g for g in groups(svg_of_step(trace, k)) if g.get("stroke")}
        there = ~np.isnan(trace.frame(k)[0][:, 0])
        assert drawn["vertex"][0].get("d").count("h0") == there.sum()
        waiting = len(trace.points_to_come(k))
        assert ("waiting" in drawn) == (waiting > 0)
        if waiting:  # the first corner of the path has no mark
            assert len(re.findall(r"-?\d+ -?\d+", drawn["waiting"][0].get("d"))) == waiting + 1
        if "circle" in drawn and "doomed" in drawn and len(trace[k].circles) == len(drawn["circle"]):
            for circle, corners in zip(drawn["circle"], places_on(drawn["doomed"][0].get("d")), strict=True):
                x, y, r = (int(circle.get(name)) for name in ("cx", "cy", "r"))
                assert np.hypot(*(corners - (x, y)).T) == pytest.approx(r, abs=3)
                circles += 1
    assert circles > 5


def test_points_still_to_be_made_have_no_number_and_points_to_come_have():
    made, given = TRACES["refinement"](), TRACES["insertions"]()
    assert made.makes_points
    texts = [numbers_of_layers(layers_of(made, 0, numbers=True)), numbers_of_layers(layers_of(given, 0))]
    assert [len(words) for words in texts] == [int((~np.isnan(made.frame(0)[0][:, 0])).sum()), 16]


def test_a_lone_triangle_has_three_edges_and_dashed_edges_begin_with_a_dash_each():
    corners, triangles = [(0, 0), (4, 0), (0, 3)], [(0, 1, 2)]
    step = fm.Step("look", points=corners, triangles=triangles, asked=[(0, 1), (1, 2), (2, 0)], edges=[(0, 1), (1, 2), (2, 0)])
    paths = {g.get("data-role"): g[0].get("d") for g in groups(svg_of_step(fm.record([step]), 0)) if g.get("stroke")}
    assert [[len(stroke) for stroke in places_on(paths[name])] for name in ("mesh", "edge", "asked")] == [[4], [4], [2, 2, 2]]


@pytest.mark.parametrize(("width", "height"), [(100, 1), (2, 1), (1, 1), (1, 100)])
def test_a_picture_is_neither_tall_nor_very_flat(width, height):
    step = fm.Step("look", points=[(0, 0), (width, 0), (0, height)], triangles=[(0, 1, 2)])
    page = tree(svg_of_step(fm.record([step]), 0)).find(SVG + "svg")
    assert 1.29 < int(page.get("width")) / int(page.get("height")) < 2.21


def test_every_hatch_and_ring_is_defined_under_a_name_of_its_role_and_theme(trace):
    names = {False: set(), True: set()}
    for dark in names:
        for k in range(len(trace)):
            svg = svg_of_step(trace, k, dark=dark)
            defined = [element.get("id") for element in tree(svg).iter() if element.get("id")]
            assert set(re.findall(r"url\(#([^)]*)\)", svg)) == set(defined)
            assert len(defined) == len(set(defined))
            names[dark].update(defined)
            assert PAPER[dark] in svg
    assert not names[False] & names[True]
    assert all(name.split("-")[1] in ROLES for name in names[False] | names[True])


def test_what_lies_outside_the_view_is_left_out_and_what_reaches_out_of_it_is_cut():
    far = 1e9
    points = [(-far, -far), (far, -far), (0.5, far), (0.2, 0.2), (0.8, 0.4)]
    steps = [fm.Step("look", points=points, triangles=[(0, 1, 3), (1, 4, 3)], visited=[(1, 2, 4)], edges=[(0, 4), (0, 2)])]
    trace = fm.record(steps, view=(0, 1, 0, 1))
    svg = svg_of_step(trace, 0)
    for group in groups(svg):
        for path in group.iter(SVG + "path"):
            for stroke in places_on(path.get("d") if "l" in path.get("d") else ""):
                assert np.abs(stroke).max() <= FAR
    (edge,) = (g for g in groups(svg) if g.get("data-role") == "edge")
    (stroke,) = places_on(edge[0].get("d"))  # the other runs far from the view
    (x, y), (u, v) = stroke
    assert (v - y) / (u - x) == pytest.approx(-1, abs=1e-3)  # up and to the right, as seen from point 0
    assert numbers_written(svg) == ["3", "4"]
    (shape,) = (s for g in groups(svg) if g.get("data-role") == "visited" for s in places_on(g[0].get("d")))
    assert len(shape) in (4, 5, 6)


def test_no_edge_outside_the_view_is_drawn():
    trace = of_points(fm.bowyer_watson, fm.grid_points(6))
    trace.view = (1.7, 3.3, 1.7, 3.3)
    svg = svg_of_step(trace, -1)
    (group,) = (g for g in groups(svg) if g.get("data-role") == "mesh")
    page = tree(svg).find(SVG + "svg")
    corners = np.concatenate(places_on(group[0].get("d")))
    assert corners[:, 0].min() < 0 < int(page.get("width")) < corners[:, 0].max()
    assert len({tuple(corner) for corner in corners.tolist()}) <= 16  # of 36


def test_no_circle_that_keeps_off_the_view_is_drawn():
    circles = np.array([(0.5, 0.5, 0.3), (9, 9, 1), (0.5, 0.5, 9), (9, 0.5, 8.5), (1e6, 0.5, 1e6 - 30)])
    svg = svg_of_layers([Layer("circle", "circles", circles)], ["circle"], (0, 1, 0, 1), "circles")
    assert [len(g) for g in groups(svg)] == [2]


def test_a_circle_much_larger_than_the_view_is_an_arc_through_its_triangle():
    step = fm.Step("look", points=[(0, 0), (1, 0), (0.5, 1e-3)], triangles=[(0, 1, 2)], circles=[(0, 1, 2)])
    trace = fm.record([step], view=(0, 1, -0.2, 0.2))
    (group,) = (g for g in groups(svg_of_step(trace, 0)) if g.get("data-role") == "circle")
    x, y, bx, by, ex, ey = map(int, re.findall(r"-?\d+", group[0].get("d")))
    begin, middle, end = np.array([(x, y), (bx, by), (ex, ey)])
    t = np.linspace(0, 1, 2001)[:, None]
    curve = (1 - t) ** 2 * begin + 2 * t * (1 - t) * middle + t**2 * end
    (dots,) = (g for g in groups(svg_of_step(trace, 0)) if g.get("data-role") == "vertex" and g.get("stroke"))
    for dot in re.findall(r"M(\d+) (\d+)h0", dots[0].get("d")):
        assert np.hypot(*(curve - np.array(dot, float)).T).min() < 8  # tenths of a pixel


@pytest.mark.filterwarnings("error")
def test_circles_of_any_size_are_near_the_page_or_left_out():
    for power in range(43):
        for middle in (0.25, 0.4, 0.5):
            mesh = fm.delaunay([(0, 0), (1, 0), (middle, 10.0**-power)])
            layers = layers_of_mesh(mesh, circles=True)
            assert_sound(svg_of_layers(layers, [], (0, 1, -0.5, 0.5), "flat"))
    layer = Layer("circle", "circles", np.array([(0.3 * r, 0.7 * r, np.hypot(0.3, 0.7) * r) for r in 1.7 ** np.arange(600)]))
    assert_sound(svg_of_layers([layer], [], (0, 1, 0, 1), "through a corner"))


def test_a_narrow_picture_writes_its_legend_in_rows():
    trace = TRACES["insertions"]()
    k = max(range(len(trace)), key=lambda k: len(legend_of(layers_of(trace, k))))
    words = {role.word for role in ROLES.values()}
    wide, narrow = tree(svg_of_step(trace, k)), tree(svg_of_step(trace, k, width=240))
    assert narrow.get("width") == "240"
    rows = [{text.get("y") for text in page.iter(SVG + "text") if text.text in words} for page in (wide, narrow)]
    assert len(rows[0]) == 1
    assert len(rows[1]) > 1
    assert max(int(y) for y in rows[1]) < int(narrow.get("viewBox").split()[3])


def test_an_address_holds_between_double_quotes_and_gives_the_image_back(trace):
    class Reader(HTMLParser):
        def handle_starttag(self, tag, attrs):
            self.src = dict(attrs)["src"]

    for k in range(len(trace)):
        svg = svg_of_step(trace, k)
        address = data_uri(svg)
        assert not set('"<>&#\n') & set(address)
        assert html.unescape(address) == address
        reader = Reader()
        reader.feed(f'<img src="{address}">')
        assert unquote(reader.src.removeprefix("data:image/svg+xml,")) == svg
        assert len(address) < 1.2 * len(svg)


# ---- animations, and one line of ipywidgets ------------------------------------------------------------


@pytest.fixture(scope="module")
def flips():
    return TRACES["flips"]()


@pytest.mark.filterwarnings("error")
def test_an_animation_that_nobody_looks_at_goes_without_a_word(flips):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        flips.animate()
        gc.collect()
    assert not caught


def test_an_animation_has_a_frame_for_every_step_at_its_speed(flips, tmp_path):
    flips.animate(fps=4).save(tmp_path / "flips.gif", writer="pillow")
    with Image.open(tmp_path / "flips.gif") as film:
        assert film.info["duration"] == 250
        assert film.n_frames <= len(flips)
    flips.animate(steps=[0, 5, 3], dark=True).save(tmp_path / "dark.gif", writer="pillow")
    with Image.open(tmp_path / "dark.gif") as film:
        assert film.n_frames == 3
        assert film.convert("RGB").getpixel((2, 2)) == tuple(bytes.fromhex(PAPER[True][1:]))


def test_an_animation_plays_in_a_notebook(flips):
    page = flips.animate(fps=1, steps=[0, 1, 2]).to_jshtml()
    assert page.count("data:image/png;base64") == 3
    assert "1000" in page


def test_an_empty_trace_cannot_be_animated():
    with pytest.raises(fm.MeshError, match="no step to animate: the trace is empty"):
        fm.record([]).animate()
    with pytest.raises(fm.MeshError, match="no step to animate: steps is empty"):
        TRACES["one point"]().animate(steps=[])


def test_a_slider_of_ipywidgets_draws_the_step_it_stands_on(flips):
    from ipywidgets import interactive

    control = interactive(flips.draw, {"auto_display": False}, k=(0, len(flips) - 1))
    (slider,) = control.kwargs_widgets
    for k in (0, len(flips) - 1, 3):
        slider.value = k
        control.update()
        assert control.result.alt.startswith(f"step {k} of {len(flips) - 1}, {flips[k].kind}")
