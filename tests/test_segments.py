"""Constrained Delaunay triangulations of every domain that broke others, against exact brute force and Triangle."""

import itertools

import exact
import exact_constrained as check
import numpy as np
import pytest
from corpus import EXHAUSTIVE, for_all
from domains import DOMAINS, Recipe, add, box, cells, kept_segments, loops, over_seeds, random_segments, rows, star_polygon
from faces import Faces
from hypothesis import strategies as st

import fem_mesh as fm
from fem_mesh import kernel
from fem_mesh.domain.domain import Region

SPLIT = {name for name, make in DOMAINS.items() if make().crossings == "split"}
STRAIGHT = [name for name in DOMAINS if name not in SPLIT]
MIDDLING = [name for name in STRAIGHT if not name.startswith(("tiny", "huge"))]
SHAPES = {
    name: (lambda name=name, options=options: shape(name, *options))
    for name, *options in [
        ("square",), ("l_shape",), ("disk",), ("annulus",), ("plate_with_hole",), ("airfoil",), ("airfoil", "0012"),
        ("turbine_blade",), ("gear",), ("letter", "A"), ("letter", "B"), ("cracked_square",), ("star",),
    ]
    for name in [name]
}  # fmt: skip


def shape(name, *options):
    from fem_mesh.domain import shapes

    return getattr(shapes, name)(*options)


def play(steps):
    return fm.record(steps, limit=None).mesh


def check_cdt(oracle, mesh, domain):
    """All that makes ``mesh`` the constrained Delaunay triangulation of ``oracle``: a Recipe, or the domain itself."""
    check.check_realisation(mesh)
    check.check_constrained_delaunay(mesh.points, mesh.triangles.tolist(), mesh.segments.tolist())
    check.check_area(oracle, mesh)
    check.check_points(oracle, mesh)
    check.check_boundary_chains(oracle, mesh)
    check_rows(domain, mesh)
    assert mesh.points.tobytes() == domain.points.tobytes()
    assert np.array_equal(mesh.merged_into, domain.merged_into)
    assert mesh.refinement is None


def check_rows(domain, mesh):
    """Each piece lies on the row that it names, exactly."""
    assert mesh.segments.shape == (len(mesh.segment_of), 2)
    whole = exact.integers(mesh.points.tolist())
    for (a, b), row in zip(mesh.segments.tolist(), mesh.segment_of.tolist(), strict=True):
        i, j = domain.segments[row].tolist()
        assert exact.turn(whole[i], whole[j], whole[a]) == exact.turn(whole[i], whole[j], whole[b]) == 0
        assert min(whole[i], whole[j]) <= min(whole[a], whole[b]) <= max(whole[a], whole[b]) <= max(whole[i], whole[j])


def same_mesh(one, other):
    """To the last index."""
    for name in ("points", "triangles", "neighbors", "segments", "segment_of", "merged_into", "regions"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
    assert one.note == other.note


# --- the corpus ---


@pytest.mark.parametrize("name", DOMAINS)
def test_a_cdt_covers_exactly_what_its_segments_enclose(name):
    recipe = DOMAINS[name]()
    domain = recipe.domain()
    check_cdt(domain if name in SPLIT else recipe, fm.constrained_delaunay(domain), domain)


@pytest.mark.parametrize("name", STRAIGHT)
def test_there_are_as_many_triangles_as_in_triangle(name):
    recipe = DOMAINS[name]()
    assert len(fm.constrained_delaunay(recipe.domain()).triangles) == check.triangle_count(recipe)


@pytest.mark.parametrize("name", STRAIGHT)
def test_a_domain_encloses_what_its_recipe_says(name):
    recipe = DOMAINS[name]()
    assert Faces(recipe.domain()).area == Faces(recipe).area


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_has_the_area_of_its_outlines_and_as_many_triangles_as_in_triangle(name):
    domain = SHAPES[name]()
    mesh = fm.constrained_delaunay(domain)
    check_cdt(domain, mesh, domain)
    assert len(mesh.triangles) == check.triangle_count(domain)


@pytest.mark.parametrize("name", DOMAINS)
def test_watched_in_plain_python_and_compiled_the_mesh_is_the_same_to_the_last_index(name, monkeypatch):
    domain = DOMAINS[name]().domain()
    watched = play(fm.insert_segments(domain))
    monkeypatch.setattr(kernel, "SMALL", -1)
    same_mesh(watched, fm.constrained_delaunay(domain))


@pytest.mark.parametrize("name", MIDDLING)
@pytest.mark.parametrize("power", [-80, -1, 7, 100])
def test_scaling_by_a_power_of_two_changes_no_triangle(name, power):
    recipe = DOMAINS[name]()
    mesh, scaled = (fm.constrained_delaunay(r.domain()) for r in (recipe, recipe.scaled(power)))
    for array in ("triangles", "neighbors", "segments", "segment_of"):
        np.testing.assert_array_equal(getattr(mesh, array), getattr(scaled, array))


@pytest.mark.parametrize("name", DOMAINS)
def test_the_same_domain_gives_the_same_mesh_bit_for_bit(name):
    same_mesh(*(fm.constrained_delaunay(DOMAINS[name]().domain()) for _ in range(2)))


@pytest.mark.parametrize("name", STRAIGHT)
def test_the_order_and_direction_of_the_rows_change_neither_area_nor_number(name):
    recipe = DOMAINS[name]()
    if recipe.loops:
        other = Recipe(
            recipe.points, recipe.segments, recipe.holes, tuple(loop[::-1] for loop in recipe.loops[::-1]), recipe.loose
        )
    else:
        other = rows(recipe.points, recipe.segments[::-1, ::-1], recipe.holes)
    mesh, turned = (fm.constrained_delaunay(r.domain()) for r in (recipe, other))
    check.check_area(recipe, turned)
    assert len(turned.triangles) == len(mesh.triangles)
    assert len(turned.segments) == len(mesh.segments)


# --- random domains ---


def check_one(recipe):
    domain = recipe.domain()
    mesh = fm.constrained_delaunay(domain)
    check_cdt(recipe, mesh, domain)
    assert len(mesh.triangles) == check.triangle_count(recipe)


@over_seeds(200, 10_000)
def test_star_polygons(seed):
    check_one(star_polygon(seed))


@over_seeds(200, 10_000)
def test_sets_of_segments_that_do_not_cross(seed):
    check_one(random_segments(seed))


@over_seeds(200, 10_000)
def test_outlines_of_lattice_cells_full_of_ties(seed):
    check_one(cells(seed))


@over_seeds(40, 2_000)
def test_random_domains_far_from_the_origin(seed):
    points = star_polygon(seed).points
    check_one(loops(np.round((512700, 5.4e6) + 67 * (1 + points), 3)))


@over_seeds(60, 2_000)
def test_both_drivers_agree_on_random_domains(seed):
    domain = (star_polygon, random_segments, cells)[seed % 3](seed).domain()
    watched, before = play(fm.insert_segments(domain)), kernel.SMALL
    kernel.SMALL = -1
    try:
        same_mesh(watched, fm.constrained_delaunay(domain))
    finally:
        kernel.SMALL = before


ends = st.tuples(*2 * [st.integers(0, 6)])


@for_all(60, drawn=st.lists(st.tuples(ends, ends), max_size=14), loose=st.lists(ends, max_size=5))
def test_segments_drawn_on_a_small_lattice(drawn, loose):
    """Shrinks to the smallest set that goes wrong."""
    check_one(kept_segments(6, drawn, loose))


@for_all(30, drawn=st.lists(st.tuples(ends, ends), max_size=6))
def test_drawn_segments_that_cross_are_split(drawn):
    points = [*box(0, 0, 6, 6), *itertools.chain.from_iterable(drawn)]
    inner = [(4 + 2 * k, 5 + 2 * k) for k in range(len(drawn))]
    domain = fm.Domain(points, [(0, 1), (1, 2), (2, 3), (3, 0), *inner], crossings="split")
    mesh = fm.constrained_delaunay(domain)
    check_cdt(domain, mesh, domain)


# --- steps ---

FEW = [
    "unit_square", "two_squares_with_a_corner_stored_twice", "hole_sharing_part_of_an_outer_side",
    "chain_touching_its_own_edge",
    "kite_whose_longer_diagonal_is_the_constraint", "two_holes_touching_in_a_vertex", "letter_b", "segment_that_hangs_outside",
    "squares_nested_corner_to_side", "lattice_cells_1", "comb",
]  # fmt: skip


@pytest.mark.parametrize("name", FEW)
def test_every_frame_is_a_valid_triangulation(name):
    trace = fm.record(fm.insert_segments(DOMAINS[name]().domain()))
    for k in range(len(trace)):
        points, triangles = trace.frame(k)
        check.check_triangles(points, triangles.tolist())
    assert {frozenset(t) for t in trace.frame(len(trace) - 1)[1].tolist()} == {
        frozenset(t) for t in trace.mesh.triangles.tolist()
    }


@pytest.mark.parametrize("name", FEW)
def test_every_frame_is_the_frame_before_with_the_steps_changes(name):
    trace = fm.record(fm.insert_segments(DOMAINS[name]().domain()))
    mesh = set()
    for k, step in enumerate(trace):
        removed, added = ({frozenset(map(int, t)) for t in triangles} for triangles in (step.removed, step.added))
        assert removed <= mesh
        mesh = (mesh - removed) | added
        assert {frozenset(t) for t in trace.frame(k)[1].tolist()} == mesh
        assert step.caption
        assert "\n" not in step.caption


def test_the_steps_are_told_in_order_points_then_segments_then_carving():
    kinds = [step.kind for step in fm.record(fm.insert_segments(DOMAINS["letter_e"]().domain()))]
    assert kinds[0] == "start"
    assert kinds[-1] == "done"
    assert kinds.index("carve") > max(i for i, kind in enumerate(kinds) if kind == "segment") > kinds.index("cross")


# --- names and regions ---


def test_boundaries_are_named_by_nesting():
    mesh = fm.constrained_delaunay(DOMAINS["letter_b"]().domain())
    assert {name: len(pieces) for name, pieces in mesh.boundaries.items()} == {"outer": 9, "hole 0": 4, "hole 1": 4}
    hole = mesh.points[mesh.segments[mesh.boundaries["hole 1"]].ravel()]
    assert set(map(tuple, hole.tolist())) == set(box(2, 6, 4, 8))


def test_an_island_in_a_hole_is_a_second_outline():
    mesh = fm.constrained_delaunay(DOMAINS["nested_squares"]().domain())
    assert list(mesh.boundaries) == ["outer", "hole 0", "outer 1", "hole 1"]


def test_regions_end_at_segments():
    recipe, seeds = DOMAINS["a_segment_from_side_to_side"](), [(0.1, 0.5), (0.9, 0.5)]
    regions = [Region(*seed, name) for seed, name in zip(seeds, ("left", "right"), strict=True)]
    mesh = fm.constrained_delaunay(fm.Domain(recipe.points, recipe.segments, regions=regions))
    check.check_regions(mesh, seeds)
    assert mesh.region_names == ("", "left", "right")
    assert set(mesh.regions.tolist()) == {1, 2}


def test_what_no_seed_reaches_is_in_no_region():
    recipe = DOMAINS["a_segment_from_side_to_side"]()
    mesh = fm.constrained_delaunay(fm.Domain(recipe.points, recipe.segments, regions=[Region(0.9, 0.5, "right")]))
    check.check_regions(mesh, [(0.9, 0.5)])
    assert set(mesh.regions.tolist()) == {0, 1}


# --- what cannot be meshed ---

X = [(0, 0), (4, 4), (0, 4), (4, 0)]


def test_an_open_x_has_no_closed_loop_and_gives_its_hull():
    domain = fm.Domain(X, [(0, 1), (2, 3)], crossings="split")
    mesh = fm.constrained_delaunay(domain)
    assert check.area_of(mesh) == 16
    assert {frozenset(s) for s in mesh.segments.tolist()} == {frozenset((v, 4)) for v in range(4)}


def test_segments_that_cross_are_an_error_that_names_both_and_the_place():
    with pytest.raises(fm.MeshError, match=r"segments? 0.*1.*\(2.*2.*\).*crossings=.split"):
        fm.Domain(X, [(0, 1), (2, 3)])


@pytest.mark.parametrize(
    ("segments", "area"),
    [
        ([(0, 1), (1, 2), (2, 3), (3, 0), (0, 2)], 81),
        ([(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 4), (4, 7), (7, 5)], 81 - 8),
    ],
    ids=["a diagonal", "a divided hole"],
)
def test_a_segment_that_divides_a_loop_bounds_nothing(segments, area):
    domain = fm.Domain([*box(0, 0, 9, 9), (2, 2), (6, 2), (4, 6), (4, 4)], segments)
    mesh = fm.constrained_delaunay(domain)
    assert check.area_of(mesh) == area
    check_cdt(domain, mesh, domain)


def test_with_seeds_parity_does_not_matter():
    recipe = rows([*box(0, 0, 4, 4), (8, 0), (8, 4)], [(0, 1), (1, 2), (2, 3), (3, 0), (1, 4), (4, 5), (5, 2)], holes=[(6, 2)])
    mesh = fm.constrained_delaunay(recipe.domain())
    assert check.area_of(mesh) == Faces(recipe).area == 16


@pytest.mark.parametrize("seed", [(20, 2), (-1, 2), (2, 1e9)])
def test_a_seed_outside_the_domain_is_an_error_that_names_it(seed):
    with pytest.raises(fm.MeshError, match=r"(hole|seed).*0.*\("):
        fm.constrained_delaunay(fm.Domain(box(0, 0, 4, 4), [(0, 1), (1, 2), (2, 3), (3, 0)], [seed]))


def test_a_seed_in_a_notch_is_outside_too():
    recipe = DOMAINS["letter_e"]()
    with pytest.raises(fm.MeshError, match=r"hole|seed"):
        fm.constrained_delaunay(fm.Domain(recipe.points, recipe.segments, [(4, 1.5)]))


@pytest.mark.parametrize(
    ("points", "segments"),
    [
        ([(0, 0), (1, 1), (2, 2)], [(0, 1), (1, 2)]),
        ([(0, 0), (1, 1)], [(0, 1)]),
        ([(0, 0), (1, 1), (2, 2)], [(0, 2), (2, 1), (1, 0)]),
    ],
)
def test_points_on_a_line_give_no_triangles_and_a_word(points, segments):
    mesh = fm.constrained_delaunay(fm.Domain(points, segments))
    assert mesh.triangles.shape == (0, 3)
    assert mesh.note


def test_what_is_no_domain_is_refused():
    for wrong in ([(0, 0), (1, 0), (0, 1)], None, 3):
        with pytest.raises(fm.MeshError, match="Domain"):
            fm.constrained_delaunay(wrong)


# --- large ---


@pytest.mark.parametrize("n", [3_000, pytest.param(50_000, marks=EXHAUSTIVE)])
def test_large_outlines_with_many_points(n):
    outline = star_polygon(5, n // 100)
    loose = np.random.default_rng(1).uniform(-1, 1, (n, 2))
    recipe = add(outline, loose)
    mesh = fm.constrained_delaunay(recipe.domain())
    check.check_realisation(mesh)
    check.check_constrained_delaunay(mesh.points, mesh.triangles.tolist(), mesh.segments.tolist())
    check.check_area(recipe, mesh)
    points, segments = check.distinct(recipe)
    assert len(mesh.triangles) == len(check.shewchuk.triangulate({"vertices": points, "segments": segments}, "pQ")["triangles"])


def test_steps_show_the_edges_that_are_crossed_and_what_is_hidden():
    banks = [(0, 4), (12, 4), (1, 8), (4, 7), (7, 9), (10, 7), (2, 1), (6, 6), (9, 2), (12, 0)]
    trace = fm.record(fm.insert_segments(fm.Domain(banks, [(0, 1)])))
    cross, laid = trace[1], trace[2]
    assert len(cross.edges) == len(cross.doomed) - 1 == 4
    for a, b in cross.edges:
        assert fm.orient(banks[0], banks[1], banks[a]) * fm.orient(banks[0], banks[1], banks[b]) < 0
    inside = {v for v, p in enumerate(banks) for t in laid.added if fm.in_circle(*(banks[c] for c in t), p)}
    assert f"{len(inside)} points in their circles, none that its triangle sees" in laid.caption


def test_a_mesh_of_a_domain_that_touches_itself_is_valid():
    touching = fm.Domain.from_loops([(0, 0), (1, 0), (1, 1), (0, 1)], [(1, 1), (2, 1), (2, 2), (1, 2)])
    assert fm.constrained_delaunay(touching).validate().areas().sum() == 2
