"""A student's answers, put into the instructor's notebook.

Checks, tags, metadata and all given cells are the instructor's own. Of the student's notebook come only sources of code:
answer cells, found by cell id, then by ``grade_id``, then by position; and cells that the student added, which run where
they stand, as they did in the student's notebook. What was out of the ordinary is said.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from fem_mesh.course.homework.cells import name_of, role

MOST_CELLS = 2_000


@dataclass
class Merged:
    """What is run, in order, and what was strange.

    cells : (source, index of the instructor's cell or -1 for a student's own)
    answers : source of each answer cell that was found, by its ``grade_id`` (or id): code and prose
    code : those of them that are code
    added : sources of the student's own code cells
    notes : sentences for student and instructor
    """

    cells: list[tuple[str, int]] = field(default_factory=list)
    answers: dict[str, str] = field(default_factory=dict)
    code: dict[str, str] = field(default_factory=dict)
    added: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def merge(released: Any, submission: Any) -> Merged:
    """Put the answers of ``submission`` into ``released``, the students' version of the instructor's notebook.

    Both are nbformat's dictionaries; of the submission only ``cells`` with ``source``, ``id`` and ``metadata`` are read.
    """
    merged = Merged()
    theirs = list(_sources(submission, merged))
    slots, follow = _assigned(released, theirs, merged)
    merged.cells += [(source, -1) for source in _own(follow[-1], merged)]
    for at, cell in enumerate(released.cells):
        kind, found = role(cell), slots.get(at, [])
        if kind in ("answer", "explain"):
            sources = _chosen(cell, found, merged)
            if sources:
                merged.answers[_label(cell)] = "\n".join(sources)
            if sources and cell.cell_type == "code":
                merged.code[_label(cell)] = merged.answers[_label(cell)]
                merged.cells += [(source, at) for source in sources]
        elif cell.cell_type == "code":
            if found and _plain(found[0].source) != _plain(cell.source):
                merged.notes.append(f"{_label(cell)} is not yours to change: it was run as it was handed out")
            merged.cells.append((cell.source, at))
        merged.cells += [(source, -1) for source in _own(follow[at], merged)]
    return merged


@dataclass
class _Their:
    source: str
    id: str
    name: str
    kind: str


def _sources(submission: Any, merged: Merged) -> Iterator[_Their]:
    cells = submission.get("cells") if isinstance(submission, dict) else None
    cells = cells if isinstance(cells, list) else []
    if len(cells) > MOST_CELLS:
        merged.notes.append(f"the notebook has {len(cells)} cells; only the first {MOST_CELLS} were read")
    for cell in cells[:MOST_CELLS]:
        source = cell.get("source") if isinstance(cell, dict) else None
        source = "".join(source) if isinstance(source, list) and all(isinstance(s, str) for s in source) else source
        if isinstance(source, str):
            told = cell.get("metadata")
            told = told.get("nbgrader") if isinstance(told, dict) else None
            name = told.get("grade_id") if isinstance(told, dict) else None
            yield _Their(source, str(cell.get("id", "")), str(name or ""), str(cell.get("cell_type")))


def _assigned(
    released: Any, theirs: list[_Their], merged: Merged
) -> tuple[dict[int, list[_Their]], defaultdict[int, list[_Their]]]:
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
        if at is None:
            follow[last].append(their)
        else:
            slots.setdefault(at, []).append(their)
            last = max(last, at)  # a copy of an earlier cell takes nothing back
    return slots, follow


def _chosen(cell: Any, found: list[_Their], merged: Merged) -> list[str]:
    """The sources that answer ``cell``: one, or the parts of a cell that was split or copied."""
    label, stub = _label(cell), _plain(cell.source)
    if not found:
        merged.notes.append(
            f"{label} was not found"
            + (
                "; your cell at its position was run in its place"
                if merged.cells and merged.cells[-1][1] < 0
                else ": it was deleted or renamed"
            )
        )
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
        merged.notes.append(f"{label} was left as it was handed out")
        written = found[:1]
    return [their.source for their in written]


def _own(theirs: list[_Their], merged: Merged) -> Iterator[str]:
    for their in theirs:
        if their.kind == "code" and their.source.strip():
            merged.added.append(their.source)
            yield their.source


def _plain(source: str) -> str:
    """Source without what editors change by themselves."""
    return "\n".join(line.rstrip() for line in source.strip().splitlines())


def _label(cell: Any) -> str:
    return name_of(cell) or str(cell.get("id", "a cell"))
