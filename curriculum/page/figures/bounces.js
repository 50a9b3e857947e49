/* Infinitely many bounces, over at a finite time. */
import { axis, ball, number, steps } from "../draw.js";
import { runModel } from "../engine.js";
import { ARRIVES, charted, G, grip, kept, R, scene, START } from "../parts.js";

const ROWS = 600;
const LAND = ARRIVES / G; // s

// When all bounces are over [s], and when the k-th (from 1) is at its top.
const over = (e) => (LAND * (1 + e)) / (1 - e);
const top = (e, k) => LAND * (1 + (2 * e * (1 - e ** (k - 1))) / (1 - e) + e ** k);

const run = kept((restitution, until) =>
  runModel("exact", scene([START], { restitution }), { dt: until / ROWS }, ROWS),
);

function draw(view) {
  const { e } = view.own;
  const [end, until] = [over(e), Math.max(1, 1.15 * over(e))];
  const { t, y } = run(e, until);
  const side = end < 0.5 * until ? "start" : "end"; // where its words have room
  const { svg, sx, sy } = charted(view, {
    x: axis([0, until], "time (s)", ...steps(0, until)),
    y: axis([0, 1.15], "height (m)", 0, 0.5, 1),
    lines: [{ model: "exact", xs: t, ys: y }],
    rules: [{ x: end, text: `over at ${number(end)} s`, kind: "dashed", row: 1, side }],
  });
  const r = sy(0) - sy(R);
  const tops = [1, 2, 3, 4].map((k) => top(e, k)).filter((time) => time < until);
  const balls = tops.map((time) => [sx(time), sy(y[Math.round((time / until) * ROWS)])]);
  const text = `e = ${e.toFixed(2)}`;
  const high = `every bounce is e² = ${number(e * e, 2)} times as high as the last`;
  const lift = (x, to) => Math.sqrt(Math.max(0, sy.back(to) - R) / (START - R));
  const range = { r: Math.max(r, 14), low: 0, high: 0.95, step: 0.01, at: lift };
  return {
    svg: [
      ...balls.slice(1).map((at) => ball("exact", ...at, r, "ghost")),
      svg,
      ball("exact", ...balls[0], r),
      ball("exact", sx(until) - r, sy(R), r, "ghost"),
    ].join(""),
    words: `${text}: ${high}, and all are over at ${number(end)} s.`,
    handles: [grip(view, "e", ...balls[0], "the top of the first bounce", text, range)],
  };
}

export const figure = {
  title: "Bounces that end",
  caption:
    "There are infinitely many bounces, and they are over at a finite time: drag the top of the " +
    "first.",
  height: 250,
  start: () => ({ e: 0.7 }), // that of the scene bounce
  draw,
};
