/* MuJoCo's impedance: how firmly a soft contact asks, by its depth. */
import { arrow, axis, ball, label, number, table } from "../draw.js";
import { impedance, softDefaults } from "../engine.js";
import { beside, grip, lens, R, softKnobs } from "../kit.js";

const [GROUND, HARD, TIMES] = [60, 120, 40]; // px of the table, of an arrow for d = 1; of the lens
const MOST = 1.5; // widths

// How d rises with the depth, in widths.
function chartOf([d0, d1], at, depth) {
  const xs = Array.from({ length: 61 }, (_, k) => (k / 60) * MOST);
  const pad = 0.25 * (d1 - d0) + 1e-4;
  const ticks = d1 - d0 > 1e-3 ? [d0, (d0 + d1) / 2, d1] : [d1];
  const named = ticks.map((each) => [each, each.toFixed(d1 > 0.99 ? 4 : 3)]);
  return {
    x: axis([0, MOST], "depth / width", 0, 0.5, 1),
    y: axis([d0 - pad, d1 + pad], "impedance d", ...named),
    lines: [{ model: "soft", xs, ys: xs.map(at) }],
    points: [{ model: "soft", x: depth, y: at(depth), size: 8 }],
  };
}

// The ball `deep` in the table [r], and its share of a hard contact's answer as an arrow.
const picture = (left, floor, r, deep, d, share) => [
  table(0, floor, left, GROUND),
  ball("soft", left / 2, floor + (deep - 1) * r, r),
  lens("soft", 40, 42, r, deep, 38, TIMES),
  arrow("push m-soft weaker", left - 22, floor, 0, -HARD),
  arrow("push m-soft", left - 34, floor, 0, -HARD * d),
  label(share, left - 4, floor - HARD - 8, "end", "tick"),
].join("");

function draw(view) {
  const { depth } = view.own; // in widths
  const { solimp } = softDefaults(softKnobs(view));
  const [, , width, middle] = solimp;
  const at = (x) => impedance(x * width, solimp);
  const d = at(depth);
  const digits = d > 0.99 ? 4 : 3;
  const [floor, r] = [view.height - GROUND, Math.min(50, 0.09 * view.width)]; // px
  const share = `${number(100 * d, digits)} %`;
  const drawn = (left) => picture(left, floor, r, (depth * width) / R, d, share);
  const { svg, sx, sy, middle: centre } = beside(view, chartOf(solimp, at, depth), drawn);
  const text = `${number(1000 * depth * width, 2)} mm deep, d = ${number(d, digits)}`;
  const range = { low: 0, high: MOST, step: 0.05, at: sx.back };
  const press = { ...range, r, step: -0.05, by: (dx, dy) => dy / 60 };
  const whole = grip(view, "depth", centre, floor - r, "the ball: press it", text, press);
  const rise = depth <= middle ? "rising" : "levelling";
  return {
    svg,
    words:
      `${text}: of the acceleration that a hard contact would give it gives ${share}, and ` +
      `R = (1 − d) / d = ${number((1 - d) / d)} per unit of inverse mass.`,
    handles: [
      { ...whole, name: "ball" },
      grip(view, "depth", sx(depth), sy(d), "the depth", text, range),
    ],
    lit: [depth >= 1 ? "hardest" : rise],
  };
}

export const figure = {
  title: "MuJoCo’s impedance",
  caption:
    "The deeper the ball, the larger its share of a hard contact’s answer: press the ball, or " +
    "drag the point.",
  height: 250,
  knobs: ["impedance"],
  start: () => ({ depth: 0.5 }),
  draw,
};
