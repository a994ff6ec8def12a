"""nbgrader users lose nothing: its own validation takes a released notebook, and its autograder gives the same points."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from classroom import ORIENT

pytest.importorskip("nbgrader")


def test_nbgraders_own_validation_takes_a_released_notebook(course):
    from nbgrader.nbgraderformat import MetadataValidator

    for notebook in (course.released, course.notebook(), nbformat.read(course.source, as_version=4)):
        MetadataValidator().validate_nb(notebook)


def test_nbgraders_autograder_gives_the_same_points(course, monkeypatch):
    monkeypatch.setenv("PATH", os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))  # it calls alembic
    wrong = ORIENT.replace("Fraction(x), Fraction(y)", "x, y")
    students = {"ada": course.notebook(), "bob": course.notebook(orient=wrong), "cy": course.released}
    for student, notebook in students.items():
        course.submit(student, notebook)
    course.grade()
    desk = course.folder / "desk"
    (desk / "source" / "hw").mkdir(parents=True)
    shutil.copy(course.source, desk / "source" / "hw" / "hw.ipynb")
    (desk / "nbgrader_config.py").write_text(
        f"c = get_config()\nc.CourseDirectory.course_id = 'x'\nc.CourseDirectory.root = {str(desk)!r}\n"
    )

    def nbgrader(*arguments):
        command = [sys.executable, "-m", "nbgrader", *arguments]
        done = subprocess.run(command, cwd=desk, capture_output=True, text=True, timeout=300, check=False)
        assert done.returncode == 0, done.stderr[-3000:]

    nbgrader("generate_assignment", "hw")
    for student in students:
        (desk / "submitted" / student / "hw").mkdir(parents=True)
        shutil.copy(course.submissions / f"{student}.ipynb", desk / "submitted" / student / "hw" / "hw.ipynb")
    nbgrader("autograde", "hw")
    from nbgrader.api import Gradebook

    with Gradebook(f"sqlite:///{desk}/gradebook.db") as book:
        for student in students:
            theirs = book.find_submission_notebook("hw", "hw", student).grades
            points = {grade.name: grade.auto_score for grade in theirs if grade.name.startswith("check")}
            ours = {
                task["name"]: task["score"] for task in course.results()[student]["tasks"] if task["name"].startswith("check")
            }
            assert points == ours, student
