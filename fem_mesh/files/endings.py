"""Reading and writing: the ending of a file's name says what it is."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fem_mesh.domain.domain import Domain
from fem_mesh.errors import MeshError
from fem_mesh.files import formats, triangle_format
from fem_mesh.mesh.mesh import Mesh

READERS: dict[str, Callable[[Path], Any]] = {
    ".node": triangle_format.read_node,
    ".poly": triangle_format.read_poly,
    ".ele": triangle_format.read_ele,
    **dict.fromkeys(formats.FORMATS, formats.read_mesh),
}
ELE_LOSES = (formats.SEGMENTS, formats.BOUNDARIES, formats.SEGMENT_OF, formats.MERGED)


def read(path: str | os.PathLike[str]) -> Domain | Mesh:
    """What the file ``path`` holds: a Domain in .poly and .node, a Mesh in all others.

    .poly, .node : the domain or points for Triangle; marker 3 of a segment becomes its name "boundary 3"
    .ele : triangles from Triangle, their points in the .node file beside it; the first attribute is the region
    .msh, .vtu, .vtk, .xdmf, .inp, .mesh, .off, .obj, .ply, .stl : by meshio. Lines are the mesh's segments,
        sets or numbers of lines its boundaries, sets or numbers of triangles its regions

    Raises MeshError that names the file, and the line where there are lines, if it is cut off or wrong,
    is not flat, or holds cells that are no triangles; FileNotFoundError if it is not there.

    >>> import pathlib, tempfile
    >>> path = pathlib.Path(tempfile.mkdtemp(), "corner.poly")
    >>> _ = path.write_text("3 2 0 0\\n 1 0 0\\n 2 1 0\\n 3 0 1\\n 3 1\\n 1 1 2 7\\n 2 2 3 7\\n 3 3 1 7\\n 0\\n")
    >>> read(path)
    Domain: 3 points, 3 segments (boundary 7)
    """
    path = Path(path)
    if path.suffix.lower() not in READERS:
        raise MeshError(f"{path}: fem_mesh reads {', '.join(READERS)}, not {_ending(path)}; {_hint('from_meshio')}")
    found: Domain | Mesh = READERS[path.suffix.lower()](path)
    return found


def write(thing: Domain | Mesh, path: str | os.PathLike[str]) -> tuple[str, ...]:
    """Write a Mesh, or a Domain (.poly and .node only), to the file ``path``, whose ending decides (see ``read``).

    Returns a sentence for each thing that such files cannot keep, () if there is none. Coordinates are
    kept to the last bit. An .ele file gets a .node file beside it. What is kept of a Mesh, there and back:

    file, method           points    segments   boundaries     regions    segment_of
    .vtu .vtk .xdmf .xmf   all       all        names          names      all
    .msh                   all       all        first name     names      none
    .inp                   all       all        words          words      none
    .mesh                  all       all        first number   numbers    none
    .ele                   all       none       none           names      none
    .off .obj .ply         all       none       none           none       none
    .stl                   corners   none       none           none       none
    to_meshio              all       all        names          names      none
    to_skfem               used      named      names          names      none
    to_matplotlib          all       none       none           none       none

    first : a segment in several boundaries is kept in the first of them
    words : names as single words, "hole 0" as "hole_0"; numbers of regions may change
    corners : each triangle's own, which are merged when read; used : those of triangles, numbered anew

    In .msh names are physical groups (triangles without a region are in the group "no region", since some
    programs leave out what is in no group), in .inp sets, in .vtu, .vtk and .xdmf an array of 0 and 1 over the
    cells for each, "boundary: hole 0". The domain, its curves and ``merged_into`` are in no file.

    >>> import pathlib, tempfile
    >>> import fem_mesh as fm
    >>> mesh = fm.delaunay([(0, 0), (1, 0), (0, 0.1)])
    >>> path = pathlib.Path(tempfile.mkdtemp(), "corner.ele")
    >>> write(mesh, path)
    ()
    >>> (read(path).points == mesh.points).all()
    np.True_
    """
    path = Path(path)
    ending = path.suffix.lower()
    if not isinstance(thing, Domain | Mesh):
        raise MeshError(f"write takes a Mesh or a Domain, not {type(thing).__name__}")
    if ending not in READERS:
        raise MeshError(f"{path}: fem_mesh writes {', '.join(READERS)}, not {_ending(path)}; {_hint('to_meshio')}")
    if ending == ".node":
        return _write_points(thing, path)
    if isinstance(thing, Domain):
        if ending != ".poly":
            raise MeshError(f"{path}: a Domain is written as .poly; to write it as {ending}, mesh it first")
        return triangle_format.write_poly(thing, path)
    if ending == ".poly":
        raise MeshError(f"{path}: .poly files hold domains, and a Mesh is written as .ele, .msh, ...")
    if ending == ".ele":
        triangle_format.write_ele(thing, path)
        return formats.what_is_lost(thing, ending, ELE_LOSES)
    return formats.write_mesh(thing, path)


def _write_points(thing: Domain | Mesh, path: Path) -> tuple[str, ...]:
    triangle_format.write_node(thing.points, path)
    rest = thing.segments if isinstance(thing, Domain) else thing.triangles
    kind = "segments" if isinstance(thing, Domain) else "triangles"
    return (f"{kind} and all else: .node files keep points only",) if len(rest) else ()


def _ending(path: Path) -> str:
    return path.suffix or "files without an ending"


def _hint(verb: str) -> str:
    return f"for other files, {verb} of fem_mesh.files.formats exchanges meshes with meshio itself"
