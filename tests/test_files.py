"""Files: what is written is read back to the last bit; what is cut off or wrong is named by file and line."""

import signal
import sys
import tempfile
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import pytest
import triangle as shewchuk
from corpus import for_all
from hypothesis import assume
from hypothesis import strategies as st
from small_meshes import COORDINATES, NAMES, SIDES, SQUARE, bits, check_same_mesh, check_same_names, meshes, plate

import fem_mesh as fm
from fem_mesh.domain.curves import Circle
from fem_mesh.domain.domain import Domain
from fem_mesh.domain.reading import Region
from fem_mesh.files.endings import READERS, read, write
from fem_mesh.files.formats import FORMATS, from_meshio, to_meshio

KEEPING_NAMES = [".msh", ".vtu", ".vtk", ".xdmf"]
SCRATCH = tempfile.TemporaryDirectory()  # where random meshes go, one after the other
ENDLESS = [".obj", ".inp"]  # these say nowhere how long they are: a shorter one is a smaller mesh
IN_SECTIONS = [".vtk"]  # this says so of each section, but not which sections there are


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty working directory, so that messages name files as a user would."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def scratch(name):
    return Path(SCRATCH.name, name)


@contextmanager
def patience(seconds):
    """An endless loop fails the test."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def stop(*_):
        raise TimeoutError(f"still reading after {seconds} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def check_same_domain(domain, other, parts=("points", "segments", "toggles", "holes")):
    for part in parts:
        assert bits(getattr(domain, part)) == bits(getattr(other, part)), part
    assert (domain.names, domain.regions) == (other.names, other.regions)


# --- random meshes and domains ---


@st.composite
def domains(draw):
    """A soup of segments, some between points that lie in a small grid: they cross, overlap, repeat."""
    places = st.tuples(COORDINATES, COORDINATES) | st.tuples(st.integers(0, 3), st.integers(0, 3))
    points = draw(st.lists(places, max_size=8))
    ends = st.integers(0, max(len(points) - 1, 0))
    segments = draw(st.lists(st.tuples(ends, ends), max_size=8 if points else 0))
    names = draw(st.lists(NAMES | st.just(""), min_size=len(segments), max_size=len(segments)))
    areas = st.none() | st.floats(1e-300, 1e300)
    regions = draw(st.lists(st.builds(Region, COORDINATES, COORDINATES, NAMES | st.just(""), max_area=areas), max_size=3))
    holes = draw(st.lists(st.tuples(COORDINATES, COORDINATES), max_size=3))
    try:
        return Domain(points, segments, holes, names=names, regions=regions, crossings="split")
    except fm.MeshError:  # no room for the crossing points
        assume(False)


# --- what is written is read back ---


@for_all(150, domain=domains())
def test_a_domain_comes_back_from_poly_to_the_last_bit(domain):
    assume(len(domain.points))
    lost = write(domain, scratch("soup.poly"))
    unsure = len(domain.holes) or any(sentence.startswith("parity") for sentence in lost)
    check_same_domain(domain, read(scratch("soup.poly")), ["points", "segments", "holes"] + ["toggles"] * (not unsure))


@for_all(150, mesh=meshes())
def test_a_mesh_comes_back_from_ele_and_node_to_the_last_bit(mesh):
    write(mesh, scratch("soup.ele"))
    again = read(scratch("soup.ele"))
    check_same_mesh(mesh, again, ["points", "triangles", "regions"])
    assert again.region_names == mesh.region_names
    assert bits(read(scratch("soup.node")).points) == bits(mesh.points)


@pytest.mark.parametrize("ending", FORMATS)
def test_a_mesh_comes_back_from_every_format_as_far_as_it_keeps_it(ending):
    losing = [part for part, thing in (("segments", "segments"), ("regions", "regions")) if thing in FORMATS[ending].loses]
    parts = [part for part in ("points", "triangles", "segments", "regions") if part not in losing]

    short = st.floats(0.1, 10).map(lambda x: round(x, 9)) | st.integers(-3, 3).map(float)
    words = st.sampled_from(["inlet", "wall", "steel", "rubber"])

    @for_all(40, mesh=meshes(words, short) if ending == ".inp" else meshes())
    def check(mesh):
        lost = write(mesh, scratch(f"soup{ending}"))
        again = read(scratch(f"soup{ending}"))
        if ending == ".stl":
            corners = mesh.points[mesh.triangles]
            assert np.array_equal(again.points[again.triangles], corners)
        elif ending == ".inp":  # regions are numbered as their sets come, and empty sets are not written
            check_same_mesh(mesh, again, ["points", "triangles", "segments"])
            assert [again.region_names[r] for r in again.regions] == [mesh.region_names[r] for r in mesh.regions]
        else:
            check_same_mesh(mesh, again, parts)
        if ending in KEEPING_NAMES and not any("is written as" in sentence for sentence in lost):
            check_same_names(mesh, again)

    check(40)


@for_all(60, mesh=meshes())
def test_a_mesh_comes_back_from_meshio_itself(mesh):
    again = from_meshio(to_meshio(mesh))
    check_same_mesh(mesh, again)
    check_same_names(mesh, again)


@pytest.mark.parametrize("ending", [".vtu", ".vtk", ".xdmf", ".xmf"])
def test_vtk_formats_keep_everything(folder, ending):
    mesh = plate()
    assert write(mesh, f"plate{ending}") == ()
    again = read(f"plate{ending}")
    check_same_mesh(mesh, again, ["points", "triangles", "segments", "regions", "segment_of"])
    check_same_names(mesh, again)


def test_what_a_format_cannot_keep_is_said(folder):
    assert write(plate(), "plate.msh") == (
        "rows of the domain's segments (segment_of): .msh files keep none",
        "segment 3 is in 2 boundaries, and is kept in the first",
    )
    assert write(plate(), "plate.stl") == (
        "segments: .stl files keep none",
        "boundaries: .stl files keep none",
        "regions: .stl files keep none",
        "names of regions: .stl files keep none",
        "rows of the domain's segments (segment_of): .stl files keep none",
        "numbers of points: .stl files keep none",
    )
    assert write(fm.delaunay([*SQUARE, (0, 0)]), "plate.off") == ("merged points (merged_into): .off files keep none",)
    assert write(fm.delaunay(SQUARE), "plate.node") == ("triangles and all else: .node files keep points only",)
    assert write(Domain(SQUARE, SIDES), "plate.node") == ("segments and all else: .node files keep points only",)
    assert write(Domain(SQUARE, []), "plate.node") == ()


def test_coordinates_in_inp_files_have_the_20_characters_that_its_readers_take(folder):
    places = [-6.393512075653085e-06, 0.012345678901234567, 1 / 3, 1e-40 / 3, 2 / 3 * 1e21, -1e50 / 7]
    mesh = fm.delaunay([(x, y) for x in places for y in (0, 1)])
    (said,) = write(mesh, "plate.inp")
    assert said == "coordinates of 8 points are rounded to 20 characters each"
    again = read("plate.inp")
    assert np.allclose(again.points, mesh.points, rtol=1e-12, atol=0)
    assert again.points[2:6].tolist() == mesh.points[2:6].tolist()
    node = Path("plate.inp").read_text().partition("*NODE")[2].partition("*ELEMENT")[0]
    assert max(len(number.strip()) for line in node.splitlines() for number in line.split(",")) == 20


def test_regions_without_a_name_are_sets_by_number_in_inp(folder):
    mesh = fm.Mesh(SQUARE, [(0, 1, 2), (0, 2, 3)], regions=[7, 0])
    assert write(mesh, "plate.inp") == ("the name 'region 7' is written as 'region_7'",)
    again = read("plate.inp")
    assert [again.region_names[r] for r in again.regions] == ["region_7", ""]


def test_triangles_without_a_region_are_in_a_group_of_their_own_in_msh(folder):
    mesh = fm.Mesh(SQUARE, [(0, 1, 2), (0, 2, 3)], regions=[0, 7], region_names=["", "no region"])
    assert write(mesh, "plate.msh") == ("the name 'no region' is written as 'no region_2'",)
    assert '2 8 "no region"\n' in Path("plate.msh").read_text()
    again = read("plate.msh")
    assert again.regions.tolist() == [0, 7]
    assert again.region_names == ("", "no region_2", *[""] * 6)


def test_abaqus_has_its_own_words_for_cells(folder):
    write(plate(), "plate.inp")
    assert [line for line in Path("plate.inp").read_text().splitlines() if "ELEMENT" in line] == [
        "*ELEMENT, TYPE=T3D2",
        "*ELEMENT, TYPE=CPS3",
    ]


def test_names_that_msh_cannot_hold_are_said_to_change(folder):
    mesh = fm.Mesh(SQUARE, [(0, 1, 2), (0, 2, 3)], segments=SIDES, boundaries={'the "wall"': [0], "x": [1]},
                   regions=[1, 0], region_names=["", "x"])  # fmt: skip
    assert write(mesh, "plate.msh") == (
        "the name 'the \"wall\"' is written as 'the _wall_'",
        "the name 'x' is written as 'x_2'",
    )
    again = read("plate.msh")
    assert list(again.boundaries) == ["the _wall_", "x"]
    assert again.region_names == ("", "x_2")


def test_curves_and_sizes_are_said_to_be_lost_in_poly(folder):
    angle = np.arange(8) * np.pi / 4
    points = np.column_stack([np.cos(angle), np.sin(angle)])
    segments = [(i, (i + 1) % 8) for i in range(8)]
    regions = [Region(0, 0, "air", size=0.1, max_area=0.5)]
    disk = Domain(points, segments, curves=dict.fromkeys(range(8), Circle((0, 0), 1)), regions=regions)
    lost = write(disk, "disk.poly")
    assert lost == (
        "curves: .poly keeps the chords of 8 segments only",
        "sizes: .poly keeps no longest edge for region 'air'; max_area is kept",
    )
    assert read("disk.poly").regions == (Region(0, 0, "air", max_area=0.5),)


def test_a_domain_whose_holes_nest_by_parity_says_that_triangle_fills_them(folder):
    nested = Domain.from_loops(SQUARE, [(0.5, 0.5), (1, 0.5), (1, 1)])
    (lost,) = write(nested, "plate.poly")
    assert lost.startswith("holes: .poly keeps seeds only, and there are none")
    again = read("plate.poly")
    check_same_domain(nested, again)
    assert "give a seed in each hole" in again.report[-1]
    seeded = Domain.from_loops(SQUARE, [(0.5, 0.5), (1, 0.5), (1, 1)], holes=[(0.9, 0.6)])
    assert write(seeded, "plate.poly") == ()
    assert read("plate.poly").report == ()
    beside = Domain.from_loops(SQUARE, [(3, 0), (4, 0), (4, 1)])
    assert write(beside, "plate.poly") == ()


def test_a_side_that_two_loops_share_keeps_its_parity(folder):
    """A hole that shares part of an outer side: written once a segment, the side would close the wrong loop."""
    points = [*SQUARE, (0.5, 0), (1, 0), (1, 1), (0.5, 1)]
    outer = [(0, 4), (4, 5), (5, 1), *SIDES[1:]]
    domain = Domain(points, [*outer, (4, 5), (5, 6), (6, 7), (7, 4)])
    write(domain, "bite.poly")
    check_same_domain(domain, read("bite.poly"))


def test_loops_that_close_only_where_cracks_cross_are_said_to_count_when_read_back(folder):
    ends = [(x, y) for x in (1, 2) for y in (0, 3)] + [(x, y) for y in (1, 2) for x in (0, 3)]
    hash_sign = Domain(ends, [(0, 1), (2, 3), (4, 5), (6, 7)], crossings="split")
    (lost,) = write(hash_sign, "hash.poly")
    assert lost.startswith("parity: loops that close where segments cross")


# --- other people's files ---


def test_points_numbered_from_1_and_in_a_node_file_of_their_own(folder):
    Path("box.node").write_text("# a box\n4 2 1 1\n1 0 0 5.5 1\n2 2 0 5.5 1\n\n3 2 2 5.5 1 # corner\n4 0 2 5.5 1\n")
    Path("box.poly").write_text(
        "0 2 1 1\n4 1\n1 1 2 7\n2 2 3 0\n3 3 4 -2\n4 4 1 7\n1\n1 1 1\n2\n1 .5 .5 3 -1\n2 1.5 1.5 2.5 .125\n"
    )
    domain = read("box.poly")
    assert domain.points.tolist() == [[0, 0], [2, 0], [2, 2], [0, 2]]
    assert domain.segments.tolist() == [list(pair) for pair in SIDES]
    assert domain.names == ("boundary 7", "", "boundary -2", "boundary 7")
    assert domain.holes.tolist() == [[1, 1]]
    assert domain.regions == (Region(0.5, 0.5, "region 3"), Region(1.5, 1.5, "region 2.5", max_area=0.125))


def test_a_domain_keeps_its_names_in_comments_that_triangle_skips(folder):
    write(Domain(SQUARE, SIDES, names=["inlet", "boundary 2", "", "inlet"]), "box.poly")
    text = Path("box.poly").read_text()
    assert '# name of boundary 3: "inlet"' in text
    assert read("box.poly").names == ("inlet", "boundary 2", "", "inlet")
    Path("box.poly").write_text(text.replace("# name of boundary 3:", "# or"))
    assert read("box.poly").names == ("boundary 3", "boundary 2", "", "boundary 3")


EXAMPLES = sorted((Path(shewchuk.__file__).parent / "data").iterdir())


@pytest.mark.parametrize("path", [path for path in EXAMPLES if path.suffix == ".ele"], ids=lambda path: path.name)
def test_the_meshes_that_come_with_triangle_read_as_its_own_reader_reads_them(path):
    mesh, theirs = read(path), shewchuk.get_data(path.stem)
    assert mesh.points.tolist() == theirs["vertices"].tolist()
    assert sorted(map(sorted, mesh.triangles.tolist())) == sorted(map(sorted, theirs["triangles"].tolist()))


@pytest.mark.parametrize("path", [path for path in EXAMPLES if path.suffix == ".poly"], ids=lambda path: path.name)
def test_the_domains_that_come_with_triangle_read_as_its_own_reader_reads_them(path, folder):
    domain, theirs = read(path), shewchuk.get_data(path.stem)
    assert domain.points.tolist() == theirs["vertices"].tolist()
    assert sorted(map(sorted, domain.segments.tolist())) == sorted(map(sorted, theirs["segments"].tolist()))
    assert domain.holes.tolist() == np.reshape(theirs.get("holes", []), (-1, 2)).tolist()
    write(domain, "again.poly")
    check_same_domain(domain, read("again.poly"))


FINE = {
    "Windows line ends": "3 2 0 0\r\n0 0 0\r\n1 1 0\r\n2 0 1\r\n",
    "old Mac line ends": "3 2 0 0\r0 0 0\r1 1 0\r2 0 1\r",
    "trailing comments": "3 2 0 0 # header\n0 0 0 # a 1 2 3\n1 1 0#b\n2 0 1\n# the end",
    "tabs, indents, blank lines": "\n\n\t3\t2  0 0\n\n   0 0 0\n 1\t1 0 \n 2 0 1\n\n\n",
    "no line end at the end": "3 2 0 0\n0 0 0\n1 1 0\n2 0 1",
    "a byte order mark": "\ufeff3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n",
    "a short header": "3\n0 0 0\n1 1 0\n2 0 1\n",
    "signs and exponents": "3 2 0 0\n0 +0. -0\n1 1e0 .0\n2 0 10E-1\n",
}


@pytest.mark.parametrize("name", FINE)
def test_what_is_odd_but_right_is_read(name, folder):
    Path("plate.node").write_bytes(FINE[name].encode())
    assert read("plate.node").points.tolist() == [[0, 0], [1, 0], [0, 1]]


# --- broken files ---

NODES = "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n"
BROKEN = {  # what is wrong: (the file, its text, what the message says)
    "an empty file": (".node", "", r"plate\.node, line 1: the file ends where the number of points should be"),
    "only a comment": (".node", "# nothing\n\n", r"line 2: the file ends where the number of points"),
    "cut off after the header": (".node", "3 2 0 0\n", r"plate\.node, line 1: the file ends where point 1 of 3 should be"),
    "cut off in the middle": (".node", "3 2 0 0\n0 0 0\n1 1 0\n", r"line 3: the file ends where point 3 of 3 should be"),
    "cut off within a line": (".node", "2 2 0 0\n0 0 0\n1 1\n", r"line 3: expected 3 numbers for point 2 of 2 .*, found 2"),
    "a number too many": (".node", "1 2 0 0\n0 0 0 7\n", r"expected 3 numbers for point 1 of 1 \(point, x, y\), found 4"),
    "a line too many": (".node", "1 2 0 0\n0 0 0\n1 1 0\n", r"line 3: expected the end of the file .*, found '1 1 0'"),
    "a letter among the numbers": (".node", "2 2 0 0\n0 0 0\n1 1 O\n", r"line 3: expected a number, found 'O'"),
    "an underscore": (".node", "1 2 0 0\n0 1_0 0\n", r"line 2: expected a number, found '1_0'"),
    "not a number": (".node", "1 2 0 0\n0 nan 0\n", r"line 2: expected a number, found 'nan'"),
    "beyond all doubles": (".node", "1 2 0 0\n0 1e999 0\n", r"line 2: expected a number, found '1e999'"),
    "beyond exact signs": (".node", "1 2 0 0\n0 1e300 0\n", r"plate\.node: point 0 = .* has a magnitude outside"),
    "locale commas": (".node", "1 2 0 0\n0 0,5 1\n", r"line 2: found a comma in '0,5': numbers are written 0\.5"),
    "a negative count": (".node", "-3 2 0 0\n", r"line 1: the number of points is -3"),
    "half a count": (".node", "2.5 2 0 0\n", r"line 1: expected whole numbers, found 2\.5"),
    "a huge count": (".node", "99999999999999 2 0 0\n0 0 0\n", r"line 2: the file ends where point 2 of 99999999999999"),
    "three dimensions": (".node", "1 3 0 0\n0 0 0 0\n", r"line 1: the dimension is 3, and fem_mesh meshes the plane"),
    "huge attributes": (".node", "1 2 999999999 0\n0 0 0 0\n", r"line 1: expected the number of attributes, 0 to 1000"),
    "two markers": (".node", "1 2 0 2\n0 0 0 0 0\n", r"line 1: expected the number of markers, 0 or 1, found 2"),
    "a wrong first index": (".node", "1 2 0 0\n5 0 0\n", r"line 2: the first point has the number 5"),
    "a repeated index": (".node", "3 2 0 0\n1 0 0\n2 1 0\n2 0 1\n", r"line 4: expected point 3, .* 2, which line 3 has"),
    "a missing index": (".node", "2 2 0 0\n1 0 0\n3 1 0\n", r"line 3: expected point 2, found number 3"),
    "half an index": (".node", "1 2 0 0\n.5 0 0\n", r"line 2: expected whole numbers for the number of a point, found 0\.5"),
    "binary junk": (".node", "\x89PNG\r\n\x1a\n\0\0\0\rIHDR", r"plate\.node is no text file: it holds bytes that are 0"),
    "junk without zeros": (".node", "\x89PNG\r\n\x1a\n", r"plate\.node, line 1: expected a number, found"),
    "no segments": (".poly", NODES, r"plate\.poly, line 4: the file ends where the number of segments should be"),
    "no holes": (".poly", NODES + "1 0\n1 1 2\n", r"line 6: the file ends where the number of holes should be"),
    "a segment to nowhere": (".poly", NODES + "1 0\n1 1 4\n0\n", r"line 6: point 4 is not there: points have .* 1 to 3"),
    "a segment from 0 among points from 1": (".poly", NODES + "1 0\n1 0 2\n0\n", r"line 6: point 0 is not there"),
    "segments that count otherwise": (".poly", NODES + "1 0\n0 1 2\n0\n", r"line 6: the numbers begin with 0 here, and with 1"),
    "half a marker": (".poly", NODES + "1 1\n1 1 2 .5\n0\n", r"line 6: expected whole numbers for markers, found 0\.5"),
    "a region without attribute": (".poly", NODES + "0 0\n0\n1\n1 0 0\n", r"line 8: expected 4 to 5 numbers for region 1 of 1"),
    "more after the regions": (".poly", NODES + "0 0\n0\n0\n7\n", r"line 8: expected the end of the file after the regions"),
    "crossing segments": (".poly", "4 2\n1 0 0\n2 2 2\n3 2 0\n4 0 2\n2\n1 1 2\n2 3 4\n0\n",
                          r"plate\.poly: .*cross.* \(these numbers begin with 0, the file's with 1\)"),
    "cells with six corners": (".ele", "1 6 0\n1 1 2 3 4 5 6\n", r"plate\.ele, line 1: there are 6 corners a cell"),
    "a triangle to nowhere": (".ele", "1 3 0\n1 1 2 9\n", r"line 2: point 9 is not there: points have the numbers 1 to 3"),
    "half a corner": (".ele", "1 3 0\n1 1 2 2.5\n", r"line 2: expected whole numbers for points, found 2\.5"),
    "a triangle with a corner twice": (".ele", "1 3 0\n1 1 2 2\n", r"plate\.ele: triangle 0 = \(0, 1, 1\) names a point twice"),
    "a cut-off .ele": (".ele", "2 3 0\n1 1 2 3\n", r"plate\.ele, line 2: the file ends where triangle 2 of 2 should be"),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_named_with_its_line(name, folder):
    ending, text, message = BROKEN[name]
    Path("plate.node").write_text(NODES)
    Path(f"plate{ending}").write_bytes(text.encode("latin-1"))
    with pytest.raises(fm.MeshError, match=message):
        read(f"plate{ending}")


@pytest.mark.parametrize("ending", [".poly", ".node", ".ele"])
def test_every_cut_off_file_of_triangle_is_refused(folder, ending):
    """But for the last line, whose last number may still be one, and for the comments at the end."""
    write(Domain(SQUARE, SIDES, [(0.25, 0.25)], names="wall", regions=[Region(1, 1, "steel", max_area=0.5)]), "plate.poly")
    write(plate(), "plate.ele")
    text = Path(f"plate{ending}").read_text()
    told = text.partition("#")[0].rstrip("\n")
    for n in range(told.rindex("\n")):
        if ending == ".poly" and told[:n].rstrip("\n").rpartition("\n")[2].startswith("0 0.25 0"):
            continue  # the list of regions may be missing
        Path(f"plate{ending}").write_text(text[:n])
        with pytest.raises(fm.MeshError, match=rf"plate\{ending}"):
            read(f"plate{ending}")


def test_a_missing_file_is_not_found_by_its_name(folder):
    for ending in READERS:
        with pytest.raises(FileNotFoundError, match=rf"nowhere\{ending}"):
            read(f"nowhere{ending}")
    Path("plate.ele").write_text("1 3 0\n1 1 2 3\n")
    with pytest.raises(FileNotFoundError, match=r"plate\.ele needs the points of a file that is not there: 'plate\.node'"):
        read("plate.ele")


@pytest.mark.parametrize("ending", FORMATS)
def test_a_cut_off_file_of_any_format_is_refused_or_whole(folder, ending, capfd):
    mesh = fm.Mesh(SQUARE, [(0, 1, 2), (0, 2, 3)], segments=SIDES, regions=[1, 2])
    write(mesh, f"plate{ending}")
    data = Path(f"plate{ending}").read_bytes()
    whole = read(f"plate{ending}")
    for n in range(0, len(data), 1 + len(data) // 200):
        Path(f"cut{ending}").write_bytes(data[:n])
        with patience(5), suppress(fm.MeshError):
            found = read(f"cut{ending}")
            if ending not in ENDLESS:
                check_same_mesh(whole, found, ["points", "triangles", "segments"] + ["regions"] * (ending not in IN_SECTIONS))
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("junk", [b"", b"\n", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", b"hello\nworld\n", bytes(range(256)) * 4])
@pytest.mark.parametrize("ending", FORMATS)
def test_junk_of_any_ending_is_refused_without_a_word_on_the_screen(folder, ending, junk, capfd):
    Path(f"junk{ending}").write_bytes(junk)
    with patience(5), pytest.raises(fm.MeshError, match=rf"junk\{ending}"):
        read(f"junk{ending}")
    assert capfd.readouterr() == ("", "")


# --- what meshio reads and a mesh cannot be ---


def cells(points, *blocks, **more):
    meshio = pytest.importorskip("meshio")
    return meshio.Mesh(np.array(points, float), [(kind, np.array(rows)) for kind, rows in blocks], **more)


def test_a_mesh_that_is_not_flat_is_refused():
    with pytest.raises(fm.MeshError, match=r"not flat: point 2 at \(0\.0, 1\.0, 5\.0\) has another z than point 0"):
        from_meshio(cells([(0, 0, 3), (1, 0, 3), (0, 1, 5)], ("triangle", [(0, 1, 2)])))
    assert from_meshio(cells([(0, 0, 3), (1, 0, 3), (0, 1, 3)], ("triangle", [(0, 1, 2)]))).points.shape == (3, 2)
    with pytest.raises(fm.MeshError, match=r"points have the shape \(3, 1\)"):
        from_meshio(cells([(0,), (1,), (2,)], ("triangle", [(0, 1, 2)])))


def test_cells_that_are_no_triangles_are_refused():
    with pytest.raises(fm.MeshError, match="holds 1 cells of type 'quad', and a Mesh has triangles only"):
        from_meshio(cells(SQUARE, ("triangle", [(0, 1, 2)]), ("quad", [(0, 1, 2, 3)])))
    with pytest.raises(fm.MeshError, match="no triangles"):
        from_meshio(cells(SQUARE, ("line", [(0, 1)]), ("vertex", [(0,)])))
    with pytest.raises(fm.MeshError, match="names a point that is not there"):
        from_meshio(cells(SQUARE, ("triangle", [(0, 1, 7)])))
    with pytest.raises(fm.MeshError, match=r"segment 0 = \(1, 3\) is no edge of a triangle"):
        from_meshio(cells(SQUARE, ("line", [(1, 3)]), ("triangle", [(0, 1, 2), (0, 2, 3)])))


def test_blocks_of_one_type_are_joined_and_their_sets_with_them():
    lines, triangles = [("line", [(0, 1)]), ("line", [(1, 2), (2, 3)])], [("triangle", [(0, 1, 2)]), ("triangle", [(0, 2, 3)])]
    mesh = from_meshio(
        cells(SQUARE, lines[0], triangles[0], lines[1], triangles[1],
              cell_sets={"right": [None, None, [0], None], "all": [[0], [], [0, 1], []], "steel": [None, None, None, [0]]})
    )  # fmt: skip
    assert mesh.segments.tolist() == [[0, 1], [1, 2], [2, 3]]
    assert {name: rows.tolist() for name, rows in mesh.boundaries.items()} == {"right": [1], "all": [0, 1, 2]}
    assert mesh.regions.tolist() == [0, 1]
    assert mesh.region_names == ("", "steel")


def test_triangles_in_several_sets_are_in_the_region_of_the_first_and_a_note_says_so():
    mesh = from_meshio(cells(SQUARE, ("triangle", [(0, 1, 2), (0, 2, 3)]), cell_sets={"half": [[0]], "all": [[0, 1]]}))
    assert mesh.regions.tolist() == [1, 2]
    assert mesh.note == "1 triangles are in several sets, and in the region of the first"


def test_large_and_negative_numbers_of_regions_become_names():
    tags = {"gmsh:physical": [np.array([70001, -4])]}
    mesh = from_meshio(cells(SQUARE, ("triangle", [(0, 1, 2), (0, 2, 3)]), cell_data=tags, field_data={"air": [70001, 2]}))
    assert mesh.regions.tolist() == [2, 1]
    assert mesh.region_names == ("", "region -4", "air")


def test_attributes_that_are_no_whole_numbers_are_no_regions(folder):
    Path("plate.node").write_text(NODES)
    Path("plate.ele").write_text("1 3 1\n1 1 2 3 0.5\n")
    assert read("plate.ele").regions.tolist() == [0]
    assert read("plate.ele").note == "the attributes in plate.ele are no whole numbers: they are not its regions"


# --- what has no file ---


def test_endings_that_fem_mesh_does_not_know_are_refused_by_name(folder):
    with pytest.raises(fm.MeshError, match=r"plate\.doc: fem_mesh reads \.node, \.poly, .*, not \.doc"):
        read("plate.doc")
    with pytest.raises(fm.MeshError, match=r"plate: fem_mesh writes .*, not files without an ending"):
        write(plate(), "plate")


def test_each_thing_has_files_of_its_own(folder):
    with pytest.raises(fm.MeshError, match=r"a Domain is written as \.poly; to write it as \.msh, mesh it first"):
        write(Domain(SQUARE, SIDES), "plate.msh")
    with pytest.raises(fm.MeshError, match=r"\.poly files hold domains, and a Mesh is written as \.ele"):
        write(plate(), "plate.poly")
    with pytest.raises(fm.MeshError, match="write takes a Mesh or a Domain, not list"):
        write(SQUARE, "plate.node")
    with pytest.raises(fm.MeshError, match=r"the mesh has no triangles, and a \.vtu file is a list of cells"):
        write(fm.delaunay([(0, 0), (1, 1)]), "line.vtu")
    assert not list(folder.iterdir())


def test_no_points_and_no_triangles_have_files_too(folder):
    write(fm.delaunay([(0, 0), (1, 1)]), "line.ele")
    assert read("line.ele").points.tolist() == [[0, 0], [1, 1]]
    Path("nothing.node").write_text("0 2 0 0\n")
    assert len(read("nothing.node").points) == 0
    with pytest.raises(fm.MeshError, match=r"nothing\.poly: the domain has no points"):
        write(Domain([], []), "nothing.poly")


def test_endings_may_be_in_capitals(folder):
    write(plate(), "PLATE.ELE")
    assert Path("PLATE.NODE").exists()
    check_same_mesh(plate(), read("PLATE.ELE"), ["points", "triangles"])
    write(plate(), "PLATE.MSH")
    check_same_mesh(plate(), read("PLATE.MSH"))


def test_meshio_is_imported_when_it_is_first_needed():
    import subprocess

    code = "import sys, fem_mesh.files.endings; assert 'meshio' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
