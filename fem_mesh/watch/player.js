// The player: steps through a trace, forward and back, at any place at once.

import { View } from "./view.js";
import { Trace } from "./trace.js";
import { Timeline } from "./timeline.js";
import { make, button, setFace, listenToKeys, toggleHelp, showLegend, watchTheme, watchSize, letZoom, toggleFullScreen, disable } from "./panel.js";

const A_SECOND = 2; // steps, at speed 1
const SPEEDS = [0.25, 0.5, 1, 2, 4, 8];

// `host` may have: step(k) to hear of every step, more() to load further steps, and what holds at the beginning.
export class Player {
  constructor(root, data, style, host = {}) {
    Object.assign(this, { root, style, host, k: -1, playing: false, speed: 1, circles: true, numbers: null });
    this.build();
    this.view = new View(this.canvas, style, data.box);
    this.timeline = new Timeline(this.strip, null, style, (k) => this.pauseAt(k));
    this.setData(data);
    letZoom(this.view, () => this.draw(), root);
    this.canvas.addEventListener("dblclick", () => this.fit());
    this.stops = [watchTheme((dark) => this.setDark(dark)), watchSize(this.canvas, () => this.draw())];
    this.go(Math.min(host.k ?? 0, this.trace.length - 1));
  }

  // ---- the trace ---------------------------------------------------------------------------------

  setData(data) {
    this.trace = new Trace(data);
    this.timeline.setTrace(this.trace);
    this.scrubber.max = this.trace.length - 1;
    const [left, right, bottom, top] = data.box;
    if (String(data.box) !== String(this.view.box)) this.view.setBox(data.box);
    this.canvas.style.aspectRatio = String(Math.min(2.2, Math.max(1.3, (right - left) / (top - bottom))));
    this.root.setAttribute("aria-label", `player of ${this.trace.length} steps`);
    disable(this.more, !(data.more && this.host.more), this.root);
    this.more.hidden = this.more.disabled;
    this.numbersButton.setAttribute("aria-pressed", String(this.showsNumbers));
    if (this.k >= 0) this.go(Math.min(this.k, this.trace.length - 1));
  }

  // ---- moving ------------------------------------------------------------------------------------

  go(k) {
    this.k = Math.min(Math.max(k, 0), this.trace.length - 1);
    this.frame = this.trace.frame(this.k);
    const kind = this.trace.kind(this.k), angle = this.trace.angles[this.k];
    const where = `step ${this.k} of ${this.trace.length - 1}, ${kind}`;
    this.where.textContent = where;
    this.angle.textContent = angle === null ? "" : `smallest angle ${angle.toFixed(1)}°`;
    this.caption.textContent = this.trace.captions[this.k];
    this.canvas.setAttribute("aria-label", `${where}: ${this.trace.captions[this.k]}`);
    this.scrubber.value = this.k;
    this.scrubber.setAttribute("aria-valuetext", where);
    const ofKind = this.trace.steps[this.k].kind;
    for (const [node, word, way] of [[this.previousOfKind, "previous", -1], [this.nextOfKind, "next", 1]]) {
      node.title = `${word} ${kind} (${way < 0 ? "[" : "]"})`;
      node.setAttribute("aria-label", `${word} ${kind}`);
      node.textContent = way < 0 ? `« ${kind}` : `${kind} »`;
      disable(node, this.sameKind(way, ofKind) === null, this.root);
    }
    this.draw();
    this.host.step?.(this.k);
  }

  pauseAt(k) {
    this.pause();
    this.go(k);
  }

  sameKind(direction, kind) {
    for (let k = this.k + direction; k >= 0 && k < this.trace.length; k += direction)
      if (this.trace.steps[k].kind === kind) return k;
    return null;
  }

  jump(direction) {
    const k = this.sameKind(direction, this.trace.steps[this.k].kind);
    if (k !== null) this.pauseAt(k);
  }

  // Each step is drawn before the next one's time begins to run: none is ever skipped.
  // Where another view of the same widget plays, this one follows.
  play(follows = false) {
    if (!follows && this.k === this.trace.length - 1) this.go(0);
    this.setPlaying(true);
    if (follows) return;
    const tick = () => {
      if (!this.playing) return;
      if (this.root.isConnected) this.go(this.k + 1); // a page may take a cell out that is not in sight
      if (this.k === this.trace.length - 1) this.pause();
      else this.timer = setTimeout(tick, 1000 / (A_SECOND * this.speed));
    };
    this.timer = setTimeout(tick, 500 / (A_SECOND * this.speed));
  }

  pause() {
    clearTimeout(this.timer);
    if (this.playing) this.setPlaying(false);
  }

  setPlaying(playing) {
    this.playing = playing;
    setFace(this.playButton, playing ? "pause" : "play");
    this.playButton.setAttribute("aria-label", playing ? "pause" : "play");
    this.playButton.title = `${playing ? "pause" : "play"} (space)`;
    this.caption.setAttribute("aria-live", playing ? "off" : "polite"); // spoken step by step, not in a rush
    this.host.playing?.(playing);
  }

  setSpeed(speed) {
    this.speed = speed;
    this.speeds.value = String(speed);
    this.host.speed?.(speed);
  }

  faster(direction) {
    const i = SPEEDS.indexOf(this.speed) + direction;
    if (i >= 0 && i < SPEEDS.length) this.setSpeed(SPEEDS[i]);
  }

  // ---- showing -----------------------------------------------------------------------------------

  draw() {
    if (!this.frame) return;
    showLegend(this.legend, this.view, this.view.draw(this.frame, { circles: this.circles, numbers: this.numbers }));
    this.timeline.draw(this.k);
    this.root.dataset.drawn = this.view.drawn;
  }

  setDark(dark) {
    this.view.dark = this.timeline.dark = dark;
    this.root.classList.toggle("fem-dark", dark);
    this.draw();
  }

  fit() {
    this.view.fit();
    this.draw();
  }

  setCircles(circles) {
    this.circles = circles;
    this.circlesButton.setAttribute("aria-pressed", String(circles));
    this.draw();
    this.host.circles?.(circles);
  }

  setNumbers(numbers) {
    this.numbers = numbers;
    this.numbersButton.setAttribute("aria-pressed", String(this.showsNumbers));
    this.draw();
    this.host.numbers?.(numbers);
  }

  get showsNumbers() {
    return this.numbers ?? this.trace?.size <= this.style.limits.numbers;
  }

  toggleHelp() {
    toggleHelp(this.help, this.helpButton);
  }

  zoomBy(factor) {
    this.view.zoomBy(factor);
    this.draw();
  }

  build() {
    this.where = make("span", { class: "fem-where" });
    this.angle = make("span", { class: "fem-angle" });
    this.caption = make("p", { class: "fem-caption", role: "status", "aria-live": "polite" });
    this.canvas = make("canvas", { class: "fem-canvas", role: "img" });
    this.legend = make("div", { class: "fem-legend" });
    this.strip = make("canvas", { class: "fem-strip", "aria-hidden": "true", title: "click to go there" });
    const seek = () => this.pauseAt(Number(this.scrubber.value));
    this.scrubber = make("input", { type: "range", class: "fem-scrubber", min: 0, value: 0, "aria-label": "step", input: seek });
    this.help = make("div", { class: "fem-help", hidden: true });
    this.root.classList.add("fem-mesh", "fem-player");
    for (const [name, value] of [["tabindex", "0"], ["role", "group"]]) this.root.setAttribute(name, value);
    this.root.replaceChildren(
      make("div", { class: "fem-head" }, this.where, this.angle),
      this.caption, this.canvas, this.legend, this.buildBar(), this.scrubber, this.strip, this.help,
    );
    listenToKeys(this.root, this.keys(), this.help);
  }

  buildBar() {
    const to = (k) => () => this.pauseAt(k());
    this.playButton = button("play", "play", () => this.togglePlay(), { key: "space" });
    this.previousOfKind = button("previous of this kind", "«", () => this.jump(-1), { key: "[" });
    this.nextOfKind = button("next of this kind", "»", () => this.jump(1), { key: "]" });
    for (const node of [this.previousOfKind, this.nextOfKind]) node.classList.add("fem-kind");
    this.circlesButton = button("circles", "circles", () => this.setCircles(!this.circles), { key: "c", pressed: true });
    this.numbersButton = button("numbers", "1 2", () => this.setNumbers(!this.showsNumbers), { key: "n", pressed: true });
    this.more = button("load 500 more steps", "load 500 more", () => this.host.more(), { key: "m" });
    this.helpButton = button("help", "?", () => this.toggleHelp(), { key: "?" });
    const choose = () => this.setSpeed(Number(this.speeds.value));
    this.speeds = make("select", { "aria-label": "speed", title: "speed (- and +)", change: choose },
      ...SPEEDS.map((speed) => make("option", { value: speed, selected: speed === 1 }, `${speed}×`)));
    return make("div", { class: "fem-bar", role: "toolbar", "aria-label": "steps" },
      button("first step", "first", to(() => 0), { key: "home" }),
      this.previousOfKind,
      button("step back", "back", to(() => this.k - 1), { key: "←" }),
      this.playButton,
      button("step forward", "forward", to(() => this.k + 1), { key: "→" }),
      this.nextOfKind,
      button("last step", "last", to(() => this.trace.length - 1), { key: "end" }),
      this.speeds, this.more, make("span", { class: "fem-space" }),
      this.circlesButton, this.numbersButton,
      button("fit the view", "fit", () => this.fit(), { key: "0" }),
      button("full screen", "full", () => toggleFullScreen(this.root), { key: "f" }),
      this.helpButton);
  }

  togglePlay() {
    if (this.playing) this.pause();
    else this.play();
  }

  keys() {
    return [
      [[" "], "play, pause", () => this.togglePlay()],
      [["ArrowLeft"], "one step back", () => this.pauseAt(this.k - 1)],
      [["ArrowRight"], "one step forward", () => this.pauseAt(this.k + 1)],
      [["Home"], "first step", () => this.pauseAt(0)],
      [["End"], "last step", () => this.pauseAt(this.trace.length - 1)],
      [["["], "previous step of this kind", () => this.jump(-1)],
      [["]"], "next step of this kind", () => this.jump(1)],
      [["-"], "slower", () => this.faster(-1)],
      [["+", "="], "faster", () => this.faster(1)],
      [["c"], "circles", () => this.setCircles(!this.circles)],
      [["n"], "numbers", () => this.setNumbers(!this.showsNumbers)],
      [["i"], "zoom in (or ctrl and the wheel)", () => this.zoomBy(1.4)],
      [["o"], "zoom out", () => this.zoomBy(1 / 1.4)],
      [["0"], "fit the view (or double click)", () => this.fit()],
      [["f"], "full screen", () => toggleFullScreen(this.root)],
      [["m"], "load 500 more steps, where there are more", () => this.more.hidden || this.host.more()],
      [["?"], "this help", () => this.toggleHelp()],
    ];
  }

  close() {
    clearTimeout(this.timer);
    this.playing = false;
    for (const stop of this.stops) stop();
  }
}

// ---- a page ----------------------------------------------------------------------------------------

// A page without a kernel: each still picture becomes a player once it comes into view.
export function mountPlayers(style) {
  const watcher = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      if (!isIntersecting || !target.querySelector(".fem-data")) continue;
      watcher.unobserve(target);
      mountPlayer(target, style);
    }
  });
  const observe = (which) => document.querySelectorAll(which).forEach((root) => watcher.observe(root));
  observe(".fem-still:not([data-stands-in])");
  setTimeout(() => observe(".fem-still"), 1000); // those that stand in for a widget have waited for it
}

function mountPlayer(root, style) {
  const data = JSON.parse(root.querySelector(".fem-data").textContent);
  data.captions = Array.from(root.querySelectorAll("tbody td:last-child"), (cell) => cell.textContent.trimEnd());
  const rest = root.querySelectorAll(".fem-note, details");
  root.classList.remove("fem-still");
  const player = new Player(root, data, style);
  root.append(...rest);
  player.stops.push(watchTheme(() => root.isConnected || player.close())); // its cell was run again
}
