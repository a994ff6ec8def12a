"""A class: every submission in a process of its own, a few at a time, here or on a cluster; what is done stays done."""

from __future__ import annotations

import contextlib
import hashlib
import json
import secrets
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import fem_mesh
from fem_mesh.course import notebooks
from fem_mesh.course.homework.cells import Task, homework_of, tasks_of
from fem_mesh.course.homework.drive import START, clear, end
from fem_mesh.course.homework.release import release
from fem_mesh.course.homework.results import BY_HAND, HELD, UNANSWERED, Marked, Result, from_json, nothing, to_json, write
from fem_mesh.course.homework.sandbox import Limits, box_of
from fem_mesh.course.homework.submissions import LARGEST, Submission, contents
from fem_mesh.course.notebooks import NotebookError

ANSWERING = 15.0  # seconds that a scheduler may take to answer
JUDGING = 60.0  # seconds that a worker may take besides the kernel's


@dataclass(frozen=True)
class Homework:
    """What all submissions are graded against.

    released : the students' version, as JSON: no solution goes near a student's code
    """

    name: str
    released: str
    tasks: list[Task]
    packages: tuple[str, ...]
    seed: int
    sandbox: str
    limits: Limits

    @property
    def key(self) -> str:
        """Of everything but the submission that marks depend on, this library's own code among it."""
        told = [self.released, self.seed, asdict(self.limits), self.sandbox, _code()]
        return hashlib.sha256(json.dumps(told).encode()).hexdigest()


@cache
def _code() -> str:
    """Of what judges: this library's own code, as it is when it is first asked for, Python and NumPy."""
    code = hashlib.sha256(f"{sys.version} {np.__version__}".encode())
    for path in sorted(Path(fem_mesh.__file__).parent.rglob("*.py")):
        code.update(path.read_bytes())
    return code.hexdigest()


def seed_in(folder: Path) -> int:
    """The seed that is kept in a folder of results. It is drawn when it is first asked for, so that nobody knows the cases
    beforehand, not even who knows the notebook, and stays: two runs have the same cases.
    """
    file = folder / "seed.txt"
    with contextlib.suppress(OSError, ValueError):
        return int(file.read_text(encoding="utf-8"))
    folder.mkdir(parents=True, exist_ok=True)
    seed = secrets.randbits(128)
    file.write_text(f"{seed}\n", encoding="utf-8")
    return seed


def homework_from(path: Path, seed: int, sandbox: str, limits: Limits) -> tuple[Homework, list[str]]:
    """The homework in the instructor's notebook ``path``, and what the instructor should know of it."""
    source = notebooks.read(path)
    released, notes = release(source)
    about = homework_of(source)
    name = about["homework"] or path.stem
    tasks = tasks_of(released)
    return Homework(name, json.dumps(released), tasks, tuple(about["packages"]), seed, sandbox, limits), notes


def check_solution(homework: Homework, source: Path, folder: Path, executor: Executor, again: bool = False) -> None:
    """Grade the instructor's own notebook, as a student's. Raises NotebookError where it does not get all points."""
    result = grade_class(homework, [Submission("solution", source)], folder / "solution", executor, 1, again=again)[0]
    wrong = [f"{task.name}: {task.message}" for task in result.tasks if not _is_right(task)]
    if result.trouble or wrong:
        raise NotebookError(
            f"{source}: your own solution does not get all points, so nothing was graded. {result.trouble or wrong[0]}. "
            "(--force grades all the same.)"
        )


def _is_right(task: Marked) -> bool:
    return task.message in (BY_HAND, HELD, UNANSWERED) if task.score is None else task.score == task.points


def grade_submission(job: dict[str, Any]) -> dict[str, Any]:
    """Grade one submission in a process of its own, on whatever machine this runs: plain data in, plain data out."""
    limits = Limits(**job["limits"])
    box = box_of(job["sandbox"], tuple(job["packages"]))
    nonce = secrets.token_hex(16)
    base = Path(tempfile.mkdtemp(prefix="fm-"))
    try:
        told = {**job, "box": asdict(box), "base": str(base), "nonce": nonce, "memory": 2 * limits.memory}
        said, trouble = _worked(json.dumps(told), limits.total + START + JUDGING)
        if trouble:
            return {"trouble": trouble}
        answer = json.loads(said)
        return (
            {"result": answer["result"]} if answer["nonce"] == nonce else {"trouble": "the grader's process was tampered with"}
        )
    except (ValueError, TypeError, KeyError):
        return {"trouble": "the grader's process said nothing that makes sense"}
    finally:
        clear(base)


def _worked(job: str, seconds: float) -> tuple[str, str]:
    """What the process said, or what went wrong with it."""
    command = [sys.executable, "-sP", "-m", "fem_mesh.course.homework.grade_one"]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        said, error = process.communicate(job, timeout=seconds)
    except subprocess.TimeoutExpired:
        return "", f"not done after {seconds:.0f} seconds"
    finally:
        if process.poll() is None:
            end(process.pid)
            process.wait()
    if process.returncode == 0:
        return said, ""
    last = (error.strip().splitlines() or [f"exit code {process.returncode}"])[-1]
    return "", f"the grader's process ended early: {last}"


def grade_class(
    homework: Homework,
    submissions: Sequence[Submission],
    folder: Path,
    executor: Executor,
    jobs: int,
    progress: Callable[[], object] = lambda: None,
    again: bool = False,
) -> list[Result]:
    """Results of ``submissions``, in their order, each kept in ``folder`` as soon as it is there.

    What is there already, of the same submission and homework, is not graded again, unless ``again``. ``jobs`` are under
    way at a time. No submission, whatever it is, stops the others.
    """
    folder.mkdir(parents=True, exist_ok=True)
    base, results = homework.key, dict[str, Result]()
    waiting: dict[Future[dict[str, Any]], tuple[Submission, str]] = {}

    def settle(least: int) -> None:
        while len(waiting) > least:
            for future in wait(waiting, return_when=FIRST_COMPLETED).done:
                submission, key = waiting.pop(future)
                keep(submission, _result_of(future, homework, submission), key)

    def keep(submission: Submission, result: Result, key: str) -> None:
        result = replace(result, student=submission.student, submitted=submission.submitted, key=key)
        results[submission.student] = result
        write(_file(folder, submission), to_json(result))
        progress()

    try:
        for submission in submissions:
            content, trouble = _content(submission)
            key = hashlib.sha256(f"{base} {trouble} ".encode() + content).hexdigest()
            kept = None if again else _kept(_file(folder, submission), key, homework.tasks)
            if kept:
                results[submission.student] = replace(kept, submitted=submission.submitted)
                progress()
            elif trouble:
                keep(submission, nothing(submission.student, homework.tasks, trouble), key)
            else:
                settle(jobs - 1)
                waiting[executor.submit(grade_submission, _job(homework, submission, content))] = (submission, key)
        settle(0)
    finally:
        for future in waiting:
            future.cancel()
    return [results[submission.student] for submission in submissions]


def _content(submission: Submission) -> tuple[bytes, str]:
    if submission.trouble:
        return b"", submission.trouble
    try:
        content = contents(submission)
    except OSError as error:
        return b"", f"the file cannot be read: {error.strerror}"
    return (content, "") if len(content) <= LARGEST else (b"", f"the file has more than {LARGEST >> 20} MB")


def _job(homework: Homework, submission: Submission, content: bytes) -> dict[str, Any]:
    return {
        "student": submission.student,
        "released": homework.released,
        "submission": content.decode("latin-1"),  # bytes in a text: JSON has no other place for them
        "seed": homework.seed,
        "sandbox": homework.sandbox,
        "packages": list(homework.packages),
        "limits": asdict(homework.limits),
    }


def _result_of(future: Future[dict[str, Any]], homework: Homework, submission: Submission) -> Result:
    try:
        told = future.result()
        trouble = told.get("trouble", "")
        return nothing(submission.student, homework.tasks, trouble) if trouble else from_json(told["result"], homework.tasks)
    except Exception as error:  # of a cluster's machine, say: one submission, not the class
        return nothing(submission.student, homework.tasks, f"the grader failed ({type(error).__name__}: {error})")


def _file(folder: Path, submission: Submission) -> Path:
    return folder / f"{submission.file_name}.json"


def _kept(path: Path, key: str, tasks: list[Task]) -> Result | None:
    try:
        result = from_json(path.read_text(encoding="utf-8"), tasks)
    except (OSError, ValueError):
        return None
    return result if result.key == key else None


@contextmanager
def executor_of(address: str, jobs: int) -> Iterator[tuple[Executor, int]]:
    """Where submissions are graded, and how many at a time: threads here, or the cluster of a Dask scheduler."""
    if not address:
        with ThreadPoolExecutor(jobs) as threads:
            yield threads, jobs
        return
    try:
        from distributed import Client
    except ImportError:
        raise NotebookError('distributed is missing: pip install "fem_mesh[cluster]"') from None
    try:
        client = Client(address, timeout=ANSWERING)
    except (OSError, ValueError) as error:
        raise NotebookError(f"no Dask scheduler answers at {address}: {error}") from None
    with client:
        yield client.get_executor(pure=False), max(1, 2 * sum(client.nthreads().values()))
