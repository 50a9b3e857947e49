/* A stack on springs: the lowest contact carries all. Lift a ball and those above it come along. */
import { arrow, ball, number, table } from "../draw.js";
import { runModel } from "../engine.js";
import { clipped, clock, enlarged, forceLength, G, handle, kept, label, lens, plural, R, scene, tidy, within } from "../parts.js";

const [COUNT, PX, DT, SECONDS] = [3, 34, 0.0005, 1.2];
const ABOVE = 1.6; // r: how high a ball can be lifted
const floorOf = (view) => view.height - 40;

// Heights [m] of balls at rest on springs of stiffness k, from `from` up lifted by `lift` [r].
function restingHeights(k, from, lift) {
  const heights = [];
  let surface = 0;
  const free = lift > 0 ? from : COUNT;
  for (let i = 0; i < COUNT; i++) {
    const carried = i < free ? free - i : COUNT - i;
    const sunk = i === from && lift > 0 ? -lift * R : (carried * G) / k;
    heights.push(surface + R - sunk);
    surface = heights[i] + R;
  }
  return heights;
}

const fall = kept((stiffness, damping, from, lift) => {
  const balls = scene(restingHeights(stiffness, from, lift));
  return runModel("penalty", balls, { dt: DT, stiffness, damping }, Math.round(SECONDS / DT));
});

function heightsOf(view) {
  const { from, lift, time } = view.own;
  const k = view.get("stiffness");
  if (time === null) return restingHeights(k, from, lift);
  const run = fall(k, view.get("damping"), from, lift);
  const row = Math.round(time / DT);
  return Array.from(run.y.subarray(row * COUNT, (row + 1) * COUNT));
}

function draw(view) {
  const [floor, x, k] = [floorOf(view), 0.36 * view.width, view.get("stiffness")];
  const heights = heightsOf(view);
  const at = (height) => floor - (height / R) * PX;
  const depths = heights.map((height, i) => (i ? 2 - (height - heights[i - 1]) / R : 1 - height / R));
  const forces = depths.map((depth) => Math.max(0, (k * depth * R) / G));
  const pushes = forces.map((force, i) => {
    const y = at(i ? heights[i - 1] + R : 0);
    const name = force > 0 ? label(`${number(force, 2)} m g`, x + PX + 24, y - 4) : "";
    return arrow("push m-penalty", x + PX + 14, y, 0, -Math.min(60, forceLength(force, 20))) + name;
  });
  const balls = heights.map((height) => ball("penalty", x, at(height), PX));
  const look = { depth: depths[0], r: PX, times: enlarged(depths[0], PX), size: 44 };
  const seen = look.times > 2 && look.depth > 0; // a deeper one is seen without a lens
  const beside = [Math.min(view.width - 50, x + 230), view.width < 480 ? 60 : floor - 90];
  const near = seen ? lens("stack-lens", "penalty", ...beside, look) : "";
  const open = depths.findIndex((depth) => depth < 0);
  const carried = plural(open < 0 ? COUNT : open, "ball");
  const bottom = `the lowest contact ${depths[0] < 0 ? "is open" : `is ${number(depths[0])} r deep`}`;
  const { from, lift: lifted } = view.own;
  return {
    svg: clipped("stack-scene", 0, 0, view.width, view.height, table(0, floor, view.width, 40), ...balls, ...pushes, near),
    words: `It carries ${carried}: ${bottom}, m g / k is ${number(G / k / R)} r.`,
    handles: heights.map((height, i) =>
      handle(String(i), x, Math.min(at(height), view.height - 20), PX, `ball ${i + 1} from below: lift it`, i === from ? lifted : 0, `${bottom}, ${number(forces[0], 2)} m g`),
    ),
  };
}

function lift(view, from, by) {
  Object.assign(view.own, { from, lift: tidy(within(0, by, ABOVE)), time: null });
}
const time = clock(0.25, () => SECONDS, ["Let go", "Stop"]);

export const figure = {
  title: "A stack on springs",
  caption: "The lowest contact carries every ball above it: lift one off, and the rest come up.",
  height: 330,
  knobs: ["stiffness"],
  uses: ["damping"],
  start: () => ({ from: COUNT - 1, lift: 0, time: null }),
  draw,
  drag(view, name, x, y) {
    const from = Number(name);
    const resting = restingHeights(view.get("stiffness"), COUNT, 0)[from];
    lift(view, from, (floorOf(view) - y) / PX - resting / R);
  },
  nudge(view, name, dx, dy) {
    const held = Number(name) === view.own.from ? view.own.lift : 0;
    lift(view, Number(name), held - 0.1 * dy);
  },
  release: (view) => view.own.lift > 0 && time.start(view),
  ...time.parts,
};
