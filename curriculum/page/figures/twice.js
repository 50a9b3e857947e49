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
const [STRIP, GROUND, PX, BALL] = [132, 44, 12, 13]; // px: a strip, its table, 1 m/s in a step, a ball
const [DOWN, UP] = [-5, 1]; // m/s; a gap is counted in what 1 m/s closes in a step

// ---- one step, part by part

// Gap [what 1 m/s closes in a step] and speed [m/s] before a step and after each of its parts.
const stagesOf = kept((model, gap, v, settings) => {
  const unit = settings.dt / R; // r
  const one = scene([(1 + gap * unit) * R], { vy: [v] });
  const seen = [one];
  STEP[model](one, one, { ...settings, see: (state) => seen.push(state) });
  return seen.map(({ y, vy }) => ({ gap: (y[0] / R - 1) / unit, v: vy[0] }));
});

// The middle of a column, the table's top in a strip.
const columnOf = (view, k) => (k + 0.5) * (view.width / 6);
const FLOOR = STRIP - GROUND;

// A strip: the ball after each part, and how far its speed would carry it in one step.
const strip = (view, model, stages) => [
  table(0, FLOOR, view.width, GROUND),
  label(model, view.width - 4, 14, "end", "tick strong"),
  ...stages.map(({ gap, v }, k) => {
    const [x, y] = [columnOf(view, k), FLOOR - gap * PX];
    const kind = k && k < stages.length - 1 ? "seen" : "ball plainly";
    return [
      ball(model, x, y - BALL, BALL, kind),
      arrow(`push m-${model}`, x, y, 0, -v * PX),
      label(PARTS[model][k], x, STRIP - 6, "middle", "tick strong"),
    ].join("");
  }),
].join("");

// ---- a ball that slides off a held one

const [SECONDS, FINE, HEIGHT] = [0.5, 1e-4, 5]; // s, s, m: so high that it meets no table
const slid = kept((model, lean, settings) => {
  const [x, y] = [2 * R * Math.sin(lean), 2 * R * Math.cos(lean)];
  const all = scene([HEIGHT, HEIGHT + y], { x: [0, x], mass: [Infinity, 1] });
  return runModel(model, all, settings, Math.round(SECONDS / settings.dt));
});

// Where the upper ball is at a time [r]: between two rows by their speeds, a cubic.
function placeAt({ x, y, vx, vy, dt, steps }, time) {
  const row = Math.min(steps - 1, Math.floor(time / dt));
  const [a, b, s] = [2 * row + 1, 2 * row + 3, time / dt - row];
  const blend = (q, v) =>
    q[a] + s * (dt * v[a] + s * (3 * (q[b] - q[a]) - dt * (2 * v[a] + v[b]) +
      s * (2 * (q[a] - q[b]) + dt * (v[a] + v[b]))));
  return [blend(x, vx) / R, (blend(y, vy) - HEIGHT) / R];
}

// The worst place of a model's run [r], beside leapfrog with the finest steps.
const errorOf = kept((model, lean, settings) => {
  const [run, fine] = [slid(model, lean, settings), slid("leapfrog", lean, { ...settings, dt: FINE })];
  const off = (time, row) => {
    const [x, y] = placeAt(fine, time);
    return Math.hypot(run.x[2 * row + 1] / R - x, (run.y[2 * row + 1] - HEIGHT) / R - y);
  };
  return Math.max(...Array.from(run.t.subarray(1), (time, k) => off(time, k + 1)));
});

const STEPS = Array.from({ length: 7 }, (_, k) => 0.0005 * 2 ** k); // s
const curve = kept((model, lean, settings) =>
  STEPS.map((dt) => errorOf(model, lean, { ...settings, dt })),
);

// The order: error over step, beside lines of slope one and two.
function order(view, settings, left, top) {
  const { lean } = view.own;
  const { dt, ...others } = settings;
  const all = MODELS.map((model) => curve(model, lean, others));
  const now = MODELS.map((model) => errorOf(model, lean, settings));
  const slope = (power, [first]) => STEPS.map((each) => 0.5 * first * (each / STEPS[0]) ** power);
  const ticks = [0.5, 2, 8, 32].map((ms) => [ms / 1000, String(ms)]);
  const chart = plot([left, top, view.width - left, view.height - top], {
    x: { ...axis([0.0005, 0.064], "time step dt (ms)", ...ticks), log: true },
    y: { ...tens(-6, 1), label: "sliding: error / r" },
    lines: [
      ...all.map((ys, k) => ({ model: "fixed", xs: STEPS, ys: slope(k + 1, ys), kind: "thin dotted" })),
      ...all.map((ys, k) => ({ model: MODELS[k], xs: STEPS, ys })),
    ],
    points: now.map((y, k) => ({ model: MODELS[k], x: dt, y, size: 7 })),
  });
  const named = all.map((ys, k) =>
    label(`slope ${k + 1}`, chart.sx(STEPS[3]), chart.sy(slope(k + 1, ys)[3]) + 18));
  return { ...chart, svg: chart.svg + named.join(""), now };
}

// The held ball and both ways around it, to the end of the run.
function slide(view, settings, wide, top) {
  const { lean } = view.own;
  const scale = Math.min(46, wide / 7); // px for 1 r
  const [x, y] = [1.2 * scale, top + 3.4 * scale];
  const place = ([px, py]) => [x + px * scale, y - py * scale];
  const drawn = MODELS.map((model) => {
    const run = slid(model, lean, settings);
    const points = Array.from(run.t, (_, k) => [run.x[2 * k + 1] / R, (run.y[2 * k + 1] - HEIGHT) / R]);
    const seen = points.filter(([, py]) => y - py * scale < view.height - scale);
    const end = place(seen[seen.length - 1]);
    return path(seen.map(place), `line m-${model}`) + ball(model, ...end, scale, "ghost");
  });
  const at = place([2 * Math.sin(lean), 2 * Math.cos(lean)]);
  return { svg: ball("fixed", x, y, scale, "body") + drawn.join("") +
    ball("leapfrog", ...at, scale, "ball plainly"), at, x, y, scale };
}

function draw(view) {
  const { gap, v } = view.own;
  const settings = knobs(view);
  const [first, second] = MODELS.map((model) => stagesOf(model, gap, v, settings));
  const top = 2 * STRIP + 14;
  const wide = Math.round(0.38 * view.width);
  const sliding = { dt: view.get("dt"), baumgarte: settings.baumgarte, iters: settings.iters };
  const whole = { ...sliding, restitution: 0 };
  const held = slide(view, whole, wide, top);
  const { svg, sx, sy, now } = order(view, whole, wide, top);
  const x = columnOf(view, 0);
  const y = FLOOR - gap * PX;
  const lift = { r: BALL, low: UP - 1, high: -DOWN, step: 0.1, by: (dx, dy) => -dy / PX };
  const fly = { low: DOWN, high: UP, step: 0.1, at: (toX, to) => (y - to) / PX };
  const tall = `${number(gap * settings.dt / R, 2)} r`;
  const ball1 = grip(view, "gap", x, y - BALL, "the ball: its gap before the step", tall, lift);
  const tip = grip(view, "v", x, y - v * PX, "its speed before the step", `${number(v, 2)} m/s`, fly);
  const at = (toX, toY) => Math.atan2(toX - held.x, Math.max(1, held.y - toY));
  const lean = { r: held.scale, low: 0.05, high: 0.8, step: 0.02, at };
  const leans = `${number((view.own.lean * 180) / Math.PI, 2)}° off the top`;
  const turn = { at: sx.back, times: 1.1 };
  const ends = [first, second].map((all, k) => {
    const { gap: end, v: speed } = all[all.length - 1];
    return `${MODELS[k]} ends at ${number(end * settings.dt / R, 2)} r with ${number(speed, 2)} m/s`;
  });
  const [late, near] = now.map((each) => `${number(each, 2)} r`);
  return {
    svg:
      strip(view, "lcp", first) + shift(0, STRIP, strip(view, "leapfrog", second)) +
      held.svg + svg,
    words:
      `From a gap of ${tall} with ${number(v, 2)} m/s ${ends.join(", ")}. Where a ball slides, ` +
      `${number(1000 * settings.dt)} ms leave ${late} with lcp and ${near} with leapfrog.`,
    handles: [
      ball1,
      wholly(ball1, "other", x, STRIP + y - BALL, BALL),
      tip,
      grip(view, "lean", ...held.at, "the sliding ball: where it starts", leans, lean),
      grip(view, "dt", sx(settings.dt), sy(now[1]), "the time step", `${settings.dt} s`, turn),
    ],
    lit: ["way", "speed"],
  };
}

export const figure = {
  title: "One step, asked once and asked twice",
  caption:
    "lcp asks one question in a step, leapfrog two: drag the ball and its speed, the sliding ball " +
    "and the time step, and see what each step leaves.",
  height: 520,
  knobs: ["dt"],
  start: () => ({ gap: 3, v: -4, lean: 0.1 }),
  draw,
};
