"""Lessons run in JupyterLab, from the first cell to the last: the others differ in what nbval and the exports see."""

from pathlib import Path

import pytest

from .notebook import cell, js, open_notebook, run_all

LESSONS = Path(__file__).parents[2] / "notebooks"
OURS = """() => cells.flatMap((cell, i) => {
    const data = cell.model.outputs.toJSON().map(output => output.data ?? {});
    return data.some(data => String(data["text/html"] ?? "").includes("fem-mesh")) ? [i] : [];
})"""


@pytest.mark.parametrize("lesson", ["00_live_coding", "01_empty_circle", "02_lawson_flips"])
def test_a_lesson_runs_to_its_end_without_an_error_and_without_the_network(lesson, page, seen):
    open_notebook(page, path=LESSONS / f"{lesson}.ipynb", name=f"{lesson}.ipynb")
    run_all(page)
    for i in js(page, OURS):
        js(page, "i => notebook.scrollToCell(cells[i])", i)
        ours = cell(page, i).locator(".fem-mesh:visible")
        ours.locator("canvas").first.wait_for()
        assert ours.count() == 1, f"code cell {i} shows one player or playground"
    assert (seen.errors, seen.foreign) == ([], [])
