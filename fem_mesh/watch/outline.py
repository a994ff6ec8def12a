"""A domain on Matplotlib axes: its segments and their names, its curves, what lies inside, its seeds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb

from fem_mesh.mesh.points import view_box
from fem_mesh.watch.draw import _caption, _legend, _set_view, draw_layers, new_axes
from fem_mesh.watch.layers import Layer, numbers_of
from fem_mesh.watch.picture import Picture, picture_of
from fem_mesh.watch.style import INK, MOST_NUMBERS, PAPER, ROLES, color_of

if TYPE_CHECKING:
    from fem_mesh.domain.domain import Domain

Box = tuple[float, float, float, float]  # left, right, bottom, top

MOST_NAMED = 8  # with more names than this none is written
ROWS = 700  # of the raster that shows the inside
VISIBLE = 4e-3  # of the view: a curve nearer to its chord is not drawn
ARC = 16  # chords by which a curve is drawn
AROUND = 0.06  # more room around a domain than around a mesh, as a share of its extent: for the names

# in points
APART = 5.0  # between a segment and its name
LETTER, LINE = 6.0, 14.0  # the size of a name's letters
CLOSE = 6.0  # between the places that names keep clear of
CROWDED, ROOMY = 9.0, 24.0  # vertices are marked, and numbered, where four in five segments are at least so long
NUMBER = (9.0, 8.0)  # from a vertex to the middle of its number
PLACES = 24  # tried for a name


def plot_domain(
    domain: Domain,
    ax: Axes | None = None,
    *,
    numbers: bool | None = None,
    legend: bool = True,
    dark: bool = False,
    title: str | None = None,
) -> Picture | Axes:
    """Draw a domain: what lies inside by parity, unless hole seeds decide; segments, curves, names and seeds.

    ax : Matplotlib axes, cleared first; returned. Without it a Picture of its own is returned.
    numbers : write the points' numbers (None: if there are not many)
    title : replaces the line of facts above the picture
    """
    page = new_axes(dark) if ax is None else ax
    page.clear()
    _set_view(page, _view_of(domain), dark)
    inside = _inside(page, domain, dark)
    lengths = np.hypot(*np.diff(_on_page(page, domain.points)[domain.segments], axis=1)[:, 0].T)
    room = np.quantile(lengths, 0.2) if len(lengths) else np.inf
    layers = _layers(page, domain, marked=room >= CROWDED)
    numbered = bool(numbers or (numbers is None and len(domain.points) <= MOST_NUMBERS and room >= ROOMY))
    draw_layers(page, [*layers, numbers_of(domain.points)] if numbered else layers, dark)
    for region in domain.regions:
        _write(page, region.name, _on_page(page, (region.x, region.y))[0], (0.0, LINE), dark)
    _names(page, domain, inside, numbered, dark)
    if legend:
        _legend(page, ["inside"] * bool(page.images) + [layer.role for layer in layers], dark)
    head, text = ("Domain", repr(domain).removeprefix("Domain: ")) if title is None else (title, "")
    _caption(page, head, text, dark)
    return page if ax is not None else picture_of(page, repr(domain) if title is None else title)


def _layers(page: Axes, domain: Domain, marked: bool) -> list[Layer]:
    layers = [
        Layer("segment", "lines", domain.points[domain.segments]),
        Layer("curve", "lines", _curves(page, domain)),
        Layer("vertex", "markers", domain.points if marked else domain.points[:0]),
        Layer("hole", "markers", domain.holes),
        Layer("region", "markers", np.array([(r.x, r.y) for r in domain.regions]).reshape(-1, 2)),
    ]
    return [layer for layer in layers if len(layer.places)]


def _view_of(domain: Domain) -> Box:
    everything = np.concatenate([domain.points, domain.holes, np.array([(r.x, r.y) for r in domain.regions]).reshape(-1, 2)])
    left, right, bottom, top = view_box(everything)
    more = AROUND * max(right - left, top - bottom) if any(domain.names) else 0.0
    return left - more, right + more, bottom - more, top + more


def _on_page(page: Axes, points: Any) -> np.ndarray:
    """Where points lie on the page, in points of 1/72 inch."""
    return np.asarray(page.transData.transform(np.asarray(points).reshape(-1, 2))) * 72 / page.figure.dpi


def _inside(page: Axes, domain: Domain, dark: bool) -> np.ndarray:
    """Shade what lies inside an odd number of loops; returns the raster, which covers the page."""
    if len(domain.holes) or not domain.toggles.any():
        return np.zeros((1, 1), bool)
    box = (*page.get_xlim(), *page.get_ylim())
    columns = round(ROWS * (box[1] - box[0]) / (box[3] - box[2]))
    mask = inside_mask(domain.points, domain.segments[domain.toggles], box, ROWS, columns)
    image = np.zeros((*mask.shape, 4))
    image[..., :3] = to_rgb(color_of("inside", dark))
    image[..., 3] = ROLES["inside"].fill * mask
    page.imshow(image, extent=box, origin="lower", aspect="equal", interpolation="nearest", zorder=0.5)
    return mask


def inside_mask(points: np.ndarray, pairs: np.ndarray, box: Box, rows: int, columns: int) -> np.ndarray:
    """Whether the middle of each pixel lies inside, by parity: bool (rows, columns), from the bottom up. For the eye."""
    left, right, bottom, top = box
    y = bottom + (np.arange(rows) + 0.5) * ((top - bottom) / rows)
    a, b = points[pairs[:, 0]], points[pairs[:, 1]]
    swap = a[:, 1] > b[:, 1]
    a[swap], b[swap] = b[swap], a[swap]
    first, last = np.searchsorted(y, a[:, 1]), np.searchsorted(y, b[:, 1])
    number = last - first  # of scan lines that each segment crosses
    segment = np.repeat(np.arange(len(pairs)), number)
    row = np.arange(len(segment)) - np.repeat(np.cumsum(number) - number - first, number)
    share = (y[row] - a[segment, 1]) / (b[segment, 1] - a[segment, 1])
    x = a[segment, 0] + share * (b[segment, 0] - a[segment, 0])
    column = np.clip(np.ceil((x - left) / (right - left) * columns - 0.5), 0, columns).astype(int)
    crossed = np.zeros((rows, columns + 1), np.int64)
    np.add.at(crossed, (row, column), 1)
    return np.asarray(crossed.cumsum(axis=1)[:, :columns] % 2 == 1)


def _curves(page: Axes, domain: Domain) -> np.ndarray:
    """The curves that can be told from their chords, each by ARC chords: float64 (n, ARC + 1, 2)."""
    view = max(np.ptp(page.get_xlim()), np.ptp(page.get_ylim()))
    lines = []
    for row, curve in domain.curves.items():
        a, b = (tuple(domain.points[v].tolist()) for v in domain.segments[row])
        middle = np.array(curve.between(a, b))
        if np.hypot(*(middle - (np.array(a) + b) / 2)) > VISIBLE * view:
            lines.append(_arc(curve, a, b, ARC))
    return np.array(lines).reshape(-1, ARC + 1, 2)


def _arc(curve: Any, a: Any, b: Any, n: int) -> list[Any]:
    if n == 1:
        return [a, b]
    middle = tuple(curve.between(a, b))
    return [*_arc(curve, a, middle, n // 2)[:-1], *_arc(curve, middle, b, n // 2)]


# ---- names ---------------------------------------------------------------------------------------------


def _names(page: Axes, domain: Domain, inside: np.ndarray, numbered: bool, dark: bool) -> None:
    """Each name once, beside one of its segments, where it hides least."""
    names = list(dict.fromkeys(filter(None, domain.names)))
    if len(names) > MOST_NAMED:
        return
    ends = _on_page(page, domain.points)[domain.segments]
    taken = _drawn(ends)
    if numbered:
        taken = np.concatenate([taken, _on_page(page, domain.points) + np.array(NUMBER)])
    corners = _on_page(page, np.column_stack([page.get_xlim(), page.get_ylim()]))
    for name in names:
        own = ends[[other == name for other in domain.names]]
        half = np.array([LETTER * len(name), LINE]) / 2
        middles, places = _places(own, half)
        cost = 0.01 * np.arange(len(places))  # what a place hides, or how far it lies off the page
        cost += (np.abs(taken - places[:, None]) <= half + 2).all(axis=2).sum(axis=1)
        cost += np.maximum(0, np.maximum(corners[0] - places + half, places + half - corners[1])).max(axis=1)
        share = np.clip((places - corners[0]) / (corners[1] - corners[0]), 0, 1 - 1e-9)
        cost += 0.5 * inside[tuple((share[:, ::-1] * inside.shape).astype(int).T)]
        best = int(cost.argmin())
        _write(page, name, middles[best], places[best] - middles[best], dark)
        spread = np.arange(-half[0], half[0] + 1, CLOSE)
        taken = np.concatenate([taken, places[best] + np.column_stack([spread, 0 * spread])])


def _places(own: np.ndarray, half: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The middles of the longest segments, and the places beside them, right and left, for a name of this size."""
    along = own[:, 1] - own[:, 0]
    off_center = np.abs(np.arange(len(own)) - len(own) // 2)
    longest = np.lexsort([off_center, -np.round(np.hypot(*along.T) / CROWDED)])
    longest = longest[np.linspace(0, len(own) - 1, min(PLACES, len(own))).astype(int)]
    normal = np.column_stack([along[longest, 1], -along[longest, 0]])
    normal /= np.maximum(np.hypot(*normal.T), 1e-9)[:, None]
    normal = np.concatenate([normal, -normal])
    middles = np.tile(own[longest].mean(axis=1), (2, 1))
    return middles, middles + normal * (APART + np.abs(normal) @ half)[:, None]


def _drawn(ends: np.ndarray) -> np.ndarray:
    """Places along segments (k, 2, 2), not far apart."""
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T) if len(ends) else np.empty(0)
    number = (lengths / CLOSE).astype(int) + 1
    segment = np.repeat(np.arange(len(ends)), number)
    share = (np.arange(len(segment)) - np.repeat(np.cumsum(number) - number, number)) / number[segment]
    return np.asarray(ends[segment, 0] + share[:, None] * (ends[segment, 1] - ends[segment, 0]))


def _write(page: Axes, text: str, middle: Any, offset: Any, dark: bool) -> None:
    """Write ``text`` off a place on the page."""
    place = tuple(page.transData.inverted().transform(np.asarray(middle) * page.figure.dpi / 72))
    page.annotate(
        text, place, offset, textcoords="offset points", ha="center", va="center", color=INK[dark], fontsize=11,
        style="italic", zorder=7, bbox={"facecolor": PAPER[dark], "edgecolor": "none", "alpha": 0.75, "pad": 1.0},
    )  # fmt: skip
