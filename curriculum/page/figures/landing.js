/* Where within a step the ball lands decides how deep lcp finds it, and so how high its bias makes
 * it hop; where it bounces, too, the target is the larger of both and not the sum. Values: how deep
 * it is found [r], bounce and bias [m/s], how high it then comes with either [r]. */
import { arrow, axis, ball, clipped, label, number, plot, steps, table } from "../draw.js";
import { data } from "../data.js";
import { column, G, kept, R, record } from "../runs.js";

const [FALL, GROUND, ARROW] = [70, 96, 22]; // px: the fall of one step, the table, 1 m/s
const ARRIVES = Math.sqrt(2 * G * (data.scenes.drop.start[0] - R)); // m/s, on the table

// A flight that begins at a gap [r] with a speed: [time, gap] of its states, and the highest [r].
function flight(gap, vy, knobs, seconds) {
  const count = Math.max(5, Math.ceil(seconds / knobs.dt));
  const run = record("lcp", column([(1 + gap) * R], { vy }), knobs, count);
  const points = Array.from(run.t, (t, k) => [t, run.y[k] / R - 1]);
  return { points, high: Math.max(0, ...points.slice(1).map(([, each]) => each)) };
}

const landing = kept((share, dt, baumgarte, restitution) => {
  const knobs = { ...data.defaults, dt, baumgarte, restitution };
  const [seconds, fall] = [restitution > 0 ? 0.9 : 0.3, (ARRIVES * dt) / R];
  const larger = flight(share * fall, -ARRIVES, knobs, seconds);
  const depth = -Math.min(0, ...larger.points.slice(0, 4).map(([, gap]) => gap));
  const [bounce, bias] = [restitution * ARRIVES, (baumgarte / dt) * depth * R];
  const sum = flight(-depth, bounce + bias, { ...knobs, restitution: 0 }, seconds);
  return { seconds, fall, depth, bounce, bias, larger, sum };
});

function draw(view) {
  const { own: { share, dt, baumgarte, restitution }, width, height } = view;
  const { seconds, fall, depth, bounce, bias, larger, sum } =
    landing(share, dt, baumgarte, restitution);
  const bounces = restitution > 0;
  const [left, floor] = [Math.round(0.38 * width), height - GROUND];
  const [px, r, x] = [FALL / fall, Math.min(42, 0.22 * left), left / 2]; // px: for a gap of 1 r
  const top = 1.15 * Math.max(0.5 * fall, larger.high, bounces ? sum.high : 0);
  const lines = [{ model: "lcp", points: larger.points, kind: "plainly" }];
  if (bounces) lines.push({ model: "lcp", points: sum.points, kind: "dotted" });
  const { picture } = plot(view, {
    left: left + 8,
    x: axis([0, seconds], "time (s)", ...steps(0, seconds, 3)),
    y: axis([-1.2 * fall, top], "gap / r", ...steps(0, top, 3)), zero: true, lines,
  });
  const wish = (name, v, aside) => {
    if (!(v > 0)) return "";
    const kind = v < Math.max(bounce, bias) ? "weaker" : "";
    const at = x + aside * Math.min(r + 24, x - 24);
    return [arrow(`push m-lcp ${kind}`, at, floor, 0, -Math.min(floor - 30, ARROW * v)),
      label(name, Math.max(28, at), floor + GROUND - 10, "middle")];
  };
  const what = {
    label: "the ball: how deep it is found", value: "share", low: 0, high: 0.99, step: 0.05,
    at: (_, y) => -y / FALL,
  };
  const told = [depth, bounce, bias, larger.high, sum.high].map((each) => number(each, 2));
  const words = bounces ? `${told[0]} r deep: bounce ${told[1]}, bias ${told[2]} m/s. The larger ` +
    `lifts it ${told[3]} r, both ${told[4]} r.`
    : `Found ${told[0]} r deep and hops ${told[3]} r high.`;
  return {
    picture: [
      clipped(0, 0, left, height, table(0, floor, left, GROUND),
        label(`gaps × ${number(px / r, 2)}`, 4, 16, "start", "tick"),
        ball("lcp", x, floor - share * FALL - r, r, "ghost"),
        wish("bounce", bounce, -1), wish("bias", bias, 1)),
      view.grab(what, ball("lcp", x, floor + depth * px - r, r)), picture,
    ],
    words,
    values: { depth, bounce, bias, larger: larger.high, sum: sum.high },
  };
}

export const figure = {
  title: "A landing within a step",
  caption: "The dashed ball is the last look before the landing. The sooner after it the ball "
    + "lands, the deeper the next look finds it.",
  height: (width) => (width < 480 ? 260 : 290),
  knobs: ["baumgarte", "restitution"],
  start: () => ({ share: 0.327, restitution: 0 }), // the chapter's own drop
  draw,
};
