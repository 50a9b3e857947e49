/* The corner: gap to the right, force upwards, what a model allows as a thick line, and the state
 * that runs along it while the ball is lifted or pressed into the table. */
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

// {gap(load), curve}: the gap [r] under a load [m g], the line that is allowed; what is shown of it,
// and the hardest press in the picture.
const LAWS = {
  exact: () => ({ gap: () => 0, shown: WIDE, most: WIDE.most, curve: [[0, 0], [0, 2 * WIDE.most]] }),
  penalty({ stiffness }) {
    const steep = (stiffness * R) / G; // weights a radius
    return { gap: (load) => -load / steep, shown: WIDE, most: -WIDE.low * steep,
      curve: [[0, 0], [(-2 * WIDE.most) / steep, 2 * WIDE.most]] };
  },
  soft(own) {
    const gap = (load, less = 0, more = 2) => { // found by halving
      const middle = 0.5 * (less + more);
      if (middle === less || middle === more) return -more;
      return softLoad(middle, own) > load ? gap(load, less, middle) : gap(load, middle, more);
    };
    const depths = range(61, (k) => (k / 50) * NEAR.low);
    return { gap, shown: NEAR, most: softLoad(-NEAR.low, own),
      curve: depths.map((each) => [each, each && softLoad(-each, own)]) };
  },
};

function draw(view) {
  const { own: { model, hand } } = view;
  const { gap: gapOf, curve, shown, most } = LAWS[model](view.own);
  const load = Math.max(0, -hand) * Math.min(shown.most, most); // m g
  const gap = load > 0 ? gapOf(load) : Math.max(0, hand) * shown.high;
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
  height: (width) => (width < 480 ? 260 : 300),
  knobs: ({ model }) => ({ penalty: ["stiffness"], soft: ["impedance"] })[model] ?? [],
  room: 1,
  start: ({ model = "exact" }) => ({ model, hand: model === "exact" ? 0.5 : -0.5 }),
  switches: () => Object.keys(LAWS).map((model) => [model, "model", model]),
  draw,
};
