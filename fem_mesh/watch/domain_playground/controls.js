// The sliders and buttons of the domain playground.

import { make, button, toggleFullScreen } from "../panel.js";

const STEEPEST = 36; // degrees
const PLACES = 100; // of the sliders of lengths
const SIZES = [0.5, 0.01]; // shares of the extent, from such a slider's place 1 to its last
const BRUSHES = [0.1, 0.002];

export class Controls {
  constructor(board) {
    this.board = board;
    this.sliders = this.buildSliders();
    this.bar = this.buildBar();
    for (const select of [this.starts, this.encroachment]) // its letters are its own
      select.addEventListener("keydown", (event) => event.ctrlKey || event.key === "Escape" || event.stopPropagation());
  }

  // ---- bounds ------------------------------------------------------------------------------------

  get brushSize() {
    return threeDigits(shareAt(Number(this.brush.value), BRUSHES) * this.board.extent);
  }

  show({ min_angle: angle, size, encroachment }) {
    const { extent } = this.board, percent = (length) => `${Number(((100 * length) / extent).toPrecision(2))} %`;
    const tell = (name, words) => {
      this[`${name}Shown`].textContent = words;
      this[name].setAttribute("aria-valuetext", words);
    };
    this.angle.value = angle;
    tell("angle", angle ? `≥ ${angle}°` : "none");
    this.size.value = size === null ? 0 : placeOf(size / extent, SIZES);
    tell("size", size === null ? "none" : `≤ ${threeDigits(size)} (${percent(size)})`);
    tell("brush", `${this.brushSize} (${percent(this.brushSize)})`);
    this.encroachment.value = encroachment;
  }

  buildSliders() {
    const { board } = this;
    const slider = (name, label, min, max, act) => {
      this[name] = make("input", { type: "range", min, max, step: 1, value: min, "aria-label": label, input: act });
      this[`${name}Shown`] = make("output", {});
      return make("label", { class: `fem-${name}` }, make("span", {}, label), this[`${name}Shown`], this[name]);
    };
    const setSize = () => {
      const at = Number(this.size.value);
      board.bound({ size: at ? threeDigits(shareAt(at, SIZES) * board.extent) : null });
    };
    const rows = [
      slider("angle", "smallest angle", 0, STEEPEST, () => board.bound({ min_angle: Number(this.angle.value) })),
      slider("size", "longest edge", 0, PLACES, setSize),
      slider("brush", "brush: edges of", 1, PLACES, () => { this.show(board.bounds); board.redraw(); }),
    ];
    this.brush.value = PLACES / 2;
    this.brushRow = rows[2];
    this.brushRow.hidden = true;
    this.encroachment = make("select", { "aria-label": "encroachment", change: () => board.bound({ encroachment: this.encroachment.value }) },
      make("option", { value: "lens" }, "vertex in the lens (Chew)"), make("option", { value: "circle" }, "vertex in the circle (Ruppert)"));
    return [...rows, make("label", {}, make("span", {}, "encroachment"), this.encroachment)];
  }

  // ---- buttons -----------------------------------------------------------------------------------

  showShapes(names) {
    if (this.starts.options.length === 1) this.starts.append(...names.map((name) => make("option", { value: name }, name)));
  }

  press(name, on) {
    this[name].setAttribute("aria-pressed", String(on));
  }

  buildBar() {
    const { board } = this;
    this.starts = make("select", { "aria-label": "start from a shape", change: () => board.start(this.starts.value) },
      make("option", { value: "" }, "start from ..."));
    this.undo = button("undo", "undo", () => board.goBack("undo"), { key: "ctrl-z" });
    this.redo = button("redo", "redo", () => board.goBack("redo"), { key: "ctrl-y" });
    this.gridOn = button("grid: corners snap to it", "grid", () => board.toggleGrid(), { key: "g", pressed: false });
    this.brushOn = button("brush: small triangles where you drag", "brush", () => board.toggleBrush(), { key: "b", pressed: false });
    this.clearSpots = button("clear the brush's strokes", "clear strokes", () => board.clearSpots());
    this.play = button("play Ruppert's steps", "play Ruppert's steps", () => board.record(), { key: "p" });
    this.copy = button("copy as code", "copy as code", () => board.stage.copy(board.told.code));
    this.help = button("help", "?", () => board.toggleHelp(), { key: "?" });
    return make("div", { class: "fem-bar", role: "toolbar", "aria-label": "drawing" },
      this.starts, button("clear", "clear", () => board.clear()), this.undo, this.redo, this.gridOn, this.brushOn,
      this.clearSpots, make("span", { class: "fem-space" }), this.play, this.copy,
      button("fit the view", "fit", () => board.fit(), { key: "0" }),
      button("full screen", "full", () => toggleFullScreen(board.root), { key: "f" }), this.help);
  }
}

// What keys do. The player has keys of its own; and while the pointer is down, none does anything.
export function keysOf(board) {
  const here = (act) => (event) => event.target.closest(".fem-player") || board.pencil.pressed || act(event);
  const step = (dx, dy) => here((event) => board.pencil.step(event, dx, dy));
  return [
    [["ArrowLeft"], "move the cross, the keyboard's pointer (finer with shift)", step(-1, 0)],
    [["ArrowRight"], "", step(1, 0)],
    [["ArrowUp"], "", step(0, 1)],
    [["ArrowDown"], "", step(0, -1)],
    [[" "], "set a corner at the cross; on the first one: close the loop", here(() => board.pencil.space())],
    [["Enter"], "close the loop (or double click); with the cross: as space", here(() => board.pencil.enter())],
    [["Escape"], "drop the loop under way, or the cross", here(() => board.pencil.escape())],
    [["Delete", "Backspace"], "remove the corner that is chosen, or at the cross (or shift-click)", here(() => board.pencil.removeChosen())],
    [["m"], "take the corner at the cross up, move it by arrow keys, put it down", here(() => board.pencil.lift())],
    [["ctrl-z"], "undo", here(() => board.goBack("undo"))],
    [["ctrl-y", "ctrl-Z"], "redo", here(() => board.goBack("redo"))],
    [["b"], "brush", here(() => board.toggleBrush())],
    [["g"], "grid", here(() => board.toggleGrid())],
    [["p"], "play the steps", here(() => board.record())],
    [["i"], "zoom in (or ctrl and the wheel)", here(() => board.zoomBy(1.4))],
    [["o"], "zoom out", here(() => board.zoomBy(1 / 1.4))],
    [["0"], "fit the view", here(() => board.fit())],
    [["f"], "full screen", here(() => toggleFullScreen(board.root))],
    [["?"], "this help", here(() => board.toggleHelp())],
  ];
}

const threeDigits = (value) => Number(value.toPrecision(3));

// Shares of the extent on a logarithmic slider, from its place 1 to the last; and back.
const shareAt = (place, [from, to]) => from * (to / from) ** ((place - 1) / (PLACES - 1));
const placeOf = (share, [from, to]) =>
  Math.min(PLACES, Math.max(1, Math.round(1 + ((PLACES - 1) * Math.log(share / from)) / Math.log(to / from))));
