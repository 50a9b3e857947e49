/* The clamp is on the sum of the changes. In a groove one contact must take some push back. */
import { arrow, ball, label, number, shift } from "../draw.js";
import { makeRows, projectImpulse, solveContacts } from "../engine.js";
import { kept, pair, wholly } from "../kit.js";

const SIDES = [-1, 1];

// The ball's velocity after 20 sweeps in a groove of two held balls, reached with (vx, vy).
function leaves(vx, vy, project) {
  const contacts = SIDES.map((side, k) => ({ i: 0, j: k + 1, nx: -0.6 * side, ny: 0.8, depth: 0 }));
  const rows = makeRows(contacts, [1, Infinity, Infinity]);
  const [x, y] = [[vx, 0, 0], [vy, 0, 0]];
  solveContacts(rows, x, y, { iters: 20, project });
  return { vx: x[0], vy: y[0], speed: Math.hypot(x[0], y[0]), lam: rows.map((c) => c.lam) };
}
const both = kept((vx, vy) => [
  leaves(vx, vy, projectImpulse),
  leaves(vx, vy, (lam, change) => lam + Math.max(0, change)),
]);

function groove({ vx, vy }, after, title, x, y, r) {
  const scale = 1.7 * r; // px of an arrow for 1 m/s
  const pushes = SIDES.map((side, k) => {
    const [dx, dy] = [-side * 0.6 * scale * after.lam[k], -0.8 * scale * after.lam[k]];
    return arrow("push m-lcp", x + side * 0.6 * r - dx, y + 0.8 * r - dy, dx, dy);
  });
  const moves = after.speed > 1e-3;
  return [
    label(title, x, 18, "middle", "axis-name"),
    ...SIDES.map((side) => ball("fixed", x + side * 1.2 * r, y + 1.6 * r, r, "body")),
    ball("lcp", x, y, r),
    ...pushes,
    arrow("before", x - scale * vx, y + scale * vy, scale * vx, -scale * vy),
    moves ? arrow("weight", x, y, scale * after.vx, -scale * after.vy) : "",
    moves ? label(`leaves: ${number(after.speed, 2)} m/s`, x, y + 2.6 * r + 18, "middle") : "",
  ].join("");
}

function draw(view) {
  const { vx, vy } = view.own;
  const [right, wrong] = both(vx, vy);
  const r = Math.min(52, view.width / 9.5);
  const [x, y, scale] = [view.width / 4, view.height - 3.2 * r, 1.7 * r];
  const ranges = { vx: [-1.2, 1.2], vy: [-1.6, -0.1] };
  const at = (toX, toY) => [(x - toX) / scale, (toY - y) / scale];
  const from = [x - scale * vx, y + scale * vy];
  const text = `comes with ${number(vx, 2)} m/s to the right and ${number(-vy, 2)} m/s down`;
  const to = { at, px: 0.1 * scale };
  const came = pair(view, "ball", from, "where the ball comes from", text, ranges, to);
  const [sum, each] = [right, wrong].map(({ speed }) => `at ${number(speed, 2)} m/s where`);
  return {
    svg:
      groove(view.own, right, "sum ≥ 0", x, y, r) +
      shift(view.width / 2, 0, groove(view.own, wrong, "each change ≥ 0", x, y, r)),
    words: `After 20 sweeps the ball moves ${sum} the sum is clamped, ${each} each change is.`,
    handles: [
      wholly(came, "left", x, y, r),
      wholly(came, "right", x + view.width / 2, y, r),
      came,
    ],
  };
}

export const figure = {
  title: "A ball falls into a groove, with two clamps",
  caption:
    "With a clamp on each change nothing is ever taken back, and the ball is thrown out of the " +
    "groove: drag where it comes from.",
  height: 320,
  narrow: 230,
  start: () => ({ vx: 0.5, vy: -1 }),
  draw,
};
