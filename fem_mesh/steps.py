"""Step: what an algorithm tells while it works."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

Triangle = tuple[int, int, int]


class Step:
    """One step of an algorithm. Immutable; applying and undoing it cost its own size.

    kind : a short word: "locate", "cavity", "insert", "test", "flip", ...
    caption : one plain sentence with the numbers that decided it, made when it is read
    added, removed : the triangles that come and go, triples of point numbers
    new_points : the points that come, triples (number, x, y)
    point : what the step is about, a pair (x, y), or None
    edges : pairs of point numbers to show
    doomed : triangles about to go
    visited : triangles looked at on the way
    circles : triangles whose circumcircles to show
    new_segments, gone_segments : the edges that become segments, and those that are none any more
    gone_points : the numbers of the points that go
    asked : pairs of point numbers that are to become segments
    encroached : segments to show as encroached upon, with their diametral circles
    facts : the numbers behind the caption, by name; ``makes_points`` of the first step says that later points are not
        given but made, so that no picture shows them before they come

    A lecturer's own generator yields steps with the *full current lists* instead of differences, and
    may go on changing them: :func:`record` copies them at the yield and works out what changed.

    >>> step = Step("insert", "point 2 joins", points=[(0, 0), (1, 0), (0, 1)], triangles=[(0, 1, 2)])
    >>> step
    Step insert: point 2 joins
    """

    __slots__ = (
        "_caption", "added", "asked", "circles", "doomed", "edges", "encroached", "facts", "gone_points", "gone_segments",
        "kind", "new_points", "new_segments", "point", "points", "removed", "triangles", "visited",
    )  # fmt: skip

    _caption: str | Callable[[Step], str]
    kind: str
    added: tuple[Triangle, ...]
    removed: tuple[Triangle, ...]
    new_points: tuple[tuple[int, float, float], ...]
    point: tuple[float, float] | None
    edges: tuple[tuple[int, int], ...]
    doomed: tuple[Triangle, ...]
    visited: tuple[Triangle, ...]
    circles: tuple[Triangle, ...]
    new_segments: tuple[tuple[int, int], ...]
    gone_segments: tuple[tuple[int, int], ...]
    gone_points: tuple[int, ...]
    asked: tuple[tuple[int, int], ...]
    encroached: tuple[tuple[int, int], ...]
    facts: dict[str, Any]
    points: Any
    triangles: Any

    def __init__(
        self,
        kind: str,
        caption: str | Callable[[Step], str] = "",
        *,
        points: Any = None,
        triangles: Any = None,
        added: Iterable[Any] = (),
        removed: Iterable[Any] = (),
        new_points: Iterable[Any] = (),
        point: Any = None,
        edges: Iterable[Any] = (),
        doomed: Iterable[Any] = (),
        visited: Iterable[Any] = (),
        circles: Iterable[Any] = (),
        new_segments: Iterable[Any] = (),
        gone_segments: Iterable[Any] = (),
        gone_points: Iterable[int] = (),
        asked: Iterable[Any] = (),
        encroached: Iterable[Any] = (),
        **facts: Any,
    ) -> None:
        put = object.__setattr__
        put(self, "kind", kind)
        put(self, "_caption", caption)
        put(self, "added", _tuples(added))
        put(self, "removed", _tuples(removed))
        put(self, "new_points", _tuples(new_points))
        put(self, "point", None if point is None else tuple(point))
        put(self, "edges", _tuples(edges))
        put(self, "doomed", _tuples(doomed))
        put(self, "visited", _tuples(visited))
        put(self, "circles", _tuples(circles))
        put(self, "new_segments", _tuples(new_segments))
        put(self, "gone_segments", _tuples(gone_segments))
        put(self, "gone_points", tuple(gone_points))
        put(self, "asked", _tuples(asked))
        put(self, "encroached", _tuples(encroached))
        put(self, "facts", facts)
        put(self, "points", points)
        put(self, "triangles", triangles)

    @property
    def caption(self) -> str:
        """One plain sentence: what happens, and the numbers that decided it."""
        return self._caption if isinstance(self._caption, str) else self._caption(self)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"a Step does not change: {name!r} cannot be set")

    def __getstate__(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in self.__slots__}

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name, value in state.items():
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        return f"Step {self.kind}: {self.caption}" if self.caption else f"Step {self.kind}"


def many(n: int, thing: str) -> str:
    """ "1 flip", "2 flips".

    >>> many(2, "flip")
    '2 flips'
    """
    return f"{n} {thing}{'s' * (n != 1)}"


def counted(n: int, thing: str) -> str:
    """ "1,234 points", "1 point".

    >>> counted(1234, "point")
    '1,234 points'
    """
    return f"{n:,} {thing}{'s' * (n != 1)}"


def _tuples(items: Iterable[Any]) -> tuple[Any, ...]:
    if isinstance(items, tuple) and (not items or isinstance(items[0], tuple)):
        return items
    return tuple(tuple(item.tolist() if hasattr(item, "tolist") else item) for item in items)
