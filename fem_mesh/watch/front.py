"""The part that runs in a browser: plain ES modules, put together to one text where they are used."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path

from rjsmin import jsmin

from fem_mesh.watch.style import as_table

HERE = Path(__file__).parent
VIEW = ("geometry.js", "camera.js", "view.js", "panel.js")
PLAYER = (*VIEW, "trace.js", "timeline.js", "player.js")
PLAYER_WIDGET = (*PLAYER, "kernel.js", "player_widget.js")
PLAYGROUND = (*VIEW, "kernel.js", "mesh.js", "playground.js")
ROOM = ("drawing", "pencil", "overlay", "controls", "histogram", "stage", "board")
DOMAIN_PLAYGROUND = (*PLAYER, "kernel.js", *(f"domain_playground/{name}.js" for name in ROOM))

_NEIGHBOURS = re.compile(r'^import .* from "\.{1,2}/.*";$', re.MULTILINE)  # what a module takes from the others


def _read(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")


@cache
def css(*more: str) -> str:
    """The style sheet, and ``more`` of them, a rule a line."""
    return re.sub(r"\s+", " ", "".join(map(_read, ("view.css", *more)))).replace("} ", "}\n")


@cache
def module(names: tuple[str, ...], last: str) -> str:
    """The modules as one text, then the table of roles as STYLE, then the line ``last``."""
    style = json.dumps(as_table(), separators=(",", ":"))
    return "\n".join([*(_NEIGHBOURS.sub("", _read(name)) for name in names), f"const STYLE = {style};", last, ""])


@cache
def slim(source: str) -> str:
    """A module without comments and blanks, where it is kept in a notebook."""
    return str(jsmin(source))
