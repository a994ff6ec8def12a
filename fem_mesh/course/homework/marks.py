"""Marks as a table: nbgrader's columns, then one for each task."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from fem_mesh.course.homework.cells import Task
from fem_mesh.course.homework.results import Result
from fem_mesh.course.notebooks import NotebookError

PERSON = ("last_name", "first_name", "email")
COLUMNS = (
    "assignment",
    "duedate",
    "timestamp",
    "student_id",
    *PERSON,
    "raw_score",
    "late_submission_penalty",
    "score",
    "max_score",
)


def read_roster(path: Path) -> dict[str, dict[str, str]]:
    """Names by student from a CSV with a column ``student_id`` and any of ``last_name``, ``first_name``, ``email``."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise NotebookError(f"{path}: no table: {error}") from None
    if not rows or "student_id" not in rows[0]:
        raise NotebookError(f"{path}: the table needs a column student_id")
    return {row["student_id"]: {name: row.get(name) or "" for name in PERSON} for row in rows}


def write_marks(
    path: Path, homework: str, tasks: Sequence[Task], results: Sequence[Result], roster: dict[str, dict[str, str]] | None = None
) -> None:
    """Write the table. A task that is marked by hand has an empty place, and is in ``max_score`` alone."""
    people = roster or {}
    temporary = path.with_name(f"{path.name}.part")
    with temporary.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow([*COLUMNS, *(task.name for task in tasks), "remark"])
        for result in results:
            person = people.get(result.student, {})
            row = [homework, "", result.submitted, result.student, *(person.get(name, "") for name in PERSON)]
            row += [_number(result.score), "0", _number(result.score), _number(result.most)]
            row += ["" if task.score is None else _number(task.score) for task in result.tasks]
            table.writerow([_harmless(place) for place in (*row, result.trouble or "; ".join(result.notes))])
    temporary.replace(path)


def _number(points: float) -> str:
    return f"{points:g}"


def _harmless(text: str) -> str:
    """Text that no spreadsheet takes for a formula."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text
