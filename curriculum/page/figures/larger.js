/* Bounce or bias: the target is the larger of the two, not their sum. */
import { arrow, ball, number, steps, table } from "../draw.js";
import { runModel } from "../engine.js";
import { knobsOf } from "../store.js";
import { axis, beside, G, handle, kept, label, R, scene, START, tidy, within } from "../parts.js";

const [PX, SPEED, SECONDS] = [54, 20, 0.9]; // px a radius, px for 1 m/s, s
const DEEPEST = 0.5; // r
const ARRIVES = Math.sqrt(2 * G * (START - R)); // m/s
const floorOf = (view) => view.height - 46;

// The two wishes [m/s] for a ball that is found so deep [r].
function wishes(depth, { restitution, baumgarte, dt }) {
  return { bounce: restitution * ARRIVES, bias: (baumgarte / dt) * depth * R };
}

// The flights [share of the drop's height] of the ball that lcp meets as it arrives, and of one that
// leaves with the sum of its wishes.
const flights = kept((depth, knobs) => {
  const { bounce, bias } = wishes(depth, knobs);
  return [-ARRIVES, bounce + bias].map((v) => {
    const found = scene([(1 - depth) * R], { vy: [v], restitution: knobs.restitution });
    const run = runModel("lcp", found, knobs, Math.ceil(SECONDS / knobs.dt));
    return { t: run.t, ys: Array.from(run.y, (y) => (y - R) / (START - R)) };
  });
});

function picture(view, left, { bounce, bias }) {
  const [floor, x] = [floorOf(view), left / 2];
  const y = floor - PX + view.own.depth * PX;
  const speed = (v) => -Math.min(floor - 24, SPEED * v);
  const wide = left > 150 ? PX + 14 : 0.36 * left;
  const arrows = [["bounce", bounce, x - wide], ["bias", bias, x + wide]].map(([name, v, at]) => {
    const kind = v < Math.max(bounce, bias) ? "push m-lcp weaker" : "push m-lcp";
    return arrow(kind, at, floor, 0, speed(v)) + label(name, within(26, at, left - 20), floor + 18, "middle");
  });
  return table(0, floor, left, 46) + ball("lcp", x, y, PX) + arrows.join("");
}

function draw(view) {
  const knobs = knobsOf(view.values);
  const wanted = wishes(view.own.depth, knobs);
  const [larger, both] = flights(view.own.depth, knobs);
  const law = knobs.restitution ** 2;
  const chart = {
    x: { domain: [0, SECONDS], ticks: steps(0, SECONDS, 4), label: "time (s)" },
    y: axis([-0.06, 1.5], "height / drop", 0, 0.5, 1),
    lines: [
      { model: "lcp", xs: larger.t, ys: larger.ys },
      { model: "lcp", xs: both.t, ys: both.ys, class: "thin dotted" },
    ],
    rules: law > 0 ? [{ y: law, text: "e²", class: "dashed" }] : [],
  };
  const { svg, middle } = beside(view, "larger", chart, (left) => picture(view, left, wanted));
  const high = (flight) => number(Math.max(0, ...flight.ys), 2);
  const text = `${number(view.own.depth, 2)} r deep: bounce ${number(wanted.bounce)} m/s, bias ${number(wanted.bias)} m/s`;
  const y = floorOf(view) - PX + view.own.depth * PX;
  return {
    svg,
    words: `${text}. The larger lifts the ball to ${high(larger)} of the drop, the sum (dotted) to ${high(both)}.`,
    handles: [handle("ball", middle, y, PX, "the ball: how deep lcp finds it", view.own.depth, text)],
    lit: [["lcp-target", law === 0 ? "return bias" : wanted.bias > 0 ? "return max(bias" : "return bounce if"]],
  };
}

const set = (view, depth) => (view.own.depth = tidy(within(0, depth, DEEPEST), 2));

export const figure = {
  title: "A landing: bounce and bias",
  caption:
    "The target is the larger of bounce and bias: with their sum (dotted) a ball that is found deep bounces higher than its material allows.",
  height: 280,
  uses: ["dt", "restitution", "baumgarte", "iters"],
  shows: { scene: "bounce", restitution: 0.7 },
  start: () => ({ depth: 0.06 }),
  draw,
  drag: (view, name, x, y) => set(view, (y - floorOf(view)) / PX + 1),
  nudge: (view, name, dx, dy) => set(view, view.own.depth + 0.02 * dy),
};
