// What players and playgrounds have in common: elements, buttons with keys, legend, theme, zoom.

const SVG = "http://www.w3.org/2000/svg";

const ICONS = {
  first: "M3 3h2v10H3zM13 3 6 8l7 5z",
  last: "M11 3h2v10h-2zM3 3l7 5-7 5z",
  back: "M11 3 4 8l7 5z",
  forward: "M5 3l7 5-7 5z",
  play: "M4 2.5 13.5 8 4 13.5z",
  pause: "M4 3h3v10H4zM9.5 3h3v10h-3z",
  circles: "M8 2.5a5.5 5.5 0 1 0 .01 0z",
  fit: "M2 6V2h4M10 2h4v4M14 10v4h-4M6 14H2v-4",
  full: "M6 2H2v4M2 2l4 4M10 14h4v-4M14 14l-4-4M10 2h4v4M14 2l-4 4M2 10v4h4M2 14l4-4",
  undo: "M6 3 2 7l4 4M2 7h7a4 4 0 0 1 0 7H6",
  redo: "M10 3l4 4-4 4M14 7H7a4 4 0 0 0 0 7h3",
};
const OUTLINED = new Set(["circles", "fit", "full", "undo", "redo"]);

// An element with attributes (functions become listeners) and children.
export function make(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") node.addEventListener(name, value);
    else if (value !== null && value !== false) node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.filter((child) => child !== null));
  return node;
}

function icon(name) {
  const svg = document.createElementNS(SVG, "svg"), path = document.createElementNS(SVG, "path");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("aria-hidden", "true");
  if (OUTLINED.has(name)) svg.setAttribute("class", "fem-outlined");
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

// A button: an icon or a word, a label for the ear and the pointer, and the key that does the same.
export function button(label, face, action, { key = "", pressed = null } = {}) {
  const title = key ? `${label} (${key})` : label;
  const node = make("button", { type: "button", title, "aria-label": label, click: action });
  if (key) node.setAttribute("aria-keyshortcuts", SHORTCUTS[key] ?? key);
  if (pressed !== null) node.setAttribute("aria-pressed", String(pressed));
  setFace(node, face);
  return node;
}

const SHORTCUTS = { space: "Space", "←": "ArrowLeft", "→": "ArrowRight", "ctrl-z": "Control+Z", "ctrl-y": "Control+Y" };

// Disable a button; the focus does not go down with it.
export function disable(node, off, root) {
  if (off && document.activeElement === node) root.focus({ preventScroll: true });
  node.disabled = off;
}

export function setFace(node, face) {
  node.replaceChildren(face in ICONS ? icon(face) : face);
}

// Actions by key, for a root element that has the focus; "?" shows them. `table`: [keys, words, action] rows.
export function listenToKeys(root, table, help) {
  const actions = new Map(table.flatMap(([keys, , action]) => keys.map((key) => [key, action])));
  // JupyterLab leaves the keys to us where the element with the focus says so.
  for (const node of [root, ...root.querySelectorAll(FOCUSABLE)]) node.setAttribute("data-lm-suppress-shortcuts", "true");
  root.addEventListener("keydown", (event) => {
    const typed = "[]".includes(event.key); // which takes AltGr or Option on many keyboards
    const name = (!typed && (event.ctrlKey || event.metaKey) ? "ctrl-" : "") + event.key;
    const inField = event.target.matches("input, select, textarea");
    if ((event.altKey && !typed) || (inField && !name.startsWith("ctrl-") && FIELD_KEYS.has(event.key))) return;
    if (event.target.matches("button, summary, select") && (event.key === " " || event.key === "Enter")) return; // pressing it
    const action = event.key === "Escape" && !help.hidden ? () => (help.hidden = true) : actions.get(name);
    if (!action) return;
    event.preventDefault();
    event.stopPropagation();
    action(event);
  });
  help.addEventListener("click", () => (help.hidden = true));
  help.append(
    make("h3", {}, "Keys"),
    make("dl", {}, ...table.flatMap(([keys, words]) => (words ? [make("dt", {}, keyNames(keys)), make("dd", {}, words)] : []))),
  );
}

const FOCUSABLE = "canvas, button, select, input, textarea, summary";
const FIELD_KEYS = new Set(["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End", "PageUp", "PageDown"]);

const KEY_NAMES = { " ": "space", ArrowLeft: "←", ArrowRight: "→", Home: "home", End: "end", Delete: "delete" };

const keyNames = (keys) => keys.filter((key) => key !== "=").map((key) => KEY_NAMES[key] ?? key).join(" or ");

// The looks that a picture shows, each with its word.
export function showLegend(node, view, shown) {
  const listed = shown.filter((name) => name !== "mesh" && name !== "vertex");
  const state = listed.join() + view.dark;
  if (node.dataset.shown === state) return;
  node.dataset.shown = state;
  node.replaceChildren(...listed.map((name) => make("span", {}, swatch(view, name), view.roles[name].word)));
}

function swatch(view, name) {
  const svg = document.createElementNS(SVG, "svg"), role = view.roles[name];
  svg.setAttribute("viewBox", "0 0 26 14");
  svg.setAttribute("aria-hidden", "true");
  const shape = document.createElementNS(SVG, role.fill ? "rect" : role.marker ? "circle" : "line");
  const look = { fill: "none", stroke: view.color(name), "stroke-width": Math.min(role.width * 1.33, 5) };
  if (role.fill) Object.assign(look, { x: 1, y: 1, width: 24, height: 12, fill: view.color(name), "fill-opacity": role.fill });
  else if (role.marker) Object.assign(look, { cx: 13, cy: 7, r: Math.min(role.size / 2, 5) });
  else Object.assign(look, { x1: 1, y1: 7, x2: 25, y2: 7, "stroke-dasharray": role.dash.map((d) => d * role.width * 1.33).join(" ") });
  for (const [key, value] of Object.entries(look)) shape.setAttribute(key, value);
  svg.append(shape);
  if (role.hatch) svg.append(swatchHatch(role.hatch, view.color(name)));
  return svg;
}

function swatchHatch(hatch, color) {
  const path = document.createElementNS(SVG, "path"), slanted = hatch.includes("/");
  path.setAttribute("d", slanted ? "M2 12 8 2M10 12l6-10M18 12l6-10" : "M5 5h.01M13 5h.01M21 5h.01M9 10h.01M17 10h.01");
  for (const [key, value] of Object.entries({ stroke: color, "stroke-width": slanted ? 1 : 1.8, "stroke-linecap": "round" }))
    path.setAttribute(key, value);
  return path;
}

// Call back with whether the page is dark, now and whenever that changes. Returns how to stop.
export function watchTheme(callback) {
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => {
    const { jpThemeLight, vscodeThemeKind } = document.body.dataset;
    if (jpThemeLight) return jpThemeLight === "false";
    if (vscodeThemeKind) return !vscodeThemeKind.includes("light");
    return system.matches;
  };
  const tell = () => callback(isDark());
  const observer = new MutationObserver(() => requestAnimationFrame(tell)); // when the page has its new style sheets
  observer.observe(document.body, { attributes: true, attributeFilter: ["data-jp-theme-light", "data-vscode-theme-kind"] });
  system.addEventListener("change", tell);
  tell();
  return () => {
    observer.disconnect();
    system.removeEventListener("change", tell);
  };
}

// Follow a pointer that was pressed on a canvas, until it is let go or taken away.
export function track(canvas, event, move, release, cancel = release) {
  const stop = new AbortController(), follow = (name, act) =>
    canvas.addEventListener(name, (now) => now.pointerId === event.pointerId && act(now), { signal: stop.signal });
  const end = (act) => (now) => {
    stop.abort();
    act(now);
  };
  canvas.setPointerCapture(event.pointerId);
  follow("pointermove", move);
  follow("pointerup", end(release));
  follow("pointercancel", end(cancel));
}

// Zoom with the wheel (with ctrl, but in full screen); with `pans`, dragging moves the view.
export function letZoom(view, redraw, root, { pans = true } = {}) {
  const { canvas } = view;
  canvas.addEventListener("wheel", (event) => {
    if (!(event.ctrlKey || event.metaKey || document.fullscreenElement === root)) return;
    event.preventDefault();
    view.zoomBy(Math.exp(-0.002 * event.deltaY * (event.deltaMode ? 20 : 1)), view.at(event));
    redraw();
  }, { passive: false });
  if (pans) canvas.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    let last = view.at(event);
    track(canvas, event, (moved) => {
      const at = view.at(moved);
      view.panBy(at[0] - last[0], at[1] - last[1]);
      last = at;
      redraw();
    }, () => null);
  });
}

// Call back when an element changes its size. Returns how to stop.
export function watchSize(node, callback) {
  const observer = new ResizeObserver(callback);
  observer.observe(node);
  return () => observer.disconnect();
}

export function toggleFullScreen(root) {
  if (document.fullscreenElement) document.exitFullscreen();
  else root.requestFullscreen?.();
}

export function toggleHelp(help, button) {
  help.hidden = !help.hidden;
  button.setAttribute("aria-expanded", String(!help.hidden));
}
