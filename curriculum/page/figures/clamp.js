/* The clamp is on the sum of the changes: a ball falls into a groove, and one contact must take back. */
import { arrow, ball, number } from "../draw.js";
import { makeRows, projectImpulse, solveContacts } from "../engine.js";
import { handle, kept, label, shift, tidy, within } from "../parts.js";

const SIDES = [-1, 1];

// The ball's velocity after 20 sweeps in a groove of two held balls, reached with (vx, vy).
function leaves(vx, vy, project) {
  const contacts = [1, 2].map((j) => ({ i: 0, j, nx: j === 1 ? 0.6 : -0.6, ny: 0.8, depth: 0 }));
  const rows = makeRows(contacts, [1, Infinity, Infinity], [0, 0], [0, 0]);
  const [x, y] = [[vx, 0, 0], [vy, 0, 0]];
  solveContacts(rows, x, y, { iters: 20, project });
  return { vx: x[0], vy: y[0], lam: rows.map((c) => c.lam) };
}
const both = kept((vx, vy) => [
  leaves(vx, vy, projectImpulse),
  leaves(vx, vy, (lam, change) => lam + Math.max(0, change)),
]);

const radius = (view) => Math.min(52, view.width / 9.5);
const speedOf = (view) => 1.7 * radius(view); // px of an arrow for 1 m/s
const centre = (view) => [view.width / 4, view.height - 3.2 * radius(view)];

function groove(view, after, title) {
  const r = radius(view);
  const [x, y] = centre(view);
  const { vx, vy } = view.own;
  const scale = speedOf(view);
  const held = SIDES.map((side) => ball("fixed", x + side * 1.2 * r, y + 1.6 * r, r, "body"));
  const pushes = SIDES.map((side, k) => {
    const [dx, dy] = [-side * 0.6 * scale * after.lam[k], -0.8 * scale * after.lam[k]];
    return arrow("push m-lcp", x + side * 0.6 * r - dx, y + 0.8 * r - dy, dx, dy);
  });
  const speed = Math.hypot(after.vx, after.vy);
  return [
    label(title, x, 18, "middle", "axis-name"),
    ...held,
    ball("lcp", x, y, r),
    ...pushes,
    arrow("before", x - scale * vx, y + scale * vy, scale * vx, -scale * vy),
    speed > 1e-3 ? arrow("weight", x, y, scale * after.vx, -scale * after.vy) : "",
    speed > 1e-3 ? label(`leaves with ${number(speed, 2)} m/s`, x, y + 2.6 * r + 18, "middle") : "",
  ].join("");
}

function draw(view) {
  const { vx, vy } = view.own;
  const [right, wrong] = both(vx, vy);
  const [x, y] = centre(view);
  const scale = speedOf(view);
  const speed = (v) => `${number(Math.hypot(v.vx, v.vy), 2)} m/s`;
  const text = `comes with ${number(vx, 2)} m/s to the right and ${number(-vy, 2)} m/s down`;
  return {
    svg: groove(view, right, "sum ≥ 0") + shift(view.width / 2, 0, groove(view, wrong, "each change ≥ 0")),
    words: `After 20 sweeps the ball moves at ${speed(right)} where the sum is clamped and at ${speed(wrong)} where each change is.`,
    handles: [handle("ball", x - scale * vx, y + scale * vy, 14, "where the ball comes from", vx, text)],
  };
}

function set(view, vx, vy) {
  Object.assign(view.own, { vx: tidy(within(-1.2, vx, 1.2), 2), vy: tidy(within(-1.6, vy, -0.1), 2) });
}

export const figure = {
  title: "A ball falls into a groove, with two clamps",
  caption:
    "With a clamp on each change nothing is ever taken back, and the ball is thrown out of the groove: drag where it comes from.",
  height: 320,
  narrow: 230,
  start: () => ({ vx: 0.5, vy: -1 }),
  draw,
  drag(view, name, x, y) {
    const [at, height] = centre(view);
    set(view, (at - x) / speedOf(view), (y - height) / speedOf(view));
  },
  nudge: (view, name, dx, dy) => set(view, view.own.vx - 0.1 * dx, view.own.vy + 0.1 * dy),
};
