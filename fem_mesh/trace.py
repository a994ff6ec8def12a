"""Trace: a run recorded so that one can go back.

A trace is a table of *lifetimes*: each triangle (and each point) with the step that brought it and the
step that took it. The mesh after step k is the rows born by then and not yet gone, so any frame is as
near as any other, and a trace takes the memory of its changes.
"""

from __future__ import annotations

import heapq
import math
import operator
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.lifetimes import Lifetimes
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.points import view_box
from fem_mesh.mesh.quality import angles
from fem_mesh.steps import Step, Triangle, many

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation


SHOWN = {"visited": 3, "doomed": 3, "circles": 3, "edges": 2, "asked": 2, "encroached": 2}  # how many numbers each row has


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
        self._triangles, self._points, self._segments = Lifetimes("i", 3), Lifetimes("d", 2), Lifetimes("i", 2)
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

    def lifetimes(self, of: Literal["points", "triangles", "segments"]) -> Lifetimes:
        """Everything of a kind that ever was, with the step that brought it and the step that took it."""
        return {"points": self._points, "triangles": self._triangles, "segments": self._segments}[of]

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

    def animate(self, fps: float = 2.0, **options: Any) -> FuncAnimation:
        """The run as a Matplotlib animation, ``fps`` steps a second; ``options`` are those of ``draw``, and ``steps``.

        In a notebook ``HTML(trace.animate().to_jshtml())`` plays it.

        >>> import fem_mesh as fm
        >>> film = fm.record(fm.bowyer_watson([(0, 0), (4, 0), (0, 3), (3, 2)])).animate(fps=1, steps=[0, 1, 3])
        >>> film.save("film.gif", writer="pillow")  # doctest: +SKIP
        """
        from fem_mesh.watch.film import animate

        return animate(self, fps, **options)

    def save(self, path: Any, **options: Any) -> None:
        """Write the run as a page that plays (.html), a film (.gif, .mp4) or a contact sheet (.png); the ending decides."""
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
        from fem_mesh.watch.page import html_of_trace

        return {"text/plain": repr(self), "text/html": html_of_trace(self)}

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
        new, dropped = [], []
        if step.points is not None:
            given = self._read_points(step)
            known = self._points.current()
            new = [(i, *p) for i, p in enumerate(given) if known.get(i) != p]
            dropped = [i for i in known if i >= len(given)]
        self._check_shown(step)
        before = self._triangles.current()
        now = before if step.triangles is None else {_turned(t): t for t in self._read_triangles(step)}
        return Step(
            step.kind, step._caption,
            added=[t for key, t in now.items() if key not in before],
            removed=[t for key, t in before.items() if key not in now],
            new_points=new, gone_points=[*step.gone_points, *dropped], point=step.point, edges=step.edges, doomed=step.doomed,
            visited=step.visited, circles=step.circles, new_segments=step.new_segments, gone_segments=step.gone_segments,
            asked=step.asked, encroached=step.encroached, **step.facts,
        )  # fmt: skip

    def _read_points(self, step: Step) -> list[tuple[float, ...]]:
        points = [tuple(map(float, p)) for p in step.points]
        for i, p in enumerate(points):
            if len(p) != 2 or not (math.isfinite(p[0]) and math.isfinite(p[1])):
                raise MeshError(f"step {len(self)} ({step.kind}): point {i} = {p} is no pair of finite numbers")
        return points

    def _read_triangles(self, step: Step) -> list[Triangle]:
        k, n, result = len(self), self._count(step), list[Triangle]()
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

    def _check_shown(self, step: Step) -> None:
        n = self._count(step)
        for name, width in SHOWN.items():
            for row in getattr(step, name):
                if len(row) != width or not all(isinstance(i, int | np.integer) and 0 <= i < n for i in row):
                    what = f"{name} hold {row!r}, which are no {width} numbers of points: there are {n}"
                    raise MeshError(f"step {len(self)} ({step.kind}): {what}")

    def _count(self, step: Step) -> int:
        """How many points a step with full lists may speak of."""
        return max(len(step.points) if step.points is not None else 0, self._points.size)


def _turned(triangle: Any) -> Triangle:
    """The same triangle with its lowest vertex first."""
    a, b, c = triangle
    return (a, b, c) if a < b and a < c else (b, c, a) if b < c else (c, a, b)
