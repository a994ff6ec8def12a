"""One submission, from bytes to marks. Run as a process of its own: ``python -m fem_mesh.course.homework.grade_one``.

It reads a job from standard input and writes a result to standard output, both JSON. The student's code runs in a
further process, the kernel; what that shows in a check cell is verified here.
"""

from __future__ import annotations

import contextlib
import json
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fem_mesh.check import Verdict, judge
from fem_mesh.course.homework.asked import cases_of_call, given_in, names_in
from fem_mesh.course.homework.cells import Task, homework_of, tasks_of
from fem_mesh.course.homework.drive import KernelLost, Ran, kernel_in
from fem_mesh.course.homework.merge import Merged, merge
from fem_mesh.course.homework.packages import Place
from fem_mesh.course.homework.results import Marked, Result, nothing, to_json
from fem_mesh.course.homework.room import furnish
from fem_mesh.course.homework.sandbox import Box, Limits
from fem_mesh.course.homework.scan import scan
from fem_mesh.course.notebooks import NotebookError

LONGEST = 20_000  # characters of an open answer
NESTED = 100  # levels of lists in an answer; the judge needs five


def grade_one(released: Any, submission: bytes, student: str, seed: int, box: Box, limits: Limits, base: Path) -> Result:
    """Mark ``submission``, the bytes of a student's notebook, against ``released``, the students' version.

    ``released`` is nbformat's dictionary, ``base`` an empty folder that may be filled. Never raises for anything that a
    student can hand in.
    """
    began, tasks = time.monotonic(), tasks_of(released)
    try:
        notebook = read(submission)
    except NotebookError as error:
        return nothing(student, tasks, error.message)
    merged, about = merge(released, notebook), homework_of(released)
    calls = [call for task in tasks for call in task.calls]
    given = given_in(released)
    cases = {call.text: cases_of_call(call, seed, given) for call in calls}
    shown = {call.name: cases[call.text] for call in calls if call.name != "mesh"}  # a mesh comes without being asked for
    uses = sorted({*about["uses"], *names_in(call.text for call in calls)})
    furnish(base / "room", uses, shown, box, limits)
    ran, lost = _run(merged, tasks, box, limits, base)
    marked = [_mark(task, ran.get(task.at), cases, lost, merged) for task in tasks]
    notes = [*merged.notes, *([f"the kernel did not live to the end: {lost}"] if lost else [])]
    findings = scan(merged.code, merged.added, about["uses"])
    return Result(student, marked, "", notes, findings, bool(box.bwrap), round(time.monotonic() - began, 2))


def read(submission: bytes) -> dict[str, Any]:
    """A student's notebook as plain data. Raises NotebookError, a sentence for the student, where it is none."""
    try:
        notebook = json.loads(submission.decode("utf-8-sig"))
    except UnicodeDecodeError:
        raise NotebookError("the file is no text, so no notebook") from None
    except RecursionError:
        raise NotebookError("the file is no notebook: it is nested too deeply") from None
    except ValueError as error:
        what = "it is empty" if not submission.strip() else f"no JSON ({error})"
        raise NotebookError(f"the file is no notebook: {what}") from None
    if not isinstance(notebook, dict):
        raise NotebookError("the file is no notebook: it is JSON, but no object")
    if isinstance(notebook.get("worksheets"), list):  # nbformat 3
        sheets = [sheet.get("cells") for sheet in notebook["worksheets"] if isinstance(sheet, dict)]
        cells = [cell for sheet in sheets if isinstance(sheet, list) for cell in sheet]
        notebook["cells"] = [{"source": cell.get("input"), **cell} for cell in cells if isinstance(cell, dict)]
    if not isinstance(notebook.get("cells"), list):
        raise NotebookError("the file is no notebook: it has no cells")
    if not notebook["cells"]:
        raise NotebookError("the notebook is empty: it has no cells")
    return notebook


def _run(merged: Merged, tasks: list[Task], box: Box, limits: Limits, base: Path) -> tuple[dict[int, Ran], str]:
    """What came of the check cells, by their place, and why the kernel was lost, or nothing."""
    checks = {task.at for task in tasks}
    ran: dict[int, Ran] = {}
    try:
        with kernel_in(box, base, limits) as kernel:
            for source, at in merged.cells:
                if source.strip():
                    came = kernel.run(source)
                    if at in checks:
                        ran[at] = came
    except KernelLost as error:
        return ran, str(error)
    return ran, ""


def _mark(task: Task, ran: Ran | None, cases: Mapping[str, Any], lost: str, merged: Merged) -> Marked:
    if task.by_hand:
        text = merged.answers.get(task.name, "")[:LONGEST]
        return Marked(task.name, task.title, task.points, None, "to be marked by hand", text=text)
    if ran is None:
        return Marked(task.name, task.title, task.points, 0, f"the check did not run to its end: {lost}")
    answers = ran.answers
    if len(answers) > len(task.calls):
        said = f"the check cell showed {len(answers)} answers where it asks for {len(task.calls)}"
        return Marked(task.name, task.title, task.points, 0, said)
    verdicts: list[Verdict] = []
    messages = []
    for call, answer in zip(task.calls, answers, strict=False):
        verdict = _judged(call.name, answer, cases[call.text])
        verdicts.append(verdict)
        if not verdict.right:
            messages.append(str(verdict))
    if len(answers) < len(task.calls):
        messages.append(f"no answer came to the check {task.calls[len(answers)].name}: {ran.error or 'it showed nothing'}")
    said = messages[0] if messages else "; ".join(map(str, verdicts))
    return Marked(task.name, task.title, task.points, 0 if messages else task.points, said, [v.as_json() for v in verdicts])


def _judged(name: str, answer: Any, cases: list[dict[str, Any]]) -> Verdict:
    if not isinstance(answer, dict) or answer.get("check") != name or _depth(answer) > NESTED:
        return Verdict(name, False, "what the check cell showed is no answer to this check")
    return judge(name, answer, cases)


def _depth(thing: Any) -> int:
    """How deeply lists and dictionaries are nested."""
    depth, level = 0, [thing]
    while level and depth <= NESTED:
        level = [
            inner
            for item in level
            for inner in (item.values() if isinstance(item, dict) else item if isinstance(item, list) else ())
        ]
        depth += 1
    return depth


class Node(dict[str, Any]):
    """A part of a notebook, as nbformat's: but importing nbformat takes longer than most submissions."""

    def __getattr__(self, name: str) -> Any:
        if name not in self:
            raise AttributeError(name)
        return self[name]


def main() -> None:
    """Read a job, grade it, write the result."""
    job = json.load(sys.stdin)
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        most = job["memory"] << 20  # a submission may be made to fill the memory of whoever reads it
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
    told = job["box"]
    box = Box(Place(**told["place"]), told["bwrap"], told["why"], told["options"])
    released = json.loads(job["released"], object_hook=Node)
    submission = job["submission"].encode("latin-1")
    result = grade_one(released, submission, job["student"], job["seed"], box, Limits(**job["limits"]), Path(job["base"]))
    sys.stdout.write(json.dumps({"nonce": job["nonce"], "result": to_json(result)}))


if __name__ == "__main__":
    main()
