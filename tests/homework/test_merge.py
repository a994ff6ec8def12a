"""Answers find their cells, whatever has become of them; nothing else of a submission counts."""

import copy

import pytest
from classroom import IN_CIRCLE, ORIENT, cell, source
from hypothesis import given
from hypothesis import strategies as st
from nbformat.v4 import new_code_cell, new_markdown_cell

from fem_mesh.course.homework.merge import merge
from fem_mesh.course.homework.release import release

RELEASED = release(source())[0]
CHECKS = ["fm.check.orient(orient)", "fm.check.in_circle(in_circle)"]


def answered():
    notebook = copy.deepcopy(RELEASED)
    cell(notebook, "a-orient").source, cell(notebook, "a-circle").source = ORIENT, IN_CIRCLE
    cell(notebook, "explain").source = "Rounding."
    return notebook


def code(merged):
    return [source for source, _ in merged.cells]


def test_answers_go_where_they_belong():
    merged = merge(RELEASED, answered())
    assert code(merged) == ["import fem_mesh as fm", ORIENT, CHECKS[0], IN_CIRCLE, CHECKS[1]]
    assert merged.notes == []
    assert merged.answers == {"orient": ORIENT, "in-circle": IN_CIRCLE, "explain": "Rounding."}
    assert merged.code == {"orient": ORIENT, "in-circle": IN_CIRCLE}


def position(notebook, cell_id):
    return next(k for k, each in enumerate(notebook.cells) if each.get("id") == cell_id)


def retyped(notebook):
    cell(notebook, "a-orient").cell_type = "markdown"
    cell(notebook, "c-orient").cell_type = "raw"


def retagged(notebook):
    for each in notebook.cells:
        each.metadata = {"tags": ["nbval-skip"]}


def without_ids(notebook):
    for each in notebook.cells:
        each.pop("id")


def without_ids_and_marks(notebook):
    without_ids(notebook)
    retagged(notebook)


def duplicated(notebook):
    at = position(notebook, "a-orient")
    twin = copy.deepcopy(notebook.cells[at])
    twin.id, twin.source = "twin", cell(RELEASED, "a-orient").source
    notebook.cells.insert(at + 1, twin)


def answered_in_the_copy(notebook):
    duplicated(notebook)
    cell(notebook, "twin").source = cell(notebook, "a-orient").source
    cell(notebook, "a-orient").source = cell(RELEASED, "a-orient").source


def replaced(notebook):
    notebook.cells[position(notebook, "a-orient")] = new_code_cell(ORIENT)


def shuffled(notebook):
    notebook.cells.reverse()


def checks_gone(notebook):
    notebook.cells = [each for each in notebook.cells if not each.id.startswith("c-")]


def checks_changed(notebook):
    cell(notebook, "c-orient").source = "# NBVAL_SKIP\npass"
    cell(notebook, "c-circle").metadata.nbgrader.points = 1000


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (retyped, "orient was no code cell any more"),
        (retagged, "orient had lost its mark"),
        (without_ids, ""),
        (without_ids_and_marks, "orient was not found; your cell at its position was run"),
        (duplicated, "orient stands there 2 times"),
        (answered_in_the_copy, "orient stands there 2 times"),
        (replaced, "orient was not found; your cell at its position was run"),
        (shuffled, ""),
        (checks_gone, ""),
        (checks_changed, "the cell check-orient is not yours to change"),
    ],
)
def test_what_becomes_of_cells_does_not_change_what_is_run(change, told):
    notebook = answered()
    change(notebook)
    merged = merge(RELEASED, notebook)
    assert code(merged) == ["import fem_mesh as fm", ORIENT, CHECKS[0], IN_CIRCLE, CHECKS[1]]
    assert told in "; ".join(merged.notes)
    assert bool(merged.notes) == bool(told)


def test_the_parts_of_a_split_cell_run_in_order():
    notebook = answered()
    at = position(notebook, "a-orient")
    first, rest = "from fractions import Fraction", "def orient(a, b, c):\n    return 1"
    notebook.cells[at].source = first
    part = copy.deepcopy(notebook.cells[at])
    part.id, part.source = "part", rest
    notebook.cells[at + 1 : at + 1] = [part, new_code_cell("helper = 1"), new_markdown_cell("A remark.")]
    assert code(merge(RELEASED, notebook))[1:5] == [first, rest, "helper = 1", CHECKS[0]]


def test_a_deleted_answer_is_missing_and_no_solution_takes_its_place():
    notebook = answered()
    del notebook.cells[position(notebook, "a-orient")]
    merged = merge(RELEASED, notebook)
    assert code(merged) == ["import fem_mesh as fm", CHECKS[0], IN_CIRCLE, CHECKS[1]]
    assert merged.notes == ["orient was not found: it was deleted or renamed"]


def test_cells_of_ones_own_run_where_they_stand_and_never_count_as_checks():
    notebook = answered()
    notebook.cells.insert(0, new_code_cell("import math"))
    notebook.cells.append(new_code_cell("fm.check.orient(orient)  # mine"))
    merged = merge(RELEASED, notebook)
    assert merged.cells[0] == ("import math", -1)
    assert merged.cells[-1] == ("fm.check.orient(orient)  # mine", -1)
    assert merged.added == ["import math", "fm.check.orient(orient)  # mine"]


def imported(notebook):
    cell(notebook, "imports").source = "import math\nimport fem_mesh as fm\nfrom itertools import combinations as c\n"


def imported_and_changed(notebook):
    imported(notebook)
    cell(notebook, "imports").source += "def helper(x):\n    import os\n    return x\nfm.check.orient = print\nif 1: import sys"


def imported_into_a_check(notebook):
    cell(notebook, "c-orient").source = "import math\nfm.check.orient(orient)"


def no_python(notebook):
    cell(notebook, "imports").source = "import math\n%matplotlib inline"


ADDED = "import math\nfrom itertools import combinations as c"


@pytest.mark.parametrize(
    ("change", "added", "told"),
    [
        (imported, [ADDED], []),
        (imported_and_changed, [ADDED], ["the cell imports is not yours to change: it was run as it was handed out, and after "
                                         "it the imports that you added"]),
        (imported_into_a_check, [], ["the cell check-orient is not yours to change: it was run as it was handed out"]),
        (no_python, [], ["the cell imports is not yours to change: it was run as it was handed out"]),
    ],
)  # fmt: skip
def test_imports_that_were_added_to_a_given_cell_run_after_it_and_nothing_else_of_it(change, added, told):
    notebook = answered()
    change(notebook)
    merged = merge(RELEASED, notebook)
    assert code(merged) == ["import fem_mesh as fm", *added, ORIENT, CHECKS[0], IN_CIRCLE, CHECKS[1]]
    assert merged.added == added  # so the scan reads them, too
    assert merged.notes == told
    assert bool(merged.dropped) == bool(told)


def test_imports_that_were_added_are_not_taken_for_an_answer():
    notebook = answered()
    imported(notebook)
    del notebook.cells[position(notebook, "a-orient")]
    assert merge(RELEASED, notebook).notes == ["orient was not found: it was deleted or renamed"]


def test_a_copy_below_the_check_runs_where_it_stands():
    notebook = answered()
    notebook.cells.append(copy.deepcopy(notebook.cells[position(notebook, "a-orient")]))
    notebook.cells[-1].id, notebook.cells[-1].source = "draft", "def orient(a, b, c):\n    return 1"
    assert code(merge(RELEASED, notebook)) == [
        "import fem_mesh as fm",
        ORIENT,
        CHECKS[0],
        IN_CIRCLE,
        CHECKS[1],
        notebook.cells[-1].source,
    ]
    cell(notebook, "a-orient").source = cell(RELEASED, "a-orient").source  # then it is the answer
    assert code(merge(RELEASED, notebook))[1] == notebook.cells[-1].source


def test_another_cell_before_a_deleted_answer_does_not_pass_for_it():
    notebook = answered()
    at = position(notebook, "a-orient")
    notebook.cells[at] = new_code_cell('print("hello")')
    assert merge(RELEASED, notebook).notes == ["orient was not found: it was deleted or renamed"]


def test_any_number_of_cells_of_ones_own_hides_no_answer():
    notebook = answered()
    notebook.cells[1:1] = [new_code_cell("1") for _ in range(3000)]
    merged = merge(RELEASED, notebook)
    assert code(merged)[-5:] == ["import fem_mesh as fm", ORIENT, CHECKS[0], IN_CIRCLE, CHECKS[1]]
    assert len(merged.cells) == 305
    assert merged.notes == ["of the cells that you added, the first 300 were run"]


KEYS = st.sampled_from(["cells", "id", "source", "metadata", "cell_type", "nbgrader", "grade_id"])
PLAIN = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5)
JSON = st.recursive(
    PLAIN | st.sampled_from(["a-orient", "orient", "code", "markdown"]),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(KEYS, inner),
    max_leaves=20,
)


@given(cells=st.lists(st.dictionaries(KEYS, JSON) | JSON, max_size=6))
def test_any_json_at_all_can_be_merged(cells):
    merged = merge(RELEASED, {"cells": cells})
    ours = [source for source, at in merged.cells if at >= 0 and RELEASED.cells[at].id in ("imports", "c-orient", "c-circle")]
    assert ours == ["import fem_mesh as fm", *CHECKS]
