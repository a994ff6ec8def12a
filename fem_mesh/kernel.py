"""Kernels: plain Python functions over flat arrays, which Numba may compile and Python may call.

An algorithm's kernel is a generator that yields ``(event, where)`` before and after each change.
All its state lives in the arrays it is given, so it can be dropped after any *settled* event and
started again on the same arrays: it goes on where it stopped. Two drivers run the same generator:

* :func:`watch` iterates it in plain Python, over views that hand out Python numbers;
* :func:`run` drains it, compiled by Numba where the input is large, in plain Python where it is small.

This is the only file that knows Numba.
"""

from __future__ import annotations

import hashlib
import inspect
import math
import pickle
import re
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

Function = TypeVar("Function", bound=Callable[..., Any])

SETTLED = 16  # events from here on leave the arrays whole: a driver may stop after one
LAST = 64  # events from here on are a generator's last word: the caller has to act, or it is over
EVENTS_A_CALL = 50_000  # compiled work returns to Python this often, for Ctrl-C and progress
EVENTS_IN_PYTHON = 30_000  # a run that takes more than these (about a second) is compiled, however small it began
SMALL = 3_000  # below this size a first call runs in plain Python rather than wait for a compiler
CONSTANT = (int, float, str, tuple, np.generic)  # what a kernel may find in capitals
PATIENCE = 2.0  # seconds of compiling before a line says so

_kernels: list[Callable[..., Any]] = []
_sources: dict[str, bytes | None] = {}  # of each module that holds kernels, as it was imported
_inlined: set[Callable[..., Any]] = set()
_compiled: dict[Callable[..., Any], Any] = {}
_lock = threading.RLock()
_here = threading.local()  # .compiles: what this thread wants, while it wants something


def kernel(function: Function) -> Function:
    """Note ``function`` as a kernel: it stays callable as it is, and compiled code may call it too."""
    _kernels.append(function)
    _note_source(function)
    return function


def inlined_kernel(function: Function) -> Function:
    """A kernel that compiled code takes in where it is called: for innermost loops, where handing over
    half a dozen arrays would cost as much as the work."""
    _inlined.add(function)
    return kernel(function)


def index(i: int) -> int:
    """Narrow ``i`` to an index. Compiled it is a uint32, which spares every array access a test for < 0."""
    return i


def scratch(n: int) -> list[float]:
    """Room for ``n`` floats, to be overwritten. Compiled it is an array."""
    return [0.0] * n


def view(array: np.ndarray) -> memoryview:
    """The same memory, handing out Python's own numbers."""
    return memoryview(array)  # type: ignore[arg-type]


def watch(generator: Callable[..., Iterator[tuple[int, int]]], state: Sequence[np.ndarray]) -> Iterator[tuple[int, int]]:
    """Iterate a generator kernel in plain Python, yielding each event as it happens.

    The kernel gets views of the same arrays that hand out Python's own ints and floats, which are
    faster than NumPy's scalars and neither wrap nor warn.
    """
    return generator(*map(view, state))


def run(
    generator: Callable[..., Iterator[tuple[int, int]]],
    state: Sequence[np.ndarray],
    size: int,
    *,
    total: int | None = None,
    done: Callable[[], int] | None = None,
) -> tuple[int, int]:
    """Drain a generator kernel: compiled if that is at hand or worth its wait, else in plain Python.

    ``size`` is the size of the input, ``done()`` says how much is done, of ``total`` if that is known (a
    progress bar appears after two seconds). Returns the last event, ``(0, 0)`` if there was none.
    """
    arguments = (tuple(state), EVENTS_A_CALL)
    last = (0, 0)
    patience = EVENTS_IN_PYTHON if _wanted() is None else math.inf
    if not worth_compiling(generator, arguments, size):
        for count, last in enumerate(watch(generator, state)):
            if count >= patience and SETTLED <= last[0] < LAST and _numba() is not None:
                break  # it was not small after all: compiled code takes over
        else:
            return last
    drain = compile_driver(generator, state)
    with _progress(total, generator.__name__) as bar:
        while True:
            finished, event, where = drain(*arguments)
            last = (event, where) if event else last
            if done is not None:
                bar.update(done() - bar.n)
            if finished:
                return last


def call(function: Callable[..., Any], *arguments: Any, size: int) -> Any:
    """Call a kernel that is no generator: compiled if that is at hand or worth its wait."""
    if not worth_compiling(function, (arguments,), size):
        return function(*(view(a) if isinstance(a, np.ndarray) else a for a in arguments))
    return compile_call(function, arguments)(arguments)


def worth_compiling(function: Callable[..., Any], arguments: tuple[Any, ...], size: int) -> bool:
    """Whether to run ``function`` compiled: it already is for such arguments, or the input is large and Numba is there."""
    wanted = _wanted()
    if wanted or (size > SMALL and wanted is None):
        return _numba() is not None
    return is_compiled(function) and _types(arguments) in _compiled[function].overloads


def can_compile() -> bool:
    """Whether Numba is there and may be used."""
    return _numba() is not None


def is_compiled(function: Callable[..., Any]) -> bool:
    """Whether this process has ``function`` compiled, for some arguments."""
    return function in _compiled and bool(_compiled[function].overloads)


def is_kept(function: Callable[..., Any]) -> bool:
    """Whether this machine keeps ``function`` compiled, as the kernels' sources are now."""

    def probe() -> None:  # kept where every driver is
        pass

    numba = _numba()
    try:
        folder = numba and numba.njit(probe, cache=True).stats.cache_path
    except RuntimeError:  # nowhere to write a cache
        return False
    found = Path(folder).glob(f"*{_name_of_driver(function)}-*.nbi") if folder else ()
    return any(index.stat().st_mtime >= Path(__file__).stat().st_mtime for index in found)  # Numba asks the same


@contextmanager
def compiling(wanted: bool | None) -> Iterator[None]:
    """What this thread runs is compiled, however small it is, and nothing is said of it; or nothing new is compiled.

    None leaves it to the size, as ever.
    """
    before = _wanted()
    _here.compiles = wanted
    try:
        yield
    finally:
        _here.compiles = before


def _wanted() -> bool | None:
    return getattr(_here, "compiles", None)


def compile_driver(generator: Callable[..., Iterator[tuple[int, int]]], state: Sequence[np.ndarray]) -> Any:
    """The compiled driver of a generator kernel, compiled for these arrays if it was not yet."""

    def drain(arrays: Any, budget: int) -> tuple[bool, int, int]:
        event, where = 0, 0
        for event, where in generator(*arrays):
            budget -= 1
            if budget <= 0 and event >= SETTLED and event < LAST:
                return False, event, where
        return True, event, where

    return _compile(generator, drain, (tuple(state), EVENTS_A_CALL))


def compile_call(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """A compiled ``call(arguments)`` of a kernel, compiled for these arguments if it was not yet."""

    def call(arguments: Any) -> Any:
        return function(*arguments)

    return _compile(function, call, (arguments,))


def _compile(function: Callable[..., Any], driver: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    if is_compiled(function) and _types(arguments) in _compiled[function].overloads:
        return _compiled[function]  # without waiting for what another thread compiles
    with _lock:
        if function not in _compiled:
            driver.__qualname__ = _name_of_driver(function)
            _compiled[function] = _jit(driver, cache=True)
        types = _types(arguments)
        if types not in _compiled[function].overloads:
            notice = threading.Timer(PATIENCE, _say_compiling, [function.__name__])
            notice.daemon = True
            if not _wanted():  # else nobody waits
                notice.start()
            try:
                _compiled[function].compile(types)
            except (OSError, EOFError, pickle.UnpicklingError):  # a full disk, a broken cache: do without
                _compiled[function] = _jit(driver, cache=False)
                _compiled[function].compile(types)
            finally:
                notice.cancel()
        return _compiled[function]


def _name_of_driver(function: Callable[..., Any]) -> str:
    """Numba keeps a cache file a name: one for each kernel, and each state of the kernels' sources."""
    return re.sub(r"\W", "_", f"{function.__module__}_{function.__qualname__}_{_fingerprint(function)[:12]}")


def _jit(driver: Callable[..., Any], cache: bool) -> Any:
    try:
        return _numba().njit(driver, cache=cache, error_model="numpy", nogil=True, _nrt=False)
    except RuntimeError:  # nowhere to write a cache: graders, hubs
        return _numba().njit(driver, error_model="numpy", nogil=True, _nrt=False)


def _types(arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(_numba().typeof(argument) for argument in arguments)


def _say_compiling(name: str) -> None:
    print(f"fem_mesh: compiling {name}, once on this machine (some 10 to 30 s) ...", file=sys.stderr, flush=True)


def _note_source(function: Callable[..., Any]) -> None:
    """Keep the source of the kernel's module as it is now, while it is being imported: it may be edited later."""
    if function.__module__ not in _sources:
        try:
            with open(inspect.getfile(function), "rb") as file:
                _sources[function.__module__] = file.read()
        except (OSError, TypeError):  # typed into a notebook
            _sources[function.__module__] = None


def _fingerprint(function: Callable[..., Any]) -> str:
    """A hash of every module with kernels that this one may call, and of the constants (in capitals) there: an edited
    kernel must not meet a cached driver; and of what else was imported nothing is compiled anew."""
    _note_source(function)
    digest = hashlib.sha256()
    for name, kernels in sorted(_called(function).items()):
        source = _sources[name]
        for f in kernels if source is None else ():  # their code must do
            digest.update(f.__code__.co_code + repr((f.__code__.co_names, f.__code__.co_consts)).encode())
        named = list(kernels[0].__globals__.items())  # a list: a cell may be adding names
        constants = sorted((key, repr(value)) for key, value in named if key.isupper() and isinstance(value, CONSTANT))
        digest.update((source or b"") + repr(constants).encode())
    return digest.hexdigest()


def _called(function: Callable[..., Any]) -> dict[str, list[Callable[..., Any]]]:
    """The kernels of each module that this one may reach: by a name, as a module's attribute, or enclosed."""
    kernels, found, new = dict.fromkeys([*_kernels, function]), dict[str, list[Callable[..., Any]]](), [function.__module__]
    while new:  # ends: each module once
        name = new.pop()
        if name in found:
            continue
        found[name] = [f for f in kernels if f.__module__ == name]
        known = list(found[name][0].__globals__.values())
        known += [cell.cell_contents for f in found[name] for cell in f.__closure__ or ()]
        known += [value for module in known if inspect.ismodule(module) for value in list(vars(module).values())]
        new += [value.__module__ for value in known if inspect.isfunction(value) and value in kernels]
    return found


_numba_module: Any = False
_registered = 0  # kernels that Numba knows


def _numba() -> Any:
    """Numba with every kernel registered, or None where it cannot be imported or is switched off."""
    global _numba_module, _registered
    if _numba_module is not False and _registered == len(_kernels):
        return _numba_module  # without waiting, as there
    with _lock:
        if _numba_module is False:
            try:
                import numba
                from numba.extending import overload
            except ImportError:
                _numba_module = None
                return None

            @overload(index, inline="always")
            def _index(i):  # type: ignore[no-untyped-def]
                return lambda i: np.uint32(i)

            @overload(scratch, inline="always")
            def _scratch(n):  # type: ignore[no-untyped-def]
                return lambda n: np.empty(n)

            _numba_module = None if numba.config.DISABLE_JIT else numba  # type: ignore[attr-defined]
        if _numba_module is not None and _registered < len(_kernels):
            from numba.extending import register_jitable

            for function in _kernels[_registered:]:
                inline = "always" if function in _inlined else "never"
                # Counting references to arrays that the caller holds anyway would take half of the time.
                counted = "scratch" in function.__code__.co_names
                register_jitable(error_model="numpy", inline=inline, _nrt=counted)(function)
            _registered = len(_kernels)
        return _numba_module


def _progress(total: int | None, name: str) -> Any:
    from tqdm import tqdm

    return tqdm(total=total, desc=name, delay=2, leave=False, unit_scale=True)
