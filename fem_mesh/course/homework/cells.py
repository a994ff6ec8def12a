"""What the cells of a homework are for, by nbgrader's metadata (version 3); our own keys stand under ``fem_mesh``.

| cell | nbgrader | what it is |
|---|---|---|
| answer | solution, not grade | code that students write; ``# BEGIN SOLUTION`` ... ``# END SOLUTION`` is taken out |
| check | grade, not solution | code that calls ``fm.check.*``: worth its points or none |
| explain | grade and solution | an open answer, marked by hand |
| given | neither | all else |
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from fem_mesh.course.notebooks import NotebookError

SCHEMA = 3
KEYS = {"schema_version", "grade", "solution", "locked", "task", "points", "grade_id", "cell_type", "checksum"}
_NAME = re.compile(r"[A-Za-z0-9_\-]+")
_HEADING = re.compile(r"^#+\s+(.+?)\s*#*\s*$", re.MULTILINE)


@dataclass(frozen=True)
class Call:
    """A call ``fm.check.name(...)`` in a check cell of the instructor's: ``text`` is the call as it stands there."""

    name: str
    text: str


@dataclass(frozen=True)
class Task:
    """A cell that is worth points.

    at : which cell of the notebook
    calls : the checks it makes; empty where it is marked by hand
    """

    name: str
    title: str
    points: float
    at: int
    calls: tuple[Call, ...]

    @property
    def by_hand(self) -> bool:
        """Whether no machine can mark it."""
        return not self.calls


def metadata(role: str, name: str, points: float = 0) -> dict[str, Any]:
    """nbgrader's metadata for a cell of ours.

    >>> metadata("check", "check-orient", 2)["nbgrader"]["points"]
    2
    """
    grade, solution = role in ("check", "explain"), role in ("answer", "explain")
    kept: dict[str, Any] = {
        "schema_version": SCHEMA,
        "grade": grade,
        "solution": solution,
        "locked": not solution,
        "task": False,
    }
    return {"nbgrader": kept | {"grade_id": name} | ({"points": points} if grade else {})}


def role(cell: Any) -> str:
    """What a cell is for: "answer", "check", "explain" or "given"."""
    told = cell.metadata.get("nbgrader")
    told = told if isinstance(told, dict) else {}
    if told.get("task"):
        return "explain"
    return {(0, 0): "given", (0, 1): "answer", (1, 0): "check", (1, 1): "explain"}[
        bool(told.get("grade")), bool(told.get("solution"))
    ]


def name_of(cell: Any) -> str:
    """The ``grade_id`` of a cell, or an empty string."""
    told = cell.metadata.get("nbgrader")
    name = told.get("grade_id") if isinstance(told, dict) else None
    return name if isinstance(name, str) else ""


def homework_of(notebook: Any) -> dict[str, Any]:
    """What the notebook says of itself: ``homework``, its name; ``uses``, names of fem_mesh that answers may use;
    ``packages``, packages that they may import besides numpy and matplotlib.
    """
    told = notebook.metadata.get("fem_mesh")
    told = dict(told) if isinstance(told, dict) else {}
    for key in ("uses", "packages"):
        names = told.get(key, [])
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise NotebookError(f'the notebook\'s metadata fem_mesh: "{key}" must be a list of names, not {names!r}')
    return {
        "homework": str(told.get("homework", "")),
        "uses": list(told.get("uses", [])),
        "packages": list(told.get("packages", [])),
    }


def tasks_of(notebook: Any) -> list[Task]:
    """The cells worth points, in order. Raises NotebookError for the first that is not as it must be."""
    tasks, title = [], ""
    for at, cell in enumerate(notebook.cells):
        if cell.cell_type == "markdown" and (found := _HEADING.search(cell.source)):
            title = found[1]
        if role(cell) in ("check", "explain"):
            points = cell.metadata["nbgrader"].get("points")
            calls = tuple(calls_in(cell.source)) if role(cell) == "check" and cell.cell_type == "code" else ()
            tasks.append(Task(name_of(cell), title or name_of(cell), _points(points, at, cell), at, calls))
    repeated = [name for name, n in Counter(name_of(cell) for cell in notebook.cells if role(cell) != "given").items() if n > 1]
    if repeated:
        raise NotebookError(f"several cells are called {repeated[0]!r}: give each a grade_id of its own")
    if not tasks:
        raise NotebookError('no cell is worth points: mark cells as nbgrader does ("fem-mesh homework new" shows how)')
    return tasks


def _points(points: Any, at: int, cell: Any) -> float:
    name = name_of(cell)
    if not _NAME.fullmatch(name):
        raise NotebookError(f"cell {at + 1}: its grade_id is {name!r}, but must be letters, digits, - and _")
    if isinstance(points, bool) or not isinstance(points, int | float) or not 0 <= points < 1e6:
        raise NotebookError(f"cell {at + 1} ({name}): points must be a number from 0 on, not {points!r}")
    return points


def calls_in(source: str) -> Iterator[Call]:
    """The calls of checks in a cell's code, in order.

    >>> [call.name for call in calls_in("fm.check.orient(orient)\\nfm.check.in_circle(f)")]
    ['orient', 'in_circle']
    """
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError, RecursionError):
        return
    found = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    for node in sorted(found, key=lambda node: (node.lineno, node.col_offset)):
        path = ast.unparse(node.func).split(".")
        if len(path) >= 2 and path[-2] == "check":
            yield Call(path[-1], ast.unparse(node))
