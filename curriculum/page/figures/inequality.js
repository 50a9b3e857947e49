/* Where a step ends: gap + dt v_n may not be negative. In the plane of gap and speed what lcp or
 * leapfrog asks for, of a ball that comes fast, and one step. Values: gap and dt v_n before the
 * step [r], gap [r] and speed [m/s] after it. */
import { area, arrow, axis, ball, circle, clipped, label, line, number, plot,
  table } from "../draw.js";
import { column, G, kept, R, record } from "../runs.js";

const [DOWN, UP] = [-5, 2]; // m/s; a gap is counted in what 1 m/s closes in a step
const [PX, GROUND] = [30, 96]; // px: what 1 m/s does in a step, the table

// One step from a gap [r] with a speed [m/s]: gap and speed at its end.
const stepped = kept((model, gap, v, dt, baumgarte) => {
  const run = record(model, column([(1 + gap) * R], { vy: v }),
    { dt, baumgarte, iters: 20, warm: 0 }, 1);
  return { gap: run.y[1] / R - 1, v: run.vy[1] };
});

function chartOf(view, unit, { gap, free, end }) {
  const { model, dt, baumgarte } = view.own;
  const speeds = Array.from({ length: 141 }, (_, k) => -UP + ((UP - DOWN) * k) / 140);
  // how far a ball that comes at 90 m/s may go, as a speed
  const asked = speeds.map((k) => [k * unit,
    (stepped(model, k * unit, -90, dt, baumgarte).gap / unit - k)]);
  const left = Math.round(0.42 * view.width);
  return plot([left + 8, 0, view.width - left - 8, view.height], {
    x: axis([-UP * unit, -DOWN * unit], "gap / r", 0, Number((2 * unit).toPrecision(2)),
      Number((4 * unit).toPrecision(2))),
    y: axis([DOWN, UP], "v_n (m/s)", DOWN, 0, UP),
    lines: [{ model, points: asked, kind: "plainly" }],
    under: ({ sx, sy, box }) => {
      const [from, to] = [[sx(-UP * unit), sy(UP)], [sx(-DOWN * unit), sy(DOWN)]];
      const [x, y] = [sx(gap), sy(Math.max(DOWN, free))];
      return [
        area([from, to, [box.left, box.bottom]], "region"), line(...from, ...to, "rule"),
        line(sx(0), sy(UP), sx(0), box.bottom, "grid"), label("ends inside", box.left + 8,
          box.bottom - 10, "start", "tick"),
        arrow(`push m-${model}`, x, y, 0, sy((end.gap - gap) / unit) - y), circle(x, y, 5, "dot"),
      ];
    },
  });
}

function draw(view) {
  const { own, width, height } = view;
  const { dt, model } = own;
  const unit = dt / R; // r that 1 m/s does in a step
  const { gap } = own;
  const free = own.v - dt * G; // m/s, once gravity has acted
  const end = stepped(model, gap, own.v, dt, own.baumgarte);
  const sum = gap + unit * free; // r
  const [left, floor] = [Math.round(0.42 * width), height - GROUND];
  const r = Math.min(40, 0.22 * left);
  const at = (far) => floor - (far / unit) * PX;
  const [x, y, tip] = [0.42 * left, at(gap), Math.min(height - 12, at(sum))];
  const lift = {
    label: "the ball: its gap", text: `${number(gap, 2)} r`, value: "gap", low: -UP * unit,
    high: 4 * unit, step: 0.1 * unit, at: (_, to) => (-to / PX) * unit,
  };
  const fly = {
    label: "its speed", text: `${number(own.v, 2)} m/s`, value: "v", low: DOWN, high: UP, step: 0.1,
    at: (_, to) => -to / PX,
  };
  const pushed = Math.abs(end.gap - sum) > 1e-9;
  const [tall, moves] = [gap, unit * free].map((each) => number(each, 2));
  return {
    picture: [
      clipped(0, 0, left, height, table(0, floor, left, GROUND),
        ball(model, x, at(end.gap) - r, r, "ghost"),
        line(x, y, x + r + 14, y, "grid"), arrow("push m-fixed", x - r - 12, floor, 0, y - floor),
        label("gap", Math.max(18, x - r - 12), floor + 20, "middle"), arrow("weight", x + r + 14,
          y, 0, tip - y),
        label("dt v_n", Math.min(x + r + 22, left - 46), 0.5 * (y + tip) + 5)),
      view.grab(lift, ball(model, x, y - r, r, "ball plainly")), view.point(x + r + 14, tip, fly),
      chartOf(view, unit, { gap, free, end }).picture,
    ],
    words: `Gap ${tall} r and dt v_n ${moves} r make ${number(sum, 2)} r${sum < 0 ? ", inside" : ""}. ` +
      `${pushed ? `${model} pushes: the step ends at ${number(end.gap, 2)} r` : `${model} does not push`}, with ${number(end.v, 2)} m/s.`,
    values: { gap, moves: unit * free, sum, end, pushed },
  };
}

export const figure = {
  title: "One inequality: where a step ends",
  caption: "The grey half would end inside the table. The line is what the model asks for in its place.",
  height: () => 350,
  knobs: ({ model }) => (model === "lcp" ? ["baumgarte"] : []),
  start: () => ({ gap: 0.008, v: -2, model: "lcp" }),
  buttons: ({ own }) => ["lcp", "leapfrog"].map((model) =>
    [model, () => (own.model = model), String(own.model === model)]),
  draw,
};
