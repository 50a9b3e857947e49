/* One long step by hand: what it does to place and speed is a 2 x 2 matrix; its eigenvalues say whether
 * the next steps grow. */
import { el, mark, number } from "../draw.js";
import { criticalDt, runModel } from "../engine.js";
import { alongAxis, axis, charted, handle, kept, label, line, R, scene, shift, tidy, within } from "../parts.js";

const DEPTH = 0.2; // r: how deep the ball is pressed in
const LONGEST = 0.032; // s
const TOP = 1.8; // r
const FINE = 2e-5; // s
const TEXT = 56; // px below the chart

// Depth x and upward speed v after one step from (x, v), x from the place of rest: mass 1, no clamp.
const stepMatrix = (dt, k, c) => [
  [1 - k * dt * dt, -dt * (1 - c * dt)],
  [k * dt, 1 - c * dt],
];

// The eigenvalues of a 2 x 2 matrix, as [real, imaginary] each.
function eigenvalues([[a, b], [c, d]]) {
  const square = ((a - d) / 2) ** 2 + b * c;
  const root = Math.sqrt(Math.abs(square));
  return [root, -root].map((part) => (square < 0 ? [(a + d) / 2, part] : [(a + d) / 2 + part, 0]));
}

const pressed = scene([(1 - DEPTH) * R]);
const spring = kept((stiffness, damping) =>
  runModel("penalty", pressed, { dt: FINE, stiffness, damping }, Math.round(LONGEST / FINE)),
);
const height = (y) => y / R - 1;

// The unit circle and the eigenvalues.
function circle(pairs, width, rows) {
  const unit = Math.min(width / 4.8, (rows - 50) / 2.4);
  const [x, y] = [width - 1.7 * unit, rows / 2];
  const at = ([real, imaginary]) => [x + within(-2.8, real, 1.5) * unit, y - imaginary * unit];
  return [
    label("eigenvalues", x, 14, "middle", "axis-name"),
    line(x - 2.8 * unit, y, x + 1.6 * unit, y, "grid"),
    line(x, y - 1.2 * unit, x, y + 1.2 * unit, "grid"),
    el("circle", { cx: x, cy: y, r: unit, class: "rule" }),
    label("−1", x - unit - 5, y + 18, "end", "tick"),
    label("1", x + unit + 5, y + 18, "start", "tick"),
    ...pairs.map((pair) => mark("penalty", ...at(pair), 7)),
  ].join("");
}

function stepChart(view, width, { dt, stiffness, damping }) {
  const fine = spring(stiffness, damping);
  const ys = Array.from(runModel("penalty", pressed, { dt, stiffness, damping }, 1).y, height);
  const chart = charted(view, 0, {
    id: "long-step",
    width,
    height: view.height - TEXT,
    x: axis([0, 1000 * LONGEST], "time (ms)", 0, 10, 20, 30),
    y: axis([-0.5, TOP], "height / r", 0, 1),
    lines: [
      { model: "exact", xs: Array.from(fine.t, (t) => 1000 * t), ys: Array.from(fine.y, height), class: "thin" },
      { model: "penalty", xs: [0, 1000 * dt], ys, class: "law" },
    ],
    rules: [{ y: 0 }],
    points: [{ model: "penalty", x: 1000 * dt, y: Math.min(TOP, ys[1]), size: 7 }],
  });
  return { ...chart, tip: [chart.sx(1000 * Math.min(LONGEST, dt)), chart.sy(Math.min(TOP, ys[1]))] };
}

function draw(view) {
  const knobs = { dt: view.get("dt"), stiffness: view.get("stiffness"), damping: view.get("damping") };
  const matrix = stepMatrix(knobs.dt, knobs.stiffness, knobs.damping);
  const pairs = eigenvalues(matrix);
  const size = Math.max(...pairs.map((pair) => Math.hypot(...pair)));
  const left = Math.round(0.56 * view.width);
  const chart = stepChart(view, left, knobs);
  const rows = matrix.map(([x, v], k) => {
    const row = `${"xv"[k]}’ = ${number(x)} x ${v < 0 ? "−" : "+"} ${number(Math.abs(v))} v`;
    return label(row, chart.box.left, view.height - 24 + 20 * k);
  });
  const grows = size < 1 - 1e-9 ? "the steps die away" : size > 1 + 1e-9 ? "the steps grow" : "the steps stay as large";
  const { damped } = criticalDt(1, knobs.stiffness, knobs.damping);
  const text = `dt = ${number(1000 * knobs.dt)} ms`;
  return {
    svg: chart.markup + shift(left + 16, 0, circle(pairs, view.width - left - 16, view.height - TEXT)) + rows.join(""),
    words: `${text}: the larger eigenvalue has size ${number(size)}, so ${grows}; they grow from dt = ${number(1000 * damped)} ms on.`,
    handles: [handle("step", ...chart.tip, 14, "the end of the step", knobs.dt, text)],
  };
}

const set = (view, dt) => view.set({ dt: within(0.0005, tidy(dt), LONGEST) });

export const figure = {
  title: "One long step of a pressed spring",
  caption:
    "One step multiplies place and speed by a matrix: drag its end, and the ball never rests once an eigenvalue leaves the circle.",
  height: 310,
  uses: ["dt", "stiffness", "damping"],
  shows: { dt: 0.016 },
  draw,
  ...alongAxis((view, share) => set(view, share * LONGEST), (view, by) => set(view, view.get("dt") + 0.0005 * by)),
};
