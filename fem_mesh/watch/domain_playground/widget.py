"""The domain playground: an outline to draw, and a mesh that follows."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import traitlets

from fem_mesh.algorithms import ahead
from fem_mesh.algorithms.constrained_delaunay import constrained_delaunay, insert_segments
from fem_mesh.algorithms.refine import refine
from fem_mesh.algorithms.refining.watched import ruppert
from fem_mesh.domain.domain import Domain
from fem_mesh.errors import MeshError
from fem_mesh.kernel import compiling
from fem_mesh.mesh.mesh import Mesh
from fem_mesh.mesh.points import view_box
from fem_mesh.recording import record
from fem_mesh.steps import many
from fem_mesh.trace import Trace
from fem_mesh.watch.domain_playground.sketch import SHAPES, Sketch, number, places, wrapped
from fem_mesh.watch.domain_playground.tell import arrays_of, encroached_segments, say_state
from fem_mesh.watch.front import DOMAIN_PLAYGROUND, css, module
from fem_mesh.watch.live import Live, undisturbed
from fem_mesh.watch.page import html_of_picture
from fem_mesh.watch.svg import svg_of_mesh
from fem_mesh.watch.wire import as_data

PAGE = (0.0, 6.0, 0.0, 4.0)  # left, right, bottom, top of an empty one
STEEPEST = 36.0  # degrees, up to which all meshes but those with small input angles end
MOST_POINTS = 20_000  # that a mesh may have added,
FEW_POINTS = 300  # and while compiling has not ended: in a twentieth of a second
MOST_STEPS = 5_000  # of a run that is played
GROWTH = 0.3  # of sizes with the distance from a spot
BOUNDS = ("min_angle", "size", "spots", "encroachment")  # traits
NOTE = "A picture of the domain playground: where the notebook runs, its cell makes it answer the pointer."


class DomainPlayground(Live):
    """A domain to draw: click its corners, and a mesh follows live.

    domain : a Domain to begin with; by default an empty page
    traits : min_angle, size, spots, encroachment: how it begins

    The first closed loop is the outline, further ones are holes and islands. Corners can be dragged, sliders set the
    bounds, a brush asks for small triangles. In the browser, ? shows all keys. In Python, live:

    domain : what is drawn, a Domain; None while nothing is closed, or while it is refused. Set it to begin anew
    mesh : its mesh, a Mesh or None. Observe it to follow
    min_angle : the smallest angle asked for, 0 to 36 degrees. With 0 and no sizes no points are added
    size : the longest edge asked for, or None
    spots : triples (x, y, h): around (x, y) edges of at most h + 0.3 times the distance
    encroachment : "lens" or "circle", as ``refine`` takes it
    trace : the run of ``ruppert`` on this domain, up to 5,000 steps, recorded when it is asked for
    refusal : why there is no mesh, a sentence, or ""

    ``min_angle``, ``size``, ``spots`` and ``encroachment`` may be set, observed and linked. ``as_code()`` gives the
    lines of Python that make domain and mesh again. Raises MeshError for anything that is no Domain.

    >>> import fem_mesh as fm
    >>> playground = fm.DomainPlayground(fm.l_shape())
    >>> playground
    DomainPlayground: 6 corners, 4 triangles, smallest angle 45.0 degrees
    >>> playground.size = 0.5
    >>> len(playground.mesh.triangles)
    52
    >>> print(playground.as_code())
    import fem_mesh as fm
    <BLANKLINE>
    domain = fm.l_shape()
    mesh = fm.refine(domain, min_angle=20, size=0.5)
    mesh
    """

    _css = css("domain_playground/board.css")
    _esm = module(DOMAIN_PLAYGROUND, "export default { render: (context) => renderDomainPlayground(context, STYLE) };")
    min_angle = traitlets.Float(20.0, min=0.0, max=STEEPEST).tag(sync=True)
    size = traitlets.Float(None, allow_none=True).tag(sync=True)
    spots: Any = traitlets.List().tag(sync=True)
    encroachment = traitlets.Enum(["lens", "circle"], "lens").tag(sync=True)
    domain = traitlets.Instance(Domain, allow_none=True)
    mesh = traitlets.Instance(Mesh, allow_none=True, read_only=True)

    def __init__(self, domain: Domain | None = None, **traits: Any) -> None:
        if domain is not None and not isinstance(domain, Domain):
            raise MeshError(f"a DomainPlayground begins with a Domain, not {domain!r:.80}: fm.l_shape() is one")
        self._starts: dict[str, Domain] = {}  # what was begun with, besides the shapes
        self._sketch = Sketch()
        self._key: tuple[Any, ...] | None = None  # what the mesh was made for
        self._opened = False
        self._most = MOST_POINTS
        self._domain: Domain | None = None
        self._trace: Trace | None = None
        self.refusal = ""
        self.where: tuple[float, float] | None = None
        super().__init__(**traits)
        if domain is not None:
            self._sketch = self._begin(domain)
        self._opened = True
        self._update()
        self.on_msg(self._answer)

    # ---- what is drawn, and its mesh ---------------------------------------------------------------

    @property
    @undisturbed
    def trace(self) -> Trace | None:
        """The run that makes the mesh, step by step, up to 5,000 steps; None without a domain."""
        if self._trace is None and self.domain is not None:
            steps = ruppert(self.domain, **self._bounds()) if self._is_bounded else insert_segments(self.domain)
            self._trace = record(steps, MOST_STEPS)
        return self._trace

    @undisturbed
    def as_code(self) -> str:
        """The lines of Python that make this domain and this mesh again."""
        if self.domain is None:
            return "import fem_mesh as fm"
        lines = ["import fem_mesh as fm", *["import numpy as np"] * bool(self.spots), "", self._sketch.as_code()]
        if self.spots:
            most = "np.inf" if self.size is None else number(self.size)
            lines += [
                wrapped(f"spots = {places(self.spots)}"), "\n", "def size(x, y):", f"    wanted = np.full(x.shape, {most})",
                "    for a, b, h in spots:",
                f"        wanted = np.minimum(wanted, h + {GROWTH} * np.hypot(x - a, y - b))", "    return wanted", "\n",
            ]  # fmt: skip
        return "\n".join([*lines, f"mesh = {self._call()}", "mesh"])

    def _call(self) -> str:
        if not self._is_bounded:
            return "fm.constrained_delaunay(domain)"
        options = [f"min_angle={number(self.min_angle)}"]
        options += ["size=size"] if self.spots else [f"size={number(self.size)}"] if self.size else []
        options += [f"max_points={self._most}"] if self._is_cut else []
        options += ['encroachment="circle"'] if self.encroachment == "circle" else []
        return f"fm.refine(domain, {', '.join(options)})"

    @property
    def _is_cut(self) -> bool:
        """Whether as many points were added as may be."""
        refinement = self.mesh.refinement if self.mesh is not None else None
        return refinement is not None and refinement.added >= self._most

    @property
    def _is_bounded(self) -> bool:
        return self.min_angle > 0 or self.size is not None or bool(self.spots)

    def _bounds(self) -> dict[str, Any]:
        """What ``refine`` and ``ruppert`` are asked for."""
        size = sizes_around(self.spots, self.size) if self.spots else self.size
        return {"min_angle": self.min_angle, "size": size, "max_points": self._most, "encroachment": self.encroachment}

    def _update(self, serial: str | None = None, drawn: bool = False, most: int = MOST_POINTS) -> None:
        """Mesh what is drawn within the bounds, unless that was done, and tell the browser."""
        key = (self._sketch, self.min_angle, self.size, tuple(self.spots), self.encroachment, most)
        if key == self._key and serial is None and not drawn:
            return
        with self.hold_trait_notifications():
            if key != self._key:
                self._key, self._most, self._trace = None, most, None  # no mesh is there, should this be interrupted
                with compiling(False if most < MOST_POINTS else None):
                    self._mesh_anew()
                self._key = key
            self._tell(serial, drawn)

    def _mesh_anew(self) -> None:
        self.refusal, self.where = "", None
        domain = mesh = None
        try:
            domain = self._sketch.to_domain()
            if domain is not None:
                mesh = refine(domain, **self._bounds()) if self._is_bounded else constrained_delaunay(domain)
        except MeshError as error:
            self.refusal, self.where, domain = str(error), error.where, None
        self._domain = self.domain = domain
        self.set_trait("mesh", mesh)

    @traitlets.observe(*BOUNDS)
    @undisturbed
    def _bounds_changed(self, _change: Any) -> None:
        if self._opened:
            self._update(most=MOST_POINTS if ahead.is_ready() else self._most)

    @traitlets.observe("domain")
    @undisturbed
    def _domain_changed(self, change: Any) -> None:
        if change["new"] is not self._domain:
            self._sketch = Sketch() if change["new"] is None else self._begin(change["new"])
            self._update(drawn=True)

    @traitlets.validate("size", "spots")
    def _is_valid(self, proposal: Any) -> Any:
        return CHECKS[proposal["trait"].name](proposal["value"])

    # ---- the browser -----------------------------------------------------------------------------

    def _begin(self, domain: Domain) -> Sketch:
        sketch = Sketch.begun_with(domain, f"domain {len(self._starts) + 1}")
        self._starts[sketch.start] = domain
        return sketch

    @undisturbed
    def _answer(self, _widget: Any, message: dict[str, Any], _buffers: Any) -> None:
        kind, serial = message["type"], message.get("serial")
        try:
            if kind == "hello":
                ahead.compile_ahead()
                self._tell(serial, drawn=True, to="hello")
            elif kind == "steps":
                self._send_steps(serial)
            elif kind == "ask":
                self._ask(serial, message)
        except BaseException as error:  # an interrupt as well: the browser waits for an answer
            answer = "steps" if kind == "steps" else "mesh"
            self.send({"type": answer, "serial": serial, "refusal": f"{type(error).__name__}: {error}", "where": None})
            raise

    def _ask(self, serial: str | None, message: dict[str, Any]) -> None:
        bounds = {name: message[name] for name in BOUNDS if name in message}
        with self.hold_trait_notifications():  # observers find all of it changed, and the mesh made; checks come last as well
            for name, value in bounds.items():
                setattr(self, name, CHECKS[name](value) if name in CHECKS else value)
            drawn = message.get("drawn")
            if drawn is not None:
                self._sketch = self._sketch_of(drawn)
            begun = drawn is not None and "points" not in drawn
            self._update(serial, drawn=begun, most=MOST_POINTS if ahead.is_ready() else FEW_POINTS)

    def _sketch_of(self, drawn: dict[str, Any]) -> Sketch:
        start = drawn["start"]
        if start in self._starts:
            begun = Sketch.of(self._starts[start], start)
        else:
            begun = Sketch.of_shape(start) if start in SHAPES else Sketch()
        return begun.edited(drawn["points"], drawn["segments"]) if "points" in drawn else begun

    def _tell(self, serial: str | None, drawn: bool, to: str = "ask") -> None:
        """Send the mesh, or why there is none; with ``drawn``, the sketch as well."""
        mesh, buffers = self.mesh, list[bytes]()
        content: dict[str, Any] = {"type": "mesh", "to": to, "serial": serial, "refusal": self.refusal, "where": self.where}
        compiles = "; more of them as soon as that is compiled" if self._is_cut and self._most < MOST_POINTS else ""
        content |= {
            "state": say_state(mesh) + compiles,
            "code": self.as_code(),
            "bounded": self._is_bounded,
            "asked": {name: getattr(self, name) for name in BOUNDS},
        }
        content |= {"provisional": self._most < MOST_POINTS, "extent": self._extent}
        if mesh is not None:
            lens = self.min_angle if self.encroachment == "lens" and self.min_angle > 0 else None
            buffers, more = arrays_of(mesh, encroached_segments(mesh, lens))
            content |= {"points": len(mesh.points), "triangles": len(mesh.triangles), **more}
        if drawn:
            sketch = self._sketch
            content["drawn"] = {"start": sketch.start, "points": sketch.points, "segments": sketch.segments}
            content |= {"box": view_box(np.array(sketch.points)) if sketch.points else PAGE, "shapes": list(SHAPES)}
        self.send(content, buffers)

    @property
    def _extent(self) -> float:
        """The larger side of what is drawn."""
        if not self._sketch.points:
            return PAGE[1] - PAGE[0]
        return float(np.ptp(np.array(self._sketch.points), axis=0).max())

    def _send_steps(self, serial: str | None) -> None:
        trace = self.trace
        if trace is None:
            answer: dict[str, Any] = {"refusal": "there is no domain to play the steps of"}
        else:
            cut = "" if trace.complete else f"the first {len(trace):,} steps of it: the run goes on"
            if self._is_cut and trace.complete:
                cut = f"a run that may add {self._most:,} points" + "; more when that is compiled" * (self._most < MOST_POINTS)
            answer = {"data": as_data(trace), "cut": cut}
        self.send({"type": "steps", "serial": serial, **answer})

    # ---- showing -----------------------------------------------------------------------------------

    @undisturbed
    def still(self, key: str) -> str:
        svg = "" if self.mesh is None else svg_of_mesh(self.mesh, repr(self), numbers=False)
        return html_of_picture(svg, f"{self!r}; {say_state(self.mesh)}" if svg else repr(self), key, NOTE)

    def __repr__(self) -> str:
        if self.domain is None and not self.refusal:
            return "DomainPlayground: nothing is drawn yet"
        facts = [many(len(self._sketch.points), "corner")]
        if self.mesh is None:
            return f"DomainPlayground: {facts[0]}, refused: {self.refusal}"
        facts.append(many(len(self.mesh.triangles), "triangle"))
        facts += [f"smallest angle {self.mesh.min_angle:.1f} degrees"] if len(self.mesh.triangles) else []
        return "DomainPlayground: " + ", ".join(facts)


def sizes_around(spots: Any, most: float | None) -> Any:
    """A size function: small around the ``spots``, growing with the distance, nowhere larger than ``most``.

    >>> sizes_around([(0.0, 0.0, 0.1)], 1.0)(np.array([0.0, 3.0, 40.0]), np.array([0.0, 0.0, 0.0])).tolist()
    [0.1, 0.9999999999999999, 1.0]
    """

    def size(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        wanted = np.full(x.shape, np.inf if most is None else most)
        for a, b, h in spots:
            wanted = np.minimum(wanted, h + GROWTH * np.hypot(x - a, y - b))
        return wanted

    return size


def _as_size(size: float | None) -> float | None:
    if size is not None and not 0 < size < math.inf:
        raise traitlets.TraitError(f"size must be a number > 0, or None, not {size!r}")
    return size


def _as_spots(spots: Any) -> list[tuple[float, float, float]]:
    try:
        triples = [(float(x), float(y), float(h)) for x, y, h in spots]
    except (TypeError, ValueError):
        triples = [(0.0, 0.0, math.nan)]
    if not all(math.isfinite(x) and math.isfinite(y) and 0 < h < math.inf for x, y, h in triples):
        raise traitlets.TraitError(f"spots must be triples (x, y, h) with h > 0, not {spots!r:.80}")
    return triples


CHECKS: dict[str, Callable[[Any], Any]] = {"size": _as_size, "spots": _as_spots}
