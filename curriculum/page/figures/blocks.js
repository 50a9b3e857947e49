/* Colliding blocks count the digits of pi (Galperin 2003): a wall, a block of mass 1, and one of mass 100^n. */
import { el, number, table } from "../draw.js";
import { runExact, runModel } from "../engine.js";
import { knobsOf } from "../store.js";
import { clipped, clock, handle, kept, label, line, plural, R, scene, whole, within } from "../parts.js";

const SECONDS = 4;
const MOST = 3; // n: 100^3 and 3,141 impacts
const ROWS = 1500; // of exact, to be looked at
const LIGHT = 30; // px, and a heavier block is larger
const side = (n) => LIGHT + 16 * n;
const lineUp = (n) => ({ x: [0, 0.6, 1.15], vx: [0, 0, -1], mass: [Infinity, 1, 100 ** n], restitution: 1 });

// The gaps of a run's row [m]: from wall to light block, from light to heavy one.
const gapsOf = (run, row) => [1, 2].map((i) => run.x[3 * row + i] - run.x[3 * row + i - 1] - 2 * R);

// Without a weight, so that all impacts lie in one line.
const byExact = kept((n) => {
  const run = runExact(scene([5, 5, 5], lineUp(n)), { dt: SECONDS / ROWS }, ROWS, 0);
  return { run, times: run.events.map((each) => each.t) };
});

// lcp has a floor and a weight; an impact is a step that changes the light block's speed along it.
const byLcp = kept((n, knobs) => {
  const steps = Math.ceil(SECONDS / knobs.dt);
  const run = runModel("lcp", scene([R, R, R], lineUp(n)), { ...knobs, restitution: 1 }, steps);
  const times = [];
  for (let row = 1; row <= steps; row++)
    if (Math.abs(run.vx[3 * row + 1] - run.vx[3 * row - 2]) > 1e-9) times.push(row * knobs.dt);
  return { run, times };
});

const lanes = (view) => [
  ["exact", byExact(view.own.n)],
  ["lcp", byLcp(view.own.n, knobsOf(view.values))],
];
const shape = (view) => ({ wall: 22, unit: (view.width - 30) / 2.1, lane: (view.height - 8) / 2 });

function lane(view, [model, { run, times }], k) {
  const { wall, unit, lane: high } = shape(view);
  const floor = (k + 1) * high - 14;
  const time = view.own.time ?? 0;
  const [first, second] = gapsOf(run, Math.min(run.steps, Math.round(time / run.dt)));
  const [x, big] = [wall + first * unit, side(view.own.n)];
  const far = x + LIGHT + second * unit;
  const block = (at, size, mass) =>
    el("rect", { x: at, y: floor - size, width: size, height: size, class: `ball m-${model}` }) +
    label(mass, at + size / 2, floor - size / 2 + 5, "middle", "on-ball");
  const seen = times.filter((each) => each <= time).length;
  const parts = [
    table(0, floor, view.width, 12),
    line(wall, floor - 78, wall, floor, "table-top"),
    el("rect", { x: 0, y: floor - 78, width: wall, height: 78, class: "ground" }),
    block(x, LIGHT, "1"),
    block(far, big, `100${["", "", "²", "³"][view.own.n]}`),
    label(`${model}: ${whole(seen)} of ${plural(times.length, "impact")}`, view.width - 4, floor - high + 32, "end"),
  ];
  return clipped(`blocks-${model}`, 0, floor - high + 14, view.width, high, ...parts);
}

function draw(view) {
  const [exact, lcp] = lanes(view);
  const { wall, unit, lane: high } = shape(view);
  const { n, time: now } = view.own;
  const [, { run, times }] = exact;
  const [first, second] = gapsOf(run, Math.min(ROWS, Math.round(((now ?? 0) / SECONDS) * ROWS)));
  const corner = Math.min(wall + (first + second) * unit + LIGHT + side(n), view.width - 14);
  const counted = `exact counts ${plural(times.length, "impact")}`;
  const missed = `lcp at dt = ${number(1000 * view.get("dt"))} ms counts ${whole(lcp[1].times.length)}`;
  const text = `100 to the power of ${n}`;
  return {
    svg: lane(view, exact, 0) + lane(view, lcp, 1),
    words: `Mass 1 and ${whole(100 ** n)}: ${counted}, ${missed}.`,
    handles: [handle("size", corner, high - 14 - side(n), 12, "the heavy block’s mass", n, text)],
  };
}

const time = clock(0.4, () => SECONDS);
const set = (view, n) => Object.assign(view.own, { n: within(0, Math.round(n), MOST), time: null });

export const figure = {
  title: "Colliding blocks count the digits of π",
  caption:
    "exact counts 3, 31, 314, 3,141 impacts, and lcp loses count where they come faster than its steps: drag the corner of the heavy block to make it heavier.",
  height: 260,
  knobs: ["dt"],
  uses: ["iters", "baumgarte"],
  start: () => ({ n: 2, time: null }),
  draw,
  drag: (view, name, x, y) => set(view, (shape(view).lane - 14 - y - LIGHT) / 16),
  nudge: (view, name, dx, dy) => set(view, view.own.n + Math.sign(dx - dy)),
  ...time.parts,
};
