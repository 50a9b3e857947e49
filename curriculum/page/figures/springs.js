/* Balls on springs. One rests where the spring pushes with its weight, m g / k deep; in a stack the
 * lowest contact carries all. What the hand holds falls when it is let go. */
import { arrow, axis, ball, clipped, el, label, number, path, plural, table } from "../draw.js";
import { within } from "../draw.js";
import { runModel, stateAt } from "../engine.js";
import { beside, depthsOf, forceLength, G, grip, kept, lens, R, scene } from "../kit.js";

const [DT, SECONDS] = [0.0005, 1.2];
const springs = {
  knobs: ["stiffness"],
  clock: () => ({ end: SECONDS, rate: 0.25, name: "Let go" }),
};

const fall = kept((heights, stiffness, damping) =>
  runModel("penalty", scene(heights), { dt: DT, stiffness, damping }, Math.round(SECONDS / DT)),
);

// The heights [m] of balls that are held at some, or have fallen from there since.
function fallen({ own: { time }, get }, heights) {
  if (time === null) return heights;
  return stateAt(fall(heights, get("stiffness"), get("damping")), Math.round(time / DT)).y;
}

// ---- the sponge: press the ball into it

const [LARGE, GROUND] = [54, 104]; // px: a radius, the table
const [DEEPEST, HIGHEST] = [1.1, 1.2]; // r
const MOST = 2.7; // weights, at the end of the ramp

const depthOf = (view, rest) => 1 - fallen(view, [(1 - (view.own.press ?? rest)) * R])[0] / R;

// A coil from (x, top) down to (x, bottom), the thicker the stiffer.
function coil(x, top, bottom, stiffness) {
  const turn = (_, k) => [x + (k % 2 ? -16 : 16), top + ((k + 0.5) * (bottom - top)) / 12];
  const wire = path([[x, top], ...Array.from({ length: 12 }, turn), [x, bottom]], "coil");
  return el("g", { "stroke-width": Math.log10(stiffness) - 0.5 }, wire);
}

function picture(left, height, stiffness, depth, push) {
  const [x, floor, aside] = [left / 2, height - GROUND, Math.min(LARGE + 12, left / 2 - 10)];
  const y = floor + (depth - 1) * LARGE;
  const under = Math.max(y + LARGE, floor);
  return [
    table(0, floor, left, GROUND),
    coil(x, under, height - 4, stiffness),
    ball("penalty", x, y, LARGE),
    arrow("weight", x - aside, y, 0, forceLength(1)),
    arrow("push m-penalty", x + aside, under, 0, -Math.min(150, forceLength(push))),
    lens("penalty", left - 34, 36, LARGE, depth, 30),
  ].join("");
}

function drawSponge(view) {
  const k = view.get("stiffness");
  const rest = G / k / R; // r
  const deepest = Math.min(DEEPEST, Math.sqrt(2 * HIGHEST * rest)); // from there it stays in sight
  view.own.press &&= Math.min(view.own.press, deepest);
  const depth = depthOf(view, rest);
  const push = Math.max(0, depth / rest); // weights
  const [floor, end] = [view.height - GROUND, Math.min(DEEPEST, MOST * rest)];
  const y = floor + (depth - 1) * LARGE;
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
    r: LARGE, low: -1, high: deepest, step: -Math.max(0.1 * rest, 0.001),
    at: (x, to) => (to - floor) / LARGE + 1,
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
    lit: depth > 0 ? ["spring"] : [],
  };
}

const sponge = {
  title: "A ball on a spring",
  caption:
    "The ball rests where the spring pushes with its weight, m g / k deep: press the ball, or " +
    "turn the ramp.",
  height: 350,
  start: () => ({ press: null, time: null }),
  draw: drawSponge,
  ...springs,
};

// ---- the stack: lift a ball and those above it come along; press one and those below carry it

const [COUNT, PX] = [3, 34];
const ABOVE = 1.6; // r: how high a ball can be lifted
const [HARDEST, PRESS] = [9, 6]; // weights; weights for a radius that the hand goes down

/* Heights [m] of balls at rest on springs of stiffness k. The hand holds ball `from`: it lifts it
 * by so many radii, and those above come along, or it presses it down with so many weights. */
function heightsAtRest(k, from, hand) {
  const heights = [];
  let surface = 0;
  for (let i = 0; i < COUNT; i++) {
    const lifted = hand > 0 && i === from;
    const above = hand > 0 && i < from ? from - i : COUNT - i;
    const pressed = hand < 0 && i <= from ? -hand : 0;
    heights.push(surface + R + (lifted ? hand * R : (-(above + pressed) * G) / k));
    surface = heights[i] + R;
  }
  return heights;
}

// Every ball as a handle: lifted, or pressed down with some weights.
function holds(view, heights, { at, seen }, x, k) {
  const resting = heightsAtRest(k, COUNT, 0);
  return heights.map((height, i) => {
    const low = at(resting[i]);
    const range = {
      r: PX,
      low: -HARDEST,
      high: ABOVE,
      step: 0.1,
      at: (toX, y) => ((low - y) / PX) * (y > low ? PRESS : 1),
      get: () => (i === view.own.from ? view.own.hand : 0),
      set: (to) => Object.assign(view.own, { from: i, hand: to, time: null }),
      release: () => view.own.hand && view.play(),
    };
    const name = `ball ${i + 1} from below: lift it or press it`;
    const by = range.get();
    const text = by < 0 ? `pressed with ${number(-by, 2)} m g` : `lifted by ${number(by, 2)} r`;
    return grip(view, `ball-${i}`, x, seen(at(height)), name, text, range);
  });
}

function drawStack(view) {
  const k = view.get("stiffness");
  const [floor, x] = [view.height - 40, 0.36 * view.width];
  const { from, hand, time } = view.own;
  const heights = fallen(view, heightsAtRest(k, from, hand));
  const at = (height) => floor - (height / R) * PX;
  const seen = (y) => within(12, y, view.height - 12); // none is lost on the softest spring
  const depths = depthsOf(heights);
  const forces = depths.map((depth) => Math.max(0, (k * depth * R) / G));
  const pushes = forces.map((force, i) => {
    const y = at(i ? heights[i - 1] + R : 0);
    const name = force > 0 ? label(`${number(force, 2)} m g`, x + PX + 24, y - 8) : "";
    return arrow("push m-penalty", x + PX + 14, y, 0, -Math.min(60, forceLength(force, 20))) + name;
  });
  const pressed = time === null ? forceLength(-hand, 20) : 0;
  const aside = [Math.min(view.width - 50, x + 230), view.width < 480 ? 60 : floor - 90];
  const svg = clipped(0, 0, view.width, view.height,
    table(0, floor, view.width, 40),
    ...heights.map((height) => ball("penalty", x, seen(at(height)), PX)),
    ...pushes,
    arrow("weight", x, at(heights[from] + R) - pressed, 0, pressed),
    lens("penalty", ...aside, PX, depths[0], 44),
  );
  const open = depths.findIndex((depth) => depth < 0);
  const carried = plural(open < 0 ? COUNT : open, "ball");
  const bottom = depths[0] < 0 ? "open" : `${number(depths[0])} r deep`;
  const more = pressed ? `, and a hand that presses with ${number(-hand, 2)} m g` : "";
  const one = number(G / k / R); // r, of a ball alone
  return {
    svg,
    words: `The lowest contact carries ${carried}${more}, ${bottom}; m g / k is ${one} r.`,
    handles: holds(view, heights, { at, seen }, x, k),
  };
}

const stack = {
  title: "A stack on springs",
  caption:
    "The lowest contact carries every ball above it: lift one off, and the rest come up; press " +
    "one down, and all below it feel it.",
  height: 330,
  start: () => ({ from: COUNT - 1, hand: 0, time: null }),
  draw: drawStack,
  ...springs,
};

export const figures = { sponge, stack };
