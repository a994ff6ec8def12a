"""A page of feedback for a student: what was right, what went wrong first, and its picture.

All that stands on it may come from a stranger. Texts are escaped, pictures are images, and the page forbids scripts.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Iterator
from html import escape
from typing import Any

from fem_mesh.check import Verdict
from fem_mesh.course.homework.results import BY_HAND, NOT_GRADED, UNANSWERED, UNWRITTEN, Marked, Result, clean

LARGEST = 2_000_000  # characters of a picture
SHORT = (UNWRITTEN, UNANSWERED, NOT_GRADED)  # is said beside the points, and no more
_CODE = re.compile(r"`([^`\n]+)`")
_BOX = re.compile(r"viewBox=['\"]\S+ \S+ (\d[\d.]{0,8}) (\d[\d.]{0,8})")
_SAID_TWICE = re.compile(r"\s*\(\s*[\d.]+ points?\s*\)\s*$", re.IGNORECASE)
_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
:root {{ color-scheme: light dark; --line: #8884; --soft: #8881; --right: #009e73; --wrong: #d55e00; }}
body {{ font: 1rem/1.55 system-ui, sans-serif; max-width: 46rem; margin: 2.5rem auto; padding: 0 1.25rem; }}
h1 {{ font-size: 1.5rem; line-height: 1.25; margin: 0; }} h2 {{ font-size: 1.1rem; line-height: 1.35; margin: 0; }}
h1 + p {{ margin: .25rem 0 1.75rem; }}
p {{ margin: .6rem 0 0; }} p, h1, h2, li {{ overflow-wrap: anywhere; }}
section {{ border: 1px solid var(--line); border-left: .3rem solid #888; border-radius: .4rem; }}
section {{ padding: .9rem 1.1rem 1rem; margin: 1rem 0; }}
section.right {{ border-left-color: var(--right); }} section.wrong {{ border-left-color: var(--wrong); }}
header {{ display: flex; flex-wrap: wrap; justify-content: space-between; align-items: baseline; gap: .1rem 1.5rem; }}
.points {{ margin: 0; white-space: nowrap; font-variant-numeric: tabular-nums; opacity: .75; }}
code, pre {{ font: .9em/1.5 ui-monospace, monospace; background: var(--soft); border-radius: .25rem; }}
code {{ padding: .1em .3em; }}
pre {{ white-space: pre-wrap; overflow-wrap: anywhere; padding: .7rem .9rem; margin: .8rem 0 0; }}
img {{ display: block; max-width: 100%; max-height: 24rem; background: #fff; border-radius: .3rem; margin: 0 auto; }}
figure {{ margin: .9rem 0 0; overflow-x: auto; }}
@media (max-width: 36rem) {{ img.wide {{ max-width: none; width: 34rem; }} }}
footer {{ margin-top: 2rem; font-size: .9rem; opacity: .85; }} footer h2 {{ font-size: 1rem; }}
ul {{ margin: .3rem 0 1rem; padding-left: 1.2rem; }}
@media (prefers-color-scheme: dark) {{ img {{ filter: invert(.93) hue-rotate(180deg); }} }}
</style>
</head>
<body>
{body}
</body>
</html>
"""


def page(result: Result, homework: str, penalty: float = 0) -> str:
    """The page of one student, as HTML that needs no network. ``penalty`` is taken off the points."""
    title = f"{homework}: {result.student}"
    parts = [f"<h1>{escape(title)}</h1>", f"<p>{_sum(result, penalty)}</p>", *_trouble(result), *map(_task, result.tasks)]
    about = [*_notes(result), *_findings(result)]
    parts += ["<footer>", *about, "</footer>"] if about else []
    return clean(_PAGE.format(title=escape(title), body="\n".join(parts)))


def points(number: float, most: float | None = None) -> str:
    """A number of points in words.

    >>> points(1), points(0.5), points(2, 3)
    ('1 point', '0.5 points', '2 of 3 points')
    """
    last = number if most is None else most
    return f"{number:g}{'' if most is None else f' of {most:g}'} point{'s' * (last != 1)}"


def _sum(result: Result, penalty: float) -> str:
    said = points(max(0, result.score - penalty), result.most - result.waiting)
    if penalty:
        said += f", {points(abs(penalty))} {'taken off' if penalty > 0 else 'added'} by hand"
    return said + (f", and {result.waiting:g} more that are given by hand" if result.waiting else "")


def _trouble(result: Result) -> Iterator[str]:
    if result.trouble:
        yield f'<section class="wrong"><h2>Not graded</h2><p>{_prose(result.trouble)}</p></section>'


def _task(task: Marked) -> str:
    state, said = _state(task)
    title = _prose(_SAID_TWICE.sub("", task.title))
    parts = [f'<section class="{state}">', f'<header><h2>{title}</h2><p class="points">{said}</p></header>']
    message = task.message.removeprefix(BY_HAND).removeprefix("; ")
    if message and message not in SHORT and not task.by_hand:
        parts.append(f"<p>{_prose(message)}</p>")
    if task.text:
        parts.append(f"<pre>{escape(task.text)}</pre>")
    first_wrong = next((verdict for verdict in task.verdicts if not verdict.get("right")), None)
    if first_wrong:
        parts.append(_picture(first_wrong))
    return "\n".join([*parts, "</section>"])


def _state(task: Marked) -> tuple[str, str]:
    """The colour of a task, and its points in words."""
    short = task.message if task.message in SHORT else ""
    if task.score is None:
        return "", f"{points(task.points)}: {short or BY_HAND}"
    if task.by_hand:
        return "right" if task.score == task.points else "", f"{points(task.score, task.points)}: by hand"
    is_right = bool(task.score) or all(verdict.get("right") for verdict in task.verdicts or [{}])
    state, word = ("right", "right") if is_right else ("wrong", "not yet right")
    return state, f"{points(task.score, task.points)}: {short or word}"


def _prose(text: str) -> str:
    """A sentence as HTML, with `code` in it set as such."""
    return _CODE.sub(r"<code>\1</code>", escape(text))


def _picture(told: dict[str, Any]) -> str:
    """What was found beside what was expected, as an image: in an image nothing runs."""
    try:
        verdict = Verdict(**told)
        drawing = verdict.draw()
        svg = "" if drawing is None else str(drawing.svg)
    except Exception:  # what is to be drawn came from a stranger, and no picture is worth the page
        return ""
    if not 0 < len(svg) <= LARGEST:
        return ""
    data = base64.b64encode(svg.encode()).decode()
    box = _BOX.search(svg)  # side by side is too small for a telephone
    kind = ' class="wide"' if box and float(box[1]) > 1.5 * float(box[2]) else ""
    return f'<figure><img{kind} alt="{escape(verdict.message)}" src="data:image/svg+xml;base64,{data}"></figure>'


def _notes(result: Result) -> Iterator[str]:
    if result.notes:
        yield "<h2>About the notebook</h2>\n<ul>" + "".join(f"<li>{_prose(note)}</li>" for note in result.notes) + "</ul>"


def _findings(result: Result) -> Iterator[str]:
    if result.trouble or not result.findings:
        return
    yield "<h2>What stands out in the code</h2>\n<p>It says nothing about the marks.</p>"
    lines = (f"<li>{escape(found.cell)}, line {found.line}: {escape(found.what)}</li>" for found in result.findings)
    yield "<ul>" + "".join(lines) + "</ul>"
