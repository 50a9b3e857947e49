/* Landing on a spring: deep, and thrown back. Picture and chart have one scale. */
import { arrow, axis, ball, number, steps, table } from "../draw.js";
import { pushOfTable, runModel } from "../engine.js";
import { beside, forceLength, G, grip, kept, R, scene, START } from "../parts.js";

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
  const push = (row) => (row ? pushOfTable(run, one, row) / G : 0);
  const domain = [1.15 * low - 0.05, Math.min(3, 1.1 * up) + 0.1];
  return { t: run.t, gaps, push, domain, deepest: FROM + seen.indexOf(low) * DT };
});

function draw(view) {
  const { t, gaps, push, domain, deepest } = landing(view.get("stiffness"), view.get("damping"));
  const time = () => view.own.time ?? deepest;
  const row = rowOf(time());
  const chart = {
    x: axis([FROM, TO], "time (s)", ...steps(FROM, TO, view.width < 480 ? 2 : 4)),
    y: axis(domain, "gap / r", ...steps(...domain)),
    lines: [{ model: "penalty", xs: t, ys: gaps, from: rowOf(FROM) }],
    rules: [{ y: 0 }],
    points: [{ model: "penalty", x: t[row], y: gaps[row], size: 7 }],
  };
  const picture = (left, { sy }) => {
    const [floor, bottom, r] = [sy(0), sy(gaps[row]), sy(0) - sy(1)];
    const pushed = Math.min(forceLength(push(row), 12), floor);
    return [
      table(0, floor, left, view.height - floor),
      ball("penalty", left / 2, bottom - r, r, "ball plainly"),
      arrow("weight", left / 2 - 40, floor - 60, 0, forceLength(1, 12)),
      arrow("push m-penalty", left / 2 + 40, Math.max(floor, bottom), 0, -pushed),
    ].join("");
  };
  const { svg, sx, sy } = beside(view, chart, picture, 0.36);
  const place = `${number(Math.abs(gaps[row]), 2)} r ${gaps[row] > 0 ? "above" : "deep"}`;
  const text = `${place} at ${t[row].toFixed(3)} s`;
  const range = { low: FROM, high: TO, step: 0.005, at: sx.back, get: time };
  return {
    svg,
    words: `${text}; the push is ${number(push(row), 2)} m g.`,
    handles: [grip(view, "time", sx(t[row]), sy(gaps[row]), { label: "the moment", text, ...range })],
    lit: gaps[row] < 0 ? [["penalty", "return max(0.0"]] : [],
  };
}

export const figure = {
  title: "The landing on a spring",
  caption:
    "The spring takes up the whole fall, so the ball dives and is thrown back: drag the moment along the " +
    "curve.",
  height: 280,
  start: () => ({ time: null }),
  clock: () => ({ from: FROM, end: TO, rate: 0.12, names: ["Play", "Stop"] }),
  draw,
};
