// What is drawn: corners and segments, the loop under way, spots of the brush; and how it came to be, for undo.
//
// A segment is [a, b, row, curved]: two corners, its row in the shape begun with (-1: drawn by hand), and whether it
// still follows its curve there. See fem_mesh/watch/sketch.py.

const DRAWN = -1;
const MOST_UNDONE = 500;
const MOST_SPOTS = 300;

export class Drawing {
  constructor() {
    Object.assign(this, { start: "", points: [], segments: [], open: [], spots: [], past: [], future: [], version: 0 });
  }

  get corners() {
    return this.points.length + this.open.length;
  }

  // What is sent to the kernel.
  get closed() {
    return { start: this.start, points: this.points, segments: this.segments };
  }

  // ---- going back --------------------------------------------------------------------------------

  snapshot() {
    const { start, points, segments, open, spots } = this;
    return JSON.stringify({ start, points, segments, open, spots });
  }

  remember() {
    this.past.push(this.snapshot());
    if (this.past.length > MOST_UNDONE) this.past.shift();
    this.future = [];
  }

  goBack(from, to) {
    if (!from.length) return false;
    to.push(this.snapshot());
    Object.assign(this, JSON.parse(from.pop()));
    this.version += 1;
    return true;
  }

  undo() {
    return this.goBack(this.past, this.future);
  }

  redo() {
    return this.goBack(this.future, this.past);
  }

  // Begin anew with what the kernel sends. At the very beginning there is nothing to go back to.
  begin({ start, points, segments }, { first = false } = {}) {
    if (!first) this.remember();
    Object.assign(this, { start, points, segments, open: [], spots: first ? this.spots : [] });
  }

  // Take over what was changed elsewhere, here and in all that undo and redo go to where it was as here. The loop under
  // way stays. Returns whether there was anything new.
  follow(there) {
    const part = (state) => JSON.stringify(Object.keys(there).map((name) => state[name])), here = part(this);
    if (part(there) === here) return false;
    const followed = (known) => {
      const then = JSON.parse(known);
      return part(then) === here ? JSON.stringify({ ...then, ...there }) : known;
    };
    Object.assign(this, there, { past: this.past.map(followed), future: this.future.map(followed) });
    return true;
  }

  clear() {
    this.remember();
    Object.assign(this, { start: "", points: [], segments: [], open: [], spots: [] });
    this.version += 1;
  }

  // ---- the loop under way ------------------------------------------------------------------------

  add(x, y) {
    this.remember();
    this.open.push([x, y]);
  }

  close() {
    if (this.open.length < 3) return false;
    this.remember();
    const first = this.points.length, n = this.open.length;
    this.points = [...this.points, ...this.open];
    this.segments = [...this.segments, ...this.open.map((_, i) => [first + i, first + ((i + 1) % n), DRAWN, false])];
    this.open = [];
    this.version += 1;
    return true;
  }

  drop() {
    if (!this.open.length) return false;
    this.remember();
    this.open = [];
    return true;
  }

  // ---- corners -----------------------------------------------------------------------------------

  nearest(x, y) {
    let best = -1, least = Infinity;
    this.points.forEach(([px, py], i) => {
      const distance = Math.hypot(px - x, py - y);
      if (distance < least) [best, least] = [i, distance];
    });
    return [best, least];
  }

  // A moved corner takes its segments off their curves.
  move(i, x, y) {
    this.points = this.points.map((point, k) => (k === i ? [x, y] : point));
    this.segments = this.segments.map(([a, b, row, curved]) => [a, b, row, curved && a !== i && b !== i]);
    this.version += 1;
  }

  // The neighbours of a corner that goes are joined, unless they are already: then what is left of the loop goes too.
  remove(i) {
    this.remember();
    const at = this.segments.filter(([a, b]) => a === i || b === i), others = this.segments.filter((s) => !at.includes(s));
    const ends = at.map(([a, b]) => (a === i ? b : a));
    let kept = others;
    if (at.length === 2) {
      const [u, v] = ends, joined = others.find(([a, b]) => (a === u && b === v) || (a === v && b === u));
      const lonely = (w) => others.every((s) => s === joined || (s[0] !== w && s[1] !== w));
      if (joined && lonely(u) && lonely(v)) kept = others.filter((s) => s !== joined);
      else if (!joined) {
        const bridge = at[0][1] === i ? [u, v, at[0][2], false] : [v, u, at[0][2], false];
        kept = this.segments.flatMap((s) => (s === at[0] ? [bridge] : s === at[1] ? [] : [s]));
      }
    }
    const used = new Set(kept.flatMap(([a, b]) => [a, b]));
    this.renumber((k) => k !== i && (used.has(k) || !ends.includes(k)), kept);
  }

  renumber(stays, segments) {
    const number = new Map();
    this.points.forEach((_, k) => stays(k) && number.set(k, number.size));
    this.points = this.points.filter((_, k) => stays(k));
    this.segments = segments.map(([a, b, row, curved]) => [number.get(a), number.get(b), row, curved]);
    this.version += 1;
  }

  // ---- the brush ---------------------------------------------------------------------------------

  // Ask for edges of length h around (x, y), unless that is asked for already.
  get isFull() {
    return this.spots.length >= MOST_SPOTS;
  }

  addSpot(x, y, h) {
    if (this.isFull || this.spots.some(([a, b, k]) => Math.hypot(a - x, b - y) < h && k <= h)) return false;
    this.spots = [...this.spots, [x, y, h]];
    return true;
  }
}
