"""Marks as a table: nbgrader's columns, then one for each task, then a remark, then the instructor's own.

An instructor types points for open questions into the table, so it is read before it is written anew: what only a person
can know is kept. What the grader finds is the grader's, and a table in which that was changed is not written over.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fem_mesh.course.homework.cells import Task
from fem_mesh.course.homework.results import Result, clean, write
from fem_mesh.course.notebooks import NotebookError

PERSON = ("last_name", "first_name", "email")
PENALTY = "late_submission_penalty"
COLUMNS = ("assignment", "duedate", "timestamp", "student_id", *PERSON, "raw_score", PENALTY, "score", "max_score")
REMARK = "remark"
_FORMULA = re.compile(r"(^|;)(?=[=+\-@\t\r])")
ELSE = "name another table with --csv"


@dataclass(frozen=True)
class Typed:
    """What an instructor typed into a student's row: points by task, a penalty, and columns of their own."""

    points: Mapping[str, float] = field(default_factory=dict)
    penalty: float = 0
    more: Mapping[str, str] = field(default_factory=dict)

    def __bool__(self) -> bool:
        return bool(self.points or self.penalty or any(self.more.values()))


def read_roster(path: Path) -> dict[str, dict[str, str]]:
    """Names by student from a CSV with a column ``student_id`` and any of ``last_name``, ``first_name``, ``email``."""
    rows = _rows(path)
    if not rows or "student_id" not in rows[0]:
        raise NotebookError(f"{path}: the table needs a column student_id")
    return {row["student_id"]: {name: row.get(name) or "" for name in PERSON} for row in rows}


def read_typed(
    path: Path, homework: str, tasks: Sequence[Task], students: Collection[str], written: Path
) -> dict[str, Typed]:  # fmt: skip
    """What was typed into the table ``path`` since it was written, by student, if it is there. ``written`` is its copy.

    Raises NotebookError where the table is not this homework's, or where something would be lost: points of one who is not
    among ``students``, or what stands in a check's column.
    """
    if not path.exists():
        return {}
    rows = _rows(path)
    if any("student_id" not in row or "assignment" not in row for row in rows):
        raise NotebookError(f"{path} is there already, and is no table of marks: {ELSE}")
    other = next((row["assignment"] for row in rows if row["assignment"] != _harmless(homework)), None)
    if other is not None:
        raise NotebookError(f"{path} is the table of {other}, not of {homework}: {ELSE}")
    before = {row["student_id"]: row for row in (_rows(written) if written.exists() else [])}
    for row in rows:
        _refuse_changes(path, row, before.get(row["student_id"], {}), tasks)
    typed = {row["student_id"]: _typed(path, row, tasks) for row in rows}
    here = {_harmless(student) for student in students}
    gone = sorted(name for name, what in typed.items() if what and name not in here)
    if gone:
        raise NotebookError(f"{path} holds what you typed for {gone[0]}, of whom there is nothing here: {ELSE}")
    return typed


def write_marks(
    path: Path,
    homework: str,
    tasks: Sequence[Task],
    results: Sequence[Result],
    roster: Mapping[str, Mapping[str, str]] | None = None,
    typed: Mapping[str, Typed] | None = None,
) -> None:
    """Write the table. A task that waits for marks by hand has an empty place, and is in ``max_score`` alone."""
    people, typed = roster or {}, typed or {}
    more = list(dict.fromkeys(name for what in typed.values() for name in what.more))
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow([*COLUMNS, *(task.name for task in tasks), REMARK, *more])
    for result in results:
        person, own = people.get(result.student, {}), typed_of(result, typed)
        row = [homework, "", result.submitted, result.student, *(person.get(name, "") for name in PERSON)]
        row += map(_number, (result.score, own.penalty, max(0, result.score - own.penalty), result.most))
        row += ["" if task.score is None else _number(task.score) for task in result.tasks]
        row += [_remark(result), *(own.more.get(name, "") for name in more)]
        numbers = {COLUMNS.index(PENALTY)}  # a bonus is a negative number, and no formula
        table.writerow([place if k in numbers else _harmless(place) for k, place in enumerate(row)])
    write(path, text.getvalue())


def _remark(result: Result) -> str:
    notes = result.notes if result.sandboxed else [*result.notes, "graded without a sandbox"]
    return clean(result.trouble or "; ".join(notes))


def typed_of(result: Result, typed: Mapping[str, Typed]) -> Typed:
    """What was typed for the student of a result."""
    return typed.get(_harmless(result.student), Typed())


def _rows(path: Path) -> list[dict[str, str]]:
    """The rows of a table, as a spreadsheet saves it: with commas, semicolons or tabs."""
    try:
        text = path.read_text(encoding="utf-8-sig")
        first = text.partition("\n")[0]
        delimiter = max(",;\t", key=first.count)
        rows = list(csv.DictReader(io.StringIO(text, newline=""), delimiter=delimiter, restval="", restkey=""))
    except UnicodeDecodeError:
        raise NotebookError(f"{path}: no table in UTF-8: save it as that") from None
    except (OSError, csv.Error) as error:
        raise NotebookError(f"{path}: no table: {error}") from None
    return [{name: value for name, value in row.items() if name} for row in rows]


def _typed(path: Path, row: Mapping[str, str], tasks: Sequence[Task]) -> Typed:
    place = f"{path}, {row['student_id']}"
    points = {}
    for task in tasks:
        told = row.get(task.name, "").strip()
        if task.by_hand and told:
            number = _read(told)
            if number is None or not 0 <= number <= task.points:
                raise NotebookError(f"{place}: {task.name} must be a number from 0 to {task.points:g}, not {told!r}")
            points[task.name] = number
    told = row.get(PENALTY, "").strip() or "0"
    penalty = _read(told)
    if penalty is None:
        raise NotebookError(f"{place}: {PENALTY} must be a number, not {told!r}")
    known = {*COLUMNS, REMARK, *(task.name for task in tasks)}
    return Typed(points, penalty, {name: value for name, value in row.items() if name not in known})


def _refuse_changes(path: Path, row: Mapping[str, str], before: Mapping[str, str], tasks: Sequence[Task]) -> None:
    for task in tasks:
        if task.by_hand or task.name not in row or task.name not in before:
            continue
        now, then = row[task.name].strip(), before[task.name]
        if now != then and (_read(now) is None or _read(now) != _read(then)):
            raise NotebookError(
                f"{path}, {row['student_id']}: {task.name} was {then}, and is {now or 'empty'}, but what checks found is "
                f"written anew each time: type what you take off into {PENALTY} (-2 adds 2), or {ELSE}"
            )


def _read(text: str) -> float | None:
    try:
        number = float(text.replace(",", "."))
    except ValueError:
        return None
    return number if abs(number) < 1e6 else None  # nan is none, too


def _number(points: float) -> str:
    return f"{points:g}"


def _harmless(text: str) -> str:
    """Text that no spreadsheet takes for a formula, not even one that separates by semicolons."""
    return _FORMULA.sub(r"\1'", text)
