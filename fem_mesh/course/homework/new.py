"""A homework to begin with: one task, its check, an open question."""

from __future__ import annotations

from typing import Any

from fem_mesh.course.homework.cells import metadata
from fem_mesh.course.notebooks import _nbformat

_TITLE = """# {name}

What the homework is about, in two or three sentences, and what students will be able to do.

*For you, and to be deleted: a cell's part is told by nbgrader's metadata, which nbgrader's own panel in JupyterLab edits.
The notebook's metadata `fem_mesh.uses` lists the names of `fm` that answers may use.*"""
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
    ['markdown', 'code', 'markdown', 'code', 'code', 'markdown', 'markdown']
    """
    v4 = _nbformat().v4
    cells = [
        ("markdown", "title", _TITLE.format(name=name), {}),
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
