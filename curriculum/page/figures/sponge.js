/* Press the ball into the spring: it rests where weight and push are equal, m g / k deep. */
import { arrow, ball, el, number, plot, round, table } from "../draw.js";
import { runModel } from "../engine.js";
import { clipped, clock, enlarged, forceLength, G, kept, label, lens, R, scene, shift, split, tidy, within } from "../parts.js";

const PX = 54; // a radius
const DT = 0.0002; // s
const SECONDS = 1.2;
const DEEPEST = 1.1; // r
const floorOf = (view) => view.height - 104;
const restOf = (view) => G / view.get("stiffness") / R; // r

// What the ball does from so deep [r], let go.
const fall = kept((depth, stiffness, damping) =>
  runModel("penalty", scene([(1 - depth) * R]), { dt: DT, stiffness, damping }, SECONDS / DT),
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
  const turns = 6;
  const step = (bottom - top) / (2 * turns);
  const zigzag = Array.from({ length: 2 * turns }, (_, k) => `L${x + (k % 2 ? -16 : 16)} ${round(top + (k + 0.5) * step)}`);
  return el("path", { d: `M${x} ${round(top)}${zigzag.join("")}L${x} ${round(bottom)}`, class: "coil", "stroke-width": Math.log10(stiffness) - 0.5 });
}

function scenery(view, depth, left) {
  const [floor, x] = [floorOf(view), left / 2];
  const y = floor - PX + depth * PX;
  const push = Math.max(0, (view.get("stiffness") * depth * R) / G);
  const times = enlarged(depth, PX);
  const near = times > 2 && depth > 0;
  return clipped(
    "sponge-scene", 0, 0, left, view.height,
    table(0, floor, left, view.height - floor),
    coil(x, Math.max(y + PX, floor), view.height - 4, view.get("stiffness")),
    ball("penalty", x, y, PX),
    arrow("weight", x - PX - 12, y, 0, forceLength(1)),
    arrow("push m-penalty", x + PX + 12, Math.max(y + PX, floor), 0, -Math.min(150, forceLength(push))),
    near ? lens("sponge-lens", "penalty", left - 34, 36, { depth, r: PX, times, size: 30 }) : "",
  );
}

function draw(view) {
  const { left, right, at } = split(view.width);
  const [k, depth, rest] = [view.get("stiffness"), depthOf(view), restOf(view)];
  const weights = (d) => Math.max(0, (k * d * R) / G);
  const end = Math.min(DEEPEST, (2.7 * G) / k / R);
  const chart = plot({
    id: "sponge",
    width: right,
    height: view.height,
    x: { domain: [0, DEEPEST], ticks: [[0, "0"], [0.5, "0.5"], [1, "1"]], label: "depth / r" },
    y: { domain: [0, 3], ticks: [[0, "0"], [1, "1"], [2, "2"], [3, "3"]], label: "force / m g" },
    lines: [{ model: "penalty", xs: [0, end], ys: [0, weights(end)] }],
    rules: [{ y: 1, text: "weight", class: "dashed" }],
    points: [{ model: "penalty", x: Math.max(0, depth), y: Math.min(3, weights(depth)), size: 7 }],
  });
  const text = `${number(depth)} r deep, push ${number(weights(depth))} m g`;
  const settled = Math.abs(depth - rest) < 1e-3 * rest;
  return {
    svg: scenery(view, depth, left) + shift(at, 0, chart.markup),
    words: `${text}. ${settled ? "It rests" : "At rest it would be"} m g / k = ${number(rest)} r deep.`,
    handles: [
      { name: "ball", x: left / 2, y: floorOf(view) - PX + depth * PX, r: PX, label: "the ball: press it in or lift it", value: depth, text },
      { name: "ramp", x: at + chart.sx(end), y: chart.sy(weights(end)), r: 12, label: "the stiffness k", value: k, text: `${number(k)} N/m` },
    ],
    scale: chart,
  };
}

const stiffnessFor = (k) => ({ stiffness: within(100, tidy(k), 1e6) });
const time = clock(0.25, () => SECONDS, ["Let go", "Stop"]);

export const figure = {
  title: "A ball on a spring",
  caption: "The ball rests where the spring pushes with its weight, m g / k deep: press the ball, or turn the ramp.",
  height: 290,
  knobs: ["stiffness"],
  uses: ["damping"],
  start: () => ({ press: null, time: null }),
  draw,
  drag(view, name, x, y) {
    view.stop();
    const { right, at } = split(view.width);
    if (name === "ball") Object.assign(view.own, { time: null, press: tidy(within(-1, (y - floorOf(view)) / PX + 1, DEEPEST)) });
    else view.set(stiffnessFor(rampAt(x - at, y, right, view.height)));
  },
  nudge(view, name, dx, dy) {
    view.stop();
    if (name === "ramp") view.set(stiffnessFor(view.get("stiffness") * 1.1 ** (-dy - dx)));
    else Object.assign(view.own, { time: null, press: tidy(within(-1, depthOf(view) + dy * Math.max(0.1 * restOf(view), 0.001), DEEPEST)) });
  },
  release: (view, name) => name === "ball" && time.start(view),
  tick: time.tick,
  buttons: [time.button],
};

// The stiffness whose ramp goes through (x, y) of the chart.
function rampAt(x, y, width, height) {
  const [left, bottom] = [30, height - 42];
  const depth = (Math.max(1e-3, x - left) / (width - 10 - left)) * DEEPEST;
  const force = (Math.max(8, bottom - y) / (bottom - 26)) * 3;
  return (force * G) / (depth * R);
}
