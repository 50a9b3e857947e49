/* The models side by side over one table, and below it their gaps over time. It is still until it
 * is pressed; its scale never changes, and a ruler says it. Values: the time shown [s], the models'
 * rows and gaps [r] then, and the highest place in the picture [m]. */
import { arrow, axis, ball, label, line, number, plot, steps, table, within } from "../draw.js";
import { data } from "../data.js";
import { column, gapsOf, kept, MODELS, pushIn, R, record } from "../runs.js";

const [GROUND, BELOW, HIGHEST] = [26, 76, 1.25]; // px, px; m

const run = kept((model, heights, knobs, steps) => {
  const made = record(model, column(heights), knobs, steps);
  const gaps = gapsOf(made);
  const landing = gaps.findIndex((gap) => gap <= 0);
  return { model, made, gaps, landing: landing < 0 ? steps : landing };
});

// The knobs that a model's run hangs on, and no others: so what else is dragged costs nothing.
function knobsOf(own, model) {
  const { dt, impedance } = own;
  const solimp = impedance ? [Math.max(0, 2 * impedance - 1), impedance, 0.001, 0.5, 2] : null;
  const all = { ...own, solimp, solref: null };
  return { dt, ...Object.fromEntries(data.uses[model].map((name) => [name, all[name]])) };
}

function runsOf(own) {
  const { scene, models, dt, lift, until } = own;
  const heights = data.scenes[scene].start.map((y) => y + lift);
  const names = MODELS.filter((model) => models.split(",").includes(model));
  const all = names.map((model) => run(model, heights, knobsOf(own, model),
    Math.ceil(Math.max(own.to, own.from + 8 * dt) / dt)));
  const landing = Math.max(1, Math.min(...all.map((each) => each.landing)) - 1) * dt;
  const to = until ? landing : Math.max(own.from + 8 * dt, own.to);
  return { all, to, from: until ? 0 : own.from };
}

const heightsIn = ({ made: { n, y } }, row) => Array.from(y.subarray(row * n, (row + 1) * n));

const placeWords = (gap) => {
  if (!Number.isFinite(gap)) return "nowhere";
  return Math.abs(gap) < 5e-5 ? "touching"
    : `${number(Math.abs(gap), 2)} r ${gap < 0 ? "in" : "up"}`;
};

// A model's balls, held by the hand; from above what a picture holds, an arrow and how high.
function lane(view, each, row, k, { floor, scale, wide, top }) {
  const [x, heights, start] = [wide * (k + 0.5), heightsIn(each, row),
    data.scenes[view.own.scene].start];
  const r = Math.max(5, R * scale);
  const shown = heights.map((height) => {
    if (height < top + R) return ball(each.model, x, Math.min(floor + r, floor - height * scale),
      r);
    const far = Number.isFinite(height) ? `${number(height, 2)} m` : "out of sight";
    return [arrow("weight", x, 54, 0, -30), label(far, x, 70, "middle", "tick")];
  });
  const push = Math.min(40, 14 * Math.sqrt(Math.max(0, pushIn(each.made, row))));
  const gap = placeWords(each.gaps[row]);
  const what = {
    label: `${each.model}: the balls`, text: gap, value: "lift", step: 0.02, low: 1.05 * R - start[0],
    high: HIGHEST - start[start.length - 1], also: { from: 0, time: 0 },
    at: (_, y) => (floor - y) / scale, release: () => view.play(0),
  };
  return [
    view.grab(what, shown),
    arrow(`push m-${each.model}`, x, floor + GROUND - 3, 0, -push),
    label(each.model, x, floor + GROUND + 20, "middle"),
    label(gap, x, floor + GROUND + 40, "middle", "tick"),
  ];
}

function chartOf(view, { all, from, to }, top) {
  const shown = all.map(({ model, made, gaps }, k) => {
    const [first, last] = [from, to].map((t) => Math.round(t / made.dt));
    const points = gaps.slice(first, last + 1).map((gap, i) => [made.t[first + i], gap]);
    return { model, points, marks: [0.12, 0.37, 0.62, 0.87].map((s) =>
      Math.round((s + 0.05 * k) * points.length)) };
  });
  const finite = shown.flatMap(({ points }) =>
    points.map(([, gap]) => gap)).filter(Number.isFinite);
  const [low, high] = [finite.reduce((a, b) => Math.min(a, b), -0.05),
    finite.reduce((a, b) => Math.max(a, b), 0)];
  const most = Math.min(high, Math.max(2, -2 * low), (HIGHEST - R) / R);
  const domain = [Math.max(low, -10) - 0.06 * (most - low), most + 0.06 * (most - low)];
  const time = within(from, from + view.own.time, to);
  const chart = plot([0, top, view.width, view.height - top], {
    x: axis([from, to], "time (s)", ...steps(from, to, view.width < 480 ? 3 : 6)),
    y: axis(domain, "gap / r (below 0: overlap)", ...steps(...domain, 4)), lines: shown,
    rules: [{ y: 0 }, { x: time }],
  });
  const what = {
    label: "the time shown", text: `${time.toFixed(3)} s`, value: "time", low: 0, high: to - from,
    step: view.own.dt, at: (x) => chart.sx.back(x) - from,
  };
  return [chart.picture, view.point(chart.sx(time), chart.box.bottom - 2, what)];
}

function draw(view) {
  const seen = runsOf(view.own);
  const { all, from, to } = seen;
  const time = within(from, from + view.own.time, to);
  const row = Math.min(Math.round(time / view.own.dt), all[0].made.steps);
  const wide = view.width / all.length;
  const chartTop = Math.round(0.56 * view.height);
  const floor = chartTop - BELOW;
  const reach = Math.max(...all.flatMap((each) => [heightsIn(each, Math.round(from / view.own.dt)),
    heightsIn(each, 0).map((y) => (from > 0 ? Math.min(y, 0.45) : y))].flat()));
  const top = within(0.45, reach + 1.2 * R, HIGHEST + R);
  const scale = Math.min((floor - 6) / top, (0.42 * wide) / R); // px for 1 m
  const gaps = all.map((each) => each.gaps[row]);
  const told = all.map(({ model }, k) => `${model} ${placeWords(gaps[k])}`);
  return {
    picture: [
      table(0, floor, view.width, GROUND),
      all.map((each, k) => lane(view, each, row, k, { floor, scale, wide, top })),
      line(4, floor, 4, floor - 0.2 * scale, "rule"), label("0.2 m", 2, floor - 0.2 * scale - 7,
        "start", "tick"),
      chartOf(view, seen, chartTop),
    ],
    words: `${time.toFixed(3)} s: ${told.join(", ")}.`,
    values: { time, row, top, gaps: Object.fromEntries(all.map(({ model }, k) =>
      [model, gaps[k]])) },
  };
}

const lengthOf = ({ own }) => {
  const { from, to } = runsOf(own);
  return to - from;
};

export const figure = {
  title: "The models over one table",
  caption: "Lift the balls and let them go, or drag the time along the curves.",
  height: (width) => (width < 480 ? 460 : 500),
  knobs: ({ knobs }) => knobs.split(","),
  start: ({ scene = "drop" }) => ({
    scene, models: "penalty,lcp", from: 0.3, to: 1.2, until: "", lift: 0, knobs: "dt", slower: 6,
    impedance: null, ...data.scenes[scene].own,
  }),
  clock: (view) => ({ end: lengthOf(view), rate: 1 / view.own.slower }),
  buttons: (view) => [
    view.running ? ["Stop", view.stop] : ["Let them fall", () => view.play()],
    ["One step", () => {
      view.stop();
      view.own.time = Math.min(lengthOf(view), view.own.time + view.own.dt);
    }],
    [`${view.own.slower} × slower`, () => (view.own.slower = { 6: 30, 30: 1,
      1: 6 }[view.own.slower])],
    ["From the start", () => (view.own.time = 0)],
  ],
  draw,
};
