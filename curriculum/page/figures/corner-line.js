/* The line of a step: the more impulse, the farther out it ends; and the line of what each model
 * asks for: lcp's is upright, that of the spring from after the step leans, penalty's is level. */
import { arrow, axis, ball, label, lane, mark, plain, plot, within } from "../draw.js";
import { CONTACT_MARGIN, Contact, contact_target, FLOOR } from "../contact.js";
import { column, G, R, record, springOf } from "../runs.js";

const [LOW, HIGH, MOST] = [-0.1, 0.06, 6]; // r, r, N s

// One step of a model: where it ends [r], with which impulse, the line of what it asks for, and where
// on it its name stands [gap at the end, impulse].
function stepped(model, own) {
  const { gap, free, dt, baumgarte } = own;
  const [kick, fall] = [dt * G, ((free - gap) * R) / dt]; // m/s: of gravity, after it
  const [one] = column([(1 + gap) * R], { vy: fall + kick });
  const contact = new Contact(one, FLOOR, 0, 1, -gap * R);
  contact.target = contact_target(contact, 0, baumgarte, dt);
  if (model === "implicit") [contact.softness, contact.target] = springOf(own)(contact.depth);
  const near = -contact.depth < (model === "lcp" ? CONTACT_MARGIN : 0);
  const run = record(model, [one], { ...own, restitution: 0 }, 1);
  const [end, lam] = [run.y[1] / R - 1, run.vy[1] - fall];
  const asks = (impulse) => gap + ((contact.target - contact.softness * impulse) * dt) / R;
  const level = !near || model === "penalty";
  const line = level ? [[HIGH, lam], [LOW, lam]] : [[HIGH, 0], [asks(0), 0], [asks(2 * MOST), 2 * MOST]];
  return { model, end, lam, line, name: level ? [HIGH, lam]
    : [within(LOW, asks(0.95 * MOST), HIGH - 0.02), 0.95 * MOST] };
}

const short = (value) => plain(Number(value.toFixed(3)));

function draw(view) {
  const { own: { gap, free, dt } } = view;
  const found = view.own.models.split(",").map((model) => stepped(model, view.own));
  const { left, x, r, larger, at, drawn } = lane(view, { under: 90, larger: 8 });
  const { sx, sy, box, picture, knob } = plot(view, {
    left, x: axis([LOW, HIGH], "gap at the end of the step / r", -0.1, -0.05, 0, 0.05),
    y: axis([-0.035 * MOST, 1.07 * MOST], "impulse (N s)", 0, 2, 4, 6),
    lines: [
      { model: "body", points: [[free, 0], [free + (2 * MOST * dt) / R, 2 * MOST]], kind: "step-line" },
      ...found.map(({ model, line }) => ({ model, points: line })),
    ],
  });
  const nameOf = ({ model, name: [at, high] }, k) => { // beside its line, on the left where there is room
    if (at === HIGH) return label(model, box.right, sy(Math.min(high, MOST)) - 8 - 18 * k, "end");
    const onLeft = at < 0 && sx(at) - box.left > 10 * model.length;
    return label(model, sx(at) + (onLeft ? -8 : 8), sy(high), onLeft ? "end" : "start");
  };
  const what = { label: "the ball: its gap before the step", value: "gap", low: LOW, high: HIGH,
    step: 0.005, at: (_, y) => -y / larger / r };
  return {
    picture: [
      drawn(found.map(({ model, end }) => ball(model, x, at(end), r, "ghost")),
        arrow("weight", x + r + 12, at(gap) + r, 0, at(free) - at(gap))),
      view.grab(what, ball("fixed", x, at(gap), r)), picture,
      label("the step", Math.min(sx(free + (1.6 * dt) / R) + 10, box.right - 56), sy(1.6), "start", "tick"),
      found.map(({ model, end, lam }) => // who is thrown out of the picture has no mark in it
        (end <= HIGH && lam <= 1.07 * MOST ? mark(model, sx(end), sy(lam), 7) : "")), found.map(nameOf),
      knob("free", "where the ball would end without a push", 0.005),
    ],
    words: `From ${short(gap)} r to ${short(free)} r; with a push: ` +
      `${found.map(({ model, end }) => `${model} ${short(end)}`).join(", ")} r.`,
  };
}

export const figure = {
  title: ({ models }) => `The line of a step: ${models.replaceAll(",", ", ")}`,
  caption: "The more push, the farther out the step ends. Where its line crosses a model’s, it is solved.",
  height: (width) => (width < 480 ? 280 : 320),
  knobs: ({ models }) => (models.includes("implicit") ? ["stiffness"] : []),
  start: () => ({ models: "penalty,lcp", gap: -0.02, free: -0.07, baumgarte: 1 }),
  draw,
};
