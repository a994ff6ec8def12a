// The camera: which part of the plane a canvas shows. Lengths on the canvas are CSS pixels.

const MOST_ZOOM = 5000;
const LEAST_ZOOM = 0.2;

export class Camera {
  constructor(canvas, box) {
    this.canvas = canvas;
    this.setBox(box);
  }

  setBox([left, right, bottom, top]) {
    this.box = [left, right, bottom, top];
    this.fit();
  }

  fit() {
    const [left, right, bottom, top] = this.box;
    this.center = [(left + right) / 2, (bottom + top) / 2];
    this.zoom = 1;
  }

  get scale() {
    const [left, right, bottom, top] = this.box;
    return this.zoom * Math.min(this.width / (right - left), this.height / (top - bottom));
  }

  toScreen(x, y) {
    const s = this.scale;
    return [this.width / 2 + s * (x - this.center[0]), this.height / 2 - s * (y - this.center[1])];
  }

  toWorld(px, py) {
    const s = this.scale;
    return [this.center[0] + (px - this.width / 2) / s, this.center[1] - (py - this.height / 2) / s];
  }

  // The place of a pointer event, in pixels of the canvas.
  at(event) {
    const frame = this.canvas.getBoundingClientRect();
    return [event.clientX - frame.left, event.clientY - frame.top];
  }

  // Zoom by a factor around a pixel.
  zoomBy(factor, [px, py] = [this.width / 2, this.height / 2]) {
    const before = this.toWorld(px, py);
    this.zoom = Math.min(MOST_ZOOM, Math.max(LEAST_ZOOM, this.zoom * factor));
    const after = this.toWorld(px, py);
    this.center = this.center.map((c, i) => c + before[i] - after[i]);
  }

  panBy(dx, dy) {
    const s = this.scale;
    this.center = [this.center[0] - dx / s, this.center[1] + dy / s];
  }

  // Give the canvas as many pixels as it is shown with; returns whether it can be seen at all.
  resize() {
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (!width || !height) return false;
    const ratio = window.devicePixelRatio || 1;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    [this.width, this.height, this.ratio] = [width, height, ratio];
    return true;
  }
}
