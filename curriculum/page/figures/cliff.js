/* The cliff: past the critical step the dropped ball of penalty never rests, and soon explodes. A
 * run is judged over the same seconds at every step. Values: how far it still moves in the last
 * quarter [r], the energy that it gained [starts], the critical step [s]. */
import { axis, label, line, mark, number, plot, tenTo, timeSteps, within } from "../draw.js";
import { critical_dt } from "../contact.js";
import { data } from "../data.js";
import { column, G, gainOf, kept, R, record } from "../runs.js";

const [LOW, HIGH, SECONDS, STEPS] = [0.0005, 0.064, 4, 2000]; // s; steps, as contact.py takes
const [NONE, FARTHEST] = [1e-6, 1e9]; // r: less is drawn as zero, more as nowhere

// A drop of at least so many seconds, and so many steps: how far the ball still moves in the last
// quarter [r], and what energy it gained.
const dropped = kept((dt, stiffness, damping) => {
  const count = Math.max(STEPS, Math.round(SECONDS / dt));
  const start = column(data.scenes.drop.start);
  const run = record("penalty", start, { dt, stiffness, damping }, count);
  const late = run.y.subarray(-Math.round(run.y.length / 4));
  const ends = [Math.max, Math.min].map((pick) => late.reduce((a, b) => pick(a, b)));
  const far = (ends[0] - ends[1]) / R;
  const gained = gainOf(run);
  return { gained, far: Number.isFinite(far) ? within(NONE, far, FARTHEST) : FARTHEST };
}, 200);

function draw(view) {
  const { dt, stiffness, damping } = view.own;
  const { far, gained } = dropped(dt, stiffness, damping);
  const points = Array.from({ length: 40 }, (_, k) => {
    const each = LOW * (HIGH / LOW) ** (k / 39);
    return [each, dropped(each, stiffness, damping).far];
  });
  const [critical, popular] = [damping, 0].map((each) => critical_dt(1, stiffness, each));
  const ticks = [[NONE, "0"], 0.001, 1, 1000, [1e6, tenTo(6)]];
  const { sx, sy, box, picture, knob } = plot(view, {
    x: timeSteps(LOW, HIGH),
    y: { ...axis([NONE, FARTHEST], "still moving at the end / r", ...ticks), log: true },
    lines: [{ model: "penalty", points, kind: "plainly" }],
  });
  const limit = (at, name, side, kind) => [
    line(sx(at), box.top, sx(at), box.bottom, kind),
    label(`${name}: ${number(1000 * at)} ms`, sx(at) + (side === "end" ? -6 : 6), box.top + 14,
      side),
  ];
  const right = critical > 0.006;
  const both = right && popular < 0.025 && view.width >= 480; // there its name has room
  const explodes = !(gained < 10);
  const rests = far <= NONE;
  const gains = gained > 1e-9 ? `gains ${number(gained, 4)} times its energy` : "gains no energy";
  const deep = `it comes to rest ${number(G / stiffness / R, 2)} r deep`;
  const ends = explodes ? "it explodes" : rests ? deep : "it still moves at the end";
  return {
    picture: [
      picture, limit(critical, "with its damper", right ? "end" : "start", "rule"),
      both ? limit(popular, "2√(m/k)", "start", "rule dashed") : "",
      mark("penalty", sx(dt), sy(far), 8), knob("dt", "the time step", 0.0002),
    ],
    words: `At dt = ${number(1000 * dt)} ms the ball ${gains}; ${ends}.`,
    values: { far, gained, critical, explodes, rests },
  };
}

export const figure = {
  title: "The cliff",
  caption: "How far the dropped ball still moves. Past the critical step it never rests.",
  height: (width) => (width < 480 ? 260 : 300),
  knobs: ["dt", "stiffness", "damping"],
  draw,
};
