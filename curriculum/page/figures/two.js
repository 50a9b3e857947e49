/* The question: two balls, same gravity, same drop, and two answers to what force the table applies. They
 * fall to the table; what happens there is shown once the first bet is made. */
import { ball, number, round, table, words } from "../draw.js";
import { pushOfTable, runModel, series } from "../engine.js";
import { knobsOf, sceneOf, startOf } from "../store.js";

const MODELS = ["penalty", "lcp"];
const STEPS = 800; // 1.6 s, as in the exercise
const SLOW = 6; // times slower than it happens
const GROUND = 54;

// Both runs are the chapter's own drop, whatever is set elsewhere: the bet is about them.
const runs = [];
function drops() {
  if (!runs.length) {
    const values = startOf("drop");
    const scene = sceneOf(values);
    for (const model of MODELS) {
      const run = runModel(model, scene, knobsOf(values), STEPS);
      runs.push({ model, run, scene, ...series(run, scene) });
    }
  }
  return runs;
}

// The row that may be shown: until the bet is made nothing past the landing.
function rowOf(view, { run, landing }) {
  const row = Math.min(STEPS, Math.floor(view.own.time / run.dt + 1e-6));
  return view.open("ex1") ? row : Math.min(row, landing - 1);
}

const gapWords = (gap) => (Math.abs(gap) < 5e-5 ? "on the table" : `${number(Math.abs(gap), 2)} r ${gap < 0 ? "inside" : "above"}`);

function lane(view, each, k) {
  const x = view.width * (0.25 + 0.5 * k);
  const r = Math.min(74, view.width / 7);
  const floor = view.height - GROUND;
  const row = rowOf(view, each);
  const gap = each.gap[row];
  const held = !view.open("ex1") && view.own.time / each.run.dt >= each.landing;
  const y = floor - r - gap * r;
  const push = row > 0 ? pushOfTable(each.run, each.scene, row) : 0;
  return [
    y > -r ? ball(each.model, x, y, r) : words(`↑ ${number(gap, 2)} r up`, { x, y: 24, class: "tick", "text-anchor": "middle" }),
    words(held ? "and now?" : push > 0 ? gapWords(gap) : "", { x, y: floor + 24, class: "tick strong", "text-anchor": "middle" }),
    words(each.model, { x, y: floor + 44, class: "tick", "text-anchor": "middle" }),
  ].join("");
}

export const figure = {
  title: "Two balls fall onto two tables",
  caption: `The same ball, the same gravity, the same drop, ${SLOW} times slower than it happens. They differ in one thing: the force that the table applies.`,
  height: 330,
  narrow: 280,
  start: () => ({ time: 0.39 }),
  buttons: [
    {
      label: (view) => (view.running() ? "Stop" : "Drop both"),
      press(view) {
        if (view.running()) return view.stop();
        view.own.time = view.still ? 1.6 : 0.3;
        view.run();
      },
    },
  ],
  draw(view) {
    const shown = drops();
    const floor = view.height - GROUND;
    const rows = shown.map((each) => rowOf(view, each));
    const landed = shown.every((each, k) => rows[k] >= each.landing - 1);
    const places = shown.map((each, k) => `${each.model} is ${gapWords(each.gap[rows[k]])}`);
    const told = view.open("ex1") ? `${places.join(", ")}.` : "Both are about to touch. What happens now is your first bet.";
    return {
      svg: table(0, floor, view.width, GROUND) + shown.map((each, k) => lane(view, each, k)).join(""),
      words: landed ? `At ${round(view.own.time)} s: ${told}` : "Both fall side by side.",
      handles: [],
    };
  },
  tick(view, seconds) {
    view.own.time = Math.min(1.6, view.own.time + seconds / SLOW);
    const [first] = drops();
    const end = view.open("ex1") ? 1.6 : (first.landing + 2) * first.run.dt;
    return view.own.time < end && !view.still;
  },
};
