/* The signs of a contact: normal, depth and v_n, of ball a with ball b and with the table. */
import { arrow, ball, label, number, table, within } from "../draw.js";
import { detect_contacts } from "../contact.js";
import { column, R } from "../runs.js";

const [GROUND, ARROW] = [26, 0.1]; // px of table; m in the picture for 1 m/s
const [SIDE, LOW, TOP, FAST] = [0.45, 0.03, 0.34, 1.5]; // m, m/s: how far one can drag

function draw(view) {
  const { own: { x, y, vx, vy }, width, height } = view; // of ball a; ball b lies in the middle
  const [scale, floor] = [Math.min(580, width / 1.1), height - GROUND]; // px for 1 m
  const place = (toX, toY) => [width / 2 + toX * scale, floor - toY * scale];
  const all = detect_contacts(column([y, R], { x: [x, 0], vx: [vx, 0], vy: [vy, 0] }), Infinity);
  const contacts = [all[0], all[2]]; // with the table, with ball b
  const normals = contacts.map(({ nx, ny }, k) => {
    const [fromX, fromY] = k ? place(nx * R, R + ny * R) : place(x, 0);
    const [dx, dy] = [0.7 * R * scale * nx, -0.7 * R * scale * ny];
    return [arrow("push m-exact", fromX, fromY, dx, dy),
      label("n", fromX + 1.35 * dx, fromY + 1.35 * dy + 5, "middle", "axis-name")];
  });
  const [[ax, ay], [bx, by], r] = [place(x, y), place(0, R), R * scale];
  const [tipX, tipY] = place(x + ARROW * vx, y + ARROW * vy);
  const there = { label: "ball a", value: ["x", "y"], low: [-SIDE, LOW], high: [SIDE, TOP],
    step: 0.01, at: (toX, toY) => [(toX - width / 2) / scale, (floor - toY) / scale] };
  const fast = { label: "the velocity of ball a", value: ["vx", "vy"], low: [-FAST, -FAST],
    high: [FAST, FAST], step: 0.1, at: (toX, toY) => [toX / scale / ARROW, -toY / scale / ARROW] };
  return {
    picture: [
      table(0, floor, width, GROUND),
      ball("fixed", bx, by, r, "body"), label("b", bx, by + 5, "middle", "on-ball"),
      view.grab(there, [ball("exact", ax, ay, r), label("a", ax, ay + 5, "middle", "on-ball")]),
      normals, arrow("weight", ax, ay, ARROW * vx * scale, -ARROW * vy * scale),
      view.point(within(10, tipX, width - 10), within(10, tipY, height - 10), fast),
    ],
    words: contacts.map((c, k) => `${k ? "Ball b" : "Table"}: depth ${number(c.depth / R, 2)} r, ` +
      `vₙ ${number(c.v_n(), 2)} m/s.`).join(" "),
  };
}

export const figure = {
  title: "The signs of a contact",
  caption: "The normal n points to a, depth is positive in an overlap, vₙ while they separate.",
  height: (width) => (width < 480 ? 200 : 280),
  start: () => ({ x: 0.24, y: 0.3, vx: 0.3, vy: -1.2 }),
  draw,
};
