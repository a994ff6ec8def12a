"""The player: a widget that steps through a trace, or through a generator that is still running."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import traitlets

from fem_mesh.errors import MeshError
from fem_mesh.recording import Recording
from fem_mesh.steps import Step, many
from fem_mesh.trace import Trace
from fem_mesh.watch.front import PLAYER_WIDGET, module
from fem_mesh.watch.live import Live
from fem_mesh.watch.page import html_of_trace
from fem_mesh.watch.wire import as_data

AT_ONCE = 2_000  # steps that a player takes of a generator at first,
PATIENCE = 2.0  # seconds that it waits for them,
MORE = 500  # and steps that it loads on demand
MOST_SENT = 20_000  # steps of a trace that travel at once
SPEEDS = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0]
NOTE = "This copy of the player works without Python: no live widget is here."


class Player(Live):
    """A widget that steps through a trace: forward, back, to the next step of the same kind, at any speed.

    It plays in the browser, so no step is skipped, however busy the kernel is. Its traits may be set, observed
    and linked:

    step : int, the step that is shown
    playing : bool
    speed : 0.25, 0.5, 1, 2, 4 or 8; at 1 it shows two steps a second
    circles : bool, whether circles are shown
    numbers : bool or None, whether vertices are numbered (None: if there are not many)

    ``trace`` is what it plays; ``load(500)`` takes further steps of a generator that has not ended.
    """

    _esm = module(PLAYER_WIDGET, "export default { render: (context) => renderPlayer(context, STYLE) };")
    data = traitlets.Dict().tag(sync=True)
    step = traitlets.Int(0).tag(sync=True)
    playing = traitlets.Bool(False).tag(sync=True)
    speed = traitlets.Enum(SPEEDS, 1.0).tag(sync=True)
    circles = traitlets.Bool(True).tag(sync=True)
    numbers = traitlets.Bool(None, allow_none=True).tag(sync=True)

    def __init__(self, source: Trace | Iterable[Step], view: Any = None, **traits: Any) -> None:
        if isinstance(source, Trace):
            if view is not None:
                raise MeshError("view goes with a generator: a trace has one of its own, trace.view")
            self._recording, self.trace = None, source
        else:
            self._recording = Recording(source, view)
            self._recording.take(AT_ONCE, PATIENCE)
            self.trace = self._recording.trace
        if not len(self.trace):
            raise MeshError("there is no step to play: the trace is empty")
        self._sent = min(len(self.trace), MOST_SENT)
        step = traits.pop("step", 0)
        super().__init__(data=as_data(self.trace, self._sent), **traits)
        self.step = step
        self.on_msg(self._answer)

    def load(self, steps: int = MORE) -> None:
        """Take ``steps`` further steps, as many as there are; those that came before a generator fails are shown."""
        if steps < 1:
            raise MeshError(f"at least one further step can be taken, not {steps}")
        try:
            if self._sent == len(self.trace) and self._recording is not None:
                self._recording.take(steps)
        finally:
            self._sent = min(self._sent + steps, len(self.trace))
            self.data = as_data(self.trace, self._sent)

    def _answer(self, _widget: Any, message: dict[str, Any], _buffers: Any) -> None:
        if message.get("type") != "more":
            return
        try:
            self.load()
        except BaseException as error:  # an interrupt as well: the reader waits for an answer
            self.send({"type": "failed", "said": f"the generator failed: {type(error).__name__}: {error}"})
            raise

    @traitlets.validate("step")
    def _within(self, proposal: Any) -> int:
        return int(min(max(proposal["value"], 0), self._sent - 1))

    def still(self, key: str) -> str:
        return html_of_trace(self.trace, stands_in=key, note=NOTE)

    def __repr__(self) -> str:
        return f"Player of {many(len(self.trace), 'step')}"


def play(source: Trace | Iterable[Step], view: tuple[float, float, float, float] | None = None, **traits: Any) -> Player:
    """Play a trace, or a generator of steps, in a notebook.

    source : a Trace, or any generator that yields ``fm.Step`` (one that is endless is taken some steps at a time)
    view : left, right, bottom, top of the picture, for a generator; by default every point is in it
    traits : step, playing, speed, circles, numbers: how it begins (see ``Player``)

    Returns the Player, an ipywidget. Keys: space, arrows, home, end, [ and ] for the previous and next step of the
    same kind, c circles, n numbers, f full screen, ? for all of them.

    Raises MeshError for a trace without steps, and as ``record`` does.

    >>> import fem_mesh as fm
    >>> points = fm.random_points(16, seed=1)
    >>> player = fm.play(fm.lawson(points, fm.any_triangulation(points)), speed=4)
    >>> player
    Player of 87 steps
    >>> player.step = 8
    >>> player.trace[player.step].kind
    'flip'
    """
    return Player(source, view, **traits)
