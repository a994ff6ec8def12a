"""Why a check cell showed no answer, in words that lead a student to the cell that is the reason.

A check says only that a name is not defined. What the student needs to know is which cell should have defined it, and what
became of that: it holds no Python, it raised, it was deleted, or it is a given cell whose change was not taken over.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from fem_mesh.course.homework.cells import Task, role
from fem_mesh.course.homework.merge import Merged, label_of

LONGEST = 100  # characters of a line of code in a sentence
_SYNTAX = re.compile(r"((?:Syntax|Indentation|Tab)Error: .*) \(\S+, line (\d{1,6})\)", re.DOTALL)
_NAME = re.compile(r"name '(\w+)' is not defined")


@dataclass(frozen=True)
class Failed:
    """A cell that raised something: what it is called, its source, what the kernel said, and on which line (or 0)."""

    label: str
    source: str
    error: str
    line: int = 0

    def __str__(self) -> str:
        found = _SYNTAX.fullmatch(self.error)
        error, line = (found[1], int(found[2])) if found else (self.error, self.line)
        lines = self.source.splitlines()
        if not 0 < line <= len(lines):
            return f"{self.label} raised {error}"
        return f"{self.label}, line {line}, `{lines[line - 1].strip()[:LONGEST]}`, raised {error}"


def hint(said: str, failed: list[Failed], merged: Merged, released: Any) -> str:
    """What is to be known of the first name that ``said`` calls not defined, or an empty string."""
    found = _NAME.search(said)
    if not found:
        return ""
    word = re.compile(rf"\b{found[1]}\b")
    for failure in failed:
        if word.search(failure.source):
            return str(failure)
    for cell in released.cells:
        label = label_of(cell)
        if role(cell) == "answer" and label not in merged.answers and word.search(cell.source):
            return f"{label} was not found: it was deleted or renamed"
    changed = [label for label, source in merged.dropped.items() if word.search(source)]
    return f"your change to the cell {changed[0]} was not taken over" if changed else ""


def answers_before(released: Any, tasks: list[Task]) -> dict[int, list[str]]:
    """The answer cells of code that belong to each task, by its place: those between it and the task before."""
    places, found = {task.at for task in tasks}, dict[int, list[str]]()
    waiting: list[str] = []
    for at, cell in enumerate(released.cells):
        if role(cell) == "answer":
            waiting.append(label_of(cell))
        if at in places:
            found[at], waiting = waiting, []
    return found
