/* Where within a step the ball lands decides how deep lcp finds it, and so how high it hops. */
import { axis, label, line, mark, number, path, steps, table } from "../draw.js";
import { runModel } from "../engine.js";
import { ARRIVES, beside, G, grip, kept, knobs, R, scene } from "../parts.js";

const LOOKS = 5; // steps in the near picture: one before the landing, four after it
const STEP = 56; // px of the fall of one step
const SECONDS = 0.3;

// The ball from the last look before the landing on: it lands `share` of a step later. Gaps in r.
const lands = kept((share, told) => {
  const before = scene([R + share * ARRIVES * told.dt], { vy: [-ARRIVES] });
  const count = Math.max(LOOKS, Math.ceil(SECONDS / told.dt));
  const run = runModel("lcp", before, { ...told, restitution: 0 }, count);
  const gaps = Array.from(run.y, (y) => y / R - 1);
  return { t: run.t, gaps, deepest: -Math.min(...gaps), hop: Math.max(0, ...gaps.slice(1)) };
});

function draw(view) {
  const { share } = view.own;
  const { t, gaps, deepest, hop } = lands(share, knobs(view));
  const drop = (ARRIVES * view.get("dt")) / R; // r of one step
  const most = Math.max((view.get("baumgarte") * ARRIVES) ** 2 / (2 * G * R), 0.05);
  const floor = 0.55 * view.height;
  const chart = {
    x: axis([0, SECONDS], "time (s)", ...steps(0, SECONDS, view.width < 480 ? 2 : 3)),
    y: axis([-1.2 * drop, 1.15 * most], "gap / r", ...steps(0, 1.15 * most, 3)),
    lines: [{ model: "lcp", xs: t, ys: gaps }],
    rules: [{ y: 0 }],
  };
  // the looks around the landing, a step apart, and the ball's lowest point at each
  const wide = (left) => left / (LOOKS + 0.6);
  const picture = (left) => {
    const place = (gap, k) => [(k + 1.3) * wide(left), floor - (gap / drop) * STEP];
    const at = gaps.slice(0, LOOKS + 1).map(place);
    return [
      table(0, floor, left, view.height - floor),
      label("a look a step", 4, 16, "start", "axis-name"),
      ...at.map(([x]) => line(x, 26, x, floor, "grid")),
      path([place(gaps[0] + drop, -1), ...at], "line m-lcp thin"),
      ...at.map(([x, y]) => mark("lcp", x, y, 6)),
    ].join("");
  };
  const { svg, middle } = beside(view, chart, picture, 0.46);
  const step = wide(2 * middle);
  const text = `${number(100 * share, 2)} % of a step after a look`;
  const place = [(share + 1.3) * step, floor];
  const range = { low: 0, high: 0.99, step: 0.05, at: (x) => x / step - 1.3 };
  const found = `is found ${number(deepest, 2)} r deep and hops ${number(hop, 2)} r high`;
  return {
    svg,
    words: `It lands ${text}, ${found}.`,
    handles: [grip(view, "share", ...place, "the landing within the step", text, range)],
  };
}

export const figure = {
  title: "The landing within a step, and the hop",
  caption:
    "lcp looks once a step: the sooner after a look the ball lands, the deeper the next look " +
    "finds it, and the higher Baumgarte’s push makes it hop.",
  height: 270,
  knobs: ["baumgarte"],
  start: () => ({ share: 0.327 }), // the chapter's own drop
  draw,
};
