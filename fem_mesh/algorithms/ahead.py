"""Compiling ahead: while the user of a live widget is still looking, what larger meshes need is compiled elsewhere.

Compiling takes some 30 s, once on a machine, and would hold up all Python that runs meanwhile. So another process does
it and leaves it where Numba keeps such things; a thread waits for that, and takes what is there in half a second.
"""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
import threading
from pathlib import Path

from fem_mesh.algorithms.delaunay import delaunay
from fem_mesh.algorithms.refine import refine
from fem_mesh.algorithms.ruppert import refine_mesh
from fem_mesh.domain.domain import Domain
from fem_mesh.kernel import can_compile, compiling, is_compiled, is_kept

LONGEST = 300.0  # seconds that the other process may take
PATIENCE = 2.0  # seconds that the end of this process waits for the thread
CODE = "import sys; sys.path[:] = {path!r}; from fem_mesh.algorithms.ahead import compile_now; compile_now(niceness=10)"

_lock = threading.Lock()
_thread: threading.Thread | None = None
_child: subprocess.Popen[bytes] | None = None
_ending = False


def compile_ahead() -> None:
    """Begin to compile what ``delaunay`` and ``refine`` need, in the background; at once if that was begun before.

    Says nothing of it: where no other process can be had, large meshes are compiled for when they come.
    """
    global _thread
    with _lock:
        if _thread is None and not _ending:
            _thread = threading.Thread(target=_compile, name="fem_mesh compiles ahead", daemon=True)
            atexit.register(_stop)
            _thread.start()


def is_ready() -> bool:
    """Whether nothing is left to wait for: ``refine`` is compiled, or it is not being compiled."""
    return is_compiled(refine_mesh) or _thread is None or not _thread.is_alive()


def compile_now(niceness: int = 0) -> None:
    """Compile, or take from where it is kept, what ``delaunay`` and ``refine`` need."""
    if niceness and hasattr(os, "nice"):
        os.nice(niceness)
    outer, hole, sharp = [(0, 0), (8, 0), (8, 8), (0, 8)], [(1, 1), (3, 1), (3, 3)], [(4, 4), (7, 4), (7, 4.25)]
    domain = Domain.from_loops(outer, hole, sharp)
    with compiling(True):
        delaunay(domain.points)
        refine(domain, min_angle=30.0, size=4.0)
        refine(domain, min_angle=30.0, max_points=2)
        refine(domain, min_angle=30.0, size=lambda x, y: 1.0 + x)


def _compile() -> None:
    if not can_compile():
        return
    if not is_compiled(refine_mesh) and not is_kept(refine_mesh):
        try:
            _compile_elsewhere()
        except (OSError, subprocess.SubprocessError):  # no process to be had, or too slow a machine
            return
        if not is_kept(refine_mesh):  # nothing came of it: it is compiled when it is needed
            return
    if not _ending:
        compile_now()


def _compile_elsewhere() -> None:
    """In a process of its own, if there is a Python to run."""
    global _child
    if not (sys.executable and Path(sys.executable).name.lower().startswith(("python", "pypy"))):
        return
    command, nothing = [sys.executable, "-c", CODE.format(path=sys.path)], subprocess.DEVNULL
    hidden = getattr(subprocess, "CREATE_NO_WINDOW", 0)  # on Windows
    with _lock:
        if _ending:
            return
        _child = subprocess.Popen(command, stdin=nothing, stdout=nothing, stderr=nothing, creationflags=hidden)
    try:
        _child.wait(LONGEST)
    finally:
        _child.kill()


def _stop() -> None:
    """The process ends: leave no other one behind, and no thread in the midst of compiled code."""
    global _ending
    with _lock:
        _ending = True
        if _child is not None:
            _child.kill()
    if _thread is not None:
        _thread.join(PATIENCE)
