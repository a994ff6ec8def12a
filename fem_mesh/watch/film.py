"""A trace as a film (.gif, .mp4), a contact sheet (.png) or a page (.html)."""

from __future__ import annotations

import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.figure import Figure
from tqdm import tqdm

from fem_mesh.errors import MeshError
from fem_mesh.watch.draw import draw_step, new_axes
from fem_mesh.watch.page import save_page
from fem_mesh.watch.picture import DPI, Picture
from fem_mesh.watch.style import PAPER

if TYPE_CHECKING:
    from fem_mesh.trace import Trace

SHEET = 12  # frames on a contact sheet
HOLD = 2.0  # seconds that a film rests on its last frame


def save_trace(
    trace: Trace, path: Any, *, fps: float | None = None, steps: Iterable[int] | None = None, **options: Any
) -> None:
    """Write a trace to ``path``; the ending decides what it becomes.

    .html : a page that plays, anywhere and without a network; as it stands, the first frame and all steps in words
    .gif, .mp4 : a film, ``fps`` steps a second (2 by default); .mp4 needs the program ffmpeg
    .png : a contact sheet of some 12 steps, or of the ``steps`` given

    ``options`` are those of ``draw_step``. Raises MeshError for an empty trace, steps that are not there, another
    ending, an option that a file of this ending cannot keep, or where ffmpeg is missing.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in (".html", ".gif", ".mp4", ".png"):
        raise MeshError(f"a trace is saved as .html, .gif, .mp4 or .png, not as {path.suffix or path.name!r}")
    chosen = _choose(trace, steps, "save")
    if ending in (".png", ".html") and fps is not None:
        raise MeshError(f"fps is for films: leave it out of {ending}, or save a .gif")
    if ending == ".png":
        contact_sheet(trace, None if steps is None else chosen, **options).save(path)
    elif ending == ".html":
        save_page(trace, path, None if steps is None else chosen, **options)
    else:
        _save_film(trace, path, 2.0 if fps is None else fps, chosen, options)


def _choose(trace: Trace, steps: Iterable[int] | None, verb: str) -> list[int]:
    """The numbers of the steps asked for, all of them by default."""
    chosen = list(range(len(trace)) if steps is None else steps)
    if not chosen:
        raise MeshError(f"there is no step to {verb}: " + ("the trace is empty" if steps is None else "steps is empty"))
    for k in chosen:
        if not -len(trace) <= k < len(trace):
            raise MeshError(f"there is no step {k} to {verb}: the trace has {len(trace)}")
    return chosen


class Animation(FuncAnimation):
    """Matplotlib's, which may be thrown away without having been shown."""

    def __del__(self) -> None:
        pass  # Matplotlib's would warn


def animate(trace: Trace, fps: float = 2.0, *, steps: Iterable[int] | None = None, **options: Any) -> Animation:
    """The steps of a trace, all or those given, as a Matplotlib animation; ``options`` are those of ``draw_step``."""
    frames = _choose(trace, steps, "animate")
    if not 0 < fps < np.inf:
        raise MeshError(f"fps is how many steps are shown in a second: a number > 0, not {fps!r}")
    page = new_axes(bool(options.get("dark", False)))
    assert isinstance(page.figure, Figure)

    def draw(k: int) -> None:
        draw_step(trace, k, page, **options)

    return Animation(page.figure, draw, frames, init_func=lambda: None, interval=1000 / fps, cache_frame_data=False)


def contact_sheet(trace: Trace, steps: Iterable[int] | None = None, **options: Any) -> Picture:
    """Some steps of a trace on one sheet, in reading order."""
    chosen = list(steps) if steps is not None else choose_steps(len(trace))
    columns = len(chosen) if len(chosen) <= 3 else min(4, int(np.ceil(np.sqrt(len(chosen)))))
    rows = -(-len(chosen) // columns)
    dark = bool(options.get("dark", False))
    figure = Figure(figsize=(5.2 * columns, 4.9 * rows), facecolor=PAPER[dark])
    axes = figure.subplots(rows, columns, squeeze=False)
    figure.subplots_adjust(
        left=0.015, right=0.985, top=1 - 0.85 / (4.9 * rows), bottom=0.35 / (4.9 * rows), hspace=0.32, wspace=0.06
    )
    for ax in axes.flat:
        ax.set_axis_off()
    for ax, k in zip(axes.flat, tqdm(chosen, desc="drawing", delay=2, leave=False), strict=False):
        draw_step(trace, k, ax, **options)
    return Picture(figure, f"{len(chosen)} of {len(trace)} steps: " + ", ".join(f"{k} {trace[k].kind}" for k in chosen))


def choose_steps(n: int) -> list[int]:
    """Up to a sheet's worth of step numbers, evenly from the first to the last."""
    return sorted({int(k) for k in np.linspace(0, n - 1, min(n, SHEET)).round()})


def _save_film(trace: Trace, path: Path, fps: float, steps: Iterable[int], options: dict[str, Any]) -> None:
    if path.suffix.lower() == ".mp4" and shutil.which("ffmpeg") is None:
        raise MeshError("an .mp4 needs the program ffmpeg, which is not installed: save a .gif instead")
    frames = list(steps)
    frames += frames[-1:] * int(HOLD * min(fps, 100))
    film = animate(trace, fps, steps=frames, **options)
    writer = PillowWriter(fps=fps) if path.suffix.lower() == ".gif" else FFMpegWriter(fps=fps)  # type: ignore[arg-type]
    with tqdm(total=len(frames), desc=path.name, delay=2, leave=False) as bar:
        film.save(
            str(path), writer=writer, dpi=DPI, savefig_kwargs={"facecolor": PAPER[bool(options.get("dark", False))]},
            progress_callback=lambda _frame, _total: bar.update(),
        )  # fmt: skip
