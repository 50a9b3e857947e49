/* leapfrog beside lcp: one step in its parts, a ball that slides off a held one, and how the error
 * of that falls with the step. */
import { arrow, axis, ball, label, line, number, path, plot, shift, table } from "../draw.js";
import { runModel, STEP } from "../engine.js";
import { grip, kept, knobs, R, scene, tens, wholly } from "../kit.js";

const MODELS = ["lcp", "leapfrog"];
const PARTS = {
  lcp: ["before", "kick", "push", "move"],
  leapfrog: ["before", "½ kick", "way?", "move", "½ kick", "speed?"],
};

// ---- one step, part by part

// px: a model's strip, its table, so deep that no arrow hides a name below it, a radius
const [STRIP, GROUND, BALL] = [140, 66, 13];
const FLOOR = STRIP - GROUND;
const PX = 9; // what 1 m/s does in a step; gaps are counted in it
const [DOWN, UP] = [-5, 1]; // m/s
const ASIDE = 28; // px from the tip of the first arrow to what one drags it by

// Gap and speed [m/s] before a step, and after each of its parts.
const stagesOf = kept((model, gap, v, settings) => {
  const one = scene([R + gap * settings.dt], { vy: [v] });
  const seen = [one];
  STEP[model](one, one, { ...settings, see: (state) => seen.push(state) });
  return seen.map(({ y, vy }) => ({ gap: (y[0] - R) / settings.dt, v: vy[0] }));
});

const columnOf = ({ width }, k) => ((k + 0.5) * width) / PARTS.leapfrog.length; // its middle

// The ball after each part, and how far its speed would carry it in one step.
function strip(view, model, stages) {
  const each = ({ gap, v }, k) => {
    const [x, y] = [columnOf(view, k), FLOOR - gap * PX];
    const kind = k && k < stages.length - 1 ? "seen" : "ball plainly";
    const speed = arrow(`push m-${model}`, x, y, 0, -v * PX);
    return ball(model, x, y - BALL, BALL, kind) + speed +
      label(PARTS[model][k], x, STRIP - 6, "middle");
  };
  const drawn = stages.map(each).join("");
  return table(0, FLOOR, view.width, GROUND) + label(model, view.width - 4, 14, "end") + drawn;
}

// ---- a ball that slides off a held one, from `lean` off its top

const [SECONDS, FINE, HEIGHT] = [0.5, 1e-4, 5]; // s, s, m: so high that it meets no table
const slid = kept((model, lean, settings) => {
  const [x, y] = [2 * R * Math.sin(lean), 2 * R * Math.cos(lean)];
  const all = scene([HEIGHT, HEIGHT + y], { x: [0, x], mass: [Infinity, 1] });
  return runModel(model, all, settings, Math.floor(SECONDS / settings.dt + 1e-9));
});
const placesOf = ({ x, y, t }) =>
  Array.from(t, (_, k) => [x[2 * k + 1] / R, (y[2 * k + 1] - HEIGHT) / R]);

// The worst place of a model's run [r], beside leapfrog with the finest steps: between two of those
// the ball is less than 1e-6 r off a straight line.
const errorOf = kept((model, lean, settings) => {
  const fine = placesOf(slid("leapfrog", lean, { ...settings, dt: FINE }));
  const off = ([x, y], row) => {
    const at = Math.min(fine.length - 1.001, (row * settings.dt) / FINE);
    const [[x1, y1], [x2, y2], s] = [fine[Math.floor(at)], fine[Math.ceil(at)], at % 1];
    return Math.hypot(x - x1 - s * (x2 - x1), y - y1 - s * (y2 - y1));
  };
  return Math.max(...placesOf(slid(model, lean, settings)).map(off));
});

const STEPS = Array.from({ length: 7 }, (_, k) => 0.0005 * 2 ** k); // s

// Error over step, beside lines of slope one and two; `now`: the reader's own.
function order(view, settings, left, top) {
  const { lean } = view.own;
  const at = (model) => (dt) => errorOf(model, lean, { ...settings, dt });
  const all = MODELS.map((model) => STEPS.map(at(model)));
  const now = MODELS.map((model) => at(model)(settings.dt));
  const slopes = all.map(([first], k) =>
    STEPS.map((dt) => 0.5 * first * (dt / STEPS[0]) ** (k + 1)));
  const ticks = [0.5, 2, 8, 32].map((ms) => [ms / 1000, String(ms)]);
  const drawn = (ys, model, kind) => ({ model, xs: STEPS, ys, kind });
  const chart = plot([left, top, view.width - left, view.height - top], {
    x: { ...axis([STEPS[0], 0.064], "time step dt (ms)", ...ticks), log: true },
    y: { ...tens(-6, 1), label: "sliding: error / r" },
    lines: [
      ...slopes.map((ys) => drawn(ys, "fixed", "thin dotted")),
      ...all.map((ys, k) => drawn(ys, MODELS[k])),
    ],
    points: now.map((y, k) => ({ model: MODELS[k], x: settings.dt, y, size: 7 })),
  });
  const named = slopes.map((ys, k) =>
    label(`slope ${k + 1}`, chart.sx(STEPS[1 + 2 * k]), chart.sy(ys[1 + 2 * k]) + 18));
  return { ...chart, svg: chart.svg + named.join(""), now };
}

// The held ball, and both ways around it.
function slide(view, settings, wide, top) {
  const { lean } = view.own;
  const scale = Math.min(46, wide / 7); // px for 1 r
  const [x, y] = [1.2 * scale, top + 3.4 * scale];
  const place = ([px, py]) => [x + px * scale, y - py * scale];
  const drawn = MODELS.map((model) => {
    const ways = placesOf(slid(model, lean, settings)).map(place);
    const seen = ways.filter(([to, down]) => to < wide - scale && down < view.height - scale);
    return path(seen, `line m-${model}`) + ball(model, ...seen[seen.length - 1], scale, "ghost");
  });
  const at = place([2 * Math.sin(lean), 2 * Math.cos(lean)]);
  const both = ball("fixed", x, y, scale, "body") + drawn.join("");
  return { svg: both + ball("leapfrog", ...at, scale, "ball plainly"), at, x, y, scale };
}

// ---- the whole

function handlesOf(view, { dt }, held, { sx, sy, now }) {
  const { gap, v, lean } = view.own;
  const [x, y] = [columnOf(view, 0), FLOOR - gap * PX];
  const lift = { r: BALL, low: 0, high: -DOWN, step: 0.1, by: (dx, dy) => -dy / PX };
  const fly = { low: DOWN, high: UP, step: 0.1, at: (toX, to) => (y - to) / PX };
  const at = (toX, toY) => Math.atan2(toX - held.x, Math.max(1, held.y - toY));
  const roll = { r: held.scale, low: 0.05, high: 0.8, step: 0.02, at };
  const tall = `${number((gap * dt) / R, 2)} r`;
  const top = grip(view, "gap", x, y - BALL, "the ball: its gap before the step", tall, lift);
  const fast = ["its speed before the step", `${number(v, 2)} m/s`, fly];
  const angle = `${number((lean * 180) / Math.PI, 2)}°`;
  const turn = { times: 1.1, at: sx.back };
  return [
    top,
    wholly(top, "other", x, STRIP + y - BALL, BALL),
    grip(view, "v", x + ASIDE, y - v * PX, ...fast),
    grip(view, "lean", ...held.at, "the sliding ball: where it starts", angle, roll),
    grip(view, "dt", sx(dt), sy(now[1]), "the time step", `${number(1000 * dt)} ms`, turn),
  ];
}

function draw(view) {
  const { gap, v } = view.own;
  const settings = { ...knobs(view), dt: view.get("dt") };
  const all = MODELS.map((model) => stagesOf(model, gap, v, settings));
  const [top, wide] = [2 * STRIP + 14, Math.round(0.38 * view.width)];
  const sliding = { dt: settings.dt, baumgarte: settings.baumgarte, iters: settings.iters };
  const held = slide(view, { ...sliding, restitution: 0 }, wide, top);
  const chart = order(view, { ...sliding, restitution: 0 }, wide, top);
  const strips = all.map((stages, k) => shift(0, k * STRIP, strip(view, MODELS[k], stages)));
  const [x, tip] = [columnOf(view, 0), FLOOR - (gap + v) * PX];
  const inRadii = (gap) => `${number((gap * settings.dt) / R, 2)} r`;
  const ends = all.map((stages, k) => {
    const { gap: end, v: speed } = stages[stages.length - 1];
    return `${MODELS[k]} ends at ${inRadii(end)} with ${number(speed, 2)} m/s`;
  });
  const [lcp, leapfrog] = chart.now.map((each) => `${number(each, 2)} r`);
  return {
    svg: strips.join("") + line(x + 8, tip, x + ASIDE, tip, "rule") + held.svg + chart.svg,
    words:
      `From a gap of ${inRadii(gap)} with ${number(v, 2)} m/s ${ends.join(", ")}. Where a ball ` +
      `slides, steps of ${number(1000 * settings.dt)} ms leave ${lcp} with lcp and ${leapfrog} ` +
      "with leapfrog.",
    handles: handlesOf(view, settings, held, chart),
    lit: ["way", "speed"],
  };
}

export const figure = {
  title: "One step, asked once and asked twice",
  caption:
    "lcp asks one question in a step, leapfrog two: drag the ball and its speed, the sliding " +
    "ball and the time step, and see what each step leaves.",
  height: 536,
  knobs: ["dt"],
  start: () => ({ gap: 3, v: -4, lean: 0.1 }),
  draw,
};
