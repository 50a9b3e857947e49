/* Colliding blocks count the digits of pi (Galperin 2003): a wall, a block of mass 1, of 100^n. */
import { clipped, label, line, plain, plural, rect, table, whole, within } from "../draw.js";
import { runExact, runModel } from "../engine.js";
import { grip, kept, knobs, R, scene } from "../kit.js";

const SECONDS = 4;
const MOST = 3; // n: 100^3 and 3,141 impacts
const ROWS = 1500; // of exact, to be looked at
const LIGHT = 30; // px, and a heavier block is larger
const lineUp = (n) => ({
  x: [0, 0.6, 1.15],
  vx: [0, 0, -1],
  mass: [Infinity, 1, 100 ** n],
  restitution: 1,
});

// Without a weight, so that all impacts lie in one line.
const byExact = kept((n) => {
  const run = runExact(scene([5, 5, 5], lineUp(n)), { dt: SECONDS / ROWS }, ROWS, 0);
  return { run, times: run.events.map((each) => each.t) };
});

// lcp has a floor and a weight; an impact is a step that changes the light block's speed along it.
const byLcp = kept((n, settings) => {
  const steps = Math.ceil(SECONDS / settings.dt);
  const run = runModel("lcp", scene([R, R, R], lineUp(n)), settings, steps);
  const times = [];
  for (let row = 1; row <= steps; row++)
    if (Math.abs(run.vx[3 * row + 1] - run.vx[3 * row - 2]) > 1e-9) times.push(row * settings.dt);
  return { run, times };
});

function lane(view, model, { run, times }, k) {
  const { n, time } = view.own;
  const [wall, unit, high] = [22, (view.width - 30) / 2.1, (view.height - 8) / 2]; // px
  const [floor, big] = [(k + 1) * high - 14, LIGHT + 16 * n];
  const row = Math.min(run.steps, Math.round((time ?? 0) / run.dt));
  const gap = (i) => unit * (run.x[3 * row + i] - run.x[3 * row + i - 1] - 2 * R);
  const far = within(LIGHT, wall + gap(1) + LIGHT + gap(2), view.width - 14); // none is lost, and
  const near = within(0, wall + gap(1), far - LIGHT); // what went through the wall is seen in it
  const block = (at, size, mass) =>
    rect(at, floor - size, size, size, `ball m-${model}`) +
    label(mass, at + size / 2, floor - size / 2 + 5, "middle", "on-ball");
  const seen = whole(times.filter((each) => each <= (time ?? 0)).length);
  const count = `${model}: ${seen} of ${plural(times.length, "impact")}`;
  const svg = [
    table(0, floor, view.width, 12),
    line(wall, floor - 78, wall, floor, "table-top"),
    rect(0, floor - 78, wall, 78, "ground"),
    block(near, LIGHT, "1"),
    block(far, big, ["1", "100", "100²", "100³"][n]),
    label(count, view.width - 4, floor - high + 32, "end"),
  ].join("");
  const middle = [Math.min(far + big / 2, view.width - 14), floor - big / 2];
  return { svg: clipped(0, floor - high + 14, view.width, high, svg), middle, r: big / 2 };
}

function draw(view) {
  const { n } = view.own;
  const settings = { ...knobs(view), dt: view.get("dt"), restitution: 1 };
  const [exact, lcp] = [byExact(n), byLcp(n, settings)];
  const above = lane(view, "exact", exact, 0);
  const counted = `exact counts ${plural(exact.times.length, "impact")}`;
  const missed = `lcp at dt = ${plain(1000 * settings.dt)} ms counts ${whole(lcp.times.length)}`;
  const text = `100 to the power of ${n}`;
  const range = { r: above.r, low: 0, high: MOST, step: 1, by: (dx, dy) => Math.round(-dy / 16) };
  return {
    svg: above.svg + lane(view, "lcp", lcp, 1).svg,
    words: `Mass 1 and ${whole(100 ** n)}: ${counted}, ${missed}.`,
    handles: [grip(view, "n", ...above.middle, "the heavy block’s mass", text, range)],
  };
}

export const figure = {
  title: "Colliding blocks count the digits of π",
  caption:
    "exact counts 3, 31, 314, 3,141 impacts, and lcp loses count where they come faster than its " +
    "steps: drag the heavy block upwards to make it heavier.",
  height: 260,
  knobs: ["dt"],
  start: () => ({ n: MOST, time: null }),
  clock: () => ({ end: SECONDS, rate: 0.4, name: "Play" }),
  draw,
};
