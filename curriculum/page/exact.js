/* The exact model: event to event, with no step error, also where balls slide over one another.
 *
 * Between events the contacts that push are equations: their gaps stay 0. Where no normal turns the
 * motion is a parabola; where balls slide it is a Taylor series in time. The rows of a run are read
 * from it, so the time step does not enter. An event is a gap or a force that falls through zero;
 * there the impulses and the forces are solved for anew.
 *
 * Bodies are numbered 0 to n - 1; the floor is body n, with inverse mass 0.
 */

import { data } from "./data.js";

const { TOUCH, SLOW, GRAZE, ORDER } = data.exact; // m, m/s, of g, terms: as in the Python files
const REST = 1e-12; // m/s: a smaller speed is rounding
export const MOST_EVENTS = 20000; // a page must answer: past this many events the run is cut short

// ---- linear complementarity

// lam with (W lam + b) = 0 where active, 0 elsewhere; redundant contacts leave `active`.
function solveActive(W, b, active) {
  const index = b.map((_, c) => c).filter((c) => active[c]);
  const rows = index.map((c) => [...index.map((k) => W[c][k]), -b[c]]);
  index.forEach((c, p) => {
    if (rows[p][p] > 1e-13 * W[c][c]) {
      const pivot = rows[p][p];
      rows[p] = rows[p].map((v) => v / pivot);
      rows.forEach((row, q) => {
        if (q === p) return;
        const factor = row[p];
        rows[q] = row.map((v, k) => v - factor * rows[p][k]);
      });
    } else {
      active[c] = false;
      rows[p] = rows[p].map(() => 0);
      for (const row of rows) row[p] = 0;
    }
  });
  const lam = b.map(() => 0);
  index.forEach((c, p) => (lam[c] = rows[p][index.length]));
  return lam;
}

// From lam towards the solution of the active set, letting go of what would have to pull.
function approach(W, b, active, lam) {
  let trial = solveActive(W, b, active);
  for (;;) {
    const bad = trial.map((_, c) => c).filter((c) => active[c] && trial[c] < 0);
    if (!bad.length) return trial;
    const shares = bad.map((c) => lam[c] / (lam[c] - trial[c]));
    const share = Math.min(...shares);
    lam = lam.map((v, c) => (active[c] ? v + share * (trial[c] - v) : 0));
    bad.forEach((c, k) => {
      if (shares[k] <= share) active[c] = false;
    });
    trial = solveActive(W, b, active);
  }
}

// lam >= 0 with w = W lam + b >= 0 and lam w = 0: the active-set rule of Lawson and Hanson (1974),
// started from all contacts active.
export function solveLcp(W, b) {
  if (b.length === 0) return [];
  if (b.length === 1) return [Math.max(-b[0] / W[0][0], 0)];
  let lam = b.map(() => 0);
  const active = b.map(() => true);
  const refused = b.map(() => false);
  const small = 1e-14 * Math.max(0, ...b.map(Math.abs));
  for (;;) {
    const before = lam;
    lam = approach(W, b, active, lam);
    const same = lam.every((v, c) => v === before[c]);
    const w = b.map((value, c) => (active[c] ? 0 : dot(W[c], lam) + value));
    let worst = -1;
    for (let c = 0; c < b.length; c++) {
      refused[c] = refused[c] && same;
      if (!refused[c] && (worst < 0 || w[c] < w[worst])) worst = c;
    }
    if (worst < 0 || w[worst] >= -small) return lam;
    active[worst] = refused[worst] = true;
  }
}

const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);

// ---- geometry and reactions of a list of contacts {i, j, nx, ny}

const along = (c, ax, ay) => c.nx * (ax[c.i] - ax[c.j]) + c.ny * (ay[c.i] - ay[c.j]);

function delassus(contacts, w) {
  return contacts.map((c) =>
    contacts.map((d) => {
      let shared = 0;
      if (c.i === d.i) shared += w[c.i];
      if (c.j === d.j) shared += w[c.j];
      if (c.i === d.j) shared -= w[c.i];
      if (c.j === d.i) shared -= w[c.j];
      return shared * (c.nx * d.nx + c.ny * d.ny);
    }),
  );
}

function push(contacts, lam, w, ax, ay) {
  contacts.forEach((c, k) => {
    ax[c.i] += lam[k] * w[c.i] * c.nx;
    ay[c.i] += lam[k] * w[c.i] * c.ny;
    ax[c.j] -= lam[k] * w[c.j] * c.nx;
    ay[c.j] -= lam[k] * w[c.j] * c.ny;
  });
}

// Adds M^-1 J' lam to (ax, ay), lam from the complementarity problem; returns lam.
function react(contacts, w, ax, ay, b) {
  const lam = solveLcp(delassus(contacts, w), b);
  push(contacts, lam, w, ax, ay);
  return lam;
}

function listPairs(n) {
  const pairs = [];
  for (let i = 0; i < n; i++) pairs.push({ i, j: n });
  for (let i = 0; i < n; i++) for (let j = i + 1; j < n; j++) pairs.push({ i, j });
  return pairs;
}

function measureGap(pair, s) {
  const { i, j } = pair;
  if (j === s.n) return { i, j, nx: 0, ny: 1, gap: s.y[i] - s.radius[i] };
  const dx = s.x[i] - s.x[j];
  const dy = s.y[i] - s.y[j];
  const distance = Math.sqrt(dx * dx + dy * dy);
  const known = distance > 0;
  return {
    i,
    j,
    nx: known ? dx / distance : 0,
    ny: known ? dy / distance : 1,
    gap: distance - s.radius[i] - s.radius[j],
  };
}

// ---- what happens at one instant: impulses, then forces

function smallGap(pair, s) {
  const last = (k) => 2.3e-16 * Math.max(Math.abs(s.x[k]), Math.abs(s.y[k]));
  return TOUCH * (s.radius[pair.i] / data.radius) + 4 * Math.max(last(pair.i), last(pair.j));
}

function settle(s, pairs, restitution, log) {
  const found = pairs.map((pair) => measureGap(pair, s));
  const small = pairs.map((pair) => smallGap(pair, s));
  const gap = found.map((c) => Math.max(c.gap, 0));
  const active = pairs.map(() => false);
  let near = found.map((_, p) => p).filter((p) => found[p].gap <= small[p]);
  let contacts = near.map((p) => found[p]);
  let speed = contacts.map((c) => along(c, s.vx, s.vy));
  if (speed.some((v) => v < -1e-13)) {
    const b = speed.map((v, k) => v + (restitution * Math.abs(v) < SLOW ? 0 : restitution * v));
    react(contacts, s.w, s.vx, s.vy, b);
    const after = contacts.map((c) => along(c, s.vx, s.vy));
    contacts.forEach((c, k) => {
      if (speed[k] < -SLOW) log(c, -speed[k], after[k]);
    });
    speed = after;
  }
  const rests = speed.map((v) => Math.abs(v) < REST);
  near = near.filter((_, k) => rests[k]);
  contacts = contacts.filter((_, k) => rests[k]);
  const forces = hold(s, contacts);
  near.forEach((p, k) => {
    gap[p] += 2 * small[p];
    active[p] = forces.pushes[k];
  });
  return { ...forces, gap, active };
}

// The accelerations of this instant, and which of the resting contacts push; does any of them turn?
function hold(s, contacts) {
  const ax = s.w.map(() => 0);
  const ay = s.w.map((w) => (w > 0 ? -s.gravity : 0));
  const slip = contacts.map((c) => (c.j === s.n ? 0 : along({ ...c, nx: -c.ny, ny: c.nx }, s.vx, s.vy)));
  const b = contacts.map((c, k) => along(c, ax, ay) + slip[k] ** 2 / (s.radius[c.i] + s.radius[c.j]));
  const lam = react(contacts, s.w, ax, ay, b);
  const pushes = contacts.map((c, k) => lam[k] * (s.w[c.i] + s.w[c.j]) > 2 * GRAZE * s.gravity); // twice: what just let go does not push
  const turns = contacts.map(
    (c, k) => c.j !== s.n && (slip[k] !== 0 || along({ ...c, nx: -c.ny, ny: c.nx }, ax, ay) !== 0),
  );
  return { ax, ay, pushes, slides: pushes.some((yes, k) => yes && turns[k]) };
}

// ---- sliding: the Taylor series of the motion while a set of contacts pushes

function invert(W) {
  const table = W.map((row) => row.slice());
  table.forEach((_, k) => {
    const pivot = table[k][k];
    const row = table[k].map((v) => v / -pivot);
    const column = table.map((each) => each[k]);
    table.forEach((each, r) => each.forEach((v, c) => (each[c] = v + column[r] * row[c])));
    table.forEach((each, r) => (each[k] = column[r] / pivot));
    table[k] = row;
    table[k][k] = 1 / pivot;
  });
  return table;
}

// Puts the state on gap = 0 and v_n = 0, and returns the contacts with their normals there.
function project(s, pairs, solve) {
  const contacts = pairs.map((pair) => measureGap(pair, s));
  push(contacts, solve(contacts.map((c) => -c.gap)), s.w, s.x, s.y);
  const placed = pairs.map((pair) => measureGap(pair, s));
  push(placed, solve(placed.map((c) => -along(c, s.vx, s.vy))), s.w, s.vx, s.vy);
  return placed;
}

// q'' = g + M^-1 J' lam with gap = 0. The normals are series too, n = (q_i - q_j) / (r_i + r_j), and
// n . n = 1 gives, order by order, a linear system for lam with one and the same matrix.
function slide(s, pairs) {
  const before = pairs.map((pair) => measureGap(pair, s));
  const inverse = invert(delassus(before, s.w));
  const solve = (b) => inverse.map((row) => dot(row, b));
  const contacts = project(s, pairs, solve);
  const reach = contacts.map((c) => s.radius[c.i] + s.radius[c.j]);
  const X = [s.x.slice(), s.vx.slice()];
  const Y = [s.y.slice(), s.vy.slice()];
  const NX = [contacts.map((c) => c.nx)];
  const NY = [contacts.map((c) => c.ny)];
  const lam = [];
  for (let k = 0; k < ORDER - 1; k++) {
    const turns = (A) => contacts.map((c, p) => (c.j === s.n ? 0 : (A[c.i] - A[c.j]) / reach[p]));
    NX.push(turns(X[k + 1]));
    NY.push(turns(Y[k + 1]));
    const ax = s.w.map(() => 0);
    const ay = s.w.map((w) => (k === 0 && w > 0 ? -s.gravity : 0));
    for (let m = 0; m < k; m++) push(withNormals(contacts, NX[k - m], NY[k - m]), lam[m], s.w, ax, ay);
    const turn = contacts.map((_, p) => {
      let sum = 0;
      for (let m = 1; m <= k + 1; m++) sum += NX[m][p] * NX[k + 2 - m][p] + NY[m][p] * NY[k + 2 - m][p];
      return 0.5 * reach[p] * sum;
    });
    const b = contacts.map((c, p) => -(along(c, ax, ay) + (k + 1) * (k + 2) * turn[p]));
    lam.push(solve(b));
    push(contacts, lam[k], s.w, ax, ay);
    const share = (k + 1) * (k + 2);
    X.push(ax.map((v) => v / share));
    Y.push(ay.map((v) => v / share));
  }
  return { X, Y, lam, contacts, span: trusted(X, Y, s.radius) };
}

const withNormals = (contacts, nx, ny) => contacts.map((c, p) => ({ ...c, nx: nx[p], ny: ny[p] }));

// A time by which the last terms of the series are below 1e-16 r.
function trusted(X, Y, radius) {
  let span = Infinity;
  for (const k of [ORDER - 1, ORDER]) {
    for (let i = 0; i < radius.length - 1; i++) {
      const size = Math.max(Math.abs(X[k][i]), Math.abs(Y[k][i])) / radius[i];
      if (size > 0) span = Math.min(span, (1e-16 / size) ** (1 / k));
    }
  }
  return span;
}

// ---- events

function evaluate(p, t) {
  let sum = 0;
  for (let k = p.length - 1; k >= 0; k--) sum = sum * t + p[k];
  return sum;
}

const rate = (p) => p.slice(1).map((c, k) => (k + 1) * c);

// The series of what has the sign of a gap: y - r, or |q_i - q_j|^2 - (r_i + r_j)^2.
function gapSeries(pair, gap, s, X, Y) {
  const { i, j } = pair;
  if (j === s.n) return [gap, ...Y.slice(1).map((row) => row[i])];
  const dx = X.map((row) => row[i] - row[j]);
  const dy = Y.map((row) => row[i] - row[j]);
  const p = [gap * (gap + 2 * (s.radius[i] + s.radius[j]))];
  for (let k = 1; k < Math.max(5, X.length); k++) {
    let sum = 0;
    for (let m = Math.max(0, k - dx.length + 1); m <= Math.min(k, dx.length - 1); m++)
      sum += dx[m] * dx[k - m] + dy[m] * dy[k - m];
    p.push(sum);
  }
  return p;
}

// First t in [0, horizon] at which sum p[k] t^k, p[0] >= 0, falls through zero; Infinity if it does
// not. Newton's method with the least curvature up to the horizon, so that no step passes a root.
function firstFall(p, horizon) {
  const slopes = rate(p);
  const bends = rate(slopes).map((c) => 0.5 * c);
  const curved = p.slice(3).some((c) => c !== 0);
  let t = 0;
  for (let tries = 0; tries < 200; tries++) {
    const value = Math.max(evaluate(p, t), 0);
    const slope = evaluate(slopes, t);
    const bend = curved ? leastBend(bends, t, horizon) : p[2] || 0;
    const root = Math.sqrt(slope * slope - 4 * value * bend);
    const step =
      slope < 0 ? (2 * value) / (root - slope) : bend < 0 ? (slope + root) / (-2 * bend) : Infinity;
    if (!(t + step <= horizon)) return Infinity;
    t += step;
    if (!curved || step <= 1e-15 * t) return t;
  }
  return t;
}

function leastBend(bends, from, to) {
  const [a, b, c] = [bends[0] || 0, bends[1] || 0, bends[2] || 0];
  const at = (t) => a + t * (b + t * c);
  let least = Math.min(at(from), at(to));
  if (c > 0) least = Math.min(least, at(Math.min(Math.max(-b / (2 * c), from), to)));
  const rest = bends.slice(3).map(Math.abs);
  return least - evaluate(rest, to) * to ** 3;
}

// The motion from this instant on, and the time of its first event (at most `horizon`).
function plan(s, pairs, now, horizon) {
  const { gap, active, slides } = now;
  let X = [s.x, s.vx, now.ax.map((a) => 0.5 * a)];
  let Y = [s.y, s.vy, now.ay.map((a) => 0.5 * a)];
  let span = horizon;
  const falls = [];
  if (slides) {
    const held = slide(
      s,
      pairs.filter((_, p) => active[p]),
    );
    ({ X, Y } = held);
    span = Math.min(horizon, held.span);
    held.contacts.forEach((c, k) => {
      const least = (GRAZE * s.gravity) / (s.w[c.i] + s.w[c.j]);
      const series = held.lam.map((row) => row[k]);
      falls.push([Math.max(series[0], 0) - least, ...series.slice(1)]);
    });
  }
  pairs.forEach((pair, p) => {
    if (!active[p]) falls.push(gapSeries(pair, gap[p], s, X, Y));
  });
  for (const p of falls) span = Math.min(span, firstFall(p, span));
  return { X, Y, span };
}

// ---- the run

export function run(scene, times, gravity, out) {
  const n = scene.y.length;
  const floored = (row, value) => [...row, value];
  const s = {
    n,
    gravity,
    x: floored(scene.x, 0),
    y: floored(scene.y, 0),
    vx: floored(scene.vx, 0),
    vy: floored(scene.vy, 0),
    w: floored(
      scene.mass.map((m) => 1 / m),
      0,
    ),
    radius: floored(scene.radius, 0),
  };
  const pairs = listPairs(n);
  const end = times[times.length - 1];
  let t = 0;
  let k = 0;
  const log = (c, closing, leaving) =>
    out.events.push({ t, i: c.i, j: c.j === n ? -1 : c.j, closing, leaving });
  for (let round = 0; k < times.length; round++) {
    const now = settle(s, pairs, scene.restitution, log);
    const { X, Y, span } = plan(s, pairs, now, end - t);
    const cut = round >= MOST_EVENTS;
    if (cut) out.cut = t;
    const paths = pathsOf(X, Y, n);
    for (; k < times.length && (cut || times[k] <= t + span); k++)
      sample(out, k, paths, cut ? 0 : times[k] - t);
    move(s, paths, span);
    t += span;
  }
}

// The series of each ball's place and speed, from the rows of X and Y.
function pathsOf(X, Y, n) {
  return Array.from({ length: n }, (_, i) => {
    const [x, y] = [X, Y].map((A) => A.map((row) => row[i]));
    return { x, y, vx: rate(x), vy: rate(y) };
  });
}

const PARTS = ["x", "y", "vx", "vy"];

function sample(out, k, paths, time) {
  for (const part of PARTS)
    for (let i = 0; i < out.n; i++) out[part][k * out.n + i] = evaluate(paths[i][part], time);
}

function move(s, paths, span) {
  for (const part of PARTS) paths.forEach((path, i) => (s[part][i] = evaluate(path[part], span)));
}
