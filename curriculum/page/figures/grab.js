/* The first screen: a ball that can be lifted, dropped and thrown. It moves by the exact model, in real
 * time, and gives back a fixed share of its speed. */
import { arrow, ball, el, number, table } from "../draw.js";
import { runExact, stateAt } from "../engine.js";
import { data } from "../data.js";

const R = data.radius;
const BOUNCE = 0.6;
const DT = 1 / 240; // s between two rows of a throw
const LONG = 12; // s that are computed at once
const WALL = 1e4; // m: the radius of the two held balls that serve as walls
const GROUND = 46; // px of table below its top

const scaleOf = (view) => (view.height - GROUND) / 0.8; // px for a metre
const wide = (view) => view.width / scaleOf(view); // m
const held = (view, [x, y]) => [
  Math.min(wide(view) - R, Math.max(R, x)),
  Math.min((view.height - GROUND) / scaleOf(view) - 0.2 * R, Math.max(R, y)),
];

// What the ball does from here on, with a velocity: two walls and a table, event to event.
function thrown(view, [x, y], [vx, vy]) {
  const scene = {
    x: [x, -WALL, wide(view) + WALL],
    y: [y, WALL, WALL],
    vx: [vx, 0, 0],
    vy: [vy, 0, 0],
    mass: [1, Infinity, Infinity],
    radius: [R, WALL, WALL],
    restitution: BOUNCE,
  };
  return runExact(scene, { dt: DT }, Math.round(LONG / DT));
}

function release(view, velocity) {
  const { own } = view;
  own.run = thrown(view, own.place, velocity);
  own.time = 0;
  if (view.still) seek(view, LONG);
  else view.run();
}

// Show the throw at a time.
function seek(view, time) {
  const { own } = view;
  own.time = Math.min(time, LONG);
  const now = stateAt(own.run, Math.min(own.run.steps, Math.floor(own.time / DT)));
  own.velocity = [now.vx[0], now.vy[0]];
  own.place = [now.x[0], now.y[0]];
}

export const figure = {
  title: "A ball over a table",
  caption: "Grab the ball: lift it, drop it, throw it.",
  height: 480,
  narrow: 340,
  start: () => ({ place: null, velocity: [0, 0], run: null, time: 0 }),
  buttons: [
    {
      label: "Drop it",
      press(view) {
        view.own.place = [0.5 * wide(view), 0.68];
        release(view, [0, 0]);
      },
    },
  ],
  draw(view) {
    const { own } = view;
    const scale = scaleOf(view);
    own.place = held(view, own.place || [0.5 * wide(view), 0.5]);
    const [x, y] = [own.place[0] * scale, view.height - GROUND - own.place[1] * scale];
    const gap = own.place[1] - R;
    const rests = own.run && gap < 1e-9 && Math.abs(own.velocity[1]) < 1e-9;
    const push = rests ? arrow("push m-exact", x, view.height - GROUND, 0, -70, "push") : "";
    const rx = R * scale * (1 - 0.4 * Math.min(1, gap));
    const shadow = el("ellipse", { cx: x, cy: view.height - GROUND + 6, rx, ry: 5, class: "shadow" });
    const weight = arrow("weight", x, y, 0, 70, "weight");
    return {
      svg: table(0, view.height - GROUND, view.width, GROUND) + shadow + ball("exact", x, y, R * scale) + weight + push,
      words: rests
        ? "It rests: the table pushes with exactly the ball’s weight."
        : `${number(gap, 2)} m above the table. Let go.`,
      handles: [
        {
          name: "ball",
          x,
          y,
          r: R * scale,
          label: "the ball; arrow keys move it, Enter lets it go",
          value: gap,
          text: `${number(gap, 2)} m above the table`,
        },
      ],
    };
  },
  drag(view, name, x, y) {
    const { own } = view;
    view.stop();
    own.run = null;
    own.velocity = [0, 0];
    own.place = held(view, [x / scaleOf(view), (view.height - GROUND - y) / scaleOf(view)]);
  },
  nudge(view, name, dx, dy) {
    const { own } = view;
    view.stop();
    own.run = null;
    own.place = held(view, [own.place[0] + 0.02 * dx, own.place[1] - 0.02 * dy]);
  },
  release(view) {
    const [x, y] = view.flick().map((v) => Math.max(-6, Math.min(6, v / scaleOf(view))));
    release(view, [x, -y]);
  },
  enter: (view) => release(view, [0, 0]),
  tick(view, seconds) {
    const { own } = view;
    seek(view, own.time + seconds);
    const still = Math.abs(own.velocity[0]) < 1e-3 && Math.abs(own.velocity[1]) < 1e-6 && own.place[1] - R < 1e-9;
    return own.time < LONG && !still;
  },
};
