/* The live figure: four models meet the same table. Everything shown is computed here by engine.js
 * when a knob moves; nothing is replayed. The text sets its state by links and by numbers that can be
 * dragged; the state lives in the address. */
"use strict";

const Figure = (() => {
  const { number, plain, plot, steps, decades } = Plot;
  const { MODELS } = ContactEngine;
  const { KNOBS } = State;
  const DURATION = 4; // s of simulated time, whatever dt is
  const SECONDS = 5; // that a run through the visible window takes the reader
  const STILL = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  const root = document.getElementById("figure");
  const $ = (id) => document.getElementById(id);

  let state = {};
  let now = {}; // {scene, knobs, steps, runs, quality, series}
  let time = 0; // simulated seconds shown
  let view = [0, DURATION]; // the window of time that chart and scrubber show
  let kind = "gap"; // what the chart shows
  let lens = "auto";
  let playing = false;
  let chart = null;

  // ---- computing

  function simulate() {
    const scene = State.sceneOf(state);
    const knobs = State.knobsOf(state);
    const count = Math.max(1, Math.floor(DURATION / state.dt + 1e-9));
    const runs = {};
    const series = {};
    const quality = {};
    for (const model of MODELS) runs[model] = ContactEngine.runModel(model, scene, knobs, count);
    for (const model of MODELS) {
      series[model] = ContactEngine.series(runs[model], scene);
      quality[model] = ContactEngine.quality(runs[model], scene, runs.exact, series[model]);
    }
    now = { scene, knobs, steps: count, runs, series, quality };
  }

  const criticalDt = () => ContactEngine.criticalDt(1, state.stiffness, state.damping);
  const rowAt = (t) => Math.min(now.steps, Math.max(0, Math.floor(t / state.dt + 1e-6)));
  const timeAt = (row) => (row + 1e-4) * state.dt;
  const landingRow = () => Math.min(now.series.exact.landing, now.series.penalty.landing, now.steps);

  // The window in which the contact happens: a little before the landing, and what follows it.
  function contactView() {
    const landing = landingRow() * state.dt;
    const long = state.scene === "bounce" ? 1.2 : state.scene === "stack" ? 0.3 : 0.6;
    const from = Math.max(0, landing - 0.05);
    return [from, Math.min(DURATION, Math.max(from + long, from + 12 * state.dt))];
  }

  // ---- what a bet still hides

  // Whether the spring throws its ball, or would: what exercise 3 is about.
  function throwsUp() {
    const { energy_excess: gained, blew_up: burst } = now.quality.penalty;
    return state.dt >= criticalDt().damped || burst || gained > 0.5;
  }

  // The exercise whose answer the figure would show now, or null.
  function hiddenBy() {
    if (!Bets.open("ex1")) return "ex1";
    return throwsUp() && !Bets.open("ex3") ? "ex3" : null;
  }

  // Where soft rests is what exercise 4 asks: until then its ball falls and is shown no further.
  const waits = (model) => model === "soft" && !Bets.open("ex4");
  const shownRow = (model, row) =>
    waits(model) ? Math.max(0, Math.min(row, now.series[model].landing - 1)) : row;
  const held = (model, row) => shownRow(model, row) !== row;

  function showVeil() {
    const id = hiddenBy();
    $("veil").hidden = id === null;
    root.toggleAttribute("data-veiled", id !== null);
    if (id === null) return;
    $("veil-words").textContent = PAGE.veils[id];
    $("veil-bet").href = `#${id}`;
    $("veil-show").dataset.exercise = id;
  }

  // ---- the lanes

  function lensReach(row) {
    if (lens !== "auto") return Number(lens);
    const shown = MODELS.filter((model) => !held(model, row));
    return Lane.fittingLens(shown.map((model) => now.series[model].gap[row]));
  }

  function shownOf(model, row) {
    const { runs, scene, series } = now;
    const n = scene.y.length;
    row = shownRow(model, row);
    const y = Array.from(runs[model].y.subarray(row * n, (row + 1) * n));
    const trail = [];
    const every = Math.max(1, Math.round(0.05 / state.dt));
    for (let k = 0; k < Math.min(row, series[model].landing); k += every)
      for (let i = 0; i < n; i++) trail.push(runs[model].y[k * n + i]);
    const sink = model === "penalty" && hiddenBy() === null ? weightOverK() / PAGE.radius : null;
    return { model, y, radius: PAGE.radius, push: series[model].push[row], trail, sink };
  }

  // How far the lowest ball must sink for its spring to carry all the weight that stands on it.
  const weightOverK = () => (now.scene.y.length * -ContactEngine.GRAVITY) / state.stiffness;

  function laneWords(model, row) {
    const { gap, push } = now.series[model];
    if (held(model, row)) return ["then?", "exercise 4"];
    const size = Math.abs(gap[row]);
    const place = !Number.isFinite(gap[row])
      ? "gone: not a number"
      : size < 1e-9
        ? "touching"
        : `${number(size, 2)} r ${gap[row] < 0 ? "in" : "up"}`;
    return [place, `↑ ${number(push[row], 2)} m g`];
  }

  function drawLanes(row) {
    const veiled = hiddenBy() !== null;
    const at = veiled ? Math.max(0, landingRow() - 1) : row;
    const reach = lensReach(at);
    for (const model of MODELS) {
      const shown = shownOf(model, at);
      $(`lane-${model}`).innerHTML = Lane.air(shown);
      $(`lens-${model}`).innerHTML = Lane.lens(shown, reach);
      const [place, push] = laneWords(model, at);
      $(`now-${model}`).textContent = place;
      $(`push-${model}`).textContent = push;
      if (!playing) $(`lane-${model}`).setAttribute("aria-label", `${model}: ${place}, ${push}`);
    }
    $("lens-reach").textContent = `${reach} r`;
  }

  // ---- the chart

  // Least and greatest finite value of some series between two rows.
  function range(columns, from, to) {
    let [low, high] = [Infinity, -Infinity];
    for (const ys of columns) {
      for (let row = from; row <= to; row++) {
        if (!Number.isFinite(ys[row])) continue;
        if (ys[row] < low) low = ys[row];
        if (ys[row] > high) high = ys[row];
      }
    }
    return low <= high ? [low, high] : [0, 1];
  }

  const CHARTS = {
    gap: {
      label: "gap / r (below 0: overlap)",
      axis: ([low, high]) => {
        const bottom = Math.min(low, -0.002);
        const top = Math.max(Math.min(high, 1), 0.25 * -bottom);
        const room = 0.08 * (top - bottom);
        return { domain: [bottom - room, top + room], ticks: steps(bottom - room, top + room, 4) };
      },
    },
    push: {
      label: "push / weight (root scale)",
      axis: ([, high]) => {
        const top = Math.max(2, Math.min(high, 1e9));
        const ticks = [0, 1, 10, 100, 1000, 1e4, 1e5, 1e6, 1e7].filter((v) => v <= top);
        return {
          domain: [0, top],
          root: true,
          ticks: (ticks.length > 4 ? [0, 1, ...ticks.slice(-2)] : ticks).map((v) => [v, plain(v)]),
        };
      },
    },
    energy: {
      label: "energy / start",
      axis: ([low, high]) => {
        if (high > 5) {
          const top = Math.min(1e12, 10 ** Math.ceil(Math.log10(high)));
          return { domain: [0.1, top], log: true, zero: true, ticks: decades(0.1, top, 4) };
        }
        const [bottom, top] = [Math.min(low, 0.98 * high), high];
        const room = 0.08 * (top - bottom);
        return { domain: [bottom - room, top + room], ticks: steps(bottom - room, top + room, 4) };
      },
    },
  };

  function drawChart() {
    const node = $("chart");
    const { width, height } = sizes;
    const [from, to] = [rowAt(view[0]), Math.min(now.steps, rowAt(view[1]) + 1)];
    const columns = MODELS.map((model) => now.series[model][kind]);
    const y = { ...CHARTS[kind].axis(range(columns, from, to)), label: CHARTS[kind].label };
    const xs = now.runs.exact.t;
    const veiled = hiddenBy() !== null;
    const lines = MODELS.map((model, m) => {
      const marks = [0.12, 0.37, 0.62, 0.87].map((share) =>
        rowAt(view[0] + (share + 0.06 * m) * (view[1] - view[0])),
      );
      const end = Math.min(to, shownRow(model, to)) + 1;
      const markers = marks.filter((row) => row < end);
      return { model, xs, ys: columns[m], from: Math.min(from, end), to: end, markers };
    });
    const options = {
      id: "chart",
      width,
      height,
      left: 52,
      y,
      x: { domain: view, ticks: steps(view[0], view[1], width < 420 ? 4 : 6), label: "time (s)" },
      lines: veiled ? [] : lines,
      rules: kind === "gap" ? [{ y: 0 }] : kind === "push" ? [{ y: 1, class: "dashed" }] : [],
    };
    chart = plot(options);
    node.setAttribute("viewBox", `0 0 ${width} ${height}`);
    node.setAttribute("width", width);
    node.setAttribute("height", height);
    node.innerHTML = `${chart.markup}<line id="cursor" class="${veiled ? "none" : "cursor"}" y1="${chart.box.top}" y2="${chart.box.bottom}"/>`;
    node.setAttribute(
      "aria-label",
      `${CHARTS[kind].label} against time for each model; the values at the time shown stand below`,
    );
  }

  // The values of all models at one time, in words below the chart.
  function readOut(row) {
    if (hiddenBy() !== null) return ($("readout").textContent = "");
    const value = (model) => (held(model, row) ? "in exercise 4" : number(now.series[model][kind][row]));
    const values = MODELS.map((model) => `${model} ${value(model)}`);
    $("readout").textContent = `${(row * state.dt).toFixed(4)} s: ${values.join(", ")}`;
  }

  const sizes = { width: 0, height: 0, axis: 0 };
  const beside = () => window.innerWidth >= 1024;
  // What is left of the window below the chart's upper edge, for the chart, the scrubber and the values.
  function roomForChart() {
    const above = $("chart").getBoundingClientRect().top - root.getBoundingClientRect().top + root.scrollTop;
    return window.innerHeight - above - $("scrub").clientHeight - 44;
  }

  // Widths are read when the layout changes, not at every redraw: reading them is the slow part.
  function measure() {
    const before = JSON.stringify(sizes);
    const box = $("chart").parentElement;
    sizes.width = Math.max(260, Math.floor(box.clientWidth));
    sizes.height = beside() ? Math.round(Math.min(280, Math.max(110, roomForChart()))) : 132;
    sizes.axis = Math.max(100, Math.floor($("dt-range").clientWidth));
    return before !== JSON.stringify(sizes);
  }

  function lookAt(from, to) {
    const wide = Math.min(DURATION, Math.max(8 * state.dt, to - from));
    const start = Math.min(Math.max(0, from), DURATION - wide);
    view = [start, start + wide];
    showScrub();
    drawChart();
    seek(Math.min(Math.max(time, view[0]), view[1]));
  }

  function zoom(factor) {
    const middle = Math.min(Math.max(time, view[0]), view[1]);
    lookAt(middle - (middle - view[0]) * factor, middle + (view[1] - middle) * factor);
  }

  // ---- the dt axis, true to scale, with both critical steps on it once exercise 3 is decided

  function drawDtAxis() {
    const { el, words } = Plot;
    const width = sizes.axis;
    const pad = 22; // half a slider thumb: the axis lines up with the slider above it
    const share = (dt) => Math.log(dt / KNOBS.dt.low) / Math.log(KNOBS.dt.high / KNOBS.dt.low);
    const at = (dt) => pad + Math.min(1, Math.max(0, share(dt))) * (width - 2 * pad);
    const parts = [];
    for (const dt of width > 300
      ? [0.001, 0.002, 0.004, 0.008, 0.016, 0.032]
      : width > 230
        ? [0.001, 0.004, 0.016]
        : [0.002, 0.016]) {
      parts.push(el("line", { x1: at(dt), x2: at(dt), y1: 0, y2: 5, class: "axis" }));
      parts.push(words(plain(dt), { x: at(dt), y: 19, class: "tick", "text-anchor": "middle" }));
    }
    const { damped } = criticalDt();
    const open = Bets.open("ex3") && Bets.open("ex1");
    if (open && damped <= KNOBS.dt.high && damped >= KNOBS.dt.low)
      parts.push(el("path", { d: `M${Plot.round(at(damped))} -30V7`, class: "rule" }));
    const node = $("dt-axis");
    node.setAttribute("viewBox", `0 0 ${width} 22`);
    node.setAttribute("width", width);
    node.innerHTML = parts.join("");
    $("dt-note").title = "The largest stable step of penalty, with its damper";
    $("dt-note").textContent = open ? `│ critical ${number(damped)} s` : "";
  }

  // ---- showing a time

  function seek(t, fromPlay) {
    time = Math.min(DURATION, Math.max(0, t));
    const row = rowAt(time);
    drawLanes(row);
    if (chart) {
      const x = chart.sx(Math.min(Math.max(row * state.dt, view[0]), view[1]));
      $("cursor").setAttribute("x1", x);
      $("cursor").setAttribute("x2", x);
    }
    readOut(row);
    $("scrub").value = String(row);
    $("scrub").setAttribute(
      "aria-valuetext",
      `${number(row * state.dt)} seconds, step ${row} of ${now.steps}`,
    );
    $("clock").textContent = `t = ${(row * state.dt).toFixed(3)} s, step ${row}`;
    if (fromPlay) return;
    Inside.write(state, now, row);
    writeAddress();
  }

  function showScrub() {
    Object.assign($("scrub"), { min: String(rowAt(view[0])), max: String(rowAt(view[1])) });
  }

  function refresh(announce) {
    simulate();
    showScrub();
    drawChart();
    drawDtAxis();
    showVeil();
    Inside.results(state, now);
    seek(Math.min(Math.max(time, view[0]), view[1]));
    if (announce) say();
  }

  let sayTimer = 0;
  function say() {
    clearTimeout(sayTimer);
    if (hiddenBy() !== null) return;
    const deepest = (model) => `${model} ${number(now.quality[model].max_penetration_frac)} r`;
    const shown = MODELS.filter((model) => !waits(model));
    const told = `Deepest: ${shown.map(deepest).join(", ")}.`;
    sayTimer = setTimeout(() => ($("figure-status").textContent = told), 500);
  }

  // ---- the clock

  let lastFrame = 0;
  function frame(stamp) {
    if (!playing) return;
    const passed = Math.min(0.1, (stamp - lastFrame) / 1000);
    lastFrame = stamp;
    const next = time + (passed * (view[1] - view[0])) / SECONDS;
    seek(Math.min(next, view[1]), true);
    if (next >= view[1]) pause();
    else requestAnimationFrame(frame);
  }

  function run() {
    if (hiddenBy() !== null) return $("veil-show").focus();
    if (time >= view[1] - 1e-9 || time < view[0]) time = view[0];
    playing = true;
    $("run").textContent = "Pause";
    lastFrame = performance.now();
    requestAnimationFrame(frame);
  }

  function pause() {
    if (!playing) return;
    playing = false;
    $("run").textContent = "Run";
    seek(time);
  }

  function stepBy(by) {
    pause();
    const row = Math.min(now.steps, Math.max(0, rowAt(time) + by));
    if (timeAt(row) > view[1] || timeAt(row) < view[0])
      lookAt(timeAt(row) - 0.5 * (view[1] - view[0]), timeAt(row) + 0.5 * (view[1] - view[0]));
    seek(timeAt(row));
  }

  // ---- state, address, history

  function remember(how, where) {
    try {
      history[how](null, "", where);
    } catch {
      // a frame without an address of its own: the state is kept until the page is closed
    }
  }

  let addressTimer = 0;
  function writeAddress() {
    clearTimeout(addressTimer);
    if (!playing) addressTimer = setTimeout(() => remember("replaceState", address(true)), 250);
  }

  const address = (withTime) =>
    location.pathname + State.write(state, withTime && time !== view[1] ? time : null) + location.hash;

  // Take over a state; `window` is kept while a knob moves, and set to the contact otherwise.
  function take(next, { keepView = false, at = null } = {}) {
    state = next;
    Controls.show(state);
    simulate();
    if (!keepView) view = contactView();
    if (at !== null && (at < view[0] || at > view[1])) view = [0, DURATION];
    time = at !== null ? at : keepView ? time : view[1];
    refresh(true);
  }

  const set = (changes) => {
    pause();
    const keepView = !("scene" in changes);
    take({ ...state, ...changes }, { keepView });
  };

  // A link of the text: its state, in a place of its own in the history; run it, or show its end.
  function follow(query) {
    clearTimeout(addressTimer);
    remember("replaceState", address(true));
    pause();
    const { state: next, time: at } = State.read(query);
    remember("pushState", location.pathname + State.write(next, at));
    take(next, { at });
    if (!STILL && at === null && hiddenBy() === null) {
      time = view[0];
      run();
    }
  }

  function back() {
    pause();
    const { state: next, time: at } = State.read(location.search);
    take(next, { at });
  }

  // After a bet, or "show me": lift the veil and let it run.
  function unveil() {
    refresh(false);
    if (hiddenBy() === null && !STILL) {
      time = view[0];
      run();
    }
  }

  // ---- controls

  function listenChart() {
    const node = $("chart");
    const rowOf = (event) => {
      const x = event.clientX - node.getBoundingClientRect().left;
      const share = (x - chart.box.left) / (chart.box.right - chart.box.left);
      return rowAt(view[0] + Math.min(1, Math.max(0, share)) * (view[1] - view[0]));
    };
    node.addEventListener("pointerdown", (event) => {
      pause();
      seek(timeAt(rowOf(event)));
      if (event.pointerType === "mouse") node.setPointerCapture(event.pointerId);
    });
    node.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) seek(timeAt(rowOf(event)));
      else readOut(rowOf(event));
    });
    node.addEventListener("pointerleave", () => readOut(rowAt(time)));
    node.addEventListener("dblclick", () => zoom(0.5));
    // a wheel turned sideways, or with Shift, moves the window; plain turning scrolls the page
    const turn = (event) => {
      const sideways = event.shiftKey ? event.deltaY || event.deltaX : event.deltaX;
      if (Math.abs(sideways) < (event.shiftKey ? 1 : Math.abs(event.deltaY))) return;
      event.preventDefault();
      const by = 0.1 * Math.sign(sideways) * (view[1] - view[0]);
      lookAt(view[0] + by, view[1] + by);
    };
    node.addEventListener("wheel", turn, { passive: false });
  }

  function listenTime() {
    const click = (id, action) => $(id).addEventListener("click", action);
    click("run", () => (playing ? pause() : run()));
    click("step", () => stepBy(1));
    click("back", () => stepBy(-1));
    click("view-contact", () => lookAt(...contactView()));
    click("view-all", () => lookAt(0, DURATION));
    click("zoom-in", () => zoom(0.5));
    click("zoom-out", () => zoom(2));
    click("veil-show", () => Bets.show($("veil-show").dataset.exercise));
    $("scrub").addEventListener("input", (event) => {
      pause();
      seek(timeAt(Number(event.target.value)));
    });
    for (const radio of root.querySelectorAll('input[name="chart"]'))
      radio.addEventListener("change", () => {
        kind = radio.value;
        drawChart();
        seek(time);
      });
    $("lens-choice").addEventListener("change", (event) => {
      lens = event.target.value;
      drawLanes(rowAt(time));
    });
  }

  function listen() {
    listenChart();
    listenTime();
    Controls.listen(set);
    $("inside").addEventListener("toggle", () => Inside.write(state, now, rowAt(time)));
    window.addEventListener("popstate", back);
    window.addEventListener("beforeprint", () => {
      pause();
      seek(view[1]);
    });
    document.addEventListener("bet", unveil);
    new ResizeObserver(() => {
      if (!measure()) return;
      drawChart();
      drawDtAxis();
      seek(time, playing);
    }).observe($("chart").parentElement);
  }

  function start() {
    const { state: first, time: at } = State.read(location.search);
    measure();
    listen();
    take(first, { at });
  }

  return {
    start,
    set,
    follow,
    take,
    hiddenBy,
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
    get view() {
      return view;
    },
    get playing() {
      return playing;
    },
  };
})();
