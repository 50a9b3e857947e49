/* The first screen: a ball that can be lifted, dropped and thrown. It moves by the exact model, in
 * real time, and gives back a fixed share of its speed. */
import { arrow, ball, el, label, table, within } from "../draw.js";
import { runExact, stateAt } from "../engine.js";
import { inHand, R, scene } from "../parts.js";

const BOUNCE = 0.6;
const DT = 1 / 240; // s between two rows of a throw
const LONG = 12; // s that are computed at once
const GROUND = 46; // px of table below its top

const scaleOf = (view) => (view.height - GROUND) / 0.8; // px for a metre
const wide = (view) => view.width / scaleOf(view); // m
const held = (view, x, y) => [within(R, x, wide(view) - R), within(R, y, 0.8 - 0.2 * R)];

// What the ball does from here on, upwards: it bounces on the table, event to event.
function thrown([, y], [, vy]) {
  const up = scene([y], { vy: [vy], restitution: BOUNCE });
  return runExact(up, { dt: DT }, Math.round(LONG / DT));
}

// And sideways, between two walls: place and speed after a time.
function across(view, x, vx, time) {
  const wall = vx > 0 ? wide(view) - R : R;
  const hit = vx === 0 ? Infinity : (wall - x) / vx;
  if (hit >= time) return [x + time * vx, vx];
  return across(view, wall, -BOUNCE * vx, time - hit);
}

// Hold the ball at a place, in metres.
function hold(view, x, y) {
  view.stop();
  Object.assign(view.own, { run: null, velocity: [0, 0], place: held(view, x, y) });
}

function letGo(view, velocity) {
  const { own } = view;
  Object.assign(own, { from: own.place, thrown: velocity, time: 0 });
  own.run = thrown(own.place, velocity);
  if (view.still) seek(view, LONG);
  else view.run();
}

// Show the throw at a time. Does the ball still move?
function seek(view, time) {
  const { own } = view;
  own.time = Math.min(time, LONG);
  const { y, vy } = stateAt(own.run, Math.floor(own.time / DT + 1e-9));
  const [x, vx] = across(view, own.from[0], own.thrown[0], own.time);
  Object.assign(own, { place: [x, y[0]], velocity: [vx, vy[0]] });
  const rests = Math.abs(vx) < 1e-3 && Math.abs(vy[0]) < 1e-6 && y[0] - R < 1e-9;
  return own.time < LONG && !rests;
}

function draw(view) {
  const { own } = view;
  const [scale, floor] = [scaleOf(view), view.height - GROUND];
  own.place = held(view, ...(own.place || [0.5 * wide(view), 0.5]));
  const hand = {
    place: () => own.place,
    put: (toX, toY) => hold(view, toX, toY),
    letGo: (velocity) => letGo(view, velocity),
  };
  const told = "the ball; arrow keys move it, Enter lets it go";
  const grip = inHand(view, "ball", told, floor, scale, hand);
  const { x, y, r, value: gap } = grip;
  const rests = own.run && gap < 1e-9 && Math.abs(own.velocity[1]) < 1e-9;
  const rx = r * (1 - 0.4 * Math.min(1, gap));
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
      : `${grip.text}. Let go.`,
    handles: [grip],
  };
}

export const figure = {
  title: "A ball over a table",
  caption: "Grab the ball: lift it, drop it, throw it.",
  height: 480,
  narrow: 340,
  start: () => ({ place: null, velocity: [0, 0], run: null, time: 0 }),
  buttons: [
    {
      label: "Drop it",
      press(view) {
        view.own.place = [0.5 * wide(view), 0.68];
        letGo(view, [0, 0]);
      },
    },
  ],
  draw,
  tick: (view, seconds) => seek(view, view.own.time + seconds),
};
