/* Landing on a spring: deep, and thrown back. Picture and chart have one scale. */
import { arrow, ball, number, steps, table } from "../draw.js";
import { pushOfTable, runModel } from "../engine.js";
import { alongAxis, beside, clock, forceLength, G, handle, kept, R, scene, START, within } from "../parts.js";

const [DT, FROM, TO] = [0.0005, 0.4, 1.2]; // s
const rowOf = (time) => Math.round(time / DT);

// Gap [r] and push [m g] of a landing, when it is deepest, and what the chart shows.
const landing = kept((stiffness, damping) => {
  const one = scene([START]);
  const run = runModel("penalty", one, { dt: DT, stiffness, damping }, rowOf(TO));
  const gaps = Array.from(run.y, (y) => y / R - 1);
  const seen = gaps.slice(rowOf(FROM));
  const low = Math.min(...seen);
  const up = Math.max(0, ...seen.slice(seen.indexOf(low)));
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

function draw(view) {
  const { t, gaps, push, domain } = of(view);
  const row = rowOf(timeOf(view));
  const chart = {
    x: { domain: [FROM, TO], ticks: steps(FROM, TO, view.width < 480 ? 2 : 4), label: "time (s)" },
    y: { domain, ticks: steps(...domain, 5), label: "gap / r" },
    lines: [{ model: "penalty", xs: t, ys: gaps, from: rowOf(FROM), to: rowOf(TO) + 1 }],
    rules: [{ y: 0 }],
    points: [{ model: "penalty", x: t[row], y: gaps[row], size: 7 }],
  };
  const picture = (left, { sy }) => {
    const [floor, bottom, r] = [sy(0), sy(gaps[row]), sy(0) - sy(1)];
    return [
      table(0, floor, left, view.height - floor),
      ball("penalty", left / 2, bottom - r, r, "ball plainly"),
      arrow("weight", left / 2 - 40, floor - 60, 0, forceLength(1, 12)),
      arrow("push m-penalty", left / 2 + 40, Math.max(floor, bottom), 0, -Math.min(forceLength(push(row), 12), floor)),
    ].join("");
  };
  const { svg, x, y } = beside(view, "dive", chart, picture, 0.36);
  const text = `${number(Math.abs(gaps[row]), 2)} r ${gaps[row] > 0 ? "above" : "deep"} at ${t[row].toFixed(3)} s`;
  return {
    svg,
    words: `${text}; the push is ${number(push(row), 2)} m g.`,
    handles: [handle("time", x(t[row]), y(gaps[row]), 14, "the moment", t[row], text)],
    lit: gaps[row] < 0 ? [["penalty", "return max(0.0"]] : [],
  };
}

const set = (view, at) => (view.own.time = Number(within(FROM, at, TO).toFixed(4)));
const time = clock(0.12, () => TO, ["Play", "Stop"], FROM);

export const figure = {
  title: "The landing on a spring",
  caption: "The spring takes up the whole fall, so the ball dives and is thrown back: drag the moment along the curve.",
  height: 280,
  uses: ["stiffness", "damping"],
  start: () => ({ time: null }),
  draw,
  ...alongAxis((view, share) => set(view, FROM + share * (TO - FROM)), (view, by) => set(view, timeOf(view) + 0.005 * by)),
  ...time.parts,
};
