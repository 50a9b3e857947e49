/* The sandbox: balls to throw, in real time, by the model that the reader chooses. */
import { ball, number, round, table } from "../draw.js";
import { lcpStep, penaltyStep, softStep } from "../engine.js";
import { data } from "../data.js";
import { knobsOf } from "../store.js";

const R = data.radius;
const STEP = { soft: softStep, lcp: lcpStep, penalty: penaltyStep };
const NEXT = { soft: "lcp", lcp: "penalty", penalty: "soft" };
const GROUND = 40;
const MOST = 9; // balls
const WALL = 1e3; // m: the radius of two held balls that serve as walls

const scaleOf = (view) => (view.height - GROUND) / 1.6; // px for a metre
const wide = (view) => view.width / scaleOf(view);

// The own state as a scene: the walls come last.
function sceneOf(view, { balls }) {
  const column = (name, left, right) => [...balls.map((each) => each[name]), left, right];
  return {
    x: column("x", -WALL, wide(view) + WALL),
    y: column("y", R, R),
    vx: column("vx", 0, 0),
    vy: column("vy", 0, 0),
    mass: column("mass", Infinity, Infinity),
    radius: column("radius", WALL, WALL),
  };
}

const fresh = (x, y) => ({ x, y, vx: 0, vy: 0, mass: 1, radius: R });
const stack = (x) => [0, 1, 2].map((k) => fresh(x, (2 * k + 1) * R));

// One step of the model for all balls; the one that is held stays in the hand.
function step(view, knobs) {
  const { own } = view;
  const scene = sceneOf(view, own);
  const next = STEP[own.model]({ ...scene, pushed: own.pushed }, scene, knobs);
  own.pushed = next.pushed;
  own.balls.forEach((each, k) => {
    if (`ball-${k}` === view.grabbed) return;
    for (const key of ["x", "y", "vx", "vy"]) each[key] = next[key][k];
    if (!Number.isFinite(each.y) || Math.abs(each.y) > 50) Object.assign(each, fresh(0.5 * wide(view), 1.2));
  });
}

export const figure = {
  title: "Sandbox",
  caption: "Throw balls, build a stack, and change the model under them. Real time, by the time step and the knobs that are set on this page.",
  height: 380,
  narrow: 320,
  knobs: ["restitution", "dt"],
  uses: ["stiffness", "damping", "baumgarte", "iters", "impedance", "timeconst", "dampratio"],
  start: () => ({ model: "soft", balls: stack(0.5).concat(fresh(1.1, R)), late: 0 }),
  buttons: [
    {
      label: (view) => (view.running() ? "Stop" : "Run"),
      press: (view) => (view.running() ? view.stop() : view.run()),
    },
    { label: (view) => `Model: ${view.own.model}`, press: (view) => (view.own.model = NEXT[view.own.model]) },
    {
      label: "Add a ball",
      press(view) {
        const { own } = view;
        if (own.balls.length < MOST) own.balls.push(fresh(0.3 + 0.23 * (own.balls.length % 5), 1.3));
        view.run();
      },
    },
    { label: "Stack again", press: ({ own }) => (own.balls = stack(0.5)) },
  ],
  draw(view) {
    const { own } = view;
    const scale = scaleOf(view);
    const place = (each) => [each.x * scale, view.height - GROUND - each.y * scale];
    const drawn = own.balls.map((each) => ball(own.model, ...place(each), R * scale));
    return {
      svg: table(0, view.height - GROUND, view.width, GROUND) + drawn.join(""),
      words: `${own.balls.length} balls by ${own.model}, at steps of ${round(1000 * view.get("dt"))} ms.`,
      handles: own.balls.map((each, k) => {
        const [x, y] = place(each);
        const text = `${number(each.y - R, 2)} m above the table`;
        return { name: `ball-${k}`, x, y, r: R * scale, label: `ball ${k + 1}`, value: each.y, text };
      }),
    };
  },
  drag(view, name, x, y) {
    const each = view.own.balls[Number(name.slice(5))];
    const [toX, toY] = [x / scaleOf(view), Math.max(R, (view.height - GROUND - y) / scaleOf(view))];
    Object.assign(each, { x: toX, y: toY, vx: 0, vy: 0 });
    if (!view.still) view.run();
  },
  nudge(view, name, dx, dy) {
    const each = view.own.balls[Number(name.slice(5))];
    Object.assign(each, { x: each.x + 0.02 * dx, y: Math.max(R, each.y - 0.02 * dy), vx: 0, vy: 0 });
  },
  release(view, name) {
    const [vx, vy] = view.flick().map((v) => Math.max(-5, Math.min(5, v / scaleOf(view))));
    Object.assign(view.own.balls[Number(name.slice(5))], { vx, vy: -vy });
  },
  tick(view, seconds) {
    const { own } = view;
    const knobs = knobsOf(view.values);
    own.late = Math.min(0.05, own.late + seconds);
    for (; own.late >= knobs.dt; own.late -= knobs.dt) step(view, knobs);
  },
};
