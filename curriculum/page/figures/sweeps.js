/* The sweeps, contact after contact: a stack of three, its impulses as bars, the clamp at zero.
 * Values: contacts mended, the impulses [m g dt], whether the last change was clamped. */
import { arrow, axis, ball, circle, clipped, label, line, number, plot, rect } from "../draw.js";
import { table } from "../draw.js";
import { kept, visits } from "../runs.js";

const [COUNT, PX, SWEEPS, UNIT] = [3, 34, 20, 24]; // UNIT: px of an arrow for a speed of g dt
const LAST = COUNT * SWEEPS;
const NAMES = ["ball 1 on the table", "ball 2 on 1", "ball 3 on 2"];

// In m g dt and g dt: all balls have fallen for one step, the uppermost has a speed besides.
const course = kept((top) => visits([1, 1, 1], [0, 0, 0], [-1, -1, top - 1], LAST));

function draw(view) {
  const { own, width, height } = view;
  const at = Math.min(LAST, Math.floor(own.time + 1e-9));
  const { contact, wanted, lam, vy } = course(own.top)[at];
  const clamped = contact !== null && lam[contact] === 0 && wanted < 0;
  const heightOf = (c) => height - 42 - 2 * c * PX; // of a contact
  const left = Math.round(0.36 * width);
  const x = 0.4 * left;
  const { sx, box, picture } = plot(view, {
    left, x: axis([0, 3.6], "impulse / m g dt", 0, 1, 2, 3), y: axis([0, 1], ""),
  });
  // a contact's impulse, and what the last change asked for
  const bar = (impulse, c) => {
    const y = heightOf(c) - 12;
    const last = c === contact;
    const before = sx(clamped ? 0 : impulse - wanted);
    return [
      rect(sx(0), y - 9, sx(impulse) - sx(0), 18, "bar-fill m-lcp"),
      last ? arrow("weight", before, y - 17, sx(wanted) - sx(0), 0) : "",
      impulse > 0 ? label(number(impulse), sx(impulse) + 8, y + 6) : "",
      last && clamped ? label("clamped at 0", sx(0) + 8, y + 6) : "",
    ];
  };
  const what = {
    label: "the uppermost ball’s speed before the sweeps", value: "top", low: -1, high: 3,
    step: 0.1, at: (_, y) => -y / UNIT,
  };
  const change = `${number(Math.abs(wanted), 2)} ${wanted < 0 ? "less" : "more"}`;
  const end = clamped ? ", clamped at 0" : "";
  const told = contact === null ? "No contact has pushed yet"
    : `Sweep ${Math.ceil(at / COUNT)}, ${NAMES[contact]}: ${change}${end}`;
  return {
    picture: [
      clipped(0, 0, left, height, table(0, heightOf(0), left, 42)),
      [0, 1].map((i) => ball("lcp", x, heightOf(i) - PX, PX, "body")),
      vy.map((v, i) => arrow("weight", x + PX + 12, heightOf(i) - PX, 0, -UNIT * v)),
      view.grab(what, ball("lcp", x, heightOf(2) - PX, PX)),
      contact === null ? "" : circle(x, heightOf(contact), 8, "event m-lcp"),
      lam.map(bar), picture, line(sx(0), box.top, sx(0), box.bottom, "rule"),
    ],
    words: `${told}. They carry ${lam.map((one) => number(one, 2)).join(", ")} m g dt.`,
    values: { at, lam, clamped },
  };
}

export const figure = {
  title: "The sweeps, contact after contact",
  caption: "Each contact mends itself and disturbs its neighbours. Drag the uppermost ball’s speed "
    + "up: the clamp stops its contact from pulling.",
  height: () => 270,
  start: () => ({ time: COUNT, top: 0 }),
  clock: () => ({ end: LAST, rate: 2 }),
  play: () => "Play",
  buttons: ({ own }) =>
    [["One contact on", () => (own.time = (Math.floor(own.time) + 1) % (LAST + 1))]],
  draw,
};
