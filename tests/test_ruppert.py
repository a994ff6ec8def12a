"""Refinement of every domain that broke others: it ends, keeps its bounds, and says truly what it could not keep."""

import math
import pickle
import warnings

import exact_constrained as check
import numpy as np
import pytest
from corpus import EXHAUSTIVE
from domains import (
    DOMAINS,
    Recipe,
    add,
    box,
    cells,
    fan,
    fork,
    loops,
    over_seeds,
    pair,
    random_segments,
    rows,
    star_polygon,
    wedge,
)
from test_segments import SHAPES, SPLIT, play, same_mesh

import fem_mesh as fm
from fem_mesh import kernel
from fem_mesh.domain.domain import Region

BUDGET = 600  # vertices: enough for most of the corpus at 20 degrees, and soon spent
BOUNDS = [20, 33, *(pytest.param(bound, marks=EXHAUSTIVE) for bound in (5, 12, 26, 30, 36, 40))]
EASY = [
    "unit_square",
    "letter_a",
    "letter_b",
    "letter_e",
    "nested_squares",
    "seventeen_gon",
    "two_loops_sharing_part_of_a_side",
]
INSIDE_OUT = ["lens", "circle"]


def refined(recipe, *, min_angle=20.0, oracle=None, **options):
    """The refined mesh of a recipe, or of a Domain, held up to all nine points."""
    domain = recipe.domain() if isinstance(recipe, Recipe) else recipe
    options.setdefault("max_points", BUDGET)
    mesh = fm.refine(domain, min_angle=min_angle, **options)
    asked = {key: options[key] for key in ("max_area", "size", "max_points", "encroachment") if key in options}
    oracle = domain if oracle is None and not isinstance(recipe, Recipe) else oracle or recipe
    check.validate_refinement(oracle, mesh, min_angle=min_angle, base=domain.points, **asked)
    return mesh


def of(name):
    """What to refine, and what to hold the mesh up to."""
    return DOMAINS[name]().domain() if name in SPLIT else DOMAINS[name]()


# --- the corpus ---


@pytest.mark.parametrize("bound", BOUNDS)
@pytest.mark.parametrize("name", DOMAINS)
def test_every_domain_is_refined_within_the_budget_and_what_is_left_is_said(name, bound):
    refined(of(name), min_angle=bound)


@pytest.mark.parametrize("name", DOMAINS)
def test_with_diametral_circles_and_circumcenters_too(name):
    refined(of(name), min_angle=20, encroachment="circle", steiner="circumcenter")


@pytest.mark.parametrize("name", EASY)
@pytest.mark.parametrize("bound", [0, 5, 15, 20, 25, 30, 33])
def test_domains_without_small_angles_keep_the_bound_everywhere(name, bound):
    mesh = refined(DOMAINS[name](), min_angle=bound, max_points=5_000)
    assert mesh.refinement.complete
    assert not len(mesh.refinement.left)
    assert mesh.note == ""


@pytest.mark.parametrize("bound", [20, 28, *(pytest.param(bound, marks=EXHAUSTIVE) for bound in (5, 33))])
@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_is_refined(name, bound):
    refined(SHAPES[name](), min_angle=bound, max_points=5_000)


@over_seeds(25, 1_000)
def test_star_polygons(seed):
    refined(star_polygon(seed), min_angle=(20, 28, 33)[seed % 3], max_points=300)


@over_seeds(25, 1_000)
def test_sets_of_segments_that_do_not_cross(seed):
    refined(random_segments(seed), min_angle=(20, 28, 33)[seed % 3], max_points=300)


@over_seeds(25, 1_000)
def test_outlines_of_lattice_cells_full_of_ties(seed):
    refined(cells(seed), min_angle=(20, 28, 33)[seed % 3], max_points=400)


@over_seeds(8, 300)
def test_random_domains_far_from_the_origin(seed):
    points = star_polygon(seed).points
    refined(loops(np.round((512700, 5.4e6) + 67 * (1 + points), 3)), min_angle=25, max_points=300)


# --- small input angles ---


@pytest.mark.parametrize("degrees", [1, 2, 3, 5, 8, 12, 17, 20, 25, 29, 30, 35, 41, 45, 52, 59, 60])
@pytest.mark.parametrize("bound", [20, 30])
def test_a_wedge_is_finished_and_only_its_tip_is_excused(degrees, bound):
    mesh = refined(wedge(degrees), min_angle=bound, max_points=5_000)
    assert mesh.refinement.complete
    assert set(mesh.refinement.why) <= {"small input angle"}
    if degrees != bound:
        assert bool(len(mesh.refinement.left)) == (degrees < bound)


@pytest.mark.parametrize("degrees", [2, 10, 30, 50, 59, 61, 90])
@pytest.mark.parametrize("bound", [20, 26])
@pytest.mark.parametrize("encroachment", INSIDE_OUT)
def test_two_segments_that_meet_inside_are_finished(degrees, bound, encroachment):
    mesh = refined(fork(degrees), min_angle=bound, max_points=5_000, encroachment=encroachment)
    assert mesh.refinement.complete


@pytest.mark.parametrize("degrees", [4, 9, 20, 36])
def test_a_fan_of_segments_is_finished(degrees):
    mesh = refined(fan(9, degrees), min_angle=26, max_points=8_000)
    assert mesh.refinement.complete


def test_a_wedge_of_20_degrees_asked_for_30_says_what_is_left_and_why():
    mesh = fm.refine(wedge(20).domain(), min_angle=30)
    assert mesh.refinement.complete
    assert set(mesh.refinement.why) == {"small input angle"}
    worst = check.angles_of(mesh)[mesh.refinement.left].min(axis=1)
    assert (worst < 30).all()
    assert mesh.min_angle == pytest.approx(worst.min())


def test_a_crack_of_a_fiftieth_of_a_degree_ends_and_is_usable():
    for name in ("crack_of_a_fiftieth_of_a_degree", "notch_of_a_fiftieth_of_a_degree"):
        mesh = refined(DOMAINS[name](), min_angle=25, max_points=20_000)
        assert mesh.refinement.complete


# --- never endless ---


@pytest.mark.parametrize("degrees", [104, 105])
def test_one_to_sqrt_two_with_lenses_ends_by_itself(degrees):
    mesh = refined(pair(degrees), min_angle=31, max_points=20_000)
    assert mesh.refinement.complete
    assert not len(mesh.refinement.left)


@pytest.mark.parametrize("degrees", [104, 105])
@pytest.mark.parametrize("steiner", ["circumcenter", "offcenter"])
def test_one_to_sqrt_two_with_circles_stops_at_the_budget_at_the_latest(degrees, steiner):
    mesh = refined(pair(degrees), min_angle=31, encroachment="circle", steiner=steiner, max_points=1_500)
    assert mesh.refinement.added <= 1_500
    assert mesh.refinement.complete or mesh.note


@pytest.mark.parametrize("bound", [40, 50, 59.9])
def test_a_bound_beyond_reach_stops_at_the_budget_with_a_usable_mesh(bound):
    mesh = refined(DOMAINS["nested_squares"](), min_angle=bound, max_points=500)
    assert not mesh.refinement.complete
    assert "budget" in mesh.refinement.why
    assert mesh.note


@pytest.mark.parametrize("budget", [0, 1, 2, 3, 6])
def test_the_budget_is_kept_however_small(budget):
    mesh = refined(DOMAINS["letter_a"](), min_angle=30, max_points=budget)
    assert mesh.refinement.added <= budget
    assert not mesh.refinement.complete


def test_an_area_that_asks_for_millions_stops_at_the_budget():
    mesh = refined(DOMAINS["unit_square"](), max_area=1.2e-7, max_points=700)
    assert 650 < mesh.refinement.added <= 700
    assert not mesh.refinement.complete


@pytest.mark.parametrize(
    "name", ["vertex_1e_15_above_the_bottom_side", "three_points_one_ulp_apart", "grid_turned_by_302_degrees"]
)
def test_precision_ends_what_no_budget_would(name):
    refined(DOMAINS[name](), min_angle=30, max_points=5_000)


# --- size ---


@pytest.mark.parametrize("name", [*EASY, "fork_of_10_degrees", "leg_486_high_and_1_wide"])
@pytest.mark.parametrize("share", [0.3, 0.05])
def test_areas_and_edges_keep_their_bounds(name, share):
    recipe = DOMAINS[name]()
    extent = np.ptp(recipe.points, axis=0)
    area, edge = float(share**2 * extent.prod() / 4), float(share * extent.max())
    for options in ({"max_area": area}, {"size": edge}, {"max_area": area, "size": edge}):
        assert refined(recipe, max_points=20_000, **options).refinement.complete


@pytest.mark.parametrize("bound", [0, 20])
def test_a_size_that_grows_with_the_distance_from_a_corner(bound):
    def size(x, y):
        assert isinstance(x, np.ndarray)
        assert x.shape == y.shape
        return 0.05 + 0.4 * np.hypot(x, y)

    mesh = refined(DOMAINS["letter_b"](), min_angle=bound, size=size, max_points=20_000)
    assert mesh.refinement.complete
    near = np.hypot(*mesh.points[mesh.triangles].mean(axis=1).T) < 1
    longest = check.sides_of(mesh).max(axis=1)
    assert longest[near].max() < longest[~near].max() / 3


def test_size_alone_without_a_bound_on_angles():
    mesh = refined(DOMAINS["letter_e"](), min_angle=0, size=0.6, max_points=5_000)
    assert mesh.refinement.complete


def test_a_number_and_a_function_of_that_number_give_meshes_as_large():
    recipe = DOMAINS["letter_a"]()
    constant = refined(recipe, size=0.7, max_points=5_000)
    function = refined(recipe, size=lambda x, y: np.full(np.shape(x), 0.7), max_points=5_000)
    assert len(function.triangles) == pytest.approx(len(constant.triangles), rel=0.2)


def halves(left, right):
    recipe = DOMAINS["a_segment_from_side_to_side"]()
    regions = [Region(0.1, 0.5, "left", **left), Region(0.9, 0.5, "right", **right)]
    return fm.Domain(recipe.points, recipe.segments, regions=regions)


def test_each_region_keeps_its_own_size():
    mesh = refined(halves({"size": 0.05}, {"max_area": 0.1}), max_points=20_000)
    assert mesh.refinement.complete
    check.check_regions(mesh, [(0.1, 0.5), (0.9, 0.5)])
    longest, left = check.sides_of(mesh).max(axis=1), mesh.regions == 1
    assert longest[left].max() <= 0.05 * (1 + 1e-12)
    assert mesh.areas()[~left].max() <= 0.1 * (1 + 1e-12)
    assert (mesh.regions > 0).all()
    assert left.sum() > 10 * (~left).sum() / 5


def test_the_stricter_of_a_regions_size_and_the_size_asked_for_holds():
    mesh = refined(halves({"size": 0.05}, {}), size=0.2, max_points=20_000)
    longest, left = check.sides_of(mesh).max(axis=1), mesh.regions == 1
    assert longest[left].max() <= 0.05 * (1 + 1e-12)
    assert longest.max() <= 0.2 * (1 + 1e-12)


# --- part of a mesh, and a mesh again ---


def triangle_set(mesh, keep):
    return {frozenset(map(tuple, corners)) for corners in mesh.points[mesh.triangles[keep]].tolist()}


@pytest.mark.parametrize("name", ["nested_squares", "letter_b", "open_chains_and_loose_points"])
def test_where_a_mask_says_so_and_near_it_triangles_change_and_nowhere_else(name):
    recipe = DOMAINS[name]()
    start = fm.refine(recipe.domain(), size=float(np.ptp(recipe.points) / 12))
    centre = start.points[start.triangles].mean(axis=1)
    where = np.hypot(*(centre - centre[0]).T) < np.ptp(recipe.points) / 6
    mesh = fm.refine(start, where=where, max_area=float(start.areas().max() / 30), max_points=5_000)
    check.validate_refinement(recipe, mesh, min_angle=20, max_points=5_000, base=start.points, everywhere=False)
    assert mesh.refinement.added > 20
    far = np.hypot(*(centre - centre[0]).T) > np.ptp(recipe.points) / 3
    everything = np.ones(len(mesh.triangles), bool)
    assert far.any()
    assert triangle_set(start, far) <= triangle_set(mesh, everything)
    inside = np.hypot(*(mesh.points[mesh.triangles].mean(axis=1) - centre[0]).T) < np.ptp(recipe.points) / 12
    assert mesh.areas()[inside].max() <= start.areas().max() / 30 * (1 + 1e-12)


def test_a_mask_of_nothing_changes_nothing():
    start = fm.refine(DOMAINS["letter_b"]().domain(), size=1.0)
    mesh = fm.refine(start, where=np.zeros(len(start.triangles), bool), max_area=1e-3)
    assert mesh.refinement.added == 0
    assert triangle_set(mesh, slice(None)) == triangle_set(start, slice(None))


@pytest.mark.parametrize("name", [*EASY, "wedge_of_12_degrees", "fork_of_10_degrees", "star_polygon_0"])
@pytest.mark.parametrize("encroachment", INSIDE_OUT)
def test_refining_a_refined_mesh_again_adds_nothing(name, encroachment):
    options = {"min_angle": 25, "max_area": float(np.ptp(DOMAINS[name]().points) ** 2 / 100), "encroachment": encroachment}
    once = fm.refine(DOMAINS[name]().domain(), max_points=20_000, **options)
    assert once.refinement.complete
    twice = fm.refine(once, max_points=20_000, **options)
    assert twice.refinement.added == 0
    assert twice.refinement.complete
    assert triangle_set(twice, slice(None)) == triangle_set(once, slice(None))
    assert sorted(map(sorted, twice.segments.tolist())) == sorted(map(sorted, once.segments.tolist()))


@pytest.mark.parametrize("name", EASY)
def test_a_cdt_refined_is_the_domain_refined(name):
    domain = DOMAINS[name]().domain()
    mesh = fm.refine(fm.constrained_delaunay(domain), min_angle=26)
    check.validate_refinement(DOMAINS[name](), mesh, min_angle=26, base=domain.points)


def test_a_refined_mesh_is_refined_further():
    recipe = DOMAINS["nested_squares"]()
    coarse = fm.refine(recipe.domain(), min_angle=20)
    fine = fm.refine(coarse, min_angle=30, max_area=0.5)
    check.validate_refinement(recipe, fine, min_angle=30, max_area=0.5, base=coarse.points)
    assert fine.refinement.added == len(fine.points) - len(coarse.points)


# --- the same mesh ---

TWICE = ["letter_b", "seventeen_gon", "star_polygon_1", "random_segments_0", "wedge_of_12_degrees", "metres_of_a_survey"]


def bits(mesh):
    arrays = (mesh.points, mesh.triangles, mesh.neighbors, mesh.segments, mesh.segment_of, mesh.refinement.left)
    return [np.ascontiguousarray(array).tobytes() for array in arrays] + [mesh.refinement.why]


@pytest.mark.parametrize("name", TWICE)
def test_the_same_input_gives_the_same_mesh_bit_for_bit(name):
    one, other = (fm.refine(DOMAINS[name]().domain(), min_angle=30, max_points=BUDGET) for _ in range(2))
    assert bits(one) == bits(other)


@pytest.mark.parametrize("name", TWICE)
@pytest.mark.parametrize("power", [-90, 3, 100])
def test_scaling_by_a_power_of_two_scales_the_mesh(name, power):
    recipe = DOMAINS[name]()
    extent = float(np.ptp(recipe.points))
    for options in (
        {},
        {"encroachment": "circle", "steiner": "circumcenter"},
        {"size": extent / 8},
        {"max_area": extent**2 / 200},
    ):
        more = {"size": 2.0**power, "max_area": 4.0**power}
        scaled = {key: value * more.get(key, 1) if key in more else value for key, value in options.items()}
        mesh = fm.refine(recipe.domain(), min_angle=25, max_points=BUDGET, **options)
        other = fm.refine(recipe.scaled(power).domain(), min_angle=25, max_points=BUDGET, **scaled)
        np.testing.assert_array_equal(mesh.points * 2.0**power, other.points)
        np.testing.assert_array_equal(mesh.triangles, other.triangles)
        np.testing.assert_array_equal(mesh.segments, other.segments)
        assert mesh.refinement.why == other.refinement.why


OPTIONS = [
    {},
    {"min_angle": 32},
    {"encroachment": "circle"},
    {"steiner": "circumcenter"},
    {"max_area": 0.3},
    {"size": 0.5},
    {"size": lambda x, y: 0.3 + 0.1 * np.abs(x)},
    {"max_points": 7},
]


@pytest.mark.parametrize("options", OPTIONS, ids=lambda options: ", ".join(options) or "as it is")
@pytest.mark.parametrize(
    "name", ["letter_e", "wedge_of_12_degrees", "random_segments_1", "star_polygon_2", "fork_of_10_degrees"]
)
def test_watched_in_plain_python_and_compiled_the_mesh_is_the_same_to_the_last_index(name, options, monkeypatch):
    domain, options = DOMAINS[name]().domain(), {"max_points": 150} | options
    watched = play(fm.ruppert(domain, **options))
    monkeypatch.setattr(kernel, "SMALL", -1)
    compiled = fm.refine(domain, **options)
    same_mesh(watched, compiled)
    assert bits(watched) == bits(compiled)
    assert watched.refinement.complete == compiled.refinement.complete


@over_seeds(20, 500)
def test_both_drivers_agree_on_random_domains(seed):
    domain = (star_polygon, random_segments, cells)[seed % 3](seed).domain()
    watched, before = play(fm.ruppert(domain, min_angle=28, max_points=80)), kernel.SMALL
    kernel.SMALL = -1
    try:
        assert bits(watched) == bits(fm.refine(domain, min_angle=28, max_points=80))
    finally:
        kernel.SMALL = before


# --- steps ---


@pytest.mark.parametrize("name", ["letter_e", "wedge_of_12_degrees", "lattice_cells_1", "fork_of_10_degrees"])
@pytest.mark.parametrize("encroachment", INSIDE_OUT)
def test_every_frame_is_a_valid_triangulation(name, encroachment):
    trace = fm.record(fm.ruppert(DOMAINS[name]().domain(), min_angle=34, max_points=40, encroachment=encroachment))
    for k in range(len(trace)):
        points, triangles = trace.frame(k)
        check.check_triangles(points, triangles.tolist())
    assert {frozenset(t) for t in trace.frame(len(trace) - 1)[1].tolist()} == {
        frozenset(t) for t in trace.mesh.triangles.tolist()
    }
    assert all(step.caption and "\n" not in step.caption for step in trace)
    assert trace[-1].kind == "done"
    assert {"skinny", "encroached", "split"} & {step.kind for step in trace}


def test_a_mesh_is_refined_step_by_step_too():
    coarse = fm.refine(DOMAINS["letter_b"]().domain(), min_angle=20)
    trace = fm.record(fm.ruppert(coarse, min_angle=30, max_area=1.0))
    assert bits(trace.mesh) == bits(fm.refine(coarse, min_angle=30, max_area=1.0))


# --- what is refused ---

NAN = float("nan")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"min_angle": NAN}, "min_angle.*nan"),
        ({"min_angle": -1}, "min_angle.*-1"),
        ({"min_angle": 60}, "min_angle.*60"),
        ({"min_angle": float("inf")}, "min_angle"),
        ({"min_angle": "20"}, "min_angle"),
        ({"max_area": 0}, "max_area.*0"),
        ({"max_area": -2.0}, r"max_area.*-2"),
        ({"max_area": NAN}, "max_area.*nan"),
        ({"size": 0}, "size.*0"),
        ({"size": -1.0}, "size.*-1"),
        ({"size": NAN}, "size.*nan"),
        ({"size": lambda x, y: np.where(x > 1, NAN, 1.0)}, "size.*nan"),
        ({"size": lambda x, y: 1.0 - x}, "size"),
        ({"size": lambda x, y: np.ones(3)}, "size.*shape"),
        ({"max_points": -1}, "max_points.*-1"),
        ({"encroachment": "square"}, "encroachment.*square"),
        ({"steiner": "centroid"}, "steiner.*centroid"),
        ({"where": np.ones(3, bool)}, "where"),
    ],
    ids=lambda value: value if isinstance(value, str) else ", ".join(value),
)
def test_bad_arguments_are_refused_by_name(options, message):
    domain = DOMAINS["letter_b"]().domain()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(fm.MeshError, match=message):
            fm.refine(domain, **options)
        with pytest.raises(fm.MeshError, match=message):
            play(fm.ruppert(domain, **options))


@pytest.mark.parametrize("where", [np.ones(3, bool), [1.5], "all", np.ones((2, 2), bool)])
def test_a_mask_must_have_one_value_a_triangle(where):
    mesh = fm.constrained_delaunay(DOMAINS["letter_b"]().domain())
    with pytest.raises(fm.MeshError, match="where"):
        fm.refine(mesh, where=where)


def test_what_is_neither_domain_nor_mesh_is_refused():
    for wrong in (None, [(0, 0), (1, 0), (0, 1)], 7):
        with pytest.raises(fm.MeshError, match="Domain"):
            fm.refine(wrong)


def test_a_domain_without_triangles_is_refined_to_nothing():
    mesh = fm.refine(fm.Domain([(0, 0), (1, 1), (2, 2)], [(0, 1), (1, 2)]))
    assert mesh.triangles.shape == (0, 3)
    assert mesh.note


def test_a_plain_delaunay_mesh_is_refined_within_its_hull():
    start = fm.delaunay(fm.random_points(30, seed=2))
    mesh = fm.refine(start, min_angle=25)
    check.check_realisation(mesh, closed=False)
    check.check_angles(mesh, 25)
    assert mesh.refinement.complete
    assert mesh.points[:30].tobytes() == start.points.tobytes()
    assert float(check.area_of(mesh)) == pytest.approx(float(check.area_of(start)), rel=2.0**-40)


def test_loose_rows_and_bridges_stay_edges():
    for name in ("bridge_from_the_outline_to_a_hole", "open_chains_and_loose_points", "chain_touching_its_own_edge"):
        refined(add(DOMAINS[name](), []), min_angle=28, max_points=3_000)
    refined(rows([*box(0, 0, 9, 9), (3, 3), (6, 3)], [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5)]), min_angle=30)


# --- curves, moves, masks ---


@pytest.mark.parametrize(
    "options", [{"min_angle": 30}, {"min_angle": 28, "size": 0.15}, {"min_angle": 25, "steiner": "circumcenter"}]
)
@pytest.mark.parametrize("make", [fm.disk, fm.annulus, fm.airfoil, fm.turbine_blade, fm.gear], ids=lambda make: make.__name__)
def test_curved_shapes_are_refined_like_others(make, options):
    domain = make()
    mesh = fm.refine(domain, **options)
    check.validate_refinement(domain, mesh, min_angle=options["min_angle"], size=options.get("size"))
    assert mesh.refinement.off_curve == 0


def test_new_points_on_the_rim_of_a_disk_lie_on_its_circle_and_the_area_grows_towards_pi():
    coarse = fm.refine(fm.disk(n=8), min_angle=25)
    fine = fm.refine(coarse, min_angle=25, size=0.1)  # a mesh remembers its curves
    for mesh in (coarse, fine):
        rim = mesh.points[np.unique(mesh.segments)]
        assert np.abs(np.hypot(*rim.T) - 1).max() < 1e-9
    assert 0 < np.pi - fine.areas().sum() < 0.01 < np.pi - coarse.areas().sum()


def test_a_curve_whose_way_is_not_free_is_left_and_reported():
    angles = np.radians([0, 50, 100, 150, 200, 250, 300])
    ring = np.round(np.column_stack([np.cos(angles), np.sin(angles)]) * 2**30) / 2**30
    bulge = 1 - np.cos(np.radians(25))
    guard = ring[:2].mean(axis=0) * (1 + 0.6 * bulge)  # a given point between chord and arc
    domain = fm.Domain(
        np.concatenate([ring, [guard, guard * 1.5, guard * 1.5 + [0, 0.1]]]),
        [(i, (i + 1) % 7) for i in range(7)] + [(7, 8), (8, 9), (9, 7)],
        curves={0: fm.Circle((0, 0), 1)},
    )
    mesh = fm.refine(domain, min_angle=20, size=0.3, max_points=3_000)
    check.check_realisation(mesh)
    assert mesh.refinement.off_curve > 0
    assert "left on a chord" in repr(mesh.refinement)


@pytest.mark.parametrize("make", [fm.plate_with_hole, fm.airfoil, fm.gear], ids=lambda make: make.__name__)
def test_moving_vertices_saves_triangles(make):
    moved, added = (len(fm.refine(make(), min_angle=32, steiner=steiner).triangles) for steiner in ("relocation", "offcenter"))
    assert moved < 0.9 * added


def test_what_changes_beside_a_mask_keeps_the_angles_too():
    coarse = fm.refine(fm.l_shape(), min_angle=30, max_area=0.05)
    near = np.hypot(*coarse.points[coarse.triangles].mean(axis=1).T) < 0.5
    mesh = fm.refine(coarse, min_angle=30, max_area=5e-4, where=near)
    assert mesh.min_angle >= 30 - 1e-9
    assert len(mesh.triangles) < len(fm.refine(coarse, min_angle=30, max_area=5e-4).triangles) / 2


@pytest.mark.parametrize("events", [1, 2, 7])
def test_refinement_dropped_after_any_settled_event_goes_on_where_it_stopped(events, monkeypatch):
    domain = fm.plate_with_hole()
    monkeypatch.setattr(kernel, "SMALL", -1)
    whole = fm.refine(domain, min_angle=33)
    monkeypatch.setattr(kernel, "EVENTS_A_CALL", events)
    assert bits(fm.refine(domain, min_angle=33)) == bits(whole)


# --- what a review broke ---


def test_a_run_stopped_by_the_budget_lists_the_triangles_that_had_no_size_yet():
    mesh = fm.refine(fm.square(), size=lambda x, y: 0 * x + 0.05, max_points=120)
    sides = mesh.points[mesh.triangles] - np.roll(mesh.points[mesh.triangles], 1, axis=1)
    assert len(mesh.refinement.left) >= (np.hypot(*sides.T).max(axis=0) > 0.05).sum() > 100


def test_a_size_that_is_tiny_in_one_spot_takes_no_memory_for_it():
    mesh = fm.refine(fm.l_shape(), size=lambda x, y: 1e-5 + 0.3 * np.hypot(x, y))
    assert mesh.refinement.complete
    assert len(mesh.triangles) < 20_000


def test_regions_without_names_are_asked_to_keep_the_bounds_too():
    square = fm.Mesh([(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 1, 2), (0, 2, 3)], regions=[1, 2])
    mesh = fm.refine(square, max_area=0.1)
    assert mesh.areas().max() <= 0.1
    assert set(mesh.regions.tolist()) == {1, 2}


@pytest.mark.parametrize("regions", [[-1, 0], [1], [0.5, 1], [10**6, 0]])
def test_regions_that_are_no_numbers_of_regions_are_refused(regions):
    with pytest.raises(fm.MeshError, match="regions"):
        fm.Mesh([(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 1, 2), (0, 2, 3)], regions=regions)


def test_seeds_that_flood_everything_are_refused():
    with pytest.raises(fm.MeshError, match="not closed"):
        fm.refine(fm.Domain([(0, 0), (4, 0), (4, 4), (0, 4)], [(0, 1), (1, 2), (2, 3)], holes=[(3, 1)]))


@pytest.mark.parametrize("make", [fm.airfoil, fm.turbine_blade, fm.disk], ids=lambda make: make.__name__)
def test_meshes_of_curved_shapes_can_be_pickled(make):
    mesh = fm.refine(make(), min_angle=25)
    assert bits(pickle.loads(pickle.dumps(mesh))) == bits(mesh)


def test_captions_say_where_a_segment_is_split():
    far = fm.Domain.from_loops(np.add([(0, 0), (0.134, 0), (0.134, 0.03), (0, 0.03)], (512700, 5.4e6)))
    for domain, words in ((far, "in the middle"), (fm.disk(n=8), "on its curve"), (fm.star(), "a power of two")):
        splits = [step.caption for step in fm.ruppert(domain, min_angle=30, size=0.15) if step.kind == "split"]
        assert any(words in caption for caption in splits)
        assert domain is not far or all(words in caption for caption in splits)


def test_coordinates_at_the_edge_of_the_exact_range_are_refined_or_left():
    for scale in (1e-42, 1e-40, 1e58):
        corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * scale
        mesh = fm.refine(fm.Domain.from_loops(corners), min_angle=30, max_area=0.01 * scale * scale, max_points=400)
        assert len(mesh.triangles) > 100


def test_a_segment_keeps_all_its_names_however_often_it_is_listed():
    square = fm.Mesh(
        [(0, 0), (1, 0), (1, 1), (0, 1)],
        [(0, 1, 2), (0, 2, 3)],
        segments=[(0, 1), (1, 2), (1, 0)],
        boundaries={"all": [0, 1], "right": [1], "again": [2]},
    )
    mesh = fm.refine(square, max_area=0.1)
    for name, places in (("all", {(0.5, 0), (1, 0.5)}), ("right", {(1, 0.5)}), ("again", {(0.5, 0)})):
        used = {tuple(p) for p in mesh.points[mesh.segments[mesh.boundaries[name]]].reshape(-1, 2).tolist()}
        assert places <= used


def test_a_corner_is_sharp_where_its_curves_meet_at_a_small_angle_though_their_chords_do_not():
    half = math.radians(61) / 2
    tip, low, high = (0, 0), (math.cos(half), -math.sin(half)), (math.cos(half), math.sin(half))

    def inward(p, q):
        middle = [(p[i] + q[i]) / 2 + 0.25 * turned for i, turned in enumerate((p[1] - q[1], q[0] - p[0]))]
        return lambda t: tuple((1 - t) ** 2 * a + 2 * t * (1 - t) * b + t * t * c for a, b, c in zip(p, middle, q, strict=True))

    curves = {0: inward(tip, low), 4: inward(high, tip)}
    domain = fm.Domain([tip, low, (2, -1), (2, 1), high], [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0)], curves=curves)
    mesh = fm.refine(domain, min_angle=20, size=0.05)
    assert mesh.refinement.complete
    assert set(mesh.refinement.why) == {"small input angle"}
    assert np.hypot(*np.diff(mesh.points[mesh.segments], axis=1)[:, 0].T).min() > 1e-3


def test_a_vertex_on_the_chord_of_a_curve_is_refused():
    square, sides = [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0)], [(0, 1), (1, 2), (2, 3), (3, 0)]
    with pytest.raises(fm.MeshError, match=r"point 4 at \(0.5, 0\) lies on the chord of segment 0"):
        fm.Domain(square, sides, curves={0: lambda t: (t, 0.4 * t * (1 - t))})
