/* The models side by side over one table, and below it their gaps over time. It is still until it
 * is pressed, and keeps its scale. Values: the time shown [s], the models' rows and gaps [r] then,
 * and the highest place in the picture [m]. */
import { arrow, axis, ball, circle, label, line, number, plain, plot, steps } from "../draw.js";
import { table, within } from "../draw.js";
import { data } from "../data.js";
import { column, G, gapsOf, inRow, kept, MODELS, pushIn, R, record } from "../runs.js";

const [GROUND, BELOW, LOWEST] = [26, 76, 0.45]; // px, px; m: a picture is at least so high
const PACE = { 6: 30, 30: 1, 1: 6 }; // how many times slower, and what the button makes of it
const SCENES = { drop: "A ball falls", bounce: "A ball bounces", stack: "Three balls stand" };

const run = kept((model, heights, knobs, count) => {
  const made = record(model, column(heights), knobs, count);
  const gaps = gapsOf(made);
  const landing = gaps.findIndex((gap) => gap <= 0);
  return { model, made, gaps, landing: landing < 0 ? count : landing };
});

// The knobs that a model's run depends on, and no others: so what else is dragged costs nothing.
const knobsOf = (own, model) =>
  Object.fromEntries(["dt", ...data.uses[model]].map((name) => [name, own[name]]));

// The runs of all models, and the times between which they are shown [s].
function runsOf(own) {
  const { scene, models, dt, lift, until } = own;
  const heights = data.scenes[scene].start.map((y) => y + lift);
  const last = Math.max(own.to, own.from + 8 * dt);
  const all = MODELS.filter((model) => models.split(",").includes(model)).map((model) =>
    run(model, heights, knobsOf(own, model), Math.ceil(last / dt)));
  if (!until) return { all, from: own.from, to: last };
  const landing = Math.min(...all.map((each) => each.landing));
  return { all, from: 0, to: Math.max(1, landing - 1) * dt };
}

// How high the picture is [m]: as the balls are where it begins, with some room to lift them.
function topOf({ scene, from, until }) {
  const { start } = data.scenes[scene];
  const begins = Math.max(...start) - (until ? 0 : (G / 2) * from ** 2);
  return Math.max(LOWEST, begins + 1.2 * R * start.length);
}

function placeWords(gap) {
  if (!Number.isFinite(gap)) return "gone";
  if (Math.abs(gap) < 5e-5) return "touches";
  return `${number(gap, 2)} r`;
}

// A model's balls, held by the hand; from above what a picture holds, an arrow and how high.
function lane(view, { model, made, gaps }, row, k, { floor, scale, wide, top }) {
  const { own } = view;
  const [x, start] = [wide * (k + 0.5), data.scenes[own.scene].start];
  const r = Math.max(5, R * scale);
  const heights = inRow(made, "y", row);
  const shown = heights.map((height) => {
    if (height < top + R)
      return ball(model, x, Math.min(floor + r, floor - height * scale), r);
    const far = Number.isFinite(height) ? `${number(height, 2)} m` : "out of sight";
    return [circle(x, 44, 26, "halo"), arrow("weight", x, 54, 0, -30),
      label(far, x, 70, "middle", "tick")];
  });
  const push = Math.min(40, 14 * Math.sqrt(Math.max(0, pushIn(made, row))));
  const what = {
    label: `${model}: the balls`, value: "lift", low: 1.05 * R - start[0],
    high: top - R - start[start.length - 1], step: 0.02, at: (_, y) => (floor - y) / scale,
    seen: () => (own.from + own.time > 0 && heights[0] < top ? heights[0] - start[0] : own.lift),
    also: { from: 0, time: 0 }, release: () => view.play(0),
  };
  return [
    view.grab(what, [shown, circle(x, within(22, floor - (heights[0] || 0) * scale, floor), 22, "halo")]), arrow(`push m-${model}`, x, floor + GROUND - 3, 0, -push),
    label(model, x, floor + GROUND + 20, "middle"),
    label(placeWords(gaps[row]), x, floor + GROUND + 40, "middle", "tick"),
  ];
}

function chartOf(view, { all, from, to }, top, time) {
  const lines = all.map(({ model, made, gaps }, k) => {
    const [first, last] = [from, to].map((t) => Math.round(t / made.dt));
    const points = gaps.slice(first, last + 1).map((gap, i) => [made.t[first + i], gap]);
    const marks = [0.12, 0.37, 0.62, 0.87].map((s) => Math.round((s + 0.05 * k) * points.length));
    return { model, points, marks };
  });
  const past = lines.map((each) => ({ ...each, points: each.points.filter(([t]) => t <= time) }));
  const coming = lines.map((each) => ({ ...each, marks: [], kind: "coming" }));
  const seen = lines.flatMap(({ points }) => points.map(([, gap]) => gap)).filter(Number.isFinite);
  const low = seen.reduce((a, b) => Math.min(a, b), -0.05);
  const high = seen.reduce((a, b) => Math.max(a, b), 0);
  const most = Math.min(high, Math.max(2, -2 * low), 12);
  const domain = [Math.max(low, -10) - 0.06 * (most - low), most + 0.06 * (most - low)];
  const { sx, box, picture } = plot(view, {
    top, zero: true, lines: [...coming, ...past],
    x: axis([from, to], "time (s)", ...steps(from, to, view.width < 480 ? 3 : 6)),
    y: axis(domain, "gap / r, r = 0.1 m (below 0: overlap)", ...steps(...domain, 4)),
  });
  const what = {
    label: "the time shown", value: "time", low: 0, high: to - from, step: view.own.dt,
    at: (x) => sx.back(x) - from,
  };
  const x = sx(time);
  return [picture, line(x, box.top, x, box.bottom, "rule"), view.point(x, box.bottom - 2, what)];
}

function draw(view) {
  const { own, width, height } = view;
  const seen = runsOf(own);
  const { all, from, to } = seen;
  const row = Math.min(Math.round(within(from, from + own.time, to) / own.dt), all[0].made.steps);
  const time = row * own.dt;
  const wide = width / all.length;
  const chartTop = Math.round(0.56 * height);
  const [floor, top] = [chartTop - BELOW, topOf(view.text)];
  const scale = Math.min((floor - 6) / top, (0.42 * wide) / R); // px for 1 m
  const told = all.map(({ model, gaps }) => `${model} ${placeWords(gaps[row])}`);
  return {
    picture: [
      table(0, floor, width, GROUND),
      all.map((each, k) => lane(view, each, row, k, { floor, scale, wide, top })),
      chartOf(view, seen, chartTop, within(from, time, to)),
    ],
    words: `${time.toFixed(3)} s: ${told.join(", ")}.`,
    values: { time, row, top,
      gaps: Object.fromEntries(all.map(({ model, gaps }) => [model, gaps[row]])) },
  };
}

const lengthOf = ({ own }) => {
  const { from, to } = runsOf(own);
  return to - from;
};

export const figure = {
  title: "The models over one table",
  caption: ({ scene, from, to, until, dt }) => `${SCENES[scene]}: ${until
    ? "lift it and let it go, or drag the time along the curves, up to the landing"
    : `from ${from} to ${to} s, in steps of ${plain(1000 * dt)} ms`}.`,
  height: (width) => (width < 480 ? 400 : 460),
  knobs: ({ knobs }) => knobs.split(","),
  choices: { until: ["", "landing"] },
  start: ({ scene = "drop" }) => ({
    scene, models: "penalty,lcp", from: 0.3, to: 1.2, until: "", lift: 0, knobs: "dt", slower: 6,
    ...data.scenes[scene].own,
  }),
  clock: (view) => ({ end: lengthOf(view), rate: 1 / view.own.slower }),
  play: () => "Let them fall",
  buttons: (view) => {
    const { own } = view;
    const step = () => {
      view.stop();
      own.time = Math.min(lengthOf(view), own.time + own.dt);
    };
    return [["Step", step],
      [`${own.slower} × slower`, () => (own.slower = PACE[own.slower])]];
  },
  draw,
};
