"""Domains, each named by what it breaks; the docstring is the reason it is here.

``DOMAINS[name]()`` is a Recipe: what a user would type, and what is true of it by a count of our own
(``toggles``), without a look at fem_mesh. ``recipe.domain()`` is the fem_mesh.Domain of it.
"""

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import exact
import numpy as np
import pytest
from corpus import CORPUS, EXHAUSTIVE, on_circle

DOMAINS: dict[str, Callable[[], "Recipe"]] = {}
NONE = np.empty((0, 2))


@dataclass(frozen=True)
class Recipe:
    """Loops (closed outlines), or rows of point numbers; loose points come last."""

    points: np.ndarray
    segments: np.ndarray
    holes: np.ndarray = field(default_factory=lambda: NONE)
    loops: tuple[np.ndarray, ...] = ()
    loose: np.ndarray = field(default_factory=lambda: NONE)
    crossings: str = "error"

    @property
    def toggles(self) -> np.ndarray:
        """Whether an odd number of closed loops run along each row; rows on no cycle never do."""
        name = [self._name(v) for v in range(len(self.points))]
        edges = [tuple(sorted((name[i], name[j]))) for i, j in self.segments.tolist()]
        times = Counter(edges) if self.loops else dict.fromkeys(edges, 1)
        seen, result = set(), []
        for edge in edges:
            result.append(edge[0] != edge[1] and edge not in seen and times[edge] % 2 == 1 and self._closes(edge, edges))
            seen.add(edge)
        return np.array(result, bool)

    def _name(self, v: int) -> tuple[float, float]:
        x, y = self.points[v].tolist()
        return x + 0.0, y + 0.0

    def _closes(self, edge, edges) -> bool:
        """Whether the ends of an edge are joined without it."""
        neighbours: dict[object, list[object]] = {}
        for a, b in edges:
            if (a, b) != edge:
                neighbours.setdefault(a, []).append(b)
                neighbours.setdefault(b, []).append(a)
        reached, stack = {edge[0]}, [edge[0]]
        while stack:
            new = set(neighbours.get(stack.pop(), ())) - reached
            reached |= new
            stack += new
        return edge[1] in reached

    def domain(self):
        import fem_mesh as fm

        if self.loops:
            return fm.Domain.from_loops(*self.loops, points=self.loose, holes=self.holes, crossings=self.crossings)
        return fm.Domain(self.points, self.segments, self.holes, crossings=self.crossings)

    def scaled(self, power: int) -> "Recipe":
        s = 2.0**power
        loops = tuple(loop * s for loop in self.loops)
        return replace(self, points=self.points * s, holes=self.holes * s, loops=loops, loose=self.loose * s)


def loops(*outlines: object, loose: object = (), holes: object = ()) -> Recipe:
    """Closed outlines, as ``Domain.from_loops`` takes them."""
    each = tuple(np.array(outline, float).reshape(-1, 2) for outline in outlines)
    extra, seeds = np.array(loose, float).reshape(-1, 2), np.array(holes, float).reshape(-1, 2)
    rows, first = [], 0
    for loop in each:
        rows += [(first + i, first + (i + 1) % len(loop)) for i in range(len(loop))]
        first += len(loop)
    return Recipe(np.vstack([*each, extra]), np.array(rows), seeds, each, extra)


def rows(points: object, segments: object, holes: object = (), crossings: str = "error") -> Recipe:
    """Points and pairs of point numbers, as ``Domain`` takes them."""
    seeds = np.array(holes, float).reshape(-1, 2)
    return Recipe(np.array(points, float), np.array(segments).reshape(-1, 2), seeds, crossings=crossings)


def add(recipe: Recipe, points: object, segments: object = ()) -> Recipe:
    """The recipe as rows, with more points and more rows, which are numbered from the first new point."""
    extra = np.array(points, float).reshape(-1, 2)
    more = np.array(segments, int).reshape(-1, 2) + len(recipe.points)
    return rows(np.vstack([recipe.points, extra]), np.vstack([recipe.segments, more]), recipe.holes)


def domain(make: Callable[[], Recipe]) -> Callable[[], Recipe]:
    DOMAINS[make.__name__] = make
    return make


def over_seeds(few: int, many: int) -> Callable[[Callable[[int], None]], Callable[[int], None]]:
    """A property of a seed, tried on the first ``few`` seeds, and on ``many`` under the mark exhaustive."""

    def decorate(check: Callable[[int], None]) -> Callable[[int], None]:
        @pytest.mark.parametrize("seeds", [few, pytest.param(many, marks=EXHAUSTIVE)])
        def test(seeds: int) -> None:
            for seed in range(seeds):
                try:
                    check(seed)
                except (Exception, pytest.fail.Exception) as error:
                    error.add_note(f"seed {seed}")
                    raise

        test.__name__, test.__doc__ = check.__name__, check.__doc__
        return test

    return decorate


def box(left: float, bottom: float, right: float, top: float) -> list[tuple[float, float]]:
    return [(left, bottom), (right, bottom), (right, top), (left, top)]


def polar(degrees: float, radius: float = 1.0) -> tuple[float, float]:
    return radius * math.cos(math.radians(degrees)), radius * math.sin(math.radians(degrees))


SQUARE = box(0, 0, 1, 1)


# --- what broke others ---


@domain
def unit_square():
    """Its four corners lie on one circle."""
    return loops(SQUARE)


@domain
def ring_with_its_last_vertex_repeated():
    """A closed outline as people store it."""
    ring = on_circle(2 * np.pi * np.arange(20) / 20)
    return loops(np.vstack([ring, ring[:1]]))


@domain
def two_squares_with_a_corner_stored_twice():
    """They touch in one point, which has two numbers."""
    return loops(box(0, 0, 1, 1), box(1, 1, 2, 2))


@domain
def three_points_one_ulp_apart():
    """Segments between neighbouring doubles, near 1e5, in a large triangle."""
    up = np.nextafter(1e5, 2e5)
    big = loops([(0, 0), (3e5, 0), (0, 3e5)])
    return add(big, [(1e5, 1e5), (up, 1e5), (1e5, up), (5e4, 5e4)], [(0, 1), (0, 3)])


@domain
def a_vertex_in_the_middle_of_a_segment_then_a_segment_from_it():
    """A T: the segment must be split although its row names only its ends."""
    return rows([*SQUARE, (0.5, 0), (0.5, 0.5)], [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5)])


@domain
def a_segment_from_side_to_side():
    """Both its ends lie within sides: it cuts the square, and toggles nothing."""
    return rows([*SQUARE, (0.25, 0), (0.75, 1)], [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5)])


@domain
def hole_sharing_part_of_an_outer_side():
    """The shared part belongs to two loops: outside on both of its sides."""
    return loops(box(0, 0, 8, 8), box(2, 0, 5, 3))


@domain
def hole_sharing_a_corner_and_parts_of_two_sides():
    """What is left is an L."""
    return loops(box(0, 0, 8, 8), box(0, 0, 5, 3))


@domain
def two_loops_sharing_a_side():
    """Inside on both sides of it: it stays, as a segment, and bounds nothing."""
    return loops(box(0, 0, 4, 4), box(4, 0, 7, 4))


@domain
def two_loops_sharing_part_of_a_side():
    """The same with T's."""
    return loops(box(0, 0, 4, 4), box(4, 1, 7, 6))


@domain
def hole_touching_the_outline_in_one_vertex():
    """The boundary passes that vertex twice."""
    return loops(box(0, 0, 8, 8), [(0, 0), (4, 2), (2, 4)])


@domain
def hole_touching_a_side_from_within():
    """The hole's vertex splits the side."""
    return loops(box(0, 0, 8, 8), [(3, 0), (5, 3), (2, 4)])


@domain
def two_holes_touching_in_a_vertex():
    """Between them the domain closes to a point."""
    return loops(box(0, 0, 9, 9), box(2, 2, 4, 4), box(4, 4, 7, 7))


@domain
def seventeen_gon():
    """Regular, of radius 3 about (1, 1): nearly cocircular away from the origin."""
    return loops(1 + on_circle(2 * np.pi * np.arange(17) / 17, 3))


@domain
def grid_turned_by_302_degrees():
    """Loose points that rounding has put just inside, on, or just outside the sides."""
    grid = CORPUS["grid_turned_by_302_degrees"](64)
    return loops(grid[[0, 7, 63, 56]], loose=grid)


@domain
def grid_in_quarters():
    """seq(0.25, 2, 0.25) x seq(0.5, 2, 0.25): ties, and many points on the sides."""
    grid = CORPUS["grid_in_quarters"](56)
    return loops(box(0.25, 0.5, 2.25, 2.25), loose=grid)


@domain
def metres_of_a_survey():
    """x in [512700, 512834], y over 5.4e6: map coordinates."""
    return loops((512700, 5.4e6) + 67 * (1 + star_polygon(4, 30).points))


@domain
def vertex_1e_15_into_the_bottom_side():
    """An outline that is not convex by so little."""
    return loops([(0, 0), (0.5, 1e-15), (1, 0), (1, 1), (0, 1)])


@domain
def vertex_1e_15_above_the_bottom_side():
    """The side is a segment, and the vertex loose: no edge between them may be lost."""
    return loops(SQUARE, loose=[(0.5, 1e-15)])


@domain
def vertex_1e_15_below_the_bottom_side():
    """The vertex is outside, and stays unused."""
    return loops(SQUARE, loose=[(0.5, -1e-15)])


@domain
def chain_touching_its_own_edge():
    """An open chain that ends within its own first segment."""
    return add(loops(box(0, 0, 8, 8)), [(1, 1), (6, 1), (6, 5), (3, 1)], [(0, 1), (1, 2), (2, 3)])


@domain
def chain_running_back_on_itself():
    """Its second segment lies on its first."""
    return add(loops(box(0, 0, 8, 8)), [(1, 1), (6, 1), (3, 1), (3, 4)], [(0, 1), (1, 2), (2, 3)])


@domain
def triangle_2e_6_by_53():
    """Too thin for an absolute tolerance."""
    return loops([(0, 0), (53, 0), (0, 2e-6)])


@domain
def x_of_two_segments_in_a_square():
    """Two segments that cross, to be split."""
    return replace(add(loops(SQUARE), [(0.2, 0.2), (0.8, 0.7), (0.3, 0.9), (0.6, 0.1)], [(0, 1), (2, 3)]), crossings="split")


@domain
def kite_whose_longer_diagonal_is_the_constraint():
    """The constraint is the wrong diagonal by far."""
    return add(loops(box(-9, -9, 9, 9)), [(0, -8), (1, 0), (0, 8), (-1, 0)], [(0, 2)])


@domain
def twenty_points_of_fifteenths():
    """Loose points of the lattice 2 (i / 15) - 1 in a square that they touch."""
    return loops(box(-1, -1, 1, 1), loose=CORPUS["twenty_points_of_fifteenths"](0))


@domain
def leg_486_high_and_1_wide():
    """A long thin L, 486 : 1."""
    return loops(CORPUS["leg_486_high_and_1_wide"](0))


@domain
def crack_of_a_fiftieth_of_a_degree():
    """Two segments in a square that meet at 0.02 degrees."""
    return add(
        loops(SQUARE), [(0.25, 0.5), (0.75, 0.5), (0.25 + polar(0.02, 0.5)[0], 0.5 + polar(0.02, 0.5)[1])], [(0, 1), (0, 2)]
    )


@domain
def notch_of_a_fiftieth_of_a_degree():
    """The same, open to the side: the crack lies outside."""
    half = 0.5 * math.tan(math.radians(0.01))
    return loops([(0, 0), (1, 0), (1, 0.5 - half), (0.5, 0.5), (1, 0.5 + half), (1, 1), (0, 1)])


# --- segments that bound nothing ---


@domain
def bridge_from_the_outline_to_a_hole():
    """On no cycle: inside on both of its sides."""
    return add(
        rows([*box(0, 0, 9, 9), *box(3, 3, 6, 6)], [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4)]), []
    )


@domain
def segment_that_hangs_outside():
    """It bounds nothing, and nothing of it is meshed."""
    return rows([*SQUARE, (2, 2)], [(0, 1), (1, 2), (2, 3), (3, 0), (2, 4)])


@domain
def segment_that_leaves_through_a_corner():
    """It starts inside, passes exactly through a corner, and ends outside."""
    return add(loops(box(0, 0, 4, 4)), [(2, 2), (6, 6)], [(0, 1)])


@domain
def open_chains_and_loose_points():
    """A tree, a crack, single points."""
    tree = [(2, 2), (5, 5), (5, 8), (8, 5), (1, 7), (3, 8), (7, 2)]
    return add(loops(box(0, 0, 9, 9)), tree, [(0, 1), (1, 2), (1, 3), (4, 5)])


@domain
def rows_of_no_length_and_rows_given_twice():
    """As exports from drawing programs have them."""
    return rows([*SQUARE, (0, 0)], [(0, 1), (1, 1), (1, 2), (2, 3), (3, 4), (1, 0), (4, 0)])


@domain
def rows_that_overlap_on_a_side():
    """A side given in full and once more as two pieces that overlap: open chains over it bound nothing."""
    points = [*box(0, 0, 8, 8), (2, 0), (6, 0), (4, 0)]
    return rows(points, [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (6, 1)])


# --- nesting ---


@domain
def nested_squares():
    """Inside, outside, inside, outside: parity."""
    return loops(*(box(k, k, 16 - k, 16 - k) for k in (0, 2, 4, 6)))


@domain
def squares_nested_corner_to_side():
    """Each one's corners lie within the sides of the one around it."""
    return loops(box(0, 0, 8, 8), [(4, 0), (8, 4), (4, 8), (0, 4)], box(2, 2, 6, 6))


@domain
def holes_by_seeds():
    """Seeds decide, and nesting does not: the inner square is a region, not a hole."""
    return loops(box(0, 0, 9, 9), box(1, 1, 4, 4), box(5, 5, 8, 8), holes=[(2, 2)])


@domain
def letter_a():
    """On a grid of integers: many vertices on one line."""
    return loops([(0, 0), (2, 0), (3, 3), (6, 3), (7, 0), (9, 0), (6, 9), (3, 9)], [(4, 5), (5, 5), (5, 7), (4, 7)])


@domain
def letter_b():
    """Two holes, one above the other."""
    return loops([(0, 0), (5, 0), (6, 1), (6, 4), (5, 5), (6, 6), (6, 8), (5, 9), (0, 9)], box(2, 1, 4, 4), box(2, 6, 4, 8))


@domain
def letter_e():
    """Arms of one width: every in-circle test is a tie."""
    return loops([(0, 0), (5, 0), (5, 1), (1, 1), (1, 2), (4, 2), (4, 3), (1, 3), (1, 4), (5, 4), (5, 5), (0, 5)])


@domain
def comb():
    """Deep notches: the hull's triangles have most of the vertices."""
    return loops([(0, 0), (16, 0), *((16 - k, 8 if k % 2 else 1) for k in range(17))])


# --- angles ---


@domain
def square_in_a_square_tip_to_side():
    """Small distances between segments that do not touch."""
    return loops(box(0, 0, 8, 8), [(4, 2.0**-20), (6, 4), (4, 6), (2, 4)])


def wedge(degrees: float) -> Recipe:
    """A corner of so many degrees between sides of equal length."""
    return loops([(0, 0), (1, 0), polar(degrees)])


def fork(degrees: float) -> Recipe:
    """Two segments of lengths 1 and 0.6 that meet inside a square at so many degrees."""
    return add(loops(box(-1, -1, 2, 2)), [(0, 0), (1, 0), polar(degrees, 0.6)], [(0, 1), (0, 2)])


def pair(degrees: float, longer: float = 2**0.5) -> Recipe:
    """Lengths 1 and sqrt 2 in a wide box: at 104 degrees, with circles and no shells, each split gives a similar triangle."""
    return add(loops(box(-20, -20, 20, 20)), [(0, 0), (1, 0), polar(degrees, longer)], [(0, 1), (0, 2)])


def fan(spokes: int, degrees: float) -> Recipe:
    """Segments of many lengths that leave one vertex at equal angles."""
    tips = [polar(k * degrees, 1 + (7 * k % 5) / 8) for k in range(spokes)]
    return add(loops(box(-3, -3, 3, 3)), [(0, 0), *tips], [(0, k + 1) for k in range(spokes)])


for angle in (1, 5, 12, 20, 30, 45, 60):
    DOMAINS[f"wedge_of_{angle}_degrees"] = lambda angle=angle: wedge(angle)
for angle in (104, 105):
    DOMAINS[f"one_to_sqrt_two_at_{angle}_degrees"] = lambda angle=angle: pair(angle)
DOMAINS["fork_of_10_degrees"] = lambda: fork(10)
DOMAINS["fan_of_9_degrees"] = lambda: fan(11, 9)


# --- scales ---

DOMAINS["tiny"] = lambda: letter_a().scaled(-100)
DOMAINS["huge"] = lambda: letter_a().scaled(100)
DOMAINS["tiny_star"] = lambda: star_polygon(3, 20).scaled(-100)


# --- families, by seed ---


def star_polygon(seed: int, n: int | None = None) -> Recipe:
    """A polygon that the origin sees all of, of very different radii."""
    random = np.random.default_rng(seed)
    n = int(random.integers(4, 30)) if n is None else n
    angle = 2 * np.pi * (np.arange(n) + 0.9 * random.random(n)) / n
    return loops(on_circle(angle) * random.uniform(0.05, 1, n)[:, None])


def cells(seed: int) -> Recipe:
    """The outline of random cells of a lattice: ties everywhere, corners that only touch, holes, loose points."""
    random = np.random.default_rng(seed)
    side = int(random.integers(2, 7))
    full = np.pad(random.random((side, side)) < random.uniform(0.4, 0.9), 1)
    full[1, 1] = True
    number, edges = {}, []
    for i in range(1, side + 2):
        for j in range(1, side + 2):
            below, before = ((i, j), (i + 1, j)), ((i, j), (i, j + 1))
            sides = [below] if full[i, j] != full[i, j - 1] else []
            sides += [before] if full[i, j] != full[i - 1, j] else []
            edges += [[number.setdefault(v, len(number)) for v in edge] for edge in sides]
    loose = random.integers(1, 2 * side + 3, (int(random.integers(0, 6)), 2)) / 2
    return add(rows(list(number), edges), loose)


def random_segments(seed: int) -> Recipe:
    """In a square, random segments that do not cross: some share ends, overlap, end within others or pass over points."""
    random = np.random.default_rng(seed)
    side = int(random.choice([4, 8, 12, 1000]))
    tries = int(random.integers(5, 60))
    drawn = [(tuple(a), tuple(b)) for a, b in random.integers(0, side + 1, (tries, 2, 2)).tolist()]
    return kept_segments(side, drawn, random.integers(0, side + 1, (int(random.integers(0, 8)), 2)).tolist())


def kept_segments(side: int, drawn: object, loose: object = ()) -> Recipe:
    """Of the segments drawn in a square those that cross no earlier one and close no cycle."""
    points = box(0, 0, side, side)
    kept = exact.sides(points)
    group: dict[object, int] = dict.fromkeys(points, 0)
    for a, b in drawn:
        known = group.setdefault(a, len(group)), group.setdefault(b, len(group))
        if known[0] != known[1] and not any(crosses(a, b, c, d) for c, d in kept):
            kept.append((a, b))
            group = {p: known[0] if g == known[1] else g for p, g in group.items()}
    number = {p: i for i, p in enumerate(dict.fromkeys([p for ab in kept for p in ab] + [tuple(p) for p in loose]))}
    return rows(list(number), [(number[a], number[b]) for a, b in kept])


def crosses(a, b, c, d) -> bool:
    """Whether the insides of ab and cd meet in one point that is inside both."""
    turns = [exact.sign(exact.turn(*abc)) for abc in ((a, b, c), (a, b, d), (c, d, a), (c, d, b))]
    return turns[0] * turns[1] < 0 and turns[2] * turns[3] < 0


for seed in range(3):
    DOMAINS[f"star_polygon_{seed}"] = lambda seed=seed: star_polygon(seed)
    DOMAINS[f"lattice_cells_{seed}"] = lambda seed=seed: cells(seed)
    DOMAINS[f"random_segments_{seed}"] = lambda seed=seed: random_segments(seed)
