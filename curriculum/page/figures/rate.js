/* How many sweeps a resting tower takes to a millionth: with its height, and with its uppermost ball's mass. */
import { ball, table } from "../draw.js";
import { makeRows, normalSpeed, solveContacts } from "../engine.js";
import { axis, beside, handle, kept, label, scene, whole, within } from "../parts.js";

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

// The tower's top, and the heavy ball on a light one: [x, y, radius].
function places({ own, height }, left) {
  const floor = height - 24;
  const r = Math.min(18, (floor - 30) / (2 * own.count));
  const big = 15 * (1 + 0.25 * Math.log10(own.ratio));
  return { floor, top: [Math.min(46, 0.21 * left), floor - (2 * own.count - 1) * r, r], heavy: [left - 40, floor - 30 - big, big] };
}

function picture(view, left) {
  const { floor, top, heavy } = places(view, left);
  const [x, y, r] = top;
  const kind = r < 8 ? "ball plainly" : "ball";
  const balls = Array.from({ length: view.own.count }, (_, i) => ball("lcp", x, floor - (2 * i + 1) * r, r, kind));
  return [
    table(0, floor, left, 24),
    ...balls,
    ball("lcp", heavy[0], floor - 15, 15),
    ball("lcp", ...heavy),
    label(whole(view.own.count), x, y - r - 6, "middle"),
    label(`1 : ${whole(view.own.ratio)}`, heavy[0], heavy[1] - heavy[2] - 6, "middle"),
  ].join("");
}

function draw(view) {
  const { heights, ratios } = measured();
  const { count, ratio } = view.own;
  const [tall, heavy] = [sweepsOf(count, 1), sweepsOf(2, ratio)];
  const chart = {
    x: { ...axis([1, 1000], "balls, or mass ratio", 1, 10, 100), log: true },
    y: { ...axis([10, 20000], "sweeps", 10, 100, 1000, [10000, "10⁴"]), log: true },
    lines: [
      { model: "lcp", xs: HEIGHTS, ys: heights, markers: [0, 1, 2, 3, 4] },
      { model: "lcp", xs: RATIOS, ys: ratios, class: "dotted", markers: [0, 1, 2, 3] },
    ],
    points: [[count, tall], [ratio, heavy]].map(([x, y]) => ({ model: "lcp", x, y, size: 8 })),
    under: ({ sx, sy }) => label("height", sx(13), sy(1400), "end") + label("mass ratio", sx(950), sy(14), "end"),
  };
  const { svg, middle } = beside(view, "rate", chart, (left) => picture(view, left), 0.36);
  const at = places(view, 2 * middle);
  const list = (values) => values.map(whole).join(", ");
  const [first, second] = [`${count} balls, ${whole(tall)} sweeps`, `1 to ${whole(ratio)}, ${whole(heavy)} sweeps`];
  return {
    svg,
    words: `Tower of ${first}; two balls, ${second}. Measured here: ${list(heights)} for ${list(HEIGHTS)} balls and ${list(ratios)} for ratios of ${list(RATIOS)}.`,
    handles: [
      handle("count", ...at.top.slice(0, 2), 14, "the tower’s uppermost ball: make it higher", count, first),
      handle("ratio", ...at.heavy, "the heavy ball: make it heavier", ratio, second),
    ],
  };
}

const setCount = (view, count) => (view.own.count = within(2, Math.round(count), 40));
const setRatio = (view, ratio) => (view.own.ratio = Math.round(within(1, ratio, 1000)));

export const figure = {
  title: "Sweeps to a millionth",
  caption:
    "Four times the sweeps for twice the height, ten times the sweeps for ten times the mass on top: drag the tower’s top, or the heavy ball.",
  height: 300,
  start: () => ({ count: 5, ratio: 10 }),
  draw,
  drag(view, name, x, y) {
    const floor = view.height - 24;
    if (name === "count") setCount(view, 2 * 20 ** within(0, (floor - 50 - y) / (floor - 90), 1));
    else setRatio(view, 10 ** (3 * within(0, (floor - 45 - y) / 120, 1)));
  },
  nudge(view, name, dx, dy) {
    if (name === "count") setCount(view, view.own.count + dx - dy);
    else setRatio(view, view.own.ratio * 1.26 ** (dx - dy) + 0.5 * Math.sign(dx - dy));
  },
};
