/* How many sweeps a resting tower takes to a millionth: with its height, and with its uppermost ball's mass. */
import { axis, ball, label, table, whole, within } from "../draw.js";
import { makeRows, normalSpeed, solveContacts } from "../engine.js";
import { beside, grip, kept, scene } from "../parts.js";

const CLOSE = 1e-6; // of the speed that gravity gives in a step
const HEIGHTS = [2, 5, 10, 20, 40];
const RATIOS = [1, 10, 100, 1000];
const MOST = 50000;

// Sweeps until no contact of a resting tower closes or opens faster than CLOSE; speeds in g dt.
const sweepsOf = kept((count, ratio) => {
  const mass = Array.from({ length: count }, (_, i) => (i === count - 1 ? ratio : 1));
  const contacts = mass.map((_, i) => ({ i, j: i - 1, nx: 0, ny: 1, depth: 0 }));
  const none = mass.map(() => 0);
  const rows = makeRows(contacts, scene(none, { mass }).mass, none, none);
  const [vx, vy] = [none.slice(), mass.map(() => -1)];
  for (let sweeps = 1; sweeps <= MOST; sweeps++) {
    solveContacts(rows, vx, vy, { iters: 1 });
    if (rows.every((c) => Math.abs(normalSpeed(c, vx, vy)) <= CLOSE)) return sweeps;
  }
  return MOST;
});
const measured = kept(() => ({
  heights: HEIGHTS.map((count) => sweepsOf(count, 1)),
  ratios: RATIOS.map((ratio) => sweepsOf(2, ratio)),
}));

function draw(view) {
  const { heights, ratios } = measured();
  const [count, ratio] = [view.own.count, Math.round(view.own.ratio)];
  const [tall, heavy] = [sweepsOf(count, 1), sweepsOf(2, ratio)];
  const floor = view.height - 24;
  const r = Math.min(18, (floor - 30) / (2 * count));
  const big = 15 * (1 + 0.25 * Math.log10(ratio));
  const [top, above] = [floor - (2 * count - 1) * r, floor - 30 - big];
  const middles = (left) => [Math.min(46, 0.21 * left), left - 40]; // of the tower, and of the two
  const picture = (left) => {
    const [tower, pair] = middles(left);
    const kind = r < 8 ? "ball plainly" : "ball";
    return [
      table(0, floor, left, 24),
      ...Array.from({ length: count }, (_, i) => ball("lcp", tower, floor - (2 * i + 1) * r, r, kind)),
      ball("lcp", pair, floor - 15, 15),
      ball("lcp", pair, above, big),
      label(whole(count), tower, top - r - 6, "middle"),
      label(`1 : ${whole(ratio)}`, pair, above - big - 6, "middle"),
    ].join("");
  };
  const points = [[count, tall], [ratio, heavy]];
  const chart = {
    x: { ...axis([1, 1000], "balls, or mass ratio", 1, 10, 100), log: true },
    y: { ...axis([10, 20000], "sweeps", 10, 100, 1000, [10000, "10⁴"]), log: true },
    lines: [
      { model: "lcp", xs: HEIGHTS, ys: heights, markers: [0, 1, 2, 3, 4] },
      { model: "lcp", xs: RATIOS, ys: ratios, kind: "dotted", markers: [0, 1, 2, 3] },
    ],
    points: points.map(([x, y]) => ({ model: "lcp", x, y, size: 8 })),
    under: ({ sx, sy }) =>
      label("height", sx(13), sy(1400), "end") + label("mass ratio", sx(950), sy(14), "end"),
  };
  const { svg, middle } = beside(view, chart, picture, 0.36);
  const [tower, pair] = middles(2 * middle);
  const higher = {
    label: "the tower’s uppermost ball: make it higher",
    text: `${count} balls, ${whole(tall)} sweeps`,
    ...{ low: 2, high: 40, step: 1, set: (wanted) => (view.own.count = Math.round(wanted)) },
    at: (x, y) => 2 * 20 ** within(0, (floor - 50 - y) / (floor - 90), 1),
  };
  const heavier = {
    label: "the heavy ball: make it heavier",
    text: `1 to ${whole(ratio)}, ${whole(heavy)} sweeps`,
    r: big,
    ...{ low: 1, high: 1000, times: 1.26, set: (wanted) => (view.own.ratio = wanted) },
    at: (x, y) => 10 ** (3 * within(0, (floor - 45 - y) / 120, 1)),
  };
  return {
    svg,
    words: `A tower of ${higher.text}; two balls, ${heavier.text}.`,
    handles: [
      grip(view, "count", tower, top, higher),
      grip(view, "ratio", pair, above, heavier),
    ],
  };
}

export const figure = {
  title: "Sweeps to a millionth",
  caption:
    "Four times the sweeps for twice the height, ten times the sweeps for ten times the mass on top: drag " +
    "the tower’s top, or the heavy ball.",
  height: 300,
  start: () => ({ count: 5, ratio: 10 }),
  draw,
};
