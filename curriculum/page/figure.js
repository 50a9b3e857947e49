/* The live figure: three models fall on the same table. Everything shown is computed here by
 * engine.js when a knob moves; nothing is replayed. State lives in the address (its query part). */
"use strict";

const Figure = (() => {
  const { MODELS, svg, html, number, plain, plot, markerPath, decades } = Draw;
  const DATA = PAGE; // written into the page at build time, from contact.py
  const LANE = DATA.lane;
  const DURATION = 4; // s of simulated time, whatever dt is
  const DEFAULTS = { scene: "drop", seed: 0, speed: 4, zoom: 50, ...DATA.defaults };
  const STILL = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  const root = document.getElementById("figure");
  const $ = (id) => document.getElementById(id);

  // What a knob is: its range, how its slider is scaled, and its words.
  const KNOBS = {
    dt: { low: 0.0005, high: 0.064, log: true, digits: 3, unit: "s" },
    stiffness: { low: 100, high: 1e6, log: true, digits: 3, unit: "N/m" },
    damping: { low: 0, high: 300, step: 1, digits: 3, unit: "N s/m" },
    restitution: { low: 0, high: 1, step: 0.01, digits: 2, unit: "" },
    sweeps: { low: 1, high: 100, step: 1, digits: 3, whole: true, unit: "" },
    baumgarte: { low: 0, high: 1, step: 0.01, digits: 2, unit: "" },
  };
  const SLIDER = 400; // positions of a logarithmic slider: 1 % and 2 % a press
  const NOISE = 1e-13; // m: nearer than this is touching

  let state = {};
  let now = {}; // {scene, knobs, runs, quality, steps}
  let time = 0; // simulated seconds shown
  let playing = false;
  let played = false; // a run has been started once, by the page or the reader
  let charts = [];

  const ownKnobs = (scene) => ({
    damping: DATA.scenes[scene].damping,
    restitution: DATA.scenes[scene].restitution,
  });

  // ---- state and address

  function readAddress(text = location.search) {
    const query = new URLSearchParams(text);
    const scene = DATA.scenes[query.get("scene")] ? query.get("scene") : DEFAULTS.scene;
    state = { ...DEFAULTS, scene, ...ownKnobs(scene) };
    for (const [name, knob] of Object.entries(KNOBS)) {
      const given = Number(query.get(name));
      if (query.has(name) && given >= knob.low && given <= knob.high)
        state[name] = knob.whole ? Math.round(given) : given;
    }
    const seed = Number(query.get("seed"));
    if (Number.isInteger(seed) && seed >= 0 && seed < DATA.scenes.drop.starts.length) state.seed = seed;
    for (const [name, allowed] of [
      ["speed", [1, 4, 20]],
      ["zoom", [5, 50, 500]],
    ]) {
      if (allowed.includes(Number(query.get(name)))) state[name] = Number(query.get(name));
    }
    const at = Number(query.get("t"));
    return query.has("t") && at >= 0 && at <= DURATION ? at : null;
  }

  function address(withTime) {
    const query = new URLSearchParams();
    const base = { ...DEFAULTS, ...ownKnobs(state.scene) };
    for (const name of ["scene", ...Object.keys(KNOBS), "seed", "zoom", "speed"]) {
      if (state[name] !== base[name])
        query.set(name, typeof state[name] === "number" ? plain(state[name]) : state[name]);
    }
    if (withTime && time > 0) query.set("t", plain(time));
    const text = query.toString();
    return location.pathname + (text ? `?${text}` : "") + location.hash;
  }

  function remember(where) {
    try {
      history.replaceState(null, "", where);
    } catch {
      // a frame without an address of its own: the state is kept until the page is closed
    }
  }

  let addressTimer = 0;
  function writeAddress() {
    clearTimeout(addressTimer);
    addressTimer = setTimeout(() => remember(address(!playing)), 250);
  }

  // ---- computing

  function sceneNow() {
    const data = DATA.scenes[state.scene];
    const y = data.starts[state.seed];
    const zero = y.map(() => 0);
    return {
      x: zero,
      y,
      vx: zero,
      vy: zero,
      mass: y.map(() => 1),
      radius: y.map(() => DATA.radius),
      restitution: state.restitution,
      damping: state.damping,
    };
  }

  function simulate() {
    const scene = sceneNow();
    const knobs = {
      dt: state.dt,
      stiffness: state.stiffness,
      damping: state.damping,
      restitution: state.restitution,
      sweeps: state.sweeps,
      baumgarte: state.baumgarte,
    };
    const steps = Math.max(1, Math.floor(DURATION / state.dt + 1e-9));
    const runs = {},
      quality = {},
      series = {};
    for (const model of MODELS) runs[model] = ContactEngine.runModel(model, scene, knobs, steps);
    for (const model of MODELS) {
      quality[model] = ContactEngine.quality(runs[model], scene, runs.exact);
      series[model] = ContactEngine.series(runs[model], scene);
    }
    now = { scene, knobs, steps, runs, quality, series };
  }

  const criticalDt = () => ContactEngine.criticalDt(1, state.stiffness, state.damping);
  const rowAt = (t) => Math.min(now.steps, Math.floor(t / state.dt + 1e-6));

  // ---- the lanes: table first, ball over it, so that a ball inside the table is seen inside it

  function drawLane(model, row) {
    const run = now.runs[model];
    const node = $(`lane-${model}`);
    const lens = { x: LANE.lens_x, y: LANE.lens_y, r: LANE.lens_r };
    const scale = LANE.scale;
    const radius = DATA.radius * scale;
    const top = (y) => LANE.floor - y * scale;
    const parts = [];
    parts.push(
      svg("rect", {
        x: 0,
        y: LANE.floor,
        width: LANE.width,
        height: LANE.height - LANE.floor,
        fill: `url(#hatch-${model})`,
        class: "table",
      }),
    );
    parts.push(svg("line", { x1: 0, x2: LANE.width, y1: LANE.floor, y2: LANE.floor, class: "table-top" }));
    const moving = svg("g", { "clip-path": `url(#air-${model})` });
    const deepest = now.series[model].deepestRow;
    let highest = -Infinity,
      known = true;
    for (let i = 0; i < run.n; i++) {
      const y = run.y[row * run.n + i];
      if (!Number.isFinite(y)) {
        known = false;
        continue;
      }
      highest = Math.max(highest, y);
      const cy = Math.max(-2000, Math.min(4000, top(y)));
      moving.append(svg("circle", { cx: LANE.width / 2, cy, r: radius, class: `ball m-${model}` }));
      moving.append(svg("path", { d: markerPath(model, LANE.width / 2, cy, 8), class: "ball-mark" }));
    }
    // the fall as outlines, up to the first landing
    for (let t = 0; t < Math.min(row, now.series[model].landing) * state.dt; t += 0.05) {
      for (let i = 0; i < run.n; i++)
        parts.push(
          svg("circle", {
            cx: LANE.width / 2,
            cy: Draw.round(top(run.y[rowAt(t) * run.n + i])),
            r: radius,
            class: "strobe",
          }),
        );
    }
    if (row > deepest && now.series[model].depth[deepest] > 0.02 * DATA.radius) {
      const cy = top(run.y[deepest * run.n]);
      if (cy < 2000)
        moving.prepend(svg("circle", { cx: LANE.width / 2, cy, r: radius, class: `ghost m-${model}` }));
    }
    parts.push(moving);
    const escaped = !known || top(highest) < -radius;
    if (escaped)
      parts.push(
        svg("path", { d: `M${LANE.width / 2} 10l16 26h-10v26h-12v-26h-10z`, class: `ball m-${model}` }),
      );
    // the lens
    parts.push(
      svg("path", {
        d: `M${LANE.width / 2 - 3} ${LANE.floor}L${lens.x - lens.r * 0.94} ${lens.y - lens.r * 0.34}M${LANE.width / 2 + 3} ${LANE.floor}L${lens.x + lens.r * 0.94} ${lens.y - lens.r * 0.34}`,
        class: "lens-ray",
      }),
    );
    parts.push(svg("circle", { cx: lens.x, cy: lens.y, r: lens.r, class: "lens-glass" }));
    const inside = svg("g", { "clip-path": `url(#glass-${model})` });
    inside.append(
      svg("rect", {
        x: lens.x - lens.r,
        y: lens.y,
        width: 2 * lens.r,
        height: lens.r,
        fill: `url(#hatch-${model})`,
        class: "table",
      }),
    );
    inside.append(
      svg("line", { x1: lens.x - lens.r, x2: lens.x + lens.r, y1: lens.y, y2: lens.y, class: "table-top" }),
    );
    const zoom = scale * state.zoom;
    const y0 = run.y[row * run.n];
    if (Number.isFinite(y0)) {
      const bottom = (y0 - DATA.radius) * zoom;
      if (Math.abs(bottom) < 40 * lens.r) {
        const r = DATA.radius * zoom;
        inside.append(svg("circle", { cx: lens.x, cy: lens.y - bottom - r, r, class: `ball m-${model}` }));
      } else if (bottom < 0) {
        inside.append(
          svg("rect", {
            x: lens.x - lens.r,
            y: lens.y - lens.r,
            width: 2 * lens.r,
            height: 2 * lens.r,
            class: `ball m-${model}`,
          }),
        );
      }
    }
    if (model === "penalty") {
      const at = lens.y + weightOverK() * zoom;
      inside.append(
        svg("line", { x1: lens.x - lens.r, x2: lens.x + lens.r, y1: at, y2: at, class: "sink-line" }),
      );
    }
    parts.push(inside);
    parts.push(svg("circle", { cx: lens.x, cy: lens.y, r: lens.r, class: "lens-rim" }));
    node.querySelector(".moving").replaceChildren(...parts);
    // in words, under the lane
    const depth = now.series[model].depth[row];
    const gap = y0 - DATA.radius;
    const words = !known
      ? "gone: not a number any more"
      : escaped
        ? `${number(highest)} m up, out of view`
        : depth > NOISE
          ? `${number(depth / DATA.radius)} r deep`
          : gap < NOISE
            ? "on the table"
            : `${number(gap)} m above`;
    $(`now-${model}`).textContent = words;
    if (!playing) node.setAttribute("aria-label", `${model}: ${words}, the lens shows the lowest contact`);
  }

  // How far the lowest ball must sink for its spring to carry all the weight that stands on it.
  const weightOverK = () => (now.scene.y.length * -ContactEngine.GRAVITY) / state.stiffness;

  // ---- the charts

  // Widths are read when the layout changes, not at every redraw: reading them is the slow part.
  const widths = { chart: 0, axis: 0 };
  function measureWidths() {
    const before = `${widths.chart} ${widths.axis}`;
    widths.chart = Math.max(280, Math.floor($("chart-height").parentElement.clientWidth));
    widths.axis = Math.max(260, Math.floor($("dt-axis").parentElement.clientWidth));
    return before !== `${widths.chart} ${widths.axis}`;
  }

  function drawCharts() {
    const width = widths.chart;
    const left = 52; // the same for all three, so that one cursor runs through them
    const xs = now.runs.exact.t;
    const seconds = {
      domain: [0, DURATION],
      ticks: [0, 1, 2, 3, 4].map((t) => [t, String(t)]),
      label: "time (s)",
    };
    const bare = { domain: [0, DURATION], ticks: [] };
    // markers sit at times of their own for each model, so that lines on top of one another still show
    const marks = (model) => [0.35, 1.35, 2.35, 3.35].map((t) => rowAt(t + 0.22 * MODELS.indexOf(model)));
    const lines = (pick) =>
      MODELS.map((model) => ({
        model,
        xs,
        ys: pick(now.series[model], now.runs[model]),
        markers: marks(model),
      }));
    const n = now.scene.y.length;
    const heights = [];
    for (const model of MODELS) {
      for (let i = 0; i < n; i++) {
        heights.push({
          model,
          xs,
          ys: now.series[model].heights[i],
          markers: i === n - 1 ? marks(model) : [],
        });
      }
    }
    const r = DATA.radius;
    const deepest = Math.max(...MODELS.map((m) => now.series[m].finiteMax));
    const depthTop = Math.max(1, 10 ** Math.ceil(Math.log10(Math.max(deepest / r, 1e-9))));
    const sink = weightOverK() / r;
    const weight = n === 1 ? "m g / k" : `${n} m g / k`;
    const gain = Math.max(...MODELS.map((m) => now.series[m].energyMax));
    const energyAxis =
      gain > 5
        ? { domain: [0.01, Math.min(1e12, 10 ** Math.ceil(Math.log10(gain) + 1e-9))], log: true, zero: true }
        : { domain: [0, Math.max(1.2, 1.1 * gain)] };
    energyAxis.ticks =
      gain > 5
        ? [[0, "0"], ...decades(energyAxis.domain[0], energyAxis.domain[1], 4)]
        : gain > 2.2
          ? [0, 1, 2, 3, 4, 5].filter((v) => v <= energyAxis.domain[1]).map((v) => [v, String(v)])
          : [
              [0, "0"],
              [0.5, "0.5"],
              [1, "1"],
            ];
    energyAxis.label = gain > 5 ? "energy / start (log; bottom is 0)" : "energy / start";
    charts = [
      plot($("chart-height"), {
        width,
        height: 190,
        left,
        x: bare,
        lines: heights,
        y: {
          domain: [-0.05, 1.15],
          ticks: [
            [0, "0"],
            [0.5, "0.5"],
            [1, "1"],
          ],
          label: n === 1 ? "height of the centre (m)" : "heights of the centres (m)",
        },
      }),
      plot($("chart-depth"), {
        width,
        height: 220,
        left,
        top: 32,
        x: bare,
        lines: lines((s) => s.depthInRadii),
        rules: [{ y: sink, text: weight, class: "dashed" }],
        y: {
          domain: [1e-6, depthTop],
          log: true,
          zero: true,
          ticks: [[0, "0"], ...decades(1e-6, depthTop, 4)],
          label: "depth / r (log; bottom is 0)",
        },
      }),
      plot($("chart-energy"), {
        width,
        height: 220,
        left,
        x: seconds,
        lines: lines((s) => s.energy),
        rules: [{ y: 1 }],
        y: energyAxis,
      }),
    ];
    for (const [at, chart] of charts.entries()) {
      chart.cursor = svg("line", { y1: chart.box.top, y2: chart.box.bottom, class: "cursor" });
      [$("chart-height"), $("chart-depth"), $("chart-energy")][at].append(chart.cursor);
    }
  }

  // ---- the dt axis, to true scale, with both critical steps on it

  const share = (knob, value) =>
    knob.log
      ? Math.log(value / knob.low) / Math.log(knob.high / knob.low)
      : (value - knob.low) / (knob.high - knob.low);

  function drawDtAxis() {
    const node = $("dt-axis");
    const width = widths.axis;
    const pad = 22; // half a slider thumb: the axis lines up with the slider above it
    const height = 92;
    node.setAttribute("viewBox", `0 0 ${width} ${height}`);
    node.setAttribute("width", width);
    node.setAttribute("height", height);
    const at = (dt) => pad + Math.min(1, Math.max(0, share(KNOBS.dt, dt))) * (width - 2 * pad);
    const parts = [svg("line", { x1: pad, x2: width - pad, y1: 4, y2: 4, class: "axis" })];
    const grid = [0.0005, 0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064];
    const every = width < 520 ? 2 : 1;
    grid.forEach((dt, i) => {
      parts.push(svg("line", { x1: at(dt), x2: at(dt), y1: 4, y2: 11, class: "axis" }));
      if (i % every === (every === 2 ? 1 : 0))
        parts.push(
          svg(
            "text",
            {
              x: at(dt),
              y: 26,
              class: "tick",
              "text-anchor": i === 7 && every === 1 ? "end" : i === 7 ? "end" : i === 0 ? "start" : "middle",
            },
            String(dt),
          ),
        );
    });
    const critical = criticalDt();
    const marks = [
      [critical.damped, `with the damper ${number(critical.damped)}`, 50],
      [critical.undamped, `2√(m/k) ${number(critical.undamped)}`, 74],
    ];
    for (const [dt, words, y] of marks) {
      const off = dt > KNOBS.dt.high ? " →" : dt < KNOBS.dt.low ? "← " : "";
      const x = at(dt);
      const left = x > width / 2;
      // the line passes over the axis and goes on below the numbers, not through them
      parts.push(
        svg("path", {
          d: `M${Draw.round(x)} 0V13M${Draw.round(x)} 30V${y + 4}`,
          class: y === 50 ? "rule" : "rule dashed",
        }),
      );
      const label = off === "← " ? off + words : words + off;
      parts.push(
        svg(
          "text",
          { x: x + (left ? -6 : 6), y, class: "tick strong", "text-anchor": left ? "end" : "start" },
          label,
        ),
      );
    }
    node.replaceChildren(
      svg(
        "title",
        {},
        `Critical time steps of penalty: ${number(critical.damped)} s with its damper, ${number(critical.undamped)} s by the formula without one.`,
      ),
      ...parts,
    );
  }

  // ---- tables and words

  function verdict(model) {
    const q = now.quality[model];
    if (!q.blew_up) return "ok";
    return `EXPLODED at ${number(q.blew_up_step * state.dt)} s`;
  }

  function writeResults() {
    const rows = [
      ["deepest / r", (q) => number(q.max_penetration_frac)],
      ["at the end / r", (q) => number(q.rest_penetration_frac)],
      ["energy above start", (q) => number(q.energy_excess)],
      ["energy put in by contact", (q) => number(q.contact_energy)],
      ["height error / r", (q) => (q.height_error_frac === null ? "–" : number(q.height_error_frac))],
      ["jitter / r", (q) => number(q.rest_jitter)],
    ];
    const body = rows.map(([name, pick]) =>
      html(
        "tr",
        {},
        html("th", { scope: "row" }, name),
        ...MODELS.map((model) => html("td", {}, pick(now.quality[model]))),
      ),
    );
    body.push(
      html(
        "tr",
        { class: "verdict" },
        html("th", { scope: "row" }, "verdict"),
        ...MODELS.map((model) => html("td", {}, verdict(model))),
      ),
    );
    $("results-body").replaceChildren(...body);
    for (const model of MODELS) $(`verdict-${model}`).textContent = verdict(model);
    $("command").textContent = command();
    const critical = criticalDt();
    $("sink-note").textContent =
      `${now.scene.y.length === 1 ? "m g / k" : `${now.scene.y.length} m g / k`} = ${number(1000 * weightOverK())} mm = ${number(weightOverK() / DATA.radius)} r`;
    $("dt-note").textContent =
      state.dt >= critical.damped ? "dt is past penalty's limit." : "dt is within penalty's limit.";
  }

  function command() {
    const own = ownKnobs(state.scene);
    const flags = [`--scene ${state.scene}`];
    const flag = {
      dt: "--dt",
      stiffness: "--stiffness",
      damping: "--damping",
      restitution: "--restitution",
      sweeps: "--iters",
      baumgarte: "--baumgarte",
      seed: "--seed",
    };
    for (const [name, text] of Object.entries(flag)) {
      if (state[name] !== { ...DEFAULTS, ...own }[name]) flags.push(`${text} ${plain(state[name])}`);
    }
    if (now.steps !== 2000) flags.push(`--steps ${now.steps}`);
    return `python contact.py ${flags.join(" ")}`;
  }

  let sayTimer = 0;
  function say(words) {
    clearTimeout(sayTimer);
    sayTimer = setTimeout(() => {
      $("figure-status").textContent = words;
    }, 500);
  }

  // ---- inside one step

  // Balls are numbered from the table up; of a pair i < j the second stands on the first.
  const contactName = (c) => (c.j < 0 ? `${c.i + 1} on table` : `${c.j + 1} on ${c.i + 1}`);
  const eventWords = (e) =>
    `${e.j < 0 ? `ball ${e.i + 1} meets the table` : `ball ${e.j + 1} meets ball ${e.i + 1}`} at ${number(e.closing)} m/s, ${e.leaving > 1e-13 ? `leaves at ${number(e.leaving)} m/s` : "stays"}`;

  function writeInside() {
    if (!$("inside").open) return;
    const row = Math.min(rowAt(time), now.steps - 1);
    $("inside-when").textContent =
      `The step from t = ${plain(row * state.dt)} s to ${plain((row + 1) * state.dt)} s. Balls are numbered from the table up.`;
    // penalty
    const springs = [];
    ContactEngine.penaltyStep(ContactEngine.stateAt(now.runs.penalty, row), now.scene, now.knobs, springs);
    const penalty = springs.length
      ? [
          tableOf(
            ["contact", "gap (mm)", "v_n (m/s)", "force (N)"],
            springs.map((s) => [contactName(s), number(1000 * s.gap), number(s.speed), number(s.force)]),
          ),
          html(
            "p",
            {},
            `Force = max(0, k depth − c v_n). The weight of a ball is ${number(-ContactEngine.GRAVITY)} N.`,
          ),
        ]
      : [html("p", {}, "No contact: only gravity acts.")];
    $("inside-penalty").replaceChildren(...penalty);
    // lcp
    const trace = {};
    ContactEngine.lcpStep(ContactEngine.stateAt(now.runs.lcp, row), now.scene, now.knobs, trace);
    const lcp = [];
    if (trace.contacts.length) {
      lcp.push(
        tableOf(
          ["contact", "gap (mm)", "v_n (m/s)", "target (m/s)"],
          trace.contacts.map((c) => [
            contactName(c),
            number(1000 * c.gap),
            number(c.speed),
            number(c.target),
          ]),
        ),
      );
      lcp.push(
        tableOf(
          ["sweep", ...trace.contacts.map((c) => `lam, ${contactName(c)}`)],
          trace.sweeps.map((lam, s) => [String(s + 1), ...lam.map((v) => number(v, 6))]),
        ),
      );
      lcp.push(
        html(
          "p",
          {},
          trace.sweeps.length < state.sweeps
            ? `The last sweep changed nothing, so the other ${state.sweeps - trace.sweeps.length} are left out.`
            : `All ${state.sweeps} sweeps were used; the last one still changed something. lam is in N s.`,
        ),
      );
    } else lcp.push(html("p", {}, "No contact nearer than 1 mm: only gravity acts."));
    $("inside-lcp").replaceChildren(...lcp);
    // exact
    const from = row * state.dt,
      to = (row + 1) * state.dt;
    const events = now.runs.exact.events.filter((e) => e.t > from - 1e-12 && e.t <= to);
    const exact = events.slice(0, 20).map((e) => html("li", {}, `${number(e.t, 7)} s: ${eventWords(e)}`));
    $("inside-exact").replaceChildren(
      exact.length
        ? html("ol", {}, ...exact)
        : html("p", {}, "No event in this step: every ball follows its parabola or stays at rest."),
      ...(events.length > 20 ? [html("p", {}, `and ${events.length - 20} more impacts in this step`)] : []),
    );
  }

  function tableOf(head, rows) {
    return html(
      "div",
      { class: "scroll", tabindex: "0", role: "group", "aria-label": `Table: ${head.join(", ")}` },
      html(
        "table",
        {},
        html("thead", {}, html("tr", {}, ...head.map((h) => html("th", { scope: "col" }, h)))),
        html(
          "tbody",
          {},
          ...rows.map((cells) =>
            html(
              "tr",
              {},
              html("th", { scope: "row" }, cells[0]),
              ...cells.slice(1).map((c) => html("td", {}, c)),
            ),
          ),
        ),
      ),
    );
  }

  // ---- showing a time

  function seek(t, fromPlay) {
    time = Math.min(DURATION, Math.max(0, t));
    const row = rowAt(time);
    for (const model of MODELS) drawLane(model, row);
    for (const chart of charts) {
      const x = chart.sx(Math.min(row * state.dt, DURATION));
      chart.cursor.setAttribute("x1", x);
      chart.cursor.setAttribute("x2", x);
    }
    const scrub = $("scrub");
    scrub.value = String(row);
    scrub.setAttribute("aria-valuetext", `${number(row * state.dt)} seconds, step ${row} of ${now.steps}`);
    $("clock").textContent = `t = ${(row * state.dt).toFixed(3)} s, step ${row} of ${now.steps}`;
    if (!fromPlay) {
      writeInside();
      writeAddress();
    }
  }

  function refresh(announce) {
    simulate();
    $("scrub").max = String(now.steps);
    drawCharts();
    drawDtAxis();
    writeResults();
    seek(time);
    if (announce)
      say(
        MODELS.map(
          (m) => `${m}: ${verdict(m)}, deepest ${number(now.quality[m].max_penetration_frac)} r`,
        ).join("; "),
      );
  }

  // ---- the clock

  let lastFrame = 0;
  function frame(stamp) {
    if (!playing) return;
    const passed = Math.min(0.1, (stamp - lastFrame) / 1000);
    lastFrame = stamp;
    seek(time + passed / state.speed, true);
    if (time >= DURATION) pause();
    else requestAnimationFrame(frame);
  }

  function run() {
    if (time >= DURATION - 1e-9) time = 0;
    playing = played = true;
    $("run").textContent = "Pause";
    $("run").setAttribute("data-state", "running");
    lastFrame = performance.now();
    requestAnimationFrame(frame);
  }

  function pause() {
    playing = false;
    $("run").textContent = "Run";
    $("run").setAttribute("data-state", "paused");
    seek(time);
  }

  function step(by) {
    if (playing) pause();
    seek((Math.min(now.steps, Math.max(0, rowAt(time) + by)) + 1e-4) * state.dt);
  }

  // ---- controls

  function toSlider(knob, value) {
    return knob.log ? Math.round(share(knob, value) * SLIDER) : value;
  }

  function fromSlider(knob, position) {
    if (!knob.log) return position;
    return Number((knob.low * (knob.high / knob.low) ** (position / SLIDER)).toPrecision(knob.digits));
  }

  function showKnob(name) {
    const knob = KNOBS[name];
    const slider = $(`${name}-range`),
      field = $(`${name}-number`);
    slider.value = String(toSlider(knob, state[name]));
    slider.setAttribute("aria-valuetext", `${plain(state[name])} ${knob.unit}`.trim());
    if (document.activeElement !== field) field.value = plain(state[name]);
    field.setAttribute("aria-invalid", "false");
    $(`${name}-error`).textContent = "";
  }

  function showState() {
    for (const name of Object.keys(KNOBS)) showKnob(name);
    for (const [name, value] of [
      ["scene", state.scene],
      ["speed", state.speed],
      ["zoom", state.zoom],
    ]) {
      const radio = root.querySelector(`input[name="${name}"][value="${value}"]`);
      if (radio) radio.checked = true;
    }
    $("seed").value = String(state.seed);
    $("speed-note").textContent = {
      1: "Real speed.",
      4: "Slow motion: ¼ of real speed.",
      20: "Slow motion: 1/20 of real speed.",
    }[state.speed];
  }

  function set(changes, announce = true) {
    Object.assign(state, changes);
    showState();
    refresh(announce);
  }

  // A link of presets: take its state without loading the page again.
  function follow(link) {
    const query = new URL(link.href, location.href).search;
    remember(`${location.pathname + query}#figure`);
    readAddress(query);
    showState();
    time = 0;
    refresh(true);
    root.scrollIntoView({ behavior: STILL ? "auto" : "smooth", block: "start" });
    if (STILL) seek(DURATION);
    else run();
  }

  function listen() {
    for (const [name, knob] of Object.entries(KNOBS)) {
      const range = {
        min: knob.log ? 0 : knob.low,
        max: knob.log ? SLIDER : knob.high,
        step: knob.log ? 1 : knob.step,
      };
      Object.assign($(`${name}-range`), range);
      $(`${name}-range`).addEventListener("input", (event) =>
        set({ [name]: fromSlider(knob, Number(event.target.value)) }),
      );
      const field = $(`${name}-number`);
      field.addEventListener("change", () => {
        const value = Number(field.value);
        const good =
          field.value.trim() !== "" &&
          value >= knob.low &&
          value <= knob.high &&
          (!knob.whole || Number.isInteger(value));
        if (good) {
          set({ [name]: value });
          return;
        }
        field.setAttribute("aria-invalid", "true");
        $(`${name}-error`).textContent =
          `${field.value || "Nothing"} is not allowed: ${knob.whole ? "a whole number " : ""}${plain(knob.low)} to ${plain(knob.high)}.`;
      });
      field.addEventListener("blur", () => {
        if (field.getAttribute("aria-invalid") === "true") return;
        field.value = plain(state[name]);
      });
    }
    for (const radio of root.querySelectorAll('input[name="scene"]')) {
      radio.addEventListener("change", () => {
        time = STILL ? DURATION : 0;
        set({ scene: radio.value, ...ownKnobs(radio.value) });
        if (!STILL && !playing) run();
      });
    }
    for (const name of ["speed", "zoom"]) {
      for (const radio of root.querySelectorAll(`input[name="${name}"]`)) {
        radio.addEventListener("change", () => {
          state[name] = Number(radio.value);
          showState();
          seek(time);
        });
      }
    }
    $("seed").addEventListener("change", (event) => set({ seed: Number(event.target.value) }));
    $("run").addEventListener("click", () => (playing ? pause() : run()));
    $("restart").addEventListener("click", () => {
      pause();
      seek(0);
    });
    $("step").addEventListener("click", () => step(1));
    $("back").addEventListener("click", () => step(-1));
    $("reset").addEventListener("click", () => {
      state = { ...DEFAULTS, ...ownKnobs(DEFAULTS.scene) };
      time = 0;
      set({});
    });
    $("to-contact").addEventListener("click", () => {
      if (playing) pause();
      const depth = now.series.penalty.depth;
      let row = 0;
      while (row < now.steps && !(depth[row] > 0)) row++;
      seek((row + 1e-4) * state.dt);
    });
    $("scrub").addEventListener("input", (event) => {
      if (playing) pause();
      seek((Number(event.target.value) + 1e-4) * state.dt);
    });
    $("inside").addEventListener("toggle", writeInside);
    for (const id of ["chart-height", "chart-depth", "chart-energy"]) {
      const node = $(id);
      const to = (event) => {
        const chart = charts[0];
        const x = event.clientX - node.getBoundingClientRect().left;
        if (playing) pause();
        seek((DURATION * (x - chart.box.left)) / (chart.box.right - chart.box.left));
      };
      node.addEventListener("pointerdown", (event) => {
        to(event);
        if (event.pointerType === "mouse") node.setPointerCapture(event.pointerId);
      });
      node.addEventListener("pointermove", (event) => {
        if (event.buttons & 1) to(event);
      });
    }
    for (const link of document.querySelectorAll("a[data-preset]")) {
      link.addEventListener("click", (event) => {
        event.preventDefault();
        follow(link);
      });
    }
    new ResizeObserver(() => {
      if (!measureWidths()) return;
      drawCharts();
      drawDtAxis();
      seek(time, true);
    }).observe($("chart-height").parentElement);
  }

  function start() {
    const at = readAddress();
    time = at ?? (STILL ? DURATION : 0);
    measureWidths();
    listen();
    showState();
    refresh(false);
    if (at !== null || STILL) return;
    // run once by itself, when the figure is first seen
    new IntersectionObserver(
      (entries, observer) => {
        if (!entries.some((entry) => entry.isIntersecting)) return;
        observer.disconnect();
        if (!played) run();
      },
      { threshold: 0.3 },
    ).observe($("lanes"));
  }

  return {
    start,
    address: () => location.origin + address(true),
    get state() {
      return state;
    },
    get now() {
      return now;
    },
    get time() {
      return time;
    },
    get playing() {
      return playing;
    },
    tableOf,
  };
})();
