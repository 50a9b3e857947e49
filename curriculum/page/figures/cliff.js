/* The cliff: a step longer than the critical one, and the ball never rests; a little longer, it explodes. */
import { number, plot } from "../draw.js";
import { criticalDt, quality, runModel } from "../engine.js";
import { alongAxis, axis, charted, handle, kept, logGrid, R, scene, shift, START, tidy, within } from "../parts.js";

const [LOW, HIGH] = [0.0005, 0.064]; // s
const SECONDS = 4;
const STEPS = 2000; // as many as contact.py takes
const MOST = 1e9; // r: as much as can be read off
const COURSE = 150; // px of the upper chart

const ball = scene([START]);
const drop = (dt, stiffness, damping) => runModel("penalty", ball, { dt, stiffness, damping }, STEPS);

// How far the ball still moves in the last quarter of a run [r].
function moves({ y }) {
  const late = y.subarray(0.75 * STEPS);
  const far = (Math.max(...late) - Math.min(...late)) / R;
  return Number.isFinite(far) ? Math.min(MOST, far) : MOST;
}
// A run, and the energy that it gains at most, of what it started with, as contact.py has it.
const dropped = kept((dt, stiffness, damping) => {
  const run = drop(dt, stiffness, damping);
  return { run, ...quality(run, ball) };
});

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

function chartOf(view, dt, far) {
  const { damped, undamped, low, high } = range(view);
  const known = view.result("curve", [...knobsIn(view), low, high]) || { xs: [], ys: [] };
  const critical = { x: damped, text: `with its damper ${number(1000 * damped)}`, side: "end" };
  const free = { x: undamped, text: `2√(m/k) ${number(1000 * undamped)}`, class: "dashed", row: 1, side: "start" };
  const tens = [[1e-3, "0.001"], [1, "1"], [1e3, "1000"], [1e6, "10⁶"]];
  return charted(view, 0, {
    id: "cliff",
    height: view.height - COURSE,
    left: 64,
    x: { ...axis([low, high], "time step dt (ms)", ...[1, 2, 4, 8, 16].map((k) => [k * low, String(tidy(1000 * k * low))])), log: true },
    y: { ...axis([1e-5, MOST], "still moving at the end / r", [0, "0"], ...tens), log: true, zero: true },
    lines: [{ model: "penalty", ...known, class: "plainly" }],
    rules: view.width < 480 ? [critical] : [critical, free],
    points: [{ model: "penalty", x: within(low, dt, high), y: far, size: 8 }],
  });
}

function draw(view) {
  const dt = view.get("dt");
  const { run, blew_up: explodes, energy_excess: gained } = dropped(dt, ...knobsIn(view));
  const far = moves(run);
  const chart = chartOf(view, dt, far);
  const { low, high } = range(view);
  const text = `dt = ${number(1000 * dt)} ms`;
  const gains = gained > 1e-9 ? `the ball gains ${number(gained, 4)} times its energy` : "the ball gains no energy";
  const how = `${gains} ${explodes ? "and explodes" : far < 1e-6 ? "and comes to rest" : "and never rests"}`;
  return {
    svg: course(view, run) + shift(0, COURSE, chart.markup),
    words: `${text}: ${how}.`,
    handles: [handle("dt", chart.sx(within(low, dt, high)), COURSE + chart.sy(far), 14, "the time step", dt, `${text}, ${how}`)],
  };
}

const set = (view, dt) => view.set({ dt: within(LOW, tidy(dt), HIGH) });

export const figure = {
  title: "The cliff",
  caption: "Drag the time step: past the critical one the dropped ball never rests, and a little further it explodes.",
  height: 400,
  knobs: ["stiffness", "damping"],
  uses: ["dt"],
  shows: { dt: 0.03 },
  jobs: {
    curve([stiffness, damping, low, high]) {
      const xs = logGrid(low, high, 49);
      return { xs, ys: xs.map((dt) => moves(drop(dt, stiffness, damping))) };
    },
  },
  draw,
  ...alongAxis((view, share) => set(view, range(view).low * 16 ** share), (view, by) => set(view, view.get("dt") * 1.03 ** by)),
};
