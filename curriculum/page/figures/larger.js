/* Bounce or bias: the target is the larger of the two, not their sum. */
import { arrow, axis, ball, label, number, steps, table, within } from "../draw.js";
import { runModel } from "../engine.js";
import { ARRIVES, beside, grip, kept, knobs, R, scene, START } from "../parts.js";

const [PX, SPEED, SECONDS] = [54, 20, 0.9]; // px a radius, px for 1 m/s, s
const DEEPEST = 0.5; // r

// The flight of a ball that lcp finds so deep [r] with a speed: heights as shares of the drop.
const flight = kept((depth, v, told) => {
  const found = scene([(1 - depth) * R], { vy: [v], restitution: told.restitution });
  const run = runModel("lcp", found, told, Math.ceil(SECONDS / told.dt));
  return { xs: run.t, ys: Array.from(run.y, (y) => (y - R) / (START - R)) };
});

function draw(view) {
  const { depth } = view.own;
  const told = knobs(view);
  const e = told.restitution;
  const [bounce, bias] = [e * ARRIVES, (told.baumgarte / told.dt) * depth * R]; // m/s
  const larger = flight(depth, -ARRIVES, told);
  const both = flight(depth, bounce + bias, told);
  const chart = {
    x: axis([0, SECONDS], "time (s)", ...steps(0, SECONDS, 4)),
    y: axis([-0.06, 1.5], "height / drop", 0, 0.5, 1),
    lines: [{ model: "lcp", ...larger }, { model: "lcp", ...both, kind: "thin dotted" }],
    rules: e > 0 ? [{ y: e * e, text: "e²", kind: "dashed" }] : [],
  };
  const floor = view.height - 46;
  const y = floor + (depth - 1) * PX;
  const picture = (left) => {
    const x = left / 2;
    const aside = left > 150 ? PX + 14 : 0.36 * left;
    const wish = (name, v, at) => {
      const kind = v < Math.max(bounce, bias) ? "push m-lcp weaker" : "push m-lcp";
      const up = Math.min(floor - 24, SPEED * v);
      const place = within(26, at, left - 20);
      return arrow(kind, at, floor, 0, -up) + label(name, place, floor + 18, "middle");
    };
    const wishes = wish("bounce", bounce, x - aside) + wish("bias", bias, x + aside);
    return table(0, floor, left, 46) + ball("lcp", x, y, PX) + wishes;
  };
  const { svg, middle } = beside(view, chart, picture);
  const high = ({ ys }) => number(Math.max(0, ...ys), 2);
  const wanted = `bounce ${number(bounce)} m/s, bias ${number(bias)} m/s`;
  const text = `${number(depth, 2)} r deep: ${wanted}`;
  const at = (x, to) => (to - floor) / PX + 1;
  const range = { r: PX, low: 0, high: DEEPEST, step: -0.02, at };
  const line = bias > 0 ? "return max(bias" : "return bounce if";
  return {
    svg,
    words:
      `${text}. The larger lifts the ball to ${high(larger)} of the drop, the sum (dotted) to ` +
      `${high(both)}.`,
    handles: [grip(view, "depth", middle, y, "the ball: how deep lcp finds it", text, range)],
    lit: [["lcp-target", e === 0 ? "return bias" : line]],
  };
}

export const figure = {
  title: "A landing: bounce and bias",
  caption:
    "The target is the larger of bounce and bias: with their sum (dotted) a ball that is found " +
    "deep bounces higher than its material allows.",
  height: 280,
  shows: { scene: "bounce", restitution: 0.7 },
  start: () => ({ depth: 0.06 }),
  draw,
};
