/* Three balls by penalty, two of which have motors, each drawn some times as far from its mean place as
 * it is; and what becomes of them at which step. With switch=1 the force may be the step's last. */
import { ball, label, line, ms, number, path, range, rect, scaleOf, svg, table, within } from "../draw.js";
import { column, inRow, kept, R, record } from "../runs.js";

const [AT, MASS, MOTOR] = [[-0.205, 0, 0.205], [0.2, 1, 0.2], [20, 0, -20]]; // m, kg, N
const [DAMPING, SECONDS, LATE] = [80, 1, 0.75]; // N s/m, s; what comes after this share is judged
const [LARGER, FAR] = [[80, 20, 5], 0.5]; // times; m: what is farther away has flown apart
const FATES = ["holds still", "trembles", "flies apart"];
const endsOf = ({ switch: shown }) => (shown ? [0.0005, 0.016] : [0.002, 0.008]); // s

// The fate, by how much finger and cup tremble [r], and the states [x, y] that are shown.
const squeezed = kept((dt, stiffness, late) => {
  const balls = column([R, R, R], { x: AT, mass: MASS });
  const push = () => balls.forEach((each, i) => (each.fx = MOTOR[i]));
  const run = record(late ? "implicit" : "penalty", balls, { dt, stiffness, damping: DAMPING },
    Math.ceil(SECONDS / dt - 1e-9), push);
  const states = range(run.steps + 1, (row) => [inRow(run, "x", row), inRow(run, "y", row)]);
  const gone = states.findIndex((places) => places.flat().some((each) => !(Math.abs(each) < FAR)));
  if (gone >= 0) return { fate: 2, shown: states.slice(0, gone) };
  const rest = states.slice(Math.floor(LATE * states.length));
  const depths = rest.map(([x, y]) => 2 - Math.hypot(x[1] - x[0], y[1] - y[0]) / R);
  const trembling = Math.max(...depths) - Math.min(...depths);
  const larger = LARGER.find((times) => times * trembling < 1) ?? 1;
  const means = range(3, (i) => rest.reduce((sum, [x]) => sum + x[i], 0) / rest.length);
  const shown = rest.map(([x, y]) => [x.map((each, i) => means[i] + larger * (each - means[i])), y]);
  return { fate: trembling < 1e-5 ? 0 : 1, trembling, larger, shown };
}, 60);

// From which step on it is as bad as this fate, found by halving [s].
const begins = kept((fate, stiffness, late, good, bad) => {
  if (squeezed(good, stiffness, late).fate >= fate) return good;
  if (squeezed(bad, stiffness, late).fate < fate) return bad;
  while (bad > 1.02 * good) {
    const middle = Math.sqrt(good * bad);
    [good, bad] = squeezed(middle, stiffness, late).fate < fate ? [middle, bad] : [good, middle];
  }
  return bad;
});

function draw(view) {
  const { own: { dt, stiffness, late, time }, width, height } = view;
  const [low, high] = endsOf(view.own);
  const { fate, trembling, larger, shown } = squeezed(dt, stiffness, late);
  const [floor, top, middle] = [height - 104, height - 60, width / 2];
  const scale = Math.min((floor - 24) / (2.5 * R), width / 8.6 / R); // px for 1 m
  const waits = fate === 2 && time === 0 && !view.running; // until it is played one sees where it ends
  const steps = waits ? shown.length - 1 : time / dt;
  const [r, row, share] = [R * scale, Math.floor(steps), steps % 1];
  const [now, next] = [row, row + 1].map((k) => shown[k % shown.length]); // a step moves straight
  const places = range(3, (i) => [0, 1].map((k) => now[k][i] + share * (next[k][i] - now[k][i])))
    .map(([x, y]) => [middle + x * scale, floor - Math.max(R, y) * scale]);
  const finger = ([x, y], side) => [ // from its hinge over its joint to its tip
    path([[middle + 1.6 * side * r, 10], [x + 0.8 * side * r, 0.5 * (y - r)], [x, y]], "finger"),
    ball("fixed", x, y, r, "body")];
  const [cupX, cupY] = places[1];
  const at = scaleOf({ domain: [low, high], log: true }, 12, width - 12);
  const parts = [low, ...[1, 2].map((k) => begins(k, stiffness, late, low, high)), high];
  const what = { label: "the time step", value: "dt", low, high, step: 0.0001, at: at.back };
  const ticks = range(1 + Math.round(Math.log2(high / low)), (k) => low * 2 ** k);
  return {
    picture: [
      table(0, floor, width, 20), finger(places[0], -1), finger(places[2], 1),
      rect(middle - 2 * r, 2, 4 * r, 16, "body m-fixed"), ball("penalty", cupX, cupY, r),
      svg`<ellipse cx=${cupX} cy=${cupY - 0.72 * r} rx=${0.62 * r} ry=${0.15 * r} class="ground"/>`,
      FATES.map((name, k) => {
        const [from, to] = [at(parts[k]), at(parts[k + 1])];
        return [rect(from, top, to - from, 18, `fate-${k}`),
          k === fate || to - from > 6 * name.length
            ? label(name, (from + to) / 2, top + 38, "middle", k === fate ? "strong" : "tick") : ""];
      }),
      ticks.map((each) => label(ms(each), within(26, at(each), width - 26), top + 58, "middle", "tick")),
      line(at(dt), top - 8, at(dt), top + 18, "rule"), view.point(at(dt), top + 9, what),
    ],
    words: `In steps of ${ms(dt)} it ${FATES[fate]}` +
      `${fate === 1 ? `, by ${number(trembling, 2)} r` : ""}` +
      `${fate === 1 && larger > 1 ? `, drawn ${larger} times larger` : ""}.`,
  };
}

export const figure = {
  title: "A gripper that trembles",
  caption: "Two fingers squeeze a cup, in slow motion. Drag the time step.",
  height: (width) => (width < 480 ? 240 : 280),
  knobs: ({ switch: shown }) => (shown ? ["stiffness"] : []),
  start: () => ({ dt: 0.004, late: 0, switch: 0 }),
  clock({ own: { dt, stiffness, late } }) {
    const { fate, shown } = squeezed(dt, stiffness, late);
    const end = dt * shown.length;
    return { end, rate: fate < 2 ? 0.02 : end / 2, loops: true, alone: true };
  },
  play: () => "Play",
  switches: ({ switch: shown }) => (shown ? [["Force from the step’s end", "late", 1]] : []),
  draw,
};
