"""Students' versions: nothing of a solution is left, and what would leave it in is refused."""

import copy
import json

import nbformat
import pytest
from classroom import ORIENT, call, cell, source
from nbformat.v4 import new_code_cell, new_output

from fem_mesh.course.homework.cells import calls_in, metadata, tasks_of
from fem_mesh.course.homework.new import starter
from fem_mesh.course.homework.release import release
from fem_mesh.course.notebooks import NotebookError


def test_the_students_version_has_no_solution_no_output_and_all_else():
    notebook = source()
    for each in notebook.cells:
        if each.cell_type == "code":
            each.outputs, each.execution_count = [new_output("stream", text="Fraction")], 3
    before = copy.deepcopy(notebook)
    version, notes = release(notebook)
    assert (notebook, notes) == (before, [])
    nbformat.validate(version)
    assert cell(version, "a-orient").source == "def orient(a, b, c):\n    raise NotImplementedError()"
    assert cell(version, "explain").source == "YOUR ANSWER HERE"
    text = nbformat.writes(version)
    assert not [word for word in ("Fraction", "SOLUTION", "rounding") if word in text]
    for old, new in zip(notebook.cells, version.cells, strict=True):
        assert (old.id, old.cell_type, old.metadata.get("nbgrader")) == (new.id, new.cell_type, new.metadata.get("nbgrader"))
        if old.id not in ("a-orient", "a-circle", "explain"):
            assert new.source == old.source
    assert cell(version, "c-orient").metadata.editable is False
    assert release(version)[0] == version or "no BEGIN SOLUTION" in release(version)[1][0]


def test_solutions_may_be_parts_marked_in_nbgraders_way_and_hidden_tests_go():
    notebook = source()
    answer = cell(notebook, "a-orient")
    answer.source = (
        "x = 1\n### BEGIN SOLUTION\ny = 2\n### END SOLUTION\nz = 3\nif z:\n\t# begin solution\n\tw = 4\n\t# end solution"
    )
    cell(notebook, "c-orient").source += "\n### BEGIN HIDDEN TESTS\nassert y == 2\n### END HIDDEN TESTS"
    version, notes = release(notebook)
    assert notes == ["cell 5 (check-orient) has hidden tests: they are not run, for other cases are tried in grading anyway"]
    stub = "raise NotImplementedError()"
    assert cell(version, "a-orient").source == f"x = 1\n{stub}\nz = 3\nif z:\n\t{stub}"
    assert cell(version, "c-orient").source == "fm.check.orient(orient)"


def test_an_answer_without_marks_is_a_solution_as_a_whole_and_this_is_said():
    notebook = source()
    cell(notebook, "a-orient").source = ORIENT
    version, notes = release(notebook)
    assert cell(version, "a-orient").source == "raise NotImplementedError()"
    assert notes == ["cell 4 (orient) has no BEGIN SOLUTION: all of it is taken for the solution"]


def test_a_check_that_runs_in_the_students_kernel_alone_is_marked_by_hand():
    notebook = source()
    cell(notebook, "c-orient").source = "assert orient((0, 0), (1, 0), (0, 1)) > 0"
    version, notes = release(notebook)
    assert "calls no fm.check" in notes[0]
    assert [task.by_hand for task in tasks_of(version)] == [True, False, True]


@pytest.mark.parametrize(
    ("cell_id", "change", "message"),
    [
        ("a-orient", {"source": "# BEGIN SOLUTION\nx = 1"}, "cell 4 .orient.: BEGIN SOLUTION has no END"),
        ("a-orient", {"source": "x = 1\n# END SOLUTION"}, "END SOLUTION without its BEGIN"),
        ("a-orient", {"source": "# BEGIN SOLUTION\n# BEGIN SOLUTION\n# END SOLUTION"}, "a second BEGIN SOLUTION"),
        ("a-orient", {"source": "x = 1  # BEGIN SOLUTION\nx = 2\n# END SOLUTION"}, "END SOLUTION without its BEGIN"),
        ("a-orient", {"source": "x = 1  # BEGIN SOLUTION"}, "must each stand alone on a line"),
        ("imports", {"source": "# BEGIN SOLUTION\nx = 1\n# END SOLUTION"}, "cell 2 holds a solution, but is no answer cell"),
        ("c-orient", {"metadata": metadata("check", "check orient", 2)}, "its grade_id is 'check orient'"),
        ("c-orient", {"metadata": metadata("check", "in-circle", 2)}, "several cells are called 'in-circle'"),
        ("c-orient", {"metadata": metadata("check", "check-orient", -1)}, "points must be a number from 0 on, not -1"),
        ("c-orient", {"metadata": metadata("check", "check-orient", True)}, "points must be a number"),
        ("c-orient", {"cell_type": "markdown"}, "a check must be a code cell"),
        ("a-orient", {"cell_type": "markdown"}, "an answer in prose needs points"),
    ],
)  # fmt: skip
def test_what_would_go_wrong_is_refused_with_its_place(cell_id, change, message):
    notebook = source()
    cell(notebook, cell_id).update(nbformat.from_dict(change))
    with pytest.raises(NotebookError, match=message):
        release(notebook)


def test_metadata_are_nbgraders_and_nothing_more():
    notebook = source()
    cell(notebook, "c-orient").metadata.nbgrader["hint"] = "x"
    with pytest.raises(NotebookError, match="'hint' is no key of nbgrader's"):
        release(notebook)
    notebook = source()
    cell(notebook, "c-orient").metadata.nbgrader["schema_version"] = 2
    with pytest.raises(NotebookError, match="schema_version 3"):
        release(notebook)
    with pytest.raises(NotebookError, match="no cell is worth points"):
        release(nbformat.v4.new_notebook(cells=[new_code_cell("1")]))


def test_the_command_never_writes_over_the_solutions(tmp_path):
    path = tmp_path / "hw.ipynb"
    nbformat.write(source(), path)
    before = path.read_bytes()
    for options in ([], ["--force"]):
        result = call("homework", "release", path, "-o", tmp_path, *options)
        assert result.exit_code == 1
        assert "is the notebook with the solutions" in result.output
    assert path.read_bytes() == before
    assert call("homework", "release", path, "-o", tmp_path / "out").exit_code == 0
    again = call("homework", "release", path, "-o", tmp_path / "out")
    assert again.exit_code == 1
    assert "is there already" in again.output
    assert call("homework", "release", path, "-o", tmp_path / "out", "--force").exit_code == 0


def test_nothing_hangs_on_an_answer_that_could_be_its_solution():
    notebook = source()
    cell(notebook, "explain").attachments = {"solution.png": {"image/png": "aGVsbG8="}}
    cell(notebook, "a-orient").metadata |= {"comment": "use Fraction", "tags": ["x"]}
    version, _ = release(notebook)
    assert "solution.png" not in json.dumps(version)
    assert "use Fraction" not in json.dumps(version)
    assert cell(version, "a-orient").metadata.tags == ["x"]


@pytest.mark.parametrize(
    ("check", "message"),
    [
        ("for f in (orient, orient): fm.check.orient(f)", r"cell 5 .check-orient.: fm.check.orient\(f\) stands in a loop"),
        ("(lambda: fm.check.orient(orient))()", "stands in a loop or a function"),
        ("from fem_mesh.check import orient as chk\nchk(orient)", "write each call as fm.check.orient"),
        ("c = fm.check\nc.orient(orient)", "fm.check: write each call as"),
    ],
)
def test_a_check_that_the_grader_cannot_read_off_is_refused(check, message):
    notebook = source()
    cell(notebook, "c-orient").source = check
    with pytest.raises(NotebookError, match=message):
        release(notebook)


def test_a_given_cell_that_would_fail_when_graded_is_told():
    notebook = source()
    cell(notebook, "imports").source += "\nfrom fem_mesh import refine\nx = fm.delaunay(fm.random_points(9, seed=1))\nfm.orient"
    assert release(notebook)[1] == [
        "cell 2 uses fm.delaunay, which is never handed out: while homework is graded, the cell fails there: write its result "
        "down, as a list",
        'cell 2 uses fm.orient, which is not in "uses": while homework is graded, the cell fails there',
        "cell 2 uses fm.refine, which is never handed out: while homework is graded, the cell fails there: write its result "
        "down, as a list",
    ]


@pytest.mark.parametrize(
    ("uses", "check", "message"),
    [
        (["orient", "delaunay"], "fm.check.orient(orient)", "'delaunay', which meshes or needs what does"),
        (["nothing"], "fm.check.orient(orient)", "'nothing', which fem_mesh does not hand out"),
        ([], "fm.check.nothing(orient)", r"fm.check.nothing\(orient\)"),
        ([], "fm.check.mesh(p, t)", "say what is to be meshed"),
    ],
)
def test_what_could_not_be_graded_is_not_released(uses, check, message):
    notebook = source()
    notebook.metadata.fem_mesh["uses"] = uses
    cell(notebook, "c-orient").source = check
    with pytest.raises(NotebookError, match=message):
        release(notebook)


def test_students_do_not_get_a_cell_for_the_instructor():
    notebook = source()
    notebook.cells.insert(1, new_code_cell("mine = 1", metadata={"tags": ["keep", "instructor"]}))
    version, _ = release(notebook)
    assert [each.id for each in version.cells] == [each.id for each in source().cells]
    assert [task.at for task in tasks_of(version)] == [task.at for task in tasks_of(source())]
    cell(notebook, "c-orient").metadata["tags"] = ["instructor"]
    with pytest.raises(NotebookError, match=r"cell 6 .check-orient. is tagged .instructor., so students would not get it"):
        release(notebook)


def test_a_new_homework_can_be_released_as_it_is(tmp_path):
    path = tmp_path / "hw6.ipynb"
    assert "next: fem-mesh homework release" in call("homework", "new", path).output
    assert call("homework", "new", path).exit_code == 1
    assert "ends in .ipynb" in call("homework", "new", tmp_path / "hw6").output
    version, notes = release(nbformat.read(path, as_version=4))
    assert notes == []
    assert "Fraction" not in json.dumps(version)
    assert "For you" in path.read_text()
    assert "For you" not in json.dumps(version)
    nbformat.validate(starter("a"))


def test_calls_are_read_from_code_that_is_never_run():
    code = "if x:\n    fem_mesh.check.lawson(g)\ncheck.orient(f); fm.check.mesh(p, t, min_angle=25)"
    assert [call.name for call in calls_in(code)] == ["lawson", "orient", "mesh"]
    assert list(calls_in("%matplotlib inline")) == list(calls_in("x.checks.orient(f)")) == []
