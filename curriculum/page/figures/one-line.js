/* One line: every contact with a softness R lies where its target is R times what it must carry.
 * The spring of penalty taken at the end of the step is one of them. */
import { axis, circle, label, mark, number } from "../draw.js";
import { soften } from "../engine.js";
import { atRest, charted, G, grip, kept, R, scene, softKnobs } from "../parts.js";

const [LOW, HIGH] = [1e-6, 1];
const ONE = scene([R]);
const OMEGA = 2 * Math.PI * 30; // 1/s, Box2D's 30 Hz, with a damping ratio of 10
const WAYS = {
  // {target, softness} of a contact of a ball of 1 kg, as each engine chooses them
  "implicit spring": (c, { stiffness, damping, dt }) => implicit(stiffness, damping, c.depth, dt),
  "MuJoCo’s soft": (c, knobs) => soften(c, ONE, ONE, knobs),
  "Box2D’s soft step": (c, { dt }) => implicit(OMEGA ** 2, 2 * 10 * OMEGA, c.depth, dt),
  "CFM and ERP": (c, { dt }) => ({ softness: 1e-5 / dt, target: (0.2 / dt) * c.depth }), // ODE's
};

// Spring and damper taken at the end of the step: lam = dt (k (depth - dt v_n) - c v_n).
function implicit(k, c, depth, dt) {
  const softness = 1 / (k * dt * dt + c * dt);
  return { softness, target: dt * k * depth * softness };
}

// Where a ball of 1 kg is at rest in one of these ways: {softness, target, depth [r]}.
const rests = kept((way, knobs) => atRest((c) => WAYS[way](c, knobs), knobs.dt));

function draw(view) {
  const knobs = softKnobs(view);
  const { dt, damping } = knobs;
  const tens = [[0, "0"], [1e-5, "10⁻⁵"], 0.001, 0.1];
  const { svg, sx, sy } = charted(view, {
    x: { ...axis([LOW, HIGH], "R m g dt (m/s)", ...tens), log: true, zero: true },
    y: { ...axis([LOW, HIGH], "target at rest (m/s)", ...tens), log: true, zero: true },
    lines: [{ model: "fixed", xs: [0, LOW, HIGH], ys: [0, LOW, HIGH], kind: "plainly" }],
  });
  const all = Object.keys(WAYS).map((name) => [name, rests(name, knobs)]);
  const places = all.map(([, { softness, target }]) => [sx(softness * G * dt), sy(target)]);
  const marks = all.map(([name], i) => {
    const [x, y] = places[i];
    const sign = i < 2 ? mark(["penalty", "soft"][i], x, y, 8) : circle(x, y, 6, "dot");
    const beside = [Math.min(x + 12, view.width - 8.2 * name.length), y + 20];
    return sign + label(name, ...(i < 2 && x > 150 ? [x - 18, y - 6, "end"] : beside));
  });
  const told = all.map(
    ([name, { softness, depth }]) => `${name} R = ${number(softness)} /kg, ${number(depth)} r deep`,
  );
  const hard = mark("lcp", sx(0), sy(0), 7) + label("lcp, R = 0", sx(0) + 58, sy(0) - 4);
  const softnessAt = (x) => sx.back(x) / (G * dt);
  const spring = {
    times: 1.1,
    at: (x) => (1 / softnessAt(x) - damping * dt) / (dt * dt),
  };
  const soft = {
    low: 1e-4, // of 1 - d
    high: 0.5,
    times: 1.1,
    get: () => 1 - view.get("impedance"),
    at: (x) => softnessAt(x) / (1 + softnessAt(x)),
    set: (left) => view.set({ impedance: Number((1 - left).toPrecision(5)) }),
  };
  const [k, d] = [`k = ${number(view.get("stiffness"))} N/m`, `d = ${view.get("impedance")}`];
  return {
    svg: svg + hard + marks.join(""),
    words: `At rest on one line, target = R m g dt: lcp R = 0; ${told.join("; ")}.`,
    handles: [
      grip(view, "stiffness", ...places[0], "the implicit spring: its stiffness", k, spring),
      grip(view, "impedance", ...places[1], "soft: its impedance", d, soft),
    ],
  };
}

export const figure = {
  title: "One line: target and softness R of a ball at rest",
  caption:
    "A spring taken at the end of the step, MuJoCo’s contact and other engines’ are lcp’s sweep " +
    "with a softness R, and at rest their targets lie on one line: drag the spring or soft along " +
    "it.",
  height: 330,
  draw,
};
