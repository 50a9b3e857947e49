/* The sweep as a walk: the impulses of two contacts are a plane, the cost a bowl over it, and each
 * visit to a contact goes to the lowest point along its own axis, but not below zero. With momentum
 * a walk down a long valley takes fewer sweeps. Values: where both end [m g dt], and their sweeps. */
import { arrow, axis, ball, circle, clipped, label, mark, number, path, plot, rect,
  steps } from "../draw.js";
import { table } from "../draw.js";
import { solve_with_momentum } from "../contact.js";
import { kept, stacked, visits } from "../runs.js";

const [SWEEPS, UNIT, GROUND] = [100, 22, 40]; // px: an arrow for g dt, the table
const LEVELS = [0.02, 0.1, 0.3, 0.7, 1.4, 2.5, 4]; // of the contours, as shares of the picture

// From the impulses `begin` of table and lower ball, and of the two balls [m g dt]: those after
// every sweep, and with momentum. The upper ball is `heavy` times as heavy.
const walks = kept((v1, v2, begin, heavy) => {
  const all = visits([1, heavy], begin, [v1 + begin[0] - begin[1], v2 + begin[1] / heavy],
    2 * SWEEPS);
  const rolled = Array.from({ length: SWEEPS + 1 }, (_, count) => {
    const contacts = stacked([1, heavy], begin, [v1 + begin[0] - begin[1], v2 + begin[1] / heavy]);
    solve_with_momentum(contacts, count);
    return contacts.map(({ lam }) => lam);
  });
  return { walked: all.map(({ lam }) => lam), rolled };
});

// The contour of the bowl so high above its lowest point, where both balls are stopped.
const contourOf = (v1, v2, heavy) => (height) =>
  Array.from({ length: 73 }, (_, k) => {
    const [size, angle] = [Math.sqrt(2 * height), (k * Math.PI) / 36];
    const second = size * Math.sqrt(heavy) * Math.sin(angle);
    return [size * Math.cos(angle) + second - v1 - heavy * v2, second - heavy * v2];
  });

function draw(view) {
  const { own, width, height } = view;
  const { v1, v2, heavy } = own;
  const most = 3.5 * heavy; // m g dt, that are seen
  const begin = [own.begin1, own.begin2].map((share) => share * most);
  const { walked, rolled } = walks(v1, v2, begin, heavy);
  const end = walked[2 * SWEEPS];
  const near = ([x, y]) => Math.hypot(x - end[0], y - end[1]) < 1e-3 * Math.hypot(...end, 1);
  const sweeps = [Math.ceil(walked.findIndex(near) / 2), rolled.findIndex(near)];
  const [left, floor] = [Math.round(0.28 * width), height - GROUND];
  const chart = plot([left, 0, width - left, height], {
    x: axis([-0.1 * most, 1.25 * most], "table’s push / m g dt", ...steps(0, most, 3)),
    y: axis([-0.1 * most, 1.05 * most], "upper push / m g dt", ...steps(0, most, 3)),
    under: ({ sx, sy, box: { left, top, right, bottom } }) => {
      const drawn = (points, kind) => path(points.map(([x, y]) => [sx(x), sy(y)]), kind);
      const dots = (points, model) => points.slice(1, 9).map(([x, y]) =>
        circle(sx(x), sy(y), 4, `look m-${model}`));
      const bowl = LEVELS.map((level) => drawn(contourOf(v1, v2, heavy)(level * most), "contour"));
      return [
        rect(left, top, sx(0) - left, bottom - top, "region"), rect(sx(0), sy(0), right - sx(0),
          bottom - sy(0), "region"),
        clipped(left, top, right - left, bottom - top, bowl), drawn(walked,
          "line m-lcp plainly"), dots(walked, "lcp"),
        drawn(rolled, "line m-leapfrog plainly"), dots(rolled, "leapfrog"), mark("lcp", sx(end[0]),
          sy(end[1]), 7),
      ];
    },
  });
  const { sx, sy } = chart;
  const r = Math.min(36, 0.3 * left);
  const hold = (k) => {
    const [y, v] = [floor - (2 * k + 1) * r, [v1, v2][k]];
    const what = {
      label: `the ${["lower", "upper"][k]} ball’s speed before the sweeps`, text: `${number(v, 2)} g dt`,
      value: `v${k + 1}`, low: -2, high: 3, step: 0.1, at: (_, to) => -to / UNIT,
    };
    return [view.grab(what, ball("lcp", left / 2, y, r, "ball plainly")),
      arrow("weight", left / 2, y, 0, -UNIT * v)];
  };
  const list = (pair) => pair.map((each) => number(each)).join(" and ");
  const from = {
    label: "where the sweeps start", text: `${list(begin)} m g dt`, value: ["begin1",
      "begin2"], low: 0, high: 1,
    step: 0.02, at: (x, y) => [sx.back(x) / most, sy.back(y) / most],
  };
  return {
    picture: [
      table(0, floor, left, GROUND), hold(0), hold(1),
      heavy > 1 ? label(`${heavy} kg`, left / 2, floor - 4 * r - 8, "middle") : "", chart.picture,
      view.point(sx(begin[0]), sy(begin[1]), { ...from, low: [0, 0], high: [1, 1] }),
    ],
    words: `From ${list(begin)} m g dt the sweeps come to ${list(end)}, within a thousandth after ${sweeps[0]}; with momentum after ${sweeps[1]}.`,
    values: { end, rolled: rolled[SWEEPS], sweeps },
  };
}

export const figure = {
  title: "The sweep walks down a bowl",
  caption: "Round dots: after each visit of a plain sweep. With momentum (yellow) the walk goes on a little after each sweep.",
  height: (width) => (width < 480 ? 300 : 340),
  start: () => ({ v1: -1, v2: -1, heavy: 10, begin1: 0.02, begin2: 0.86 }),
  buttons: ({ own }) => [["The upper ball ten times as heavy",
    () => (own.heavy = own.heavy > 1 ? 1 : 10), String(own.heavy > 1)]],
  draw,
};
