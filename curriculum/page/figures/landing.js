/* Where within a step the ball lands decides how deep lcp finds it, and so how high Baumgarte's
 * push makes it hop. Where it bounces, too, the target is the larger of both, not the sum. */
import { arrow, axis, ball, label, number, steps, table } from "../draw.js";
import { runModel } from "../engine.js";
import { ARRIVES, beside, grip, kept, knobs, R, scene } from "../kit.js";

const [FALL, GROUND] = [70, 96]; // px: the fall of one step, the table
const [ARROW, SHORT, LONG] = [22, 0.3, 0.9]; // px for 1 m/s; s, of a hop and of a bounce

// A flight that begins at a gap [r] with a speed: times, gaps and the highest gap [r].
function flight(gap, v, settings, seconds) {
  const start = scene([(1 + gap) * R], { vy: [v] });
  const run = runModel("lcp", start, settings, Math.max(5, Math.ceil(seconds / settings.dt)));
  const ys = Array.from(run.y, (y) => y / R - 1);
  return { xs: run.t, ys, high: Math.max(0, ...ys.slice(1)) };
}

/* A landing so late in a step: what the ball falls in one, its gap at the last look before it, its
 * depth at the first look after it [r], what bounce and bias ask for [m/s], and both flights. */
const landing = kept((share, settings) => {
  const { dt, baumgarte, restitution: e } = settings;
  const seconds = e > 0 ? LONG : SHORT;
  const fall = (ARRIVES * dt) / R;
  const before = share * fall;
  const larger = flight(before, -ARRIVES, settings, seconds);
  const depth = -Math.min(0, ...larger.ys.slice(0, 4));
  const [bounce, bias] = [e * ARRIVES, (baumgarte / dt) * depth * R];
  const sum = flight(-depth, bounce + bias, { ...settings, restitution: 0 }, seconds);
  return { bounces: e > 0, seconds, fall, before, depth, bounce, bias, larger, sum };
});

function chartOf({ bounces, seconds, fall, larger, sum }) {
  const top = 1.15 * Math.max(0.5 * fall, larger.high, bounces ? sum.high : 0);
  const dotted = { model: "lcp", ...sum, kind: "thin dotted" };
  return {
    x: axis([0, seconds], "time (s)", ...steps(0, seconds, 3)),
    y: axis([-1.2 * fall, top], "gap / r", ...steps(0, top, 3)),
    lines: [{ model: "lcp", ...larger, kind: "plainly" }, ...(bounces ? [dotted] : [])],
    rules: [{ y: 0 }],
  };
}

// The ball at the two looks, and the two wishes; `px` for a gap of 1 r.
function picture(left, floor, r, px, { before, depth, bounce, bias }) {
  const x = left / 2;
  const aside = Math.min(r + 22, x - 24);
  const lowest = (gap, kind) => ball("lcp", x, floor - gap * px - r, r, kind);
  const wish = (name, v, at) => {
    const kind = v < Math.max(bounce, bias) ? "push m-lcp weaker" : "push m-lcp";
    const drawn = arrow(kind, at, floor, 0, -Math.min(floor - 24, ARROW * v));
    return v > 0 ? drawn + label(name, Math.max(28, at), floor + GROUND - 10, "middle") : "";
  };
  return [
    table(0, floor, left, GROUND),
    label(`gaps × ${number(px / r, 2)}`, 4, 14, "start", "tick"),
    lowest(before, "ghost"),
    lowest(-depth, "ball"),
    wish("bounce", bounce, x - aside),
    wish("bias", bias, x + aside),
  ].join("");
}

function draw(view) {
  const { share } = view.own;
  const now = landing(share, knobs(view));
  const { bounces, fall, depth, bounce, bias, larger, sum } = now;
  const floor = view.height - GROUND;
  const [px, r] = [FALL / fall, Math.min(44, 0.08 * view.width)]; // of a gap of 1 r, of a radius
  const drawn = (left) => picture(left, floor, r, px, now);
  const { svg, middle } = beside(view, chartOf(now), drawn);
  const text = `${number(100 * share, 2)} % of a step after a look`;
  const range = { r, low: 0, high: 0.99, step: 0.05, at: (x, y) => 1 - (y + r - floor) / FALL };
  const place = [middle, floor + depth * px - r, "the ball: how deep it is found", text];
  const lifts = [larger, sum].map(({ high }) => `${number(high)} r`);
  const both = `the larger lifts it ${lifts[0]}, their sum (dotted) ${lifts[1]}`;
  const wishes = `: bounce ${number(bounce)} m/s, bias ${number(bias)} m/s; ${both}`;
  const hops = `; it hops ${number(larger.high, 2)} r high`;
  return {
    svg,
    words: `It lands ${text} and is found ${number(depth, 2)} r deep${bounces ? wishes : hops}.`,
    handles: [grip(view, "share", ...place, range)],
    lit: [bounces ? "larger" : "bias"],
  };
}

export const figure = {
  title: "A landing within a step",
  caption:
    "The dashed ball is the last look before the landing: the sooner after a look it lands, the " +
    "deeper the next one finds it, and the more Baumgarte’s bias asks for.",
  height: 290,
  knobs: ["baumgarte", "restitution"],
  start: () => ({ share: 0.327 }), // the chapter's own drop
  draw,
};
