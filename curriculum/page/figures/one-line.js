/* One line: every contact with a softness R lies where its target is R times what it must carry. The
 * spring of penalty taken at the end of the step is one of them. */
import { el, mark, number } from "../draw.js";
import { detectContacts, GRAVITY, makeRows, soften, solveContacts } from "../engine.js";
import { alongAxis, axis, charted, G, handle, kept, label, R, scene, softKnobs, tidy, within } from "../parts.js";

const [LOW, HIGH] = [1e-6, 1];
const OMEGA = 2 * Math.PI * 30; // 1/s, Box2D's 30 Hz
const WAYS = {
  // {target, softness} of a contact of a ball of 1 kg, as each engine chooses them
  "implicit spring": (c, { stiffness, damping, dt }) => implicit(stiffness, damping, c.depth, dt),
  "MuJoCo’s soft": (c, knobs, state, one) => soften(c, state, one, knobs),
  "Box2D’s soft step": (c, { dt }) => implicit(OMEGA ** 2, 2 * 10 * OMEGA, c.depth, dt), // a damping ratio of 10
  "CFM and ERP": (c, { dt }) => ({ softness: 1e-5 / dt, target: (0.2 / dt) * c.depth }), // ODE's defaults
};

// Spring and damper taken at the end of the step: lam = dt (k (depth - dt v_n) - c v_n).
function implicit(k, c, depth, dt) {
  const softness = 1 / (k * dt * dt + c * dt);
  return { softness, target: dt * k * depth * softness };
}

// A ball of 1 kg comes to rest by lcp's sweep with this way's {target, softness}: {softness, target, depth}.
function rests(way, knobs) {
  const one = scene([R]);
  const state = { x: [0], y: [R], vx: [0], vy: [0] };
  let last = { softness: 0, target: 0 };
  for (let step = 0; step < 4000; step++) {
    const contacts = detectContacts(state.x, state.y, one.radius, 0);
    const asked = contacts.map((c) => way(c, knobs, state, one));
    state.vy[0] += knobs.dt * GRAVITY;
    const rows = makeRows(contacts, one.mass, asked.map((each) => each.target), asked.map((each) => each.softness));
    solveContacts(rows, state.vx, state.vy, { iters: 1 });
    state.y[0] += knobs.dt * state.vy[0];
    if (asked.length) last = asked[0];
    if (asked.length && Math.abs(state.vy[0]) < 1e-9) break; // m/s
  }
  return { ...last, depth: 1 - state.y[0] / R };
}

const atRest = kept((name, knobs) => rests(WAYS[name], knobs));

// The points, the two that can be dragged first: [name, what it rests with].
function points(view) {
  const knobs = softKnobs(view);
  const { stiffness, damping, dt, solimp, solref } = knobs;
  const told = [{ stiffness, damping, dt }, { dt, solimp, solref, restitution: 0 }, { dt }, { dt }];
  return Object.keys(WAYS).map((name, k) => [name, atRest(name, told[k])]);
}

function chartOf(view) {
  const tens = [[0, "0"], [1e-5, "10⁻⁵"], [1e-3, "0.001"], [0.1, "0.1"]];
  return charted(view, 0, {
    id: "one-line",
    x: { ...axis([LOW, HIGH], "R m g dt (m/s)", ...tens), log: true, zero: true },
    y: { ...axis([LOW, HIGH], "target at rest (m/s)", ...tens), log: true, zero: true },
    lines: [{ model: "fixed", xs: [0, LOW, HIGH], ys: [0, LOW, HIGH], class: "plainly" }],
  });
}

function draw(view) {
  const chart = chartOf(view);
  const all = points(view);
  const at = ({ softness, target }) => [chart.sx(softness * G * view.get("dt")), chart.sy(target)];
  const marks = all.map(([name, rest], k) => {
    const [x, y] = at(rest);
    const left = k < 2 && x > 150;
    const place = left ? [x - 18, y - 6, "end"] : [Math.min(x + 12, view.width - 8.2 * name.length), y + 20];
    const sign = k < 2 ? mark(["penalty", "soft"][k], x, y, 8) : el("circle", { cx: x, cy: y, r: 6, class: "dot" });
    return sign + label(name, ...place);
  });
  const [spring, mujoco] = all.map(([, rest]) => at(rest));
  const [k, d] = [view.get("stiffness"), view.get("impedance")];
  const depths = all.map(([name, rest]) => `${name} R = ${number(rest.softness)} /kg, ${number(rest.depth)} r deep`);
  const hard = mark("lcp", chart.sx(0), chart.sy(0), 7) + label("lcp, R = 0", chart.sx(0) + 14, chart.sy(0) - 10);
  return {
    svg: chart.markup + hard + marks.join(""),
    words: `At rest on one line, target = R m g dt: lcp R = 0; ${depths.join("; ")}.`,
    handles: [
      handle("spring", ...spring, 15, "the implicit spring: its stiffness", k, `k = ${number(k)} N/m`),
      handle("soft", ...mujoco, 15, "soft: its impedance", d, `d = ${d}`),
    ],
  };
}

const stiffen = (view, k) => view.set({ stiffness: within(100, tidy(k), 1e6) });
const give = (view, left) => view.set({ impedance: within(0.5, Number((1 - tidy(left)).toFixed(7)), 0.9999) }); // left: 1 - d

// Sets the knob that puts a point where it is dragged. The axis ends in a decade that leads to 0.
function put(view, share, name) {
  const dt = view.get("dt");
  const softness = (HIGH * (LOW / HIGH / 10) ** (1 - share)) / (G * dt);
  if (name === "spring") stiffen(view, (1 / softness - view.get("damping") * dt) / (dt * dt));
  else give(view, softness / (1 + softness));
}

function step(view, by, name) {
  if (name === "spring") stiffen(view, view.get("stiffness") * 1.1 ** -by);
  else give(view, (1 - view.get("impedance")) * 1.1 ** by);
}

export const figure = {
  title: "One line: target and softness R of a ball at rest",
  caption:
    "A spring taken at the end of the step, MuJoCo’s contact and other engines’ are lcp’s sweep with a softness R, and at rest their targets lie on one line: drag the spring or soft along it.",
  height: 330,
  uses: ["stiffness", "damping", "dt", "impedance", "timeconst", "dampratio"],
  draw,
  ...alongAxis(put, step),
};
