/* One inequality: at the end of a step the gap, gap + dt v_n, must not be negative. What lcp asks
 * for in its place is a choice: which share of a gap to close or of an overlap to open, and how far
 * ahead to look. */
import { arrow, axis, ball, circle, el, label, line, number, table } from "../draw.js";
import { GRAVITY, runModel } from "../engine.js";
import { beside, grip, kept, knobs, R, scene } from "../kit.js";

const [DOWN, UP] = [-5, 2]; // m/s; a gap is counted in what 1 m/s closes in a step
const [PX, GROUND] = [26, 92]; // px: what 1 m/s does in a step, the table

// One step of lcp from a gap [r] with a speed [m/s]: gap and speed at its end.
const stepped = kept((gap, v, settings) => {
  const start = scene([(1 + gap) * R], { vy: [v] });
  const run = runModel("lcp", start, { ...settings, restitution: 0 }, 1);
  return { gap: run.y[1] / R - 1, v: run.vy[1] };
});

// The plane of gap and speed: where a step ends inside, and the speeds that lcp asks for.
function chartOf(unit, settings, { gap, free, end }) {
  const speeds = Array.from({ length: 141 }, (_, k) => -UP + ((UP - DOWN) * k) / 140);
  const asked = speeds.map((k) => stepped(k * unit, -90, settings).v); // of a ball that comes fast
  return {
    x: axis([-UP * unit, -DOWN * unit], "gap / r", 0, +(2 * unit).toPrecision(2)),
    y: axis([DOWN, UP], "v_n (m/s)", DOWN, 0, UP),
    lines: [{ model: "lcp", xs: speeds.map((k) => k * unit), ys: asked, kind: "plainly" }],
    under: ({ sx, sy, box: { left, bottom } }) => {
      const [from, to] = [sx(-UP * unit), sx(-DOWN * unit)];
      const d = `M${from} ${sy(UP)}L${to} ${sy(DOWN)}L${left} ${bottom}Z`;
      const [x, y] = [sx(gap), sy(Math.max(DOWN, free))];
      return [
        el("path", { d, class: "region" }),
        line(sx(0), sy(UP), sx(0), bottom, "grid") + line(from, sy(UP), to, sy(DOWN), "rule"),
        label("ends inside", left + 6, bottom - 8, "start", "tick"),
        arrow("push m-lcp", x, y, 0, sy(end.v) - y) + circle(x, y, 5, "dot"),
      ].join("");
    },
  };
}

// Ball, gap and dt v_n: from y to the tip, `end` where the ball is after the step [px].
function picture(left, { floor, r, y, end, tip, enlarged }) {
  const x = 0.42 * left;
  const [aside, far] = [x + r + 14, x - r - 12];
  return [
    table(0, floor, left, GROUND),
    label(`gaps × ${number(enlarged, 2)}`, 4, 14, "start", "tick"),
    ball("lcp", x, y - r, r),
    ball("lcp", x, end - r, r, "ghost"),
    line(x, y, aside, y, "grid"),
    arrow("push m-fixed", far, floor, 0, y - floor),
    label("gap", Math.max(14, far), floor + 18, "middle"),
    arrow("weight", aside, y, 0, tip - y),
    label("dt v_n", Math.min(aside + 8, left - 46), 0.5 * (y + tip) + 5, "start", "strong"),
  ].join("");
}

function draw(view) {
  const { own } = view;
  const settings = knobs(view);
  const unit = settings.dt / R; // r that 1 m/s does in a step
  const gap = own.gap * unit;
  const free = own.v + settings.dt * GRAVITY; // m/s, once gravity has acted
  const end = stepped(gap, own.v, settings);
  const sum = gap + unit * free; // r
  const [floor, r] = [view.height - GROUND, Math.min(40, 0.08 * view.width)]; // px
  const at = (far) => floor - (far / unit) * PX;
  const [y, tip] = [at(gap), Math.min(view.height - 14, at(sum))];
  const places = { floor, r, y, end: at(end.gap), tip, enlarged: PX / unit / r };
  const chart = chartOf(unit, settings, { gap, free, end });
  const { svg, middle } = beside(view, chart, (left) => picture(left, places), 0.46);
  const x = 0.84 * middle;
  const [tall, moves] = [gap, unit * free].map((each) => `${number(each, 2)} r`);
  const adds = `gap ${tall} + dt v_n ${moves} = ${number(sum, 2)} r${sum < 0 ? ", inside" : ""}`;
  const pushed = end.v > free + 1e-9;
  const does = pushed ? `lcp pushes, and it ends at ${number(end.gap, 2)} r` : "lcp does not push";
  const lift = { r, low: -UP, high: -DOWN, step: 0.1, by: (dx, dy) => -dy / PX };
  const fly = { low: DOWN, high: UP, step: 0.1, at: (toX, to) => (y - to) / PX };
  return {
    svg,
    words: `${adds}; ${does}.`,
    handles: [
      grip(view, "gap", x, y - r, "the ball: its gap", tall, lift),
      grip(view, "v", x + r + 14, tip, "its speed", `${number(own.v, 2)} m/s`, fly),
    ],
    lit: pushed ? ["bias"] : [],
  };
}

export const figure = {
  title: "One inequality: where a step ends",
  caption:
    "Gap and dt v_n may not add up to less than nothing: drag the ball and its speed, and see " +
    "which speeds lcp asks for in place of that, from how far away, and where the step ends.",
  height: 350,
  knobs: ["baumgarte"],
  start: () => ({ gap: 3, v: -4 }),
  draw,
};
