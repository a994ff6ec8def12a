"""A trace as data for the browser: the same table of lifetimes, in numbers short enough to travel."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fem_mesh.lifetimes import NEVER, Lifetimes

if TYPE_CHECKING:
    from fem_mesh.steps import Step
    from fem_mesh.trace import Trace

UNIT = 1e-6  # of the view box's width: coordinates travel as whole numbers of these
SHOWN = ("visited", "doomed", "asked", "encroached", "edges")  # of a step, besides `circles`


def as_data(trace: Trace, steps: int | None = None) -> dict[str, Any]:
    """The first ``steps`` steps of a trace (all of them by default), to be written as JSON and read by trace.js.

    ``captions`` come with it; a page that writes them as a table may leave them out.
    """
    n = len(trace) if steps is None else min(steps, len(trace))
    left, right, bottom, top = map(float, trace.view_box())
    unit = (right - left) * UNIT
    points = _lifetimes(trace.lifetimes("points"), n)
    points["rows"] = np.rint((points["rows"] - np.array([left, bottom])) / unit).astype(np.int64)
    kinds = list(dict.fromkeys(step.kind for step in trace[:n]))
    angles = trace.min_angles()[:n].round(2).tolist()
    return {
        "box": [left, right, bottom, top],
        "kinds": kinds,
        "steps": [_step(step, kinds.index(step.kind), left, bottom, unit) for step in trace[:n]],
        "captions": [step.caption for step in trace[:n]],
        "angles": [None if angle != angle else angle for angle in angles],
        "points": _flat(points),
        "triangles": _flat(_lifetimes(trace.lifetimes("triangles"), n)),
        "segments": _flat(_lifetimes(trace.lifetimes("segments"), n)),
        "makes_points": trace.makes_points,
        "more": n < len(trace) or not trace.complete,
    }


def _lifetimes(table: Lifetimes, n: int) -> dict[str, Any]:
    """The rows born before step ``n``: how much later than the row before, and how many steps each lived (0: on)."""
    born, died = table.lifetimes()
    here = born < n
    born, died = born[here], died[here]
    lived = np.where((died < n) & (died != NEVER), died - born, 0)
    later = np.diff(born, prepend=0)
    return {"rows": table.table()[here], "born": later, "lived": lived, "numbers": table.keys()[here]}


def _flat(table: dict[str, Any]) -> dict[str, list[int]]:
    return {name: array.ravel().tolist() for name, array in table.items()}


def _step(step: Step, kind: int, left: float, bottom: float, unit: float) -> dict[str, Any]:
    shown: dict[str, Any] = {"kind": kind}
    if step.point is not None and np.isfinite(step.point).all():
        x, y = step.point
        shown["point"] = [round((x - left) / unit), round((y - bottom) / unit)]
    for name in SHOWN:
        if getattr(step, name):
            shown[name] = _numbers(getattr(step, name))
    if step.circles != step.doomed:  # where they are the same, they travel once
        shown["circles"] = _numbers(step.circles)
    return shown


def _numbers(rows: Any) -> list[int]:
    return [int(number) for row in rows for number in row]
