"""A homework, and the class that hands it in."""

import copy
import json
from pathlib import Path

import nbformat
from click.testing import CliRunner
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

from fem_mesh.course.command import main
from fem_mesh.course.homework.cells import metadata

ORIENT = """def orient(a, b, c):
    from fractions import Fraction
    (ax, ay), (bx, by), (cx, cy) = [(Fraction(x), Fraction(y)) for x, y in (a, b, c)]
    left = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (left > 0) - (left < 0)"""
IN_CIRCLE = """def in_circle(a, b, c, d):
    from fractions import Fraction
    rows = [(Fraction(x) - Fraction(d[0]), Fraction(y) - Fraction(d[1])) for x, y in (a, b, c)]
    (ax, ay), (bx, by), (cx, cy) = rows
    aa, bb, cc = (x * x + y * y for x, y in rows)
    return aa * (bx * cy - cx * by) + bb * (cx * ay - ax * cy) + cc * (ax * by - bx * ay) > 0"""


def solved(code):
    first, *rest = code.splitlines()
    return "\n".join([first, "    # BEGIN SOLUTION", *rest, "    # END SOLUTION"])


def source():
    """The instructor's notebook: two predicates, and an open question."""
    cells = [
        new_markdown_cell("# Homework\n\nTwo predicates.", id="title"),
        new_code_cell("import fem_mesh as fm", id="imports"),
        new_markdown_cell("## Which side", id="task-1"),
        new_code_cell(solved(ORIENT), id="a-orient", metadata=metadata("answer", "orient")),
        new_code_cell("fm.check.orient(orient)", id="c-orient", metadata=metadata("check", "check-orient", 2)),
        new_markdown_cell("## Inside or not", id="task-2"),
        new_code_cell(solved(IN_CIRCLE), id="a-circle", metadata=metadata("answer", "in-circle")),
        new_code_cell("fm.check.in_circle(in_circle)", id="c-circle", metadata=metadata("check", "check-in-circle", 3)),
        new_markdown_cell("Because of rounding.", id="explain", metadata=metadata("explain", "explain", 1)),
    ]
    told = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    return new_notebook(cells=cells, metadata=told | {"fem_mesh": {"homework": "hw", "uses": []}})


def call(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def cell(notebook, cell_id):
    return next(cell for cell in notebook.cells if cell.get("id") == cell_id)


class Class:
    """A folder with the instructor's notebook, and the students' version to answer."""

    def __init__(self, folder: Path, notebook=None):
        self.folder = folder
        self.source = folder / "hw.ipynb"
        self.submissions = folder / "submissions"
        self.submissions.mkdir(parents=True)
        nbformat.write(notebook or source(), self.source)
        assert call("homework", "release", self.source, "-o", folder / "students").exit_code == 0
        self.released = nbformat.read(folder / "students" / "hw.ipynb", as_version=4)

    def notebook(self, orient=ORIENT, circle=IN_CIRCLE):
        """The students' version, answered."""
        notebook = copy.deepcopy(self.released)
        for cell_id, code in (("a-orient", orient), ("a-circle", circle)):
            if code is not None:
                cell(notebook, cell_id).source = code
        return notebook

    def submit(self, student, notebook=None, name=None):
        path = self.submissions / (name or f"{student}.ipynb")
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(notebook, bytes):
            path.write_bytes(notebook)
        else:
            path.write_text(json.dumps(notebook or self.notebook()), encoding="utf-8")  # as it is: nbformat would repair it
        return path

    def grade(self, *options, own=False):
        """Grade the class; the instructor's ``own`` solution first only where that is what is tested."""
        table = ("--csv", self.folder / "grades.csv", "--feedback", self.folder / "out")
        force = () if own else ("--force",)
        return call("homework", "grade", self.source, self.submissions, *table, "--jobs", 2, *force, *options)

    def results(self):
        """What is kept of each student."""
        return {path.stem: json.loads(path.read_text()) for path in (self.folder / "grades.results").glob("*.json")}

    def scores(self):
        """The marks of each student, task by task."""
        return {student: [task["score"] for task in told["tasks"]] for student, told in self.results().items()}
