/* Where a step ends: gap + dt v_n may not be negative. In the plane of gap and speed what lcp or
 * leapfrog asks for, of a ball that comes fast, and one step; below it the parts of that step.
 * Values: gap and dt v_n before the step [r], gap [r] and speed [m/s] after it, and after each of
 * its parts [[gap [r], v_n [m/s]]]. */
import { area, arrow, axis, ball, circle, clipped, label, line, number, plot } from "../draw.js";
import { table } from "../draw.js";
import { data } from "../data.js";
import { column, G, kept, R, record } from "../runs.js";

const [DOWN, UP] = [-5, 2]; // m/s; a gap is counted in what 1 m/s closes in a step
const [PX, GROUND, STRIP, SMALL] = [30, 66, 130, 9]; // px: what 1 m/s does in a step; ...
const PARTS = { lcp: ["before", "kick", "push", "move"],
  leapfrog: ["before", "½ kick", "push", "move", "½ kick", "push"] };

// One step from a gap [r] with a speed [m/s]: gap and speed at its end.
const stepped = kept((model, gap, v, dt, baumgarte) => {
  const knobs = { ...data.defaults, dt, baumgarte };
  const run = record(model, column([(1 + gap) * R], { vy: v }), knobs, 1);
  return { gap: run.y[1] / R - 1, v: run.vy[1] };
}, 400);

// Gap [r] and speed [m/s] before a step and after each of its parts: it moves with the speed that
// leads to its end.
function partsOf(model, gap, v, dt, end) {
  const [kick, moves] = [dt * G, ((end.gap - gap) * R) / dt];
  if (model === "lcp") return [[gap, v], [gap, v - kick], [gap, moves], [end.gap, moves]];
  return [[gap, v], [gap, v - kick / 2], [gap, moves], [end.gap, moves],
    [end.gap, moves - kick / 2], [end.gap, end.v]];
}

function draw(view) {
  const { own: { dt, model, gap, v, baumgarte }, width, height } = view;
  const unit = dt / R; // r that 1 m/s does in a step
  const end = stepped(model, gap, v, dt, baumgarte);
  const free = v - dt * G; // m/s, once gravity has acted
  const sum = gap + unit * free; // r
  const [left, top] = [Math.round(0.42 * width), height - STRIP];
  const floor = top - GROUND - 20;
  const [r, x] = [Math.min(40, 0.22 * left), 0.42 * left];
  const at = (far) => floor - (far / unit) * PX;
  const [y, tip] = [at(gap), Math.min(top - 32, at(sum))];
  // how far a ball that comes at 90 m/s may go, as a speed
  const asked = Array.from({ length: 141 }, (_, k) => {
    const from = (-UP + ((UP - DOWN) * k) / 140) * unit;
    return [from, (stepped(model, from, -90, dt, baumgarte).gap - from) / unit];
  });
  const ticks = [2, 4].map((k) => Number((k * unit).toPrecision(2)));
  const { sx, sy, box, picture } = plot(view, {
    left: left + 8, height: top,
    x: axis([-UP * unit, -DOWN * unit], "gap / r", 0, ...ticks),
    y: axis([DOWN, UP], "v_n (m/s)", DOWN, 0, UP),
    lines: [{ model, points: asked, kind: "plainly" }],
  });
  const [high, low] = [[sx(-UP * unit), sy(UP)], [sx(-DOWN * unit), sy(DOWN)]];
  const [dotX, dotY] = [sx(gap), sy(Math.max(DOWN, free))];
  const plane = [
    area([high, low, [box.left, box.bottom]], "region"), line(...high, ...low, "rule"),
    line(sx(0), sy(UP), sx(0), box.bottom, "grid"),
    label("ends inside", box.left + 8, box.bottom - 10, "start", "tick"),
    arrow(`push m-${model}`, dotX, dotY, 0, sy((end.gap - gap) / unit) - dotY),
    circle(dotX, dotY, 5, "dot"),
  ];
  const parts = partsOf(model, gap, v, dt, end);
  const base = height - 62;
  const strip = parts.map(([far, speed], k) => {
    const middle = (width * (k + 0.5)) / parts.length;
    const from = base - (far / unit) * SMALL;
    return [ball(model, middle, from - 14, 14, "ball plainly"),
      arrow(`push m-${model}`, middle + 22, from, 0, -speed * SMALL),
      label(PARTS[model][k], middle, height - 4, "middle")];
  });
  const lift = {
    label: "the ball: its gap", value: "gap", low: -UP * unit, high: 4 * unit, step: 0.1 * unit,
    at: (_, to) => (-to / PX) * unit,
  };
  const fly = {
    label: "its speed", value: "v", low: DOWN, high: UP, step: 0.1, at: (_, to) => -to / PX,
  };
  const pushed = Math.abs(end.gap - sum) > 1e-9;
  const [tall, moves] = [gap, unit * free].map((each) => number(each, 2));
  const does = pushed ? `pushes it to ${number(end.gap, 2)} r` : "does not push";
  return {
    picture: [
      clipped(0, 0, left, top - 20, table(0, floor, left, GROUND),
        ball(model, x, at(end.gap) - r, r, "ghost"), line(x, y, x + r + 14, y, "grid"),
        arrow("push m-fixed", x - r - 12, floor, 0, y - floor),
        label("gap", Math.max(18, x - r - 12), floor + 20, "middle"),
        arrow("weight", x + r + 14, y, 0, tip - y),
        label("dt v_n", Math.min(x + r + 22, left - 46), 0.5 * (y + tip) + 5)),
      view.grab(lift, ball(model, x, y - r, r, "ball plainly")),
      view.point(x + r + 14, tip, fly), plane, picture,
      table(0, base, width, 42), strip,
    ],
    words: `Gap ${tall} r + dt v_n ${moves} r = ${number(sum, 2)} r` +
      `${sum < 0 ? ", inside" : ""}: ${model} ${does}.`,
    values: { gap, moves: unit * free, sum, end, pushed, parts },
  };
}

export const figure = {
  title: "One inequality: where a step ends",
  caption: "The grey half would end inside the table. The line is what the model asks for instead. "
    + "Below: the parts of the step.",
  height: () => 400,
  knobs: ({ model }) => (model === "lcp" ? ["baumgarte"] : []),
  choices: { model: Object.keys(PARTS) },
  start: () => ({ gap: 0.008, v: -2, model: "lcp" }),
  buttons: ({ own }) => ["lcp", "leapfrog"].map((model) =>
    [model, () => (own.model = model), String(own.model === model)]),
  draw,
};
