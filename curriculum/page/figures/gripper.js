/* Two fingers squeeze a cup, as in exercise 8: three balls by penalty, of which two have motors.
 * With map=1 time step and stiffness can be chosen in a field of what becomes of it, and the
 * spring's force be taken from the end of the step. Values: what it does, how deep the left finger
 * is in the cup at the worst and by how much that trembles in the last quarter [r]. */
import { ball, circle, clipped, label, line, number, path, plot, rect, svg } from "../draw.js";
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

// What becomes of it over the field, a fate a cell; `share` of the way between two ends.
const [COLUMNS, ROWS] = [18, 11];
const share = ([low, high], at) => low * (high / low) ** at;
const field = kept((late) =>
  Array.from({ length: COLUMNS * ROWS }, (_, cell) => {
    const [i, j] = [cell % COLUMNS, Math.floor(cell / COLUMNS)].map((k) => k + 0.5);
    return squeezed(share(DT, i / COLUMNS), share(K, j / ROWS), late, 0.6).fate;
  }));

// Fingers and cup over the table, and where the left one touches it.
function picture({ n, x, y }, row, { width, floor }) {
  const scale = (width / 2 - 4) / (SEEN + R); // px for 1 m
  const r = R * scale;
  const places = Array.from({ length: n }, (_, i) =>
    [width / 2 + x[n * row + i] * scale, floor - Math.max(R, y[n * row + i]) * scale]);
  const [[leftX, leftY], [cupX, cupY], [rightX, rightY]] = places;
  return { touch: [(leftX + cupX) / 2, cupY], drawn: [
    table(0, floor, width, 24),
    rect(0, leftY - 0.3 * r, leftX, 0.6 * r, "arm"),
    rect(rightX, rightY - 0.3 * r, width - rightX, 0.6 * r, "arm"),
    places.map(([px, py], i) => ball(i === 1 ? "penalty" : "fixed", px, py, r, "plainly ball")),
    svg`<ellipse cx=${cupX} cy=${cupY - 0.72 * r} rx=${0.62 * r} ry=${0.15 * r} class="cup"/>`,
  ] };
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

function choices(view, top) {
  const { own } = view;
  const { sx, sy, box, picture } = plot(view, {
    top, x: timeSteps(...DT), y: { ...tens(4, 6, "stiffness k (N/m)"), domain: K },
  });
  const cells = field(own.late).map((each, cell) => {
    const [i, j] = [cell % COLUMNS, Math.floor(cell / COLUMNS)];
    const [x0, x1] = [i, i + 1].map((k) => sx(share(DT, k / COLUMNS)));
    const [y0, y1] = [j + 1, j].map((k) => sy(share(K, k / ROWS)));
    return each ? rect(x0, y0, x1 - x0, y1 - y0, `fate-${each}`) : "";
  });
  const limit = Array.from({ length: 40 }, (_, at) => share(K, at / 39))
    .map((k) => [critical_dt(MASS[0], k, DAMPING), k])
    .filter(([dt]) => dt > DT[0] && dt < DT[1]).map(([dt, k]) => [sx(dt), sy(k)]);
  const what = {
    label: "time step and stiffness", value: ["dt", "stiffness"], low: [DT[0], K[0]],
    high: [DT[1], K[1]], step: [0.0002, 2000], at: (x, y) => [sx.back(x), sy.back(y)],
    also: { time: 0 }, release: () => view.play(0),
  };
  const names = own.late ? [["holds", 0.2, 0.4]]
    : [["holds", 0.08, 0.86], ["trembles", 0.6, 0.8], ["flies apart", 0.7, 0.25]];
  return [
    cells, picture, own.late ? "" : path(limit, "rule"),
    names.map(([name, across, down]) => label(name, box.left + across * (box.right - box.left),
      box.top + down * (box.bottom - box.top))),
    view.point(sx(own.dt), sy(own.stiffness), what),
  ];
}

function draw(view) {
  const { own, width } = view;
  const run = squeezed(own.dt, own.stiffness, own.late);
  const { fate, deepest, trembling } = run;
  const begins = own.map && (own.time > 0 || fate === 2) ? 0 : LATE; // s
  const row = Math.min(run.last, Math.floor((begins + own.time) / own.dt));
  const narrow = width < 480;
  const place = narrow ? { width, floor: 104 } : { width: 0.56 * width, floor: 180 };
  const { drawn, touch } = picture(run.run, row, place);
  const [x, y, size] = narrow ? [width / 2, 236, 90]
    : [0.79 * width, 138, Math.min(124, 0.2 * width)];
  const moves = fate === 1 ? `, by ${number(trembling, 2)} r` : "";
  const told = fate === 2 ? "it flies apart"
    : `it ${FATES[fate]}${moves}; finger and cup overlap by ${number(deepest, 2)} r`;
  const [ms, k] = [1000 * own.dt, own.stiffness].map((each) => number(each, 2));
  return {
    picture: [
      clipped(0, 0, place.width, place.floor + 24, drawn),
      line(...touch, x - (narrow ? 0 : size), y - (narrow ? size : 0), "grid"),
      lens(x, y, size, run, row),
      own.map ? choices(view, narrow ? 360 : 300) : "",
    ],
    words: `dt = ${ms} ms, k = ${k} N/m${own.late ? ", force from the end" : ""}: ${told}.`,
    values: { does: FATES[fate], deepest, trembling, row },
  };
}

export const figure = {
  title: "A gripper that trembles",
  caption: "Two fingers squeeze a cup, in slow motion; the lens shows where the left touches it.",
  height: (width, { map } = {}) => (width < 480 ? 352 : 290) + (map ? 260 : 0),
  start: () => ({ dt: 0.004, map: 0, late: 0 }),
  clock({ own: { dt, stiffness, late, map } }) {
    if (!map) return { end: SECONDS - LATE, rate: 0.04, loops: true, alone: true };
    return { end: Math.min(SECONDS, squeezed(dt, stiffness, late).last * dt), rate: 0.1 };
  },
  play: ({ map }) => (map ? "Squeeze" : "Play"),
  buttons: ({ own }) => {
    const change = () => Object.assign(own, { late: 1 - own.late, time: 0 });
    return own.map ? [["Force from the end of the step", change, String(Boolean(own.late))]] : [];
  },
  draw,
};
