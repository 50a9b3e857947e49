/* The first screen: a ball to lift, drop and throw, in real time, by the exact model, which gives
 * back a fixed share of its speed. */
import { arrow, ball, el, label, number, table, within } from "../draw.js";
import { runExact, stateAt } from "../engine.js";
import { R, scene } from "../kit.js";

const GROUND = 46; // px of table below its top
const FASTEST = 6; // m/s, of a ball that is thrown
const HIGH = 0.8; // m over the table that are seen
const BOUNCE = 0.6;
const LONG = 12; // s, until it rests however it was thrown
const scaleOf = (view) => (view.height - GROUND) / HIGH; // px for a metre
const wide = (view) => view.width / scaleOf(view); // m
const held = (view, x, y) => [within(R, x, wide(view) - R), within(R, y, HIGH - 0.2 * R)];

// Sideways the ball flies between two walls: place and speed after a time.
function across(view, x, vx, time) {
  const wall = vx > 0 ? wide(view) - R : R;
  const hit = vx === 0 ? Infinity : (wall - x) / vx;
  if (hit >= time) return [x + time * vx, vx];
  return across(view, wall, -BOUNCE * vx, time - hit);
}

// Upwards it bounces on the table, event to event. Does it still move, so many seconds later?
function fly(view, seconds) {
  const { place, velocity } = view.own;
  const up = scene([place[1]], { vy: [velocity[1]], restitution: BOUNCE });
  const { y, vy } = stateAt(runExact(up, { dt: seconds }, 1), 1);
  const [x, vx] = across(view, place[0], velocity[0], seconds);
  Object.assign(view.own, { place: [x, y[0]], velocity: [vx, vy[0]] });
  return Math.abs(vx) > 1e-3 || Math.abs(vy[0]) > 1e-6 || y[0] - R > 1e-9;
}

// Hold the ball at a place, in metres.
function hold(view, x, y) {
  view.stop();
  Object.assign(view.own, { free: false, velocity: [0, 0], place: held(view, x, y) });
}

function letGo(view, velocity) {
  Object.assign(view.own, { free: true, velocity });
  if (view.still) fly(view, LONG);
  else view.run();
}

function drop(view) {
  view.own.place = [0.5 * wide(view), 0.68];
  letGo(view, [0, 0]);
}

function draw(view) {
  const { own } = view;
  const [scale, floor] = [scaleOf(view), view.height - GROUND];
  own.place = held(view, ...(own.place || [0.5 * wide(view), 0.5]));
  const [left, high] = own.place;
  const [x, y, r, gap] = [left * scale, floor - high * scale, R * scale, high - R];
  const rests = own.free && gap < 1e-9 && Math.abs(own.velocity[1]) < 1e-9;
  const rx = r * (1 - 0.4 * Math.min(1, gap));
  const text = `${number(gap, 2)} m above the table`;
  const nudge = (dx, dy) => hold(view, own.place[0] + 0.02 * dx, own.place[1] - 0.02 * dy);
  const release = () => {
    const [vx, vy] = view.flick().map((v) => within(-FASTEST, v / scale, FASTEST));
    letGo(view, [vx, -vy]);
  };
  const drag = (toX, toY) => hold(view, toX / scale, (floor - toY) / scale);
  const name = "the ball; arrow keys move it, Enter lets it go";
  return {
    svg: [
      table(0, floor, view.width, GROUND),
      el("ellipse", { cx: x, cy: floor + 6, rx, ry: 5, class: "shadow" }),
      ball("exact", x, y, r),
      arrow("weight", x, y, 0, 70) + label("weight", x + 7, y + 70),
      rests ? arrow("push m-exact", x, floor, 0, -70) + label("push", x + 7, floor - 60) : "",
    ].join(""),
    words: rests
      ? "It rests: the table pushes with exactly the ball’s weight."
      : `${own.free ? "" : "A hand holds it "}${text}.`,
    handles: [{ name: "ball", label: name, x, y, r, value: gap, text, drag, nudge, release }],
  };
}

export const figure = {
  title: "A ball over a table",
  caption: "Grab the ball: lift it, drop it, throw it.",
  height: 360,
  narrow: 340,
  start: () => ({ place: null, velocity: [0, 0], free: false }),
  buttons: [["Drop it", drop]],
  draw,
  tick: fly,
};
