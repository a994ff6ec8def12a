"""The house stands as it was drawn: who may import whom, and how long a room may be."""

import ast
import inspect
from pathlib import Path

import pytest

import fem_mesh as fm

ROOT = Path(fm.__file__).parent
FILES = sorted(path for path in ROOT.rglob("*.py") if path.name != "__init__.py")
FLOORS = [
    "errors",
    "kernel",
    "predicates",
    "mesh",
    "domain",
    "files",
    "steps",
    "textbook",
    "algorithms",
    "lifetimes",
    "trace",
    "recording",
    "poisson",
    "watch",
    "check",
    "course",
]  # from the ground up
SHOWING = {  # the methods that show or export import what they call inside themselves
    ("mesh/mesh.py", "fem_mesh.watch.draw"),
    ("domain/domain.py", "fem_mesh.watch.outline"),
    ("mesh/mesh.py", "fem_mesh.files.endings"),
    ("mesh/mesh.py", "fem_mesh.files.formats"),
    ("mesh/mesh.py", "fem_mesh.files.solvers"),
    ("domain/domain.py", "fem_mesh.files.endings"),
    ("trace.py", "fem_mesh.watch.draw"),
    ("trace.py", "fem_mesh.watch.film"),
    ("trace.py", "fem_mesh.watch.page"),
}


def floor(name):
    return FLOORS.index(name.removeprefix("fem_mesh.").split(".")[0])


def imports(path):
    """(module, whether inside a function or for types only) of every import of ours."""
    tree = ast.parse(path.read_text())
    inner = {id(n) for f in ast.walk(tree) if isinstance(f, ast.FunctionDef | ast.If) for n in ast.walk(f)}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("fem_mesh"):
            yield node.module, id(node) in inner


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_import_points_up(path):
    own = str(path.relative_to(ROOT))
    for module, inside in imports(path):
        name = own.removesuffix(".py").replace("/", ".")
        if floor(module) > floor(name):
            assert inside, f"{own} imports {module}, which stands above it"
            assert (own, module) in SHOWING


def test_only_kernel_knows_numba():
    assert [p.name for p in FILES if "import numba" in p.read_text() or "from numba" in p.read_text()] == ["kernel.py"]


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_rooms_stay_small(path):
    source = path.read_text()
    assert len(source.splitlines()) <= 330
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef):
            body = node.end_lineno - node.lineno + 1 - len((ast.get_docstring(node) or "").splitlines())
            # A kernel's generator cannot be cut: `yield from` does not compile.
            yields = any(isinstance(inner, ast.Yield) for inner in ast.walk(node))
            assert body <= (80 if yields and node.decorator_list else 50), f"{path.name}: {node.name} has {body} lines"


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_function_but_kernels_states_its_types(path):
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.FunctionDef) and not any("kernel" in ast.unparse(d) for d in node.decorator_list):
            if node.name in ("_index", "_scratch"):  # Numba reads these
                continue
            arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
            assert node.returns is not None, f"{path.name}: {node.name}"
            assert all(a.annotation for a in arguments if a.arg not in ("self", "cls")), f"{path.name}: {node.name}"


@pytest.mark.parametrize("name", sorted(fm.__all__))
def test_every_public_name_is_explained(name):
    thing = getattr(fm, name)
    assert inspect.getdoc(thing)
    if inspect.isfunction(thing):
        assert ">>>" in inspect.getdoc(thing), f"{name} has no example"
