"""Points added, moved and removed in the playground in JupyterLab, by pointer and by keys."""

import re

import pytest

import fem_mesh as fm

from .shared import until
from .square import BEGINNING, PIXEL, SETUP, five_points

NOTEBOOK = [SETUP, "playground"]


@pytest.fixture
def playground(opened):
    with five_points(opened) as playground:
        yield playground


def test_a_click_adds_a_point_where_it_is_and_the_page_reads_what_python_has(playground):
    for n, (x, y) in enumerate([(0.25, 0.25), (0.7, 0.2), (1.04, 0.5), (-0.2, 1.03)], 6):  # the last two beyond the hull
        playground.plane.click(x, y)
        playground.reads("points", f"{n} points")
        assert playground.points_in_python()[-1] == pytest.approx((x, y), abs=PIXEL)
        mesh = fm.delaunay(playground.points_in_python())
        playground.reads("triangles", f"{len(mesh.triangles)} triangles")
        playground.reads("smallest", f"smallest angle {mesh.min_angle:.1f}°")
        playground.reads("caption", re.compile(f"^point {n - 1} is joined to the . edges around the cavity"))
    playground.is_delaunay()


def test_a_pointer_that_is_taken_away_ends_its_drag(playground):
    plane = playground.plane
    begin, end = plane.at(0.5, 0.625), plane.at(0.3, 0.4)
    gesture = """(canvas, [begin, end]) => {
        const {left, top} = canvas.getBoundingClientRect();
        const at = (type, {x, y}) => canvas.dispatchEvent(
            new PointerEvent(type, {pointerId: 1, bubbles: true, clientX: left + x, clientY: top + y}));
        canvas.setPointerCapture = () => null;
        at("pointerdown", begin); at("pointermove", end); at("pointercancel", end); at("pointermove", {x: 5, y: 5});
        delete canvas.setPointerCapture;
    }"""
    playground.canvas.evaluate(gesture, [begin, end])
    playground.desk.comes_true("abs(playground.points[4] - (0.3, 0.4)).max() < 0.01")
    playground.press("Control+z")
    playground.desk.comes_true("playground.points[4].tolist() == [0.5, 0.625]")


def test_a_click_on_a_point_chooses_it_and_delete_takes_it_out(playground):
    playground.plane.click(0.5, 0.625)
    playground.reads("caption", "point 4 at (0.5000, 0.6250): drag it, or delete it")
    assert playground.points_in_python() == BEGINNING
    playground.desk.page.keyboard.press("Delete")
    playground.reads("points", "4 points")
    assert playground.points_in_python() == BEGINNING[:4]
    assert playground.caption.text_content() == "point 4 is taken out: 4 triangles go, 2 come"


def test_delete_takes_out_only_what_was_chosen(playground):
    playground.plane.click(0, 0)
    playground.reads("caption", re.compile("point 0 at"))
    playground.desk.page.keyboard.press("Delete")
    playground.reads("points", "4 points")
    playground.desk.page.keyboard.press("Delete")
    playground.desk.page.keyboard.press("Backspace")
    assert len(playground.points_in_python()) == 4


def test_shift_and_a_click_take_a_point_out(playground):
    playground.plane.click(1, 0, modifiers=["Shift"])
    playground.reads("points", "4 points")
    assert [1, 0] not in playground.points_in_python()
    playground.is_delaunay()


def test_a_dragged_point_is_moved_as_it_goes_and_that_is_one_change(playground):
    desk = playground.desk
    with playground.plane.held(0.5, 0.625):
        playground.plane.move(0.4, 0.5)
        desk.comes_true(f"abs(playground.points[4] - (0.4, 0.5)).max() < {PIXEL}")
        playground.reads("caption", re.compile("^point 4 moves"))
        playground.plane.move(0.9, 0.1)
        playground.plane.move(0.75, 0.25)
    desk.comes_true(f"abs(playground.points[4] - (0.75, 0.25)).max() < {PIXEL}")
    playground.is_delaunay()
    assert desk.ask("playground.trace[-1].kind") == "'move'"
    playground.press("Control+z")
    desk.comes_true("playground.points[4].tolist() == [0.5, 0.625]")
    playground.reads("caption", re.compile("^point 4 is joined"))
    assert playground.button("undo").is_disabled(), "one change"


def test_dragging_the_plane_moves_the_view_and_clicks_know_it(playground):
    with playground.plane.held(0.25, 0.25):
        playground.plane.move(0.35, 0.35)
    assert len(playground.points_in_python()) == 5
    playground.press("i", "o")
    playground.plane.click(0.35, 0.35)
    playground.reads("points", "6 points")
    assert playground.points_in_python()[-1] == pytest.approx((0.25, 0.25), abs=PIXEL)
    playground.press("0")
    playground.plane.click(0.25, 0.25)
    playground.reads("caption", re.compile("^point 5 at"))


def test_the_wheel_zooms_with_ctrl_only(playground):
    page = playground.desk.page
    playground.canvas.hover(position=playground.plane.at(0.25, 0.25))
    page.keyboard.down("Control")
    page.mouse.wheel(0, -400)
    page.keyboard.up("Control")
    until(page, "() => +document.querySelector('.fem-playground').dataset.drawn")
    playground.plane.click(0.25, 0.25)  # the pointer's place stays
    playground.reads("points", "6 points")
    assert playground.points_in_python()[-1] == pytest.approx((0.25, 0.25), abs=PIXEL)
    playground.plane.click(0.5, 0.25)
    playground.reads("points", "7 points")
    assert playground.points_in_python()[-1] == pytest.approx((0.25 + 0.25 / 2.2255, 0.25), abs=PIXEL)  # e^0.8


def test_the_keyboard_alone_adds_chooses_and_removes(playground):
    playground.press("ArrowRight")
    playground.reads("caption", "cross at (0.500, 0.500)")
    keys = playground.desk.page.keyboard
    for key in ("ArrowLeft", "ArrowLeft", "ArrowDown", "Shift+ArrowUp", "Shift+ArrowRight"):  # 20 pixels, with shift 2
        keys.press(key)
    x, y = 0.5 - 38 * PIXEL, 0.5 - 18 * PIXEL
    playground.reads("caption", f"cross at ({x:.3f}, {y:.3f})")
    keys.press("Enter")
    playground.reads("points", "6 points")
    assert playground.points_in_python()[-1] == pytest.approx((x, y), abs=PIXEL)
    keys.press("Enter")
    playground.reads("caption", re.compile("^point 5 at .*: drag it, or delete it"))
    keys.press("Delete")
    playground.reads("points", "5 points")
    keys.press("ArrowUp")
    keys.press("Space")
    playground.reads("points", "6 points")
    keys.press("Shift+ArrowUp")
    playground.reads("caption", re.compile("^cross at .*, on point 5$"))
    keys.press("Backspace")
    playground.reads("points", "5 points")
    playground.is_delaunay()


def test_a_screen_reader_is_told_what_happened_and_what_there_is(playground):
    playground.plane.click(0.25, 0.25)
    playground.reads("caption", re.compile("^point 5 is joined"))
    assert playground.root.get_by_role("status").text_content() == playground.caption.text_content()
    assert re.match(r"6 points, . triangles, smallest angle \d+\.\d°", playground.plane.canvas.get_attribute("aria-label"))


def test_a_drag_with_keys_in_between_leaves_a_trace_that_can_be_played(playground):
    playground.press("ArrowRight")
    with playground.plane.held(0.5, 0.625):
        playground.plane.move(0.3, 0.7)
        playground.reads("caption", re.compile("^point 4 moves"))
        for key in ("Enter", "ArrowUp", "ArrowUp", "Enter", "Control+z"):
            playground.desk.page.keyboard.press(key)
        playground.plane.move(0.7, 0.3)
    playground.is_delaunay()
    while playground.button("undo").is_enabled():
        playground.press("Control+z")
        playground.desk.do("None")  # heard, and answered
    assert playground.points_in_python() == BEGINNING
    playground.is_delaunay()
