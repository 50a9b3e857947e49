/* One long step by hand: what it does to place and speed is a 2 x 2 matrix, and its eigenvalues say
 * whether the next steps grow. */
import { axis, circle, label, line, mark, number, plot, within } from "../draw.js";
import { criticalDt, runModel } from "../engine.js";
import { grip, kept, R, scene } from "../kit.js";

const DEPTH = 0.2; // r: how deep the ball is pressed in
const LONGEST = 0.032; // s
const TOP = 1.8; // r
const FINE = 2e-5; // s
const TEXT = 56; // px below the chart

// Depth x (from the place of rest) and upward speed v after one step from (x, v): 1 kg, no clamp.
const stepMatrix = (dt, k, c) => [
  [1 - k * dt * dt, -dt * (1 - c * dt)],
  [k * dt, 1 - c * dt],
];

// The eigenvalues of a 2 x 2 matrix, as [real, imaginary] each.
function eigenvalues([[a, b], [c, d]]) {
  const square = ((a - d) / 2) ** 2 + b * c;
  const root = Math.sqrt(Math.abs(square));
  const middle = (a + d) / 2;
  return [root, -root].map((part) => (square < 0 ? [middle, part] : [middle + part, 0]));
}

// The heights [r] of the pressed ball, and their times [ms].
const pressed = kept((dt, stiffness, damping, count) => {
  const run = runModel("penalty", scene([(1 - DEPTH) * R]), { dt, stiffness, damping }, count);
  return { xs: Array.from(run.t, (t) => 1000 * t), ys: Array.from(run.y, (y) => y / R - 1) };
});

// The unit circle and the eigenvalues, from `left` on.
function circleOf(pairs, left, width, height) {
  const unit = Math.min(width / 4.8, (height - 50) / 2.4);
  const [x, y] = [left + width - 1.7 * unit, height / 2];
  const least = Math.min(...pairs.map(([real]) => real));
  const at = ([real, imaginary]) => [x + within(-2.8, real, 1.5) * unit, y - imaginary * unit];
  return [
    label("eigenvalues", left + width, 14, "end", "axis-name"),
    line(x - 2.8 * unit, y, x + 1.6 * unit, y, "grid"),
    line(x, y - 1.2 * unit, x, y + 1.2 * unit, "grid"),
    circle(x, y, unit, "rule"),
    label("−1", x - unit - 5, y + 18, "end", "tick"),
    label("1", x + unit + 5, y + 18, "start", "tick"),
    ...pairs.map((pair) => mark("penalty", ...at(pair), 7)),
    least < -2.8 ? label(`← ${number(least)}`, x - 2.8 * unit - 8, y - unit - 8) : "",
  ].join("");
}

function draw(view) {
  const [dt, k, c] = ["dt", "stiffness", "damping"].map(view.get);
  const matrix = stepMatrix(dt, k, c);
  const pairs = eigenvalues(matrix);
  const size = Math.max(...pairs.map((pair) => Math.hypot(...pair)));
  const [left, height] = [Math.round(0.56 * view.width), view.height - TEXT];
  const once = pressed(dt, k, c, 1);
  const [x, y] = [Math.min(1000 * LONGEST, 1000 * dt), Math.min(TOP, once.ys[1])];
  const fine = pressed(FINE, k, c, Math.round(LONGEST / FINE));
  const { svg, sx, sy, box } = plot([0, 0, left, height], {
    x: axis([0, 1000 * LONGEST], "time (ms)", 0, 10, 20, 30),
    y: axis([-0.5, TOP], "height / r", 0, 1),
    lines: [{ model: "exact", ...fine, kind: "thin" }, { model: "penalty", ...once, kind: "law" }],
    rules: [{ y: 0 }],
    points: [{ model: "penalty", x, y, size: 7 }],
  });
  const row = ([a, b], i) =>
    `${"xv"[i]}’ = ${number(a)} x ${b < 0 ? "−" : "+"} ${number(Math.abs(b))} v`;
  const rows = matrix.map((each, i) => label(row(each, i), box.left, view.height - 24 + 20 * i));
  const fate = size < 1 - 1e-9 ? "die away" : size > 1 + 1e-9 ? "grow" : "stay as large";
  const { damped } = criticalDt(1, k, c);
  const text = `dt = ${number(1000 * dt)} ms`;
  const range = { high: LONGEST, step: 0.0005, at: (to) => sx.back(to) / 1000 };
  return {
    svg: svg + circleOf(pairs, left + 16, view.width - left - 16, height) + rows.join(""),
    words:
      `${text}: the larger eigenvalue has size ${number(size)}, so the steps ${fate}; ` +
      `they grow from dt = ${number(1000 * damped)} ms on.`,
    handles: [grip(view, "dt", sx(x), sy(y), "the end of the step", text, range)],
  };
}

export const figure = {
  title: "One long step of a pressed spring",
  caption:
    "One step multiplies place and speed by a matrix: drag its end, and the ball never rests " +
    "once an eigenvalue leaves the circle.",
  height: 310,
  draw,
};
