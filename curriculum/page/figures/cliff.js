/* The cliff: with a step longer than the critical one the ball never rests, and soon explodes. */
import { axis, number, plain, plot, within } from "../draw.js";
import { criticalDt, quality, runModel } from "../engine.js";
import { drops, G, grip, kept, R, scene, START } from "../kit.js";

const [LOW, HIGH] = [0.0005, 0.064]; // s
const STEPS = 2000; // as many as contact.py takes
const NONE = 1e-6; // r: less is drawn as zero
const LEFT = [[NONE, "0"], 0.001, 1, 1000, [1e6, "10⁶"]]; // ticks

const FARTHEST = 1e9; // r, of a ball that is nowhere

// How far the ball still moves in the last quarter [r].
function moves(dt, stiffness, damping) {
  const late = drops(dt, stiffness, damping, STEPS).subarray(-(STEPS / 4 + 1));
  const far = (late.reduce((a, b) => Math.max(a, b)) - late.reduce((a, b) => Math.min(a, b))) / R;
  return Number.isFinite(far) ? Math.min(FARTHEST, far) : FARTHEST;
}

const dropped = kept((dt, stiffness, damping) => {
  const ball = scene([START]);
  return quality(runModel("penalty", ball, { dt, stiffness, damping }, STEPS), ball);
});
// That for many steps, from one on to one 16 times as long.
const curve = kept((low, ...spring) => {
  const xs = Array.from({ length: 97 }, (_, k) => low * 16 ** (k / 96));
  return { xs, ys: xs.map((dt) => moves(dt, ...spring)) };
});

function draw(view) {
  const [dt, k, c] = ["dt", "stiffness", "damping"].map(view.get);
  const { blew_up: explodes, energy_excess: gained } = dropped(dt, k, c);
  const far = moves(dt, k, c);
  const { damped, undamped } = criticalDt(1, k, c);
  // the shortest step that is shown: the critical one is seven times, the longest 16 times as long
  const low = within(LOW, Number((damped / 6.8).toPrecision(1)), HIGH / 16);
  const shown = within(low, dt, 16 * low);
  const critical = { x: damped, text: `with its damper ${number(1000 * damped)}`, side: "end" };
  const free = { x: undamped, text: `2√(m/k) ${number(1000 * undamped)}`, kind: "dashed", row: 1 };
  const ticks = [1, 2, 4, 8, 16].map((times) => [times * low, plain(1000 * times * low)]);
  const chart = plot([0, 0, view.width, view.height], {
    x: { ...axis([low, 16 * low], "time step dt (ms)", ...ticks), log: true },
    y: { ...axis([NONE, FARTHEST], "still moving at the end / r", ...LEFT), log: true },
    lines: [{ model: "penalty", ...curve(low, k, c), kind: "plainly" }],
    rules: view.width < 480 ? [critical] : [critical, free],
    points: [{ model: "penalty", x: shown, y: far, size: 8 }],
  });
  const gains = gained > 1e-9 ? `${number(gained, 4)} times its energy` : "no energy";
  const ends = explodes ? "explodes" : far < NONE ? "comes to rest" : "never rests";
  const sinks = `It sinks ${number(G / k / R, 2)} r where it rests`;
  const text = `dt = ${number(1000 * dt)} ms: the ball gains ${gains} and ${ends}`;
  const range = { times: 1.03, at: chart.sx.back };
  return {
    svg: chart.svg,
    words: `${text}. ${sinks}.`,
    handles: [grip(view, "dt", chart.sx(shown), chart.sy(far), "the time step", text, range)],
  };
}

export const figure = {
  title: "The cliff",
  caption:
    "Drag the time step: past the critical one the dropped ball never rests, and a little " +
    "further it explodes.",
  height: 270,
  knobs: ["dt", "stiffness", "damping"],
  draw,
};
