/* Balls to lift, drop and throw, in real time: on the first screen one, by the exact model, which
 * gives back a fixed share of its speed; in the sandbox many, by the model that is chosen. */
import { arrow, ball, el, label, number, round, table, within } from "../draw.js";
import { runExact, stateAt, STEP } from "../engine.js";
import { knobs, R, scene } from "../parts.js";

const GROUND = 46; // px of table below its top
const FASTEST = 6; // m/s, of a ball that is thrown
const high = ({ own }) => (own.balls ? 1.6 : 0.8); // m over the table that are seen
const scaleOf = (view) => (view.height - GROUND) / high(view); // px for a metre
const wide = (view) => view.width / scaleOf(view); // m
const ground = (view) => table(0, view.height - GROUND, view.width, GROUND);

// A handle for a ball at place() [m]: put(x, y) moves it, letGo([vx, vy]) lets it go.
function inHand(view, name, label, { place, put, letGo }) {
  const [[x, y], scale, floor] = [place(), scaleOf(view), view.height - GROUND];
  return {
    name,
    label,
    x: x * scale,
    y: floor - y * scale,
    r: R * scale,
    value: y - R,
    text: `${number(y - R, 2)} m above the table`,
    drag: (toX, toY) => put(toX / scale, (floor - toY) / scale),
    nudge: (dx, dy) => put(place()[0] + 0.02 * dx, place()[1] - 0.02 * dy),
    release() {
      const [vx, vy] = view.flick().map((v) => within(-FASTEST, v / scale, FASTEST));
      letGo([vx, -vy]);
    },
  };
}

// ---- the first screen

const BOUNCE = 0.6;
const LONG = 12; // s, until it rests however it was thrown
const held = (view, x, y) => [within(R, x, wide(view) - R), within(R, y, 0.8 - 0.2 * R)];

// Sideways the ball flies between two walls: place and speed after a time.
function across(view, x, vx, time) {
  const wall = vx > 0 ? wide(view) - R : R;
  const hit = vx === 0 ? Infinity : (wall - x) / vx;
  if (hit >= time) return [x + time * vx, vx];
  return across(view, wall, -BOUNCE * vx, time - hit);
}

// Upwards it bounces on the table, event to event. Does it still move, so many seconds later?
function fly(view, seconds) {
  const { place, velocity } = view.own;
  const up = scene([place[1]], { vy: [velocity[1]], restitution: BOUNCE });
  const { y, vy } = stateAt(runExact(up, { dt: seconds }, 1), 1);
  const [x, vx] = across(view, place[0], velocity[0], seconds);
  Object.assign(view.own, { place: [x, y[0]], velocity: [vx, vy[0]] });
  return Math.abs(vx) > 1e-3 || Math.abs(vy[0]) > 1e-6 || y[0] - R > 1e-9;
}

// Hold the ball at a place, in metres.
function hold(view, x, y) {
  view.stop();
  Object.assign(view.own, { free: false, velocity: [0, 0], place: held(view, x, y) });
}

function letGo(view, velocity) {
  Object.assign(view.own, { free: true, velocity });
  if (view.still) fly(view, LONG);
  else view.run();
}

function drop(view) {
  view.own.place = [0.5 * wide(view), 0.68];
  letGo(view, [0, 0]);
}

function drawGrab(view) {
  const { own } = view;
  const floor = view.height - GROUND;
  own.place = held(view, ...(own.place || [0.5 * wide(view), 0.5]));
  const grip = inHand(view, "ball", "the ball; arrow keys move it, Enter lets it go", {
    place: () => own.place,
    put: (toX, toY) => hold(view, toX, toY),
    letGo: (velocity) => letGo(view, velocity),
  });
  const { x, y, r, value: gap } = grip;
  const rests = own.free && gap < 1e-9 && Math.abs(own.velocity[1]) < 1e-9;
  const rx = r * (1 - 0.4 * Math.min(1, gap));
  return {
    svg: [
      ground(view),
      el("ellipse", { cx: x, cy: floor + 6, rx, ry: 5, class: "shadow" }),
      ball("exact", x, y, r),
      arrow("weight", x, y, 0, 70) + label("weight", x + 7, y + 70),
      rests ? arrow("push m-exact", x, floor, 0, -70) + label("push", x + 7, floor - 60) : "",
    ].join(""),
    words: rests
      ? "It rests: the table pushes with exactly the ball’s weight."
      : `${own.free ? "" : "A hand holds it "}${grip.text}.`,
    handles: [grip],
  };
}

const grab = {
  title: "A ball over a table",
  caption: "Grab the ball: lift it, drop it, throw it.",
  height: 360,
  narrow: 340,
  start: () => ({ place: null, velocity: [0, 0], free: false }),
  buttons: [["Drop it", drop]],
  draw: drawGrab,
  tick: fly,
};

// ---- the sandbox

const NEXT = { soft: "lcp", lcp: "penalty", penalty: "soft" };
const MOST = 9; // balls
const WALL = 1e3; // m: the radius of two held balls that serve as walls

const fresh = (x, y) => ({ x, y, vx: 0, vy: 0, mass: 1, radius: R });
const stack = (x) => [0, 1, 2].map((k) => fresh(x, (2 * k + 1) * R));
const wall = (x) => ({ ...fresh(x, R), mass: Infinity, radius: WALL });

// One step of the model for all balls; the one that is held stays in the hand.
function step(view, told) {
  const { own } = view;
  const all = [...own.balls, wall(-WALL), wall(wide(view) + WALL)];
  const column = (name) => [name, all.map((each) => each[name])];
  const scene = Object.fromEntries(Object.keys(all[0]).map(column));
  const next = STEP[own.model]({ ...scene, pushed: own.pushed }, scene, told);
  own.pushed = next.pushed;
  own.balls.forEach((each, k) => {
    if (String(k) === view.grabbed) return;
    for (const key of ["x", "y", "vx", "vy"]) each[key] = next[key][k];
    const lost = !(Math.abs(each.y) < 50 && each.x > -R && each.x < wide(view) + R);
    if (lost) Object.assign(each, fresh(0.5 * wide(view), 1.2));
  });
}

function drawSandbox(view) {
  const { balls, model, last } = view.own;
  const hold = (each, k) =>
    inHand(view, String(k), `ball ${k + 1}`, {
      place: () => [each.x, each.y],
      put(x, y) {
        const place = { x: within(R, x, wide(view) - R), y: within(R, y, high(view) - R) };
        Object.assign(each, place, { vx: 0, vy: 0 });
        view.own.last = k;
        if (view.grabbed && !view.still) view.run();
      },
      letGo: ([vx, vy]) => Object.assign(each, { vx, vy }),
    });
  const handles = balls.map(hold);
  const drawn = handles.map(({ x, y, r }) => ball(model, x, y, r));
  return {
    svg: ground(view) + drawn.join(""),
    words:
      `${balls.length} balls by ${model}, at steps of ${round(1000 * view.get("dt"))} ms; ` +
      `${handles[last].label} ${handles[last].text}.`,
    handles,
  };
}

function add(view) {
  const { balls } = view.own;
  if (balls.length < MOST) balls.push(fresh(0.3 + 0.23 * (balls.length % 5), 1.3));
  view.run();
}

const sandbox = {
  title: "Sandbox",
  caption:
    "Throw balls, build a stack, and change the model under them. Real time, by the time step " +
    "and the knobs that are set on this page.",
  height: 380,
  narrow: 320,
  knobs: ["restitution", "dt"],
  start: () => ({ model: "soft", balls: stack(0.5).concat(fresh(1.1, R)), late: 0, last: 0 }),
  buttons: [
    [
      (view) => (view.running ? "Stop" : "Run"),
      (view) => (view.running ? view.stop() : view.run()),
    ],
    [({ own }) => `Model: ${own.model}`, ({ own }) => (own.model = NEXT[own.model])],
    ["Add a ball", add],
    ["Stack again", ({ own }) => Object.assign(own, { balls: stack(0.5), last: 0 })],
  ],
  draw: drawSandbox,
  tick(view, seconds) {
    const { own } = view;
    const told = knobs(view);
    own.late = Math.min(0.05, own.late + seconds);
    for (; own.late >= told.dt; own.late -= told.dt) step(view, told);
  },
};

export const figures = { grab, sandbox };
