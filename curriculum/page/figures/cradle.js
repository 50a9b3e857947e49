/* Newton's cradle: the same ball, all impacts at one moment or one shortly after another. */
import { ball, number } from "../draw.js";
import { runExact } from "../engine.js";
import { clock, G, handle, kept, label, line, R, scene, shift, tidy, within } from "../parts.js";

const [COUNT, LENGTH] = [4, 0.5]; // balls; m of a string
const MOST = 0.9; // rad
const APART = 1e-3; // r: the gap where the impacts come one after another
const QUARTER = (Math.PI / 2) * Math.sqrt(LENGTH / G); // s of a small swing down

// The speeds after the first ball has come in with `speed`; no weight to speak of while they strike.
const strike = kept((speed, apart) => {
  const x = Array.from({ length: COUNT }, (_, i) => i * (2 + (apart ? APART : 0)) * R);
  x[0] -= 1e-3 * R;
  const balls = scene(x.map(() => 0.5), { x, vx: x.map((_, i) => (i ? 0 : speed)), restitution: 1 });
  const rows = 200;
  const run = runExact(balls, { dt: 1e-5 }, rows, 1e-9);
  return Array.from(run.vx.subarray(rows * COUNT, (rows + 1) * COUNT));
});

// The angles of the strings at a time: the swing down, the impact, the swing up.
function angles(view, after) {
  const { pulled, time } = view.own;
  const phase = (Math.PI / 2) * ((time ?? 0) / QUARTER);
  if (time === null || phase <= Math.PI / 2) return after.map((_, i) => (i ? 0 : -pulled * Math.cos(phase)));
  return after.map((v) => (v / Math.sqrt(G * LENGTH)) * -Math.cos(phase));
}

const speedOf = (pulled) => pulled * Math.sqrt(G * LENGTH); // a small swing's, at its lowest
const shape = (view) => {
  const wide = view.width < 480 ? view.width : view.width / 2;
  const scale = Math.min(270, wide / 1.3);
  return { wide, scale, r: R * scale * 0.72, top: 34, rows: view.width < 480 };
};

function frame(view, after, title) {
  const { wide, scale, r, top } = shape(view);
  const first = wide / 2 - (COUNT - 1) * r;
  const swings = angles(view, after).map((angle, i) => {
    const x = first + 2 * r * i;
    const [bx, by] = [x + LENGTH * scale * Math.sin(angle), top + LENGTH * scale * Math.cos(angle)];
    return line(x, top, bx, by, "axis") + ball("exact", bx, by, r);
  });
  const beam = line(first - r, top, first + 7 * r, top, "table-top");
  return label(title, wide / 2, 18, "middle", "axis-name") + beam + swings.join("");
}

function draw(view) {
  const { pulled } = view.own;
  const speed = speedOf(pulled);
  const [once, chain] = [strike(speed, false), strike(speed, true)];
  const { wide, rows, scale, r, top } = shape(view);
  const list = (after) => after.map((v) => number(v / speed, 2)).join(", ");
  const angle = angles(view, once)[0];
  const [x, y] = [wide / 2 - (COUNT - 1) * r + LENGTH * scale * Math.sin(angle), top + LENGTH * scale * Math.cos(angle)];
  const second = shift(rows ? 0 : wide, rows ? 200 : 0, frame(view, chain, "one after another"));
  const text = `pulled back by ${number((pulled * 180) / Math.PI, 2)}°`;
  return {
    svg: frame(view, once, "at one moment") + second,
    words: `All impacts at one moment: they leave with ${list(once)} of its speed. One shortly after another: ${list(chain)}.`,
    handles: [handle("ball", x, y, r, "the first ball: pull it back", pulled, text)],
  };
}

const time = clock(0.35, () => 2 * QUARTER, ["Let go", "Stop"]);
const set = (view, pulled) => Object.assign(view.own, { time: null, pulled: tidy(within(0.1, pulled, MOST), 3) });

export const figure = {
  title: "Newton’s cradle, with two laws of impact",
  caption:
    "Pull back the first ball and let go: how the others leave depends on whether all impacts happen at one moment or one shortly after another.",
  height: 210,
  narrow: 400,
  start: () => ({ pulled: 0.6, time: null }),
  draw,
  drag(view, name, x, y) {
    const { wide, r, top } = shape(view);
    set(view, Math.atan2(wide / 2 - (COUNT - 1) * r - x, Math.max(10, y - top)));
  },
  nudge: (view, name, dx, dy) => set(view, view.own.pulled - 0.05 * (dx + dy)),
  release: (view) => time.start(view),
  ...time.parts,
};
