/* The cliff: a step longer than the critical one, and the ball never rests; a little longer, it explodes. */
import { number, plot } from "../draw.js";
import { criticalDt, runModel } from "../engine.js";
import { axis, G, kept, logGrid, R, scene, shift, START, tidy, within } from "../parts.js";

const [LOW, HIGH] = [0.0005, 0.064]; // s
const SECONDS = 4;
const EXPLODED = 10; // times the start's energy
const MOST = 1e9; // times the start's energy: as much as can be read off

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
const curve = kept((stiffness, damping, low, high) => {
  const xs = logGrid(low, high, 33);
  return { xs, ys: xs.map((dt) => drop(dt, stiffness, damping).left) };
});

// The steps that are shown: seven times shorter than the critical one, and more than twice as long.
function range(view) {
  const { damped } = criticalDt(1, view.get("stiffness"), view.get("damping"));
  const low = within(LOW, tidy(damped / 6.8, 1), HIGH / 16);
  return { damped, low, high: 16 * low };
}

function course(view, width, { run }) {
  return plot({
    id: "cliff-course",
    width,
    height: 150,
    x: axis([0, SECONDS], "time (s)", 0, 1, 2, 3, 4),
    y: axis([-0.5, 1.5], "height (m)", 0, 1),
    left: 64,
    lines: [{ model: "penalty", xs: run.t, ys: Array.from(run.y, (y) => within(-9, y, 9)) }],
    rules: [{ y: 0 }],
  });
}

function chartOf(view, width) {
  const { damped, low, high } = range(view);
  const { undamped } = criticalDt(1, view.get("stiffness"), view.get("damping"));
  const [dt, made] = [view.get("dt"), dropped(view.get("dt"), view.get("stiffness"), view.get("damping"))];
  const known = view.result("curve", [view.get("stiffness"), view.get("damping"), low, high]) || { xs: [], ys: [] };
  return plot({
    id: "cliff",
    width,
    height: view.height - 150,
    left: 64,
    x: { domain: [low, high], log: true, ticks: [1, 2, 4, 8, 16].map((k) => [k * low, String(tidy(1000 * k * low))]), label: "time step dt (ms)" },
    y: { domain: [1e-8, MOST], log: true, zero: true, label: "energy left / start", ticks: [[0, "0"], [1e-6, "10⁻⁶"], [1e-3, "0.001"], [1, "1"], [1e3, "1000"], [1e6, "10⁶"]] },
    lines: [{ model: "penalty", ...known, class: "plainly" }],
    rules: [
      { x: damped, text: `with its damper ${number(1000 * damped)}`, side: "end" },
      { x: undamped, text: `2√(m/k) ${number(1000 * undamped)}`, class: "dashed", row: 1, side: "start" },
    ],
    points: [{ model: "penalty", x: within(low, dt, high), y: made.left, size: 8 }],
  });
}

function draw(view) {
  const made = dropped(view.get("dt"), view.get("stiffness"), view.get("damping"));
  const chart = chartOf(view, view.width);
  const { low, high } = range(view);
  const dt = view.get("dt");
  const text = `dt = ${number(1000 * dt)} ms`;
  const times = `${number(made.left, 2)} times its energy`;
  const how = made.left < 1e-6 ? "the ball comes to rest" : made.left < EXPLODED ? `the ball never rests, it keeps ${times}` : `it explodes, to ${times}`;
  return {
    svg: course(view, view.width, made).markup + shift(0, 150, chart.markup),
    words: `${text}: ${how}.`,
    handles: [{ name: "dt", x: chart.sx(within(low, dt, high)), y: 150 + chart.sy(made.left), r: 14, label: "the time step", value: dt, text: `${text}, ${how}` }],
  };
}

export const figure = {
  title: "The cliff",
  caption: "Drag the time step: past the critical one the dropped ball never rests, and a little further it explodes.",
  height: 400,
  knobs: ["stiffness", "damping"],
  uses: ["dt"],
  jobs: { curve: ([stiffness, damping, low, high]) => curve(stiffness, damping, low, high) },
  draw,
  drag(view, name, x) {
    const { low, high } = range(view);
    const share = (x - 64) / (view.width - 10 - 64);
    view.set({ dt: within(low, tidy(low * (high / low) ** share), high) });
  },
  nudge: (view, name, dx, dy) => view.set({ dt: within(LOW, tidy(view.get("dt") * 1.03 ** (dx - dy)), HIGH) }),
};
