"""The model problem: what its elements hold is found exactly, and its estimator sees what they do not."""

import subprocess
import sys

import numpy as np
import pytest

import fem_mesh as fm
from fem_mesh import poisson

DOMAINS = {"l-shape": fm.l_shape, "plate": fm.plate_with_hole, "crack": fm.cracked_square, "letter": lambda: fm.letter("B")}


def meshes():
    return {name: fm.refine(make(), 25, max_area=0.02) for name, make in DOMAINS.items()}


MESHES = meshes()


@pytest.fixture(params=MESHES)
def mesh(request):
    return MESHES[request.param]


def linear(x, y):
    return 1 + 2 * x - 3 * y


def quadratic(x, y):
    return 1 + x - y + 2 * x * x - 3 * x * y + 5 * y * y  # Laplacian 14


# ---- solving -----------------------------------------------------------------------------------------


def test_linear_elements_find_linear_solutions_exactly(mesh):
    u = poisson.solve(mesh, g=linear)
    np.testing.assert_allclose(u, linear(*mesh.points.T), rtol=0, atol=1e-12)
    assert poisson.energy_error(mesh, u, lambda x, y: (2 + 0 * x, -3 + 0 * x)) < 1e-11


def test_quadratic_elements_find_quadratic_solutions_exactly(mesh):
    u = poisson.solve(mesh, f=-14.0, g=quadratic, degree=2)
    np.testing.assert_allclose(u, quadratic(*poisson.basis(mesh, 2).doflocs), rtol=0, atol=1e-11)
    assert poisson.energy_error(mesh, u, lambda x, y: (1 + 4 * x - 3 * y, -1 - 3 * x + 10 * y), degree=2) < 1e-10
    assert poisson.indicators(mesh, u, f=-14.0, degree=2).max() < 1e-10


def test_rows_of_the_stiffness_matrix_sum_to_0_and_it_is_symmetric(mesh):
    from skfem.models.poisson import laplace

    for degree in (1, 2):
        matrix = laplace.assemble(poisson.basis(mesh, degree))
        assert abs(matrix.sum(axis=1)).max() < 1e-11
        assert abs(matrix - matrix.T).max() < 1e-12


def test_the_solution_has_no_residual_inside():
    from skfem import LinearForm
    from skfem.models.poisson import laplace

    mesh = MESHES["plate"]
    u = poisson.solve(mesh, f=lambda x, y: np.exp(x) * y, g=linear)
    space = poisson.basis(mesh)
    load = LinearForm(lambda v, w: np.exp(w.x[0]) * w.x[1] * v).assemble(space)
    inside = np.setdiff1d(np.arange(space.N), space.get_dofs().all())
    assert len(inside) > 50
    assert abs(laplace.assemble(space) @ u - load)[inside].max() < 1e-13


def test_f_pushes_upwards():
    u = poisson.solve(MESHES["l-shape"], f=1.0)
    assert u.min() == 0
    assert 0.1 < u.max() < 0.2


def test_a_mesh_without_inner_points_has_the_values_of_its_boundary():
    mesh = fm.delaunay([(0, 0), (1, 0), (0, 1)])
    assert poisson.solve(mesh, f=1.0, g=linear).tolist() == [1, 3, -2]
    assert poisson.indicators(mesh, [1.0, 3.0, -2.0], f=1.0) == pytest.approx(1.0)  # h_T |f| = sqrt(2) sqrt(1/2)


def test_duplicates_have_the_value_of_their_point_and_loose_points_none(recwarn):
    points = [(0, 0), (1, 0), (1, 1), (0, 1), (1, 0), (0.5, 0.5)]
    u = poisson.solve(fm.delaunay(points), g=linear)
    assert u[4] == u[1] == 3
    loose = fm.Mesh([*points[:4], (0.3, 0.3)], [(0, 1, 2), (0, 2, 3)])
    u = poisson.solve(loose, g=linear)
    assert np.isnan(u[4])
    np.testing.assert_allclose(u[:4], [1, 3, 0, -2])
    assert poisson.indicators(loose, u).shape == (2,)
    assert not recwarn.list


# ---- estimating ----------------------------------------------------------------------------------------


def test_the_estimator_is_0_for_linear_solutions(mesh):
    assert poisson.indicators(mesh, linear(*mesh.points.T)).max() < 1e-11


def test_indicators_are_those_of_the_formula(mesh):
    """The jumps written out: each triangle's gradient from its corners, each inner edge from two triangles."""
    u = np.random.default_rng(1).random(len(mesh.points))
    triangles, corners = mesh.triangles, mesh.points[mesh.triangles]
    edges = np.roll(corners, -1, axis=1) - corners  # edge i from corner i to corner i + 1
    length = np.hypot(*edges.transpose(2, 0, 1))
    normal = np.stack([edges[..., 1], -edges[..., 0]], axis=2) / length[..., None]
    slope = np.linalg.solve(edges[:, :2], np.diff(u[triangles], axis=1)[..., None])[..., 0]
    square = 9 * length.max(axis=1) ** 2 * mesh.areas()  # f = 3
    for t, across in enumerate(mesh.neighbors):
        for i in range(3):  # neighbour i lies across the edge from corner i + 1
            if across[i] >= 0:
                e = (i + 1) % 3
                jump = (slope[t] - slope[across[i]]) @ normal[t, e]
                square[t] += 0.5 * length[t, e] * jump**2 * length[t, e]
    np.testing.assert_allclose(poisson.indicators(mesh, u, f=3.0), np.sqrt(square), rtol=1e-10)


def test_the_laplacian_of_quadratic_elements_is_seen(mesh):
    u = quadratic(*poisson.basis(mesh, 2).doflocs)
    corners = mesh.points[mesh.triangles]
    longest = np.hypot(*(corners - np.roll(corners, 1, axis=1)).transpose(2, 0, 1)).max(axis=1)
    expected = longest * 15 * np.sqrt(mesh.areas())
    np.testing.assert_allclose(poisson.indicators(mesh, u, f=1.0, degree=2), expected, rtol=1e-8)


@pytest.mark.parametrize(("degree", "low", "high"), [(1, 2.5, 4.5), (2, 5.0, 10.0)])
def test_the_estimate_is_some_times_the_error_on_every_mesh(degree, low, high):
    for area in (0.1, 0.01, 0.003):
        mesh = fm.refine(fm.l_shape(), 30, max_area=area)
        u = poisson.solve(mesh, g=poisson.corner_solution, degree=degree)
        error = poisson.energy_error(mesh, u, poisson.corner_gradient, degree=degree)
        assert low < np.linalg.norm(poisson.indicators(mesh, u, degree=degree)) / error < high


def test_the_energy_error_of_nothing_is_the_energy():
    mesh = MESHES["plate"]
    assert poisson.energy_error(mesh, np.zeros(len(mesh.points)), lambda x, y: (3 + 0 * x, 4 + 0 * x)) == pytest.approx(
        5 * np.sqrt(mesh.areas().sum())
    )


def test_a_large_mesh_is_integrated_in_parts_to_the_same_sum(monkeypatch):
    mesh = MESHES["letter"]
    u = poisson.solve(mesh, f=1.0)
    whole = poisson.energy_error(mesh, u, lambda x, y: (x, y))
    monkeypatch.setattr(poisson, "AT_ONCE", 7)
    assert poisson.energy_error(mesh, u, lambda x, y: (x, y)) == pytest.approx(whole)


# ---- the L-shape ----------------------------------------------------------------------------------------


def test_the_corner_solution_is_0_at_the_inner_corner_of_the_l_shape_and_harmonic():
    mesh = fm.refine(fm.l_shape(), 30, max_area=0.01)
    corner = np.unique(mesh.segments[mesh.boundaries["corner"]])
    u = poisson.corner_solution(*mesh.points.T)
    assert abs(u[corner]).max() < 1e-15
    assert np.delete(u, corner).min() > 0
    x, y = mesh.points[mesh.triangles].mean(axis=1).T
    h = 1e-4
    around = sum(poisson.corner_solution(x + dx, y + dy) for dx, dy in ((h, 0), (-h, 0), (0, h), (0, -h)))
    far = np.hypot(x, y) > 0.1
    assert abs(around - 4 * poisson.corner_solution(x, y))[far].max() / h**2 < 1e-3


def test_the_corner_gradient_is_that_of_the_corner_solution():
    random = np.random.default_rng(2)
    t, r = random.uniform(0.01, 1.49 * np.pi, 200), random.uniform(0.1, 2, 200)
    x, y, h = r * np.cos(t), r * np.sin(t), 1e-6
    gx, gy = poisson.corner_gradient(x, y)
    np.testing.assert_allclose(gx, (poisson.corner_solution(x + h, y) - poisson.corner_solution(x - h, y)) / (2 * h), atol=1e-8)
    np.testing.assert_allclose(gy, (poisson.corner_solution(x, y + h) - poisson.corner_solution(x, y - h)) / (2 * h), atol=1e-8)


@pytest.mark.parametrize("degree", [1, 2])
def test_on_equal_triangles_the_error_falls_as_the_cube_root_of_the_unknowns(degree):
    start = fm.refine(fm.l_shape(), 30, size=0.5).to_skfem()
    found = []
    for halvings in (2, 3):
        mesh = fm.Mesh.from_skfem(start.refined(halvings))
        u = poisson.solve(mesh, g=poisson.corner_solution, degree=degree)
        found.append((len(u), poisson.energy_error(mesh, u, poisson.corner_gradient, degree=degree)))
    (n, error), (more, smaller) = found
    assert np.log(smaller / error) / np.log(more / n) == pytest.approx(-1 / 3, abs=0.01)


# ---- bad input -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"degree": 3}, "degree must be 1 or 2, not 3"),
        ({"f": lambda x, y: np.ones(3)}, r"f\(x, y\) must return one number for each place in x, of shape \(\d+, \d+\), not"),
        ({"g": lambda x, y: 1 / x}, r"g\(0, -?[\d.]+\) is -?inf, which is no finite number"),
        ({"g": float("nan")}, r"g\(.*\) is nan"),
        ({"g": "one"}, "not <U3 of shape"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero")
def test_bad_data_are_refused_with_the_place(options, says):
    with pytest.raises(fm.MeshError, match=says):
        poisson.solve(MESHES["l-shape"], **options)


def test_a_solution_of_another_mesh_is_refused():
    mesh = MESHES["l-shape"]
    with pytest.raises(fm.MeshError, match=r"u must be what solve\(mesh, degree=1\) returns, shape \(\d+,\), not \(3,\)"):
        poisson.indicators(mesh, [1, 2, 3])
    u = poisson.solve(mesh, degree=2)
    with pytest.raises(fm.MeshError, match=r"degree=1"):
        poisson.energy_error(mesh, u, poisson.corner_gradient)


def test_an_empty_mesh_is_refused_with_its_reason():
    with pytest.raises(fm.MeshError, match="there is nothing to solve on: no triangles: all 3 points lie on one line"):
        poisson.solve(fm.delaunay([(0, 0), (1, 1), (2, 2)]))


def test_importing_it_does_not_import_scikit_fem():
    code = "import sys, fem_mesh.poisson; print([name for name in ('skfem', 'scipy') if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=100, check=True)
    assert done.stdout.strip() == "[]"
