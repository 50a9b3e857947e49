/* Where within a step the ball lands decides how deep lcp finds it, and so how high it hops. */
import { el, mark, number, steps, table } from "../draw.js";
import { runModel } from "../engine.js";
import { knobsOf } from "../store.js";
import { beside, G, handle, kept, label, line, R, scene, START, tidy, within } from "../parts.js";

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

const of = (view) => lands(view.own.share, knobsOf(view.values));

// The looks around the landing, a step apart, and the ball's lowest point at each.
function looks(view, left) {
  const [wide, floor] = [left / (LOOKS + 0.6), 0.55 * view.height];
  const drop = (ARRIVES * view.get("dt")) / R; // r of one step
  const { gaps } = of(view);
  const at = gaps.slice(0, LOOKS + 1).map((gap, k) => [(k + 1.3) * wide, floor - (gap / drop) * STEP]);
  const path = [[0.3 * wide, at[0][1] - STEP], ...at].map(([x, y], k) => `${k ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`);
  Object.assign(view.own, { wide, floor });
  return [
    table(0, floor, left, view.height - floor),
    label("a look a step", 4, 16, "start", "axis-name"),
    ...at.map(([x]) => line(x, 26, x, floor, "grid")),
    el("path", { d: path.join(""), class: "line m-lcp thin" }),
    ...at.map(([x, y]) => mark("lcp", x, y, 6)),
  ].join("");
}

function draw(view) {
  const { t, gaps, deepest, hop } = of(view);
  const most = Math.max((view.get("baumgarte") * ARRIVES) ** 2 / (2 * G * R), 0.05);
  const chart = {
    x: { domain: [0, SECONDS], ticks: steps(0, SECONDS, view.width < 480 ? 2 : 3), label: "time (s)" },
    y: { domain: [-1.2 * ((ARRIVES * view.get("dt")) / R), 1.15 * most], ticks: steps(0, 1.15 * most, 3), label: "gap / r" },
    lines: [{ model: "lcp", xs: t, ys: gaps }],
    rules: [{ y: 0 }],
  };
  const { svg } = beside(view, "landing", chart, (left) => looks(view, left), 0.46);
  const { share, wide, floor } = view.own;
  const text = `${number(100 * share, 2)} % of a step after a look`;
  return {
    svg,
    words: `It lands ${text}, is found ${number(deepest, 2)} r deep and hops ${number(Math.max(0, hop), 2)} r high.`,
    handles: [handle("landing", (share + 1.3) * wide, floor, 14, "the landing within the step", share, text)],
  };
}

const set = (view, share) => (view.own.share = tidy(within(0, share, 0.99), 2));

export const figure = {
  title: "The landing within a step, and the hop",
  caption:
    "lcp looks once a step: the sooner after a look the ball lands, the deeper the next look finds it, and the higher Baumgarte’s push makes it hop.",
  height: 270,
  knobs: ["baumgarte"],
  uses: ["dt", "iters"],
  start: () => ({ share: 0.3 }),
  draw,
  drag: (view, name, x) => set(view, x / view.own.wide - 1.3),
  nudge: (view, name, dx, dy) => set(view, view.own.share + 0.05 * (dx - dy)),
};
