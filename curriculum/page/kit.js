/* What the explaining figures share: scenes of balls, results that are kept, a chart beside a
 * picture, a lens, and handles that set a number. */
import { axis, ball, circle, clipped, el, label, plot, round, table } from "./draw.js";
import { tenTo, within } from "./draw.js";
import { data } from "./data.js";
import { GRAVITY, makeRows, projectImpulse, solveContacts } from "./engine.js";
import { knobsOf, QUANTITIES } from "./store.js";

export const R = data.radius; // m
export const G = -GRAVITY; // m/s^2, and the weight in N of a ball of 1 kg
export const START = data.scenes.drop.start[0]; // m, of the ball that is dropped
export const ARRIVES = Math.sqrt(2 * G * (START - R)); // m/s, and it reaches the table so fast

// A scene of balls: `more` holds what differs from balls of 1 kg at rest over one another.
export function scene(heights, more = {}) {
  const same = (value) => heights.map(() => value);
  const each = { x: same(0), vx: same(0), vy: same(0), mass: same(1), radius: same(R) };
  return { ...each, y: heights, restitution: 0, damping: 0, ...more };
}

/* Heights [m] of a ball of 1 kg that is dropped on a spring: penalty's steps, bit for bit, in one
 * loop for figures that look at many drops at once. */
export function drops(dt, stiffness, damping, steps) {
  const heights = new Float64Array(steps + 1).fill(START);
  let speed = 0;
  for (let row = 1; row <= steps; row++) {
    const depth = R - heights[row - 1];
    const force = depth > 0 ? Math.max(0, stiffness * depth - damping * speed) : 0;
    speed += dt * (force - G);
    heights[row] = heights[row - 1] + dt * speed;
  }
  return heights;
}

/* What sweeps over a column do, contact by contact from below: [{contact, wanted, lam, vy}],
 * where `wanted` is the change before the clamp; first what they start with. */
export function visits(masses, lam, vy, count) {
  const contacts = masses.map((_, i) => ({ i, j: i - 1, nx: 0, ny: 1 }));
  const rows = makeRows(contacts, masses).map((row, k) => ({ ...row, lam: lam[k] }));
  const vx = masses.map(() => 0);
  const seen = [{ contact: null, wanted: 0, lam, vy: vy.slice() }];
  for (let at = 0; at < count; at++) {
    const contact = at % rows.length;
    let wanted = 0;
    const project = (sum, change) => projectImpulse(sum, (wanted = change));
    solveContacts([rows[contact]], vx, vy, { iters: 1, project });
    seen.push({ contact, wanted, lam: rows.map((row) => row.lam), vy: vy.slice() });
  }
  return seen;
}

// A function that keeps its last results, by its arguments.
export function kept(compute) {
  const held = new Map();
  return (...given) => {
    const key = JSON.stringify(given);
    if (!held.has(key)) {
      if (held.size > 20) held.clear();
      held.set(key, compute(...given));
    }
    return held.get(key);
  };
}

export const knobs = (view) => knobsOf(view.values);

// What soft is told, for a ball that does not bounce.
export const softKnobs = (view) => ({
  ...knobsOf({ ...view.values, impedance: view.get("impedance") }),
  restitution: 0,
});

// How deep each of balls of such heights [m] is in what is below it [r].
export const depthsOf = (heights) =>
  heights.map((y, i) => (i ? 2 - (y - heights[i - 1]) / R : 1 - y / R));

// ---- pictures

/* A picture at the left and a chart at the right: the chart, with the svg of both and the picture's
 * `middle`. picture(width, chart) is drawn within its part, a `share` of the width. */
export function beside(view, options, picture, share = 0.4) {
  const left = Math.round(Math.min(share * view.width, 300));
  const chart = plot([left + 16, 0, view.width - left - 16, view.height], options);
  const drawn = clipped(0, 0, left, view.height, picture(left, chart));
  return { ...chart, svg: drawn + chart.svg, middle: left / 2 };
}

// What is seen through a lens of `size` px around (x, y).
export function through(x, y, size, ...inside) {
  const style = `clip-path: circle(${size}px at ${round(x)}px ${round(y)}px) view-box`;
  const seen = el("g", { style }, circle(x, y, size, "lens-ground"), ...inside);
  return seen + circle(x, y, size, "lens-rim");
}

/* A look at a contact through a lens around (x, y): the table's top, and the edge of a ball that is
 * `depth` deep [r], enlarged so that it can be seen, or `given` times; a radius is `r` px. Nothing
 * where that is seen without a lens. */
export function lens(model, x, y, r, depth, size, given) {
  const steps = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000];
  const times = given || steps.find((each) => each * depth * r >= 12) || 10000;
  if (!given && (times <= 2 || depth <= 0)) return "";
  const inside = [
    table(x - size, y, 2 * size, size),
    ball(model, x, y + (depth - 1) * r * times, r * times, "magnified"),
  ];
  const enlarged = label(`× ${times}`, x, y + size + 16, "middle", "tick");
  return through(x, y, size, ...inside) + enlarged;
}

// How long an arrow for a force is, in weights: the root, since impacts are hundreds of weights.
export const forceLength = (weights, unit = 26) => unit * Math.sqrt(Math.max(weights, 0));

// An axis of powers of ten, from 10^low to 10^high.
export function tens(low, high) {
  const powers = Array.from({ length: high - low + 1 }, (_, k) => low + k);
  const ticks = powers.map((power) => [10 ** power, tenTo(power)]);
  return { domain: [10 ** low, 10 ** high], ticks, log: true };
}

// ---- handles

/* A handle at (x, y) for one number: `name` in the figure's own state, or a quantity of the page.
 *   label, text   what it is, and its value in words
 *   at(x, y)      the number where the handle is dragged to; kept from `low` to `high`
 *   by(dx, dy)    in place of it: what a drag by so many px adds
 *   step, times   what an arrow key to the right or up adds, or multiplies by
 *   get(), set(v) in place of the state; r, hold, release() as in stage.js
 * A number of its own that is set takes the figure's clock back to before its start. */
export function grip(view, name, x, y, label, text, options) {
  const quantity = QUANTITIES[name];
  const { at, by, step, times, get, r, hold, release } = { ...quantity, ...options };
  const value = get || (() => (quantity ? view.get(name) : view.own[name]));
  const put = (wanted) => putNumber(view, name, wanted, { ...quantity, ...options });
  const moved = (toX, toY) => view.from.value + by(toX - view.from.x, toY - view.from.y);
  const drag = (toX, toY) => put(by ? moved(toX, toY) : at(toX, toY));
  const nudge = (dx, dy) => put(times ? value() * times ** (dx - dy) : value() + step * (dx - dy));
  return { name, x, y, r, hold, label, text, value: value(), drag, nudge, release };
}

function putNumber(view, name, wanted, { low, high, digits, set }) {
  const held = within(low, wanted, high);
  const value = Number(digits ? held.toPrecision(digits) : held.toFixed(4));
  if (set) set(value);
  else if (!(name in view.own)) view.set({ [name]: value });
  else Object.assign(view.own, "time" in view.own && { time: null }, { [name]: value });
}

/* A handle for two numbers, `ranges`: {name: [low, high]}. at(x, y) gives those where it is dragged
 * to, and an arrow key moves it by `px`; they are kept with so many digits. */
export function pair(view, name, [x, y], label, text, ranges, { at, px = 4, digits, r }) {
  const drag = (toX, toY) =>
    Object.entries(ranges).forEach(([each, [low, high]], k) =>
      putNumber(view, each, at(toX, toY)[k], { low, high, digits }));
  let [nowX, nowY] = [x, y];
  const nudge = (dx, dy) => drag((nowX += px * dx), (nowY += px * dy));
  return { name, x, y, r, label, text, value: at(x, y)[0], drag, nudge };
}

// The same handle at another place, too: all of a ball. The hand goes on as from the first.
export const wholly = (handle, name, x, y, r) =>
  ({ ...handle, name, x, y, r, hold: handle.hold || [handle.x, handle.y] });
