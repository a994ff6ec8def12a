"""The roles that things play in a picture: one table for every renderer.

Each role has a colour of Okabe and Ito's palette (2008), readable to colour-blind eyes; a second cue,
so that colour never carries meaning alone; and the word that captions and legends use.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILLION, PURPLE = "#0072B2", "#D55E00", "#CC79A7"


@dataclass(frozen=True)
class Role:
    """How one role looks. ``dark`` is its colour on a dark ground."""

    word: str
    color: str
    dark: str
    width: float = 1.0  # of lines, in points
    dash: tuple[float, ...] = ()  # on and off lengths, in line widths
    hatch: str = ""
    fill: float = 0.0  # opacity
    marker: str = ""
    size: float = 0.0  # of markers, in points


ROLES = {
    "mesh": Role("triangle", "#777777", "#9A9A9A", width=0.9),
    "visited": Role("looked at", BLUE, SKY, width=1.6, hatch="..", fill=0.14),
    "doomed": Role("about to go", VERMILLION, "#FF8A4C", width=1.8, hatch="///", fill=0.20),
    "gone": Role("gone", VERMILLION, "#FF8A4C", width=1.6, dash=(2.0, 2.0)),
    "new": Role("new", GREEN, "#2FD1A2", width=2.2, fill=0.22),
    "circle": Role("circumcircle", BLUE, SKY, width=1.1, dash=(6.0, 3.0)),
    "edge": Role("edge", ORANGE, ORANGE, width=4.0),
    "segment": Role("segment", BLACK, "#FFFFFF", width=3.2),
    "asked": Role("to be a segment", BLACK, "#FFFFFF", width=1.8, dash=(4.0, 2.0)),
    "encroached": Role("encroached", VERMILLION, "#FF8A4C", width=4.4, dash=(1.6, 0.7)),
    "diametral": Role("diametral circle", VERMILLION, "#FF8A4C", width=1.2, dash=(1.0, 2.0)),
    "vertex": Role("vertex", "#222222", "#DDDDDD", marker="o", size=4.5),
    "waiting": Role("to come", "#888888", "#888888", marker="o", size=3.5),
    "point": Role("point", PURPLE, "#F29BC9", width=2.4, marker="o", size=13.0),
    "voronoi": Role("Voronoi edge", GREEN, "#2FD1A2", width=1.5, dash=(4.0, 1.5, 1.0, 1.5)),
    "tie": Role("cocircular: either diagonal would do", PURPLE, "#F29BC9", width=2.6, dash=(2.0, 1.2)),
    "skinny": Role("skinny", ORANGE, ORANGE, width=1.0, fill=0.6),
    "inside": Role("inside", SKY, BLUE, width=0.0, fill=0.22),
    "curve": Role("its curve", PURPLE, "#F29BC9", width=1.6, dash=(3.0, 1.5)),
    "hole": Role("in a hole", VERMILLION, "#FF8A4C", width=2.6, marker="x", size=9.0),
    "spot": Role("small triangles wanted", PURPLE, "#F29BC9", width=1.3, marker="o", size=7.0),
    "wrong": Role("wrong", VERMILLION, "#FF8A4C", width=2.0, hatch="///", fill=0.20),
    "wrong edge": Role("wrong edge", VERMILLION, "#FF8A4C", width=4.4, dash=(1.6, 0.9)),
    "expected": Role("expected", GREEN, "#2FD1A2", width=2.0, fill=0.22),
    "expected edge": Role("expected edge", GREEN, "#2FD1A2", width=4.4),
    "region": Role("region", GREEN, "#2FD1A2", width=1.0, marker="D", size=8.0),
}

KINDS = {  # of steps: the role whose colour a kind wears where all steps are seen at once
    "locate": "visited", "test": "visited", "cavity": "doomed", "cross": "doomed", "carve": "doomed", "clear": "doomed",
    "remove": "doomed", "encroached": "doomed", "skinny": "doomed", "large": "doomed", "long": "doomed",
    "insert": "new", "flip": "new", "segment": "new", "split": "new", "steiner": "new", "lift": "new", "move": "point",
    "merge": "edge", "reject": "edge", "skip": "edge", "precision": "edge", "budget": "edge",
    "solve": "visited", "estimate": "visited", "mark": "doomed", "refine": "new", "sweep": "new",
}  # fmt: skip

STILL = {"inside", "curve", "hole", "region", "wrong", "wrong edge", "expected", "expected edge"}  # that no widget draws

PAPER = {False: "#FFFFFF", True: "#111318"}
INK = {False: "#1A1A1A", True: "#EDEDED"}


VIEWS = 20  # circles larger than so many views are drawn as an arc
MOST_NUMBERS = 60  # more points than this go without numbers, unless asked
THINNEST = 1.6  # of the thick lines, in points
FULL_SIZE = 120  # up to so many vertices have markers of full size
MOST_MARKED = 1_000  # more vertices than this go without a marker


def color_of(name: str, dark: bool = False) -> str:
    """The colour of a role on a light or a dark ground."""
    return ROLES[name].dark if dark else ROLES[name].color


def as_table() -> dict[str, Any]:
    """All of this as the browser takes it; what a role has by default is left out."""
    roles = {
        name: {f.name: getattr(role, f.name) for f in fields(role) if getattr(role, f.name) != f.default}
        for name, role in ROLES.items()
        if name not in STILL
    }
    limits = {"views": VIEWS, "numbers": MOST_NUMBERS, "thinnest": THINNEST, "fullSize": FULL_SIZE, "marked": MOST_MARKED}
    return {"roles": roles, "limits": limits, "paper": list(PAPER.values()), "ink": list(INK.values()), "kinds": KINDS}
