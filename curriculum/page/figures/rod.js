/* What friction breaks: a rod's lower end slides along the table, ahead of its middle. The speed at
 * which the end parts from the table, over how hard the table pushes: two straight pieces, where it
 * slides and where it sticks. The law (no pull, no overlap, no push without touch) holds where the
 * line crosses zero, and at no push at all. Values: those answers [N s], the one of the relaxed
 * law, and v_n at the chosen push [m/s]. */
import { arrow, axis, circle, clipped, line, mark, number, plot, table, within } from "../draw.js";

// A rod of 1 kg and 2 m: its end, seen from the middle [m], which without a push rises and slides
// with FREE [m/s]; W: what an impulse at the end changes of that [1/kg].
const [X, Y, FREE] = [Math.sqrt(0.2), -Math.sqrt(0.8), [0.4, 4]];
const W = [[1 + 3 * X * X, -3 * X * Y], [-3 * X * Y, 1 + 3 * Y * Y]];
const MOST = 1.3; // N s, that are seen

// v_n and v_t at a push p: friction is mu p against the motion, or as much as stops it.
function after(p, mu) {
  const sticks = (FREE[1] + W[1][0] * p) / W[1][1];
  const rub = -Math.min(mu * p, sticks);
  return [0, 1].map((k) => FREE[k] + W[k][0] * p + W[k][1] * rub);
}

// Where what f gives for a push is zero: it is straight between neighbours of a fine grid.
function crossings(f) {
  const grid = Array.from({ length: 2001 }, (_, k) => (k * 2 * MOST) / 2000);
  return grid.slice(1).flatMap((p, k) => {
    const [a, b] = [f(grid[k]), f(p)];
    return a > 0 !== b > 0 ? [grid[k] + ((p - grid[k]) * a) / (a - b)] : [];
  });
}

function answersOf(mu) {
  const law = (p) => after(p, mu)[0];
  const [relaxed = 0] = crossings((p) => law(p) - mu * after(p, mu)[1]);
  return { coulomb: [0, ...crossings(law)], relaxed: mu * FREE[1] > FREE[0] ? relaxed : 0 };
}

function draw(view) {
  const { own: { mu, push }, width, height } = view;
  const { coulomb, relaxed } = answersOf(mu);
  const [v_n, v_t] = after(push, mu);
  const narrow = width < 480;
  const left = narrow ? width : Math.round(0.36 * width);
  const floor = narrow ? 150 : height - 60;
  const points = Array.from({ length: 261 }, (_, k) => [k / 200, after(k / 200, mu)[0]]);
  const { sx, sy, picture, knob } = plot(view, {
    left: narrow ? 0 : left + 8, top: narrow ? 180 : 0,
    x: axis([0, MOST], "push of the table (N s)", 0, 0.5, 1),
    y: axis([-0.35, 0.6], "v_n of the end (m/s)", -0.2, 0, 0.2), zero: true,
    lines: [{ model: "exact", points, kind: "plainly" }],
  });
  const [x, scale] = [0.68 * left, (floor - 16) / 1.9]; // px; px for 1 m
  const middle = [x - X * scale, floor + Y * scale];
  const seen = coulomb.filter((p) => p <= MOST);
  const told = seen.map((p) => number(p, 2)).join(", ").replace(/, ([^,]*)$/, " and $1");
  const count = seen.length === 1 ? "one answer, a push" : `${seen.length} answers, pushes`;
  const fate = v_t > 1e-9 ? "slides on" : "sticks";
  const does = Math.abs(v_n) < 5e-3 ? "stays on the table" : v_n > 0 ? "rises" : "is pressed in";
  return {
    picture: [
      clipped(0, 0, left, floor + 28, table(0, floor, left, 60),
        line(2 * middle[0] - x, 2 * middle[1] - floor, x, floor, "rod"),
        circle(...middle, 4, "dot"),
        arrow("weight", x, floor, 14 * Math.min(4, v_t), -14 * 4 * v_n),
        arrow("push m-exact", x, floor + 26, 0, -26 * within(0, push, 1))),
      picture, seen.map((p) => circle(sx(p), sy(p ? 0 : FREE[0]), 9, "answer")),
      mark("exact", sx(push), sy(v_n), 7), knob("push", "the push", 0.02),
    ],
    words: `µ = ${number(mu)}: the law has ${count} of ${told} N s; relaxed it has one, ` +
      `${number(relaxed, 2)} N s. With ${number(push, 2)} N s the end ${does} and ${fate}.`,
    values: { coulomb, relaxed, v_n, v_t },
  };
}

export const figure = {
  title: "A rod, one contact, three answers",
  caption: "Circles: where the law of friction holds. Halfway between two answers there is none.",
  height: (width) => (width < 480 ? 420 : 320),
  knobs: ["mu"],
  start: () => ({ mu: 2, push: 0.25 }),
  draw,
};
