/* The contact models of contact.py in plain JavaScript.
 *
 * JavaScript's numbers are the doubles that Python uses, and + - * / and sqrt are rounded the same
 * way in both. Written in the same order of operations, all models that step give the same
 * trajectories bit for bit; exact agrees to 1e-10 r. Tests hold both claims.
 *
 * Names and signs are those of contact.py; the floor is j = -1. A scene is {x, y, vx, vy, mass,
 * radius, restitution, damping}, arrays with one number a ball; a state is {x, y, vx, vy}, and of
 * soft, pushed. The knobs are {dt, stiffness, damping, restitution, iters, baumgarte, warm, solref,
 * solimp}. */
import { data } from "./data.js";

const { CONTACT_MARGIN, SOLREF, SOLIMP, HARD, MOST_SWEEPS, LAST_BITS, EXPLODED } = data.engine;
const { TOUCH, SLOW, TOGETHER, STILL, MOST_IMPACTS } = data.engine; // of exact
const { OPENS } = data.engine; // of leapfrog
export const GRAVITY = data.engine.GRAVITY;
export const MODELS = data.models;

// max and min as Python computes them: what is not greater or less, NaN included, does not count.
const greatest = (numbers) => numbers.reduce((most, v) => (v > most ? v : most));
const least = (a, b) => (b < a ? b : a);
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
      const [nx, ny] = dist > 0 ? [dx / dist, dy / dist] : [0, 1];
      if (depth > -margin) contacts.push({ i, j, nx, ny, depth });
    }
  }
  return contacts;
}

export function normalSpeed(c, vx, vy) {
  const jx = c.j < 0 ? 0 : vx[c.j];
  const jy = c.j < 0 ? 0 : vy[c.j];
  return c.nx * (vx[c.i] - jx) + c.ny * (vy[c.i] - jy);
}

const fall = (vy, mass, dt) => vy.map((v, i) => (mass[i] < Infinity ? v + dt * GRAVITY : v));

function move({ x, y }, dt, vx, vy) {
  return { x: x.map((a, i) => a + dt * vx[i]), y: y.map((a, i) => a + dt * vy[i]), vx, vy };
}

// Motors push balls sideways [N].
const drive = (vx, mass, dt, motor = []) =>
  vx.map((v, i) => (mass[i] < Infinity ? v + dt * ((motor[i] ?? 0) / mass[i]) : v));

// ---- penalty

const penaltyNormalForce = (depth, speed, stiffness, damping) =>
  positive(stiffness * depth - damping * speed);

// One step of penalty.
function penaltyStep(state, { mass, radius, motor = [] }, knobs) {
  const { x, y, vx, vy } = state;
  const { dt, stiffness, damping } = knobs;
  const fx = y.map((_, i) => motor[i] ?? 0);
  const fy = y.map(() => 0);
  for (const c of detectContacts(x, y, radius, 0)) {
    const f = penaltyNormalForce(c.depth, normalSpeed(c, vx, vy), stiffness, damping);
    fx[c.i] += f * c.nx;
    fy[c.i] += f * c.ny;
    if (c.j < 0) continue;
    fx[c.j] -= f * c.nx;
    fy[c.j] -= f * c.ny;
  }
  const faster = (v, i, a) => (mass[i] < Infinity ? v + dt * a : v);
  const nextX = vx.map((v, i) => faster(v, i, fx[i] / mass[i]));
  const nextY = vy.map((v, i) => faster(v, i, GRAVITY + fy[i] / mass[i]));
  return move(state, dt, nextX, nextY);
}

// The same with the force from the end of the step: lcp's sweep with a softness.
function implicitStep(state, { mass, radius, motor }, { dt, stiffness, damping }) {
  const softness = 1 / (stiffness * dt * dt + damping * dt);
  const contacts = detectContacts(state.x, state.y, radius, 0);
  for (const c of contacts)
    Object.assign(c, { softness, target: dt * stiffness * c.depth * softness });
  const driven = { ...state, vx: drive(state.vx, mass, dt, motor) };
  return solveStep(driven, mass, dt, contacts, { iters: 100 });
}

// ---- lcp and soft: one problem, one sweep

// Contacts ready for the sweeps: what an impulse of 1 does to two balls, and the effective mass.
// One may have a target velocity and a softness, which lcp has not.
export function makeRows(contacts, mass) {
  return contacts.map(({ target = 0, softness = 0, ...c }) => {
    const wi = 1 / mass[c.i];
    const wj = c.j < 0 ? 0 : 1 / mass[c.j];
    const whole = wi + wj + softness;
    const effectiveMass = whole > 0 ? 1 / whole : 0;
    return turned({ ...c, target, softness, effectiveMass, wi, wj, lam: 0 }, c.nx, c.ny);
  });
}

// The row with this normal, along which a push acts.
const turned = (c, nx, ny) =>
  Object.assign(c, { nx, ny, ix: c.wi * nx, iy: c.wi * ny, jx: c.wj * nx, jy: c.wj * ny });

// The impulse after a correction: the sum may not become negative, a correction may.
export const projectImpulse = (lam, dlam) => positive(lam + dlam);

/* Projected Gauss-Seidel: changes vx, vy and the rows' lam. Returns the number of the sweep that
 * settled, 0 if none did. `project` stands in for the clamp. */
export function solveContacts(rows, vx, vy, { iters, tolerance = 0, project = projectImpulse }) {
  for (let sweep = 1; sweep <= iters; sweep++) {
    let settled = true;
    for (const c of rows) {
      const missing = c.target - normalSpeed(c, vx, vy) - c.softness * c.lam;
      const lam = project(c.lam, missing * c.effectiveMass);
      const change = lam - c.lam;
      push(c, change, vx, vy);
      c.lam = lam;
      settled = settled && Math.abs(change) <= tolerance * c.effectiveMass;
    }
    if (settled) return sweep;
  }
  return 0;
}

// The same in fewer sweeps: each is carried on by a share of its change, until one turns back.
export function solveWithMomentum(rows, vx, vy, { iters, tolerance = 0 }) {
  let t = 1;
  for (const c of rows) c.start = c.before = c.lam;
  for (let sweep = 1; sweep <= iters; sweep++) {
    if (solveContacts(rows, vx, vy, { iters: 1, tolerance })) return sweep;
    let onward = 0;
    for (const c of rows) onward += (c.lam - c.start) * (c.lam - c.before);
    if (onward < 0) t = 1;
    const longer = 0.5 * (1 + Math.sqrt(1 + 4 * t * t));
    const share = (t - 1) / longer;
    t = longer;
    for (const c of rows) {
      c.start = positive(c.lam + share * (c.lam - c.before));
      c.before = c.lam;
      push(c, c.start - c.lam, vx, vy);
      c.lam = c.start;
    }
  }
  return 0;
}

function push(c, impulse, vx, vy) {
  vx[c.i] += impulse * c.ix;
  vy[c.i] += impulse * c.iy;
  if (c.j < 0) return;
  vx[c.j] -= impulse * c.jx;
  vy[c.j] -= impulse * c.jy;
}

// Begin with a share of the impulses that the same balls gave each other in the step before.
function warmStart(rows, pushed = [], share, vx, vy) {
  for (const c of rows) {
    const last = pushed.find(({ i, j }) => i === c.i && j === c.j);
    c.lam = share * (last ? last.lam : 0);
    push(c, c.lam, vx, vy);
  }
}

// Gravity predicts the velocities, impulses correct them, the balls move.
function solveStep(state, mass, dt, contacts, { warm, last = 0, see = () => {}, ...options }) {
  const rows = makeRows(contacts, mass);
  const vx = state.vx.slice();
  const vy = fall(state.vy, mass, dt);
  const fastest = last && greatest([...rows.map((c) => c.target), ...vx, ...vy].map(Math.abs));
  see({ ...state, vx: vx.slice(), vy: vy.slice() });
  if (warm) warmStart(rows, state.pushed, warm, vx, vy);
  solveContacts(rows, vx, vy, { ...options, tolerance: last && last * fastest });
  see({ ...state, vx, vy });
  const pushed = warm ? rows.map(({ i, j, lam }) => ({ i, j, lam })) : [];
  const moved = { ...move(state, dt, vx, vy), pushed };
  see(moved);
  return moved;
}

// The normal velocity with which a contact of lcp must leave at least.
function contactTarget(c, state, { dt, restitution, baumgarte }) {
  const closing = c.depth / dt; // gap + dt v_n = 0 at the end of the step
  const bias = (baumgarte / dt) * c.depth;
  if (restitution === 0) return bias;
  const speed = normalSpeed(c, state.vx, state.vy);
  const bounce = -restitution * speed;
  if (bias > 0) return greatest([bias, bounce]);
  return -dt * speed >= -c.depth ? bounce : least(bounce, closing);
}

// One step of lcp; knobs.see as for leapfrog.
function lcpStep(state, { mass, radius }, knobs) {
  const { dt, iters, warm, see } = knobs;
  const contacts = detectContacts(state.x, state.y, radius, CONTACT_MARGIN);
  for (const c of contacts) c.target = contactTarget(c, state, knobs);
  return solveStep(state, mass, dt, contacts, { iters, warm, see });
}

// ---- leapfrog: the sweep twice a step, for the way and for the speed

// How far two balls come towards each other in a step, both as fast as the fastest gets.
function stepReach({ vx, vy }, dt) {
  const fastest = greatest([0, ...vx.map((v, i) => Math.sqrt(v * v + vy[i] * vy[i]))]);
  return greatest([CONTACT_MARGIN, 2 * dt * (fastest - dt * GRAVITY)]);
}

// The normal of when two balls meet in free flight, or are nearest, within dt; the depth of now.
function turn(c, { x, y, vx, vy }, radius, dt) {
  if (c.j < 0) return;
  const [dx, dy] = [x[c.i] - x[c.j], y[c.i] - y[c.j]];
  const [sx, sy] = [vx[c.i] - vx[c.j], vy[c.i] - vy[c.j]];
  const reach = radius[c.i] + radius[c.j];
  const along = dx * sx + dy * sy;
  const fast = sx * sx + sy * sy;
  const apart = dx * dx + dy * dy - reach * reach;
  const meet = () => (-along - Math.sqrt(positive(along * along - fast * apart))) / fast;
  const comes = apart > 0 && 0 > along;
  const t = comes ? (fast > 0 ? least(dt, meet()) : dt) : 0;
  const [toX, toY] = [dx + t * sx, dy + t * sy];
  const distance = Math.sqrt(toX * toX + toY * toY);
  if (!(distance > 0)) return;
  turned(c, toX / distance, toY / distance);
  c.depth = reach - (c.nx * dx + c.ny * dy);
}

// What leapfrog asks of a contact: `target` of the way, `after` of the speed; whether it `hits`.
function ask(c, state, radius, { dt, restitution }) {
  turn(c, state, radius, dt);
  const [gap, speed] = [-c.depth, normalSpeed(c, state.vx, state.vy)];
  const a = GRAVITY * c.ny * ((c.wi > 0) - (c.wj > 0));
  const when = gap > 0 ? timeToImpact(gap, speed, a) : 0;
  const hit = when < dt ? speed + when * a : 0;
  const back = -restitution * (speed + dt * a);
  const left = dt - when;
  const end = left * (-restitution * hit + 0.5 * left * a);
  c.hits = hit < dt * GRAVITY;
  c.stays = least(-gap, OPENS * (radius[c.i] + (c.j < 0 ? 0 : radius[c.j]))) / dt;
  c.free = !c.hits && c.stays < speed + dt * GRAVITY; // would stay open, were it alone
  c.target = c.stays;
  const fast = speed < dt * GRAVITY && !c.hits; // meets only what cannot fall away
  c.after = fast ? back : least(0, back);
  if (!c.hits || !(end > 0)) return;
  c.target = greatest([c.target, (end - greatest([gap, 0])) / dt]);
  c.after = least(-restitution * hit + left * a, back);
}

// Takes back the way of each bounce that drove a ball into one it would not have met.
function noRoom(rows) {
  const pushing = rows.filter((c) => c.lam > 0);
  const crowd = new Set();
  const join = (c) => {
    if (c.wi > 0) crowd.add(c.i);
    if (c.wj > 0) crowd.add(c.j);
  };
  pushing.filter((c) => c.free).forEach(join);
  for (let known = 0; known < crowd.size; ) {
    known = crowd.size;
    pushing.filter((c) => crowd.has(c.i) || crowd.has(c.j)).forEach(join);
  }
  const bounces = rows.filter((c) => c.target > c.stays && (crowd.has(c.i) || crowd.has(c.j)));
  for (const c of bounces) c.target = c.stays;
  return bounces.length > 0;
}

// One step of leapfrog. knobs.see is shown the state after each of its parts.
function leapfrogStep(state, { mass, radius }, knobs) {
  const { dt, iters, restitution, see = () => {} } = knobs;
  const rows = makeRows(detectContacts(state.x, state.y, radius, stepReach(state, dt)), mass);
  for (const c of rows) ask(c, state, radius, knobs);
  let [vx, vy] = [state.vx.slice(), fall(state.vy, mass, 0.5 * dt)];
  const before = { vx: vx.slice(), vy: vy.slice() };
  see({ ...state, vx: vx.slice(), vy: vy.slice() });
  solveWithMomentum(rows, vx, vy, { iters });
  if (noRoom(rows)) {
    ({ vx, vy } = before);
    for (const c of rows) c.lam = 0;
    solveWithMomentum(rows, vx, vy, { iters });
  }
  see({ ...state, vx, vy });
  const moved = move(state, dt, vx, vy);
  see(moved);
  const next = { ...moved, vx: vx.slice(), vy: fall(vy, mass, 0.5 * dt) };
  see({ ...next, vx: next.vx.slice(), vy: next.vy.slice() });
  const closed = rows.filter((c) => c.lam > 0);
  const bounces = closed.filter((c) => c.hits && restitution > 0);
  const struck = new Set(bounces.flatMap(({ i, j }) => [i, j]));
  for (const c of closed) {
    if (!(c.hits || struck.has(c.i) || struck.has(c.j))) turn(c, next, radius, 0);
    c.target = c.after;
  }
  solveWithMomentum(closed, next.vx, next.vy, { iters });
  see(next);
  return next;
}

// ---- soft, MuJoCo's contact

// x to that power; a whole one by products, which are rounded here as in Python: `**` need not be.
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
  const half = (share, middle) => raised(share, power) / raised(middle, power - 1);
  return d0 + (x <= mid ? half(x, mid) : 1 - half(1 - x, 1 - mid)) * (d1 - d0);
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
export function soften(c, state, { mass }, knobs) {
  const { solref, solimp } = softDefaults(knobs);
  const [K, B] = springOf(solref, solimp[1]);
  const d = impedance(c.depth, solimp);
  const speed = normalSpeed(c, state.vx, state.vy);
  const softness = ((1 - d) / d) * (1 / mass[c.i] + (c.j < 0 ? 0 : 1 / mass[c.j]));
  const target = speed + knobs.dt * (K * d * c.depth - B * speed);
  return { target, softness: greatest([1e-15, softness]) };
}

// One step of soft: lcp's step with another target, and softness.
function softStep(state, { mass, radius }, knobs) {
  const contacts = detectContacts(state.x, state.y, radius, 0);
  for (const c of contacts) Object.assign(c, soften(c, state, { mass }, knobs));
  const options = { iters: MOST_SWEEPS, last: LAST_BITS, warm: 1 };
  return solveStep(state, mass, knobs.dt, contacts, options);
}

// ---- runs

export const STEP = {
  penalty: penaltyStep, implicit: implicitStep,
  lcp: lcpStep, leapfrog: leapfrogStep, soft: softStep,
};
const PARTS = ["x", "y", "vx", "vy"];

// A recording: n balls, steps + 1 rows; x, y, vx, vy are flat, row by row.
function blank(n, dt, steps) {
  const t = Float64Array.from({ length: steps + 1 }, (_, k) => dt * k);
  const run = { n, dt, steps, t };
  for (const key of PARTS) run[key] = new Float64Array((steps + 1) * n).fill(NaN);
  return run;
}

function write(run, row, state) {
  for (const key of PARTS)
    for (let i = 0; i < run.n; i++) {
      const value = state[key][i];
      run[key][row * run.n + i] = value === value ? value + 0 : NaN; // one zero and one NaN
    }
}

export function stateAt(run, row) {
  const part = (key) => Array.from(run[key].subarray(row * run.n, (row + 1) * run.n));
  return Object.fromEntries(PARTS.map((key) => [key, part(key)]));
}

const alike = ({ pushed: a = [] }, { pushed: b = [] }) =>
  a.length === b.length &&
  a.every((c, k) => c.i === b[k].i && c.j === b[k].j && c.lam === b[k].lam);
const same = (a, b) =>
  PARTS.every((key) => a[key].every((v, i) => v === b[key][i])) && alike(a, b);
const SAVED = 64; // rows from one state that is kept to the next: the longest rest that is noticed

export function runModel(model, scene, knobs, steps) {
  if (model === "exact") return runExact(scene, knobs, steps);
  const run = blank(scene.y.length, knobs.dt, steps);
  let [state, saved] = [scene, scene];
  write(run, 0, state);
  for (let row = 1; row <= steps; row++) {
    state = STEP[model](state, scene, knobs);
    write(run, row, state);
    // a step depends on the state and its impulses alone: where they come back, all is known
    if (same(saved, state)) return repeat(run, row, ((row - 1) % SAVED) + 1);
    if (row % SAVED === 0) saved = state;
  }
  return run;
}

// Fills the rows after `row` with what comes back every `period` rows.
function repeat(run, row, period) {
  for (const key of PARTS)
    for (let at = (row + 1) * run.n; at < run[key].length; at++)
      run[key][at] = run[key][at - period * run.n];
  return run;
}

// ---- exact: from one impact to the next, while no normal turns

// Balls in one line, over or beside one another. run.events are the impacts.
export function runExact(scene, { dt }, steps, gravity = -GRAVITY) {
  const { x, y, mass, radius, restitution } = scene;
  const run = Object.assign(blank(y.length, dt, steps), { events: [] });
  let state = { x, y, vx: scene.vx.slice(), vy: scene.vy.slice() };
  const pairs = makeRows(detectContacts(x, y, radius, Infinity), mass);
  let gaps = pairs.map((c) => (-c.depth > TOUCH ? -c.depth : 0));
  let [now, row] = [0, 0];
  for (let impact = 0; impact < MOST_IMPACTS && row <= steps; impact++) {
    const touching = pairs.filter((_, k) => gaps[k] === 0);
    const struck = strike(touching, state, restitution);
    run.events.push(...struck.map(({ i, j }) => ({ t: now, i, j })));
    const a = accelerations(touching, state, mass, gravity);
    const { span, after } = nextImpact(pairs, gaps, state, a);
    for (; row <= steps && run.t[row] <= now + span; row++)
      write(run, row, fly(state, a, run.t[row] - now));
    state = fly(state, a, span);
    gaps = after;
    now += span;
  }
  return run;
}

function fly({ x, y, vx, vy }, { ax, ay }, t) {
  const place = (q, v, a) => q.map((each, i) => each + t * (v[i] + 0.5 * t * a[i]));
  const speed = (v, a) => v.map((each, i) => each + t * a[i]);
  return { x: place(x, vx, ax), y: place(y, vy, ay), vx: speed(vx, ax), vy: speed(vy, ay) };
}

// All impacts of one moment: v_n becomes -e v_n where a contact pushes. Returns who struck.
function strike(touching, { vx, vy }, restitution) {
  const before = touching.map((c) => normalSpeed(c, vx, vy));
  touching.forEach((c, k) => {
    const back = -restitution * before[k];
    c.target = back >= 0 && back < SLOW ? 0 : back;
  });
  settle(touching, vx, vy);
  return touching.filter((c, k) => before[k] < -SLOW);
}

// The same sweep, one derivative higher: the accelerations of balls and contacts; and who rests.
function accelerations(touching, { vx, vy }, mass, gravity) {
  const resting = touching.filter((c) => Math.abs(normalSpeed(c, vx, vy)) < STILL);
  const [ax, ay] = [mass.map(() => 0), mass.map((m) => (m < Infinity ? -gravity : 0))];
  for (const c of resting) c.target = 0;
  settle(resting, ax, ay);
  const rests = (c) => resting.includes(c) && normalSpeed(c, ax, ay) < STILL;
  return { ax, ay: ay.map((a) => (Math.abs(a) > STILL ? a : 0)), rests };
}

// Sweep until only rounding is left.
function settle(rows, vx, vy) {
  const speeds = rows.flatMap((c) => [vx[c.i], vy[c.i], vx[c.j] || 0, vy[c.j] || 0, c.target]);
  for (const c of rows) c.lam = 0;
  const tolerance = 2 ** -50 * Math.max(0, ...speeds.map(Math.abs));
  solveWithMomentum(rows, vx, vy, { iters: MOST_SWEEPS, tolerance });
}

// How long until the next gap closes; and all gaps at that moment, 0 in touch.
function nextImpact(pairs, gaps, { vx, vy }, { ax, ay, rests }) {
  const courses = pairs.map((c, k) => {
    const [gap, v, a] = [gaps[k], normalSpeed(c, vx, vy), normalSpeed(c, ax, ay)];
    return { gap, v, a, root: rests(c) ? Infinity : timeToImpact(gap, v, a), rests: rests(c) };
  });
  const span = Math.min(...courses.map(({ root }) => root));
  const after = courses.map(({ gap, v, a, root, rests }) =>
    rests || root <= span * TOGETHER ? 0 : Math.max(0, gap + span * (v + 0.5 * span * a)),
  );
  return { span, after };
}

// The first root of gap + v t + a t^2 / 2; Infinity if the gap does not close.
function timeToImpact(gap, v, a) {
  if (!(v < 0 || a < 0)) return Infinity;
  const square = v * v - 2 * gap * a;
  if (square < 0) return Infinity;
  return v < 0 ? (2 * gap) / (Math.sqrt(square) - v) : -(v + Math.sqrt(square)) / a;
}

// ---- measuring, as contact_quality and its neighbours do it

function energyAt({ n, y, vx, vy }, { mass }, row) {
  let sum = 0;
  for (let i = 0, at = row * n; i < n; i++, at++)
    if (mass[i] < Infinity)
      sum += 0.5 * mass[i] * (vx[at] * vx[at] + vy[at] * vy[at]) - mass[i] * GRAVITY * y[at];
  return sum;
}

// The smallest gap [m] to the floor or between two balls; NaN once a ball is nowhere.
function smallestGap({ n, x, y }, { radius }, row) {
  let least = Infinity;
  for (let i = 0; i < n; i++) {
    const at = row * n + i;
    least = Math.min(least, y[at] - radius[i]);
    for (let j = i + 1; j < n; j++) {
      const [dx, dy] = [x[at] - x[row * n + j], y[at] - y[row * n + j]];
      least = Math.min(least, Math.sqrt(dx * dx + dy * dy) - (radius[i] + radius[j]));
    }
  }
  return least;
}

// The push of the table [N] on all that stands on it, averaged over the step that ends in `row`:
// what changed the momentum and was not gravity.
export function pushOfTable({ n, dt, vy }, { mass }, row) {
  let sum = 0;
  for (let i = 0, at = row * n; i < n; i++, at++)
    if (mass[i] < Infinity) sum += mass[i] * ((vy[at] - vy[at - n]) / dt - GRAVITY);
  return Math.abs(sum) < 1e-9 * Math.abs(GRAVITY) ? 0 : sum;
}

// Row by row: gap [r], energy over its start, push in weights; and the row of the landing.
export function series(run, scene) {
  const rows = run.steps + 1;
  const [gap, energy, push] = [0, 1, 2].map(() => new Float64Array(rows));
  const weight = scene.mass.reduce((sum, m) => sum - (m < Infinity ? m * GRAVITY : 0), 0);
  const start = energyAt(run, scene, 0);
  let landing = rows;
  for (let row = 0; row < rows; row++) {
    gap[row] = smallestGap(run, scene, row) / scene.radius[0];
    energy[row] = energyAt(run, scene, row) / start;
    if (row > 0) push[row] = pushOfTable(run, scene, row) / weight;
    if (landing === rows && (gap[row] <= 0 || push[row] > 1e-9)) landing = row;
  }
  return { gap, energy, push, landing };
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
