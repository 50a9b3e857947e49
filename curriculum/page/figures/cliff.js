/* The eigenvalues of a step of a pressed spring, beside the circle of size one; and how far a ball
 * still moves that was lifted by a ten thousandth of its depth at rest. */
import { circle, label, line, logAxis, mark, ms, number, path, plain, plot, range } from "../draw.js";
import { tenTo, within } from "../draw.js";
import { critical_dt } from "../contact.js";
import { column, G, kept, R, record } from "../runs.js";

const [LOW, HIGH, COUNT] = [0.0005, 0.064, 1000]; // s, s, steps
const [NONE, FARTHEST] = [1e-6, 1e9]; // r: less is drawn as zero, more as nowhere
const LEFTMOST = -2.4; // an eigenvalue further to the left stands at the edge, with its number
const isWide = (width) => width >= 480; // the circle stands beside the chart, or above it

// The eigenvalues [real, imaginary] of the step's matrix, for a ball of 1 kg.
function pairOf({ stiffness: k, damping: c }, dt) {
  const [[a, b], [e, d]] = [[1 - k * dt * dt, -dt * (1 - c * dt)], [k * dt, 1 - c * dt]];
  const [square, middle] = [((a - d) / 2) ** 2 + b * e, (a + d) / 2];
  const root = Math.sqrt(Math.abs(square));
  return [root, -root].map((part) => (square < 0 ? [middle, part] : [middle + part, 0]));
}

// How far the lifted ball moves in the last quarter of COUNT steps [r].
const moves = kept((dt, stiffness, damping) => {
  const start = column([R - ((1 - 1e-4) * G) / stiffness]);
  const { y } = record("penalty", start, { dt, stiffness, damping }, COUNT);
  const late = y.slice(-COUNT / 4);
  const far = (Math.max(...late) - Math.min(...late)) / R;
  return Number.isFinite(far) ? within(NONE, far, FARTHEST) : FARTHEST;
}, 200);

function circleOf(own, pairs, critical, width, height) {
  const unit = Math.min(width / 4, (height - 26) / 2.1);
  const [x, y] = [0.5 * (width + unit), 0.5 * height + 6];
  const at = ([real, imaginary]) => [x + within(LEFTMOST, real, 1.3) * unit, y - imaginary * unit];
  // of both, from a step of nothing to twice the critical one
  const ways = [0, 1].map((which) => range(121, (k) => at(pairOf(own, (k / 60) * critical)[which])));
  const tick = (text, toX, toY, anchor = "start") => label(text, toX, toY, anchor, "tick");
  const least = Math.min(...pairs.map(([real]) => real));
  return [
    line(x + LEFTMOST * unit, y, x + 1.4 * unit, y, "axis"),
    line(x, y - 1.1 * unit, x, y + 1.1 * unit, "grid"), circle(x, y, unit, "rule region"),
    tick("size 1", x + 0.74 * unit, y - 0.78 * unit), tick("1", x + unit + 6, y + 20),
    tick("−1", x - unit - 6, y + 20, "end"), tick("0", x - 6, y + 20, "end"),
    label("eigenvalues of a step", 0, 14, "start", "axis-name"),
    ways.map((each) => path(each, "rule dashed")), pairs.map((pair) => mark("penalty", ...at(pair), 7)),
    least < LEFTMOST ? label(number(least), x + LEFTMOST * unit, y - 14) : "",
  ];
}

function draw(view) {
  const { own: { dt, stiffness, damping }, width, height } = view;
  const critical = critical_dt(1, stiffness, damping);
  const pairs = pairOf(view.own, dt);
  const dts = [...range(16, (k) => LOW * (HIGH / LOW) ** (k / 15)), 0.985 * critical, 1.015 * critical]
    .filter((each) => each >= LOW && each <= HIGH).sort((a, b) => a - b);
  const [left, top] = isWide(width) ? [Math.round(0.42 * width), 0] : [0, Math.round(0.42 * height)];
  const { sx, sy, box, picture, knob } = plot(view, {
    left, top, x: logAxis([LOW, HIGH], "time step dt (ms)",
      ...range(8, (k) => [LOW * 2 ** k, plain(1000 * LOW * 2 ** k)])),
    y: logAxis([NONE, FARTHEST], `still moving after ${COUNT.toLocaleString("en")} steps / r`,
      [NONE, "<10⁻⁶"], 0.001, 1, 1000, [1e6, tenTo(6)]),
    lines: [{ model: "penalty", kind: "plainly",
      points: dts.map((each) => [each, moves(each, stiffness, damping)]) }],
  });
  const side = sx(critical) > 0.5 * (left + width) ? -1 : 1;
  const kind = pairs[0][1] > 0 ? "rings" : pairs[1][0] < 0 ? "jumps to and fro" : "creeps back";
  const size = Math.max(...pairs.map((pair) => Math.hypot(...pair)));
  return {
    picture: [
      circleOf(view.own, pairs, critical, left || width, top || height), picture,
      line(sx(critical), box.top, sx(critical), box.bottom, "rule"),
      label(`critical: ${ms(critical)}`, sx(critical) + 6 * side, box.top + 14, side < 0 ? "end" : "start"),
      mark("penalty", sx(dt), sy(moves(dt, stiffness, damping)), 7), knob("dt", "the time step", 0.0002),
    ],
    words: `In steps of ${ms(dt)} a pressed ball ${kind}: × ${number(size)} a step.`,
  };
}

export const figure = {
  title: "The cliff: eigenvalues, and what they do",
  caption: "Make the step longer: the pair meets, parts, and one leaves the circle on the left. Just there "
    + "a ball at rest begins to move.",
  height: (width) => (isWide(width) ? 300 : 410),
  knobs: ["stiffness", "damping"],
  draw,
};
