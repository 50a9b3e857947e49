/* The puzzle: one spring, two wishes. Every try is a drop of 40 s, run in a worker; the map of all springs
 * is shown once the reader gives up. */
import { decades, el, number, plot, steps } from "../draw.js";
import { GRAVITY, criticalDt, runModel, series } from "../engine.js";
import { data } from "../data.js";
import { QUANTITIES, fitting, sceneOf, startOf } from "../store.js";

const DT = 0.01; // s
const SINK = 0.001; // r
const LONG = 40; // s
const K = QUANTITIES.stiffness;
const C = QUANTITIES.damping;

// Whether a ball dropped on this spring is at rest after LONG.
function drop({ stiffness, damping }) {
  const scene = sceneOf({ ...startOf("drop"), damping });
  const run = runModel("penalty", scene, { dt: DT, stiffness, damping }, Math.round(LONG / DT));
  const { gap, energy } = series(run, scene);
  const late = gap.subarray(gap.length - 200);
  const spread = Math.max(...late) - Math.min(...late);
  return { rests: Number.isFinite(spread) && spread < 1e-3 && energy[energy.length - 1] < 1 };
}

const keyOf = (view) => ({ stiffness: view.get("stiffness"), damping: view.get("damping") });

function chartOf(view) {
  return plot({
    id: "puzzle",
    width: view.width,
    height: view.height,
    x: { domain: [K.low, K.high], log: true, ticks: decades(K.low, K.high), label: "stiffness k (N/m)" },
    y: { domain: [C.low, C.high], ticks: steps(C.low, C.high, 4), label: "damping c (N s/m)" },
  });
}

// Where the sink is small enough, and where the step is below its critical length.
function map({ sx, sy, box }) {
  const least = -GRAVITY / (SINK * data.radius);
  const edge = [];
  for (let px = box.left; px <= box.right; px += 4) {
    const k = K.low * (K.high / K.low) ** ((px - box.left) / (box.right - box.left));
    const c = (4 - k * DT * DT) / (2 * DT);
    edge.push(`${px} ${c > 0 ? Math.max(sy(Math.min(c, C.high)), box.top) : box.bottom}`);
  }
  const stable = `M${box.left} ${box.bottom}L${edge.join("L")}L${box.right} ${box.bottom}Z`;
  const deep = { x: sx(least), y: box.top, width: box.right - sx(least), height: box.bottom - box.top };
  return (
    el("path", { d: stable, class: "region" }) +
    el("rect", { ...deep, class: "region" }) +
    el("text", { x: box.left + 8, y: box.bottom - 10, class: "tick strong" }, "comes to rest") +
    el("text", { x: sx(least) + 6, y: box.top + 20, class: "tick strong" }, "sinks little")
  );
}

const dot = (chart, { stiffness, damping }, kind) => el("circle", { cx: chart.sx(stiffness), cy: chart.sy(damping), r: 6, class: kind });

function move(view, k, c) {
  view.set({ stiffness: fitting(K, Number(k.toPrecision(3))), damping: fitting(C, Math.round(c)) });
}

export const figure = {
  title: "A puzzle: one spring, two wishes",
  caption: "Find a spring on which the ball sinks less than a thousandth of its radius and still comes to rest at a time step of 0.01 s. Each try is a drop of 40 s.",
  height: 300,
  knobs: ["stiffness", "damping"],
  start: () => ({ tries: [], gaveUp: false }),
  buttons: [
    {
      label: (view) => (view.own.gaveUp ? "Hide the map" : "I think there is none: show why"),
      press: (view) => (view.own.gaveUp = !view.own.gaveUp),
    },
  ],
  jobs: { drop },
  draw(view) {
    const { own } = view;
    const now = keyOf(view);
    const chart = chartOf(view);
    const found = view.coarse ? null : view.result("drop", now);
    const same = (each) => each.stiffness === now.stiffness && each.damping === now.damping;
    if (found && !own.tries.some(same)) own.tries.push(now);
    const sink = `It sinks ${number(-GRAVITY / now.stiffness / data.radius, 2)} r; less than ${SINK} is wanted.`;
    const rest = found ? `${found.rests ? "It comes to rest." : "It never comes to rest."}` : "";
    const why = own.gaveUp
      ? " To sink so little k must be above 98,100 N/m, and there the longest step is below " +
        `${number(criticalDt(1, 98100, 0).undamped, 2)} s, with any damper. The two regions do not meet.`
      : "";
    const tried = own.tries.map((each) => dot(chart, each, "look m-penalty")).join("");
    const text = `k ${number(now.stiffness)} N/m, c ${number(now.damping)} N s/m`;
    const [x, y] = [chart.sx(now.stiffness), chart.sy(now.damping)];
    return {
      svg: (own.gaveUp ? map(chart) : "") + chart.markup + tried + dot(chart, now, "dot"),
      words: `${sink} ${rest}${why}`,
      handles: [
        { name: "spring", x, y, r: 16, label: "the spring: stiffness and damping", value: now.stiffness, text },
      ],
    };
  },
  drag(view, name, x, y) {
    const { box } = chartOf(view);
    const share = (x - box.left) / (box.right - box.left);
    move(view, K.low * (K.high / K.low) ** share, C.low + ((box.bottom - y) / (box.bottom - box.top)) * (C.high - C.low));
  },
  nudge(view, name, dx, dy) {
    const { stiffness, damping } = keyOf(view);
    move(view, stiffness * 1.05 ** dx, damping - 2 * dy);
  },
};
