/* The sweep as a walk: the impulses of two contacts are a plane, the cost a bowl over it, and each
 * visit to a contact goes to the lowest point along its own axis, but not below zero. With momentum
 * a walk down a long valley takes fewer sweeps. */
import { arrow, axis, ball, circle, clipped, label, number, path, plural, rect } from "../draw.js";
import { steps, table } from "../draw.js";
import { makeRows, solveWithMomentum } from "../engine.js";
import { beside, grip, kept, pair, visits } from "../kit.js";

const [PX, UNIT, GROUND] = [36, 22, 40]; // px: a radius, an arrow for g dt, the table
const SWEEPS = 100;
const [SLOW, FAST] = [-2, 3]; // g dt, of a ball before the sweeps
const LEVELS = [0.02, 0.1, 0.3, 0.7, 1.4, 2.5, 4]; // of the contours, as shares of the picture

// The balls' speeds once the impulses `begin` have acted.
const pushed = ([v1, v2], [table, upper], heavy) => [v1 + table - upper, v2 + upper / heavy];

/* From the impulses `begin` of table and lower ball, and of the two balls, [m g dt]: those after
 * every visit. Speeds in g dt; the upper ball is `heavy` times as heavy. */
const walk = kept((speeds, begin, heavy) =>
  visits([1, heavy], begin, pushed(speeds, begin, heavy), 2 * SWEEPS).map(({ lam }) => lam));

// Those after every sweep with momentum.
const roll = kept((speeds, begin, heavy) =>
  Array.from({ length: SWEEPS + 1 }, (_, iters) => {
    const contacts = [0, 1].map((i) => ({ i, j: i - 1, nx: 0, ny: 1 }));
    const rows = makeRows(contacts, [1, heavy]).map((row, k) => ({ ...row, lam: begin[k] }));
    const vy = pushed(speeds, begin, heavy);
    solveWithMomentum(rows, [0, 0], vy, { iters });
    return rows.map(({ lam }) => lam);
  }),
);

// The contour of the bowl so high above its lowest point, where both balls are stopped.
const contourOf = ([v1, v2], heavy) => (height) =>
  Array.from({ length: 73 }, (_, k) => {
    const [size, angle] = [Math.sqrt(2 * height), (k * Math.PI) / 36];
    const second = size * Math.sqrt(heavy) * Math.sin(angle);
    return [size * Math.cos(angle) + second - v1 - heavy * v2, second - heavy * v2];
  });

function chartOf({ seen, rolled, contour, most, end }) {
  const ticks = steps(0, most, 3);
  const under = ({ sx, sy, box: { left, top, right, bottom } }) => {
    const drawn = (points, kind) => path(points.map(([x, y]) => [sx(x), sy(y)]), kind);
    const [width, height] = [right - left, bottom - top];
    return [
      rect(left, top, sx(0) - left, height, "region"),
      rect(sx(0), sy(0), right - sx(0), bottom - sy(0), "region"),
      clipped(left, top, width, height, ...LEVELS.map((c) => drawn(contour(c * most), "contour"))),
      drawn(seen, "line m-lcp plainly"),
      ...seen.slice(1, 9).map(([x, y]) => circle(sx(x), sy(y), 4, "look m-lcp")),
      rolled.length ? drawn(rolled, "line m-leapfrog plainly") : "",
      ...rolled.slice(1, 9).map(([x, y]) => circle(sx(x), sy(y), 4, "look m-leapfrog")),
    ].join("");
  };
  return {
    x: axis([-0.1 * most, 1.25 * most], "table’s push / m g dt", ...ticks),
    y: axis([-0.1 * most, most], "upper push / m g dt", ...ticks),
    points: [{ model: "lcp", x: end[0], y: end[1], size: 7 }],
    under,
  };
}

function draw(view) {
  const { own } = view;
  const { v1, v2, heavy } = own;
  const most = 3.5 * heavy; // m g dt, that are seen
  const begin = [own.begin1, own.begin2].map((each) => Math.min(each, most));
  const seen = walk([v1, v2], begin, heavy);
  const rolled = own.rolls ? roll([v1, v2], begin, heavy) : [];
  const end = seen[2 * SWEEPS];
  const contour = contourOf([v1, v2], heavy);
  const floor = view.height - GROUND;
  const at = [1, 2].map((k) => floor - (2 * k - 1) * PX);
  const picture = (left) => {
    const x = 0.5 * left;
    const speed = (y, k) => arrow("weight", x, y, 0, -UNIT * [v1, v2][k]);
    const balls = at.map((y, k) => ball("lcp", x, y, PX, "ball plainly") + speed(y, k));
    const name = heavy > 1 ? label(`${heavy} kg`, x, at[1] - PX - 8, "middle") : "";
    return table(0, floor, left, GROUND) + balls.join("") + name;
  };
  const chart = chartOf({ seen, rolled, contour, most, end });
  const { svg, sx, sy, middle } = beside(view, chart, picture, 0.3);
  const hold = (y, k) => {
    const range = { r: PX, low: SLOW, high: FAST, step: 0.1, by: (dx, dy) => -dy / UNIT };
    const name = `the ${["lower", "upper"][k]} ball’s speed before the sweeps`;
    return grip(view, `v${k + 1}`, middle, y, name, `${number(own[`v${k + 1}`], 2)} g dt`, range);
  };
  const list = (pair) => pair.map((each) => number(each, 3)).join(" and ");
  const named = ["where the sweeps start", `${list(begin)} m g dt`];
  const from = [sx(begin[0]), sy(begin[1])];
  const ranges = { begin1: [0, most], begin2: [0, most] };
  const to = { at: (x, y) => [sx.back(x), sy.back(y)] };
  const near = ([x, y]) => Math.hypot(x - end[0], y - end[1]) < 1e-3 * Math.hypot(...end, 1);
  const sweeps = plural(Math.ceil(seen.findIndex(near) / 2), "sweep");
  const fewer = own.rolls ? `, with momentum after ${plural(rolled.findIndex(near), "sweep")}` : "";
  return {
    svg,
    words: `From ${list(begin)} m g dt the sweeps come to ${list(end)}, within a thousandth ` +
      `after ${sweeps}${fewer}.`,
    handles: [...at.map(hold), pair(view, "start", from, ...named, ranges, to)],
    lit: ["sweep"],
  };
}

const start = () => ({ v1: -1, v2: -1, heavy: 1, begin1: 0, begin2: 2.5, rolls: false });
const form = {
  height: 330,
  buttons: [
    [
      ({ own }) => `The upper ball ${own.heavy > 1 ? "as" : "ten times as"} heavy`,
      ({ own }) => (own.heavy = own.heavy > 1 ? 1 : 10),
    ],
    [
      ({ own }) => (own.rolls ? "Without momentum" : "With momentum"),
      ({ own }) => (own.rolls = !own.rolls),
    ],
  ],
  draw,
};

export const figures = {
  bowl: {
    title: "The sweep walks down a bowl",
    caption:
      "Each visit goes to the lowest point along one axis and stops at the wall: drag where the " +
      "sweeps start, and the balls’ speeds, until one contact need not push.",
    start,
    ...form,
  },
  momentum: {
    title: "Sweeps with momentum in a long valley",
    caption:
      "To the right one contact’s push, upwards the other’s: plain sweeps take short steps along " +
      "the valley, those with momentum longer ones; drag where they start.",
    start: () => ({ ...start(), heavy: 10, begin2: 30, rolls: true }),
    ...form,
  },
};
