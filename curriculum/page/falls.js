/* Models that fall side by side, of the live figure and of the first bet: their runs, what of them
 * may be seen before a bet, and a lane for each over one table. */
import { arrow, ball, label, number, within } from "./draw.js";
import { data } from "./data.js";
import { criticalDt, runModel, series } from "./engine.js";
import { grip, kept, R } from "./kit.js";
import { knobsOf, sceneOf, startOf } from "./store.js";

export const GROUND = 26; // px of table
export const BELOW = 72; // px of all that is below its top
export const HIGHEST = 1.3; // m: where a ball can be held

// A run of balls that start `lift` m above the scene's own places.
const held = kept((model, scene, settings, count, lift) => {
  const each = sceneOf({ scene, ...settings });
  each.y = each.y.map((height) => height + lift);
  const run = runModel(model, each, settings, count);
  return { model, run, ...series(run, each) };
});

// The run of a model up to the end of the window, by what changes its runs and nothing else.
function runOf(view, model) {
  const all = knobsOf(view.values);
  const settings = Object.fromEntries(["dt", ...data.uses[model]].map((name) => [name, all[name]]));
  const count = Math.max(1, Math.floor(view.own.to / all.dt + 1e-9));
  return held(model, view.values.scene, settings, count, view.own.lift);
}

// ---- what may be shown

// The bet that a model's course past the landing would tell the answer of, or null.
function hiddenBy(view, model) {
  const { dt, stiffness, damping } = view.values;
  if (model === "exact") return null;
  if (!view.open("ex1")) return "exercise 1";
  const throws = dt >= 0.97 * criticalDt(1, stiffness, damping).damped; // what exercise 3 asks
  return model === "penalty" && throws && !view.open("ex3") ? "exercise 3" : null;
}

export const timeOf = ({ own }) => Math.min(own.to, Math.max(own.from, own.time ?? own.from));

// Of each model its run, first and last row of the window that may be seen, and the row of now.
export function shownOf(view) {
  const { models, from } = view.own;
  return models.map((model) => {
    const each = runOf(view, model);
    const { dt, steps } = each.run;
    const bet = hiddenBy(view, model);
    const last = bet ? Math.max(0, Math.min(each.landing - 1, steps)) : steps;
    const row = Math.min(steps, Math.floor(timeOf(view) / dt + 1e-6));
    const first = Math.min(last, Math.floor(from / dt));
    return { ...each, first, last, row: Math.min(row, last), waits: row > last && bet };
  });
}

// Heights of a model's balls now.
export const nowOf = ({ run, row }) => Array.from(run.y.subarray(row * run.n, (row + 1) * run.n));

// ---- drawing

const [SHORT, LONG] = [["touching", "in", "up"], ["on the table", "inside", "above"]];
export function placeWords({ gap, row }, long = false) {
  const [touches, below, above] = long ? LONG : SHORT;
  if (!Number.isFinite(gap[row])) return "nowhere";
  if (Math.abs(gap[row]) < (long ? 5e-5 : 1e-9)) return touches;
  return `${number(Math.abs(gap[row]), 2)} r ${gap[row] < 0 ? below : above}`;
}

const radiusOf = ({ scale }) => Math.max(4, R * scale);

/* One model's balls over the table, and where they are. sight: {floor, wide, scale} in px, of the
 * table's top, a lane, and a metre. */
export function lane(each, k, text, sight) {
  const { floor, scale, wide } = sight;
  const x = wide * (k + 0.5);
  const { row, model } = each;
  const balls = nowOf(each).map((height) => {
    const y = floor - height * scale;
    if (y > floor + 2 * radiusOf(sight)) return arrow("weight", x, floor - 54, 0, 50);
    return Number.isFinite(y) ? ball(model, x, y, radiusOf(sight)) : "";
  });
  const push = row > 0 ? Math.min(40, 14 * Math.sqrt(Math.max(each.push[row], 0))) : 0;
  return [
    ...balls,
    push > 1 ? arrow(`push m-${model}`, x, floor + GROUND - 4, 0, -push) : "",
    label(model, x, floor + GROUND + 16, "middle"),
    label(text, x, floor + GROUND + 35, "middle", "tick"),
  ].join("");
}

/* Every ball is a handle, held from `least` m below its scene's place to `most` m over the table.
 * Where one is held all models begin anew, each with its balls so high, and let them fall when it
 * is let go. */
export function handlesOf(view, shown, sight, [least, most]) {
  const { floor, scale, wide } = sight;
  const start = sceneOf(startOf(view.values.scene || "drop")).y;
  const one = (each, k) => (height, i) => {
    const y = within(4, floor - height * scale, floor + radiusOf(sight));
    const range = {
      r: Math.max(14, radiusOf(sight)),
      low: least,
      high: most - start[start.length - 1],
      step: 0.02,
      at: (toX, toY) => (floor - toY) / scale - start[i],
      set: (lift) => Object.assign(view.own, { lift, from: 0, time: 0 }),
      release: view.play,
    };
    const [name, text] = [`${each.model}, ball ${i + 1}`, `${number(height - R, 2)} m above`];
    return { ...grip(view, "lift", wide * (k + 0.5), y, name, text, range), name };
  };
  return shown.flatMap((each, k) => nowOf(each).map(one(each, k)));
}
