/* The models side by side over one table: the live figure, in which models, scene, quantity and
 * window of time follow the text, and the question of the first bet, two of them in the chapter's
 * own drop. A ball whose end would tell what a bet asks waits for it. */
import { arrow, axis, ball, label, line, number, plot, steps, table, within } from "../draw.js";
import { MODELS, criticalDt, runModel, series } from "../engine.js";
import { decades, grip, kept, R, START } from "../parts.js";
import { knobsOf, sceneOf, startOf } from "../store.js";

const LONGEST = 4; // s
const [LEAST, HIGHEST] = [1.05 * R - START, 1.3]; // m: where the balls can be held
const SECONDS = 5; // that a run through the window takes
const [GROUND, BELOW] = [26, 72]; // px of table, and of all that is below its top
// what a button shows next, of the scenes and of what the chart can show
const NEXT = {
  drop: "bounce", bounce: "stack", stack: "drop",
  gap: "push", push: "energy", energy: "gap",
};
const nextScene = ({ values }) => NEXT[values.scene];
// which quantities change a model's run
const USES = {
  penalty: ["dt", "stiffness", "damping"],
  lcp: ["dt", "restitution", "baumgarte", "iters", "warm"],
  soft: ["dt", "restitution", "solref", "solimp"],
  exact: ["dt", "restitution"],
};
// the line of code that runs while a ball touches
const LINES = {
  penalty: ["penalty", "max(0.0, stiffness"],
  lcp: ["sweep", "lam = max("],
  soft: ["soft", "c.target = v_n"],
  exact: ["exact", "bounce(touching"],
};

// A run of balls that start `lift` m above the scene's own places.
const held = kept((model, scene, told, count, lift) => {
  const each = sceneOf({ scene, restitution: told.restitution, damping: told.damping });
  each.y = each.y.map((height) => height + lift);
  const run = runModel(model, each, told, count);
  return { model, run, ...series(run, each) };
});

// The run of a model up to the end of the window.
function runOf(view, model) {
  const all = knobsOf(view.values);
  const told = Object.fromEntries(USES[model].map((name) => [name, all[name]]));
  const count = Math.max(1, Math.floor(view.own.to / all.dt + 1e-9));
  return held(model, view.values.scene, told, count, view.own.lift);
}

// ---- what may be shown

// The bet that a model's course past the landing would tell the answer of, or null.
function hiddenBy(view, model) {
  const { dt, stiffness, damping } = view.values;
  if (model === "exact") return null;
  if (!view.open("ex1")) return "exercise 1";
  if (model === "soft" && !view.open("ex4")) return "exercise 4";
  const throws = dt >= 0.97 * criticalDt(1, stiffness, damping).damped; // what exercise 3 asks
  return model === "penalty" && throws && !view.open("ex3") ? "exercise 3" : null;
}

const timeOf = ({ own }) => Math.min(own.to, Math.max(own.from, own.time ?? own.from));

// Of each model its run, first and last row of the window that may be seen, and the row of now.
function shownOf(view) {
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

// ---- drawing

// Least and greatest finite value of a column in the window, [0, 1] if there is none.
function range(shown, column) {
  let [low, high] = [Infinity, -Infinity];
  for (const each of shown) {
    const [values, n] = column(each);
    for (let k = each.first * n; k < (each.last + 1) * n; k++) {
      if (values[k] < low) low = values[k];
      if (values[k] > high && values[k] < Infinity) high = values[k];
    }
  }
  return low <= high ? [low, high] : [0, 1];
}

const [SHORT, LONG] = [["touching", "in", "up"], ["on the table", "inside", "above"]];
function placeWords({ gap, row }, least = 1e-9, [touches, below, above] = SHORT) {
  if (!Number.isFinite(gap[row])) return "nowhere";
  if (Math.abs(gap[row]) < least) return touches;
  return `${number(Math.abs(gap[row]), 2)} r ${gap[row] < 0 ? below : above}`;
}

// Heights of a model's balls now.
const nowOf = ({ run, row }) => Array.from(run.y.subarray(row * run.n, (row + 1) * run.n));

/* What a picture of such a width and height shows: {floor, scale, high}. Where a ball flies off,
 * the picture shows all that is above the table, and how high it is. */
function sightOf(shown, wide, floor, calm) {
  const far = Math.max(...shown.flatMap(nowOf).filter(Number.isFinite), 0);
  const high = Math.max(calm, 1.2 * far);
  const scale = Math.min((floor - 8) / high, (0.4 * wide) / R);
  return { floor, high, wide, scale, far: high > calm };
}

function ruler({ floor, scale, high, far }) {
  const mark = (height) => {
    const y = floor - height * scale;
    return line(0, y, 6, y, "axis") + label(`${number(height, 2)} m`, 9, y + 5, "start", "tick");
  };
  return far ? line(0, 8, 0, floor, "axis") + steps(0, high, 4).slice(1).map(mark).join("") : "";
}

const radiusOf = ({ scale }) => Math.max(4, R * scale);

// One model's balls over the table, and where they are.
function lane(each, k, told, sight) {
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
    label(told, x, floor + GROUND + 35, "middle", "tick"),
  ].join("");
}

/* Every ball is a handle. Where one is held all models begin anew, each with its balls so high, and
 * let them fall when it is let go. */
function handlesOf(view, shown, sight, [least, most]) {
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

// A plain axis around the values from low to high, and a little more.
function around(low, high, name) {
  const room = 0.08 * (high - low || 0.1);
  const domain = [low - room, high + room];
  return axis(domain, name, ...steps(...domain, 4));
}

const CHARTS = {
  gap([least, most]) {
    const low = Math.min(least, -0.002);
    return around(low, Math.max(Math.min(most, 2), -0.25 * low), "gap / r (below 0: overlap)");
  },
  push: ([, most]) => decades(Math.max(10, most), "push / weight", [0, "0"], 1, 10, 100),
  energy([least, most]) {
    return most > 5 ? decades(most, "energy / start", 1) : around(least, most, "energy / start");
  },
};

function chartOf(view, shown, height) {
  const { from, to, chart } = view.own;
  const lines = shown.map(({ model, run, first, last, ...each }, k) => {
    const shares = [0.12, 0.37, 0.62, 0.87].map((share) => (share + 0.05 * k) * (to - from));
    const rows = shares.map((time) => Math.round(first + time / run.dt));
    const markers = rows.filter((row) => row <= last);
    return { model, xs: run.t, ys: each[chart], from: first, to: last + 1, markers };
  });
  const cursor = { x: timeOf(view), kind: "cursor" };
  const level = { gap: [{ y: 0 }], push: [{ y: 1, kind: "dashed" }], energy: [] }[chart];
  return plot([0, view.height - height, view.width, height], {
    margin: 52,
    x: axis([from, to], "time (s)", ...steps(from, to, view.width < 420 ? 4 : 6)),
    y: CHARTS[chart](range(shown, (each) => [each[chart], 1])),
    lines,
    rules: [cursor, ...level],
  });
}

function draw(view) {
  const shown = shownOf(view);
  const height = Math.min(180, Math.round(0.42 * view.height)); // px, of the chart
  const [floor, wide] = [view.height - height - BELOW, view.width / shown.length];
  const [, top] = range(shown, ({ run }) => [run.y, run.n]);
  // while a ball is held the picture does not change under the hand
  if (!view.grabbed || !view.own.calm) view.own.calm = within(3.2 * R, top + 1.2 * R, HIGHEST);
  const sight = sightOf(shown, wide, floor, view.own.calm);
  const { svg, sx, box } = chartOf(view, shown, height);
  const time = timeOf(view);
  const text = `${time.toFixed(3)} s`;
  const { from, to } = view.own;
  const dt = view.get("dt");
  const at = (to) => dt * Math.round(sx.back(to) / dt); // of a row
  const times = { low: from, high: to, step: dt, at, get: () => timeOf(view) };
  const place = (each, until) => (each.waits ? until : placeWords(each));
  const waiting = (each) => `waits for your bet in ${each.waits}`;
  const told = shown.map((each) => `${each.model} ${place(each, waiting(each))}`);
  const touching = shown.filter((each) => view.running && each.push[each.row] > 0);
  const drawn = shown.map((each, k) => lane(each, k, place(each, "bet first"), sight));
  return {
    svg: table(0, floor, view.width, GROUND) + drawn.join("") + ruler(sight) + svg,
    words: `${text}: ${told.join(", ")}.`,
    handles: [
      ...handlesOf(view, shown, sight, [LEAST, HIGHEST]),
      grip(view, "time", sx(time), box.bottom - 14, "the time shown", text, times),
    ],
    lit: touching.map((each) => LINES[each.model]),
  };
}

const lanes = {
  title: "Four models, one table",
  height: 560,
  knobs: "dt stiffness damping baumgarte iters warm impedance timeconst restitution".split(" "),
  start: () => ({ models: MODELS, chart: "gap", from: 0.3, to: 1.2, time: null, lift: 0 }),
  clock({ own: { from, to } }) {
    const slower = number(SECONDS / (to - from), 2);
    return { from, end: to, rate: (to - from) / SECONDS, name: `Play, ${slower} × slower` };
  },
  buttons: [
    [
      ({ box }) => (box.classList.contains("all") ? "Less" : "More"),
      ({ box }) => box.classList.toggle("all"),
    ],
    [(view) => `A ${nextScene(view)} instead`, (view) => view.set({ scene: nextScene(view) })],
    [({ own }) => `Show ${NEXT[own.chart]}`, ({ own }) => (own.chart = NEXT[own.chart])],
  ],
  // What the text asks to see: {models, chart, from, to} as an address has them.
  look(view, { models, chart, from, to }, anew) {
    const { own } = view;
    own.lift = 0;
    const named = (model) => !models || models.split(",").includes(model);
    if (models || anew) own.models = MODELS.filter(named);
    if (chart || anew) own.chart = chart || "gap";
    if (from || to || anew) {
      own.from = Math.min(Number(from || 0.3), LONGEST - 0.1);
      const least = own.from + 8 * view.get("dt");
      own.to = Math.min(LONGEST, Math.max(least, Number(to || own.from + 0.9)));
    }
  },
  // Once through the window, from its start.
  replay(view) {
    view.own.time = null;
    view.play();
  },
  draw,
};

// ---- the question: what force does the table apply?

const ASKED = { models: ["penalty", "lcp"], to: 1.6 }; // s
const FROM = ({ lift }) => (lift ? 0 : 0.3); // s
const FIRST = 0.39; // s, of the still
const SLOW = 6; // times slower than it happens

// Both runs are the chapter's own drop, whatever is set elsewhere: the bet is about them.
const timeOfTwo = ({ own }) => own.time ?? (own.lift ? 0 : FIRST);
function askedOf({ own, open }) {
  const asked = { ...ASKED, from: FROM(own), time: timeOfTwo({ own }), lift: own.lift };
  return shownOf({ own: asked, values: startOf("drop"), open });
}

function drawTwo(view) {
  const shown = askedOf(view);
  const [floor, wide] = [view.height - BELOW, view.width / 2];
  const high = ((floor - 8) * R) / Math.min(74, 0.28 * wide); // a radius is 74 px
  const sight = { floor, wide, high, scale: (floor - 8) / high };
  const held = shown.filter((each) => nowOf(each)[0] < high);
  const place = (each) => placeWords(each, 5e-5, LONG);
  const told = (each) => (each.waits ? "and now?" : place(each));
  const drawn = shown.map((each, k) => lane(each, k, told(each), sight));
  const places = `${shown.map((each) => `${each.model} is ${place(each)}`).join(", ")}.`;
  const asked = "Both are about to touch. What happens now is your first bet.";
  const now = `At ${timeOfTwo(view).toFixed(2)} s`;
  const above = number(nowOf(shown[0])[0] / R - 1, 2);
  const falling = `Both are ${above} r above the table, and fall side by side.`;
  const landed = shown.every(({ row, landing }) => row >= landing - 1);
  return {
    svg: table(0, floor, view.width, GROUND) + drawn.join(""),
    words: landed ? `${now}: ${view.open("ex1") ? places : asked}` : falling,
    // they are held above the table, so that no bet is told
    handles: handlesOf(view, held, sight, [1.3 * R - START, high - R]),
  };
}

const two = {
  title: "Two balls fall onto two tables",
  caption:
    `The same ball, the same gravity, the same drop, ${SLOW} times slower than it happens. They ` +
    "differ in one thing: the force that the table applies.",
  height: 346,
  narrow: 280,
  start: () => ({ time: null, lift: 0 }),
  clock(view) {
    const [{ landing, run }] = askedOf(view);
    const end = view.open("ex1") ? ASKED.to : (landing + 2) * run.dt;
    return { from: FROM(view.own), end, rate: 1 / SLOW, name: "Drop both" };
  },
  draw: drawTwo,
};

export const figures = { lanes, two };
