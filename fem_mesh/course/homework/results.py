"""What is known of a submission after grading, as plain data: it crosses processes and machines as JSON, never as a pickle."""

from __future__ import annotations

import json
import re
import secrets
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from fem_mesh.course.homework.cells import Task
from fem_mesh.course.homework.scan import Finding

# What no page and no terminal should get: controls, marks that turn the direction of text, halves of characters.
_UNFIT = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]")
BY_HAND = "to be marked by hand"
HELD = f"{BY_HAND}; when it was run, the tests held"
UNANSWERED = "not answered"
UNWRITTEN = "not written yet"
NOT_GRADED = "not graded"


@dataclass(frozen=True)
class Marked:
    """A task with its marks.

    score : points earned, all of them or none; None where the task is marked by hand, and not yet
    message : one sentence: right, or what went wrong first
    verdicts : what the judge said of each check, as its ``as_json`` says it
    text : the student's own words or code, where the task is marked by hand
    by_hand : whether the points were given by hand
    """

    name: str
    title: str
    points: float
    score: float | None
    message: str
    verdicts: list[dict[str, Any]] = field(default_factory=list)
    text: str = ""
    by_hand: bool = False


@dataclass(frozen=True)
class Result:
    """What became of one submission.

    trouble : why it could not be graded as a whole, or ""
    sandboxed : whether the student's kernel was shut in
    key : of everything the marks depend on; the same key, the same marks
    """

    student: str
    tasks: list[Marked]
    trouble: str = ""
    notes: list[str] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    sandboxed: bool = False
    seconds: float = 0.0
    submitted: str = ""
    key: str = ""

    @property
    def score(self) -> float:
        """Points that were earned so far."""
        return sum(task.score or 0 for task in self.tasks)

    @property
    def most(self) -> float:
        """Points that could be earned, by hand too."""
        return sum(task.points for task in self.tasks)

    @property
    def waiting(self) -> float:
        """Points that somebody has yet to give, or not, by hand."""
        return sum(task.points for task in self.tasks if task.score is None)


def nothing(student: str, tasks: list[Task], trouble: str) -> Result:
    """The result of a submission that could not be graded."""
    marked = [Marked(task.name, task.title, task.points, None if task.by_hand else 0, NOT_GRADED) for task in tasks]
    return Result(student, marked, trouble)


def with_points(result: Result, points: Mapping[str, float]) -> Result:
    """A result with the ``points`` that were given by hand, by task."""
    marked = [replace(task, score=points[task.name], by_hand=True) if task.name in points else task for task in result.tasks]
    return replace(result, tasks=marked)


def clean(text: str) -> str:
    """A stranger's text as it can stand anywhere.

    >>> clean("a\\x1b[31mb")
    'a?[31mb'
    """
    return _UNFIT.sub("?", text)


def write(path: Path, text: str) -> None:
    """Write a file as a whole or not at all, whoever else writes it."""
    part = path.with_name(f"{path.name}.{secrets.token_hex(4)}.part")
    try:
        part.write_text(text, encoding="utf-8", errors="replace", newline="\n")
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def to_json(result: Result) -> str:
    """A result as a JSON text."""
    return json.dumps(asdict(result), ensure_ascii=True, indent=1)


def from_json(text: str, tasks: list[Task]) -> Result:
    """The result in a JSON text, checked against the tasks that it must speak of. Raises ValueError for anything else."""
    try:
        told = json.loads(text)
        told["tasks"] = [Marked(**task) for task in told["tasks"]]
        told["findings"] = [Finding(**finding) for finding in told["findings"]]
        result = Result(**told)
        expected = [(task.name, task.points, task.by_hand) for task in tasks]
        found = [(task.name, task.points, task.score is None) for task in result.tasks]
        fits = found == expected and all(task.score in (None, 0, task.points) for task in result.tasks)
        fits = fits and not any(task.by_hand for task in result.tasks)
        fits = fits and all(isinstance(task.message, str) for task in result.tasks) and isinstance(result.student, str)
    except (TypeError, KeyError, AttributeError, RecursionError) as error:
        raise ValueError(f"no result: {type(error).__name__}") from None
    if not fits:
        raise ValueError("the result does not speak of the tasks of this homework")
    return result
