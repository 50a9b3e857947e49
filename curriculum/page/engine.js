/* The contact models of contact.py in plain JavaScript; exact is in exact.js.
 *
 * JavaScript's numbers are the doubles that Python uses, and + - * / and sqrt are rounded the same way
 * in both. Written in the same order of operations, penalty, lcp and soft give the same trajectories
 * bit for bit; exact agrees to 1e-10 r. Tests hold both claims.
 *
 * Names and signs are those of contact.py; the floor is j = -1. A scene is {x, y, vx, vy, mass, radius,
 * restitution, damping}, arrays with one number a ball; a state is {x, y, vx, vy}, and of soft, pushed.
 * The knobs are {dt, stiffness, damping, restitution, iters, baumgarte, warm, solref, solimp}.
 */
import { data } from "./data.js";
import { run as simulateExact } from "./exact.js";

const { CONTACT_MARGIN, SOLREF, SOLIMP, HARD, MOST_SWEEPS, LAST_BITS, EXPLODED } = data.engine;
export const GRAVITY = data.engine.GRAVITY;
export const MODELS = ["penalty", "lcp", "soft", "exact"];

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
      contacts.push({ i, j, nx: dist > 0 ? dx / dist : 0, ny: dist > 0 ? dy / dist : 1, depth });
    }
  }
  return contacts;
}

export function normalSpeed(c, vx, vy) {
  const jx = c.j < 0 ? 0 : vx[c.j];
  const jy = c.j < 0 ? 0 : vy[c.j];
  return c.nx * (vx[c.i] - jx) + c.ny * (vy[c.i] - jy);
}

const accelerated = (vy, mass, dt, fy) =>
  vy.map((v, i) => (mass[i] === Infinity ? v : v + dt * (GRAVITY + (fy ? fy[i] / mass[i] : 0))));

function move({ x, y }, dt, vx, vy) {
  return { x: x.map((a, i) => a + dt * vx[i]), y: y.map((a, i) => a + dt * vy[i]), vx, vy };
}

// ---- penalty

const penaltyNormalForce = (depth, speed, stiffness, damping) =>
  positive(stiffness * depth - damping * speed);

// One step of penalty. knobs.clampForce stands in for the clamped force.
export function penaltyStep(state, scene, knobs) {
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
  }
  const { mass } = scene;
  const faster = vx.map((v, i) => (mass[i] === Infinity ? v : v + dt * (fx[i] / mass[i])));
  return move(state, dt, faster, accelerated(vy, mass, dt, fy));
}

// ---- lcp and soft: one problem, one sweep

// A contact with its target velocity and its softness (0 for lcp), ready for the sweeps: what an
// impulse of 1 does to its two balls, and the effective mass.
export function makeRows(contacts, mass, targets, softness) {
  return contacts.map((c, k) => {
    const wi = 1 / mass[c.i];
    const wj = c.j < 0 ? 0 : 1 / mass[c.j];
    const whole = softness[k] > 0 ? wi + wj + softness[k] : wi + wj;
    return {
      ...c,
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

// The impulse after a correction: the sum may not become negative, a correction may.
export const projectImpulse = (lam, dlam) => positive(lam + dlam);

// Projected Gauss-Seidel. Changes vx, vy and the lam of the rows; returns whether it settled. `project`
// stands in for the clamp.
export function solveContacts(rows, vx, vy, { iters, tolerance = 0, project = projectImpulse }) {
  for (let sweep = 0; sweep < iters; sweep++) {
    let settled = true;
    for (const c of rows) {
      const missing = c.target - normalSpeed(c, vx, vy) - c.softness * c.lam;
      const lam = project(c.lam, missing * c.effectiveMass);
      const change = lam - c.lam;
      push(c, change, vx, vy);
      c.lam = lam;
      settled = settled && Math.abs(change) <= tolerance * c.effectiveMass;
    }
    if (settled) return true;
  }
  return false;
}

function push(c, impulse, vx, vy) {
  vx[c.i] += impulse * c.ix;
  vy[c.i] += impulse * c.iy;
  if (c.j < 0) return;
  vx[c.j] -= impulse * c.jx;
  vy[c.j] -= impulse * c.jy;
}

// Begin with a share of the impulses that the same balls gave each other in the step before.
function warmStart(rows, pushed, share, vx, vy) {
  for (const c of rows) {
    const last = pushed && pushed.find(({ i, j }) => i === c.i && j === c.j);
    c.lam = share * (last ? last.lam : 0);
    push(c, c.lam, vx, vy);
  }
}

// Gravity predicts the velocities, impulses correct them, the balls move.
function solveStep(state, scene, dt, rows, { warm, last, ...options }) {
  const vx = state.vx.slice();
  const vy = accelerated(state.vy, scene.mass, dt);
  const tolerance = last ? last * fastest(rows, vx, vy) : 0;
  if (warm) warmStart(rows, state.pushed, warm, vx, vy);
  const settled = solveContacts(rows, vx, vy, { ...options, tolerance });
  const next = move(state, dt, vx, vy);
  next.settled = settled;
  if (warm && rows.length) next.pushed = rows.map(({ i, j, lam }) => ({ i, j, lam }));
  return next;
}

// The largest speed in sight: of the targets, and of the balls.
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

// One step of lcp. knobs.project stands in for the clamp.
export function lcpStep(state, scene, knobs) {
  const { dt, iters, warm, project } = knobs;
  const contacts = detectContacts(state.x, state.y, scene.radius, CONTACT_MARGIN);
  const targets = contacts.map((c) => contactTarget(c, state, knobs));
  const hard = contacts.map(() => 0);
  return solveStep(state, scene, dt, makeRows(contacts, scene.mass, targets, hard), { iters, project, warm });
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
  const rise = x <= mid ? raised(x, power) / raised(mid, power - 1) : 1 - raised(1 - x, power) / raised(1 - mid, power - 1);
  return d0 + rise * (d1 - d0);
}

const share = (a) => Math.min(Math.max(a, 0.0001), 0.9999);

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
  return { solref, solimp: [share(d0), share(d1), width, share(mid), Math.max(power, 1)] };
}

// K [1/s^2] and B [1/s] of the reference acceleration, from either form of solref.
function springOf([first, second], d1) {
  if (first > 0) return [1 / (d1 * d1 * first * first * second * second), 2 / (d1 * first)];
  return [-first / (d1 * d1), -second / d1];
}

// The target and the softness of a contact of soft.
export function soften(c, state, scene, knobs) {
  const { solref, solimp } = softDefaults(knobs);
  const [K, B] = springOf(solref, solimp[1]);
  const d = impedance(c.depth, solimp);
  const speed = normalSpeed(c, state.vx, state.vy);
  const soft = ((1 - d) / d) * (1 / scene.mass[c.i] + (c.j < 0 ? 0 : 1 / scene.mass[c.j]));
  return { target: speed + knobs.dt * (K * d * c.depth - B * speed), softness: soft > 1e-15 ? soft : 1e-15 };
}

// One step of soft: lcp's step with another target, and softness.
export function softStep(state, scene, knobs) {
  const contacts = detectContacts(state.x, state.y, scene.radius, 0);
  const soft = contacts.map((c) => soften(c, state, scene, knobs));
  const rows = makeRows(
    contacts,
    scene.mass,
    soft.map((each) => each.target),
    soft.map((each) => each.softness),
  );
  return solveStep(state, scene, knobs.dt, rows, { iters: MOST_SWEEPS, last: LAST_BITS, warm: 1 });
}

// ---- runs

const STEP = { penalty: penaltyStep, lcp: lcpStep, soft: softStep };
const PARTS = ["x", "y", "vx", "vy"];

// A recording: n balls, steps + 1 rows; x, y, vx, vy are flat, row by row.
function blank(n, dt, steps) {
  const run = { n, dt, steps, unsettled: 0, t: new Float64Array(steps + 1) };
  for (const key of PARTS) run[key] = new Float64Array((steps + 1) * n);
  for (let s = 0; s <= steps; s++) run.t[s] = dt * s;
  return run;
}

function write(run, row, state) {
  for (const key of PARTS) for (let i = 0; i < run.n; i++) run[key][row * run.n + i] = state[key][i] + 0; // no -0
}

export function stateAt(run, row) {
  const part = (key) => Array.from(run[key].subarray(row * run.n, (row + 1) * run.n));
  return Object.fromEntries(PARTS.map((key) => [key, part(key)]));
}

const alike = ({ pushed: a = [] }, { pushed: b = [] }) =>
  a.length === b.length && a.every((c, k) => c.i === b[k].i && c.j === b[k].j && c.lam === b[k].lam);
const same = (a, b) => PARTS.every((key) => a[key].every((v, i) => v === b[key][i])) && alike(a, b);
const LONGEST = 4; // periods of rest that are noticed: penalty and lcp have 1 and 2, soft up to 4

export function runModel(model, scene, knobs, steps) {
  if (model === "exact") return runExact(scene, knobs, steps);
  const run = blank(scene.y.length, knobs.dt, steps);
  let state = scene;
  const before = []; // the last states, the newest first
  write(run, 0, state);
  for (let row = 1; row <= steps; row++) {
    before.unshift(state);
    before.length = Math.min(before.length, LONGEST);
    state = STEP[model](state, scene, knobs);
    if (state.settled === false) run.unsettled++;
    write(run, row, state);
    // a step depends on the state and its impulses alone: where they come back, all else is known
    const period = 1 + before.findIndex((old) => same(old, state));
    if (period > 0) return repeat(run, row, period);
  }
  return run;
}

// Fills the rows after `row` with what comes back every `period` rows.
function repeat(run, row, period) {
  for (const key of PARTS)
    for (let at = (row + 1) * run.n; at < run[key].length; at++) run[key][at] = run[key][at - period * run.n];
  return run;
}

export function runExact(scene, knobs, steps, gravity = -GRAVITY) {
  const run = blank(scene.y.length, knobs.dt, steps);
  Object.assign(run, { events: [], cut: null });
  simulateExact(scene, run.t, gravity, run, react);
  return run;
}

// Brings contacts to their targets by impulses, swept until only rounding is left; changes vx, vy. With
// accelerations in place of velocities the impulses are forces. `both`: a contact may pull as well.
function react(mass, contacts, targets, vx, vy, both) {
  const rows = makeRows(contacts, mass, targets, targets.map(() => 0));
  let most = 0;
  for (const c of rows) most = Math.max(most, Math.abs(c.target), Math.abs(normalSpeed(c, vx, vy)));
  const project = both ? (lam, dlam) => lam + dlam : undefined;
  solveContacts(rows, vx, vy, { iters: 1e5, tolerance: 2 ** -52 * most, project });
  return rows.map((c) => c.lam);
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
function smallestGap(run, { radius }, row) {
  const { n, x, y } = run;
  let least = Infinity;
  for (let i = 0; i < n; i++) {
    const at = row * n + i;
    if (Number.isNaN(y[at])) return NaN;
    least = Math.min(least, y[at] - radius[i]);
    for (let j = i + 1; j < n; j++) {
      const dx = x[at] - x[row * n + j];
      const dy = y[at] - y[row * n + j];
      least = Math.min(least, Math.sqrt(dx * dx + dy * dy) - (radius[i] + radius[j]));
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

// Row by row: gap [r], energy over its start, push in weights; and the row of the landing.
export function series(run, scene) {
  const rows = run.steps + 1;
  const found = { gap: new Float64Array(rows), energy: new Float64Array(rows), push: new Float64Array(rows) };
  const weight = scene.mass.reduce((sum, m) => sum - (m < Infinity ? m * GRAVITY : 0), 0);
  const start = energyAt(run, scene, 0);
  let landing = rows;
  for (let row = 0; row < rows; row++) {
    found.gap[row] = smallestGap(run, scene, row) / scene.radius[0];
    found.energy[row] = energyAt(run, scene, row) / start;
    if (row > 0) found.push[row] = pushOfTable(run, scene, row) / weight;
    if (landing === rows && (found.gap[row] <= 0 || found.push[row] > 1e-9)) landing = row;
  }
  return { ...found, landing };
}

// The most energy above the start, in starts; whether the run exploded.
export function quality(run, scene) {
  const { energy } = series(run, scene);
  const excess = energy.reduce((most, each) => (each - 1 <= most ? most : each - 1), 0);
  return { energy_excess: excess, blew_up: !(excess < EXPLODED) };
}

// The largest stable dt of penalty's step for a ball kept in contact, with its damper and without.
export function criticalDt(mass, stiffness, damping) {
  const root = Math.sqrt(damping * damping + 4 * mass * stiffness);
  return {
    damped: root + damping > 0 ? (4 * mass) / (root + damping) : Infinity,
    undamped: stiffness > 0 ? 2 * Math.sqrt(mass / stiffness) : Infinity,
  };
}
