"""Domains meshed as they are drawn: bounds by slider and by brush, the steps played below, and code that does it again."""

import ast
import re

import pytest

from .board import L_SHAPE, SETUP, cleared
from .shared import until

NOTEBOOK = [SETUP]


@pytest.fixture
def board(opened):
    with cleared(opened) as board:
        yield board


def test_sliders_ask_and_the_mesh_follows(board):
    board.draw(L_SHAPE)
    board.has_corners(6)
    board.labelled("smallest angle").fill("33")
    board.desk.comes_true("pg.min_angle == 33")
    board.reads_as_in_python()
    board.labelled("longest edge").fill("40")
    board.desk.comes_true("pg.size is not None and pg.mesh.refinement.complete")
    board.reads_as_in_python()
    board.reads("state", re.compile(r"^complete: [\d,]+ points added$"))
    for name in ("smallest angle", "longest edge"):
        board.labelled(name).fill("0")
    board.desk.comes_true("pg.min_angle == 0 and pg.size is None and pg.mesh.refinement is None")
    board.reads("state", "no bounds: constrained Delaunay, no points added")
    board.reads_as_in_python()


def test_a_storm_of_slider_events_is_a_few_meshes_and_ends_at_the_last_value(board):
    board.draw(L_SHAPE)
    board.has_corners(6)
    board.desk.do("made = []; pg.observe(made.append, 'mesh')")
    script = """root => {
        const slider = root.querySelector("input[aria-label='smallest angle']");
        for (let k = 0; k <= 72; k++) { slider.value = k % 37; slider.dispatchEvent(new Event("input")); }
    }"""
    board.root.evaluate(script)
    board.desk.comes_true("pg.min_angle == 35")
    board.reads_as_in_python()
    assert int(board.desk.ask("len(made)", code="pg.unobserve(made.append, 'mesh')")) <= 2
    assert board.labelled("smallest angle").input_value() == "35"


def test_encroached_segments_are_marked_until_refinement_by_the_circle_has_split_them(board):
    board.labelled("smallest angle").fill("0")
    board.draw([(0.5, 1), (5.5, 1), (5.5, 2), (3, 1.5), (0.5, 2)])
    board.reads("encroached", re.compile("^[1-9] segments? encroached$"))
    assert board.legend.text_content() == "segmentencroacheddiametral circle"
    board.labelled("encroachment").select_option("circle")
    board.labelled("smallest angle").fill("20")
    board.reads("encroached", "")
    board.desk.comes_true("pg.encroachment == 'circle' and pg.mesh.refinement.complete")
    assert board.legend.text_content() == "segment"


def test_triangles_that_stay_below_the_bound_are_tinted_and_the_reason_is_told(board):
    board.draw([(0.5, 1), (5.5, 1), (5.5, 1.5)])
    board.reads("state", re.compile(r"^complete: \d+ points added, \d+ triangles? left \(small input angle\)$"))
    assert "skinny" in board.legend.text_content()
    assert board.histogram.get_attribute("aria-label").startswith("histogram: ")
    assert board.root.locator(".fem-histogram .fem-below[height]:not([height='0'])").count() > 0


def test_the_brush_asks_for_small_triangles_and_its_strokes_can_be_cleared(board):
    board.draw([(1, 1), (5, 1), (5, 3), (1, 3)])
    board.has_corners(4)
    board.press("b")
    few = int(board.desk.ask("len(pg.mesh.triangles)"))
    with board.plane.held(2, 2):
        board.plane.move(3, 2)
    board.desk.comes_true(f"len(pg.spots) > 3 and len(pg.mesh.triangles) > 20 * {few}")
    board.reads_as_in_python()
    assert "small triangles wanted" in board.legend.text_content()
    spots = board.desk.ask("len(pg.spots)")
    board.control("clear the brush's strokes").click()
    board.desk.comes_true("pg.spots == []")
    board.reads_as_in_python()
    board.press("Control+z")
    board.desk.comes_true(f"len(pg.spots) == {spots}")
    board.press("b")


def test_the_steps_are_played_below(board):
    board.draw(L_SHAPE)
    board.has_corners(6)
    board.labelled("smallest angle").fill("34")
    board.desk.comes_true("pg.min_angle == 34 and len(pg.mesh.points) > 6")
    board.control("play Ruppert's steps").click()
    player = board.root.locator(".fem-player")
    player.wait_for()
    board.desk.page.keyboard.press("ArrowRight")  # it has the focus
    until(board.desk.page, "() => /^step 1 of/.test(document.querySelector('.fem-player .fem-where').textContent)")
    assert player.get_attribute("aria-label") == f"player of {board.desk.ask('len(pg.trace)')} steps"
    board.desk.page.keyboard.press("End")
    last = ast.literal_eval(board.desk.ask("pg.trace[-1].caption"))
    until(board.desk.page, "last => document.querySelector('.fem-player .fem-caption').textContent === last", last)
    assert len(board.corners()) == 6, "its keys are not ours"
    board.control("close the player").click()
    player.wait_for(state="detached")
    board.labelled("smallest angle").fill("0")
    board.control("play the segments' insertion").click()
    player.wait_for()
    assert board.desk.ask("'segment' in pg.trace.counts") == "True"
    board.control("close the player").click()


def test_a_long_run_is_cut_and_says_so(board):
    board.labelled("start from a shape").select_option("square")
    board.desk.comes_true("pg.domain is not None")
    board.desk.do("pg.size = 0.02")
    board.desk.comes_true("pg.mesh.refinement.complete")  # not before all is compiled
    board.press("p")
    board.reads("cut", "the first 5,000 steps of it: the run goes on")
    board.control("close the player").click()


def test_code_is_copied_that_makes_the_mesh_again(board):
    board.draw(L_SHAPE)
    board.has_corners(6)
    board.labelled("longest edge").fill("30")
    board.desk.comes_true("pg.size is not None")
    board.reads_as_in_python()
    board.control("copy as code").click()
    code = board.code.input_value()
    assert code == ast.literal_eval(board.desk.ask("pg.as_code()"))
    names = {}
    exec(code, names)
    assert names["mesh"].triangles.tolist() == ast.literal_eval(board.desk.ask("pg.mesh.triangles.tolist()"))


def test_what_python_sets_is_seen(board):
    board.desk.do("pg.domain = fm.gear(); pg.min_angle = 31; pg.size = 0.1; pg.encroachment = 'circle'")
    board.reads("state", re.compile("^complete"))
    board.reads_as_in_python()
    assert board.labelled("smallest angle").input_value() == "31"
    assert board.labelled("encroachment").input_value() == "circle"
    assert "≤ 0.1 (5 %)" in board.root.locator("label.fem-size").text_content()
    board.desk.do("pg.spots = [(0.5, 0.5, 0.01)]")
    until(board.desk.page, "() => document.querySelector('.fem-legend').textContent.includes('small triangles wanted')")
    board.reads_as_in_python()
