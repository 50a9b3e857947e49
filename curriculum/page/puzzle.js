/* The puzzle: one spring, two wishes that no stiffness fulfils together. The reader tries first; then
 * a map of the whole plane is measured, here. */
"use strict";

const Puzzle = (() => {
  const { number, plot, decades, el, round } = Plot;
  const { GRAVITY } = ContactEngine;
  const $ = (id) => document.getElementById(id);
  const WEIGHT = -GRAVITY; // N, of one ball of 1 kg
  const R = PAGE.radius;
  const GOAL = { dt: 0.01, depth: 0.001, seconds: 40 };
  const EXPLODED = 10;
  const K = { low: 1e3, high: 1e6 };
  const C = { low: 0, high: 240 };
  const tries = [];
  let map = null;
  let shown = null;

  // One try, step by step so that it can end early: {outcome: "rests" | "never rests" | "explodes"}.
  function attempt(stiffness, damping) {
    const scene = SmallFigures.oneBall(SmallFigures.START);
    const knobs = { dt: GOAL.dt, stiffness, damping };
    const steps = Math.round(GOAL.seconds / GOAL.dt);
    const limit = (1 + EXPLODED) * WEIGHT * scene.y[0];
    let state = scene;
    let [low, high] = [Infinity, -Infinity];
    for (let row = 1; row <= steps; row++) {
      const next = ContactEngine.penaltyStep(state, scene, knobs);
      const [y, v] = [next.y[0], next.vy[0]];
      if (!(0.5 * v * v + WEIGHT * y < limit)) return { outcome: "explodes", when: row * GOAL.dt };
      if (y === state.y[0] && v === state.vy[0]) return { outcome: "rests", depth: (R - y) / R };
      if (row >= 0.75 * steps) {
        low = Math.min(low, y);
        high = Math.max(high, y);
      }
      state = next;
    }
    const moving = (high - low) / R;
    if (moving > 1e-3) return { outcome: "never rests", moving };
    return { outcome: "rests", depth: (R - state.y[0]) / R };
  }

  const kOf = () => Number((K.low * (K.high / K.low) ** (Number($("puzzle-k").value) / 200)).toPrecision(3));
  const cOf = () => Number($("puzzle-c").value);

  // ---- the map

  function mapMarkup(chart) {
    if (!map) return "";
    const dx = (chart.box.right - chart.box.left) / map.columns;
    const dy = (chart.box.bottom - chart.box.top) / map.rows;
    const kinds = { rests: "map-settles", "never rests": "map-never", explodes: "map-explodes" };
    const cells = map.cells
      .filter(({ outcome }) => outcome !== "explodes")
      .map(({ column, row, outcome }) =>
        el("rect", {
          x: chart.box.left + column * dx,
          y: chart.box.bottom - (row + 1) * dy,
          width: dx + 0.2,
          height: dy + 0.2,
          class: kinds[outcome],
        }),
      );
    // where the formula says stability ends: k dt^2 + 2 c dt = 4 m
    const path = SmallFigures.logGrid(K.low, 4 / GOAL.dt ** 2, 80)
      .map(
        (k, i) =>
          `${i ? "L" : "M"}${round(chart.sx(k))} ${round(chart.sy((4 - k * GOAL.dt ** 2) / (2 * GOAL.dt)))}`,
      )
      .join("");
    return cells.join("") + el("path", { d: path, class: "line m-penalty" });
  }

  function tryMarkup(a, chart) {
    const [x, y] = [round(chart.sx(a.k)), round(chart.sy(a.c))];
    const cross = a.outcome === "explodes";
    const shape = cross
      ? `M${x - 5} ${y - 5}l10 10m0 -10l-10 10`
      : `M${x - 5} ${y}a5 5 0 1 0 10 0a5 5 0 1 0 -10 0Z`;
    const ring = a === shown ? el("circle", { cx: x, cy: y, r: 12, class: "map-now" }) : "";
    return ring + el("path", { d: shape, class: a.outcome === "rests" ? "map-try" : "map-old" });
  }

  function draw() {
    const width = Math.max(256, Math.min(560, Math.floor($("puzzle-map").clientWidth)));
    const needed = WEIGHT / (GOAL.depth * R);
    const chart = plot({
      id: "puzzle",
      width,
      height: 300,
      x: { domain: [K.low, K.high], log: true, ticks: decades(K.low, K.high), label: "stiffness k (N/m)" },
      y: {
        domain: [C.low, C.high],
        ticks: [0, 50, 100, 150, 200].map((v) => [v, String(v)]),
        label: "damping c (N s/m)",
      },
      rules: map ? [{ x: needed, text: "sinks < 0.001 r →", class: "dashed" }] : [],
    });
    const marks = [...new Set([...tries, shown])].map((a) => tryMarkup(a, chart));
    $("puzzle-map").innerHTML = Plot.picture(
      width,
      300,
      "Map of your tries: stiffness against damping",
      mapMarkup(chart),
      chart.markup,
      ...marks,
    );
    $("puzzle-key").textContent = map
      ? "Measured in your browser, a drop a cell. Dark: comes to rest. Pale: never rests. Empty: explodes. Coloured line: the formula k dt² + 2 c dt = 4 m."
      : "Each try leaves a mark: a disc where the ball comes to rest, a ring where it never does, a cross where it explodes.";
  }

  // ---- tries

  const outcomeWords = {
    rests: (a) => `Comes to rest at dt = 0.01 s, ${number(a.depth)} r deep.`,
    explodes: (a) =>
      `Explodes at dt = 0.01 s: more than ten times the energy gained after ${number(a.when)} s.`,
    "never rests": (a) => `Never rests at dt = 0.01 s: it still moves ${number(a.moving)} r.`,
  };

  function judge(keep) {
    const [k, c] = [kOf(), cOf()];
    shown = { k, c, ...attempt(k, c) };
    if (keep) tries.push(shown);
    const sinks = WEIGHT / k / R;
    $("goal-sink").toggleAttribute("data-met", sinks < GOAL.depth);
    $("goal-sink").textContent =
      `Sinks m g / k = ${number(sinks)}\u00a0r; wanted: less than ${GOAL.depth}\u00a0r.`;
    $("goal-rest").toggleAttribute("data-met", shown.outcome === "rests");
    $("goal-rest").textContent = outcomeWords[shown.outcome](shown);
    const resting = tries.filter((a) => a.outcome === "rests").map((a) => a.depth);
    const best = resting.length
      ? `Your least depth at rest so far: ${number(Math.min(...resting))} r.`
      : "None has come to rest yet.";
    $("puzzle-tries").textContent = tries.length
      ? `${tries.length} ${tries.length === 1 ? "try" : "tries"}. ${best}`
      : "";
    $("puzzle-give").disabled = !tries.length || map !== null;
    draw();
  }

  function show() {
    $("puzzle-k-out").textContent = `${number(kOf(), 3)} N/m`;
    $("puzzle-c-out").textContent = `${cOf()} N s/m`;
    $("puzzle-k").setAttribute("aria-valuetext", `${kOf()} newtons per metre`);
  }

  // ---- the answer, after a try

  // The whole map, a few columns at a time so that the page stays awake.
  function measureMap(done) {
    const [columns, rows, cells] = [48, 24, []];
    let column = 0;
    const work = () => {
      const until = performance.now() + 12;
      for (; column < columns && performance.now() < until; column++) {
        const k = K.low * (K.high / K.low) ** ((column + 0.5) / columns);
        for (let row = 0; row < rows; row++) {
          const c = C.low + ((row + 0.5) / rows) * (C.high - C.low);
          cells.push({ column, row, k, c, ...attempt(k, c) });
        }
      }
      if (column < columns) setTimeout(work, 0);
      else done({ columns, rows, cells });
    };
    work();
  }

  function explain() {
    const settled = map.cells.filter((cell) => cell.outcome === "rests");
    const best = settled.reduce((a, b) => (b.depth < a.depth ? b : a));
    const found = settled.filter((cell) => cell.depth < GOAL.depth).length;
    const stiff = number(WEIGHT / (GOAL.depth * R), 4);
    const soft = number(4 / GOAL.dt ** 2);
    const limit = number(2 * Math.sqrt((GOAL.depth * R) / WEIGHT));
    $("puzzle-why").innerHTML = [
      `<h4>${found ? "The map disagrees with the formula" : "There is none"}</h4>`,
      `<p>To sink less than 0.001 r the spring needs k above m g / (0.001 r) = ${stiff} N/m. To let the ball rest, the step needs k dt² + 2 c dt &lt; 4 m; at dt = 0.01 s and without a damper that is k below ${soft} N/m. Any damper lowers it: c takes its share of the same 4 m. The two never meet.</p>`,
      `<p>Measured here: of ${map.cells.length} drops over the map, ${settled.length} came to rest and ${found === 0 ? "none" : found} of them above the wanted stiffness. The least depth at rest was ${number(best.depth)} r, with k = ${number(best.k)} N/m and c = ${number(best.c)} N s/m. Close to the line a fall from a metre explodes where a ball set down gently would rest; the formula speaks of a ball that stays in contact.</p>`,
      `<p>Put the two conditions together and both m and k drop out: a spring that sinks by d can only be stepped with dt below 2√(d/g). For 0.001 r that is ${limit} s, whatever you tune. The way out is to stop using a spring: lcp rests at depth 0 with the same dt.</p>`,
    ].join("");
    $("puzzle-why").hidden = false;
    $("puzzle-why").focus();
  }

  function start() {
    if (!$("puzzle")) return;
    let timer = 0;
    const moved = () => {
      show();
      clearTimeout(timer);
      timer = setTimeout(() => judge(true), 200);
    };
    $("puzzle-k").addEventListener("input", moved);
    $("puzzle-c").addEventListener("input", moved);
    $("puzzle-give").addEventListener("click", () => {
      $("puzzle-give").disabled = true;
      $("puzzle-key").textContent = "Measuring the whole map…";
      measureMap((result) => {
        map = result;
        draw();
        explain();
        Bets.show("puzzle");
      });
    });
    show();
    judge(false);
    new ResizeObserver(draw).observe($("puzzle"));
  }

  return { start, attempt };
})();
