/* No target above -e v_n: two elastic balls are just parting when a third strikes one of them. */
import { arrow, ball, el, number } from "../draw.js";
import { makeRows, normalSpeed, solveContacts } from "../engine.js";
import { handle, kept, label, line, tidy, within } from "../parts.js";

const ELASTIC = 1; // the restitution of all three
const MOST = 3.5; // m/s

// The speeds after the impact of three touching balls in a row; `repair`: no target below zero.
const struck = kept((speeds, repair) => {
  const [vx, vy] = [speeds.slice(), [0, 0, 0]];
  const contacts = [0, 1].map((i) => ({ i: i + 1, j: i, nx: 1, ny: 0, depth: 0 }));
  const wanted = contacts.map((c) => -ELASTIC * normalSpeed(c, vx, vy));
  const targets = repair ? wanted.map((v) => Math.max(0, v)) : wanted;
  solveContacts(makeRows(contacts, [1, 1, 1], targets, [0, 0]), vx, vy, { iters: 1000 });
  return vx;
});
const energy = (speeds) => speeds.reduce((sum, v) => sum + 0.5 * v * v, 0);

const layout = (view) => {
  const r = Math.min(26, view.width / 13);
  const bars = view.width - Math.min(150, 0.25 * view.width);
  return { r, x: (bars - 16) / 2 - 2 * r, bars, speed: Math.min(30, view.width / 20), rows: [92, 216, 340] };
};
const tip = ({ r, x, speed }, i, v) => x + 2 * r * i + speed * v;
const bowY = (r, i) => -r - 12 - 16 * i; // the arrows stand over one another

function row(view, speeds, k, title, most) {
  const each = layout(view);
  const { r, x, bars, speed, rows } = each;
  const unit = (view.width - bars - 8) / most;
  const balls = speeds.map(
    (v, i) =>
      ball("lcp", x + 2 * r * i, rows[k], r, "ball plainly") +
      arrow("weight", x + 2 * r * i, rows[k] + bowY(r, i), speed * v, 0) +
      label(number(v, 2), x + 2 * r * i, rows[k] + 5, "middle", "on-ball"),
  );
  return (
    label(title, 0, rows[k] - r - 48, "start", "axis-name") +
    balls.join("") +
    el("rect", { x: bars, y: rows[k] - 10, width: energy(speeds) * unit, height: 20, class: "bar-fill m-lcp" }) +
    label(`${number(energy(speeds), 4)} J`, bars, rows[k] + 30, "start")
  );
}

function draw(view) {
  const { speeds } = view.own;
  const [moreau, repaired] = [struck(speeds, false), struck(speeds, true)];
  const most = Math.max(...[speeds, moreau, repaired].map(energy), 0.1);
  const each = layout(view);
  const { r, rows, bars } = each;
  const begun = bars + (energy(speeds) * (view.width - bars - 8)) / most;
  const list = (values) => values.map((v) => number(v, 2)).join(", ");
  const gain = energy(repaired) / energy(speeds) - 1;
  const more = gain > 1e-9 ? `${number(100 * gain, 2)} % more energy` : "no more energy";
  return {
    svg: [
      row(view, speeds, 0, "before", most),
      row(view, moreau, 1, "after, each target −e v_n", most),
      row(view, repaired, 2, "after, no target below 0", most),
      label("energy", bars, rows[0] - r - 22, "start", "axis-name"),
      line(begun, rows[0] - r - 14, begun, rows[2] + 14),
    ].join(""),
    words: `Before: ${list(speeds)} m/s. With −e v_n: ${list(moreau)} m/s and the same energy. With no target below 0: ${list(repaired)} m/s and ${more}.`,
    handles: speeds.map((v, i) =>
      handle(String(i), tip(each, i, v), rows[0] + bowY(r, i), 11, `the speed of ball ${i + 1}`, v, `${number(v, 2)} m/s`),
    ),
  };
}

function set(view, i, v) {
  view.own.speeds = view.own.speeds.map((old, k) => (k === i ? tidy(within(-MOST, v, MOST), 2) : old));
}

export const figure = {
  title: "Three elastic balls, and the energy of the impact",
  caption:
    "Two balls part while a third strikes: targets of −e v_n keep the energy, and the repair that allows no target below zero adds some; drag the speeds.",
  height: 384,
  start: () => ({ speeds: [-1, 0, -3] }),
  draw,
  drag(view, name, x) {
    const each = layout(view);
    set(view, Number(name), (x - tip(each, Number(name), 0)) / each.speed);
  },
  nudge: (view, name, dx, dy) => set(view, Number(name), view.own.speeds[Number(name)] + 0.1 * (dx - dy)),
};
