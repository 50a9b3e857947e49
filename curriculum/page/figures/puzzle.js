/* The puzzle: one spring, two wishes. Every try is a drop of 40 s. */
import { axis, circle, number } from "../draw.js";
import { charted, G, kept, pair, R, stillMoves, tens } from "../parts.js";
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
  const chart = charted(view, {
    x: { ...tens(2, 6), label: "stiffness k (N/m)" },
    y: axis([C.low, C.high], "damping c (N s/m)", 0, 100, 200, 300),
  });
  const { sx, sy } = chart;
  const same = (each) => each.stiffness === now.stiffness && each.damping === now.damping;
  if (!view.dragging && !own.tries.some(same)) own.tries.push(now);
  const dot = (each) => circle(sx(each.stiffness), sy(each.damping), 6, "look m-penalty");
  const sinks = `It sinks ${number(G / now.stiffness / R, 2)} r; less than ${SINK} is wanted.`;
  const to = { at: (x, y) => [sx.back(x), sy.back(y)], digits: 3 };
  const ranges = { stiffness: [K.low, K.high], damping: [C.low, C.high] };
  const place = [sx(now.stiffness), sy(now.damping)];
  const text = `k ${number(now.stiffness)} N/m, c ${number(now.damping)} N s/m`;
  const told = ["the spring: stiffness and damping", text];
  return {
    svg: chart.svg + own.tries.map(dot).join(""),
    words: `${sinks} It ${rests(now) ? "comes" : "never comes"} to rest.`,
    handles: [pair(view, "spring", place, ...told, ranges, to)],
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
