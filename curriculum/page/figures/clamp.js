/* A ball falls into a groove, where one contact must take some push back: the clamp on the sum, and a
 * wrong one, on each change. */
import { arrow, ball, label, number } from "../draw.js";
import { Ball, Contact, solve_contacts } from "../contact.js";
import { R } from "../runs.js";

const SIDES = [-1, 1];

// WRONG, to show what it does: what was pushed too much, no later sweep takes back.
function solve_wrongly(contacts, iters) {
  for (let sweep = 0; sweep < iters; sweep++)
    for (const c of contacts) {
      const change = Math.max(0, -c.v_n() * c.m_eff); // and not max(0, c.lam + ...) - c.lam
      c.apply_impulse(change);
      c.lam += change;
    }
}

// The ball after 20 sweeps in a groove of two held balls, its speed [m/s], and the impulses [N s].
function leaves(vx, vy, solve) {
  const [one, held] = [new Ball(0, 0, vx, vy, 1, R), new Ball(0, 0, 0, 0, Infinity, R)];
  const contacts = SIDES.map((side) => new Contact(one, held, -0.6 * side, 0.8, 0));
  solve(contacts, 20);
  const speed = Math.hypot(one.vx, one.vy);
  return { ...one, lam: contacts.map(({ lam }) => lam), speed, said: `${number(speed < 1e-3 ? 0 : speed, 2)} m/s` };
}

function draw(view) {
  const { own: { vx, vy }, width, height } = view;
  const both = [solve_contacts, solve_wrongly].map((each) => leaves(vx, vy, each));
  const r = Math.min(50, width / 9.5);
  const [y, scale] = [height - 3.3 * r, 1.7 * r]; // px; px of an arrow for 1 m/s
  const grooves = both.map((after, k) => {
    const x = ((2 * k + 1) * width) / 4;
    return [
      label(k ? "each change ≥ 0" : "the sum stays ≥ 0", x, 18, "middle", "axis-name"),
      SIDES.map((side) => ball("fixed", x + side * 1.2 * r, y + 1.6 * r, r, "body")),
      ball("lcp", x, y, r), arrow("before", x - scale * vx, y + scale * vy, scale * vx, -scale * vy),
      SIDES.map((side, i) => {
        const [dx, dy] = [-side * 0.6 * scale * after.lam[i], -0.8 * scale * after.lam[i]];
        return arrow("push m-lcp", x + side * 0.6 * r - dx, y + 0.8 * r - dy, dx, dy);
      }),
      after.speed > 1e-3 ? arrow("weight", x, y, scale * after.vx, -scale * after.vy) : "",
      label(`leaves: ${after.said}`, x, height - 6, "middle"),
    ];
  });
  const what = { label: "where the ball comes from", value: ["vx", "vy"], low: [-1.2, -1.3],
    high: [1.2, -0.1], step: 0.1, at: (toX, toY) => [-toX / scale, toY / scale] };
  return {
    picture: [grooves, view.point(width / 4 - scale * vx, y + scale * vy, what)],
    words: `It comes at ${number(vx, 2)} m/s to the right, ${number(-vy, 2)} m/s down, and leaves ` +
      `at ${both[0].said}, or ${both[1].said}.`,
  };
}

export const figure = {
  title: "A ball falls into a groove, with two clamps",
  caption: "A clamp on each change takes nothing back: the ball is thrown out of the groove.",
  height: (width) => (width < 480 ? 220 : 280),
  start: () => ({ vx: 0.5, vy: -1 }),
  draw,
};
