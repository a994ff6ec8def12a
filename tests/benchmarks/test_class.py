"""What a class of a hundred takes: 90 ordinary submissions, and 10 that attack the grader; and the later homeworks."""

import copy
import statistics
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "homework"))

from answers import NAMES, notebook_of
from attacks import ATTACKS
from classroom import Class, cell
from test_notebooks import PARTLY

LIMIT = 10  # seconds for a cell
CHOSEN = [
    *("endless loop", "swallows the timeout", "sleeps for ever in C", "50 GB", "fork bomb", "kills its parent", "floods"),
    *("forges a report", "network", "ready-made predicate"),
]
LATE = 3  # of these are ended at the limit


@pytest.mark.parametrize(("name", "students"), [(NAMES[0], 90), *((name, 10) for name in NAMES[1:])])
def test_a_class_is_graded(name, students, line, tmp_path):
    course = Class(tmp_path, notebook_of(name))
    answers = [None, *PARTLY[name].values()]
    for k in range(students):
        notebook, answer = copy.deepcopy(notebook_of(name)), answers[k % len(answers)]
        if answer:
            cell(notebook, answer[0]).source = answer[1]
        course.submit(f"student {k:02d}", notebook)
    attacks = CHOSEN if name == NAMES[0] else []
    for attack in attacks:
        notebook = copy.deepcopy(notebook_of(name))
        cell(notebook, "answer-orient").source = attack_on(tmp_path, attack)
        course.submit(attack, notebook)
    took, peak = grade(course)
    results = course.results()
    assert len(results) == students + len(attacks)
    ordinary = [told["seconds"] for student, told in results.items() if student.startswith("student")]
    line(f"{name}: {len(results)} submissions", f"{took:.0f} s")
    line("an ordinary one: median, longest", f"{statistics.median(ordinary):.2f}, {max(ordinary):.2f} s", reach="<= 4 s")
    line("the grader's own memory", f"{peak >> 20} MB", reach="<= 300 MB")
    if attacks:
        longest = sorted(results[attack]["seconds"] for attack in attacks)[::-1]
        line(
            f"the {LATE} longest attacks",
            ", ".join(f"{seconds:.1f}" for seconds in longest[:LATE]) + " s",
            reach=f"{LIMIT} s a cell",
        )


def attack_on(folder, name):
    code = ATTACKS[name][0]
    for word, value in {"port": 9, "outside": str(folder / "outside"), "here": str(folder)}.items():
        code = code.replace("{" + word + "!r}", repr(value)).replace("{" + word + "}", str(value))
    return code


def grade(course):
    """Grade as an instructor does; returns the seconds, and the most bytes that the grader itself had."""
    command = [Path(sys.executable).with_name("fem-mesh"), "homework", "grade", course.source, course.submissions]
    options = ["--csv", course.folder / "grades.csv", "--feedback", course.folder / "out", "--jobs", 2, "--cell-time", LIMIT]
    start, peak = time.monotonic(), 0
    process = subprocess.Popen(list(map(str, [*command, *options])), stderr=subprocess.DEVNULL)
    grader = psutil.Process(process.pid)
    while process.poll() is None:
        if grader.status() != psutil.STATUS_ZOMBIE:
            peak = max(peak, grader.memory_info().rss)
        time.sleep(0.2)
    assert process.returncode == 0
    return time.monotonic() - start, peak
