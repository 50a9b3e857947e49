/* The puzzle: one spring, two wishes. Every try is a drop of 40 s, run in a worker; the map of all springs
 * is shown once the reader gives up. */
import { axis, circle, decades, label, number, path, rect, steps, within } from "../draw.js";
import { criticalDt, runModel, series } from "../engine.js";
import { charted, G, R } from "../parts.js";
import { QUANTITIES, sceneOf, startOf } from "../store.js";

const DT = 0.01; // s
const SINK = 0.001; // r
const LONG = 40; // s
const { stiffness: K, damping: C } = QUANTITIES;
const LEAST = G / SINK / R; // N/m: a softer spring sinks too much

// Whether a ball dropped on this spring is at rest after LONG.
function drop({ stiffness, damping }) {
  const scene = sceneOf({ ...startOf("drop"), damping });
  const run = runModel("penalty", scene, { dt: DT, stiffness, damping }, Math.round(LONG / DT));
  const { gap, energy } = series(run, scene);
  const late = gap.subarray(gap.length - 200);
  const spread = Math.max(...late) - Math.min(...late);
  return spread < 1e-3 && energy[energy.length - 1] < 1;
}

// Where the sink is small enough, and where the step is below its critical length.
function map({ sx, sy, box }) {
  const { left, right, top, bottom } = box;
  const edge = [];
  for (let px = left; px <= right; px += 4) {
    const c = (4 - sx.back(px) * DT * DT) / (2 * DT);
    edge.push([px, within(top, sy(c), bottom)]);
  }
  return [
    path([[left, bottom], ...edge, [right, bottom]], "region"),
    rect(sx(LEAST), top, right - sx(LEAST), bottom - top, "region"),
    label("comes to rest", left + 8, bottom - 10),
    label("sinks little", sx(LEAST) + 6, top + 20),
  ].join("");
}

function draw(view) {
  const { own } = view;
  const now = { stiffness: view.get("stiffness"), damping: view.get("damping") };
  const chart = charted(view, {
    x: { ...axis([K.low, K.high], "stiffness k (N/m)", ...decades(K.low, K.high)), log: true },
    y: axis([C.low, C.high], "damping c (N s/m)", ...steps(C.low, C.high, 4)),
    under: (each) => (own.gaveUp ? map(each) : ""),
  });
  const { sx, sy } = chart;
  const rests = view.dragging ? null : view.result("drop", now);
  const same = (each) => each.stiffness === now.stiffness && each.damping === now.damping;
  if (rests !== null && !own.tries.some(same)) own.tries.push(now);
  const dot = (each, r, kind) => circle(sx(each.stiffness), sy(each.damping), r, kind);
  const set = (k, c) => {
    const stiffness = Number(within(K.low, k, K.high).toPrecision(3));
    view.set({ stiffness, damping: within(C.low, Math.round(c), C.high) });
  };
  const longest = number(criticalDt(1, LEAST, 0).undamped, 2);
  const told = [
    `It sinks ${number(G / now.stiffness / R, 2)} r; less than ${SINK} is wanted.`,
    rests === null ? "" : rests ? "It comes to rest." : "It never comes to rest.",
    own.gaveUp ? `To sink so little k must be above ${number(LEAST)} N/m, and there the longest` : "",
    own.gaveUp ? `step is below ${longest} s, with any damper. The two regions do not meet.` : "",
  ];
  const spring = {
    name: "spring",
    ...{ x: sx(now.stiffness), y: sy(now.damping), r: 16, value: now.stiffness },
    label: "the spring: stiffness and damping",
    text: `k ${number(now.stiffness)} N/m, c ${number(now.damping)} N s/m`,
    drag: (x, y) => set(sx.back(x), sy.back(y)),
    nudge: (dx, dy) => set(view.get("stiffness") * 1.05 ** dx, view.get("damping") - 2 * dy),
  };
  return {
    svg: chart.svg + own.tries.map((each) => dot(each, 6, "look m-penalty")).join("") + dot(now, 6, "dot"),
    words: told.filter(Boolean).join(" "),
    handles: [spring],
  };
}

export const figure = {
  title: "A puzzle: one spring, two wishes",
  caption:
    "Find a spring on which the ball sinks less than a thousandth of its radius and still comes to rest " +
    "at a time step of 0.01 s. Each try is a drop of 40 s.",
  height: 300,
  knobs: ["stiffness", "damping"],
  start: () => ({ tries: [], gaveUp: false }),
  buttons: [
    {
      label: ({ own }) => (own.gaveUp ? "Hide the map" : "I think there is none: show why"),
      press: ({ own }) => (own.gaveUp = !own.gaveUp),
    },
  ],
  jobs: { drop },
  draw,
};
