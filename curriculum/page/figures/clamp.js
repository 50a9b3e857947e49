/* The clamp is on the sum of the changes: a ball falls into a groove, where one contact must take
 * some push back; beside it contact.py's sweep with one line changed, which clamps each change.
 * Values: with which speed the ball leaves either [m/s]. */
import { arrow, ball, label, number } from "../draw.js";
import { Ball, Contact, solve_contacts, solve_contacts_each } from "../contact.js";
import { R } from "../runs.js";

const SIDES = [-1, 1];

// The ball after 20 sweeps in a groove of two held balls, and the impulses.
function leaves(vx, vy, solve) {
  const [one, held] = [new Ball(0, 0, vx, vy, 1, R), new Ball(0, 0, 0, 0, Infinity, R)];
  const contacts = SIDES.map((side) => new Contact(one, held, -0.6 * side, 0.8, 0));
  solve(contacts, 20);
  return { vx: one.vx, vy: one.vy, lam: contacts.map(({ lam }) => lam),
    speed: Math.hypot(one.vx, one.vy) };
}

function draw(view) {
  const { vx, vy } = view.own;
  const [right, wrong] = [solve_contacts, solve_contacts_each].map((solve) =>
    leaves(vx, vy, solve));
  const r = Math.min(50, view.width / 9.5);
  const [y, scale] = [view.height - 3.3 * r, 1.7 * r]; // px of an arrow for 1 m/s
  const groove = (after, title, x) => [
    label(title, x, 18, "middle", "axis-name"),
    SIDES.map((side) => ball("fixed", x + side * 1.2 * r, y + 1.6 * r, r, "body")),
    ball("lcp", x, y, r), arrow("before", x - scale * vx, y + scale * vy, scale * vx, -scale * vy),
    SIDES.map((side, k) => {
      const [dx, dy] = [-side * 0.6 * scale * after.lam[k], -0.8 * scale * after.lam[k]];
      return arrow("push m-lcp", x + side * 0.6 * r - dx, y + 0.8 * r - dy, dx, dy);
    }),
    after.speed > 1e-3 ? arrow("weight", x, y, scale * after.vx, -scale * after.vy) : "",
    label(`leaves: ${number(after.speed < 1e-3 ? 0 : after.speed, 2)} m/s`, x, view.height - 6,
      "middle"),
  ];
  const x = view.width / 4;
  const what = {
    label: "where the ball comes from", value: ["vx", "vy"], low: [-1.2, -1.6], high: [1.2,
      -0.1], step: 0.1,
    text: `${number(vx, 2)} m/s to the right and ${number(-vy, 2)} m/s down`,
    at: (toX, toY) => [-toX / scale, toY / scale],
  };
  return {
    picture: [
      groove(right, "the sum stays ≥ 0", x), groove(wrong, "each change ≥ 0", 3 * x),
      view.point(x - scale * vx, y + scale * vy, what),
    ],
    words: `After 20 sweeps the ball moves at ${number(right.speed, 2)} m/s where the sum is clamped, ` +
      `at ${number(wrong.speed, 2)} m/s where each change is.`,
    values: { sum: right.speed, each: wrong.speed },
  };
}

export const figure = {
  title: "A ball falls into a groove, with two clamps",
  caption: "With a clamp on each change nothing is ever taken back, and the ball is thrown out of the groove.",
  height: (width) => (width < 480 ? 230 : 310),
  start: () => ({ vx: 0.5, vy: -1 }),
  draw,
};
