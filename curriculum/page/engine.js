/* The three contact models of contact.py, in plain JavaScript.
 *
 * JavaScript numbers are the same 64-bit doubles that Python uses, and + - * / and sqrt are rounded
 * the same way in both. So penalty and lcp, written here in the same order of operations, give the
 * same trajectories bit for bit; exact agrees to 1e-12. A browser test holds both claims.
 *
 * Names and signs are those of contact.py: gap > 0 apart; depth = -gap; n is a unit vector pointing
 * from j to i (the floor is j = -1); v_n > 0 separating; lam >= 0. Units: m, kg, s, N*s.
 *
 * A scene is {x, y, vx, vy, mass, radius, restitution, damping}: arrays with one number a ball.
 * The knobs are {dt, stiffness, damping, restitution, sweeps, baumgarte}.
 */
"use strict";

const ContactEngine = (() => {
  const GRAVITY = -9.81;
  const CONTACT_MARGIN = 1e-3;
  const MODELS = ["penalty", "lcp", "exact"];

  // max(0, a) as Python computes it: what is not greater than zero, NaN included, becomes +0.
  const positive = (a) => (a > 0 ? a : 0);

  // Floor contacts by body, then pairs i < j: the order is part of the result.
  function detectContacts(x, y, radius, margin) {
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

  function normalSpeed(c, vx, vy) {
    const jx = c.j < 0 ? 0 : vx[c.j];
    const jy = c.j < 0 ? 0 : vy[c.j];
    return c.nx * (vx[c.i] - jx) + c.ny * (vy[c.i] - jy);
  }

  // One step of penalty: a clamped spring and damper a contact, under semi-implicit Euler.
  // `trace`, when given, receives what each contact did.
  function penaltyStep(state, scene, knobs, trace) {
    const { x, y, vx, vy } = state;
    const { mass, radius } = scene;
    const { dt, stiffness, damping } = knobs;
    const n = y.length;
    const fx = new Array(n);
    const fy = new Array(n);
    fx.fill(0);
    fy.fill(0);
    for (const c of detectContacts(x, y, radius, 0)) {
      const speed = normalSpeed(c, vx, vy);
      const f = positive(stiffness * c.depth - damping * speed);
      fx[c.i] += f * c.nx;
      fy[c.i] += f * c.ny;
      if (c.j >= 0) {
        fx[c.j] -= f * c.nx;
        fy[c.j] -= f * c.ny;
      }
      if (trace) trace.push({ i: c.i, j: c.j, gap: -c.depth, speed, force: f });
    }
    const next = { x: new Array(n), y: new Array(n), vx: new Array(n), vy: new Array(n) };
    for (let i = 0; i < n; i++) {
      next.vx[i] = vx[i] + dt * (fx[i] / mass[i]);
      next.vy[i] = vy[i] + dt * (GRAVITY + fy[i] / mass[i]);
      next.x[i] = x[i] + dt * next.vx[i];
      next.y[i] = y[i] + dt * next.vy[i];
    }
    return next;
  }

  // One step of lcp: predict, then sweep over the contacts (projected Gauss-Seidel), then move.
  // `trace`, when given, receives the contacts and the impulses after every sweep.
  function lcpStep(state, scene, knobs, trace) {
    const { x, y } = state;
    const { mass, radius } = scene;
    const { dt, restitution, baumgarte, sweeps } = knobs;
    const n = y.length;
    const contacts = detectContacts(x, y, radius, CONTACT_MARGIN);
    const vx = new Array(n);
    const vy = new Array(n);
    for (let i = 0; i < n; i++) {
      vx[i] = state.vx[i];
      vy[i] = state.vy[i] + dt * GRAVITY;
    }
    const invMass = mass.map((m) => 1 / m);
    const lam = contacts.map(() => 0);
    const target = contacts.map((c) => {
      const push = (baumgarte / dt) * c.depth;
      if (!(restitution > 0)) return push;
      const bounce = -restitution * normalSpeed(c, state.vx, state.vy);
      return push > 0 && push > bounce ? push : bounce;
    });
    const rows = contacts.map((c) => {
      const wi = invMass[c.i];
      const wj = c.j < 0 ? 0 : invMass[c.j];
      return { effectiveMass: 1 / (wi + wj), ix: wi * c.nx, iy: wi * c.ny, jx: wj * c.nx, jy: wj * c.ny };
    });
    if (trace) {
      trace.contacts = contacts.map((c, k) => ({
        i: c.i,
        j: c.j,
        gap: -c.depth,
        speed: normalSpeed(c, vx, vy),
        target: target[k],
      }));
      trace.sweeps = [];
    }
    for (let sweep = 0; sweep < sweeps && contacts.length; sweep++) {
      let changed = false;
      for (let k = 0; k < contacts.length; k++) {
        const c = contacts[k];
        const row = rows[k];
        const total = positive(lam[k] + (target[k] - normalSpeed(c, vx, vy)) * row.effectiveMass);
        const dlam = total - lam[k];
        if (total !== lam[k]) changed = true;
        lam[k] = total;
        vx[c.i] += dlam * row.ix;
        vy[c.i] += dlam * row.iy;
        if (c.j >= 0) {
          vx[c.j] -= dlam * row.jx;
          vy[c.j] -= dlam * row.jy;
        }
      }
      if (trace) trace.sweeps.push(lam.slice());
      if (!changed) break;
    }
    const next = { x: new Array(n), y: new Array(n), vx, vy };
    for (let i = 0; i < n; i++) {
      next.x[i] = x[i] + dt * vx[i];
      next.y[i] = y[i] + dt * vy[i];
    }
    return next;
  }

  const STEP = { penalty: penaltyStep, lcp: lcpStep };

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

  function stateAt(run, row) {
    const part = (a) => Array.from(a.subarray(row * run.n, (row + 1) * run.n));
    return { x: part(run.x), y: part(run.y), vx: part(run.vx), vy: part(run.vy) };
  }

  function runModel(model, scene, knobs, steps) {
    if (model === "exact") return runExact(scene, knobs, steps);
    const step = STEP[model];
    const run = blank(scene.y.length, knobs.dt, steps);
    let state = { x: scene.x, y: scene.y, vx: scene.vx, vy: scene.vy };
    write(run, 0, state);
    for (let row = 1; row <= steps; row++) {
      state = step(state, scene, knobs);
      write(run, row, state);
    }
    return run;
  }

  // ---- exact: from event to event, in a column (every ball on one vertical line)

  const TOUCH_IN_RADII = 1e-12; // closer than this touches
  const STILL = 1e-13; // m/s: closing slower than this is resting
  const UNSEEN_IN_RADII = 1e-15; // a bounce lower than this is the last of its series
  const MOST_EVENTS = 20000; // a page must answer: past this many events the run is cut short

  // lam >= 0 with w = W lam + b >= 0 and lam w = 0: the active-set rule of Lawson and Hanson,
  // started from all contacts active.
  function solveLcp(W, b) {
    const size = b.length;
    let lam = b.map(() => 0);
    const active = b.map(() => true);
    const refused = b.map(() => false);
    const small = 1e-14 * Math.max(0, ...b.map(Math.abs));
    for (;;) {
      const before = lam;
      let trial = solveActive(W, b, active);
      for (;;) {
        let share = Infinity;
        const bad = [];
        for (let c = 0; c < size; c++) {
          if (!(active[c] && trial[c] < 0)) continue;
          bad.push(c);
          share = Math.min(share, lam[c] / (lam[c] - trial[c]));
        }
        if (!bad.length) break;
        const old = lam;
        lam = lam.map((v, c) => (active[c] ? v + share * (trial[c] - v) : 0));
        for (const c of bad) if (old[c] / (old[c] - trial[c]) <= share) active[c] = false;
        trial = solveActive(W, b, active);
      }
      lam = trial;
      const w = b.map((value, c) =>
        active[c] ? 0 : W[c].reduce((sum, a, k) => sum + a * lam[k], 0) + value,
      );
      const same = lam.every((v, c) => v === before[c]);
      for (let c = 0; c < size; c++) refused[c] = refused[c] && same;
      let worst = 0;
      const shown = w.map((v, c) => (refused[c] ? 0 : v));
      for (let c = 1; c < size; c++) if (shown[c] < shown[worst]) worst = c;
      if (!size || shown[worst] >= -small || refused[worst]) return lam;
      active[worst] = refused[worst] = true;
    }
  }

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
    index.forEach((c, p) => {
      lam[c] = rows[p][index.length];
    });
    return lam;
  }

  // First t >= 0 at which c0 + c1 t + c2 t^2 (c0 >= 0) falls through zero; infinite where it never does.
  function firstRoot(c0, c1, c2) {
    const root = Math.sqrt(c1 * c1 - 4 * c0 * c2);
    const t = c1 < 0 ? (2 * c0) / (root - c1) : c2 < 0 ? (c1 + root) / (-2 * c2) : Infinity;
    return Number.isNaN(t) ? Infinity : t;
  }

  function runExact(scene, knobs, steps) {
    const n = scene.y.length;
    const { dt } = knobs;
    const run = blank(n, dt, steps);
    run.events = [];
    run.cut = null;
    const pairs = [];
    for (let i = 0; i < n; i++) pairs.push({ i, j: -1 });
    for (let i = 0; i < n; i++) for (let j = i + 1; j < n; j++) pairs.push({ i, j });
    const invMass = scene.mass.map((m) => 1 / m);
    const unit = scene.radius[0];
    let y = scene.y.slice(),
      v = scene.vy.slice();
    let a = new Array(n).fill(GRAVITY);
    let held = pairs.map(() => false);
    // a pair's normal points from j to i: down when ball j is the upper one
    const side = (c) => (c.j < 0 || scene.y[c.i] >= scene.y[c.j] ? 1 : -1);
    const gapOf = (c) =>
      c.j < 0
        ? y[c.i] - scene.radius[c.i]
        : Math.abs(y[c.i] - y[c.j]) - scene.radius[c.i] - scene.radius[c.j];
    const along = (c, row) => side(c) * (row[c.i] - (c.j < 0 ? 0 : row[c.j]));

    // row + M^-1 J' lam with lam from the complementarity problem; rounding noise becomes 0.
    function pushed(row, contacts, b) {
      const W = contacts.map((c) =>
        contacts.map((d) => {
          const shared =
            (c.i === d.i ? invMass[c.i] : 0) +
            (c.j >= 0 && c.j === d.j ? invMass[c.j] : 0) -
            (c.i === d.j ? invMass[c.i] : 0) -
            (c.j >= 0 && c.j === d.i ? invMass[c.j] : 0);
          return side(c) * side(d) * shared;
        }),
      );
      const lam = solveLcp(W, b);
      const noise = 1e-13 * Math.max(...row.map(Math.abs));
      const next = row.slice();
      contacts.forEach((c, k) => {
        next[c.i] += lam[k] * invMass[c.i] * side(c);
      });
      contacts.forEach((c, k) => {
        if (c.j >= 0) next[c.j] -= lam[k] * invMass[c.j] * side(c);
      });
      return next.map((value) => (Math.abs(value) > noise ? value : 0));
    }

    let now = 0,
      k = 0;
    while (k <= steps) {
      // what happens at this instant: impulses, then the forces of what rests
      let near = pairs.map((_, c) => c).filter((c) => gapOf(pairs[c]) <= TOUCH_IN_RADII * unit);
      let contacts = near.map((c) => pairs[c]);
      let speed = contacts.map((c) => along(c, v));
      if (speed.some((s) => s < -STILL)) {
        const bounce = near.map((c, at) => {
          const wanted = held[c] ? 0 : -scene.restitution * speed[at];
          return wanted * wanted > -2 * GRAVITY * UNSEEN_IN_RADII * unit ? wanted : 0;
        });
        v = pushed(
          v,
          contacts,
          speed.map((s, at) => s - bounce[at]),
        );
        const after = contacts.map((c) => along(c, v));
        contacts.forEach((c, at) => {
          if (speed[at] < -STILL)
            run.events.push({ t: now, i: c.i, j: c.j, closing: -speed[at], leaving: after[at] });
        });
        speed = after;
      }
      const rest = near.filter((_, at) => Math.abs(speed[at]) <= STILL);
      const still = pairs.map(() => false);
      for (const c of rest) still[c] = true;
      contacts = rest.map((c) => pairs[c]);
      a = new Array(n).fill(GRAVITY);
      if (contacts.length)
        a = pushed(
          a,
          contacts,
          contacts.map((c) => along(c, a)),
        );
      held = still;
      // fly to the next impact, or to the end
      const horizon = run.t[steps] - now;
      let tau = horizon;
      if (run.events.length < MOST_EVENTS) {
        pairs.forEach((c, at) => {
          if (!still[at])
            tau = Math.min(tau, firstRoot(Math.max(gapOf(c), 0), along(c, v), 0.5 * along(c, a)));
        });
      } else run.cut = now;
      const until = now + tau;
      for (; k <= steps && (run.t[k] <= until || run.cut !== null); k++) {
        const s = run.cut === null ? run.t[k] - now : 0;
        for (let i = 0; i < n; i++) {
          run.x[k * n + i] = scene.x[i];
          run.y[k * n + i] = y[i] + s * (v[i] + 0.5 * s * a[i]);
          run.vy[k * n + i] = v[i] + s * a[i];
        }
      }
      y = y.map((value, i) => value + tau * (v[i] + 0.5 * tau * a[i]));
      v = v.map((value, i) => value + tau * a[i]);
      now = until;
    }
    return run;
  }

  // ---- measuring, as contact_quality and its neighbours do it

  function energyAt(run, scene, row) {
    let sum = 0;
    for (let i = 0; i < run.n; i++) {
      const at = row * run.n + i;
      const speed2 = run.vx[at] * run.vx[at] + run.vy[at] * run.vy[at];
      sum += 0.5 * scene.mass[i] * speed2 - scene.mass[i] * GRAVITY * run.y[at];
    }
    return sum;
  }

  // Deepest overlap with the floor or one another [m]; NaN once a ball is nowhere.
  function penetrationAt(run, scene, row) {
    const { n } = run;
    let deepest = 0;
    for (let i = 0; i < n; i++) {
      const at = row * n + i;
      if (Number.isNaN(run.y[at])) return NaN;
      deepest = Math.max(deepest, scene.radius[i] - run.y[at]);
      for (let j = i + 1; j < n; j++) {
        const dx = run.x[at] - run.x[row * n + j];
        const dy = run.y[at] - run.y[row * n + j];
        deepest = Math.max(deepest, scene.radius[i] + scene.radius[j] - Math.sqrt(dx * dx + dy * dy));
      }
    }
    return deepest;
  }

  // What the charts show: heights by ball, depth, energy over its start.
  function series(run, scene) {
    const rows = run.steps + 1;
    const depth = new Float64Array(rows);
    const depthInRadii = new Float64Array(rows);
    const energy = new Float64Array(rows);
    const heights = [];
    for (let i = 0; i < run.n; i++)
      heights.push(Float64Array.from({ length: rows }, (_, row) => run.y[row * run.n + i]));
    const start = energyAt(run, scene, 0);
    let deepestRow = 0,
      finiteMax = 0,
      energyMax = 0;
    let landing = rows; // the first row in which the lowest ball has met the table
    for (let row = rows - 1; row > 0; row--) {
      if (run.vy[row * run.n] >= 0 || run.y[row * run.n] <= scene.radius[0]) landing = row;
    }
    for (let row = 0; row < rows; row++) {
      depth[row] = penetrationAt(run, scene, row);
      depthInRadii[row] = depth[row] / scene.radius[0];
      energy[row] = energyAt(run, scene, row) / start;
      if (depth[row] > depth[deepestRow]) deepestRow = row;
      if (Number.isFinite(depth[row])) finiteMax = Math.max(finiteMax, depth[row]);
      if (Number.isFinite(energy[row])) energyMax = Math.max(energyMax, energy[row]);
    }
    return { heights, depth, depthInRadii, energy, deepestRow, finiteMax, energyMax, landing };
  }

  // Energy [J] that contacts put INTO the bodies in the step that ends in `row`. A contact may leave
  // with e times the speed it closed with, or with the speed it parts at, plus what falling through
  // its gap adds; what is more than that is put in.
  function contactWork(run, scene, row) {
    const { n } = run;
    const old = (row - 1) * n,
      now = row * n;
    let sum = 0;
    const add = (i, j, nx, ny, depth) => {
      if (!(depth > -CONTACT_MARGIN)) return;
      const part = (at) =>
        nx * (run.vx[at + i] - (j < 0 ? 0 : run.vx[at + j])) +
        ny * (run.vy[at + i] - (j < 0 ? 0 : run.vy[at + j]));
      const before = part(old),
        after = part(now);
      if (!(after > 0)) return;
      const closing = Math.max(-before - (j < 0 ? run.dt * GRAVITY : 0), 0);
      const allowed = Math.max(scene.restitution * closing, before) ** 2 - 2 * GRAVITY * Math.max(-depth, 0);
      const mobility = 1 / scene.mass[i] + (j < 0 ? 0 : 1 / scene.mass[j]);
      sum += (0.5 / mobility) * Math.max(after * after - allowed, 0);
    };
    for (let i = 0; i < n; i++) add(i, -1, 0, 1, scene.radius[i] - run.y[old + i]);
    for (let i = 0; i < n; i++) {
      for (let j = i + 1; j < n; j++) {
        const dx = run.x[old + i] - run.x[old + j],
          dy = run.y[old + i] - run.y[old + j];
        const dist = Math.sqrt(dx * dx + dy * dy);
        add(
          i,
          j,
          dist > 0 ? dx / dist : 0,
          dist > 0 ? dy / dist : 1,
          scene.radius[i] + scene.radius[j] - dist,
        );
      }
    }
    return sum;
  }

  const EXPLODED = 10; // times the start energy: more than this gained is an explosion

  function quality(run, scene, reference) {
    const rows = run.steps + 1;
    const unit = scene.radius[0];
    const start = energyAt(run, scene, 0);
    const scale = Math.abs(start) || 1;
    let deepest = 0,
      excess = -Infinity,
      work = 0,
      error = 0,
      blewUpStep = null;
    const depth = [];
    for (let row = 0; row < rows; row++) {
      depth.push(penetrationAt(run, scene, row) / unit);
      deepest = Math.max(deepest, depth[row]);
      const above = (energyAt(run, scene, row) - start) / scale;
      excess = Math.max(excess, above);
      if (blewUpStep === null && !(above < EXPLODED)) blewUpStep = row;
      for (let i = 0; i < run.n; i++) {
        const at = row * run.n + i;
        if (reference) error = Math.max(error, Math.abs(run.y[at] - reference.y[at]) / unit);
      }
      if (row > 0) work += contactWork(run, scene, row) / scale;
    }
    const late = depth.slice(Math.floor((3 * rows) / 4));
    const mean = late.reduce((sum, d) => sum + d, 0) / late.length;
    const spread = Math.sqrt(late.reduce((sum, d) => sum + (d - mean) ** 2, 0) / late.length);
    return {
      max_penetration_frac: deepest,
      rest_penetration_frac: depth[rows - 1],
      energy_excess: excess,
      contact_energy: work,
      height_error_frac: reference ? error : null,
      rest_jitter: spread,
      blew_up: blewUpStep !== null,
      blew_up_step: blewUpStep,
    };
  }

  // The largest stable dt of penalty's step for a ball kept in contact, with its damper and without.
  function criticalDt(mass, stiffness, damping) {
    const root = Math.sqrt(damping * damping + 4 * mass * stiffness);
    return {
      damped: root + damping > 0 ? (4 * mass) / (root + damping) : Infinity,
      undamped: stiffness > 0 ? 2 * Math.sqrt(mass / stiffness) : Infinity,
    };
  }

  return {
    GRAVITY,
    CONTACT_MARGIN,
    MODELS,
    detectContacts,
    penaltyStep,
    lcpStep,
    runModel,
    stateAt,
    series,
    quality,
    criticalDt,
  };
})();

if (typeof module !== "undefined") module.exports = ContactEngine;
