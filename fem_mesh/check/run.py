"""The half of a check that runs a student's work, and writes down what came: a *transcript*, plain JSON.

It stands alone: the standard library and NumPy, nothing of ours, so that a grading kernel needs this file and
neither the cases' makers nor the judge. What it writes proves nothing; the judge looks at every number again.
"""

from __future__ import annotations

import ast
import contextlib
import linecache
import math
import numbers
import os
import re
import signal
import sysconfig
import threading
import traceback
import types
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Set
from decimal import Decimal
from itertools import takewhile
from typing import Any

import numpy as np

SECONDS = 10.0  # that one case may take
STEPS = 1000  # that a generator may yield in one case, unless the case says
ITEMS = 400_000  # numbers and rows that one case may write down
DEEPEST = 6
LONGEST = 200  # characters of a text
MESSAGE = 300  # characters of what an exception says
LARGEST = 2**63  # beyond, an integer is written as its sign

ARGUMENTS = {  # what a student's work is called with; a case of the predicates lists its calls instead
    "lawson": ("points", "triangles"),
    "bowyer_watson": ("points",),
    "segments": ("points", "triangles", "segments"),
    "carve": ("points", "triangles", "segments"),
    "ruppert": ("points", "segments", "min_angle"),
    "encroached": ("points", "segments"),
    "flip": ("points", "triangles", "edge"),
    "cavity": ("points", "triangles", "p"),
}
GENERATORS = ("lawson", "bowyer_watson", "segments", "ruppert")

Place = dict[str, Any]


class OutOfTime(BaseException):
    """Raised in the student's code when its time is up; no ``except Exception`` of theirs catches it."""


def run(check: str, work: Any, cases: Iterable[dict[str, Any]], seconds: float = SECONDS) -> dict[str, Any]:
    """Call ``work`` on each case, or drive its generator, and return the transcript.

    Ends with the first case in which the work raises or runs out of time (``seconds`` a case, where the system has
    such an alarm, and in the main thread). What is printed by the work is left alone. Never raises but
    KeyboardInterrupt.

    >>> run("orient", lambda a, b, c: 1, [{"name": "one", "calls": [[[0, 0], [1, 0], [0, 1]]]}])["runs"]
    [{'case': 'one', 'kind': 'function', 'yields': [1], 'returned': None, 'error': None, 'stopped': None}]
    """
    transcript: dict[str, Any] = {"check": check, "runs": []}
    if not callable(work):
        return {**transcript, "refused": type(work).__name__}
    for case in cases:
        record = run_case(check, work, case, seconds)
        transcript["runs"].append(record)
        if record["error"] is not None:
            break
    return transcript


def given(points: Any, triangles: Any) -> dict[str, Any]:
    """The transcript of a mesh that is there already.

    >>> given(np.eye(2), [(0, 1, 2)])["runs"][0]["returned"]
    [[[1.0, 0.0], [0.0, 1.0]], [[0, 1, 2]]]
    """
    room = [ITEMS]
    record = {"case": "mesh", "kind": "value", "yields": [], "returned": [plain(points, room), plain(triangles, room)]}
    return {"check": "mesh", "runs": [{**record, "error": None, "stopped": None}]}


def run_case(check: str, work: Callable[..., Any], case: dict[str, Any], seconds: float = SECONDS) -> dict[str, Any]:
    """What came of one case."""
    record: dict[str, Any] = {"case": case["name"], "kind": "function", "yields": [], "returned": None}
    record.update(error=None, stopped=None)
    try:
        with time_limit(seconds):
            _fill(record, check, work, case)
    except KeyboardInterrupt:
        raise
    except OutOfTime as error:
        record.update(error=_said(error, error.args[0] or _place_of_work(work)), stopped="time")
    except BaseException as error:  # whatever a student's code raises, SystemExit too: it is what came of the case
        frames = [*traceback.walk_tb(error.__traceback__)]
        place = recursion_of(frames) if isinstance(error, RecursionError) else None
        record["error"] = _said(error, place or place_of(reversed(frames)) or _place_of_work(work))
    return record


def _fill(record: dict[str, Any], check: str, work: Callable[..., Any], case: dict[str, Any]) -> None:
    room = [ITEMS]
    if "calls" in case:
        for arguments in case["calls"]:
            record["yields"].append(plain(work(*map(fresh, arguments)), room))
        return
    result = work(*(fresh(case[name]) for name in ARGUMENTS[check]))
    if check in GENERATORS and isinstance(result, Iterator):
        record["kind"] = "generator"
        _drive(result, record, int(case.get("steps", STEPS)), room)
    else:
        record["returned"] = plain(result, room)


def _drive(states: Iterator[Any], record: dict[str, Any], most: int, room: list[int]) -> None:
    while True:  # each turn writes a state down, and there is room for ``most``
        try:
            state = next(states)
        except StopIteration as end:
            record["returned"] = plain(end.value, room)
            return
        if len(record["yields"]) == most:
            record["stopped"] = "steps"
            return
        record["yields"].append(plain(state, room))


def fresh(value: Any) -> Any:
    """A case's value as a student gets it, their own to change: a point is a pair of floats, points are a list of pairs.

    >>> fresh([[0, 1], [2, 3]]), fresh([0.5, 1])
    ([(0, 1), (2, 3)], (0.5, 1))
    """
    if not isinstance(value, list):
        return value
    if value and not isinstance(value[0], list):
        return tuple(value)
    return [tuple(row) for row in value]


# ---- what came, as plain JSON ------------------------------------------------------------------------


def plain(value: Any, room: list[int] | None = None, depth: int = 0) -> Any:
    """``value`` as JSON, copied: numbers, texts and lists. What is none of these is told by the name of its type.

    Arrays and tuples become lists, sets sorted lists, a Step the lists it holds. A number that is no double is
    told by its sign. ``room[0]`` is how many items may still be written.

    >>> plain({(2, 0, 1), (0, 1, 3)}), plain(np.eye(2)), plain(object())
    ([[0, 1, 3], [2, 0, 1]], [[1.0, 0.0], [0.0, 1.0]], {'type': 'object'})
    """
    room = [ITEMS] if room is None else room
    room[0] -= 1
    if room[0] < 0 or depth > DEEPEST:
        return {"type": type(value).__name__, "cut": True}
    if isinstance(value, np.ndarray):
        if value.size > room[0]:
            return {"type": "ndarray", "cut": True}
        value = value.tolist()
    elif isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, str):
        return str(value[:LONGEST])
    if isinstance(value, numbers.Real | Decimal):
        return _plain_number(value)
    if type(value).__name__ == "Step" and hasattr(value, "triangles"):
        lists = {name: plain(getattr(value, name, None), room, depth + 1) for name in ("points", "triangles")}
        return {"type": "Step", **lists}
    if isinstance(value, Collection) and not isinstance(value, Mapping | bytes | bytearray):
        items = [plain(item, room, depth + 1) for item in value]
        return _sorted(items) if isinstance(value, Set) else items
    return {"type": type(value).__name__}


def _plain_number(value: Any) -> Any:
    if isinstance(value, numbers.Integral) and abs(int(value)) <= LARGEST:
        return int(value)
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else {"type": "float", "text": str(float(value)), **_sign(value)}
    with contextlib.suppress(OverflowError, ValueError):
        if float(value) == value:
            return float(value)
    return {"type": type(value).__name__, **_sign(value)}


def _sign(value: Any) -> dict[str, int]:
    return {"sign": int(value > 0) - int(value < 0)} if value == value else {}


def _sorted(items: list[Any]) -> list[Any]:
    try:
        return sorted(items)
    except TypeError:
        return sorted(items, key=repr)


# ---- where in their code -----------------------------------------------------------------------------


@contextlib.contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise OutOfTime in what runs longer, with the place in the student's code where it was.

    It rings again each second, for code that catches everything.
    """
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def ring(number: int, frame: types.FrameType | None) -> None:
        own = takewhile(lambda entry: entry[0].f_code.co_filename != __file__, traceback.walk_stack(frame))
        stack = [*own] if frame else []  # from where the alarm rang out to our call of the student's code
        raise OutOfTime(loop_of(reversed(stack)) or place_of(stack), seconds)

    handler = signal.signal(signal.SIGALRM, ring)
    timer = signal.setitimer(signal.ITIMER_REAL, seconds, 1.0)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, *timer)
        signal.signal(signal.SIGALRM, handler)


HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
GATE = os.path.join(os.path.dirname(HERE), "start.py")  # what refuses imports in a grading kernel
LIBRARIES = (HERE, GATE, *(sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")), "<frozen")


Frames = Iterable[tuple[types.FrameType, int | None]]


def place_of(frames: Frames) -> Place | None:
    """The first of the frames (given from the innermost on) that is the student's: line in its cell, source, function."""
    for frame, known in frames:
        name, line = frame.f_code.co_filename, known or frame.f_code.co_firstlineno  # clean-up of a loop has no line
        if not name.startswith(LIBRARIES):
            source = linecache.getline(name, line, frame.f_globals).strip()
            return {"line": line, "source": source[:LONGEST], "function": frame.f_code.co_name}
    return None


def loop_of(frames: Frames) -> Place | None:
    """The outermost ``while``, or else ``for``, that is under way in the outermost of the student's frames that has one.

    Where in a loop without an end an alarm rings is chance; that it is in this loop is not. ``frames`` from the outermost on.
    """
    for frame, line in frames:
        name = frame.f_code.co_filename
        if name.startswith(LIBRARIES) or line is None:
            continue
        try:
            tree = ast.parse("".join(linecache.getlines(name, frame.f_globals)))
        except (SyntaxError, ValueError):
            continue
        begin = frame.f_code.co_firstlineno
        loops = [
            (isinstance(node, ast.For), node.lineno)
            for node in ast.walk(tree)
            if isinstance(node, ast.While | ast.For) and begin <= node.lineno <= line <= (node.end_lineno or 0)
        ]
        if loops:
            return place_of([(frame, min(loops)[1])])
    return None


def recursion_of(frames: list[tuple[types.FrameType, int]]) -> Place | None:
    """The first call of a function of the student's that is under way more than once: how deep it went is chance."""
    times = Counter(frame.f_code for frame, _ in frames)
    return place_of((frame, line) for frame, line in frames if times[frame.f_code] > 1)


def _place_of_work(work: Any) -> Place:
    code = getattr(work, "__code__", None)
    if code is None:
        return {"line": None, "source": "", "function": getattr(work, "__name__", type(work).__name__)}
    source = linecache.getline(code.co_filename, code.co_firstlineno).strip()
    return {"line": code.co_firstlineno, "source": source[:LONGEST], "function": code.co_name}


def _said(error: BaseException, place: Place) -> dict[str, Any]:
    if isinstance(error, OutOfTime):
        return {"type": "OutOfTime", "message": f"{error.args[1]:g} second{'s' * (error.args[1] != 1)}", **place}
    try:
        message = "it calls itself without an end" if isinstance(error, RecursionError) else str(error)
    except Exception:  # an exception of a student's own, whose words cannot be had
        message = ""
    message = re.sub(r"0x[0-9a-fA-F]+", "0x...", " ".join(message.split()))[:MESSAGE]
    return {"type": type(error).__name__, "message": message, **place}
