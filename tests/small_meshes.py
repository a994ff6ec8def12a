"""Small meshes with segments, boundaries and regions, and what it means that two are the same."""

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

import fem_mesh as fm

SQUARE = [(0, 0), (2, 0), (2, 2), (0, 2)]
SIDES = [(0, 1), (1, 2), (2, 3), (3, 0)]

SIZES = st.floats(1e-35, 1e35) | st.floats(0.1, 10)
COORDINATES = st.just(0.0) | SIZES | SIZES.map(lambda x: -x) | st.integers(-3, 3).map(float)
NAMES = st.text(min_size=1, max_size=8) | st.sampled_from(["inlet", "wall", "boundary 3", "region 1", 'a "b"', "ä b%20", "#"])


def bits(array):
    return array.dtype, array.shape, array.tobytes()


def check_same_mesh(mesh, other, parts=("points", "triangles", "segments", "regions")):
    for part in parts:
        assert bits(getattr(mesh, part)) == bits(getattr(other, part)), part


def check_same_names(mesh, other):
    assert other.region_names == mesh.region_names
    assert sorted(other.boundaries) == sorted(mesh.boundaries)  # numbers decide their order
    for name, rows in mesh.boundaries.items():
        assert other.boundaries[name].tolist() == rows.tolist()


@st.composite
def meshes(draw, names=NAMES, coordinates=COORDINATES):
    points = draw(st.lists(st.tuples(coordinates, coordinates), min_size=3, max_size=9))
    plain = fm.delaunay(points)
    assume(len(plain.triangles))
    edges = sorted({tuple(sorted(t[[i, i - 1]].tolist())) for t in plain.triangles for i in range(3)})
    segments = draw(st.lists(st.sampled_from(edges), unique=True, max_size=5))
    region_names = ["", *draw(st.lists(names, unique=True, max_size=3))]
    regions = draw(st.lists(st.integers(0, len(region_names) - 1), min_size=len(edges), max_size=len(edges)))
    owners = draw(st.lists(st.integers(0, 2), min_size=len(segments), max_size=len(segments)))
    groups = [name for name in draw(st.lists(names, unique=True, max_size=3)) if name not in region_names]
    return fm.Mesh(
        plain.points,
        plain.triangles,
        segments=segments,
        regions=regions[: len(plain.triangles)],
        boundaries={name: np.flatnonzero(np.array(owners) == i) for i, name in enumerate(groups)},
        region_names=region_names,
    )


def plate():
    """A mesh with everything: two regions, an interface, two boundaries, a corner in both, merged points."""
    mesh = fm.delaunay([*SQUARE, (0, 0)])
    return fm.Mesh(
        mesh.points,
        mesh.triangles,
        segments=[*SIDES, diagonal(mesh)],
        segment_of=[0, 1, 2, 3, 9],
        regions=[1, 2],
        region_names=["", "steel", "rubber"],
        boundaries={"left": [3], "walls": [0, 2, 3], "nobody": []},
    )


def diagonal(mesh):
    return sorted(set(mesh.triangles[0].tolist()) & set(mesh.triangles[1].tolist()))
