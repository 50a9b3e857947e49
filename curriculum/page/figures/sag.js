/* What unfinished sweeps leave: a column at rest under lcp sags as on springs. Its law stands
 * beside it, and the sweeps of a step can be spent on substeps. */
import { axis, ball, label, number, path, plural, rect, table, tenTo } from "../draw.js";
import { runModel, stateAt } from "../engine.js";
import { beside, depthsOf, G, grip, kept, knobs, R, scene, tens, through } from "../kit.js";

const [FEWEST, FIRST, MOST, HEAVIEST] = [2, 8, 10, 100]; // balls, balls, balls, kg
const [LENS, GROUND, LARGEST] = [15, 38, 30]; // px: a lens, the table, a ball
const ROWS = 300; // steps until all is at rest: the run starts where the law has it

// The law: how deep each ball is pressed into what is below it [r]; `masses` from below.
const lawOf = (masses, { dt, iters, baumgarte, warm }) =>
  masses.map((own, i) => {
    const above = masses.slice(i + 1).reduce((sum, mass) => sum + mass, 0);
    const deep = ((1 - warm) / (baumgarte * iters)) * (above / own) * ((G * dt * dt) / R);
    return above && deep ? Math.min(1, deep) : 0; // no number where nothing is asked to open
  });

// The same of a run of lcp; and whether it is at rest.
const sags = kept((masses, settings) => {
  let top = 0;
  const heights = lawOf(masses, settings).map((deep) => (top += (2 - deep) * R) - R);
  const balls = scene(heights, { mass: masses });
  const run = runModel("lcp", balls, { ...settings, restitution: 0 }, ROWS);
  const [before, depths] = [ROWS - 9, ROWS].map((row) => depthsOf(stateAt(run, row).y));
  const rests = (deep, i) => Math.abs(deep - before[i]) < 1e-3 * Math.abs(deep) + 1e-9;
  return { depths, rests: depths.every(rests) };
});

// All ways to spend the sweeps of a step on equal substeps.
const waysOf = ({ dt, iters, ...others }) =>
  Array.from({ length: iters }, (_, k) => k + 1)
    .filter((parts) => iters % parts === 0)
    .map((parts) => ({ ...others, parts, dt: dt / parts, iters: iters / parts }));

// Which of them has about so many substeps.
function nearest(ways, wanted) {
  const off = ways.map(({ parts }) => Math.abs(Math.log(parts / wanted)));
  return off.indexOf(Math.min(...off));
}

// A contact through a lens: a ball in what is below it, both in px, and the law as a bracket.
function lens(x, y, deep, law) {
  const [near, far] = [x + LENS + 3, x + LENS + 9];
  const below = rect(x - LENS, y, 2 * LENS, LENS, "body m-fixed");
  const above = rect(x - LENS, y - LENS, 2 * LENS, LENS + deep, "ball m-lcp");
  const bracket = path([[far, y], [near, y], [near, y + law], [far, y + law]], "rule");
  return through(x, y, LENS, below, above) + bracket;
}

// The column, a lens at each contact, and how deep it is; and the place of each ball.
function column(left, height, masses, depths, law) {
  const r = Math.min(LARGEST, (height - GROUND - 14) / (2 * masses.length)); // px
  const floor = height - GROUND;
  const size = (0.85 * LENS) / Math.max(1e-9, ...depths, ...law); // px for an overlap of 1 r
  const ten = 10 ** Math.floor(Math.log10(Math.max(1e-9, ...depths))); // r: in it they are settings
  const places = masses.map((_, i) => [r + 6, floor - (2 * i + 1) * r]);
  const drawn = masses.map((mass, i) => {
    const [x, y] = places[i];
    const heavy = mass === 1 ? "" : label(number(mass, 2), x, y + 5, "middle", "on-ball");
    const at = x + r + LENS + 12;
    const shown = Math.round((100 * depths[i]) / ten) / 100 + 0; // no -0
    return [
      ball("lcp", x, y, r, heavy ? "ball plainly" : "ball") + heavy,
      lens(at, y + r, size * depths[i], size * law[i]),
      label(shown.toFixed(2), at + LENS + 16, y + r + (i ? 5 : -4)),
    ].join("");
  });
  const power = Math.log10(ten);
  const enlarged = label(power ? `in ${tenTo(power)} r` : "in r", left - 4, height - 5, "end");
  return { svg: table(0, floor, left, GROUND) + drawn.join("") + enlarged, places, r };
}

// The lowest overlap with each way to spend the sweeps, and the law as a line.
function chartOf(ways, all) {
  const ys = all.map(({ depths }) => Math.max(0, depths[0]));
  const laws = all.map(({ law }) => law[0]);
  const xs = ways.map(({ parts }) => parts);
  const top = Math.ceil(Math.log10(Math.max(1e-9, ...ys, ...laws)) + 0.1);
  const most = ways[0].iters; // substeps of one sweep
  return {
    x: { ...axis([0.9, 1.12 * most], "substeps", ...new Set([1, most])), log: true },
    y: { ...tens(top - 3, top), label: "lowest overlap / r" },
    lines: [
      { model: "fixed", xs, ys: laws, kind: "plainly" },
      { model: "lcp", xs, ys, kind: "thin" },
    ],
    points: xs.map((x, k) => ({ model: "lcp", x, y: ys[k], size: 5 })),
  };
}

function draw(view) {
  const { own } = view;
  const masses = own.masses.slice(0, own.count);
  const ways = waysOf(knobs(view));
  const now = nearest(ways, own.parts);
  const all = ways.map((way) => ({ ...sags(masses, way), law: lawOf(masses, way) }));
  const { depths, rests, law } = all[now];
  let made;
  const picture = (left) => (made = column(left, view.height, masses, depths, law)).svg;
  const { svg, sx, sy } = beside(view, chartOf(ways, all), picture, 0.42);
  const hold = ([x, y], i) => {
    const get = () => Math.log10(own.masses[i]);
    const set = (to) => (own.masses[i] = Number((10 ** to).toPrecision(2)));
    const range = { r: made.r, low: 0, high: Math.log10(HEAVIEST), step: 0.1, get, set };
    const text = `${number(own.masses[i], 2)} kg`;
    const name = `ball ${i + 1} from below: drag it up, and it is heavier`;
    return grip(view, `ball-${i}`, x, y, name, text, { ...range, by: (dx, dy) => -dy / 60 });
  };
  const { dt, iters, baumgarte, parts } = ways[now];
  const spent = `${plural(parts, "substep")} of ${plural(iters, "sweep")}`;
  const lawful = number(law[0], 2);
  const way = { low: 1, high: ways[0].iters, at: sx.back, get: () => parts };
  const next = (by) => (own.parts = ways[nearest(ways, own.parts) + by]?.parts ?? own.parts);
  const given = `K = ${iters}, β = ${baumgarte}, dt = ${number(1000 * dt)} ms`;
  const deep = `${number(depths[0], 2)} r deep${rests ? "" : ", and still moves"}`;
  const knob = grip(view, "parts", sx(parts), sy(Math.max(0, depths[0])), "substeps", spent, way);
  return {
    svg,
    words: `${given}: the lowest of ${own.count} balls is ${deep}; the law says ${lawful} r.`,
    handles: [...made.places.map(hold), { ...knob, nudge: (dx, dy) => next(Math.sign(dx - dy)) }],
  };
}

export const figure = {
  title: "What unfinished sweeps leave",
  caption:
    "Each lens shows how deep a ball lies in what is below it, and the bracket what the law " +
    "says: drag a ball up to make it heavier, and spend the sweeps of a step on substeps.",
  height: 480,
  narrow: 360,
  knobs: ["iters", "baumgarte", "dt", "warm"],
  start: () => ({ masses: Array(MOST).fill(1), count: FIRST, parts: 1 }),
  buttons: [
    ["A ball more", ({ own }) => (own.count = Math.min(MOST, own.count + 1))],
    ["A ball less", ({ own }) => (own.count = Math.max(FEWEST, own.count - 1))],
  ],
  draw,
};
