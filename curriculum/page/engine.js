/* The contact models of contact.py in plain JavaScript: penalty, lcp and soft; exact is in exact.js.
 *
 * JavaScript numbers are the same 64-bit doubles that Python uses, and + - * / and sqrt are rounded
 * the same way in both. So the three, written here in the same order of operations, give the same
 * trajectories bit for bit; exact agrees with curriculum/exact.py to 1e-10 r. Tests hold both claims.
 *
 * Names and signs are those of contact.py: gap > 0 apart; depth = -gap; n is a unit vector pointing
 * from j to i (the floor is j = -1); v_n > 0 separating; lam >= 0. Units: m, kg, s, N*s.
 *
 * A scene is {x, y, vx, vy, mass, radius, restitution, damping}: arrays with one number a ball.
 * The knobs are {dt, stiffness, damping, restitution, iters, baumgarte, solref, solimp}.
 * A ball of infinite mass is held where it is.
 */

import { run as simulateExact } from "./exact.js";

export const GRAVITY = -9.81;
export const CONTACT_MARGIN = 1e-3;
export const MODELS = ["penalty", "lcp", "soft", "exact"];
export const SOLREF = [0.02, 1]; // MuJoCo's defaults; HARD is the hardest contact it allows
export const SOLIMP = [0.9, 0.95, 0.001, 0.5, 2];
const HARD = [0.9999, 0.9999, 0.001, 0.5, 2];
const MOST_SWEEPS = 10000; // of soft in one step
const LAST_BITS = 2 ** -48; // of soft: a correction below this share of the speeds is rounding

// max(0, a) as Python computes it: what is not greater than zero, NaN included, becomes +0.
const positive = (a) => (a > 0 ? a : 0);

// Floor contacts by body, then pairs i < j: the order is part of the result.
export function detectContacts(x, y, radius, margin) {
  const contacts = [];
  const n = y.length;
  for (let i = 0; i < n; i++) {
    const depth = radius[i] - y[i];
    if (depth > -margin) contacts.push({ i, j: -1, nx: 0, ny: 1, depth });
  }
  for (let i = 0; i < n; i++) {
    for (let j = i + 1; j < n; j++) {
      const dx = x[i] - x[j];
      const dy = y[i] - y[j];
      const dist = Math.sqrt(dx * dx + dy * dy);
      const depth = radius[i] + radius[j] - dist;
      if (!(depth > -margin)) continue;
      const nx = dist > 0 ? dx / dist : 0;
      const ny = dist > 0 ? dy / dist : 1;
      contacts.push({ i, j, nx, ny, depth });
    }
  }
  return contacts;
}

export function normalSpeed(c, vx, vy) {
  const jx = c.j < 0 ? 0 : vx[c.j];
  const jy = c.j < 0 ? 0 : vy[c.j];
  return c.nx * (vx[c.i] - jx) + c.ny * (vy[c.i] - jy);
}

// One step of penalty: a clamped spring and damper a contact, under semi-implicit Euler.
// `trace`, when given, receives what each contact did. knobs.clampForce stands in for the clamp.
export function penaltyStep(state, scene, knobs, trace) {
  const { x, y, vx, vy } = state;
  const { dt, stiffness, damping, clampForce = penaltyNormalForce } = knobs;
  const fx = y.map(() => 0);
  const fy = y.map(() => 0);
  for (const c of detectContacts(x, y, scene.radius, 0)) {
    const speed = normalSpeed(c, vx, vy);
    const f = clampForce(c.depth, speed, stiffness, damping);
    fx[c.i] += f * c.nx;
    fy[c.i] += f * c.ny;
    if (c.j >= 0) {
      fx[c.j] -= f * c.nx;
      fy[c.j] -= f * c.ny;
    }
    if (trace) trace.push({ i: c.i, j: c.j, gap: -c.depth, speed, force: f });
  }
  const held = scene.mass.map((m) => m === Infinity);
  return move(state, dt, {
    vx: vx.map((v, i) => (held[i] ? v : v + dt * (fx[i] / scene.mass[i]))),
    vy: vy.map((v, i) => (held[i] ? v : v + dt * (GRAVITY + fy[i] / scene.mass[i]))),
  });
}

export const penaltyNormalForce = (depth, speed, stiffness, damping) =>
  positive(stiffness * depth - damping * speed);

function move({ x, y }, dt, { vx, vy }) {
  return { x: x.map((a, i) => a + dt * vx[i]), y: y.map((a, i) => a + dt * vy[i]), vx, vy };
}

// ---- lcp and soft: one problem, one sweep

// A contact with its target velocity and its softness (0 for lcp), ready for the sweeps: what an
// impulse of 1 does to its two balls, and the effective mass.
export function makeRows(contacts, mass, targets, softness) {
  return contacts.map((c, k) => {
    const wi = 1 / mass[c.i];
    const wj = c.j < 0 ? 0 : 1 / mass[c.j];
    const mobility = wi + wj;
    const whole = softness[k] > 0 ? mobility + softness[k] : mobility;
    return {
      i: c.i,
      j: c.j,
      nx: c.nx,
      ny: c.ny,
      depth: c.depth,
      target: targets[k],
      softness: softness[k],
      effectiveMass: whole > 0 ? 1 / whole : 0,
      ix: wi * c.nx,
      iy: wi * c.ny,
      jx: wj * c.nx,
      jy: wj * c.ny,
      lam: 0,
    };
  });
}

// Projected Gauss-Seidel. Changes vx, vy and the lam of the rows; stops after a sweep in which no
// correction changed a velocity by more than `tolerance`. `project` is the clamp, on the sum.
export function solveContacts(rows, vx, vy, { iters, tolerance = 0, project = projectImpulse }, trace) {
  for (let sweep = 0; sweep < iters && rows.length; sweep++) {
    let settled = true;
    for (const c of rows) {
      const missing = c.target - normalSpeed(c, vx, vy) - c.softness * c.lam;
      const lam = project(c.lam, missing * c.effectiveMass);
      if (lam === c.lam) continue;
      const change = lam - c.lam;
      push(c, change, vx, vy);
      c.lam = lam;
      if (!(Math.abs(change) <= tolerance * c.effectiveMass)) settled = false;
    }
    if (trace) trace.push(rows.map((c) => c.lam));
    if (settled) break;
  }
}

// The impulse after a correction: the sum may not become negative, a correction may.
export const projectImpulse = (lam, dlam) => positive(lam + dlam);

function push(c, impulse, vx, vy) {
  vx[c.i] += impulse * c.ix;
  vy[c.i] += impulse * c.iy;
  if (c.j < 0) return;
  vx[c.j] -= impulse * c.jx;
  vy[c.j] -= impulse * c.jy;
}

// The largest speed in sight, as soft wants it: of the targets, and of the balls.
function fastest(rows, vx, vy) {
  let most = rows.length ? Math.abs(rows[0].target) : 0;
  const see = (v) => {
    if (Math.abs(v) > most) most = Math.abs(v);
  };
  for (const c of rows) see(c.target);
  vx.forEach((v, i) => {
    see(v);
    see(vy[i]);
  });
  return most;
}

// Gravity predicts the velocities, impulses correct them, the balls move.
function solveStep(state, scene, dt, rows, options, trace) {
  const vx = state.vx.slice();
  const vy = state.vy.map((v, i) => (scene.mass[i] === Infinity ? v : v + dt * GRAVITY));
  if (trace) {
    const told = ({ i, j, depth, target }, speed) => ({ i, j, gap: -depth, speed, target });
    trace.contacts = rows.map((c) => told(c, normalSpeed(c, vx, vy)));
    trace.sweeps = [];
  }
  const { share, ...rest } = options;
  const tolerance = share ? share * fastest(rows, vx, vy) : 0;
  solveContacts(rows, vx, vy, { ...rest, tolerance }, trace && trace.sweeps);
  return move(state, dt, { vx, vy });
}

// The normal velocity with which a contact of lcp must leave at least.
function contactTarget(c, state, { dt, restitution, baumgarte }) {
  const bias = (baumgarte / dt) * c.depth;
  if (restitution === 0) return bias;
  const speed = normalSpeed(c, state.vx, state.vy);
  const bounce = -restitution * speed;
  if (bias > 0) return bounce > bias ? bounce : bias;
  const meets = dt * speed <= c.depth;
  return meets || !(c.depth / dt < bounce) ? bounce : c.depth / dt;
}

// One step of lcp. `trace`, when given, receives the contacts and the impulses after every sweep.
// knobs.target and knobs.project stand in for the target and the clamp.
export function lcpStep(state, scene, knobs, trace) {
  const { dt, iters, project, target = contactTarget } = knobs;
  const contacts = detectContacts(state.x, state.y, scene.radius, CONTACT_MARGIN);
  const targets = contacts.map((c) => target(c, state, knobs));
  const hard = contacts.map(() => 0);
  const rows = makeRows(contacts, scene.mass, targets, hard);
  return solveStep(state, scene, dt, rows, { iters, project }, trace);
}

// ---- soft, MuJoCo's contact

// x to that power; a whole power by products, whose bits are the same in every language.
function raised(x, power) {
  if (power !== Math.trunc(power)) return x ** power;
  let product = 1;
  for (let k = 0; k < power; k++) product *= x;
  return product;
}

// The impedance d of a contact `depth` deep; solimp is [d0, d1, width, mid, power].
export function impedance(depth, [d0, d1, width, mid, power]) {
  if (width <= 1e-15) return 0.5 * (d0 + d1);
  if (depth >= width) return d1;
  const x = depth / width;
  const y =
    x <= mid
      ? raised(x, power) / raised(mid, power - 1)
      : 1 - raised(1 - x, power) / raised(1 - mid, power - 1);
  return d0 + y * (d1 - d0);
}

const between = (low, a, high) => Math.min(Math.max(a, low), high);

// The solref and solimp that a run uses, within MuJoCo's bounds.
export function softDefaults({ restitution, dt, solref, solimp }) {
  if (!solref && restitution > 0) {
    solref = [0, -(1 + restitution) / dt];
    solimp = solimp || HARD;
  } else if (!solref || solref[0] > 0) {
    const [timeconst, dampratio] = solref || SOLREF;
    solref = [Math.max(timeconst, 2 * dt), dampratio];
  }
  const [d0, d1, width, mid, power] = solimp || SOLIMP;
  const share = (a) => between(0.0001, a, 0.9999);
  return { solref, solimp: [share(d0), share(d1), width, share(mid), power] };
}

// K [1/s^2] and B [1/s] of the reference acceleration, from either form of solref.
function springOf([first, second], d1) {
  if (first > 0) return [1 / (d1 * d1 * first * first * second * second), 2 / (d1 * first)];
  return [-first / (d1 * d1), -second / d1];
}

// One step of soft: lcp's step with another target, and softness.
export function softStep(state, scene, knobs, trace) {
  const { dt } = knobs;
  const { solref, solimp } = softDefaults(knobs);
  const [K, B] = springOf(solref, solimp[1]);
  const contacts = detectContacts(state.x, state.y, scene.radius, 0);
  const softness = [];
  const targets = contacts.map((c) => {
    const d = impedance(c.depth, solimp);
    const speed = normalSpeed(c, state.vx, state.vy);
    const mobility = 1 / scene.mass[c.i] + (c.j < 0 ? 0 : 1 / scene.mass[c.j]);
    const soft = ((1 - d) / d) * mobility;
    softness.push(soft > 1e-15 ? soft : 1e-15);
    return speed + dt * (K * d * c.depth - B * speed);
  });
  const rows = makeRows(contacts, scene.mass, targets, softness);
  return solveStep(state, scene, dt, rows, { iters: MOST_SWEEPS, share: LAST_BITS }, trace);
}

export const STEP = { penalty: penaltyStep, lcp: lcpStep, soft: softStep };

// A recording: n balls, steps + 1 rows; x, y, vx, vy are flat, row by row.
function blank(n, dt, steps) {
  const size = (steps + 1) * n;
  const run = { n, dt, steps, t: new Float64Array(steps + 1) };
  for (const key of ["x", "y", "vx", "vy"]) run[key] = new Float64Array(size);
  for (let s = 0; s <= steps; s++) run.t[s] = dt * s;
  return run;
}

function write(run, row, state) {
  for (let i = 0; i < run.n; i++) {
    const at = row * run.n + i;
    run.x[at] = state.x[i] + 0; // -0 becomes 0
    run.y[at] = state.y[i] + 0;
    run.vx[at] = state.vx[i] + 0;
    run.vy[at] = state.vy[i] + 0;
  }
}

export function stateAt(run, row) {
  const part = (a) => Array.from(a.subarray(row * run.n, (row + 1) * run.n));
  return { x: part(run.x), y: part(run.y), vx: part(run.vx), vy: part(run.vy) };
}

const same = (a, b) => ["x", "y", "vx", "vy"].every((key) => a[key].every((v, i) => v === b[key][i]));
const LONGEST = 4; // periods of rest that are noticed: penalty and lcp have 1 and 2, soft up to 4

export function runModel(model, scene, knobs, steps) {
  if (model === "exact") return runExact(scene, knobs, steps);
  const step = STEP[model];
  const run = blank(scene.y.length, knobs.dt, steps);
  let state = { x: scene.x, y: scene.y, vx: scene.vx, vy: scene.vy };
  const before = []; // the last states, the newest first
  write(run, 0, state);
  for (let row = 1; row <= steps; row++) {
    before.unshift(state);
    before.length = Math.min(before.length, LONGEST);
    state = step(state, scene, knobs);
    write(run, row, state);
    // a step depends on the state alone: where one comes back, all that follows is known
    const period = 1 + before.findIndex((old) => same(old, state));
    if (period > 0) return repeat(run, row, period);
  }
  return run;
}

// Fills the rows after `row` with what comes back every `period` rows.
function repeat(run, row, period) {
  for (const key of ["x", "y", "vx", "vy"])
    for (let at = (row + 1) * run.n; at < run[key].length; at++)
      run[key][at] = run[key][at - period * run.n];
  return run;
}

export function runExact(scene, knobs, steps, gravity = -GRAVITY) {
  const run = blank(scene.y.length, knobs.dt, steps);
  run.events = [];
  run.cut = null;
  simulateExact(scene, run.t, gravity, run);
  return run;
}

// ---- measuring, as contact_quality and its neighbours do it

function energyAt(run, scene, row) {
  let sum = 0;
  for (let i = 0; i < run.n; i++) {
    if (scene.mass[i] === Infinity) continue;
    const at = row * run.n + i;
    const speed2 = run.vx[at] * run.vx[at] + run.vy[at] * run.vy[at];
    sum += 0.5 * scene.mass[i] * speed2 - scene.mass[i] * GRAVITY * run.y[at];
  }
  return sum;
}

// The smallest gap [m] to the floor or between two balls; NaN once a ball is nowhere.
function smallestGap(run, scene, row) {
  const { n } = run;
  let least = Infinity;
  const add = (gap) => {
    if (!(gap >= least)) least = gap;
  };
  for (let i = 0; i < n; i++) {
    const at = row * n + i;
    if (Number.isNaN(run.y[at])) return NaN;
    add(run.y[at] - scene.radius[i]);
    for (let j = i + 1; j < n; j++) {
      const dx = run.x[at] - run.x[row * n + j];
      const dy = run.y[at] - run.y[row * n + j];
      add(Math.sqrt(dx * dx + dy * dy) - (scene.radius[i] + scene.radius[j]));
    }
  }
  return least;
}

// The push of the table [N] on all that stands on it, averaged over the step that ends in `row`:
// what changed the momentum and was not gravity.
export function pushOfTable(run, scene, row) {
  let sum = 0;
  for (let i = 0; i < run.n; i++) {
    if (scene.mass[i] === Infinity) continue;
    const change = run.vy[row * run.n + i] - run.vy[(row - 1) * run.n + i];
    sum += scene.mass[i] * (change / run.dt - GRAVITY);
  }
  return Math.abs(sum) < 1e-9 * Math.abs(GRAVITY) ? 0 : sum;
}

// The first row at which surfaces touch, or a velocity shows more than gravity's change.
function firstContact(run, scene) {
  const { n, dt } = run;
  const shows = (v, at, fall) =>
    Math.abs(v[at] - v[at - n] - fall) > 1e-9 * (Math.abs(v[at - n]) + Math.abs(fall));
  for (let row = 0; row <= run.steps; row++) {
    if (smallestGap(run, scene, row) <= 0) return row;
    for (let at = row * n; row > 0 && at < (row + 1) * n; at++) {
      const fall = scene.mass[at - row * n] === Infinity ? 0 : dt * GRAVITY;
      if (shows(run.vx, at, 0) || shows(run.vy, at, fall)) return row;
    }
  }
  return run.steps + 1;
}

// What the charts show, row by row: depth and gap [r], energy over its start, push in weights.
export function series(run, scene) {
  const rows = run.steps + 1;
  const column = () => new Float64Array(rows);
  const found = { gap: column(), depth: column(), energy: column(), push: column() };
  const weight = scene.mass.reduce((sum, m) => sum - (m < Infinity ? m * GRAVITY : 0), 0);
  const start = energyAt(run, scene, 0);
  for (let row = 0; row < rows; row++) {
    const gap = smallestGap(run, scene, row);
    found.gap[row] = gap / scene.radius[0];
    found.depth[row] = Math.max(-gap, 0) / scene.radius[0];
    found.energy[row] = energyAt(run, scene, row) / start;
    if (row > 0) found.push[row] = pushOfTable(run, scene, row) / weight;
  }
  return { ...found, landing: firstContact(run, scene) };
}

const EXPLODED = 10; // times the start energy: more than this gained is an explosion

// The standard deviation of the last quarter.
function jitter(depth) {
  const late = depth.slice(Math.floor((3 * depth.length) / 4));
  const mean = late.reduce((sum, d) => sum + d, 0) / late.length;
  return Math.sqrt(late.reduce((sum, d) => sum + (d - mean) ** 2, 0) / late.length);
}

// The worst height error, in radii, and its parts: before the first contact, and what is added after.
function heightErrors(run, scene, reference, landed) {
  if (!reference) return { height_error_frac: null, flight_error_frac: null, contact_error_frac: null };
  const landing = Math.min(landed, firstContact(reference, scene));
  let [worst, flight] = [0, 0];
  for (let at = 0; at < run.y.length; at++) {
    const error = Math.abs(run.y[at] - reference.y[at]) / scene.radius[0];
    if (error > worst) worst = error;
    if (at < landing * run.n) flight = worst;
  }
  return { height_error_frac: worst, flight_error_frac: flight, contact_error_frac: worst - flight };
}

export function quality(run, scene, reference, known = series(run, scene)) {
  const { gap, depth, energy, landing } = known;
  const start = energyAt(run, scene, 0);
  const sign = start < 0 ? -1 : 1;
  let [deepest, excess, risen, rebound] = [0, 0, 0, 0];
  let blewUpStep = null;
  for (let row = 0; row < depth.length; row++) {
    if (!(depth[row] <= deepest)) deepest = depth[row];
    const above = sign * (energy[row] - 1);
    if (above > excess) excess = above;
    if (blewUpStep === null && !(above < EXPLODED)) blewUpStep = row;
    if (row >= landing && gap[row] > rebound) rebound = gap[row];
    if (row > 0) risen += Math.max(sign * (energy[row] - energy[row - 1]), 0);
  }
  return {
    max_penetration_frac: deepest,
    rest_penetration_frac: depth[depth.length - 1],
    rest_gap_frac: gap[gap.length - 1],
    rebound_frac: rebound,
    rest_jitter: jitter(depth),
    energy_excess: excess,
    contact_energy: risen,
    blew_up: blewUpStep !== null,
    blew_up_step: blewUpStep,
    ...heightErrors(run, scene, reference, landing),
  };
}

// The largest stable dt of penalty's step for a ball kept in contact, with its damper and without.
export function criticalDt(mass, stiffness, damping) {
  const root = Math.sqrt(damping * damping + 4 * mass * stiffness);
  return {
    damped: root + damping > 0 ? (4 * mass) / (root + damping) : Infinity,
    undamped: stiffness > 0 ? 2 * Math.sqrt(mass / stiffness) : Infinity,
  };
}
