/* The corner, four times: gap to the right, force upwards, what a model allows as a line, and the
 * state that runs along it while the reader lifts the ball or presses it into the table. */
import { arrow, axis, ball, circle, line, number, path, table } from "../draw.js";
import { pushOfTable, runModel, soften } from "../engine.js";
import { beside, forceLength, G, grip, kept, knobs, lens, R, scene } from "../kit.js";
import { softKnobs } from "../kit.js";

const PX = 70; // a radius, and how far the hand goes down until it presses hardest
// What a picture shows: gaps from low to high [r], the hardest press [m g], ticks, and the lens.
const WIDE = { low: -0.4, high: 1, most: 30, xs: [0, 0.5, 1], ys: [0, 10, 20, 30] };
const NEAR = { low: -0.03, high: 0.06, most: 12, xs: [-0.03, 0, 0.05], ys: [0, 4, 8, 12] };

/* A figure of the corner with a model's law(view): {gap(load), curve, most}, the gap [r] under a
 * load [m g], the line that it allows as points, and the hardest press that fits into the picture.
 * extra(view, load): what else is seen, {under(chart), deepest [r], words}. */
function corner(model, law, { extra = () => ({}), hand = 0.5, shown = WIDE, ...about }) {
  const draw = (view) => drawn(view, { model, shown, ...law(view) }, extra);
  return { height: 300, start: () => ({ hand }), draw, ...about };
}

function drawn(view, { model, shown, gap: gapOf, curve, most = shown.most }, extra) {
  const { hand } = view.own; // 1: lifted as high as the picture shows; -1: pressed as hard
  const load = Math.max(0, -hand) * Math.min(shown.most, most);
  const gap = load > 0 ? gapOf(load) : hand * shown.high;
  const { under = () => "", deepest = null, words = "" } = extra(view, load);
  const axes = ({ box, sx, sy }) => [[box.right, sy(0)], [sx(0), sy(0)], [sx(0), box.top]];
  const chart = {
    x: axis([shown.low, shown.high], "gap / r", ...shown.xs),
    y: axis([-0.035 * shown.most, 1.07 * shown.most], "force / m g", ...shown.ys),
    points: [{ model, x: gap, y: Math.min(1.05 * shown.most, load), size: 7 }],
    lines: [{ model, xs: curve.map(([x]) => x), ys: curve.map(([, y]) => y), kind: "law plainly" }],
    under: (each) => path(axes(each), "allowed") + under(each),
  };
  const small = Math.min(1, view.width / 430);
  const [floor, r] = [view.height - 74, PX * small]; // px
  const centre = floor - r - gap * r;
  const picture = (left) => {
    const [x, y] = [left / 2, centre];
    const pull = Math.min(forceLength(load, 14), y - r - 2);
    const push = forceLength(load, 100 / Math.sqrt(shown.most));
    return [
      table(0, floor, left, 74),
      ball(model, x, y, r),
      deepest === null ? "" : ball(model, x, floor - r - deepest * r, r, "ghost"),
      arrow(`push m-${model}`, x + Math.min(r, left / 2 - 26) + 12, floor, 0, -push),
      hand > 0 ? line(x, y, x, 0, "hand") : arrow("weight", x, y - r - pull, 0, pull),
      shown === NEAR ? lens(model, 40, 42, r, -gap, 38, 10) : "",
    ].join("");
  };
  const { svg, middle } = beside(view, chart, picture);
  const holds = load > 0 ? `Pressed with ${number(load, 2)} m g` : "Held by the hand";
  const text = `gap ${number(gap, 2)} r, force ${number(load, 2)} m g`;
  const range = { r, low: -1, high: 1, step: 0.05, by: (dx, dy) => -dy / r };
  return {
    svg,
    words: `${holds}: ${text}.${words}`,
    handles: [grip(view, "hand", middle, centre, "the ball: lift it or press it", text, range)],
  };
}

const wall = { gap: () => 0, curve: [[WIDE.high, 0], [0, 0], [0, 1.07 * WIDE.most]] };

function ramp(view) {
  const steep = (view.get("stiffness") * R) / G; // weights a radius
  const top = 1.07 * WIDE.most;
  const curve = [[WIDE.high, 0], [0, 0], [-top / steep, top]];
  return { gap: (load) => -load / steep, curve, most: -WIDE.low * steep };
}

/* lcp: the ball comes from FROM radii above, drawn down by the load, and lcp looks once a step. A
 * load of L weights is a gravity of L g: our own gravity where the clock runs sqrt(L) as fast. */
const FROM = 0.8;
const arrival = kept((load, settings) => {
  const one = scene([(1 + FROM) * R]);
  const dt = settings.dt * Math.sqrt(load);
  const run = runModel("lcp", one, { ...settings, dt, restitution: 0 }, 400);
  const looks = Array.from(run.y, (y, row) => {
    const force = row ? (load * pushOfTable(run, one, row)) / G : 0;
    return { gap: y / R - 1, force };
  });
  const stays = ({ gap }, row) => row > 1 && Math.abs(gap - looks[row - 1].gap) < 1e-6;
  const still = looks.findIndex((look, row) => look.force > 0 && stays(look, row));
  return still < 0 ? looks : looks.slice(0, still + 1);
});

function looksOf(view, load) {
  if (load < 1) return {};
  const looks = arrival(load, knobs(view));
  const deepest = Math.min(0, ...looks.map(({ gap }) => gap));
  const ring = ({ sx, sy }, { gap, force }) =>
    circle(sx(gap), sy(Math.min(1.05 * WIDE.most, force)), 4, "look m-lcp");
  const deep = `the step before the first push ended ${number(-deepest, 2)} r deep`;
  return {
    deepest,
    under: (chart) => looks.map((look) => (look.gap < WIDE.low ? "" : ring(chart, look))).join(""),
    words: ` It came in ${looks.length} steps; ${deep}.`,
  };
}

// soft: at rest the solver asks for no velocity where lam = target / R; how deep that is for a load
// is found by halving.
function rounded(view) {
  const [settings, one] = [softKnobs(view), scene([R])];
  const load = (deep) => {
    const contact = { i: 0, j: -1, nx: 0, ny: 1, depth: deep * R };
    const { target, softness } = soften(contact, one, one, settings);
    return target / softness / (G * settings.dt);
  };
  const gap = (wanted, less = 0, more = 2) => {
    const middle = 0.5 * (less + more);
    if (middle === less || middle === more) return -more;
    return load(middle) > wanted ? gap(wanted, less, middle) : gap(wanted, middle, more);
  };
  const depths = Array.from({ length: 60 }, (_, k) => (-1.2 * NEAR.low * (k + 1)) / 60);
  return {
    gap,
    curve: [[NEAR.high, 0], [0, 0], ...depths.map((each) => [-each, load(each)])],
    most: load(-NEAR.low),
  };
}

export const figures = {
  corner: corner("exact", () => wall, {
    title: "The corner: gap to the right, force upwards",
    caption:
      "Lift the ball and the gap grows with no force; press it and the force grows with no gap.",
  }),
  "corner-penalty": corner("penalty", ramp, {
    title: "penalty’s ramp beside the corner",
    caption: "penalty has a ramp beside the wall: the ball must get in before the table pushes.",
    hand: -0.5, knobs: ["stiffness"],
  }),
  "corner-lcp": corner("lcp", () => wall, {
    title: "lcp meets the corner once a step",
    caption:
      "Press, and the ball comes down step by step: each ring is one look, the last of the fall " +
      "is past the wall, and the next looks bring it back.",
    extra: looksOf, hand: -0.6, knobs: ["dt"],
  }),
  "corner-soft": corner("soft", rounded, {
    title: "soft rounds the corner off",
    caption:
      "soft rounds the corner: the ball gives way at first and the slope grows steeper, as the " +
      "lens shows.",
    hand: -0.5, shown: NEAR, knobs: ["impedance"],
  }),
};
