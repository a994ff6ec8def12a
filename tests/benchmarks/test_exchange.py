"""What a mesh of a million triangles takes to scikit-fem and Matplotlib, and to scikit-fem's own numbering of facets."""

import time

import numpy as np
import pytest

import fem_mesh as fm


@pytest.fixture(scope="module")
def plain():
    return fm.refine(fm.l_shape(), min_angle=20, max_area=3 / 680_000)


def named(mesh):
    """With four boundaries and three regions."""
    k = len(mesh.segments)
    boundaries = {name: np.arange(i, k, 4) for i, name in enumerate(("left", "right", "top", "bottom"))}
    regions = np.arange(len(mesh.triangles)) % 3
    return fm.Mesh(
        mesh.points, mesh.triangles, segments=mesh.segments, boundaries=boundaries, regions=regions, region_names=["", "a", "b"]
    )


def seconds(work):
    took = []
    for _ in range(3):
        start = time.perf_counter()
        work()
        took.append(time.perf_counter() - start)
    return f"{sorted(took)[1]:.2f} s"


def test_a_million_triangles_to_solvers(line, plain):
    bare = fm.Mesh(plain.points, plain.triangles)
    size = f"{len(bare.triangles):,} triangles"
    line(f"to_skfem, {size}", seconds(bare.to_skfem), reach="<= 1 s")
    mesh = named(plain)
    line(
        f"to_skfem, {size}, named",
        seconds(mesh.to_skfem),
        f"{seconds(lambda: bare.to_skfem().facets)} (its facets)",
        "",
        "<= 3 s",
    )
    line(f"to_matplotlib, {size}", seconds(bare.to_matplotlib))
