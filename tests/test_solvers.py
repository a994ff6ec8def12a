"""A mesh in scikit-fem and in Matplotlib, and back: the same triangles in the same order, the same names."""

import re
import subprocess
import sys
import warnings

import numpy as np
import pytest
import skfem
from corpus import for_all
from domains import DOMAINS
from matplotlib.tri import LinearTriInterpolator, Triangulation
from small_meshes import SIDES, SQUARE, bits, meshes, plate

import fem_mesh as fm
from fem_mesh.files.formats import FORMATS


def edges_of(m, facets):
    return sorted(map(tuple, m.facets[:, facets].T.tolist()))


def numbered_anew(mesh):
    """Each point's number among those in triangles."""
    return np.cumsum(~np.isin(np.arange(len(mesh.points)), mesh.unused)) - 1


def check_in_skfem(mesh):
    """scikit-fem holds our points, triangles, boundaries and regions, by its own numbering of facets."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        m = mesh.to_skfem()
    assert len(caught) == (len(mesh.unused) > 0)
    assert m.is_valid(raise_=True)
    new = numbered_anew(mesh)
    assert np.array_equal(m.p.T, np.delete(mesh.points, mesh.unused, axis=0))
    assert np.array_equal(m.t.T, np.sort(new[mesh.triangles], axis=1))
    assert list(m.boundaries or {}) == list(mesh.boundaries)
    for name, rows in mesh.boundaries.items():
        assert m.facets[:, m.boundaries[name]].T.tolist() == np.sort(new[mesh.segments[rows]], axis=1).tolist()
    named = {name: np.flatnonzero(mesh.regions == r) for r, name in enumerate(mesh.region_names) if r and name}
    assert {name: rows.tolist() for name, rows in (m.subdomains or {}).items()} == {k: v.tolist() for k, v in named.items()}
    return m


def check_back(mesh, m):
    again = fm.Mesh.from_skfem(m)
    assert bits(again.points) == bits(np.delete(mesh.points, mesh.unused, axis=0))
    assert np.array_equal(np.sort(again.triangles, axis=1), np.sort(numbered_anew(mesh)[mesh.triangles], axis=1))
    assert list(again.boundaries) == list(mesh.boundaries)
    for name, rows in mesh.boundaries.items():
        ends = np.sort(numbered_anew(mesh)[mesh.segments[rows]], axis=1)
        assert again.segments[again.boundaries[name]].tolist() == ends.tolist()
    assert {*again.region_names} == {"", *mesh.region_names}
    assert [again.region_names[r] for r in again.regions] == [mesh.region_names[r] for r in mesh.regions]
    assert again.note == ""


# --- scikit-fem ---


@for_all(150, mesh=meshes())
def test_a_mesh_comes_back_from_scikit_fem(mesh):
    check_back(mesh, check_in_skfem(mesh))


@pytest.mark.parametrize("name", DOMAINS)
def test_every_domain_that_broke_others_arrives_in_scikit_fem(name):
    domain = DOMAINS[name]().domain()
    mesh = fm.constrained_delaunay(domain)
    if not len(mesh.triangles):
        pytest.skip("it has no inside")
    check_back(mesh, check_in_skfem(mesh))


def test_everything_in_a_plate_arrives_once():
    with pytest.warns(UserWarning, match=r"1 of 5 points is in no triangle: scikit-fem has the other 4") as caught:
        m = plate().to_skfem()
    assert caught[0].filename == __file__
    assert edges_of(m, m.boundaries["left"]) == [(0, 3)]
    assert edges_of(m, m.boundaries["walls"]) == [(0, 1), (0, 3), (2, 3)]
    assert m.boundaries["nobody"].tolist() == []
    assert {name: rows.tolist() for name, rows in m.subdomains.items()} == {"steel": [0], "rubber": [1]}


def test_a_segment_given_twice_is_one_facet():
    mesh = fm.Mesh(SQUARE, [(0, 1, 2), (0, 2, 3)], segments=[(0, 1), (1, 0), (1, 2)], boundaries={"wall": [0, 1, 2]})
    m = mesh.to_skfem()
    assert edges_of(m, m.boundaries["wall"]) == [(0, 1), (1, 2)]
    assert np.isclose(skfem.Functional(lambda w: 1 + 0 * w.x[0]).assemble(m_basis(m, "wall")), 4)


def m_basis(m, name):
    return skfem.FacetBasis(m, skfem.ElementTriP1(), facets=name)


def test_regions_without_a_name_are_called_by_number():
    mesh = fm.Mesh(SQUARE, [(0, 1, 2), (0, 2, 3)], regions=[0, 7])
    m = mesh.to_skfem()
    assert {name: rows.tolist() for name, rows in m.subdomains.items()} == {"region 7": [1]}
    again = fm.Mesh.from_skfem(m)
    assert again.regions.tolist() == [0, 7]
    assert again.region_names[7] == "region 7"


def test_regions_of_one_name_are_one_subdomain():
    mesh = fm.Mesh(SQUARE, [(0, 1, 2), (0, 2, 3)], regions=[2, 1], region_names=["", "steel", "steel"])
    assert mesh.to_skfem().subdomains["steel"].tolist() == [0, 1]


def test_a_mesh_without_names_has_none_in_scikit_fem():
    m = fm.Mesh(SQUARE, [(0, 1, 2), (0, 2, 3)], segments=SIDES).to_skfem()
    assert m.boundaries is None
    assert m.subdomains is None


def test_scikit_fem_integrates_over_our_boundaries_and_regions():
    outer, hole = [(0, 0), (4, 0), (4, 3), (0, 3)], [(1, 1), (2, 1), (2, 2), (1, 2)]
    domain = fm.Domain.from_loops(outer, hole, regions={"steel": (0.1, 0.1)})
    mesh = fm.refine(domain, max_area=0.1)
    m = mesh.to_skfem()
    one = skfem.Functional(lambda w: 1 + 0 * w.x[0])
    assert {name: round(one.assemble(m_basis(m, name)), 12) for name in m.boundaries} == {"outer": 14, "hole 0": 4}
    assert np.isclose(one.assemble(skfem.Basis(m, skfem.ElementTriP1(), elements="steel")), 11)
    assert np.allclose(one.elemental(skfem.Basis(m, skfem.ElementTriP1())), mesh.areas())


def test_triangles_in_several_subdomains_are_in_the_region_of_the_first():
    m = skfem.MeshTri().with_subdomains({"a": np.array([1]), "b": np.array([0, 1])})
    mesh = fm.Mesh.from_skfem(m)
    assert [mesh.region_names[r] for r in mesh.regions] == ["b", "a"]
    assert mesh.note == "1 triangles are in several sets, and in the region of the first"


def test_meshes_that_scikit_fem_refined_come_back():
    m = fm.refine(fm.square(), max_area=0.2).to_skfem()
    finer = fm.Mesh.from_skfem(m.refined())
    assert len(finer.triangles) == 4 * m.nelements
    assert {name: len(rows) for name, rows in finer.boundaries.items()} == {k: 2 * len(v) for k, v in m.boundaries.items()}
    finer.validate()
    around = m.with_boundaries({"around": m.facets_around(np.array([0]))})  # has a side to each facet
    assert len(fm.Mesh.from_skfem(around).boundaries["around"]) == 3


@pytest.mark.parametrize("m", [skfem.MeshTri2(), skfem.MeshQuad(), skfem.MeshTet(), Triangulation([0, 1, 0], [0, 0, 1])])
def test_what_is_no_mesh_of_straight_triangles_is_refused(m):
    with pytest.raises(fm.MeshError, match=f"from_skfem takes a skfem.MeshTri of straight triangles, not a {type(m).__name__}"):
        fm.Mesh.from_skfem(m)


def test_facets_and_triangles_that_are_not_there_are_named():
    with pytest.raises(fm.MeshError, match=r"boundaries\['wall'\] holds 9 at place 1: numbers there go from 0 to 4"):
        fm.Mesh.from_skfem(skfem.MeshTri().with_boundaries({"wall": np.array([0, 9])}))
    with pytest.raises(fm.MeshError, match=r"subdomains\['steel'\] holds -1 at place 0"):
        fm.Mesh.from_skfem(skfem.MeshTri().with_subdomains({"steel": np.array([-1])}))


def test_a_mesh_without_triangles_is_refused():
    line = fm.delaunay([(0, 0), (1, 1)])
    for move in (line.to_skfem, line.to_matplotlib):
        with pytest.raises(fm.MeshError, match="the mesh has no triangles"):
            move()


def test_the_arrays_there_are_copies():
    mesh = fm.refine(fm.square(), max_area=0.2)
    m, t = mesh.to_skfem(), mesh.to_matplotlib()
    m.p[:], t.x[:] = 0, 0
    assert mesh.points.any()
    m.boundaries["top"][:] = 0


def test_without_scikit_fem_an_error_says_what_to_install():
    code = "import sys; sys.modules['skfem'] = None; import fem_mesh as fm; fm.delaunay([(0, 0), (1, 0), (0, 1)]).to_skfem()"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.stderr.rstrip().endswith("ImportError: this needs scikit-fem: pip install scikit-fem")


def test_importing_fem_mesh_imports_no_solver():
    code = "import sys, fem_mesh, fem_mesh.files.solvers; print([m for m in ('scipy', 'skfem', 'meshio') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "[]"


# --- Matplotlib ---


@for_all(60, mesh=meshes())
def test_a_mesh_comes_back_from_matplotlib_to_the_last_bit(mesh):
    again = fm.Mesh.from_matplotlib(mesh.to_matplotlib())
    assert bits(again.points) == bits(mesh.points)
    assert bits(again.triangles) == bits(mesh.triangles)


def test_matplotlib_finds_the_neighbors_that_we_have():
    mesh = fm.delaunay(fm.random_points(50, seed=1))
    assert mesh.to_matplotlib().neighbors.tolist() == mesh.neighbors[:, [2, 0, 1]].tolist()  # at the edge from corner i


def test_matplotlib_interpolates_as_we_do():
    mesh = fm.delaunay(fm.random_points(50, seed=1))
    values, queries = np.sin(3 * mesh.points[:, 0]), fm.random_points(200, seed=2).T
    theirs = LinearTriInterpolator(mesh.to_matplotlib(), values)(*queries).filled(np.nan)
    assert np.allclose(mesh.interpolate(values, *queries), theirs, equal_nan=True)


def test_masked_triangles_are_left_out():
    mesh = fm.delaunay(fm.random_points(50, seed=1))
    t = mesh.to_matplotlib()
    t.set_mask(mesh.angles().min(axis=1) < 10)
    assert fm.Mesh.from_matplotlib(t).min_angle >= 10
    t.set_mask(np.ones(len(mesh.triangles), bool))
    assert len(fm.Mesh.from_matplotlib(t).triangles) == 0


def test_what_is_no_triangulation_is_refused():
    with pytest.raises(fm.MeshError, match=r"from_matplotlib takes a matplotlib\.tri\.Triangulation, not a list"):
        fm.Mesh.from_matplotlib(SQUARE)


# --- the table of what each keeps ---


def everything():
    """A mesh with all that a file could keep, a point in no triangle among the others, and a side in two boundaries."""
    mesh = fm.delaunay([(0, 0), (0, 0), *SQUARE[1:]])
    at = np.array([0, 2, 3, 4])
    return fm.Mesh(
        mesh.points,
        mesh.triangles,
        segments=[*at[SIDES], sorted(set(mesh.triangles[0].tolist()) & set(mesh.triangles[1].tolist()))],
        segment_of=[0, 1, 2, 3, 9],
        regions=[2, 1],
        region_names=["", "steel 1", "rubber"],
        boundaries={"left side": [3], "walls": [0, 2, 3]},
    )


def there_and_back(way, mesh, folder):
    if way.startswith("."):
        fm.write(mesh, folder / f"plate{way}")
        return fm.read(folder / f"plate{way}")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return getattr(fm.Mesh, way.replace("to_", "from_"))(getattr(mesh, way)())


def places(mesh, ends):
    return {frozenset(map(tuple, mesh.points[pair].tolist())) for pair in ends}


def kept_points(mesh, again):
    if bits(mesh.points) == bits(again.points):
        return "all"
    if bits(np.delete(mesh.points, mesh.unused, axis=0)) == bits(again.points):
        return "used"
    assert np.array_equal(mesh.points[mesh.triangles], again.points[again.triangles])
    return "corners"


def kept_segments(mesh, again):
    named = np.unique(np.concatenate(list(mesh.boundaries.values())))
    found = {"all": mesh.segments, "named": mesh.segments[named], "none": ()}
    return next(word for word, ends in found.items() if places(mesh, ends) == places(again, again.segments))


def kept_boundaries(mesh, again):
    def sets(of, words=False, first=False):
        taken = np.zeros(len(of.segments), int)
        for i, rows in enumerate(list(of.boundaries.values())[::-1]):
            taken[rows] = len(of.boundaries) - i
        chosen = {
            name: np.flatnonzero(taken == i) if first else rows for i, (name, rows) in enumerate(of.boundaries.items(), 1)
        }
        return {re.sub(" ", "_" if words else " ", name): places(of, of.segments[rows]) for name, rows in chosen.items()}

    theirs = sets(again)
    firsts = list(sets(mesh, first=True).values())
    found = {
        "names": theirs == sets(mesh),
        "first name": theirs == sets(mesh, first=True),
        "words": theirs == sets(mesh, words=True),
        "first number": list(theirs.values()) == firsts and all(re.fullmatch(r"boundary \d+", name) for name in theirs),
        "none": not theirs,
    }
    return next(word for word, so in found.items() if so)


def kept_regions(mesh, again):
    ours, theirs = ([of.region_names[r] for r in of.regions] for of in (mesh, again))
    found = {
        "names": ours == theirs and mesh.regions.tolist() == again.regions.tolist(),
        "words": [re.sub(" ", "_", name) for name in ours] == theirs,
        "numbers": mesh.regions.tolist() == again.regions.tolist() and not any(again.region_names),
        "none": not again.regions.any(),
    }
    return next(word for word, so in found.items() if so)


def kept_rows(mesh, again):
    ours, theirs = mesh.segment_of.tolist(), again.segment_of.tolist()
    return "all" if ours == theirs else "none" if {*theirs} <= {-1} else "some"


COLUMNS = {
    "points": (kept_points, "numbers of points"),
    "segments": (kept_segments, "segments"),
    "boundaries": (kept_boundaries, "boundaries"),
    "regions": (kept_regions, "regions"),
    "segment_of": (kept_rows, "rows of the domain's segments (segment_of)"),
}


def table():
    """{file or method: {column: word}}, as ``help(fm.write)`` shows it."""
    lines = fm.write.__doc__.partition("file, method")[2].partition("\n\n")[0].splitlines()
    columns, *rows = (re.split("  +", line.strip()) for line in lines)
    return {way: dict(zip(columns, words, strict=True)) for first, *words in rows for way in first.split()}


def test_the_table_has_all_files_that_hold_meshes():
    assert {*table()} == {*FORMATS, ".ele", "to_meshio", "to_skfem", "to_matplotlib"}


@pytest.mark.parametrize("way", table())
def test_the_table_of_what_is_kept_is_true(way, tmp_path):
    mesh = everything()
    again = there_and_back(way, mesh, tmp_path)
    assert table()[way] == {column: kept(mesh, again) for column, (kept, _) in COLUMNS.items()}


@pytest.mark.parametrize("way", [way for way in table() if way.startswith(".")])
def test_write_says_what_the_table_says(way, tmp_path):
    said, words = fm.write(everything(), tmp_path / f"plate{way}"), table()[way]
    for column, (_, thing) in COLUMNS.items():
        assert (f"{thing}: {way} files keep none" in said) == (words[column] in ("none", "corners"))
        if "number" in words[column]:
            assert f"names of {thing}: {way} files keep none" in said
    assert any("is written as" in sentence for sentence in said) == ("words" in words.values())
    assert any("is kept in the first" in sentence for sentence in said) == words["boundaries"].startswith("first")
