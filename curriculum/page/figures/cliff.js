/* The cliff: past the critical step the dropped ball of penalty never rests, and soon explodes. A
 * run is judged over the same seconds at every step. Values: how far it still moves in the last
 * quarter [r], the energy that it gained [starts], the critical step [s]. */
import { axis, mark, number, plain, plot, tenTo, within } from "../draw.js";
import { critical_dt } from "../contact.js";
import { data } from "../data.js";
import { column, G, gainOf, kept, R, record } from "../runs.js";

const [LOW, HIGH, SECONDS, STEPS] = [0.0005, 0.064, 4, 2000]; // s; steps, as contact.py takes
const [NONE, FARTHEST] = [1e-6, 1e9]; // r: less is drawn as zero, more as nowhere
const START = data.scenes.drop.start;

// At least so many seconds, and so many steps.
const ring = (dt, stiffness, damping) =>
  record("penalty", column(START), { dt, stiffness, damping },
    Math.max(STEPS, Math.round(SECONDS / dt)));

// How far the ball still moves in the last quarter [r].
function moves({ y }) {
  const late = y.subarray(-Math.round(y.length / 4));
  const far = (late.reduce((a, b) => Math.max(a, b)) - late.reduce((a, b) => Math.min(a, b))) / R;
  return Number.isFinite(far) ? within(NONE, far, FARTHEST) : FARTHEST;
}

const dropped = kept((...given) => {
  const run = ring(...given);
  return { far: moves(run), gained: gainOf(run) };
});

const curve = kept((...spring) =>
  Array.from({ length: 40 }, (_, k) => {
    const dt = LOW * (HIGH / LOW) ** (k / 39);
    return [dt, moves(ring(dt, ...spring))];
  }));

function draw(view) {
  const { dt, stiffness, damping } = view.own;
  const { far, gained } = dropped(dt, stiffness, damping);
  const critical = critical_dt(1, stiffness, damping);
  const popular = critical_dt(1, stiffness, 0);
  const right = critical > 0.006 ? "end" : "start";
  const rules = [{ x: critical, text: `with its damper: ${number(1000 * critical)} ms`,
    side: right }];
  if (popular < HIGH && view.width >= 480)
    rules.push({ x: popular, text: `2√(m/k): ${number(1000 * popular)} ms`, kind: "dashed", row: 1,
      side: right });
  const chart = plot([0, 0, view.width, view.height], {
    x: { ...axis([LOW, HIGH], "time step dt (ms)",
      ...[0.5, 1, 2, 4, 8, 16, 32, 64].map((ms) => [ms / 1000, plain(ms)])), log: true },
    y: { ...axis([NONE, FARTHEST], "still moving at the end / r", [NONE, "0"], 0.001, 1, 1000,
      [1e6, tenTo(6)]), log: true },
    lines: [{ model: "penalty", points: curve(stiffness, damping), kind: "plainly" }], rules,
  });
  const explodes = !(gained < 10);
  const rests = far <= NONE;
  const gains = gained > 1e-9 ? `gains ${number(gained, 4)} times its energy` : "gains no energy";
  const ends = explodes ? "it explodes" : rests
    ? `it comes to rest ${number(G / stiffness / R, 2)} r deep` : "it never rests";
  const [x, y] = [chart.sx(within(LOW, dt, HIGH)), chart.sy(far)];
  const what = {
    label: "the time step", text: `${number(1000 * dt)} ms: ${ends}`, value: "dt", low: LOW, high: HIGH,
    step: 0.0002, at: chart.sx.back,
  };
  return {
    picture: [chart.picture, mark("penalty", x, y, 8), view.point(x, chart.box.bottom, what)],
    words: `At dt = ${number(1000 * dt)} ms the ball ${gains}; ${ends}.`,
    values: { far, gained, critical, explodes, rests },
  };
}

export const figure = {
  title: "The cliff",
  caption: "How far the dropped ball still moves, over the time step. Past the critical step it never rests.",
  height: () => 300,
  knobs: ["dt", "stiffness", "damping"],
  draw,
};
