/* One long step by hand: what it does to place and speed is a 2 x 2 matrix; its eigenvalues say whether
 * the next steps grow. */
import { el, mark, number, plot } from "../draw.js";
import { criticalDt, runModel } from "../engine.js";
import { axis, kept, label, line, R, scene, shift, split, tidy, within } from "../parts.js";

const DEPTH = 0.2; // r: how deep the ball is pressed in
const LONGEST = 0.032; // s
const TOP = 1.8; // r
const FINE = 2e-5; // s

// (x, v) after one step from (x, v), x measured from the table up: mass 1, and the clamp not reached.
export function stepMatrix(dt, k, c) {
  return [
    [1 - k * dt * dt, dt - c * dt * dt],
    [-k * dt, 1 - c * dt],
  ];
}

// The eigenvalues of a 2 x 2 matrix, as [real, imaginary] each.
export function eigenvalues([[a, b], [c, d]]) {
  const [half, square] = [(a + d) / 2, ((a - d) / 2) ** 2 + b * c];
  const root = Math.sqrt(Math.abs(square));
  return square < 0
    ? [[half, root], [half, -root]]
    : [[half + root, 0], [half - root, 0]];
}

const pressed = scene([(1 - DEPTH) * R]);
const spring = kept((stiffness, damping) => runModel("penalty", pressed, { dt: FINE, stiffness, damping }, LONGEST / FINE));
const knobs = (view) => ({ dt: view.get("dt"), stiffness: view.get("stiffness"), damping: view.get("damping") });
const height = (y) => y / R - 1;

function stepChart(view, width, rows) {
  const { dt, stiffness, damping } = knobs(view);
  const fine = spring(stiffness, damping);
  const next = runModel("penalty", pressed, knobs(view), 1);
  const ys = [height(next.y[0]), height(next.y[1])];
  return plot({
    id: "long-step",
    width,
    height: rows,
    x: axis([0, 1000 * LONGEST], "time (ms)", 0, 10, 20, 30),
    y: axis([-0.5, TOP], "height / r", 0, 1),
    lines: [
      { model: "exact", xs: fine.t.map((t) => 1000 * t), ys: Array.from(fine.y, height), class: "thin" },
      { model: "penalty", xs: [0, 1000 * dt], ys, class: "law" },
    ],
    rules: [{ y: 0 }],
    points: [{ model: "penalty", x: 1000 * dt, y: Math.min(TOP, ys[1]), size: 7 }],
  });
}

// The unit circle and the eigenvalues, two units wide at each side.
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

function draw(view) {
  const { dt, stiffness, damping } = knobs(view);
  const [[a, b], [c, d]] = stepMatrix(dt, stiffness, damping);
  const pairs = eigenvalues([[a, b], [c, d]]);
  const size = Math.max(...pairs.map((pair) => Math.hypot(...pair)));
  const { left, right, at } = split(view.width, 0.56, 400);
  const chart = stepChart(view, left, view.height - 56);
  const y = chart.sy(Math.min(TOP, height(runModel("penalty", pressed, knobs(view), 1).y[1])));
  const rows = [[`x’ = ${number(a)} x ${b < 0 ? "−" : "+"} ${number(Math.abs(b))} v`, -24], [`v’ = ${number(c)} x ${d < 0 ? "−" : "+"} ${number(Math.abs(d))} v`, -4]];
  const grows = Math.abs(size - 1) < 1e-9 ? "each step is as large as the last" : size < 1 ? "the steps die away" : "the steps grow";
  const text = `dt = ${number(1000 * dt)} ms`;
  return {
    svg: chart.markup + shift(at, 0, circle(pairs, right, view.height - 56)) + rows.map(([row, up]) => label(row, chart.box.left, view.height + up)).join(""),
    words: `${text}: the larger eigenvalue has size ${number(size)}, so ${grows}; that ends at dt = ${number(1000 * criticalDt(1, stiffness, damping).damped)} ms.`,
    handles: [{ name: "step", x: chart.sx(1000 * Math.min(LONGEST, dt)), y, r: 14, label: "the end of the step", value: dt, text }],
  };
}

export const figure = {
  title: "One long step of a pressed spring",
  caption: "One step multiplies place and speed by a matrix: drag its end, and the ball never rests once an eigenvalue leaves the circle.",
  height: 310,
  uses: ["dt", "stiffness", "damping"],
  shows: { dt: 0.016 },
  draw,
  drag(view, name, x) {
    const { left } = split(view.width, 0.56, 400);
    const { box } = stepChart(view, left, view.height - 56);
    view.set({ dt: within(0.0005, tidy(((x - box.left) / (box.right - box.left)) * LONGEST), LONGEST) });
  },
  nudge: (view, name, dx, dy) => view.set({ dt: within(0.0005, Number((view.get("dt") + 0.0005 * (dx - dy)).toPrecision(3)), LONGEST) }),
};
