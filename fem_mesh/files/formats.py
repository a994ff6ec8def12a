"""Mesh files of other programs, through meshio; it is imported when it is first needed.

meshio prints, calls sys.exit, and reads some cut-off files for ever or as if they were whole: it is kept
quiet here, its complaints become MeshErrors, and a file is checked for its end before it is read.
"""

from __future__ import annotations

import contextlib
import io
import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.files.exchange import (
    from_meshio,
    to_meshio,
    triangles_only,
    with_arrays,
    with_plain_arrays,
    with_references,
    with_sets,
    with_tags,
)
from fem_mesh.mesh.mesh import Mesh

__all__ = ["FORMATS", "from_meshio", "read_mesh", "to_meshio", "what_is_lost", "write_mesh"]

LONGEST = 200  # characters of a complaint of meshio

THINGS: dict[str, Callable[[Mesh], Any]] = {  # what a file may lose, and whether a mesh has any
    "segments": lambda mesh: len(mesh.segments),
    "boundaries": lambda mesh: len(mesh.boundaries),
    "names of boundaries": lambda mesh: len(mesh.boundaries),
    "regions": lambda mesh: mesh.regions.any(),
    "names of regions": lambda mesh: any(mesh.region_names),
    "rows of the domain's segments (segment_of)": lambda mesh: (mesh.segment_of >= 0).any(),
    "merged points (merged_into)": lambda mesh: (mesh.merged_into != np.arange(len(mesh.points))).any(),
    "numbers of points": lambda mesh: len(mesh.points),
}
SEGMENTS, BOUNDARIES, BOUNDARY_NAMES, REGIONS, REGION_NAMES, SEGMENT_OF, MERGED, NUMBERS = THINGS
ALL_BUT_TRIANGLES = (SEGMENTS, BOUNDARIES, REGIONS, REGION_NAMES, SEGMENT_OF, MERGED)


@dataclass(frozen=True)
class Format:
    """How files of one ending are read and written.

    meshio : its name there
    prepare : the ``meshio.Mesh`` for the writer, and sentences on what it could not keep
    loses : what of ``THINGS`` it does not keep
    whole : a pattern in every whole file; its group, if it has one, is the number of cells
    writer, options : where it is written under another name, and how
    """

    meshio: str
    prepare: Callable[[Mesh], tuple[Any, list[str]]]
    loses: tuple[str, ...]
    whole: bytes = b""
    writer: str = ""
    options: dict[str, Any] = field(default_factory=dict)


WHOLE_VTK = rb"\A# vtk DataFile[^\n]*\n[^\n]*\n(?:(?!ASCII)|(?s:.*\n\Z))"  # text ends with its last line
ASCII = {"binary": False}  # Gmsh reads no other .vtk files, and VTK no cell arrays that meshio writes in version 5.1
BY_ABAQUS = {"float_fmt": "", "translate_cell_names": False}  # CalculiX takes 20 characters a number, so the shortest
XDMF = Format("xdmf", with_arrays, (MERGED,), options={"data_format": "XML"})
FORMATS = {
    ".msh": Format("gmsh", with_tags, (SEGMENT_OF, MERGED), rb"\$EndElements", "gmsh22", ASCII),
    ".vtu": Format("vtu", with_arrays, (MERGED,)),
    ".vtk": Format("vtk", with_plain_arrays, (MERGED,), WHOLE_VTK, "vtk42", ASCII),
    ".xdmf": XDMF,
    ".xmf": XDMF,
    ".inp": Format("abaqus", with_sets, (SEGMENT_OF, MERGED), options=BY_ABAQUS),
    ".mesh": Format("medit", with_references, (BOUNDARY_NAMES, REGION_NAMES, SEGMENT_OF, MERGED), rb"(?m)^\s*End\s*\Z"),
    ".off": Format("off", triangles_only, ALL_BUT_TRIANGLES, rb"(?m)^\s*\d+ +(\d+) +\d+"),
    ".obj": Format("obj", triangles_only, ALL_BUT_TRIANGLES),
    ".ply": Format("ply", triangles_only, ALL_BUT_TRIANGLES, rb"(?s)element face (\d+).*end_header"),
    ".stl": Format("stl", triangles_only, (*ALL_BUT_TRIANGLES, NUMBERS), rb"\A(?!\s*solid)|endsolid|\0"),
}


def read_mesh(path: Path) -> Mesh:
    """The mesh in a file, by its ending."""
    form = FORMATS[path.suffix.lower()]
    data = path.read_bytes()
    if not data.strip():
        raise MeshError(f"{path} is empty")
    whole = re.search(form.whole, data)
    if not whole:
        raise MeshError(f"{path} is no whole {path.suffix} file: is it cut off?")
    import meshio

    found = _quietly(path, "read", lambda: meshio.read(path, file_format=form.meshio))
    count = sum(len(block.data) for block in found.cells)
    if whole.lastindex and count != int(whole[1]):
        raise MeshError(f"{path}: {int(whole[1])} cells were announced, and {count} are there: is it cut off?")
    try:
        return from_meshio(found)
    except MeshError as error:
        raise MeshError(f"{path}: {error}") from None


def write_mesh(mesh: Mesh, path: Path) -> tuple[str, ...]:
    """Write a mesh to a file, by its ending; returns a sentence for each thing that it cannot keep."""
    form, ending = FORMATS[path.suffix.lower()], path.suffix
    if not len(mesh.triangles):
        raise MeshError(f"{path}: the mesh has no triangles, and a {ending} file is a list of cells; .node keeps its points")
    import meshio

    data, said = form.prepare(mesh)
    _quietly(path, "write", lambda: meshio.write(path, data, file_format=form.writer or form.meshio, **form.options))
    return (*what_is_lost(mesh, ending, form.loses), *said)


def what_is_lost(mesh: Mesh, ending: str, loses: tuple[str, ...]) -> tuple[str, ...]:
    """A sentence for each of ``loses`` that the mesh has."""
    return tuple(f"{thing}: {ending} files keep none" for thing in loses if THINGS[thing](mesh))


def _quietly(path: Path, verb: str, work: Callable[[], Any]) -> Any:
    """Call meshio: what it prints and raises becomes one MeshError."""
    printed = io.StringIO()
    try:
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return work()
    except OSError:
        raise
    except ImportError as error:
        raise MeshError(f"{path}: to {verb} it, meshio needs {error.name}: pip install {error.name}") from None
    except (Exception, SystemExit) as error:
        said = "" if isinstance(error, SystemExit) else f"{type(error).__name__}: {error}"
        complaint = " ".join((printed.getvalue() + " " + said).split())
        raise MeshError(f"{path}: meshio cannot {verb} it: {complaint[:LONGEST]}") from None
