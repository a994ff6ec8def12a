"""fem_mesh, as it is while homework is graded: checks, what the homework hands out, and pictures that nobody sees.

Copied into the room as the package's first file, beside ``names.json``.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

_FILE = Path(__file__).with_name("names.json")
_NAMES: dict[str, Any] = json.loads(_FILE.read_text(encoding="utf-8")) if _FILE.exists() else {}


class Nothing:
    """Stands in for pictures and players: whatever is asked of it, nothing comes of it."""

    def __call__(self, *arguments: object, **options: object) -> Nothing:
        return self

    def __getattr__(self, name: str) -> Nothing:
        if name.startswith("_"):
            raise AttributeError(name)
        return self

    def __iter__(self) -> Iterator[Nothing]:
        return iter(())

    def __repr__(self) -> str:
        return "no picture while homework is graded"


class Refused:
    """Stands in for what is not handed out: it says so as soon as it is used."""

    def __init__(self, why: str) -> None:
        object.__setattr__(self, "_why", why)

    def __call__(self, *arguments: object, **options: object) -> NoReturn:
        raise RuntimeError(object.__getattribute__(self, "_why"))

    def __getattr__(self, name: str) -> NoReturn:
        if name.startswith("_"):  # what Python itself asks for, to show it for instance
            raise AttributeError(name)
        raise RuntimeError(object.__getattribute__(self, "_why"))


def __getattr__(name: str) -> Any:
    if name == "check":
        return import_module("fem_mesh.check")
    if name in _NAMES.get("handed_out", ()):
        return getattr(import_module(_NAMES["handed_out"][name]), name)
    if name in _NAMES.get("pictures", ()):
        return Nothing()
    if name in _NAMES.get("solvers", ()):
        return Refused(f"fm.{name} meshes for you, so it is not there while homework is graded: write it yourself")
    if name in _NAMES.get("others", ()):
        return Refused(f"fm.{name} is not handed out in this homework: do without it, or ask whether it may be used")
    raise AttributeError(f"module 'fem_mesh' has no attribute {name!r}")
