/* A ball slides off a held one: the worst error of its place over the step. */
import { ball, clipped, label, logAxis, mark, ms, number, path, plot, range } from "../draw.js";
import { tenTo, timeSteps } from "../draw.js";
import { data } from "../data.js";
import { column, G, kept, R, record } from "../runs.js";

const BOTH = ["lcp", "leapfrog"];
const [SECONDS, FINE, HEIGHT] = [0.48, 1e-4, 5]; // s, s, m: so high that it meets no table
const STEPS = range(7, (k) => 0.0005 * 2 ** k); // s

// The places of the sliding ball, from the middle of the held one [r].
const placesOf = kept((model, lean, dt) => {
  const [x, y] = [2 * R * Math.sin(lean), 2 * R * Math.cos(lean)];
  const balls = column([HEIGHT, HEIGHT + y], { x: [0, x], mass: [Infinity, 1] });
  const run = record(model, balls, { ...data.defaults, dt }, Math.floor(SECONDS / dt + 1e-9));
  return run.t.map((_, k) => [run.x[2 * k + 1] / R, (run.y[2 * k + 1] - HEIGHT) / R]);
});

// How a frictionless ball's place and velocity change: the held ball pushes along the line of centres,
// as hard as keeps it on its circle, and never pulls.
function changeOf([x, y, vx, vy]) {
  const push = Math.max(0, ((G / R) * y - vx * vx - vy * vy) / 4);
  return [vx, vy, push * x, push * y - G / R];
}

// The right places, FINE apart, by the midpoint rule.
const truth = kept((lean) => {
  let state = [2 * Math.sin(lean), 2 * Math.cos(lean), 0, 0];
  const after = (dt, change) => state.map((v, k) => v + dt * change[k]);
  return range(Math.round(SECONDS / FINE) + 1, () => {
    const [x, y] = state;
    state = after(FINE, changeOf(after(FINE / 2, changeOf(state))));
    return [x, y];
  });
});

// Between two of those places the ball is on a straight line.
const errorOf = kept((model, lean, dt) => {
  const fine = truth(lean);
  return Math.max(...placesOf(model, lean, dt).map(([x, y], row) => {
    const at = Math.min(fine.length - 1.001, (row * dt) / FINE);
    const [[x1, y1], [x2, y2], s] = [fine[Math.floor(at)], fine[Math.ceil(at)], at % 1];
    return Math.hypot(x - x1 - s * (x2 - x1), y - y1 - s * (y2 - y1));
  }));
}, 40);

function draw(view) {
  const { own: { dt, lean }, width, height } = view;
  const all = BOTH.map((model) => STEPS.map((step) => [step, errorOf(model, lean, step)]));
  const now = BOTH.map((model) => errorOf(model, lean, dt));
  const slopes = all.map(([[, first]], k) =>
    STEPS.map((step) => [step, 0.4 * first * (step / STEPS[0]) ** (k + 1)]));
  const left = Math.round(0.34 * width);
  const { sx, sy, picture, knob } = plot(view, {
    left, x: timeSteps(6),
    y: logAxis([1e-6, 10], "error / r", ...[-6, -4, -2, 0].map((power) => [10 ** power, tenTo(power)])),
    lines: [...slopes.map((points) => ({ model: "fixed", points, kind: "dotted" })),
      ...all.map((points, k) => ({ model: BOTH[k], points }))],
  });
  const scale = Math.min(44, left / 4.6); // px for 1 r
  const [x, y] = [1.15 * scale, 3.4 * scale];
  const place = ([toX, toY]) => [x + toX * scale, y - toY * scale];
  const what = { label: "the sliding ball: where it starts", value: "lean", low: 0.05, high: 0.8,
    step: 0.02, at: (toX, toY) => Math.atan2(toX - x, Math.max(1, y - toY)) };
  const start = place([2 * Math.sin(lean), 2 * Math.cos(lean)]);
  return {
    picture: [
      ball("fixed", x, y, scale, "body"), clipped(0, 0, left - 8, height, BOTH.map((model) =>
        path(placesOf(model, lean, dt).map(place), `line way m-${model}`))),
      view.grab(what, ball("leapfrog", ...start, scale)), picture,
      BOTH.map((model, k) => [
        label(`slope ${k + 1}`, sx(STEPS[3]) + 4, sy(slopes[k][3][1]) + 18, "start", "tick"),
        label(model, sx(STEPS[0]) + 10, sy(all[k][0][1]) - 14), mark(model, sx(dt), sy(now[k]), 7)]),
      knob("dt", "the time step", 0.0005),
    ],
    words: `From ${number((lean * 180) / Math.PI, 2)}° in steps of ${ms(dt)}, lcp is off by ` +
      `${number(now[0], 2)} r, leapfrog by ${number(now[1], 2)} r.`,
  };
}

export const figure = {
  title: "Sliding: the error over the step",
  caption: "Half the step: lcp’s error is half as large, leapfrog’s a quarter.",
  height: (width) => (width < 480 ? 290 : 340),
  start: () => ({ lean: Math.PI / 9 }), // 20 degrees, as in the text
  draw,
};
