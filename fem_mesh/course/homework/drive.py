"""Runs cells in a student's kernel, and hears only what it says to the cell that is running.

Not by nbclient: there a later cell can change what an earlier one displayed, an interrupt that is swallowed starts the
wait anew, and output is kept without a bound. What the kernel sends is data from a stranger here: counted, never
trusted, and kept only if it came in the running cell's name.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import signal
import subprocess
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from queue import Empty
from typing import Any, NoReturn

from fem_mesh.course.homework.results import clean
from fem_mesh.course.homework.sandbox import Box, Limits, command_of, environment

ANSWER = "application/vnd.fem-mesh.answer+json"
GRACE = 3.0  # seconds that a cell has to end after it was interrupted
START = 60.0  # seconds that a kernel may take to answer
PULSE = 0.1  # seconds between two looks at whether the kernel lives
_ANSI, _LINE = re.compile(r"\x1b\[[0-9;]*m"), re.compile(r"Cell In\[[^\]]*\], line (\d{1,6})")
KEPT = 2_000  # characters kept of what a cell printed or raised


class KernelLost(Exception):  # noqa: N818 - it says what happened
    """The kernel is gone, or was ended: the message says why, in words for the student."""


@dataclass
class Ran:
    """What a cell did.

    answers : what it displayed as an answer, in order: any JSON at all
    error : the exception that ended it, "NameError: ...", or ""
    line : of the cell, where that was raised, or 0
    """

    answers: list[Any] = field(default_factory=list)
    error: str = ""
    line: int = 0


class Watch(threading.Thread):
    """Ends a kernel whose processes together take more memory, processes or disk than they may."""

    def __init__(self, pid: int, folder: Path, limits: Limits) -> None:
        super().__init__(daemon=True)
        self.pid, self.folder, self.limits = pid, folder, limits
        self.why = ""
        self.over = threading.Event()

    def run(self) -> None:
        import psutil

        while not self.over.wait(0.25):
            try:
                family = psutil.Process(self.pid).children(recursive=True)
            except psutil.Error:
                return
            if len(family) > self.limits.processes:
                self.why = f"it started more than {self.limits.processes} processes"
            elif _resident(family) + _held(family) > self.limits.memory << 20:
                self.why = f"it took more than {self.limits.memory} MB of memory"
            elif _taken(self.folder) > self.limits.memory << 17:
                self.why = f"it wrote more than {self.limits.memory // 8} MB"
            if self.why:
                end(self.pid)
                return


def _resident(family: Sequence[Any]) -> int:
    import psutil

    total = 0
    for process in family:
        with contextlib.suppress(psutil.Error):
            total += process.memory_info().rss
    return total


def _held(family: Sequence[Any]) -> int:
    """Bytes of files that live in memory without a name, as far as this system shows them."""
    sizes: dict[tuple[int, int], int] = {}
    for process in family:
        with contextlib.suppress(OSError):
            for name in os.listdir(f"/proc/{process.pid}/fd"):
                path = f"/proc/{process.pid}/fd/{name}"
                with contextlib.suppress(OSError):
                    if os.readlink(path).startswith("/memfd:"):
                        about = os.stat(path)
                        sizes[about.st_dev, about.st_ino] = about.st_blocks * 512
    return sum(sizes.values())


def _taken(folder: Path) -> int:
    total = 0
    for at, _, files in os.walk(folder):
        for name in files:
            with contextlib.suppress(OSError):
                total += os.lstat(os.path.join(at, name)).st_size + 512
    return total


def end(pid: int) -> None:
    """Kill a process that we started, and its descendants: for a sandbox the first is enough, its world goes with it."""
    import psutil

    with contextlib.suppress(psutil.Error):
        parent = psutil.Process(pid)
        for process in (parent, *parent.children(recursive=True)):
            with contextlib.suppress(psutil.Error):
                process.send_signal(signal.SIGKILL) if os.name == "posix" else process.kill()


class Kernel:
    """A student's kernel. Every cell ends within its time, however the kernel behaves."""

    def __init__(self, manager: Any, client: Any, watch: Watch, limits: Limits, started: float) -> None:
        self.manager, self.client, self.watch, self.limits = manager, client, watch, limits
        self.last = started + limits.total
        self.output = 0

    def run(self, source: str) -> Ran:
        """Run one cell. Raises KernelLost where the kernel does not live to see the next."""
        ran = Ran()
        request = self.client.execute(source, store_history=False, allow_stdin=False, stop_on_error=False)
        seconds = min(self.limits.cell, self.last - time.monotonic())
        if self._listen(request, ran, seconds):
            return ran
        self.manager.interrupt_kernel()
        if self._listen(request, ran, GRACE) and time.monotonic() < self.last:
            ran.error = f"TimeoutError: the cell was not done after {self.limits.cell:g} seconds"
            return ran
        self._lost(f"a cell was not done after {max(seconds, 0):.0f} seconds and could not be interrupted")

    def _listen(self, request: str, ran: Ran, seconds: float) -> bool:
        """Hear what the cell says, until it is done (True) or the time is over (False)."""
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0:
            try:
                message = self.client.get_iopub_msg(timeout=min(PULSE, left))
            except Empty:
                if not self.manager.is_alive():
                    self._lost("the kernel died")
                continue
            except Exception as error:  # whatever a stranger can send
                self._lost(f"the kernel sent what is no message ({type(error).__name__})")
            if _said(message, "parent_header", "msg_id") == request and self._heard(message, ran):
                return True
        return False

    def _heard(self, message: Any, ran: Ran) -> bool:
        kind, content = _said(message, "header", "msg_type"), message.get("content")
        if not isinstance(content, dict):
            return False
        if kind == "status":
            return content.get("execution_state") == "idle"
        self.output += _size(content)
        if self.output > self.limits.output << 20:
            self._lost(f"more than {self.limits.output} MB of output")
        data = content.get("data")
        if kind == "display_data" and isinstance(data, dict) and ANSWER in data:
            ran.answers.append(data[ANSWER])
        elif kind == "error":
            ran.error = clean(f"{content.get('ename')}: {content.get('evalue')}"[:KEPT]).removesuffix(": ")
            ran.line = _line(content.get("traceback"))
        return False

    def _lost(self, why: str) -> NoReturn:
        time.sleep(PULSE)  # the watch may be about to say more
        end(self.watch.pid)
        raise KernelLost(f"{self.watch.why}, so it was ended" if self.watch.why else why)


def _line(traceback: Any) -> int:
    """The line of the cell that a traceback names first, or 0."""
    rows = traceback if isinstance(traceback, list) else []
    text = _ANSI.sub("", "\n".join(row[:KEPT] for row in rows[:10] if isinstance(row, str)))
    found = _LINE.search(text)
    return int(found[1]) if found else 0


def _said(message: Any, *names: str) -> Any:
    for name in names:
        message = message.get(name) if isinstance(message, dict) else None
    return message


def _size(thing: Any) -> int:
    """About the length of its JSON, without writing it out."""
    total, stack = 0, [thing]
    while stack:
        item = stack.pop()
        if isinstance(item, dict):
            stack.extend(item.keys())
            stack.extend(item.values())
        elif isinstance(item, list):
            stack.extend(item)
        total += len(item) + 3 if isinstance(item, str) else 8
    return total


@contextmanager
def kernel_in(box: Box, base: Path, limits: Limits) -> Iterator[Kernel]:
    """A kernel in the folder ``base``, in which ``base / "room"`` stands; it and all its processes are gone afterwards."""
    import zmq
    from jupyter_client.kernelspec import KernelSpec, KernelSpecManager
    from jupyter_client.manager import KernelManager

    sockets, home = base / "io", base / "home"
    for folder in (sockets, home):
        folder.mkdir(mode=0o700)
    spec = KernelSpec(
        argv=command_of(box, base / "room", sockets, limits),
        display_name="grading",
        language="python",
        interrupt_mode="message",
    )

    class Specs(KernelSpecManager):
        def get_kernel_spec(self, kernel_name: str) -> KernelSpec:
            return spec

    context = zmq.Context()
    context.setsockopt(zmq.MAXMSGSIZE, limits.output << 20)  # of later sockets; one message can be as large as memory
    manager = KernelManager(
        kernel_name="grading", kernel_spec_manager=Specs(), transport="ipc", ip=str(sockets / "k"), context=context,
        connection_file=str(sockets / "c.json"),
    )  # fmt: skip
    started = time.monotonic()
    manager.start_kernel(
        cwd=str(home), env=environment(box, home), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, independent=False
    )
    process: Any = manager.provisioner
    pid = process.pid
    watch = Watch(pid, base, limits)
    client = manager.client()
    try:
        watch.start()
        client.start_channels(stdin=False, hb=False)
        _ready(client, manager)
        yield Kernel(manager, client, watch, limits, started)
    finally:
        watch.over.set()
        end(pid)
        client.stop_channels()
        process.process.wait(10)
        context.destroy(linger=0)


def _ready(client: Any, manager: Any) -> None:
    try:
        client.wait_for_ready(timeout=START)
    except RuntimeError as error:
        state = "is alive" if manager.is_alive() else "ended"
        raise KernelLost(f"the kernel did not start: it {state}; {error}") from None


def clear(base: Path) -> None:
    """Remove a folder that a stranger has written in."""
    for at, folders, _ in os.walk(base):  # folders that nobody may enter
        for name in folders:
            with contextlib.suppress(OSError):
                if not os.path.islink(path := os.path.join(at, name)):
                    os.chmod(path, 0o700)
    shutil.rmtree(base, ignore_errors=True)
