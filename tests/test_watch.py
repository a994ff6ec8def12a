"""Pictures say what they show, keep their view box, and land in files."""

import shutil

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

import fem_mesh as fm
from fem_mesh.watch.style import ROLES


@pytest.fixture(scope="module")
def trace():
    points = fm.random_points(9, seed=1)
    return fm.record(fm.lawson(points, fm.any_triangulation(points)))


def test_the_view_box_never_moves_through_a_trace(trace):
    boxes = {trace.draw(k).axes.get_xlim() + trace.draw(k).axes.get_ylim() for k in range(len(trace))}
    assert len(boxes) == 1


def test_a_picture_says_in_text_what_it_shows(trace):
    data, metadata = trace.draw(1)._repr_mimebundle_()
    assert data["text/plain"] == metadata["image/png"]["alt"] == f"step 1 of {len(trace) - 1}, test: {trace[1].caption}"
    assert data["image/png"].startswith("iVBOR")


def test_drawing_on_given_axes_returns_them_and_clears_them_first(trace):
    ax = Figure().add_subplot()
    ax.plot([0, 100], [0, 100])
    assert trace.draw(2, ax) is ax
    assert ax.get_xlim()[1] < 10
    assert fm.delaunay(fm.random_points(5)).plot(ax) is ax


def test_drawing_on_the_axes_of_a_subfigure_works(trace):
    left, right = Figure().subfigures(1, 2)
    trace.draw(2, left.subplots())
    fm.delaunay(fm.random_points(5)).plot(right.subplots())


def test_drawing_opens_no_window_and_leaves_no_figure_behind(trace):
    before = plt.get_fignums()
    trace.draw(3)
    assert plt.get_fignums() == before


@pytest.mark.parametrize("options", [{"circles": False}, {"dark": True, "numbers": True, "legend": False}])
def test_every_step_can_be_drawn_in_every_way(trace, options):
    for k in range(len(trace)):
        trace.draw(k, **options)
    for step_of in (
        fm.bowyer_watson(fm.grid_points(3)),
        fm.bowyer_watson([(0, 0), (1, 1)]),
        fm.textbook.bowyer_watson([(0.5, 0.5)]),
    ):
        other = fm.record(step_of)
        for k in range(len(other)):
            other.draw(k, **options)._repr_mimebundle_()


def test_steps_count_from_the_end_too(trace):
    assert trace.draw(-1).alt == trace.draw(len(trace) - 1).alt


def test_every_role_has_a_word_a_second_cue_and_a_colour_of_its_own_ground():
    assert len({role.word for role in ROLES.values()}) == len(ROLES)
    cues = {(role.dash, role.hatch, role.marker, role.size, role.width) for role in ROLES.values()}
    assert len(cues) == len(ROLES)


def test_a_gif_has_a_frame_for_every_step_and_rests_on_the_last(trace, tmp_path):
    trace.save(tmp_path / "flips.gif", fps=4)
    with Image.open(tmp_path / "flips.gif") as film:
        assert film.n_frames >= len(set(range(len(trace))))
        assert film.size[0] > 500


def test_a_png_is_a_contact_sheet(trace, tmp_path):
    trace.save(tmp_path / "sheet.png", steps=[0, 1, 2])
    with Image.open(tmp_path / "sheet.png") as sheet:
        assert sheet.size[0] > 1000


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="an .mp4 needs the program ffmpeg")
def test_an_mp4_is_written_where_ffmpeg_is(trace, tmp_path):
    trace.save(tmp_path / "flips.mp4", steps=range(4))
    assert (tmp_path / "flips.mp4").stat().st_size > 1000


def test_without_ffmpeg_the_error_says_what_to_do(trace, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(fm.MeshError, match=r"ffmpeg.*\.gif"):
        trace.save(tmp_path / "flips.mp4")


def test_an_unknown_ending_and_an_empty_trace_are_refused(trace, tmp_path):
    with pytest.raises(fm.MeshError, match=r"\.gif, \.mp4 or \.png"):
        trace.save(tmp_path / "flips.bmp")
    with pytest.raises(fm.MeshError, match="no step to save"):
        fm.record([]).save(tmp_path / "none.gif")


def test_meshes_show_a_picture_and_traces_a_page_under_their_line_of_facts(trace):
    for thing in (fm.delaunay(fm.random_points(9)), fm.delaunay([(0, 0), (1, 1)]), fm.delaunay([])):
        data, metadata = thing._repr_mimebundle_()
        assert data["text/plain"] == repr(thing) == metadata["image/png"]["alt"]
    data = trace._repr_mimebundle_()
    assert data["text/plain"] == repr(trace)
    assert f"<p>{trace!r}</p>" in data["text/html"]


@pytest.mark.parametrize("height", [1e-3, 1e-7, 1e-12, 1e-30])
def test_circles_of_almost_flat_triangles_are_drawn_in_no_time(height):
    mesh = fm.delaunay([(0, 0), (1, 0), (0.5, height)])
    mesh.plot(circles=True)._repr_mimebundle_()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "points", [fm.random_points(8) + 1e15, fm.random_points(8) * 1e38, fm.random_points(8) * 1e-40, [(1e38, 1e38)]]
)
def test_far_huge_and_tiny_point_sets_are_drawn_without_a_warning(points):
    fm.delaunay(points).plot(circles=True)._repr_mimebundle_()
    fm.record(fm.bowyer_watson(points)).draw(-1)._repr_mimebundle_()


def test_a_large_mesh_shows_its_middle():
    mesh = fm.delaunay(np.random.default_rng(0).random((20_000, 2)))
    picture = mesh._repr_mimebundle_()[0]
    assert picture["text/plain"] == repr(mesh)


def test_one_line_of_ipywidgets_steps_through_a_trace(trace):
    from ipywidgets import interactive

    slider = interactive(trace.draw, k=(0, len(trace) - 1)).children[0]
    assert slider.max == len(trace) - 1


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        ("a.gif", {"fps": 0}, "fps is how many steps are shown in a second"),
        ("a.gif", {"steps": [999]}, "there is no step 999 to save: the trace has"),
        ("a.png", {"fps": 2}, "fps is for films"),
        ("a.html", {"fps": 2}, "fps is for films"),
        ("a.png", {"steps": []}, "steps is empty"),
    ],
)
def test_a_trace_is_not_saved_as_nobody_could_have_meant(name, options, says, tmp_path):
    trace = fm.record(fm.bowyer_watson([(0, 0), (4, 0), (0, 3), (3, 2)]))
    with pytest.raises(fm.MeshError, match=says):
        trace.save(tmp_path / name, **options)
    assert not (tmp_path / name).exists()
