/* The sweep as a walk: the impulses of two contacts are a plane, the cost a bowl over it, and each
 * visit to a contact goes to the lowest point along its own axis, but not below zero. With momentum
 * a walk down a long valley takes fewer sweeps. Values: where both end [m g dt], their sweeps. */
import { area, arrow, axis, ball, circle, clipped, label, mark, number, path } from "../draw.js";
import { plot, steps, table } from "../draw.js";
import { solve_accelerated } from "../contact.js";
import { kept, stacked, visits } from "../runs.js";

const [SWEEPS, UNIT, GROUND] = [100, 22, 40]; // px: an arrow for g dt, the table
const LEVELS = [0.02, 0.1, 0.3, 0.7, 1.4, 2.5, 4]; // of the contours, as shares of the picture

// From the impulses `begin` of table and lower ball, and of the two balls [m g dt]: those after
// every visit, and with momentum after every sweep. The upper ball is `heavy` times as heavy.
const walks = kept((v1, v2, begin, heavy) => {
  const [masses, speeds] = [[1, heavy], [v1 + begin[0] - begin[1], v2 + begin[1] / heavy]];
  const rolled = Array.from({ length: SWEEPS + 1 }, (_, count) => {
    const contacts = stacked(masses, begin, speeds);
    solve_accelerated(contacts, count);
    return contacts.map(({ lam }) => lam);
  });
  return { walked: visits(masses, begin, speeds, 2 * SWEEPS).map(({ lam }) => lam), rolled };
});

// The contour of the bowl so high above its lowest point, where both balls are stopped.
const contourOf = (v1, v2, heavy, height) =>
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
  const { sx, sy, box, picture } = plot(view, {
    left,
    x: axis([-0.1 * most, 1.25 * most], "table’s push / m g dt", ...steps(0, most, 3)),
    y: axis([-0.1 * most, 1.05 * most], "upper push / m g dt", ...steps(0, most, 3)),
  });
  const place = ([x, y]) => [sx(x), sy(y)];
  const [zero, far] = [place([0, 0]), [box.right, box.top]];
  const negative = area([[box.left, far[1]], [zero[0], far[1]], zero, [far[0], zero[1]],
    [far[0], box.bottom], [box.left, box.bottom]], "region");
  const bowl = LEVELS.map((level) =>
    path(contourOf(v1, v2, heavy, level * most).map(place), "contour"));
  const way = (points, model) => [path(points.map(place), `line m-${model} plainly`),
    points.slice(1, 9).map((each) => circle(...place(each), 4, `look m-${model}`))];
  const r = Math.min(36, 0.3 * left);
  const hold = (v, k) => {
    const y = floor - (2 * k + 1) * r;
    const what = {
      label: `the ${["lower", "upper"][k]} ball’s speed before the sweeps`, value: `v${k + 1}`,
      low: -2, high: 3, step: 0.1, at: (_, to) => -to / UNIT,
    };
    return [view.grab(what, ball("lcp", left / 2, y, r, "ball plainly")),
      arrow("weight", left / 2, y, 0, -UNIT * v)];
  };
  const list = (pair) => pair.map((each) => number(each)).join(" and ");
  const from = {
    label: "where the sweeps start", value: ["begin1", "begin2"], low: [0, 0], high: [1, 1],
    step: 0.02, at: (x, y) => [sx.back(x) / most, sy.back(y) / most],
  };
  return {
    picture: [
      table(0, floor, left, GROUND), [v1, v2].map(hold),
      heavy > 1 ? label(`${heavy} kg`, left / 2, floor - 4 * r - 8, "middle") : "",
      picture, negative,
      clipped(box.left, box.top, box.right - box.left, box.bottom - box.top, bowl),
      way(walked, "lcp"), way(rolled, "leapfrog"), mark("lcp", ...place(end), 7),
      view.point(...place(begin), from),
    ],
    words: `From ${list(begin)} m g dt to ${list(end)}: ${sweeps[0]} sweeps, with momentum ` +
      `${sweeps[1]}.`,
    values: { end, rolled: rolled[SWEEPS], sweeps },
  };
}

export const figure = {
  title: "The sweep walks down a bowl",
  caption: "Dots: after each visit of a plain sweep. With momentum (yellow) the walk goes on a "
    + "little after each sweep.",
  height: (width) => (width < 480 ? 280 : 340),
  start: () => ({ v1: -1, v2: -1, heavy: 10, begin1: 0.02, begin2: 0.86 }),
  buttons: ({ own }) => {
    const change = () => (own.heavy = own.heavy > 1 ? 1 : 10);
    return [["The upper ball ten times as heavy", change, String(own.heavy > 1)]];
  },
  draw,
};
