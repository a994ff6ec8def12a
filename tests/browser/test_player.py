"""The player, as a reader meets it in JupyterLab: by pointer, by keys, by ear, and from Python."""

import re

import pytest

from .flips import CELLS, KINDS, LAST, TRACE, same_kind, where
from .notebook import run_cell
from .shared import until

ENDLESS = """
def spiral():
    points = [(0, 0), (1, 0)]
    while True:
        n = len(points)
        points.append((n * (n % 7 - 3), n * (n % 5 - 2.5)))
        yield fm.Step("grow" if n % 2 else "wait", f"point {n} comes", points=points[-3:], triangles=[])

endless = fm.play(spiral())
endless
"""
RESET = "player.set_trait('playing', False); player.step, player.speed, player.circles, player.numbers = 0, 1, True, None"


NOTEBOOK = [CELLS[0], CELLS[2], "import ipywidgets\nplayer", "again = fm.play(trace)\nagain", ENDLESS]


@pytest.fixture
def at(opened):
    """The notebook, its player at step 0."""
    opened.begin_anew(RESET)
    opened.widget(1, "player").reads("where", where(0))
    return opened


@pytest.fixture
def player(at):
    yield at.widget(1, "player")
    at.nothing_wrong()


def shows(player, k):
    """Wait until all that the player says is of step k."""
    player.reads("where", where(k))
    assert player.caption.text_content() == TRACE[k].caption
    assert player.canvas.get_attribute("aria-label") == f"{where(k)}: {TRACE[k].caption}"
    assert player.scrubber.input_value() == str(k)
    assert player.scrubber.get_attribute("aria-valuetext") == where(k)
    angle = TRACE.min_angles()[k]
    assert player.angle.text_content() == f"smallest angle {angle:.1f}°"


# ---- moving ------------------------------------------------------------------------------------------


def test_keys_step_forward_and_back_and_from_each_step_to_the_next_of_its_kind(player):
    shows(player, 0)
    for key, k in (("ArrowLeft", 0), ("ArrowRight", 1), ("ArrowRight", 2), ("ArrowLeft", 1), ("End", LAST)):
        player.press(key)
        shows(player, k)
    player.press("Home", "ArrowRight")
    k = 1
    for key, way in [("]", 1)] * 4 + [("[", -1)] * 3 + [("ArrowRight", 0), ("ArrowRight", 0), ("]", 1), ("[", -1), ("[", -1)]:
        player.press(key)
        k = same_kind(k, way) if way else k + 1
        shows(player, k)
    assert {KINDS[j] for j in range(k)} > {"start"}
    player.desk.comes_true(f"player.step == {k}")


def test_buttons_do_what_the_keys_do(player):
    kin = {"next test": same_kind(1, 1), "previous test": 1}
    for name, k in [("step forward", 1), *kin.items(), ("step back", 0), ("last step", LAST), ("first step", 0)]:
        player.button(name).click()
        shows(player, k)
    assert player.button("previous start").is_disabled()
    assert player.button("next start").is_disabled()


def test_the_scrubber_and_the_strip_lead_to_any_step(player):
    player.scrubber.focus()
    for key, k in (("End", LAST), ("ArrowLeft", LAST - 1), ("Home", 0), ("ArrowRight", 1)):
        player.desk.page.keyboard.press(key)
        shows(player, k)
    player.scrubber.fill("7")
    shows(player, 7)
    width = player.strip.bounding_box()["width"]
    for k in (LAST, 0, 11):
        gutter = min(92, width / 4)
        player.strip.click(position={"x": gutter + 4 + (width - gutter - 9) * k / LAST, "y": 20})
        shows(player, k)


def test_playing_shows_every_step_in_order(player):
    watch = """root => {
        const where = root.querySelector(".fem-where");
        window.passed = [where.textContent];
        const observer = new MutationObserver(() => passed.push(where.textContent));
        observer.observe(where, {childList: true, characterData: true, subtree: true});
    }"""
    player.root.evaluate(watch)
    player.press("+", "+", "+", "+")
    assert player.root.get_by_label("speed").input_value() == "8"
    assert player.caption.get_attribute("aria-live") == "polite"
    player.press(" ")
    player.button("pause").wait_for()
    assert player.caption.get_attribute("aria-live") == "off", "spoken in a rush"
    player.reads("where", where(LAST))
    player.button("play").wait_for()
    assert player.desk.page.evaluate("passed") == [where(k) for k in range(LAST + 1)]
    player.desk.comes_true(f"(player.step, player.playing, player.speed) == ({LAST}, False, 8)")
    player.press("-", "-", " ")  # from the last step it begins again
    player.reads("where", re.compile(r"^step \d of"))
    player.press("Space")
    player.button("play").wait_for()
    k = int(player.where.text_content().split()[1])
    player.desk.page.wait_for_timeout(300)
    shows(player, k)


def test_speed_goes_up_and_down_between_its_ends(player):
    speed = player.root.get_by_label("speed")
    for key, values in (("+", "2 4 8 8"), ("-", "4 2 1 0.5 0.25 0.25"), ("=", "0.5 1")):
        for value in values.split():
            player.press(key)
            assert speed.input_value() == value
    speed.select_option("4")
    player.desk.comes_true("player.speed == 4")


# ---- looks -------------------------------------------------------------------------------------------


def test_circles_and_numbers_are_turned_on_and_off_and_the_legend_follows(player):
    player.press("ArrowRight")
    assert "circumcircle" in player.legend.text_content()
    for key, name in (("c", "circles"), ("n", "numbers")):
        button = player.button(name)
        assert button.get_attribute("aria-pressed") == "true"
        player.press(key)
        assert button.get_attribute("aria-pressed") == "false"
        player.desk.comes_true(f"player.{name} is False")
        assert ("circumcircle" in player.legend.text_content()) == (name == "numbers")
        button.click()
        assert button.get_attribute("aria-pressed") == "true"


def test_zoom_pan_and_full_screen_end_in_the_same_step(player):
    page = player.desk.page
    player.press("ArrowRight", "i", "i", "o", "0")
    player.canvas.hover()
    page.keyboard.down("Control")
    page.mouse.wheel(0, -300)
    page.keyboard.up("Control")
    box = player.canvas.bounding_box()
    page.mouse.move(box["x"] + 200, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 260, box["y"] + 220)
    page.mouse.up()
    player.canvas.dblclick()
    player.press("f")
    page.wait_for_function("() => document.fullscreenElement?.matches('.fem-player')")
    player.press("ArrowRight", "f")
    page.wait_for_function("() => !document.fullscreenElement")
    shows(player, 2)


# ---- the page and Python -----------------------------------------------------------------------------


def test_what_python_sets_the_page_shows_and_what_the_page_does_python_has(player):
    desk = player.desk
    desk.do("player.step = 5")
    shows(player, 5)
    player.press("ArrowRight")
    desk.comes_true("player.step == 6")
    assert desk.ask("player.step", code="player.step = 10**9") == str(LAST)
    shows(player, LAST)
    desk.do("player.circles, player.numbers, player.speed = False, False, 0.25")
    until(desk.page, "() => document.querySelector('.fem-player select').value === '0.25'")
    for name in ("circles", "numbers"):
        assert player.button(name).get_attribute("aria-pressed") == "false"
    desk.do("player.step, player.speed, player.playing = 0, 8, True")
    player.reads("where", where(LAST))
    desk.comes_true(f"(player.step, player.playing) == ({LAST}, False)")


def test_a_slider_is_linked_to_the_step(player):
    desk = player.desk
    desk.do(f"slider = ipywidgets.IntSlider(max={LAST}); link = ipywidgets.link((player, 'step'), (slider, 'value'))")
    desk.do("slider.value = 7")
    shows(player, 7)
    player.press("ArrowRight", "ArrowRight", "ArrowRight")
    desk.comes_true("slider.value == 10")
    desk.do("link.unlink()")


def test_two_views_of_a_player_follow_each_other(player):
    other = player.desk.widget(2, "player")
    player.press("ArrowRight", "ArrowRight", "c", "+")
    shows(other, 2)
    assert other.button("circles").get_attribute("aria-pressed") == "false"
    assert other.root.get_by_label("speed").input_value() == "2"
    other.press("End", "c")
    shows(player, LAST)
    assert player.button("circles").get_attribute("aria-pressed") == "true"


def test_two_views_play_no_faster_than_one(player):
    other = player.desk.widget(2, "player")
    player.desk.do("player.speed = 0.25")
    other.button("play").click()
    other.reads("where", re.compile(f"^(?!{where(0)})"))
    player.desk.page.wait_for_timeout(200)  # of two seconds
    assert other.where.text_content() == where(1)


def test_a_cell_run_again_shows_one_player(at):
    for _ in range(2):
        run_cell(at.page, 3)
        again = at.widget(3, "player")
        again.press("ArrowRight", "ArrowRight")
        again.reads("where", where(2))
        at.comes_true("again.step == 2")
    until(at.page, "() => cells[3].node.querySelectorAll('.fem-player').length === 1")
    at.nothing_wrong()


def test_an_endless_run_is_played_500_steps_further_on_demand(at):
    endless = at.widget(4, "player")
    more = endless.button("load 500 more steps")
    n = int(at.ask("len(endless.trace)"))
    assert n <= 2000
    endless.press("End")
    endless.reads("where", re.compile(f"step {n - 1} of {n - 1}, "))
    more.click()
    endless.reads("where", re.compile(f"step {n - 1} of {n + 499}, "))
    endless.press("m")
    endless.reads("where", re.compile(f"step {n - 1} of {n + 999}, "))
    endless.press("End")
    endless.reads("caption", f"point {n + 1001} comes")
    at.comes_true(f"len(endless.trace) == {n + 1000} and endless.step == {n + 999}")
    at.nothing_wrong()


# ---- keyboard and ear --------------------------------------------------------------------------------


def test_a_screen_reader_is_told_each_step(player):
    assert player.root.get_attribute("aria-label") == f"player of {LAST + 1} steps"
    for k in (0, 1):
        shows(player, k)
        assert player.root.get_by_role("status").text_content() == TRACE[k].caption
        assert player.root.get_by_role("img").get_attribute("aria-label").endswith(TRACE[k].caption)
        player.press("ArrowRight")


def test_keys_work_on_when_a_button_has_nothing_left_to_do(player):
    k = 1
    player.press("ArrowRight")
    player.button("next test").focus()
    while (after := same_kind(k, 1)) != k:
        player.desk.page.keyboard.press("Enter")
        player.reads("where", where(k := after))
    player.desk.page.keyboard.press("Home")
    player.reads("where", where(0))


@pytest.mark.parametrize("modifiers", [{"altKey": True}, {"altKey": True, "ctrlKey": True, "modifierAltGraph": True}])
def test_brackets_are_heard_from_keyboards_where_they_need_alt(player, modifiers):
    player.press("ArrowRight")
    player.root.evaluate(
        "(root, m) => root.dispatchEvent(new KeyboardEvent('keydown', {key: ']', bubbles: true, ...m}))", modifiers
    )
    assert player.where.text_content() == where(same_kind(1, 1))
