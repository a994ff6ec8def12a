// What the live widgets have in common, besides what they show: a kernel, and a still picture beside them.

import { watchSize } from "./panel.js";

// Call back on an event of a widget's model. Returns how to stop.
export function listen(model, event, callback) {
  model.on(event, callback);
  return () => model.off(event, callback);
}

export const NO_ANSWER = "the kernel does not answer: it is busy, or the cell must be run again";

// Send a message to the kernel; returns whether there was one to take it.
export function send(model, message) {
  try {
    model.send(message);
    return true;
  } catch {
    return false;
  }
}

// What a buffer of a message holds, in an order that typed arrays may begin with.
export function bytesOf({ buffer, byteOffset, byteLength }) {
  return buffer.slice(byteOffset, byteOffset + byteLength);
}

// While a widget lives, the still picture beside it, which stands in for it, is not shown. Returns how to stop.
export function hideStandIn(key, root) {
  let hidden = [];
  const hide = () => {
    const cell = root.closest(".jp-Cell, .cell") ?? document.body;
    for (let node = root; node !== cell && node.parentElement && !hidden.length; node = node.parentElement) {
      hidden = [...node.parentElement.querySelectorAll(`[data-stands-in="${key}"]`)];
      for (const still of hidden) still.hidden = true;
    }
  };
  const stop = watchSize(root, () => root.isConnected && hide()); // once it is in the page
  return () => {
    stop();
    for (const still of hidden) still.hidden = false;
  };
}

// Put lines of code on the clipboard; where that is not allowed they are there to be copied by hand.
export function copyLines(lines, area, say) {
  const byHand = () => {
    area.select();
    say("press ctrl-c to copy");
  };
  area.hidden = false;
  area.value = lines;
  area.rows = Math.min(MOST_ROWS, lines.split("\n").length);
  if (navigator.clipboard) navigator.clipboard.writeText(lines).then(() => say("copied: paste it into a cell"), byHand);
  else byHand();
}

const MOST_ROWS = 9; // of code, to be seen at once
