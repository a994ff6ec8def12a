// The strip below a player: a lane for each kind of step, a curve of the smallest angle, and where we are.

import { track } from "./panel.js";

const LANE = 13; // pixels
const CURVE = 34;
const GAP = 5;

export class Timeline {
  constructor(canvas, trace, style, seek) {
    Object.assign(this, { canvas, trace, style, dark: false });
    this.context = canvas.getContext("2d");
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button) return;
      const to = (moved) => seek(this.stepAt(moved.clientX - canvas.getBoundingClientRect().left));
      track(canvas, event, to, () => null);
      to(event);
    });
  }

  // Kinds in the order of their first step.
  setTrace(trace) {
    this.trace = trace;
    this.kinds = [...new Set(trace.steps.map((step) => step.kind))];
    this.highest = trace.angles.reduce((highest, angle) => Math.max(highest, angle ?? 0), 1e-9);
    this.canvas.style.height = `${LANE * this.kinds.length + GAP + CURVE}px`;
    this.back = null;
  }

  get gutter() {
    return Math.min(92, this.canvas.clientWidth / 4);
  }

  xOf(k) {
    const room = this.canvas.clientWidth - this.gutter - 9;
    return this.gutter + 4 + (room * k) / Math.max(this.trace.length - 1, 1);
  }

  stepAt(px) {
    const share = (px - this.gutter - 4) / (this.canvas.clientWidth - this.gutter - 9);
    return Math.round(Math.min(1, Math.max(0, share)) * (this.trace.length - 1));
  }

  draw(k) {
    const { clientWidth: width, clientHeight: height } = this.canvas, ratio = window.devicePixelRatio || 1;
    if (!width) return;
    const state = [width, height, ratio, this.dark].join();
    if (!this.back || this.state !== state) {
      [this.canvas.width, this.canvas.height] = [width * ratio, height * ratio];
      this.back = this.drawBack(width, height, ratio);
      this.state = state;
    }
    const g = this.context, x = this.xOf(k), ink = this.style.ink[+this.dark];
    g.setTransform(1, 0, 0, 1, 0, 0);
    g.drawImage(this.back, 0, 0);
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.fillStyle = ink;
    g.fillRect(x - 0.75, 0, 1.5, height);
    const lane = this.kinds.indexOf(this.trace.steps[k].kind);
    g.beginPath();
    g.arc(x, LANE * (lane + 0.5), 4, 0, 2 * Math.PI);
    g.fill();
    const angle = this.trace.angles[k];
    if (angle !== null) {
      g.beginPath();
      g.arc(x, this.yOf(angle), 3, 0, 2 * Math.PI);
      g.fill();
    }
  }

  yOf(angle) {
    return LANE * this.kinds.length + GAP + (CURVE - 4) * (1 - angle / this.highest) + 2;
  }

  // All that does not move, drawn once.
  drawBack(width, height, ratio) {
    const back = document.createElement("canvas");
    [back.width, back.height] = [width * ratio, height * ratio];
    const g = back.getContext("2d");
    g.scale(ratio, ratio);
    g.fillStyle = this.style.paper[+this.dark];
    g.fillRect(0, 0, width, height);
    g.font = "11px system-ui, sans-serif";
    g.textBaseline = "middle";
    g.textAlign = "right";
    const { steps, kinds } = this.trace, tick = Math.max(1.2, Math.min(6, (0.7 * (width - this.gutter)) / steps.length));
    this.kinds.forEach((kind, lane) => {
      g.fillStyle = this.style.ink[+this.dark];
      g.fillText(kinds[kind], this.gutter - 6, LANE * (lane + 0.5));
      g.globalAlpha = 0.12;
      g.fillRect(this.gutter, LANE * (lane + 0.5), width - this.gutter, 1);
      g.globalAlpha = 1;
      const role = this.style.roles[this.style.kinds[kinds[kind]] ?? "vertex"];
      g.fillStyle = this.dark ? role.dark : role.color;
      steps.forEach((step, k) => {
        if (step.kind === kind) g.fillRect(this.xOf(k) - tick / 2, LANE * lane + 2, tick, LANE - 4);
      });
    });
    this.drawCurve(g, width);
    return back;
  }

  drawCurve(g, width) {
    const role = this.style.roles.circle, floor = this.yOf(0);
    g.fillStyle = this.style.ink[+this.dark];
    g.fillText("smallest", this.gutter - 6, floor - CURVE + 12);
    g.fillText(`angle, ≤ ${this.highest.toFixed(0)}°`, this.gutter - 6, floor - CURVE + 24);
    g.globalAlpha = 0.3;
    g.fillRect(this.gutter, floor, width - this.gutter, 1);
    g.globalAlpha = 1;
    g.strokeStyle = this.dark ? role.dark : role.color;
    g.lineWidth = 1.6;
    g.beginPath();
    let before = null;
    this.trace.angles.forEach((angle, k) => {
      if (angle !== null) {
        if (before === null) g.moveTo(this.xOf(k), this.yOf(angle));
        else g.lineTo(this.xOf(k), this.yOf(before)), g.lineTo(this.xOf(k), this.yOf(angle));
      }
      before = angle;
    });
    g.stroke();
  }
}
