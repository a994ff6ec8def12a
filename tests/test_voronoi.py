"""A Voronoi diagram is the dual of its mesh: exact where it decides, near where it is written in doubles."""

import pickle
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
import scipy.spatial
from corpus import CORPUS, for_all, pythagorean_circle
from exact import apexes, inside, integers, plane, turn
from hypothesis import strategies as st

import fem_mesh as fm
from fem_mesh.kernel import SMALL
from fem_mesh.mesh.voronoi import voronoi_of

NAMES = sorted(name for name in CORPUS if name != "both_scales_at_once")  # whose circles are too wide to compare
LATTICE = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), min_size=1, max_size=25)


def center(a, b, c):
    """The centre of the circle, without rounding."""
    p, q, r, _ = plane(a, b, c)
    return Fraction(-p, 2 * r), Fraction(-q, 2 * r)


def exact_vertices(diagram):
    """The exact place of each vertex, in the units of ``integers``: the centre of all its triangles' circles."""
    whole, places = integers(diagram.mesh.points), [set() for _ in diagram.vertices]
    for v, triangle in zip(diagram.vertex_of.tolist(), diagram.mesh.triangles.tolist(), strict=True):
        places[v].add(center(*(whole[i] for i in triangle)))
    assert all(len(found) == 1 for found in places), "the triangles of a vertex do not lie on one circle"
    vertices = [found.pop() for found in places]
    assert len(set(vertices)) == len(vertices), "two vertices are in one place"
    return vertices


def square(p, q):
    return (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2


def check_diagram(diagram):
    """Combinatorially and exactly: vertices, edges, and for each site a convex cell around it."""
    mesh, vertices = diagram.mesh, exact_vertices(diagram)
    whole, edges = integers(mesh.points), diagram.edges.tolist()
    sites = diagram.sites.tolist()
    distinct = len(set(whole))
    assert len(vertices) + 1 - len(edges) + distinct == 2  # Euler's formula, with a vertex at infinity
    beside = {}  # the edges as seen from the site on their left: (site, from, to)
    for (v, w), (left, right), direction in zip(edges, sites, diagram.directions, strict=True):
        assert v >= 0
        assert w != v
        for end in (v, w) if w >= 0 else (v,):
            radius = square(vertices[end], whole[left])
            assert radius == square(vertices[end], whole[right])
            assert radius == min(square(vertices[end], p) for p in whole)
        across = mesh.points[right] - mesh.points[left]
        if w < 0:
            assert np.hypot(*direction) == pytest.approx(1)
            assert direction @ np.array([-across[1], across[0]]) == pytest.approx(np.hypot(*across))
            assert max(turn(whole[left], whole[right], p) for p in whole) == 0  # it leaves beyond the hull's edge
        else:
            assert np.isnan(direction).all()
        beside[left, v, w] = right
        beside[right, w, v] = left
    assert len(beside) == 2 * len(edges)
    for i, cell in enumerate(diagram.cells()):
        check_cell(i, cell.tolist(), vertices, whole, beside)
    assert {side[0] for side in beside} == set(mesh.triangles.ravel().tolist())


def check_cell(i, cell, vertices, whole, beside):
    """The cell of site i is convex, has the site inside it, and edges on all its sides."""
    i = next(j for j in range(len(whole)) if whole[j] == whole[i] and any(side[0] == j for side in beside))
    sides = list(zip(cell, cell[1:] + cell[:1], strict=True))
    assert {(i, v, w) for v, w in sides} == {side for side in beside if side[0] == i}
    assert cell.count(-1) <= 1
    assert len(set(cell)) == len(cell)
    for v, w in sides:
        if min(v, w) >= 0:
            assert turn(vertices[v], vertices[w], whole[i]) > 0
            assert all(turn(vertices[v], vertices[w], vertices[u]) > 0 for u in cell if u not in (v, w, -1))


@for_all(120, points=LATTICE)
def test_on_a_lattice_cells_are_convex_around_their_sites_and_ties_share_vertices(points):
    mesh = fm.delaunay(points)
    diagram = mesh.voronoi()
    if len(mesh.triangles):
        check_diagram(diagram)
    else:
        check_line(diagram)


@pytest.mark.parametrize("name", NAMES)
def test_cells_are_convex_around_their_sites(name):
    mesh = fm.delaunay(CORPUS[name](40))
    diagram = mesh.voronoi()
    check_diagram(diagram)
    scale = Fraction(integers(mesh.points)[0][0]) / Fraction(mesh.points[0, 0]) if mesh.points[0, 0] else None
    for place, exact in zip(diagram.vertices.tolist(), exact_vertices(diagram) if scale else (), strict=False):
        true = np.array([float(value / scale) for value in exact])
        radius = np.hypot(*(mesh.points - true).T).min()
        np.testing.assert_allclose(place, true, atol=1e-9 * radius, rtol=1e-12)


def test_with_both_scales_at_once_it_still_decides_exactly():
    mesh = fm.delaunay(CORPUS["both_scales_at_once"](20))
    vertices = exact_vertices(mesh.voronoi())
    assert len(vertices) == len(mesh.triangles)


@pytest.mark.parametrize("seed", range(5))
def test_it_is_the_diagram_that_scipy_makes(seed):
    points = fm.random_points(200, seed=seed)
    ours, theirs = fm.delaunay(points).voronoi(), scipy.spatial.Voronoi(points)
    assert {frozenset(pair) for pair in ours.sites.tolist()} == {frozenset(pair) for pair in theirs.ridge_points.tolist()}
    assert len(ours.vertices) == len(theirs.vertices)
    distance, to = scipy.spatial.cKDTree(theirs.vertices).query(ours.vertices)
    assert (distance <= 1e-8 * (1 + np.abs(ours.vertices).max(axis=1))).all()
    for i, cell in enumerate(ours.cells()):
        region = theirs.regions[theirs.point_region[i]]
        assert {-1 if v < 0 else int(to[v]) for v in cell.tolist()} == set(region)


@pytest.mark.parametrize("name", NAMES)
def test_every_end_of_an_edge_is_as_far_from_its_two_sites_as_from_no_other(name):
    points = CORPUS[name](40)
    diagram = fm.delaunay(points).voronoi()
    reach = 2.0 * float(np.ptp(points, axis=0).max(initial=0.0))
    near = 1e-6 * reach + 4 * np.spacing(np.abs(points).max(initial=0.0))
    for (a, b), ends in zip(diagram.sites.tolist(), diagram.ends(reach).tolist(), strict=True):
        for end in ends:
            away = np.hypot(*(diagram.mesh.points - end).T)
            assert away[[a, b]] == pytest.approx(away.min(), rel=1e-6, abs=near)


def test_edges_without_an_end_are_drawn_as_far_as_asked():
    line = fm.delaunay([(0, 0), (2, 0)]).voronoi()
    assert line.ends(5.0).tolist() == [[[1, 5], [1, -5]]]
    corner = fm.delaunay([(0, 0), (2, 0), (0, 2)]).voronoi()
    assert sorted(end for _, end in corner.ends(3.0).tolist())[:2] == [[-2.0, 1.0], [1.0, -2.0]]


def test_the_diagram_of_a_grid_is_a_grid():
    diagram = fm.delaunay(fm.grid_points(5, 4)).voronoi()
    assert sorted(diagram.vertices.tolist()) == sorted([x + 0.5, y + 0.5] for x in range(4) for y in range(3))
    assert len(diagram.edges) == 5 * 3 + 4 * 4
    inner = diagram.cell(6)
    assert diagram.vertices[inner].min(axis=0).tolist() == [0.5, 0.5]
    assert diagram.vertices[inner].max(axis=0).tolist() == [1.5, 1.5]
    assert sorted(map(tuple, diagram.directions[diagram.edges[:, 1] < 0].tolist())) == sorted(
        [(0.0, -1.0), (0.0, 1.0)] * 4 + [(-1.0, 0.0), (1.0, 0.0)] * 3
    )
    check_diagram(diagram)


def test_the_diagram_of_a_ring_is_a_star():
    diagram = fm.delaunay(pythagorean_circle(36)).voronoi()
    assert diagram.vertices.tolist() == [[0, 0]]
    assert all(cell.tolist() == [0, -1] for cell in diagram.cells())
    check_diagram(diagram)


def test_the_cell_of_a_rings_centre_is_bounded():
    diagram = fm.delaunay([*pythagorean_circle(12), (0, 0)]).voronoi()
    assert -1 not in diagram.cell(12)
    check_diagram(diagram)


def check_line(diagram):
    """Parallel lines between neighbours among points on one line."""
    points, whole = diagram.mesh.points, integers(diagram.mesh.points)
    assert len(diagram.vertices) == 0
    assert diagram.note == diagram.mesh.note
    assert (diagram.edges == -1).all()
    assert sorted({p for pair in diagram.sites.tolist() for p in (whole[pair[0]], whole[pair[1]])}) == (
        sorted(set(whole)) if len(set(whole)) > 1 else []
    )
    assert {frozenset((whole[a], whole[b])) for a, b in diagram.sites.tolist()} == {
        frozenset(pair) for pair in pairwise(sorted(set(whole)))
    }
    for (left, right), direction in zip(diagram.sites.tolist(), diagram.directions, strict=True):
        across = points[right] - points[left]
        assert direction @ np.array([-across[1], across[0]]) == pytest.approx(np.hypot(*across))
    assert [cell.tolist() for cell in diagram.cells()] == [[-1]] * len(points)


@pytest.mark.parametrize("points", [[], [(1, 2)], [(0, 0), (0, 0)], [(0, 0), (4, 2)], [(2, 1), (0, 0), (6, 3), (0, 0), (4, 2)]])
def test_points_on_one_line_have_parallel_lines_between_them(points):
    check_line(fm.delaunay(points).voronoi())


def test_a_mesh_of_nothing_is_delaunay():
    fm.validate([], [])
    assert fm.delaunay([]).is_delaunay()


def test_equal_points_have_one_cell():
    points = [(0, 0), (4, 0), (0, 0), (0, 4), (4, 4), (2, 1), (2, 1)]
    mesh = fm.delaunay(points)
    for given in (mesh, fm.Mesh(points, mesh.triangles), fm.Mesh(points[::-1], 6 - mesh.triangles)):
        diagram = given.voronoi()
        check_diagram(diagram)
        cells = [cell.tolist() for cell in diagram.cells()]
        assert len(set(map(tuple, cells))) == 5


def test_where_a_circle_is_not_empty_there_is_no_diagram():
    with pytest.raises(fm.MeshError, match=r"the circle of triangle 0 = \(0, 1, 2\) holds point 3 at \(1, 2\)"):
        fm.Mesh([(0, 0), (4, 0), (5, 3), (1, 2)], [(0, 1, 2), (0, 2, 3)]).voronoi()
    with pytest.raises(fm.MeshError, match="the convex hull is not covered"):
        fm.constrained_delaunay(fm.l_shape()).voronoi()
    with pytest.raises(fm.MeshError, match="there is no triangle, but the points do not lie on a line"):
        fm.Mesh([(0, 0), (1, 0), (0, 1)], []).voronoi()


def test_a_diagram_does_not_change_and_can_be_kept():
    diagram = fm.delaunay(fm.random_points(20, seed=1)).voronoi()
    with pytest.raises(ValueError, match="read-only"):
        diagram.vertices[0] = 0
    with pytest.raises(AttributeError):
        diagram.edges = ()
    again = pickle.loads(pickle.dumps(diagram))
    np.testing.assert_array_equal(again.vertices, diagram.vertices)
    assert repr(again) == repr(diagram)
    assert repr(fm.delaunay([(0, 0), (1, 0)]).voronoi()) == (
        "Voronoi: 0 vertices, 1 edge, no triangles: 2 points, and a triangle needs 3"
    )


# ---- ties --------------------------------------------------------------------------------------------


def exact_ties(mesh):
    whole, left = integers(mesh.points), apexes(mesh.triangles.tolist())
    return {
        frozenset((a, b))
        for (a, b), c in left.items()
        if (b, a) in left and inside(whole[a], whole[b], whole[c], whole[left[b, a]]) == 0
    }


def check_ties(mesh):
    found = mesh.cocircular_edges()
    assert found.dtype == np.int32
    assert len({frozenset(edge) for edge in found.tolist()}) == len(found)
    assert {frozenset(edge) for edge in found.tolist()} == exact_ties(mesh)


@for_all(100, points=LATTICE, shift=st.sampled_from([0.0, 1e6, 2.0**-40]), unit=st.sampled_from([1.0, 1 / 3, 0.1]))
def test_edges_within_a_circle_are_found_exactly(points, shift, unit):
    check_ties(fm.delaunay(shift + unit * np.array(points, float)))


@pytest.mark.parametrize("name", sorted(CORPUS))
def test_in_every_set_the_edges_within_a_circle_are_found_exactly(name):
    check_ties(fm.delaunay(CORPUS[name](200)))


def test_in_a_mesh_that_is_not_delaunay_ties_are_found_too():
    points = np.random.default_rng(3).permutation(fm.grid_points(9))
    check_ties(fm.Mesh(points, fm.any_triangulation(points)))
    check_ties(fm.constrained_delaunay(fm.plate_with_hole()))


def test_an_ulp_beside_the_circle_is_no_tie():
    circle = [(5, 0), (4, 3), (-3, 4), (3, -4)]
    for corner in range(4):
        for step in (-1, 1):
            points = np.array(circle, float)
            points[corner, 0] = np.nextafter(points[corner, 0], step * np.inf)
            assert len(fm.delaunay(points).cocircular_edges()) == 0
    assert len(fm.delaunay(circle).cocircular_edges()) == 1


def test_many_ties_compiled_are_those_of_plain_python():
    side = int(SMALL**0.5) + 3  # the squares of this grid are more than a kernel takes in plain Python
    mesh = fm.delaunay(fm.grid_points(side))
    assert len(mesh.cocircular_edges()) == (side - 1) ** 2
    assert len(voronoi_of(mesh).vertices) == (side - 1) ** 2
