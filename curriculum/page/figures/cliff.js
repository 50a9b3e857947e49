/* The cliff: with a step longer than the critical one the ball never rests, and soon explodes. The
 * puzzle is the same at one step: a spring on which the ball hardly sinks, yet comes to rest. */
import { axis, number, plain, plot, within } from "../draw.js";
import { criticalDt, quality, runModel } from "../engine.js";
import { decades, FARTHEST, G, grip, kept, R, scene, START, stillMoves } from "../kit.js";

const [LOW, HIGH] = [0.0005, 0.064]; // s
const SECONDS = 4;
const STEPS = 2000; // as many as contact.py takes
const LEFT = [[0, "0"], 0.001, 1, 1000, [1e6, "10⁶"]]; // ticks
const COURSE = 170; // px of the upper chart
const TOP = 1.5; // m, of a ball that stays

const moves = (...knobs) => stillMoves(...knobs, STEPS, STEPS / 4 + 1); // in the last quarter
const dropped = kept((dt, stiffness, damping) => {
  const ball = scene([START]);
  const run = runModel("penalty", ball, { dt, stiffness, damping }, STEPS);
  return { run, ...quality(run, ball) };
});
// That for many steps, from one on to one 16 times as long.
const curve = kept((low, ...spring) => {
  const xs = Array.from({ length: 97 }, (_, k) => low * 16 ** (k / 96));
  return { xs, ys: xs.map((dt) => moves(dt, ...spring)) };
});

// The height over time, all of it: where the ball flies away, in powers of ten.
function course(view, { t, y }) {
  const end = Math.min(STEPS, t.findIndex((time) => time > SECONDS) >>> 0);
  const top = y.subarray(0, end + 1).reduce((most, each) => (each > most ? each : most), 0);
  const calm = axis([-TOP / 6, TOP], "height (m)", 0, 1);
  return plot([0, 0, view.width, COURSE], {
    x: axis([0, SECONDS], "time (s)", 0, 1, 2, 3, 4),
    y: top > TOP ? decades(top, "height (m)", [0, "0"], 1, 10, 100) : calm,
    margin: 64,
    lines: [{ model: "penalty", xs: t, ys: y, to: end }],
    rules: [{ y: 0 }],
  }).svg;
}

function draw(view) {
  const [dt, k, c] = ["dt", "stiffness", "damping"].map(view.get);
  const { run, blew_up: explodes, energy_excess: gained } = dropped(dt, k, c);
  const far = moves(dt, k, c);
  const { damped, undamped } = criticalDt(1, k, c);
  // the shortest step that is shown: the critical one is seven times, the longest 16 times as long
  const low = within(LOW, Number((damped / 6.8).toPrecision(1)), HIGH / 16);
  const shown = within(low, dt, 16 * low);
  const critical = { x: damped, text: `with its damper ${number(1000 * damped)}`, side: "end" };
  const free = { x: undamped, text: `2√(m/k) ${number(1000 * undamped)}`, kind: "dashed", row: 1 };
  const ticks = [1, 2, 4, 8, 16].map((times) => [times * low, plain(1000 * times * low)]);
  const chart = plot([0, COURSE, view.width, view.height - COURSE], {
    margin: 64,
    x: { ...axis([low, 16 * low], "time step dt (ms)", ...ticks), log: true },
    y: { ...axis([1e-5, FARTHEST], "still moving at the end / r", ...LEFT), log: true, zero: true },
    lines: [{ model: "penalty", ...curve(low, k, c), kind: "plainly" }],
    rules: view.width < 480 ? [critical] : [critical, free],
    points: [{ model: "penalty", x: shown, y: far, size: 8 }],
  });
  const gains = gained > 1e-9 ? `${number(gained, 4)} times its energy` : "no energy";
  const ends = explodes ? "explodes" : far < 1e-6 ? "comes to rest" : "never rests";
  const sinks = `It sinks ${number(G / k / R, 2)} r where it rests`;
  const text = `dt = ${number(1000 * dt)} ms: the ball gains ${gains} and ${ends}`;
  const range = { times: 1.03, at: chart.sx.back };
  return {
    svg: course(view, run) + chart.svg,
    words: `${text}. ${sinks}.`,
    handles: [grip(view, "dt", chart.sx(shown), chart.sy(far), "the time step", text, range)],
  };
}

const form = { height: 420, knobs: ["stiffness", "damping"], draw };
export const figures = {
  cliff: {
    title: "The cliff",
    caption:
      "Drag the time step: past the critical one the dropped ball never rests, and a little " +
      "further it explodes.",
    ...form,
  },
  puzzle: {
    title: "A puzzle: one spring, two wishes",
    caption:
      "Turn stiffness and damping until the ball sinks less than a thousandth of its radius and " +
      "still comes to rest at this time step.",
    ...form,
  },
};
