"""The playground: a Delaunay triangulation to click into."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import chain
from typing import Any

import numpy as np
import traitlets

from fem_mesh.algorithms import ahead
from fem_mesh.algorithms.live import LiveDelaunay, say_move
from fem_mesh.errors import MeshError
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.points import as_points, view_box
from fem_mesh.mesh.quality import cocircular_edges
from fem_mesh.steps import Step
from fem_mesh.trace import Trace
from fem_mesh.watch.front import PLAYGROUND, module
from fem_mesh.watch.live import Live, undisturbed
from fem_mesh.watch.page import html_of_picture
from fem_mesh.watch.svg import svg_of_mesh

BOX = (-0.06, 1.06, -0.06, 1.06)  # what an empty playground shows: the unit square
FILLED = 0.2  # points that spread so far in the unit square are seen in it
RING = ((5, 0), (4, 3), (3, 4), (0, 5), (-3, 4), (-4, 3), (-5, 0), (-4, -3), (-3, -4), (0, -5), (3, -4), (4, -3))
GRID = 5  # points a side
MARGIN = 0.06  # around the unit square, as a share of it
MOST_TOLD = 300  # points to begin with that are inserted one by one in the trace
MOST_UNDONE = 200  # changes, or as many as take
MOST_KEPT = 50_000_000  # bytes
FAR = 20.0  # how far Voronoi edges without an end go, as a part of what the view shows
NOTE = "A picture of the playground: where the notebook runs, its cell makes it answer clicks."


class Playground(Live):
    """A Delaunay triangulation to click into: each click is answered by the engine's own insertion, point by point.

    points : (n, 2) to begin with; by default none
    seed : of the random points that its buttons make
    traits : circles, voronoi, ties, numbers, animated: what is shown at first; they may be set, observed and linked

    Click to add a point, drag one to move it, shift-click it or press delete to take it out; ? shows all keys. What
    you do is there in Python at once: ``points``, ``mesh``, ``trace`` (every step since the last beginning), and
    ``add``, ``move``, ``remove``, ``undo``, ``redo``, ``clear`` do in code what the pointer does.

    Numbers stay 0 .. n - 1: when a point is taken out, the last one takes its number.

    Raises MeshError for points that are no finite pairs of numbers.

    >>> import fem_mesh as fm
    >>> playground = fm.Playground([(0, 0), (1, 0), (0, 1)])
    >>> playground.add(0.25, 0.25)
    'point 3 is joined to the 3 edges around the cavity: 3 triangles come, 1 goes'
    >>> playground
    Playground: 4 points, 3 triangles, smallest angle 18.4 degrees
    >>> playground.undo()
    >>> playground.mesh.triangles.tolist()
    [[0, 1, 2]]
    """

    _esm = module(PLAYGROUND, "export default { render: (context) => renderPlayground(context, STYLE) };")
    box = traitlets.Tuple(BOX).tag(sync=True)
    circles = traitlets.Bool(False).tag(sync=True)
    voronoi = traitlets.Bool(False).tag(sync=True)
    ties = traitlets.Bool(False).tag(sync=True)
    numbers = traitlets.Bool(None, allow_none=True).tag(sync=True)
    animated = traitlets.Bool(True).tag(sync=True)
    version = traitlets.Int(0)  # grows with every change: observe it to follow

    def __init__(self, points: Any = None, seed: int = 0, **traits: Any) -> None:
        given = as_points(() if points is None else points)
        traits.setdefault("box", _box_of(given))
        super().__init__(**traits)
        self._random = np.random.default_rng(seed)
        self._live: LiveDelaunay
        self._steps: list[Step]
        self._dragged: Any = None  # the state before the drag under way, and its triangles
        self._done: list[Any] = []
        self._undone: list[Any] = []
        self._said = "click to add a point"
        self._begin(given)
        self.on_msg(self._answer)
        self.observe(lambda _change: self._send_all(), ["ties", "voronoi"])

    # ---- what there is ---------------------------------------------------------------------------

    @property
    @undisturbed
    def points(self) -> np.ndarray:
        """The points, float64 (n, 2)."""
        return self._live.points

    @property
    @undisturbed
    def mesh(self) -> Mesh:
        """The triangulation as it stands."""
        return self._live.mesh()

    @property
    @undisturbed
    def trace(self) -> Trace:
        """Every step since the playground was last begun anew."""
        trace = Trace()
        trace.view = self.box
        for step in self._steps:
            trace.append(step)
        trace.mesh = self.mesh
        return trace

    @undisturbed
    def as_code(self) -> str:
        """The lines that make this playground again."""
        rows = ",\n".join(f"    ({x!r}, {y!r})" for x, y in self.points.tolist())
        given = f"[\n{rows},\n]" if rows else ""
        return f"import fem_mesh as fm\n\nplayground = fm.Playground({given})\nplayground"

    # ---- what one does -----------------------------------------------------------------------------

    def add(self, x: float, y: float) -> str:
        """Add a point, as a click does. Returns what happened, in a sentence."""
        return self._change(lambda: self._live.add(x, y))

    def remove(self, i: int) -> str:
        """Take point ``i`` out; the last point takes its number."""
        return self._change(lambda: self._live.remove(i))

    def move(self, i: int, x: float, y: float) -> str:
        """Move point ``i``."""
        return self._change(lambda: self._live.move(i, x, y))

    @undisturbed
    def begin(self, points: Any = ()) -> None:
        """Begin anew with these points."""
        given = as_points(points)
        self._remember()
        left, right, bottom, top = self.box
        inside = (given >= (left, bottom)).all() and (given <= (right, top)).all()
        self.box = self.box if inside else _box_of(given)
        self._begin(given)
        self._send_all()

    def clear(self) -> None:
        """Begin anew without a point."""
        self.begin()

    def undo(self) -> None:
        """Take the last change back."""
        self._go_back(self._done, self._undone)

    def redo(self) -> None:
        """Make the change again that ``undo`` took back."""
        self._go_back(self._undone, self._done)

    def _begin(self, points: np.ndarray) -> None:
        few = len(points) <= MOST_TOLD
        self._live = LiveDelaunay(() if few else points)
        self._steps = [] if few else [self._live.start()]
        for x, y in points.tolist() if few else ():
            self._steps += self._live.add(x, y)
        self._said = self._steps[-1].caption if self._steps else "click to add a point"

    @undisturbed
    def _change(self, change: Callable[[], list[Step]]) -> str:
        self._drop()
        state = self._state()
        steps = change()
        if any(step.added or step.removed or step.new_points for step in steps):
            self._remember(state)
        self._steps += steps
        self._said = steps[-1].caption
        self._tell({"type": "steps", "steps": [_as_message(step) for step in steps], "animated": self.animated})
        return self._said

    # ---- going back ------------------------------------------------------------------------------

    def _state(self) -> tuple[Any, ...]:
        return self._live, self._live.snapshot(), tuple(self._steps), self._said, self.box

    def _remember(self, state: Any = None) -> None:
        self._drop()
        self._push(state or self._state())

    def _push(self, state: Any) -> None:
        self._done.append(state)
        self._undone.clear()
        del self._done[:-MOST_UNDONE]
        while len(self._done) > 1 and sum(map(_weight, self._done)) > MOST_KEPT:  # ends: one is left
            del self._done[0]

    @undisturbed
    def _go_back(self, here: list[Any], there: list[Any]) -> None:
        self._drop()
        if here:
            there.append(self._state())
            self._live, snapshot, steps, self._said, self.box = here.pop()
            self._live.restore(snapshot)
            self._steps = list(steps)
            self._send_all()

    def _drag(self, i: int, x: float, y: float, last: bool) -> None:
        """A drag is many moves to the eye, and one to the trace and to undo."""
        if self._dragged is not None and self._dragged[2] != i:  # another hand, or one whose end was not heard
            self._drop()
        before = self._dragged or (self._state(), _rows(self._live.triangles), i)
        steps = self._live.move(i, x, y)
        self._said, self._dragged = steps[-1].caption, before
        if last:
            self._drop()
        self._tell({"type": "steps", "steps": [_as_message(step) for step in steps], "animated": False})

    def _drop(self) -> None:
        """End the drag under way, if there is one."""
        if self._dragged is None:
            return
        (state, before, i), self._dragged = self._dragged, None
        now, place = _rows(self._live.triangles), tuple(self.points[i].tolist())
        points = state[1][0][1:]
        if place == tuple(points[i].tolist()):  # it is back, or never left
            return
        self._push(state)
        shown = Step("move", say_move, point=place, new_points=[(i, *place)], removed=before - now, added=now - before, i=i)
        self._steps.append(shown)

    # ---- the browser -----------------------------------------------------------------------------

    @undisturbed
    def _answer(self, _widget: Any, message: dict[str, Any], _buffers: Any) -> None:
        actions: dict[str, Callable[[], Any]] = {
            "all": self._greet,
            "add": lambda: self.add(message["x"], message["y"]),
            "remove": lambda: self.remove(message["i"]),
            "move": lambda: self._drag(message["i"], message["x"], message["y"], bool(message.get("last"))),
            "random": lambda: self.begin(self._made(16)),
            "more": lambda: self._add_all(self._made(20)),
            "ring": lambda: self.begin(self._lattice(np.array(RING), 13)),
            "grid": lambda: self.begin(self._lattice(2 * np.argwhere(np.ones((GRID, GRID))) - (GRID - 1), 2 * GRID)),
            "clear": self.clear,
            "undo": self.undo,
            "redo": self.redo,
            "code": lambda: self.send({"type": "code", "text": self.as_code()}),
        }
        try:
            actions[message["type"]]()
        except MeshError as error:
            self._said = str(error)
            self._tell({"type": "steps", "steps": []})

    def _greet(self) -> None:
        """A browser asks for everything: what it shows may soon be large."""
        ahead.compile_ahead()
        self._send_all()

    def _add_all(self, points: np.ndarray) -> None:
        self._remember()
        for x, y in points.tolist():
            self._steps += self._live.add(x, y)
        self._said = self._steps[-1].caption
        self._send_all()

    def _made(self, n: int) -> np.ndarray:
        """Random points in the middle of the view, with few decimals."""
        (left, right, bottom, top), margin = self.box, MARGIN / (1 + 2 * MARGIN) * max(self._extent)
        made = self._random.uniform((left + margin, bottom + margin), (right - margin, top - margin), (n, 2))
        return np.asarray(made.round(4 - math.floor(math.log10(max(self._extent)))))

    def _lattice(self, places: Any, across: int) -> np.ndarray:
        """``places`` in whole numbers, in the middle of the view, scaled by a power of two: their ties stay exact."""
        left, right, bottom, top = self.box
        unit = 2.0 ** math.floor(math.log2(min(self._extent) / across))
        middle = np.rint(np.array([left + right, bottom + top]) / 2 / unit)
        return np.asarray((np.asarray(places) + middle) * unit)

    @property
    def _extent(self) -> tuple[float, float]:
        left, right, bottom, top = self.box
        return right - left, top - bottom

    @undisturbed
    def _send_all(self) -> None:
        points, triangles = self.points.astype("<f8"), self._live.triangles.astype("<i4")
        self._tell({"type": "all"}, [points.tobytes(), triangles.tobytes()])

    def _tell(self, message: dict[str, Any], buffers: list[bytes] | None = None) -> None:
        message |= {"said": self._said, "undo": bool(self._done), "redo": bool(self._undone)}
        mesh = self.mesh if self.ties or self.voronoi else None
        if mesh is not None and self.ties:
            message["ties"] = cocircular_edges(mesh.points, mesh.triangles, mesh.neighbors).ravel().tolist()
        if mesh is not None and self.voronoi:
            message["voronoi"] = True
            buffers = [*(buffers or []), mesh.voronoi().ends(FAR * max(self._extent)).astype("<f8").tobytes()]
        self.send(message, buffers)
        self.version += 1

    @undisturbed
    def still(self, key: str) -> str:
        svg = svg_of_mesh(self.mesh, repr(self), circles=self.circles, numbers=self.numbers, voronoi=self.voronoi)
        return html_of_picture(svg, repr(self), key, NOTE)

    @undisturbed
    def __repr__(self) -> str:
        return repr(self.mesh).replace("Mesh", "Playground", 1) if len(self.points) else "Playground: no points yet"


def _box_of(points: np.ndarray) -> Any:
    """What a view of these points shows: the unit square, if it is filled by them or if there is none."""
    if not len(points):
        return BOX
    (left, bottom), (right, top) = low, high = points.min(axis=0), points.max(axis=0)
    if len(points) == 1 or not (high > low).any():
        return left - 0.5, left + 0.5, bottom - 0.5, bottom + 0.5
    if min(left, bottom) >= BOX[0] and max(right, top) <= BOX[1] and (high - low).max() > FILLED:
        return BOX
    return view_box(points)


def _rows(triangles: np.ndarray) -> set[Any]:
    """Triangles as a set, each with its lowest corner first."""
    return {(a, b, c) if a < b and a < c else (b, c, a) if b < c else (c, a, b) for a, b, c in triangles.tolist()}


def _weight(state: Any) -> int:
    return sum(array.nbytes for array in state[1])


def _as_message(step: Step) -> dict[str, Any]:
    flat = {name: list(chain.from_iterable(getattr(step, name))) for name in ("added", "removed", "doomed", "edges")}
    return {"kind": step.kind, "point": step.point, "new_points": step.new_points, "gone_points": step.gone_points, **flat}
