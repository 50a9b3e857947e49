/* The cliff: a step longer than the critical one, and the ball never rests; a little longer, it explodes. */
import { data } from "../data.js";
import { number, plot } from "../draw.js";
import { criticalDt, runModel } from "../engine.js";
import { alongAxis, axis, charted, G, handle, kept, logGrid, R, scene, shift, START, tidy, within } from "../parts.js";

const [LOW, HIGH] = [0.0005, 0.064]; // s
const SECONDS = 4;
const MOST = 1e9; // times the start's energy: as much as can be read off
const COURSE = 150; // px of the upper chart

// The ball's run, and the energy that is left in its last second, of what it started with. At rest
// in the spring there is none left.
function drop(dt, stiffness, damping) {
  const run = runModel("penalty", scene([START]), { dt, stiffness, damping }, Math.floor(SECONDS / dt));
  const rest = R - G / stiffness;
  let most = 0;
  for (let row = Math.floor(0.75 * run.steps); row <= run.steps; row++) {
    const left = 0.5 * run.vy[row] ** 2 + G * (run.y[row] - rest);
    if (!(left <= most)) most = Number.isFinite(left) ? left : Infinity;
  }
  return { run, left: Math.min(MOST, most / (G * (START - rest))) };
}
const dropped = kept(drop);

const knobsIn = (view) => [view.get("stiffness"), view.get("damping")];

// The steps that are shown: seven times shorter than the critical one, and more than twice as long.
function range(view) {
  const { damped, undamped } = criticalDt(1, ...knobsIn(view));
  const low = within(LOW, tidy(damped / 6.8, 1), HIGH / 16);
  return { damped, undamped, low, high: 16 * low };
}

function course(view, run) {
  const chart = plot({
    id: "cliff-course",
    width: view.width,
    height: COURSE,
    x: axis([0, SECONDS], "time (s)", 0, 1, 2, 3, 4),
    y: axis([-0.5, 1.5], "height (m)", 0, 1),
    left: 64,
    lines: [{ model: "penalty", xs: run.t, ys: Array.from(run.y, (y) => within(-9, y, 9)) }],
    rules: [{ y: 0 }],
  });
  return chart.markup;
}

function chartOf(view, dt, left) {
  const { damped, undamped, low, high } = range(view);
  const known = view.result("curve", [...knobsIn(view), low, high]) || { xs: [], ys: [] };
  const tens = [[1e-6, "10⁻⁶"], [1e-3, "0.001"], [1, "1"], [1e3, "1000"], [1e6, "10⁶"]];
  return charted(view, 0, {
    id: "cliff",
    width: view.width,
    height: view.height - COURSE,
    left: 64,
    x: { ...axis([low, high], "time step dt (ms)", ...[1, 2, 4, 8, 16].map((k) => [k * low, String(tidy(1000 * k * low))])), log: true },
    y: { ...axis([1e-8, MOST], "energy left / start", [0, "0"], ...tens), log: true, zero: true },
    lines: [{ model: "penalty", ...known, class: "plainly" }],
    rules: [
      { x: damped, text: `with its damper ${number(1000 * damped)}`, side: "end" },
      { x: undamped, text: `2√(m/k) ${number(1000 * undamped)}`, class: "dashed", row: 1, side: view.width < 480 ? "end" : "start" },
    ],
    points: [{ model: "penalty", x: within(low, dt, high), y: left, size: 8 }],
  });
}

function draw(view) {
  const dt = view.get("dt");
  const { run, left } = dropped(dt, ...knobsIn(view));
  const chart = chartOf(view, dt, left);
  const { low, high } = range(view);
  const text = `dt = ${number(1000 * dt)} ms`;
  const times = `${number(left, 2)} times the energy of the start`;
  const moving = left < data.engine.EXPLODED ? `after ${SECONDS} s the ball still has ${times}` : `it explodes, to ${times}`;
  const how = left < 1e-6 ? "the ball comes to rest" : moving;
  return {
    svg: course(view, run) + shift(0, COURSE, chart.markup),
    words: `${text}: ${how}.`,
    handles: [handle("dt", chart.sx(within(low, dt, high)), COURSE + chart.sy(left), 14, "the time step", dt, `${text}, ${how}`)],
  };
}

const set = (view, dt) => view.set({ dt: within(LOW, tidy(dt), HIGH) });

export const figure = {
  title: "The cliff",
  caption: "Drag the time step: past the critical one the dropped ball never rests, and a little further it explodes.",
  height: 400,
  knobs: ["stiffness", "damping"],
  uses: ["dt"],
  start: () => ({}),
  jobs: {
    curve([stiffness, damping, low, high]) {
      const xs = logGrid(low, high, 65);
      return { xs, ys: xs.map((dt) => drop(dt, stiffness, damping).left) };
    },
  },
  draw,
  ...alongAxis((view, share) => set(view, range(view).low * 16 ** share), (view, by) => set(view, view.get("dt") * 1.03 ** by)),
};
