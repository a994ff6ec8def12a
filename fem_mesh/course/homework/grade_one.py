"""One submission, from bytes to marks. Run as a process of its own: ``python -m fem_mesh.course.homework.grade_one``.

It reads a job from standard input and writes a result to standard output, both JSON. The student's code runs in a
further process, the kernel; what that shows in a check cell is verified here.
"""

from __future__ import annotations

import contextlib
import json
import signal
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fem_mesh.check import Verdict, judge
from fem_mesh.course.homework.asked import cases_of_call, given_in, names_in
from fem_mesh.course.homework.cells import Task, homework_of, role, tasks_of
from fem_mesh.course.homework.drive import KernelLost, Ran, clear, kernel_in
from fem_mesh.course.homework.merge import Merged, label_of, merge
from fem_mesh.course.homework.packages import Place
from fem_mesh.course.homework.reasons import Failed, answers_before, hint
from fem_mesh.course.homework.results import BY_HAND, HELD, UNANSWERED, UNWRITTEN, Marked, Result, nothing, to_json
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
    seen = _run(merged, tasks, released, box, limits, base)
    answers = answers_before(released, tasks)
    marked = [
        _mark_by_hand(task, seen, answers[task.at], merged, released.cells[task.at])
        if task.by_hand
        else _mark(task, seen, cases, answers[task.at], merged, released)
        for task in tasks
    ]
    notes = [*merged.notes, *([f"the kernel did not live to the end: {seen.lost}"] if seen.lost else [])]
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
    except ValueError:
        what = "the file is empty" if not submission.strip() else "the file is no notebook (it is not JSON)"
        raise NotebookError(f"{what}: save the notebook in JupyterLab, and hand in the file that ends in .ipynb") from None
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


@dataclass
class Seen:
    """What came of a run.

    ran : of the cells that are worth points, by their place
    failed : the other cells that raised something, in order
    lost : why the kernel was lost, or an empty string
    """

    ran: dict[int, Ran] = field(default_factory=dict)
    failed: list[Failed] = field(default_factory=list)
    lost: str = ""


def _run(merged: Merged, tasks: list[Task], released: Any, box: Box, limits: Limits, base: Path) -> Seen:
    checks = {task.at for task in tasks}
    seen = Seen()
    try:
        with kernel_in(box, base, limits) as kernel:
            for source, at in merged.cells:
                if source.strip():
                    came = kernel.run(source)
                    if at in checks:
                        seen.ran[at] = came
                    elif came.error:
                        label = label_of(released.cells[at]) if at >= 0 else "a cell that you added"
                        seen.failed.append(Failed(label, source, came.error, came.line))
    except KernelLost as error:
        seen.lost = str(error)
    return seen


def _mark_by_hand(task: Task, seen: Seen, own: list[str], merged: Merged, cell: Any) -> Marked:
    """A task to be marked by hand: an open answer, or a cell of tests that nobody but the student's kernel has run."""
    if role(cell) == "explain":
        text = merged.answers.get(task.name, "")
        answered = text.strip() and (task.name not in merged.untouched or not cell.metadata["nbgrader"].get("solution"))
        said, text = (BY_HAND, text) if answered else (UNANSWERED, "")
    else:
        text = "\n\n".join(merged.answers[name] for name in own if name in merged.answers)
        ran = seen.ran.get(task.at, Ran(error=seen.lost))
        said = f"{BY_HAND}; when it was run: {ran.error}" if ran.error else HELD
        if own and merged.untouched.issuperset(own):
            said, text = UNWRITTEN, ""
    return Marked(task.name, task.title, task.points, None, said, text=text[:LONGEST])


def _mark(
    task: Task, seen: Seen, cases: Mapping[str, Any], own: list[str], merged: Merged, released: Any
) -> Marked:  # fmt: skip
    ran = seen.ran.get(task.at)
    if ran is None:
        return Marked(task.name, task.title, task.points, 0, f"the check did not run to its end: {seen.lost}")
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
            before = f"right on {verdict.passed} of {verdict.total} cases, then: " if verdict.passed else ""
            why = hint(verdict.message, seen.failed, merged, released)
            messages.append(f"{before}{verdict}" + (f"; {why}" if why else ""))
    if len(answers) < len(task.calls):
        why = hint(ran.error, seen.failed, merged, released) or ran.error or "it showed nothing"
        messages.append(f"no answer came to the check {task.calls[len(answers)].name}: {why}")
    if messages and own and merged.untouched.issuperset(own):
        return Marked(task.name, task.title, task.points, 0, UNWRITTEN)
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


def _end_with_parent() -> None:
    """Where the command is killed, end as by an exception, so that the kernel ends, too, and its folder goes."""

    def leave(*_: object) -> None:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)  # it comes once for each thread that dies, and cleaning up takes a while
        sys.exit("ended from outside")

    signal.signal(signal.SIGTERM, leave)
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG


def main() -> None:
    """Read a job, grade it, write the result."""
    _end_with_parent()
    job = json.load(sys.stdin)
    try:
        _grade(job)
    finally:
        clear(Path(job["base"]))


def _grade(job: dict[str, Any]) -> None:
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
