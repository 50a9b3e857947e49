/* The corner, five times: gap to the right, force upwards, what a model allows as a line, and the state
 * that runs along it while the reader lifts the ball or presses it into the table. */
import { arrow, ball, el, number, table } from "./draw.js";
import { knobsOf } from "./store.js";
import { pushOfTable, runModel, soften } from "./engine.js";
import { axis, beside, forceLength, G, handle, kept, label, line, R, scene, softKnobs, within } from "./parts.js";

const PULL = 64; // px below the ball at which the hand presses hardest
// What a picture shows: gaps from low to high [r], a radius in px, the hardest press in weights, ticks.
const WIDE = { low: -0.4, high: 1, r: 60, most: 30, xs: [0, 0.5, 1], ys: [0, 10, 20, 30] };
const NEAR = { low: -0.03, high: 0.06, r: 1200, most: 12, xs: [-0.02, 0, 0.04], ys: [0, 4, 8, 12] };
const floorOf = (view) => view.height - 74;
const radius = (law, view) => law.near.r * Math.min(1, view.width / 430); // px
const gripOf = (view) => floorOf(view) - 60 * Math.min(1, view.width / 430); // where a ball at rest is held

// hand: above 0 the ball is held so high [r]; below 0 it is pressed, at -1 as hard as the picture shows.
function stateOf(law, view) {
  const { hand } = view.own;
  const load = Math.max(0, -hand) * Math.min(law.near.most, law.most ? law.most(view) : Infinity);
  return { load, gap: load > 0 ? law.gap(load, view) : Math.max(0, hand) };
}

const handY = (law, view) => gripOf(view) - view.own.hand * (view.own.hand > 0 ? radius(law, view) : PULL);

function picture(law, view, state, left) {
  const [floor, x, r] = [floorOf(view), left / 2, radius(law, view)];
  const y = floor - r - state.gap * r;
  const pull = forceLength(state.load, 14);
  const held = view.own.hand > 0;
  return [
    table(0, floor, left, 74),
    ball(law.model, x, y, r, r > 100 ? "ball plainly" : "ball"),
    law.ghosts ? law.ghosts(view, state, x, floor, r) : "",
    arrow(`push m-${law.model}`, x + Math.min(r, left / 2 - 26) + 12, floor, 0, -forceLength(state.load, 100 / Math.sqrt(law.near.most))),
    held ? line(x, y, x, 0, "hand") : arrow("weight", x, Math.max(2, y - r - pull), 0, Math.min(pull, y - r - 2)),
  ].join("");
}

const allowed = ({ box, sx, sy }) => el("path", { d: `M${box.right} ${sy(0)}H${sx(0)}V${box.top}`, class: "allowed" });

function draw(law, view) {
  const state = stateOf(law, view);
  const { low, high, most, xs, ys } = law.near;
  const chart = {
    x: axis([low, high], "gap / r", ...xs),
    y: axis([-0.035 * most, 1.07 * most], "force / m g", ...ys),
    points: [{ model: law.model, x: state.gap, y: Math.min(1.05 * most, state.load), size: 7 }],
    lines: [{ model: law.model, ...law.curve(view), class: "law plainly" }],
    under: (each) => allowed(each) + (law.more ? law.more(view, state, each) : ""),
  };
  const { svg, middle } = beside(view, law.name, chart, (left) => picture(law, view, state, left));
  const said = state.load > 0 ? `Pressed with ${number(state.load, 2)} m g` : "Held by the hand";
  const text = `gap ${number(state.gap, 2)} r, force ${number(state.load, 2)} m g`;
  return {
    svg,
    words: `${said}: ${text}.${law.words ? ` ${law.words(view, state)}` : ""}`,
    handles: [handle("ball", middle, handY(law, view), 20, "the ball: lift it or press it", view.own.hand, text)],
  };
}

// A corner with one model's law: {name, model, near, gap(load, view), curve(view), ...}.
export function corner(law, about) {
  const set = (view, hand) => (view.own.hand = Number(within(-1, hand, law.near.high).toFixed(3)));
  return {
    height: 260,
    start: () => ({ hand: law.hand ?? 0.5 * law.near.high }),
    draw: (view) => draw(law, view),
    drag(view, name, x, y) {
      const up = gripOf(view) - y;
      set(view, up / (up > 0 ? radius(law, view) : PULL));
    },
    nudge(view, name, dx, dy) {
      const above = view.own.hand - 1e-9 * dy > 0;
      set(view, view.own.hand - 0.05 * dy * (above ? law.near.high : 1));
    },
    ...about,
  };
}

const TOP = 1.07 * WIDE.most;
const wall = { xs: [WIDE.high, 0, 0], ys: [0, 0, TOP] };
const bare = { near: WIDE, model: "exact", gap: () => 0, curve: () => wall };
export const LAWS = {
  corner: { ...bare, name: "corner" },
  exact: { ...bare, name: "corner-exact" },
};

// The two events at which exact changes from one side of the corner to the other.
LAWS.exact.more = (view, state, { sx, sy, box }) =>
  el("circle", { cx: sx(0), cy: sy(0), r: 12, class: "event" }) +
  label("gap → 0", sx(0.98), sy(0) - 12, "end") +
  label("force → 0", sx(0) + 10, box.top + 14);
LAWS.exact.words = (view, state) =>
  state.load > 0 ? "It rests until the force falls to 0: an event." : "It flies until the gap falls to 0: an event.";

const stiffest = (view) => view.get("stiffness") * R / G; // weights a radius
LAWS.penalty = {
  name: "corner-penalty",
  hand: -0.5,
  model: "penalty",
  near: WIDE,
  most: (view) => -WIDE.low * stiffest(view),
  gap: (load, view) => -load / stiffest(view),
  curve: (view) => ({ xs: [WIDE.high, 0, -TOP / stiffest(view)], ys: [0, 0, TOP] }),
};

/* lcp: the ball comes from FROM radii above, drawn down by the load, and lcp looks once a step. A load of
 * L weights is a gravity of L g, and that is our own gravity where the clock runs sqrt(L) as fast. */
const FROM = 0.8;
const arrival = kept((load, knobs) => {
  const one = scene([(1 + FROM) * R]);
  const run = runModel("lcp", one, { ...knobs, dt: knobs.dt * Math.sqrt(load) }, 400);
  const gaps = Array.from(run.y, (y) => (y - R) / R);
  const forces = gaps.map((_, row) => (row ? (load * pushOfTable(run, one, row)) / G : 0));
  const still = gaps.findIndex((gap, row) => row > 1 && forces[row] > 0 && Math.abs(gap - gaps[row - 1]) < 1e-6);
  const shown = still < 0 ? gaps.length : still + 1;
  return { gaps: gaps.slice(0, shown), forces: forces.slice(0, shown) };
});
function looks(view, { load }) {
  if (load < 1) return { gaps: [], forces: [], deepest: 0 };
  const found = arrival(load, { ...knobsOf(view.values), restitution: 0 });
  return { ...found, deepest: Math.min(0, ...found.gaps) };
}

LAWS.lcp = {
  ...bare,
  name: "corner-lcp",
  hand: -0.6,
  model: "lcp",
  more(view, state, { sx, sy }) {
    const { gaps, forces } = looks(view, state);
    const rings = gaps.map((gap, row) => [sx(gap), sy(Math.min(1.05 * WIDE.most, forces[row]))]);
    return rings.map(([cx, cy]) => el("circle", { cx, cy, r: 4, class: "look m-lcp" })).join("");
  },
  ghosts: (view, state, x, floor, r) =>
    state.load < 1 ? "" : ball("lcp", x, floor - r - looks(view, state).deepest * r, r, "ghost"),
  words(view, state) {
    const { gaps, deepest } = looks(view, state);
    const deep = `the step before the first push ended ${number(-deepest, 2)} r deep`;
    return gaps.length ? `It came in ${gaps.length} steps; ${deep}.` : "";
  },
};

// soft: at rest the solver asks for no velocity where lam = target / R.
const softLoad = (gap, view) => {
  const knobs = softKnobs(view);
  const contact = { i: 0, j: -1, nx: 0, ny: 1, depth: -gap * R };
  const { target, softness } = soften(contact, scene([R * (1 + gap)]), scene([R]), knobs);
  return target / softness / (G * knobs.dt);
};
const softGap = (load, view) => {
  let [low, high] = [-2, 0];
  for (let k = 0; k < 50; k++) {
    const middle = 0.5 * (low + high);
    if (softLoad(middle, view) > load) low = middle;
    else high = middle;
  }
  return low;
};
LAWS.soft = {
  name: "corner-soft",
  hand: -0.5,
  model: "soft",
  near: NEAR,
  most: (view) => softLoad(NEAR.low, view),
  gap: softGap,
  curve(view) {
    const xs = [NEAR.high, ...Array.from({ length: 61 }, (_, k) => (1.2 * NEAR.low * k) / 60)];
    return { xs, ys: xs.map((gap) => (gap < 0 ? softLoad(gap, view) : 0)) };
  },
};
