"""Trace: a run recorded so that one can go back.

A trace is a table of *lifetimes*: each triangle (and each point) with the step that brought it and the
step that took it. The mesh after step k is the rows born by then and not yet gone, so any frame is as
near as any other, and a trace takes the memory of its changes.
"""

from __future__ import annotations

import heapq
import operator
from array import array
from collections import Counter
from collections.abc import Generator, Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.points import view_box
from fem_mesh.mesh.quality import angles
from fem_mesh.steps import Step, Triangle, many

NEVER = np.iinfo(np.int32).max


class Trace(Sequence[Step]):
    """A recorded run: ``len(trace)``, ``trace[k]``, iteration; every frame at once, forward and back.

    mesh : the result the algorithm returned; for a lecturer's own generator the last frame
    counts : how many steps there are of each kind
    complete : False if ``record`` stopped at its limit

    >>> import fem_mesh as fm
    >>> trace = fm.record(fm.bowyer_watson([(0, 0), (4, 0), (0, 3), (3, 2)]))
    >>> trace
    Trace: 5 steps (start 1, locate 1, cavity 1, insert 1, done 1), 4 points, 2 triangles
    >>> trace[3].caption
    'point 3 is joined to the 2 edges around the cavity: 2 triangles come, 1 goes'
    """

    def __init__(self) -> None:
        self._steps: list[Step] = []
        self._triangles, self._points, self._segments = _Lifetimes("i", 3), _Lifetimes("d", 2), _Lifetimes("i", 2)
        self.view: tuple[float, float, float, float] | None = None
        self.complete = True
        self.mesh: Mesh | None = None

    # ---- a sequence of steps ---------------------------------------------------------------------

    def __len__(self) -> int:
        return len(self._steps)

    def __getitem__(self, k: Any) -> Any:
        return self._steps[k]

    def __iter__(self) -> Iterator[Step]:
        return iter(self._steps)

    @property
    def counts(self) -> dict[str, int]:
        return dict(Counter(step.kind for step in self._steps))

    def frame(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """Points and triangles after step ``k``: float64 (n, 2), nan where a point has not come yet; int32 (m, 3)."""
        k = range(len(self))[k]
        numbers, coordinates = self._points.at(k)
        points = np.full((self._points.size, 2), np.nan)
        points[numbers] = coordinates
        return points, self._triangles.at(k)[1]

    def segments(self, k: int) -> np.ndarray:
        """The edges that are segments after step ``k``: int32 (j, 2)."""
        return self._segments.at(range(len(self))[k])[1]

    @property
    def makes_points(self) -> bool:
        """Whether later points are not given but made (see ``Step``)."""
        return bool(self._steps) and bool(self[0].facts.get("makes_points"))

    def points_to_come(self, k: int) -> np.ndarray:
        """The points that come after step ``k``, but for the one it is about: float64 (j, 2)."""
        if self.makes_points:
            return np.empty((0, 2))
        born, _ = self._points.lifetimes()
        later = self._points.table()[born > k]
        point = self[k].point
        return later if point is None else later[(later != point).any(axis=1)]

    def all_points(self) -> np.ndarray:
        """Every point that ever comes, where it was last: float64 (n, 2)."""
        return self._points.final(self._points.size)

    def view_box(self) -> tuple[float, float, float, float]:
        """left, right, bottom, top of every picture of this trace."""
        if self.view is not None:
            return self.view
        return view_box(self._points.table())

    def min_angles(self) -> np.ndarray:
        """The smallest angle after each step, in degrees: float64 (len(trace),), nan while there is no triangle."""
        if self._points.size < len(self._points.table()):  # points move: each frame has its own angles
            frames = (angles(*self.frame(k)) for k in range(len(self)))
            return np.array([frame.min() if len(frame) else np.nan for frame in frames])
        table, born, died = self._triangles.table(), *self._triangles.lifetimes()
        coordinates = self._points.final(self._points.size)
        smallest = angles(coordinates, table).min(axis=1) if len(table) else np.empty(0)
        result, row = np.full(len(self), np.nan), 0
        alive: list[tuple[float, int]] = []  # a heap of angle and row
        for k in range(len(self)):
            while row < len(table) and born[row] <= k:
                heapq.heappush(alive, (smallest[row], row))
                row += 1
            while alive and died[alive[0][1]] <= k:
                heapq.heappop(alive)
            if alive:
                result[k] = alive[0][0]
        return result

    # ---- showing ---------------------------------------------------------------------------------

    def draw(self, k: int, *ax: Any, **options: Any) -> Any:
        """Draw step ``k`` on Matplotlib axes ``ax``, or without them as a picture of its own.

        ``options`` are those of ``fem_mesh.watch.draw.draw_step``: circles, numbers, legend, dark. In a notebook,
        ``ipywidgets.interact(trace.draw, k=(0, len(trace) - 1))`` steps through the trace.
        """
        from fem_mesh.watch.draw import draw_step

        return draw_step(self, k, *ax, **options)

    def save(self, path: Any, **options: Any) -> None:
        """Write the run as a film (.gif, .mp4) or a contact sheet (.png); the ending decides."""
        from fem_mesh.watch.film import save_trace

        save_trace(self, path, **options)

    def __repr__(self) -> str:
        kinds = ", ".join(f"{kind} {count}" for kind, count in self.counts.items())
        facts = [many(len(self), "step") + (f" ({kinds})" if kinds else "")]
        if self._steps:
            points, triangles = self.frame(-1)
            facts += [f"{int((~np.isnan(points[:, 0])).sum())} points", many(len(triangles), "triangle")]
        return "Trace: " + ", ".join(facts) + ("" if self.complete else ", stopped at the limit")

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> Any:
        if not self._steps:
            return {"text/plain": repr(self)}
        from fem_mesh.watch.film import picture_of_trace

        return picture_of_trace(self)._repr_mimebundle_()

    # ---- recording -------------------------------------------------------------------------------

    def append(self, step: Step) -> None:
        """Add a step to the end. A step with full lists is turned into the difference to the frame before."""
        k = len(self._steps)
        if step.points is not None or step.triangles is not None:
            step = self._difference(step)
        for number in step.gone_points:
            self._points.end(number, k)
        for number, x, y in step.new_points:
            self._points.end(number, k)
            self._points.begin(number, (x, y), k)
        for triangle in step.removed:
            if not self._triangles.end(_turned(triangle), k):
                raise MeshError(f"step {k} ({step.kind}) removes triangle {triangle}, which is not there")
        for triangle in step.added:
            if _turned(triangle) in self._triangles.alive:
                raise MeshError(f"step {k} ({step.kind}) adds triangle {triangle}, which is there already")
            self._triangles.begin(_turned(triangle), triangle, k)
        for a, b in step.gone_segments:
            self._segments.end((min(a, b), max(a, b)), k)
        for a, b in step.new_segments:
            self._segments.end((min(a, b), max(a, b)), k)
            self._segments.begin((min(a, b), max(a, b)), (a, b), k)
        self._steps.append(step)

    def _difference(self, step: Step) -> Step:
        k = len(self._steps)
        if step.points is not None:
            given = [tuple(map(float, p)) for p in step.points]
            known = self._points.current()
            new = [(i, *p) for i, p in enumerate(given) if known.get(i) != p]
            for number in [i for i in known if i >= len(given)]:
                self._points.end(number, k)
        else:
            new = []
        before = self._triangles.current()
        now = before if step.triangles is None else {_turned(t): t for t in self._read_triangles(step)}
        return Step(
            step.kind, step._caption,
            added=[t for key, t in now.items() if key not in before],
            removed=[t for key, t in before.items() if key not in now],
            new_points=new, gone_points=step.gone_points, point=step.point, edges=step.edges, doomed=step.doomed,
            visited=step.visited, circles=step.circles, new_segments=step.new_segments, gone_segments=step.gone_segments,
            asked=step.asked, encroached=step.encroached, **step.facts,
        )  # fmt: skip

    def _read_triangles(self, step: Step) -> list[Triangle]:
        k, n = len(self._steps), len(step.points) if step.points is not None else self._points.size
        result = []
        for t in step.triangles:
            try:
                a, b, c = map(operator.index, t)
            except TypeError:
                raise MeshError(f"step {k} ({step.kind}): triangle {t!r} is no triple of point numbers") from None
            except ValueError:
                raise MeshError(f"step {k} ({step.kind}): triangle {t!r} has not three corners") from None
            if not 0 <= min(a, b, c) <= max(a, b, c) < n:
                raise MeshError(f"step {k} ({step.kind}): triangle {t!r} names a point that is not there: there are {n}")
            result.append((a, b, c))
        return result


def record(
    steps: Iterable[Step] | Generator[Step, None, Any],
    limit: int | None = 200_000,
    view: tuple[float, float, float, float] | None = None,
) -> Trace:
    """Run a generator of steps to its end, or to ``limit`` steps, and keep them all.

    ``view`` = (left, right, bottom, top) fixes what pictures show; without it they show every point.
    A generator that is still running after ``limit`` steps gives an incomplete trace, which says so.

    >>> def two_triangles():
    ...     points, triangles = [(0, 0), (1, 0), (0, 1), (1, 1)], [(0, 1, 2)]
    ...     yield Step("start", "one triangle", points=points, triangles=triangles)
    ...     triangles.append((1, 3, 2))
    ...     yield Step("insert", "and another", points=points, triangles=triangles)
    >>> trace = record(two_triangles())
    >>> trace[1].added
    ((1, 3, 2),)
    >>> trace.mesh
    Mesh: 4 points, 2 triangles, smallest angle 45.0 degrees, a last frame, not validated
    """
    trace = Trace()
    trace.view = view
    iterator = iter(steps)
    result = None
    while True:  # ends with the generator, or at the limit
        try:
            step = next(iterator)
        except StopIteration as stop:
            result = stop.value
            break
        if limit is not None and len(trace) >= limit:
            trace.complete = False
            break
        if not isinstance(step, Step):
            raise MeshError(f"step {len(trace)} is {step!r}: a generator to record must yield fm.Step(...)")
        trace.append(step)
    trace.mesh = result if isinstance(result, Mesh) else _last_frame(trace)
    return trace


def _last_frame(trace: Trace) -> Mesh | None:
    if not len(trace):
        return None
    points, triangles = trace.frame(-1)
    there = np.flatnonzero(~np.isnan(points[:, 0]))
    points = points[: there[-1] + 1 if len(there) else 0]
    note = "a last frame, not validated"
    try:
        return Mesh(points, triangles, note=note)
    except MeshError:  # broken, or with gaps among its points: to look at, all the same
        return Mesh._of(points, triangles, np.full((len(triangles), 3), -1, np.int32), note=note)


def _turned(triangle: Any) -> Triangle:
    """The same triangle with its lowest vertex first."""
    a, b, c = triangle
    return (a, b, c) if a < b and a < c else (b, c, a) if b < c else (c, a, b)


class _Lifetimes:
    """Rows of numbers, each under a key, each with the step that began and the step that ended it."""

    def __init__(self, typecode: str, width: int) -> None:
        self._rows, self._width = array(typecode), width
        self._born, self._died, self._keys = array("i"), array("i"), array("i")
        self.alive: dict[Any, int] = {}

    @property
    def size(self) -> int:
        """One more than the highest number among the keys (points only)."""
        return max(self._keys, default=-1) + 1

    def begin(self, key: Any, row: Any, k: int) -> None:
        self.alive[key] = len(self._born)
        self._rows.extend(row)
        self._born.append(k)
        self._died.append(NEVER)
        self._keys.append(key if isinstance(key, int) else 0)

    def end(self, key: Any, k: int) -> bool:
        row = self.alive.pop(key, None)
        if row is not None:
            self._died[row] = k
        return row is not None

    def current(self) -> dict[Any, tuple[Any, ...]]:
        w = self._width
        return {key: tuple(self._rows[w * row : w * row + w]) for key, row in self.alive.items()}

    def table(self) -> np.ndarray:
        return np.array(self._rows).reshape(-1, self._width)

    def lifetimes(self) -> tuple[np.ndarray, np.ndarray]:
        return np.array(self._born), np.array(self._died)

    def at(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """The keys and rows alive after step k."""
        born, died = self.lifetimes()
        alive = (born <= k) & (k < died)
        return np.array(self._keys)[alive], self.table()[alive]

    def final(self, size: int) -> np.ndarray:
        """The last row of each key."""
        result = np.full((size, self._width), np.nan)
        if size:
            result[np.array(self._keys)] = self.table()
        return result
