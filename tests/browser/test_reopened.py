"""Widgets whose page or kernel is gone: loaded again, restarted, or opened again as a saved notebook."""

import pytest

from .flips import CELLS, FIRST, LAST, TABLE, TRACE, where
from .notebook import KERNEL, cell, open_notebook, python, restart_kernel, run_all, run_cell, save, wait_open
from .shared import expect, is_picture

PLAYGROUNDS = (3, 4)
ALL = [*CELLS, "fm.Playground(points)"]


def only(page, i, what):
    """What of class ``fem-what`` is seen in the i-th cell's output: there is one."""
    output = cell(page, i).locator(".jp-OutputArea-output")
    output.last.evaluate("node => node.scrollIntoView()")  # only what is in sight plays
    found = output.locator(f".fem-{what}:visible")
    expect(found).to_have_count(1)
    found.evaluate("node => node.scrollIntoView()")
    return found


def alive(page, i, kind):
    """The widget in the i-th cell's output, once it is there instead of what stood in for it."""
    cell(page, i).locator(f".jp-OutputArea-output .fem-{kind}:not([data-stands-in])").wait_for()
    return only(page, i, kind)


def reads(locator, text):
    expect(locator).to_have_text(text)


def steps(page, player):
    player.focus()
    for key, k in (("Home", 0), ("ArrowRight", 1), ("End", LAST)):
        page.keyboard.press(key)
        reads(player.locator(".fem-where"), where(k))
        assert player.locator(".fem-caption").text_content() == TRACE[k].caption


def test_widgets_outlive_their_page_and_a_player_its_kernel(page, seen):
    open_notebook(page, CELLS)
    run_all(page)
    only(page, 2, "player").press("End")
    only(page, 3, "playground").get_by_role("button", name="clear").click()
    reads(only(page, 3, "playground").locator(".fem-points"), "0 points")
    save(page)
    page.reload()
    wait_open(page)
    player, playground = alive(page, 2, "player"), alive(page, 3, "playground")
    reads(player.locator(".fem-where"), where(LAST))
    assert python(page, f"player.step == {LAST}") == "True"
    reads(playground.locator(".fem-points"), "0 points")
    playground.locator("canvas").click(position={"x": 300, "y": 200})
    reads(playground.locator(".fem-points"), "1 point")
    assert python(page, "len(playground.points)") == "1"

    restart_kernel(page)
    steps(page, player)
    playground.press("v")
    playground.locator("button[aria-label=voronoi][aria-pressed=true]").wait_for()
    run_all(page)
    steps(page, only(page, 2, "player"))
    assert (seen.errors, seen.foreign) == ([], [])


def test_playgrounds_say_that_their_kernel_is_gone(page, seen):
    open_notebook(page, ["import fem_mesh as fm\nfm.Playground([(0.5, 0.5)])", "fm.DomainPlayground(fm.square())"])
    run_all(page)
    reads(only(page, 0, "playground").locator(".fem-points"), "1 point")
    reads(only(page, 1, "domain-playground").locator(".fem-triangles"), "2 triangles")
    restart_kernel(page)
    playground, domains = only(page, 0, "playground"), only(page, 1, "domain-playground")
    domains.get_by_label("smallest angle", exact=True).fill("30")
    expect(domains.locator(".fem-status")).to_contain_text("the kernel does not answer")
    playground.locator("canvas").click(position={"x": 300, "y": 30})
    expect(playground.locator(".fem-caption")).to_contain_text("kernel")
    assert playground.locator(".fem-points").text_content() == "1 point"
    assert (seen.errors, seen.foreign) == ([], [])


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """A notebook with the outputs of a run, as a lab saves it: without the widgets' models."""
    import nbformat
    from nbclient import NotebookClient

    cells = [nbformat.v4.new_code_cell(source) for source in ALL]
    notebook = nbformat.v4.new_notebook(cells=cells, metadata={"kernelspec": KERNEL})
    NotebookClient(notebook, store_widget_state=False).execute()
    path = tmp_path_factory.mktemp("saved") / "saved.ipynb"
    nbformat.write(notebook, path)
    return path


def test_a_saved_notebook_that_is_not_trusted_shows_pictures_and_words(page, seen, saved):
    open_notebook(page, path=saved)
    for i in (1, 2):
        still = only(page, i, "still")
        is_picture(still, FIRST)
        still.locator("summary").click()
        assert still.locator("tbody tr").all_inner_texts() == TABLE
    is_picture(only(page, 3, "still"), "Playground: 9 points")
    assert (seen.errors, seen.foreign) == ([], [])


def test_a_saved_notebook_that_is_trusted_plays_and_lives_again_cell_by_cell(page, seen, saved):
    open_notebook(page, path=saved, trusted=True)
    for i in (1, 2):
        steps(page, only(page, i, "player"))
        only(page, i, "mesh").locator("summary").click()
        assert only(page, i, "mesh").locator("tbody tr").count() == len(TRACE)
    for i in PLAYGROUNDS:
        is_picture(only(page, i, "still"), "Playground: 9 points")
    lost = page.get_by_text("model not found")
    expect(lost).to_have_count(3)
    expect(lost.filter(visible=True)).to_have_count(0)

    run_cell(page, 0)
    run_cell(page, 3)
    reads(only(page, 3, "playground").locator(".fem-points"), "9 points")
    only(page, 3, "mesh")
    is_picture(only(page, 4, "still"), "Playground: 9 points")  # it looks like the one that lives
    run_all(page)
    for i, kind in ((2, "player"), (3, "playground"), (4, "playground")):
        only(page, i, kind)
        only(page, i, "mesh")
    told = [error for error in seen.errors if "widget model not found" not in error]
    assert (told, seen.foreign) == ([], [])
