/* How many sweeps a resting tower takes to a millionth: with its height, and with its uppermost ball's mass. */
import { ball, number, plot, table } from "../draw.js";
import { makeRows, normalSpeed, solveContacts } from "../engine.js";
import { kept, label, scene, shift, split, whole, within } from "../parts.js";

const CLOSE = 1e-6; // of the speed that gravity gives in a step
const HEIGHTS = [2, 5, 10, 20, 40];
const RATIOS = [1, 10, 100, 1000];
const MOST = 50000;

// Sweeps until no contact of a resting tower closes or opens faster than CLOSE; speeds in g dt.
export const sweepsOf = kept((count, ratio) => {
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

function tower(view, left) {
  const { count } = view.own;
  const floor = view.height - 24;
  const r = Math.min(18, (floor - 30) / (2 * count));
  const x = Math.min(46, left / 3);
  const balls = Array.from({ length: count }, (_, i) => ball("lcp", x, floor - (2 * i + 1) * r, r, r < 8 ? "ball plainly" : "ball"));
  const big = 15 * (1 + 0.25 * Math.log10(view.own.ratio));
  const second = left - 44;
  const pair = [ball("lcp", second, floor - 15, 15), ball("lcp", second, floor - 30 - big, big)];
  const names = [label(whole(count), x + r + 8, floor - 6), label(`1 : ${whole(view.own.ratio)}`, second, floor - 42 - 2 * big, "middle")];
  return { svg: table(0, floor, left, 24) + balls.join("") + pair.join("") + names.join(""), top: [x, floor - (2 * count - 1) * r], heavy: [second, floor - 30 - big], big };
}

function draw(view) {
  const { left, right, at } = split(view.width, 0.36);
  const { heights, ratios } = measured();
  const { count, ratio } = view.own;
  const [tall, heavy] = [sweepsOf(count, 1), sweepsOf(2, ratio)];
  const chart = plot({
    id: "rate",
    width: right,
    height: view.height,
    x: { domain: [1, 1000], log: true, ticks: [[1, "1"], [10, "10"], [100, "100"], [1000, "1000"]], label: "balls, or mass ratio" },
    y: { domain: [10, 20000], log: true, ticks: [[10, "10"], [100, "100"], [1000, "1000"], [10000, "10⁴"]], label: "sweeps to a millionth" },
    lines: [
      { model: "lcp", xs: HEIGHTS, ys: heights, markers: [0, 1, 2, 3, 4] },
      { model: "lcp", xs: RATIOS, ys: ratios, class: "dotted", markers: [0, 1, 2, 3] },
    ],
    points: [{ model: "lcp", x: count, y: tall, size: 8 }, { model: "lcp", x: ratio, y: heavy, size: 8 }],
  });
  const picture = tower(view, left);
  const handle = (name, [x, y], r, title, value, text) => ({ name, x, y, r, label: title, value, text });
  return {
    svg: picture.svg + shift(at, 0, chart.markup + label("height", chart.sx(13), chart.sy(1400), "end") + label("mass ratio", chart.sx(150), chart.sy(700))),
    words: `A tower of ${count} equal balls takes ${whole(tall)} sweeps, two balls with the upper ${whole(ratio)} times as heavy ${whole(heavy)}; measured here: ${heights.map(whole).join(", ")} for ${HEIGHTS.join(", ")} balls and ${ratios.map(whole).join(", ")} for ratios of ${RATIOS.map(whole).join(", ")}.`,
    handles: [
      handle("count", picture.top, 14, "the tower’s uppermost ball: make it higher", count, `${count} balls, ${whole(tall)} sweeps`),
      handle("ratio", picture.heavy, picture.big, "the heavy ball: make it heavier", ratio, `1 to ${number(ratio)}, ${whole(heavy)} sweeps`),
    ],
  };
}

const setCount = (view, count) => (view.own.count = within(2, Math.round(count), 40));
const setRatio = (view, ratio) => (view.own.ratio = Math.round(within(1, ratio, 1000)));

export const figure = {
  title: "Sweeps to a millionth",
  caption: "Four times the sweeps for twice the height, ten times the sweeps for ten times the mass on top: drag the tower’s top, or the heavy ball.",
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
