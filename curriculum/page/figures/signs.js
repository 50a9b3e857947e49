/* The signs of a contact: normal, depth and v_n, of a ball with another ball and with the table. */
import { arrow, ball, label, number, table, within } from "../draw.js";
import { detectContacts, normalSpeed } from "../engine.js";
import { pair, R } from "../kit.js";

const GROUND = 26; // px of table
const ARROW = 0.1; // m in the picture for 1 m/s
const [SIDE, TOP, FAST] = [0.45, 0.34, [-1.5, 1.5]]; // m, m, m/s: how far one can drag

const wayOf = (speed) => (speed > 0 ? "separating" : speed < 0 ? "closing" : "neither");

// Ball a and the tip of its velocity, as what one drags.
function handlesOf(view, { scale, floor, place }, texts) {
  const { width } = view;
  const { x, y, vx, vy } = view.own;
  const [ax, ay] = place(x, y);
  const [tipX, tipY] = place(x + ARROW * vx, y + ARROW * vy);
  const tip = [within(8, tipX, width - 8), within(8, tipY, view.height - 8)]; // none is lost
  const [places, speeds] = [{ x: [-SIDE, SIDE], y: [0, TOP] }, { vx: FAST, vy: FAST }];
  const fast = `${number(vx, 2)} m/s to the right, ${number(vy, 2)} m/s up; ${texts}`;
  return [
    pair(view, "ball", [ax, ay], "ball a", texts, places, {
      at: (toX, toY) => [(toX - width / 2) / scale, (floor - toY) / scale],
      px: 0.01 * scale,
      r: R * scale,
    }),
    pair(view, "velocity", tip, "the velocity of ball a", fast, speeds, {
      at: (toX, toY) => [(toX - ax) / scale / ARROW, (ay - toY) / scale / ARROW],
      px: 0.1 * ARROW * scale,
    }),
  ];
}

function draw(view) {
  const { x, y, vx, vy } = view.own; // of ball a; ball b lies still in the middle
  const scale = Math.min(680, view.width / 1.1); // px for 1 m
  const floor = view.height - GROUND;
  const place = (toX, toY) => [view.width / 2 + toX * scale, floor - toY * scale];
  const contacts = detectContacts([x, 0], [y, R], [R, R], Infinity).filter((c) => c.i === 0);
  const texts = contacts.map((c) => {
    const speed = normalSpeed(c, [vx, 0], [vy, 0]);
    const [depth, v] = [number(c.depth / R), number(speed)];
    return `a and ${c.j < 0 ? "table" : "b"}: depth ${depth} r, v_n ${v} m/s, ${wayOf(speed)}`;
  });
  const normals = contacts.map(({ j, nx, ny }) => {
    const [fromX, fromY] = j < 0 ? place(x, 0) : place(nx * R, R + ny * R);
    const [dx, dy] = [0.7 * R * scale * nx, -0.7 * R * scale * ny];
    const name = label("n", fromX + dx + 8, fromY + dy + 5, "start", "axis-name");
    return arrow("push m-exact", fromX, fromY, dx, dy) + name;
  });
  const [ax, ay] = place(x, y);
  const [bx, by] = place(0, R);
  return {
    svg: [
      table(0, floor, view.width, GROUND),
      ball("fixed", bx, by, R * scale, "body"),
      label("b", bx, by + 5, "middle", "on-ball"),
      ball("exact", ax, ay, R * scale, "ball plainly"),
      label("a", ax, ay - 0.5 * R * scale, "middle", "on-ball"),
      ...normals,
      arrow("weight", ax, ay, ARROW * vx * scale, -ARROW * vy * scale),
    ].join(""),
    words: texts.map((each) => `Contact of ${each}.`).join(" "),
    handles: handlesOf(view, { scale, floor, place }, texts.join("; ")),
  };
}

export const figure = {
  title: "The signs of a contact",
  caption:
    "The normal n points to a, the depth is positive in an overlap, and v_n while the two " +
    "separate: drag ball a, and the tip of its velocity.",
  height: 330,
  narrow: 200,
  start: () => ({ x: 0.24, y: 0.3, vx: 0.3, vy: -1.2 }),
  draw,
};
