/* Runs of contact.py's steps, made into JavaScript (to_js.py). A recording has `n` balls, `steps` + 1
 * times t [s], and lists x, y, vx, vy, row by row. */
import { Ball, flights, GRAVITY, implicit_step, soft_defaults, STEP } from "./contact.js";
import { data } from "./data.js";

export const R = data.radius; // m
export const G = -GRAVITY; // m/s^2, and the weight in N of a ball of 1 kg

// Balls at these heights [m]; `more`: x, vx, vy, mass or radius, a number or one for each.
export function column(heights, more = {}) {
  const all = { x: 0, vx: 0, vy: 0, mass: 1, radius: R, ...more };
  const at = (name, i) => (Array.isArray(all[name]) ? all[name][i] : all[name]);
  return heights.map((y, i) =>
    new Ball(at("x", i), y, at("vx", i), at("vy", i), at("mass", i), at("radius", i)));
}

// Softness and target of a spring from after the step, (depth) => [1/kg, m/s].
export function springOf({ dt, stiffness, damping }) {
  const softness = 1 / (stiffness * dt * dt + damping * dt);
  return (depth) => [softness, dt * stiffness * depth * softness];
}

// step(balls) of a model with these knobs, as contact.step_of has it.
function stepOf(model, knobs) {
  const { dt, restitution = 0, solref = null, solimp = null } = knobs;
  if (model === "implicit") return (balls) => implicit_step(balls, dt, springOf(knobs));
  const soft = soft_defaults(restitution, dt, solref, solimp);
  const values = { ...knobs, restitution, solref: soft[0], solimp: soft[1] };
  const taken = data.taken[model].map((name) => values[name]);
  return (balls) => STEP[model](balls, dt, ...taken);
}

// The recording of a model; before each step push(balls) may set forces.
export function record(model, balls, knobs, steps, push = () => {}) {
  const { dt } = knobs;
  const run = { n: balls.length, steps, dt, t: Array.from({ length: steps + 1 }, (_, k) => dt * k) };
  const lists = ["x", "y", "vx", "vy"].map((key) => [key, (run[key] = [])]);
  const write = (states) => { // one zero and one NaN, as contact.py writes them
    for (const state of states)
      for (const [key, list] of lists) list.push(Number.isNaN(state[key]) ? NaN : state[key] + 0);
  };
  if (model === "exact") {
    sample(balls, knobs.restitution ?? 0, run.t, write);
    return run;
  }
  const step = stepOf(model, knobs);
  write(balls);
  for (let row = 1; row <= steps; row++) {
    push(balls);
    step(balls);
    write(balls);
  }
  return run;
}

// The states at these times [s], as contact.exact_run has them.
function sample(balls, restitution, times, write) {
  let [now, row] = [0, 0];
  for (const [flight, a] of flights(balls, restitution)) {
    for (; row < times.length && times[row] < now + flight; row++) {
      const t = times[row] - now;
      write(balls.map(({ x, y, vx, vy }, k) =>
        ({ x, y: y + t * (vy + 0.5 * t * a[k]), vx, vy: vy + t * a[k] })));
    }
    if (row === times.length) return;
    now += flight;
  }
}

// x, y, vx or vy of all balls in a row.
export const inRow = (run, part, row) => run[part].slice(run.n * row, run.n * (row + 1));

// Of a column, in every row, the smallest gap [r]: of ball `upper` to `lower`, or to the table, 0.
export const gapsOf = (run) =>
  run.t.map((_, row) => {
    const ys = inRow(run, "y", row);
    const gaps = ys.flatMap((y, i) => [
      { gap: y / R - 1, upper: i + 1, lower: 0 },
      ...ys.slice(0, i).map((low, k) => ({ gap: Math.abs(y - low) / R - 2, upper: i + 1, lower: k + 1 })),
    ]);
    return gaps.reduce((a, b) => (b.gap >= a.gap ? a : b));
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
      if (held.size > most) held.delete(held.keys().next().value);
      held.set(key, compute(...given));
    }
    return held.get(key);
  };
}
