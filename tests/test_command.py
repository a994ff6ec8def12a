"""The command ``fem-mesh``: blank copies of the lessons, and runs of notebooks as they are kept."""

import ast
import json
import re
import sys
from pathlib import Path

import nbformat
import pytest
from click.testing import CliRunner
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output

from fem_mesh.course.command import main
from fem_mesh.course.notebooks import VIEW, without_solutions

LESSONS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))
SOLUTION = re.compile("<details>.*?</details>", re.DOTALL)


def call(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def write(path, *cells, **metadata):
    notebook = new_notebook(cells=[cell if hasattr(cell, "cell_type") else new_code_cell(cell) for cell in cells])
    notebook.metadata.update(metadata)
    for k, cell in enumerate(notebook.cells):
        cell.id = f"cell-{k}"
    path.write_text(nbformat.writes(notebook) + "\n", encoding="utf-8")
    return path


def read(path):
    return nbformat.read(path, as_version=4)


# ---- blank copies ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def copies(tmp_path_factory):
    folder = tmp_path_factory.mktemp("room") / "live" / "today"
    result = call("blank", *LESSONS, "-o", folder)
    assert result.exit_code == 0, result.output
    assert result.output.split() == [word for path in LESSONS for word in ("wrote", str(folder / path.name))]
    return folder


@pytest.mark.parametrize("path", LESSONS, ids=lambda path: path.stem)
def test_a_blank_lesson_keeps_its_prose_and_its_imports_and_no_answer(path, copies):
    lesson, copy = read(path), read(copies / path.name)
    nbformat.validate(copy)
    assert len(lesson.cells) == len(copy.cells) > 10
    typed = [cell for cell in copy.cells if cell.cell_type == "code"]
    given = [cell for cell in lesson.cells if cell.cell_type == "code"]
    assert typed[0].source == given[0].source
    assert all(isinstance(line, ast.Import | ast.ImportFrom) for line in ast.parse(typed[0].source).body)
    for cell in typed[1:]:
        assert {name: cell[name] for name in ("source", "outputs", "metadata", "execution_count")} == {
            "source": "", "outputs": [], "metadata": {}, "execution_count": None
        }  # fmt: skip
    for old, new in zip(lesson.cells, copy.cells, strict=True):
        if old.cell_type == "markdown":
            assert "".join(new.source.split()) == "".join(SOLUTION.sub("", old.source).split())
    text, known = (copies / path.name).read_text(encoding="utf-8"), typed[0].source
    answers = [cell.source for cell in given[1:]]
    answers += [fold for cell in lesson.cells if cell.cell_type == "markdown" for fold in SOLUTION.findall(cell.source)]
    lines = {line.strip() for answer in answers for line in answer.splitlines() if len(line.split()) > 2}
    assert len(lines) > 10
    assert [line for line in lines if json.dumps(line)[1:-1] in text and line not in known] == []
    assert not {cell.id for cell in given[1:]} & {cell.id for cell in copy.cells}


def test_a_cell_tagged_keep_stays_without_its_outputs_and_slides_stay_slides(tmp_path):
    slide = {"slideshow": {"slide_type": "slide"}}
    kept = new_code_cell("tools = 1", metadata={"tags": ["keep"]}, execution_count=2, outputs=[new_output("stream", text="1")])
    told = new_code_cell("1 / 0", metadata={"tags": ["raises-exception"], **slide})
    path = write(tmp_path / "a.ipynb", "import fem_mesh as fm", kept, told, widgets={VIEW: {"state": {}}})
    assert call("blank", path, "-o", tmp_path / "live").exit_code == 0
    copy = read(tmp_path / "live" / "a.ipynb")
    assert [cell.source for cell in copy.cells] == ["import fem_mesh as fm", "tools = 1", ""]
    assert (copy.cells[1].outputs, copy.cells[1].execution_count) == ([], None)
    assert (copy.cells[2].metadata, copy.metadata) == (slide, {})


def test_what_is_folded_goes_however_it_is_folded():
    assert without_solutions("a <DETAILS open>b <details>c</details> d</details> e") == "a  e"
    assert without_solutions("a\n\n<details>\nnever closed") == "a"
    assert without_solutions("details of a\n\n\n\nb") == "details of a\n\nb"


def test_a_cell_of_solutions_alone_goes_whole(tmp_path):
    path = write(tmp_path / "a.ipynb", "import math", new_markdown_cell("<details>\n\nSeven.\n</details>"), "7")
    call("blank", path, "-o", tmp_path / "live")
    assert [cell.cell_type for cell in read(tmp_path / "live" / "a.ipynb").cells] == ["code", "code"]


def test_a_notebook_is_never_written_over_by_its_copy(tmp_path):
    path = write(tmp_path / "a.ipynb", "import math", "7")
    before = path.read_bytes()
    (tmp_path / "door").symlink_to(tmp_path, target_is_directory=True)
    for folder in (tmp_path, tmp_path / "door", tmp_path / "live" / ".."):
        result = call("blank", path, "-o", folder, "--force")
        assert result.exit_code == 1
        assert "is the notebook itself" in result.output
        assert path.read_bytes() == before


def test_a_copy_that_was_typed_into_is_written_over_only_by_force(tmp_path):
    path, copy = write(tmp_path / "a.ipynb", "import math", "7"), tmp_path / "live" / "a.ipynb"
    assert call("blank", path, "-o", copy.parent).exit_code == 0
    copy.write_text("typed")
    result = call("blank", path, "-o", copy.parent)
    assert (result.exit_code, copy.read_text()) == (1, "typed")
    assert "is there already" in result.output
    assert call("blank", path, "-o", copy.parent, "--force").exit_code == 0
    assert read(copy).cells[1].source == ""


def test_two_notebooks_of_one_name_do_not_become_one_copy(tmp_path):
    (tmp_path / "b").mkdir()
    paths = write(tmp_path / "a.ipynb", "1"), write(tmp_path / "b" / "a.ipynb", "2")
    result = call("blank", *paths, "-o", tmp_path / "live")
    assert result.exit_code == 1
    assert "two of the notebooks are called a.ipynb" in result.output
    assert not (tmp_path / "live").exists()


# ---- runs ------------------------------------------------------------------------------------------

PLAYED = """
points = fm.random_points(5, seed=1)
player = fm.play(fm.lawson(points, fm.any_triangulation(points)))
player
"""


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A notebook that has been run, the bytes of its file then, and what a second run said."""
    folder = tmp_path_factory.mktemp("course")
    (folder / "beside.txt").write_text("read from beside")
    path = write(
        folder / "small.ipynb", "import sys\nimport ipywidgets\nimport fem_mesh as fm", PLAYED, "player.trace",
        "print(1, flush=True)\nprint('fem_mesh: compiling it', file=sys.stderr, flush=True)\nprint(2)", "",
        "ipywidgets.IntSlider()", "print(open('beside.txt').read(), sys.executable)", "fm.Playground()",
        kernelspec={"name": "python3", "display_name": "mine", "language": "python"}, widgets={VIEW: {"state": {}}},
    )  # fmt: skip
    first = call("run", path)
    assert (first.exit_code, first.output.split(":")[0]) == (0, f"saved {path}"), first.output
    before = path.read_bytes()
    return path, before, call("run", path)


def test_a_second_run_changes_nothing(kept):
    path, before, again = kept
    assert (again.exit_code, again.output.split(":")[0]) == (0, f"unchanged {path}")
    assert path.read_bytes() == before


def test_a_run_is_kept_without_what_dies_with_its_kernel(kept):
    notebook = read(kept[0])
    nbformat.validate(notebook)
    assert VIEW not in kept[0].read_text(encoding="utf-8")
    assert notebook.metadata == {"kernelspec": {"name": "python3", "display_name": "mine", "language": "python"}}
    assert all(cell.metadata == {} for cell in notebook.cells)
    assert [cell.execution_count for cell in notebook.cells] == [1, 2, 3, 4, None, 5, 6, 7]


def test_the_still_of_a_widget_stays_and_a_player_stays_playable(kept):
    _, played, traced, *_, empty = read(kept[0]).cells
    for cell, stands_in in ((played, True), (traced, False), (empty, True)):
        (output,) = cell.outputs
        assert set(output.data) == {"text/html", "text/plain"}
        assert ('fem-still" data-stands-in=' in output.data["text/html"]) is stands_in
        assert ("fem-data" in output.data["text/html"]) is (cell is not empty)


def test_streams_are_whole_and_the_kernel_is_this_python_in_the_notebooks_folder(kept):
    _, _, _, printed, blank, slider, beside, _ = read(kept[0]).cells
    assert [output.text for output in printed.outputs] == ["1\n2\n"]
    assert blank.outputs == []
    assert list(slider.outputs[0].data) == ["text/plain"]
    assert beside.outputs[0].text == f"read from beside {sys.executable}\n"


def test_a_failing_cell_is_named_and_its_notebook_stays_as_it_was(tmp_path):
    path = write(tmp_path / "a.ipynb", "x = 1", new_markdown_cell("why"), "\nx / 0  # here", "print('later')")
    before = path.read_bytes()
    result = call("run", path)
    assert result.exit_code == 1
    assert f"{path}, code cell 2 (cell-2), which begins 'x / 0  # here': ZeroDivisionError: division by zero" in result.output
    assert path.read_bytes() == before


def test_a_cell_that_does_not_end_is_named_too(tmp_path):
    path = write(tmp_path / "a.ipynb", "while True:\n    pass")
    result = call("run", path, "--timeout", 1)
    assert result.exit_code == 1
    assert "code cell 1 (cell-0), which begins 'while True:': not done after 1 seconds" in result.output


def test_a_file_that_is_no_notebook_is_named(tmp_path):
    (tmp_path / "a.ipynb").write_text("import fem_mesh")
    for command in (["run"], ["blank", "-o", tmp_path / "live"]):
        result = call(*command, tmp_path / "a.ipynb")
        assert result.exit_code == 1
        assert f"{tmp_path / 'a.ipynb'}: no notebook" in result.output


@pytest.mark.parametrize("name", ["nbformat", "nbclient"])
def test_without_jupyter_the_command_says_what_to_install(tmp_path, monkeypatch, name):
    path = write(tmp_path / "a.ipynb", "1")
    monkeypatch.setitem(sys.modules, name, None)
    result = call("run", path)
    assert result.exit_code == 1
    assert f'{name} is missing: pip install "fem_mesh[course]"' in result.output
