/* Landing on a spring: deep, and thrown back. Picture and chart have one scale. */
import { arrow, ball, number, plot, steps, table } from "../draw.js";
import { pushOfTable, runModel } from "../engine.js";
import { clipped, clock, forceLength, G, kept, R, scene, shift, split, START, within } from "../parts.js";

const [DT, FROM, TO] = [0.0005, 0.4, 1.2]; // s
const rowOf = (time) => Math.round(time / DT);

// Gap [r] and push [m g] of a landing, and the chart's range.
const landing = kept((stiffness, damping) => {
  const one = scene([START]);
  const run = runModel("penalty", one, { dt: DT, stiffness, damping }, rowOf(TO));
  const gaps = Array.from(run.y, (y) => y / R - 1);
  const seen = gaps.slice(rowOf(FROM));
  const low = Math.min(...seen);
  const landed = seen.findIndex((gap) => gap <= 0);
  const up = Math.max(0, ...seen.slice(Math.max(landed, 0)));
  return {
    t: run.t,
    gaps,
    deepest: FROM + seen.indexOf(low) * DT,
    push: (row) => (row ? pushOfTable(run, one, row) / G : 0),
    domain: [1.15 * low - 0.05, Math.min(3, 1.1 * up) + 0.1],
  };
});

const of = (view) => landing(view.get("stiffness"), view.get("damping"));
const timeOf = (view) => view.own.time ?? of(view).deepest;

function chartOf(view, width) {
  const { t, gaps, domain } = of(view);
  const row = rowOf(timeOf(view));
  return plot({
    id: "dive",
    width,
    height: view.height,
    x: { domain: [FROM, TO], ticks: steps(FROM, TO, 4), label: "time (s)" },
    y: { domain, ticks: steps(...domain, 5), label: "gap / r" },
    lines: [{ model: "penalty", xs: t, ys: gaps, from: rowOf(FROM), to: rowOf(TO) + 1 }],
    rules: [{ y: 0 }],
    points: [{ model: "penalty", x: t[row], y: gaps[row], size: 7 }],
  });
}

function draw(view) {
  const { left, right, at } = split(view.width, 0.36);
  const { gaps, push, t } = of(view);
  const row = rowOf(timeOf(view));
  const chart = chartOf(view, right);
  const [floor, bottom] = [chart.sy(0), chart.sy(gaps[row])];
  const r = floor - chart.sy(1);
  const force = push(row);
  const text = `${number(Math.abs(gaps[row]), 2)} r ${gaps[row] > 0 ? "above" : "deep"} at ${t[row].toFixed(3)} s`;
  const picture = clipped(
    "dive-scene", 0, 0, left, view.height,
    table(0, floor, left, view.height - floor),
    ball("penalty", left / 2, bottom - r, r, "ball plainly"),
    arrow("weight", left / 2 - 40, floor - 60, 0, forceLength(1, 12)),
    arrow("push m-penalty", left / 2 + 40, Math.max(floor, bottom), 0, -Math.min(forceLength(force, 12), floor)),
  );
  return {
    svg: picture + shift(at, 0, chart.markup),
    words: `${text}; the push is ${number(force, 2)} m g.`,
    handles: [{ name: "time", x: at + chart.sx(t[row]), y: chart.sy(gaps[row]), r: 14, label: "the moment", value: t[row], text }],
  };
}

const time = clock(0.12, () => TO);
const set = (view, at) => (view.own.time = Number(within(FROM, at, TO).toFixed(4)));

export const figure = {
  title: "The landing on a spring",
  caption: "The spring takes up the whole fall, so the ball dives and is thrown back: drag the moment along the curve.",
  height: 280,
  uses: ["stiffness", "damping"],
  start: () => ({ time: null }),
  draw,
  drag(view, name, x) {
    view.stop();
    const { right, at } = split(view.width, 0.36);
    const left = chartOf(view, right).box.left;
    set(view, FROM + ((x - at - left) / (right - 10 - left)) * (TO - FROM));
  },
  nudge(view, name, dx, dy) {
    view.stop();
    set(view, timeOf(view) + 0.005 * (dx - dy));
  },
  tick: (view, seconds) => {
    if (view.own.time === null || view.own.time < FROM) view.own.time = FROM;
    return time.tick(view, seconds);
  },
  buttons: [time.button],
};
