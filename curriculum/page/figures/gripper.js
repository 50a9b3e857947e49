/* Two fingers squeeze a cup, as in exercise 8: three balls by penalty, of which two have motors.
 * With map=1 time step and stiffness can be chosen in a map of what becomes of it, and the
 * spring's force be taken from the end of the step. Values: what it does, how deep the left finger
 * is in the cup at the worst and by how much that trembles in the last quarter [r]. */
import { area, ball, circle, clipped, label, line, number, plot, rect, svg } from "../draw.js";
import { table, tens, through, timeSteps, within } from "../draw.js";
import { critical_dt } from "../contact.js";
import { column, kept, R, record } from "../runs.js";

const [AT, MASS, MOTOR] = [[-0.205, 0, 0.205], [0.2, 1, 0.2], [20, 0, -20]]; // m, kg, N
const [DAMPING, SECONDS, LATE] = [80, 1, 0.75]; // N s/m, s; what is judged comes after this share
const [DT, K] = [[0.0005, 0.008], [3000, 1e6]]; // s, N/m: what can be chosen
const SEEN = 0.32; // m: who is further away has flown apart
const FATES = ["holds still", "trembles", "flies apart"];

// The run, how deep finger and cup are in one another, row by row [r], what happens in the end, and
// `last`, the row up to which all can be seen.
const squeezed = kept((dt, stiffness, late, seconds = SECONDS) => {
  const balls = column([R, R, R], { x: AT, mass: MASS });
  const push = () => balls.forEach((ball, i) => (ball.fx = MOTOR[i]));
  const [knobs, count] = [{ dt, stiffness, damping: DAMPING }, Math.ceil(seconds / dt - 1e-9)];
  const run = record(late ? "implicit" : "penalty", balls, knobs, count, push);
  const { n, x, y, steps } = run;
  const depths = Array.from({ length: steps + 1 }, (_, row) => {
    const [dx, dy] = [x[n * row + 1] - x[n * row], y[n * row + 1] - y[n * row]];
    return 2 - Math.sqrt(dx * dx + dy * dy) / R;
  });
  const end = depths.slice(Math.floor(LATE * (steps + 1)));
  const [most, least] = [Math.max(...end), Math.min(...end)];
  const gone = x.findIndex((each, k) => !(Math.abs(each) < SEEN && y[k] < SEEN));
  const fate = gone >= 0 ? 2 : most - least < 1e-5 ? 0 : 1;
  const last = gone < 0 ? steps : Math.floor(gone / n);
  return { run, depths, deepest: most, trembling: most - least, fate, last };
});

// Where the map's parts begin: [stiffness, time steps from which on it trembles and flies apart],
// found by halving, near the critical step of a finger.
const borders = kept((late) =>
  Array.from({ length: 12 }, (_, at) => {
    const stiffness = K[0] * (K[1] / K[0]) ** (at / 11);
    const critical = critical_dt(MASS[0], stiffness, DAMPING);
    const fate = (dt) => squeezed(dt, stiffness, late, 0.6).fate;
    const from = (worse, low) => {
      let [good, bad] = [low, 2 * critical];
      if (fate(bad) < worse) return Infinity;
      while (bad > 1.04 * good) {
        const middle = 0.5 * (good + bad);
        [good, bad] = fate(middle) < worse ? [middle, bad] : [good, middle];
      }
      return bad;
    };
    const trembles = from(1, 0.9 * critical);
    return [stiffness, trembles, trembles < Infinity ? from(2, 0.97 * trembles) : Infinity];
  }));

// Fingers and cup over the table, and where the left one touches it.
function picture({ n, x, y }, row, width, middle) {
  const scale = (width / 2 - 4) / (SEEN + R); // px for 1 m
  const [r, floor] = [R * scale, middle + R * scale];
  const places = Array.from({ length: n }, (_, i) =>
    [width / 2 + x[n * row + i] * scale, floor - Math.max(R, y[n * row + i]) * scale]);
  const [[leftX, leftY], [cupX, cupY], [rightX, rightY]] = places;
  return { touch: [(leftX + cupX) / 2, cupY], drawn: clipped(0, 0, width, floor + 24,
    table(0, floor, width, 24),
    rect(0, leftY - 0.3 * r, leftX, 0.6 * r, "arm"),
    rect(rightX, rightY - 0.3 * r, width - rightX, 0.6 * r, "arm"),
    places.map(([px, py], i) => ball(i === 1 ? "penalty" : "fixed", px, py, r, "plainly ball")),
    svg`<ellipse cx=${cupX} cy=${cupY - 0.72 * r} rx=${0.62 * r} ry=${0.15 * r} class="cup"/>`,
  ) };
}

/* Where the left finger touches the cup, enlarged so much that the overlap fills it: the cup's edge
 * stays, the finger's trembles, and the trail of its last places stays with it. */
function lens(x, y, size, { depths, fate, ...late }, row) {
  const { deepest, trembling } = fate === 2 ? { deepest: 0.15, trembling: 0 } : late;
  const times = Math.min(0.9 / Math.max(deepest, 1e-6),
    0.5 / Math.max(trembling, 1e-9)) * size; // px for 1 r
  const edge = x - 0.5 * Math.min(0.9 * size, deepest * times);
  const tip = (k) => edge + within(-size, depths[k] * times, 2 * size);
  const big = 40 * size;
  const before = [8, 6, 4, 2].filter((back) => row >= back).map((back) =>
    line(tip(row - back), y - size, tip(row - back), y + size, "trail"));
  return [
    through(x, y, size, circle(edge + big, y, big, "magnified m-penalty"),
      circle(tip(row) - big, y, big, "magnified m-fixed"), before),
    label(`× ${number(times / 40, 2)}`, x, y + size + 20, "middle", "tick"),
  ];
}

function map(view, top) {
  const { own } = view;
  const { sx, sy, box, picture } = plot(view, {
    top, x: timeSteps(...DT), y: { ...tens(4, 6, "stiffness k (N/m)"), domain: K },
  });
  const parts = [1, 2].map((fate) =>
    area([[box.right, box.bottom], ...borders(own.late).map((border) =>
      [sx(Math.min(DT[1], border[fate])), sy(border[0])]), [box.right, box.top]], `fate-${fate}`));
  const what = {
    label: "time step and stiffness", value: ["dt", "stiffness"], low: [DT[0], K[0]],
    high: [DT[1], K[1]], step: [0.0002, 2000], at: (x, y) => [sx.back(x), sy.back(y)],
    also: { time: 0 }, release: () => view.play(0),
  };
  const names = own.late ? [["holds", 0.2, 0.4]]
    : [["holds", 0.08, 0.86], ["trembles", 0.58, 0.86], ["flies apart", 0.7, 0.25]];
  return [
    parts, picture,
    names.map(([name, across, down]) => label(name, box.left + across * (box.right - box.left),
      box.top + down * (box.bottom - box.top))),
    view.point(sx(own.dt), sy(own.stiffness), what),
  ];
}

const sizeOf = (width) => Math.min(124, 0.2 * width); // px, of the lens

function draw(view) {
  const { own, width } = view;
  const run = squeezed(own.dt, own.stiffness, own.late);
  const { fate, deepest, trembling } = run;
  const begins = own.map && (own.time > 0 || fate === 2) ? 0 : LATE; // s
  const row = own.time === 0 && fate === 2 ? run.last // where it ends, until it is played
    : Math.min(run.last, Math.floor((begins + own.time) / own.dt));
  const size = sizeOf(width);
  const [x, y] = [width - size - 8, size + 12];
  const { drawn, touch } = picture(run.run, row, x - size - 16, y);
  const told = fate === 2 ? FATES[2]
    : `${FATES[fate]}${fate ? `, by ${number(trembling, 2)} r` : ""}; finger and cup overlap by ` +
      `${number(deepest, 2)} r`;
  return {
    picture: [
      drawn, line(...touch, x - size, y, "grid"), lens(x, y, size, run, row),
      own.map ? map(view, 2 * size + 50) : "",
    ],
    words: `${number(1000 * own.dt, 2)} ms, ${number(own.stiffness, 2)} N/m: it ${told}.`,
    values: { does: FATES[fate], deepest, trembling, row },
  };
}

export const figure = {
  title: "A gripper that trembles",
  caption: "Two fingers squeeze a cup, in slow motion; the lens shows where the left touches it.",
  height: (width, { map: shown } = {}) => 2 * sizeOf(width) + (shown ? 302 : 42),
  start: () => ({ dt: 0.004, map: 0, late: 0 }),
  clock({ own: { dt, stiffness, late, map: shown } }) {
    if (!shown) return { end: SECONDS - LATE, rate: 0.04, loops: true, alone: true };
    const end = Math.min(SECONDS, squeezed(dt, stiffness, late).last * dt);
    return { end, rate: Math.min(0.1, end / 2) }; // two seconds at least
  },
  play: (own) => (own.map ? "Squeeze" : "Play"),
  buttons: ({ own }) => {
    const change = () => Object.assign(own, { late: 1 - own.late, time: 0 });
    return own.map ? [["Force from the step’s end", change, String(Boolean(own.late))]] : [];
  },
  draw,
};
