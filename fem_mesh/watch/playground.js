// The playground: a Delaunay triangulation that answers each click. The kernel does the geometry and sends what
// changed; this draws it.

import { View } from "./view.js";
import { Mesh } from "./mesh.js";
import { make, button, listenToKeys, toggleHelp, track, showLegend, watchTheme, watchSize, letZoom, toggleFullScreen, disable } from "./panel.js";
import { copyLines, bytesOf, listen, send, hideStandIn, NO_ANSWER } from "./kernel.js";

const NEAR = 9; // pixels within which a click means a point that is there,
const NEAREST = 2; // less where points are dense
const STILL = 4; // pixels that a click may tremble
const UNDERWAY = 2; // moves of a drag on their way: the second hurries the answer to the first
const DOOMED_FOR = 260; // milliseconds that an animated insertion shows its cavity,
const FRESH_FOR = 360; // and its fan
const TOGGLES = [["circles", "circles", "c"], ["voronoi", "Voronoi", "v"], ["ties", "ties", "t"], ["numbers", "1 2", "n"], ["animated", "animate", "a"]];

class Playground {
  constructor(root, model, style) {
    Object.assign(this, { root, model, mesh: new Mesh(), ties: [], chosen: null, cursor: null, show: {}, unanswered: 0, next: null });
    this.build();
    this.view = new View(this.canvas, style, model.get("box"));
    letZoom(this.view, () => this.draw(), root, { pans: false });
    this.canvas.addEventListener("pointerdown", (event) => this.press(event));
    this.stops = [
      watchTheme((dark) => this.setDark(dark)), watchSize(this.canvas, () => this.draw()),
      listen(model, "msg:custom", (message, buffers) => this.hear(message, buffers)),
      ...TOGGLES.map(([trait]) => listen(model, `change:${trait}`, () => this.setToggle(trait))),
      listen(model, "change:box", () => { this.view.setBox(model.get("box")); this.draw(); }),
      hideStandIn(model.get("key"), root),
    ];
    for (const [trait] of TOGGLES) this.setToggle(trait);
    this.ask({ type: "all" });
  }

  // ---- talking to the kernel ---------------------------------------------------------------------

  // While the pointer is down only what it does itself is done.
  ask(message) {
    if (this.pressed && message.type !== "move") return;
    if (!send(this.model, message)) this.say(NO_ANSWER);
  }

  // While a point is dragged: the latest place, as soon as few others are under way.
  askToMove(message) {
    if (this.unanswered >= UNDERWAY && !message.last) this.next = message;
    else {
      this.unanswered += 1;
      this.next = null;
      this.ask(message);
    }
  }

  hear(message, buffers) {
    if (message.type === "code") return copyLines(message.text, this.code, (words) => this.say(words));
    if (message.type === "all") {
      const [points, triangles] = buffers.map(bytesOf);
      this.mesh = new Mesh(new Float64Array(points), new Int32Array(triangles));
      this.show = {};
      clearTimeout(this.timer);
    }
    if (message.type === "all") this.chosen = null;
    if (message.type === "steps") this.hearSteps(message);
    this.ties = message.ties ?? [];
    if (message.voronoi) this.mesh.voronoi = new Float64Array(bytesOf(buffers.at(-1)));
    if (this.chosen !== null && this.chosen >= this.mesh.x.length) this.chosen = null;
    this.readOut(message);
    this.draw();
    this.unanswered = Math.max(0, this.unanswered - 1);
    if (this.next) this.askToMove(this.next);
  }

  // The new mesh is here at once; an animated insertion shows first what goes, then what comes.
  hearSteps({ steps, animated }) {
    clearTimeout(this.timer);
    this.show = {};
    const calm = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    const before = animated && !calm ? this.mesh.copy() : null;
    for (const step of steps) this.mesh.apply(step);
    if (!steps.length) return;
    const last = steps.at(-1), cavity = steps.find((step) => step.kind === "cavity");
    if (!before) return;
    const fan = () => {
      const fresh = new Mesh([], last.added);
      this.show = { fresh: last.added, point: last.point, old: [...this.mesh.rows].filter(([key]) => !fresh.rows.has(key)).flatMap(([, row]) => row) };
      this.draw();
      this.timer = setTimeout(() => { this.show = {}; this.draw(); }, FRESH_FOR);
    };
    if (!cavity) return fan();
    const { doomed, point, edges } = cavity;
    this.show = { mesh: before, doomed, point, edges, circles: doomed };
    this.timer = setTimeout(fan, DOOMED_FOR);
  }

  readOut({ said, undo, redo }) {
    const count = (n, thing) => `${n.toLocaleString("en")} ${thing}${n === 1 ? "" : "s"}`;
    this.points.textContent = count(this.mesh.x.length, "point");
    this.triangles.textContent = count(this.mesh.rows.size, "triangle");
    this.smallest.textContent = this.mesh.rows.size ? `smallest angle ${this.mesh.smallest.toFixed(1)}°` : "";
    if (said !== undefined) this.caption.textContent = said;
    disable(this.undoButton, !undo, this.root);
    disable(this.redoButton, !redo, this.root);
    this.toggles.numbers.setAttribute("aria-pressed", String(this.isOn("numbers")));
    this.canvas.setAttribute("aria-label", `${this.points.textContent}, ${this.triangles.textContent}, ${this.smallest.textContent}`);
  }

  // ---- pointer and keys --------------------------------------------------------------------------

  // The point that a place means, or null.
  under([x, y]) {
    const { view } = this, [i, distance] = this.mesh.nearest(x, y);
    const apart = Math.sqrt(((view.box[1] - view.box[0]) * (view.box[3] - view.box[2])) / this.mesh.x.length);
    const reach = Math.max(NEAREST, Math.min(NEAR, 0.2 * apart * view.scale));
    return distance * view.scale <= reach ? i : null;
  }

  // A click adds, or chooses the point that is there; shift-click takes it out; dragging moves it, or the view.
  press(event) {
    if (event.button || this.pressed) return;
    this.root.focus({ preventScroll: true });
    const i = this.under(this.view.toWorld(...this.view.at(event))), from = this.view.at(event);
    let [dragged, last] = [false, from];
    [this.pressed, this.unanswered] = [true, 0];
    const move = (moved) => {
      const [px, py] = this.view.at(moved);
      dragged ||= Math.hypot(px - from[0], py - from[1]) > STILL;
      if (!dragged) return;
      const [x, y] = this.view.toWorld(px, py);
      if (i !== null) this.askToMove({ type: "move", i, x, y });
      else this.view.panBy(px - last[0], py - last[1]), this.draw();
      last = [px, py];
    };
    const letGo = (at) => {
      this.pressed = false;
      const [x, y] = this.view.toWorld(...at);
      if (dragged && i !== null) this.askToMove({ type: "move", i, x, y, last: true });
      return [x, y];
    };
    const release = (moved) => {
      const [x, y] = letGo(this.view.at(moved));
      if (!dragged && i !== null) event.shiftKey ? this.ask({ type: "remove", i }) : this.choose(i);
      else if (!dragged) this.add(x, y);
    };
    track(this.canvas, event, move, release, () => letGo(last));
  }

  add(x, y) {
    this.chosen = null;
    const digits = Math.max(0, Math.ceil(Math.log10(2 * this.view.scale))); // finer than a pixel
    this.ask({ type: "add", x: Number(x.toFixed(digits)), y: Number(y.toFixed(digits)) });
  }

  choose(i) {
    this.chosen = this.chosen === i ? null : i;
    if (this.chosen !== null) this.caption.textContent = `point ${i} at ${this.place(i)}: drag it, or delete it`;
    this.draw();
  }

  place(i) {
    return `(${this.mesh.x[i].toPrecision(4)}, ${this.mesh.y[i].toPrecision(4)})`;
  }

  remove() {
    const i = this.chosen ?? this.underCursor();
    this.chosen = null; // the last point takes its number
    if (i !== null) this.ask({ type: "remove", i });
  }

  underCursor() {
    return this.cursor && this.under(this.cursor);
  }

  // A cross that the arrow keys move: the playground without a mouse.
  moveCursor(event, dx, dy) {
    const step = (event.shiftKey ? 2 : 20) / this.view.scale, [x, y] = this.cursor ?? this.view.center;
    this.cursor = this.cursor ? [x + step * dx, y + step * dy] : [x, y];
    const i = this.underCursor();
    this.caption.textContent = `cross at (${this.cursor.map((v) => v.toFixed(3)).join(", ")})${i === null ? "" : `, on point ${i}`}`;
    this.draw();
  }

  addAtCursor() {
    const i = this.underCursor();
    if (i !== null) this.choose(i);
    else if (this.cursor) this.add(...this.cursor);
    else this.moveCursor({}, 0, 0);
  }

  keys() {
    const toggle = ([trait, face, key]) => [[key], { numbers: "numbers", animated: "animate insertions" }[trait] ?? face, () => this.toggle(trait)];
    return [
      [["ctrl-z"], "undo", () => this.ask({ type: "undo" })],
      [["ctrl-y", "ctrl-Z"], "redo", () => this.ask({ type: "redo" })],
      [["Delete", "Backspace"], "take the chosen point out (or shift-click)", () => this.remove()],
      [["ArrowLeft"], "move the cross (finer with shift)", (event) => this.moveCursor(event, -1, 0)],
      [["ArrowRight"], "", (event) => this.moveCursor(event, 1, 0)],
      [["ArrowUp"], "", (event) => this.moveCursor(event, 0, 1)],
      [["ArrowDown"], "", (event) => this.moveCursor(event, 0, -1)],
      [["Enter", " "], "add a point at the cross, or choose the one there", () => this.addAtCursor()],
      [["Escape"], "drop the cross, and the choice", () => { [this.cursor, this.chosen] = [null, null]; this.draw(); }],
      ...TOGGLES.map(toggle),
      [["i"], "zoom in (or ctrl and the wheel)", () => this.zoomBy(1.4)],
      [["o"], "zoom out", () => this.zoomBy(1 / 1.4)],
      [["0"], "fit the view", () => this.fit()],
      [["f"], "full screen", () => toggleFullScreen(this.root)],
      [["?"], "this help", () => this.toggleHelp()],
    ];
  }

  // ---- showing -----------------------------------------------------------------------------------

  draw() {
    const { mesh = this.mesh, old, circles, ...shown } = this.show, get = (trait) => this.model.get(trait);
    const frame = { x: mesh.x, y: mesh.y, triangles: old ?? mesh.triangles, ...shown };
    frame.circles = get("circles") ? mesh.triangles : circles;
    if (get("voronoi")) frame.voronoi = mesh.voronoi;
    if (get("ties") && mesh === this.mesh) frame.ties = this.ties;
    if (this.chosen !== null && !frame.point) frame.point = [mesh.x[this.chosen], mesh.y[this.chosen]];
    if (this.cursor) frame.cross = this.cursor;
    const roles = this.view.draw(frame, { numbers: get("numbers"), markers: true });
    showLegend(this.legend, this.view, roles);
    this.root.dataset.drawn = this.view.drawn;
  }

  setDark(dark) {
    this.view.dark = dark;
    this.root.classList.toggle("fem-dark", dark);
    this.draw();
  }

  setToggle(trait) {
    this.toggles[trait].setAttribute("aria-pressed", String(this.isOn(trait)));
    if (!["ties", "voronoi"].includes(trait) || !this.model.get(trait)) this.draw(); // these come from the kernel
  }

  isOn(trait) {
    return this.model.get(trait) ?? this.mesh.x.length <= this.view.style.limits.numbers; // numbers: null means if there are few
  }

  toggle(trait) {
    this.model.set(trait, !this.isOn(trait));
    this.model.save_changes();
  }

  zoomBy(factor) {
    this.view.zoomBy(factor);
    this.draw();
  }

  // All points, and what the view showed at first.
  fit() {
    const [left, right, bottom, top] = this.model.get("box"), { x, y } = this.mesh, room = 0.04 * (right - left);
    const least = (values, edge) => values.reduce((a, v) => Math.min(a, v - room), edge);
    const most = (values, edge) => values.reduce((a, v) => Math.max(a, v + room), edge);
    this.view.setBox([least(x, left), most(x, right), least(y, bottom), most(y, top)]);
    this.draw();
  }

  toggleHelp() {
    toggleHelp(this.help, this.helpButton);
  }

  say(words) {
    this.caption.textContent = words;
  }

  build() {
    const readOut = (kind) => make("span", { class: `fem-${kind}` });
    [this.points, this.triangles, this.smallest] = ["points", "triangles", "smallest"].map(readOut);
    this.caption = make("p", { class: "fem-caption", role: "status", "aria-live": "polite" }, "click to add a point");
    this.canvas = make("canvas", { class: "fem-canvas fem-plane", role: "application", tabindex: -1 });
    this.legend = make("div", { class: "fem-legend" });
    this.help = make("div", { class: "fem-help", hidden: true });
    this.code = make("textarea", { class: "fem-code", "aria-label": "the cell that rebuilds this", readonly: true, hidden: true });
    this.root.classList.add("fem-mesh", "fem-playground");
    for (const [attribute, value] of [["tabindex", "0"], ["role", "group"], ["aria-label", "playground"]]) this.root.setAttribute(attribute, value);
    this.root.replaceChildren(
      make("div", { class: "fem-head" }, this.points, this.triangles, this.smallest),
      this.caption, this.canvas, this.legend, ...this.buildBars(), this.code, this.help,
    );
    listenToKeys(this.root, this.keys(), this.help);
  }

  buildBars() {
    const word = (label, face, type, shortcut) => button(label, face, () => this.ask({ type }), shortcut);
    this.undoButton = word("undo", "undo", "undo", { key: "ctrl-z" });
    this.redoButton = word("redo", "redo", "redo", { key: "ctrl-y" });
    this.helpButton = button("help", "?", () => this.toggleHelp(), { key: "?" });
    this.toggles = {};
    for (const [trait, face, key] of TOGGLES)
      this.toggles[trait] = button({ animated: "animate insertions" }[trait] ?? trait, face, () => this.toggle(trait), { key, pressed: false });
    return [
      make("div", { class: "fem-bar", role: "toolbar", "aria-label": "points" },
        word("16 random points", "16 random", "random"), word("20 more random points", "+ 20 random", "more"),
        word("twelve points on a circle", "ring of 12", "ring"), word("a grid of points", "grid", "grid"), word("clear", "clear", "clear"),
        make("span", { class: "fem-space" }), this.undoButton, this.redoButton, word("copy as code", "copy as code", "code")),
      make("div", { class: "fem-bar", role: "toolbar", "aria-label": "view" },
        ...Object.values(this.toggles), make("span", { class: "fem-space" }),
        button("fit the view", "fit", () => this.fit(), { key: "0" }),
        button("full screen", "full", () => toggleFullScreen(this.root), { key: "f" }),
        this.helpButton),
    ];
  }

  close() {
    clearTimeout(this.timer);
    for (const stop of this.stops) stop();
  }
}

export function renderPlayground({ model, el }, style) {
  const stage = make("div");
  el.replaceChildren(stage);
  const playground = new Playground(stage, model, style);
  return () => playground.close();
}
