"""The commands ``fem-mesh homework release``, ``new`` and ``grade``."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from tempfile import TemporaryFile

import click

from fem_mesh.course import notebooks
from fem_mesh.course.homework import sandbox as boxes
from fem_mesh.course.homework.feedback import page
from fem_mesh.course.homework.grade import Homework, check_solution, executor_of, grade_class, homework_from, seed_in
from fem_mesh.course.homework.marks import read_roster, read_typed, typed_of, write_marks
from fem_mesh.course.homework.new import starter
from fem_mesh.course.homework.release import release as released_from
from fem_mesh.course.homework.results import Result, nothing, with_points, write
from fem_mesh.course.homework.sandbox import Limits
from fem_mesh.course.homework.submissions import Submission, find
from fem_mesh.course.notebooks import NotebookError
from fem_mesh.steps import many

SOURCE = click.argument("source", type=click.Path(exists=True, dir_okay=False, path_type=Path))
DEFAULT = Limits()
ABSENT = "nothing handed in"
NAMED = 20  # files that are left aside


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

    What stands between "# BEGIN SOLUTION" and "# END SOLUTION" becomes a stub; outputs and cells tagged "instructor" go.
    SOURCE itself stays as it is.
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
    "--seed",
    type=int,
    help="Of the cases that answers are tried on; drawn once, and kept beside the results, if not said. "
    "Pages show cases: where students hand in again after they saw theirs, say another.",
)
@click.option("--cell-time", type=click.FloatRange(1), default=DEFAULT.cell, show_default=True, help="Seconds for a cell.")
@click.option(
    "--total-time", type=click.FloatRange(1), default=DEFAULT.total, show_default=True, help="Seconds for a submission."
)
@click.option("--memory", type=click.IntRange(512), default=DEFAULT.memory, show_default=True, help="MB for a submission.")
@click.option("--executor", default="", help="A Dask scheduler's address: grade on its cluster.")
@click.option("--again", is_flag=True, help="Grade also what has been graded.")
@click.option("--force", is_flag=True, help="Grade without trying SOURCE's own solution first.")
def grade(
    source: Path, submissions: Path, table: Path, feedback: Path | None, results: Path | None, roster: Path | None, jobs: int,
    sandbox: str, seed: int | None, cell_time: float, total_time: float, memory: int, executor: str, again: bool,
    force: bool,
) -> None:  # fmt: skip
    """Grade the folder SUBMISSIONS against SOURCE, the instructor's notebook with solutions.

    A submission is a file student.ipynb, or a folder named after the student with a notebook inside. Each is run in a process
    of its own; none is changed, and none stops the others. A task is right on all of its cases, or gives no points.
    SOURCE's own solution is graded first, and must get all points. What was graded before is not graded again.

    Points for open questions you type into their empty columns of the table, and call this again: it keeps them, and what
    you type into late_submission_penalty and into columns of your own, and adds them up.

    The exit code is 0 when every submission got a verdict, 1 when one could not be graded.
    """
    limits = Limits(cell_time, total_time, memory)
    folder = results or table.with_name(f"{table.stem}.results")
    written = folder / f"written-{table.name}"
    pages = [feedback] if feedback else []
    with _disk():
        assignment, notes = homework_from(source, seed_in(folder) if seed is None else seed, sandbox, limits)
        for note in notes:
            click.echo(f"note: {note}", err=True)
        found, aside = find(submissions, source.name, [folder, table, *pages])
        people = read_roster(roster) if roster else {}
        typed = read_typed(table, assignment.name, assignment.tasks, {*people, *(s.student for s in found)}, written)
        for place in (folder, table.parent, *pages):
            place.mkdir(parents=True, exist_ok=True)
            TemporaryFile(dir=place).close()  # better now than when all has been graded
        if not executor:
            _warn_of_sandbox(assignment)
        graded = _graded(assignment, None if force else source, found, folder, jobs, executor, again)
        absent = [nothing(student, assignment.tasks, ABSENT) for student in people if student not in {s.student for s in found}]
        everyone = [with_points(result, typed_of(result, typed).points) for result in (*graded, *absent)]
        write_marks(table, assignment.name, assignment.tasks, everyone, people, typed)
        write(written, table.read_text(encoding="utf-8"))
        for at, submission, result in ((at, *pair) for at in pages for pair in zip(found, everyone, strict=False)):
            write(at / f"{submission.file_name}.html", page(result, assignment.name, typed_of(result, typed).penalty))
    _tell(everyone[: len(graded)], absent, people, aside)
    click.echo(f"wrote {table}" + (f" and {many(len(graded), 'page')} in {feedback}" if feedback else ""))
    if any(result.trouble for result in graded):
        raise SystemExit(1)


@contextmanager
def _disk() -> Iterator[None]:
    """Says what went wrong with a folder or a file, in a sentence."""
    try:
        yield
    except OSError as error:
        raise NotebookError(f"{error.filename or 'a file could not be written'}: {error.strerror or error}") from None


def _graded(
    assignment: Homework, source: Path | None, found: list[Submission], folder: Path, jobs: int, address: str, again: bool
) -> list[Result]:
    """The results of what was ``found``, after the instructor's own solution in ``source`` proved right."""
    from tqdm import tqdm

    try:
        with executor_of(address, jobs) as (executor, at_once):
            if source:
                check_solution(assignment, source, folder, executor, again)
            with tqdm(total=len(found), unit="submission", disable=None) as bar:
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
            "your files, reach the network, disturb the grader, and import a solver: run it where nothing can be harmed, and "
            "look at the scans.",
            err=True,
        )


def _tell(graded: list[Result], absent: list[Result], people: Mapping[str, object], aside: list[str]) -> None:
    marked = [result for result in graded if not result.trouble]
    for result in graded:
        if result.trouble:
            click.echo(f"{result.student}: {result.trouble}")
        if people and result.student not in people:
            click.echo(f"{result.student}: not in the roster")
    for result in absent:
        click.echo(f"{result.student}: {ABSENT}")
    if aside:
        click.echo(f"left aside: {', '.join(aside[:NAMED])}{', ...' if len(aside) > NAMED else ''}")
    open_to_all = sum(not result.sandboxed for result in marked)
    if open_to_all:
        click.echo(f"warning: graded without a sandbox: {many(open_to_all, 'submission')}", err=True)
    told = many(len(graded), "submission")
    told += f": {len(marked)} graded, {len(graded) - len(marked)} not" if len(marked) < len(graded) else ""
    told += f"; median {median(result.score for result in marked):g} points" if marked else ""
    waiting = sum(task.score is None for result in marked for task in result.tasks)
    click.echo(told + (f", with {many(waiting, 'answer')} still to be marked by hand" if waiting else ""))
