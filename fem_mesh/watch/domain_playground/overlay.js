// What the domain playground draws above the mesh: outline, loop under way, handles of corners, spots, brush, grid.

const FADED = 0.62; // what the last mesh loses of its colour while an outline is refused
const MANY = 40; // corners: more of them have small handles
const [SMALL, LARGE, FIRST] = [5, 8, 12]; // handles, in pixels

export class Overlay {
  constructor(board) {
    this.board = board;
  }

  get view() {
    return this.board.view;
  }

  // Returns the roles that it shows.
  draw() {
    const { board, view } = this, { drawing, told } = board, shown = [];
    if (told.refusal) this.fade();
    if (board.grid) this.grid(board.grid);
    if (drawing.segments.length && (told.refusal || !board.mesh)) {
      const ends = (i) => view.toScreen(...drawing.points[i]);
      this.lines(drawing.segments.map(([a, b]) => [ends(a), ends(b)]), "segment");
      shown.push("segment");
    }
    if (drawing.open.length) this.loop(shown);
    this.spots(shown);
    this.handles();
    if (told.refusal && told.where) this.ring(...view.toScreen(...told.where));
    return shown;
  }

  // Where the pointer is, or the cross of the keyboard.
  get tip() {
    const { pencil } = this.board;
    return pencil.cross ? this.view.toScreen(...pencil.cross) : pencil.pointer;
  }

  fade() {
    const { context: g, width, height, style, dark } = this.view;
    g.globalAlpha = FADED;
    g.fillStyle = style.paper[+dark];
    g.fillRect(0, 0, width, height);
    g.globalAlpha = 1;
  }

  loop(shown) {
    const corners = this.board.drawing.open.map((corner) => this.view.toScreen(...corner)), { tip } = this;
    const stops = tip ? [...corners, tip] : corners;
    this.lines(stops.slice(1).map((end, i) => [stops[i], end]), "asked");
    shown.push("asked");
  }

  lines(lines, role) {
    const { context: g } = this.view;
    g.beginPath();
    for (const [from, to] of lines) {
      g.moveTo(...from);
      g.lineTo(...to);
    }
    this.view.pen(role);
    g.stroke();
  }

  handles() {
    const { view } = this, { drawing, pencil } = this.board, ink = view.style.ink[+view.dark], accent = view.color("circle");
    const side = drawing.points.length > MANY ? SMALL : LARGE;
    view.context.setLineDash([]);
    view.context.lineWidth = 1.5;
    drawing.points.forEach((corner, i) => {
      const chosen = i === pencil.chosen;
      this.square(corner, chosen ? side + 5 : side, chosen ? accent : ink);
    });
    drawing.open.forEach((corner, i) => this.square(corner, i ? LARGE : FIRST, accent));
  }

  square(corner, side, color) {
    const { context: g, style, dark } = this.view, [x, y] = this.view.toScreen(...corner);
    g.strokeStyle = color;
    g.fillStyle = style.paper[+dark];
    g.fillRect(x - side / 2, y - side / 2, side, side);
    g.strokeRect(x - side / 2, y - side / 2, side, side);
  }

  ring(x, y) {
    const { context: g } = this.view;
    g.strokeStyle = this.view.color("doomed");
    g.lineWidth = 3;
    g.beginPath();
    g.arc(x, y, 10, 0, 2 * Math.PI);
    g.stroke();
  }

  spots(shown) {
    const { view, board, tip } = this;
    view.pen("spot");
    view.context.fillStyle = view.color("spot");
    for (const [x, y, h] of board.drawing.spots) this.disk(view.toScreen(x, y), Math.max(2.5, (h * view.scale) / 2), 0.3);
    if (board.drawing.spots.length) shown.push("spot");
    if (board.brush && tip) this.disk(tip, Math.max(4, board.controls.brushSize * view.scale), 0.12);
  }

  disk([x, y], radius, alpha) {
    const { context: g } = this.view;
    g.beginPath();
    g.arc(x, y, radius, 0, 2 * Math.PI);
    g.globalAlpha = alpha;
    g.fill();
    g.globalAlpha = 1;
    g.stroke();
  }

  grid(cell) {
    const { context: g, width, height, scale, style, dark } = this.view;
    const [left, top] = this.view.toWorld(0, 0), [right, bottom] = this.view.toWorld(width, height);
    if (cell * scale < 5) return;
    g.fillStyle = style.ink[+dark];
    g.globalAlpha = 0.35;
    for (let i = Math.ceil(left / cell); i <= right / cell; i++)
      for (let j = Math.ceil(bottom / cell); j <= top / cell; j++) {
        const [x, y] = this.view.toScreen(i * cell, j * cell);
        g.fillRect(x - 0.75, y - 0.75, 1.5, 1.5);
      }
    g.globalAlpha = 1;
  }
}
