/* One step of a pressed spring multiplies depth and speed by a matrix: its two eigenvalues beside
 * the circle of size one. Values: the eigenvalues [real, imaginary], their size, and the critical
 * step. */
import { arrow, circle, label, line, mark, number, path, within } from "../draw.js";
import { critical_dt } from "../contact.js";

const FARTHEST = -3.2; // what is further to the left, is said

// The eigenvalues [real, imaginary] of the step's matrix, for a ball of 1 kg.
function pairOf({ stiffness: k, damping: c }, dt) {
  const [[a, b], [e, d]] = [[1 - k * dt * dt, -dt * (1 - c * dt)], [k * dt, 1 - c * dt]];
  const [square, middle] = [((a - d) / 2) ** 2 + b * e, (a + d) / 2];
  const root = Math.sqrt(Math.abs(square));
  return [root, -root].map((part) => (square < 0 ? [middle, part] : [middle + part, 0]));
}

function draw(view) {
  const { own, width, height } = view;
  const pairs = pairOf(own, own.dt);
  const size = Math.max(...pairs.map((pair) => Math.hypot(...pair)));
  const critical = critical_dt(1, own.stiffness, own.damping);
  const unit = Math.min(width / 5.2, (height - 30) / 2.5);
  const [x, y] = [width - 1.75 * unit, height / 2];
  const at = ([real, imaginary]) =>
    [x + within(FARTHEST, real, 1.5) * unit, y - imaginary * unit];
  // the way of both, from a step of nothing to twice the critical one
  const ways = [0, 1].map((which) =>
    Array.from({ length: 241 }, (_, k) => at(pairOf(own, (k / 120) * critical)[which])));
  const least = Math.min(...pairs.map(([real]) => real));
  const kind = pairs[0][1] > 0 ? "rings" : least < 0 ? "is thrown to and fro" : "creeps back";
  const tick = (text, toX, toY, anchor = "start") => label(text, toX, toY, anchor, "tick");
  return {
    picture: [
      line(x + FARTHEST * unit, y, x + 1.6 * unit, y, "axis"),
      line(x, y - 1.2 * unit, x, y + 1.2 * unit, "grid"),
      circle(x, y, unit, "region-ring"),
      tick("size 1", x + 0.74 * unit, y - 0.78 * unit), tick("1", x + unit + 6, y + 20),
      tick("−1", x - unit - 6, y + 20, "end"), tick("0", x - 6, y + 20, "end"),
      tick("real", x + 1.6 * unit, y - 8, "end"), tick("imaginary", x + 6, y - 1.12 * unit),
      ways.map((each) => path(each, "rule dashed")),
      pairs.map((pair) => mark("penalty", ...at(pair), 8)),
      least < FARTHEST
        ? [arrow("weight", 40, y - 24, -30, 0), label(number(least), 46, y - 19)] : "",
    ],
    words: `With ${number(1000 * own.dt)} ms it ${kind}, each step × ${number(size)}. From ` +
      `${number(1000 * critical)} ms on that grows.`,
    values: { pairs, size, critical },
  };
}

export const figure = {
  title: "The eigenvalues of one step",
  caption: "Make the step longer: the pair meets, parts, and one leaves the circle at −1.",
  height: (width) => (width < 480 ? 200 : 260),
  knobs: ["dt", "stiffness", "damping"],
  start: () => ({ dt: 0.014 }),
  draw,
};
