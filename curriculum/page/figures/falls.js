/* The models side by side over one table, and their gaps over time: dark up to now, faint where one
 * has seen what comes. A stack's overlaps are drawn enlarged. */
import { arrow, axis, ball, clipped, label, line, ms, number, plain, plot } from "../draw.js";
import { table, within } from "../draw.js";
import { data } from "../data.js";
import { column, G, gapsOf, inRow, kept, pushIn, R, record } from "../runs.js";

const [GROUND, NAMES, LOWEST] = [50, 28, 0.34]; // px, px; m: a picture is at least so high
const SCENES = { drop: "A ball falls", bounce: "A ball bounces", stack: "Three balls stand" };

const run = kept((model, heights, knobs, count) => {
  const made = record(model, column(heights), knobs, count);
  return { model, made, gaps: gapsOf(made) };
});

// The runs of the models, and until when they are shown [s].
function runsOf(own) {
  const to = Math.max(own.to, own.from + 8 * own.dt);
  const knobs = Object.fromEntries(Object.keys(data.defaults).map((name) => [name, own[name]]));
  const { start } = data.scenes[own.scene];
  const runOf = (model) => run(model, start, knobs, Math.ceil(to / own.dt));
  return { to, all: own.models.split(",").map(runOf) };
}

// How high the picture is [m], without the models' names.
const topOf = ({ scene, from }) =>
  Math.max(LOWEST, Math.max(...data.scenes[scene].start) - (G / 2) * from ** 2 + R);

function placeWords({ gap, upper, lower }, many) {
  if (!Number.isFinite(gap)) return "gone";
  const whose = many ? `, ball ${upper} ${lower ? `on ${lower}` : "on the table"}` : "";
  return `${Math.abs(gap) < 5e-5 ? "touches" : `${number(gap, 2)} r`}${whose}`;
}

// How many times larger a stack's overlaps are drawn.
function enlarged({ scene }, all) {
  const deepest = Math.max(0, ...all.flatMap(({ gaps }) => gaps.map(({ gap }) => -gap || 0)));
  return scene === "stack" ? [20, 5, 2].find((times) => times * deepest < 1.8) ?? 1 : 1;
}

// A model's balls; for one above the picture an arrow.
function lane({ model, made }, row, x, { floor, scale, larger }) {
  let [below, drawn] = [-R, -R]; // of the ball below: where it is, where it is drawn
  const shown = inRow(made, "y", row).map((height) => {
    const apart = height - below - 2 * R;
    drawn += 2 * R + (apart < 0 ? larger * apart : apart);
    below = height;
    const y = Math.min(floor + GROUND, floor - drawn * scale);
    return y > -R * scale ? ball(model, x, y, R * scale) : arrow("weight", x, 67, 0, -30);
  });
  const push = Math.min(40, 14 * Math.sqrt(Math.max(0, pushIn(made, row))));
  return [
    shown, arrow(`push m-${model}`, x, floor + GROUND / 2, 0, -push),
    label(model, x, 15, "middle"), line(x - 24, 23, x + 24, 23, `line m-${model}`),
  ];
}

function chartOf(view, { all, to }, top, time) {
  const { from } = view.own;
  const first = Math.round(from / view.own.dt);
  const seen = all.flatMap(({ gaps }) => gaps.slice(first).map(({ gap }) => gap)).filter(Number.isFinite);
  const low = seen.reduce((a, b) => Math.min(a, b), -0.05);
  const most = Math.min(seen.reduce((a, b) => Math.max(a, b), 0), Math.max(2, -2 * low), 12);
  const margin = 0.06 * (most - low);
  const { sx, box, picture } = plot(view, {
    top, zero: true, x: axis([from, to], ""),
    y: axis([Math.max(low, -10) - margin, most + margin], "gap / r over time / s (r = 0.1 m; overlap < 0)"),
    lines: all.map(({ model, made, gaps }) => ({
      model, points: gaps.slice(first).map(({ gap }, k) => [made.t[first + k], gap]),
      layers: [["whole", view.seen < to ? to : from], ["coming", view.seen], ["", time]],
    })),
  });
  const what = { label: "the time shown", value: "time", low: 0, high: to - from,
    step: view.own.dt, at: (x) => sx.back(x) - from };
  const x = sx(time);
  return [picture, line(x, box.top, x, box.bottom, "rule"), view.point(x, box.bottom - 2, what)];
}

function draw(view) {
  const { own, width, height } = view;
  const [{ all, to }, { from }] = [runsOf(own), own];
  const row = Math.min(Math.round(within(from, from + own.time, to) / own.dt), all[0].made.steps);
  const time = row * own.dt;
  // what comes is not told before it has been played, unless the text shows some of it
  view.seen = Math.max(view.seen ?? (view.text.time > 0 ? to : 0), time);
  const chartTop = Math.round(0.54 * height);
  const [wide, floor] = [width / all.length, chartTop - GROUND];
  const scale = Math.min((floor - NAMES) / topOf(own), (0.42 * wide) / R); // px for 1 m
  const [larger, many] = [enlarged(own, all), own.scene === "stack"];
  const told = all.map(({ model, gaps }) => `${model} ${placeWords(gaps[row], many)}`);
  return {
    picture: [
      clipped(0, 0, width, chartTop, table(0, floor, width, GROUND), all.map((each, k) =>
        lane(each, row, wide * (k + 0.5), { floor, scale, larger })),
      larger > 1 ? label(`overlaps × ${larger}`, 4, 42, "start", "tick") : ""),
      chartOf(view, { all, to }, chartTop, within(from, time, to)),
    ],
    words: `${time.toFixed(3)} s: ${told.join(", ")}.`,
  };
}

const slower = ({ from, to }) => (to - from > 2 ? 1 : to - from > 0.5 ? 6 : 30);

export const figure = {
  title: ({ scene, models }) => `${SCENES[scene]}: ${models.replaceAll(",", ", ")}`,
  caption: ({ scene, from, to, dt }) =>
    `${SCENES[scene]}, from ${plain(from)} to ${plain(to)} s, in steps of ${ms(dt)}.`,
  height: (width) => (width < 480 ? 360 : 440),
  start: ({ scene = "drop" }) => ({
    scene, models: "penalty,lcp", from: 0.4, to: 1.2, knobs: "dt", ...data.scenes[scene].own,
  }),
  clock: ({ own }) => ({ end: runsOf(own).to - own.from, rate: 1 / slower(own) }),
  play: (own) => `Let go${slower(own) > 1 ? `, speed 1/${slower(own)}` : ""}`,
  draw,
};
