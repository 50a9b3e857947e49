/* The sweep as a walk in the plane of two impulses: each visit goes along one axis, until that contact
 * has its target. With momentum=1 a heavy ball lies on top, in a long bowl, and a second walk has
 * momentum. */
import { arrow, axis, ball, clipped, label, mark, number, path, plot, range, rect } from "../draw.js";
import { table } from "../draw.js";
import { Contact, FLOOR, solve_accelerated, solve_contacts } from "../contact.js";
import { column, kept, R } from "../runs.js";

const [SWEEPS, UNIT, GROUND] = [80, 26, 40]; // px: an arrow for g dt, the table
const LEVELS = [0.02, 0.1, 0.3, 0.7, 1.4, 2.5, 4]; // of the contours, as shares of the picture

// In m g dt and g dt: impulses and speeds after each visit, and the impulses of a walk with momentum
// after each sweep.
const walks = kept((v2, heavy) => {
  const start = () => {
    const balls = column([R, 3 * R], { mass: [1, heavy], vy: [-1, v2] });
    return balls.map((each, i) => new Contact(each, i ? balls[0] : FLOOR, 0, 1, 0));
  };
  const contacts = start();
  const plainly = range(2 * SWEEPS + 1, (visit) => {
    if (visit) solve_contacts([contacts[(visit + 1) % 2]], 1);
    return { lam: contacts.map((c) => c.lam), vy: contacts.map(({ a }) => a.vy) };
  });
  const rolled = range(SWEEPS + 1, (count) => {
    const all = start();
    solve_accelerated(all, count);
    return all.map(({ lam }) => lam);
  });
  return { plainly, rolled, end: plainly[2 * SWEEPS].lam };
});

// The contour of the bowl so high above its lowest point, where both balls are stopped.
const contourOf = (v2, heavy, height) =>
  range(73, (k) => {
    const [size, angle] = [Math.sqrt(2 * height), (k * Math.PI) / 36];
    const second = size * Math.sqrt(heavy) * Math.sin(angle);
    return [size * Math.cos(angle) + second + 1 - heavy * v2, second - heavy * v2];
  });

function draw(view) {
  const { own: { v2, momentum, time }, width, height } = view;
  const [heavy, most] = momentum ? [10, 24] : [1, 3]; // kg, m g dt
  const { plainly, rolled, end } = walks(v2, heavy);
  const at = Math.min(2 * SWEEPS, Math.floor(time + 1e-9));
  const [{ lam, vy }, sweep] = [plainly[at], Math.ceil(at / 2)];
  const [left, floor] = [Math.round(0.28 * width), height - GROUND];
  const { sx, sy, box, picture } = plot(view, {
    left, x: axis([-0.1 * most, 1.25 * most], "table’s push / m g dt"),
    y: axis([-0.1 * most, 1.05 * most], "upper push / m g dt"),
  });
  const way = (points, kind) => path(points.map(([x, y]) => [sx(x), sy(y)]), kind);
  // where a contact has its target, and both balls move as one; or the bowl
  const lines = momentum ? LEVELS.map((level) => way(contourOf(v2, heavy, level * most), "contour"))
    : [[1, 1], [2, v2 + 1]].map(([steep, off]) => {
      const up = Math.min(1.05 * most, (1.25 * most - off) / steep); // to the picture's edge
      return way([[off, 0], [steep * up + off, up]], "rule dashed");
    });
  const r = Math.min(40, 0.3 * left);
  const hold = { label: "the upper ball’s speed before the sweeps", value: "v2", low: -2,
    high: momentum ? 0 : 3, step: 0.1, at: (_, y) => -y / UNIT };
  const balls = vy.map((v, k) => {
    const [y, shape] = [floor - (2 * k + 1) * r, ball("lcp", left / 2, floor - (2 * k + 1) * r, r)];
    return [k ? view.grab(hold, shape) : shape, arrow("weight", left / 2, y, 0, -UNIT * v)];
  });
  const off = ([x, y]) => number(Math.hypot(x - end[0], y - end[1]), 2);
  return {
    picture: [
      table(0, floor, left, GROUND), balls,
      momentum ? label(`${heavy} kg`, left / 2, floor - 4 * r - 8, "middle") : "", picture,
      rect(box.left, box.top, sx(0) - box.left, box.bottom - box.top, "region"),
      rect(sx(0), sy(0), box.right - sx(0), box.bottom - sy(0), "region"),
      clipped(box.left, box.top, box.right - box.left, box.bottom - box.top, lines,
        way(plainly.slice(0, at + 1).map((each) => each.lam), "line m-lcp plainly"),
        momentum ? way(rolled.slice(0, sweep + 1), "line m-leapfrog plainly") : ""),
      momentum ? mark("leapfrog", sx(rolled[sweep][0]), sy(rolled[sweep][1])) : "",
      mark("lcp", sx(lam[0]), sy(lam[1]), 7),
    ],
    words: momentum
      ? `After ${sweep} sweeps: ${off(lam)} m g dt from the answer; with momentum ${off(rolled[sweep])}.`
      : `After ${at} visits they carry ${lam.map((each) => number(each, 2)).join(" and ")} m g dt.`,
  };
}

export const figure = {
  title: ({ momentum }) => (momentum ? "The sweep walks down a bowl" : "The sweep, contact after contact"),
  caption: ({ momentum }) => (momentum
    ? "Blue: a plain sweep after the other. Yellow: with momentum. Drag the upper ball’s speed."
    : "Each visit brings one contact to its dashed line and disturbs the other. Drag the upper ball "
      + "up: no push goes below zero."),
  height: (width) => (width < 480 ? 260 : 340),
  start: ({ momentum = 0 }) => ({ momentum, v2: -1, time: momentum ? 44 : 2 }),
  clock: ({ own: { momentum } }) =>
    ({ end: momentum ? 2 * SWEEPS : 24, rate: momentum ? 20 : 2, step: 1 + momentum }),
  play: () => "Play",
  draw,
};
