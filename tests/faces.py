"""The faces that segments cut the plane into, in fractions: slabs between the x of their ends, trapezoids in each slab.

Slow, and independent of any triangulation: no mesh is asked. ``domain`` is anything with ``points``, ``segments``,
``toggles`` (whether crossing a row leads from outside to inside) and ``holes`` (seeds; without any, parity decides).
Rows may overlap, repeat, touch; they must not cross.
"""

import bisect
import math
from collections import defaultdict
from fractions import Fraction
from functools import cached_property
from itertools import pairwise

import exact

BOTTOM, TOP = -math.inf, math.inf  # below and above every row


class Faces:
    """``area`` kept, ``kept(face)``, ``beside(a, b)`` and ``seeds()``; whole numbers are those of ``self.whole``."""

    def __init__(self, domain):
        given, holes = [tuple(p) for p in domain.points.tolist()], [tuple(h) for h in domain.holes]
        numbers = exact.integers([*given, *holes])
        self.unit = max((x.as_integer_ratio()[1] for p in [*given, *holes] for x in map(float, p)), default=1)
        self.whole, self.holes = numbers[: len(given)], numbers[len(given) :]
        self.rows = []
        for (i, j), toggles in zip(domain.segments.tolist(), domain.toggles.tolist(), strict=True):
            if self.whole[i] != self.whole[j]:
                self.rows.append((*sorted((self.whole[i], self.whole[j])), bool(toggles)))
        self.xs = sorted({end[0] for a, b, _ in self.rows for end in (a, b)})
        self.slabs = [[(BOTTOM, TOP, 0)]] + [self._slab(x, right) for x, right in pairwise(self.xs)] + [[(BOTTOM, TOP, 0)]]
        self._join()

    def _slab(self, x, right):
        """The cells of a slab from below: (row at its bottom, row at its top, parity)."""
        at, middle = defaultdict(list), Fraction(x + right, 2)
        for row in self.rows:
            if row[0][0] <= x and row[1][0] >= right:
                at[height(row, middle)].append(row)
        cells, bottom, parity = [], BOTTOM, 0
        for y in sorted(at):
            cells.append((bottom, at[y][0], parity))
            bottom, parity = at[y][0], (parity + sum(row[2] for row in at[y])) % 2
        assert parity == 0 or self.holes, (
            f"the rows that toggle do not close up between x = {x / self.unit} and {right / self.unit}"
        )
        return [*cells, (bottom, TOP, 0)]

    def _join(self):
        """Give each cell the number of its face: cells that share a piece of a wall without a row on it are one.

        Without seeds, parity must not depend on the path.
        """
        first = [0]
        for cells in self.slabs:
            first.append(first[-1] + len(cells))
        parent = list(range(first[-1]))

        def root(i):
            while parent[i] != i:
                parent[i] = i = parent[parent[i]]
            return i

        upright = defaultdict(list)
        for a, b, _ in self.rows:
            if a[0] == b[0]:
                upright[a[0]].append((a[1], b[1]))
        for k, x in enumerate(self.xs):
            for i, j in openings(self.slabs[k], self.slabs[k + 1], x, sorted(upright[x])):
                parent[root(first[k] + i)] = root(first[k + 1] + j)
        for k, cells in enumerate(self.slabs):  # below and above everything lies outside
            parent[root(first[k])] = root(0)
            parent[root(first[k] + len(cells) - 1)] = root(0)
        self.face = [[root(first[k] + i) for i in range(len(cells))] for k, cells in enumerate(self.slabs)]
        self.parity, self.areas, self.widest = {}, defaultdict(Fraction), {}
        for k, cells in enumerate(self.slabs):
            for face, (bottom, top, parity) in zip(self.face[k], cells, strict=True):
                known = self.parity.setdefault(face, parity)
                assert known == parity or self.holes, "the parity of a face depends on the path"
                if 0 < k < len(self.slabs) - 1 and bottom is not BOTTOM and top is not TOP:
                    self._measure(face, bottom, top, self.xs[k - 1], self.xs[k])
        self.outside = self.face[0][0]

    def _measure(self, face, bottom, top, x, right):
        middle = Fraction(x + right, 2)
        tall = height(top, middle) - height(bottom, middle)
        self.areas[face] += (right - x) * tall
        score = min(tall, Fraction(right - x))
        if score > self.widest.get(face, (0,))[0]:
            self.widest[face] = score, middle, height(bottom, middle) + tall / 2

    @cached_property
    def _carved(self):
        return {self.outside} | {self.at(hole)[0] for hole in self.holes}

    def kept(self, face):
        """Whether the face belongs to the domain."""
        if face == self.outside:
            return False
        return face not in self._carved if self.holes else self.parity[face] == 1

    @cached_property
    def area(self):
        """Of all that is kept, in the user's units squared."""
        return sum((area for face, area in self.areas.items() if self.kept(face)), Fraction(0)) / self.unit**2

    def at(self, point):
        """The faces just above and just below a point in whole numbers, right of it by less than anything."""
        slab = bisect.bisect_right(self.xs, point[0])
        tops = [-math.inf if row is TOP else exact.turn(row[0], row[1], point) for _, row, _ in self.slabs[slab]]
        faces = self.face[slab]
        above = next(i for i, side in enumerate(tops) if side < 0)
        below = next(i for i, side in enumerate(tops) if side <= 0)
        return faces[above], faces[below]

    def beside(self, a, b):
        """The faces on the two sides of a piece of a row, from a to b in whole numbers."""
        middle = Fraction(a[0] + b[0], 2), Fraction(a[1] + b[1], 2)
        if a[0] != b[0]:
            return self.at(middle)
        right, k = self.at(middle)[0], bisect.bisect_left(self.xs, a[0])
        heights = [TOP if top is TOP else height(top, a[0]) for _, top, _ in self.slabs[k]]
        return right, self.face[k][bisect.bisect_left(heights, middle[1])]

    def holds(self, point):
        """Whether a point of ``whole`` lies in what is kept, or on its boundary."""
        if any(self.kept(face) for face in self.at(point)):
            return True
        touching = [r for r in self.rows if exact.turn(r[0], r[1], point) == 0 and r[0] <= point <= r[1]]
        ends = [(a, b) for a, b, _ in touching for a, b in ((a, point), (point, b)) if a != b]
        return any(self.kept(face) for a, b in ends for face in self._near(a, b, point))

    def _near(self, a, b, point):
        """The faces beside the piece of ab next to ``point``, one of its ends."""
        on = [q for q in self.whole if exact.turn(a, b, q) == 0 and min(a, b) < q < max(a, b)]
        other = b if point == a else a
        nearest = min([*on, other], key=lambda q: abs(q[0] - point[0]) + abs(q[1] - point[1]))
        return self.beside(*sorted((point, nearest)))

    def seeds(self):
        """A point, in floats, inside each bounded face that does not belong to the domain."""
        carved = [face for face in self.areas if not self.kept(face) and face != self.outside]
        return [
            (float(Fraction(x) / self.unit), float(Fraction(y) / self.unit))
            for _, x, y in (self.widest[face] for face in carved)
        ]


def height(row, x):
    """The y of a row at x."""
    (ax, ay), (bx, by) = row[0], row[1]
    return Fraction(ay * (bx - x) + by * (x - ax), 1) / (bx - ax)


def openings(left, right, x, upright):
    """Pairs (i, j) of cells, left and right of the wall at x, between which the wall is open somewhere."""
    bounds = [[(level(bottom, x), level(top, x)) for bottom, top, _ in cells] for cells in (left, right)]
    i = j = 0
    while i < len(left) and j < len(right):
        low, high = max(bounds[0][i][0], bounds[1][j][0]), min(bounds[0][i][1], bounds[1][j][1])
        if low < high and not covered(low, high, upright):
            yield i, j
        if bounds[0][i][1] <= bounds[1][j][1]:
            i += 1
        else:
            j += 1


def level(row, x):
    return row if isinstance(row, float) else height(row, x)


def covered(low, high, intervals):
    """Whether sorted closed intervals cover all of low .. high."""
    for bottom, top in intervals:
        if bottom > low:
            break
        low = max(low, top)
    return low >= high
