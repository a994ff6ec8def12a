"""Exact geometry in Python's integers: slow, short, and independent of fem_mesh."""

from collections.abc import Iterable, Sequence

Pair = tuple[int, int]


def integers(points: Iterable[Sequence[float]]) -> list[Pair]:
    """The points times the one power of two that makes every coordinate an integer."""
    ratios = [(float(x).as_integer_ratio(), float(y).as_integer_ratio()) for x, y in points]
    scale = max((denominator for pair in ratios for _, denominator in pair), default=1)
    return [(nx * (scale // dx), ny * (scale // dy)) for (nx, dx), (ny, dy) in ratios]


def turn(a: Pair, b: Pair, c: Pair) -> int:
    """Twice the area of abc, positive if counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def plane(a: Pair, b: Pair, c: Pair) -> tuple[int, int, int, int]:
    """(p, q, r, s) such that p x + q y + r (x^2 + y^2) < s exactly inside the circle of the counter-clockwise abc."""
    (ux, uy, uz), (vx, vy, vz) = ((q[0] - a[0], q[1] - a[1], lift(q) - lift(a)) for q in (b, c))
    p, q, r = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    return p, q, r, p * a[0] + q * a[1] + r * lift(a)


def lift(point: Pair) -> int:
    return point[0] * point[0] + point[1] * point[1]


def inside(a: Pair, b: Pair, c: Pair, d: Pair) -> int:
    """Positive if d lies strictly inside the circle of the counter-clockwise abc, 0 on it."""
    p, q, r, s = plane(a, b, c)
    return s - p * d[0] - q * d[1] - r * lift(d)


def sees_wide(a: Pair, b: Pair, p: Pair) -> int:
    """Positive if p sees ab under more than 90 degrees, 0 under exactly 90."""
    return -(a[0] - p[0]) * (b[0] - p[0]) - (a[1] - p[1]) * (b[1] - p[1])


def sign(value: float) -> int:
    return (value > 0) - (value < 0)


def hull(points: Iterable[Pair]) -> list[Pair]:
    """The distinct points on the convex hull's boundary, counter-clockwise, those within its sides too."""

    def chain(ordered: list[Pair]) -> list[Pair]:
        result: list[Pair] = []
        for point in ordered:
            while len(result) > 1 and turn(result[-2], result[-1], point) < 0:
                result.pop()
            result.append(point)
        return result[:-1]

    ordered = sorted(set(points))
    return chain(ordered) + chain(ordered[::-1])


def hull_area(points: Iterable[Sequence[float]]) -> int:
    """Twice the area of the convex hull, in the units of ``integers``."""
    return sum(turn((0, 0), a, b) for a, b in sides(hull(integers(points))))


def sides(polygon: list[Pair]) -> list[tuple[Pair, Pair]]:
    return list(zip(polygon, polygon[1:] + polygon[:1], strict=True))


def apexes(triangles: Iterable[Sequence[int]]) -> dict[tuple[int, int], int]:
    """The third vertex of the triangle on the left of each directed edge."""
    left: dict[tuple[int, int], int] = {}
    for a, b, c in triangles:
        for start, end, apex in ((a, b, c), (b, c, a), (c, a, b)):
            assert (start, end) not in left, f"two triangles on the left of {start}-{end}"
            left[start, end] = apex
    return left


def check_triangulation(points: Iterable[Sequence[float]], triangles: Sequence[Sequence[int]]) -> None:
    """Counter-clockwise triangles on all the distinct points that cover the convex hull, once."""
    whole = integers(points)
    areas = [turn(*(whole[v] for v in triangle)) for triangle in triangles]
    assert min(areas) > 0
    assert {whole[v] for triangle in triangles for v in triangle} == set(whole)
    left, border = apexes(triangles), hull(whole)
    assert {(whole[a], whole[b]) for a, b in left if (b, a) not in left} == set(sides(border))
    assert sum(areas) == hull_area(points)
    assert len(triangles) == 2 * len(set(whole)) - len(border) - 2


def check_every_circle(points: Iterable[Sequence[float]], triangles: Sequence[Sequence[int]]) -> None:
    """No point lies strictly inside any triangle's circle: every triangle against every point."""
    whole = integers(points)
    lifted = [(x, y, lift((x, y))) for x, y in whole]
    for triangle in triangles:
        p, q, r, s = plane(*(whole[v] for v in triangle))
        assert min(p * x + q * y + r * z for x, y, z in lifted) == s, f"the circle of {tuple(triangle)} is not empty"


def check_across_edges(points: Iterable[Sequence[float]], triangles: Sequence[Sequence[int]]) -> None:
    """No circle holds the vertex across an edge: enough for a triangulation of the hull (Delaunay 1934)."""
    assert min(signs_across_edges(points, triangles), default=0) >= 0


def is_unique(points: Iterable[Sequence[float]], triangles: Sequence[Sequence[int]]) -> bool:
    """Whether no other triangulation is Delaunay: each vertex across an edge lies strictly outside the circle."""
    return min(signs_across_edges(points, triangles), default=1) > 0


def signs_across_edges(points: Iterable[Sequence[float]], triangles: Sequence[Sequence[int]]) -> list[int]:
    whole, left = integers(points), apexes(triangles)
    return [-inside(whole[a], whole[b], whole[c], whole[left[b, a]]) for (a, b), c in left.items() if a < b and (b, a) in left]
