/* A ball slides off a round hill: the force that soft gives, step by step, over the angle, beside
 * the one that the hill asks for. Once the hill asks for less than d0 gives, the ball is thrown
 * off, falls back, and so on. Values: the angle by the formula, that of the first step without
 * force [degrees], and the share of steps without one until the ball leaves the hill. */
import { axis, ball, circle, clipped, label, line, number, plot, range } from "../draw.js";
import { data } from "../data.js";
import { column, G, kept, R, record } from "../runs.js";

const [HILL, START, COUNT, END] = [1, 0.1, 900, 55]; // m, rad, steps, degrees
const SETTLED = 50; // steps in which the ball finds its depth
const DEGREE = Math.PI / 180;
const asked = (angle) => 3 * Math.cos(angle) - 2 * Math.cos(START); // m g

// [[angle [rad], force [m g]]] of every step, up to where the hill would let the ball go.
const slid = kept((d0, dt) => {
  const reach = HILL + R;
  const at = { x: [0, reach * Math.sin(START)], mass: [Infinity, 1], radius: [HILL, R] };
  const solimp = [d0, ...data.solimp.slice(1)];
  const run = record("soft", column([HILL, HILL + reach * Math.cos(START)], at), { dt, solimp }, COUNT);
  return range(COUNT - SETTLED, (k) => {
    const [now, next] = [1, 3].map((off) => 2 * (k + SETTLED) + off);
    const [fx, fy] = [(run.vx[next] - run.vx[now]) / dt, (run.vy[next] - run.vy[now]) / dt + G];
    const force = Math.hypot(fx, fy) / G;
    return [Math.atan2(run.x[now], run.y[now] - HILL), force < 1e-9 ? 0 : force];
  }).filter(([angle]) => asked(angle) > 0);
});

function draw(view) {
  const { own: { d0, dt }, width, height } = view;
  const steps = slid(d0, dt);
  const formula = Math.acos((2 * Math.cos(START)) / (3 - d0));
  const none = steps.filter(([, force]) => force === 0);
  const [first, share] = [none.length ? none[0][0] / DEGREE : null, none.length / steps.length];
  const left = Math.round(0.24 * width);
  const { sx, box, picture } = plot(view, {
    left: left + 8, x: axis([0, END], "angle from the top (degrees)", 0, 10, 20, 30, 40, 50),
    y: axis([0, 2.4], "force / m g", 0, 1, 2),
    lines: [
      { model: "soft", points: steps.map(([angle, force]) => [angle / DEGREE, force]), kind: "thin plainly" },
      { model: "body", points: range(END + 1, (k) => [k, Math.max(0, asked(k * DEGREE))]), kind: "step-line" },
    ],
  });
  const [hill, r] = [0.86 * left, 0.12 * left];
  const [topX, topY] = [(hill + r) * Math.sin(formula), (hill + r) * Math.cos(formula)];
  const middle = height - 46;
  return {
    picture: [
      clipped(0, 0, left, middle, circle(0, middle, hill, "body m-fixed"),
        line(0, middle, topX, middle - topY, "rule dashed")),
      ball("soft", topX, middle - topY, r), picture,
      line(sx(formula / DEGREE), box.top, sx(formula / DEGREE), box.bottom, "rule"),
      label(`${number(formula / DEGREE)}°`, sx(formula / DEGREE) + 6, box.top + 12),
    ],
    words: `From ${number(formula / DEGREE)}° on the hill asks for less than d₀ gives; ` +
      `${first === null ? "no step lacks a force." : `the first gap comes at ${number(first)}°.`}`,
    values: { formula: formula / DEGREE, first, share },
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
