/* The sweeps, contact after contact: a stack of three, its impulses as bars, and the clamp at zero. */
import { arrow, ball, el, number, table } from "../draw.js";
import { makeRows, projectImpulse, solveContacts } from "../engine.js";
import { axis, beside, clock, handle, kept, label, plural, R, scene, tidy, within } from "../parts.js";

const [COUNT, PX, SWEEPS] = [3, 34, 20];
const UNIT = 24; // px of an arrow for a speed of g dt
const names = ["ball 1 on the table", "ball 2 on ball 1", "ball 3 on ball 2"];

/* What the sweeps do, contact by contact: [{contact, wanted, lam, vy}], impulses in m g dt and speeds in
 * g dt. All balls have fallen for one step; the uppermost has the speed `top` besides. */
const course = kept((top) => {
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

// Where a contact is: between the balls of the picture.
const heightOf = (view, c) => view.height - 42 - 2 * c * PX;

// A contact's impulse as a bar, and what the last change asked for.
function bar({ contact, wanted, lam }, c, y, sx) {
  const bars = [el("rect", { x: sx(0), y: y - 9, width: sx(lam[c]) - sx(0), height: 18, class: "bar-fill m-lcp" })];
  if (lam[c] > 0) bars.push(label(number(lam[c]), sx(lam[c]) + 6, y + 5));
  if (c === contact) bars.push(arrow("weight", sx(lam[c] > 0 ? lam[c] - wanted : 0), y - 15, sx(wanted) - sx(0), 0));
  if (c === contact && lam[c] === 0 && wanted < 0) bars.push(label("clamped at 0", sx(0) + 6, y + 5));
  return bars.join("");
}

function picture(view, { contact, vy }, left) {
  const x = 0.4 * left;
  const parts = vy.map((v, i) => {
    const y = heightOf(view, i) - PX;
    return ball("lcp", x, y, PX) + arrow("weight", x + PX + 12, y, 0, -UNIT * v);
  });
  if (contact !== null) parts.push(el("circle", { cx: x, cy: heightOf(view, contact), r: 8, class: "event m-lcp" }));
  return table(0, heightOf(view, 0), left, 42) + parts.join("");
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
  const chart = {
    x: axis([0, 3.4], "impulse / m g dt", 0, 1, 2, 3),
    y: { domain: [0, 1], ticks: [] },
    rules: [{ x: 0 }],
    under: ({ sx }) => [0, 1, 2].map((c) => bar(shown, c, heightOf(view, c) - 12, sx)).join(""),
  };
  const { svg, x, middle } = beside(view, "sweeps", chart, (left) => picture(view, shown, left));
  const tip = [0.8 * middle + PX + 12, heightOf(view, 2) - PX - UNIT * shown.vy[2]];
  const { top } = view.own;
  return {
    svg,
    words: `${saying(shown, at)}. The contacts carry ${shown.lam.map((lam) => number(lam)).join(", ")} m g dt.`,
    handles: [
      handle("sweep", x(shown.lam[0]), heightOf(view, 0) - 12, 12, "the sweeps", at, `${plural(at, "contact")} mended`),
      handle("top", ...tip, 12, "the uppermost ball’s speed before the sweeps", top, `${number(top - 1, 2)} g dt`),
    ],
    lit: at ? [["sweep", "lam = max"]] : [],
  };
}

const last = COUNT * SWEEPS;
const time = clock(2, () => last);
const sweepTo = (view, at) => (view.own.time = within(0, Math.round(at), last));
// To the first moment at which the lowest contact carries so much [m g dt].
function dragBar(view, carried) {
  const at = course(view.own.top).findIndex(({ lam }) => lam[0] >= carried - 0.02);
  sweepTo(view, at < 0 ? last : at);
}
const throwTop = (view, top) => Object.assign(view.own, { time: 0, top: tidy(within(-1, top, 3), 2) });

export const figure = {
  title: "The sweeps, contact after contact",
  caption:
    "Each contact mends itself and disturbs its neighbours; drag the uppermost ball’s speed upwards, and the clamp stops its contact from pulling.",
  height: 260,
  start: () => ({ time: COUNT, top: 0 }),
  draw,
  drag(view, name, x, y) {
    if (name === "top") throwTop(view, 1 + (heightOf(view, 2) - PX - y) / UNIT);
    else dragBar(view, 3.4 * view.own.along(x));
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
