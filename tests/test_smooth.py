"""Smoothing moves what is free to better places, and nothing else; both drivers move it alike."""

import itertools
import os
import subprocess
import sys

import numpy as np
import pytest

import fem_mesh as fm
from fem_mesh import kernel, poisson
from fem_mesh.algorithms.refining.reopening import reopen
from fem_mesh.mesh.workspace import FLIPPED

module = sys.modules["fem_mesh.algorithms.smooth"]


def in_a_square(n, sides=0, seed=0):
    """The Delaunay triangulation of random points in a square whose sides have so many points."""
    side = np.arange(sides or max(1, round(1.2 * n**0.5))) / (sides or max(1, round(1.2 * n**0.5)))
    one, zero = np.ones(len(side)), np.zeros(len(side))
    boundary = [(side, zero), (one, side), (1 - side, one), (zero, 1 - side)]
    points = np.concatenate([np.column_stack(part) for part in boundary])
    return fm.delaunay(np.concatenate([points, np.random.default_rng(seed).random((n, 2))]))


def some_mesh(seed):
    """Meshes of many kinds: random, lattices full of ties, slivers, domains with segments, holes, cracks and regions."""
    kind, random = seed % 6, np.random.default_rng(seed)
    if kind == 0:
        return in_a_square(40, seed=seed)
    if kind == 1:
        return fm.delaunay(np.floor(random.random((60, 2)) * 7))
    if kind == 2:  # nearly on a line
        points = random.random((40, 2))
        return fm.delaunay(np.column_stack([points[:, 0], points[:, 0] + np.round(points[:, 1] * 3) * 2.0**-40]))
    make = [fm.plate_with_hole, fm.cracked_square, fm.gear, lambda: fm.letter("B"), two_materials][seed // 6 % 5]
    return fm.refine(make(), 20 + seed % 3, max_area=0.02) if kind < 5 else fm.constrained_delaunay(with_points(seed))


def two_materials():
    points = [(0, 0), (1, 0), (3, 0), (3, 2), (2, 2), (0, 2)]
    segments = [*((i, (i + 1) % 6) for i in range(6)), (1, 4)]  # the last divides it
    regions = [fm.Region(0.2, 0.2, "steel"), fm.Region(2.5, 1.5, "glass")]
    return fm.Domain(points, segments, regions=regions, names=["outer"] * 6 + [""])


def with_points(seed):
    """A square with an open segment across it, and points strewn over it."""
    points = [(0, 0), (1, 0), (1, 1), (0, 1), (0.2, 0.3), (0.8, 0.6)]
    strewn = np.random.default_rng(seed).random((50, 2)) * 0.98 + 0.01
    return fm.Domain(np.concatenate([points, strewn]), [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5)])


def bumpy(x, y):
    return 0.05 + x * x + np.abs(y)


def meshes_of(steps):
    return [step.facts["mesh"] for step in steps if step.kind != "done"]


def fixed_points(mesh):
    """The ends of segments, of boundary edges, and of edges between regions."""
    edges = [mesh.segments.ravel()]
    for i in range(3):
        across = mesh.neighbors[:, i]
        border = (across < 0) | (mesh.regions[across] != mesh.regions)
        edges.append(mesh.triangles[border][:, [i - 2, i - 1]].ravel())
    return np.unique(np.concatenate(edges))


def energy(mesh):
    """The volume between the lifted triangles and the paraboloid, but for a factor."""
    corners = mesh.points[mesh.triangles]
    return float((mesh.areas() * np.square(corners - np.roll(corners, 1, axis=1)).sum(axis=(1, 2))).sum())


# ---- what stays ----------------------------------------------------------------------------------------


def seeds(quick, all_of_them):
    """Some seeds always, the others with ``-m exhaustive``."""
    return [*range(quick), *(pytest.param(seed, marks=pytest.mark.exhaustive) for seed in range(quick, all_of_them))]


@pytest.mark.parametrize("seed", seeds(30, 300))
def test_every_sweep_leaves_a_valid_delaunay_mesh_with_all_that_was_fixed_bit_by_bit(seed):
    mesh, method = some_mesh(seed), ("odt", "centroid")[seed // 3 % 2]
    fixed, free = fixed_points(mesh), 0
    for after in meshes_of(fm.smooth(mesh, bumpy if seed % 2 else None, sweeps=4, method=method))[1:]:
        after.validate()
        np.testing.assert_array_equal(after.points[fixed], mesh.points[fixed])
        assert len(after.triangles) == len(mesh.triangles)
        np.testing.assert_array_equal(after.segments, mesh.segments)
        np.testing.assert_array_equal(fixed_points(after), fixed)
        assert reopen(after)[0].work.state[FLIPPED] == 0  # constrained Delaunay
        assert after.is_delaunay() or mesh.domain is not None
        fm.Mesh(after.points, after.triangles, segments=after.segments)  # which are still edges
        for name in range(len(mesh.region_names)):
            assert after.areas()[after.regions == name].sum() == pytest.approx(mesh.areas()[mesh.regions == name].sum())
        free += int((after.points != mesh.points).any(axis=1).sum())
    assert free > 0 or seed % 6 == 2


def test_neighbors_and_the_rest_are_those_of_a_mesh_made_anew():
    mesh = fm.refine(two_materials(), 25, max_area=0.05)
    after = meshes_of(fm.smooth(mesh, bumpy))[-1]
    anew = fm.Mesh(after.points, after.triangles)
    np.testing.assert_array_equal(after.triangles, anew.triangles)
    np.testing.assert_array_equal(after.neighbors, anew.neighbors)
    assert after.region_names == mesh.region_names
    assert after.domain is mesh.domain
    assert after.points.dtype == np.float64
    assert after.triangles.dtype == after.neighbors.dtype == np.int32


def test_duplicates_go_with_their_point():
    mesh = in_a_square(30)
    doubled = fm.delaunay(np.concatenate([mesh.points, mesh.points[-5:]]))
    after = meshes_of(fm.smooth(doubled))[-1]
    assert (after.points != doubled.points)[-5:].all()
    np.testing.assert_array_equal(after.points[-5:], after.points[-10:-5])


# ---- what gets better ----------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["odt", "centroid"])
@pytest.mark.parametrize("seed", seeds(3, 20))
def test_triangles_of_random_points_become_rounder(seed, method):
    start, *sweeps, done = fm.smooth(in_a_square(300, seed=seed), method=method, sweeps=6)
    means = [step.facts["mean_angle"] for step in (start, *sweeps)]
    assert means[0] < 33
    assert means[-1] > 45.5
    assert (np.diff(means[:4]) > 0).all()
    assert done.facts["min_angle"] > 10 > start.facts["min_angle"]


@pytest.mark.parametrize("size", [None, bumpy])
@pytest.mark.parametrize("angle", [0, 20, 33])
@pytest.mark.parametrize("seed", seeds(6, 60))
def test_no_sweep_makes_a_smaller_angle_than_asked_or_than_there_was(seed, angle, size):
    meshes = meshes_of(fm.smooth(some_mesh(seed), size, min_angle=angle, sweeps=4))
    for before, after in itertools.pairwise(meshes):
        assert after.min_angle >= min(before.min_angle, angle) - 1e-9


@pytest.mark.parametrize("seed", seeds(5, 40))
def test_moves_and_flips_lower_the_energy(seed):
    meshes = meshes_of(fm.smooth(in_a_square(100, sides=14, seed=seed), min_angle=0.0))
    energies = np.array([energy(mesh) for mesh in meshes])
    assert (np.diff(energies) < 1e-13).all()
    assert energies[-1] < 0.9 * energies[0]


def test_the_mean_of_circumcentres_is_where_the_energy_of_a_star_is_least():
    ring = np.array([(0, 0), (4, -1), (5, 3), (1, 4), (-1, 2)], float)
    mesh = fm.delaunay([*ring, (2.5, 1.0)])
    assert len(mesh.triangles) == 5
    after = meshes_of(fm.smooth(mesh, sweeps=1, min_angle=0))[-1]
    best = energy(fm.Mesh(after.points, mesh.triangles))
    for dx, dy in ((1e-3, 0), (-1e-3, 0), (0, 1e-3), (0, -1e-3)):
        moved = after.points.copy()
        moved[-1] += dx, dy
        assert energy(fm.Mesh(moved, mesh.triangles)) > best


def test_the_centroid_method_moves_a_vertex_to_the_centroid_of_its_star():
    ring = np.array([(0, 0), (4, -1), (5, 3), (1, 4), (-1, 2)], float)
    mesh = fm.delaunay([*ring, (2.5, 1.0)])
    after = meshes_of(fm.smooth(mesh, sweeps=1, method="centroid", min_angle=0))[-1]
    centroid = np.average(mesh.points[mesh.triangles].mean(axis=1), weights=mesh.areas(), axis=0)
    np.testing.assert_allclose(after.points[-1], centroid, rtol=1e-14)


@pytest.mark.parametrize("method", ["odt", "centroid"])
def test_equal_triangles_stay_and_it_ends_at_once(method):
    x, y = np.meshgrid(np.arange(8.0), np.arange(8.0))
    mesh = fm.delaunay(np.column_stack([(x + y / 2).ravel(), (y * 0.875).ravel()]))
    steps = list(fm.smooth(mesh, method=method))
    assert [step.kind for step in steps] == ["start", "sweep", "done"]
    np.testing.assert_allclose(steps[-1].facts["mesh"].points, mesh.points, atol=1e-14)


# ---- sizes -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["odt", "centroid"])
def test_points_go_where_small_triangles_are_wanted(method):
    mesh = fm.refine(fm.square(), 30, max_area=0.004)
    near = [
        (np.hypot(*(m.points - 0.5).T) < 0.15).sum()
        for m in meshes_of(fm.smooth(mesh, lambda x, y: 0.1 + np.hypot(x - 0.5, y - 0.5), method=method))
    ]
    assert near[-1] > 1.7 * near[0]


def test_only_the_proportions_of_sizes_count():
    mesh = in_a_square(80)
    one, other = (meshes_of(fm.smooth(mesh, lambda x, y, k=k: k * bumpy(x, y)))[-1] for k in (1.0, 2.0**30))
    np.testing.assert_array_equal(one.points, other.points)
    for equal in (3, 0.1, lambda x, y: 7.0, lambda x, y: np.full(x.shape, np.inf)):
        np.testing.assert_array_equal(meshes_of(fm.smooth(mesh, equal))[-1].points, meshes_of(fm.smooth(mesh))[-1].points)


def test_the_error_on_the_l_shape_falls_with_the_same_points_graded_to_the_corner():
    mesh = fm.refine(fm.l_shape(), 30, max_area=0.01)
    after = meshes_of(fm.smooth(mesh, lambda x, y: np.hypot(x, y) ** (2 / 3), sweeps=15))[-1]
    errors = []
    for m in (mesh, after):
        u = poisson.solve(m, g=poisson.corner_solution)
        errors.append(poisson.energy_error(m, u, poisson.corner_gradient))
    assert len(after.points) == len(mesh.points)
    assert errors[1] < 0.6 * errors[0]
    assert after.min_angle >= 20 - 1e-9


def test_the_same_with_sizes_from_the_estimator():
    mesh = fm.refine(fm.l_shape(), 30, max_area=0.01)
    errors = []
    for _ in range(4):
        u = poisson.solve(mesh, g=poisson.corner_solution)
        errors.append(poisson.energy_error(mesh, u, poisson.corner_gradient))
        eta = poisson.indicators(mesh, u)
        wanted = np.sqrt(mesh.areas() / (eta + eta.mean() / 100))
        mesh = meshes_of(fm.smooth(mesh, lambda x, y, mesh=mesh, wanted=wanted: wanted[mesh.find(x, y)], sweeps=5))[-1]
    assert (np.diff(errors) < 0).all()
    assert errors[-1] < 0.65 * errors[0]


# ---- two drivers -----------------------------------------------------------------------------------------


def plainly(generator, state, size):
    for _ in kernel.watch(generator, state):
        pass


def compiled(generator, state, size):
    with kernel.compiling(True):
        kernel.run(generator, state, size)


def in_pieces(pieces):
    def drive(generator, state, size):
        event = 1
        while event:  # until the generator has nothing left to do
            event = 0
            for event, _ in itertools.islice(kernel.watch(generator, state), pieces):  # noqa: B007
                pass

    return drive


def smoothed(monkeypatch, drive, mesh, **options):
    monkeypatch.setattr(module, "run", drive)
    return meshes_of(fm.smooth(mesh, sweeps=2, **options))[-1]


@pytest.mark.parametrize("seed", seeds(36, 300))
def test_both_drivers_give_identical_meshes(monkeypatch, seed):
    mesh, options = some_mesh(seed), {"size": bumpy if seed % 4 < 2 else None, "method": ("odt", "centroid")[seed % 2]}
    one, other = (smoothed(monkeypatch, drive, mesh, **options) for drive in (plainly, compiled))
    np.testing.assert_array_equal(one.points, other.points)
    np.testing.assert_array_equal(one.triangles, other.triangles)
    np.testing.assert_array_equal(one.neighbors, other.neighbors)


@pytest.mark.parametrize("pieces", [1, 2, 7])
def test_a_sweep_dropped_after_any_event_goes_on_where_it_stopped(monkeypatch, pieces):
    mesh = in_a_square(60)
    whole, dropped = (smoothed(monkeypatch, drive, mesh) for drive in (plainly, in_pieces(pieces)))
    np.testing.assert_array_equal(dropped.points, whole.points)
    np.testing.assert_array_equal(dropped.triangles, whole.triangles)


@pytest.mark.parametrize("power", [-60, 40])
def test_a_mesh_scaled_by_a_power_of_two_is_smoothed_alike(power):
    mesh, scale = in_a_square(60), 2.0**power
    points, triangles = mesh.points, mesh.triangles
    one, other = (meshes_of(fm.smooth(fm.Mesh(k * points, triangles)))[-1] for k in (1.0, scale))
    np.testing.assert_array_equal(scale * one.points, other.points)
    np.testing.assert_array_equal(one.triangles, other.triangles)


CHECKED = """
    import numpy as np, fem_mesh as fm
    from fem_mesh import kernel
    kernel.SMALL = -1
    for mesh in (fm.delaunay(fm.random_points(200)), fm.refine(fm.plate_with_hole(), 25, max_area=0.01)):
        for method in ("odt", "centroid"):
            *_, done = fm.smooth(mesh, lambda x, y: 0.1 + x * x, method=method)
            print(done.caption)
"""


@pytest.mark.exhaustive
def test_no_array_is_read_out_of_bounds(tmp_path):
    printed = []
    for bounds in ("0", "1"):
        settings = os.environ | {"NUMBA_BOUNDSCHECK": bounds, "NUMBA_CACHE_DIR": str(tmp_path / bounds)}
        code = "\n".join(line[4:] for line in CHECKED.splitlines())
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600, env=settings)
        assert done.returncode == 0, done.stderr
        printed.append(done.stdout)
    assert printed[0] == printed[1]


# ---- told --------------------------------------------------------------------------------------------


def test_a_trace_shows_each_sweep_forward_and_back():
    mesh = in_a_square(40)
    trace = fm.record(fm.smooth(mesh, sweeps=4))
    assert [step.kind for step in trace] == ["start", *["sweep"] * 4, "done"]
    for k, step in enumerate(trace):
        points, triangles = trace.frame(k)
        np.testing.assert_array_equal(points, step.facts["mesh"].points)
        assert {frozenset(t) for t in triangles.tolist()} == {frozenset(t) for t in step.facts["mesh"].triangles.tolist()}
        assert trace.min_angles()[k] == pytest.approx(step.facts["min_angle"])
        if step.kind == "sweep":
            assert len(step.new_points) == step.facts["moves"] > 0
            assert step.facts["sweep"] == k
    assert trace.mesh is trace[-1].facts["mesh"]


def test_captions_tell_moves_flips_and_angles():
    start, first, *_, done = fm.smooth(in_a_square(40), sweeps=2)
    assert start.caption.startswith("40 of 72 points are free to move; smallest angle ")
    facts = first.facts
    angles = f"smallest angle {facts['min_angle']:.1f} degrees, the triangles' mean {facts['mean_angle']:.1f}"
    assert first.caption == f"sweep 1: {facts['moves']} points move, {facts['flips']} edges are flipped; {angles}"
    assert done.caption.startswith("after 2 sweeps: smallest angle ")


# ---- bad input -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"mesh": fm.square()}, r"smooth needs a Mesh, not Domain: refine\(domain\) makes one of a Domain"),
        ({"mesh": fm.delaunay([(0, 0), (1, 1), (2, 2)])}, "there is nothing to smooth: no triangles: all 3 points"),
        ({"sweeps": 0}, "sweeps must be a whole number, at least 1, not 0"),
        ({"sweeps": 2.5}, "sweeps must be a whole number, at least 1, not 2.5"),
        ({"method": "laplace"}, 'method must be "odt" or "centroid", not \'laplace\''),
        ({"size": 0}, "size must be greater than 0"),
        ({"size": "small"}, "size must be a number"),
        ({"min_angle": -1}, "min_angle must be at least 0 and below 60 degrees"),
        ({"min_angle": float("nan")}, "min_angle must be a number"),
        ({"mesh": fm.Mesh([(0, 0), (1, 0), (0, 1), (0.2, 0.2), (0.9, 0.9)], [(0, 1, 2), (3, 1, 4)])}, "overlap"),
    ],
)
def test_bad_input_is_refused_before_the_first_step(options, says):
    given = {"mesh": fm.delaunay(fm.random_points(9)), **options}
    with pytest.raises(fm.MeshError, match=says):
        fm.smooth(given.pop("mesh"), **given)


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan])
def test_a_size_that_is_none_is_refused_with_the_place(value):
    with pytest.raises(fm.MeshError, match=r"size\([\d.]+, [\d.]+\) is .*: an edge length must be greater than 0"):
        list(fm.smooth(in_a_square(20), lambda x, y: np.where(x > 0.5, value, 1.0)))
