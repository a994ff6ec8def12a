"""A student's answers, put into the instructor's notebook.

Checks, tags, metadata and all given cells are the instructor's own. Of the student's notebook come only sources of code:
answer cells, found by cell id, then by ``grade_id``, then by position; cells that the student added, which run where they
stand, as they did in the student's notebook; and imports that the student added to a given cell, which run after it, as if
they were a cell of the student's own. What was out of the ordinary is said.
"""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from fem_mesh.course.homework.cells import name_of, role

MOST_OWN = 300  # cells that a student added; no more of them are run
MOST_PARTS = 50  # of an answer
_DEFINED = re.compile(r"^(?:def |class )?(\w+)(?:\(|:| *=)", re.MULTILINE)
OWN, IMPORTS = -1, -2  # in place of an index: a cell that the student added, imports that the student added to a cell


@dataclass
class Merged:
    """What is run, in order, and what was strange.

    cells : (source, index of the instructor's cell, or ``OWN``, or ``IMPORTS``)
    answers : source of each answer cell that was found, by its ``grade_id`` (or id): code and prose
    code : those of them that are code
    added : sources of the student's own code cells
    notes : sentences for student and instructor
    untouched : answer cells that are as they were handed out, by ``grade_id`` (or id)
    dropped : given cells that the student changed, by name (or id): what the student wrote there
    """

    cells: list[tuple[str, int]] = field(default_factory=list)
    answers: dict[str, str] = field(default_factory=dict)
    code: dict[str, str] = field(default_factory=dict)
    added: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    untouched: set[str] = field(default_factory=set)
    dropped: dict[str, str] = field(default_factory=dict)


def merge(released: Any, submission: Any) -> Merged:
    """Put the answers of ``submission`` into ``released``, the students' version of the instructor's notebook.

    Both are nbformat's dictionaries; of the submission only ``cells`` with ``source``, ``id`` and ``metadata`` are read.
    """
    merged = Merged()
    theirs = list(_sources(submission))
    slots, follow = _assigned(released, theirs)
    merged.cells += [(source, OWN) for source in _own(follow[-1], merged)]
    for at, cell in enumerate(released.cells):
        kind, found = role(cell), slots.get(at, [])
        if kind in ("answer", "explain"):
            sources = _chosen(cell, found, merged)
            if sources:
                merged.answers[label_of(cell)] = "\n".join(sources)
            if sources and cell.cell_type == "code":
                merged.code[label_of(cell)] = merged.answers[label_of(cell)]
                merged.cells += [(source, at) for source in sources]
        elif cell.cell_type == "code":
            merged.cells.append((cell.source, at))
            changed = [their.source for their in found if _plain(their.source) != _plain(cell.source)]
            if changed:
                _keep_imports(cell, changed, merged)
        merged.cells += [(source, OWN) for source in _own(follow[at], merged)]
    return merged


@dataclass
class _Their:
    source: str
    id: str
    name: str
    kind: str


def _sources(submission: Any) -> Iterator[_Their]:
    cells = submission.get("cells") if isinstance(submission, dict) else None
    for cell in cells if isinstance(cells, list) else []:
        source = cell.get("source") if isinstance(cell, dict) else None
        source = "".join(source) if isinstance(source, list) and all(isinstance(s, str) for s in source) else source
        if isinstance(source, str):
            source = source.encode("utf-8", "replace").decode("utf-8")  # JSON knows halves of characters
            told = cell.get("metadata")
            told = told.get("nbgrader") if isinstance(told, dict) else None
            name = told.get("grade_id") if isinstance(told, dict) else None
            yield _Their(source, str(cell.get("id", "")), str(name or ""), str(cell.get("cell_type")))


def _assigned(released: Any, theirs: list[_Their]) -> tuple[dict[int, list[_Their]], defaultdict[int, list[_Their]]]:
    """Which of the student's cells belong to which of ours, and which follow it as the student's own."""
    by_id = {cell.id: at for at, cell in enumerate(released.cells) if "id" in cell}
    by_name = {name_of(cell): at for at, cell in enumerate(released.cells) if name_of(cell)}
    by_text = {
        _plain(cell.source): at
        for at, cell in enumerate(released.cells)
        if role(cell) in ("given", "check") and cell.source.strip()
    }
    slots: dict[int, list[_Their]] = {}
    follow: defaultdict[int, list[_Their]] = defaultdict(list)
    last = -1
    for their in theirs:
        at = by_id.get(their.id)
        at = by_name.get(their.name) if at is None and their.name else at
        at = by_text.get(_plain(their.source)) if at is None else at
        if at is None or _is_a_later_draft(their, released.cells[at], slots.get(at, []), at < last):
            follow[last].append(their)
        else:
            slots.setdefault(at, []).append(their)
            last = max(last, at)  # a copy of an earlier cell takes nothing back
    return slots, follow


def _is_a_later_draft(their: _Their, cell: Any, found: list[_Their], is_later: bool) -> bool:
    """Whether this is a copy, further below, of an answer that was given already: it runs there, as it did for the student."""
    if not found or not is_later or role(cell) != "answer" or their.id == cell.get("id"):
        return False
    return any(other.id == cell.get("id") and _plain(other.source) != _plain(cell.source) for other in found)


def _chosen(cell: Any, found: list[_Their], merged: Merged) -> list[str]:
    """The sources that answer ``cell``: one, or the parts of a cell that was split or copied."""
    label, stub = label_of(cell), _plain(cell.source)
    if not found:
        there = merged.cells[-1][0] if merged.cells and merged.cells[-1][1] == OWN else ""
        names = _DEFINED.findall(stub)
        is_there = any(name in _DEFINED.findall(there) for name in names) if names else bool(there)
        what = "; your cell at its position was run in its place" if is_there else ": it was deleted or renamed"
        merged.notes.append(f"{label} was not found{what}")
        return []
    if cell.cell_type == "code" and any(their.kind != "code" for their in found):
        merged.notes.append(f"{label} was no code cell any more: it was run as code all the same")
    if "id" in cell and all(their.id != cell.id for their in found) and any(their.id for their in found):
        merged.notes.append(f"{label} was found by its name, not by its id")
    if all(their.name != name_of(cell) for their in found) and name_of(cell):
        merged.notes.append(f"{label} had lost its mark: it was found by its id")
    written = [their for their in found if _plain(their.source) != stub]
    if len(found) > 1:
        merged.notes.append(f"{label} stands there {len(found)} times: what was written into them was run in order")
    if not written:
        merged.untouched.add(label)
        written = found[:1]
    return [their.source for their in written[:MOST_PARTS]]


def _keep_imports(cell: Any, changed: list[str], merged: Merged) -> None:
    """Of what the student made of a cell that is not theirs, run the imports that were added; say what is not run."""
    lost, imports = True, ""
    if role(cell) == "given":
        lost, imports = _imports_added(cell.source, changed)
    if imports:
        merged.added.append(imports)
        merged.cells.append((imports, IMPORTS))
    if lost:
        merged.dropped[label_of(cell)] = "\n".join(changed)
        note = f"the cell {label_of(cell)} is not yours to change: it was run as it was handed out"
        merged.notes.append(f"{note}, and after it the imports that you added" if imports else note)


def _imports_added(given: str, changed: list[str]) -> tuple[bool, str]:
    """Whether anything but new imports tells ``changed`` from ``given``, and those imports."""
    try:
        ours = [ast.dump(node) for node in ast.parse(given).body]
        theirs = [node for source in changed for node in ast.parse(source).body]
    except (SyntaxError, ValueError, RecursionError, MemoryError):  # a magic, say
        return True, ""
    added = [node for node in theirs if isinstance(node, ast.Import | ast.ImportFrom) and ast.dump(node) not in ours]
    rest = [ast.dump(node) for node in theirs if node not in added]
    return rest != ours, "\n".join(map(ast.unparse, added))


def _own(theirs: list[_Their], merged: Merged) -> Iterator[str]:
    for their in theirs:
        if their.kind == "code" and their.source.strip() and len(merged.added) < MOST_OWN:
            merged.added.append(their.source)
            yield their.source
            if len(merged.added) == MOST_OWN:
                merged.notes.append(f"of the cells that you added, the first {MOST_OWN} were run")


def _plain(source: str) -> str:
    """Source without what editors change by themselves."""
    return "\n".join(line.rstrip() for line in source.strip().splitlines())


def label_of(cell: Any) -> str:
    """What a cell is called in what is said to students."""
    return name_of(cell) or str(cell.get("id", "a cell"))
