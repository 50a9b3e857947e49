/* The sweeps, contact after contact: a stack of three, its impulses as bars, the clamp at zero. */
import { arrow, axis, ball, circle, label, number, plural, rect, table } from "../draw.js";
import { makeRows, projectImpulse, solveContacts } from "../engine.js";
import { beside, grip, kept, R, scene } from "../parts.js";

const [COUNT, PX, SWEEPS] = [3, 34, 20];
const LAST = COUNT * SWEEPS;
const UNIT = 24; // px of an arrow for a speed of g dt
const names = ["ball 1 on the table", "ball 2 on ball 1", "ball 3 on ball 2"];

/* What the sweeps do, contact by contact: [{contact, wanted, lam, vy}], impulses in m g dt, speeds
 * in g dt. All balls have fallen for one step; the uppermost has the speed `top` besides. */
const course = kept((top) => {
  const balls = scene([R, 3 * R, 5 * R]);
  const contacts = names.map((_, i) => ({ i, j: i - 1, nx: 0, ny: 1, depth: 0 }));
  const rows = makeRows(contacts, balls.mass, [0, 0, 0], [0, 0, 0]);
  const [vx, vy] = [[0, 0, 0], [-1, -1, top - 1]];
  const seen = [{ contact: null, wanted: 0, lam: [0, 0, 0], vy: vy.slice() }];
  for (let at = 0; at < LAST; at++) {
    let wanted = 0;
    const project = (lam, change) => projectImpulse(lam, (wanted = change));
    solveContacts([rows[at % COUNT]], vx, vy, { iters: 1, project });
    seen.push({ contact: at % COUNT, wanted, lam: rows.map((c) => c.lam), vy: vy.slice() });
  }
  return seen;
});

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

function draw(view) {
  const { top } = view.own;
  const [at, seen] = [timeOf(view), course(top)];
  const { contact, lam, vy } = seen[at];
  const heightOf = (c) => view.height - 42 - 2 * c * PX; // of a contact
  const chart = {
    x: axis([0, 3.4], "impulse / m g dt", 0, 1, 2, 3),
    y: { domain: [0, 1], ticks: [] },
    rules: [{ x: 0 }],
    under: ({ sx }) => names.map((_, c) => bar(seen[at], c, heightOf(c) - 12, sx)).join(""),
  };
  const thrown = (x, v, i) => arrow("weight", x + PX + 12, heightOf(i) - PX, 0, -UNIT * v);
  const picture = (left) => {
    const x = 0.4 * left;
    const balls = vy.map((v, i) => ball("lcp", x, heightOf(i) - PX, PX) + thrown(x, v, i));
    const event = contact === null ? "" : circle(x, heightOf(contact), 8, "event m-lcp");
    return table(0, heightOf(0), left, 42) + balls.join("") + event;
  };
  const { svg, sx, middle } = beside(view, chart, picture);
  // to the first moment at which the lowest contact carries so much
  const carrying = (wanted) => seen.findIndex((each) => each.lam[0] >= wanted - 0.02);
  const until = (x) => (carrying(sx.back(x)) + LAST + 1) % (LAST + 1);
  const sweep = { low: 0, high: LAST, step: 1, at: until, get: () => timeOf(view) };
  const thrownAt = (x, y) => 1 + (heightOf(2) - PX - y) / UNIT;
  const range = { low: -1, high: 3, step: 0.1, at: thrownAt };
  const bottom = [sx(lam[0]), heightOf(0) - 12];
  const [mended, speed] = [`${plural(at, "contact")} mended`, `${number(top - 1, 2)} g dt`];
  const tip = [0.8 * middle + PX + 12, heightOf(2) - PX - UNIT * vy[2]];
  const carried = lam.map((each) => number(each)).join(", ");
  return {
    svg,
    words: `${saying(seen[at], at)}. The contacts carry ${carried} m g dt.`,
    handles: [
      grip(view, "time", ...bottom, "the sweeps", mended, sweep),
      grip(view, "top", ...tip, "the uppermost ball’s speed before the sweeps", speed, range),
    ],
    lit: at ? [["sweep", "lam = max"]] : [],
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
