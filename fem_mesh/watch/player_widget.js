// The player as a widget.

import { Player } from "./player.js";
import { make } from "./panel.js";
import { listen, send, hideStandIn, NO_ANSWER } from "./kernel.js";

// Of the views of a widget, the one whose clock ticks; by its data, which all views share (each has a model of its own).
const leaders = new WeakMap();

// A widget: its traits follow the player, and the player follows them.
export function renderPlayer({ model, el }, style) {
  const set = (name) => (value) => {
    if (model.get(name) === value) return;
    model.set(name, value);
    model.save_changes();
  };
  const lead = (playing) => {
    const data = model.get("data");
    if (playing) leaders.set(data, leaders.get(data) ?? player);
    else leaders.delete(data);
    set("playing")(playing);
  };
  const stage = make("div");
  el.replaceChildren(stage);
  const player = new Player(stage, model.get("data"), style, {
    k: model.get("step"), step: set("step"), speed: set("speed"), circles: set("circles"), numbers: set("numbers"),
    playing: lead, more: () => send(model, { type: "more" }) || (player.caption.textContent = NO_ANSWER),
  });
  const on = {
    data: (data) => player.setData(data),
    step: (k) => k !== player.k && player.go(k),
    speed: (speed) => speed !== player.speed && player.setSpeed(speed),
    circles: (circles) => circles !== player.circles && player.setCircles(circles),
    numbers: (numbers) => numbers !== player.numbers && player.setNumbers(numbers),
    playing: (playing) => {
      if (playing && !player.playing) player.play(leaders.has(model.get("data")));
      if (!playing) player.pause();
    },
  };
  const stops = Object.entries(on).map(([name, act]) => listen(model, `change:${name}`, () => act(model.get(name))));
  for (const name of ["speed", "circles", "numbers", "playing"]) on[name](model.get(name));
  const leave = () => {
    if (leaders.get(model.get("data")) === player) lead(false);
    player.close();
  };
  stops.push(listen(model, "msg:custom", ({ type, said }) => type === "failed" && (player.caption.textContent = said)));
  stops.push(hideStandIn(model.get("key"), stage), leave);
  return () => stops.forEach((stop) => stop());
}
