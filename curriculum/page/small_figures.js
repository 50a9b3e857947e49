/* The small figures: a ball, one knob, one idea each. Every point is computed by engine.js; the lines
 * through them are the formulas. A figure is a knob and a function draw(value, width) that returns
 * {height, markup, output, words}; nothing here touches the document, so a figure's still picture is
 * the same drawing at the knob's first value. live_small.js puts them into the page. */
"use strict";

const SmallFigures = (() => {
  const { el, words, number, plain, plot, decades, steps, ball, table, arrow, mark } = Plot;
  const { runModel, criticalDt, GRAVITY, MODELS } = ContactEngine;
  const R = PAGE.radius;
  const G = -GRAVITY; // also the weight in N of a ball of 1 kg
  const DEFAULTS = { ...PAGE.defaults, damping: 80, restitution: 0 };
  const START = PAGE.scenes.drop.starts[0][0]; // m, of the ball that is dropped

  const oneBall = (height, more = {}) => ({
    x: [0],
    y: [height],
    vx: [0],
    vy: [0],
    mass: [1],
    radius: [R],
    restitution: 0,
    ...more,
  });
  const logGrid = (low, high, count) =>
    Array.from({ length: count }, (_, i) => low * (high / low) ** (i / (count - 1)));
  const group = (x, y, ...children) =>
    el("g", { transform: `translate(${Plot.round(x)} ${Plot.round(y)})` }, ...children);
  const plural = (count, word) => `${count} ${word}${count === 1 ? "" : "s"}`;

  const ticksAt = (...values) => values.map((v) => [v, plain(v).replace("-", "−")]);

  const axis = (domain, label, ...at) => ({ domain, label, ticks: ticksAt(...at) });

  // Results that do not depend on the knob are computed once.
  const kept = new Map();
  const once = (name, compute) => {
    if (!kept.has(name)) kept.set(name, compute());
    return kept.get(name);
  };

  // A picture on the left (a share of the width) and a plot on the right.
  function split(width, share = 0.34) {
    const left = Math.round(Math.min(170, Math.max(96, share * width)));
    return { left, right: width - left - 8 };
  }

  // The picture and the plot, beside one another.
  const beside = (left, chart, ...picture) => group(0, 0, ...picture) + group(left + 8, 0, chart.markup);

  // How long an arrow for a force is; the scale is a square root, since impacts are hundreds of weights.
  const forceLength = (force) => 24 * Math.sqrt(force / G);
  const weights = (force) => `${number(force / G, 2)} m g`;

  // A ball on a table: its centre at (x, y), the table's top at `floor`, weight and push as arrows.
  function pushed(model, x, y, r, force, floor, width) {
    return [
      table(0, floor, width, 34),
      ball(model, x, y, r),
      arrow("weight", x - r - 10, y, 0, forceLength(G)),
      arrow(`push m-${model}`, x + r + 10, Math.max(y + r, floor), 0, -Math.min(forceLength(force), 150)),
    ].join("");
  }

  // The push of the table on what stands on it [N], averaged over the step that ends in `row`.
  const pushAt = (run, scene, row) => ContactEngine.pushOfTable(run, scene, row);

  // ---- balance: a spring must be pressed to push

  function balance(stiffness, width) {
    const { left, right } = split(width);
    const depth = G / stiffness / R;
    const reach = Math.min(0.1, 2.5 * depth);
    const r = Math.min(44, left * 0.36);
    const floor = 150;
    const chart = plot({
      id: "balance",
      width: right,
      height: 200,
      x: axis([0, 0.1], "depth / r", 0, 0.05, 0.1),
      y: axis([0, 2.4], "force / m g", 0, 1, 2),
      lines: [{ model: "penalty", xs: [0, reach], ys: [0, (stiffness * reach * R) / G] }],
      rules: [{ y: 1, text: "weight", class: "dashed" }],
      points: [{ model: "penalty", x: depth, y: 1, size: 6 }],
    });
    const centre = floor - r + 10 * depth * r;
    return {
      height: 200,
      markup: beside(left, chart, pushed("penalty", left / 2, centre, r, G, floor, left)),
      output: `k = ${number(stiffness)} N/m`,
      words: `Weight and push balance where the spring is pressed by m g / k = ${number(1000 * depth * R)} mm = ${number(depth)} r. In the picture it is ten times as deep.`,
    };
  }

  // ---- dive: landing on a spring

  const diveRun = () =>
    once("dive", () => runModel("penalty", oneBall(START), { ...DEFAULTS, dt: 0.0005 }, 2400));

  function dive(time, width) {
    const { left, right } = split(width);
    const scene = oneBall(START);
    const run = diveRun();
    const row = Math.round(time / run.dt);
    const depths = Array.from(run.y, (y) => (R - y) / R);
    const force = pushAt(run, scene, row);
    const r = Math.min(44, left * 0.36);
    const floor = 150;
    const chart = plot({
      id: "dive",
      width: right,
      height: 200,
      x: axis([0.4, 1], "time (s)", 0.4, 0.6, 0.8, 1),
      y: axis([-0.45, 0.3], "depth / r", -0.4, -0.2, 0, 0.2),
      lines: [{ model: "penalty", xs: run.t, ys: depths, from: 800, to: 2001 }],
      rules: [{ y: 0 }, { x: time }],
      points: [{ model: "penalty", x: time, y: depths[row], size: 6 }],
    });
    return {
      height: 200,
      markup: beside(
        left,
        chart,
        pushed("penalty", left / 2, floor - r + depths[row] * r, r, force, floor, left),
      ),
      output: `t = ${time.toFixed(3)} s`,
      words: `${depths[row] > 0 ? `${number(depths[row])} r deep` : `${number(-depths[row])} r above`}, moving at ${number(run.vy[row])} m/s; the push is ${weights(force)}.`,
    };
  }

  // ---- long-step: one step in which the force does not change

  function longStep(dt, width) {
    const { left, right } = split(width);
    const scene = oneBall(0.8 * R);
    const knobs = { dt, stiffness: 1e4, damping: 0 };
    const next = ContactEngine.penaltyStep(scene, scene, knobs);
    const fine = once("long-step", () => runModel("penalty", scene, { ...knobs, dt: 1e-5 }, 3000));
    const height = (y) => (y - R) / R;
    const r = Math.min(30, left * 0.26);
    const [floor, pixel] = [160, 1];
    const at = (y) => floor - r - height(y) * r * pixel;
    const chart = plot({
      id: "long-step",
      width: right,
      height: 210,
      x: axis([0, 30], "time (ms)", 0, 10, 20, 30),
      y: axis([-0.4, 1.8], "height / r", 0, 0.5, 1, 1.5),
      lines: [
        { model: "exact", xs: fine.t.map((t) => 1000 * t), ys: Array.from(fine.y, height), class: "thin" },
        { model: "penalty", xs: [0, 1000 * dt], ys: [height(scene.y[0]), height(next.y[0])] },
      ],
      rules: [{ y: 0 }],
      points: [{ model: "penalty", x: 1000 * dt, y: height(next.y[0]), size: 6 }],
    });
    const best = Math.sqrt(1e4) * 0.2 * R;
    return {
      height: 210,
      markup: beside(
        left,
        chart,
        table(0, floor, left, 34),
        ball("penalty", left / 2, at(scene.y[0]), r, "ghost"),
        ball("penalty", left / 2, at(next.y[0]), r),
        arrow("push m-penalty", left / 2, at(next.y[0]), 0, -Math.min(60, 8 * next.vy[0])),
      ),
      output: `dt = ${number(1000 * dt)} ms`,
      words: `The step keeps the push of 200 N for ${number(1000 * dt)} ms: the ball leaves with ${number(next.vy[0])} m/s. The spring itself (dashed) gives ${number(best)} m/s at the most.`,
    };
  }

  // ---- corner: gap and force, and where each model is

  function cornerRuns() {
    return once("corner", () => {
      const scene = oneBall(START);
      const runs = MODELS.map((model) => runModel(model, scene, { ...DEFAULTS, dt: 0.001 }, 1000));
      return runs.map((run) => ({
        gap: Array.from(run.y, (y) => (y - R) / R),
        force: Array.from(run.y, (_, row) => (row ? pushAt(run, scene, row) / G : 0)),
      }));
    });
  }

  // Before a bet the models that tell its answer are left out; exact tells none.
  function corner(time, width, open) {
    const { left, right } = split(width);
    const row = Math.round(time / 0.001);
    const told = (model) => model === "exact" || (open("ex1") && (model !== "soft" || open("ex4")));
    const shown = MODELS.filter(told);
    const runs = shown.map((model) => cornerRuns()[MODELS.indexOf(model)]);
    const most = 400;
    const chart = plot({
      id: "corner",
      width: right,
      height: 230,
      x: axis([-0.36, 0.45], "gap / r", -0.2, 0, 0.2, 0.4),
      y: {
        domain: [0, most],
        root: true,
        ticks: ticksAt(0, 1, 10, 100, 400),
        label: "push / m g",
      },
      lines: [
        {
          model: shown[0],
          xs: runs[0].gap,
          ys: runs[0].force,
          from: Math.max(0, row - 30),
          to: row + 1,
          class: "thin",
        },
      ],
      points: shown.map((model, m) => ({
        model,
        x: runs[m].gap[row],
        y: Math.min(most, runs[m].force[row]),
        size: 6,
      })),
    });
    const allowed = `M${chart.box.right} ${chart.box.bottom}H${Plot.round(chart.sx(0))}V${chart.box.top}`;
    const r = Math.min(15, left / 9.5);
    const floor = 190;
    const balls = shown.map((model, m) =>
      ball(model, (left * (m + 0.5)) / shown.length, Math.max(-30, floor - r - 4 * runs[m].gap[row] * r), r),
    );
    return {
      height: 230,
      markup: beside(
        left,
        { markup: el("path", { d: allowed, class: "allowed" }) + chart.markup },
        table(0, floor, left, 34),
        ...balls,
      ),
      output: `t = ${time.toFixed(3)} s`,
      words: `Gap / r and push / m g: ${shown.map((model, m) => `${model} ${number(runs[m].gap[row], 2)} and ${number(runs[m].force[row], 2)}`).join("; ")}. The thick corner is all that the conditions allow.`,
    };
  }

  // ---- sweeps: lam of the three contacts of a resting stack, after each sweep

  const restingStack = () => ({
    x: [0, 0, 0],
    y: [R, 3 * R, 5 * R],
    vx: [0, 0, 0],
    vy: [0, 0, 0],
    mass: [1, 1, 1],
    radius: [R, R, R],
    restitution: 0,
  });

  function sweeps(count, width) {
    const { left, right } = split(width);
    const traced = once("sweeps", () => {
      const trace = {};
      ContactEngine.lcpStep(restingStack(), restingStack(), { ...DEFAULTS, baumgarte: 0, iters: 20 }, trace);
      return [[0, 0, 0], ...trace.sweeps];
    });
    const unit = G * DEFAULTS.dt;
    const at = Math.min(count, traced.length - 1);
    const carried = traced[at].map((lam) => lam / unit);
    const r = Math.min(26, left / 4.2);
    const floor = 190;
    const x = left * 0.4;
    const balls = [1, 3, 5].map(
      (high, c) =>
        ball("lcp", x, floor - high * r, r) +
        arrow(
          "push m-lcp",
          x + r + 8,
          floor - (high - 1) * r,
          0,
          -carried[c] * r * 0.66,
          number(carried[c], 2),
        ),
    );
    const chart = plot({
      id: "sweeps",
      width: right,
      height: 224,
      x: axis([0, 20], "sweep", 0, 5, 10, 15, 20),
      y: axis([0, 3.3], "impulse / m g dt", 0, 1, 2, 3),
      lines: [0, 1, 2].map((c) => ({
        model: "lcp",
        xs: traced.map((_, s) => s),
        ys: traced.map((lam) => lam[c] / unit),
      })),
      rules: [...[1, 2, 3].map((y) => ({ y, class: "dashed" })), { x: count }],
      points: carried.map((y) => ({ model: "lcp", x: count, y, size: 5 })),
    });
    return {
      height: 224,
      markup: beside(left, chart, table(0, floor, left, 34), ...balls),
      output: plural(count, "sweep"),
      words: `The contacts should carry 3, 2 and 1 balls; after ${plural(count, "sweep")} they carry ${carried.map((v) => number(v)).join(", ")}.`,
    };
  }

  // ---- clamp: the sum may not become negative, a single change may

  // A ball in the groove of two that nothing moves: its velocity and impulses after some sweeps.
  function groove(count, project) {
    const state = { x: [0, -1.2, 1.2], y: [0, -1.6, -1.6], vx: [0.5, 0, 0], vy: [-1, 0, 0] };
    const contacts = [1, 2].map((j) => ({ i: 0, j, nx: j === 1 ? 0.6 : -0.6, ny: 0.8, depth: 0 }));
    const rows = ContactEngine.makeRows(contacts, [1, Infinity, Infinity], [0, 0], [0, 0]);
    ContactEngine.solveContacts(rows, state.vx, state.vy, { iters: count, project });
    return { vx: state.vx[0], vy: state.vy[0], lam: rows.map((c) => c.lam) };
  }

  function groovePicture(result, width, title) {
    const r = Math.min(27, width / 6);
    const [x, y] = [width / 2, 92];
    const fixed = [-1, 1].map((side) => ball("fixed", x + side * 1.2 * r, y + 1.6 * r, r, "body"));
    const arrows = [-1, 1].map((side, k) => {
      const [dx, dy] = [-side * 0.6 * 52 * result.lam[k], -0.8 * 52 * result.lam[k]];
      return arrow("push m-lcp", x + side * 0.6 * r - dx, y + 0.8 * r - dy, dx, dy);
    });
    return [
      words(title, { x, y: 16, class: "axis-name", "text-anchor": "middle" }),
      ...fixed,
      ball("lcp", x, y, r),
      ...arrows,
      arrow("weight", x, y, 130 * result.vx, -130 * result.vy, "v"),
    ].join("");
  }

  function clamp(count, width) {
    const right = groove(count, ContactEngine.projectImpulse);
    const wrong = groove(count, (lam, dlam) => lam + Math.max(0, dlam));
    const half = width / 2;
    const speed = (v) => number(Math.hypot(v.vx, v.vy));
    return {
      height: 180,
      markup:
        group(0, 0, groovePicture(right, half, "sum ≥ 0")) +
        group(half, 0, groovePicture(wrong, half, "each change ≥ 0")),
      output: plural(count, "sweep"),
      words: `After ${plural(count, "sweep")} the ball moves at ${speed(right)} m/s where the sum is clamped and at ${speed(wrong)} m/s where each change is: there what one contact pushed too much is never taken back.`,
    };
  }

  // ---- larger: bounce and bias, the larger of the two against their sum

  const sumTarget = (c, state, { dt, restitution, baumgarte }) => {
    const v_n = ContactEngine.normalSpeed(c, state.vx, state.vy) + dt * GRAVITY;
    return (baumgarte / dt) * c.depth - restitution * v_n;
  };

  function larger(dt, width) {
    const scene = oneBall(START, { restitution: 0.7 });
    const knobs = { ...DEFAULTS, dt, restitution: 0.7 };
    const count = Math.round(1.2 / dt);
    const runs = [undefined, sumTarget].map((target) => runModel("lcp", scene, { ...knobs, target }, count));
    const height = (y) => (y - R) / (START - R);
    const apex = (run) => {
      const landed = run.vy.findIndex((v, row) => row > 0 && v > 0);
      let best = Math.max(landed, 0);
      for (let row = best; row <= count && run.vy[row] > 0; row++) best = row;
      return best;
    };
    const tops = runs.map(apex);
    const chart = plot({
      id: "larger",
      width,
      height: 220,
      x: { domain: [0.4, 1.2], ticks: steps(0.4, 1.2, 4), label: "time (s)" },
      y: axis([0, 1], "height / start", 0, 0.49, 1),
      lines: runs.map((run, k) => ({
        model: "lcp",
        xs: run.t,
        ys: Array.from(run.y, height),
        class: k ? "thin dotted" : "",
      })),
      rules: [{ y: 0.49, text: "e² = 0.49", class: "dashed" }],
    });
    const marks = runs.map((run, k) => {
      const [x, y] = [chart.sx(run.t[tops[k]]), chart.sy(height(run.y[tops[k]]))];
      return (
        ball("lcp", x, y, 9, k ? "ghost" : "ball") +
        words(k ? "sum" : "larger", { x: x + 13, y: y + (k ? -8 : 18), class: "tick strong" })
      );
    });
    const share = runs.map((run, k) => Math.sqrt(Math.max(0, height(run.y[tops[k]]))));
    return {
      height: 220,
      markup: chart.markup + marks.join(""),
      output: `dt = ${number(1000 * dt)} ms`,
      words: `A material of e = 0.7 bounces with ${number(share[0])} by the larger of the two, with ${number(share[1])} by their sum.`,
    };
  }

  // ---- hop: the bias velocity throws the ball up

  function hop(baumgarte, width) {
    const { left, right } = split(width);
    const run = runModel("lcp", oneBall(START), { ...DEFAULTS, baumgarte }, 500);
    const gap = Array.from(run.y, (y) => (y - R) / R);
    let landed = gap.findIndex((g) => g <= 0);
    if (landed < 0) landed = 499;
    let top = landed;
    for (let row = landed; row <= 500; row++) if (gap[row] > gap[top]) top = row;
    const r = Math.min(44, left * 0.36);
    const floor = 160;
    const chart = plot({
      id: "hop",
      width: right,
      height: 200,
      x: axis([0.4, 0.8], "time (s)", 0.4, 0.6, 0.8),
      y: axis([-0.1, 0.9], "gap / r", 0, 0.4, 0.8),
      lines: [{ model: "lcp", xs: run.t, ys: gap, from: 200, to: 401 }],
      rules: [{ y: 0 }],
      points: [{ model: "lcp", x: run.t[top], y: gap[top], size: 6 }],
    });
    return {
      height: 200,
      markup: beside(
        left,
        chart,
        table(0, floor, left, 34),
        ball("lcp", left / 2, floor - r, r, "ghost"),
        ball("lcp", left / 2, floor - r - gap[top] * r, r),
      ),
      output: `β = ${baumgarte.toFixed(2)}`,
      words:
        gap[top] > 1e-6
          ? `It landed ${number(-Math.min(...gap))} r deep, with restitution 0, and hops ${number(gap[top])} r high.`
          : `It landed ${number(-Math.min(...gap))} r deep and does not hop${gap[500] < -1e-6 ? `; ${number(-gap[500])} r of overlap stay` : ""}.`,
    };
  }

  // ---- bounces: infinitely many, and over at a finite time

  function bounces(e, width) {
    const scene = oneBall(START, { restitution: e });
    const first = Math.sqrt((2 * (START - R)) / G);
    const end = (first * (1 + e)) / (1 - e);
    const until = Math.max(1, 1.15 * end);
    const run = runModel("exact", scene, { dt: until / 600 }, 600);
    const chart = plot({
      id: "bounces",
      width,
      height: 210,
      x: { domain: [0, until], ticks: steps(0, until, 5), label: "time (s)" },
      y: axis([0, 1.1], "height (m)", 0, 0.5, 1),
      lines: [{ model: "exact", xs: run.t, ys: Array.from(run.y) }],
      rules: [{ x: end, text: `over at ${number(end)} s`, class: "dashed" }],
    });
    const r = chart.sy(0) - chart.sy(R);
    const tops = [0, 1, 2, 3, 4].map((k) =>
      k ? first * (1 + (2 * e * (1 - e ** (k - 1))) / (1 - e) + e ** k) : 0,
    );
    const balls = tops
      .filter((t) => t < until)
      .map((t) => ball("exact", chart.sx(t), chart.sy(run.y[Math.round((t / until) * 600)]), r, "ghost"));
    return {
      height: 210,
      markup: balls.join("") + chart.markup + ball("exact", chart.sx(until) - r, chart.sy(R), r),
      output: `e = ${e.toFixed(2)}`,
      words: `${plural(run.events.length, "impact")} until a bounce is lower than 1e−15 r.`,
    };
  }

  // ---- cradle: impacts at one moment, or one shortly after another

  function cradle(gap, width) {
    const x = [-1, 0, 2 * R + gap * R, 4 * R + 2 * gap * R];
    const same = (value) => x.map(() => value);
    const scene = {
      x,
      y: same(0.5),
      vx: [2, 0, 0, 0],
      vy: same(0),
      mass: same(1),
      radius: same(R),
      restitution: 1,
    };
    const steps = 80;
    const run = ContactEngine.runExact(scene, { dt: 0.01 }, steps, 1e-9); // no weight to speak of
    const last = Array.from({ length: 4 }, (_, i) => run.vx[steps * 4 + i]);
    const scale = width / 3.2;
    const r = R * scale;
    const row = (at, y, title) =>
      [0, 1, 2, 3]
        .map((i) => {
          const cx = (run.x[at * 4 + i] + 1.25) * scale;
          return (
            ball("exact", cx, y, r) +
            arrow("push m-exact", cx, y - r - 6, 0.16 * scale * run.vx[at * 4 + i], 0)
          );
        })
        .join("") + words(title, { x: 0, y: y - r - 22, class: "axis-name" });
    return {
      height: 190,
      markup: row(0, 66, "before") + row(steps, 160, "after"),
      output: gap === 0 ? "no gap" : `gap = ${number(gap)} r`,
      words:
        `${gap === 0 ? "Touching: one impact, solved at one moment." : "Apart: impacts one after another."} ` +
        `They leave with ${last.map((v) => number(v, 2)).join(", ")} m/s; energy and momentum are kept.`,
    };
  }

  // ---- slide: a ball slides off a ball, and leaves it

  const SLIDE = { angle: 0.35, dt: 0.002, steps: 500, fine: 2e-5, until: 0.45 };

  const slideScene = () => ({
    x: [0, 2 * R * Math.sin(SLIDE.angle)],
    y: [5, 5 + 2 * R * Math.cos(SLIDE.angle)],
    vx: [0, 0],
    vy: [0, 0],
    mass: [Infinity, 1],
    radius: [R, R],
    restitution: 0,
  });

  // The angles at which the last step began and ended in which something else than gravity pushed.
  function lastPush(run) {
    const pushed = (row) => {
      const [now, before] = [2 * row + 1, 2 * row - 1];
      const [dvx, dvy] = [run.vx[now] - run.vx[before], run.vy[now] - run.vy[before]];
      return Math.hypot(dvx, dvy + G * run.dt) > 1e-6 * G * run.dt;
    };
    let row = run.steps;
    while (row > 1 && !pushed(row)) row--;
    return [row - 1, row].map((at) => Math.atan2(run.x[2 * at + 1], run.y[2 * at + 1] - 5));
  }

  // Runs of the four models, and where each lets the ball go. exact has no step: it is looked at finely.
  function slideRuns() {
    return once("slide", () =>
      MODELS.map((model) => {
        const { dt, fine, until } = SLIDE;
        const run = runModel(model, slideScene(), { ...DEFAULTS, dt, iters: 50 }, SLIDE.steps);
        const place = (row) => ({ x: run.x[2 * row + 1], y: run.y[2 * row + 1] - 5 });
        const looked =
          model === "exact" ? runModel(model, slideScene(), { ...DEFAULTS, dt: fine }, until / fine) : run;
        return { model, place, leaves: lastPush(looked) };
      }),
    );
  }

  const degrees = (angle, places = 1) => `${((angle * 180) / Math.PI).toFixed(places)}°`;

  function slideWords(runs, release) {
    const steps = runs.filter(({ model }) => model !== "exact");
    const told = steps.map(({ model, leaves: [from, to] }) => `${model} ${degrees(from)} to ${degrees(to)}`);
    const { leaves } = runs.find(({ model }) => model === "exact");
    return (
      `The last push should come at ${degrees(release, 2)}; exact ${degrees(leaves[1], 2)}. ` +
      `The steps of ${SLIDE.dt} s in which it comes: ${told.join("; ")}.`
    );
  }

  function slide(time, width) {
    const runs = slideRuns();
    const row = Math.round(time / SLIDE.dt);
    const scale = Math.min(width / 0.62, 560);
    const [cx, cy] = [0.2 * scale, 0.31 * scale];
    const release = Math.acos((2 / 3) * Math.cos(SLIDE.angle));
    const ray = (angle, from, to) =>
      `M${Plot.round(cx + from * scale * Math.sin(angle))} ${Plot.round(cy - from * scale * Math.cos(angle))}` +
      `L${Plot.round(cx + to * scale * Math.sin(angle))} ${Plot.round(cy - to * scale * Math.cos(angle))}`;
    const height = Math.round(cy + 0.2 * scale);
    const balls = runs.map(({ model, place }) => {
      const { x, y } = place(row);
      return ball(model, cx + x * scale, cy - y * scale, R * scale, model === "exact" ? "ball" : "ghost");
    });
    const marks = runs.map(({ model, leaves }, k) => {
      const far = (0.12 + 0.022 * k) * scale;
      const middle = 0.5 * (leaves[0] + leaves[1]);
      return mark(model, cx + far * Math.sin(middle), cy - far * Math.cos(middle), 5);
    });
    return {
      height,
      markup: [
        ball("fixed", cx, cy, R * scale, "body"),
        el("path", { d: ray(release, 0, 0.32), class: "rule dashed" }),
        words("cos θ = ⅔ cos θ₀", {
          x: Math.min(width - 108, cx + 0.33 * scale * Math.sin(release)),
          y: cy - 0.33 * scale * Math.cos(release),
          class: "tick strong",
        }),
        ...balls,
        ...marks,
      ].join(""),
      output: `t = ${time.toFixed(2)} s`,
      words: slideWords(runs, release),
    };
  }

  // ---- impedance: how hard a soft contact is, by its depth

  function impedance(share, width) {
    const { left, right } = split(width);
    const solimp = ContactEngine.SOLIMP;
    const d = ContactEngine.impedance(share * solimp[2], solimp);
    const xs = Array.from({ length: 61 }, (_, k) => k / 40);
    const chart = plot({
      id: "impedance",
      width: right,
      height: 200,
      x: axis([0, 1.5], "depth / width", 0, 0.5, 1, 1.5),
      y: {
        domain: [0.89, 0.96],
        ticks: [
          [0.9, "0.90"],
          [0.92, "0.92"],
          [0.95, "0.95"],
        ],
        label: "impedance d",
      },
      lines: [{ model: "soft", xs, ys: xs.map((x) => ContactEngine.impedance(x * solimp[2], solimp)) }],
      points: [{ model: "soft", x: share, y: d, size: 6 }],
    });
    const r = Math.min(44, left * 0.36);
    const floor = 150;
    return {
      height: 200,
      markup: beside(
        left,
        chart,
        table(0, floor, left, 34),
        ball("soft", left / 2, floor - r + 20 * share, r),
      ),
      output: `depth = ${number(share * solimp[2] * 1000, 2)} mm`,
      words: `d = ${number(d)}: the contact takes ${number(100 * d)} % of what a hard one would; R = (1 − d) / d = ${number((1 - d) / d)} per unit of inverse mass. In the picture it is 1,000 times as deep.`,
    };
  }

  // ---- one-line: from a spring over MuJoCo's contact to lcp

  function softRest(d) {
    const run = runModel("soft", oneBall(R), { ...DEFAULTS, solimp: [d, d, 0.001, 0.5, 2] }, 1000);
    return (R - run.y[run.steps]) / R;
  }

  function oneLine(softness, width) {
    const d = 1 - softness;
    const rest = softRest(d);
    const spring = G / DEFAULTS.stiffness / R;
    const points = once("one-line", () => logGrid(1e-4, 0.1, 13).map((s) => [s, softRest(1 - s)]));
    const { left, right } = split(width, 0.26);
    const chart = plot({
      id: "one-line",
      width: right,
      height: 230,
      x: {
        domain: [1e-4, 0.1],
        log: true,
        ticks: [
          [1e-4, "0.9999"],
          [1e-2, "0.99"],
          [0.1, "0.9"],
        ],
        label: "impedance d",
      },
      y: {
        domain: [1e-6, 0.1],
        log: true,
        zero: true,
        ticks: ticksAt(0, 1e-5, 1e-3, 0.1),
        label: "rest depth / r",
      },
      lines: [{ model: "soft", xs: points.map((p) => p[0]), ys: points.map((p) => p[1]) }],
      rules: [
        { y: spring, text: `penalty ${number(spring)}`, class: "dashed" },
        { y: 0, text: "lcp 0", class: "dashed", side: "end" },
      ],
      points: [{ model: "soft", x: softness, y: rest, size: 6 }],
    });
    const r = Math.min(34, left * 0.34);
    const floor = 160;
    return {
      height: 230,
      markup: beside(
        left,
        chart,
        table(0, floor, left, 34),
        ball("soft", left / 2, floor - r + 100 * rest * r, r),
      ),
      output: `d = ${plain(Number(d.toFixed(5)))}`,
      words: `It rests ${number(rest)} r deep; (1 − d) g = d² K depth says so. In the picture it is a hundred times as deep.`,
    };
  }

  // ---- cliff: does the ball come to rest? against dt, with both critical steps

  // How much the ball still moves in the last quarter of a run [r]; a very large number if it exploded.
  function unrest(run) {
    let [low, high] = [Infinity, -Infinity];
    for (let row = Math.floor(0.75 * run.steps); row <= run.steps; row++) {
      low = Math.min(low, run.y[row]);
      high = Math.max(high, run.y[row]);
    }
    return Number.isFinite(high - low) ? Math.min(1e9, (high - low) / R) : 1e9;
  }

  const cliffSteps = logGrid(0.004, 0.064, 49);
  const cliffLine = (model, damping) =>
    cliffSteps.map((dt) =>
      unrest(runModel(model, oneBall(START), { ...DEFAULTS, dt, damping }, Math.floor(8 / dt))),
    );

  function cliff(damping, width) {
    const stiffness = DEFAULTS.stiffness;
    const critical = criticalDt(1, stiffness, damping);
    const solved = once("cliff", () => cliffLine("lcp", 0)); // lcp has no damper: computed once
    const chart = plot({
      id: "cliff",
      width,
      height: 260,
      top: 64,
      x: {
        domain: [0.004, 0.064],
        log: true,
        ticks: ticksAt(0.004, 0.008, 0.016, 0.032),
        label: "time step dt (s)",
      },
      y: {
        domain: [1e-6, 1e9],
        log: true,
        zero: true,
        label: "still moving after 6 s (r)",
        ticks: [
          [0, "0"],
          [1e-4, "10⁻⁴"],
          [1, "1"],
          [1e4, "10⁴"],
          [1e8, "10⁸"],
        ],
      },
      lines: [
        { model: "penalty", xs: cliffSteps, ys: cliffLine("penalty", damping), markers: [5, 15, 25, 35, 45] },
        { model: "lcp", xs: cliffSteps, ys: solved, markers: [10, 20, 30, 40] },
      ],
      rules: [
        {
          x: critical.undamped,
          text: `2√(m/k) ${number(critical.undamped)}`,
          class: "dashed",
          row: -2,
          side: width < 380 ? "end" : "start",
        },
        {
          x: critical.damped,
          text: `with damper ${number(critical.damped)}`,
          row: -1,
          side: critical.damped < 0.011 ? "start" : "end",
        },
      ],
    });
    return {
      height: 260,
      markup: chart.markup,
      output: `c = ${damping} N s/m`,
      words: `With this damper the drop can be stepped with dt below ${number(critical.damped)} s.`,
    };
  }

  // ---- the list: knob, caption, drawing

  const plainKnob = (low, high, step, value) => ({ low, high, step, value });
  const logKnob = (low, high, value) => ({ low, high, log: true, value });

  const FIGURES = {
    balance: {
      knob: logKnob(1e3, 1e5, 1e4),
      label: "Stiffness k",
      draw: balance,
      title: "A ball at rest on a spring: its weight against the push",
    },
    dive: {
      knob: plainKnob(0.42, 0.96, 0.002, 0.452),
      label: "Time",
      draw: dive,
      title: "The landing on a spring: deep, and thrown back",
    },
    "long-step": {
      knob: plainKnob(0.001, 0.03, 0.0005, 0.02),
      label: "Length of the step dt",
      draw: longStep,
      title: "One long step of a spring that is 0.2 r pressed",
    },
    corner: {
      knob: plainKnob(0.42, 0.9, 0.001, 0.452),
      label: "Time",
      draw: corner,
      title: "Gap and push of the dropped ball: the corner, and where each model is",
    },
    sweeps: {
      knob: plainKnob(0, 20, 1, 4),
      label: "Sweeps",
      draw: sweeps,
      title: "A stack at rest: the impulse of each contact, sweep by sweep",
    },
    clamp: {
      knob: plainKnob(0, 12, 1, 6),
      label: "Sweeps",
      draw: clamp,
      title: "A ball falls into a groove: the clamp on the sum against the clamp on each change",
    },
    larger: {
      knob: plainKnob(0.0005, 0.016, 0.0005, 0.004),
      label: "Time step dt",
      draw: larger,
      title: "The first bounce, by the larger of bounce and bias and by their sum",
    },
    hop: {
      knob: plainKnob(0, 1, 0.02, 0.2),
      label: "Baumgarte gain β",
      draw: hop,
      title: "After the landing: the bias velocity lifts the ball off the table",
    },
    bounces: {
      knob: plainKnob(0, 0.95, 0.01, 0.7),
      label: "Restitution e",
      draw: bounces,
      title: "Infinitely many bounces, over at a finite time",
    },
    cradle: {
      knob: plainKnob(0, 0.5, 0.01, 0),
      label: "Gaps between the balls",
      draw: cradle,
      title: "A ball strikes three: at one moment, or one after another",
    },
    slide: {
      knob: plainKnob(0, 0.6, 0.01, 0.36),
      label: "Time",
      draw: slide,
      title: "A ball slides off a ball that is held; where does each model let it go?",
    },
    impedance: {
      knob: plainKnob(0, 1.5, 0.05, 0.6),
      label: "Depth",
      draw: impedance,
      title: "MuJoCo’s impedance: the deeper, the harder",
    },
    "one-line": {
      knob: logKnob(1e-4, 0.1, 0.05),
      label: "From lcp to MuJoCo and beyond: 1 − d",
      draw: oneLine,
      title: "One line: impedance d takes soft from a spring’s give to lcp",
    },
    cliff: {
      knob: plainKnob(0, 200, 2, 80),
      label: "Damping c",
      draw: cliff,
      title: "The cliff: past the critical step the ball never rests",
    },
  };

  // One figure at a value of its knob, as a whole svg element and its words.
  // `open(id)` tells whether the answer of a bet may be seen.
  function render(name, value, width, open = () => false) {
    const figure = FIGURES[name];
    const drawn = figure.draw(value, width, open);
    return {
      ...drawn,
      svg: Plot.picture(width, drawn.height, `${figure.title}. ${drawn.words}`, drawn.markup),
    };
  }

  return { FIGURES, render, oneBall, logGrid, unrest, START };
})();
