"""HTML that is readable as it stands, and a player where scripts run. No kernel, no network."""

from __future__ import annotations

import html
import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem_mesh.errors import MeshError
from fem_mesh.watch.front import PLAYER, css, module, slim
from fem_mesh.watch.svg import data_uri, svg_of_step
from fem_mesh.watch.wire import as_data

if TYPE_CHECKING:
    from fem_mesh.trace import Trace

MOST_EMBEDDED = 60_000  # bytes of a cell's output in a saved notebook
MOST_LISTED = 200  # steps in the table of a trace that is too long to be embedded whole
LONGEST = 20_000  # steps of a saved page
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>:root {{ color-scheme: light dark; }} body {{ margin: 1em auto; max-width: 800px; }}</style></head>
<body>
{body}</body></html>
"""


def html_of_trace(trace: Trace, stands_in: str = "", note: str = "") -> str:
    """What a cell shows of a trace: a player if that takes up to 60 kB, else its first frame and a table of steps.

    ``stands_in`` is the key of the widget in whose absence alone it is shown; ``note`` stands below the picture.
    """
    whole = _readable(trace, len(trace), stands_in, note, as_data(trace))
    if len(whole.encode()) <= MOST_EMBEDDED:
        return whole
    note = f'{note} All of it: fm.play(trace), or trace.save("steps.html").'.strip()
    n = min(len(trace), MOST_LISTED)
    while True:  # ends: n falls to 1
        part = _readable(trace, n, stands_in, note)
        if len(part.encode()) <= MOST_EMBEDDED or n == 1:
            return part
        n //= 2


def html_of_picture(svg: str, says: str, stands_in: str, note: str) -> str:
    """A still picture of a widget, with a sentence that says what it shows."""
    picture = f'<img src="{data_uri(svg)}" alt="{html.escape(says)}">' if svg else ""
    return _frame(f"<p>{html.escape(says)}</p>\n{picture}\n<p><em>{html.escape(note)}</em></p>\n", stands_in)


def save_page(trace: Trace, path: Path, steps: Iterable[int] | None = None, **options: Any) -> None:
    """Write a trace as one HTML file that plays anywhere, without a network: its first 20,000 steps."""
    if steps is not None or options:
        given = ", ".join(["steps"] * (steps is not None) + list(options))
        raise MeshError(f"an .html keeps all steps, and its reader chooses how to see them: leave out {given}")
    data = as_data(trace, LONGEST)
    body = _readable(trace, len(data["steps"]), "", "", data)
    path.write_text(PAGE.format(title=html.escape(repr(trace)), body=body), encoding="utf-8")


def _readable(trace: Trace, n: int, stands_in: str, note: str, data: dict[str, Any] | None = None) -> str:
    """The first frame, its caption and the first ``n`` steps in words; with ``data``, a player too."""
    caption = html.escape(f"step 0 of {len(trace) - 1}, {trace[0].kind}: {trace[0].caption}")
    rows = "\n".join(
        f"<tr><td>{k}<td>{html.escape(step.kind)}<td>{html.escape(step.caption)}" for k, step in enumerate(trace[:n])
    )
    rest = f"\n<tr><td>…<td><td>and {len(trace) - n:,} more steps" if n < len(trace) else ""
    body = (
        f"<p>{html.escape(repr(trace))}</p>\n"
        f'<img src="{data_uri(svg_of_step(trace, 0))}" alt="{caption}">\n'
        f"<p>{caption}</p>\n"
        + (f'<p class="fem-note"><em>{html.escape(note)}</em></p>\n' if note else "")
        + "<details><summary>all steps in words</summary><table><thead><tr><th>step<th>kind<th>what happens</thead>\n"
        f"<tbody>\n{rows}{rest}\n</tbody></table></details>\n"
    )
    if data is None:
        return _frame(body, stands_in)
    del data["captions"]  # they stand in the table
    numbers = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
    body += f'<script type="application/json" class="fem-data">{numbers}</script>\n'
    script = slim(module(PLAYER, "mountPlayers(STYLE);"))
    return _frame(body, stands_in) + f'<script type="module">\n{script}</script>\n'


def _frame(body: str, stands_in: str) -> str:
    key = f' data-stands-in="{stands_in}"' if stands_in else ""
    return f'<style>{css()}</style>\n<div class="fem-mesh fem-still"{key}>\n{body}</div>\n'
