/* Runs of the steps of contact.py, which are made into JavaScript when the page is built
 * (curriculum/page/to_js.py), so that they have its bits. A recording has `n` balls and
 * `steps` + 1 rows: t [s], and x, y, vx, vy flat, row by row. */
import { Ball, Contact, FLOOR, GRAVITY, MAX_IMPACTS, STEP, TOUCH_TOLERANCE } from "./contact.js";
import { accelerations, detect_contacts, next_impact, soft_defaults, solve_impacts } from "./contact.js";
import { implicit_step, solve_contacts } from "./contact.js";
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

// The smallest gap [r] of every row, to the table or between two balls.
export const gapsOf = (run) =>
  Array.from(run.t, (_, row) => {
    const balls = column(inRow(run, "y", row), { x: inRow(run, "x", row) });
    return -Math.max(...detect_contacts(balls, Infinity).map(({ depth }) => depth)) / R;
  });

// The push of the table [m g] on balls of 1 kg, in the step that ends in a row: what changed their
// momentum and was not gravity.
export function pushIn({ n, dt, vy }, row) {
  let sum = 0;
  for (let i = row * n; row > 0 && i < (row + 1) * n; i++) sum += (vy[i] - vy[i - n]) / dt + G;
  return Math.abs(sum) < 1e-9 * G ? 0 : sum / n / G;
}

// The most energy above the start, in starts, of a falling ball; NaN counts as without end.
export function gainOf({ y, vy }) {
  const energy = (row) => 0.5 * vy[row] ** 2 + G * y[row];
  const most = vy.reduce((high, _, row) => (energy(row) <= high ? high : energy(row)), 0);
  return Number.isNaN(most) ? Infinity : most / energy(0) - 1;
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

// ---- a column swept contact after contact

// The contacts of balls of these masses over one another, from below, with impulses and speeds.
export function stacked(masses, lam, vy) {
  const balls = column(masses.map((_, i) => (2 * i + 1) * R), { mass: masses, vy });
  return balls.map((ball, i) =>
    Object.assign(new Contact(ball, i ? balls[i - 1] : FLOOR, 0, 1, 0), { lam: lam[i] }));
}

/* What single visits do, from below and again: [{contact, wanted, lam, vy}], where `wanted` is the
 * change before the clamp; first what they start with. */
export function visits(masses, lam, vy, count) {
  const contacts = stacked(masses, lam, vy);
  const now = () => ({ lam: contacts.map((c) => c.lam), vy: contacts.map(({ a }) => a.vy) });
  const seen = [{ contact: null, wanted: 0, ...now() }];
  for (let at = 0; at < count; at++) {
    const contact = at % contacts.length;
    const wanted = -contacts[contact].v_n() * contacts[contact].m_eff;
    solve_contacts([contacts[contact]], 1);
    seen.push({ contact, wanted, ...now() });
  }
  return seen;
}
