"""Readers that are neither ours nor meshio's open what we write: Gmsh, VTK, trimesh, Triangle, CalculiX, DOLFINx.

A reader that is not on this machine is skipped; where FEM_MESH_READERS=required says so, it fails (DOLFINx never).
"""

import importlib
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import fem_mesh as fm

HERE = Path(__file__).parent
DEBIAN = "/usr/bin/python3"  # where DOLFINx is, if it is there


def missing(what):
    if os.environ.get("FEM_MESH_READERS") == "required":
        pytest.fail(what)
    pytest.skip(what)


def reader(module):
    """A module: Gmsh's needs libraries of the system besides."""
    try:
        return importlib.import_module(module)
    except (ImportError, OSError) as error:
        return missing(f"no {module} on this machine: {error}")


@pytest.fixture
def calculix():
    return shutil.which("ccx") or missing("no CalculiX (ccx) on this machine")


def plate(names=None, regions=True):
    """A plate with a hole, whose boundaries have names, of steel; on the right of an interface it has no region."""
    domain = fm.Domain.from_loops([(0, 0), (4, 0), (4, 3), (0, 3)], [(1, 1), (2, 1), (2, 2), (1, 2)], names=names)
    points, segments = np.vstack([domain.points, [(3, 0), (3, 3)]]), [*domain.segments.tolist(), (8, 9)]
    seeds = {"steel": (0.1, 0.1)} if regions else None
    return fm.refine(fm.Domain(points, segments, names=[*domain.names, "interface"], regions=seeds), max_area=0.2)


def places(points, rows):
    """Edges or triangles as sets of their corners' coordinates: readers number points as they like.

    To 12 digits: Gmsh reads 0.4375 from an .obj file as 0.43750000000000006.
    """
    return {frozenset(map(tuple, corners)) for corners in points[rows].round(12).tolist()}


def kept(mesh):
    """What a file of arrays or groups has of it: name -> rows of segments, name -> rows of triangles."""
    regions = {name: np.flatnonzero(mesh.regions == r) for r, name in enumerate(mesh.region_names) if r and name}
    return dict(mesh.boundaries), regions


# --- Gmsh ---


@pytest.fixture
def gmsh():
    module = reader("gmsh")
    module.initialize(["", "-v", "1"], readConfigFiles=False, interruptible=False)
    yield module
    module.finalize()


def opened(gmsh, path):
    """Points (n, 2), and a function for the lines (1) or triangles (2) of an entity, or all."""
    gmsh.open(str(path))
    tags, xyz, _ = gmsh.model.mesh.getNodes()
    assert not xyz[2::3].any()
    row = dict(zip(tags.tolist(), range(len(tags)), strict=True))

    def cells(dimension, entity=-1):
        nodes = gmsh.model.mesh.getElementsByType(dimension, entity)[1].tolist()
        return np.array([row[v] for v in nodes], int).reshape(-1, dimension + 1)

    return xyz.reshape(-1, 3)[:, :2], cells


@pytest.mark.parametrize("names", [None, ["wall", "the duct"]])
def test_gmsh_finds_our_points_triangles_and_named_groups(gmsh, names, tmp_path):
    mesh = plate(names)
    assert list(mesh.boundaries) == [*(names or ["outer", "hole 0"]), "interface"]
    fm.write(mesh, tmp_path / "plate.msh")
    points, cells = opened(gmsh, tmp_path / "plate.msh")
    assert sorted(points.tolist()) == sorted(mesh.points.tolist())
    found = {1: {}, 2: {}}
    for dimension, number in gmsh.model.getPhysicalGroups():
        entities = gmsh.model.getEntitiesForPhysicalGroup(dimension, number)
        rows = np.concatenate([cells(dimension, entity) for entity in entities])
        found[dimension][gmsh.model.getPhysicalName(dimension, number)] = places(points, rows)
    boundaries, regions = kept(mesh)
    regions["no region"] = np.flatnonzero(mesh.regions == 0)
    assert found[1] == {name: places(mesh.points, mesh.segments[rows]) for name, rows in boundaries.items()}
    assert found[2] == {name: places(mesh.points, mesh.triangles[rows]) for name, rows in regions.items()}
    assert (len(cells(1)), len(cells(2))) == (len(mesh.segments), len(mesh.triangles))


def test_what_gmsh_writes_of_our_file_is_read_back(gmsh, tmp_path):
    mesh = plate()
    fm.write(mesh, tmp_path / "plate.msh")
    opened(gmsh, tmp_path / "plate.msh")
    gmsh.write(str(tmp_path / "theirs.msh"))  # version 4.1
    theirs = fm.read(tmp_path / "theirs.msh")
    assert theirs.areas().sum() == pytest.approx(11)
    assert {name: len(rows) for name, rows in theirs.boundaries.items()} == {k: len(v) for k, v in mesh.boundaries.items()}
    assert np.isclose(theirs.areas()[theirs.regions == theirs.region_names.index("steel")].sum(), 8)
    assert set(theirs.region_names) == {"", "steel"}


@pytest.mark.parametrize("ending", [".mesh", ".vtk", ".obj", ".stl"])
def test_gmsh_finds_our_triangles_in_other_files_too(gmsh, ending, tmp_path):
    mesh = plate()
    fm.write(mesh, tmp_path / f"plate{ending}")
    points, cells = opened(gmsh, tmp_path / f"plate{ending}")
    assert len(cells(2)) == len(mesh.triangles)
    assert places(points, cells(2)) == places(mesh.points, mesh.triangles)
    if ending in (".mesh", ".vtk"):
        assert places(points, cells(1)) == places(mesh.points, mesh.segments)
    if ending == ".mesh":  # an entity for each number
        found = [len(cells(*entity)) for entity in gmsh.model.getEntities() if entity[0]]
        boundaries, regions = kept(mesh)
        steel = len(regions["steel"])
        assert sorted(found) == sorted([*map(len, boundaries.values()), steel, len(mesh.triangles) - steel])


# --- VTK ---

VTK = {  # module and class of the reader
    ".vtu": ("vtkmodules.vtkIOXML", "vtkXMLUnstructuredGridReader"),
    ".vtk": ("vtkmodules.vtkIOLegacy", "vtkUnstructuredGridReader"),
    ".xdmf": ("vtkmodules.vtkIOXdmf2", "vtkXdmfReader"),
    ".xmf": ("vtkmodules.vtkIOXdmf2", "vtkXdmfReader"),
    ".ply": ("vtkmodules.vtkIOPLY", "vtkPLYReader"),
    ".obj": ("vtkmodules.vtkIOGeometry", "vtkOBJReader"),
    ".stl": ("vtkmodules.vtkIOGeometry", "vtkSTLReader"),
}


def corners_of(cell):
    return [cell.GetPointId(i) for i in range(cell.GetNumberOfPoints())]


@pytest.mark.parametrize("ending", VTK)
def test_vtk_finds_our_points_cells_and_named_arrays(ending, tmp_path):
    module, name = VTK[ending]
    source = getattr(reader(module), name)()
    as_numpy = reader("vtkmodules.util.numpy_support").vtk_to_numpy
    mesh = plate(["wall", 'ä <"duct"> 100 %'])
    fm.write(mesh, tmp_path / f"plate{ending}")
    source.SetFileName(str(tmp_path / f"plate{ending}"))
    source.Update()
    data = source.GetOutputDataObject(0)
    points = as_numpy(data.GetPoints().GetData())
    cells = [
        [data.GetCell(c).GetPointId(i) for i in range(data.GetCell(c).GetNumberOfPoints())]
        for c in range(data.GetNumberOfCells())
    ]
    triangles = np.array([cell for cell in cells if len(cell) == 3])
    assert np.array_equal(points[triangles][:, :, :2], mesh.points[mesh.triangles].astype(points.dtype))  # .stl is single
    if ending in (".stl", ".ply", ".obj"):
        return
    assert np.array_equal(points[:, :2], mesh.points)
    assert np.array_equal(triangles, mesh.triangles)
    k = len(mesh.segments)
    assert np.array_equal([cell for cell in cells if len(cell) == 2], mesh.segments)
    arrays = data.GetCellData()
    found = {arrays.GetArrayName(i): as_numpy(arrays.GetArray(i)) for i in range(arrays.GetNumberOfArrays())}
    assert np.array_equal(found["regions"], [0] * k + mesh.regions.tolist())
    boundaries, regions = kept(mesh)
    expected = {f"boundary: {name}": rows for name, rows in boundaries.items()}
    expected |= {f"region {mesh.region_names.index(name)}: {name}": rows + k for name, rows in regions.items()}
    for name, rows in expected.items():
        if ending != ".vtk":  # which VTK decodes
            name = name.replace("%", "%25").replace('"', "%22").replace("<", "%3C").replace(">", "%3E")
        assert np.flatnonzero(found[name]).tolist() == rows.tolist()


# --- trimesh, Triangle ---


@pytest.mark.parametrize("ending", [".off", ".ply", ".obj", ".stl"])
def test_trimesh_finds_our_triangles(ending, tmp_path):
    trimesh, mesh = reader("trimesh"), plate()
    fm.write(mesh, tmp_path / f"plate{ending}")
    theirs = trimesh.load(tmp_path / f"plate{ending}", process=False)
    assert np.array_equal(theirs.vertices[theirs.faces][:, :, :2], mesh.points[mesh.triangles])
    assert theirs.area == pytest.approx(11)
    if ending != ".stl":
        assert np.array_equal(theirs.vertices[:, :2], mesh.points)


def test_triangle_finds_our_domain_points_and_triangles(tmp_path):
    triangle, mesh = reader("triangle"), plate()
    fm.write(mesh.domain, tmp_path / "plate.poly")
    theirs = triangle.load(str(tmp_path), "plate")
    assert theirs["vertices"].tolist() == mesh.domain.points.tolist()
    assert theirs["segments"].tolist() == mesh.domain.segments.tolist()
    fm.write(mesh, tmp_path / "fine.ele")
    theirs = triangle.load(str(tmp_path), "fine")
    assert theirs["vertices"].tolist() == mesh.points.tolist()
    assert theirs["triangles"].tolist() == mesh.triangles.tolist()
    assert theirs["triangle_attributes"].ravel().tolist() == mesh.regions.tolist()


# --- solvers of their own ---

PATCH = """*INCLUDE, INPUT=plate.inp
*MATERIAL, NAME=steel
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=steel, MATERIAL=steel
1.
*STEP
*STATIC
*BOUNDARY
{}
*EL PRINT, ELSET=steel
S
*END STEP
"""


def test_calculix_solves_on_our_sets(calculix, tmp_path):
    """Pulled by one part in a thousand, all triangles of our set have the stress 1."""
    fine = fm.refine(fm.disk(), max_area=0.05)
    mesh = fm.Mesh(fine.points, fine.triangles, regions=np.ones(len(fine.triangles), int), region_names=["", "steel"])
    fm.write(mesh, tmp_path / "plate.inp")
    pulled = [f"{v + 1},1,1,{1e-3 * mesh.points[v, 0]:.12f}\n{v + 1},2,2,0." for v in np.unique(fine.segments)]
    (tmp_path / "job.inp").write_text(PATCH.format("\n".join(pulled)))
    run = subprocess.run([calculix, "job"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "ERROR" not in run.stdout
    rows = [line.split() for line in (tmp_path / "job.dat").read_text().splitlines()]
    stress = {int(row[0]): float(row[2]) for row in rows if len(row) == 8 and row[0].isdigit()}
    assert sorted(stress) == list(range(1, len(mesh.triangles) + 1))
    assert np.allclose(list(stress.values()), 1, atol=1e-6)


WORDS = [("one-dimensional", 2), ("two-dimensional", 2), ("sets:", 1)]  # where its counts stand in what it says


def test_calculix_counts_our_lines_and_triangles(calculix, tmp_path):
    mesh = plate(["wall", "duct"])
    fm.write(mesh, tmp_path / "plate.inp")
    sections = "".join(f"*SOLID SECTION, ELSET={name}, MATERIAL=m\n1.\n" for name in ["wall", "duct", "interface", "steel"])
    text = "*INCLUDE, INPUT=plate.inp\n*MATERIAL, NAME=m\n*ELASTIC\n1000., 0.\n" + sections + "*STEP\n*NO ANALYSIS\n*END STEP\n"
    (tmp_path / "job.inp").write_text(text)
    said = subprocess.run([calculix, "job"], cwd=tmp_path, capture_output=True, text=True, check=False).stdout.split()
    lines, triangles, sets = (said[said.index(word) + ahead] for word, ahead in WORDS)
    assert (int(lines), int(triangles), int(sets)) == (len(mesh.segments), len(mesh.triangles), 4)


@pytest.mark.parametrize("regions", [True, False])
def test_dolfinx_finds_our_groups(regions, tmp_path):
    known = "import importlib.util, sys; sys.exit(not all(map(importlib.util.find_spec, ['dolfinx', 'gmsh'])))"
    if not Path(DEBIAN).exists() or subprocess.run([DEBIAN, "-c", known], check=False).returncode:
        pytest.skip("no DOLFINx on this machine (see dolfinx_reads.py)")
    mesh = plate(regions=regions)
    fm.write(mesh, tmp_path / "plate.msh")
    run = subprocess.run(
        [DEBIAN, HERE / "dolfinx_reads.py", "plate.msh"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    boundaries, named = kept(mesh)
    sizes = {name: len(rows) for name, rows in (named | boundaries).items()}
    sizes["no region"] = int((mesh.regions == 0).sum())
    first, *lines = [line for line in run.stdout.splitlines() if not line.startswith("Info")]
    assert first == f"{len(mesh.points)} points, {len(mesh.triangles)} triangles"
    assert sorted(lines) == sorted(f"{name}: {size}" for name, size in sizes.items())
