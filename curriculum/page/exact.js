/* The exact model: event to event, with no step error, also where balls slide over one another.
 *
 * Between events the contacts that push are equations: their gaps stay 0. Where no normal turns the
 * motion is a parabola; where balls slide it is a Taylor series in time. The rows of a run are read
 * from it, so the time step does not enter. An event is a gap or a force that falls through zero;
 * there `react`, contact.py's sweep, solves for the impulses and the forces anew.
 *
 * Bodies are numbered 0 to n - 1; the floor is body -1.
 */
import { data } from "./data.js";

const { TOUCH, SLOW, STILL, ORDER } = data.exact; // m, m/s, m/s, terms: as in the Python files
const GRAZE = 1e-12; // of g: a smaller force is none
const MOST_EVENTS = 20000; // a page must answer: past this many events the run is cut short

const normalSpeed = ({ i, j, nx, ny }, vx, vy) => nx * (vx[i] - (j < 0 ? 0 : vx[j])) + ny * (vy[i] - (j < 0 ? 0 : vy[j]));

// Adds M^-1 J' lam to (ax, ay).
function push(s, contacts, lam, ax, ay) {
  contacts.forEach(({ i, j, nx, ny }, k) => {
    ax[i] += (lam[k] * nx) / s.mass[i];
    ay[i] += (lam[k] * ny) / s.mass[i];
    if (j < 0) return;
    ax[j] -= (lam[k] * nx) / s.mass[j];
    ay[j] -= (lam[k] * ny) / s.mass[j];
  });
}

function listPairs(n) {
  const pairs = [];
  for (let i = 0; i < n; i++) pairs.push({ i, j: -1 });
  for (let i = 0; i < n; i++) for (let j = i + 1; j < n; j++) pairs.push({ i, j });
  return pairs;
}

function measureGap({ i, j }, s) {
  if (j < 0) return { i, j, nx: 0, ny: 1, gap: s.y[i] - s.radius[i] };
  const dx = s.x[i] - s.x[j];
  const dy = s.y[i] - s.y[j];
  const distance = Math.sqrt(dx * dx + dy * dy);
  const known = distance > 0;
  return { i, j, nx: known ? dx / distance : 0, ny: known ? dy / distance : 1, gap: distance - s.radius[i] - s.radius[j] };
}

// ---- what happens at one instant: impulses, then forces

const rounding = ({ i, j }, s) =>
  1e-15 * Math.max(...[i, j].map((k) => (k < 0 ? 0 : Math.max(Math.abs(s.x[k]), Math.abs(s.y[k])))));

function settle(s, pairs, restitution, log) {
  const found = pairs.map((pair) => measureGap(pair, s));
  const small = pairs.map((pair) => TOUCH + rounding(pair, s));
  const gap = found.map((c) => Math.max(c.gap, 0));
  const active = pairs.map(() => false);
  const near = found.map((_, p) => p).filter((p) => found[p].gap <= small[p]);
  const contacts = near.map((p) => found[p]);
  const before = contacts.map((c) => normalSpeed(c, s.vx, s.vy));
  if (before.some((v) => v < -STILL)) {
    const targets = before.map((v) => (restitution * Math.abs(v) < SLOW ? 0 : -restitution * v));
    s.react(contacts, targets, s.vx, s.vy);
    contacts.forEach((c, k) => {
      if (before[k] < -SLOW) log(c, -before[k], normalSpeed(c, s.vx, s.vy));
    });
  }
  const rests = contacts.map((c) => Math.abs(normalSpeed(c, s.vx, s.vy)) < STILL + rounding(c, s));
  const resting = near.filter((_, k) => rests[k]);
  const forces = hold(
    s,
    resting.map((p) => found[p]),
  );
  resting.forEach((p, k) => {
    gap[p] += 2 * small[p];
    active[p] = forces.pushes[k];
  });
  return { ...forces, gap, active };
}

const across = (c) => ({ ...c, nx: -c.ny, ny: c.nx });

// The accelerations of this instant, and which of the resting contacts push; does any of them turn?
function hold(s, contacts) {
  const ax = s.mass.map(() => 0);
  const ay = s.mass.map((m) => (m < Infinity ? -s.gravity : 0));
  const slip = contacts.map((c) => (c.j < 0 ? 0 : normalSpeed(across(c), s.vx, s.vy)));
  const targets = contacts.map((c, k) => (c.j < 0 ? 0 : -(slip[k] ** 2) / (s.radius[c.i] + s.radius[c.j])));
  const lam = s.react(contacts, targets, ax, ay);
  // twice the least force: what has just let go does not push
  const pushes = contacts.map((c, k) => lam[k] > 2 * least(s, c));
  const turns = contacts.map((c, k) => c.j >= 0 && (slip[k] !== 0 || normalSpeed(across(c), ax, ay) !== 0));
  return { ax, ay, pushes, slides: pushes.some((yes, k) => yes && turns[k]) };
}

// A smaller force is none.
const least = (s, { i, j }) => (GRAZE * s.gravity) / (1 / s.mass[i] + (j < 0 ? 0 : 1 / s.mass[j]));

// ---- sliding: the Taylor series of the motion while a set of contacts pushes

// Puts the state on gap = 0 and v_n = 0, and returns the contacts with their normals there.
function project(s, pairs) {
  const contacts = pairs.map((pair) => measureGap(pair, s));
  const [dx, dy] = [s.x.map(() => 0), s.y.map(() => 0)];
  s.react(contacts, contacts.map((c) => -c.gap), dx, dy, true);
  s.x.forEach((_, i) => {
    s.x[i] += dx[i];
    s.y[i] += dy[i];
  });
  const placed = pairs.map((pair) => measureGap(pair, s));
  s.react(placed, placed.map(() => 0), s.vx, s.vy, true);
  return placed;
}

// q'' = g + M^-1 J' lam with gap = 0. The normals are series too, n = (q_i - q_j) / (r_i + r_j), and
// n . n = 1 gives, order by order, a linear system for lam with one and the same matrix.
function slide(s, pairs) {
  const contacts = project(s, pairs);
  const reach = contacts.map((c) => s.radius[c.i] + (c.j < 0 ? 0 : s.radius[c.j]));
  const X = [s.x.slice(), s.vx.slice()];
  const Y = [s.y.slice(), s.vy.slice()];
  const NX = [contacts.map((c) => c.nx)];
  const NY = [contacts.map((c) => c.ny)];
  const lam = [];
  const turns = (A) => contacts.map((c, p) => (c.j < 0 ? 0 : (A[c.i] - A[c.j]) / reach[p]));
  for (let k = 0; k < ORDER - 1; k++) {
    NX.push(turns(X[k + 1]));
    NY.push(turns(Y[k + 1]));
    const ax = s.mass.map(() => 0);
    const ay = s.mass.map((m) => (k === 0 && m < Infinity ? -s.gravity : 0));
    const withNormals = (m) => contacts.map((c, p) => ({ ...c, nx: NX[m][p], ny: NY[m][p] }));
    for (let m = 0; m < k; m++) push(s, withNormals(k - m), lam[m], ax, ay);
    const turn = contacts.map((_, p) => {
      let sum = 0;
      for (let m = 1; m <= k + 1; m++) sum += NX[m][p] * NX[k + 2 - m][p] + NY[m][p] * NY[k + 2 - m][p];
      return 0.5 * reach[p] * sum;
    });
    const share = (k + 1) * (k + 2);
    lam.push(s.react(contacts, turn.map((each) => -share * each), ax, ay, true));
    X.push(ax.map((v) => v / share));
    Y.push(ay.map((v) => v / share));
  }
  return { X, Y, lam, contacts, span: trusted(X, Y, s.radius) };
}

// A time by which the last terms of the series are below 1e-16 r.
function trusted(X, Y, radius) {
  let span = Infinity;
  for (const k of [ORDER - 1, ORDER]) {
    for (let i = 0; i < radius.length; i++) {
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
  if (j < 0) return [gap, ...Y.slice(1).map((row) => row[i])];
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
      const series = held.lam.map((row) => row[k]);
      falls.push([Math.max(series[0], 0) - least(s, c), ...series.slice(1)]);
    });
  }
  pairs.forEach((pair, p) => {
    if (!active[p]) falls.push(gapSeries(pair, gap[p], s, X, Y));
  });
  for (const p of falls) span = Math.min(span, firstFall(p, span));
  return { X, Y, span };
}

// ---- the run

// Fills the rows of `out` with the motion of a scene at `times`, and out.events with its impacts. `react`
// gives contacts the impulses that bring them to targets (engine.js).
export function run(scene, times, gravity, out, react) {
  const s = { ...stateOf(scene), mass: scene.mass, radius: scene.radius, n: scene.y.length, gravity };
  s.react = (...given) => react(scene.mass, ...given);
  const pairs = listPairs(s.n);
  const end = times[times.length - 1];
  let t = 0;
  let k = 0;
  const log = ({ i, j }, closing, leaving) => out.events.push({ t, i, j, closing, leaving });
  for (let round = 0; k < times.length; round++) {
    const now = settle(s, pairs, scene.restitution, log);
    const { X, Y, span } = plan(s, pairs, now, end - t);
    const cut = round >= MOST_EVENTS;
    if (cut) out.cut = t;
    const paths = pathsOf(X, Y, s.n);
    for (; k < times.length && (cut || times[k] <= t + span); k++) sample(out, k, paths, cut ? 0 : times[k] - t);
    move(s, paths, span);
    t += span;
  }
}

const stateOf = (scene) => Object.fromEntries(PARTS.map((part) => [part, scene[part].slice()]));

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
