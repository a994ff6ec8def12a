// A trace as the browser holds it: a table of lifetimes (see fem_mesh/watch/wire.py).
//
// Rows of points, triangles and segments, each with the step that brought it and the step that took it. The
// frame after step k is the rows alive then, so any frame is as near as any other.

const NEVER = 2 ** 31 - 1;

class Lifetimes {
  constructor({ rows, born, lived, numbers }) {
    let k = 0;
    this.rows = rows;
    this.numbers = numbers;
    this.born = Int32Array.from(born, (later) => (k += later));
    this.died = Int32Array.from(lived, (steps, row) => (steps ? this.born[row] + steps : NEVER));
  }

  // The rows of `width` numbers that `wanted(born, died)`, flat.
  pick(width, wanted) {
    const result = [];
    for (let row = 0; row < this.born.length; row++)
      if (wanted(this.born[row], this.died[row])) for (let i = 0; i < width; i++) result.push(this.rows[width * row + i]);
    return result;
  }
}

export class Trace {
  constructor({ points, triangles, segments, box, makes_points: makesPoints, ...rest }) {
    Object.assign(this, rest, { box, makesPoints }); // steps, kinds, captions, angles, more
    this.points = new Lifetimes(points);
    this.triangles = new Lifetimes(triangles);
    this.segments = new Lifetimes(segments);
    this.unit = (box[1] - box[0]) / 1e6; // in which coordinates come
    this.size = this.points.numbers.reduce((size, number) => Math.max(size, number + 1), 0);
    this.last = [new Float64Array(this.size).fill(NaN), new Float64Array(this.size).fill(NaN)];
    for (let row = 0; row < this.points.numbers.length; row++) this.place(row, ...this.last);
  }

  get length() {
    return this.steps.length;
  }

  kind(k) {
    return this.kinds[this.steps[k].kind];
  }

  at([x, y]) {
    return [this.box[0] + this.unit * x, this.box[2] + this.unit * y];
  }

  place(row, x, y) {
    const { rows, numbers } = this.points;
    [x[numbers[row]], y[numbers[row]]] = this.at([rows[2 * row], rows[2 * row + 1]]);
  }

  // What View draws of step k.
  frame(k) {
    const step = this.steps[k];
    const isAlive = (born, died) => born <= k && k < died;
    const isFresh = (born, died) => k > 0 && born === k && k < died;
    const isOld = (born, died) => isAlive(born, died) && !isFresh(born, died);
    const triangles = this.triangles.pick(3, isOld), fresh = this.triangles.pick(3, isFresh);
    const removed = this.triangles.pick(3, (born, died) => died === k);
    return {
      ...this.pointsAt(k), triangles, fresh, gone: vanished(removed, [triangles, fresh]),
      visited: step.visited, doomed: step.doomed, circles: step.circles ?? step.doomed, point: step.point && this.at(step.point),
      segments: this.segments.pick(2, isAlive), asked: step.asked, encroached: step.encroached, edges: step.edges,
      waiting: this.waiting(k),
    };
  }

  pointsAt(k) {
    const { born, died, numbers } = this.points;
    const [x, y, there] = [this.last[0].slice(), this.last[1].slice(), new Uint8Array(this.size)];
    for (let row = 0; row < numbers.length; row++)
      if (born[row] <= k && k < died[row]) {
        this.place(row, x, y);
        there[numbers[row]] = 1;
      }
    return { x, y, there };
  }

  // The points that come later, but for the one that the step is about.
  waiting(k) {
    if (this.makesPoints) return [];
    const { rows, born } = this.points, { point } = this.steps[k], result = [];
    for (let row = 0; row < born.length; row++)
      if (born[row] > k && !(point?.[0] === rows[2 * row] && point[1] === rows[2 * row + 1]))
        result.push(...this.at([rows[2 * row], rows[2 * row + 1]]));
    return result;
  }
}

// The edges of removed triangles that no triangle has any more.
function vanished(removed, standing) {
  const name = (a, b) => (a < b ? `${a} ${b}` : `${b} ${a}`), edges = new Map();
  for (const [a, b] of sides(removed)) edges.set(name(a, b), [a, b]);
  if (edges.size) for (const flat of standing) for (const [a, b] of sides(flat)) edges.delete(name(a, b));
  return [...edges.values()].flat();
}

function* sides(flat) {
  for (let i = 0; i < flat.length; i += 3)
    for (let j = 0; j < 3; j++) yield [flat[i + j], flat[i + ((j + 1) % 3)]];
}
