"""What a verdict shows, as plain values: panels side by side, theirs first, then what was expected."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from fem_mesh.check.verdict import Picture

Rows = Iterable[Sequence[int]]


def panel(
    title: str,
    triangles: Rows = (),
    *,
    points: Any = None,
    wrong: Rows = (),
    right: Rows = (),
    wrong_edges: Rows = (),
    right_edges: Rows = (),
    edges: Rows = (),
    segments: Rows = (),
    circles: Rows = (),
    diametral: Rows = (),
    point: Iterable[int] = (),
    words: Sequence[str] = (),
) -> dict[str, Any]:
    """One panel: rows of point numbers. ``edges`` are those that the title speaks of, ``circles`` are circumcircles of
    triangles, ``diametral`` those over edges, ``point`` wears a ring, ``words`` stand for the points' numbers,
    ``points`` are its own ones."""
    rows = {
        "triangles": triangles, "wrong": wrong, "right": right, "wrong_edges": wrong_edges, "right_edges": right_edges,
        "edges": edges, "segments": segments, "circles": circles, "diametral": diametral,
    }  # fmt: skip
    shown: dict[str, Any] = {name: sorted([int(v) for v in row] for row in given) for name, given in rows.items()}
    shown.update(title=title, point=[int(v) for v in point], words=list(words))
    if points is not None:
        shown["points"] = np.asarray(points, float).tolist()
    return {name: value for name, value in shown.items() if value}


def beside(points: Any, *panels: dict[str, Any]) -> Picture:
    """Panels side by side, over the same points."""
    return {"points": np.asarray(points, float).tolist(), "panels": list(panels)}
