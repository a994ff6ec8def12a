"""How fast, beside Triangle (PyPI's ``triangle``, option Q) in the same process. Nothing here can fail on time."""

import gc
import os
import statistics
import subprocess
import sys
import time

import numpy as np
import pytest
import triangle
from families import FAMILIES, uniform
from fresh import fresh, peak_memory
from scipy.spatial import Delaunay

import fem_mesh as fm


def triangulate(points):
    return triangle.triangulate({"vertices": points}, "Q")


@pytest.mark.parametrize("n", [100_000, 1_000_000])
def test_uniform_points_beside_triangle(compare, n):
    points = uniform(n)
    compare(f"delaunay, uniform, n = {n:,}", lambda: fm.delaunay(points), lambda: triangulate(points), "must 0.7, aim 0.5")


@pytest.mark.parametrize("family", FAMILIES[1:], ids=lambda family: family.__name__)
def test_other_families_beside_triangle(compare, family):
    points = family(100_000)
    what = f"delaunay, {family.__name__.replace('_', ' ')}, n = 100,000"
    compare(what, lambda: fm.delaunay(points), lambda: triangulate(points), "<= 1.2, aim 0.8")


def test_uniform_points_beside_scipy(compare):
    points = uniform(100_000)
    compare("delaunay, beside SciPy, n = 100,000", lambda: fm.delaunay(points), lambda: Delaunay(points), "", rounds=3)


def test_uniform_points_beside_startinpy(compare):
    startinpy = pytest.importorskip("startinpy")  # a further peer, of the extra "bench"
    points = np.column_stack([uniform(100_000), np.zeros(100_000)])
    peer = lambda: startinpy.DT().insert(points, insertionstrategy="BBox")  # noqa: E731
    compare("delaunay, beside startinpy, n = 100,000", lambda: fm.delaunay(points[:, :2]), peer, "", rounds=3)


def test_growth_from_ten_thousand_to_a_million_points(line):
    micro = {}
    for n in (10_000, 100_000, 1_000_000):
        points = uniform(n)
        fm.delaunay(points)
        times = []
        for _ in range(max(5, 200_000 // n)):
            gc.collect()
            start = time.process_time()
            fm.delaunay(points)
            times.append(time.process_time() - start)
        micro[n] = statistics.median(times) / n * 1e6
    shown = ", ".join(f"{t:.2f}" for t in micro.values())
    line("time a point at 1e4, 1e5, 1e6", f"{shown} us", "", f"{micro[1_000_000] / micro[10_000]:.2f}", "<= 1.5")


# ---- in fresh processes --------------------------------------------------------------------------------


def test_import(line):
    code = "import numpy, time; t = time.perf_counter(); import fem_mesh; print(time.perf_counter() - t)"
    line("import fem_mesh, beyond numpy's own", f"{fresh(code) * 1e3:.0f} ms", "", "", "<= 100 ms")


def test_first_thousand_points_in_a_fresh_process(line):
    code = (
        "import numpy, fem_mesh as fm, time; p = fm.random_points(1000, seed=1); t = time.perf_counter();"
        "fm.delaunay(p); print(time.perf_counter() - t)"
    )
    line("first delaunay of 1,000 points, fresh process", f"{fresh(code) * 1e3:.0f} ms", "", "", "<= 150 ms")


def test_recording_a_thousand_points(line):
    points = fm.random_points(1000, seed=1)
    times = []
    for _ in range(5):
        start = time.process_time()
        fm.record(fm.bowyer_watson(points))
        times.append(time.process_time() - start)
    line("bowyer_watson recorded, 1,000 points", f"{statistics.median(times) * 1e3:.0f} ms", "", "", "<= 500 ms")


def test_peak_memory_of_a_million_points(line):
    before = (
        "import numpy as np, fem_mesh as fm; fm.delaunay(np.random.default_rng(0).random((5_000, 2)));"
        "points = np.random.default_rng(1).random((1_000_000, 2))"
    )
    peak = peak_memory(before, "mesh = fm.delaunay(points); count = len(points)")
    line("peak memory beyond the input, n = 1,000,000", f"{peak:.0f} bytes a point", "", "", "<= 250")


def test_first_compilation(line, tmp_path):
    code = "import numpy as np, fem_mesh as fm, time; t = time.perf_counter();"
    code += "fm.delaunay(np.random.default_rng(0).random((5_000, 2))); print(time.perf_counter() - t)"
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    cold, warm = (
        float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment).stdout)
        for _ in range(2)
    )
    line("first compiled delaunay on a machine; from the cache", f"{cold:.1f} s; {warm:.2f} s")
