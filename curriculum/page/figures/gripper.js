/* A gripper whose fingers tremble, as in exercise 8, drawn so that one sees it: three balls by
 * penalty, of which two have motors, each LARGER times as far from its mean place as it is. Below
 * it all time steps, in three parts: it holds, trembles, flies apart. With switch=1 the spring's
 * force may be taken from the end of the step. Values: what it does, how deep the left finger is in
 * the cup, by how much that trembles [r], and where the parts begin [s]. */
import { ball, label, line, ms, number, range, rect, svg, table, within } from "../draw.js";
import { column, kept, R, record } from "../runs.js";

const [AT, MASS, MOTOR] = [[-0.205, 0, 0.205], [0.2, 1, 0.2], [20, 0, -20]]; // m, kg, N
const [SECONDS, LATE] = [1, 0.75]; // s; judged is what comes after this share
const endsOf = ({ switch: shown }) => (shown ? [0.0002, 0.016] : [0.002, 0.008]); // s
const [LARGER, FAR, DAMPING] = [80, 0.5, 80]; // times; m: farther away it has flown apart; N s/m
const FATES = ["holds still", "trembles", "flies apart"];

const squeezed = kept((dt, stiffness, late) => {
  const balls = column([R, R, R], { x: AT, mass: MASS });
  const push = () => balls.forEach((each, i) => (each.fx = MOTOR[i]));
  const knobs = { dt, stiffness, damping: DAMPING };
  const { x, y, steps } = record(late ? "implicit" : "penalty", balls, knobs,
    Math.ceil(SECONDS / dt - 1e-9), push);
  const from = Math.floor(LATE * steps);
  const rows = range(steps - from, (k) => [0, 1, 2].map((i) => x[3 * (from + k) + i]));
  const means = [0, 1, 2].map((i) => rows.reduce((sum, row) => sum + row[i], 0) / rows.length);
  const depths = rows.map((_, k) => {
    const at = 3 * (from + k);
    return 2 - Math.hypot(x[at + 1] - x[at], y[at + 1] - y[at]) / R;
  });
  const [deepest, least] = [Math.max(...depths), Math.min(...depths)];
  const gone = x.findIndex((each, k) => !(Math.abs(each) < FAR && y[k] < FAR));
  const fate = gone >= 0 ? 2 : deepest - least < 1e-5 ? 0 : 1;
  const flight = range(Math.ceil(gone / 3), (row) => [x, y].map((all) => all.slice(3 * row, 3 * row + 3)));
  return { rows, means, deepest, trembling: deepest - least, fate, flight };
}, 60);

// Where it begins to be as bad as this fate, found by halving [s].
const begins = kept((fate, stiffness, late, good, bad) => {
  if (squeezed(good, stiffness, late).fate >= fate) return good;
  if (squeezed(bad, stiffness, late).fate < fate) return bad;
  while (bad > 1.02 * good) {
    const middle = Math.sqrt(good * bad);
    [good, bad] = squeezed(middle, stiffness, late).fate < fate ? [middle, bad] : [good, middle];
  }
  return bad;
});

// Where the three are drawn [m], [[x, y]]: between two rows on the straight way that the step takes.
function placesOf({ rows, means, fate, flight }, time, dt) {
  const [row, share] = [Math.floor(time / dt), (time / dt) % 1];
  if (fate < 2) {
    const [now, next] = [rows[row % rows.length], rows[(row + 1) % rows.length]];
    return means.map((mean, i) => [mean + LARGER * (now[i] + share * (next[i] - now[i]) - mean), R]);
  }
  const [now, next] = [row, row + 1].map((k) => flight[Math.min(k, flight.length - 1)]);
  const at = (part, i) => now[part][i] + share * (next[part][i] - now[part][i]);
  return means.map((_, i) => [at(0, i), Math.max(R, at(1, i))]);
}

function draw(view) {
  const { own: { dt, stiffness, late, time }, width, height } = view;
  const [low, high] = endsOf(view.own);
  const seen = squeezed(dt, stiffness, late);
  const { deepest, trembling, fate } = seen;
  const [floor, top, middle] = [height - 104, height - 60, width / 2];
  const scale = Math.min((floor - 24) / (2.2 * R), width / 8.6 / R); // px for 1 m
  const r = R * scale;
  const places = placesOf(seen, time, dt).map(([x, y]) => [middle + x * scale, floor - y * scale]);
  const finger = ([x, y]) => [
    rect(x - 0.25 * r, 14, 0.5 * r, y - 14, "arm"), ball("fixed", x, y, r, "body"),
  ];
  const at = (step) => 12 + ((width - 24) * Math.log(step / low)) / Math.log(high / low);
  const parts = [low, ...[1, 2].map((k) => begins(k, stiffness, late, low, high)), high];
  const what = { label: "the time step", value: "dt", low, high, step: 0.0001,
    at: (x) => low * (high / low) ** within(0, (x - 12) / (width - 24), 1) };
  return {
    picture: [
      table(0, floor, width, 20),
      [places[0], places[2]].map(finger), rect(middle - 4.2 * r, 4, 8.4 * r, 14, "arm"),
      ball("penalty", ...places[1], r),
      svg`<ellipse cx=${places[1][0]} cy=${places[1][1] - 0.72 * r} rx=${0.62 * r} ry=${0.15 * r}
        class="cup"/>`,
      FATES.map((name, k) => {
        const [from, to] = [at(parts[k]), at(parts[k + 1])];
        return [rect(from, top, to - from, 18, `fate-${k}`), k === fate || to - from > 6 * name.length
          ? label(name, (from + to) / 2, top + 38, "middle", k === fate ? "strong" : "tick") : ""];
      }),
      [0.0002, 0.0005, 0.001, 0.002, 0.004, 0.008, 0.016].map((each) => (each < low || each > high ? ""
        : label(ms(each), within(26, at(each), width - 26), top + 58, "middle", "tick"))),
      line(at(dt), top - 8, at(dt), top + 18, "rule"), view.point(at(dt), top + 9, what),
    ],
    words: `In steps of ${ms(dt)} it ${FATES[fate]}` +
      `${fate === 1 ? `, by ${number(trembling, 2)} r, drawn ${LARGER} times larger` : ""}.`,
    values: { does: FATES[fate], deepest, trembling, parts },
  };
}

export const figure = {
  title: "A gripper that trembles",
  caption: ({ stiffness }) => `Two fingers squeeze a cup, in slow motion: ` +
    `${stiffness.toLocaleString("en")} N/m. Drag the step.`,
  height: (width) => (width < 480 ? 240 : 280),
  knobs: ({ switch: shown }) => (shown ? ["stiffness"] : []),
  start: () => ({ dt: 0.004, late: 0, switch: 0 }),
  clock({ own: { dt, stiffness, late } }) {
    const { fate, flight } = squeezed(dt, stiffness, late);
    const end = fate < 2 ? 0.25 : dt * flight.length;
    return { end, rate: fate < 2 ? 0.02 : end / 2, loops: true, alone: true };
  },
  play: () => "Play",
  switches: ({ switch: shown }) => (shown ? [["Force from the step’s end", "late", 1]] : []),
  draw,
};
