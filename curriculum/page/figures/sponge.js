/* Press the ball into the spring: it rests where weight and push are equal, m g / k deep. */
import { arrow, ball, el, number, round, table } from "../draw.js";
import { runModel } from "../engine.js";
import { axis, beside, clock, enlarged, forceLength, G, handle, kept, lens, R, scene, tidy, within } from "../parts.js";

const PX = 54; // a radius
const [DT, SECONDS] = [0.0002, 1.2];
const DEEPEST = 1.1; // r
const floorOf = (view) => view.height - 104;
const restOf = (view) => G / view.get("stiffness") / R; // r

// What the ball does from so deep [r], let go.
const fall = kept((depth, stiffness, damping) =>
  runModel("penalty", scene([(1 - depth) * R]), { dt: DT, stiffness, damping }, Math.round(SECONDS / DT)),
);

function depthOf(view) {
  const { press, time } = view.own;
  if (press === null) return restOf(view);
  if (time === null) return press;
  const run = fall(press, view.get("stiffness"), view.get("damping"));
  return 1 - run.y[Math.round(time / DT)] / R;
}

// A coil from (x, top) down to (x, bottom), the thicker the stiffer.
function coil(x, top, bottom, stiffness) {
  const step = (bottom - top) / 12;
  const turns = Array.from({ length: 12 }, (_, k) => `L${x + (k % 2 ? -16 : 16)} ${round(top + (k + 0.5) * step)}`);
  const path = `M${x} ${round(top)}${turns.join("")}L${x} ${round(bottom)}`;
  return el("path", { d: path, class: "coil", "stroke-width": Math.log10(stiffness) - 0.5 });
}

function picture(view, depth, left) {
  const [floor, x] = [floorOf(view), left / 2];
  const y = floor - PX + depth * PX;
  const push = Math.max(0, (view.get("stiffness") * depth * R) / G);
  const times = enlarged(depth, PX);
  const aside = Math.min(PX + 12, left / 2 - 10);
  return [
    table(0, floor, left, view.height - floor),
    coil(x, Math.max(y + PX, floor), view.height - 4, view.get("stiffness")),
    ball("penalty", x, y, PX),
    arrow("weight", x - aside, y, 0, forceLength(1)),
    arrow("push m-penalty", x + aside, Math.max(y + PX, floor), 0, -Math.min(150, forceLength(push))),
    times > 2 && depth > 0 ? lens("sponge-lens", "penalty", left - 34, 36, { depth, r: PX, times, size: 30 }) : "",
  ].join("");
}

function draw(view) {
  const [k, depth, rest] = [view.get("stiffness"), depthOf(view), restOf(view)];
  const weights = (d) => Math.max(0, (k * d * R) / G);
  const end = Math.min(DEEPEST, 2.7 * rest);
  const chart = {
    x: axis([0, DEEPEST], "depth / r", 0, 0.5, 1),
    y: axis([0, 3], "force / m g", 0, 1, 2, 3),
    lines: [{ model: "penalty", xs: [0, end], ys: [0, weights(end)] }],
    rules: [{ y: 1, text: "weight", class: "dashed" }],
    points: [{ model: "penalty", x: within(0, depth, end), y: Math.min(weights(end), weights(depth)), size: 7 }],
  };
  const { svg, x, y, middle } = beside(view, "sponge", chart, (left) => picture(view, depth, left));
  const text = `${number(Math.abs(depth))} r ${depth < 0 ? "above" : "deep"}, push ${number(weights(depth))} m g`;
  const settled = Math.abs(depth - rest) < 1e-3 * rest;
  return {
    svg,
    words: `${text}. ${settled ? "It rests" : "At rest it would be"} m g / k = ${number(rest)} r deep.`,
    handles: [
      handle("ball", middle, floorOf(view) - PX + depth * PX, PX, "the ball: press it in or lift it", depth, text),
      handle("ramp", x(end), y(weights(end)), 12, "the stiffness k", k, `${number(k)} N/m`),
    ],
    lit: depth > 0 ? [["penalty", "return max(0.0"]] : [],
  };
}

const time = clock(0.25, () => SECONDS, ["Let go", "Stop"]);
const press = (view, depth) => Object.assign(view.own, { time: null, press: tidy(within(-1, depth, DEEPEST)) });
const stiffen = (view, k) => view.set({ stiffness: within(100, tidy(k), 1e6) });

export const figure = {
  title: "A ball on a spring",
  caption: "The ball rests where the spring pushes with its weight, m g / k deep: press the ball, or turn the ramp.",
  height: 290,
  knobs: ["stiffness"],
  uses: ["damping"],
  start: () => ({ press: null, time: null }),
  draw,
  drag(view, name, x, y) {
    if (name === "ball") press(view, (y - floorOf(view)) / PX + 1);
    else stiffen(view, (2.7 * G) / (Math.max(0.001, view.own.along(x) * DEEPEST) * R));
  },
  nudge(view, name, dx, dy) {
    if (name === "ball") press(view, depthOf(view) + dy * Math.max(0.1 * restOf(view), 0.001));
    else stiffen(view, view.get("stiffness") * 1.1 ** (-dy - dx));
  },
  release: (view, name) => name === "ball" && time.start(view),
  ...time.parts,
};
