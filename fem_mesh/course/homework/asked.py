"""What a check cell asks for, read from the instructor's notebook: what a student's kernel says of it does not count."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from copy import deepcopy
from typing import Any

import numpy as np

import fem_mesh
from fem_mesh.check import cases_of, mesh_case
from fem_mesh.course.homework.cells import Call, calls_in, role
from fem_mesh.course.notebooks import NotebookError

KNOWN: dict[str, Any] = {"fm": fem_mesh, "fem_mesh": fem_mesh, "np": np}
PLACES = ("points", "triangles", "delaunay", "min_angle", "domain")  # the arguments of check.mesh

REPEATING = (ast.For, ast.While, ast.FunctionDef, ast.Lambda, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)


def cases_of_call(call: Call, seed: int, given: Mapping[str, ast.expr] | None = None) -> list[dict[str, Any]]:
    """The cases that a call's answer is judged on. ``given`` are the instructor's variables (:func:`given_in`).

    Raises NotebookError where the call does not say enough.

    >>> cases_of_call(Call("mesh", "fm.check.mesh(p, t, domain=fm.square(), min_angle=25)"), 0)[0]["min_angle"]
    25.0
    """
    try:
        return [mesh_case(**_asked_of_mesh(call, given or {}))] if call.name == "mesh" else cases_of(call.name, seed)
    except NotebookError:
        raise
    except Exception as error:  # whatever the instructor's own expression raises
        raise NotebookError(f"{call.text}: {type(error).__name__}: {error}") from None


def refuse_unreadable(source: str) -> None:
    """Raise NotebookError where a check cell's calls cannot be read off it: checks under other names, or in a loop.

    >>> refuse_unreadable("for f in (mine, yours): fm.check.orient(f)")
    Traceback (most recent call last):
    fem_mesh.course.notebooks.NotebookError: fm.check.orient(f) stands in a loop or a function: write each call of a check out
    """
    tree = _parsed(source)
    nodes = list(ast.walk(tree)) if tree else []
    called = {id(node.func.value) for node in nodes if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)}
    for node in nodes:
        named = isinstance(node, ast.ImportFrom) and (node.module or "").startswith("fem_mesh.check")
        named |= isinstance(node, ast.Attribute) and node.attr == "check" and id(node) not in called
        if named:
            raise NotebookError(f"{ast.unparse(node)}: write each call as fm.check.orient(f), for the grader reads the name")
        if isinstance(node, REPEATING):
            for call in calls_in(ast.unparse(node)):
                raise NotebookError(f"{call.text} stands in a loop or a function: write each call of a check out")


def _asked_of_mesh(call: Call, given: Mapping[str, ast.expr]) -> dict[str, Any]:
    node = _Put(given).visit(ast.parse(call.text, mode="eval").body)
    written = dict(zip(PLACES, node.args, strict=False)) | {word.arg: word.value for word in node.keywords if word.arg}
    asked = {name: _value(node) for name, node in written.items() if name in PLACES and name != "triangles" and _is_known(node)}
    for name in ("delaunay", "min_angle", "domain"):
        if name in written and name not in asked:
            raise NotebookError(f"{call.text}: {name} must be written out, or made in a cell that is not an answer")
    if asked.get("domain") is None and asked.get("points") is None:
        raise NotebookError(
            f"{call.text}: say what is to be meshed, by its points or domain=..., written out or made in a cell that is not an "
            "answer: of what a student's cell makes, the grader cannot know what it should be"
        )
    return asked


class _Put(ast.NodeTransformer):
    """Puts what the instructor's variables are in their places."""

    def __init__(self, given: Mapping[str, ast.expr]) -> None:
        self.given, self.inside = given, set[str]()

    def visit_Name(self, node: ast.Name) -> ast.AST:  # so ast calls it
        if node.id not in self.given or node.id in self.inside:
            return node
        self.inside.add(node.id)
        put: ast.AST = self.visit(deepcopy(self.given[node.id]))
        self.inside.discard(node.id)
        return put


def given_in(notebook: Any) -> dict[str, ast.expr]:
    """What the instructor's cells, other than answers, assign to a name once: ``points = fm.random_points(20, seed=1)``."""
    found: dict[str, list[ast.expr]] = {}
    for cell in notebook.cells:
        tree = _parsed(cell.source) if cell.cell_type == "code" and role(cell) in ("given", "check") else None
        for node in tree.body if tree else ():
            if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
                found.setdefault(node.targets[0].id, []).append(node.value)
    return {name: values[0] for name, values in found.items() if len(values) == 1}


def _parsed(source: str) -> ast.Module | None:
    try:
        return ast.parse(source)
    except (SyntaxError, ValueError, RecursionError):  # a magic, say
        return None


def _is_known(node: ast.expr) -> bool:
    return {name.id for name in ast.walk(node) if isinstance(name, ast.Name)} <= set(KNOWN)


def _value(node: ast.expr) -> Any:
    """What an expression of the instructor's is, with nothing in it but fem_mesh and NumPy."""
    return eval(compile(ast.Expression(node), "<check>", "eval"), dict(KNOWN))


def names_in(sources: Iterable[str]) -> set[str]:
    """The public names of fem_mesh that code uses, as ``fm.name`` or from an import.

    >>> sorted(names_in(["fm.check.mesh(p, t, domain=fm.square())"]))
    ['square']
    """
    names = set()
    for source in sources:
        tree = _parsed(source)
        for node in ast.walk(tree) if tree else ():
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in ("fm", "fem_mesh"):
                names.add(node.attr)
            elif isinstance(node, ast.ImportFrom) and node.module == "fem_mesh":
                names |= {alias.name for alias in node.names}
    return names & set(fem_mesh.__all__) - {"check"}
