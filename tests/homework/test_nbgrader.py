"""nbgrader users lose nothing: its own validation takes a released notebook, and its autograder gives the same points."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from answers import FOLDER, NAMES, notebook_of
from classroom import ORIENT, call

from fem_mesh.course.homework.cells import tasks_of

pytest.importorskip("nbgrader")


@pytest.mark.parametrize("name", [None, *NAMES])
def test_nbgraders_own_validation_takes_a_released_notebook(name, course, tmp_path):
    from nbgrader.nbgraderformat import MetadataValidator

    given = [course.released, course.notebook(), nbformat.read(course.source, as_version=4)] if name is None else [
        notebook_of(name), released_of(name, tmp_path)
    ]  # fmt: skip
    for notebook in given:
        MetadataValidator().validate_nb(notebook)


def released_of(name, folder):
    assert call("homework", "release", FOLDER / f"{name}.ipynb", "-o", folder / "students").exit_code == 0
    return nbformat.read(folder / "students" / f"{name}.ipynb", as_version=4)


def autograded(desk, source, students, monkeypatch):
    """The points that nbgrader's autograder gives for each check: student -> name -> points."""
    monkeypatch.setenv("PATH", os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))  # it calls alembic
    (desk / "source" / "hw").mkdir(parents=True)
    shutil.copy(source, desk / "source" / "hw" / "hw.ipynb")
    (desk / "nbgrader_config.py").write_text(
        f"c = get_config()\nc.CourseDirectory.course_id = 'x'\nc.CourseDirectory.root = {str(desk)!r}\n"
    )

    def nbgrader(*arguments):
        command = [sys.executable, "-m", "nbgrader", *arguments]
        done = subprocess.run(command, cwd=desk, capture_output=True, text=True, timeout=300, check=False)
        assert done.returncode == 0, done.stderr[-3000:]

    nbgrader("generate_assignment", "hw")
    for student, notebook in students.items():
        (desk / "submitted" / student / "hw").mkdir(parents=True)
        nbformat.write(notebook, desk / "submitted" / student / "hw" / "hw.ipynb")
    nbgrader("autograde", "hw")
    from nbgrader.api import Gradebook

    with Gradebook(f"sqlite:///{desk}/gradebook.db") as book:
        theirs = {student: book.find_submission_notebook("hw", "hw", student).grades for student in students}
        return {
            student: {grade.name: grade.auto_score for grade in grades if grade.name.startswith("check")}
            for student, grades in theirs.items()
        }


def test_nbgraders_autograder_gives_the_same_points(course, monkeypatch):
    wrong = ORIENT.replace("Fraction(x), Fraction(y)", "x, y")
    students = {"ada": course.notebook(), "bob": course.notebook(orient=wrong), "cy": course.released}
    for student, notebook in students.items():
        course.submit(student, notebook)
    course.grade()
    ours = {
        student: {task["name"]: task["score"] for task in told["tasks"] if task["name"].startswith("check")}
        for student, told in course.results().items()
    }
    assert [list(ours[student].values()) for student in students] == [[2, 3], [0, 3], [0, 0]]
    assert autograded(course.folder / "desk", course.source, students, monkeypatch) == ours


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", NAMES)
def test_nbgraders_autograder_gives_all_points_to_a_solution_and_none_to_a_stub(name, tmp_path, monkeypatch):
    solution = notebook_of(name)
    points = autograded(
        tmp_path, FOLDER / f"{name}.ipynb", {"ada": solution, "cy": released_of(name, tmp_path)}, monkeypatch
    )  # fmt: skip
    full = {task.name: task.points for task in tasks_of(solution) if not task.by_hand}
    assert points == {"ada": full, "cy": dict.fromkeys(full, 0)}
