"""The chapter's algorithms, as short as on a page, with what a page leaves out as its price.

* ``in_circle`` uses plain floats and an absolute tolerance: it fails where points nearly share a circle,
  and at other scales than 1.
* ``lawson`` with it may never end: it gives up after ``most`` flips.
* ``bowyer_watson`` looks at every triangle for every point, O(n^2), and starts from a super-triangle: it
  loses triangles at the hull, and points outside the super-triangle vanish.

For lessons and for comparison; ``fm.delaunay`` has none of these limits. Both algorithms are generators
that yield :class:`fem_mesh.Step` with plain lists, as a lecturer would write them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence

from fem_mesh.steps import Step

Point = Sequence[float]
Triangle = tuple[int, int, int]
SUPER_TRIANGLE = ((-10.0, -10.0), (12.0, -10.0), (1.0, 20.0))  # around the unit square


def in_circle(a: Point, b: Point, c: Point, d: Point, tolerance: float = 1e-12) -> bool:
    """Whether d lies inside the circle of the counter-clockwise triangle abc, in floats, by a tolerance."""
    (ax, ay), (bx, by), (cx, cy) = ((p[0] - d[0], p[1] - d[1]) for p in (a, b, c))
    det = (
        (ax * ax + ay * ay) * (bx * cy - cx * by)
        + (bx * bx + by * by) * (cx * ay - ax * cy)
        + (cx * cx + cy * cy) * (ax * by - bx * ay)
    )
    return bool(det > tolerance)


def sides(triangle: Triangle) -> list[tuple[int, int]]:
    """The three edges of a triangle, each with the triangle on its left."""
    a, b, c = triangle
    return [(a, b), (b, c), (c, a)]


def lawson(
    points: Sequence[Point],
    triangles: Sequence[Triangle],
    inside: Callable[..., bool] = in_circle,
    most: int = 1000,
) -> Iterator[Step]:
    """Flip edges whose circle holds the vertex across, until there is none, or ``most`` are flipped.

    >>> start = [(0, 1, 2), (0, 2, 3)]
    >>> for step in lawson([(0, 0), (4, 0), (5, 3), (1, 2)], start):
    ...     print(step)
    Step flip: edge 0-2 becomes 1-3
    Step done: 1 flip
    """
    triangles = [(int(a), int(b), int(c)) for a, b, c in triangles]
    flips = 0
    while flips < most:
        apex = {edge: (set(t) - set(edge)).pop() for t in triangles for edge in sides(t)}
        for (a, b), c in apex.items():
            d = apex.get((b, a))
            if d is not None and inside(points[a], points[b], points[c], points[d]):
                break
        else:
            yield Step("done", f"{flips} flip{'s' * (flips != 1)}", points=points, triangles=triangles)
            return
        triangles = [t for t in triangles if not {a, b} <= set(t)] + [(a, d, c), (d, b, c)]
        flips += 1
        low, high = sorted((c, d))
        caption = f"edge {min(a, b)}-{max(a, b)} becomes {low}-{high}"
        yield Step("flip", caption, points=points, triangles=triangles, edges=[(c, d)])
    yield Step("gave up", f"still not done after {most} flips", points=points, triangles=triangles)


def bowyer_watson(
    points: Sequence[Point],
    super_triangle: Sequence[Point] = SUPER_TRIANGLE,
    inside: Callable[..., bool] = in_circle,
) -> Iterator[Step]:
    """Insert point by point: dig out all triangles whose circles hold it, and fan the hole.

    >>> for step in bowyer_watson([(0, 0), (1, 0), (0, 1)]):
    ...     print(step)
    Step insert: point 0: 1 triangle goes, 3 come
    Step insert: point 1: 2 triangles go, 4 come
    Step insert: point 2: 2 triangles go, 4 come
    Step done: 1 triangle without the super-triangle
    """
    n = len(points)
    everything = [*points, *super_triangle]
    triangles = [(n, n + 1, n + 2)]
    for p in range(n):
        bad = [t for t in triangles if inside(*(everything[v] for v in t), everything[p])]
        count = Counter(frozenset(edge) for t in bad for edge in sides(t))
        ring = [edge for t in bad for edge in sides(t) if count[frozenset(edge)] == 1]
        triangles = [t for t in triangles if t not in bad] + [(u, v, p) for u, v in ring]
        goes = f"{len(bad)} triangle{'s go' if len(bad) != 1 else ' goes'}"
        yield Step(
            "insert", f"point {p}: {goes}, {len(ring)} come", points=everything, triangles=triangles, point=everything[p]
        )
    kept = [t for t in triangles if max(t) < n]
    caption = f"{len(kept)} triangle{'s' * (len(kept) != 1)} without the super-triangle"
    yield Step("done", caption, points=points, triangles=kept)


def delaunay(points: Sequence[Point], **options: object) -> list[Triangle]:
    """The triangles that ``bowyer_watson`` ends with.

    >>> delaunay([(0, 0), (1, 0), (0, 1), (1, 1)])
    [(0, 1, 2), (2, 1, 3)]
    """
    *_, last = bowyer_watson(points, **options)  # type: ignore[arg-type]
    return list(last.triangles)
