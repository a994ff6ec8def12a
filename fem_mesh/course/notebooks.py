"""Notebooks as files: blank copies to type into, and runs as they are kept in the repository."""

from __future__ import annotations

import re
from copy import deepcopy
from importlib.util import find_spec
from itertools import count
from pathlib import Path
from typing import Any

from click import ClickException

VIEW = "application/vnd.jupyter.widget-view+json"  # its model dies with the kernel
PASSING = ("ExecuteTime", "execution", "trusted")  # what a cell's metadata should not remember of a run
NOTICE = "fem_mesh: compiling"  # begins a line that only a new machine prints
KEEP = "keep"  # the tag of a code cell that a blank copy leaves as it is
SHOWN = ("slideshow",)  # of a cell's metadata, what says nothing about its code

_INNERMOST = re.compile(r"<details\b(?:(?!<details\b).)*?</details\s*>", re.DOTALL | re.IGNORECASE)
_OPEN = re.compile(r"<details\b.*", re.DOTALL | re.IGNORECASE)


class NotebookError(ClickException):
    """A notebook that cannot be read, run or written: the message names it and says what to do."""


def _nbformat() -> Any:
    for name in ("nbformat", "nbclient", "ipykernel"):  # all of them, or a run would stop half-way
        if find_spec(name) is None:
            raise NotebookError(f'{name} is missing: pip install "fem_mesh[course]"')
    import nbformat

    return nbformat


def read(path: Path) -> Any:
    """The notebook in the file ``path``, as nbformat's dictionary."""
    nbformat = _nbformat()
    try:
        return nbformat.read(path, as_version=4)
    except (ValueError, nbformat.ValidationError) as error:
        raise NotebookError(f"{path}: no notebook: {str(error).splitlines()[0]}") from None


def text(notebook: Any) -> str:
    """What its file holds: one line an item, so that a difference shows what changed."""
    return str(_nbformat().writes(notebook)).rstrip("\n") + "\n"


# ---- blank copies ----------------------------------------------------------------------------------


def blank(notebook: Any) -> Any:
    """A copy to type into. Prose stays, without folded ``<details>``: they hold solutions. The first code cell, the
    imports, stays too, and what is tagged ``keep``. All other code goes, with its outputs, tags and name.
    """
    copy = deepcopy(notebook)
    copy.metadata.pop("widgets", None)
    first = next((cell for cell in copy.cells if cell.cell_type == "code"), None)
    taken = {cell.get("id") for cell in copy.cells}
    names = (name for n in count(1) if (name := f"blank-{n}") not in taken)
    for cell in copy.cells:
        if cell.cell_type == "markdown":
            cell.source = without_solutions(cell.source)
        elif cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
            if cell is not first and KEEP not in cell.metadata.get("tags", ()):
                _empty(cell, names)
    copy.cells = [cell for cell in copy.cells if cell.cell_type != "markdown" or cell.source]
    return copy


def without_solutions(prose: str) -> str:
    """Markdown without what is folded in it.

    >>> without_solutions("How many?\\n\\n<details><summary>Solution</summary>\\n\\nSeven.\\n</details>\\n\\nWhy?")
    'How many?\\n\\nWhy?'
    """
    while (less := _INNERMOST.sub("", prose)) != prose:  # ends: each round takes a fold out
        prose = less
    return re.sub(r"\n{3,}", "\n\n", _OPEN.sub("", prose)).strip("\n")


def _empty(cell: Any, names: Any) -> None:
    cell.source = ""
    cell.metadata = type(cell.metadata)({key: value for key, value in cell.metadata.items() if key in SHOWN})
    if "id" in cell:  # a name may say what is to come
        cell.id = next(names)


# ---- runs ------------------------------------------------------------------------------------------


def run(notebook: Any, path: Path, timeout: int | None = None) -> None:
    """Run a notebook that stands in the file ``path``, from a fresh kernel of this very Python, in the file's folder.

    Its outputs are then as they are kept: nothing in them but what the code says, so a second run changes nothing.
    Raises NotebookError that names the cell if one fails, or takes longer than ``timeout`` seconds.
    """
    _nbformat()
    from jupyter_client.kernelspec import KernelSpecManager
    from jupyter_client.manager import AsyncKernelManager
    from nbclient import NotebookClient
    from nbclient.exceptions import CellExecutionError, CellTimeoutError, DeadKernelError

    metadata, at = deepcopy(notebook.metadata), -1

    def begins(cell: Any, cell_index: int) -> None:
        nonlocal at
        at = cell_index

    client = NotebookClient(
        notebook,
        # Without other kernels' folders, "python3" is the interpreter that runs this.
        AsyncKernelManager(kernel_name="python3", kernel_spec_manager=KernelSpecManager(kernel_dirs=[])),
        resources={"metadata": {"path": str(path.parent)}},
        extra_arguments=["--log-level=ERROR"],  # of the kernel itself, to the terminal
        timeout=timeout,
        coalesce_streams=True,
        record_timing=False,
        on_cell_start=begins,
    )
    try:
        client.execute(cleanup_kc=True)
    except CellExecutionError as error:
        raise NotebookError(f"{_place(notebook, at, path)}: {error.ename}: {error.evalue}") from None
    except CellTimeoutError:
        raise NotebookError(f"{_place(notebook, at, path)}: not done after {timeout} seconds") from None
    except DeadKernelError:
        raise NotebookError(f"{_place(notebook, at, path)}: the kernel died") from None
    notebook.metadata = metadata
    settle(notebook)


def settle(notebook: Any) -> None:
    """Take out what lives only as long as a kernel, or says only when it ran."""
    notebook.metadata.pop("widgets", None)
    for cell in notebook.cells:
        for name in PASSING:
            cell.metadata.pop(name, None)
        if cell.cell_type != "code":
            continue
        if not cell.source.strip():  # it is not run
            cell.outputs, cell.execution_count = [], None
        for output in cell.outputs:
            output.get("data", {}).pop(VIEW, None)
            if output.output_type == "stream":
                lines = output.text.splitlines(keepends=True)
                output.text = "".join(line for line in lines if not line.startswith(NOTICE))
        cell.outputs = [output for output in cell.outputs if output.get("data", output.get("text", True))]


def _place(notebook: Any, at: int, path: Path) -> str:
    """In which notebook, in which cell, and how that cell begins."""
    cell = notebook.cells[at]
    number = sum(other.cell_type == "code" for other in notebook.cells[: at + 1])
    name = f" ({cell.id})" if "id" in cell else ""
    return f"{path}, code cell {number}{name}, which begins {cell.source.strip().splitlines()[0]!r}"
