/* The sweeps, contact after contact: a stack of three, its impulses as bars, and the clamp at zero. */
import { arrow, ball, el, number, table } from "../draw.js";
import { makeRows, projectImpulse, solveContacts } from "../engine.js";
import { clock, handle, kept, label, line, plural, R, scene, tidy, within } from "../parts.js";

const [COUNT, PX, SWEEPS] = [3, 34, 20];
const UNIT = 24; // px of an arrow for a speed of g dt
const names = ["ball 1 on the table", "ball 2 on ball 1", "ball 3 on ball 2"];

/* What the sweeps do, contact by contact: [{contact, wanted, lam, vy}], impulses in m g dt and speeds in
 * g dt. All balls have fallen for one step; the uppermost has the speed `top` besides. */
export const course = kept((top) => {
  const balls = scene([R, 3 * R, 5 * R]);
  const contacts = [0, 1, 2].map((i) => ({ i, j: i - 1, nx: 0, ny: 1, depth: 0 }));
  const rows = makeRows(contacts, balls.mass, [0, 0, 0], [0, 0, 0]);
  const [vx, vy] = [[0, 0, 0], [-1, -1, top - 1]];
  const seen = [{ contact: null, wanted: 0, lam: [0, 0, 0], vy: vy.slice() }];
  for (let at = 0; at < COUNT * SWEEPS; at++) {
    let wanted = 0;
    const project = (lam, change) => projectImpulse(lam, (wanted = change));
    solveContacts([rows[at % COUNT]], vx, vy, { iters: 1, project });
    seen.push({ contact: at % COUNT, wanted, lam: rows.map((c) => c.lam), vy: vy.slice() });
  }
  return seen;
});

const now = (view) => course(view.own.top)[Math.floor(view.own.time)];

// Where things stand: the stack's middle, the table, the wall from which bars grow, px of m g dt.
function shape({ width, height }) {
  const wall = Math.max(150, 0.42 * width);
  return { x: Math.max(56, 0.17 * width), floor: height - 34, wall, unit: (width - wall - 56) / 3.4 };
}

// A contact's impulse as a bar from the wall, and what the last change asked for.
function bar({ contact, wanted, lam }, c, { x, floor, wall, unit }) {
  const y = floor - 2 * c * PX - (c ? 0 : 10);
  const length = lam[c] * unit;
  const parts = [el("rect", { x: wall, y: y - 9, width: length, height: 18, class: "bar-fill m-lcp" })];
  if (c === contact) {
    const from = wall + length - (lam[c] > 0 ? wanted * unit : 0);
    parts.push(el("circle", { cx: x, cy: floor - 2 * c * PX, r: 8, class: "event m-lcp" }));
    parts.push(arrow("weight", from, y - 15, wanted * unit, 0));
    if (lam[c] === 0 && wanted < 0) parts.push(label("clamped at 0", wall + 6, y + 5));
  }
  if (lam[c] > 0) parts.push(label(number(lam[c]), wall + length + 6, y + 5));
  return parts.join("");
}

// The scale of the bars: m g dt, from the wall.
function scale({ floor, wall, unit }) {
  const lines = [1, 2, 3].map((k) => {
    const x = wall + k * unit;
    return line(x, 26, x, floor, "grid") + label(String(k), x, floor + 20, "middle", "tick");
  });
  const name = label("impulse / m g dt", wall, 16, "start", "axis-name");
  return name + lines.join("") + line(wall, 26, wall, floor, "table-top");
}

function saying({ contact, wanted, lam }, at) {
  if (contact === null) return "Gravity has acted and no contact has pushed";
  const clamped = lam[contact] === 0 && wanted < 0 ? ", clamped at 0" : "";
  const change = `${wanted < 0 ? "less" : "more"} by ${number(Math.abs(wanted), 2)}`;
  return `Sweep ${Math.floor((at - 1) / COUNT) + 1}, ${names[contact]}: ${change}${clamped}`;
}

function draw(view) {
  const shown = now(view);
  const at = Math.floor(view.own.time);
  const place = shape(view);
  const { x, floor, wall, unit } = place;
  const balls = shown.vy.map((v, i) => {
    const y = floor - (2 * i + 1) * PX;
    return ball("lcp", x, y, PX) + arrow("weight", x + PX + 12, y, 0, -UNIT * v);
  });
  const bars = [0, 1, 2].map((c) => bar(shown, c, place));
  const tip = [x + PX + 12, floor - 5 * PX - UNIT * shown.vy[2]];
  const { top } = view.own;
  return {
    svg: table(0, floor, view.width, 34) + scale(place) + balls.join("") + bars.join(""),
    words: `${saying(shown, at)}. The contacts carry ${shown.lam.map((lam) => number(lam)).join(", ")} m g dt.`,
    handles: [
      handle("sweep", wall + shown.lam[0] * unit, floor - 10, 12, "the sweeps", at, `${plural(at, "contact")} mended`),
      handle("top", ...tip, 12, "the uppermost ball’s speed before the sweeps", top, `${number(top - 1, 2)} g dt`),
    ],
    lit: at ? [["sweep", "lam = max"]] : [],
  };
}

const last = COUNT * SWEEPS;
const time = clock(2, () => last);
const sweepTo = (view, at) => (view.own.time = within(0, Math.round(at), last));
const throwTop = (view, top) => Object.assign(view.own, { time: 0, top: tidy(within(-1, top, 3), 2) });

export const figure = {
  title: "The sweeps, contact after contact",
  caption:
    "Each contact mends itself and disturbs its neighbours; drag the uppermost ball’s speed upwards, and the clamp stops its contact from pulling.",
  height: 260,
  start: () => ({ time: COUNT, top: 0 }),
  draw,
  drag(view, name, x, y) {
    const { floor, wall, unit } = shape(view);
    if (name === "top") throwTop(view, 1 + (floor - 5 * PX - y) / UNIT);
    else sweepTo(view, course(view.own.top).findIndex(({ lam }) => lam[0] >= (x - wall) / unit - 0.02));
  },
  nudge(view, name, dx, dy) {
    if (name === "top") throwTop(view, view.own.top - 0.1 * dy);
    else sweepTo(view, Math.floor(view.own.time) + dx - dy);
  },
  ...time.parts,
  buttons: [
    ...time.parts.buttons,
    { label: "One contact on", press: (view) => sweepTo(view, (Math.floor(view.own.time) + 1) % (last + 1)) },
  ],
};
