/* The question: two balls, same gravity, same drop, two answers to what force the table applies.
 * They fall to the table; what happens there is shown once the first bet is made. */
import { ball, label, number, table } from "../draw.js";
import { runModel, series } from "../engine.js";
import { kept } from "../parts.js";
import { knobsOf, sceneOf, startOf } from "../store.js";

const [SECONDS, FROM, FIRST] = [1.6, 0.3, 0.39]; // of the exercise; where a run and the still begin
const SLOW = 6; // times slower than it happens
const GROUND = 54; // px

// Both runs are the chapter's own drop, whatever is set elsewhere: the bet is about them.
const drops = kept(() => {
  const [scene, knobs] = [sceneOf(startOf("drop")), knobsOf(startOf("drop"))];
  return ["penalty", "lcp"].map((model) => {
    const run = runModel(model, scene, knobs, Math.round(SECONDS / knobs.dt));
    return { model, dt: knobs.dt, ...series(run, scene) };
  });
});

function gapWords(gap) {
  if (Math.abs(gap) < 5e-5) return "on the table";
  return `${number(Math.abs(gap), 2)} r ${gap < 0 ? "inside" : "above"}`;
}

function draw(view) {
  const time = view.own.time ?? FIRST;
  const open = view.open("ex1");
  const floor = view.height - GROUND;
  const r = Math.min(74, view.width / 7);
  const lanes = drops().map(({ model, dt, gap, push, landing }, k) => {
    const wanted = Math.floor(time / dt + 1e-6);
    const row = open ? wanted : Math.min(wanted, landing - 1); // no answer before the bet
    const [x, y] = [view.width * (0.25 + 0.5 * k), floor - r - gap[row] * r];
    const told = wanted > row ? "and now?" : push[row] > 0 ? gapWords(gap[row]) : "";
    const high = label(`↑ ${number(gap[row], 2)} r up`, x, 24, "middle", "tick");
    const svg = [
      y > -r ? ball(model, x, y, r) : high,
      label(told, x, floor + 24, "middle"),
      label(model, x, floor + 44, "middle", "tick"),
    ].join("");
    return { svg, landed: wanted >= landing - 1, place: `${model} is ${gapWords(gap[row])}` };
  });
  const places = `${lanes.map(({ place }) => place).join(", ")}.`;
  const asked = "Both are about to touch. What happens now is your first bet.";
  const landed = lanes.every((each) => each.landed);
  return {
    svg: table(0, floor, view.width, GROUND) + lanes.map(({ svg }) => svg).join(""),
    words: landed ? `At ${time.toFixed(2)} s: ${open ? places : asked}` : "Both fall side by side.",
  };
}

export const figure = {
  title: "Two balls fall onto two tables",
  caption:
    `The same ball, the same gravity, the same drop, ${SLOW} times slower than it happens. They ` +
    "differ in one thing: the force that the table applies.",
  height: 330,
  narrow: 280,
  start: () => ({ time: null }),
  clock: (view) => ({
    from: FROM,
    end: view.open("ex1") ? SECONDS : (drops()[0].landing + 2) * drops()[0].dt,
    rate: 1 / SLOW,
    name: "Drop both",
  }),
  draw,
};
