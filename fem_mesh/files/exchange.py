"""Between a Mesh and meshio's: cells, and names in the several ways in which files hold them.

arrays  a 0/1 array over all cells for each name, "boundary: inlet", "region 2: steel" (.vtu, .vtk, .xdmf)
tags    a number for each cell, "gmsh:physical", and a name for each number (.msh): a physical group
sets    lists of cells, by name (.inp)
"""

from __future__ import annotations

import re
import urllib.parse
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.files.names import name_number, name_regions, number_names, number_regions, number_sets
from fem_mesh.mesh.mesh import Mesh

if TYPE_CHECKING:
    import meshio

NOTHING = "(?!)"  # the pattern that no name has
TAGS = ("regions", "gmsh:physical", "medit:ref")  # arrays of numbers of regions, the first there is
NO_REGION = "no region"  # the group in .msh of triangles without one: FEniCS leaves out what is in no group
UNSAFE = re.compile(r"[^!#$'()*+,\-./0-9:;=?@A-Z\[\]^_`a-z{|}~]")  # in the name of an array, percent-encoded
UNSAFE_IN_XML = re.compile(r"[\"%&<>\x00-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
ABAQUS = {"line": "T3D2", "triangle": "CPS3"}  # as Gmsh writes them
LONGEST = 20  # characters of a number there
ARRAY = re.compile(r"(?s)(boundary|region (\d+)): (.*)")
IGNORED = ("vertex", "line", "triangle")  # cells that make no complaint


# ---- to meshio -------------------------------------------------------------------------------------


def to_meshio(mesh: Mesh) -> meshio.Mesh:
    """The mesh as a ``meshio.Mesh``: points (n, 3) with z = 0, lines for its segments, triangles.

    Boundaries and regions are its ``cell_sets``, and also its "gmsh:physical" numbers with their names in
    ``field_data``; ``cell_data["regions"]`` has the regions.
    """
    return with_names(mesh)[0]


def with_names(
    mesh: Mesh, forbidden: str = NOTHING, reserved: Iterable[str] = (), all_regions: bool = False
) -> tuple[Any, list[str]]:
    """``to_meshio(mesh)``, its names different from each other, none of them ``reserved``, without ``forbidden``
    characters; and what that changed. With ``all_regions`` those without a name are "region 7".
    """
    import meshio

    k = len(mesh.segments)
    given = [rows for name, rows in mesh.boundaries.items() if name]
    region_names = name_regions(mesh.region_names, mesh.regions) if all_regions else mesh.region_names
    fitted, said = _fit([*filter(None, mesh.boundaries), *region_names], forbidden, reserved)
    boundaries, regions = fitted[: len(given)], fitted[len(given) :]
    numbers = number_names(boundaries, "boundary", 1)
    sets = {name: [rows, np.empty(0, np.int32)] for name, rows in zip(boundaries, given, strict=True)}
    tags, times = np.zeros(k, np.int32), np.zeros(k, np.int32)
    for name in boundaries[::-1]:  # the first wins
        tags[sets[name][0]] = numbers[name]
        times[sets[name][0]] += 1
    said += [f"segment {s} is in {times[s]} boundaries, and is kept in the first" for s in np.flatnonzero(times > 1)[:1]]
    names = {name: np.array([number, 1]) for name, number in numbers.items()}
    for r, name in enumerate(regions):
        if r and name:
            sets[name] = [np.empty(0, np.int32), np.flatnonzero(mesh.regions == r).astype(np.int32)]
            names[name] = np.array([r, 2])
    cells = [("line", mesh.segments), ("triangle", mesh.triangles)]
    data = {
        "regions": [np.zeros(k, np.int32), mesh.regions],
        "gmsh:physical": [tags, mesh.regions],
        "gmsh:geometrical": [tags + 1, mesh.regions + np.int32(1)],
    }
    first = 0 if k else 1  # no empty block of lines
    return meshio.Mesh(
        np.column_stack([mesh.points, np.zeros(len(mesh.points))]),
        cells[first:],
        cell_data={key: [np.array(values) for values in blocks[first:]] for key, blocks in data.items()},
        field_data=names,
        cell_sets={name: [np.array(rows) for rows in blocks[first:]] for name, blocks in sets.items()},
    ), said


def with_tags(mesh: Mesh) -> tuple[Any, list[str]]:
    """As the .msh files of Gmsh have it: triangles without a region are in a group of their own."""
    data, said = with_names(mesh, r'["\\\x00-\x1f\x7f\ud800-\udfff]', [NO_REGION])
    tags = data.cell_data["gmsh:physical"][-1]
    if not tags.all():
        free = max(len(mesh.region_names), int(tags.max()) + 1)
        tags[tags == 0] = free
        data.field_data[NO_REGION] = np.array([free, 2])
    del data.cell_data["regions"]
    data.cell_sets = {}
    return data, said


def with_references(mesh: Mesh) -> tuple[Any, list[str]]:
    """As Medit has it: a number for each cell, and no names."""
    data, said = with_names(mesh)
    data.cell_data = {"medit:ref": data.cell_data["gmsh:physical"]}
    data.cell_sets, data.field_data = {}, {}
    return data, [sentence for sentence in said if sentence.startswith("segment")]


def with_sets(mesh: Mesh) -> tuple[Any, list[str]]:
    """As Abaqus has it: sets of cells, whose names are single words; and its own words for types of cells."""
    data, said = with_names(mesh, r"[^A-Za-z0-9_.-]", all_regions=True)
    for block in data.cells:
        block.type = ABAQUS[block.type]
    data.cell_data, data.field_data = {}, {}
    said = [sentence for sentence in said if not sentence.startswith("segment")]
    short = np.reshape([_shorten(x) for x in data.points.ravel().tolist()], data.points.shape)
    rounded = int((short != data.points).any(axis=1).sum())
    data.points = short
    return data, said + [f"coordinates of {rounded:,} points are rounded to {LONGEST} characters each"] * (rounded > 0)


def with_arrays(mesh: Mesh, unsafe: re.Pattern[str] = UNSAFE_IN_XML) -> tuple[Any, list[str]]:
    """As VTK has it: arrays over the cells. In their names ``unsafe`` characters are percent-encoded."""
    data, _ = with_names(mesh)
    k, m = len(mesh.segments), len(mesh.triangles)
    arrays = {"regions": [np.zeros(k, np.int32), mesh.regions]}
    if (mesh.segment_of >= 0).any():
        arrays["segment_of"] = [mesh.segment_of, np.full(m, -1, np.int32)]
    for name, rows in mesh.boundaries.items():
        arrays[f"boundary: {name}"] = [np.isin(np.arange(k), rows).astype(np.int32), np.zeros(m, np.int32)]
    for r, name in enumerate(mesh.region_names):
        if r and name:
            arrays[f"region {r}: {name}"] = [np.zeros(k, np.int32), (mesh.regions == r).astype(np.int32)]
    quoted = {unsafe.sub(_percent, name): blocks for name, blocks in arrays.items()}
    data.cell_data = {name: [np.array(values) for values in blocks[0 if k else 1 :]] for name, blocks in quoted.items()}
    data.cell_sets, data.field_data = {}, {}
    return data, []


def with_plain_arrays(mesh: Mesh) -> tuple[Any, list[str]]:
    """The same for the older .vtk files, in which names are single words; VTK decodes them."""
    return with_arrays(mesh, UNSAFE)


def triangles_only(mesh: Mesh) -> tuple[Any, list[str]]:
    import meshio

    return meshio.Mesh(np.column_stack([mesh.points, np.zeros(len(mesh.points))]), [("triangle", mesh.triangles)]), []


def _fit(names: list[str], forbidden: str, reserved: Iterable[str]) -> tuple[list[str], list[str]]:
    fitted: list[str] = []
    taken = set(reserved)
    for name in names:
        clean = re.sub(forbidden, "_", name)
        more = (f"{clean}_{i}" for i in range(2, len(names) + len(taken) + 2))
        fitted.append(next(new for new in (clean, *more) if not new or new not in taken))
        taken.add(fitted[-1])
    changed = zip(names, fitted, strict=True)
    return fitted, [f"the name {name!r} is written as {new!r}" for name, new in changed if name != new]


def _shorten(x: float) -> float:
    """The nearest number, or nearly, that takes ``LONGEST`` characters."""
    if len(repr(x)) <= LONGEST:
        return x
    return next(y for digits in range(15, 0, -1) if len(repr(y := float(f"{x:.{digits}e}"))) <= LONGEST)


def _percent(match: re.Match[str]) -> str:
    return urllib.parse.quote(match[0], errors="surrogatepass")


# ---- from meshio -----------------------------------------------------------------------------------


def from_meshio(data: meshio.Mesh) -> Mesh:
    """The mesh that a ``meshio.Mesh`` holds: its triangles, and its lines as segments.

    Sets of lines become boundaries, numbers or sets of triangles become regions. Raises MeshError where
    there are cells of other types, no triangles, or points that do not lie in one plane z = constant.
    """
    for block in data.cells:
        if block.type not in IGNORED and len(block.data):
            raise MeshError(f"it holds {len(block.data):,} cells of type {block.type!r}, and a Mesh has triangles only")
    triangles, segments = (_cells(data, kind, corners) for kind, corners in (("triangle", 3), ("line", 2)))
    if not len(triangles):
        raise MeshError("it holds no triangles")
    arrays, sets = _arrays(data), _sets(data)
    regions, names, note = _regions(data, arrays, sets, len(triangles))
    segment_of = _whole(data, "segment_of", "line", len(segments))
    return Mesh(
        _flat(np.asarray(data.points)),
        triangles,
        segments=segments,
        segment_of=segment_of,
        boundaries=_boundaries(data, arrays, sets, len(segments)),
        regions=regions,
        region_names=names,
        note=note,
    )


def _flat(points: np.ndarray) -> np.ndarray:
    """Points (n, 2) from points (n, 3) of one z."""
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise MeshError(f"its points have the shape {points.shape}, and must be (n, 2), or (n, 3) with one z")
    if points.shape[1] == 3:
        for v in np.flatnonzero(points[:, 2] != points[0, 2])[:1]:
            place, z = tuple(points[v].tolist()), points[0, 2].item()
            raise MeshError(f"it is not flat: point {v} at {place} has another z than point 0, which has {z}; project it first")
    flat = np.empty((len(points), 2))  # of this machine's own type, whatever the file's byte order
    flat[:] = points[:, :2]
    return flat


def _cells(data: Any, kind: str, corners: int) -> np.ndarray:
    blocks = [np.asarray(block.data) for block in data.cells if block.type == kind and len(block.data)]
    return np.concatenate([np.empty((0, corners), np.int64), *(block.astype(np.int64) for block in blocks)])


def _whole(data: Any, key: str, kind: str, count: int) -> np.ndarray | None:
    """The array ``key`` over the cells of one kind, if there is one, of whole numbers."""
    if key not in data.cell_data:
        return None
    blocks = zip(data.cells, data.cell_data[key], strict=True)
    parts = [np.asarray(values) for block, values in blocks if block.type == kind and len(block.data)]
    if any(part.ndim != 1 or part.dtype.kind not in "iuf" for part in parts):
        return None
    values = np.concatenate([np.empty(0), *parts])
    if len(values) != count or (values != np.round(values)).any() or (np.abs(values) >= 2**31).any():
        return None
    return values.astype(np.int64)


def _arrays(data: Any) -> dict[str, str]:
    """The arrays over the cells, by what ``with_arrays`` calls them."""
    return {urllib.parse.unquote(key, errors="surrogatepass"): key for key in data.cell_data}


def _sets(data: Any) -> dict[str, dict[str, np.ndarray]]:
    """For each name the lines and the triangles in its set, by their row among all lines, all triangles."""
    found = {}
    for name, blocks in data.cell_sets.items():
        if not name or name.startswith("gmsh:"):
            continue
        rows: dict[str, list[Any]] = {"line": [], "triangle": []}
        offset = dict.fromkeys(rows, 0)
        for block, members in zip(data.cells, blocks, strict=False):
            if block.type in rows:
                rows[block.type].append(offset[block.type] + np.asarray([] if members is None else members, np.int64))
                offset[block.type] += len(block.data)
        found[name] = {kind: np.concatenate([np.empty(0, np.int64), *parts]) for kind, parts in rows.items()}
    return found


def _physical_names(data: Any, dimension: int) -> dict[int, str]:
    return {number: name for name, number, of in _field_data(data) if of == dimension}


def _field_data(data: Any) -> Iterator[tuple[str, int, int]]:
    for name, value in data.field_data.items():
        value = np.asarray(value)
        if value.shape == (2,) and value.dtype.kind in "iu":
            yield name, int(value[0]), int(value[1])


def _boundaries(data: Any, arrays: dict[str, str], sets: Any, k: int) -> dict[str, np.ndarray]:
    """From our arrays, else from sets, else from the numbers of lines."""
    found = {}
    for array, key in arrays.items():
        match = ARRAY.fullmatch(array)
        if match and match[1] == "boundary":
            flags = _whole(data, key, "line", k)
            found[match[3]] = np.flatnonzero(np.zeros(0) if flags is None else flags)
    names = _physical_names(data, 1)
    for name, rows in sets.items() if not found else ():
        if len(rows["line"]) or name in names.values():
            found[name] = rows["line"]
    for tags in (_whole(data, key, "line", k) for key in TAGS[1:] if not found):
        if tags is not None:
            numbers = sorted({*tags.tolist(), *names} - {0})
            found.update({name_number(number, "boundary", names): np.flatnonzero(tags == number) for number in numbers})
    return found


def _regions(data: Any, arrays: dict[str, str], sets: Any, m: int) -> tuple[np.ndarray, tuple[str, ...], str]:
    """Regions, their names and a note: from numbers of triangles, else from sets."""
    names = _physical_names(data, 2)
    names.update({int(match[2]): match[3] for match in map(ARRAY.fullmatch, arrays) if match and match[2]})
    for key in TAGS:
        tags = _whole(data, key, "triangle", m)
        if tags is not None:
            for number in [number for number, name in names.items() if name == NO_REGION]:
                tags[tags == number] = 0
                del names[number]
            return *number_regions(tags, names), ""
    return number_sets({name: rows["triangle"] for name, rows in sets.items() if len(rows["triangle"])}, m)
