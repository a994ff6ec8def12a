"""Whose notebook is where: the folders that Moodle, Canvas and nbgrader make, and one flat folder of notebooks."""

from __future__ import annotations

import hashlib
import os
import re
import stat
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from fem_mesh.course.homework.results import clean
from fem_mesh.course.notebooks import NotebookError

LARGEST = 20 << 20  # bytes of a submission
DEEPEST = 4  # folders below a student's
_SKIPPED = (".ipynb_checkpoints", "__MACOSX")


@dataclass(frozen=True)
class Submission:
    """A student's notebook, or why there is none.

    submitted : when its file was last changed
    unlike : what tells the files about this student from those about one with much the same name
    """

    student: str
    path: Path
    trouble: str = ""
    submitted: str = ""
    unlike: str = ""

    @property
    def file_name(self) -> str:
        """What files about this student are called, without an ending: names can be as long as a file's may be."""
        name = self.student.replace("/", "_").replace("\\", "_")
        name = name if len(name.encode()) <= 100 else f"{name[:25]}-{hashlib.sha256(name.encode()).hexdigest()[:12]}"
        return f"{name}{self.unlike}"


def find(folder: Path, name: str, but: Collection[Path] = ()) -> tuple[list[Submission], list[str]]:
    """The submissions in ``folder``, by student, and the names of what was left aside. ``name`` is the homework's file name.

    A file ``ada.ipynb`` is Ada's; a folder ``ada`` is Ada's, with her notebook somewhere inside. Where there are several,
    the one called ``name`` counts. What is in ``but`` is the grader's own. Raises NotebookError where there is nothing at all.
    """
    found, aside, entries = dict[str, Submission](), [], dict[str, Path]()
    own, folder = {path.resolve() for path in but}, folder.resolve()
    for entry in sorted(folder.iterdir()):
        if entry.name.startswith(".") or entry.name in _SKIPPED or entry in own:
            continue
        is_notebook = entry.suffix.lower() == ".ipynb"
        if not is_notebook and not entry.is_dir():
            aside.append(_shown(entry.name))
            continue
        student = _shown(entry.stem if is_notebook else entry.name)
        if student in found:
            trouble = f"both {_shown(entries[student].name)} and {_shown(entry.name)} are here: which one counts?"
            found[student] = Submission(student, found[student].path, trouble)
        else:
            found[student], entries[student] = _of_student(student, entry, name), entry
    if not found:
        raise NotebookError(f"{folder}: no notebooks in it, and no folders: a student's is ada.ipynb, or ada/{name}")
    return list(_told_apart(found.values())), aside


def _told_apart(found: Iterable[Submission]) -> Iterator[Submission]:
    taken = set()
    for submission in found:
        while submission.file_name.lower() in taken:  # file systems that do not tell a from A keep one page for both
            submission = replace(submission, unlike=f"{submission.unlike}+")
        taken.add(submission.file_name.lower())
        yield submission


def _shown(name: str) -> str:
    """A file's name as text that can be written anywhere."""
    return clean(re.sub(r"[\t\n]", " ", name.encode("utf-8", "replace").decode("utf-8")))


def _of_student(student: str, entry: Path, name: str) -> Submission:
    if not entry.is_dir() or entry.is_symlink():
        return _checked(student, entry)
    notebooks = sorted(_notebooks(entry, 0))
    named = [path for path in notebooks if path.name == name]
    chosen = named if len(named) == 1 else notebooks
    if len(chosen) != 1:
        what = f"{len(chosen)} notebooks" if chosen else "no notebook"
        what += f", and {len(named) or 'not one'} of them called {name}" if chosen else ""
        return Submission(student, entry, f"the folder {_shown(entry.name)} holds {what}")
    return _checked(student, chosen[0])


def _notebooks(folder: Path, depth: int) -> Iterator[Path]:
    try:
        entries = sorted(folder.iterdir())
    except OSError:
        return
    for entry in entries:
        if entry.name in _SKIPPED or entry.is_symlink():
            continue
        if entry.is_dir():
            if depth < DEEPEST:
                yield from _notebooks(entry, depth + 1)
        elif entry.suffix.lower() == ".ipynb":
            yield entry


def _checked(student: str, path: Path) -> Submission:
    try:
        about = path.lstat()
    except OSError as error:
        return Submission(student, path, f"the file cannot be read: {error.strerror}")
    if not stat.S_ISREG(about.st_mode):  # a link may lead to another student's work, or to the solution
        return Submission(student, path, "this is a link or a device, but no file")
    submitted = datetime.fromtimestamp(about.st_mtime, UTC).isoformat(sep=" ", timespec="seconds")
    if about.st_size > LARGEST:
        return Submission(student, path, f"the file has {about.st_size >> 20} MB, more than {LARGEST >> 20}", submitted)
    return Submission(student, path, "", submitted)


def contents(submission: Submission) -> bytes:
    """The bytes of a submission; at most one more than the largest may have. Raises OSError."""
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    with open(os.open(submission.path, flags), "rb") as file:
        return file.read(LARGEST + 1)
