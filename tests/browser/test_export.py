"""Pages without a kernel: saved traces and exported notebooks, opened far from any network, with scripts and without."""

import re
import subprocess
import sys

import pytest

import fem_mesh as fm

from .flips import CELLS, FIRST, LAST, TABLE, TRACE, where
from .notebook import KERNEL
from .shared import expect, is_picture


def steps(page, player):
    """By keys."""
    expect(player.locator(".fem-where")).to_have_text(where(0))
    player.focus()
    for key, k in (("ArrowRight", 1), ("ArrowRight", 2), ("ArrowLeft", 1), ("End", LAST), ("Home", 0)):
        page.keyboard.press(key)
        assert player.locator(".fem-where").text_content() == where(k)
        assert player.locator(".fem-caption").text_content() == TRACE[k].caption
        assert player.locator("canvas.fem-canvas").get_attribute("aria-label") == f"{where(k)}: {TRACE[k].caption}"
    assert player.get_by_role("button", name="load 500 more steps").count() == 0


def readable(still):
    """First frame, caption, and every step in words, without a script."""
    is_picture(still, FIRST)
    assert not still.locator("table").is_visible()
    still.locator("summary").click()
    assert still.locator("tbody tr").all_inner_texts() == TABLE


# ---- a saved trace -----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    path = tmp_path_factory.mktemp("saved") / "flips.html"
    TRACE.save(path)
    return path


def test_a_saved_trace_plays_without_a_network(saved, static_page, seen):
    page = static_page(saved)
    player = page.locator(".fem-player")
    steps(page, player)
    player.get_by_label("speed").select_option("8")
    player.get_by_role("button", name="play", exact=True).click()
    expect(player.locator(".fem-where")).to_have_text(where(LAST), timeout=15_000)
    assert page.title() == repr(TRACE)
    page.locator("summary").click()
    assert page.locator("tbody tr").count() == len(TRACE)
    assert page.locator(".fem-mesh").count() == 1
    assert (seen.errors, seen.foreign) == ([], [])


def test_a_saved_trace_is_readable_without_scripts(saved, static_page, seen):
    for scheme in ("light", "dark"):
        readable(static_page(saved, scripts=False, color_scheme=scheme).locator(".fem-mesh"))
    assert (seen.errors, seen.foreign) == ([], [])


def test_a_saved_trace_is_dark_where_the_reader_likes_it_dark(saved, static_page):
    page = static_page(saved, color_scheme="dark")
    page.locator(".fem-player.fem-dark").wait_for()
    page.emulate_media(color_scheme="light")
    page.locator(".fem-player:not(.fem-dark)").wait_for()


def test_captions_of_any_text_come_through(tmp_path, static_page, seen):
    code = "</script><script>throw Error('captions are no code')</script>"
    texts = ["<b>bold</b> & \"quoted\" 'twice'", code, "a²+b²≤c², 三角形", "", "$x$ \\(y\\)", "a\u2028b"]
    trace = fm.record(fm.Step(f"kind {k} <i>", text, points=[(0, 0), (1, k)], triangles=[]) for k, text in enumerate(texts))
    trace.save(tmp_path / "texts.html")
    page = static_page(tmp_path / "texts.html")
    player = page.locator(".fem-player")
    player.wait_for()
    for k, text in enumerate(texts):
        assert player.locator(".fem-where").text_content() == f"step {k} of {len(texts) - 1}, kind {k} <i>"
        assert player.locator(".fem-caption").text_content() == text
        player.press("ArrowRight")
    silent = static_page(tmp_path / "texts.html", scripts=False)
    silent.locator("summary").click()
    assert silent.locator("tbody td:nth-child(2)").all_text_contents() == [f"kind {k} <i>" for k in range(len(texts))]
    assert seen.errors == []


# ---- an exported notebook ----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """As ``jupyter nbconvert --execute --to html`` makes it, and one with another widget, to compare with."""
    import nbformat

    folder = tmp_path_factory.mktemp("exported")
    for name, cells in (("lesson", CELLS), ("plain", ["import ipywidgets\nipywidgets.IntSlider()"])):
        notebook = nbformat.v4.new_notebook(
            metadata={"kernelspec": KERNEL}, cells=[nbformat.v4.new_code_cell(cell) for cell in cells]
        )
        nbformat.write(notebook, folder / f"{name}.ipynb")
    command = [sys.executable, "-m", "nbconvert", "--to", "html", "--execute", *map(str, sorted(folder.glob("*.ipynb")))]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return folder


def test_an_exported_notebook_plays_without_a_network(exported, static_page, seen):
    static_page(exported / "plain.html")
    usual = {re.sub(r"\?.*", "", url) for url in seen.foreign}  # what nbconvert's own page asks for
    seen.errors.clear()
    page = static_page(exported / "lesson.html")
    for k in (0, 1):
        page.locator(".fem-mesh").nth(k).scroll_into_view_if_needed()  # only what is in sight plays
        steps(page, page.locator(".fem-player").nth(k))
    assert page.locator(".fem-mesh").count() == 3
    playground = page.locator(".fem-mesh").last
    playground.scroll_into_view_if_needed()
    expect(playground.get_by_text("Playground: 9 points")).to_be_visible()
    assert "the README" not in page.locator("body").inner_text()
    assert {re.sub(r"\?.*", "", url) for url in seen.foreign} <= usual
    assert [error for error in seen.errors if not re.search("ERR_FAILED|ERR_INTERNET_DISCONNECTED|require", error)] == []


def test_an_exported_notebook_is_readable_without_scripts(exported, static_page):
    page = static_page(exported / "lesson.html", scripts=False)
    for k in (0, 1):
        readable(page.locator(".fem-still").nth(k))
    assert page.locator(".fem-still").nth(2).get_by_role("img").get_attribute("alt").startswith("Playground: 9 points")
