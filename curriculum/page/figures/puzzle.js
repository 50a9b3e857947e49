/* The puzzle: one spring, two wishes. Every try is a drop of 40 s. */
import { axis, circle, number, within } from "../draw.js";
import { charted, G, kept, R, stillMoves } from "../parts.js";
import { QUANTITIES } from "../store.js";

const DT = 0.01; // s
const SINK = 0.001; // r
const LONG = 40; // s
const { stiffness: K, damping: C } = QUANTITIES;

// Whether a ball dropped on this spring is at rest after LONG.
const rests = kept(
  ({ stiffness, damping }) => stillMoves(DT, stiffness, damping, LONG / DT, 200) < 1e-3,
);

function draw(view) {
  const { own } = view;
  const now = { stiffness: view.get("stiffness"), damping: view.get("damping") };
  const tens = [[1e4, "10⁴"], [1e5, "10⁵"], [1e6, "10⁶"]];
  const chart = charted(view, {
    x: { ...axis([K.low, K.high], "stiffness k (N/m)", 100, 1000, ...tens), log: true },
    y: axis([C.low, C.high], "damping c (N s/m)", 0, 100, 200, 300),
  });
  const { sx, sy } = chart;
  const same = (each) => each.stiffness === now.stiffness && each.damping === now.damping;
  if (!view.dragging && !own.tries.some(same)) own.tries.push(now);
  const dot = (each, r, kind) => circle(sx(each.stiffness), sy(each.damping), r, kind);
  const set = (k, c) => {
    const stiffness = Number(within(K.low, k, K.high).toPrecision(3));
    view.set({ stiffness, damping: within(C.low, Math.round(c), C.high) });
  };
  const sinks = `It sinks ${number(G / now.stiffness / R, 2)} r; less than ${SINK} is wanted.`;
  const spring = {
    name: "spring",
    x: sx(now.stiffness),
    y: sy(now.damping),
    value: now.stiffness,
    label: "the spring: stiffness and damping",
    text: `k ${number(now.stiffness)} N/m, c ${number(now.damping)} N s/m`,
    drag: (x, y) => set(sx.back(x), sy.back(y)),
    nudge: (dx, dy) => set(view.get("stiffness") * 1.05 ** dx, view.get("damping") - 2 * dy),
  };
  return {
    svg: [
      chart.svg,
      ...own.tries.map((each) => dot(each, 6, "look m-penalty")),
    ].join(""),
    words: `${sinks} It ${rests(now) ? "comes" : "never comes"} to rest.`,
    handles: [spring],
  };
}

export const figure = {
  title: "A puzzle: one spring, two wishes",
  caption:
    "Find a spring on which the ball sinks less than a thousandth of its radius and still comes " +
    "to rest at a time step of 0.01 s. Each try is a drop of 40 s.",
  height: 300,
  knobs: ["stiffness", "damping"],
  start: () => ({ tries: [] }),
  draw,
};
