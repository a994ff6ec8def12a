"""One frame on Matplotlib axes: a step of a trace, or a mesh."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from fem_mesh.mesh.points import view_box
from fem_mesh.watch.layers import CORE, HOLLOW, Layer, layers_of, layers_of_mesh, legend_of, rings_of
from fem_mesh.watch.picture import Picture, picture_of
from fem_mesh.watch.style import INK, PAPER, ROLES, color_of

if TYPE_CHECKING:
    from fem_mesh.mesh.mesh import Mesh
    from fem_mesh.trace import Trace

SIZE = (6.4, 5.6)  # inches
MOST_LISTED = 4  # more roles than this are listed in smaller letters
MOST_SHOWN = 3_000  # a mesh's picture in a notebook shows a part, beyond so many triangles
LETTERS_AN_INCH = 10.5  # of caption


def new_axes(dark: bool = False, size: tuple[float, float] = SIZE) -> Axes:
    """Axes that leave the top of the figure to the caption and the bottom to the legend, whatever they say."""
    figure = Figure(figsize=size, facecolor=PAPER[dark])
    return figure.add_axes((0.03, 0.075, 0.94, 0.79))


# ---- a step ------------------------------------------------------------------------------------------


def draw_step(
    trace: Trace,
    k: int,
    ax: Axes | None = None,
    *,
    circles: bool = True,
    numbers: bool | None = None,
    legend: bool = True,
    dark: bool = False,
) -> Picture | Axes:
    """Draw step ``k`` of a trace: what stands, what is about to go, what has just come, and why.

    ax : Matplotlib axes, cleared first; returned. Without it a Picture of its own is returned.
    circles : show circumcircles where the step has some
    numbers : write the vertices' numbers (None: if there are not many)

    Every frame of a trace has the same view box.
    """
    page = new_axes(dark) if ax is None else ax
    k = range(len(trace))[k]
    page.clear()
    _set_view(page, trace.view_box(), dark)
    layers = layers_of(trace, k, circles, numbers)
    draw_layers(page, layers, dark)
    if legend:
        _legend(page, legend_of(layers), dark)
    head = f"step {k} of {len(trace) - 1}, {trace[k].kind}"
    _caption(page, head, trace[k].caption, dark)
    return page if ax is not None else picture_of(page, f"{head}: {trace[k].caption}")


# ---- a mesh ------------------------------------------------------------------------------------------


def plot_mesh(
    mesh: Mesh,
    ax: Axes | None = None,
    *,
    circles: bool = False,
    numbers: bool | None = None,
    voronoi: bool = False,
    legend: bool = True,
    dark: bool = False,
    title: str | None = None,
) -> Picture | Axes:
    """Draw a mesh. ``circles`` adds every circumcircle, ``voronoi`` the Voronoi diagram of a mesh that is Delaunay,
    ``numbers`` the vertices' numbers; see ``draw_step``.

    ``title`` replaces the line of facts above the picture.
    """
    page = new_axes(dark) if ax is None else ax
    page.clear()
    _set_view(page, view_box(mesh.points), dark)
    layers = layers_of_mesh(mesh, circles, numbers, voronoi)
    draw_layers(page, layers, dark)
    if (circles or voronoi) and legend:
        shown = {layer.role for layer in layers}
        _legend(page, [name for name in ("mesh", "circle", "voronoi", "vertex", "segment") if name in shown], dark)
    facts = repr(mesh) if title is None else title
    head, _, rest = facts.partition(": ") if title is None else (facts, "", "")
    _caption(page, head, rest, dark)
    return page if ax is not None else picture_of(page, facts)


def picture_of_mesh(mesh: Mesh) -> Picture:
    """The picture that a notebook shows for a mesh: all of it, or for a large one its middle."""
    if len(mesh.triangles) <= MOST_SHOWN:
        return plot_mesh(mesh)  # type: ignore[return-value]
    centers = mesh.points[mesh.triangles].mean(axis=1)
    distance = np.abs(centers - np.median(centers, axis=0)).max(axis=1)
    near = np.argpartition(distance, MOST_SHOWN)[:MOST_SHOWN]
    page = new_axes()
    _set_view(page, view_box(mesh.points[mesh.triangles[near].ravel()]), False)
    draw_layers(page, [Layer("mesh", "polygons", mesh.points[mesh.triangles[near]])], False)
    _caption(page, repr(mesh), f"{MOST_SHOWN:,} of its triangles, around the middle", False)
    return picture_of(page, repr(mesh))


# ---- the parts ---------------------------------------------------------------------------------------


def _set_view(page: Axes, box: tuple[float, float, float, float], dark: bool) -> None:
    # The box grows to the shape of the axes: equal scales, and every frame fills the same place.
    place, whole = page.get_position(original=True), page.figure.bbox
    shape = (place.height * whole.height) / (place.width * whole.width)
    width = max(box[1] - box[0], (box[3] - box[2]) / shape)
    x, y = (box[0] + box[1]) / 2, (box[2] + box[3]) / 2
    page.set_xlim(x - width / 2, x + width / 2)
    page.set_ylim(y - shape * width / 2, y + shape * width / 2)
    page.set_aspect("equal")
    page.set_axis_off()
    page.set_facecolor(PAPER[dark])


def draw_layers(page: Axes, layers: Iterable[Layer], dark: bool) -> None:
    """Draw layers on axes that have their view, each above those before it."""
    draw = {"polygons": _polygons, "lines": _lines, "circles": _circles, "markers": _markers, "texts": _texts}
    for layer in layers:
        if len(layer.places):
            draw[layer.what](page, layer, dark)


def _polygons(page: Axes, layer: Layer, dark: bool) -> None:
    # All fills lie below all outlines.
    role, color = ROLES[layer.role], color_of(layer.role, dark)
    corners: Any = layer.places
    if role.fill:
        page.add_collection(PolyCollection(corners, facecolor=color, alpha=role.fill, edgecolor="none", zorder=1))
    hatched = PolyCollection(corners, facecolor="none", edgecolor=color, linewidth=layer.width, zorder=2)
    hatched.set_hatch(role.hatch)
    page.add_collection(hatched)


def _lines(page: Axes, layer: Layer, dark: bool) -> None:
    lines = _line_collection(layer, layer.places, dark, zorder=3)
    lines.set_capstyle("round" if not ROLES[layer.role].dash else "butt")
    page.add_collection(lines)


def _line_collection(layer: Layer, places: Iterable[np.ndarray], dark: bool, zorder: float) -> LineCollection:
    lines = LineCollection(list(places), colors=color_of(layer.role, dark), zorder=zorder)
    lines.set_linewidth(layer.width)
    lines.set_linestyle(_dash(layer.role))
    return lines


def _dash(name: str) -> Any:
    return (0, ROLES[name].dash) if ROLES[name].dash else "solid"


def _circles(page: Axes, layer: Layer, dark: bool) -> None:
    left, right, bottom, top = (*page.get_xlim(), *page.get_ylim())
    center, reach = ((left + right) / 2, (bottom + top) / 2), math.hypot(right - left, top - bottom) / 2
    whole, arcs = rings_of(layer.places, center, reach)
    page.add_collection(_line_collection(layer, arcs, dark, zorder=3.6), autolim=False)
    if not len(whole):
        return
    x, y, radius = whole.T
    page.add_collection(
        EllipseCollection(
            2 * radius, 2 * radius, np.zeros(len(x)), units="xy", offsets=np.column_stack([x, y]),
            offset_transform=page.transData, facecolors="none", edgecolors=color_of(layer.role, dark),
            linewidths=layer.width, linestyles=[_dash(layer.role)], zorder=3.6,
        ),
        autolim=False,
    )  # fmt: skip


def _markers(page: Axes, layer: Layer, dark: bool) -> None:
    look = {**_marker(layer.role, dark), "markersize": layer.size}
    page.plot(*layer.places.T, **look, zorder=4)
    if layer.role == "point":
        page.plot(*layer.places.T, marker="o", markersize=CORE, linestyle="none", color=color_of(layer.role, dark), zorder=4)


def _marker(name: str, dark: bool) -> dict[str, Any]:
    role, color = ROLES[name], color_of(name, dark)
    face = "none" if name in HOLLOW else color
    return {
        "linestyle": "none", "marker": role.marker, "markersize": role.size, "markeredgewidth": role.width,
        "markeredgecolor": color, "markerfacecolor": face,
    }  # fmt: skip


def _texts(page: Axes, layer: Layer, dark: bool) -> None:
    for text, (x, y) in zip(layer.words, layer.places.tolist(), strict=True):
        page.annotate(
            text, (x, y), (5, 4), textcoords="offset points", color=INK[dark], fontsize=10, zorder=6,
            bbox={"facecolor": PAPER[dark], "edgecolor": "none", "alpha": 0.6, "pad": 0.6},
        )  # fmt: skip


def _legend(page: Axes, names: Iterable[str], dark: bool) -> None:
    handles: list[Any] = []
    for name in names:
        role, color = ROLES[name], color_of(name, dark)
        if role.marker:
            handles.append(Line2D([], [], label=role.word, **_marker(name, dark)))
        elif role.fill:
            handles.append(Patch(facecolor=(color, role.fill), edgecolor=color, hatch=2 * role.hatch, label=role.word))
        else:
            line = Line2D([], [], color=color, linewidth=role.width, label=role.word)
            line.set_linestyle(_dash(name))
            handles.append(line)
    if handles:
        tight = len(handles) > MOST_LISTED
        page.legend(
            handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=len(handles), frameon=False,
            labelcolor=INK[dark], fontsize=8 if tight else 10, handlelength=1.2 if tight else 1.6, handletextpad=0.4,
            columnspacing=0.7 if tight else 1.1, borderaxespad=0.3,
        )  # fmt: skip


def _caption(page: Axes, head: str, text: str, dark: bool) -> None:
    width = page.get_position().width * page.figure.bbox.width / page.figure.dpi  # inches
    lines = textwrap.wrap(text, int(LETTERS_AN_INCH * width))
    page.set_title("\n".join([head, *lines]), color=INK[dark], fontsize=12.5, loc="left", linespacing=1.35)
