// Below the domain playground: the player of its steps, and its lines of code.

import { Player } from "../player.js";
import { make, button } from "../panel.js";
import { copyLines } from "../kernel.js";

export class Stage {
  constructor(board) {
    Object.assign(this, { board, player: null });
    this.node = make("div", { class: "fem-stage" });
    this.code = make("textarea", { class: "fem-code", "aria-label": "the lines that make this again", readonly: true, hidden: true, spellcheck: "false" });
  }

  play({ data, cut }) {
    const root = make("div"), close = button("close the player", "close", () => this.close());
    this.player?.close();
    close.setAttribute("data-lm-suppress-shortcuts", "true");
    this.node.replaceChildren(
      make("div", { class: "fem-bar" }, make("strong", {}, "step by step"), make("span", { class: "fem-cut" }, cut), make("span", { class: "fem-space" }), close),
      root,
    );
    this.player = new Player(root, data, this.board.style);
    this.board.say("");
    const calm = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.node.scrollIntoView({ block: "nearest", behavior: calm ? "auto" : "smooth" });
    root.focus({ preventScroll: true });
  }

  close() {
    this.board.root.focus({ preventScroll: true });
    this.stop();
    this.node.replaceChildren();
  }

  stop() {
    this.player?.close();
    this.player = null;
  }

  copy(lines) {
    copyLines(lines, this.code, (words) => this.board.say(words));
  }
}
