/* An impact amid a step of leapfrog: the old path up to the impact, the new one from there, and the
 * new one drawn back to the start of the step, where the ball is set. Values: when it meets the
 * table [steps], where it is set and where it ends [r]. */
import { arrow, axis, ball, clipped, label, line, mark, number, plot, range, table, within } from "../draw.js";
import { time_to_impact } from "../contact.js";
import { column, G, R, record } from "../runs.js";

const [DT, SPEED, E] = [0.02, -4, 0.7]; // s, m/s at the start of the step
const MOST = (-SPEED * DT + (G / 2) * DT * DT) / R; // r: from a larger gap it does not arrive
const [LOW, HIGH] = [-1, 1]; // r

function draw(view) {
  const { own: { gap }, width, height } = view;
  const when = time_to_impact(gap * R, SPEED, -G) / DT;
  const change = (-(1 + E) * (SPEED - G * DT * when) * DT) / R; // of its velocity [r in a step]
  const fall = (0.5 * G * DT * DT) / R;
  const old = (t) => gap + ((SPEED * DT) / R) * t - fall * t * t;
  const renewed = (t) => old(t) + change * (t - when);
  const run = record("leapfrog", column([(1 + gap) * R], { vy: SPEED }),
    { dt: DT, restitution: E, iters: 20 }, 1);
  const end = run.y[1] / R - 1;
  const between = (f, from, to) => range(41, (k) => from + ((to - from) * k) / 40).map((t) => [t, f(t)]);
  const [left, floor] = [Math.round(0.3 * width), Math.round(0.52 * height)];
  const [r, x] = [Math.min(46, 0.26 * left), 0.5 * left];
  const { sx, sy, box, picture } = plot(view, {
    left: left + 8, zero: true,
    x: axis([0, 1], "time / dt", 0, 0.5, 1),
    y: axis([LOW, HIGH], "gap / r", -1, 0, 1),
    lines: [
      { model: "body", points: between(old, when, 1), kind: "old" },
      { model: "body", points: between(old, 0, when), kind: "step-line" },
      { model: "leapfrog", points: between(renewed, 0, when), kind: "drawn-back" },
      { model: "leapfrog", points: between(renewed, when, 1), kind: "plainly" },
    ],
  });
  const what = { label: "the ball: its gap at the start of the step", value: "gap", low: 0.01,
    high: 0.99 * MOST, step: 0.02, at: (_, to) => -to / r };
  return {
    picture: [
      clipped(0, 0, left, height, table(0, floor, left, height - floor),
        ball("leapfrog", x, floor - renewed(0) * r - r, r, "ghost"),
        arrow("weight", x + r + 10, floor - gap * r - r, 0, -12 * SPEED)),
      view.grab(what, ball("leapfrog", x, floor - gap * r - r, r)), picture,
      line(sx(when), box.top, sx(when), box.bottom, "grid"),
      label("impact", within(box.left + 30, sx(when), box.right - 30), sy(0) - 10, "middle", "tick"),
      mark("fixed", sx(0), sy(gap)), mark("leapfrog", sx(0), sy(renewed(0))),
      mark("leapfrog", sx(1), sy(end)),
    ],
    words: `It meets the table after ${number(when, 2)} of the step. Set back to ` +
      `${number(renewed(0), 2)} r, it ends at ${number(end, 2)} r.`,
    values: { when, back: renewed(0), end },
  };
}

export const figure = {
  title: "An impact amid a step, set back",
  caption: "Old path dashed. The new path, drawn back, begins where the ball is set.",
  height: (width) => (width < 480 ? 270 : 320),
  start: () => ({ gap: 0.35 }),
  draw,
};
