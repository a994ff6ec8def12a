"""The text files of Triangle (Shewchuk 1996): .node holds points, .poly a domain, .ele triangles.

    .node   points, dimension 2, attributes, markers     then   point, x, y, attributes, marker
    .poly   as .node, or "0 2 0 0": the points are in the .node file of the same name; then
            segments, markers                            then   segment, start, end, marker
            holes                                        then   hole, x, y
            regions (may be missing)                     then   region, x, y, attribute, largest area
    .ele    triangles, corners 3, attributes             then   triangle, three points, attributes

All are numbered from 0, or all from 1. From # on a line is a comment. Names ride in comments, which
other programs skip: ``# name of boundary 2: "inlet"``. Numbers are written such that they are read back
to the last bit.
"""

from __future__ import annotations

import errno
import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fem_mesh.domain.domain import Domain
from fem_mesh.domain.loops import find_blocks
from fem_mesh.errors import MeshError
from fem_mesh.files.lines import Lines
from fem_mesh.files.names import name_number, number_names, number_regions
from fem_mesh.mesh.mesh import Mesh

MOST_ATTRIBUTES = 1000  # a header that says more is no header
FIRST_MARKER = 2  # Triangle itself gives 1 to boundary segments without a marker
NESTED = "loops nest by parity here, where Triangle fills all but the holes; give a seed in each hole"
NAMED = re.compile(r'\s*name of (boundary|region) (-?\d+): (".*")\s*')

# ---- reading ---------------------------------------------------------------------------------------


def read_node(path: Path) -> Domain:
    """The points of a .node file, as a domain without segments. Attributes and markers are left out."""
    lines = Lines(path)
    points, first = _read_points(lines)
    lines.check_end("the points")
    return _domain(path, first, points, np.empty((0, 2), np.int64))


def read_poly(path: Path) -> Domain:
    """The domain of a .poly file.

    Marker m becomes the name "boundary m", attribute a of a region its name "region a" (0 is no name),
    unless a comment has a name for it.
    """
    lines = Lines(path)
    points, first = _read_points(lines)
    if not len(points):
        points, first = _read_sibling(path)
    segments, markers = _read_segments(lines, len(points), first)
    holes = _read_holes(lines)
    areas = [] if lines.at_end() else _read_regions(lines)
    lines.check_end("the regions")
    boundary_names, region_names = _read_names(lines, "boundary"), _read_names(lines, "region")
    names = [name_number(marker, "boundary", boundary_names) for marker in markers.tolist()]
    regions = [(x, y, name_number(a, "region", region_names), None, area) for x, y, a, area in areas]
    domain = _domain(path, first, points, segments, holes, names=names, regions=regions)
    if not nests(domain):
        return domain
    return domain.reporting(f"{path} has loops within loops and no hole: {NESTED}")


def read_ele(path: Path) -> Mesh:
    """The mesh of an .ele file and the .node file beside it. The first attribute, if whole, is the region."""
    lines = Lines(path)
    at, header = lines.take_count("triangles", ("corners", "attributes"), least=1)
    count, corners, attributes = header + [3, 0][len(header) - 1 :]
    if corners != 3:
        raise lines.error(at, f"there are {corners} corners a cell, and fem_mesh meshes have triangles with 3")
    columns = ("triangle", "corner", "corner", "corner", *_attributes(lines, at, attributes))
    table, numbers = lines.take_table(count, "triangle", columns, len(columns))
    lines.check_end("the triangles")
    points, first = _read_sibling(path)
    _check_first(lines, first, lines.check_numbered(table[:, 0], numbers, "triangle"), numbers)
    triangles = _check_points(lines, table[:, 1:4], numbers, len(points), first)
    regions, note = table[:, 4] if attributes else np.zeros(count), ""
    if (regions != np.round(regions)).any() or (np.abs(regions) >= 2**31).any():
        regions, note = np.zeros(count), f"the attributes in {path} are no whole numbers: they are not its regions"
    given, names = number_regions(regions.astype(np.int64), _read_names(lines, "region"))
    try:
        return Mesh(points, triangles, regions=given, region_names=names, note=note)
    except MeshError as error:
        raise MeshError(f"{path}: {_counted(error, first)}") from None


def _read_points(lines: Lines) -> tuple[np.ndarray, int]:
    at, header = lines.take_count("points", ("dimension", "attributes", "markers"), least=1)
    count, dimension, attributes, markers = header + [2, 0, 0][len(header) - 1 :]
    if dimension != 2:
        raise lines.error(at, f"the dimension is {dimension}, and fem_mesh meshes the plane")
    columns = ("point", "x", "y", *_attributes(lines, at, attributes), *_markers(lines, at, markers))
    table, numbers = lines.take_table(count, "point", columns, len(columns))
    first = lines.check_numbered(table[:, 0], numbers, "point")
    return table[:, 1:3].copy(), first


def _read_sibling(path: Path) -> tuple[np.ndarray, int]:
    """The points of the .node file beside ``path``, and the number of the first."""
    beside = path.with_suffix(".NODE" if path.suffix.isupper() else ".node")
    try:
        lines = Lines(beside)
    except FileNotFoundError:
        raise FileNotFoundError(errno.ENOENT, f"{path} needs the points of a file that is not there", str(beside)) from None
    points, first = _read_points(lines)
    lines.check_end("the points")
    return points, first


def _read_segments(lines: Lines, n: int, first: int) -> tuple[np.ndarray, np.ndarray]:
    at, header = lines.take_count("segments", ("markers",))
    columns = ("segment", "start", "end", *_markers(lines, at, (*header, 0)[1]))
    table, numbers = lines.take_table(header[0], "segment", columns, len(columns))
    _check_first(lines, first, lines.check_numbered(table[:, 0], numbers, "segment"), numbers)
    segments = _check_points(lines, table[:, 1:3], numbers, n, first)
    markers = table[:, 3] if len(columns) > 3 else np.zeros(len(table))
    return segments, lines.check_whole(markers, numbers, "markers")


def _read_holes(lines: Lines) -> np.ndarray:
    _, (count,) = lines.take_count("holes")
    table, numbers = lines.take_table(count, "hole", ("hole", "x", "y"), 3)
    lines.check_numbered(table[:, 0], numbers, "hole")
    return table[:, 1:].copy()


def _read_regions(lines: Lines) -> list[tuple[float, float, float, float | None]]:
    """x, y, attribute and largest area of each; a largest area that is none, as Triangle's -1, is None."""
    _, (count,) = lines.take_count("regions")
    columns = ("region", "x", "y", "attribute", "largest area")
    table, numbers = lines.take_table(count, "region", columns, 4)
    lines.check_numbered(table[:, 0], numbers, "region")
    return [(x, y, attribute, area if area > 0 else None) for _, x, y, attribute, area in table.tolist()]


def _read_names(lines: Lines, word: str) -> dict[int, str]:
    """The names that comments give to numbers."""
    names = {}
    for match in filter(None, map(NAMED.fullmatch, lines.comments)):
        if match[1] == word:
            try:
                names[int(match[2])] = str(json.loads(match[3]))
            except ValueError:  # somebody's own comment
                continue
    return names


def _attributes(lines: Lines, at: int, count: int) -> tuple[str, ...]:
    if not 0 <= count <= MOST_ATTRIBUTES:
        raise lines.error(at, f"expected the number of attributes, 0 to {MOST_ATTRIBUTES}, found {count}")
    return ("attribute",) * count


def _markers(lines: Lines, at: int, count: int) -> tuple[str, ...]:
    if count not in (0, 1):
        raise lines.error(at, f"expected the number of markers, 0 or 1, found {count}")
    return ("marker",) * count


def _check_first(lines: Lines, first: int, own: int, numbers: list[int]) -> None:
    if numbers and own != first:
        raise lines.error(numbers[0], f"the numbers begin with {own} here, and with {first} for the points")


def _check_points(lines: Lines, table: np.ndarray, numbers: list[int], n: int, first: int) -> np.ndarray:
    """The points that ``table`` names, numbered from 0."""
    given = lines.check_whole(table, numbers, "points")
    wrong = (given < first) | (given >= first + n)
    for row in np.flatnonzero(wrong.any(axis=1))[:1]:
        there = f"points have the numbers {first} to {first + n - 1}" if n else "there are no points"
        raise lines.error(numbers[row], f"point {given[row][wrong[row]][0]} is not there: {there}")
    return given - first


def _domain(path: Path, first: int, *parts: Any, **named: Any) -> Domain:
    try:
        return Domain(*parts, **named)
    except MeshError as error:
        raise MeshError(f"{path}: {_counted(error, first)}") from None


def _counted(error: MeshError, first: int) -> str:
    return f"{error} (these numbers begin with 0, the file's with {first})" if first else str(error)


def nests(domain: Domain) -> bool:
    """Whether loops lie within the extent of others, and no seeds say which of them are holes."""
    pairs = domain.segments[domain.toggles]
    if len(domain.holes) or not len(pairs):
        return False
    block, count = find_blocks(pairs.astype(np.int64), len(domain.points))
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    for ends in (domain.points[pairs[:, 0]], domain.points[pairs[:, 1]]):
        np.minimum.at(low, block, ends)
        np.maximum.at(high, block, ends)
    order = np.lexsort((-high[:, 1], low[:, 1], -high[:, 0], low[:, 0]))  # what holds another comes before it
    low, high = low[order], high[order]
    for i in range(count):
        later = slice(i + 1, int(np.searchsorted(low[:, 0], high[i, 0], side="right")))
        if ((low[later, 1] >= low[i, 1]) & (high[later] <= high[i]).all(axis=1)).any():
            return True
    return False


# ---- writing ---------------------------------------------------------------------------------------


def write_node(points: np.ndarray, path: Path) -> None:
    """Write points to a .node file."""
    _write(path, _point_lines(points))


def write_poly(domain: Domain, path: Path) -> tuple[str, ...]:
    """Write a domain to a .poly file; returns a sentence for each thing that it cannot keep."""
    numbers = number_names(domain.names, "boundary", FIRST_MARKER)
    region_numbers = number_names((region.name for region in domain.regions), "region", 1)
    if not len(domain.points):
        raise MeshError(f"{path}: the domain has no points, and 0 points in a .poly file stand for those of a .node file")
    rows, parity = _rows(domain)
    ends, marked = domain.segments.tolist(), int(bool(numbers))
    lines = _point_lines(domain.points)
    lines += [f"{len(rows)} {marked}"]
    for i, row in enumerate(rows.tolist()):
        marker = f" {numbers.get(domain.names[row], 0)}" if marked else ""
        lines.append(f"{i} {ends[row][0]} {ends[row][1]}{marker}")
    lines += [f"{len(domain.holes)}", *(f"{i} {x!r} {y!r}" for i, (x, y) in enumerate(domain.holes.tolist()))]
    if domain.regions:
        lines.append(f"{len(domain.regions)}")
        for i, region in enumerate(domain.regions):
            area = -1 if region.max_area is None else float(region.max_area)
            lines.append(f"{i} {region.x!r} {region.y!r} {region_numbers.get(region.name, 0)} {area!r}")
    _write(path, [*lines, *_name_lines("boundary", numbers), *_name_lines("region", region_numbers)])
    return (*_lost(domain), *(parity if not len(domain.holes) else []))


def write_ele(mesh: Mesh, path: Path) -> None:
    """Write triangles and regions to an .ele file, and the points to the .node file beside it."""
    names = {k: name for k, name in enumerate(mesh.region_names) if k and name}
    with_regions = bool(mesh.regions.any() or names)
    lines = [f"{len(mesh.triangles)} 3 {int(with_regions)}"]
    for t, ((a, b, c), region) in enumerate(zip(mesh.triangles.tolist(), mesh.regions.tolist(), strict=True)):
        lines.append(f"{t} {a} {b} {c} {region}" if with_regions else f"{t} {a} {b} {c}")
    _write(path, lines + [_name_line("region", number, name) for number, name in names.items()])
    write_node(mesh.points, path.with_suffix(".NODE" if path.suffix.isupper() else ".node"))


def _point_lines(points: np.ndarray) -> list[str]:
    return [f"{len(points)} 2 0 0", *(f"{i} {x!r} {y!r}" for i, (x, y) in enumerate(points.tolist()))]


def _rows(domain: Domain) -> tuple[np.ndarray, list[str]]:
    """Rows of the segments to write: those that do not toggle twice, if once they would; and what that cannot mend."""
    once = np.arange(len(domain.segments))
    for rows in (once, np.repeat(once, np.where(domain.toggles, 1, 2))):
        again = Domain(domain.points, domain.segments[rows])
        if np.array_equal(again.toggles, domain.toggles):
            return rows, []
    a, b = domain.segments[np.flatnonzero(again.toggles != domain.toggles)[0]].tolist()
    return once, [f"parity: loops that close where segments cross, as along {a}-{b}, will count; give a seed in each hole"]


def _lost(domain: Domain) -> tuple[str, ...]:
    sized = [region.name for region in domain.regions if region.size is not None]
    lost = [f"curves: .poly keeps the chords of {len(domain.curves)} segments only"] if domain.curves else []
    lost += [f"holes: .poly keeps seeds only, and there are none: {NESTED}"] if nests(domain) else []
    lost += [f"sizes: .poly keeps no longest edge for region {sized[0]!r}; max_area is kept"] if sized else []
    return tuple(lost)


def _name_lines(word: str, numbers: Mapping[str, int]) -> Iterable[str]:
    return (_name_line(word, number, name) for name, number in numbers.items() if name != f"{word} {number}")


def _name_line(word: str, number: int, name: str) -> str:
    return f"# name of {word} {number}: {json.dumps(name)}"


def _write(path: Path, lines: Iterable[str]) -> None:
    path.write_text("\n".join([*lines, ""]), encoding="ascii", newline="\n")
