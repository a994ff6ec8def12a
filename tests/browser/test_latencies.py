"""How long a reader waits, in JupyterLab and a real browser: printed, never asserted.

``pytest -m exhaustive -s tests/browser/test_latencies.py``, on a quiet machine.
"""

import ast

import pytest

from .latency import measure
from .notebook import open_notebook, python, run_all
from .shared import Plane

pytestmark = pytest.mark.exhaustive

PLAYGROUND = """
import fem_mesh as fm
playground = fm.Playground(fm.random_points({n}, seed=3), circles={circles}, animated={animated})
playground
"""
PLAYER = """
import fem_mesh as fm
player = fm.play(fm.bowyer_watson(fm.random_points({n}, seed=3)))
player.load(20_000)
player
"""
# From the change of the scrubber to the frame that shows it, and the part of it that our own code takes.
SCRUB = """async root => {
    const scrubber = root.querySelector(".fem-scrubber"), own = [], all = [];
    for (let i = 0; i < 60; i++) {
        scrubber.value = scrubber.max - 1 - ((i * 37) % 60);
        await new Promise(requestAnimationFrame);
        const begin = performance.now();
        scrubber.dispatchEvent(new Event("input"));
        own.push(performance.now() - begin);
        await new Promise(done => requestAnimationFrame(() => setTimeout(done)));
        all.push(performance.now() - begin);
    }
    const median = times => times.sort((a, b) => a - b)[30];
    return [median(own), median(all), own[57]];
}"""
FREE = "(lambda m: m.points[m.triangles[m.areas().argsort()[::-1][:60:2]]].mean(axis=1).tolist())(playground.mesh)"


def begin(page, cell):
    open_notebook(page, [cell])
    run_all(page)
    page.wait_for_selector(".fem-canvas")
    page.wait_for_timeout(1500)
    return page.locator("[data-drawn]").first


def plane_of(page, root):
    return Plane(page, root.locator("canvas").first, ast.literal_eval(python(page, "playground.box")))


def test_steps_of_a_player(page):
    for n in (700, 1000, 2000, 3400):  # points; twice as many triangles
        root = begin(page, PLAYER.format(n=n))
        own, whole, slow = root.evaluate(SCRUB)
        print(f"\nplayer, {2 * n:5} triangles: {own:.1f} ms of drawing (95 %: {slow:.1f}), {whole:.1f} ms to the frame", end="")


def test_clicks_into_the_playground(page):
    for n in (200, 2000):
        for circles in (False, True):
            root = begin(page, PLAYGROUND.format(n=n, circles=circles, animated=False))
            plane, places = plane_of(page, root), ast.literal_eval(python(page, FREE))

            def click(k, plane=plane, places=places):
                plane.click(*places[k])

            watch = "root => root.querySelector('.fem-points').textContent"
            took = measure(page, click, watch, root=".fem-playground", event="pointerup")
            print(f"\nplayground, {n:4} points, circles {circles!s:5}: {took}", end="")


# A hand that moves for three seconds, 60 times a second as a mouse does, whatever the page is busy with. Playwright's own
# pointer waits for the page after each move.
DRAG = """([canvas, x, y]) => new Promise(done => {
    const {left, top} = canvas.getBoundingClientRect(), root = canvas.closest("[data-drawn]");
    const at = (type, dx, dy) => canvas.dispatchEvent(new PointerEvent(
        type, {pointerId: 1, bubbles: true, clientX: left + x + dx, clientY: top + y + dy}));
    canvas.setPointerCapture = () => {};
    at("pointerdown", 0, 0);
    const begin = performance.now(), before = Number(root.dataset.drawn);
    let moves = 0;
    const clock = setInterval(() => {
        if (performance.now() < begin + 3000) return at("pointermove", 5 + ++moves % 40, 5);
        clearInterval(clock);
        const seconds = (performance.now() - begin) / 1000;
        done([(Number(root.dataset.drawn) - before) / seconds, moves / seconds]);
        at("pointerup", 5, 5);
    }, 1000 / 60);
})"""


def test_points_dragged_in_the_playground(page):
    for circles in (False, True):
        root = begin(page, PLAYGROUND.format(n=2000, circles=circles, animated=False))
        plane = plane_of(page, root)
        at = plane.at(*ast.literal_eval(python(page, "playground.points[1000].tolist()")))
        updates, moves = page.evaluate(DRAG, [plane.canvas.element_handle(), at["x"], at["y"]])
        told = f"dragging among 2,000 points, circles {circles!s:5}"
        print(f"\n{told}: {updates:.0f} updates a second, of {moves:.0f} moves", end="")


@pytest.mark.parametrize("size", [0.092, 0.04])
def test_sliders_of_the_domain_playground(page, size):
    code = f"import fem_mesh as fm\npg = fm.DomainPlayground(fm.plate_with_hole(n=32), size={size})\npg"
    root = begin(page, code)
    while python(page, "__import__('fem_mesh').algorithms.ahead.is_ready()") != "True":
        page.wait_for_timeout(500)
    page.wait_for_timeout(2500)
    root.get_by_label("smallest angle", exact=True).focus()

    def press(k):
        page.keyboard.press("ArrowLeft" if k % 2 else "ArrowRight")

    histogram = "root => root.querySelector('.fem-bound').textContent"
    took = measure(page, press, histogram, root=".fem-domain-playground", event="input")
    print(f"\ndomain playground, {python(page, 'len(pg.mesh.triangles)')} triangles: {took}", end="")
