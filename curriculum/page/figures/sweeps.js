/* The sweep as a walk: the impulses of two contacts are a plane, and each visit to a contact goes
 * along its own axis until that contact has its target, but not below zero: a staircase between two
 * lines. With momentum=1 the upper ball is ten times as heavy, the contours are those of the bowl
 * whose lowest point is looked for, and a second walk goes on a little after each sweep. Values:
 * the impulses of both walks now, and in the end [m g dt]. */
import { area, arrow, axis, ball, clipped, label, mark, number, path, plot, range } from "../draw.js";
import { table } from "../draw.js";
import { Contact, FLOOR, solve_accelerated, solve_contacts } from "../contact.js";
import { column, kept, R } from "../runs.js";

const [SWEEPS, UNIT, GROUND] = [80, 26, 40]; // px: an arrow for g dt, the table
const LEVELS = [0.02, 0.1, 0.3, 0.7, 1.4, 2.5, 4]; // of the contours, as shares of the picture
const NAMES = ["ball 2 on 1", "ball 1 on the table"];

// Contacts of two balls over one another, from below, with these impulses and speeds.
function stacked(mass, lam, vy) {
  const balls = column([R, 3 * R], { mass, vy });
  return balls.map((each, i) =>
    Object.assign(new Contact(each, i ? balls[0] : FLOOR, 0, 1, 0), { lam: lam[i] }));
}

// In m g dt and g dt: after each visit the impulses and speeds, and the impulses of a walk with
// momentum after each sweep.
const walks = kept((v2, begin, heavy) => {
  const [mass, vy] = [[1, heavy], [begin[0] - begin[1] - 1, v2 + begin[1] / heavy]];
  const contacts = stacked(mass, begin, vy);
  const plainly = range(2 * SWEEPS + 1, (visit) => {
    if (visit) solve_contacts([contacts[(visit + 1) % 2]], 1);
    return { lam: contacts.map((c) => c.lam), vy: contacts.map(({ a }) => a.vy) };
  });
  const rolled = range(SWEEPS + 1, (count) => {
    const all = stacked(mass, begin, vy);
    solve_accelerated(all, count);
    return all.map(({ lam }) => lam);
  });
  return { plainly, rolled };
});

// The contour of the bowl so high above its lowest point, where both balls are stopped.
const contourOf = (v2, heavy, height) =>
  range(73, (k) => {
    const [size, angle] = [Math.sqrt(2 * height), (k * Math.PI) / 36];
    const second = size * Math.sqrt(heavy) * Math.sin(angle);
    return [size * Math.cos(angle) + second + 1 - heavy * v2, second - heavy * v2];
  });

function draw(view) {
  const { own: { v2, momentum, begin1, begin2, time }, width, height } = view;
  const [heavy, most] = momentum ? [10, 35] : [1, 3]; // m g dt, that are seen
  const begin = momentum ? [begin1 * most, begin2 * most] : [0, 0];
  const { plainly, rolled } = walks(v2, begin, heavy);
  const at = Math.min(2 * SWEEPS, Math.floor(time + 1e-9));
  const [{ lam, vy }, sweep] = [plainly[at], Math.ceil(at / 2)];
  const [left, floor] = [Math.round(0.28 * width), height - GROUND];
  const { sx, sy, box, picture } = plot(view, {
    left, x: axis([-0.1 * most, 1.25 * most], "table’s push / m g dt"),
    y: axis([-0.1 * most, 1.05 * most], "upper push / m g dt"),
  });
  const place = ([x, y]) => [sx(x), sy(y)];
  const [zero, far] = [place([0, 0]), [box.right, box.top]];
  const negative = area([[box.left, far[1]], [zero[0], far[1]], zero, [far[0], zero[1]],
    [far[0], box.bottom], [box.left, box.bottom]], "region");
  // where a contact has its target, and both balls move as one; or the bowl
  const own = [[1, 1], [(1 + 1 / heavy), v2 + 1]].map(([steep, off], k) =>
    path([0, 2 * most].map((up) => place([k ? steep * up + off : up + 1, up])), "rule dashed"));
  const bowl = LEVELS.map((level) =>
    path(contourOf(v2, heavy, level * most).map(place), "contour"));
  const r = Math.min(40, 0.3 * left);
  const balls = vy.map((v, k) => [ball("lcp", left / 2, floor - (2 * k + 1) * r, r, "body"),
    arrow("weight", left / 2, floor - (2 * k + 1) * r, 0, -UNIT * v)]);
  const hold = {
    label: "the upper ball’s speed before the sweeps", value: "v2", low: -2, high: 3, step: 0.1,
    at: (_, to) => -to / UNIT,
  };
  const start = {
    label: "where the sweeps start", value: ["begin1", "begin2"], low: [0, 0], high: [1, 1],
    step: 0.02, at: (x, y) => [sx.back(x) / most, sy.back(y) / most],
  };
  const last = plainly[at && at - 1].lam[at % 2 ? 0 : 1];
  const clamped = at > 0 && lam[at % 2 ? 0 : 1] === 0 && last === 0;
  const off = (each) => number(Math.hypot(each[0] - end[0], each[1] - end[1]), 2);
  const end = plainly[2 * SWEEPS].lam;
  const told = at ? `Sweep ${sweep}, ${NAMES[at % 2]}${clamped ? ", clamped at 0" : ""}` : "No push yet";
  return {
    picture: [
      table(0, floor, left, GROUND), momentum ? balls : [balls[0], view.grab(hold, balls[1])],
      momentum ? label(`${heavy} kg`, left / 2, floor - 4 * r - 8, "middle") : "",
      picture, negative,
      clipped(box.left, box.top, box.right - box.left, box.bottom - box.top, momentum ? bowl : own,
        path(plainly.slice(0, at + 1).map((each) => place(each.lam)), "line m-lcp plainly"),
        momentum ? path(rolled.slice(0, sweep + 1).map(place), "line m-leapfrog plainly") : ""),
      momentum ? mark("leapfrog", ...place(rolled[sweep])) : "", mark("lcp", ...place(lam), 7),
      momentum ? view.point(...place(begin), start) : "",
    ],
    words: momentum ? `After ${sweep} sweeps: ${off(lam)} m g dt from the answer; with momentum ` +
      `${off(rolled[sweep])}.` : `${told}: they carry ${lam.map((one) => number(one, 2)).join(" and ")} m g dt.`,
    values: { lam, rolled: rolled[sweep], end, clamped },
  };
}

export const figure = {
  title: ({ momentum }) => (momentum ? "The sweep walks down a bowl" : "The sweep, contact after contact"),
  caption: ({ momentum }) => (momentum
    ? "Blue: a plain sweep after the other. Yellow: with momentum. Drag where they start."
    : "Each visit brings one contact to its dashed line and disturbs the other. Drag the upper ball "
      + "up: no push goes below zero."),
  height: (width) => (width < 480 ? 280 : 340),
  start: ({ momentum = 0 }) =>
    ({ momentum, v2: -1, begin1: 0.02, begin2: 0.86, time: momentum ? 44 : 2 }),
  clock: ({ own }) => ({ end: own.momentum ? 2 * SWEEPS : 24, rate: own.momentum ? 20 : 2, step: 1 + own.momentum }),
  play: () => "Play",
  draw,
};
