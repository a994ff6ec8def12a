"""The students' version of a homework: solutions taken out, outputs cleared, cells of the instructor's locked."""

from __future__ import annotations

import re
from copy import deepcopy
from typing import Any

from fem_mesh.course.homework.asked import cases_of_call, given_in, names_in, refuse_unreadable
from fem_mesh.course.homework.cells import KEYS, SCHEMA, Task, homework_of, name_of, role, tasks_of
from fem_mesh.course.notebooks import NotebookError

STUB = "raise NotImplementedError()"
OPEN = "YOUR ANSWER HERE"
FOR_YOU = "instructor"  # the tag of a cell that students do not get
OURS = ("nbgrader", "tags", "jupyter", "editable", "deletable")  # metadata that answers keep
_BEGIN = re.compile(r"^(\s*)#+\s*BEGIN\s+(SOLUTION|HIDDEN\s+TESTS)\b.*$", re.IGNORECASE)
_END = re.compile(r"^\s*#+\s*END\s+(SOLUTION|HIDDEN\s+TESTS)\b.*$", re.IGNORECASE)
_MARK = re.compile(r"#+\s*(BEGIN|END)\s+(SOLUTION|HIDDEN\s+TESTS)\b", re.IGNORECASE)


def release(source: Any) -> tuple[Any, list[str]]:
    """The students' version of a notebook, and what its author should know. The notebook itself stays as it is.

    Raises NotebookError, which names the cell, where a solution would be left in, metadata are not nbgrader's, or what comes
    back could not be graded.
    """
    notebook, notes = deepcopy(source), []
    notebook.cells = [cell for at, cell in enumerate(notebook.cells) if not _is_for_you(cell, at)]
    tasks = tasks_of(notebook)
    _check_asked(notebook, tasks)
    notebook.metadata.pop("widgets", None)
    for at, cell in enumerate(notebook.cells):
        _check_metadata(cell, at)
        whole, cell.source = cell.source, without_solutions(cell.source, _place(cell, at))
        if _MARK.search(cell.source):
            raise NotebookError(f"{_place(cell, at)}: BEGIN and END SOLUTION must each stand alone on a line")
        kind = role(cell)
        if kind == "answer" and cell.source == whole:
            cell.source = STUB
            notes.append(f"{_place(cell, at)} has no BEGIN SOLUTION: all of it is taken for the solution")
        elif kind == "explain" and cell.source == whole and cell.metadata["nbgrader"].get("solution"):
            cell.source = OPEN if cell.cell_type == "markdown" else STUB
        elif kind == "given" and cell.source != whole:
            raise NotebookError(f"{_place(cell, at)} holds a solution, but is no answer cell: nbgrader's metadata say so")
        if kind in ("answer", "explain"):  # whatever else hangs on them may be a solution
            cell.pop("attachments", None)
            cell.metadata = type(cell.metadata)({key: cell.metadata[key] for key in OURS if key in cell.metadata})
        elif cell.source != whole:
            notes.append(f"{_place(cell, at)} has hidden tests: they are not run, for other cases are tried in grading anyway")
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
        if kind == "check":
            cell.metadata["editable"] = cell.metadata["deletable"] = False
        elif kind != "given":
            cell.metadata["deletable"] = False
    notes += _given_notes(notebook)
    notes += [
        f"{_place(notebook.cells[task.at], task.at)} calls no fm.check: it is marked by hand, "
        "for what runs in a student's kernel cannot be trusted to mark itself"
        for task in tasks
        if task.by_hand and role(notebook.cells[task.at]) == "check"
    ]
    return notebook, notes


def without_solutions(code: str, place: str = "the cell") -> str:
    """Code with a stub in place of each solution; hidden tests go without one.

    Raises NotebookError where a BEGIN has no END.

    >>> print(without_solutions("def f(x):\\n    # BEGIN SOLUTION\\n    return x\\n    # END SOLUTION"))
    def f(x):
        raise NotImplementedError()
    """
    kept: list[str] = []
    inside = ""
    for line in code.splitlines():
        begin, end = _BEGIN.match(line), _END.match(line)
        if begin and inside:
            raise NotebookError(f"{place}: a second BEGIN {begin[2].upper()} before the first has its END")
        if end and end[1].upper().split() != inside.split():
            raise NotebookError(f"{place}: END {end[1].upper()} without its BEGIN")
        if begin:
            inside = " ".join(begin[2].upper().split())
            kept += [begin[1] + STUB] if inside == "SOLUTION" else []
        elif end:
            inside = ""
        elif not inside:
            kept.append(line)
    if inside:
        raise NotebookError(f"{place}: BEGIN {inside} has no END")
    return "\n".join(kept)


def _given_notes(notebook: Any) -> list[str]:
    from fem_mesh.course.homework.room import ALWAYS, PICTURES, can_be_handed_out

    known = {*ALWAYS, *PICTURES, *homework_of(notebook)["uses"]}
    notes = []
    for at, cell in enumerate(notebook.cells):
        names = names_in([cell.source]) - known if cell.cell_type == "code" and role(cell) == "given" else ()
        for name in sorted(names):
            why = 'is not in "uses"' if can_be_handed_out(name) else "is never handed out"
            instead = "" if can_be_handed_out(name) else ": write its result down, as a list"
            notes.append(
                f"{_place(cell, at)} uses fm.{name}, which {why}: while homework is graded, the cell fails there{instead}"
            )
    return notes


def _is_for_you(cell: Any, at: int) -> bool:
    tags = cell.metadata.get("tags")
    if not isinstance(tags, list) or FOR_YOU not in tags:
        return False
    if role(cell) != "given":
        raise NotebookError(f'{_place(cell, at)} is tagged "{FOR_YOU}", so students would not get it, but it is theirs')
    return True


def _check_asked(notebook: Any, tasks: list[Task]) -> None:
    """Raise NotebookError for what ``grade`` could not hand out, or not judge."""
    from fem_mesh.course.homework.room import check_uses

    check_uses(homework_of(notebook)["uses"])
    given = given_in(notebook)
    for task in tasks:
        cell = notebook.cells[task.at]
        if role(cell) == "check":
            try:
                refuse_unreadable(cell.source)
            except NotebookError as error:
                raise NotebookError(f"{_place(cell, task.at)}: {error.message}") from None
        for call in task.calls:
            cases_of_call(call, 0, given)


def _check_metadata(cell: Any, at: int) -> None:
    told = cell.metadata.get("nbgrader")
    if told is None:
        return
    if not isinstance(told, dict) or told.get("schema_version") != SCHEMA:
        raise NotebookError(f"cell {at + 1}: nbgrader's metadata must have schema_version {SCHEMA}")
    strange = sorted(set(told) - KEYS)
    if strange:
        raise NotebookError(f'{_place(cell, at)}: {strange[0]!r} is no key of nbgrader\'s; our own go under "fem_mesh"')
    if role(cell) == "answer" and cell.cell_type != "code":
        raise NotebookError(f'{_place(cell, at)}: an answer in prose needs points: set "grade" to true')
    if role(cell) == "check" and cell.cell_type != "code":
        raise NotebookError(f"{_place(cell, at)}: a check must be a code cell")


def _place(cell: Any, at: int) -> str:
    return f"cell {at + 1} ({name_of(cell)})" if name_of(cell) else f"cell {at + 1}"
