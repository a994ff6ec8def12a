"""What the live widgets have in common: an anywidget, and a still picture for where it does not live.

A displayed widget is two outputs. The first is plain HTML: it is hidden while the second, the widget itself, is
alive; it is what remains in an exported page, in a notebook opened again, and where anywidget's front end is missing.
"""

from __future__ import annotations

import functools
import threading
import zlib
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import traitlets
from anywidget import AnyWidget
from IPython.display import display

from fem_mesh.watch.front import css

P = ParamSpec("P")
T = TypeVar("T")

VIEW = "application/vnd.jupyter.widget-view+json"

_changes = threading.RLock()  # one for all widgets: they may be linked, and two locks could wait for each other


def undisturbed(method: Callable[P, T]) -> Callable[P, T]:
    """A method that works while no other thread does: JupyterLab hands a page's messages over in a thread of their own,
    so a click may come while a cell is running."""

    @functools.wraps(method)
    def alone(*args: P.args, **kwargs: P.kwargs) -> T:
        with _changes:
            return method(*args, **kwargs)

    return alone


class Live(AnyWidget):
    """A widget with a still picture beside it."""

    _css = css()
    key = traitlets.Unicode().tag(sync=True)  # ties the widget to its still picture

    @undisturbed
    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value)  # a trait that a cell sets finds no other change half made

    @undisturbed
    def set_state(self, sync_data: dict[str, Any]) -> None:
        super().set_state(sync_data)

    def still(self, key: str) -> str:
        """HTML that stands in for the widget where ``key`` is not alive."""
        raise NotImplementedError

    def _ipython_display_(self) -> None:
        if not self.key:
            self.key = f"{type(self).__name__}-{zlib.crc32(self.still('').encode()):08x}"  # the same in every run
        display({"text/plain": repr(self), "text/html": self.still(self.key)}, raw=True)
        data = self._repr_mimebundle_()
        bundle: Any = data[0] if isinstance(data, tuple) else data
        if bundle and VIEW in bundle:
            display({VIEW: bundle[VIEW]}, raw=True)
