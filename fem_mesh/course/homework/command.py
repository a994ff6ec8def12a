"""The commands ``fem-mesh homework release``, ``new`` and ``grade``."""

from __future__ import annotations

import os
from pathlib import Path
from statistics import median

import click

from fem_mesh.course import notebooks
from fem_mesh.course.homework import sandbox as boxes
from fem_mesh.course.homework.feedback import page
from fem_mesh.course.homework.grade import Homework, executor_of, grade_class, homework_from, seed_in
from fem_mesh.course.homework.marks import read_roster, write_marks
from fem_mesh.course.homework.new import starter
from fem_mesh.course.homework.release import release as released_from
from fem_mesh.course.homework.results import Result
from fem_mesh.course.homework.sandbox import Limits
from fem_mesh.course.homework.submissions import Submission, find
from fem_mesh.course.notebooks import NotebookError
from fem_mesh.steps import many

SOURCE = click.argument("source", type=click.Path(exists=True, dir_okay=False, path_type=Path))
DEFAULT = Limits()


@click.group()
def homework() -> None:
    """Homework: students' versions without solutions, and marks for what comes back."""


@homework.command()
@SOURCE
@click.option("-o", "--output", "folder", required=True, type=click.Path(file_okay=False, path_type=Path),
              help="The folder for the students' version; it is made if it is not there.")  # fmt: skip
@click.option("--force", is_flag=True, help="Write over a version that is there.")
def release(source: Path, folder: Path, force: bool) -> None:
    """Write the students' version of SOURCE, an instructor's notebook.

    What stands between "# BEGIN SOLUTION" and "# END SOLUTION" becomes a stub, outputs go. SOURCE itself stays as it is.
    """
    version, notes = released_from(notebooks.read(source))
    goal = folder / source.name
    if goal.exists() and goal.samefile(source):
        raise NotebookError(f"{goal} is the notebook with the solutions: name another folder")
    _write_new(goal, notebooks.text(version), force)
    for note in notes:
        click.echo(f"note: {note}")
    click.echo(f"wrote {goal}")


@homework.command()
@click.argument("path", type=click.Path(dir_okay=False, path_type=Path))
@click.option("--force", is_flag=True, help="Write over a notebook that is there.")
def new(path: Path, force: bool) -> None:
    """Write a homework to begin with to PATH: one task, its check, and an open question, marked as nbgrader marks them."""
    if path.suffix != ".ipynb":
        raise NotebookError(f"{path}: a notebook's name ends in .ipynb")
    _write_new(path, notebooks.text(starter(path.stem)), force)
    click.echo(f"wrote {path}\nnext: fem-mesh homework release {path} -o students/")


def _write_new(path: Path, text: str, force: bool) -> None:
    if path.exists() and not force:
        raise NotebookError(f"{path} is there already: choose another name, or say --force")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8", newline="\n")


@homework.command()
@SOURCE
@click.argument("submissions", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option("--csv", "table", default="grades.csv", show_default=True, type=click.Path(dir_okay=False, path_type=Path),
              help="The table of marks, in nbgrader's columns, then one a task.")  # fmt: skip
@click.option("--feedback", type=click.Path(file_okay=False, path_type=Path), help="A folder for a page for each student.")
@click.option("--results", type=click.Path(file_okay=False, path_type=Path),
              help="A folder for what is known of each student, as JSON, for later runs [default: TABLE.results]")  # fmt: skip
@click.option("--roster", type=click.Path(exists=True, dir_okay=False, path_type=Path),
              help="A CSV with student_id, last_name, first_name, email.")  # fmt: skip
@click.option(
    "--jobs", type=click.IntRange(1), default=os.cpu_count() or 1, show_default="one a core", help="Submissions at a time."
)
@click.option("--sandbox", type=click.Choice(boxes.MODES), default="auto", show_default=True,
              help="Whether students' code runs inside bubblewrap.")  # fmt: skip
@click.option(
    "--seed", type=int, help="Of the cases that answers are tried on; drawn once, and kept beside the results, if not said."
)
@click.option("--cell-time", type=click.FloatRange(1), default=DEFAULT.cell, show_default=True, help="Seconds for a cell.")
@click.option(
    "--total-time", type=click.FloatRange(1), default=DEFAULT.total, show_default=True, help="Seconds for a submission."
)
@click.option("--memory", type=click.IntRange(512), default=DEFAULT.memory, show_default=True, help="MB for a submission.")
@click.option("--executor", default="", help="A Dask scheduler's address: grade on its cluster.")
@click.option("--again", is_flag=True, help="Grade also what has been graded.")
def grade(
    source: Path, submissions: Path, table: Path, feedback: Path | None, results: Path | None, roster: Path | None, jobs: int,
    sandbox: str, seed: int | None, cell_time: float, total_time: float, memory: int, executor: str, again: bool,
) -> None:  # fmt: skip
    """Grade the folder SUBMISSIONS against SOURCE, the instructor's notebook with solutions.

    A submission is a file student.ipynb, or a folder named after the student with a notebook inside. Each is run in a process
    of its own; none is changed, and none stops the others. What was graded before is not graded again.
    The exit code is 0 when every submission got a verdict, 1 when one could not be graded.
    """
    limits = Limits(cell_time, total_time, memory)
    folder = results or table.with_name(f"{table.stem}.results")
    assignment, notes = homework_from(source, seed_in(folder) if seed is None else seed, sandbox, limits)
    for note in notes:
        click.echo(f"note: {note}", err=True)
    found = find(submissions, source.name)
    people = read_roster(roster) if roster else None
    if not executor:
        _warn_of_sandbox(assignment)
    graded = _graded(assignment, found, folder, jobs, executor, again)
    table.parent.mkdir(parents=True, exist_ok=True)
    write_marks(table, assignment.name, assignment.tasks, graded, people)
    if feedback:
        feedback.mkdir(parents=True, exist_ok=True)
        for submission, result in zip(found, graded, strict=True):
            (feedback / f"{submission.file_name}.html").write_text(page(result, assignment.name), encoding="utf-8")
    _tell(graded, table, feedback)
    if any(result.trouble for result in graded):
        raise SystemExit(1)


def _graded(assignment: Homework, found: list[Submission], folder: Path, jobs: int, address: str, again: bool) -> list[Result]:
    from tqdm import tqdm

    try:
        with executor_of(address, jobs) as (executor, at_once), tqdm(total=len(found), unit="submission", disable=None) as bar:
            return grade_class(assignment, found, folder, executor, at_once, bar.update, again)
    except KeyboardInterrupt:
        raise NotebookError(f"stopped; what is graded is kept in {folder}: the same command goes on from there") from None


def _warn_of_sandbox(assignment: Homework) -> None:
    try:
        box = boxes.box_of(assignment.sandbox, assignment.packages)
    except (boxes.SandboxError, LookupError) as error:
        raise NotebookError(str(error)) from None
    if not box.bwrap:
        click.echo(
            f"warning: students' code runs without a sandbox, for {box.why}. It has limits of time and memory, but can read "
            "your files, reach the network and disturb the grader: run it where nothing can be harmed, and look at the scans.",
            err=True,
        )


def _tell(graded: list[Result], table: Path, feedback: Path | None) -> None:
    troubled = [result for result in graded if result.trouble]
    for result in troubled:
        click.echo(f"{result.student}: {result.trouble}")
    middle = median(result.score for result in graded)
    by_hand = any(task.score is None for result in graded for task in result.tasks)
    click.echo(
        f"{many(len(graded), 'submission')}, median {middle:g} points" + (" without those given by hand" if by_hand else "")
    )
    click.echo(f"wrote {table}" + (f" and {many(len(graded), 'page')} in {feedback}" if feedback else ""))
