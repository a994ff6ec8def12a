"""The validators themselves: they accept Triangle's meshes, and notice whatever is done to one."""

from types import SimpleNamespace

import exact
import exact_constrained as check
import numpy as np
import pytest
from domains import DOMAINS, add, box, loops, rows, wedge
from faces import Faces

# Recipes that are to be split first, and those on which Triangle itself ends the process.
NOT_FOR_TRIANGLE = {name for name, make in DOMAINS.items() if make().crossings == "split"}


def mesh_of(points, triangles, segments, **more):
    triangles = np.array(triangles).reshape(-1, 3)
    owner = {edge: t for t, abc in enumerate(triangles.tolist()) for edge in check.edges_of(abc)}
    across = [[owner.get(edge[::-1], -1) for edge in (e[1], e[2], e[0])] for e in map(check.edges_of, triangles.tolist())]
    arrays = {
        "points": points,
        "triangles": triangles,
        "segments": np.array(segments),
        "neighbors": np.array(across).reshape(-1, 3),
    }
    return SimpleNamespace(**arrays, segment_of=np.full(len(segments), -1), **more)


def triangles_mesh(domain, flags="pQ"):
    """Triangle's mesh, as an object such as ours."""
    found = check.triangulated(domain, flags)
    segments = sorted({tuple(sorted(s)) for s in found["segments"].tolist()})
    left = exact.apexes(found["triangles"].tolist())
    segments = [(a, b) for a, b in segments if (a, b) in left or (b, a) in left]
    added = len(found["vertices"]) - len(set(map(tuple, domain.points.tolist())))
    refinement = SimpleNamespace(complete=True, added=added, left=np.empty(0, int), why=())
    return mesh_of(found["vertices"], found["triangles"], segments, refinement=refinement)


def check_everything(domain, mesh):
    check.check_realisation(mesh)
    check.check_constrained_delaunay(mesh.points, mesh.triangles.tolist(), mesh.segments.tolist())
    check.check_area(domain, mesh)
    check.check_points(domain, mesh)
    check.check_boundary_chains(domain, mesh)


@pytest.mark.parametrize("name", [name for name in DOMAINS if name not in NOT_FOR_TRIANGLE])
def test_triangles_own_meshes_are_accepted(name):
    recipe = DOMAINS[name]()
    check_everything(recipe, triangles_mesh(recipe))


@pytest.mark.parametrize("name", ["nested_squares", "letter_b", "letter_e", "leg_486_high_and_1_wide", "seventeen_gon"])
@pytest.mark.parametrize("flags", ["pq10Q", "pq20Q", "pq28Q", "pq30a0.5Q"])
def test_triangles_own_refinements_are_accepted(name, flags):
    recipe, angle = DOMAINS[name](), float(flags[2:4])
    area = 0.5 if "a" in flags else None
    check.validate_refinement(recipe, triangles_mesh(recipe, flags), min_angle=angle, max_area=area, max_points=10**4)


@pytest.mark.parametrize("name", ["wedge_of_12_degrees", "wedge_of_20_degrees", "fork_of_10_degrees"])
def test_small_input_angles_are_an_excuse_for_the_triangles_at_them(name):
    recipe = DOMAINS[name]()
    mesh = triangles_mesh(recipe, "pq25Q")
    mesh.refinement.left = np.flatnonzero(check.angles_of(mesh).min(axis=1) < 25)
    mesh.refinement.why = ("small input angle",) * len(mesh.refinement.left)
    assert mesh.refinement.why
    check.validate_refinement(recipe, mesh, min_angle=25)


def test_other_triangles_have_no_such_excuse():
    mesh = triangles_mesh(wedge(60), "pQ")
    mesh = mesh_of(np.array([(0, 0), (4, 0), (4, 0.5), (0, 4)]), [(0, 1, 2), (0, 2, 3)], [(0, 1), (1, 2), (2, 3), (3, 0)])
    mesh.refinement = SimpleNamespace(complete=True, added=0, left=np.array([0]), why=("small input angle",))
    recipe = loops(mesh.points)
    with pytest.raises(AssertionError, match="triangle 0 is not excused"):
        check.validate_refinement(recipe, mesh, min_angle=20)


def nested():
    return DOMAINS["nested_squares"]()


def refined():
    recipe = nested()
    return recipe, triangles_mesh(recipe, "pq28a0.8Q")


def turned(mesh):
    """One edge flipped that is no segment, between four points in convex position that share no circle."""
    left, whole = exact.apexes(mesh.triangles.tolist()), exact.integers(mesh.points.tolist())
    fixed = {frozenset(s) for s in mesh.segments.tolist()}
    for (a, b), c in left.items():
        if (b, a) in left and frozenset((a, b)) not in fixed:
            d = left[b, a]
            convex = exact.turn(whole[c], whole[d], whole[b]) > 0 and exact.turn(whole[d], whole[c], whole[a]) > 0
            if convex and exact.inside(*(whole[v] for v in (a, b, c, d))) < 0:
                rest = [t for t in mesh.triangles.tolist() if set(t) not in ({a, b, c}, {a, b, d})]
                return mesh_of(mesh.points, [*rest, (c, d, b), (d, c, a)], mesh.segments, refinement=mesh.refinement)
    raise AssertionError("no edge can be flipped")


def moved(mesh, v, dx, dy):
    points = mesh.points.copy()
    points[v] += dx, dy
    return mesh_of(points, mesh.triangles, mesh.segments, refinement=mesh.refinement)


def without_triangle(mesh):
    return mesh_of(mesh.points, mesh.triangles[1:], mesh.segments, refinement=mesh.refinement)


def changed(mesh, **more):
    return SimpleNamespace(**(vars(mesh) | more))


def other_refinement(mesh, **more):
    return changed(mesh, refinement=SimpleNamespace(**(vars(mesh.refinement) | more)))


def middle_of_a_side(recipe, mesh):
    """A vertex made on a segment."""
    return next(v for v in mesh.segments.ravel().tolist() if v >= len(recipe.points))


def free_vertex(recipe, mesh):
    return next(v for v in range(len(recipe.points), len(mesh.points)) if v not in mesh.segments)


SABOTAGE = {  # what is done to a refined mesh, what the validator says
    "an edge flipped": (lambda r, m: turned(m), "the circle of"),
    "a triangle dropped": (lambda r, m: without_triangle(m), "is no segment|is no edge"),
    "a vertex moved": (lambda r, m: moved(m, free_vertex(r, m), 0.3, 0.2), "counter-clockwise|circle|angle"),
    "a vertex on a side moved": (lambda r, m: moved(m, middle_of_a_side(r, m), 2.0**-35, 2.0**-35), "no chain|circle"),
    "a user's point moved": (lambda r, m: moved(m, 0, -(2.0**-50), 0), "an end of row"),
    "a neighbour forgotten": (lambda r, m: changed(m, neighbors=np.where(m.neighbors == 3, -1, m.neighbors)), "neighbors"),
    "a segment forgotten": (lambda r, m: changed(m, segments=m.segments[1:]), "is no segment|circle"),
    "a segment too many": (lambda r, m: changed(m, segments=np.vstack([m.segments, free_edge(m)])), "no segment of the domain"),
    "a segment listed twice": (lambda r, m: changed(m, segments=np.vstack([m.segments, m.segments[:1, ::-1]])), "twice"),
    "a point too many": (lambda r, m: changed(m, points=np.vstack([m.points, [(1, 1)]])), "points are not"),
    "a triangle said to be left": (lambda r, m: other_refinement(m, left=np.array([5]), why=("small input angle",)), "excused"),
    "incomplete without a reason": (lambda r, m: other_refinement(m, complete=False), "complete is False"),
    "a reason of another kind": (lambda r, m: other_refinement(m, left=np.array([5]), why=("budget",)), "complete is True"),
}


def free_edge(mesh):
    fixed = {frozenset(s) for s in mesh.segments.tolist()}
    return [next(edge for abc in mesh.triangles.tolist() for edge in check.edges_of(abc) if frozenset(edge) not in fixed)]


@pytest.mark.parametrize("what", SABOTAGE)
def test_whatever_is_done_to_a_refined_mesh_is_noticed(what):
    recipe, mesh = refined()
    check.validate_refinement(recipe, mesh, min_angle=28, max_area=0.8)
    spoil, message = SABOTAGE[what]
    with pytest.raises(AssertionError, match=message):
        check.validate_refinement(recipe, spoil(recipe, mesh), min_angle=28, max_area=0.8)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"min_angle": 33}, "has an angle of"),
        ({"min_angle": 28, "max_area": 0.5}, "has area"),
        ({"min_angle": 28, "size": 1}, "longer edge"),
        ({"min_angle": 28, "size": lambda x, y: 0.5 + x}, "longer edge"),
        ({"min_angle": 28, "max_points": 3}, "points added, more than 3"),
    ],
)
def test_a_bound_that_is_not_kept_is_noticed(asked, message):
    recipe, mesh = refined()
    with pytest.raises(AssertionError, match=message):
        check.validate_refinement(recipe, mesh, **asked)


def test_an_encroached_segment_is_noticed():
    recipe = loops([(0, 0), (4, 0), (2, 1.5)])
    mesh = triangles_mesh(recipe)
    check.check_no_segment_is_encroached(mesh, 20, "lens")
    for angle, kind in ((20, "circle"), (40, "lens")):
        with pytest.raises(AssertionError, match=r"encroaches|sees segment"):
            check.check_no_segment_is_encroached(mesh, angle, kind)


@pytest.mark.parametrize("name", [name for name in DOMAINS if name not in NOT_FOR_TRIANGLE])
def test_a_cdt_with_a_triangle_less_is_noticed(name):
    recipe = DOMAINS[name]()
    whole = triangles_mesh(recipe)
    for t in range(0, len(whole.triangles), 1 + len(whole.triangles) // 5):
        mesh = mesh_of(whole.points, np.delete(whole.triangles, t, axis=0), whole.segments)
        with pytest.raises(AssertionError):
            check.check_area(recipe, mesh)


def test_brute_force_sees_what_the_local_test_sees():
    recipe = DOMAINS["open_chains_and_loose_points"]()
    mesh = triangles_mesh(recipe)
    whole, spoiled = exact.integers(mesh.points.tolist()), turned(changed(mesh, refinement=None))
    check.check_every_visible_vertex(whole, mesh.triangles.tolist(), mesh.segments.tolist())
    with pytest.raises(AssertionError, match="can be seen from it"):
        check.check_every_visible_vertex(whole, spoiled.triangles.tolist(), spoiled.segments.tolist())


# --- the faces ---


def test_areas_are_those_of_paper_and_pencil():
    expected = {"nested_squares": 160, "letter_a": 40, "letter_e": 16, "squares_nested_corner_to_side": 48, "comb": 72}
    expected |= {"hole_sharing_part_of_an_outer_side": 55, "two_loops_sharing_part_of_a_side": 31, "holes_by_seeds": 72}
    for name, area in expected.items():
        assert Faces(DOMAINS[name]()).area == area


def test_a_theta_has_no_parity():
    with pytest.raises(AssertionError, match=r"do not close up|depends on the path"):
        Faces(rows(box(0, 0, 1, 1), [(0, 1), (1, 2), (2, 3), (3, 0), (0, 2)]))


def test_open_chains_enclose_nothing():
    assert Faces(rows([(0, 0), (2, 0), (1, 2), (1, 0)], [(0, 1), (1, 2), (2, 3)])).area == 0
    assert Faces(add(loops(box(0, 0, 4, 4)), [(1, 1), (3, 1), (2, 3), (2, 1)], [(0, 1), (1, 2), (2, 3)])).area == 16
