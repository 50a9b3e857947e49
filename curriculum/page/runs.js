/* Runs of the steps of contact.py, which are made into JavaScript when the page is built
 * (curriculum/page/to_js.py), so that they have its bits. A recording has `n` balls and
 * `steps` + 1 rows: t [s], and x, y, vx, vy flat, row by row. */
import { accelerations, Ball, detect_contacts, GRAVITY, implicit_step, MAX_IMPACTS } from "./contact.js";
import { next_impact, soft_defaults, solve_impacts, STEP, TOUCH_TOLERANCE } from "./contact.js";
import { data } from "./data.js";

export const MODELS = data.models;
export const R = data.radius; // m
export const G = -GRAVITY; // m/s^2, and the weight in N of a ball of 1 kg
const PARTS = ["x", "y", "vx", "vy"];

// Balls at these heights [m]; `more`: x, vx, vy, mass or radius, a number or one for each.
export function column(heights, more = {}) {
  const all = { x: 0, vx: 0, vy: 0, mass: 1, radius: R, ...more };
  const at = (name, i) => (Array.isArray(all[name]) ? all[name][i] : all[name]);
  return heights.map((y, i) =>
    new Ball(at("x", i), y, at("vx", i), at("vy", i), at("mass", i), at("radius", i)));
}

// step(balls) of a model with these knobs, as contact.step_of has it.
function stepOf(model, knobs) {
  const { dt, restitution = 0, stiffness, damping } = knobs;
  if (model === "implicit") {
    const softness = 1 / (stiffness * dt * dt + damping * dt);
    const spring = (depth) => [softness, dt * stiffness * depth * softness];
    return (balls) => implicit_step(balls, dt, spring);
  }
  const { solref = null, solimp = null } = knobs;
  const soft = soft_defaults(restitution, dt, solref, solimp);
  const values = { ...knobs, restitution, solref: soft[0], solimp: soft[1] };
  const told = data.taken[model].map((name) => values[name]);
  return (balls) => STEP[model](balls, dt, ...told);
}

function blank(n, dt, steps) {
  const run = { n, dt, steps, t: Float64Array.from({ length: steps + 1 }, (_, k) => dt * k) };
  for (const key of PARTS) run[key] = new Float64Array((steps + 1) * n).fill(NaN);
  return run;
}

// One zero and one NaN, as contact.py writes them.
const write = (run, row, balls) =>
  balls.forEach((ball, i) => {
    for (const key of PARTS)
      run[key][row * run.n + i] = Number.isNaN(ball[key]) ? NaN : ball[key] + 0;
  });

// The recording of a model; before each step push(balls) may set forces.
export function record(model, balls, knobs, steps, push = () => {}) {
  const run = blank(balls.length, knobs.dt, steps);
  if (model === "exact") return recordExact(run, balls, knobs.restitution ?? 0);
  const step = stepOf(model, knobs);
  write(run, 0, balls);
  for (let row = 1; row <= steps; row++) {
    push(balls);
    step(balls);
    write(run, row, balls);
  }
  return run;
}

// From one impact to the next, of balls over one another: contact.exact_run.
function recordExact(run, balls, restitution) {
  const pairs = detect_contacts(balls, Infinity);
  let touching = pairs.filter((c) => -c.depth <= TOUCH_TOLERANCE);
  let [now, row] = [0, 0];
  for (let impact = 0; impact < MAX_IMPACTS && row <= run.steps; impact++) {
    solve_impacts(touching, restitution);
    const [a, gaps] = accelerations(balls, touching, pairs);
    const [span, next] = next_impact(pairs, gaps);
    const fly = (t) =>
      balls.map(({ x, y, vx, vy }, k) =>
        ({ x, y: y + t * (vy + 0.5 * t * a[k]), vx, vy: vy + t * a[k] }));
    for (; row <= run.steps && run.t[row] < now + span; row++) write(run, row,
      fly(run.t[row] - now));
    fly(span).forEach((each, k) => Object.assign(balls[k], each));
    [now, touching] = [now + span, next];
  }
  return run;
}

// ---- what is read of a run

// x, y, vx or vy of all balls in a row.
export const inRow = (run, part, row) =>
  Array.from(run[part].subarray(run.n * row, run.n * (row + 1)));

// Of every row the smallest gap [r], and whose it is: that of ball `upper` to `lower`, or the table.
export const gapsOf = (run) =>
  Array.from(run.t, (_, row) => {
    const [xs, ys] = [inRow(run, "x", row), inRow(run, "y", row)];
    let least = { gap: Infinity };
    const see = (gap, upper, lower) => {
      if (!(gap >= least.gap)) least = { gap, upper, lower };
    };
    ys.forEach((y, i) => {
      see(y / R - 1, i + 1, 0);
      for (let k = 0; k < i; k++) see(Math.hypot(xs[i] - xs[k], y - ys[k]) / R - 2, i + 1, k + 1);
    });
    return least;
  });

// The push of the table [m g] on balls of 1 kg, in the step that ends in a row: what changed their
// momentum and was not gravity.
export function pushIn({ n, dt, vy }, row) {
  let sum = 0;
  for (let i = row * n; row > 0 && i < (row + 1) * n; i++) sum += (vy[i] - vy[i - n]) / dt + G;
  return Math.abs(sum) < 1e-9 * G ? 0 : sum / n / G;
}

// A function that keeps its last results, by its arguments.
export function kept(compute, most = 20) {
  const held = new Map();
  return (...given) => {
    const key = JSON.stringify(given);
    if (!held.has(key)) {
      if (held.size > most) held.clear();
      held.set(key, compute(...given));
    }
    return held.get(key);
  };
}
