/* The line of a step: the more impulse, the farther out the step ends. Each model asks for an
 * impulse in its own way, which is a line, too: lcp's stands upright where the step should end,
 * soft's leans, and penalty's is level, since its force was fixed where the step began. Where they
 * cross, the step ends. Values: by model the impulse [N s] and the gap at the end [r]. */
import { arrow, axis, ball, clipped, label, mark, plain, plot, table } from "../draw.js";
import { CONTACT_MARGIN, Contact, contact_target, FLOOR, soft_defaults, soften } from "../contact.js";
import { data } from "../data.js";
import { column, G, R, record } from "../runs.js";

const THREE = ["penalty", "lcp", "soft"];
const [LOW, HIGH, MOST, LARGER] = [-0.1, 0.06, 6, 8]; // r, r, N s; gaps are drawn so much larger

// One step of a model from a gap [r] that would end at `free`: its impulse and its end.
function stepped(model, { gap, free, ...own }) {
  const v = ((free - gap) * R) / own.dt + own.dt * G; // m/s, before gravity
  const run = record(model, column([(1 + gap) * R], { vy: v }), { ...own, restitution: 0 }, 1);
  return { lam: run.vy[1] - v + own.dt * G, end: run.y[1] / R - 1 };
}

// The line of what a model asks for [[gap at the end, impulse]].
function asks(model, { gap, free, dt, baumgarte }, lam) {
  const contact = new Contact(column([R], { vy: ((free - gap) * R) / dt + dt * G })[0], FLOOR, 0, 1, -gap * R);
  const near = -contact.depth < (model === "lcp" ? CONTACT_MARGIN : 0);
  if (!near || model === "penalty") return [[HIGH, lam], [LOW, lam]];
  contact.target = contact_target(contact, 0, baumgarte, dt);
  if (model === "soft") soften(contact, dt, ...soft_defaults(0, dt));
  const end = (impulse) => gap + ((contact.target - contact.softness * impulse) * dt) / R;
  return [[HIGH, 0], [end(0), 0], [end(1.07 * MOST), 1.07 * MOST]];
}

const short = (value) => plain(Number(value.toFixed(3)));

function draw(view) {
  const { own, width, height } = view;
  const { gap, free, dt } = own;
  const found = Object.fromEntries(THREE.map((model) => [model, stepped(model, own)]));
  const [left, floor] = [Math.round(0.32 * width), height - 90];
  const [r, x] = [Math.min(44, 0.28 * left), 0.42 * left];
  const at = (far) => floor - far * LARGER * r;
  const { sx, sy, box, picture, knob } = plot(view, {
    left: left + 8,
    x: axis([LOW, HIGH], "gap at the end of the step / r", -0.1, -0.05, 0, 0.05),
    y: axis([-0.035 * MOST, 1.07 * MOST], "impulse (N s)", 0, 2, 4, 6),
    lines: [
      { model: "body", points: [[free, 0], [free + (2 * MOST * dt) / R, 2 * MOST]], kind: "step-line" },
      ...THREE.map((model) => ({ model, points: asks(model, own, found[model].lam) })),
    ],
  });
  const what = { label: "the ball: its gap before the step", value: "gap", low: LOW, high: HIGH,
    step: 0.005, at: (_, to) => -to / LARGER / r };
  const told = THREE.map((model) => `${model} ${short(found[model].end)}`);
  return {
    picture: [
      clipped(0, 0, left, height, table(0, floor, left, 90),
        label(`gaps × ${LARGER}`, 4, 16, "start", "tick"),
        THREE.map((model) => ball(model, x, at(found[model].end) - r, r, "ghost")),
        arrow("weight", x + r + 14, at(gap), 0, at(free) - at(gap))),
      view.grab(what, ball("fixed", x, at(gap) - r, r)), picture,
      label("the step", Math.min(sx(free + (4.4 * dt) / R), box.right) - 12, sy(4.6), "end", "tick"),
      THREE.map((model, k) => {
        const [x, y] = [sx(found[model].end), sy(found[model].lam)];
        return [mark(model, x, y, 7), label(model, x + [12, 12, -12][k], y + [18, 18, -10][k], k < 2 ? "start" : "end")];
      }),
      knob("free", "where the ball would end without a push", 0.005),
    ],
    words: `From ${short(gap)} r to ${short(free)} r; with a push: ${told.join(", ")} r.`,
    values: found,
  };
}

export const figure = {
  title: "The line of a step",
  caption: "The more push, the farther out the step ends. Where its line crosses a model’s, it is solved.",
  height: (width) => (width < 480 ? 280 : 320),
  start: () => ({ gap: -0.02, free: -0.07, baumgarte: 1, dt: data.defaults.dt }),
  draw,
};
