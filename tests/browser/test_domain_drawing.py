"""Domains drawn in JupyterLab: by pointer and by keys, in one view or two, and what Python has of them."""

import ast
import re

import pytest

from fem_mesh.watch.domain_playground.sketch import SHAPES

from .board import L_SHAPE, PIXEL, SETUP, Board, cleared
from .shared import until

NOTEBOOK = [SETUP, "pg"]


@pytest.fixture
def board(opened):
    with cleared(opened) as board:
        yield board


def test_a_triangle_is_drawn_by_clicks(board):
    assert board.hint.is_visible()
    board.draw([(1, 1), (4, 1), (1, 3)], close=False)
    board.reads("status", "corner 3; click the first one, or press enter, to close the loop")
    assert board.corners() == []
    board.plane.click(1.02, 1.02)  # near enough
    board.reads("triangles", re.compile("^[1-9]"))
    assert board.corners() == [pytest.approx(corner, abs=PIXEL) for corner in ([1, 1], [4, 1], [1, 3])]
    assert board.hint.is_hidden()
    board.reads_as_in_python()


def test_enter_and_a_double_click_close_a_loop_and_escape_drops_it(board):
    board.draw([(1, 1), (5, 1), (5, 3.5)], close=False)
    board.desk.page.keyboard.press("Enter")
    board.has_corners(3)
    board.draw([(3, 1.5), (4, 1.5)], close=False)
    board.plane.canvas.dblclick(position=board.plane.at(4, 2))
    board.desk.comes_true("pg.domain is not None and pg.domain.names == ('outer',) * 3 + ('hole 0',) * 3")
    board.draw([(0.5, 3), (1, 3), (1, 3.5)], close=False)
    board.desk.page.keyboard.press("Escape")
    board.reads("status", "the loop under way is dropped")
    board.desk.page.keyboard.press("Enter")
    assert len(board.corners()) == 6
    board.reads_as_in_python()


def test_a_dragged_corner_takes_the_mesh_along(board):
    board.draw(L_SHAPE)
    board.has_corners(6)
    with board.plane.held(2, 2):
        board.plane.move(3, 1.8)
        board.has_corner(3, 3, 1.8)
        board.reads_as_in_python()
        board.plane.move(2.5, 1.5)
    board.has_corner(3, 2.5, 1.5)
    board.press("Control+z")
    board.has_corner(3, 2, 2)
    board.reads_as_in_python()


def test_shift_and_a_click_and_delete_take_corners_out_and_then_the_loop(board):
    board.draw(L_SHAPE)
    board.plane.click(2, 2, modifiers=["Shift"])
    board.has_corners(5)
    board.plane.click(5, 2)
    board.reads("status", re.compile("^corner 2 at .* drag it, or delete it$"))
    board.desk.page.keyboard.press("Delete")
    board.has_corners(4)
    board.desk.page.keyboard.press("Delete")  # nothing is chosen any more
    board.plane.click(5, 1, modifiers=["Shift"])
    board.has_corners(3)
    board.plane.click(1, 1, modifiers=["Shift"])
    board.desk.comes_true("pg.domain is None")
    board.reads("triangles", "0 triangles")


def test_undo_and_redo_go_through_corners_loops_and_shapes(board):
    board.draw([(1, 1), (5, 1), (5, 3)])
    board.has_corners(3)
    board.button("undo").click()  # the loop is open again
    board.desk.comes_true("pg.domain is None")
    for _ in range(3):
        board.press("Control+z")
    board.hint.wait_for()
    for _ in range(4):
        board.button("redo").click()
    board.has_corners(3)
    assert board.button("redo").is_disabled()
    board.labelled("start from a shape").select_option("annulus")
    board.has_corners(96)
    board.button("clear").click()
    board.desk.comes_true("pg.domain is None")
    board.press("Control+z")
    board.desk.comes_true("pg.domain is not None and len(pg.domain.curves) == 96 and pg.as_code().count('fm.annulus()') == 1")
    board.press("Control+z")
    board.has_corners(3)
    board.press("Control+y")
    board.desk.comes_true("pg.domain is not None and len(pg.domain.curves) == 96")
    board.reads_as_in_python()


def test_the_grid_takes_corners_to_round_places(board):
    board.press("g")
    board.draw([(1.03, 1.05), (4.05, 0.95), (1.05, 3.05)])
    board.press("g")
    board.has_corners(3)
    assert board.corners() == [[1, 1], [4, 1], [1, 3]]


def test_a_crossing_is_told_where_it_is_and_the_last_mesh_stays_grey(board):
    board.draw([(1, 1), (4, 1), (4, 3), (1, 3)])
    board.has_corners(4)
    with board.plane.held(4, 3):
        board.plane.move(2.5, 0.5)
        board.refusal.wait_for()
        board.desk.comes_true("pg.domain is None and pg.mesh is None and pg.refusal")
        assert board.refusal.get_attribute("role") == "alert"
        assert board.refusal.text_content() == ast.literal_eval(board.desk.ask("pg.refusal"))
        assert "cross at (2" in board.refusal.text_content()
        x, y = ast.literal_eval(board.desk.ask("pg.where"))
        at, box, frame = board.plane.at(x, y), board.refusal.bounding_box(), board.plane.canvas.bounding_box()
        assert abs(box["y"] - frame["y"] - at["y"]) < 30 or abs(box["y"] + box["height"] - frame["y"] - at["y"]) < 30
        assert box["x"] <= frame["x"] + at["x"] <= box["x"] + box["width"]
        assert "fem-refused" in board.root.get_attribute("class")
        assert board.control("copy as code").is_disabled()
        board.plane.move(4, 3.5)
    board.refusal.wait_for(state="hidden")
    board.desk.comes_true("pg.mesh is not None and not pg.refusal")
    board.reads_as_in_python()


def test_it_starts_from_each_shape(board):
    assert board.labelled("start from a shape").locator("option").all_text_contents() == ["start from ...", *SHAPES]
    for start in ("airfoil", "cracked square", "letter A"):
        board.labelled("start from a shape").select_option(start)
        board.desk.comes_true(f"pg.domain is not None and 'fm.{SHAPES[start][0].__name__}(' in pg.as_code()")
        board.reads_as_in_python()


def test_a_domain_is_drawn_and_changed_with_the_keyboard_alone(board):
    page = board.desk.page
    board.press("g", " ")  # the grid; the cross, in the middle of the page
    board.press(" ", *["ArrowRight"] * 5, " ", *["ArrowUp"] * 5, "Enter", "Enter")  # twice: closed
    board.reads("status", "the loop is closed")
    board.has_corners(3)
    a = board.corners()
    assert [(x - a[0][0], y - a[0][1]) for x, y in a] == [(0, 0), (1, 0), (1, 1)]
    board.press("m", *["ArrowUp"] * 2, "m")
    board.reads("status", re.compile("^corner 2 is put down"))
    board.desk.comes_true(f"abs(pg.domain.points[2] - {[a[2][0], a[2][1] + 0.4]}).max() < 1e-9")
    board.press("Control+z")
    board.desk.comes_true(f"pg.domain.points.tolist() == {a}")
    board.labelled("smallest angle").focus()
    page.keyboard.press("End")
    board.desk.comes_true("pg.min_angle == 36")
    board.labelled("longest edge").focus()
    for _ in range(30):
        page.keyboard.press("ArrowRight")
    board.desk.comes_true("pg.size is not None")
    board.reads_as_in_python()
    board.press("b", " ", "b", "g")
    board.desk.comes_true("len(pg.spots) == 1")
    board.labelled("start from a shape").focus()
    page.keyboard.type("gear")
    board.desk.comes_true("'fm.gear()' in pg.as_code()")
    board.press("ArrowLeft", "?")
    board.help.wait_for()
    board.press("Escape", "Escape")
    assert board.help.is_hidden()


def test_a_second_view_shows_the_same_and_either_may_draw(board):
    other = board.desk.widget(1, "domain-playground", Board)
    other.draw(L_SHAPE)
    board.desk.comes_true("pg.domain is not None and len(pg.domain.points) == 6")
    text = other.triangles.text_content()
    board.root.scroll_into_view_if_needed()
    board.reads("triangles", text)
    until(board.desk.page, "() => document.querySelector('.fem-sheet canvas').ariaLabel.startsWith('drawing: 6 corners')")
    with board.plane.held(2, 2):
        board.plane.move(3, 1.8)
    board.has_corner(3, 3, 1.8)
    other.reads("triangles", board.triangles.text_content())


def test_a_loop_under_way_stays_when_another_view_asks_for_a_mesh(board):
    other = board.desk.widget(1, "domain-playground", Board)
    other.draw(L_SHAPE[:3], close=False)
    ask_for_a_steeper_angle(board, 25)
    board.desk.page.wait_for_timeout(600)  # the other view has asked what happened, and was told
    for corner in [*L_SHAPE[3:], L_SHAPE[0]]:
        other.plane.click(*corner)
    board.has_corners(6)


def test_undo_takes_back_what_was_done_in_a_view_and_not_what_was_done_in_another(board):
    other = board.desk.widget(1, "domain-playground", Board)
    other.draw([(3, 3), (4, 3)], close=False)
    board.draw([(1, 1), (5, 1), (1, 2)])
    board.has_corners(3)
    board.desk.page.wait_for_timeout(800)  # the other view has followed
    other.press("Control+z")
    board.desk.page.wait_for_timeout(400)
    assert len(board.corners()) == 3
    until(
        board.desk.page,
        "() => [...document.querySelectorAll('.fem-sheet canvas')].at(-1).ariaLabel.startsWith('drawing: 4 corners')",
    )


def test_a_loop_that_is_closed_while_a_view_catches_up_stays(board):
    other = board.desk.widget(1, "domain-playground", Board)
    other.draw(L_SHAPE, close=False)
    rest_after_the_next_answer(board, 2)
    ask_for_a_steeper_angle(board, 25)
    board.desk.page.wait_for_timeout(600)  # it has asked what happened; there is no answer yet
    other.plane.click(*L_SHAPE[0])
    board.has_corners(6)


def test_a_mesh_that_is_asked_for_again_while_python_compiles_takes_nothing_back(board):
    board.desk.widget(1, "domain-playground", Board)
    board.desk.do("from fem_mesh.algorithms import ahead; ready, ahead.is_ready = ahead.is_ready, lambda: False")
    try:
        board.draw(L_SHAPE)
        board.has_corners(6)
        board.press("b")
        board.desk.page.wait_for_timeout(1000)
        rest_after_the_next_answer(board, 1.3)
        ask_for_a_steeper_angle(board, 25)
        board.desk.page.wait_for_timeout(900)  # the other view waits for an answer, and wants a whole mesh by now
        board.plane.click(1.5, 1.5)
        board.desk.comes_true("len(pg.spots) == 1")
        board.desk.page.wait_for_timeout(1000)
        assert board.desk.ask("len(pg.spots)") == "1"
    finally:
        board.desk.do("ahead.is_ready = ready")


def rest_after_the_next_answer(board, seconds):
    """Python answers the page once more, and then nothing for a while."""
    rest = f"""
import time
def rest(*_):
    pg.on_msg(rest, remove=True)
    time.sleep({seconds})
pg.on_msg(rest)"""
    board.desk.do(rest)


def ask_for_a_steeper_angle(board, degrees):
    board.labelled("smallest angle").evaluate(
        "(slider, degrees) => { slider.value = degrees; slider.dispatchEvent(new Event('input', {bubbles: true})); }", degrees
    )
    board.desk.comes_true(f"pg.min_angle == {degrees}")


def test_it_fits_a_narrow_column(board):
    board.draw(L_SHAPE)
    board.root.evaluate("root => { root.style.width = '400px'; }")
    fits = "() => (root => root.scrollWidth <= root.clientWidth)(document.querySelector('.fem-domain-playground'))"
    until(board.desk.page, fits)
    assert 350 < board.plane.canvas.bounding_box()["width"] <= 400
    board.root.evaluate("root => { root.style.width = ''; }")
