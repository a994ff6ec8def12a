"""Parts of the widgets by themselves, on a page without a lab: what is hard to bring about in one."""

import pytest

import fem_mesh as fm
from fem_mesh.watch.front import PLAYER, css, module
from fem_mesh.watch.wire import as_data

FEW = [(0, 0), (1, 0), (0, 1), (1, 1)]
FAR = [*FEW, (9, 9)]
POINTER = """const at = (node, type, x, y, more = {}) => node.dispatchEvent(
    new PointerEvent(type, {pointerId: 1, bubbles: true, clientX: x, clientY: y, ...more}));"""


@pytest.fixture(scope="module")
def parts(browser, tmp_path_factory):
    path = tmp_path_factory.mktemp("parts") / "parts.html"
    code = module(PLAYER, "Object.assign(window, {Player, STYLE});")
    path.write_text(f'<style>{css()}</style><div id="here"></div><script type="module">{code}</script>')
    page = browser.new_page()
    page.goto(path.as_uri())
    page.wait_for_function("() => window.Player")
    page.evaluate("() => { HTMLCanvasElement.prototype.setPointerCapture = () => null; }")  # of a pointer that is not there
    yield page
    page.close()


def player(parts, script, points=FEW, **more):
    """Run a script with a new player of an insertion."""
    data = as_data(fm.record(fm.bowyer_watson(points)))
    code = """async ({data, ...more}) => {
        %s
        const root = document.createElement("div"), pause = ms => new Promise(done => setTimeout(done, ms));
        document.querySelector("#here").replaceChildren(root);
        const player = new Player(root, data, STYLE);
        %s
    }"""
    return parts.evaluate(code % (POINTER, script), {"data": data, **more})


def test_steps_that_are_loaded_later_are_in_the_picture(parts):
    more = as_data(fm.record(fm.bowyer_watson(FAR)))
    box, fitted = player(
        parts, "player.setData(more.more); const box = player.view.box; player.fit(); return [box, player.view.box];", more=more
    )
    assert box == fitted == more["box"]


def test_a_player_that_is_out_of_the_page_for_a_while_plays_on(parts):
    script = """
        player.setSpeed(8); player.play();
        root.remove(); await pause(300);
        const away = player.k;
        document.querySelector("#here").append(root);
        for (let i = 0; i < 100 && player.playing; i++) await pause(50);
        return [away, player.k, player.trace.length - 1];
    """
    away, now, last = player(parts, script)
    assert (away, now) == (0, last)


@pytest.mark.parametrize("where", ["fem-canvas", "fem-strip"])
@pytest.mark.parametrize("end", ["pointerup", "pointercancel"])
def test_a_pointer_that_was_let_go_or_taken_away_moves_nothing_more(parts, where, end):
    script = f"""
        const node = root.querySelector(".{where}"), state = () => [player.k, ...player.view.center].join();
        const seen = [state()];
        at(node, "pointerdown", 300, 20); at(node, "pointermove", 340, 30);
        seen.push(state());
        at(node, "{end}", 340, 30); at(node, "pointermove", 500, 90);
        return [...seen, state()];
    """
    before, moved, after = player(parts, script)
    assert before != moved == after


def test_the_other_buttons_of_a_mouse_move_nothing(parts):
    script = """
        const state = () => [player.k, ...player.view.center].join(), before = state();
        for (const node of [root.querySelector(".fem-canvas"), root.querySelector(".fem-strip")]) {
            at(node, "pointerdown", 300, 20, {button: 2}); at(node, "pointermove", 400, 90);
        }
        return [before, state()];
    """
    before, after = player(parts, script)
    assert before == after


def test_a_view_that_closes_stops_no_other(parts):
    script = """
        const told = [];
        player.host.playing = playing => told.push(playing);
        player.play(); player.close();
        return told;
    """
    assert player(parts, script) == [True]
