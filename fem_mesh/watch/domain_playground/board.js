// The domain playground: an outline to draw, and a mesh that follows. The kernel meshes; this asks and draws.

import { View } from "../view.js";
import { Stage } from "./stage.js";
import { Drawing } from "./drawing.js";
import { Pencil } from "./pencil.js";
import { Overlay } from "./overlay.js";
import { Controls, keysOf } from "./controls.js";
import { Histogram } from "./histogram.js";
import { make, disable, listenToKeys, toggleHelp, showLegend, watchTheme, watchSize, letZoom } from "../panel.js";
import { bytesOf, listen, send, hideStandIn, NO_ANSWER } from "../kernel.js";

const PATIENCE = 4000; // milliseconds without an answer before a word is said
const AGAIN = 1500; // milliseconds until a mesh is asked for again that could not be whole yet
const CATCH_UP = 300; // milliseconds until what another view did is shown here
const CELLS = 24; // of the grid, at least, across the page
const PAGE = [0, 6, 0, 4];
const NOTHING = { x: [], y: [], triangles: [] };

class DomainPlayground {
  constructor(root, model, style) {
    const bounds = { min_angle: model.get("min_angle"), size: model.get("size"), encroachment: model.get("encroachment") };
    Object.assign(this, { root, model, style, bounds, drawing: new Drawing(), mesh: null, told: {}, extent: PAGE[1], brush: false, gridShown: false });
    Object.assign(this, { me: Math.random().toString(36).slice(2), serial: 0, waiting: false, again: false, acknowledged: 0, begun: false });
    this.build();
    this.view = new View(this.canvas, style, PAGE);
    this.pencil = new Pencil(this);
    this.overlay = new Overlay(this);
    letZoom(this.view, () => this.redraw(), root, { pans: false });
    this.stops = [
      watchTheme((dark) => this.setDark(dark)), watchSize(this.canvas, () => this.draw()),
      listen(model, "msg:custom", (message, buffers) => this.hear(message, buffers)),
      hideStandIn(model.get("key"), root),
    ];
    this.controls.show(bounds);
    this.send({ type: "hello" });
  }

  // ---- talking to the kernel ---------------------------------------------------------------------

  // A request is sent when the last one was answered: while a slider moves, the latest place wins.
  send(message) {
    [this.waiting, this.again] = [true, false];
    this.serial += 1;
    this.post({ ...message, serial: `${this.me} ${this.serial}` });
    clearTimeout(this.late);
    this.late = setTimeout(() => this.say(NO_ANSWER), PATIENCE);
  }

  post(message) {
    if (!send(this.model, message)) this.say(NO_ANSWER);
  }

  ask(start = null) {
    if (this.waiting && !start) return void (this.again = true);
    this.waiting = true;
    const asked = { ...this.bounds, spots: start ? [] : this.drawing.spots }, message = { type: "ask", ...asked };
    for (const [name, value] of Object.entries(asked)) this.model.set(name, value); // not saved: the message says it
    if (start) message.drawn = { start };
    else if (this.drawing.version !== this.acknowledged) message.drawn = this.drawing.closed;
    this.acknowledged = this.drawing.version;
    this.send(message);
  }

  hear(message, buffers) {
    if (message.type === "steps") {
      if (message.serial !== this.me) return;
      return message.refusal ? this.say(message.refusal) : this.stage.play(message);
    }
    const mine = message.serial === `${this.me} ${this.serial}`;
    if (message.serial && !message.serial.startsWith(this.me)) return this.catchUp(message); // the answer to another view
    if (mine) this.hearAnswer();
    if (message.drawn && (mine || !message.serial)) this.begin(message);
    this.told = { ...this.told, refusal: "", where: null, ...message };
    this.extent = message.extent ?? this.extent;
    if (buffers.length) this.take(message, buffers);
    else if (!message.refusal) this.mesh = null;
    this.adopt(message);
    this.readOut();
    this.draw();
    if (this.again && !this.waiting) this.ask();
    clearTimeout(this.later);
    if (message.provisional) this.later = setTimeout(() => this.waiting || this.send({ type: "ask" }), AGAIN); // as Python has it
  }

  hearAnswer() {
    this.waiting = false;
    clearTimeout(this.late);
    if (this.status.textContent === NO_ANSWER) this.say("");
  }

  catchUp(message) {
    if (message.to !== "ask") return;
    this.adopt(message);
    this.redraw();
    this.catchUpSoon();
  }

  catchUpSoon() {
    clearTimeout(this.behind);
    this.behind = setTimeout(() => (this.waiting ? this.catchUpSoon() : this.send({ type: "hello" })), CATCH_UP);
  }

  // The bounds that Python has are shown, unless the hand here is ahead of it.
  adopt({ asked }) {
    if (!asked || this.waiting || this.again) return;
    const { spots, ...bounds } = asked;
    this.bounds = bounds;
    this.drawing.follow({ spots });
    this.controls.show(bounds);
  }

  begin({ drawn, box, shapes, to }) {
    if (this.begun && to === "hello") return this.follow(drawn);
    this.drawing.begin(drawn, { first: !this.begun });
    this.begun = true;
    this.acknowledged = this.drawing.version;
    this.pencil.rest();
    this.controls.showShapes(shapes);
    this.setBox(box);
  }

  // Take over what another view drew, unless the hand here is ahead of it.
  follow(drawn) {
    if (this.drawing.version === this.acknowledged && this.drawing.follow(drawn)) this.pencil.rest();
  }

  setBox([left, right, bottom, top]) {
    this.canvas.style.aspectRatio = String(Math.min(1.6, Math.max(1.05, (right - left) / (top - bottom))));
    this.view.setBox([left, right, bottom, top]);
    const width = (right - left) / CELLS, unit = 10 ** Math.floor(Math.log10(width));
    this.cell = unit * (width < 2 * unit ? 1 : width < 5 * unit ? 2 : 5);
  }

  take({ bounded, asked: { min_angle: bound } }, buffers) {
    const [places, triangles, segments, encroached, smallest] = buffers.map(bytesOf);
    const flat = new Float64Array(places), n = flat.length / 2, angles = new Float32Array(smallest);
    const least = angles.reduce((a, b) => Math.min(a, b), 180);
    const tint = bounded && least < bound ? angles.map((angle) => (angle < bound ? 0.25 + (0.6 * (bound - angle)) / bound : 0)) : null;
    this.mesh = {
      x: flat.subarray(0, n), y: flat.subarray(n), triangles: new Int32Array(triangles), segments: new Int32Array(segments),
      encroached: new Int32Array(encroached), tint, least,
    };
  }

  // ---- what one does -------------------------------------------------------------------------------

  changed() {
    this.ask();
    this.redraw();
  }

  bound(bounds) {
    Object.assign(this.bounds, bounds);
    this.controls.show(this.bounds);
    this.changed();
  }

  start(name) {
    this.controls.starts.value = "";
    if (name) this.ask(name);
  }

  closeLoop() {
    if (!this.drawing.open.length) return;
    if (!this.drawing.close()) return this.say(this.pencil.sayLoop());
    this.say("the loop is closed");
    this.changed();
  }

  goBack(way) {
    this.pencil.rest();
    if (this.drawing[way]()) this.changed();
  }

  clear() {
    this.drawing.clear();
    this.pencil.rest();
    this.changed();
  }

  clearSpots() {
    this.root.focus({ preventScroll: true }); // the button goes
    this.drawing.remember();
    this.drawing.spots = [];
    this.changed();
  }

  toggleBrush() {
    this.brush = !this.brush;
    this.controls.press("brushOn", this.brush);
    this.controls.brushRow.hidden = !this.brush;
    this.say(this.brush ? "drag over the picture where small triangles are wanted" : "");
    this.redraw();
  }

  toggleGrid() {
    this.gridShown = !this.gridShown;
    this.controls.press("gridOn", this.gridShown);
    this.redraw();
  }

  get grid() {
    return this.gridShown ? this.cell : null;
  }

  get canPlay() {
    return Boolean(this.mesh) && !this.told.refusal;
  }

  record() {
    if (!this.canPlay) return;
    this.say("recording the steps ...");
    this.post({ type: "steps", serial: this.me });
  }

  // ---- showing -----------------------------------------------------------------------------------

  say(words) {
    this.status.textContent = words;
  }

  readOut() {
    const { points, triangles, state, refusal, histogram, asked } = this.told, { mesh } = this;
    if (!refusal) {
      this.points.textContent = counted(mesh ? points : 0, "point");
      this.triangles.textContent = counted(mesh ? triangles : 0, "triangle");
      this.smallest.textContent = mesh?.triangles.length ? `smallest angle ${mesh.least.toFixed(1)}°` : "";
      this.encroached.textContent = mesh?.encroached.length ? `${counted(mesh.encroached.length / 2, "segment")} encroached` : "";
      this.state.textContent = mesh ? state : "";
      this.histogram.show(mesh ? histogram : [], asked?.min_angle);
    }
    this.root.classList.toggle("fem-refused", Boolean(refusal));
    this.refusal.hidden = !refusal;
    if (this.refusal.textContent !== refusal) this.refusal.textContent = refusal;
    const { play, copy } = this.controls;
    for (const node of [play, copy]) disable(node, !this.canPlay, this.root);
    play.textContent = this.told.bounded ? "play Ruppert's steps" : "play the segments' insertion";
    play.setAttribute("aria-label", play.textContent);
    const facts = [counted(this.drawing.corners, "corner"), ...[this.points, this.triangles, this.smallest].map((node) => node.textContent)];
    this.canvas.setAttribute("aria-label", `drawing: ${refusal || facts.filter(Boolean).join(", ")}`);
  }

  redraw() {
    this.frame ??= requestAnimationFrame(() => this.draw());
  }

  draw() {
    cancelAnimationFrame(this.frame);
    this.frame = null;
    if (!this.overlay) return;
    const { view, drawing, controls } = this;
    const roles = view.draw({ ...(this.mesh ?? NOTHING), cross: this.pencil.cross }, { numbers: false });
    if (!view.width) return;
    const shown = new Set([...roles, ...(this.mesh?.tint ? ["skinny"] : []), ...this.overlay.draw()]);
    showLegend(this.legend, view, [...shown]);
    disable(controls.undo, !drawing.past.length, this.root);
    disable(controls.redo, !drawing.future.length, this.root);
    controls.clearSpots.hidden = !drawing.spots.length;
    this.hint.hidden = Boolean(drawing.corners);
    if (this.told.refusal) this.placeRefusal();
    this.root.dataset.drawn = view.drawn;
  }

  // The sentence stands where the outline crosses itself.
  placeRefusal() {
    const { where } = this.told, { width, height } = this.view, { offsetWidth: wide, offsetHeight: high, style } = this.refusal;
    const [x, y] = where ? this.view.toScreen(...where) : [width / 2, 0], within = (place, room) => Math.max(4, Math.min(place, room - 4));
    style.left = `${within(x - wide / 2, width - wide)}px`;
    style.top = `${within(y + 16 + high < height ? y + 16 : y - 16 - high, height - high)}px`;
  }

  setDark(dark) {
    this.view.dark = dark;
    this.root.classList.toggle("fem-dark", dark);
    this.draw();
  }

  zoomBy(factor) {
    this.view.zoomBy(factor);
    this.redraw();
  }

  // Fit what is drawn, wherever it was dragged to.
  fit() {
    const { points } = this.drawing, xs = points.map(([x]) => x), ys = points.map(([, y]) => y);
    const box = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)], wide = Math.max(box[1] - box[0], box[3] - box[2]);
    if (points.length > 1) this.setBox(box.map((edge, i) => edge + (i % 2 ? 0.06 : -0.06) * wide));
    else this.view.fit();
    this.redraw();
  }

  toggleHelp() {
    toggleHelp(this.help, this.controls.help);
  }

  // ---- building ------------------------------------------------------------------------------------

  build() {
    const { root } = this, words = "Click to set corners; click the first one again to close the loop. Or start from a shape.";
    for (const name of ["points", "triangles", "smallest", "encroached", "state"]) this[name] = make("span", { class: `fem-${name}` });
    this.status = make("p", { class: "fem-status", role: "status", "aria-live": "polite" });
    this.canvas = make("canvas", { class: "fem-canvas", role: "application", "aria-label": "drawing: nothing yet" });
    this.hint = make("p", { class: "fem-hint", hidden: true }, words);
    this.refusal = make("div", { class: "fem-refusal", role: "alert", hidden: true });
    this.legend = make("div", { class: "fem-legend" });
    this.histogram = new Histogram();
    this.controls = new Controls(this);
    this.stage = new Stage(this);
    this.help = make("div", { class: "fem-help", hidden: true });
    root.classList.add("fem-mesh", "fem-domain-playground");
    for (const [name, value] of [["tabindex", "0"], ["role", "group"], ["aria-label", "domain playground"]]) root.setAttribute(name, value);
    root.replaceChildren(
      make("div", { class: "fem-head" }, this.points, this.triangles, this.smallest, this.encroached, this.state),
      make("div", { class: "fem-desk" }, make("div", { class: "fem-sheet" }, this.canvas, this.hint, this.refusal),
        make("div", { class: "fem-side" }, ...this.controls.sliders, this.histogram.node)),
      this.legend, this.status, this.controls.bar, this.stage.code, this.stage.node, this.help,
    );
    listenToKeys(root, keysOf(this), this.help);
  }

  close() {
    for (const timer of [this.late, this.later, this.behind]) clearTimeout(timer);
    cancelAnimationFrame(this.frame);
    this.stage.stop();
    for (const stop of this.stops) stop();
  }
}

const counted = (n, thing) => `${n.toLocaleString("en")} ${thing}${n === 1 ? "" : "s"}`;

export function renderDomainPlayground({ model, el }, style) {
  const root = make("div");
  el.replaceChildren(root);
  const playground = new DomainPlayground(root, model, style);
  return () => playground.close();
}
