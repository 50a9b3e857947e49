/* A stack on springs: the lowest contact carries all. Lift a ball and those above it come along;
 * press one and those below it carry that as well. */
import { arrow, ball, clipped, label, number, plural, table } from "../draw.js";
import { runModel } from "../engine.js";
import { forceLength, G, grip, kept, lens, R, scene } from "../parts.js";

const [COUNT, PX, DT, SECONDS] = [3, 34, 0.0005, 1.2];
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

const fall = kept((stiffness, damping, ...hold) => {
  const balls = scene(heightsAtRest(stiffness, ...hold));
  return runModel("penalty", balls, { dt: DT, stiffness, damping }, Math.round(SECONDS / DT)).y;
});

function heightsOf({ own: { from, hand, time }, get }) {
  const k = get("stiffness");
  if (time === null) return heightsAtRest(k, from, hand);
  const row = Math.round(time / DT);
  return Array.from(fall(k, get("damping"), from, hand).subarray(row * COUNT, (row + 1) * COUNT));
}

function draw(view) {
  const k = view.get("stiffness");
  const [floor, x] = [view.height - 40, 0.36 * view.width];
  const heights = heightsOf(view);
  const at = (height) => floor - (height / R) * PX;
  const depths = heights.map((y, i) => (i ? 2 - (y - heights[i - 1]) / R : 1 - y / R));
  const forces = depths.map((depth) => Math.max(0, (k * depth * R) / G));
  const pushes = forces.map((force, i) => {
    const y = at(i ? heights[i - 1] + R : 0);
    const name = force > 0 ? label(`${number(force, 2)} m g`, x + PX + 24, y - 4) : "";
    return arrow("push m-penalty", x + PX + 14, y, 0, -Math.min(60, forceLength(force, 20))) + name;
  });
  const { from, hand, time } = view.own;
  const pressed = time === null ? forceLength(-hand, 20) : 0;
  const aside = [Math.min(view.width - 50, x + 230), view.width < 480 ? 60 : floor - 90];
  const svg = clipped(0, 0, view.width, view.height,
    table(0, floor, view.width, 40),
    ...heights.map((height) => ball("penalty", x, at(height), PX)),
    ...pushes,
    arrow("weight", x, at(heights[from] + R) - pressed, 0, pressed),
    lens("stack-lens", "penalty", ...aside, PX, depths[0], 44),
  );
  const open = depths.findIndex((depth) => depth < 0);
  const carried = plural(open < 0 ? COUNT : open, "ball");
  const bottom = depths[0] < 0 ? "open" : `${number(depths[0])} r deep`;
  const lowest = `the lowest contact is ${bottom}`;
  const more = pressed ? `, and a hand that presses with ${number(-hand, 2)} m g` : "";
  const text = `${lowest}, ${number(forces[0], 2)} m g`;
  const resting = heightsAtRest(k, COUNT, 0);
  const hold = (height, i) => {
    const low = at(resting[i]);
    const range = {
      r: PX,
      low: -HARDEST,
      high: ABOVE,
      step: 0.1,
      at: (toX, y) => ((low - y) / PX) * (y > low ? PRESS : 1),
      get: () => (i === view.own.from ? view.own.hand : 0),
      set: (to) => Object.assign(view.own, { from: i, hand: Number(to.toFixed(3)), time: null }),
      release: () => view.own.hand && view.play(),
    };
    const name = `ball ${i + 1} from below: lift it or press it`;
    return grip(view, `ball-${i}`, x, Math.min(at(height), view.height - 20), name, text, range);
  };
  return {
    svg,
    words: `It carries ${carried}${more}: ${lowest}, m g / k is ${number(G / k / R)} r.`,
    handles: heights.map(hold),
  };
}

export const figure = {
  title: "A stack on springs",
  caption:
    "The lowest contact carries every ball above it: lift one off, and the rest come up; press " +
    "one down, and all below it feel it.",
  height: 330,
  knobs: ["stiffness"],
  start: () => ({ from: COUNT - 1, hand: 0, time: null }),
  clock: () => ({ end: SECONDS, rate: 0.25, name: "Let go" }),
  draw,
};
