/* Two fingers squeeze a cup, as in exercise 8: three balls by penalty, of which two have motors. On
 * the first screen it plays by itself; later time step and stiffness can be dragged, too, and the
 * spring's force can be taken from the end of the step. */
import { axis, ball, circle, clipped, el, label, line, number, path, plot, rect } from "../draw.js";
import { table, within } from "../draw.js";
import { criticalDt, runModel, series, stateAt } from "../engine.js";
import { grip, kept, pair, R, scene, tens, through } from "../kit.js";

const [AT, MASS, MOTOR] = [[-0.205, 0, 0.205], [0.2, 1, 0.2], [20, 0, -20]]; // m, kg, N
const [DAMPING, SECONDS, LATE] = [80, 1, 0.75]; // N s/m, s, s: what is judged comes after it
const [GROUND, TOP, TIMES] = [24, 190, 60]; // px of table, px of the picture; of the lens
const [DT, K] = [[0.0005, 0.008], [3000, 1e6]]; // s, N/m: what can be set
const APART = 1; // m: what has flown so far is seen there before it is played
const NAMES = ["the left finger", "the cup", "the right finger"];
const PLACES = { x0: AT[0], x1: AT[1], x2: AT[2] };
const start = () => ({ ...PLACES, time: null, tries: [], late: false });

const tellsOf = (dt, k, late) =>
  `dt = ${number(1000 * dt, 2)} ms, k = ${number(k, 2)} N/m${late ? ", force from the end" : ""}`;

// The run, its deepest overlap row by row [r], and what happens in the last quarter; `late`: with
// the force from the end of the step.
const squeezed = kept((dt, stiffness, late, ...x) => {
  const all = scene([R, R, R], { x, mass: MASS, motor: MOTOR });
  const steps = Math.ceil(SECONDS / dt - 1e-9);
  const model = late ? "implicit" : "penalty";
  const run = runModel(model, all, { dt, stiffness, damping: DAMPING }, steps);
  const depths = series(run, all).gap.map((gap) => Math.max(0, -gap));
  const last = depths.subarray(Math.floor(LATE * (steps + 1)));
  const deepest = Math.max(...last);
  const trembling = deepest - Math.min(...last);
  const held = stateAt(run, steps).x.every((each) => Math.abs(each) < 0.3);
  const gone = run.x.findIndex((each) => Math.abs(each) > APART); // ball by ball
  const until = gone < 0 ? SECONDS : dt * Math.floor(gone / 3);
  const does = held ? (trembling < 1e-5 ? "holds still" : "trembles") : "is gone";
  return { run, depths, deepest, trembling, does, until };
});

// Where finger and cup meet, enlarged: how far they overlap.
function lens(x, y, size, r, depth) {
  const [far, half] = [r * TIMES, 0.5 * depth * r * TIMES];
  const edge = (model, side) => ball(model, x + side * (far - half), y, far, "magnified");
  const seen = through(x, y, size, edge("fixed", -1), edge("penalty", 1));
  return seen + label(`× ${TIMES}`, x + size + 6, y + 5, "start", "tick");
}

// Fingers and cup over the table; from further away, with a scale, where they have flown apart.
function picture({ own, width }, { run, depths, until }) {
  const late = LATE + ((own.time - LATE) % (SECONDS - LATE)); // over and over
  const time = own.time <= SECONDS ? (own.time ?? until) : late;
  const row = Math.min(run.steps, Math.round(time / run.dt));
  const seen = (all) => Array.from(all.subarray(0, 3 * row + 3), (each) => (each < 1e9 ? each : 0));
  const [xs, ys] = [seen(run.x), seen(run.y)]; // until now
  const [far, high] = [xs, ys].map((all) => Math.max(0.3, ...all.map(Math.abs)));
  const floor = TOP - 14 - GROUND;
  const scale = Math.min(360, (width / 2 - 8) / (far + R), (floor - 8) / (high + R)); // px for 1 m
  const r = Math.max(9, R * scale); // what has flown far is still seen
  const place = (_, k) => [width / 2 + xs[k] * scale, floor - Math.max(R, ys[k]) * scale];
  const places = xs.map(place);
  const at = places.slice(-3);
  const trail = (i) => path(places.filter((_, k) => k % 3 === i), "line m-fixed thin");
  const arm = ([tip, up], side) => rect(side < 0 ? -9 : tip, up - 0.3 * r, width, 0.6 * r, "arm");
  const ten = 10 ** Math.floor(Math.log10((0.3 * width) / scale)); // m
  const ruler = label(`${number(ten, 1)} m`, 8, 20) + line(8, 28, 8 + ten * scale, 28, "rule");
  const arms = clipped(0, 0, at[0][0], TOP, arm(at[0], -1)) + arm(at[2], 1);
  const [cupX, cupY] = at[1];
  const touch = (at[0][0] + cupX) / 2;
  const rim = { cx: cupX, cy: cupY - 0.72 * r, rx: 0.62 * r, ry: 0.15 * r, class: "cup" };
  const drawn = [
    table(0, floor, width, GROUND),
    far > 0.3 ? ruler + [0, 1, 2].map(trail).join("") : arms,
    ...at.map(([x, y], i) => ball(i === 1 ? "penalty" : "fixed", x, y, r, "ball plainly")),
    el("ellipse", rim),
    far > 0.3 ? "" : line(touch, cupY, 52, 50) + lens(52, 50, 44, r, depths[row]),
  ];
  return { svg: clipped(0, 0, width, TOP - 14, ...drawn), at, r, scale };
}

// Time step and stiffness: what can be set, what was tried, and from where on a finger trembles.
function choices(view, dt, k, does) {
  const { own, width, height } = view;
  const { late } = own;
  const ticks = [0.5, 1, 2, 4, 8].map((ms) => [ms / 1000, String(ms)]);
  const ks = Array.from({ length: 25 }, (_, i) => K[0] * (K[1] / K[0]) ** (i / 24));
  const limits = ks.map((k) => criticalDt(MASS[0], k, DAMPING).damped);
  const { svg, sx, sy } = plot([0, TOP, width, height - TOP], {
    x: { ...axis(DT, "time step dt (ms)", ...ticks), log: true },
    y: { ...tens(4, 6), domain: K, label: "stiffness k (N/m)" },
    lines: late ? [] : [{ model: "fixed", xs: limits, ys: ks, kind: "plainly" }],
  });
  const same = (each) => each.dt === dt && each.k === k && each.late === late;
  if (!view.dragging && !own.tries.some(same)) own.tries.push({ dt, k, late, does });
  const [limit, edge] = [ks.findIndex((k) => k > 2e5), { "holds still": "dot", trembles: "look" }];
  const at = (step, stiff) => [sx(within(DT[0], step, DT[1])), sy(within(K[0], stiff, K[1]))];
  const tried = own.tries.filter((each) => each.late === late).map(({ dt, k, does }) => {
    const [x, y] = at(dt, k);
    return edge[does] ? circle(x, y, 6, `${edge[does]} m-penalty`) : label("×", x, y + 6, "middle");
  });
  const beyond = late ? "" : label("critical step", sx(limits[limit]) + 8, sy(ks[limit]));
  const named = ["time step and stiffness", tellsOf(dt, k, late)];
  const to = { at: (x, y) => [sx.back(x), sy.back(y)], px: 8, digits: 2 };
  const knob = pair(view, "choice", at(dt, k), ...named, { dt: DT, stiffness: K }, to);
  return { svg: svg + beyond + tried.join(""), knob };
}

// `small`: without what can be chosen, and it plays by itself where things may move.
function drawn(view, small) {
  const { own } = view;
  const [dt, k] = [view.get("dt"), view.get("stiffness")];
  const run = squeezed(dt, k, own.late, own.x0, own.x1, own.x2);
  const { does, deepest, trembling } = run;
  const { svg, at, r, scale } = picture(view, run);
  const { svg: map, knob } = small ? { svg: "" } : choices(view, dt, k, does);
  if (small && own.time === null && view.near && !view.still) view.play();
  const hold = ([x, y], i) => {
    const range = { r, low: AT[i] - 0.03, high: AT[i] + 0.03, step: 0.002, release: view.play };
    const text = `starts at ${number(own[`x${i}`], 3)} m`;
    return grip(view, `x${i}`, x, y, NAMES[i], text, { ...range, by: (dx) => dx / scale });
  };
  const moves = does === "trembles" ? ` by ${number(trembling, 2)} r` : "";
  const began = [own.x1 - own.x0, own.x2 - own.x1].map((far) => number(1000 * (far - 2 * R), 2));
  const holds = `it overlaps by ${number(deepest, 2)} r and ${does}${moves}`;
  return {
    svg: svg + map,
    words:
      `${tellsOf(dt, k, own.late)}: ${does === "is gone" ? "fingers and cup fly apart" : holds}. ` +
      `The gaps at the start are ${began.join(" and ")} mm.`,
    handles: at.map(hold).concat(knob ?? []),
    lit: own.late ? ["softness"] : [],
  };
}

const promise = {
  title: "A gripper that trembles",
  caption: "Two fingers squeeze a cup, in slow motion; the lens shows where the left one touches.",
  height: TOP - 14,
  start,
  clock: () => ({ from: LATE, end: 1e6, rate: 0.04, name: "Play" }),
  draw: (view) => drawn(view, true),
};

const gripper = {
  title: "A gripper",
  caption:
    "It holds still, trembles or flies apart: drag time step and stiffness, push the fingers or " +
    "the cup, and take the springs’ force from the end of the step.",
  height: 440,
  start,
  clock: () => ({ end: SECONDS, rate: 0.1, name: "Squeeze" }),
  buttons: [
    [
      ({ own }) => `Force from the ${own.late ? "beginning" : "end"} of the step`,
      ({ own }) => (own.late = !own.late),
    ],
  ],
  draw: (view) => drawn(view, false),
};

export const figures = { promise, gripper };
