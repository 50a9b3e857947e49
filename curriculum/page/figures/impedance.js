/* MuJoCo's impedance: how firmly a soft contact asks, by its depth. */
import { arrow, ball, number, table } from "../draw.js";
import { impedance, softDefaults } from "../engine.js";
import { alongAxis, axis, beside, handle, label, R, softKnobs, within } from "../parts.js";

const PX = 1200; // a radius: twenty times nearer than in the other pictures
const MOST = 1.5; // widths

function chartOf(solimp, share) {
  const [d0, d1, deep] = solimp;
  const at = (x) => impedance(x * deep, solimp);
  const xs = Array.from({ length: 61 }, (_, k) => (k / 60) * MOST);
  const pad = 0.25 * (d1 - d0) + 1e-4;
  const shown = d1 - d0 > 1e-3 ? [d0, (d0 + d1) / 2, d1] : [d1];
  return {
    x: axis([0, MOST], "depth / width", 0, 0.5, 1),
    y: axis([d0 - pad, d1 + pad], "impedance d", ...shown.map((d) => [d, d.toFixed(d1 > 0.99 ? 4 : 3)])),
    lines: [{ model: "soft", xs, ys: xs.map(at) }],
    points: [{ model: "soft", x: share, y: at(share), size: 8 }],
  };
}

function draw(view) {
  const share = view.own.depth; // of the width
  const { solimp } = softDefaults(softKnobs(view));
  const depth = share * solimp[2];
  const d = impedance(depth, solimp);
  const digits = d > 0.99 ? 4 : 3;
  const floor = view.height - 70;
  const picture = (left) =>
    table(0, floor, left, 70) +
    ball("soft", left / 2, floor + (depth / R) * PX - PX, PX, "ball plainly") +
    arrow("push m-soft", left / 2, floor - 12, 0, -110 * d) +
    label(`${number(100 * d, digits)} %`, left / 2, floor - 20 - 110 * d, "middle");
  const { svg, x, y } = beside(view, "impedance", chartOf(solimp, share), picture);
  const text = `${number(1000 * depth, 2)} mm deep, d = ${number(d, digits)}`;
  const all = "of the acceleration that a hard contact would give it gives";
  return {
    svg,
    words: `${text}: ${all} ${number(100 * d, digits)} %, and R = (1 − d) / d = ${number((1 - d) / d)} per unit of inverse mass.`,
    handles: [handle("depth", x(share), y(d), 14, "the depth", share, text)],
    lit: [["soft-impedance", share >= 1 ? "return d1" : share <= solimp[3] ? "rise = raised" : "rise = 1.0"]],
  };
}

const set = (view, share) => (view.own.depth = Number(within(0, share, MOST).toFixed(2)));

export const figure = {
  title: "MuJoCo’s impedance",
  caption: "The deeper the ball, the larger its share of a hard contact’s answer: drag the point, and see the ball twenty times nearer.",
  height: 250,
  knobs: ["impedance"],
  start: () => ({ depth: 0.5 }),
  draw,
  ...alongAxis((view, share) => set(view, share * MOST), (view, by) => set(view, view.own.depth + 0.05 * by)),
};
