// A triangulation as the playground holds it, changed by differences.

import { smallestAngle } from "./geometry.js";

export class Mesh {
  constructor(points = [], triangles = []) {
    [this.x, this.y, this.voronoi] = [[], [], []]; // the Voronoi diagram's lines come from the kernel
    for (let i = 0; i < points.length; i += 2) {
      this.x.push(points[i]);
      this.y.push(points[i + 1]);
    }
    this.rows = new Map();
    for (let i = 0; i < triangles.length; i += 3) this.add(triangles[i], triangles[i + 1], triangles[i + 2]);
  }

  add(a, b, c) {
    this.rows.set(name(a, b, c), [a, b, c]);
    this.dirty = true;
  }

  apply({ removed, added, gone_points: gone, new_points: come }) {
    for (let i = 0; i < removed.length; i += 3) this.rows.delete(name(removed[i], removed[i + 1], removed[i + 2]));
    for (let i = 0; i < added.length; i += 3) this.add(added[i], added[i + 1], added[i + 2]);
    for (const [i, x, y] of come) [this.x[i], this.y[i]] = [x, y];
    if (gone.length) this.x.length = this.y.length = Math.min(...gone);
    this.dirty = true;
  }

  get triangles() {
    if (this.dirty) [this.flat, this.dirty] = [[...this.rows.values()].flat(), false];
    return this.flat ?? [];
  }

  get smallest() {
    let smallest = Infinity;
    for (const [a, b, c] of this.rows.values()) smallest = Math.min(smallest, smallestAngle(this.x, this.y, a, b, c));
    return smallest;
  }

  nearest(x, y) {
    let best = -1, least = Infinity;
    for (let i = 0; i < this.x.length; i++) {
      const distance = Math.hypot(this.x[i] - x, this.y[i] - y);
      if (distance < least) [best, least] = [i, distance];
    }
    return [best, least];
  }

  copy() {
    const copy = new Mesh();
    return Object.assign(copy, { x: [...this.x], y: [...this.y], rows: new Map(this.rows), voronoi: this.voronoi, dirty: true });
  }
}

const name = (a, b, c) => (a < b && a < c ? `${a} ${b} ${c}` : b < c ? `${b} ${c} ${a}` : `${c} ${a} ${b}`);
