"""A page of feedback for a student: what was right, what went wrong first, and its picture.

All that stands on it may come from a stranger. Texts are escaped, pictures are images, and the page forbids scripts.
"""

from __future__ import annotations

import base64
from collections.abc import Iterator
from html import escape
from typing import Any

from fem_mesh.check import Verdict
from fem_mesh.course.homework.results import Marked, Result

LARGEST = 2_000_000  # characters of a picture
_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
:root {{ color-scheme: light dark; }}
body {{ font: 1rem/1.5 system-ui, sans-serif; max-width: 46rem; margin: 2rem auto; padding: 0 1rem; }}
h1 {{ font-size: 1.5rem; }} h2 {{ font-size: 1.15rem; margin: 0; }}
section {{ border: 1px solid #8886; border-left: .4rem solid #888; border-radius: .3rem; padding: .8rem 1rem; margin: 1rem 0; }}
section.right {{ border-left-color: #009e73; }} section.wrong {{ border-left-color: #d55e00; }}
.points {{ float: right; }} p {{ margin: .5rem 0; overflow-wrap: anywhere; }}
pre {{ white-space: pre-wrap; overflow-wrap: anywhere; background: #8882; padding: .6rem; border-radius: .3rem; }}
img {{ max-width: 100%; background: #fff; border-radius: .3rem; }}
</style>
</head>
<body>
{body}
</body>
</html>
"""


def page(result: Result, homework: str) -> str:
    """The page of one student, as HTML that needs no network."""
    title = f"{homework}: {result.student}"
    by_hand = sum(task.points for task in result.tasks if task.score is None)
    head = f"<h1>{escape(title)}</h1>\n<p>{result.score:g} of {result.most - by_hand:g} points"
    head += f", and {by_hand:g} more that are given by hand</p>" if by_hand else "</p>"
    parts = [head, *_trouble(result), *map(_task, result.tasks), *_notes(result), *_findings(result)]
    return _PAGE.format(title=escape(title), body="\n".join(parts))


def _trouble(result: Result) -> Iterator[str]:
    if result.trouble:
        yield f'<section class="wrong"><h2>Not graded</h2><p>{escape(result.trouble)}</p></section>'


def _task(task: Marked) -> str:
    state, word = ("", "by hand") if task.score is None else ("right", "right") if task.score else ("wrong", "not yet right")
    points = f"{task.points:g}" if task.score is None else f"{task.score:g} of {task.points:g}"
    parts = [f'<section class="{state}">', f'<p class="points">{points} points: {word}</p>', f"<h2>{escape(task.title)}</h2>"]
    parts.append(f"<p>{escape(task.message)}</p>")
    if task.text:
        parts.append(f"<pre>{escape(task.text)}</pre>")
    first_wrong = next((verdict for verdict in task.verdicts if not verdict.get("right")), None)
    if first_wrong:
        parts.append(_picture(first_wrong))
    return "\n".join([*parts, "</section>"])


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
    return f'<img alt="{escape(verdict.message)}" src="data:image/svg+xml;base64,{data}">'


def _notes(result: Result) -> Iterator[str]:
    if result.notes:
        yield "<h2>About the notebook</h2>\n<ul>" + "".join(f"<li>{escape(note)}</li>" for note in result.notes) + "</ul>"


def _findings(result: Result) -> Iterator[str]:
    if result.trouble:
        return
    yield "<h2>A look at the code</h2>"
    if not result.findings:
        yield "<p>Nothing stands out.</p>"
        return
    yield "<p>This stands out, and says nothing about the marks:</p>"
    lines = (f"<li>{escape(found.cell)}, line {found.line}: {escape(found.what)}</li>" for found in result.findings)
    yield "<ul>" + "".join(lines) + "</ul>"
