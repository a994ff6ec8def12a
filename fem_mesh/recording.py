"""Recording: a generator of steps, taken some steps at a time, and kept as a trace."""

from __future__ import annotations

import math
import time
from collections.abc import Generator, Iterable
from typing import Any

import numpy as np

from fem_mesh.errors import MeshError
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.steps import Step
from fem_mesh.trace import Trace


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
    recording = Recording(steps, view)
    recording.take(limit)
    return recording.trace


class Recording:
    """A generator that is being recorded, some steps at a time: ``trace`` is what there is so far."""

    def __init__(self, steps: Iterable[Step], view: tuple[float, float, float, float] | None = None) -> None:
        if not isinstance(steps, Iterable):
            raise MeshError(f"a generator of steps is wanted, not {steps!r:.80}" + "; call it, with ()" * callable(steps))
        self.trace = Trace()
        self.trace.view = _as_view(view)
        self.trace.complete = False
        self._failed: Exception | None = None
        self._steps = iter(steps)
        self._waiting: list[Step] = []  # a step that was taken to see whether there is one

    def take(self, limit: int | None, seconds: float = math.inf) -> None:
        """Record up to ``limit`` further steps, at least one, for some ``seconds``; ``trace.complete`` says if that was all."""
        trace, begin, end = self.trace, len(self.trace), time.monotonic() + seconds
        if self._failed is not None:
            raise self._failed
        while not trace.complete:  # ends with the generator, or at the limit
            try:
                step = self._waiting.pop() if self._waiting else next(self._steps)
            except StopIteration as stop:
                trace.complete = True
                trace.mesh = stop.value if isinstance(stop.value, Mesh) else _last_frame(trace)
                return
            except Exception as error:  # a generator that failed would look as if it had ended
                self._failed = error
                raise
            taken = len(trace) - begin
            if (limit is not None and taken >= limit) or (taken and time.monotonic() > end):
                self._waiting.append(step)
                trace.mesh = _last_frame(trace)
                return
            if not isinstance(step, Step):
                raise MeshError(f"step {len(trace)} is {step!r}: a generator to record must yield fm.Step(...)")
            trace.append(step)


def _as_view(view: Any) -> tuple[float, float, float, float] | None:
    if view is None:
        return None
    try:
        left, right, bottom, top = map(float, view)
    except (TypeError, ValueError):
        left = right = bottom = top = math.nan
    if not (-math.inf < left < right < math.inf and -math.inf < bottom < top < math.inf):
        raise MeshError(f"view is left, right, bottom, top, with left < right and bottom < top: not {view!r:.80}")
    return left, right, bottom, top


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
