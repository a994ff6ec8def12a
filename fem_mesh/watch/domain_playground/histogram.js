// A histogram of angles: bars of five degrees from 0 to 180, and a line at the bound.

import { make } from "../panel.js";

const [WIDE, HIGH, FOOT] = [252, 110, 16]; // in units of the picture
const TOP = 12;
const TICKS = [0, 30, 60, 90, 120, 150, 180];

export class Histogram {
  constructor() {
    this.picture = part("svg", { class: "fem-histogram", viewBox: `-12 0 ${WIDE + 26} ${HIGH + FOOT}`, role: "img" });
    this.bars = part("g", {});
    this.line = part("g", { class: "fem-bound" });
    this.most = part("text", { x: WIDE, y: 9, "text-anchor": "end" });
    const axis = part("path", { class: "fem-axis", d: `M0 ${HIGH}H${WIDE}` });
    const ticks = TICKS.map((angle) => part("text", { x: this.at(angle), y: HIGH + 12, "text-anchor": "middle" }, `${angle}°`));
    this.picture.append(this.bars, axis, ...ticks, this.line, this.most);
    this.node = make("div", {}, make("div", { class: "fem-title" }, "angles of the triangles"), this.picture);
    this.show([], 0);
  }

  at(angle) {
    return (WIDE * angle) / 180;
  }

  show(counts, bound) {
    const most = Math.max(...counts, 1), width = WIDE / Math.max(counts.length, 1), total = counts.reduce((n, count) => n + count, 0);
    this.bars.replaceChildren(...counts.map((count, i) => {
      const height = count ? Math.max(1, ((HIGH - TOP) * count) / most) : 0, low = (180 * i) / counts.length;
      const bar = part("rect", { x: width * i + 0.5, y: HIGH - height, width: width - 1, height });
      if (low + 180 / counts.length <= bound) bar.setAttribute("class", "fem-below");
      bar.append(part("title", {}, `${count} from ${low}° to ${low + 180 / counts.length}°`));
      return bar;
    }));
    const x = this.at(bound);
    this.line.replaceChildren(...(bound ? [part("path", { d: `M${x} ${TOP - 2}V${HIGH}` }), part("text", { x: x + 3, y: 9 }, `≥ ${bound}°`)] : []));
    this.most.textContent = total ? `most: ${most}` : "";
    const peak = counts.indexOf(most);
    const said = total ? `${total} angles, most of them from ${(180 * peak) / counts.length}° to ${(180 * (peak + 1)) / counts.length}°` : "no angles yet";
    this.picture.setAttribute("aria-label", `histogram: ${said}`);
  }
}

function part(tag, attributes, text = "") {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  if (text) node.append(text);
  return node;
}
