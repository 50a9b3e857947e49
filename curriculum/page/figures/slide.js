/* A ball slides off a ball that is held, and leaves it at two thirds of the height it started from. */
import { ball, el, round } from "../draw.js";
import { runExact } from "../engine.js";
import { clock, G, handle, kept, label, line, R, scene, within } from "../parts.js";

const DT = 0.0002; // s: how finely exact is looked at
const MIDDLE = 5; // m: the held ball is far above the floor
const degrees = (angle) => `${((angle * 180) / Math.PI).toFixed(1)}°`;

/* The upper ball's path from this angle on, and where it leaves: in the middle of the last row in which
 * something else than gravity has changed its velocity. */
const slides = kept((angle) => {
  const x = [0, 2 * R * Math.sin(angle)];
  const balls = scene([MIDDLE, MIDDLE + 2 * R * Math.cos(angle)], { x, mass: [Infinity, 1] });
  const steps = Math.round(0.9 / DT);
  const run = runExact(balls, { dt: DT }, steps);
  const pushed = (row) => {
    const [dvx, dvy] = [run.vx, run.vy].map((v) => v[2 * row + 1] - v[2 * row - 1]);
    return Math.hypot(dvx, dvy + G * DT) > 1e-6 * G * DT;
  };
  let last = steps;
  while (last > 1 && !pushed(last)) last--;
  const path = Array.from({ length: steps + 1 }, (_, row) => [run.x[2 * row + 1], run.y[2 * row + 1] - MIDDLE]);
  const leaves = 0.5 * (Math.atan2(...path[last - 1]) + Math.atan2(...path[last]));
  return { path, last, leaves };
});

// Until the ball has fallen below the held one's middle.
const endOf = (view) => DT * Math.max(1, slides(view.own.angle).path.findIndex(([, y]) => y < -1.2 * R) - 1);
const shape = (view) => {
  const scale = Math.min(620, view.width / 0.72, (view.height - 30) / 0.48);
  return { scale, x: view.width / 2 - 0.12 * scale, y: 0.31 * scale + 14 };
};

function draw(view) {
  const { angle, time: now } = view.own;
  const { path, last, leaves } = slides(angle);
  const { scale, x, y } = shape(view);
  const release = Math.acos((2 / 3) * Math.cos(angle));
  const at = ([px, py]) => [x + px * scale, y - py * scale];
  const ray = (theta, far) => [x, y, ...at([far * Math.sin(theta), far * Math.cos(theta)])];
  const row = Math.round((now ?? 0) / DT);
  const trail = path.slice(0, row + 1).filter((_, k) => k % 20 === 0);
  const steps = trail.map((place, k) => `${k ? "L" : "M"}${at(place).map(round).join(" ")}`);
  const [bx, by] = at(path[row]);
  const [, , lx, ly] = ray(release, 0.35);
  const narrow = view.width < 480;
  return {
    svg: [
      ball("fixed", x, y, R * scale, "body"),
      line(...ray(0, 0.3), "grid"),
      line(...ray(release, 0.33)),
      narrow ? label("dashed: cos θ = ⅔ cos θ₀", 4, view.height - 8) : label("cos θ = ⅔ cos θ₀", lx + 4, ly),
      el("path", { d: steps.join(""), class: "line m-exact" }),
      row > last ? ball("exact", ...at(path[last]), R * scale, "ghost") : "",
      ball("exact", bx, by, R * scale),
    ].join(""),
    words: `From ${degrees(angle)} it leaves at ${degrees(leaves)}; cos θ = ⅔ cos θ₀ says ${degrees(release)}.`,
    handles: [handle("ball", bx, by, 0.8 * R * scale, "the upper ball: drag where it starts", angle, `starts at ${degrees(angle)}`)],
  };
}

const time = clock(0.25, endOf, ["Let go", "Stop"]);
const set = (view, angle) => Object.assign(view.own, { time: null, angle: Number(within(0.05, angle, 1.2).toFixed(3)) });

export const figure = {
  title: "A ball slides off a ball that is held",
  caption:
    "The upper ball leaves the lower one where it has lost a third of its height over the lower one’s middle: drag where it starts, and let go.",
  height: 300,
  narrow: 250,
  start: () => ({ angle: 0.35, time: null }),
  draw,
  drag(view, name, x, y) {
    const { x: mx, y: my } = shape(view);
    set(view, Math.atan2(x - mx, Math.max(1, my - y)));
  },
  nudge: (view, name, dx, dy) => set(view, view.own.angle + 0.03 * (dx + dy)),
  release: (view) => time.start(view),
  ...time.parts,
};
