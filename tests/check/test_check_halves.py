"""The half that runs trusts the student with nothing but their own arguments; the half that judges trusts nobody."""

import copy
import json
import math
import re
import subprocess
import sys
import threading
from collections import deque
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from corpus import for_all
from hypothesis import strategies as st
from right_answers import RIGHT, lawson_with_lists

import fem_mesh as fm
from fem_mesh import check
from fem_mesh.check import cases_of
from fem_mesh.check.judge import JUDGES, find_first
from fem_mesh.check.run import GATE, STEPS, place_of, plain, run
from fem_mesh.domain.domain import Domain

CASE = {"name": "one", "points": [[0.0, 0.0], [4.0, 0.0], [5.0, 3.0], [1.0, 2.0]], "triangles": [[0, 1, 2], [0, 2, 3]]}


# ---- cases -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", sorted(set(JUDGES) - {"mesh"}))
def test_cases_are_json_and_none_is_the_same_for_another_seed(name):
    some, other = cases_of(name, 1), cases_of(name, 2)
    assert json.loads(json.dumps(some, allow_nan=False)) == some
    assert some == cases_of(name, 1)
    assert some != other
    assert [case["name"] for case in some] == [case["name"] for case in other]
    assert not [a["name"] for a, b in zip(some, other, strict=True) if a == b]


@pytest.mark.parametrize("name", ["segments", "carve", "encroached", "ruppert"])
@pytest.mark.parametrize("seed", range(8))
def test_no_point_lies_within_a_segment(name, seed):
    for case in cases_of(name, seed):
        domain = Domain(case["points"], case["segments"])
        assert not domain.report, case["name"]
        assert domain.segments.tolist() == case["segments"], case["name"]


@pytest.mark.parametrize("seed", range(8))
def test_given_triangles_are_valid(seed):
    for name in ("lawson", "segments", "carve"):
        for case in cases_of(name, seed):
            fm.validate(case["points"], case["triangles"], delaunay=name == "segments")


def test_there_are_no_other_checks():
    for call in (lambda: cases_of("sudoku"), lambda: check.judge("sudoku", {}, [])):
        with pytest.raises(fm.MeshError, match=r"no .*check 'sudoku'.*lawson"):
            call()


# ---- running -----------------------------------------------------------------------------------------


def test_the_running_half_stands_alone(tmp_path):
    """A grading kernel has this one file, without the rest of the package."""
    source = Path(fm.__file__).parent / "check" / "run.py"
    (tmp_path / "alone.py").write_text(source.read_text())
    code = f"""
import sys
sys.path.insert(0, {str(tmp_path)!r})
import alone, json
print(json.dumps(alone.run("lawson", lambda points, triangles: iter([triangles]), [{CASE!r}])))
assert not any(name.startswith("fem_mesh") for name in sys.modules)
"""
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path).stdout
    (record,) = json.loads(out)["runs"]
    assert record["yields"] == [CASE["triangles"]]
    assert record["kind"] == "generator"


def test_states_are_copied_when_they_are_yielded():
    def work(points, triangles):
        triangles.clear()
        for k in range(3):
            triangles.append((0, 1, k))
            yield triangles

    (record,) = run("lawson", work, [CASE])["runs"]
    assert [len(state) for state in record["yields"]] == [1, 2, 3]


def test_who_changes_what_was_given_changes_nothing_else():
    cases = [copy.deepcopy(CASE), copy.deepcopy(CASE)]

    def work(points, triangles):
        yield points + triangles
        points.clear()
        triangles.append("mine")

    first, second = run("lawson", work, cases)["runs"]
    assert cases == [CASE, CASE]
    assert first["yields"] == second["yields"]


@pytest.mark.parametrize(
    ("value", "written"),
    [
        (np.int32(3), 3),
        (np.float32(0.5), 0.5),
        (np.bool_(True), True),
        (np.array([[1, 2]]), [[1, 2]]),
        (np.array(2.5), 2.5),
        ({(2, 1), (1, 2)}, [[1, 2], [2, 1]]),
        ({frozenset({3, 1})}, [[1, 3]]),
        ((1, [2, (3,)]), [1, [2, [3]]]),
        (deque([1, 2]), [1, 2]),
        ({1: 2}.values(), [2]),
        ({1, "a"}, [1, "a"] if repr(1) < repr("a") else ["a", 1]),
        (math.nan, {"type": "float", "text": "nan"}),
        (-math.inf, {"type": "float", "text": "-inf", "sign": -1}),
        (Fraction(1, 2), 0.5),
        (Fraction(-1, 3), {"type": "Fraction", "sign": -1}),
        (Decimal("0.1"), {"type": "Decimal", "sign": 1}),
        (10**30 + 1, {"type": "int", "sign": 1}),
        (-(10**400), {"type": "int", "sign": -1}),
        ({1: 2}, {"type": "dict"}),
        (b"ab", {"type": "bytes"}),
        (1j, {"type": "complex"}),
        (len, {"type": "builtin_function_or_method"}),
        (iter([1]), {"type": "list_iterator"}),
        ("a" * 1000, "a" * 200),
        (None, None),
        (fm.Step("flip", points=[(0, 1)], triangles=np.eye(1)), {"type": "Step", "points": [[0, 1]], "triangles": [[1.0]]}),
    ],
    # The same in every process: a set is written in an order of its own in each.
    ids=lambda value: f"set of {len(value)}" if isinstance(value, set) else re.sub(r" at 0x.*", "", repr(value)[:60])[:30],
)  # fmt: skip
def test_what_is_no_json_is_told(value, written):
    assert plain(value) == written
    json.dumps(plain(value), allow_nan=False)


def test_what_is_too_much_is_cut():
    deep: list = []
    for _ in range(50):
        deep = [deep]
    assert "cut" in json.dumps(plain(deep))
    assert len(json.dumps(plain([[0] * 1000] * 10_000))) < 3_000_000 * 10
    assert plain(np.zeros((10_000, 10_000), np.int8)) == {"type": "ndarray", "cut": True}


def test_a_loop_without_an_end_is_stopped_at_its_line():
    def work(points, triangles):
        yield triangles
        while True:
            points = points  # here

    transcript = run("lawson", work, [CASE, CASE], seconds=0.2)
    (record,) = transcript["runs"]  # and no further case is tried
    assert record["stopped"] == "time"
    assert record["error"]["type"] == "OutOfTime"
    assert record["error"]["function"] == "work"
    assert record["error"]["source"] == "while True:"
    assert record["yields"] == [CASE["triangles"]]


def test_the_loop_is_named_from_which_it_does_not_return():
    def helper(k):
        return [j for j in range(1000) if j == k]

    def work(a, b, c):
        for k in range(3):
            helper(k)
        while a is not None:
            for k in range(10):
                helper(k)

    for _ in range(3):
        (record,) = run("orient", work, cases_of("orient")[:1], seconds=0.1)["runs"]
        assert record["error"]["source"] == "while a is not None:"


def test_a_recursion_is_named_where_it_begins():
    def helper(k):
        if k % 7:
            return helper(k + 1)
        return sum(map(helper, [k + 1]))

    (record,) = run("orient", lambda a, b, c: helper(0), cases_of("orient"))["runs"]
    assert record["error"]["message"] == "it calls itself without an end"
    assert record["error"]["source"] == "return sum(map(helper, [k + 1]))"


def test_a_loop_that_catches_exceptions_is_stopped():
    def work(a, b, c):
        while True:
            try:
                while True:
                    pass
            except Exception:
                pass

    (record,) = run("orient", work, cases_of("orient")[:1], seconds=0.2)["runs"]
    assert record["stopped"] == "time"


def test_a_generator_without_an_end_is_stopped():
    def work(points, triangles):
        while True:
            yield triangles

    (record,) = run("lawson", work, [CASE])["runs"]
    assert record["stopped"] == "steps"
    assert len(record["yields"]) == STEPS


def test_without_an_alarm_it_runs_all_the_same():
    found = []
    thread = threading.Thread(target=lambda: found.append(run("lawson", lawson_with_lists, [CASE])))
    thread.start()
    thread.join()
    assert found[0]["runs"][0]["error"] is None


@pytest.mark.parametrize("raised", [ValueError("a\nb at 0x7f12ab34"), SystemExit(3), GeneratorExit(), RecursionError("deep")])
def test_whatever_is_raised_is_written_down(raised):
    def work(a, b, c):
        raise raised

    (record,) = run("orient", work, cases_of("orient"))["runs"]
    assert record["error"]["type"] == type(raised).__name__
    assert record["error"]["source"] == "raise raised"
    assert "0x7" not in record["error"]["message"]
    assert "\n" not in record["error"]["message"]


def test_a_frame_without_a_line_has_a_place():
    place = place_of([(sys._getframe(), None)])
    assert place["function"] == "test_a_frame_without_a_line_has_a_place"
    assert place["source"].startswith("def ")


def test_an_interrupt_is_the_users():
    def work(a, b, c):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run("orient", work, cases_of("orient"))


def test_the_line_is_theirs_even_where_a_library_raises():
    def work(a, b, c):
        return np.linalg.inv(np.zeros((2, 2)))

    (record,) = run("orient", work, cases_of("orient"))["runs"]
    assert record["error"]["source"] == "return np.linalg.inv(np.zeros((2, 2)))"
    assert record["error"]["type"] == "LinAlgError"


def test_the_line_is_theirs_where_a_grading_kernel_refuses_an_import():
    gate = {}
    exec(compile("def refuse():\n    raise ImportError('not here')", GATE, "exec"), gate)

    def work(a, b, c):
        return gate["refuse"]()

    (record,) = run("orient", work, cases_of("orient"))["runs"]
    assert record["error"]["source"] == 'return gate["refuse"]()'


# ---- judging -----------------------------------------------------------------------------------------

JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-3, 20) | st.floats() | st.integers() | st.text(st.characters(), max_size=5),
    lambda inner: (
        st.lists(inner, max_size=5)
        | st.dictionaries(st.sampled_from(["type", "sign", "triangles", "points", "text", "runs", "yields"]), inner, max_size=4)
    ),
    max_leaves=20,
)
NAMES = sorted(JUDGES)


def some_cases(name):
    return [check.mesh_case(domain=fm.square(), min_angle=20)] if name == "mesh" else cases_of(name)


@for_all(80, name=st.sampled_from(NAMES), transcript=JSON)
def test_any_json_gets_a_verdict(name, transcript):
    verdict = find_first(name, transcript, some_cases(name))
    assert not verdict.right
    verdict.html()


@for_all(
    150,
    name=st.sampled_from(NAMES),
    yields=JSON | st.lists(st.lists(st.lists(st.integers(-1, 5), min_size=3, max_size=3), max_size=6), max_size=4),
    returned=JSON,
    kind=st.sampled_from(["generator", "function", "value"]),
    error=st.none() | JSON,
    stopped=st.none() | st.sampled_from(["steps", "time"]),
)
def test_any_record_gets_a_verdict(name, yields, returned, kind, error, stopped):
    cases = some_cases(name)
    record = {"kind": kind, "yields": yields, "returned": returned, "error": error, "stopped": stopped}
    verdict = find_first(name, {"runs": [record] * len(cases)}, cases)
    assert not verdict.right
    verdict.html()


@pytest.mark.parametrize("text", ["\ud800", "<b>\x00", "a\nb", "</p><script>"])
def test_what_students_write_stands_on_any_page(text):
    """Error messages, names of types and of refused things reach a page, escaped and without what no page may hold."""
    error = {"type": text, "message": text, "line": 3, "source": text, "function": text}
    record = {"case": "x", "kind": "generator", "yields": [], "returned": None, "error": error, "stopped": None}
    told = {**record, "error": None, "yields": [{"type": text}]}
    for transcript in ({"runs": [record]}, {"runs": [told]}, {"refused": text}):
        page = check.judge("lawson", transcript, cases_of("lawson")).html()
        page.encode()
        assert "<b>" not in page
        assert "<script>" not in page


def test_a_transcript_without_an_end_is_cut():
    case = cases_of("segments")[0]
    record = {"case": "x", "kind": "generator", "yields": [case["triangles"]] * 100_000, "returned": None}
    verdict = check.judge("segments", {"runs": [{**record, "error": None, "stopped": None}]}, [case])
    assert "has not ended after 80 steps" in verdict.message


RUNS = {}


def right_run(name):
    if name not in RUNS:
        cases = [case for case in cases_of(name) if len(case.get("points", ())) < 12][:3]
        RUNS[name] = cases, json.loads(json.dumps(run(name, RIGHT[name][0], cases)))
    return RUNS[name]


def places_in(value, path=()):
    yield path
    for key, inner in enumerate(value) if isinstance(value, list) else value.items() if isinstance(value, dict) else ():
        yield from places_in(inner, (*path, key))


@for_all(120, name=st.sampled_from(sorted(RIGHT)), data=st.data())
def test_a_changed_transcript_gets_a_verdict(name, data):
    """Somewhere in a right one something else is put; most such answers are wrong, and none is a crash."""
    cases, transcript = right_run(name)
    assert find_first(name, transcript, cases).right
    changed = copy.deepcopy(transcript)
    path = data.draw(st.sampled_from(list(places_in(transcript["runs"]))))
    where = changed["runs"]
    for key in path[:-1]:
        where = where[key]
    if path:
        where[path[-1]] = data.draw(JSON)
    verdict = find_first(name, changed, cases)
    verdict.html()
    if path and path[-1] in ("yields", "error") and changed != transcript:
        assert not verdict.right or path[-1] == "yields"


@pytest.mark.parametrize("name", sorted(RIGHT))
def test_a_transcript_of_other_cases_is_wrong(name):
    """An answer to seed 0 does not do for seed 1."""
    transcript = run(name, RIGHT[name][0], cases_of(name, 0))
    assert not check.judge(name, transcript, cases_of(name, 1)).right


@pytest.mark.parametrize("name", sorted(RIGHT))
def test_a_case_left_out_is_wrong(name):
    cases = cases_of(name)
    transcript = run(name, RIGHT[name][0], cases[:-1])
    verdict = check.judge(name, transcript, cases)
    assert (verdict.right, verdict.passed, verdict.message) == (False, len(cases) - 1, "nothing came of this case")


def test_import_fem_mesh_stays_light():
    code = "import sys, fem_mesh; print(sorted(m for m in sys.modules if m.startswith('fem_mesh.check')))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"
    code = (
        "import sys, fem_mesh as fm; fm.check.orient(fm.orient); "
        "print([m for m in ('matplotlib', 'IPython', 'pytest', 'ipywidgets', 'numba', 'scipy') if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out == "orient: right on all 9 cases\n[]\n"
