/* Newton's cradle: the same ball, all impacts at one moment or one shortly after another. */
import { ball, label, line, number, shift } from "../draw.js";
import { runExact } from "../engine.js";
import { G, grip, kept, R, scene, wholly } from "../kit.js";

const [COUNT, LENGTH] = [4, 0.5]; // balls; m of a string
const APART = 1e-3; // r: the gap where the impacts come one after another
const PACE = Math.sqrt(G / LENGTH); // 1/s, of a small swing
const QUARTER = Math.PI / 2 / PACE; // s of a small swing down

// The speeds after the first ball has come in with `speed`; they have no weight while they strike.
const strike = kept((speed, apart) => {
  const x = Array.from({ length: COUNT }, (_, i) => i * (2 + (apart ? APART : 0)) * R);
  x[0] -= 1e-3 * R;
  const vx = x.map((_, i) => (i ? 0 : speed));
  const balls = scene(x.map(() => 0.5), { x, vx, restitution: 1 });
  const rows = 200;
  const run = runExact(balls, { dt: 1e-5 }, rows, 1e-9);
  return Array.from(run.vx.subarray(rows * COUNT, (rows + 1) * COUNT));
});

// The angles of the strings at a time: the swing down, the impact, the swing up.
function angles({ pulled, time }, after) {
  const swing = Math.cos(PACE * (time ?? 0));
  if (time <= QUARTER) return after.map((_, i) => (i ? 0 : -pulled * swing));
  return after.map((v) => (v / PACE / LENGTH) * -swing);
}

function draw(view) {
  const { pulled } = view.own;
  const narrow = view.width < 480;
  const wide = narrow ? view.width : view.width / 2;
  const scale = Math.min(270, wide / 1.3);
  const [r, top] = [R * scale * 0.72, 34];
  const first = wide / 2 - (COUNT - 1) * r;
  const place = (i, angle) => [
    first + 2 * r * i + LENGTH * scale * Math.sin(angle),
    top + LENGTH * scale * Math.cos(angle),
  ];
  const frame = (after, title) => [
    label(title, wide / 2, 18, "middle", "axis-name"),
    line(first - r, top, first + 7 * r, top, "table-top"),
    ...angles(view.own, after).map((angle, i) => {
      const [x, y] = place(i, angle);
      const string = line(first + 2 * r * i, top, x, y, "axis");
      return string + ball("exact", x, y, r, i ? "seen" : "ball");
    }),
  ];
  const speed = pulled * PACE * LENGTH; // of a small swing, at its lowest
  const [once, chain] = [strike(speed, false), strike(speed, true)];
  const list = (after) => after.map((v) => number(v / speed, 2)).join(", ");
  const text = `pulled back by ${number((pulled * 180) / Math.PI, 2)}°`;
  const at = (x, y) => Math.atan2(first - x, Math.max(10, y - top));
  const range = { r, low: 0.1, high: 0.9, step: 0.05, at, release: view.play };
  const [[x, y], [x2, y2]] = [once, chain].map((each) => place(0, angles(view.own, each)[0]));
  const aside = [narrow ? 0 : wide, narrow ? 200 : 0];
  const second = shift(...aside, ...frame(chain, "one after another"));
  const pull = grip(view, "pulled", x, y, "the first ball: pull it back", text, range);
  const all = `All impacts at one moment: they leave with ${list(once)} of its speed.`;
  return {
    svg: frame(once, "at one moment").join("") + second,
    words: `P${text.slice(1)}. ${all} One shortly after another: ${list(chain)}.`,
    handles: [pull, wholly(pull, "other", x2 + aside[0], y2 + aside[1], r)],
  };
}

export const figure = {
  title: "Newton’s cradle, with two laws of impact",
  caption:
    "Pull back the first ball and let go: how the others leave depends on whether all impacts " +
    "happen at one moment or one shortly after another.",
  height: 210,
  narrow: 400,
  start: () => ({ pulled: 0.6, time: null }),
  clock: () => ({ end: 2 * QUARTER, rate: 0.35, name: "Let go" }),
  draw,
};
