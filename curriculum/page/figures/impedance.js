/* MuJoCo's impedance: how firmly a soft contact asks, by its depth. */
import { arrow, axis, ball, label, number, table } from "../draw.js";
import { impedance, softDefaults } from "../engine.js";
import { beside, grip, R, softKnobs, wholly } from "../parts.js";

const PX = 1200; // a radius: twenty times nearer than in the other pictures
const MOST = 1.5; // widths

function draw(view) {
  const { depth } = view.own; // in widths
  const { solimp } = softDefaults(softKnobs(view));
  const [d0, d1, width, middle] = solimp;
  const at = (x) => impedance(x * width, solimp);
  const d = at(depth);
  const digits = d > 0.99 ? 4 : 3;
  const xs = Array.from({ length: 61 }, (_, k) => (k / 60) * MOST);
  const pad = 0.25 * (d1 - d0) + 1e-4;
  const ticks = d1 - d0 > 1e-3 ? [d0, (d0 + d1) / 2, d1] : [d1];
  const named = ticks.map((each) => [each, each.toFixed(d1 > 0.99 ? 4 : 3)]);
  const chart = {
    x: axis([0, MOST], "depth / width", 0, 0.5, 1),
    y: axis([d0 - pad, d1 + pad], "impedance d", ...named),
    lines: [{ model: "soft", xs, ys: xs.map(at) }],
    points: [{ model: "soft", x: depth, y: d, size: 8 }],
  };
  const floor = view.height - 70;
  const share = `${number(100 * d, digits)} %`;
  const picture = (left) =>
    table(0, floor, left, 70) +
    ball("soft", left / 2, floor + ((depth * width) / R - 1) * PX, PX, "magnified") +
    arrow("inside", left / 2, floor - 12, 0, -110 * d) +
    label(share, left / 2, floor - 20 - 110 * d, "middle", "tick on-ball");
  const { svg, sx, sy, middle: centre } = beside(view, chart, picture);
  const text = `${number(1000 * depth * width, 2)} mm deep, d = ${number(d, digits)}`;
  const range = { low: 0, high: MOST, step: 0.05, at: sx.back };
  const under = floor + ((depth * width) / R) * PX; // the ball's lowest point
  const press = { ...range, step: -0.05, at: (x, y) => ((y - floor) / PX) * (R / width) };
  const rise = depth <= middle ? "rise = raised" : "rise = 1.0";
  return {
    svg,
    words:
      `${text}: of the acceleration that a hard contact would give it gives ${share}, and ` +
      `R = (1 − d) / d = ${number((1 - d) / d)} per unit of inverse mass.`,
    handles: [
      wholly(grip(view, "depth", centre, under, "the ball: press it", text, press), "ball",
        centre, under, 0, [0, 0, 2 * centre, under]),
      grip(view, "depth", sx(depth), sy(d), "the depth", text, range),
    ],
    lit: [["soft-impedance", depth >= 1 ? "return d1" : rise]],
  };
}

export const figure = {
  title: "MuJoCo’s impedance",
  caption:
    "The deeper the ball, the larger its share of a hard contact’s answer: drag the point, and " +
    "see the ball twenty times nearer.",
  height: 250,
  knobs: ["impedance"],
  start: () => ({ depth: 0.5 }),
  draw,
};
