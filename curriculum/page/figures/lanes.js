/* The live figure: the four models over one table. What stands in it (models, scene, quantity, window of
 * time) follows the text. A ball whose end would tell the answer of a bet waits until the bet is made. */
import { arrow, ball, decades, number, plain, plot, steps, table, words } from "../draw.js";
import { MODELS, criticalDt, runModel, series } from "../engine.js";
import { data } from "../data.js";
import { knobsOf, sceneOf } from "../store.js";

const R = data.radius;
const LONGEST = 4; // s
const SECONDS = 5; // that a run through the window takes
const GROUND = 26; // px
const chartHeight = (view) => Math.min(180, Math.round(0.42 * view.height)); // px
// which quantities change a model's run
const USES = {
  penalty: ["dt", "stiffness", "damping"],
  lcp: ["dt", "baumgarte", "iters", "warm", "restitution"],
  soft: ["dt", "restitution", "impedance", "timeconst", "dampratio"],
  exact: ["dt", "restitution"],
};
// the line of code that runs while a ball touches, and while it flies
const LINES = {
  penalty: ["penalty", "max(0.0, stiffness"],
  lcp: ["sweep", "lam = max("],
  soft: ["soft", "c.target = v_n"],
  exact: ["exact", "bounce(touching"],
};

const runs = new Map(); // model: {key, run, scene, gap, energy, push, landing}

// The run of a model up to a time, kept while nothing that it depends on changes.
function runOf(values, model, end) {
  const scene = sceneOf(values);
  const count = Math.max(1, Math.floor(end / values.dt + 1e-9));
  const key = JSON.stringify([values.scene, ...USES[model].map((name) => values[name])]);
  const held = runs.get(model);
  if (held && held.key === key && held.run.steps >= count) return held;
  const run = runModel(model, scene, knobsOf(values), count);
  const made = { key, run, scene, ...series(run, scene) };
  runs.set(model, made);
  return made;
}

// ---- what may be shown

// Whether the spring throws its ball, or would: what exercise 3 asks.
const throws = (values) => values.dt >= 0.97 * criticalDt(1, values.stiffness, values.damping).damped;

// The bet that a model's course past the landing would tell the answer of, or null.
function hiddenBy(view, model) {
  if (model === "exact") return null;
  if (!view.open("ex1")) return "exercise 1";
  if (model === "soft" && !view.open("ex4")) return "exercise 4";
  return model === "penalty" && throws(view.values) && !view.open("ex3") ? "exercise 3" : null;
}

const lastRow = (view, model, each) =>
  hiddenBy(view, model) ? Math.max(0, Math.min(each.landing - 1, each.run.steps)) : each.run.steps;

function shownOf(view) {
  const { models, to } = view.own;
  return models.map((model) => {
    const each = runOf(view.values, model, to);
    const last = lastRow(view, model, each);
    const wanted = Math.min(each.run.steps, Math.floor(view.own.time / each.run.dt + 1e-6));
    return { ...each, model, last, row: Math.min(wanted, last), waits: wanted > last && hiddenBy(view, model) };
  });
}

// ---- drawing

// The height [m] that the lanes show: the highest surface in the window, and a little air.
function reach(view, shown) {
  let top = 3.2 * R;
  for (const { run, last } of shown) {
    const n = run.n;
    const to = Math.min(last, Math.ceil(view.own.to / run.dt));
    for (let row = Math.floor(view.own.from / run.dt); row <= to; row++)
      for (let i = 0; i < n; i++) if (run.y[row * n + i] + 1.2 * R > top) top = run.y[row * n + i] + 1.2 * R;
  }
  return Math.min(top, 1.3);
}

const placeWords = (gap) =>
  !Number.isFinite(gap) ? "nowhere" : Math.abs(gap) < 1e-9 ? "touching" : `${number(Math.abs(gap), 2)} r ${gap < 0 ? "in" : "up"}`;

function lane(view, each, k, high) {
  const wide = view.width / view.own.models.length;
  const x = wide * (k + 0.5);
  const floor = view.height - chartHeight(view) - 66;
  const scale = Math.min((floor - 8) / high, (0.4 * wide) / R);
  const { run, row, model } = each;
  const parts = [];
  for (let i = 0; i < run.n; i++) {
    const y = floor - run.y[row * run.n + i] * scale;
    if (y < -R * scale) parts.push(words("↑", { x, y: 20, class: "tick strong", "text-anchor": "middle" }));
    else if (y < floor + 2 * R * scale) parts.push(ball(model, x, y, R * scale));
  }
  const push = Math.min(40, 14 * Math.sqrt(Math.max(each.push[row], 0)));
  if (push > 1 && row > 0) parts.push(arrow(`push m-${model}`, x, floor + GROUND - 4, 0, -push));
  const middle = { x, "text-anchor": "middle" };
  parts.push(words(model, { ...middle, y: floor + GROUND + 16, class: "tick strong" }));
  const told = each.waits ? `then? ${each.waits}` : placeWords(each.gap[row]);
  parts.push(words(told, { ...middle, y: floor + GROUND + 35, class: "tick" }));
  return parts.join("");
}

const CHARTS = {
  gap: {
    label: "gap / r (below 0: overlap)",
    axis([low, high]) {
      const bottom = Math.min(low, -0.002);
      const top = Math.max(Math.min(high, 2), 0.25 * -bottom);
      const room = 0.08 * (top - bottom);
      return { domain: [bottom - room, top + room], ticks: steps(bottom - room, top + room, 4) };
    },
  },
  push: {
    label: "push / weight (root scale)",
    axis([, high]) {
      const top = Math.max(2, Math.min(high, 1e7));
      const ticks = [0, 1, 10, 100, 1000, 1e4, 1e5, 1e6].filter((v) => v <= top);
      const few = ticks.length > 4 ? [0, 1, ...ticks.slice(-2)] : ticks;
      return { domain: [0, top], root: true, ticks: few.map((v) => [v, plain(v)]) };
    },
  },
  energy: {
    label: "energy / start",
    axis([low, high]) {
      if (high > 5) {
        const top = Math.min(1e12, 10 ** Math.ceil(Math.log10(high)));
        return { domain: [0.1, top], log: true, zero: true, ticks: decades(0.1, top, 4) };
      }
      const room = 0.08 * (high - low || 0.1);
      return { domain: [low - room, high + room], ticks: steps(low - room, high + room, 4) };
    },
  },
};

// Least and greatest finite value in the window.
function range(view, shown) {
  let [low, high] = [Infinity, -Infinity];
  for (const each of shown) {
    const column = each[view.own.chart];
    const to = Math.min(each.last, Math.floor(view.own.to / each.run.dt));
    for (let row = Math.floor(view.own.from / each.run.dt); row <= to; row++) {
      if (column[row] < low) low = column[row];
      if (column[row] > high && column[row] < Infinity) high = column[row];
    }
  }
  return low <= high ? [low, high] : [0, 1];
}

function chart(view, shown) {
  const { from, to, chart: kind } = view.own;
  const { axis, label } = CHARTS[kind];
  const lines = shown.map((each, k) => {
    const first = Math.floor(from / each.run.dt);
    const end = Math.min(each.last, Math.ceil(to / each.run.dt)) + 1;
    const rows = (to - from) / each.run.dt;
    const at = [0.12, 0.37, 0.62, 0.87].map((share) => Math.round(first + (share + 0.05 * k) * rows));
    const markers = at.filter((row) => row < end);
    return { model: each.model, xs: each.run.t, ys: each[kind], from: Math.min(first, end), to: end, markers };
  });
  const rules = [{ x: view.own.time, class: "cursor" }];
  if (kind === "gap") rules.push({ y: 0 });
  if (kind === "push") rules.push({ y: 1, class: "dashed" });
  return plot({
    id: "lanes-chart",
    width: view.width,
    height: chartHeight(view),
    left: 52,
    x: { domain: [from, to], ticks: steps(from, to, view.width < 420 ? 4 : 6), label: "time (s)" },
    y: { ...axis(range(view, shown)), label },
    lines,
    rules,
  });
}

// ---- the figure

const timeAt = (view, x) => {
  const { from, to } = view.own;
  return Math.min(to, Math.max(from, from + ((x - 52) / (view.width - 62)) * (to - from)));
};

export const figure = {
  title: "Four models, one table",
  height: 560,
  knobs: ["dt", "stiffness", "damping", "baumgarte", "iters", "warm", "impedance", "timeconst", "restitution"],
  uses: ["scene", "dampratio"],
  start: () => ({ models: MODELS, chart: "gap", from: 0.3, to: 1.2, time: 0.3 }),
  buttons: [
    {
      label: (view) => (view.running() ? "Stop" : `Play, ${number(SECONDS / (view.own.to - view.own.from), 2)} × slower`),
      press(view) {
        if (view.running()) return view.stop();
        if (view.own.time >= view.own.to - 1e-9) view.own.time = view.own.from;
        if (view.still) view.own.time = view.own.to;
        else view.run();
      },
    },
    { label: "More", press: (view) => view.box.classList.toggle("all") },
    {
      label: (view) => ({ drop: "A bounce instead", bounce: "A stack instead", stack: "A drop instead" })[view.values.scene],
      press: (view) => view.set({ scene: { drop: "bounce", bounce: "stack", stack: "drop" }[view.values.scene] }),
    },
    {
      label: (view) => `Show ${{ gap: "push", push: "energy", energy: "gap" }[view.own.chart]}`,
      press: (view) => (view.own.chart = { gap: "push", push: "energy", energy: "gap" }[view.own.chart]),
    },
    { label: "The chapter’s values", press: (view) => view.reset() },
  ],
  // What the text asks to see: {models, chart, from, to} as an address has them.
  look(view, { models, chart: kind, from, to }, anew) {
    const { own } = view;
    if (models || anew) own.models = MODELS.filter((model) => !models || models.split(",").includes(model));
    if (kind || anew) own.chart = kind || "gap";
    if (from || to || anew) {
      own.from = Math.min(Number(from || 0.3), LONGEST - 0.1);
      own.to = Math.min(LONGEST, Math.max(own.from + 8 * view.get("dt"), Number(to || own.from + 0.9)));
    }
  },
  // Once through the window, from its start.
  replay(view) {
    view.own.time = view.still ? view.own.to : view.own.from;
    if (!view.still) view.run();
  },
  draw(view) {
    const shown = shownOf(view);
    const high = reach(view, shown);
    const floor = view.height - chartHeight(view) - 66;
    const drawn = chart(view, shown);
    const said = shown.map((each) => `${each.model} ${each.waits ? "waits for your bet" : placeWords(each.gap[each.row])}`);
    const x = drawn.sx(view.own.time);
    const time = `${view.own.time.toFixed(3)} s`;
    const y = view.height - chartHeight(view) + drawn.box.bottom;
    return {
      svg:
        shown.map((each, k) => lane(view, each, k, high)).join("").replace(/^/, table(0, floor, view.width, GROUND)) +
        `<g transform="translate(0 ${view.height - chartHeight(view)})">${drawn.markup}</g>`,
      words: `${time}: ${said.join(", ")}.`,
      handles: [{ name: "time", x, y, r: 14, label: "the time shown", value: view.own.time, text: time }],
      lit: view.running() ? shown.filter((each) => each.push[each.row] > 0).map((each) => LINES[each.model]) : [],
    };
  },
  drag(view, name, x) {
    view.stop();
    view.own.time = timeAt(view, x);
  },
  nudge(view, name, dx, dy) {
    view.stop();
    view.own.time = Math.min(view.own.to, Math.max(view.own.from, view.own.time + (dx - dy) * view.get("dt")));
  },
  tick(view, seconds) {
    const { own } = view;
    own.time = Math.min(own.to, own.time + (seconds * (own.to - own.from)) / SECONDS);
    return own.time < own.to;
  },
};
