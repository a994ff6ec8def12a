"""A class from folder to table: round trip, broken files, going on after a stop, the names of students."""

import copy
import csv
import json
import os
import re
import subprocess
import sys
from concurrent.futures import Executor, Future, ThreadPoolExecutor

import nbformat
import pytest
from classroom import IN_CIRCLE, ORIENT, Class, call, cell, solved, source
from nbformat.v4 import new_code_cell

from fem_mesh.course.homework import grade as grading
from fem_mesh.course.homework.cells import Call, Task, metadata, tasks_of
from fem_mesh.course.homework.drive import Ran
from fem_mesh.course.homework.feedback import page
from fem_mesh.course.homework.grade import grade_submission
from fem_mesh.course.homework.grade_one import Seen, _mark_by_hand, read
from fem_mesh.course.homework.marks import COLUMNS, write_marks
from fem_mesh.course.homework.merge import merge
from fem_mesh.course.homework.reasons import answers_before
from fem_mesh.course.homework.release import release
from fem_mesh.course.homework.results import Marked, Result, from_json, nothing, to_json, write
from fem_mesh.course.homework.room import closure, furnish
from fem_mesh.course.homework.sandbox import Limits, SandboxError, box_of
from fem_mesh.course.homework.scan import scan
from fem_mesh.course.homework.submissions import find
from fem_mesh.course.notebooks import NotebookError

TASKS = [Task("check-orient", "Which side", 2, 4, (Call("orient", "fm.check.orient(orient)"),))]
BROKEN = {  # what comes besides notebooks, and what is said of it
    "deep.ipynb": (b"[" * 100_000, "it is nested too deeply"),
    "noone/readme.txt": (b"x", "holds no notebook"),
    "two/a.ipynb": (b"{}", "holds 2 notebooks, and not one of them called hw.ipynb"),
    "two/b.ipynb": (b"{}", "holds 2 notebooks"),
    "folder.ipynb/x.txt": (b"x", "holds no notebook"),
}
NO_NOTEBOOKS = [
    (b"", "the file is empty: save the notebook"),
    (b"[1, 2]", "it is JSON, but no object"),
    (b"{}", "it has no cells"),
    (b'{"cells": []}', "the notebook is empty: it has no cells"),
    (b"\xff\xfe\x00\x01", "the file is no text"),
    (b'{"cells": [{"cell_type": "code", "sour', "not JSON"),
]
NO_COLON = ORIENT.replace("(a, b, c):", "(a, b, c)")
BY_MATH = """def orient(a, b, c):
    assert math.pi
""" + ORIENT.partition("\n")[2]
BY_HELPER = """def in_circle(a, b, c, d):
    return helper(a, b, c, d)"""


@pytest.fixture(scope="module")
def graded(tmp_path_factory):
    course = Class(tmp_path_factory.mktemp("class"))
    course.submit("ada", nbformat.read(course.source, as_version=4))
    course.submit("bob", course.released)
    course.submit("cy", course.notebook(orient=ORIENT.replace("Fraction(x), Fraction(y)", "x, y")), "cy/late/hw.ipynb")
    course.submit("=dee()", b"hello")
    helped = course.notebook(orient=NO_COLON, circle=BY_HELPER)
    cell(helped, "imports").source += f"\n{IN_CIRCLE.replace('in_circle', 'helper')}"
    course.submit("eve", helped)
    shorter = course.notebook(orient=BY_MATH)
    cell(shorter, "imports").source += "\nimport math"
    shorter.cells = [each for each in shorter.cells if each.id != "a-circle"]
    course.submit("flo", shorter)
    for name, (content, _) in BROKEN.items():
        course.submit("", content, name)
    with (course.submissions / "huge.ipynb").open("wb") as file:
        file.truncate(200 << 20)
    (course.submissions / "link.ipynb").symlink_to(course.source)
    os.mkfifo(course.submissions / "pipe.ipynb")
    old = nbformat.v3.new_notebook(worksheets=[nbformat.v3.new_worksheet(cells=[nbformat.v3.new_code_cell(ORIENT)])])
    course.submit("", nbformat.v3.writes_json(old).encode(), "old.ipynb")
    roster = course.folder / "roster.csv"
    roster.write_text("student_id,last_name,first_name,email\nada,Lovelace,Ada,ada@example.org\nzoe,Z,Zoe,\n")
    course.result = course.grade("--roster", roster, own=True)
    return course


def rows(course):
    with (course.folder / "grades.csv").open(newline="") as file:
        return {row["student_id"]: row for row in csv.DictReader(file)}


def test_marks_are_all_or_nothing_a_task_and_the_table_is_nbgraders(graded):
    scores = graded.scores()
    assert scores["ada"] == [2, 3, None]
    assert scores["bob"] == [0, 0, None]
    assert scores["cy"] == [0, 3, None]
    table = rows(graded)
    assert list(table["ada"]) == [*COLUMNS, "check-orient", "check-in-circle", "explain", "remark"]
    expected = {"assignment": "hw", "last_name": "Lovelace", "email": "ada@example.org"}
    expected |= {"raw_score": "5", "score": "5", "max_score": "6"}
    assert {name: table["ada"][name] for name in expected} == expected
    assert (table["cy"]["check-orient"], table["cy"]["check-in-circle"], table["cy"]["explain"]) == ("0", "3", "")
    assert "'=dee()" in table
    assert [table["zoe"][name] for name in ("last_name", "score", "explain", "remark")] == ["Z", "0", "", "nothing handed in"]
    assert "zoe: nothing handed in" in graded.result.output
    assert "bob: not in the roster" in graded.result.output


def test_nothing_that_is_handed_in_stops_the_class(graded):
    results = graded.results()
    for name, (_, message) in BROKEN.items():
        student = name.split("/")[0].removesuffix(".ipynb")
        assert message in results[student]["trouble"], student
        assert all(task["score"] in (0, None) for task in results[student]["tasks"])
    assert results["=dee()"]["trouble"].startswith("the file is no notebook (it is not JSON): save the notebook in JupyterLab")
    assert results["huge"]["trouble"] == "the file has 200 MB, more than 20"
    assert results["link"]["trouble"] == results["pipe"]["trouble"] == "this is a link or a device, but no file"
    assert graded.scores()["old"] == [2, 0, None]  # nbformat 3, without ids and marks: its answer is run where it stands
    assert graded.result.exit_code == 1
    assert "huge: the file has 200 MB" in graded.result.output
    assert "14 submissions: 6 graded, 8 not; median 2 points, with 6 answers still" in graded.result.output


@pytest.mark.parametrize(("content", "message"), NO_NOTEBOOKS)
def test_what_is_no_notebook_is_told_what_it_is(content, message):
    with pytest.raises(NotebookError, match=re.escape(message)):
        read(content)


def test_the_cell_that_is_the_reason_is_named(graded):
    said = {student: [task["message"] for task in told["tasks"]] for student, told in graded.results().items()}
    syntax = "orient, line 1, `def orient(a, b, c)`, raised SyntaxError: expected ':'"
    assert said["eve"][0] == f"no answer came to the check orient: {syntax}"
    assert said["eve"][1].endswith(
        "NameError: name 'helper' is not defined; your change to the cell imports was not taken over"
    )
    assert said["flo"][0] == "orient: right on all 9 cases"  # its `import math` in a given cell was kept
    assert said["flo"][1] == "no answer came to the check in_circle: in-circle was not found: it was deleted or renamed"
    assert said["bob"][:2] == ["not written yet", "not written yet"]
    assert said["bob"][2] == "not answered"
    assert not graded.results()["bob"]["notes"]
    assert re.match(r"right on \d of 9 cases, then: orient, case", said["cy"][0])


def test_each_has_a_page_that_says_what_went_wrong_first(graded):
    results = graded.results()
    assert len(list((graded.folder / "out").glob("*.html"))) == len(results)
    text = (graded.folder / "out" / "cy.html").read_text()
    assert "3 of 5 points, and 1 more that are given by hand" in text
    assert results["cy"]["tasks"][0]["message"].split(",")[0] in text
    assert "not yet right</p>" in text
    assert "data:image/svg+xml;base64," in text
    assert "Fraction" not in text  # nothing of the solution


def test_what_is_done_is_not_done_again_and_marks_stay_the_same(graded, monkeypatch):
    before, table = graded.results(), (graded.folder / "grades.csv").read_bytes()
    kept = graded.folder / "grades.results"
    monkeypatch.setattr(grading, "grade_submission", None)  # would fail if it were called
    graded.grade("--roster", graded.folder / "roster.csv", own=True)
    assert graded.results() == before
    assert (graded.folder / "grades.csv").read_bytes() == table
    monkeypatch.undo()
    jobs = []
    monkeypatch.setattr(grading, "grade_submission", lambda job: jobs.append(job["student"]) or grade_submission(job))
    (kept / "ada.json").unlink()
    (kept / "cy.json").write_text("{half a resul")
    graded.submit("bob", graded.notebook())
    graded.grade()
    again = graded.results()
    assert sorted(jobs) == ["ada", "bob", "cy"]
    assert [task["score"] for task in again["bob"]["tasks"]] == [2, 3, None]
    for student in ("ada", "cy"):
        assert again[student]["tasks"] == before[student]["tasks"]
    graded.submit("bob", graded.released)
    jobs.clear()
    monkeypatch.setattr(grading, "grade_submission", lambda job: jobs.append(job["student"]) or {"trouble": "said nothing"})
    graded.grade("--again", "--csv", graded.folder / "again.csv")
    assert len(jobs) == 8  # all that can be read
    assert graded.results() == again


def test_points_that_are_typed_into_the_table_stand_in_it_and_on_the_page(graded, monkeypatch):
    monkeypatch.setattr(grading, "grade_submission", lambda job: {"trouble": "said nothing"})
    path = graded.folder / "grades.csv"
    path.write_text(path.read_text().replace(",5,0,5,6,2,3,,", ",5,0.5,5,6,2,3,1,", 1))
    graded.grade()
    row = rows(graded)["ada"]
    assert [row[name] for name in ("raw_score", "score", "explain")] == ["6", "5.5", "1"]
    text = (graded.folder / "out" / "ada.html").read_text()
    assert "5.5 of 6 points, 0.5 points taken off by hand" in text
    assert "1 of 1 point: by hand" in text
    before = path.read_bytes()
    path.write_text(path.read_text().replace(",6,2,3,1,", ",6,2,2,1,", 1))
    result = graded.grade()
    assert result.exit_code == 1
    assert "check-in-circle was 3, and is 2, but what checks found is written anew each time" in result.output
    path.write_bytes(before)


def test_a_solution_that_does_not_get_all_points_stops_the_grading(course):
    notebook = source()
    cell(notebook, "imports").source += "\nstart = fm.delaunay(fm.random_points(9, seed=1))"
    cell(notebook, "a-orient").source = solved(ORIENT.replace("    from", "    assert len(start.triangles)\n    from"))
    nbformat.write(notebook, course.source)
    course.submit("ada")
    result = course.grade(own=True)
    assert result.exit_code == 1
    assert "your own solution does not get all points, so nothing was graded. check-orient: orient, case" in result.output
    assert "NameError: name 'start' is not defined; imports, line 2, `start = fm.delaunay(" in result.output
    assert "raised RuntimeError: fm.delaunay meshes for you" in result.output
    assert not (course.folder / "grades.csv").exists()
    assert course.results() == {}


def test_tests_of_ones_own_are_shown_with_what_came_of_them():
    notebook = source()
    cell(notebook, "c-orient").source = "assert orient((0, 0), (1, 0), (0, 1)) > 0"
    released = release(notebook)[0]
    task = tasks_of(released)[0]
    own = answers_before(released, tasks_of(released))[task.at]

    def marked(seen, code=ORIENT):
        answered = copy.deepcopy(released)
        cell(answered, "a-orient").source = code
        return _mark_by_hand(task, seen, own, merge(released, answered), released.cells[task.at])

    held, failed = (marked(Seen({task.at: Ran(error=error)})) for error in ("", "AssertionError"))
    assert (held.score, held.message, held.text) == (None, "to be marked by hand; when it was run, the tests held", ORIENT)
    assert failed.message == "to be marked by hand; when it was run: AssertionError"
    assert marked(Seen(lost="the kernel died")).message.endswith("when it was run: the kernel died")
    assert marked(Seen(), cell(released, "a-orient").source).message == "not written yet"
    text = page(Result("ada", [held, failed]), "hw")
    assert text.count("from fractions import Fraction") == 2
    assert "<p>when it was run, the tests held</p>" in text


def test_what_was_graded_before_a_stop_is_kept(course):
    class Stops(Executor):
        """Grades one, and then the instructor presses Ctrl-C."""

        calls = 0

        def submit(self, function, job):
            self.calls += 1
            if self.calls == 2:
                raise KeyboardInterrupt
            future = Future()
            future.set_result(function(job))
            return future

    for student in ("ada", "bob", "cy"):
        course.submit(student)
    homework, _ = grading.homework_from(course.source, 1, "auto", Limits())
    found, folder = find(course.submissions, "hw.ipynb")[0], course.folder / "kept"
    with pytest.raises(KeyboardInterrupt):
        grading.grade_class(homework, found, folder, Stops(), 1)
    assert [path.name for path in folder.iterdir()] == ["ada.json"]


def test_a_seed_of_ones_own_makes_other_cases(course):
    folder, elsewhere = course.folder / "kept", course.folder / "elsewhere"
    seeds = [grading.seed_in(folder), grading.seed_in(folder), grading.seed_in(elsewhere)]
    assert seeds[0] == seeds[1] != seeds[2]  # by chance, once in four thousand million runs
    one, two, three = (grading.homework_from(course.source, seed, "auto", Limits())[0] for seed in seeds)
    assert one.key == two.key != three.key
    assert "Fraction" not in one.released


def test_a_mesh_is_judged_by_what_the_instructor_asked_for(course):
    notebook = source()
    notebook.metadata.fem_mesh["uses"] = ["l_shape"]
    notebook.cells += [
        new_code_cell("domain = fm.l_shape()\nbound = 20", id="given"),
        new_code_cell("# BEGIN SOLUTION\nmine = fm.refine(domain, min_angle=bound)\n# END SOLUTION", id="a-mesh",
                      metadata=metadata("answer", "mesh")),
        new_code_cell("fm.check.mesh(mine[0], mine[1], domain=domain, min_angle=bound)", id="c-mesh",
                      metadata=metadata("check", "check-mesh", 4)),
    ]  # fmt: skip
    nbformat.write(notebook, course.source)
    students = course.folder / "students"
    assert "note" not in call("homework", "release", course.source, "-o", students, "--force").output
    course.released = nbformat.read(students / "hw.ipynb", as_version=4)
    small = "import fem_mesh as fm\nmine = [(0, 0), (1, 0), (0, 1)], [(0, 1, 2)]\ndomain = fm.Domain(*mine)\nbound = 1"
    good = "mine = {points}, {triangles}"
    import fem_mesh as fm

    mesh = fm.refine(fm.l_shape(), min_angle=20)
    for student, code in {
        "right": good.format(points=mesh.points.tolist(), triangles=mesh.triangles.tolist()),
        "smaller": small,
        "refined": "mine = fm.refine(domain, min_angle=bound)",
    }.items():
        answered = course.notebook()
        cell(answered, "a-mesh").source = code
        course.submit(student, answered)
    course.grade()
    assert {student: scores[3] for student, scores in course.scores().items()} == {"right": 4, "smaller": 0, "refined": 0}


@pytest.mark.parametrize(
    ("check", "message"),
    [
        ("fm.check.nothing(f)", "fm.check.nothing(f)"),
        ("fm.check.mesh(points, triangles)", "say what is to be meshed"),
        ("fm.check.mesh(p, t, domain=fm.square(), min_angle=bound)", "min_angle must be written out"),
        ("fm.check.mesh(p, t, domain=fm.squares())", "has no attribute"),
    ],
)
def test_a_check_that_cannot_be_judged_is_refused_before_anything_is_graded(course, check, message):
    notebook = source()
    cell(notebook, "c-orient").source = check
    nbformat.write(notebook, course.source)
    course.submit("ada")
    result = course.grade()
    assert result.exit_code == 1
    assert message in result.output
    assert not (course.folder / "grades.csv").exists()


@pytest.mark.parametrize(
    ("uses", "message"),
    [
        (["delaunay"], "'delaunay', which meshes or needs what does"),
        (["bowyer_watson"], "which meshes"),
        (["play"], "which fem_mesh does not hand out"),
        (["nothing"], "which fem_mesh does not hand out"),
        ("orient", "must be a list of names"),
    ],
)
def test_names_that_must_not_be_handed_out_are_refused(course, uses, message):
    notebook = source()
    notebook.metadata.fem_mesh["uses"] = uses
    nbformat.write(notebook, course.source)
    course.submit("ada")
    result = course.grade()
    assert result.exit_code == 1
    assert message in result.output


def test_the_room_holds_no_solver_and_no_judge(tmp_path):
    furnish(
        tmp_path / "room",
        ["orient", "in_circle", "any_triangulation", "l_shape"],
        {"orient": [], "lawson": []},
        box_of("off"),
        Limits(),
    )
    files = {str(path.relative_to(tmp_path / "room")) for path in (tmp_path / "room").rglob("*.py")}
    assert {"start.py", "fem_mesh/check/run.py", "fem_mesh/predicates.py", "fem_mesh/algorithms/sweep.py"} <= files
    words = (
        "judge",
        "cases",
        "delaunay",
        "lawson",
        "bowyer",
        "halfedge",
        "ruppert",
        "textbook",
        "constrained",
        "course",
        "watch",
    )
    assert [file for file in files if any(word in file for word in words)] == []
    assert closure("fem_mesh.check.run") == ["fem_mesh.check.run"]
    code = """
import fem_mesh as fm
assert fm.orient((0, 0), (1, 0), (0, 1)) == 1 and len(fm.l_shape().points) == 6 and fm.Step("a").kind == "a"
assert list(fm.play(fm.record(x for x in ())).steps) == []
for name, why in (("delaunay", "meshes for you"), ("textbook", "meshes for you"), ("validate", "is not handed out")):
    try:
        getattr(fm, name)()
    except RuntimeError as error:
        assert why in str(error), error
    else:
        raise SystemExit(name)
"""
    code += """
seen = []
fm.check._display = lambda *what: seen.append(what)
fm.check.orient(f=lambda a, b, c: 0)
fm.check.lawson(g=lambda points, triangles: iter(()))
fm.check.mesh(points=[(0, 0)], triangles=[], domain=None)
assert [name for name, _ in seen] == ["orient", "lawson", "mesh"], seen
"""
    subprocess.run(
        [sys.executable, "-sP", "-c", f"import sys; sys.path.insert(0, {str(tmp_path / 'room')!r})\n{code}"], check=True
    )


def test_predicates_come_only_when_they_are_handed_out(tmp_path):
    furnish(tmp_path / "none", [], {}, box_of("off"), Limits())
    furnish(tmp_path / "one", ["orient"], {}, box_of("off"), Limits())
    none, one = ((tmp_path / name / "fem_mesh" / "predicates.py").read_text() for name in ("none", "one"))
    assert "def " not in none
    assert "def orient(" in one
    assert "def in_circle" not in one
    for room, names in (("none", "random_points"), ("one", "random_points, orient")):
        code = (
            f"import sys; sys.path.insert(0, {str(tmp_path / room)!r}); from fem_mesh import {names}; random_points(3, seed=1)"
        )
        subprocess.run([sys.executable, "-sP", "-c", code], check=True)


def test_what_stands_beside_a_shape_is_not_there_for_the_taking(tmp_path):
    furnish(tmp_path, ["plate_with_hole"], {}, box_of("off"), Limits())
    assert [path.name for path in tmp_path.rglob("*.py") if "def circumcenter" in path.read_text()] == []
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import fem_mesh as fm; fm.plate_with_hole(n=12)"
    subprocess.run([sys.executable, "-sP", "-c", code], check=True)


def test_a_folder_that_cannot_be_written_is_told_before_anything_is_graded(course, monkeypatch):
    monkeypatch.setattr(grading, "grade_submission", None)
    course.submit("ada")
    result = course.grade("--feedback", "/proc/nowhere/out")
    assert result.exit_code == 1
    assert re.search(r"Error: /proc/nowhere.*: No such file", result.output)


def test_two_graders_may_write_the_same_file(tmp_path):
    with ThreadPoolExecutor(4) as threads:
        list(threads.map(lambda k: write(tmp_path / "ada.json", "x" * k), range(400)))
    assert [path.name for path in tmp_path.iterdir()] == ["ada.json"]


def test_a_sandbox_that_is_required_and_not_there_is_an_error(course, monkeypatch):
    monkeypatch.setenv("PATH", "/nowhere")
    box_of.cache_clear()
    course.submit("ada")
    result = course.grade("--sandbox", "required")
    box_of.cache_clear()
    assert result.exit_code == 1
    assert "bubblewrap is not installed (Debian's package bubblewrap); install it, or say --sandbox auto" in result.output
    with pytest.raises(SandboxError):
        box_of("required")
    assert box_of("off").why == "it was switched off"
    box_of.cache_clear()


def test_a_result_is_believed_only_if_it_speaks_of_the_tasks():
    good = Result("ada", [Marked("check-orient", "Which side", 2, 2, "right")])
    assert from_json(to_json(good), TASKS) == good
    for score in (1000, 1, None, "2", -2):
        forged = Result("ada", [Marked("check-orient", "Which side", 2, score, "right")])
        with pytest.raises(ValueError, match="does not speak of the tasks"):
            from_json(to_json(forged), TASKS)
    for text in ("", "[]", "{}", '{"tasks": 3}', json.dumps({"student": "a", "tasks": [], "findings": [], "extra": 1})):
        with pytest.raises(ValueError):  # noqa: PT011 - what is no JSON says so in many ways
            from_json(text, TASKS)


def test_a_page_shows_whatever_it_is_told_and_runs_none_of_it():
    evil = "<script>alert(1)</script>"
    wrong = {"check": evil, "right": False, "message": evil, "picture": {"panels": evil}}
    marked = [Marked(evil, evil, 2, 0, evil, [wrong]), Marked("b", evil, 1, None, evil, [], evil)]
    text = page(Result(evil, marked, evil, [evil], scan({evil: "eval(1)"}, [evil], [])), evil)
    assert "<script" not in text
    assert "default-src 'none'" in text
    assert "Not graded" in text


def test_a_table_is_no_place_for_formulas(tmp_path):
    write_marks(tmp_path / "t.csv", "hw", TASKS, [nothing("=cmd|' /C calc'!A0", TASKS, "@x")])
    assert (tmp_path / "t.csv").read_text().splitlines()[1].startswith("hw,,,'=cmd")
    assert (tmp_path / "t.csv").read_text().splitlines()[1].endswith(",'@x")
    write_marks(tmp_path / "t.csv", "hw", TASKS, [nothing("x;=1+1", TASKS, "a\x1b")])
    assert "x;'=1+1" in (tmp_path / "t.csv").read_text()
    assert "\x1b" not in (tmp_path / "t.csv").read_text()


def test_the_scan_tells_what_stands_out():
    code = "import os, numpy, scipy.spatial as s\nfrom fem_mesh import delaunay\nfm.refine(x)\neval('1')\n!ls\nx.__class__"
    assert [(found.line, found.what) for found in scan({"a": code}, [], [])] == [
        (1, "imports os"),
        (1, "imports scipy.spatial, which meshes"),
        (2, "uses fm.delaunay, which is not handed out"),
        (3, "uses fm.refine, which is not handed out"),
        (4, "uses eval"),
        (5, "speaks to the shell or to IPython"),
        (6, "reaches for __class__"),
    ]
    assert scan({"a": ORIENT, "b": IN_CIRCLE}, [], []) == []
    assert [found.what for found in scan({}, [f"x = {list(range(300))}\ny = '{'A' * 300}'", "1 +"], [])] == [
        "holds a list of 300 items", "holds a text of 300 characters that is no prose"
    ]  # fmt: skip
    assert [found.what for found in scan({"a": "fm.orient(1)"}, [], ["orient"])] == []
    rows = [[k, k + 1, k + 2] for k in range(40)]
    for pasted in (f"t = {rows}", f't = "{rows}"', f't = "{" ".join(map(str, range(90)))}"'):
        assert "holds a" in scan({"a": pasted}, [], [])[0].what
    assert scan({"a": f'"{"A sentence of many words, in prose, on 3 points. " * 20}"'}, [], []) == []
