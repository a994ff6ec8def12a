"""The homework of the course: it can be solved, in several ways; what goes wrong is told; nothing is told that solves it.

That the solutions pass nbval is seen when pytest collects ``notebooks``.
"""

import ast
import contextlib
import copy
import importlib
import inspect
import io
import os
import re
import subprocess
import sys

import nbformat
import pytest
from answers import FOLDER, NAMES, given_in, notebook_of
from classroom import Class, call, cell

import fem_mesh as fm
from fem_mesh.check import cases_of, judge, mesh_case, run
from fem_mesh.check.run import given
from fem_mesh.course.homework.cells import homework_of, role, tasks_of

BANK = {name: importlib.import_module(f"answers.{name.split('_')[0]}") for name in NAMES}
RIGHT = [(check, work) for bank in BANK.values() for check, works in bank.RIGHT.items() for work in works]
WRONG = [row for bank in BANK.values() for row in bank.WRONG]


def verdict(check, work, seed=0):
    """The verdict on ``work``, whatever it prints; an endless loop has a second."""
    cases = cases_of(check, seed)
    with contextlib.redirect_stdout(io.StringIO()):
        return judge(check, run(check, work, cases, seconds=1), cases)


def said(works):
    return [f"{work[0].split()[0]}-{work[1].__name__}" for work in works]


# ---- the bank ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("check", "work"), RIGHT, ids=said(RIGHT))
def test_a_right_answer_of_another_kind_is_right(check, work):
    check = check.split()[0]
    cases = cases_of(check)
    found = judge(check, run(check, work, cases), cases)
    assert str(found) == f"{check}: right on all {len(cases)} cases"


@pytest.mark.parametrize(("check", "work", "sentence"), WRONG, ids=said(WRONG))
def test_a_typical_wrong_answer_is_told_what_is_wrong_with_it(check, work, sentence):
    found = verdict(check, work)
    assert not found.right
    assert sentence in str(found)


@pytest.mark.exhaustive
@pytest.mark.parametrize("seed", range(1, 21))
def test_other_cases_lead_to_the_same_marks(seed):
    assert [str(found) for row in RIGHT if not (found := verdict(row[0].split()[0], row[1], seed)).right] == []
    assert [work.__name__ for check, work, _ in WRONG if verdict(check, work, seed).right] == []


@pytest.mark.parametrize("work", BANK["hw4_constrained"].MESHES, ids=lambda work: work.__name__)
def test_the_letter_is_meshed_in_several_ways(work):
    domain = fm.letter("R")
    start = [tuple(t) for t in fm.delaunay(domain.points).triangles.tolist()]
    points, outline = domain.points.tolist(), domain.segments.tolist()
    mesh = given(points, work(points, start, outline))
    assert judge("mesh", mesh, [mesh_case(domain=domain)]).right
    uncut = str(judge("mesh", given(points, start), [mesh_case(domain=domain)]))
    assert "edge 1-2 has triangles on both sides, but on the domain's segment from" in uncut


@pytest.mark.parametrize("work", BANK["hw5_ruppert"].RIGHT["ruppert"], ids=lambda work: work.__name__)
def test_the_plate_is_meshed_in_several_ways(work):
    domain, names = fm.plate_with_hole(n=12), given_in("hw5_ruppert")
    points, segments = [list(map(tuple, rows.tolist())) for rows in (domain.points, domain.segments)]
    pieces = segments
    for state in work(points, segments, 25):
        found, triangles = (state.points, state.triangles) if isinstance(state, fm.Step) else state
        found, triangles = [tuple(p) for p in found], [tuple(t) for t in triangles]
        pieces = BANK["hw5_ruppert"].split_at(found, pieces)
    mesh = given(found, names["inside"](found, triangles, pieces))
    assert judge("mesh", mesh, [mesh_case(min_angle=25, domain=domain)]).right
    worse = judge("mesh", mesh, [mesh_case(min_angle=40, domain=domain)])
    assert "the smallest angle must be at least 40 degrees, but that of triangle" in str(worse)


@pytest.mark.parametrize("name", NAMES)
def test_the_bank_is_large_enough(name):
    checks = {call.name for task in tasks_of(notebook_of(name)) for call in task.calls} - {"mesh"}
    bank = BANK[name]
    assert len(bank.WRONG) >= 8
    assert all(len(works) >= 3 for works in bank.RIGHT.values())
    assert checks == {check.split()[0] for check in bank.RIGHT} == {check for check, *_ in bank.WRONG}
    assert all(len(sentence) > 12 for *_, sentence in bank.WRONG)


# ---- the notebooks -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_a_homework_is_made_as_all_of_them(name):
    notebook = notebook_of(name)
    nbformat.validate(notebook)
    tasks = tasks_of(notebook)
    assert homework_of(notebook)["homework"] == name.split("_")[0]
    assert (sum(task.points for task in tasks), 3 <= len(tasks) <= 5) == (TOTALS[name], True)
    assert [task.by_hand for task in tasks] == [False] * (len(tasks) - 1) + [True]
    assert any("image/png" in output.get("data", {}) for each in notebook.cells for output in each.get("outputs", ()))
    for each in notebook.cells:
        if each.cell_type == "markdown":
            assert "!" not in each.source
        elif role(each) == "check":
            assert [output.name for output in each.outputs] == ["stdout"]
            assert re.fullmatch(r"(\w+: right on (its case|all \d+ cases)\n)+", each.outputs[0].text)
        elif role(each) == "answer":
            bodies = [node for node in ast.parse(each.source).body if isinstance(node, ast.FunctionDef)]
            assert all(node.end_lineno - node.lineno <= 27 for node in bodies)
            assert each.source.count("# BEGIN SOLUTION") == each.source.count("# END SOLUTION") == len(bodies)


@pytest.fixture(scope="module")
def released(tmp_path_factory):
    """The students' versions, in one folder."""
    folder = tmp_path_factory.mktemp("released")
    for name in NAMES:
        assert call("homework", "release", FOLDER / f"{name}.ipynb", "-o", folder).exit_code == 0
    return folder


def test_the_students_version_fails_exactly_at_its_checks(released):
    options = [
        "--nbval-lax",
        "--nbval-current-env",
        "-p",
        "no:cacheprovider",
        "-n",
        "2",
        "--dist",
        "loadscope",
        "--tb=no",
        "-q",
        "-rfE",
    ]
    ran = subprocess.run(
        [sys.executable, "-m", "pytest", "-c", os.devnull, "--rootdir", released, *options, released],
        capture_output=True, text=True, cwd=released, timeout=300,
    )  # fmt: skip
    failed = set(re.findall(r"^FAILED .*?(\w+)\.ipynb::Cell (\d+)", ran.stdout, re.MULTILINE))
    expected = set()
    for name in NAMES:
        code = [each for each in nbformat.read(released / f"{name}.ipynb", as_version=4).cells if each.cell_type == "code"]
        expected |= {(name, str(i)) for i, each in enumerate(code) if role(each) == "check"}
    assert failed == expected, ran.stdout[-3000:]


@pytest.mark.parametrize("name", NAMES)
def test_solutions_get_all_points_and_others_what_they_earned(name, tmp_path):
    notebook = notebook_of(name)
    course = Class(tmp_path, notebook)
    course.submit("ada", notebook)
    for student, (cell_id, code, _) in PARTLY[name].items():
        theirs = copy.deepcopy(notebook)
        cell(theirs, cell_id).source = code
        course.submit(student, theirs)
    graded = course.grade()
    assert graded.exit_code == 0, graded.output
    points = [task.points for task in tasks_of(notebook)]
    results, scores = course.results(), course.scores()
    assert scores["ada"] == [*points[:-1], None], results["ada"]
    assert not results["ada"]["findings"]
    for student, (cell_id, _, sentence) in PARTLY[name].items():
        assert sentence in str(results[student]["tasks"]), (student, cell_id)
        assert 0 < sum(score or 0 for score in scores[student]) < sum(points[:-1])


def one_function(work, name, *helpers):
    """The source of functions of the bank, as an answer cell."""
    parts = [*map(inspect.getsource, helpers), inspect.getsource(work).replace(f"def {work.__name__}(", f"def {name}(", 1)]
    return "\n\n".join(parts)


_1, _2, _3, _4, _5 = BANK.values()
TOTALS = dict.fromkeys(NAMES, 10)
PARTLY = {  # student: the cell they answered otherwise than the solution, their answer, the sentence on their page
    "hw1_predicates": {
        "bob": ("answer-orient", one_function(_1.with_a_tolerance, "orient", _1.in_floats), "rounding or a tolerance hides"),
        "cy": ("answer-in-circle", "in_circle = fm.in_circle", "not handed out"),
        "dan": (
            "answer-quick",
            one_function(_1.filter_of_differences, "quick_in_circle", _1.det_and_permanent, _1.by_translation, _1.laplace),
            "points nearly on a line",
        ),
    },
    "hw2_lawson": {
        "bob": (
            "answer-lawson",
            "from itertools import combinations\n\n"
            + one_function(_2.lawson_once, "lawson", _2.illegal, _2.far_corners, _2.crossing, _2.flip_in_lists),
            "it ended, but edge",
        ),
    },
    "hw3_bowyer_watson": {
        "bob": (
            "answer-bowyer-watson",
            one_function(_3.near_super_triangle, "bowyer_watson", _3.with_a_triangle_at_the_horizon, _3.holds, _3.rim_of),
            "of the convex hull is missing",
        ),
    },
    "hw4_constrained": {
        "bob": ("answer-carve", one_function(_4.carve_the_hull, "carve"), "lies outside or in a hole, but you kept it"),
    },
    "hw5_ruppert": {
        "bob": ("answer-encroached", one_function(_5.encroached_with_a_tolerance, "encroached"), "but you left it out"),
    },
}
