/* The corner: gap to the right, force upwards, what a model allows as a thick line. */
import { arrow, axis, ball, label, lane, line, mark, number, plot, range } from "../draw.js";
import { Contact, FLOOR, soft_defaults, soften } from "../contact.js";
import { column, G, R } from "../runs.js";

const WIDE = { low: -0.4, high: 1, most: 30, larger: 1, ticks: [0, 10, 20, 30] }; // r, m g
const NEAR = { low: -0.03, high: 0.06, most: 12, larger: 12, ticks: [0, 4, 8, 12] };

// soft at rest: the load [m g] so deep [r], where the solver asks for no velocity: lam = target / R.
function softLoad(deep, { impedance: d, dt }) {
  const contact = new Contact(column([R])[0], FLOOR, 0, 1, deep * R);
  soften(contact, dt, ...soft_defaults(0, dt, null, [2 * d - 1, d, 0.001, 0.5, 2]));
  return contact.target / contact.softness / (G * dt);
}

// What is shown of a law, the hardest press in the picture, and its line [[gap, load]].
const LAWS = {
  exact: () => ({ shown: WIDE, most: WIDE.most, curve: [[0, 0], [0, 2 * WIDE.most]] }),
  penalty({ stiffness }) {
    const steep = (stiffness * R) / G; // weights a radius
    return { shown: WIDE, most: -WIDE.low * steep, curve: [[0, 0], [(-2 * WIDE.most) / steep, 2 * WIDE.most]] };
  },
  soft: (own) => ({ shown: NEAR, most: softLoad(-NEAR.low, own),
    curve: range(61, (k) => (k / 50) * -NEAR.low).map((deep) => [-deep, deep && softLoad(deep, own)]) }),
};

// The gap under a load, on a law's line.
function gapUnder(load, curve) {
  const next = curve.findIndex(([, each]) => each >= load);
  const [[x, y], [toX, toY]] = curve.slice(next - 1, next + 1);
  return x + ((toX - x) * (load - y)) / (toY - y);
}

function draw(view) {
  const { own: { model, hand } } = view;
  const { curve, shown, most } = LAWS[model](view.own);
  const load = Math.max(0, -hand) * Math.min(shown.most, most); // m g
  const gap = load > 0 ? gapUnder(load, curve) : Math.max(0, hand) * shown.high;
  const { left, x, r, floor, at, drawn } = lane(view, { share: 0.4, larger: shown.larger });
  const { sx, sy, picture } = plot(view, {
    left, x: axis([shown.low, shown.high], "gap / r", shown.low > -0.1 ? shown.low : 0, 0, shown.high / 2),
    y: axis([-0.035 * shown.most, 1.07 * shown.most], "force / m g", ...shown.ticks),
    lines: [{ model, points: [[shown.high, 0], ...curve], kind: "law plainly" }],
  });
  const what = { label: "the ball: lift it or press it", value: "hand", low: -1, high: 1, step: 0.05,
    at: (_, y) => -y / r };
  const long = 10 + 3 * Math.sqrt(load); // px, of the arrow that presses
  return {
    picture: [
      drawn(load > 0 ? arrow("weight", x, at(gap) - r - 4 - long, 0, long) : line(x, at(gap), x, 0),
        arrow(`push m-${model}`, x + r + 12, floor, 0, -100 * Math.sqrt(load / shown.most))),
      view.grab(what, ball(model, x, at(gap), r)), picture, mark(model, sx(gap), sy(load), 7),
    ],
    words: `${load > 0 ? `Pressed with ${number(load, 2)} m g` : "Held by the hand"}: gap ` +
      `${number(gap, 2)} r, force ${number(load, 2)} m g.`,
  };
}

const CAPTIONS = {
  exact: "Lift the ball: a gap and no force. Press it: a force and no gap.",
  penalty: "A ramp beside the wall: the ball must get in before the table pushes.",
  soft: "The ball gives way at first, and the slope grows steeper with the depth.",
};

export const figure = {
  title: ({ model }) => `The corner: gap and force, ${model}`,
  caption: ({ model }) => CAPTIONS[model],
  height: (width) => (width < 480 ? 240 : 300),
  knobs: ({ model }) => ({ penalty: ["stiffness"], soft: ["impedance"] })[model] ?? [],
  room: 1,
  start: ({ model }) => ({ model: "exact", hand: model ? -0.5 : 0.5, choice: model ? 0 : 1 }),
  switches: ({ choice }) => (choice ? Object.keys(LAWS).map((model) => [model, "model", model]) : []),
  draw,
};
