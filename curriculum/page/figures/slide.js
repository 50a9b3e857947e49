/* A ball slides off a ball that is held, and leaves it at two thirds of where it started. */
import { ball, label, line, path } from "../draw.js";
import { G, grip, kept, R } from "../parts.js";
import { slideOff } from "../sliding.js";

const DT = 0.0002; // s: how finely it is looked at
const SECONDS = 0.9;
const degrees = (angle) => `${((angle * 180) / Math.PI).toFixed(1)}°`;

// The upper ball's path from this angle on, the last row of contact, and where it leaves.
const slides = kept((angle) => {
  const found = slideOff(angle, 2 * R, G, DT, Math.round(SECONDS / DT));
  const end = found.path.findIndex(([, y]) => y < -1.2 * R); // it has fallen past the held one
  return { ...found, end: end < 0 ? found.path.length - 1 : end };
});

function draw(view) {
  const { angle, time } = view.own;
  const { path: places, last, leaves } = slides(angle);
  const scale = Math.min(620, view.width / 0.72, (view.height - 30) / 0.48);
  const [x, y] = [view.width / 2 - 0.12 * scale, 0.31 * scale + 14];
  const place = ([px, py]) => [x + px * scale, y - py * scale];
  const along = (theta, far) => place([far * Math.sin(theta), far * Math.cos(theta)]);
  const predicted = Math.acos((2 / 3) * Math.cos(angle));
  const row = Math.round((time ?? 0) / DT);
  const trail = places.slice(0, row + 1).filter((_, k) => k % 20 === 0);
  const [bx, by] = place(places[row]);
  const [lx, ly] = along(predicted, 0.35);
  const law = "cos θ = ⅔ cos θ₀";
  const at = (toX, toY) => Math.atan2(toX - x, Math.max(1, y - toY));
  const [start, end, said] = [angle, leaves, predicted].map(degrees);
  const text = `starts at ${start}`;
  const range = { r: R * scale, low: 0.05, high: 1.2, step: 0.03, at, release: view.play };
  return {
    svg: [
      ball("fixed", x, y, R * scale, "body"),
      line(x, y, ...along(0, 0.3), "grid"),
      line(x, y, ...along(predicted, 0.33)),
      view.width < 480 ? label(`dashed: ${law}`, 4, view.height - 8) : label(law, lx + 4, ly),
      path(trail.map(place), "line m-exact"),
      row > last ? ball("exact", ...place(places[last]), R * scale, "ghost") : "",
      ball("exact", bx, by, R * scale),
    ].join(""),
    words: `From ${start} it leaves at ${end}; ${law} says ${said}.`,
    handles: [grip(view, "angle", bx, by, "the upper ball: drag where it starts", text, range)],
  };
}

export const figure = {
  title: "A ball slides off a ball that is held",
  caption:
    "The upper ball leaves the lower one where it has lost a third of its height over the lower " +
    "one’s middle: drag where it starts, and let go.",
  height: 300,
  narrow: 250,
  start: () => ({ angle: 0.35, time: null }),
  clock: ({ own }) => ({ end: DT * slides(own.angle).end, rate: 0.25, name: "Let go" }),
  draw,
};
