/* Where within a step the ball lands decides how deep lcp finds it, and so how high Baumgarte's push
 * makes it hop. Where it bounces, too, the target is the larger of bounce and bias, not their sum. */
import { arrow, axis, ball, label, number, steps, table, within } from "../draw.js";
import { runModel } from "../engine.js";
import { ARRIVES, beside, grip, kept, knobs, R, scene } from "../parts.js";

const [FALL, GROUND] = [70, 96]; // px: the fall of one step, the table
const [ARROW, SHORT, LONG] = [22, 0.3, 0.9]; // px for 1 m/s; s, of a hop and of a bounce

// A flight that begins at a gap [r] with a speed: times and gaps [r].
const flight = kept((gap, v, told, seconds) => {
  const found = scene([(1 + gap) * R], { vy: [v] });
  const run = runModel("lcp", found, told, Math.max(5, Math.ceil(seconds / told.dt)));
  return { xs: run.t, ys: Array.from(run.y, (y) => y / R - 1) };
});

function draw(view) {
  const told = knobs(view);
  const { dt, baumgarte, restitution: e } = told;
  const seconds = e > 0 ? LONG : SHORT;
  const fall = (ARRIVES * dt) / R; // r of one step
  const before = view.own.share * fall; // r, at the last look before the landing
  const larger = flight(before, -ARRIVES, told, seconds);
  const depth = -Math.min(0, ...larger.ys.slice(0, 4));
  const [bounce, bias] = [e * ARRIVES, (baumgarte / dt) * depth * R]; // m/s
  const sum = flight(-depth, bounce + bias, { ...told, restitution: 0 }, seconds);
  const high = ({ ys }) => Math.max(0, ...ys.slice(1));
  const top = 1.15 * Math.max(0.5 * fall, high(larger), e > 0 ? high(sum) : 0);
  const chart = {
    x: axis([0, seconds], "time (s)", ...steps(0, seconds, 3)),
    y: axis([-1.2 * fall, top], "gap / r", ...steps(0, top, 3)),
    lines: [{ model: "lcp", ...larger, kind: "plainly" }],
    rules: [{ y: 0 }],
  };
  if (e > 0) chart.lines.push({ model: "lcp", ...sum, kind: "thin dotted" });
  const floor = view.height - GROUND;
  const [px, r] = [FALL / fall, Math.min(44, 0.08 * view.width)]; // of a gap of 1 r, of a radius
  const picture = (left) => {
    const x = left / 2;
    const lowest = (gap, kind) => ball("lcp", x, floor - gap * px - r, r, kind);
    const wish = (name, v, at) => {
      const kind = v < Math.max(bounce, bias) ? "push m-lcp weaker" : "push m-lcp";
      const drawn = arrow(kind, at, floor, 0, -Math.min(floor - 24, ARROW * v));
      return v > 0 ? drawn + label(name, Math.max(28, at), view.height - 10, "middle") : "";
    };
    const aside = Math.min(r + 22, x - 24);
    return [
      table(0, floor, left, GROUND),
      label(`gaps × ${number(px / r, 2)}`, 4, 14, "start", "tick"),
      lowest(before, "ghost"),
      lowest(-depth, "ball"),
      wish("bounce", bounce, x - aside),
      wish("bias", bias, x + aside),
    ].join("");
  };
  const { svg, middle } = beside(view, chart, picture);
  const text = `${number(100 * view.own.share, 2)} % of a step after a look`;
  const at = (x, y) => 1 - (y + r - floor) / FALL;
  const range = { r, low: 0, high: 0.99, step: 0.05, at };
  const place = [middle, floor + depth * px - r, "the ball: how deep it is found", text];
  const hops = `hops ${number(high(larger), 2)} r high`;
  const [one, more] = [number(high(larger), 3), number(high(sum), 3)];
  const both = `the larger lifts it ${one} r, their sum (dotted) ${more} r`;
  const bounces = `bounce ${number(bounce)} m/s, bias ${number(bias)} m/s; ${both}`;
  const found = `It lands ${text} and is found ${number(depth, 2)} r deep`;
  return {
    svg,
    words: e > 0 ? `${found}: ${bounces}.` : `${found}; it ${hops}.`,
    handles: [grip(view, "share", ...place, range)],
    lit: [["lcp-target", e > 0 ? "return max(bias" : "return close if"]],
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
