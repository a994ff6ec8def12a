// The pencil: what the pointer and the keys do on the canvas of the domain playground.

import { track } from "../panel.js";

const WITHIN = 10; // pixels of a corner that a click means
const TREMBLE = 4; // pixels that a click may move

export class Pencil {
  constructor(board) {
    Object.assign(this, { board, chosen: null, cross: null, lifted: false, pointer: null, pressed: false });
    const { canvas } = board;
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.hover(event));
    canvas.addEventListener("pointerleave", () => this.leave());
    canvas.addEventListener("dblclick", () => this.board.closeLoop());
  }

  // What it held belongs to a drawing that is no more.
  rest() {
    Object.assign(this, { chosen: null, lifted: false });
  }

  get drawing() {
    return this.board.drawing;
  }

  get view() {
    return this.board.view;
  }

  // ---- places ------------------------------------------------------------------------------------

  // A place on the page, rounded to less than a pixel, or to the grid.
  place(px, py) {
    const spot = this.view.toWorld(px, py), grid = this.board.grid;
    if (grid) return spot.map((v) => Number((grid * Math.round(v / grid)).toPrecision(12)));
    return this.rounded(spot);
  }

  rounded(spot) {
    const digits = Math.max(0, Math.ceil(Math.log10(2 * this.view.scale)));
    return spot.map((v) => Number(v.toFixed(digits)));
  }

  under([px, py]) {
    const [i, distance] = this.drawing.nearest(...this.view.toWorld(px, py));
    return distance * this.view.scale <= WITHIN ? i : null;
  }

  isAt([px, py], corner) {
    if (!corner) return false;
    const [x, y] = this.view.toScreen(...corner);
    return Math.hypot(x - px, y - py) <= WITHIN;
  }

  // ---- the pointer -------------------------------------------------------------------------------

  press(event) {
    if (event.button > 1 || this.pressed) return;
    const { board } = this;
    board.root.focus({ preventScroll: true });
    Object.assign(this, { cross: null, lifted: false });
    const from = this.view.at(event), i = this.under(from);
    if (board.brush && !event.button) this.stroke(event, from);
    else if (event.shiftKey && i !== null) this.remove(i);
    else this.follow(event, from, event.button ? null : i, !event.button);
  }

  // Drag the corner, or the view; or, where the pointer did not move, click.
  follow(event, from, i, clicks) {
    const { board, drawing } = this;
    let [dragged, last] = [false, from];
    this.track(event, (at) => {
      if (!dragged && Math.hypot(at[0] - from[0], at[1] - from[1]) > TREMBLE) {
        dragged = true;
        if (i !== null) drawing.remember();
      }
      if (!dragged) return;
      if (i !== null) this.moveTo(i, this.place(...at));
      else {
        this.view.panBy(at[0] - last[0], at[1] - last[1]);
        board.redraw();
      }
      last = at;
    }, (at) => !dragged && clicks && this.click(at, i));
  }

  stroke(event, from) {
    const dab = (at) => this.dab(this.rounded(this.view.toWorld(...at)));
    if (this.mayDab()) this.drawing.remember();
    dab(from);
    this.track(event, dab, () => this.board.redraw());
  }

  dab(spot) {
    if (this.drawing.addSpot(...spot, this.board.controls.brushSize)) this.board.changed();
  }

  mayDab() {
    const { isFull, spots } = this.drawing;
    if (isFull) this.board.say(`no further spots: ${spots.length} are there`);
    return !isFull;
  }

  track(event, move, release) {
    this.pressed = true;
    const end = (act) => (last) => {
      this.pressed = false;
      act(this.view.at(last));
    };
    track(this.board.canvas, event, (now) => move(this.view.at(now)), end(release), end(() => this.board.redraw()));
  }

  hover(event) {
    const at = this.view.at(event);
    this.pointer = at;
    this.board.canvas.style.cursor = this.board.brush ? "cell" : this.under(at) !== null ? "move" : "crosshair";
    if (this.drawing.open.length || this.board.brush) this.board.redraw();
  }

  leave() {
    this.pointer = null;
    if (this.drawing.open.length || this.board.brush) this.board.redraw();
  }

  // On the first corner a click closes the loop, on another corner it chooses that, elsewhere it sets one.
  click(at, i) {
    const { drawing, board } = this, { open } = drawing;
    if (this.isAt(at, open[0]) && open.length > 2) return board.closeLoop();
    if (this.isAt(at, open.at(-1))) return; // the second half of a double click
    if (i !== null && !open.length) return this.choose(i);
    drawing.add(...(i === null ? this.place(...at) : drawing.points[i]));
    this.chosen = null;
    board.say(this.sayLoop());
    board.redraw();
  }

  sayLoop() {
    const n = this.drawing.open.length;
    return n < 3 ? `corner ${n}; a loop needs ${3 - n} more` : `corner ${n}; click the first one, or press enter, to close the loop`;
  }

  // ---- corners -----------------------------------------------------------------------------------

  choose(i) {
    this.chosen = this.chosen === i ? null : i;
    if (this.chosen !== null) this.board.say(`corner ${i} at (${this.drawing.points[i].join(", ")}): drag it, or delete it`);
    this.board.redraw();
  }

  moveTo(i, spot) {
    this.drawing.move(i, ...spot);
    this.chosen = i;
    this.board.changed();
  }

  remove(i) {
    this.drawing.remove(i);
    this.rest();
    this.board.say(`corner ${i} is gone`);
    this.board.changed();
  }

  // Delete: the chosen corner, or the one at the cross, or the last of the loop under way.
  removeChosen() {
    const i = this.chosen ?? (this.cross ? this.under(this.view.toScreen(...this.cross)) : null);
    if (i !== null) this.remove(i);
    else if (this.drawing.open.length) {
      this.drawing.remember();
      this.drawing.open = this.drawing.open.slice(0, -1);
      this.board.redraw();
    }
  }

  // ---- keys: a cross that arrows move, as a pointer ----------------------------------------------

  step(event, dx, dy) {
    const { view, board } = this;
    if (this.cross) {
      const length = board.grid && !event.shiftKey ? board.grid : (event.shiftKey ? 2 : 20) / view.scale;
      this.cross = [this.cross[0] + length * dx, this.cross[1] + length * dy];
    } else this.cross = view.center;
    this.cross = this.place(...view.toScreen(...this.cross));
    if (this.lifted && this.chosen !== null) this.moveTo(this.chosen, this.cross);
    const i = this.under(view.toScreen(...this.cross)), on = i === null ? "" : `, on corner ${i}`;
    board.say(`cross at (${this.cross.join(", ")})${on}`);
    board.redraw();
  }

  // Space or enter at the cross: what a click does there, or a dab of the brush.
  pressAtCross() {
    const at = this.view.toScreen(...this.cross);
    if (this.lifted) return this.putDown();
    if (this.board.brush) {
      if (this.mayDab()) this.drawing.remember();
      return this.dab(this.cross);
    }
    if (this.isAt(at, this.drawing.open.at(-1))) return this.board.closeLoop(); // twice: as a double click
    this.click(at, this.under(at));
  }

  enter() {
    if (this.cross) this.pressAtCross();
    else this.board.closeLoop();
  }

  space() {
    if (this.cross) this.pressAtCross();
    else this.step({}, 0, 0);
  }

  // Take a corner up, to move it with the arrows, and put it down.
  lift() {
    if (this.lifted) return this.putDown();
    const i = this.cross ? this.under(this.view.toScreen(...this.cross)) : this.chosen;
    if (i === null) return this.board.say("move the cross onto a corner first, with the arrow keys");
    this.drawing.remember();
    [this.chosen, this.lifted, this.cross] = [i, true, [...this.drawing.points[i]]];
    this.board.say(`corner ${i} is taken up: move it with the arrow keys, and press m again`);
    this.board.redraw();
  }

  putDown() {
    this.lifted = false;
    this.board.say(`corner ${this.chosen} is put down at (${this.drawing.points[this.chosen].join(", ")})`);
    this.board.redraw();
  }

  escape() {
    if (!this.drawing.drop()) [this.cross, this.chosen, this.lifted] = [null, null, false];
    else this.board.say("the loop under way is dropped");
    this.board.redraw();
  }
}
