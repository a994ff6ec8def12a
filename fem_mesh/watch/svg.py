"""A step as SVG: the still picture where no script runs. The same layers and the same roles as everywhere."""

from __future__ import annotations

import html
import math
import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import numpy as np

from fem_mesh.mesh.points import view_box
from fem_mesh.watch.layers import CORE, HOLLOW, Layer, layers_of, layers_of_mesh, legend_of, rings_of
from fem_mesh.watch.paths import FAR, NEAR, SHAPES, Box, View, closed, line, trails
from fem_mesh.watch.style import INK, PAPER, ROLES, color_of

if TYPE_CHECKING:
    from fem_mesh.mesh.mesh import Mesh
    from fem_mesh.trace import Trace

# All lengths on the page are whole tenths of a pixel.
POINT = 40 / 3  # 1/72 inch
FOOT = 50  # between view and legend
MOST_SHOWN = 2_000  # triangles
MOST_RINGS, CELL = 1_000, 120  # with more of them, one stands for all in a square of this side
LETTER = 130  # a word's size
NARROW, WIDE = frozenset(" :fijlrt"), frozenset("mw")
ROW = 230  # of the legend
SAMPLE, MARK, GAP = 260, 150, 170  # in the legend: the width of a role's sample, of a marker's, the space after its word
TILE = 100  # of a hatch
DOTS = "M25 25h0m50 50h0"
STROKES = "M-10 10l20-20M0 100l100-100M90 110l20-20"

NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # characters that no XML may have


def svg_of_step(trace: Trace, k: int, *, dark: bool = False, width: int = 640) -> str:
    """Step ``k`` of a trace as an SVG image ``width`` pixels wide; the same text in every process.

    >>> import fem_mesh as fm
    >>> trace = fm.record(fm.bowyer_watson([(0, 0), (4, 0), (0, 3), (3, 2)]))
    >>> svg_of_step(trace, 2, width=400)[:52]
    "<svg xmlns='http://www.w3.org/2000/svg' width='400' "

    Of a large mesh it shows a part, around what the step is about.
    """
    k = range(len(trace))[k]
    layers = layers_of(trace, k)
    box, legend = trace.view_box(), legend_of(layers)
    title = f"step {k} of {len(trace) - 1}, {trace[k].kind}: {trace[k].caption}"
    for layer in layers:
        if layer.role == "mesh" and len(layer.places) > MOST_SHOWN:
            box = _box_around(trace[k].point, layer.places)
            return svg_of_layers(layers, legend, box, f"{title} (a part of it)", dark=dark, width=width)
    return svg_of_layers(layers, legend, box, title, dark=dark, width=width)


def _box_around(point: Any, triangles: np.ndarray) -> Box:
    """A view of some MOST_SHOWN of the triangles, around a point or in the middle."""
    middles = triangles.mean(axis=1)
    x, y = np.median(middles, axis=0) if point is None else point
    away = np.abs((middles - (x, y)) / (SHAPES[0], 1)).max(axis=1)
    reach = float(np.partition(away, MOST_SHOWN)[MOST_SHOWN])
    return x - SHAPES[0] * reach, x + SHAPES[0] * reach, y - reach, y + reach


def svg_of_layers(
    layers: Iterable[Layer], legend: Iterable[str], box: Box, title: str, *, dark: bool = False, width: int = 640
) -> str:
    """Layers in a view box as an SVG image, each above those before it; below it the words of the roles in ``legend``.

    Markers are dots or rings.
    """
    view = View(box, 10 * width)
    fills, rest = [], []
    for layer in layers:
        fills.append(_fill(view, layer, dark))
        rest.append(f"<g data-role='{layer.role}'{_look(layer, dark)}>{DRAW[layer.what](view, layer, dark)}</g>")
    words, rows = _legend(legend, view, dark)
    height = view.height + FOOT + ROW * max(rows, 1)
    body = "".join([*fills, *rest])
    names = [name for name in ROLES if f"url(#{_id(name, dark)})" in body + words]
    return "\n".join(
        [
            f"<svg xmlns='http://www.w3.org/2000/svg' width='{width}' height='{height // 10}' viewBox='0 0 {10 * width} "
            f"{height}' role='img' font-family='system-ui,sans-serif' font-size='{LETTER}' stroke-linejoin='round'>",
            f"<title>{_escape(title)}</title>",
            "<defs>" + "".join(_definition(name, dark) for name in names) + "</defs>",
            f"<rect width='100%' height='100%' fill='{PAPER[dark]}'/>",
            f"<svg width='{view.width}' height='{view.height}' fill='none'>{body}</svg>",
            f"<g data-role='legend' fill='none'>{words}</g>",
            "</svg>",
        ]
    )


def svg_of_mesh(mesh: Mesh, title: str, **options: Any) -> str:
    """A mesh as an SVG image, or "" if there is nothing to see; ``options`` are those of ``layers_of_mesh``."""
    if not len(mesh.points):
        return ""
    layers = layers_of_mesh(mesh, **options)
    return svg_of_layers(layers, legend_of(layers), view_box(mesh.points), title)


def data_uri(svg: str) -> str:
    """An SVG image as an address to write between double quotes: ``<img src="...">``.

    >>> data_uri("<svg id='a'>1 &lt; 2</svg>")
    "data:image/svg+xml,%3Csvg id='a'%3E1 %26lt; 2%3C/svg%3E"
    """
    return "data:image/svg+xml," + quote(svg, safe=" !$'()*+,/:;=?@[]|~")


def _escape(text: str) -> str:
    return html.escape(NO_XML.sub("", text), quote=False)


# ---- the shapes of a layer, in the look that is set around them -----------------------------------------


def _fill(view: View, layer: Layer, dark: bool) -> str:
    """The fill of polygons: below the outlines of all."""
    role = ROLES[layer.role]
    if layer.what != "polygons" or not role.fill:
        return ""
    color = color_of(layer.role, dark)
    return f"<path fill='{color}' fill-opacity='{role.fill:g}' d='{closed(view.shapes(layer.places, True))}'/>"


def _polygons(view: View, layer: Layer, dark: bool) -> str:
    if layer.role == "mesh":  # each edge once
        sides = np.concatenate([layer.places[:, [i, (i + 1) % 3]] for i in range(3)])
        return f"<path d='{trails(view.shapes(sides, False))}'/>"
    hatch = f" fill='url(#{_id(layer.role, dark)})'" if ROLES[layer.role].hatch else ""
    return f"<path{hatch} d='{closed(view.shapes(layer.places, True))}'/>"


def _lines(view: View, layer: Layer, dark: bool) -> str:
    lines = view.shapes(layer.places, False)
    if ROLES[layer.role].dash:  # each begins with a dash
        return f"<path d='{''.join(map(line, lines))}'/>"
    return f"<path stroke-linecap='round' d='{trails(lines)}'/>"


def _circles(view: View, layer: Layer, dark: bool) -> str:
    reach = math.hypot(*view.center)
    with np.errstate(over="ignore", invalid="ignore"):
        circles = np.column_stack([view.place(layer.places[:, :2]), view.scale * layer.places[:, 2]])
        away = np.hypot(*(circles[:, :2] - view.center).T)
        near = np.abs(away - circles[:, 2]) < reach + NEAR
    whole, arcs = rings_of(circles[near], view.center, reach)
    shapes = [f"<circle cx='{x}' cy='{y}' r='{r}'/>" for x, y, r in np.rint(whole).astype(int).tolist()]
    for arc in arcs:  # flat ones: parabolas to the eye
        if not np.abs(arc).max() < FAR:  # its place is lost in rounding
            continue
        begin, top, end = arc[:: len(arc) // 2]
        x, y, bx, by, ex, ey = np.rint([*begin, *(2 * top - (begin + end) / 2), *end]).astype(int).tolist()
        shapes.append(f"<path d='M{x} {y}Q{bx} {by} {ex} {ey}'/>")
    return "".join(shapes)


def _markers(view: View, layer: Layer, dark: bool) -> str:
    places = view.dots(layer.places)[0].tolist()
    if layer.role == "point":
        return "".join(_target(x, y, layer, dark) for x, y in places)
    if layer.role not in HOLLOW:
        return f"<path stroke-linecap='round' d='{''.join(f'M{x} {y}h0' for x, y in places)}'/>"
    if len(places) > MOST_RINGS:
        places = list({(x // CELL, y // CELL): (x, y) for x, y in places}.values())
    if not places:
        return ""
    mark = f"url(#{_id(layer.role, dark)})"
    corners = " ".join(f"{x} {y}" for x, y in [places[0], *places])  # the first corner has no mark
    return f"<path stroke='none' marker-mid='{mark}' marker-end='{mark}' d='M{corners}'/>"


def _texts(view: View, layer: Layer, dark: bool) -> str:
    places, which = view.dots(layer.places)
    words = [_escape(layer.words[i]) for i in which]
    look = f"fill='{INK[dark]}' stroke='{PAPER[dark]}' stroke-opacity='.7' stroke-width='40' paint-order='stroke'"
    texts = [f"<text x='{x + 65}' y='{y - 55}'>{word}</text>" for (x, y), word in zip(places, words, strict=True)]
    return f"<g {look}>{''.join(texts)}</g>"


DRAW = {"polygons": _polygons, "lines": _lines, "circles": _circles, "markers": _markers, "texts": _texts}


# ---- looks ---------------------------------------------------------------------------------------------


def _look(layer: Layer, dark: bool) -> str:
    """The colour, width and dashes of a layer's lines."""
    role = ROLES[layer.role]
    if layer.what == "texts":
        return ""
    dotted = layer.what == "markers" and layer.role not in HOLLOW  # a dot is a line without length
    width = POINT * (layer.width + layer.size if dotted else layer.width)
    dashes = " ".join(str(round(width * length)) for length in role.dash)
    dash = f" stroke-dasharray='{dashes}'" if dashes else ""
    return f" stroke='{color_of(layer.role, dark)}' stroke-width='{round(width)}'{dash}"


def _target(x: int, y: int, layer: Layer, dark: bool) -> str:
    dot = f"<circle cx='{x}' cy='{y}' r='{round(POINT * CORE / 2)}' fill='{color_of(layer.role, dark)}' stroke='none'/>"
    return f"<circle cx='{x}' cy='{y}' r='{round(POINT * layer.size / 2)}'/>{dot}"


def _id(name: str, dark: bool) -> str:
    return f"fem-{name}-{'dark' if dark else 'light'}"


def _definition(name: str, dark: bool) -> str:
    """A role's hatch, or its ring."""
    role, color = ROLES[name], color_of(name, dark)
    if role.marker:
        r, width = round(POINT * role.size / 2), round(POINT * role.width)
        ring = f"<circle r='{r}' fill='none' stroke='{color}' stroke-width='{width}'/>"
        return f"<marker id='{_id(name, dark)}' markerUnits='userSpaceOnUse' overflow='visible'>{ring}</marker>"
    dots = "." in role.hatch
    look = f"stroke='{color}' stroke-width='{24 if dots else 11}' stroke-linecap='round'"
    tile = f"width='{TILE}' height='{TILE}' patternUnits='userSpaceOnUse'"
    return f"<pattern id='{_id(name, dark)}' {tile}><path {look} d='{DOTS if dots else STROKES}'/></pattern>"


def _legend(names: Iterable[str], view: View, dark: bool) -> tuple[str, int]:
    """A sample and the word of each role, in as many rows as they need."""
    rows: list[list[str]] = [[]]
    for name in names:
        if rows[-1] and sum(map(_room, [*rows[-1], name])) > view.width:
            rows.append([])
        rows[-1].append(name)
    parts = []
    for i, row in enumerate(rows):
        x = (view.width - sum(map(_room, row)) + GAP) // 2
        y = view.height + FOOT + i * ROW + ROW // 2
        for name in row:
            at = f"x='{x + _wide(name) + 60}' y='{y + 45}'"
            parts.append(f"{_sample(name, x, y, dark)}<text {at} fill='{INK[dark]}' stroke='none'>{ROLES[name].word}</text>")
            x += _room(name)
    return "".join(parts), len(rows)


def _wide(name: str) -> int:
    return MARK if ROLES[name].marker else SAMPLE


def _room(name: str) -> int:
    word = sum(0.4 if letter in NARROW else 0.95 if letter in WIDE else 0.61 for letter in ROLES[name].word)
    return round(_wide(name) + 60 + LETTER * word + GAP)


def _sample(name: str, x: int, y: int, dark: bool) -> str:
    role, color = ROLES[name], color_of(name, dark)
    if role.marker:
        look = _look(Layer(name, "markers", np.empty((0, 2))), dark)
        if name not in HOLLOW:
            return f"<path stroke-linecap='round' d='M{x + MARK // 2} {y}h0'{look}/>"
        return f"<circle cx='{x + MARK // 2}' cy='{y}' r='{round(POINT * min(role.size, 10) / 2)}'{look}/>"
    look = _look(Layer(name, "lines", np.empty((0, 2, 2))), dark)
    if not role.fill:
        return f"<path d='M{x} {y}h{SAMPLE}'{look}/>"
    area = f"x='{x}' y='{y - 60}' width='{SAMPLE}' height='120'"
    hatch = f" fill='url(#{_id(name, dark)})'" if role.hatch else ""
    return f"<rect {area} fill='{color}' fill-opacity='{role.fill:g}'/><rect {area}{look}{hatch}/>"
