"""Right answers pass, whatever their kind; wrong ones get the message that is meant for them."""

import re

import pytest
from corpus import EXHAUSTIVE
from right_answers import RIGHT
from wrong_answers import ELL, FINE, MESHES, WRONG

import fem_mesh as fm
from fem_mesh import check
from fem_mesh.check.judge import find_first
from fem_mesh.check.run import given


def name_of(work):
    return getattr(work, "__name__", type(work).__name__)


def verdict_of(name, work, seed=0, seconds=10.0):
    cases = check.cases_of(name, seed)
    return find_first(name, check.run(name, work, cases, seconds=seconds), cases)


def says(pattern, text):
    """Whether a text has the words of a pattern: "..." stands for anything, "|" for or."""
    pattern = "|".join(".*".join(map(re.escape, choice.split("..."))) for choice in pattern.split("|"))
    return re.search(pattern, text.replace('"', ""))


ANSWERS = [pytest.param(name, work, id=f"{name}-{name_of(work)}") for name, works in RIGHT.items() for work in works]


@pytest.mark.parametrize(("name", "work"), ANSWERS)
@pytest.mark.parametrize("seeds", [[0, 1], pytest.param(range(2, 40), marks=EXHAUSTIVE)])
def test_right_answers_pass(name, work, seeds):
    for seed in seeds:
        verdict = verdict_of(name, work, seed)
        assert verdict.right, f"seed {seed}: {verdict}"
        assert verdict.passed == verdict.total == len(check.cases_of(name, seed))
        assert str(verdict) == f"{name}: right on all {verdict.total} cases"


@pytest.mark.parametrize(("name", "work", "message"), [pytest.param(*row, id=f"{row[0]}-{name_of(row[1])}") for row in WRONG])
def test_wrong_answers_get_their_message(name, work, message):
    verdict = verdict_of(name, work, seconds=0.3)
    assert not verdict.right
    assert says(message, str(verdict)), f"{verdict}, instead of {message}"
    assert verdict.passed < verdict.total
    assert len(str(verdict)) < 600
    assert "!" not in str(verdict)


@pytest.mark.parametrize(("name", "work", "message"), WRONG)
def test_a_verdict_is_plain_values_and_draws_itself(name, work, message):
    verdict = verdict_of(name, work, seconds=0.3)
    again = check.Verdict(**verdict.as_json())
    assert again == verdict
    assert verdict.html() == again.html()
    if verdict.picture is not None:
        assert "<img " in verdict.html()
        assert verdict.draw().svg.startswith("<svg ")
        assert not re.search(r"\bnan\b", verdict.draw().svg)


@pytest.mark.parametrize(("name", "work", "message"), list(WRONG)[::3])
def test_two_runs_say_the_same(name, work, message):
    assert verdict_of(name, work, seconds=0.5).html() == verdict_of(name, work, seconds=0.5).html()


def test_every_check_has_a_bank():
    for name in RIGHT:
        assert len(RIGHT[name]) >= 3
        assert sum(row[0] == name for row in WRONG) >= 8
    assert len(MESHES) >= 8


# ---- meshes ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("message", "points", "triangles", "asked"), MESHES, ids=[row[0][:30] for row in MESHES])
def test_wrong_meshes_get_their_message(message, points, triangles, asked):
    verdict = find_first("mesh", given(points, triangles), [check.mesh_case(**asked)])
    assert not verdict.right
    assert says(message, str(verdict)), f"{verdict}, instead of {message}"
    verdict.html()


@pytest.mark.parametrize(
    "domain",
    [fm.l_shape(), fm.plate_with_hole(), fm.cracked_square(), fm.star(), fm.gear(), fm.airfoil(), fm.letter("A")],
    ids=repr,
)
def test_refined_meshes_pass(domain, capsys):
    mesh = fm.refine(domain, min_angle=20)
    assert check.mesh(mesh.points, mesh.triangles, domain=mesh_domain(domain, mesh)) is None
    assert capsys.readouterr().out == "mesh: right on its case\n"


def mesh_domain(domain, mesh):
    """What a curved domain has become."""
    return domain if not domain.curves else fm.Domain(mesh.points, mesh.segments)


def test_a_mesh_in_any_order_and_orientation_passes():
    check.mesh(FINE.points.tolist(), [t[::-1] for t in FINE.triangles.tolist()[::-1]], domain=ELL, min_angle=25)
    check.mesh(FINE.points, set(map(frozenset, FINE.triangles.tolist())), domain=ELL)


def test_a_mesh_must_have_the_points_that_were_asked_for():
    case = check.mesh_case(points=[(0, 0), (1, 0), (0, 1), (1, 1)])
    verdict = find_first("mesh", given([(0, 0), (1, 0), (0, 1)], [(0, 1, 2)]), [case])
    assert "keep them as they are" in str(verdict)


# ---- the verbs ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", RIGHT)
def test_verbs_print_one_line_or_raise(name, capsys):
    verb = getattr(fm.check, name)
    assert verb(RIGHT[name][0]) is None
    printed = capsys.readouterr()
    assert printed.err == ""
    assert printed.out == f"{name}: right on all {len(check.cases_of(name))} cases\n"
    with pytest.raises(check.CheckFailed) as raised:
        verb(lambda *arguments: None)
    assert isinstance(raised.value, AssertionError)
    assert raised.value._render_traceback_() == [f"CheckFailed: {raised.value}"]
    assert capsys.readouterr() == ("", "")


NOTEBOOK = """
def lawson(points, triangles):
    for t in triangles:
        print(points[99])
        yield triangles
"""
TIES = """
def lawson(points, triangles):
    if len(points) == 4:
        yield [(0, 1, 3), (1, 2, 3)]
    if len(triangles) == 2:
        yield [(0, 1, 2), (0, 2, 3)]
"""


def outputs_of(cells):
    """What cells say in a kernel: for each its messages, those that are shown."""
    manager = pytest.importorskip("jupyter_client.manager")
    kernel, client = manager.start_new_kernel(kernel_name="python3")
    try:
        for cell in cells:
            shown = []
            client.execute_interactive(cell.strip(), output_hook=shown.append, timeout=60)
            yield [(m["msg_type"], m["content"]) for m in shown if m["msg_type"] in ("stream", "display_data", "error")]
    finally:
        client.stop_channels()
        kernel.shutdown_kernel(now=True)
        kernel.context.destroy()


def test_in_a_notebook_the_picture_comes_before_the_sentence():
    cells = ["import fem_mesh as fm", NOTEBOOK, "fm.check.lawson(lawson)", TIES, "fm.check.lawson(lawson)"]
    _, _, raised, _, ties = outputs_of(cells)
    ((_, failed),) = raised
    assert failed["ename"] == "CheckFailed"
    assert failed["evalue"] == (
        'lawson, case "a kite with the wrong diagonal", step 1: line 3, `print(points[99])`, '
        "raised IndexError: list index out of range"
    )
    assert failed["traceback"] == [f"CheckFailed: {failed['evalue']}"]
    (kind, shown), (_, failed) = ties
    assert kind == "display_data"
    assert shown["data"]["text/plain"] == failed["evalue"]
    assert shown["data"]["text/html"].startswith('<img src="data:image/svg+xml,')
    assert "step 2: you flipped edge 1-3, but no vertex lies inside either circle" in failed["evalue"]
