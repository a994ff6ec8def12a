"""A homework to begin with: one task, its check, an open question."""

from __future__ import annotations

from typing import Any

from fem_mesh.course.homework.cells import metadata
from fem_mesh.course.homework.release import FOR_YOU
from fem_mesh.course.notebooks import _nbformat

_TITLE = """# {name}

What the homework is about, in two or three sentences, and what students will be able to do.

Your own imports and helpers go into your answer cells, or into cells that you add."""
_FOR_YOU = """**For you: this cell is tagged `instructor`, so `release` leaves it out.**

- A cell's metadata `nbgrader` tell its part. An *answer* has `"solution": true`. A *check* has `"grade": true` and points,
  and gives all of them or none. An *open question* has both: you mark it by hand. All other cells are run as you wrote them.
- They are edited by nbgrader's panel where that is installed, or in JupyterLab's right sidebar: Property Inspector (the two
  gears), Advanced Tools, Cell Metadata. Give each cell a `grade_id` of its own.
- `help(fm.check)` lists the checks. A check cell with asserts of your own is marked by hand.
- There, too, Notebook Metadata: `fem_mesh.uses` lists the names of `fm` that answers may use."""
_TASK = """## Task 1: on which side?

Write `orient(a, b, c)`: positive if `c` lies to the left of the line from `a` to `b`, negative if to the right, 0 on the line.
The sign must be right for *all* doubles."""
_ANSWER = """def orient(a, b, c):
    # BEGIN SOLUTION
    from fractions import Fraction

    (ax, ay), (bx, by), (cx, cy) = [(Fraction(x), Fraction(y)) for x, y in (a, b, c)]
    left = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (left > 0) - (left < 0)
    # END SOLUTION"""
_QUESTION = "## Task 2: explain\n\nWhy does a tolerance such as `1e-12` not help?"
_EXPLAINED = "Coordinates have a scale of their own: a tolerance calls a large triangle flat, or a flat one a triangle."


def starter(name: str) -> Any:
    """A notebook, as nbformat's dictionary, that can be released and graded as it is.

    >>> [cell.cell_type for cell in starter("hw6").cells]
    ['markdown', 'markdown', 'code', 'markdown', 'code', 'code', 'markdown', 'markdown']
    """
    v4 = _nbformat().v4
    cells = [
        ("markdown", "title", _TITLE.format(name=name), {}),
        ("markdown", "for-you", _FOR_YOU, {"tags": [FOR_YOU]}),
        ("code", "imports", "import fem_mesh as fm", {}),
        ("markdown", "task-1", _TASK, {}),
        ("code", "answer-orient", _ANSWER, metadata("answer", "answer-orient")),
        ("code", "check-orient", "fm.check.orient(orient)", metadata("check", "check-orient", 2)),
        ("markdown", "task-2", _QUESTION, {}),
        ("markdown", "explain-tolerance", _EXPLAINED, metadata("explain", "explain-tolerance", 1)),
    ]
    made = []
    for kind, cell_id, source, told in cells:
        make = v4.new_code_cell if kind == "code" else v4.new_markdown_cell
        made.append(make(source, metadata=told, id=cell_id))
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return v4.new_notebook(cells=made, metadata={"kernelspec": kernel, "fem_mesh": {"homework": name, "uses": []}})
