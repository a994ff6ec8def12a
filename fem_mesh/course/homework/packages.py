"""What a grading kernel's Python consists of: its interpreter, a few packages, and the libraries that these load.

A list of what may be there, not of what may not: a mesher that nobody thought of is not there either.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import sysconfig
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

NEEDED = ("ipykernel", "numpy", "matplotlib")
IDLE = {"debugpy"}  # of what these require, what a kernel does without
IDLE_EXTENSION = "_tkinter"  # it would bring the libraries of a whole desktop
HIDDEN = ("matplotlib/_qhull",)  # begins the name of a file in a package that meshes
LOADED_LATER = ("libgcc_s.so.1",)  # by the C library itself, so no file names it
_LIBRARY = re.compile(r"(?:=> )?(/\S+) \(0x")


@dataclass(frozen=True)
class Place:
    """What is mounted in a sandbox, all read-only.

    interpreter : the file of the Python that runs
    standard : folders of the standard library
    libraries : shared libraries outside the other folders
    packages : (file or folder, its name) of each part of the packages
    hidden : files inside those that are covered
    named : the packages that were asked for, not those that these need
    """

    interpreter: str
    standard: tuple[str, ...]
    libraries: tuple[str, ...]
    packages: tuple[tuple[str, str], ...]
    hidden: tuple[str, ...]
    named: tuple[str, ...] = ("numpy", "matplotlib")

    @property
    def names(self) -> list[str]:
        """Top-level names that can be imported."""
        return sorted({name.partition(".")[0] for _, name in self.packages if "-info" not in name})


def place_of(more: Sequence[str] = (), libraries: bool = True) -> Place:
    """The place for a kernel of this very Python, with the packages ``more`` besides those it needs.

    ``libraries=False`` spares the search for shared libraries, where nothing is mounted anyway. Raises OSError where they
    cannot be found, and LookupError that names a package that is not installed.
    """
    found: dict[str, Distribution] = {}
    for name in (*NEEDED, *more):
        _collect(name, found, needed=True)
    packages = sorted({part for dist in found.values() for part in _parts(dist)})
    standard = _standard_library()
    interpreter = os.path.realpath(sys.executable)
    folders = [*standard, *(path for path, _ in packages)]
    found_libraries = sorted(_libraries([interpreter, *_extensions(folders)])) if libraries else []
    inside = tuple(f"{folder}/" for folder in folders)
    hidden = tuple(
        str(file)
        for start in HIDDEN
        for path, name in packages
        if name == start.partition("/")[0]
        for file in sorted(Path(path).glob(start.partition("/")[2] + "*"))
    )
    outside = tuple(path for path in found_libraries if not path.startswith(inside))
    return Place(interpreter, standard, outside, tuple(packages), hidden, (*NEEDED[1:], *more))


def _collect(name: str, found: dict[str, Distribution], needed: bool = False) -> None:
    from packaging.requirements import Requirement

    key = name.lower().replace("_", "-")
    if key in found or key in IDLE:
        return
    try:
        found[key] = distribution(name)
    except PackageNotFoundError:
        if needed:
            raise LookupError(f"the package {name} is not installed, but grading kernels are to have it") from None
        return
    for line in found[key].requires or ():
        requirement = Requirement(line)
        if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
            _collect(requirement.name, found)


def _parts(dist: Distribution) -> Iterator[tuple[str, str]]:
    """The files and folders directly in the packages' folder that belong to a distribution."""
    for first in {file.parts[0] for file in dist.files or ()} - {"..", "__pycache__"}:
        path = str(dist.locate_file(first))
        if not first.endswith(".pth") and os.path.exists(path):
            yield path, first


def _standard_library() -> tuple[str, ...]:
    folders = [sysconfig.get_path("stdlib"), *(path for path in sys.path if path.endswith("lib-dynload"))]
    return tuple(dict.fromkeys(os.path.realpath(folder) for folder in folders if os.path.isdir(folder)))


def _extensions(folders: Sequence[str]) -> Iterator[str]:
    for folder in folders:
        for at, inner, files in os.walk(folder):
            inner[:] = [name for name in inner if name not in ("site-packages", "dist-packages", "__pycache__", "test")]
            yield from (
                os.path.join(at, file)
                for file in files
                if (file.endswith(".so") or ".so." in file) and not file.startswith(IDLE_EXTENSION)
            )


def _libraries(binaries: Sequence[str]) -> set[str]:
    """The shared libraries that ``binaries`` load, the loader among them. Raises OSError if ``ldd`` cannot be run."""
    told = subprocess.run(["ldd", *binaries], capture_output=True, text=True, check=False, timeout=120).stdout
    libraries = set(_LIBRARY.findall(told))
    folders = {os.path.dirname(path) for path in libraries}
    return libraries | {path for name in LOADED_LATER for folder in folders if os.path.exists(path := f"{folder}/{name}")}
