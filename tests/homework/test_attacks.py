"""Submissions that want points they did not earn: none gets one, none stops the run, none leaves its folder.

Where bubblewrap is not installed, those that need it are skipped, for there the command itself warns.
"""

import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import textwrap
import time
from pathlib import Path

import nbformat
import numpy as np
import psutil
import pytest
from attacks import ATTACKS, LEFT_OVER, MESHERS, SLOW, WRONG, mesher
from classroom import IN_CIRCLE, ORIENT, Class, cell, source
from nbformat.v4 import new_code_cell

import fem_mesh as fm
from fem_mesh.check import cases_of, judge, run
from fem_mesh.check.run import fresh
from fem_mesh.course.homework.cells import metadata
from fem_mesh.course.homework.sandbox import box_of

WITHOUT_BOX = {"strips asserts", "forged verdict", "dies"}  # must fail without it too
NEEDS = pytest.mark.skipif(not box_of("auto").bwrap, reason="bubblewrap is not installed")


def each(names):
    return [pytest.param(name, marks=pytest.mark.exhaustive) if name in SLOW else name for name in names]


@pytest.fixture(scope="module")
def listener():
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(0.2)
        yield server


def only(things, out):
    return [(name, thing) for name, thing in things.items() if name not in out]


@pytest.fixture(scope="module")
def attacked(request, tmp_path_factory, listener):
    course = Class(tmp_path_factory.mktemp("attacks"), with_bowyer_watson())
    out = set() if request.config.option.markexpr == "exhaustive" else SLOW
    outside = course.folder / "outside"
    outside.mkdir()
    words = {"port": listener.getsockname()[1], "outside": str(outside), "here": str(Path(fm.__file__).parents[1])}
    for name, (code, _) in only(ATTACKS, out):
        for word, value in words.items():
            code = code.replace("{" + word + "!r}", repr(value)).replace("{" + word + "}", str(value))
        course.submit(name, course.notebook(orient=code))
    course.submit("half a character", half_a_character(course))
    for name, body in only(MESHERS | LEFT_OVER, out):
        notebook = course.notebook(orient=None, circle=None)
        cell(notebook, "a-mesh").source = mesher(body, here=words["here"], packages=str(Path(np.__file__).parents[1]))
        course.submit(f"mesher {name}", notebook)
    for name, change in only(SHAPES, out):
        notebook = course.notebook(orient=WRONG)
        change(notebook)
        course.submit(f"shape {name}", notebook, f"shape {name}/hw.ipynb")
        (course.submissions / f"shape {name}" / "conftest.py").write_text("raise SystemExit(0)")
        (course.submissions / f"shape {name}" / "numpy.py").write_text("raise SystemExit(0)")
    course.submit("remembers", course.notebook(orient=remembered()))
    course.submit("zz honest")
    before = {path: path.read_bytes() for path in sorted(course.submissions.rglob("*")) if path.is_file()}
    course.rooms = Path(tempfile.mkdtemp(prefix="t-"))  # short, for sockets have short names; and ours alone
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tempfile, "tempdir", str(course.rooms))
        course.result = course.grade("--sandbox", "required", "--cell-time", 4, "--total-time", 20, "--memory", 1024)
    course.outside = outside
    assert before == {path: path.read_bytes() for path in sorted(course.submissions.rglob("*")) if path.is_file()}
    yield course
    shutil.rmtree(course.rooms)


def half_a_character(course):
    """Right, with halves of characters wherever a student can write them, and turns of the direction of text."""
    notebook = course.notebook(orient=f"{ORIENT}\nhalf = '\ud800'\nclass \u0431(Exception): pass")
    cell(notebook, "a-circle").source = "def in_circle(*points):\n    raise ValueError(chr(0xD800) + chr(0x202E) + chr(27))"
    cell(notebook, "explain").source = "\ud800 and \u202e"
    return notebook


def remembered():
    """Right on every case that students see, learnt by heart."""
    space = {}
    exec(ORIENT, space)
    known = {repr(fresh(points)): space["orient"](*points) for case in cases_of("orient") for points in case["calls"]}
    return f"KNOWN = {known!r}\ndef orient(a, b, c):\n    return KNOWN.get(repr([a, b, c]), 1)"


def with_bowyer_watson():
    notebook = source()
    notebook.cells += [
        new_code_cell("def bowyer_watson(points):\n    # BEGIN SOLUTION\n    yield []\n    # END SOLUTION", id="a-mesh",
                      metadata=metadata("answer", "mesh")),
        new_code_cell("fm.check.bowyer_watson(bowyer_watson)", id="c-mesh", metadata=metadata("check", "check-mesh", 4)),
    ]  # fmt: skip
    return notebook


def _skip_tags(notebook):
    check = cell(notebook, "c-orient")
    check.source, check.metadata["tags"] = "# NBVAL_SKIP\n" + check.source, ["nbval-skip", "raises-exception"]


def _cleared(notebook):
    for each in notebook.cells:
        if each.cell_type == "code":
            each.outputs, each.execution_count = [], None


def _without_checks(notebook):
    notebook.cells = [each for each in notebook.cells if not each.id.startswith("c-")]


def _easier_check(notebook):
    twin = cell(notebook, "c-orient").copy()
    cell(notebook, "c-orient").source = "fm.check.orient(lambda a, b, c: 0) if 0 else None"
    notebook.cells.append(twin)


def _retyped_check(notebook):
    cell(notebook, "c-orient").cell_type = "markdown"


def _richer(notebook):
    cell(notebook, "c-orient").metadata.nbgrader.points = 1000
    cell(notebook, "a-orient").metadata.nbgrader.update(grade=True, points=1000)
    notebook.metadata["fem_mesh"] = {"homework": "../../x", "uses": ["delaunay", "orient"], "packages": ["scipy"]}
    notebook.metadata["kernelspec"] = {"name": "evil", "display_name": "x", "language": "bash"}


def _imports_more(notebook):
    cell(
        notebook, "imports"
    ).source = "import sys\nfrom fem_mesh.predicates import orient\nimport fem_mesh as fm\nfm.check.orient = lambda f: f(0)"
    cell(notebook, "a-orient").source = "# is imported"


def _with_outputs(notebook):
    check = cell(notebook, "c-orient")
    check.outputs = [
        nbformat.v4.new_output("display_data", data={"application/vnd.fem-mesh.answer+json": json.dumps({"check": "orient"})})
    ]


SHAPES = {
    "skip tags": _skip_tags, "cleared": _cleared, "no checks": _without_checks, "easier check": _easier_check,
    "retyped check": _retyped_check, "richer": _richer, "saved outputs": _with_outputs, "imports more": _imports_more,
}  # fmt: skip


@NEEDS
@pytest.mark.parametrize("name", each(ATTACKS))
def test_an_attack_earns_nothing(name, attacked):
    expected = ATTACKS[name][1]
    scores = attacked.scores()[name]
    assert scores[0] == 0
    if expected is not None:  # None: honest answers of the same student may be lost as well
        assert scores == expected, attacked.results()[name]


@NEEDS
@pytest.mark.parametrize("name", each([*MESHERS, *LEFT_OVER]))
def test_a_ready_made_mesher_is_not_there(name, attacked):
    (told,) = (task for task in attacked.results()[f"mesher {name}"]["tasks"] if task["name"] == "check-mesh")
    assert told["score"] == 0
    if name in MESHERS:
        assert "meshes for you, so it is not there while homework is graded" in told["message"]
    else:
        assert "Error" in told["message"]


@pytest.mark.parametrize("name", ["delaunay", "scipy", "matplotlib", "triangle"])
def test_outside_the_same_disguises_would_mesh(name):
    space = {}
    exec(compile(mesher(MESHERS[name]), "cell", "exec"), space)
    cases = [case for case in cases_of("bowyer_watson") if case["name"] == "random points"]
    assert cases
    assert judge("bowyer_watson", run("bowyer_watson", space["bowyer_watson"], cases), cases).right


@NEEDS
@pytest.mark.parametrize("name", each(SHAPES))
def test_what_is_done_to_a_notebook_changes_no_mark(name, attacked):
    assert attacked.scores()[f"shape {name}"] == [0, 3, None, 0]


@NEEDS
def test_answers_learnt_by_heart_are_right_at_home_alone(attacked):
    space = {}
    exec(remembered(), space)
    cases = cases_of("orient")
    assert judge("orient", run("orient", space["orient"], cases), cases).right
    assert attacked.scores()["remembers"] == [0, 3, None, 0]


@NEEDS
def test_none_stops_the_run_and_honest_work_counts(attacked):
    assert attacked.result.exit_code == 0, attacked.result.output
    assert len(attacked.scores()) == len(list(attacked.submissions.iterdir())) > 20
    assert attacked.scores()["zz honest"] == [2, 3, None, 0]
    assert all(told["sandboxed"] for told in attacked.results().values())


@NEEDS
def test_half_a_character_stops_no_page(attacked):
    assert attacked.scores()["half a character"] == [2, 0, None, 0]
    text = (attacked.folder / "out" / "half a character.html").read_text()
    assert "ValueError" in text
    assert not {*"\u202e\x1b"} & {*text}
    assert len(list((attacked.folder / "out").iterdir())) == len(attacked.scores())


@NEEDS
def test_none_reaches_the_network_or_leaves_its_folder(attacked, listener):
    with pytest.raises(TimeoutError):
        listener.accept()
    assert list(attacked.outside.iterdir()) == []


@NEEDS
def test_nothing_is_left_running_or_lying_about(attacked):
    commands = [" ".join(process.info["cmdline"] or ()) for process in psutil.process_iter(["cmdline"])]
    assert [command for command in commands if str(attacked.rooms) in command] == []
    assert list(attacked.rooms.iterdir()) == []


@NEEDS
def test_each_ends_at_the_cells_limit(attacked):
    slow = {name: told["seconds"] for name, told in attacked.results().items() if told["seconds"] > 4 + 3 + 8}
    assert slow == {}


@NEEDS
@pytest.mark.exhaustive
def test_where_the_grader_is_killed_all_ends_and_goes(tmp_path):
    course = Class(tmp_path)
    course.submit("ada", course.notebook(orient="while True: pass"))
    rooms = Path(tempfile.mkdtemp(prefix="t-"))
    command = [sys.executable, "-c", "from fem_mesh.course.command import main; main()", "homework", "grade", course.source]
    command += [course.submissions, "--csv", tmp_path / "g.csv", "--force"]
    with subprocess.Popen([str(part) for part in command], env={**os.environ, "TMPDIR": str(rooms)}) as process:
        while not list(rooms.glob("fm-*/home")):
            time.sleep(0.1)
        time.sleep(2)
        process.kill()
    until = time.monotonic() + 30
    while time.monotonic() < until and any(rooms.iterdir()):
        time.sleep(0.1)
    assert list(rooms.iterdir()) == []
    commands = [" ".join(process.info["cmdline"] or ()) for process in psutil.process_iter(["cmdline"])]
    assert [command for command in commands if str(rooms) in command] == []
    rooms.rmdir()


@NEEDS
def test_feedback_escapes_what_students_say(attacked):
    page = (attacked.folder / "out" / "speaks HTML.html").read_text()
    assert "<script" not in page
    assert "<img src=x" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page


def test_without_a_sandbox_the_verdict_still_stands_outside(tmp_path):
    course = Class(tmp_path, with_bowyer_watson())
    for name in sorted(WITHOUT_BOX):
        course.submit(name, course.notebook(orient=textwrap.dedent(ATTACKS[name][0])))
    course.submit("honest", course.notebook(circle=IN_CIRCLE))
    result = course.grade("--sandbox", "off", "--cell-time", 6)
    assert "runs without a sandbox, for it was switched off" in result.output
    assert "and import a solver" in result.output
    assert "graded without a sandbox: 4 submissions" in result.output
    assert (course.folder / "grades.csv").read_text().count("graded without a sandbox") == 4
    assert {name: scores[0] for name, scores in course.scores().items()} == dict.fromkeys(WITHOUT_BOX, 0) | {"honest": 2}
