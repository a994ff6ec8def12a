"""A figure that says in a sentence what it shows."""

from __future__ import annotations

import base64
import io
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

DPI = 110
COLORS = 128  # of a notebook's pictures


class Picture:
    """A Matplotlib figure with a sentence that says what it shows.

    As a cell's result it shows the figure, with the sentence as the image's alternative text and as
    ``text/plain``; so it is the same wherever the notebook runs. ``figure`` and ``axes`` are
    Matplotlib's own; ``save(path)`` writes a file.

    >>> from matplotlib.figure import Figure
    >>> Picture(Figure(), "an empty page")
    an empty page
    """

    def __init__(self, figure: Figure, alt: str) -> None:
        self.figure, self.alt = figure, alt

    @property
    def axes(self) -> Axes:
        return self.figure.axes[0]

    def save(self, path: Any) -> None:
        """Write the figure to ``path``; the ending decides the format, as Matplotlib reads it."""
        if str(path).lower().endswith(".png"):
            Path(path).write_bytes(self._png(2 * DPI))
        else:
            self.figure.savefig(path, facecolor=self.figure.get_facecolor())

    def __repr__(self) -> str:
        return self.alt

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> Any:
        data = {"text/plain": self.alt, "image/png": base64.b64encode(self._png(DPI)).decode()}
        return data, {"image/png": {"alt": self.alt}}

    def _png(self, dpi: int) -> bytes:
        """The figure with COLORS colours: a third of the size, and no difference to the eye."""
        full, small = io.BytesIO(), io.BytesIO()
        self.figure.savefig(full, format="png", dpi=dpi, facecolor=self.figure.get_facecolor())
        Image.open(full).convert("RGB").quantize(COLORS).save(small, format="png", optimize=True)
        return small.getvalue()


def picture_of(page: Axes, alt: str) -> Picture:
    """The figure of axes that fill a figure of their own, as a Picture that says ``alt``."""
    assert isinstance(page.figure, Figure)
    return Picture(page.figure, alt)
