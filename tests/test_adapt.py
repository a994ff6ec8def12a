"""The loop of adaptivity: it marks the least, refines that, keeps angles and points, and ends."""

import itertools
import pickle
import re

import numpy as np
import pytest

import fem_mesh as fm
from fem_mesh import poisson
from fem_mesh.algorithms.adapt import refine_marked


def solve(mesh):
    return poisson.solve(mesh, g=poisson.corner_solution)


def near(x, y):
    """An estimate that draws triangles to a place."""

    def estimate(mesh, _):
        return mesh.areas() / (1e-6 + np.square(mesh.points[mesh.triangles].mean(axis=1) - (x, y)).sum(axis=1))

    return estimate


def nothing(mesh):
    return None


def corner_run(**options):
    return list(fm.adapt(fm.l_shape(), solve, poisson.indicators, **{"max_unknowns": 400, **options}))


# ---- marking -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(60))
def test_no_smaller_set_holds_the_part_asked_for(seed):
    random = np.random.default_rng(seed)
    eta = np.sqrt(random.integers(0, 6, int(random.integers(1, 9))))
    theta = float(random.choice([0.25, 0.5, 0.75, 1.0]))
    marked, square = fm.mark(eta, theta), np.round(eta**2)
    enough = theta * square.sum()
    assert square[marked].sum() >= enough
    for fewer in itertools.combinations(range(len(eta)), max(int(marked.sum()) - 1, 0)):
        assert square[list(fewer)].sum() < enough or not marked.any()


def test_of_equal_triangles_the_first_are_marked():
    assert fm.mark([1, 1, 1, 1], 0.5).tolist() == [True, True, False, False]
    assert fm.mark([1, 2, 1, 2], 0.9).tolist() == [True, True, False, True]


def test_theta_1_marks_all_that_have_any_error_and_no_error_marks_none():
    assert fm.mark([3, 0, 1e-3, 0], 1.0).tolist() == [True, False, True, False]
    assert fm.mark(np.zeros(4)).tolist() == [False] * 4
    assert fm.mark([]).tolist() == []


def test_only_proportions_count_however_small_or_large():
    eta = np.random.default_rng(0).random(50)
    for scale in (1e-250, 1e250):
        np.testing.assert_array_equal(fm.mark(scale * eta, 0.3), fm.mark(eta, 0.3))


@pytest.mark.parametrize(
    ("eta", "theta", "says"),
    [
        ([1, 2, np.nan], 0.5, "the indicator of triangle 2 is nan: it must be finite, and at least 0"),
        ([1, -2], 0.5, "the indicator of triangle 1 is -2.0"),
        ([np.inf], 0.5, "the indicator of triangle 0 is inf"),
        ([[1, 2]], 0.5, r"one number for each triangle, shape \(m,\), not \(1, 2\)"),
        (["a"], 0.5, "indicators must be real numbers"),
        ([1, 2], 0, "0 < theta <= 1, not 0"),
        ([1, 2], 1.5, "0 < theta <= 1, not 1.5"),
        ([1, 2], float("nan"), "0 < theta <= 1, not nan"),
        ([1, 2], "half", "0 < theta <= 1, not 'half'"),
    ],
)
def test_what_is_no_indicator_or_part_is_refused(eta, theta, says):
    with pytest.raises(fm.MeshError, match=says):
        fm.mark(eta, theta)


# ---- rounds ------------------------------------------------------------------------------------------


def test_each_round_solves_estimates_marks_and_refines():
    steps = corner_run(rounds=3)
    kinds = [step.kind for step in steps]
    assert kinds == ["start", *["solve", "estimate", "mark", "refine"] * 2, "solve", "estimate", "done"]
    for before, step in itertools.pairwise(steps):
        assert step.facts["round"] - before.facts["round"] == (step.kind == "solve")
        mesh = step.facts["mesh"]
        assert (mesh is before.facts["mesh"]) == (step.kind != "refine")
        assert step.facts["elements"] == len(mesh.triangles)
        if "solution" in step.facts:
            assert len(step.facts["solution"]) == len(mesh.points) == step.facts["unknowns"]
        if "indicators" in step.facts:
            assert step.facts["error"] == pytest.approx(np.sqrt(np.sum(step.facts["indicators"] ** 2)))


def test_what_is_marked_is_what_is_shown_and_none_of_it_survives():
    steps = corner_run()
    for before, step in itertools.pairwise(steps):
        if step.kind == "refine":
            marked = fm.mark(before.facts["indicators"])
            assert before.kind == "mark"
            assert before.facts["marked"] == marked.sum() == len(before.doomed)
            gone = {frozenset(t) for t in before.doomed}
            assert gone == {frozenset(t) for t in before.facts["mesh"].triangles[marked].tolist()}
            assert gone.isdisjoint(frozenset(t) for t in step.facts["mesh"].triangles.tolist())


@pytest.mark.parametrize("angle", [0, 25, 30, 33])
@pytest.mark.parametrize("make", [fm.l_shape, fm.plate_with_hole, fm.cracked_square, lambda: fm.letter("B")])
def test_angles_points_and_segments_stay_through_all_rounds(make, angle):
    domain = make()
    before = None
    for step in fm.adapt(domain, nothing, near(0.1, 0.2), min_angle=angle, max_unknowns=600):
        if step.kind in ("start", "refine"):
            mesh = step.facts["mesh"].validate()
            assert mesh.min_angle >= angle * (1 - 1e-9)
            assert mesh.refinement.complete
            assert step.facts["min_angle"] == mesh.min_angle
            assert sorted(mesh.boundaries) == sorted({name for name in domain.names if name})
            if before is not None:
                assert len(mesh.points) > len(before.points)
                np.testing.assert_array_equal(mesh.points[: len(before.points)], before.points)
                if not domain.curves:
                    assert mesh.areas().sum() == pytest.approx(before.areas().sum(), rel=1e-12)
            before = mesh
    assert len(before.points) >= 600
    assert mesh is before


def test_triangles_come_where_the_error_is():
    *_, done = fm.adapt(fm.square(), nothing, near(0.7, 0.3), max_unknowns=1000)
    mesh = done.facts["mesh"]
    distance = np.hypot(*(mesh.points - (0.7, 0.3)).T)
    assert (distance < 0.1).sum() > 500  # on 3 % of the area


def test_marked_triangles_end_at_about_half_their_area():
    mesh = fm.refine(fm.square(), 30, max_area=0.01)
    marked = np.zeros(len(mesh.triangles), bool)
    marked[mesh.find(0.5, 0.5)] = True
    finer = refine_marked(mesh, marked)
    new = ~np.isin(np.sort(finer.triangles, axis=1), np.sort(mesh.triangles, axis=1)).all(axis=1)
    assert 0 < len(finer.points) - len(mesh.points) < 8
    assert finer.areas()[new].max() < mesh.areas().max()
    assert finer.areas()[finer.find(0.5, 0.5)] < 0.75 * mesh.areas()[marked]


def test_on_the_l_shape_it_beats_equal_triangles():
    steps = corner_run(max_unknowns=1500)
    mesh, u = steps[-1].facts["mesh"], steps[-1].facts["solution"]
    uniform = fm.refine(fm.l_shape(), 30, max_area=3 / (1.2 * len(u)))
    assert len(uniform.points) > len(u)
    errors = [poisson.energy_error(m, v, poisson.corner_gradient) for m, v in ((mesh, u), (uniform, solve(uniform)))]
    assert errors[1] > 2.3 * errors[0]


@pytest.mark.exhaustive
def test_at_10_000_unknowns_its_error_is_a_third_of_that_on_equal_triangles():
    found = []
    for step in fm.adapt(fm.l_shape(), solve, poisson.indicators):
        if step.kind == "estimate":
            facts = step.facts
            error = poisson.energy_error(facts["mesh"], facts["solution"], poisson.corner_gradient)
            found.append((np.log(facts["unknowns"]), np.log(error)))
    unknowns, errors = np.array(found).T
    uniform = fm.refine(fm.l_shape(), 30, max_area=2.42e-4)
    assert len(uniform.points) == pytest.approx(10_000, rel=0.01)
    error = poisson.energy_error(uniform, solve(uniform), poisson.corner_gradient)
    assert error > 3 * np.exp(np.interp(np.log(len(uniform.points)), unknowns, errors))
    late = unknowns > np.log(1000)
    assert np.polyfit(unknowns[late], errors[late], 1)[0] == pytest.approx(-0.5, abs=0.05)


# ---- beginning and ending ------------------------------------------------------------------------------


def test_the_first_mesh_that_has_so_many_unknowns_is_the_last():
    steps = corner_run(max_unknowns=200)
    unknowns = [step.facts["unknowns"] for step in steps if step.kind == "estimate"]
    assert unknowns[-2] < 200 <= unknowns[-1]
    assert steps[-1].kind == "done"
    assert not any(step.kind == "mark" and step.facts["round"] == steps[-1].facts["round"] for step in steps)


def test_unknowns_are_those_of_the_solution_where_it_is_an_array():
    steps = fm.adapt(fm.l_shape(), lambda mesh: np.zeros(5 * len(mesh.points)), near(0, 0), max_unknowns=1000)
    *_, done = steps
    assert done.facts["unknowns"] == 5 * len(done.facts["mesh"].points)
    assert len(done.facts["mesh"].points) < 1000
    *_, done = fm.adapt(
        fm.l_shape(), lambda mesh: np.zeros(1), near(0, 0), max_unknowns=300
    )  # too few: no way to go on for ever
    assert done.facts["unknowns"] == len(done.facts["mesh"].points) >= 300


def test_without_an_error_it_ends_at_once():
    steps = list(fm.adapt(fm.square(), nothing, lambda mesh, _: np.zeros(len(mesh.triangles))))
    assert [step.kind for step in steps] == ["start", "solve", "estimate", "done"]
    assert steps[-1].caption == "after 1 round: 51 unknowns, error estimate 0"


def test_where_numbers_have_no_room_for_smaller_triangles_it_ends_and_says_so():
    def at_the_corner(mesh, _):
        return (mesh.triangles == 0).any(axis=1).astype(float)

    domain = fm.Domain.from_loops([(0.5, 0.5), (1, 0.5), (1, 1), (0.5, 1)])
    steps = list(fm.adapt(domain, nothing, at_the_corner, max_unknowns=1_000_000, theta=1.0))
    assert steps[-1].kind == "done"
    assert steps[-1].caption.endswith("; what is marked has no room for smaller triangles")
    assert len(steps[-1].facts["mesh"].points) < 3000
    assert steps[-1].facts["mesh"].validate().min_angle >= 30


def test_it_begins_with_a_mesh_and_keeps_its_points():
    mesh = fm.refine(fm.plate_with_hole(), 30, max_area=0.05)
    start, *_, done = fm.adapt(mesh, nothing, near(0.6, 0), rounds=3)
    np.testing.assert_array_equal(start.facts["mesh"].triangles, mesh.triangles)
    np.testing.assert_array_equal(done.facts["mesh"].points[: len(mesh.points)], mesh.points)
    assert len(done.facts["mesh"].points) > len(mesh.points)


def test_the_first_mesh_is_as_coarse_as_asked():
    sizes = [next(fm.adapt(fm.l_shape(), solve, poisson.indicators, coarsest=size)).facts["elements"] for size in (1, 0.5, 0.1)]
    assert sizes[0] < sizes[1] < sizes[2]


# ---- recorded ----------------------------------------------------------------------------------------


def test_a_trace_keeps_what_each_round_changes():
    trace = fm.record(fm.adapt(fm.l_shape(), solve, poisson.indicators, max_unknowns=150))
    before = set()
    for k, step in enumerate(trace):
        points, triangles = trace.frame(k)
        mesh = step.facts["mesh"]
        now = {frozenset(t) for t in mesh.triangles.tolist()}
        np.testing.assert_array_equal(points[: len(mesh.points)], mesh.points)
        assert {frozenset(t) for t in triangles.tolist()} == now
        assert {frozenset(t) for t in step.added} == now - before
        assert {frozenset(t) for t in step.removed} == before - now
        assert {frozenset(s) for s in trace.segments(k).tolist()} == {frozenset(s) for s in mesh.segments.tolist()}
        if step.kind == "refine":
            assert len(step.new_points) == step.facts["added_points"]
        before = now
    assert trace.mesh is trace[-1].facts["mesh"]
    assert min(trace.min_angles()) >= 30 * (1 - 1e-9)
    assert pickle.loads(pickle.dumps(list(trace)))[3].caption == trace[3].caption


def test_captions_are_sentences_with_the_numbers():
    for step in corner_run(max_unknowns=100):
        assert re.fullmatch(r"[^\n]+", step.caption)
        if step.kind == "estimate":
            k, n, error = (step.facts[key] for key in ("round", "unknowns", "error"))
            assert step.caption == f"round {k}: {n} unknowns, error estimate {error:.3g}"


# ---- bad input -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"theta": 0}, "theta must be a part of the error, 0 < theta <= 1, not 0"),
        ({"min_angle": 60}, "min_angle must be at least 0 and below 60"),
        ({"max_unknowns": 0}, "max_unknowns must be a whole number, at least 1, not 0"),
        ({"max_unknowns": 10.5}, "max_unknowns must be a whole number"),
        ({"rounds": 0}, "rounds must be a whole number, at least 1, not 0"),
        ({"rounds": True}, "rounds must be a whole number"),
        ({"coarsest": -1}, "size must be greater than 0"),
        ({"solve": 3}, "solve must be a function, not 3"),
        ({"estimate": None}, "estimate must be a function, not None"),
        ({"domain": [(0, 0)]}, "refine needs a Domain or a Mesh, not list"),
        ({"domain": fm.delaunay([(0, 0), (1, 1), (2, 2)])}, "there is nothing to adapt: no triangles: all 3 points"),
    ],
)
def test_bad_options_are_refused_before_the_first_step(options, says):
    given = {"domain": fm.square(), "solve": nothing, "estimate": near(0, 0), **options}
    with pytest.raises(fm.MeshError, match=says):
        fm.adapt(given.pop("domain"), given.pop("solve"), given.pop("estimate"), **given)


@pytest.mark.parametrize(
    ("estimate", "says"),
    [
        (lambda mesh, u: np.ones(3), r"estimate\(mesh, solution\): indicators must be one number for each of the 79 triangles"),
        (lambda mesh, u: None, r"estimate\(mesh, solution\): indicators must be real numbers"),
        (lambda mesh, u: -np.ones(len(mesh.triangles)), r"estimate\(mesh, solution\): the indicator of triangle 0 is -1.0"),
        (
            lambda mesh, u: np.full(len(mesh.triangles), np.nan),
            r"estimate\(mesh, solution\): the indicator of triangle 0 is nan",
        ),
        (lambda mesh, u: np.ones((len(mesh.triangles), 1)), r"shape \(79,\), not \(79, 1\)"),
    ],
)
def test_what_estimate_returns_is_checked(estimate, says):
    with pytest.raises(fm.MeshError, match=says):
        list(fm.adapt(fm.square(), nothing, estimate))


def test_what_solve_and_estimate_raise_passes_with_a_note_that_names_them():
    def broken(mesh):
        raise ZeroDivisionError("singular")

    with pytest.raises(ZeroDivisionError, match="singular") as caught:
        list(fm.adapt(fm.square(), broken, near(0, 0)))
    assert caught.value.__notes__ == [
        "raised by solve(mesh) in round 1 of adapt, on Mesh: 51 points, 79 triangles, 21 segments, smallest angle 30.7 degrees"
    ]
    with pytest.raises(fm.MeshError, match="u must be what solve") as caught:
        list(fm.adapt(fm.square(), lambda mesh: "nonsense", lambda mesh, u: poisson.indicators(mesh, [1.0])))
    assert caught.value.__notes__[0].startswith("raised by estimate(mesh, solution) in round 1 of adapt, on Mesh: 51 points")
