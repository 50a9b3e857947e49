/* The small figures beside their paragraphs, and the puzzle. Each shows one idea and computes its
 * points with engine.js; the lines through them are the formulas. */
"use strict";

const Figures = (() => {
  const { svg, html, number, plot, decades } = Draw;
  const { runModel, criticalDt, GRAVITY } = ContactEngine;
  const R = PAGE.radius;
  const WEIGHT = -GRAVITY; // N, of one ball of 1 kg
  const $ = (id) => document.getElementById(id);

  const ball = (height, options = {}) => ({
    x: [0],
    y: [height],
    vx: [0],
    vy: [0],
    mass: [1],
    radius: [R],
    restitution: 0,
    ...options,
  });
  const drop = () => ball(PAGE.scenes.drop.starts[0][0]);
  const logGrid = (low, high, count) =>
    Array.from({ length: count }, (_, i) => low * (high / low) ** (i / (count - 1)));

  // How much the ball still moves in the last quarter of a run [r]; Infinity when it exploded.
  function unrest(run) {
    let low = Infinity,
      high = -Infinity;
    for (let row = Math.floor(0.75 * run.steps); row <= run.steps; row++) {
      low = Math.min(low, run.y[row]);
      high = Math.max(high, run.y[row]);
    }
    return Number.isFinite(high - low) ? (high - low) / R : Infinity;
  }

  function width(name) {
    return Math.max(280, Math.min(344, Math.floor($(`fig-${name}`).clientWidth)));
  }

  // ---- sink: what a stiffer spring buys, and what it costs

  function drawSink() {
    const k = Number((10 ** (3 + Number($("sink-slider").value) / 30)).toPrecision(3));
    const damping = PAGE.scenes.drop.damping;
    const ks = logGrid(1e3, 1e6, 61);
    const points = logGrid(1.5e3, 7e5, 6).map((stiffness) => {
      const dt = 0.5 * criticalDt(1, stiffness, damping).damped;
      const run = runModel(
        "penalty",
        ball(R),
        { dt, stiffness, damping },
        Math.min(20000, Math.ceil(4 / dt)),
      );
      return { model: "penalty", x: stiffness, y: (R - run.y[run.steps]) / R };
    });
    const x = { domain: [1e3, 1e6], log: true, ticks: decades(1e3, 1e6), label: "stiffness k (N/m)" };
    const size = width("sink");
    const [top, bottom] = $("fig-sink").querySelectorAll("svg.plot");
    plot(top, {
      width: size,
      height: 150,
      x: { ...x, ticks: [], label: null },
      y: { domain: [1e-4, 0.1], log: true, ticks: decades(1e-4, 0.1), label: "rest depth / r: m g / k" },
      lines: [{ model: "penalty", xs: ks, ys: ks.map((v) => WEIGHT / v / R) }],
      points,
      rules: [{ x: k }],
    });
    plot(bottom, {
      width: size,
      height: 190,
      x,
      y: { domain: [1e-3, 0.1], log: true, ticks: decades(1e-3, 0.1), label: "largest stable dt (s)" },
      lines: [{ model: "penalty", xs: ks, ys: ks.map((v) => criticalDt(1, v, damping).damped) }],
      rules: [{ x: k }],
    });
    $("sink-output").textContent = `k = ${number(k)} N/m`;
    $("sink-words").textContent =
      `It sinks ${number(WEIGHT / k / R)} r and needs dt below ${number(criticalDt(1, k, damping).damped)} s.`;
  }

  // ---- cliff: does the ball come to rest? against dt, with both critical steps

  function drawCliff() {
    const damping = 2 * Number($("cliff-slider").value);
    const stiffness = PAGE.defaults.stiffness;
    const dts = logGrid(0.004, 0.064, 80);
    const critical = criticalDt(1, stiffness, damping);
    const lines = ["penalty", "lcp"].map((model) => ({
      model,
      xs: dts,
      ys: dts.map((dt) =>
        Math.min(
          1e9,
          unrest(
            runModel(
              model,
              drop(),
              {
                dt,
                stiffness,
                damping,
                restitution: 0,
                baumgarte: PAGE.defaults.baumgarte,
                sweeps: PAGE.defaults.sweeps,
              },
              Math.floor(20 / dt),
            ),
          ),
        ),
      ),
      markers: model === "penalty" ? [8, 24, 40, 56, 72] : [16, 32, 48, 64],
    }));
    plot($("fig-cliff").querySelector("svg.plot"), {
      width: width("cliff"),
      height: 260,
      x: {
        domain: [0.004, 0.064],
        log: true,
        ticks: [0.004, 0.008, 0.016, 0.032].map((v) => [v, String(v)]),
        label: "time step dt (s)",
      },
      y: {
        domain: [1e-6, 1e9],
        log: true,
        zero: true,
        ticks: [
          [0, "0"],
          [1e-4, "1e−4"],
          [1, "1"],
          [1e4, "1e4"],
          [1e8, "1e8"],
        ],
        label: "still moving after 15 s (r)",
      },
      lines,
      top: 64,
      rules: [
        {
          x: critical.undamped,
          text: `2√(m/k) ${number(critical.undamped)}`,
          class: "dashed",
          row: -2,
          side: "start",
        },
        {
          x: critical.damped,
          text: `with damper ${number(critical.damped)}`,
          row: -1,
          side: critical.damped < 0.011 ? "start" : "end",
        },
      ],
    });
    $("cliff-output").textContent = `c = ${damping} N s/m`;
  }

  // ---- bounces: infinitely many, and over at a finite time

  function drawBounces() {
    const e = Number($("bounces-slider").value) / 100;
    const scene = drop();
    scene.restitution = e;
    const first = Math.sqrt((2 * (scene.y[0] - R)) / WEIGHT);
    const end = (first * (1 + e)) / (1 - e);
    const until = Math.max(1, 1.15 * end);
    const steps = 600;
    const run = runModel("exact", scene, { dt: until / steps }, steps);
    const impacts = run.events.length;
    const span = 10 ** Math.floor(Math.log10(until));
    const tick = until / span > 5 ? 2 * span : until / span > 2 ? span : span / 2;
    const ticks = [];
    for (let t = 0; t <= until; t += tick) ticks.push([t, Draw.plain(t)]);
    plot($("fig-bounces").querySelector("svg.plot"), {
      width: width("bounces"),
      height: 210,
      x: { domain: [0, until], ticks, label: "time (s)" },
      y: {
        domain: [0, 1.1],
        ticks: [
          [0, "0"],
          [0.5, "0.5"],
          [1, "1"],
        ],
        label: "height (m)",
      },
      lines: [{ model: "exact", xs: run.t, ys: Array.from(run.y) }],
      rules: [{ x: end, text: `over at ${number(end)} s`, class: "dashed" }],
    });
    $("bounces-output").textContent = `e = ${e.toFixed(2)}`;
    $("bounces-words").textContent =
      `${impacts} impact${impacts === 1 ? "" : "s"} until a bounce is lower than 1e−15 r.`;
  }

  // ---- sweeps: lam of the three contacts of a resting stack, after each sweep

  function drawSweeps() {
    const y = [1, 3, 5].map((a) => a * R);
    const zero = [0, 0, 0];
    const scene = { x: zero, y, vx: zero, vy: zero, mass: [1, 1, 1], radius: [R, R, R], restitution: 0 };
    const dt = PAGE.defaults.dt;
    const trace = {};
    ContactEngine.lcpStep(scene, scene, { dt, restitution: 0, baumgarte: 0, sweeps: 20 }, trace);
    const shown = Math.round(Number($("sweeps-slider").value) / 5);
    const unit = WEIGHT * dt;
    const values = trace.contacts.map((_, c) => [0, ...trace.sweeps.map((lam) => lam[c] / unit)]);
    const names = ["ball 1 on the table", "ball 2 on 1", "ball 3 on 2"];
    plot($("fig-sweeps").querySelector("svg.plot"), {
      width: width("sweeps"),
      height: 220,
      x: { domain: [0, 20], ticks: [0, 5, 10, 15, 20].map((v) => [v, String(v)]), label: "sweep" },
      y: { domain: [0, 3.4], ticks: [0, 1, 2, 3].map((v) => [v, String(v)]), label: "lam / (m g dt)" },
      lines: values.map((ys) => ({
        model: "lcp",
        xs: ys.map((_, s) => s),
        ys,
        markers: ys.map((_, s) => s),
      })),
      rules: [{ y: 3, class: "dashed" }, { y: 2, class: "dashed" }, { y: 1, class: "dashed" }, { x: shown }],
    });
    const at = Math.min(shown, values[0].length - 1);
    $("sweeps-output").textContent = `after ${shown} sweep${shown === 1 ? "" : "s"}`;
    $("sweeps-words").textContent =
      `${values.map((ys, c) => `${names[c]}: ${number(ys[at])}`).join("; ")}. They should carry 3, 2 and 1 balls.`;
  }

  const SMALL = {
    sink: [drawSink, 30],
    cliff: [drawCliff, 40],
    bounces: [drawBounces, 70],
    sweeps: [drawSweeps, 100],
  };

  // Draw a figure when it comes near, and again as its slider moves.
  function startSmall() {
    for (const [name, [draw, value]] of Object.entries(SMALL)) {
      const figure = $(`fig-${name}`);
      if (!figure) continue;
      const slider = $(`${name}-slider`);
      slider.max = { bounces: "95", sink: "90" }[name] || "100";
      slider.value = String(value);
      const words = html("p", { class: "note words", id: `${name}-words` });
      slider.parentElement.append(words);
      const redraw = () => {
        draw();
        slider.setAttribute("aria-valuetext", $(`${name}-output`).textContent);
      };
      slider.addEventListener("input", redraw);
      new IntersectionObserver(
        (entries, observer) => {
          if (!entries.some((entry) => entry.isIntersecting)) return;
          observer.disconnect();
          redraw();
        },
        { rootMargin: "400px" },
      ).observe(figure);
    }
  }

  // ---- the puzzle

  const GOAL = { dt: 0.01, depth: 0.001, seconds: 40 };
  const EXPLODED = 10;

  // One try, step by step so that it can end early: {outcome: "rests" | "never rests" | "explodes"}.
  function attempt(stiffness, damping) {
    const scene = drop();
    const knobs = { dt: GOAL.dt, stiffness, damping };
    const steps = Math.round(GOAL.seconds / GOAL.dt);
    const limit = (1 + EXPLODED) * WEIGHT * scene.y[0];
    let state = scene,
      low = Infinity,
      high = -Infinity;
    for (let row = 1; row <= steps; row++) {
      const next = ContactEngine.penaltyStep(state, scene, knobs);
      const y = next.y[0],
        v = next.vy[0];
      if (!(0.5 * v * v + WEIGHT * y < limit)) return { outcome: "explodes", when: row * GOAL.dt };
      if (y === state.y[0] && v === state.vy[0]) return { outcome: "rests", depth: (R - y) / R };
      if (row >= 0.75 * steps) {
        low = Math.min(low, y);
        high = Math.max(high, y);
      }
      state = next;
    }
    const moving = (high - low) / R;
    return moving > 1e-3
      ? { outcome: "never rests", moving }
      : { outcome: "rests", depth: (R - state.y[0]) / R };
  }

  function startPuzzle() {
    if (!$("puzzle")) return;
    const K = { low: 1e3, high: 1e6 };
    const C = { low: 0, high: 240 };
    const tries = [];
    let map = null;
    let shown = null;
    let timer = 0;
    const kOf = () =>
      Number((K.low * (K.high / K.low) ** (Number($("puzzle-k").value) / 200)).toPrecision(3));
    const cOf = () => Number($("puzzle-c").value);

    function draw() {
      const size = Math.max(
        280,
        Math.floor($("puzzle-map").parentElement.clientWidth / (window.innerWidth > 832 ? 2 : 1)) -
          (window.innerWidth > 832 ? 40 : 0),
      );
      const needed = WEIGHT / (GOAL.depth * R);
      const chart = plot($("puzzle-map"), {
        width: Math.min(size, 560),
        height: 320,
        x: { domain: [K.low, K.high], log: true, ticks: decades(K.low, K.high), label: "stiffness k (N/m)" },
        y: {
          domain: [C.low, C.high],
          ticks: [0, 50, 100, 150, 200].map((v) => [v, String(v)]),
          label: "damping c (N s/m)",
        },
        rules: map ? [{ x: needed, text: "sinks < 0.001 r →", class: "dashed" }] : [],
      });
      if (map) {
        const dx = (chart.box.right - chart.box.left) / map.columns,
          dy = (chart.box.bottom - chart.box.top) / map.rows;
        const cells = map.cells.map(({ column, row, outcome }) =>
          svg("rect", {
            x: Draw.round(chart.box.left + column * dx),
            y: Draw.round(chart.box.bottom - (row + 1) * dy),
            width: Draw.round(dx + 0.2),
            height: Draw.round(dy + 0.2),
            class:
              outcome === "rests" ? "map-settles" : outcome === "never rests" ? "map-never" : "map-explodes",
          }),
        );
        chart.inside.prepend(...cells);
        // where the formula says stability ends: k dt^2 + 2 c dt = 4 m
        const ks = logGrid(K.low, 4 / GOAL.dt ** 2, 80);
        const path = ks
          .map(
            (k, i) =>
              `${i ? "L" : "M"}${Draw.round(chart.sx(k))} ${Draw.round(chart.sy((4 - k * GOAL.dt ** 2) / (2 * GOAL.dt)))}`,
          )
          .join("");
        chart.inside.append(svg("path", { d: path, class: "line m-penalty" }));
      }
      for (const a of new Set([...tries, shown])) {
        const x = chart.sx(a.k),
          y = chart.sy(a.c);
        const last = a === shown;
        const shape =
          a.outcome === "explodes"
            ? `M${x - 5} ${y - 5}l10 10m0 -10l-10 10`
            : `M${x - 5} ${y}a5 5 0 1 0 10 0a5 5 0 1 0 -10 0Z`;
        if (last) chart.inside.append(svg("circle", { cx: x, cy: y, r: 12, class: "map-now" }));
        chart.inside.append(
          svg("path", {
            d: shape,
            class: a.outcome === "explodes" || a.outcome === "never rests" ? "map-old" : "map-try",
          }),
        );
      }
      $("puzzle-key").textContent = map
        ? "Measured in your browser, a drop a cell. Dark: comes to rest. Pale: never rests. Empty: explodes. Coloured line: the formula k dt² + 2 c dt = 4 m."
        : "Each try leaves a mark: a disc where the ball comes to rest, a ring where it never does, a cross where it explodes.";
    }

    function show() {
      $("puzzle-k-out").textContent = number(kOf(), 3) + " N/m";
      $("puzzle-c-out").textContent = `${cOf()} N s/m`;
      $("puzzle-k").setAttribute("aria-valuetext", `${kOf()} newtons per metre`);
    }

    function judge(keep) {
      const k = kOf(),
        c = cOf();
      const result = { k, c, ...attempt(k, c) };
      if (keep) tries.push(result);
      shown = result;
      const sinks = WEIGHT / k / R;
      const sink = $("goal-sink"),
        rest = $("goal-rest");
      sink.toggleAttribute("data-met", sinks < GOAL.depth);
      sink.textContent = `Sinks m g / k = ${number(sinks)}\u00a0r; wanted: less than ${GOAL.depth}\u00a0r.`;
      rest.toggleAttribute("data-met", result.outcome === "rests");
      rest.textContent =
        result.outcome === "rests"
          ? `Comes to rest at dt = 0.01 s, ${number(result.depth)} r deep.`
          : result.outcome === "explodes"
            ? `Explodes at dt = 0.01 s: more than ten times the energy gained after ${number(result.when)} s.`
            : `Never rests at dt = 0.01 s: it still moves ${number(result.moving)} r.`;
      const best = tries
        .filter((a) => a.outcome === "rests")
        .reduce((least, a) => Math.min(least, a.depth), Infinity);
      $("puzzle-tries").textContent = tries.length
        ? `${tries.length} tr${tries.length === 1 ? "y" : "ies"}. ${best < Infinity ? `Your least depth at rest so far: ${number(best)} r.` : "None has come to rest yet."}`
        : "";
      draw();
    }

    const moved = () => {
      show();
      clearTimeout(timer);
      timer = setTimeout(() => judge(true), 200);
    };
    $("puzzle-k").addEventListener("input", moved);
    $("puzzle-c").addEventListener("input", moved);

    // The whole map, a few columns at a time so that the page stays awake.
    function measureMap(done) {
      const columns = 48,
        rows = 24,
        cells = [];
      let column = 0;
      const work = () => {
        const until = performance.now() + 12;
        while (column < columns && performance.now() < until) {
          const k = K.low * (K.high / K.low) ** ((column + 0.5) / columns);
          for (let row = 0; row < rows; row++) {
            const c = C.low + ((row + 0.5) / rows) * (C.high - C.low);
            cells.push({ column, row, k, c, ...attempt(k, c) });
          }
          column++;
        }
        if (column < columns) setTimeout(work, 0);
        else done({ columns, rows, cells });
      };
      work();
    }

    $("puzzle-give").addEventListener("click", () => {
      $("puzzle-give").disabled = true;
      $("puzzle-key").textContent = "Measuring the whole map…";
      measureMap((result) => {
        map = result;
        draw();
        const settled = map.cells.filter((cell) => cell.outcome === "rests");
        const best = settled.reduce((a, b) => (b.depth < a.depth ? b : a));
        const limit = 2 * Math.sqrt((GOAL.depth * R) / WEIGHT);
        const why = $("puzzle-why");
        const stiff = WEIGHT / (GOAL.depth * R);
        const found = settled.filter((cell) => cell.depth < GOAL.depth).length;
        why.replaceChildren(
          html("h4", {}, found ? "The map disagrees with the formula" : "There is none"),
          html(
            "p",
            {},
            `To sink less than 0.001 r the spring needs k above m g / (0.001 r) = ${number(stiff, 4)} N/m. To let the ball rest, the step needs k dt² + 2 c dt < 4 m; at dt = 0.01 s and without a damper that is k below ${number(4 / GOAL.dt ** 2)} N/m. Any damper lowers it: c takes its share of the same 4 m. The two never meet.`,
          ),
          html(
            "p",
            {},
            `Measured here: of ${map.cells.length} drops over the map, ${settled.length} came to rest and ${found === 0 ? "none" : found} of them above the wanted stiffness. The least depth at rest was ${number(best.depth)} r, with k = ${number(best.k)} N/m and c = ${number(best.c)} N s/m. Close to the line a fall from a metre explodes where a ball set down gently would rest; the formula speaks of a ball that stays in contact.`,
          ),
          html(
            "p",
            {},
            `Put the two conditions together and both m and k drop out: a spring that sinks by d can only be stepped with dt below 2√(d/g). For 0.001 r that is ${number(limit)} s, whatever you tune. The way out is to stop using a spring: lcp rests at depth 0 with the same dt.`,
          ),
        );
        why.hidden = false;
        why.focus();
      });
    });
    show();
    judge(false);
    window.addEventListener("resize", draw);
  }

  function start() {
    startSmall();
    startPuzzle();
  }
  return { start, attempt, unrest, drop };
})();
