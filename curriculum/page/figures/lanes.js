/* The live figure: the models side by side over one table, in which models, scene, quantity and
 * window of time follow the text. A ball whose end would tell what a bet asks waits for it. */
import { axis, label, line, number, plot, steps, table, within } from "../draw.js";
import { MODELS } from "../engine.js";
import { BELOW, GROUND, handlesOf, HIGHEST, lane, nowOf, placeWords } from "../falls.js";
import { shownOf, timeOf } from "../falls.js";
import { grip, R, START } from "../kit.js";

const LONGEST = 4; // s
const LEAST = 1.05 * R - START; // m: how low the balls can be held
const SECONDS = 5; // that a run through the window takes
const NEXT = { drop: "bounce", bounce: "stack", stack: "drop" }; // what the button shows
const nextScene = ({ values }) => NEXT[values.scene];
// the line of code that runs while a ball touches
const LIT = {
  penalty: "spring", lcp: "sweep", leapfrog: "way", soft: "acceleration", exact: "strike",
};

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

// The gaps in the window, and a little more.
function gapAxis(shown) {
  const [least, most] = range(shown, ({ gap }) => [gap, 1]);
  const low = Math.min(least, -0.002);
  const high = Math.max(Math.min(most, 2), -0.25 * low);
  const room = 0.08 * (high - low);
  const domain = [low - room, high + room];
  return axis(domain, "gap / r (below 0: overlap)", ...steps(...domain, 4));
}

function chartOf(view, shown, height) {
  const { from, to } = view.own;
  const lines = shown.map(({ model, run, first, last, gap }, k) => {
    const shares = [0.12, 0.37, 0.62, 0.87].map((share) => (share + 0.05 * k) * (to - from));
    const rows = shares.map((time) => Math.round(first + time / run.dt));
    const markers = rows.filter((row) => row <= last);
    return { model, xs: run.t, ys: gap, from: first, to: last + 1, markers };
  });
  return plot([0, view.height - height, view.width, height], {
    margin: 52,
    x: axis([from, to], "time (s)", ...steps(from, to, view.width < 420 ? 4 : 6)),
    y: gapAxis(shown),
    lines,
    rules: [{ x: timeOf(view) }, { y: 0 }],
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
  const places = shown.map((each) => `${each.model} ${place(each, waiting(each))}`);
  const touching = shown.filter((each) => view.running && each.push[each.row] > 0);
  const brief = ({ gap, row }) => wide < 84 && Number.isFinite(gap[row]) && number(gap[row], 2);
  const below = (each) => (!each.waits && brief(each)) || place(each, "bet first");
  const drawn = shown.map((each, k) => lane(each, k, below(each), sight));
  return {
    svg: table(0, floor, view.width, GROUND) + drawn.join("") + ruler(sight) + svg,
    words: `${text}: ${places.join(", ")}.`,
    handles: [
      ...handlesOf(view, shown, sight, [LEAST, HIGHEST]),
      grip(view, "time", sx(time), box.bottom - 14, "the time shown", text, times),
    ],
    lit: touching.map(({ model }) => LIT[model]),
  };
}

export const figure = {
  title: "The models over one table",
  height: 560,
  knobs: "dt stiffness damping baumgarte iters warm impedance timeconst restitution".split(" "),
  start: () => ({ models: MODELS, from: 0.3, to: 1.2, time: null, lift: 0 }),
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
  ],
  // What the text asks to see: {models, from, to} as an address has them.
  look(view, { models, from, to }, anew) {
    const { own } = view;
    own.lift = 0;
    const named = (model) => !models || models.split(",").includes(model);
    if (models || anew) own.models = MODELS.filter(named);
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
