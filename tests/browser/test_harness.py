"""The tests' own tools, tried on a small widget: what they say they saw was there."""

import json
import sys

import pytest

from .latency import measure
from .notebook import cell, open_notebook, python, restart_kernel, run_all, run_cell, save, set_theme, wait_until

pytestmark = pytest.mark.exhaustive
WIDGET = '''
import time, anywidget, traitlets

class Dots(anywidget.AnyWidget):
    """A canvas; a click tells Python where, Python counts, the canvas draws the count."""
    _esm = """
    function render({ model, el }) {
        const root = document.createElement("div"), canvas = document.createElement("canvas");
        const count = document.createElement("span");
        Object.assign(canvas, { width: 200, height: 100 });
        count.className = "count";
        root.className = "dots";
        root.dataset.drawn = 0;
        root.append(canvas, count);
        el.append(root);
        const draw = () => {
            count.textContent = model.get("count");
            canvas.getContext("2d").fillRect(...model.get("clicked"), 4, 4);
            root.dataset.drawn = Number(root.dataset.drawn) + 1;
        };
        canvas.addEventListener("pointerdown", event => {
            model.set("clicked", [Math.round(event.offsetX), Math.round(event.offsetY)]);
            model.save_changes();
        });
        model.on("change:count", draw);
        draw();
    }
    export default { render };
    """
    clicked = traitlets.List([0, 0]).tag(sync=True)
    count = traitlets.Int(0).tag(sync=True)

    pause = 0

    @traitlets.observe("clicked")
    def _clicked(self, change):
        time.sleep(self.pause)
        self.count += 1

dots = Dots()
dots
'''

COUNT = "root => root.querySelector('.count').textContent"


def click(page, x, y):
    page.locator(".dots canvas").click(position={"x": x, "y": y})


def test_the_theme_changes_and_the_next_notebook_is_light_again(room, seen):
    light = "document.body.dataset.jpThemeLight"
    with room.notebook() as page:
        open_notebook(page, ["1"])
        set_theme(page, "JupyterLab Dark")
        assert page.evaluate(light) == "false"
    with room.notebook() as page:
        open_notebook(page, ["1"])
        assert page.evaluate(light) == "true"


def test_the_next_notebook_is_not_the_last_one(page, lab):
    for n in (1, 2):
        open_notebook(page, [f"n{n} = {n}"])
        run_all(page)
        assert python(page, "[name for name in ('n1', 'n2') if name in globals()]") == f"['n{n}']"
    assert len(lab.ask("/api/kernels")) == 1


def test_a_click_on_a_canvas_reaches_the_kernel_and_comes_back(page, lab, seen):
    open_notebook(page, [WIDGET, "import sys; print(sys.executable)"])
    assert run_all(page)[1].strip() == sys.executable
    click(page, 40, 30)
    page.wait_for_function("() => document.querySelector('.count').textContent === '1'")
    assert python(page, "dots.clicked") == "[40, 30]"
    assert python(page, "[dots.count, 'a\\nb']", code="dots.count = 7") == "[7, 'a\\nb']"
    page.wait_for_function("() => document.querySelector('.count').textContent === '7'")
    save(page)
    assert [cell["execution_count"] for cell in json.loads((lab.root / "test.ipynb").read_text())["cells"]] == [1, 2]
    assert (seen.errors, seen.foreign) == ([], [])


def test_latency_is_the_time_from_the_pointer_to_the_frame(page):
    open_notebook(page, [WIDGET])
    run_all(page)
    for pause, low, high in ((0, 2, 200), (0.25, 250, 450)):
        python(page, "None", code=f"Dots.pause = {pause}")
        took = measure(page, lambda k: click(page, k + 1, 9), COUNT, times=3, warm=1, pause=0.05)
        print(took)
        assert low < took.low <= took.median <= took.high
        assert took.median < high


def test_cells_run_again_and_a_restarted_kernel_knows_nothing(page):
    open_notebook(page, ["n = 1", {"cell_type": "markdown", "source": "# n"}, "n += 1; n", ""])
    assert run_all(page) == ["", "2", ""]
    assert [run_cell(page, 1), run_cell(page, 1)] == ["3", "4"]
    assert "[4]" in cell(page, 1).locator(".jp-InputArea-prompt").text_content()
    restart_kernel(page)
    assert python(page, "'n' in globals()") == "False"
    assert run_all(page) == ["", "2", ""]


def test_an_error_in_a_cell_fails_the_test_unless_it_is_wanted(page):
    open_notebook(page, ["1 / 0", "2"])
    with pytest.raises(AssertionError, match="division by zero"):
        run_all(page)
    assert run_all(page, errors=True)[0] == "ZeroDivisionError: division by zero"
    with pytest.raises(AssertionError, match="NameError: name 'm'"):
        python(page, "m")


def test_cells_out_of_sight_are_run_too_and_drawn_when_they_come_into_sight(page):
    tall = ["print('line\\n' * 30)"] * 6
    open_notebook(page, [*tall, WIDGET, *tall, "print('last')"])
    assert run_all(page)[-1].strip() == "last"
    cell(page, 6).scroll_into_view_if_needed()
    click(page, 10, 10)
    wait_until(page, "() => document.querySelector('.count').textContent === '1'")


SCRIPT = "<p class='told'>first frame</p><script>document.querySelector('.told').textContent = 'played'</script>"


def test_an_untrusted_notebook_shows_its_html_without_its_scripts(page):
    output = {"output_type": "display_data", "metadata": {}, "data": {"text/html": SCRIPT, "text/plain": "html"}}
    code = {"cell_type": "code", "execution_count": 1, "outputs": [output], "source": "show()"}
    open_notebook(page, [code], name="stranger.ipynb")
    told = page.locator(".told")
    told.wait_for()
    assert told.text_content() == "first frame"
    assert page.locator(".jp-OutputArea-output script").count() == 0
    open_notebook(page, [code], name="friend.ipynb", trusted=True)
    wait_until(page, "() => document.querySelector('.told')?.textContent === 'played'")


def test_a_file_is_opened_with_scripts_and_without_and_far_from_any_network(static_page, seen, tmp_path):
    (tmp_path / "page.html").write_text(SCRIPT + "<img src='https://example.org/a.png'><script>fetch('/b')</script>")
    assert static_page(tmp_path / "page.html").locator(".told").text_content() == "played"
    silent = static_page(tmp_path / "page.html", scripts=False, color_scheme="dark")
    assert silent.locator(".told").text_content() == "first frame"
    assert silent.evaluate("matchMedia('(prefers-color-scheme: dark)').matches")
    assert set(seen.foreign) == {"https://example.org/a.png"}


def test_errors_of_a_page_and_of_its_console_are_seen(static_page, seen, tmp_path):
    script = (
        "console.log('hm'); console.error('oh'); new WebSocket('ws://example.org');"
        "setTimeout(() => { setTimeout(() => { window.thrown = true; }); throw Error('no'); });"
    )
    (tmp_path / "page.html").write_text(f"<script>{script}</script>")
    page = static_page(tmp_path / "page.html")
    page.wait_for_function("() => window.thrown")
    assert [error.splitlines()[0] for error in seen.errors] == ["oh", "Error: no"]
    assert seen.foreign == ["ws://example.org/"]
    assert "log: hm" in seen.console
