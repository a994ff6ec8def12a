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
from fem_mesh.mesh.quality import circumcircle
from fem_mesh.watch.picture import Picture, picture_of
from fem_mesh.watch.style import INK, PAPER, ROLES, color_of

if TYPE_CHECKING:
    from fem_mesh.mesh.mesh import Mesh
    from fem_mesh.trace import Trace

SIZE = (6.4, 5.6)  # inches
VIEWS = 20  # circles larger than so many views are drawn as an arc
MOST_NUMBERS = 60  # more points than this go without numbers, unless asked
MOST_LISTED = 4  # more roles than this are listed in smaller letters
THINNEST = 1.6  # of the thick lines, in points
FULL_SIZE = 120  # up to so many vertices have markers of full size
MOST_MARKED = 1_000  # more vertices than this go without a marker
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
    step = trace[k]
    points, triangles = trace.frame(k)
    everything = trace.all_points()
    everything[: len(points)] = np.where(np.isnan(points), everything[: len(points)], points)
    shown: list[str] = []
    page.clear()
    _set_view(page, trace.view_box(), dark)

    fresh = {tuple(t) for t in step.added}
    old = [t for t in map(tuple, triangles.tolist()) if t not in fresh]
    _polygons(page, everything, old, "mesh", dark, shown, listed=False)
    _polygons(page, everything, step.visited, "visited", dark, shown)
    _polygons(page, everything, step.doomed, "doomed", dark, shown)
    _polygons(page, everything, step.added if k else (), "new", dark, shown)
    _polygons(page, everything, step.added if not k else (), "mesh", dark, shown, listed=False)
    _edges(page, everything, vanished_edges(step.removed, triangles.tolist()), dark, shown, role="gone", zorder=3.2)
    scale = scale_for(len(points))
    _edges(page, everything, trace.segments(k).tolist(), dark, shown, role="segment", zorder=2.9, scale=scale)
    _edges(page, everything, step.asked, dark, shown, role="asked", zorder=2.95)
    if circles:
        _circles(page, everything, step.circles, dark, shown)
        _diametral_circles(page, everything, step.encroached, dark, shown)
    _edges(page, everything, step.encroached, dark, shown, role="encroached")
    _edges(page, everything, step.edges, dark, shown)
    there = ~np.isnan(points[:, 0])
    _markers(page, trace.points_to_come(k), "waiting", dark, shown)
    if there.sum() <= MOST_MARKED:
        _markers(page, points[there], "vertex", dark, shown, listed=False, scale=scale)
    if step.point is not None:
        _markers(page, np.array([step.point]), "point", dark, shown)
    if numbers or (numbers is None and len(everything) <= MOST_NUMBERS):
        _numbers(page, points if trace.makes_points else everything, dark)
    if legend:
        _legend(page, shown, dark)
    head = f"step {k} of {len(trace) - 1}, {step.kind}"
    _caption(page, head, step.caption, dark)
    return page if ax is not None else picture_of(page, f"{head}: {step.caption}")


# ---- a mesh ------------------------------------------------------------------------------------------


def plot_mesh(
    mesh: Mesh,
    ax: Axes | None = None,
    *,
    circles: bool = False,
    numbers: bool | None = None,
    legend: bool = True,
    dark: bool = False,
    title: str | None = None,
) -> Picture | Axes:
    """Draw a mesh. ``circles`` adds every circumcircle, ``numbers`` the vertices' numbers; see ``draw_step``.

    ``title`` replaces the line of facts above the picture.
    """
    page = new_axes(dark) if ax is None else ax
    page.clear()
    _set_view(page, view_box(mesh.points), dark)
    shown: list[str] = []
    _draw_mesh(page, mesh.points, mesh.triangles, circles, dark, shown)
    if numbers or (numbers is None and len(mesh.points) <= MOST_NUMBERS):
        _numbers(page, mesh.points, dark)
    _edges(page, mesh.points, mesh.segments.tolist(), dark, shown, role="segment", scale=scale_for(len(mesh.points)))
    if circles and legend:
        _legend(page, shown, dark)
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
    _polygons(page, mesh.points, mesh.triangles[near].tolist(), "mesh", False, [])
    _caption(page, repr(mesh), f"{MOST_SHOWN:,} of its triangles, around the middle", False)
    return picture_of(page, repr(mesh))


def _draw_mesh(page: Axes, points: np.ndarray, triangles: np.ndarray, circles: bool, dark: bool, shown: list[str]) -> None:
    _polygons(page, points, triangles.tolist(), "mesh", dark, shown)
    if circles:
        _circles(page, points, triangles.tolist(), dark, shown)
    if len(points) <= MOST_MARKED:
        _markers(page, points, "vertex", dark, shown, scale=scale_for(len(points)))


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


def _polygons(
    page: Axes, points: np.ndarray, triangles: Iterable[Any], name: str, dark: bool, shown: list[str], listed: bool = True
) -> None:
    triangles = list(triangles)
    if not triangles:
        return
    role, color = ROLES[name], color_of(name, dark)
    corners = points[np.array(triangles)]
    order = list(ROLES).index(name)
    if role.fill:
        page.add_collection(PolyCollection(corners, facecolor=color, alpha=role.fill, edgecolor="none", zorder=1 + order / 20))
    hatched = PolyCollection(corners, facecolor="none", edgecolor=color, linewidth=role.width, zorder=2 + order / 20)
    hatched.set_hatch(role.hatch)
    page.add_collection(hatched)
    if listed:
        shown.append(name)


def vanished_edges(removed: Iterable[Any], triangles: Iterable[Any]) -> list[tuple[int, ...]]:
    """The edges of removed triangles that no triangle has any more."""
    return sorted(tuple(sorted(edge)) for edge in _sides(removed) - _sides(triangles))


def _sides(triangles: Iterable[Any]) -> set[frozenset[int]]:
    return {frozenset(side) for a, b, c in triangles for side in ((a, b), (b, c), (c, a))}


def scale_for(n: int) -> float:
    """How large markers and thick lines are drawn, as a part of their size, among ``n`` vertices."""
    return min(1.0, math.sqrt(FULL_SIZE / max(n, 1)))


def _edges(
    page: Axes, points: np.ndarray, edges: Iterable[Any], dark: bool, shown: list[str], role: str = "edge",
    zorder: float = 3.0, scale: float = 1.0,
) -> None:  # fmt: skip
    pairs = list(edges)
    if not pairs:
        return
    look = ROLES[role]
    lines = LineCollection(list(points[np.array(pairs)]), colors=color_of(role, dark), zorder=zorder)
    lines.set_linewidth(max(look.width * scale, min(look.width, THINNEST)))
    lines.set_linestyle((0, look.dash) if look.dash else "solid")
    lines.set_capstyle("round" if not look.dash else "butt")
    page.add_collection(lines)
    shown.append(role)


def _circles(page: Axes, points: np.ndarray, triangles: Iterable[Any], dark: bool, shown: list[str]) -> None:
    _rings(page, [circumcircle(*points[list(t)].ravel().tolist()) for t in triangles], dark, shown, "circle")


def _diametral_circles(page: Axes, points: np.ndarray, edges: Iterable[Any], dark: bool, shown: list[str]) -> None:
    ends = [points[list(edge)] for edge in edges]
    circles = [(*pair.mean(axis=0).tolist(), float(np.hypot(*(pair[1] - pair[0]))) / 2) for pair in ends]
    _rings(page, circles, dark, shown, "diametral")


def _rings(page: Axes, circles: list[tuple[float, float, float]], dark: bool, shown: list[str], name: str) -> None:
    left, right, bottom, top = (*page.get_xlim(), *page.get_ylim())
    center, reach = ((left + right) / 2, (bottom + top) / 2), math.hypot(right - left, top - bottom) / 2
    role = ROLES[name]
    large = [circle for circle in circles if VIEWS * reach < circle[2] < math.inf]
    arcs = LineCollection([_arc(*circle, center, reach) for circle in large], colors=color_of(name, dark), zorder=3.6)
    arcs.set_linewidth(role.width)
    arcs.set_linestyle((0, role.dash))
    page.add_collection(arcs, autolim=False)
    circles = [circle for circle in circles if circle[2] <= VIEWS * reach]
    if large or circles:
        shown.append(name)
    if not circles:
        return
    x, y, radius = np.array(circles).T
    page.add_collection(
        EllipseCollection(
            2 * radius, 2 * radius, np.zeros(len(x)), units="xy", offsets=np.column_stack([x, y]),
            offset_transform=page.transData, facecolors="none", edgecolors=color_of(name, dark),
            linewidths=role.width, linestyles=[(0, role.dash)], zorder=3.6,
        ),
        autolim=False,
    )  # fmt: skip


def _arc(x: float, y: float, radius: float, center: tuple[float, float], reach: float) -> np.ndarray:
    """The part near the view of a circle much larger than it: Matplotlib would dash all of it, for ever."""
    away = np.array([center[0] - x, center[1] - y])
    normal = away / max(float(np.hypot(*away)), 1e-300)
    angle = np.linspace(-2, 2, 65) * reach / radius
    foot = np.array([x, y]) + radius * normal
    along, inward = radius * np.sin(angle), -2 * radius * np.sin(angle / 2) ** 2
    return np.asarray(foot + along[:, None] * np.array([-normal[1], normal[0]]) + inward[:, None] * normal)


def _markers(
    page: Axes, points: np.ndarray, name: str, dark: bool, shown: list[str], listed: bool = True, scale: float = 1.0
) -> None:
    if not len(points):
        return
    hollow = name in ("waiting", "point")
    look = _marker(name, dark)
    page.plot(*points.T, **{**look, "markersize": scale * look["markersize"]}, zorder=5 if hollow else 4)
    if name == "point":
        page.plot(*points.T, marker="o", markersize=3.5, linestyle="none", color=color_of(name, dark), zorder=5)
    if listed:
        shown.append(name)


def _marker(name: str, dark: bool) -> dict[str, Any]:
    role, color = ROLES[name], color_of(name, dark)
    face = "none" if name in ("waiting", "point") else color
    return {
        "linestyle": "none", "marker": role.marker, "markersize": role.size, "markeredgewidth": role.width,
        "markeredgecolor": color, "markerfacecolor": face,
    }  # fmt: skip


def _numbers(page: Axes, points: np.ndarray, dark: bool) -> None:
    for number, (x, y) in enumerate(points):
        if not np.isnan(x):
            page.annotate(
                str(number), (x, y), (5, 4), textcoords="offset points", color=INK[dark], fontsize=10, zorder=6,
                bbox={"facecolor": PAPER[dark], "edgecolor": "none", "alpha": 0.6, "pad": 0.6},
            )  # fmt: skip


def _legend(page: Axes, shown: list[str], dark: bool) -> None:
    handles: list[Any] = []
    for name in dict.fromkeys(shown):
        role, color = ROLES[name], color_of(name, dark)
        if role.marker:
            handles.append(Line2D([], [], label=role.word, **_marker(name, dark)))
        elif role.fill:
            handles.append(Patch(facecolor=(color, role.fill), edgecolor=color, hatch=2 * role.hatch, label=role.word))
        else:
            line = Line2D([], [], color=color, linewidth=role.width, label=role.word)
            line.set_linestyle((0, role.dash) if role.dash else "solid")
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
