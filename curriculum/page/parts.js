/* What the explaining figures share: one ball over a table, scenes, results that are kept, a lens. */
import { ball, el, plot, round, table, words } from "./draw.js";
import { data } from "./data.js";
import { GRAVITY } from "./engine.js";
import { knobsOf } from "./store.js";

export const R = data.radius; // m
export const G = -GRAVITY; // m/s^2, and the weight in N of a ball of 1 kg
export const START = data.scenes.drop.start[0]; // m, of the ball that is dropped

// A scene of balls: `more` holds what differs from balls of 1 kg at rest over one another.
export function scene(heights, more = {}) {
  const same = (value) => heights.map(() => value);
  const each = { x: same(0), vx: same(0), vy: same(0), mass: same(1), radius: same(R) };
  return { ...each, y: heights, restitution: 0, damping: 0, ...more };
}

export const within = (low, value, high) => Math.min(high, Math.max(low, value));
export const tidy = (value, digits = 3) => Number(value.toPrecision(digits));
export const whole = (count) => String(count).replace(/\B(?=(\d{3})+$)/g, ",");
export const plural = (count, word) => `${whole(count)} ${word}${count === 1 ? "" : "s"}`;
export const shift = (x, y, ...children) =>
  el("g", { transform: `translate(${round(x)} ${round(y)})` }, ...children);
export const label = (text, x, y, anchor = "start", kind = "tick strong") =>
  words(text, { x, y, class: kind, "text-anchor": anchor });
export const line = (x1, y1, x2, y2, kind = "rule dashed") => el("line", { x1, y1, x2, y2, class: kind });
export const logGrid = (low, high, count) =>
  Array.from({ length: count }, (_, k) => low * (high / low) ** (k / (count - 1)));

// Ticks at these values; [value, text] stays as it is.
export const ticks = (...values) =>
  values.map((each) => (Array.isArray(each) ? each : [each, String(each).replace("-", "−")]));
export const axis = (domain, name, ...at) => ({ domain, label: name, ticks: ticks(...at) });

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

// What lies within a rectangle.
export function clipped(id, x, y, width, height, ...children) {
  const shape = el("clipPath", { id }, el("rect", { x, y, width, height }));
  return shape + el("g", { "clip-path": `url(#${id})` }, ...children);
}

/* A picture at the left and a chart at the right: {svg, x, y, middle}. x and y are the chart's scales
 * in the drawing, middle is the picture's. picture(width, chart) is drawn within its part, a `share` of
 * the width; options.under(chart) is drawn beneath the chart. */
export function beside(view, id, options, picture, share = 0.4) {
  const left = Math.round(within(110, share * view.width, 300));
  const at = left + 16;
  const chart = charted(view, at, { id, ...options });
  const scene = clipped(`${id}-scene`, 0, 0, left, view.height, picture(left, chart));
  const markup = el("g", { transform: `translate(${at} 0)` }, options.under ? options.under(chart) : "", chart.markup);
  return { svg: scene + markup, x: (v) => at + chart.sx(v), y: chart.sy, middle: left / 2 };
}

// A chart from `at` on, as large as the drawing; its scale is kept for the drags.
export function charted(view, at, options) {
  const chart = plot({ width: view.width - at, height: view.height, ...options });
  const { left, right } = chart.box;
  view.own.along = (x) => within(0, (x - at - left) / (right - left), 1);
  return chart;
}

/* A number that is dragged along its chart's x axis, and that arrow keys change by steps:
 * change(view, share of the axis) and step(view, by). */
export const alongAxis = (change, step) => ({
  drag: (view, name, x) => change(view, view.own.along(x), name),
  nudge: (view, name, dx, dy) => step(view, dx - dy, name),
});

/* A look at a contact through a lens around (x, y): the table's top, and the edge of a ball that is
 * `depth` deep [r], `times` as large as in the picture, where a radius is `r` px. */
export function lens(id, model, x, y, { depth, r, times, size = 38 }) {
  const big = r * times;
  const shape = el("clipPath", { id }, el("circle", { cx: x, cy: y, r: size }));
  const inside =
    el("circle", { cx: x, cy: y, r: size, class: "lens-ground" }) +
    table(x - size, y, 2 * size, size) +
    ball(model, x, y - big + depth * big, big, "ball plainly");
  return (
    shape +
    el("g", { "clip-path": `url(#${id})` }, inside) +
    el("circle", { cx: x, cy: y, r: size, class: "lens-rim" }) +
    label(`× ${times}`, x, y + size + 16, "middle", "tick")
  );
}

// How often a lens enlarges so that a depth [r] can be seen, as a round number.
export function enlarged(depth, r) {
  const wanted = 12 / Math.max(Math.abs(depth) * r, 1e-6);
  return [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000].find((each) => each >= wanted) || 10000;
}

// How long an arrow for a force is, in weights: the root, since impacts are hundreds of weights.
export const forceLength = (weights, unit = 26) => unit * Math.sqrt(Math.max(weights, 0));

// What soft is told, for a ball that does not bounce.
export const softKnobs = (view) => ({
  ...knobsOf({ ...view.values, impedance: view.get("impedance") }),
  restitution: 0,
});

export const handle = (name, x, y, r, label, value, text) => ({ name, x, y, r, label, value, text });

// The clock of a figure whose own `time` runs from `from` to end(view), `rate` s in a second; it stops
// where a handle is grabbed or the time becomes null.
export function clock(rate, end, names = ["Play", "Stop"], from = 0) {
  const tick = (view, seconds) => {
    if (view.grabbed !== null || view.own.time === null) return false;
    view.own.time = Math.min(end(view), view.own.time + rate * seconds);
    return view.own.time < end(view);
  };
  const start = (view) => {
    view.own.time = view.still ? end(view) : from;
    if (!view.still) view.run();
  };
  const press = (view) => (view.running() ? view.stop() : start(view));
  const buttons = [{ label: (view) => names[view.running() ? 1 : 0], press }];
  return { start, parts: { tick, buttons } };
}
