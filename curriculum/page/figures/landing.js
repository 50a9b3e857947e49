/* Where within a step the ball lands decides how deep lcp finds it, and so how high it hops. */
import { el, mark, number, plot, steps, table } from "../draw.js";
import { runModel } from "../engine.js";
import { knobsOf } from "../store.js";
import { clipped, G, kept, label, line, R, scene, shift, split, START, tidy, within } from "../parts.js";

const ARRIVES = Math.sqrt(2 * G * (START - R)); // m/s
const LOOKS = 5; // steps in the near picture: one before the landing, four after it
const STEP = 56; // px of the fall of one step
const SECONDS = 0.3;

// The ball from the last look before the landing on: it lands `share` of a step later. Gaps in r.
const lands = kept((share, knobs) => {
  const dt = knobs.dt;
  const before = scene([R + share * ARRIVES * dt], { vy: [-ARRIVES] });
  const run = runModel("lcp", before, { ...knobs, restitution: 0 }, Math.max(LOOKS, Math.ceil(SECONDS / dt)));
  const gaps = Array.from(run.y, (y) => y / R - 1);
  return { t: run.t, gaps, deepest: -Math.min(...gaps), hop: Math.max(...gaps.slice(1)) };
});

const near = (view) => {
  const { left, right, at } = split(view.width, 0.46, 300);
  return { left, right, at, wide: left / (LOOKS + 0.6), from: left / (LOOKS + 0.6) * 1.3, floor: view.height * 0.55 };
};
const of = (view) => lands(view.own.share, knobsOf(view.values));

// The looks around the landing, a step apart, and the ball's lowest point at each.
function looks(view) {
  const { left, wide, from, floor } = near(view);
  const { gaps } = of(view);
  const drop = (ARRIVES * view.get("dt")) / R; // r of one step
  const at = [...gaps.slice(0, LOOKS), gaps[LOOKS]].map((gap, k) => [from + k * wide, floor - (gap / drop) * STEP]);
  const path = [[from - wide, at[0][1] - STEP], ...at].map(([x, y], k) => `${k ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`);
  return clipped(
    "landing-looks", 0, 0, left, view.height,
    table(0, floor, left, view.height - floor),
    ...at.map(([x]) => line(x, 26, x, floor, "grid")),
    el("path", { d: path.join(""), class: "line m-lcp thin" }),
    ...at.map(([x, y]) => mark("lcp", x, y, 6)),
  );
}

function draw(view) {
  const { right, at, wide, from, floor } = near(view);
  const { t, gaps, deepest, hop } = of(view);
  const dt = view.get("dt");
  const most = Math.max((view.get("baumgarte") * ARRIVES) ** 2 / (2 * G * R), 0.05);
  const chart = plot({
    id: "landing",
    width: right,
    height: view.height,
    x: { domain: [0, SECONDS], ticks: steps(0, SECONDS, 3), label: "time (s)" },
    y: { domain: [-1.2 * ((ARRIVES * dt) / R), 1.15 * most], ticks: steps(0, 1.15 * most, 3), label: "gap / r" },
    lines: [{ model: "lcp", xs: t, ys: gaps }],
    rules: [{ y: 0 }],
  });
  const text = `${number(100 * view.own.share, 2)} % of a step after a look`;
  return {
    svg: looks(view) + label("a look a step", 4, 16, "start", "axis-name") + shift(at, 0, chart.markup),
    words: `It lands ${text}, is found ${number(deepest, 2)} r deep and hops ${number(Math.max(0, hop), 2)} r high.`,
    handles: [{ name: "landing", x: from + view.own.share * wide, y: floor, r: 14, label: "the landing within the step", value: view.own.share, text }],
  };
}

const set = (view, share) => (view.own.share = tidy(within(0, share, 0.99), 2));

export const figure = {
  title: "The landing within a step, and the hop",
  caption: "lcp looks once a step: the sooner after a look the ball lands, the deeper the next look finds it, and the higher Baumgarte’s push makes it hop.",
  height: 270,
  knobs: ["baumgarte"],
  uses: ["dt", "iters"],
  start: () => ({ share: 0.3 }),
  draw,
  drag(view, name, x) {
    const { wide, from } = near(view);
    set(view, (x - from) / wide);
  },
  nudge: (view, name, dx, dy) => set(view, view.own.share + 0.05 * (dx - dy)),
};
