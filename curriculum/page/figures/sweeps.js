/* The sweeps, contact after contact: a stack of three, its impulses as bars, the clamp at zero. */
import { arrow, axis, ball, circle, label, number, plural, rect, table } from "../draw.js";
import { beside, grip, kept, visits, wholly } from "../kit.js";

const [COUNT, PX, SWEEPS] = [3, 34, 20];
const LAST = COUNT * SWEEPS;
const UNIT = 24; // px of an arrow for a speed of g dt
const names = ["ball 1 on the table", "ball 2 on ball 1", "ball 3 on ball 2"];

// In m g dt and g dt: all balls have fallen for one step, the uppermost has a speed besides.
const course = kept((top) => visits([1, 1, 1], [0, 0, 0], [-1, -1, top - 1], LAST));

// A contact's impulse as a bar, and what the last change asked for.
function bar({ contact, wanted, lam }, c, y, sx) {
  const clamped = lam[c] === 0 && wanted < 0;
  const change = arrow("weight", sx(clamped ? 0 : lam[c] - wanted), y - 15, sx(wanted) - sx(0), 0);
  return [
    rect(sx(0), y - 9, sx(lam[c]) - sx(0), 18, "bar-fill m-lcp"),
    lam[c] > 0 ? label(number(lam[c]), sx(lam[c]) + 6, y + 5) : "",
    c === contact ? change : "",
    c === contact && clamped ? label("clamped at 0", sx(0) + 6, y + 5) : "",
  ].join("");
}

function saying({ contact, wanted, lam }, at) {
  if (contact === null) return "Gravity has acted and no contact has pushed";
  const clamped = lam[contact] === 0 && wanted < 0 ? ", clamped at 0" : "";
  const change = `${wanted < 0 ? "less" : "more"} by ${number(Math.abs(wanted), 2)}`;
  return `Sweep ${Math.ceil(at / COUNT)}, ${names[contact]}: ${change}${clamped}`;
}

const timeOf = (view) => Math.floor(view.own.time ?? 0); // contacts that have been mended

// The balls over the table with their speeds, and the contact that was mended last.
function picture(left, heightOf, { contact, vy }) {
  const x = 0.4 * left;
  const each = (v, i) =>
    ball("lcp", x, heightOf(i) - PX, PX, i === COUNT - 1 ? "ball" : "body") +
    arrow("weight", x + PX + 12, heightOf(i) - PX, 0, -UNIT * v);
  const event = contact === null ? "" : circle(x, heightOf(contact), 8, "event m-lcp");
  return table(0, heightOf(0), left, 42) + vy.map(each).join("") + event;
}

function draw(view) {
  const { own } = view;
  const [at, seen] = [timeOf(view), course(own.top)];
  const now = seen[at];
  const heightOf = (c) => view.height - 42 - 2 * c * PX; // of a contact
  const chart = {
    x: axis([0, 3.4], "impulse / m g dt", 0, 1, 2, 3),
    y: { domain: [0, 1], ticks: [] },
    rules: [{ x: 0 }],
    under: ({ sx }) => names.map((_, c) => bar(now, c, heightOf(c) - 12, sx)).join(""),
  };
  const { svg, sx, middle } = beside(view, chart, (left) => picture(left, heightOf, now));
  // to the first moment at which the lowest contact carries so much
  const carrying = (wanted) => seen.findIndex((each) => each.lam[0] >= wanted - 0.02);
  const until = (x) => (carrying(sx.back(x)) + LAST + 1) % (LAST + 1);
  const sweep = { low: 0, high: LAST, step: 1, at: until, get: () => timeOf(view) };
  const bottom = [sx(now.lam[0]), heightOf(0) - 12];
  const [x, y] = [0.8 * middle, heightOf(COUNT - 1) - PX];
  const fast = `${number(own.top - 1, 2)} g dt`;
  const lift = { low: -1, high: 3, step: 0.1, at: (toX, to) => 1 + (y - to) / UNIT };
  const named = ["the uppermost ball’s speed before the sweeps", fast, lift];
  const top = grip(view, "top", x + PX + 12, y - UNIT * now.vy[COUNT - 1], ...named);
  const carried = now.lam.map((each) => number(each)).join(", ");
  return {
    svg,
    words:
      `The uppermost ball begins with ${fast}. ${saying(now, at)}. ` +
      `The contacts carry ${carried} m g dt.`,
    handles: [
      grip(view, "time", ...bottom, "the sweeps", `${plural(at, "contact")} mended`, sweep),
      wholly(top, "ball", x, y, PX),
      top,
    ],
    lit: at ? ["sweep"] : [],
  };
}

export const figure = {
  title: "The sweeps, contact after contact",
  caption:
    "Each contact mends itself and disturbs its neighbours; drag the uppermost ball’s speed " +
    "upwards, play, and the clamp stops its contact from pulling.",
  height: 260,
  start: () => ({ time: COUNT, top: 0 }),
  clock: () => ({ end: LAST, rate: 2, name: "Play" }),
  buttons: [["One contact on", (view) => (view.own.time = (timeOf(view) + 1) % (LAST + 1))]],
  draw,
};
