/* MuJoCo's impedance: how firmly a soft contact asks, by its depth. */
import { arrow, ball, number, plot, table } from "../draw.js";
import { impedance, softDefaults } from "../engine.js";
import { knobsOf } from "../store.js";
import { clipped, label, R, shift, split, within } from "../parts.js";

const PX = 1000; // a radius: twenty times nearer than in the other pictures
const MOST = 1.5; // widths
const solimpOf = (view) => softDefaults({ ...knobsOf(view.values), restitution: 0 }).solimp;

function chartOf(view, width) {
  const solimp = solimpOf(view);
  const [d0, d1, deep] = solimp;
  const at = (share) => impedance(share * deep, solimp);
  const xs = Array.from({ length: 61 }, (_, k) => (k / 60) * MOST);
  const pad = 0.25 * (d1 - d0) + 1e-4;
  const shown = (d) => [d, d.toFixed(d1 > 0.99 ? 4 : 2)];
  return plot({
    id: "impedance",
    width,
    height: view.height,
    x: { domain: [0, MOST], ticks: [[0, "0"], [0.5, "0.5"], [1, "1"], [1.5, "1.5"]], label: "depth / width" },
    y: { domain: [d0 - pad, d1 + pad], ticks: d1 - d0 > 1e-3 ? [shown(d0), shown((d0 + d1) / 2), shown(d1)] : [shown(d1)], label: "impedance d" },
    lines: [{ model: "soft", xs, ys: xs.map(at) }],
    points: [{ model: "soft", x: view.own.share, y: at(view.own.share), size: 8 }],
  });
}

function draw(view) {
  const { left, right, at } = split(view.width);
  const solimp = solimpOf(view);
  const depth = view.own.share * solimp[2];
  const d = impedance(depth, solimp);
  const chart = chartOf(view, right);
  const floor = view.height - 70;
  const under = floor + (depth / R) * PX;
  const picture = clipped(
    "impedance-scene", 0, 0, left, view.height,
    table(0, floor, left, 70),
    ball("soft", left / 2, under - PX, PX, "ball plainly"),
    arrow("push m-soft", left / 2, floor - 12, 0, -110 * d),
    label(`${number(100 * d)} %`, left / 2 + 12, floor - 90),
  );
  const text = `${number(1000 * depth, 2)} mm deep, d = ${number(d)}`;
  return {
    svg: picture + shift(at, 0, chart.markup),
    words: `${text}: of the acceleration that a hard contact would give it gives ${number(100 * d)} %, and R = (1 − d) / d = ${number((1 - d) / d)} per unit of inverse mass.`,
    handles: [{ name: "depth", x: at + chart.sx(view.own.share), y: chart.sy(d), r: 14, label: "the depth", value: view.own.share, text }],
  };
}

const set = (view, share) => (view.own.share = Number(within(0, share, MOST).toFixed(2)));

export const figure = {
  title: "MuJoCo’s impedance",
  caption: "The deeper the ball, the larger its share of a hard contact’s answer: drag the point, and see the ball twenty times nearer.",
  height: 250,
  knobs: ["impedance"],
  start: () => ({ share: 0.5 }),
  draw,
  drag(view, name, x) {
    const { right, at } = split(view.width);
    const { box } = chartOf(view, right);
    set(view, ((x - at - box.left) / (box.right - box.left)) * MOST);
  },
  nudge: (view, name, dx, dy) => set(view, view.own.share + 0.05 * (dx - dy)),
};
