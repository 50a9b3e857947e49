/* No target above -e v_n: two elastic balls are just parting when a third strikes one of them. */
import { arrow, ball, label, line, number, rect } from "../draw.js";
import { makeRows, solveContacts } from "../engine.js";
import { grip, kept, wholly } from "../parts.js";

const MOST = 3.5; // m/s
const [ROWS, PX] = [[180, 320, 460], 26]; // px: where the balls are, a radius

// The speeds after the impact of three touching elastic balls; `repair`: no target below zero.
const struck = kept((speeds, repair) => {
  const [vx, vy] = [speeds.slice(), [0, 0, 0]];
  const contacts = [0, 1].map((i) => {
    const wanted = speeds[i] - speeds[i + 1];
    return { i: i + 1, j: i, nx: 1, ny: 0, target: repair ? Math.max(0, wanted) : wanted };
  });
  solveContacts(makeRows(contacts, [1, 1, 1]), vx, vy, { iters: 1000 });
  return vx;
});
const energy = (speeds) => speeds.reduce((sum, v) => sum + 0.5 * v * v, 0);
const list = (speeds) => speeds.map((v) => number(v, 2)).join(", ");

// Where a drawing so wide has the balls, of so many px, their arrows, and the bars of the energy.
function placesOf(width, most) {
  const bars = width - Math.min(150, 0.25 * width);
  return {
    bars,
    px: Math.min(30, width / 20), // of an arrow for 1 m/s
    unit: (width - bars - 8) / Math.max(most, 0.1),
    at: (i) => (bars - 16) / 2 + 2 * PX * (i - 1),
    // the arrows stand over one another, and those that are dragged further apart
    up: (i, k) => (k ? -PX - 14 - 22 * i : -PX - 20 - 44 * i),
  };
}

function row([title, speeds], k, { bars, px, unit, at, up }) {
  return [
    label(title, 0, ROWS[k] - PX - (k ? 72 : 134), "start", "axis-name"),
    ...speeds.map(
      (v, i) =>
        ball("lcp", at(i), ROWS[k], PX, k ? "seen" : "ball plainly") +
        arrow("weight", at(i), ROWS[k] + up(i, k), px * v, 0) +
        label(number(v, 2), at(i), ROWS[k] + 5, "middle", k ? "tick strong" : "on-ball"),
    ),
    rect(bars, ROWS[k] - 10, energy(speeds) * unit, 20, "bar-fill m-lcp"),
    label(`${number(energy(speeds), 4)} J`, bars, ROWS[k] + 30),
  ];
}

function draw(view) {
  const speeds = ["v1", "v2", "v3"].map((name) => view.own[name]);
  const cases = [
    ["before", speeds],
    ["after, each target −e v_n", struck(speeds, false)],
    ["after, no target below 0", struck(speeds, true)],
  ];
  const [begun, moreau, repaired] = cases.map((each) => energy(each[1]));
  const places = placesOf(view.width, Math.max(begun, moreau, repaired));
  const { bars, px, unit, at, up } = places;
  const mark = bars + begun * unit;
  const hold = (v, i) => {
    const range = { low: -MOST, high: MOST, step: 0.1, at: (x) => (x - at(i)) / px };
    const [name, text] = [`the speed of ball ${i + 1}`, `${number(v, 2)} m/s`];
    return grip(view, `v${i + 1}`, at(i) + px * v, ROWS[0] + up(i, 0), name, text, range);
  };
  const knobs = speeds.map(hold);
  const gain = repaired / begun - 1;
  const more = gain > 1e-9 ? `${number(100 * gain, 2)} % more energy` : "no more energy";
  const told = cases.map((each) => list(each[1]));
  return {
    svg: [
      ...cases.flatMap((each, k) => row(each, k, places)),
      label("energy", bars, ROWS[0] - 30, "start", "axis-name"),
      line(mark, ROWS[0] - 22, mark, ROWS[2] + 14),
    ].join(""),
    words:
      `Before: ${told[0]} m/s. With −e v_n: ${told[1]} m/s and the same energy. ` +
      `With no target below 0: ${told[2]} m/s and ${more}.`,
    handles: [...knobs.map((each, i) => wholly(each, `ball-${i}`, at(i), ROWS[0], PX)), ...knobs],
  };
}

export const figure = {
  title: "Three elastic balls, and the energy of the impact",
  caption:
    "Two balls part while a third strikes: targets of −e v_n keep the energy, and the repair " +
    "that allows no target below zero adds some; drag the speeds.",
  height: 504,
  start: () => ({ v1: -1, v2: 0, v3: -3 }),
  draw,
};
