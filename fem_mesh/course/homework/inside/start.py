"""The grading kernel's first lines: limits, what may be imported, then an ordinary kernel.

Copied into the room, and run there alone: standard library only until the limits stand. All this is a courtesy to honest
students, who read *why* an import fails. Security is what is not mounted, and that the verdict is reached elsewhere.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from types import ModuleType

WHY = "No module named {name!r} while homework is graded: only {some}, standard modules and a part of fem_mesh are there"
MESHER = "{name} meshes for you, so it is not there while homework is graded: write it yourself"
MESHERS = ("scipy", "triangle", "meshio", "shapely", "gmsh", "pygmsh", "skimage", "cv2", "sklearn", "trimesh", "meshpy", "dmsh")


class Gate(MetaPathFinder):
    """Refuses what a grading kernel does not have, and says why."""

    def __init__(self, allowed: Sequence[str], named: Sequence[str]) -> None:
        self.allowed = {*allowed, *sys.stdlib_module_names, "fem_mesh"}
        self.named = ", ".join(named)

    def find_spec(self, fullname: str, path: object = None, target: ModuleType | None = None) -> None:
        top = fullname.partition(".")[0]
        if top in MESHERS or fullname == "matplotlib._qhull" or fullname.startswith("fem_mesh.algorithms"):
            if top != "fem_mesh" or not _is_in_the_room(fullname):
                raise ImportError(MESHER.format(name=fullname), name=fullname)  # the other kind would be swallowed
        elif top not in self.allowed:
            raise ModuleNotFoundError(WHY.format(name=fullname, some=self.named), name=fullname)


def _is_in_the_room(name: str) -> bool:
    path = os.path.join(os.path.dirname(__file__), *name.split("."))
    return os.path.isdir(path) or os.path.exists(f"{path}.py")


def limit(memory: int, seconds: int, file_size: int) -> None:
    """Limits that this process cannot lift again, and that its children inherit."""
    try:
        import resource
    except ImportError:  # not on Windows
        return
    for kind, most in (
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_FSIZE, file_size),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_NOFILE, 256),
    ):
        try:
            resource.setrlimit(kind, (most, most))
        except (ValueError, OSError):  # a stricter one stands already, or this system has no such limit
            continue


def main() -> None:
    room = os.path.dirname(os.path.abspath(__file__))
    with open(os.path.join(room, "settings.json"), encoding="utf-8") as file:
        settings = json.load(file)
    limit(settings["memory"], settings["seconds"], settings["file_size"])
    sys.path[:] = dict.fromkeys([room, *sys.path, *settings["path"]])
    from ipykernel.kernelapp import IPKernelApp

    sys.meta_path.insert(0, Gate(settings["allowed"], settings["named"]))
    options = ["--HistoryManager.enabled=False", "--log-level=CRITICAL", "--InteractiveShell.cache_size=0"]
    IPKernelApp.launch_instance(["-f", sys.argv[1], *options])


if __name__ == "__main__":
    main()
