"""What stands out in a student's code. Never a mark, only lines for whoever reads the feedback.

A scan of the text, which any code can slip past; what it must not slip past is the sandbox.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from fem_mesh.course.homework.inside.start import MESHERS

USUAL = {
    "abc",
    "bisect",
    "cmath",
    "collections",
    "copy",
    "dataclasses",
    "decimal",
    "enum",
    "fem_mesh",
    "fractions",
    "functools",
    "__future__",
    "heapq",
    "itertools",
    "math",
    "matplotlib",
    "numbers",
    "numpy",
    "operator",
    "random",
    "re",
    "statistics",
    "string",
    "time",
    "typing",
}
POWERFUL = {"eval", "exec", "compile", "__import__", "open", "globals", "locals", "vars", "setattr", "delattr", "breakpoint",
            "input", "get_ipython"}  # fmt: skip
LONG = 200  # characters of a text that somebody hardly types
MANY = 60  # numbers of a list, rows and all, or in a text
MOST = 20  # lines told of one submission


@dataclass(frozen=True)
class Finding:
    """Something that stands out: in which cell, on which of its lines, and what it is."""

    cell: str
    line: int
    what: str


def scan(answers: Mapping[str, str], added: Sequence[str], uses: Iterable[str]) -> list[Finding]:
    """What stands out in answer cells and in cells that the student added.

    >>> scan({"answer-1": "import scipy.spatial"}, [], [])
    [Finding(cell='answer-1', line=1, what='imports scipy.spatial, which meshes')]
    """
    cells = [*answers.items(), *((f"added cell {k + 1}", source) for k, source in enumerate(added))]
    found = [Finding(name, line, what) for name, source in cells for line, what in sorted(set(_lines(source, set(uses))))]
    return found[:MOST]


def _lines(source: str, uses: set[str]) -> Iterator[tuple[int, str]]:
    for number, text in enumerate(source.splitlines(), 1):
        if re.match(r"\s*[!%]", text):
            yield number, "speaks to the shell or to IPython"
    try:
        tree = ast.parse(re.sub(r"(?m)^\s*[!%].*$", "pass", source))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return  # the task says so
    for node in ast.walk(tree):
        for what in _about(node, uses):
            yield int(getattr(node, "lineno", 1)), what


def _about(node: ast.AST, uses: set[str]) -> Iterator[str]:
    if isinstance(node, ast.Import):
        yield from (what for alias in node.names if (what := _about_module(alias.name)))
    elif isinstance(node, ast.ImportFrom):
        names = [f"{node.module}.{alias.name}" for alias in node.names]
        yield from {what for name in names if (what := _about_module(name))}
        if node.module == "fem_mesh":
            yield from (what for alias in node.names if (what := _about_name(alias.name, uses)))
    elif isinstance(node, ast.Attribute):
        if isinstance(node.value, ast.Name) and node.value.id in ("fm", "fem_mesh") and (what := _about_name(node.attr, uses)):
            yield what
        elif node.attr.startswith("__") and node.attr not in ("__init__", "__name__", "__doc__"):
            yield f"reaches for {node.attr}"
    elif isinstance(node, ast.Name) and node.id in POWERFUL:
        yield f"uses {node.id}"
    elif isinstance(node, ast.List | ast.Tuple | ast.Set):
        items = sum(isinstance(inner, ast.Constant) for inner in ast.walk(node))
        if items > MANY:
            yield f"holds a list of {items} items"
    elif isinstance(node, ast.Constant) and isinstance(node.value, str | bytes) and _is_blob(node.value):
        yield f"holds a text of {len(node.value)} characters that is no prose"


def _about_module(name: str) -> str:
    top = name.partition(".")[0]
    if top in MESHERS or name.startswith(("fem_mesh.algorithms", "fem_mesh.textbook", "matplotlib._qhull", "matplotlib.tri")):
        return f"imports {name}, which meshes"
    if name.count(".") > 1 and top == "fem_mesh":
        return f"imports {name}, past what is handed out"
    if top not in USUAL:
        return f"imports {name}" if top in sys.stdlib_module_names else f"imports {name}, which is not handed out"
    return ""


def _about_name(name: str, uses: set[str]) -> str:
    import fem_mesh
    from fem_mesh.course.homework.room import ALWAYS, PICTURES

    given = uses | {*ALWAYS, *PICTURES, "check"}
    return f"uses fm.{name}, which is not handed out" if name in fem_mesh.__all__ and name not in given else ""


def _is_blob(text: str | bytes) -> bool:
    words = text.split()
    return len(text) > LONG and (len(words) == 1 or sum(any(sign.isdigit() for sign in str(word)) for word in words) > MANY)
