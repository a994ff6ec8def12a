"""The playground's buttons and switches in JupyterLab, and what Python and the page tell each other."""

import ast
import re

import pytest

from .shared import until
from .square import SETUP, Square, five_points

NOTEBOOK = [SETUP, "playground"]


@pytest.fixture
def playground(opened):
    with five_points(opened) as playground:
        yield playground


def test_buttons_make_points_and_undo_and_redo_go_through_them(playground):
    undo, redo = playground.button("undo"), playground.button("redo")
    assert undo.is_disabled()
    assert redo.is_disabled()
    made = {"16 random points": 16, "20 more random points": 36, "twelve points on a circle": 12, "a grid of points": 25}
    for name, n in [("clear", 0), *made.items()]:
        playground.button(name).click()
        playground.reads("points", f"{n} points")
        playground.desk.comes_true(f"len(playground.points) == {n} and playground.mesh.is_delaunay()")
    assert playground.caption.text_content().startswith("point 24 is joined")
    undo.click()
    playground.reads("points", "12 points")
    playground.press("Control+z")
    playground.reads("points", "36 points")
    playground.press("Control+y")
    playground.reads("points", "12 points")
    redo.click()
    playground.reads("points", "25 points")
    assert redo.is_disabled()
    for n in (12, 36, 16, 0, 5):
        playground.press("Control+z")
        playground.reads("points", f"{n} points")
    assert undo.is_disabled()
    playground.press("Control+Shift+Z")
    playground.reads("points", "0 points")
    assert not playground.smallest.text_content()


TOGGLES = {
    "circles": ("c", "circumcircle"),
    "voronoi": ("v", "Voronoi edge"),
    "ties": ("t", "cocircular: either diagonal would do"),
}


def test_toggles_are_heard_by_key_and_button_and_from_python_and_the_legend_has_their_words(playground):
    playground.button("twelve points on a circle").click()
    playground.reads("points", "12 points")
    for name, (key, word) in TOGGLES.items():
        button = playground.button(name)
        for act, on in (
            (lambda key=key: playground.press(key), True),
            (button.click, False),
            (lambda name=name: playground.desk.do(f"playground.{name} = True"), True),
            (lambda name=name: playground.desk.do(f"playground.{name} = False"), False),
        ):
            act()
            pressed = f"button[aria-label={name}][aria-pressed={str(on).lower()}]"
            playground.root.locator(pressed).wait_for()
            playground.reads("legend", word if on else "")
            playground.desk.comes_true(f"playground.{name} is {on}")


def test_numbers_and_animation_are_toggled_too(playground):
    for name, label, key in (("numbers", "numbers", "n"), ("animated", "animate insertions", "a")):
        button = playground.button(label)
        on = button.get_attribute("aria-pressed")
        assert on == {"numbers": "true", "animated": "false"}[name]
        playground.press(key)
        playground.root.locator(f"button[aria-label='{label}']:not([aria-pressed={on}])").wait_for()
        playground.desk.comes_true(f"playground.{name} is {on == 'false'}")
        button.click()
        playground.desk.comes_true(f"playground.{name} is {on == 'true'}")


def test_an_animated_insertion_shows_the_cavity_then_what_is_new_then_nothing_more(playground):
    playground.desk.do("playground.animated = True")
    legend = "() => document.querySelector('.fem-playground .fem-legend')"
    playground.desk.page.evaluate(f"""() => {{
        const legend = ({legend})();
        window.told = [];
        new MutationObserver(() => told.push(legend.textContent)).observe(legend, {{childList: true}});
    }}""")
    playground.plane.click(0.25, 0.25)
    playground.reads("points", "6 points")
    playground.reads("legend", "")
    told = [text for text in playground.desk.page.evaluate("told") if text]
    assert len(told) == 2
    assert "about to go" in told[0]
    assert "circumcircle" in told[0]
    assert told[1].startswith("new")


def test_without_motion_an_insertion_is_there_at_once(playground):
    playground.desk.do("playground.animated = True")
    playground.desk.page.emulate_media(reduced_motion="reduce")
    try:
        playground.plane.click(0.25, 0.25)
        playground.reads("points", "6 points")
        assert "about to go" not in playground.legend.text_content()
    finally:
        playground.desk.page.emulate_media(reduced_motion="no-preference")


def test_code_is_copied_that_makes_the_same_points_again(playground):
    playground.plane.click(0.3, 0.2)
    playground.reads("points", "6 points")
    playground.button("copy as code").click()
    playground.code.wait_for()
    scope = {}
    code, last = playground.code.input_value().rsplit("\n", 1)
    exec(code, scope)
    assert eval(last, scope).points.tolist() == playground.points_in_python()
    playground.button("clear").click()
    playground.reads("points", "0 points")
    playground.button("copy as code").click()
    until(playground.desk.page, "() => document.querySelector('.fem-code').value.includes('Playground()')")
    scope = {}
    exec(playground.code.input_value(), scope)
    assert len(scope["playground"].points) == 0


def test_what_python_does_the_page_shows_in_every_view(playground):
    other = playground.desk.widget(1, "playground", Square)
    did = {"add(0.25, 0.25)": 6, "remove(0)": 5, "move(0, 0.3, 0.3)": 5, "undo()": 5, "redo()": 5, "clear()": 0}
    for code, n in did.items():
        playground.desk.do(f"playground.{code}")
        for view in (playground, other):
            view.reads("points", f"{n} points")
            view.reads("caption", playground.desk.ask("playground._said").strip("'"))
    other.plane.click(0.5, 0.5)
    playground.reads("points", "1 point")
    playground.reads("caption", "point 0 is there; a triangle needs 2 more")
    playground.reads("triangles", "0 triangles")


def test_a_point_on_another_is_refused_in_words(playground):
    playground.desk.do("playground.add(0.5, 0.625)")
    playground.reads("caption", re.compile("point 5 .*point 4"))
    playground.reads("points", "5 points")
    assert playground.button("undo").is_disabled(), "nothing changed"


def test_points_anywhere_are_in_view(playground):
    playground.desk.do("playground.begin([(1000, 0), (3000, 0), (2000, 2000)])")
    playground.reads("points", "3 points")
    left, right, bottom, top = ast.literal_eval(playground.desk.ask("playground.box"))
    assert left < 1000 < 3000 < right
    assert bottom < 0 < 2000 < top
    box = playground.canvas.bounding_box()
    playground.canvas.click(position={"x": box["width"] / 2, "y": box["height"] / 2})
    playground.reads("points", "4 points")
    assert playground.points_in_python()[3] == pytest.approx((2000, 1000), abs=2120 / 540)
