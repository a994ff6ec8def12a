"""The folder that a grading kernel sees as its own: a small fem_mesh without solvers and without a judge, and the cases.

A check in there only calls the student's code and writes down what came. Cases are made outside, from a seed; expected
answers do not exist. So there is nothing in the room that is worth stealing, and nothing that is worth changing.
"""

from __future__ import annotations

import ast
import json
import shutil
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import fem_mesh
from fem_mesh.course.homework.sandbox import Box, Limits, packages_in
from fem_mesh.course.notebooks import NotebookError

HOME = Path(fem_mesh.__file__).parent
INSIDE = Path(__file__).with_name("inside")
ALWAYS = ("MeshError", "Step", "grid_points", "random_points", "ring_points")
PICTURES = ("DomainPlayground", "Picture", "Player", "Playground", "Trace", "play", "record")
RUN = "fem_mesh.check.run"
PRUNED = ("fem_mesh.predicates", "fem_mesh.mesh.quality")  # are needed for a little: homework may be about the rest
ALLOWED_ALGORITHM = "fem_mesh.algorithms.sweep"  # any triangulation, as bad as can be: what Lawson's flips begin with
MESHING = (  # modules that do, or nearly do, what homework asks for
    "fem_mesh.algorithms.",
    "fem_mesh.check.",
    "fem_mesh.course.",
    "fem_mesh.mesh.constrained",
    "fem_mesh.mesh.halfedge",
    "fem_mesh.mesh.removal",
    "fem_mesh.mesh.segmented",
    "fem_mesh.textbook",
)


def furnish(room: Path, uses: Sequence[str], cases: dict[str, Any], box: Box, limits: Limits) -> None:
    """Make the folder ``room``. ``uses`` are the names of fem_mesh that answers may use, ``cases`` those of each call.

    Raises NotebookError for a name that fem_mesh does not have or that must not be handed out.
    """
    package = room / "fem_mesh"
    package.mkdir(parents=True)
    homes = _homes()
    handed_out = {name: _home_of(name, homes) for name in (*ALWAYS, *uses)}
    modules = {RUN} | {module for home in handed_out.values() for module in closure(home)} | set(closure(RUN))
    for module in sorted(modules):
        _copy(module, room)
    for module in modules & set(PRUNED):
        wanted = {name for name, home in handed_out.items() if home == module} | _taken_from(module, modules)
        file = room / _path(module).relative_to(HOME.parent)
        file.write_text(pruned(file.read_text(encoding="utf-8"), wanted), encoding="utf-8")
    shutil.copyfile(INSIDE / "face.py", package / "__init__.py")
    shutil.copyfile(INSIDE / "verbs.py", package / "check" / "__init__.py")
    shutil.copyfile(INSIDE / "start.py", room / "start.py")
    solvers = [name for name in fem_mesh.__all__ if name not in handed_out and meshes(homes.get(name, ""))]
    others = sorted(set(fem_mesh.__all__) - set(handed_out) - set(solvers) - set(PICTURES))
    names = {"handed_out": handed_out, "pictures": PICTURES, "solvers": solvers, "others": others}
    (package / "names.json").write_text(json.dumps(names), encoding="utf-8")
    (package / "cases.json").write_text(json.dumps(cases), encoding="utf-8")
    (room / "settings.json").write_text(json.dumps(_settings(box, limits)), encoding="utf-8")


def check_uses(uses: Sequence[str]) -> None:
    """Raise NotebookError for the first of the names that cannot be handed out."""
    homes = _homes()
    for name in uses:
        _home_of(name, homes)


def _settings(box: Box, limits: Limits) -> dict[str, Any]:
    return {
        "memory": limits.memory << 20,
        "seconds": int(limits.total) + 10,
        "file_size": limits.memory << 17,
        "allowed": box.place.names,
        "named": box.place.named,
        "path": [packages_in(box.place)] if box.bwrap else [],
    }


def _homes() -> dict[str, str]:
    """The module that each public name of fem_mesh comes from."""
    homes = {}
    for node in ast.walk(ast.parse((HOME / "__init__.py").read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("fem_mesh"):
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                homes[alias.name] = inner if _path(inner).exists() else str(node.module)
    return homes


def _home_of(name: str, homes: dict[str, str]) -> str:
    if name not in homes or name in PICTURES:
        raise NotebookError(f'the notebook\'s metadata fem_mesh: "uses" names {name!r}, which fem_mesh does not hand out')
    if any(meshes(module) for module in closure(homes[name])):
        raise NotebookError(f'the notebook\'s metadata fem_mesh: "uses" names {name!r}, which meshes or needs what does')
    return homes[name]


def can_be_handed_out(name: str) -> bool:
    """Whether answers could be given this name of fem_mesh.

    >>> can_be_handed_out("l_shape"), can_be_handed_out("delaunay")
    (True, False)
    """
    try:
        check_uses([name])
    except NotebookError:
        return False
    return True


def meshes(module: str) -> bool:
    """Whether a module of fem_mesh holds what homework asks for, or a piece of it.

    >>> meshes("fem_mesh.algorithms.lawson"), meshes("fem_mesh.predicates")
    (True, False)
    """
    return module.startswith(MESHING) and module not in (ALLOWED_ALGORITHM, RUN)


def closure(module: str) -> list[str]:
    """The modules of fem_mesh that a module needs, itself among them.

    >>> closure("fem_mesh.mesh.points")
    ['fem_mesh.errors', 'fem_mesh.kernel', 'fem_mesh.mesh.points', 'fem_mesh.predicates']
    """
    found: set[str] = set()
    waiting = [module]
    while waiting:
        if (name := waiting.pop()) not in found:
            found.add(name)
            waiting.extend(_imports(name))
    return sorted(found)


def _imports(module: str) -> Iterator[str]:
    for node in ast.parse(_path(module).read_text(encoding="utf-8")).body:  # not those inside functions
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("fem_mesh."):
            inner = [f"{node.module}.{alias.name}" for alias in node.names]
            if _path(str(node.module)).name == "__init__.py":
                yield from inner
            else:
                yield str(node.module)


def _taken_from(module: str, modules: Iterable[str]) -> set[str]:
    """The names that ``modules`` import from ``module``."""
    nodes = (node for other in modules for node in ast.parse(_path(other).read_text(encoding="utf-8")).body)
    return {alias.name for node in nodes if isinstance(node, ast.ImportFrom) and node.module == module for alias in node.names}


def pruned(source: str, wanted: Iterable[str]) -> str:
    """A module with only those of its functions that ``wanted`` names need; its imports and constants stay.

    >>> print(pruned("A = 1\\ndef f(): return g()\\ndef g(): return A\\ndef h(): return 3", ["g"]))
    A = 1
    <BLANKLINE>
    def g():
        return A
    """
    tree = ast.parse(source)
    functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    kept: set[str] = set()
    waiting = [name for name in wanted if name in functions]
    while waiting:
        if (name := waiting.pop()) not in kept:
            kept.add(name)
            used = {node.id for node in ast.walk(functions[name]) if isinstance(node, ast.Name)}
            waiting.extend(used & set(functions))
    tree.body = [node for node in tree.body if not isinstance(node, ast.FunctionDef) or node.name in kept]
    return ast.unparse(tree)


def _path(module: str) -> Path:
    path = HOME.joinpath(*module.split(".")[1:])
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def _copy(module: str, room: Path) -> None:
    path = _path(module)
    goal = room / "fem_mesh" / path.relative_to(HOME)
    goal.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(path, goal)
    for folder in goal.relative_to(room).parents[:-2]:
        (room / folder / "__init__.py").touch()
