/* An impact amid a step of leapfrog: the old path, the new one, and the new one drawn back. */
import { arrow, axis, ball, label, lane, line, mark, number, plot, range, within } from "../draw.js";
import { time_to_impact } from "../contact.js";
import { column, G, R, record } from "../runs.js";

const [DT, SPEED, E] = [0.02, -4, 0.7]; // s, m/s at the start of the step
const FALL = (0.5 * G * DT * DT) / R; // r, by gravity in a step
const MOST = -(SPEED * DT) / R + FALL; // r: from a larger gap it does not arrive

function draw(view) {
  const { own: { gap } } = view;
  const when = time_to_impact(gap * R, SPEED, -G) / DT;
  const change = (-(1 + E) * (SPEED - G * DT * when) * DT) / R; // of its velocity [r in a step]
  const old = (t) => gap + ((SPEED * DT) / R) * t - FALL * t * t;
  const renewed = (t) => old(t) + change * (t - when);
  const run = record("leapfrog", column([(1 + gap) * R], { vy: SPEED }),
    { dt: DT, restitution: E, iters: 20 }, 1);
  const [back, end] = [renewed(0), run.y[1] / R - 1];
  const way = (f, from, to, kind, model) => ({ model, kind,
    points: range(41, (k) => from + ((to - from) * k) / 40).map((t) => [t, f(t)]) });
  const { left, x, r, at, drawn } = lane(view, { under: 0.48 * view.height });
  const { sx, sy, box, picture } = plot(view, {
    left, zero: true, x: axis([0, 1], "time / dt", 0, 0.5, 1), y: axis([-1, 1], "gap / r", -1, 0, 1),
    lines: [way(old, when, 1, "old", "body"), way(old, 0, when, "step-line", "body"),
      way(renewed, 0, when, "drawn-back", "leapfrog"), way(renewed, when, 1, "plainly", "leapfrog")],
  });
  const what = { label: "the ball: its gap at the start of the step", value: "gap", low: 0.01,
    high: 0.99 * MOST, step: 0.02, at: (_, y) => -y / r };
  return {
    picture: [
      drawn(ball("leapfrog", x, at(back), r, "ghost"), arrow("weight", x + r + 10, at(gap), 0, -12 * SPEED)),
      view.grab(what, ball("leapfrog", x, at(gap), r)), picture,
      line(sx(when), box.top, sx(when), box.bottom, "grid"),
      label("impact", within(box.left + 30, sx(when), box.right - 30), sy(0) - 10, "middle", "tick"),
      mark("fixed", sx(0), sy(gap)), mark("leapfrog", sx(0), sy(back)), mark("leapfrog", sx(1), sy(end)),
    ],
    words: `It meets the table after ${number(when, 2)} of the step. Set back to ${number(back, 2)} r, ` +
      `it ends at ${number(end, 2)} r.`,
  };
}

export const figure = {
  title: "An impact amid a step, set back",
  caption: "Old path dashed. The new path, drawn back, begins where the ball is set.",
  height: (width) => (width < 480 ? 270 : 320),
  start: () => ({ gap: 0.35 }),
  draw,
};
