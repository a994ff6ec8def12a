// View: draws one frame of a mesh on a canvas, each thing in the look of its role.
//
// A frame is plain data:
//   x, y        coordinates by point number; NaN where no point ever was
//   there       1 for the points that stand
//   triangles, fresh, visited, doomed, circles   three point numbers a triangle, flat
//   segments, asked, encroached, edges, gone, ties   two point numbers an edge, flat
//   point       [x, y] of what it is about, or null;  waiting: coordinates of points to come, flat
//   voronoi     lines of an overlay, four coordinates each, flat
//   cross       [x, y] of a cursor that keys move
//   tint        an opacity for each of `triangles`
// All but x and y may be left out. Roles, limits, paper and ink come from fem_mesh/watch/style.py.

import { Camera } from "./camera.js";
import { circumcircle } from "./geometry.js";

const PX = 4 / 3; // CSS pixels in a point of 1/72 inch
const MOST_DASHED = 300; // more circles than this are drawn with thin whole lines
const FINEST = 0.7; // of a mesh's lines, in pixels
const A_STROKE = 600; // edges in one path: long paths take more than their share of time

const PLAIN = { width: 1, dash: [], hatch: "", fill: 0, marker: "", size: 0 }; // what a role does not say

export class View extends Camera {
  constructor(canvas, style, box) {
    super(canvas, box);
    this.context = canvas.getContext("2d", { alpha: false });
    this.roles = {};
    for (const [name, role] of Object.entries(style.roles)) this.roles[name] = { ...PLAIN, ...role };
    this.style = style;
    this.dark = false;
    this.hatches = new Map();
    this.drawn = 0;
  }

  // Draw a frame; returns the roles that it shows, for the legend.
  draw(frame, { circles = true, numbers = null, markers = null } = {}) {
    if (!this.resize()) return [];
    const g = this.context, { limits } = this.style;
    g.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    g.fillStyle = this.style.paper[+this.dark];
    g.fillRect(0, 0, this.width, this.height);
    g.lineJoin = "round";
    this.project(frame);
    const shown = new Set();
    const count = frame.there ? frame.there.reduce((n, t) => n + t, 0) : this.px.length;
    const scale = Math.min(1, Math.sqrt(limits.fullSize / Math.max(count, 1)));

    if (frame.tint) this.tinted(frame.triangles, frame.tint);
    for (const name of ["visited", "doomed", "fresh"]) this.fills(frame[name], name === "fresh" ? "new" : name);
    if (frame.voronoi) this.lines(frame.voronoi, shown);
    this.net(frame.triangles, Math.sqrt(scale));
    for (const [name, role] of [["visited", "visited"], ["doomed", "doomed"], ["fresh", "new"]])
      if (this.outlines(frame[name], role)) shown.add(role);
    for (const [name, role] of [["segments", "segment"], ["asked", "asked"], ["ties", "tie"], ["encroached", "encroached"],
      ["edges", "edge"], ["gone", "gone"]])
      if (this.edges(frame[name], role, role === "segment" ? scale : 1)) shown.add(role);
    if (circles) {
      this.circumcircles(frame.circles, shown);
      this.diametrals(frame.encroached, shown);
    }
    if (frame.waiting?.length) this.markers(this.toPixels(frame.waiting), "waiting", 1, shown);
    if (markers ?? count <= limits.marked) this.vertices(frame, scale);
    if (frame.point) this.target(this.toScreen(...frame.point), shown);
    if (frame.cross) this.cross(this.toScreen(...frame.cross));
    if (numbers ?? this.px.length <= limits.numbers) this.numbers(frame);
    this.drawn += 1;
    return Object.keys(this.roles).filter((name) => shown.has(name));
  }

  color(name) {
    const role = this.roles[name];
    return this.dark ? role.dark : role.color;
  }

  // The points in pixels.
  project({ x, y }) {
    const n = x.length, s = this.scale;
    const dx = this.width / 2 - s * this.center[0], dy = this.height / 2 + s * this.center[1];
    if (this.px?.length !== n) [this.px, this.py] = [new Float64Array(n), new Float64Array(n)];
    for (let i = 0; i < n; i++) {
      this.px[i] = dx + s * x[i];
      this.py[i] = dy - s * y[i];
    }
  }

  toPixels(flat) {
    const result = [];
    for (let i = 0; i < flat.length; i += 2) result.push(this.toScreen(flat[i], flat[i + 1]));
    return result;
  }

  trianglePath(path, flat, i) {
    const { px, py } = this, a = flat[i], b = flat[i + 1], c = flat[i + 2];
    path.moveTo(px[a], py[a]);
    path.lineTo(px[b], py[b]);
    path.lineTo(px[c], py[c]);
    path.closePath();
  }

  fills(flat, name) {
    if (!flat?.length) return;
    const g = this.context, role = this.roles[name], path = new Path2D();
    for (let i = 0; i < flat.length; i += 3) this.trianglePath(path, flat, i);
    g.globalAlpha = role.fill;
    g.fillStyle = this.color(name);
    if (role.fill) g.fill(path);
    g.globalAlpha = 1;
    if (role.hatch) {
      g.fillStyle = this.hatch(name);
      g.fill(path);
    }
  }

  tinted(flat, tint) {
    const g = this.context;
    g.fillStyle = this.color("skinny");
    for (let i = 0; i < flat.length; i += 3) {
      if (!tint[i / 3]) continue;
      const path = new Path2D();
      this.trianglePath(path, flat, i);
      g.globalAlpha = tint[i / 3];
      g.fill(path);
    }
    g.globalAlpha = 1;
  }

  outlines(flat, name) {
    if (!flat?.length) return false;
    const path = new Path2D();
    for (let i = 0; i < flat.length; i += 3) this.trianglePath(path, flat, i);
    this.pen(name);
    this.context.stroke(path);
    return true;
  }

  // Every edge of the triangles once; finer lines where there are many.
  net(flat, scale) {
    const g = this.context, { px, py } = this, n = px.length, seen = new Set();
    let path = new Path2D();
    this.pen("mesh");
    g.lineWidth = Math.max(FINEST, PX * this.roles.mesh.width * scale);
    for (let i = 0; i < flat.length; i++) {
      const a = flat[i], b = flat[i % 3 === 2 ? i - 2 : i + 1], edge = a < b ? a * n + b : b * n + a;
      if (seen.has(edge)) continue;
      seen.add(edge);
      path.moveTo(px[a], py[a]);
      path.lineTo(px[b], py[b]);
      if (seen.size % A_STROKE === 0) {
        g.stroke(path);
        path = new Path2D();
      }
    }
    g.stroke(path);
  }

  edges(flat, name, scale = 1) {
    if (!flat?.length) return false;
    const g = this.context, { px, py } = this, role = this.roles[name], path = new Path2D();
    for (let i = 0; i < flat.length; i += 2) {
      path.moveTo(px[flat[i]], py[flat[i]]);
      path.lineTo(px[flat[i + 1]], py[flat[i + 1]]);
    }
    this.pen(name, scale);
    g.lineCap = role.dash.length ? "butt" : "round";
    g.stroke(path);
    return true;
  }

  lines(flat, shown) {
    const g = this.context, path = new Path2D();
    for (let i = 0; i < flat.length; i += 4) {
      path.moveTo(...this.toScreen(flat[i], flat[i + 1]));
      path.lineTo(...this.toScreen(flat[i + 2], flat[i + 3]));
    }
    this.pen("voronoi");
    g.stroke(path);
    shown.add("voronoi");
  }

  pen(name, scale = 1) {
    const g = this.context, role = this.roles[name];
    const width = PX * Math.max(role.width * scale, Math.min(role.width, this.style.limits.thinnest));
    g.strokeStyle = this.color(name);
    g.lineWidth = width;
    g.setLineDash(role.dash.map((length) => length * width));
  }

  circumcircles(flat, shown) {
    if (!flat?.length) return;
    const rings = [];
    for (let i = 0; i < flat.length; i += 3) rings.push(circumcircle(this.px, this.py, flat[i], flat[i + 1], flat[i + 2]));
    this.rings(rings, "circle");
    shown.add("circle");
  }

  diametrals(flat, shown) {
    if (!flat?.length) return;
    const { px, py } = this, rings = [];
    for (let i = 0; i < flat.length; i += 2) {
      const [a, b] = [flat[i], flat[i + 1]];
      rings.push([(px[a] + px[b]) / 2, (py[a] + py[b]) / 2, Math.hypot(px[b] - px[a], py[b] - py[a]) / 2]);
    }
    this.rings(rings, "diametral");
    shown.add("diametral");
  }

  rings(rings, name) {
    const g = this.context, reach = Math.hypot(this.width, this.height) / 2;
    this.pen(name);
    if (rings.length > MOST_DASHED) {
      g.setLineDash([]);
      g.lineWidth = 1;
      g.globalAlpha = 0.45;
    }
    let path = new Path2D(), count = 0;
    for (const [x, y, r] of rings) {
      // A circle that passes nowhere near the page need not be drawn.
      const away = Math.hypot(x - this.width / 2, y - this.height / 2);
      if (!(Math.abs(away - r) < reach)) continue;
      if (r > this.style.limits.views * reach) this.arc(path, x, y, r, away, reach);
      else {
        path.moveTo(x + r, y);
        path.arc(x, y, r, 0, 2 * Math.PI);
      }
      if (++count % 100 === 0) {
        g.stroke(path);
        path = new Path2D();
      }
    }
    g.stroke(path);
    g.globalAlpha = 1;
  }

  // The part near the page of a circle much larger than it.
  arc(path, x, y, r, away, reach) {
    const nx = (this.width / 2 - x) / away, ny = (this.height / 2 - y) / away;
    for (let i = 0; i <= 32; i++) {
      const t = ((i / 16 - 1) * 2 * reach) / r;
      const along = r * Math.sin(t), inward = r - 2 * r * Math.sin(t / 2) ** 2;
      path[i ? "lineTo" : "moveTo"](x + nx * inward - ny * along, y + ny * inward + nx * along);
    }
  }

  vertices({ there }, scale) {
    const centers = [];
    for (let i = 0; i < this.px.length; i++) if (!there || there[i]) centers.push([this.px[i], this.py[i]]);
    this.markers(centers, "vertex", scale);
  }

  markers(centers, name, scale, shown) {
    const g = this.context, role = this.roles[name], r = (PX * scale * role.size) / 2, path = new Path2D();
    for (const [x, y] of centers) {
      path.moveTo(x + r, y);
      path.arc(x, y, r, 0, 2 * Math.PI);
    }
    this.pen(name);
    g.fillStyle = this.color(name);
    if (name === "vertex") g.fill(path);
    else g.stroke(path);
    shown?.add(name);
  }

  // The point of the step wears a ring.
  target([x, y], shown) {
    const g = this.context;
    this.markers([[x, y]], "point", 1, shown);
    g.beginPath();
    g.arc(x, y, PX * 1.75, 0, 2 * Math.PI);
    g.fill();
  }

  cross([x, y]) {
    const g = this.context;
    this.pen("point");
    g.lineWidth = 1.5;
    g.beginPath();
    for (const [dx, dy] of [[12, 0], [0, 12]]) {
      g.moveTo(x - dx, y - dy);
      g.lineTo(x + dx, y + dy);
    }
    g.stroke();
  }

  numbers({ there }) {
    const g = this.context;
    g.font = `${PX * 10}px system-ui, sans-serif`;
    g.textAlign = "left";
    g.textBaseline = "bottom";
    g.fillStyle = this.style.ink[+this.dark];
    g.strokeStyle = this.style.paper[+this.dark];
    g.lineWidth = 3;
    g.setLineDash([]);
    for (let i = 0; i < this.px.length; i++) {
      if (there && !there[i]) continue;
      const place = [String(i), this.px[i] + PX * 4, this.py[i] - PX * 2];
      g.globalAlpha = 0.75;
      g.strokeText(...place);
      g.globalAlpha = 1;
      g.fillText(...place);
    }
  }

  // The second cue of a role: lines or dots, as a pattern.
  hatch(name) {
    const key = `${name} ${this.dark} ${this.ratio}`;
    if (!this.hatches.has(key)) this.hatches.set(key, this.makeHatch(name));
    return this.hatches.get(key);
  }

  makeHatch(name) {
    const tile = document.createElement("canvas"), side = 8, g = tile.getContext("2d");
    tile.width = tile.height = Math.round(side * this.ratio);
    g.scale(tile.width / side, tile.height / side);
    g.strokeStyle = g.fillStyle = this.color(name);
    g.lineWidth = 1.1;
    if (this.roles[name].hatch.includes("/")) {
      for (const shift of [-side, 0, side]) {
        g.moveTo(shift - 1, side + 1);
        g.lineTo(shift + side + 1, -1);
      }
      g.stroke();
    } else {
      for (const [x, y] of [[2, 2], [6, 6]]) {
        g.beginPath();
        g.arc(x, y, 0.9, 0, 2 * Math.PI);
        g.fill();
      }
    }
    const pattern = this.context.createPattern(tile, "repeat");
    pattern.setTransform(new DOMMatrix().scale(side / tile.width));
    return pattern;
  }
}
