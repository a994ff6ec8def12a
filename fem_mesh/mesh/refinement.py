"""Refinement: what ``refine`` reports with the mesh it gives."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Refinement:
    """What ``refine`` achieved, and what it had to leave.

    complete : every triangle keeps the bounds, but for those at a small input angle, which no mesher can mend
    added : points added
    left : the triangles that miss a bound, int32 (k,)
    why : the reason for each of them: "small input angle", "budget" or "precision"
    off_curve : added points that had to stay on a chord, since the way to their curve was not free
    min_angle : the bound that was asked for, in degrees
    """

    complete: bool
    added: int
    left: np.ndarray
    why: tuple[str, ...]
    off_curve: int
    min_angle: float

    def __repr__(self) -> str:
        state = "complete" if self.complete else "incomplete"
        facts = [f"{state}, {self.added:,} point{'s' * (self.added != 1)} added"]
        facts += [f"{count:,} triangle{'s' * (count != 1)} left ({why})" for why, count in Counter(self.why).items()]
        facts += [f"{self.off_curve:,} of the points left on a chord"] if self.off_curve else []
        return "Refinement: " + ", ".join(facts)
