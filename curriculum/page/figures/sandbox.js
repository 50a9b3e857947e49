/* The sandbox: balls to throw, in real time, by the model that the reader chooses. */
import { ball, round, table } from "../draw.js";
import { lcpStep, penaltyStep, softStep } from "../engine.js";
import { inHand, knobs, R } from "../parts.js";

const STEP = { soft: softStep, lcp: lcpStep, penalty: penaltyStep };
const NEXT = { soft: "lcp", lcp: "penalty", penalty: "soft" };
const GROUND = 40; // px
const MOST = 9; // balls
const WALL = 1e3; // m: the radius of two held balls that serve as walls

const scaleOf = (view) => (view.height - GROUND) / 1.6; // px for a metre
const wide = (view) => view.width / scaleOf(view); // m
const fresh = (x, y) => ({ x, y, vx: 0, vy: 0, mass: 1, radius: R });
const stack = (x) => [0, 1, 2].map((k) => fresh(x, (2 * k + 1) * R));
const wall = (x) => ({ ...fresh(x, R), mass: Infinity, radius: WALL });

// One step of the model for all balls; the one that is held stays in the hand.
function step(view, told) {
  const { own } = view;
  const all = [...own.balls, wall(-WALL), wall(wide(view) + WALL)];
  const column = (name) => [name, all.map((each) => each[name])];
  const scene = Object.fromEntries(Object.keys(all[0]).map(column));
  const next = STEP[own.model]({ ...scene, pushed: own.pushed }, scene, told);
  own.pushed = next.pushed;
  own.balls.forEach((each, k) => {
    if (String(k) === view.grabbed) return;
    for (const key of ["x", "y", "vx", "vy"]) each[key] = next[key][k];
    if (!(Math.abs(each.y) < 50)) Object.assign(each, fresh(0.5 * wide(view), 1.2));
  });
}

function draw(view) {
  const { balls, model } = view.own;
  const [scale, floor] = [scaleOf(view), view.height - GROUND];
  const hold = (each, k) =>
    inHand(view, String(k), `ball ${k + 1}`, floor, scale, {
      place: () => [each.x, each.y],
      put(x, y) {
        Object.assign(each, { x, y: Math.max(R, y), vx: 0, vy: 0 });
        if (view.grabbed && !view.still) view.run();
      },
      letGo: ([vx, vy]) => Object.assign(each, { vx, vy }),
    });
  const handles = balls.map(hold);
  const drawn = handles.map(({ x, y, r }) => ball(model, x, y, r));
  return {
    svg: table(0, floor, view.width, GROUND) + drawn.join(""),
    words: `${balls.length} balls by ${model}, at steps of ${round(1000 * view.get("dt"))} ms.`,
    handles,
  };
}

function add(view) {
  const { balls } = view.own;
  if (balls.length < MOST) balls.push(fresh(0.3 + 0.23 * (balls.length % 5), 1.3));
  view.run();
}

export const figure = {
  title: "Sandbox",
  caption:
    "Throw balls, build a stack, and change the model under them. Real time, by the time step " +
    "and the knobs that are set on this page.",
  height: 380,
  narrow: 320,
  knobs: ["restitution", "dt"],
  start: () => ({ model: "soft", balls: stack(0.5).concat(fresh(1.1, R)), late: 0 }),
  buttons: [
    {
      label: (view) => (view.running ? "Stop" : "Run"),
      press: (view) => (view.running ? view.stop() : view.run()),
    },
    {
      label: ({ own }) => `Model: ${own.model}`,
      press: ({ own }) => (own.model = NEXT[own.model]),
    },
    { label: "Add a ball", press: add },
    { label: "Stack again", press: ({ own }) => (own.balls = stack(0.5)) },
  ],
  draw,
  tick(view, seconds) {
    const { own } = view;
    const told = knobs(view);
    own.late = Math.min(0.05, own.late + seconds);
    for (; own.late >= told.dt; own.late -= told.dt) step(view, told);
  },
};
