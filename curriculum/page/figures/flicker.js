/* A ball slides off a round hill: the force that soft gives, step by step, and what the hill asks for. */
import { axis, ball, circle, clipped, label, line, number, plot, range } from "../draw.js";
import { data } from "../data.js";
import { column, G, kept, R, record } from "../runs.js";

const [HILL, START, COUNT, SETTLED] = [1, 0.1, 900, 50]; // m, rad, steps; after so many it has its depth
const DEGREE = Math.PI / 180;
const asked = (angle) => 3 * Math.cos(angle) - 2 * Math.cos(START); // m g

// [[angle [degrees], force [m g]]] of every step, up to where the hill would let the ball go.
const slid = kept((d0, dt) => {
  const [reach, solimp] = [HILL + R, [d0, ...data.solimp.slice(1)]];
  const balls = column([HILL, HILL + reach * Math.cos(START)],
    { x: [0, reach * Math.sin(START)], mass: [Infinity, 1], radius: [HILL, R] });
  const run = record("soft", balls, { dt, solimp }, COUNT);
  return range(COUNT - SETTLED, (k) => {
    const [now, next] = [1, 3].map((off) => 2 * (k + SETTLED) + off);
    const [ax, ay] = [run.vx, run.vy].map((v) => (v[next] - v[now]) / dt);
    const force = Math.hypot(ax, ay + G) / G;
    return [Math.atan2(run.x[now], run.y[now] - HILL) / DEGREE, force < 1e-9 ? 0 : force];
  }).filter(([angle]) => asked(angle * DEGREE) > 0);
});

function draw(view) {
  const { own: { d0, dt }, width, height } = view;
  const steps = slid(d0, dt);
  const angle = Math.acos((2 * Math.cos(START)) / (3 - d0));
  const [first] = steps.find(([, force]) => force === 0) ?? [];
  const [left, bottom] = [Math.round(0.24 * width), height - 46];
  const { sx, box, picture } = plot(view, {
    left: left + 8, x: axis([0, 55], "angle from the top (degrees)", 0, 10, 20, 30, 40, 50),
    y: axis([0, 2.4], "force / m g", 0, 1, 2),
    lines: [
      { model: "soft", points: steps, kind: "thin plainly" },
      { model: "body", points: range(56, (k) => [k, Math.max(0, asked(k * DEGREE))]), kind: "step-line" },
    ],
  });
  const [hill, r, at] = [0.86 * left, 0.12 * left, sx(angle / DEGREE)];
  const [x, y] = [(hill + r) * Math.sin(angle), bottom - (hill + r) * Math.cos(angle)];
  return {
    picture: [
      clipped(0, 0, left, bottom, circle(0, bottom, hill, "body m-fixed"), line(0, bottom, x, y)),
      ball("soft", x, y, r), picture,
      line(at, box.top, at, box.bottom, "rule"), label(`${number(angle / DEGREE)}°`, at + 6, box.top + 12),
    ],
    words: `From ${number(angle / DEGREE)}° on the hill asks for less than d₀ gives; ` +
      `${first === undefined ? "no step lacks a force." : `the first gap comes at ${number(first)}°.`}`,
  };
}

export const figure = {
  title: "A force that flickers",
  caption: "The force that soft gives, and the one that the hill asks for (dark). Lower the impedance "
    + "at the surface.",
  height: (width) => (width < 480 ? 260 : 300),
  knobs: ["d0"],
  start: () => ({ d0: data.solimp[0] }),
  draw,
};
