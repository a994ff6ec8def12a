"""The picture of a verdict as SVG: theirs beside what was expected, in the roles of all other pictures."""

from __future__ import annotations

import html
import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_mesh.mesh.points import view_box
from fem_mesh.mesh.quality import circumcircle
from fem_mesh.watch.layers import Layer
from fem_mesh.watch.style import INK, PAPER
from fem_mesh.watch.svg import NO_XML, data_uri, svg_of_layers

if TYPE_CHECKING:
    from fem_mesh.check.verdict import Picture, Verdict

WIDTH = 420  # of a panel, in pixels
HEAD = 34  # above the panels, for their titles
LEGEND = ("wrong", "wrong edge", "expected", "expected edge", "segment", "circle", "diametral", "point")
LONGEST = 62  # of a title
MOST_NUMBERED = 60  # points
SMALL = 0.75  # a circle's radius, as a share of the points' extent, up to which all of it is shown


class Drawing:
    """A picture, and a sentence that says what it shows. As a cell's result it shows itself.

    ``svg`` is its text, ``save(path)`` writes it to a file.
    """

    def __init__(self, picture: Picture, alt: str) -> None:
        self.alt = alt
        self.svg = svg_of_picture(picture, alt)

    def save(self, path: Any) -> None:
        """Write the SVG to ``path``."""
        Path(path).write_text(self.svg, encoding="utf-8")

    def __repr__(self) -> str:
        return self.alt

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        return {"text/plain": self.alt, "text/html": image_of(self)}


def image_of(drawing: Drawing) -> str:
    """The picture as an image tag, which is shown in untrusted notebooks too."""
    alt = html.escape(drawing.alt, quote=True)
    return f'<img src="{data_uri(drawing.svg)}" alt="{alt}" style="max-width: 100%; background: white">'


def html_of(verdict: Verdict) -> str:
    """A verdict's sentence, and its picture if it has one."""
    sentence = f"<p>{html.escape(str(verdict))}</p>"
    drawing = verdict.draw()
    return sentence if drawing is None else f"{sentence}\n{image_of(drawing)}"


def svg_of_picture(picture: Picture, alt: str = "") -> str:
    """Panels side by side as one SVG image.

    >>> from fem_mesh.check.pictures import beside, panel
    >>> shown = beside([(0, 0), (1, 0), (0, 1)], panel("yours", [(0, 1, 2)], wrong=[(0, 1, 2)]), panel("expected"))
    >>> svg_of_picture(shown)[:66]
    "<svg xmlns='http://www.w3.org/2000/svg' width='852' height='385' v"
    """
    panels = picture["panels"]
    shown = [layers_of_panel(panel, np.array(panel.get("points", picture["points"]), float).reshape(-1, 2)) for panel in panels]
    box = _box_of(shown)
    parts, tallest = [], 0
    for k, (panel, layers) in enumerate(zip(panels, shown, strict=True)):
        roles = {layer.role for layer in layers}
        title = panel["title"]
        svg = svg_of_layers(layers, [role for role in LEGEND if role in roles], box, title, width=WIDTH)
        size = re.match(r"<svg xmlns='[^']*' width='\d+' height='(\d+)'", svg)
        tallest = max(tallest, int(size[1]) if size else 0)
        left = k * (WIDTH + 12)
        parts.append(svg.replace("<svg ", f"<svg x='{left}' y='{HEAD}' ", 1))
        short = title if len(title) <= LONGEST else title[: LONGEST - 3] + "..."
        words = f"<text x='{left + 8}' y='23' fill='{INK[False]}'>{html.escape(short, quote=False)}</text>"
        parts.append(words)
    width, height = len(panels) * (WIDTH + 12) - 12, HEAD + tallest
    return "\n".join(
        [
            f"<svg xmlns='http://www.w3.org/2000/svg' width='{width}' height='{height}' viewBox='0 0 {width} {height}' "
            "role='img' font-family='system-ui,sans-serif' font-size='15'>",
            f"<title>{html.escape(NO_XML.sub('', alt), quote=False)}</title>",
            f"<rect width='100%' height='100%' fill='{PAPER[False]}'/>",
            *parts,
            "</svg>",
        ]
    )


def layers_of_panel(panel: dict[str, Any], points: np.ndarray) -> list[Layer]:
    """A panel's layers, from the ground up."""

    def at(name: str, width: int) -> np.ndarray:
        return np.asarray(points[np.array(panel.get(name, ()), np.int64).reshape(-1, width)])

    circles = np.array([circumcircle(*corners) for corners in at("circles", 3).reshape(-1, 6).tolist()]).reshape(-1, 3)
    ends = at("diametral", 2)
    diametral = np.column_stack([ends.mean(axis=1), np.hypot(*(ends[:, 1] - ends[:, 0]).T) / 2])
    words = tuple(panel.get("words", map(str, range(len(points)))))
    layers = [
        Layer("mesh", "polygons", at("triangles", 3)),
        Layer("wrong", "polygons", at("wrong", 3)),
        Layer("expected", "polygons", at("right", 3)),
        Layer("segment", "lines", at("segments", 2), scale=0.8),
        Layer("edge", "lines", at("edges", 2)),
        Layer("wrong edge", "lines", at("wrong_edges", 2)),
        Layer("expected edge", "lines", at("right_edges", 2)),
        Layer("circle", "circles", circles[circles[:, 2] < math.inf]),
        Layer("diametral", "circles", diametral),
        Layer("vertex", "markers", points),
        Layer("point", "markers", points[np.array(panel.get("point", ()), np.int64)]),
        Layer("vertex", "texts", points if len(points) <= MOST_NUMBERED else points[:0], words=words),
    ]
    return [layer for layer in layers if len(layer.places)]


def _box_of(shown: list[list[Layer]]) -> tuple[float, float, float, float]:
    """A view of all vertices, and of the circles that are not much larger."""
    layers = [layer for panel in shown for layer in panel]
    places = np.concatenate([layer.places for layer in layers if layer.what == "markers"] or [np.zeros((1, 2))])
    circles = np.concatenate([layer.places for layer in layers if layer.what == "circles"] or [np.empty((0, 3))])
    circles = circles[circles[:, 2] <= SMALL * np.ptp(places, axis=0).max()]
    return view_box(np.concatenate([places, circles[:, :2] - circles[:, 2:], circles[:, :2] + circles[:, 2:]]))
