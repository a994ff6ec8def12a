"""How a student's kernel is shut in: bubblewrap's command line, or a plain command where there is no bubblewrap.

Inside bubblewrap there is no network, no other process, no other user's file and no shell: only what ``packages`` lists
and the room, both read-only; a small folder in memory to write into; and the folder of the kernel's own sockets.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from fem_mesh.course.homework.packages import Place, place_of

MODES = ("auto", "required", "off")
USER = "65534"
WORK = "/desk"
# Jupyter's JPY_PARENT_PID is a number of the world outside: a kernel would look for it in its own, and end.
_KERNELS_OWN = ("--unsetenv", "JPY_PARENT_PID", "--chdir", WORK)


class SandboxError(RuntimeError):
    """Bubblewrap was asked for and cannot be used: the message says why and what to do."""


@dataclass(frozen=True)
class Limits:
    """What a submission may use: seconds for a cell, seconds in all, MB of memory, MB of output, processes."""

    cell: float = 60.0
    total: float = 300.0
    memory: int = 2048
    output: int = 8
    processes: int = 64


@dataclass(frozen=True)
class Box:
    """Where kernels run on this machine.

    bwrap : bubblewrap's file, or "" where kernels run without it
    why : why it is not used, or ""
    options : those of its newer options that this one knows
    """

    place: Place
    bwrap: str
    why: str
    options: tuple[str, ...]


@cache
def box_of(mode: str, more: tuple[str, ...] = ()) -> Box:
    """The box of this machine, tried out once.

    ``mode`` is one of :data:`MODES`, ``more`` are packages that kernels are to have. Raises SandboxError in the mode
    "required" where bubblewrap cannot be used, LookupError for a package that is not installed.
    """
    bwrap = "" if mode == "off" else shutil.which("bwrap") or ""
    why = (
        "" if bwrap else "it was switched off" if mode == "off" else "bubblewrap is not installed (Debian's package bubblewrap)"
    )
    place, options = Place("", (), (), (), ()), tuple[str, ...]()
    if bwrap:
        try:
            place = place_of(more)
            options = _options(bwrap)
            why = _tried(Box(place, bwrap, "", options))
        except (OSError, subprocess.SubprocessError) as error:
            why = f"bubblewrap does not work here: {error}"
    if why and mode == "required":
        raise SandboxError(f"{why}; install it, or say --sandbox auto to grade without it")
    if why:
        place = place if place.packages else place_of(more, libraries=False)
    return Box(place, "" if why else bwrap, why, options)


def _options(bwrap: str) -> tuple[str, ...]:
    told = subprocess.run([bwrap, "--help"], capture_output=True, text=True, check=False, timeout=20).stdout
    return tuple(option for option in ("--disable-userns", "--size", "--clearenv") if f"{option} " in told)


def _tried(box: Box) -> str:
    """What goes wrong when something is run in the box, or nothing."""
    command = [*_shut_in(box, 1), *_closed(box.place), "--", box.place.interpreter, "-sP", "-c", "print(6 * 7)"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60, env={})
    if done.stdout.strip() == "42":
        return ""
    said = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
    return f"bubblewrap does not work here: {said}"


def command_of(box: Box, room: Path, sockets: Path, limits: Limits) -> list[str]:
    """The command that starts a kernel; Jupyter puts the connection file's name in."""
    if not box.bwrap:
        return [sys.executable, "-sP", str(room / "start.py"), "{connection_file}"]
    command = _shut_in(box, max(1, limits.memory // 8))
    command += ["--ro-bind", str(room), "/room", "--bind", str(sockets), str(sockets)]
    return [*command, *_closed(box.place), "--", box.place.interpreter, "-sP", "/room/start.py", "{connection_file}"]


def _shut_in(box: Box, megabytes: int) -> list[str]:
    place = box.place
    command = [box.bwrap, "--unshare-user", "--unshare-all", "--uid", USER, "--gid", USER, "--hostname", "grading"]
    command += ["--cap-drop", "ALL", "--new-session", "--die-with-parent"]
    command += ["--disable-userns"] if "--disable-userns" in box.options else []
    for path in (*place.standard, *place.libraries, place.interpreter):
        command += ["--ro-bind", path, path]
    for folder in place.standard:  # other packages may stand inside
        for inner in ("site-packages", "dist-packages"):
            command += ["--tmpfs", at, "--remount-ro", at] if os.path.isdir(at := f"{folder}/{inner}") else []
    command += ["--tmpfs", packages_in(place)]
    for path, name in place.packages:
        command += ["--ro-bind", path, f"{packages_in(place)}/{name}"]
    for path in place.hidden:
        command += ["--ro-bind", "/dev/null", f"{packages_in(place)}/{_inside(place, path)}"]
    command += ["--ro-bind-try", "/etc/ld.so.cache", "/etc/ld.so.cache", "--proc", "/proc", "--dev", "/dev"]
    for folder in (WORK, "/tmp", "/dev/shm"):
        command += ["--size", str(megabytes << 20)] if "--size" in box.options else []
        command += ["--tmpfs", folder]
    return command


def _closed(place: Place) -> tuple[str, ...]:
    """What comes last: nothing more can be mounted then."""
    return "--remount-ro", packages_in(place), "--remount-ro", "/", *_KERNELS_OWN


def packages_in(place: Place) -> str:
    """Where the packages are in the box: beside the standard library, where Python looks for them."""
    beside = f"{place.standard[0]}/site-packages"
    return beside if os.path.isdir(beside) else "/packages"


def _inside(place: Place, path: str) -> str:
    whole, name = next((whole, name) for whole, name in place.packages if path.startswith(f"{whole}/"))
    return f"{name}/{path[len(whole) + 1 :]}"


def environment(box: Box, home: Path) -> dict[str, str]:
    """The environment variables of a kernel."""
    folder = WORK if box.bwrap else str(home)
    threads = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")  # each takes address space
    return {
        "HOME": folder,
        "PATH": "",
        "LANG": "C.UTF-8",
        "TMPDIR": "/tmp" if box.bwrap else folder,
        "IPYTHONDIR": f"{folder}/.ipython",
        "MPLCONFIGDIR": f"{folder}/.matplotlib",
        "MPLBACKEND": "agg",
        "PYTHONHASHSEED": "0",  # two runs give the same marks
        **threads,
    }
