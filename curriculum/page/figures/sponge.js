/* Press the ball into the spring: it rests where weight and push are equal, m g / k deep. */
import { arrow, axis, ball, el, number, round, table, within } from "../draw.js";
import { runModel } from "../engine.js";
import { beside, forceLength, G, grip, kept, lens, R, scene } from "../parts.js";

const [PX, GROUND] = [54, 104]; // px: a radius, the table
const [DT, SECONDS] = [0.0002, 1.2];
const [DEEPEST, HIGHEST] = [1.1, 1.2]; // r
const MOST = 2.7; // weights, at the end of the ramp

// What the ball does from so deep [r], let go.
const fall = kept((depth, stiffness, damping) => {
  const pressed = scene([(1 - depth) * R]);
  return runModel("penalty", pressed, { dt: DT, stiffness, damping }, Math.round(SECONDS / DT)).y;
});

function depthOf(view, rest) {
  const { press, time } = view.own;
  if (press === null || time === null) return press ?? rest;
  const heights = fall(press, view.get("stiffness"), view.get("damping"));
  return 1 - heights[Math.round(time / DT)] / R;
}

// A coil from (x, top) down to (x, bottom), the thicker the stiffer.
function coil(x, top, bottom, stiffness) {
  const step = (bottom - top) / 12;
  const turn = (_, k) => `L${x + (k % 2 ? -16 : 16)} ${round(top + (k + 0.5) * step)}`;
  const turns = Array.from({ length: 12 }, turn).join("");
  const d = `M${x} ${round(top)}${turns}L${x} ${round(bottom)}`;
  return el("path", { d, class: "coil", "stroke-width": Math.log10(stiffness) - 0.5 });
}

function picture(left, height, stiffness, depth, push) {
  const [x, floor, aside] = [left / 2, height - GROUND, Math.min(PX + 12, left / 2 - 10)];
  const y = floor + (depth - 1) * PX;
  const under = Math.max(y + PX, floor);
  return [
    table(0, floor, left, GROUND),
    coil(x, under, height - 4, stiffness),
    ball("penalty", x, y, PX),
    arrow("weight", x - aside, y, 0, forceLength(1)),
    arrow("push m-penalty", x + aside, under, 0, -Math.min(150, forceLength(push))),
    lens("sponge-lens", "penalty", left - 34, 36, PX, depth, 30),
  ].join("");
}

function draw(view) {
  const k = view.get("stiffness");
  const rest = G / k / R; // r
  const depth = depthOf(view, rest);
  const push = Math.max(0, depth / rest); // weights
  const [floor, end] = [view.height - GROUND, Math.min(DEEPEST, MOST * rest)];
  const y = floor + (depth - 1) * PX;
  const chart = {
    x: axis([0, DEEPEST], "depth / r", 0, 0.5, 1),
    y: axis([0, 3], "force / m g", 0, 1, 2, 3),
    lines: [{ model: "penalty", xs: [0, end], ys: [0, end / rest] }],
    rules: [{ y: 1, text: "weight", kind: "dashed" }],
    points: [{ model: "penalty", x: within(0, depth, end), y: Math.min(MOST, push), size: 7 }],
  };
  const drawn = (left) => picture(left, view.height, k, depth, push);
  const { svg, sx, sy, middle } = beside(view, chart, drawn);
  const place = `${number(Math.abs(depth))} r ${depth < 0 ? "above" : "deep"}`;
  const text = `${place}, push ${number(push)} m g`;
  const settled = Math.abs(depth - rest) < 1e-3 * rest ? "It rests" : "At rest it would be";
  const hold = {
    r: PX,
    low: -1,
    high: Math.min(DEEPEST, Math.sqrt(2 * HIGHEST * rest)), // it stays in the picture
    step: -Math.max(0.1 * rest, 0.001),
    at: (x, to) => (to - floor) / PX + 1,
    get: () => depthOf(view, rest),
    release: view.play,
  };
  const turn = { times: 1.1, at: (x) => (MOST * G) / (Math.max(0.001, sx.back(x)) * R) };
  const steep = `${number(k)} N/m`;
  return {
    svg,
    words: `${text}. ${settled} m g / k = ${number(rest)} r deep.`,
    handles: [
      grip(view, "press", middle, y, "the ball: press it or lift it", text, hold),
      grip(view, "stiffness", sx(end), sy(end / rest), "the stiffness k", steep, turn),
    ],
    lit: depth > 0 ? [["penalty", "return max(0.0"]] : [],
  };
}

export const figure = {
  title: "A ball on a spring",
  caption:
    "The ball rests where the spring pushes with its weight, m g / k deep: press the ball, or " +
    "turn the ramp.",
  height: 290,
  knobs: ["stiffness"],
  start: () => ({ press: null, time: null }),
  clock: () => ({ end: SECONDS, rate: 0.25, name: "Let go" }),
  draw,
};
