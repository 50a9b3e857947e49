/* The corner, three times: gap to the right, force upwards, what a model allows as a line, and the
 * state that runs along it while the reader lifts the ball or presses it into the table. */
import { arrow, axis, ball, el, line, number, path, table, within } from "../draw.js";
import { runModel, soften } from "../engine.js";
import { beside, forceLength, G, grip, kept, lens, R, scene, softKnobs } from "../kit.js";

const [PX, GROUND] = [70, 74]; // px: a radius, and what the hand goes down; the table
// What a picture shows: gaps from low to high [r], the hardest press [m g], ticks, and the lens.
const WIDE = { low: -0.4, high: 1, most: 30, xs: [0, 0.5, 1], ys: [0, 10, 20, 30] };
const NEAR = {
  low: -0.03, high: 0.06, most: 12, xs: [-0.03, 0, 0.05], ys: [0, 4, 8, 12], lens: 10,
};

/* A figure of the corner with a model's law(view): {gap(load), curve, most}, the gap [r] under a
 * load [m g], the line that it allows as points, and the hardest press that fits into the picture.
 * With a clock the ball falls once it is let go: free(gap) is [gap, load] then; below(x, top) is
 * what stands under it, and `words` go on about it. */
function corner(model, law, { hand = 0.5, shown = WIDE, ...about }) {
  const draw = (view) => drawn(view, { model, shown, most: shown.most, ...law(view) });
  return { height: 300, start: () => ({ hand, time: null }), draw, ...about };
}

function drawn(view, { model, shown, gap: gapOf, curve, most, free, below, words = "" }) {
  const { hand, time } = view.own; // 1: lifted as high as the picture shows; -1: pressed as hard
  const pressed = Math.max(0, -hand) * Math.min(shown.most, most); // m g
  const start = pressed > 0 ? gapOf(pressed) : hand * shown.high;
  const held = time === null;
  const [gap, load] = held ? [start, pressed] : free(start);
  const axes = ({ box, sx, sy }) => [[box.right, sy(0)], [sx(0), sy(0)], [sx(0), box.top]];
  const [x, y] = [within(shown.low, gap, shown.high), Math.min(1.05 * shown.most, load)];
  const chart = {
    x: axis([shown.low, shown.high], "gap / r", ...shown.xs),
    y: axis([-0.035 * shown.most, 1.07 * shown.most], "force / m g", ...shown.ys),
    points: [{ model, x, y, size: 7 }],
    lines: [{ model, xs: curve.map(([x]) => x), ys: curve.map(([, y]) => y), kind: "law plainly" }],
    under: (each) => path(axes(each), "allowed"),
  };
  const small = Math.min(1, view.width / 430);
  const [floor, r] = [view.height - GROUND, PX * small]; // px
  const centre = Math.min(floor - r - gap * r, view.height - 12); // none is lost
  const picture = (left) => {
    const middle = left / 2;
    const pull = Math.min(forceLength(held ? load : 1, 14), centre - r - 2);
    const push = forceLength(load, 100 / Math.sqrt(shown.most));
    return [
      table(0, floor, left, GROUND),
      below ? below(middle, Math.max(centre + r, floor)) : "",
      ball(model, middle, centre, r),
      arrow(`push m-${model}`, middle + Math.min(r, middle - 26) + 12, floor, 0, -push),
      held && hand > 0
        ? line(middle, centre, middle, 0)
        : arrow("weight", middle, centre - r - pull, 0, pull),
      lens(model, 40, 42, r, -gap, 38, shown.lens),
    ].join("");
  };
  const { svg, middle } = beside(view, chart, picture);
  const hands = pressed > 0 ? `Pressed with ${number(pressed, 2)} m g` : "Held by the hand";
  const text = `gap ${number(gap, 2)} r, force ${number(load, 2)} m g`;
  const by = (dx, dy) => -dy / r;
  const range = { r, low: -1, high: 1, step: 0.05, by, release: free && view.play };
  return {
    svg,
    words: `${held ? hands : "Let go"}: ${text}.${words}`,
    handles: [grip(view, "hand", middle, centre, "the ball: lift it or press it", text, range)],
    lit: model === "penalty" && gap < 0 ? ["spring"] : [],
  };
}

const wall = { gap: () => 0, curve: [[WIDE.high, 0], [0, 0], [0, 1.07 * WIDE.most]] };

// ---- penalty: a ramp, and the ball once it is let go

const [DT, SECONDS] = [0.0005, 1.2];
const fall = kept((gap, stiffness, damping) =>
  runModel("penalty", scene([(1 + gap) * R]), { dt: DT, stiffness, damping }, SECONDS / DT),
);

// A coil from (x, top) down to (x, bottom), the thicker the stiffer.
function coil(x, top, bottom, stiffness) {
  const turn = (_, k) => [x + (k % 2 ? -16 : 16), top + ((k + 0.5) * (bottom - top)) / 12];
  const wire = path([[x, top], ...Array.from({ length: 12 }, turn), [x, bottom]], "coil");
  return el("g", { "stroke-width": Math.log10(stiffness) - 0.5 }, wire);
}

function ramp({ own, get, height }) {
  const [stiffness, damping] = [get("stiffness"), get("damping")];
  const [steep, top] = [(stiffness * R) / G, 1.07 * WIDE.most]; // weights a radius, weights
  return {
    gap: (load) => -load / steep,
    curve: [[WIDE.high, 0], [0, 0], [-top / steep, top]],
    most: -WIDE.low * steep,
    free(start) {
      const gap = fall(start, stiffness, damping).y[Math.round(own.time / DT)] / R - 1;
      return [gap, Math.max(0, -gap * steep)];
    },
    below: (x, under) => coil(x, under, height - 4, stiffness),
    words: ` At rest it is m g / k = ${number(1 / steep)} r deep.`,
  };
}

// ---- soft: at rest the solver asks for no velocity where lam = target / R; how deep that is for a
// load is found by halving

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
  sponge: corner("penalty", ramp, {
    title: "A ball on a spring",
    caption:
      "penalty has a ramp beside the wall: press the ball, and it must get in before the table " +
      "pushes; let go, and it rests where the spring pushes with its weight.",
    hand: -0.5, knobs: ["stiffness"],
    clock: () => ({ end: SECONDS, rate: 0.25, name: "Let go" }),
  }),
  "corner-soft": corner("soft", rounded, {
    title: "soft rounds the corner off",
    caption:
      "soft rounds the corner: the ball gives way at first and the slope grows steeper, as the " +
      "lens shows.",
    hand: -0.5, shown: NEAR, knobs: ["impedance"],
  }),
};
