"""Where things lie on a page of whole numbers, and paths there in few characters."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

Box = tuple[float, float, float, float]  # left, right, bottom, top
Places = list[tuple[int, int]]  # on the page, in tenths of a pixel

SHAPES = (1.3, 2.2)  # of a view, width to height
MARGIN = 80  # around the box in the view
NEAR = 100  # around the view: what lies farther away is not drawn
FAR = 100_000  # lines that reach farther are cut


class View:
    """Where points lie on a page: the box, centred in a view that is neither tall nor very flat."""

    def __init__(self, box: Box, width: int) -> None:
        across, up = box[1] - box[0], box[3] - box[2]
        self.width = width
        self.height = 10 * round(width / min(max(across / up, SHAPES[0]), SHAPES[1]) / 10)
        self.scale = min((self.width - 2 * MARGIN) / across, (self.height - 2 * MARGIN) / up)
        self.middle = np.array([box[0] + box[1], box[2] + box[3]]) / 2
        self.center = (self.width / 2, self.height / 2)

    def place(self, points: np.ndarray) -> np.ndarray:
        """Points (..., 2) on the page, not rounded."""
        return np.asarray(self.center + self.scale * np.array([1.0, -1.0]) * (points - self.middle))

    def shapes(self, points: np.ndarray, closed: bool) -> list[Places]:
        """Polygons or lines (n, corners, 2) that come near the view, cut where they reach far beyond it, rounded."""
        places = self.place(points)
        size = np.array([self.width, self.height])
        places = places[((places.max(axis=1) > -NEAR) & (places.min(axis=1) < size + NEAR)).all(axis=1)]
        far = (np.abs(places) > FAR).any(axis=(1, 2))
        result: list[Places] = [list(map(tuple, shape)) for shape in np.rint(places[~far]).astype(int).tolist()]
        for shape in places[far].tolist():
            for axis in (0, 1):
                for side in (-1, 1):
                    shape = _cut(shape, axis, side, closed)
            if len(shape) > 1:
                result.append([(round(x), round(y)) for x, y in shape])
        return result

    def dots(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The rounded places of points (n, 2) in the view, and which points these are."""
        places = self.place(points)
        inside = np.flatnonzero(((places > -NEAR) & (places < np.array([self.width, self.height]) + NEAR)).all(axis=1))
        return np.rint(places[inside]).astype(int), inside


def _cut(shape: list[Any], axis: int, side: int, closed: bool) -> list[Any]:
    """The part of a convex shape on the near side of a line far out."""
    result = []
    for i, p in enumerate(shape):
        room = FAR - side * p[axis]
        if room >= 0:
            result.append(p)
        if i + 1 < len(shape) or closed:
            q = shape[(i + 1) % len(shape)]
            rest = FAR - side * q[axis]
            if (room < 0) != (rest < 0):
                share = room / (room - rest)
                result.append([p[j] + share * (q[j] - p[j]) for j in (0, 1)])
    return result


def line(places: Sequence[tuple[int, int]]) -> str:
    """The path from the first place over the others.

    >>> line([(10, 20), (30, 15), (30, 40)])
    'M10 20l20-5 0 25'
    """
    (x, y), *rest = places
    steps = []
    for u, v in rest:
        steps.append(f"{u - x} {v - y}" if v >= y else f"{u - x}{v - y}")
        x, y = u, v
    tail = "".join(step if step[0] == "-" or not i else " " + step for i, step in enumerate(steps))
    return f"M{places[0][0]} {places[0][1]}l{tail}"


def closed(shapes: Iterable[Places]) -> str:
    """The outlines of polygons."""
    return "".join(line(shape) + "z" for shape in shapes)


def trails(lines: Iterable[Places]) -> str:
    """Lines between two places, each once, in a few long walks.

    >>> trails([[(0, 0), (9, 0)], [(9, 9), (9, 0)], [(9, 0), (0, 0)]])
    'M0 0l9 0 0 9'
    """
    after: dict[tuple[int, int], dict[tuple[int, int], None]] = {}
    for a, b in sorted({(min(line), max(line)) for line in lines}):
        if a != b:
            after.setdefault(a, {})[b] = after.setdefault(b, {})[a] = None
    odd = [p for p, others in after.items() if len(others) % 2]
    return "".join(line(trail) for trail in _walks(after, [*odd, *after]))


def _walks(after: dict[tuple[int, int], dict[tuple[int, int], None]], starts: Iterable[tuple[int, int]]) -> Iterator[Places]:
    """Walks along edges not gone yet, until there are none."""
    for start in starts:
        while after[start]:
            trail = [start]
            while after[trail[-1]]:
                p = trail[-1]
                q = next(iter(after[p]))
                del after[p][q], after[q][p]
                trail.append(q)
            yield trail
