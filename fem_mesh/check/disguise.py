"""The same case, not to be recognised: what is nasty about it stays, to the last bit."""

from __future__ import annotations

from typing import Any

import numpy as np

Case = dict[str, Any]
IN_ORDER = ("bowyer_watson",)  # the points are inserted in their order


def disguised(check: str, case: Case, random: np.random.Generator) -> Case:
    """A case turned by quarters, scaled by a power of two, its points renumbered, its rows shuffled: all exact.

    >>> case = {"name": "one", "points": [[1.0, 0.0], [3.0, 0.0], [1.0, 2.0]], "triangles": [[0, 1, 2]]}
    >>> disguised("lawson", case, np.random.default_rng(2))
    {'name': 'one', 'points': [[0.0625, -0.03125], [0.0, -0.09375], [0.0, -0.03125]], 'triangles': [[0, 2, 1]]}
    """
    look = Look(random)
    if "calls" not in case:
        return look.of(case, renumber=check not in IN_ORDER)
    if check in ("flip", "cavity"):
        return {**case, "calls": [look.of_piece(call, check) for call in case["calls"]]}
    return {**case, "calls": [[look.place(p) for p in call] for call in case["calls"]]}


class Look:
    """One way to turn, scale and shuffle."""

    def __init__(self, random: np.random.Generator) -> None:
        self.random = random
        self.quarters = int(random.integers(4))
        self.scale = 2.0 ** int(random.integers(-6, 1))  # never larger: what a tolerance hides stays hidden

    def place(self, p: list[float]) -> list[float]:
        """Where a place comes to lie."""
        x, y = (value * self.scale for value in p)
        for _ in range(self.quarters):
            x, y = 0.0 - y, x
        return [x, y]

    def of(self, case: Case, renumber: bool) -> Case:
        """A case of points, triangles and segments."""
        order = self.random.permutation(len(case["points"])) if renumber else np.arange(len(case["points"]))
        number = order.argsort().tolist()  # of each point, in the new order
        changed = {**case, "points": [self.place(case["points"][v]) for v in order]}
        if "triangles" in case:
            rows = [np.roll([number[v] for v in row], self.random.integers(3)).tolist() for row in case["triangles"]]
            changed["triangles"] = [rows[k] for k in self.random.permutation(len(rows))]
        if "segments" in case:
            ends = [[number[v] for v in row][:: 1 - 2 * int(self.random.integers(2))] for row in case["segments"]]
            changed["segments"] = [ends[k] for k in self.random.permutation(len(ends))]
        return changed

    def of_piece(self, call: list[Any], check: str) -> list[Any]:
        """The arguments of one call: points, triangles, and an edge or a place."""
        points, triangles, last = call
        if check == "cavity":
            found = self.of({"points": points, "triangles": triangles}, renumber=True)
            return [found["points"], found["triangles"], self.place(last)]
        found = self.of({"points": points, "triangles": triangles, "segments": [last]}, renumber=True)
        return [found["points"], found["triangles"], found["segments"][0]]
