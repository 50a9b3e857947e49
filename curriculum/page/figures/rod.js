/* A rod's lower end slides along the table, ahead of its middle. How fast it parts from the table, over
 * how hard the table pushes: the law holds where the line crosses zero, and at no push at all. */
import { arrow, axis, circle, clipped, line, mark, number, plot, table, within } from "../draw.js";

// A rod of 1 kg and 2 m: its end, seen from the middle [m], which without a push rises and slides
// with FREE [m/s]; W: what an impulse at the end changes of that [1/kg].
const [X, Y, FREE] = [Math.sqrt(0.2), -Math.sqrt(0.8), [0.4, 4]];
const W = [[1 + 3 * X * X, -3 * X * Y], [-3 * X * Y, 1 + 3 * Y * Y]];
const [MOST, FAR] = [1.3, 2.6]; // N s: that are seen, and below which answers are sought

// v_n and v_t at a push p: friction is mu p against the motion, or as much as stops it.
function after(p, mu) {
  const rub = -Math.min(mu * p, (FREE[1] + W[1][0] * p) / W[1][1]);
  return [0, 1].map((k) => FREE[k] + W[k][0] * p + W[k][1] * rub);
}

// The ends of the straight pieces: up to the push at which it sticks, and from there on.
function bendsOf(mu) {
  const sticks = FREE[1] / (mu * W[1][1] - W[1][0]);
  return [0, ...(sticks > 0 && sticks < FAR ? [sticks] : []), FAR];
}

// Where what f gives for a push is zero, of what is straight between these pushes.
const crossings = (f, bends) =>
  bends.slice(1).flatMap((p, k) => {
    const [a, b] = [f(bends[k]), f(p)];
    return a > 0 !== b > 0 ? [bends[k] + ((p - bends[k]) * a) / (a - b)] : [];
  });

function draw(view) {
  const { own: { mu, push }, width, height } = view;
  const [law, bends] = [(p) => after(p, mu)[0], bendsOf(mu)];
  const coulomb = [0, ...crossings(law, bends)];
  const [relaxed = 0] = crossings((p) => law(p) - mu * after(p, mu)[1], bends);
  const [v_n, v_t] = after(push, mu);
  const [left, floor] = [Math.round(0.36 * width), height - 60];
  const ends = [...bends.slice(1, -1), MOST].map((p) => law(Math.min(p, MOST)));
  const { sx, sy, picture, knob } = plot(view, {
    left: left + 8, x: axis([0, MOST], "push of the table (N s)", 0, 0.5, 1), zero: true,
    y: axis([Math.min(-0.35, ...ends) - 0.05, Math.max(0.6, ...ends) + 0.05], "vₙ of the end (m/s)"),
    lines: [{ model: "exact", points: bends.map((p) => [p, law(p)]), kind: "plainly" }],
  });
  const [x, scale] = [0.68 * left, Math.min(0.6 * left, (floor - 16) / 1.9)]; // px; px for 1 m
  const middle = [x - X * scale, floor + Y * scale];
  const told = coulomb.map((p) => number(p, 2)).join(", ").replace(/, ([^,]*)$/, " or $1");
  const does = Math.abs(v_n) < 5e-3 ? "stays" : v_n > 0 ? "rises" : "digs in";
  return {
    picture: [
      clipped(0, 0, left, height, table(0, floor, left, 60),
        line(2 * middle[0] - x, 2 * middle[1] - floor, x, floor, "rod"), circle(...middle, 4, "dot"),
        arrow("weight", x, floor, 14 * Math.min(4, v_t), -14 * 4 * v_n),
        arrow("push m-exact", x, floor + 58, 0, -44 * within(0, push, 1))),
      picture, coulomb.map((p) => circle(sx(p), sy(p ? 0 : FREE[0]), 9, "rule")),
      mark("exact", sx(push), sy(v_n), 7), knob("push", "the push", 0.02),
    ],
    words: `The law: ${told} N s; relaxed: ${number(relaxed, 2)} N s. At ${number(push, 2)} N s ` +
      `the end ${does}, ${v_t > 1e-9 ? "slides" : "sticks"}.`,
  };
}

export const figure = {
  title: "A rod, one contact, three answers",
  caption: "Circles: where the law of friction holds. Halfway between two answers there is none.",
  height: (width) => (width < 480 ? 260 : 320),
  knobs: ["mu"],
  start: () => ({ mu: 2, push: 0.25 }),
  draw,
};
