/* The sweeps, contact after contact: a stack of three, its impulses as bars, and the clamp at zero. */
import { arrow, ball, el, number, table } from "../draw.js";
import { makeRows, projectImpulse, solveContacts } from "../engine.js";
import { clock, G, kept, label, line, plural, scene, tidy, within, R } from "../parts.js";

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

// A contact's impulse as a bar from the wall at `x`, and what the last change asked for.
function bar(shown, c, x, y, unit) {
  const { contact, wanted, lam } = shown;
  const length = lam[c] * unit;
  const parts = [el("rect", { x, y: y - 9, width: length, height: 18, class: "bar-fill m-lcp" })];
  if (c === contact) {
    const from = x + length - (lam[c] > 0 ? wanted * unit : 0);
    parts.push(arrow("weight", from, y - 15, wanted * unit, 0));
    if (lam[c] === 0 && wanted < 0) parts.push(label("clamped at 0", x + 6, y + 5));
  }
  const there = lam[c] > 0 ? `${number(lam[c])}` : "";
  return parts.join("") + label(there, x + length + 6, y + 5);
}

function draw(view) {
  const shown = now(view);
  const at = Math.floor(view.own.time);
  const floor = view.height - 34;
  const x = Math.max(56, view.width * 0.17);
  const wall = Math.max(150, view.width * 0.42);
  const unit = (view.width - wall - 56) / 3.4;
  const heights = [1, 3, 5].map((high) => floor - high * PX);
  const balls = heights.map((y, i) => ball("lcp", x, y, PX) + arrow("weight", x + PX + 12, y, 0, -UNIT * shown.vy[i]));
  const bars = [0, 1, 2].map((c) => {
    const y = floor - 2 * c * PX - (c ? 0 : 10);
    const active = c === shown.contact ? el("circle", { cx: x, cy: floor - 2 * c * PX, r: 8, class: "event m-lcp" }) : "";
    return active + bar(shown, c, wall, y, unit);
  });
  const said = shown.contact === null ? "Gravity has acted and no contact has pushed" : `Sweep ${Math.floor((at - 1) / COUNT) + 1}, ${names[shown.contact]}: ${shown.wanted < 0 ? "less" : "more"} by ${number(Math.abs(shown.wanted), 2)}${shown.lam[shown.contact] === 0 && shown.wanted < 0 ? ", clamped at 0" : ""}`;
  const carried = shown.lam.map((lam) => number(lam)).join(", ");
  const tip = heights[2] - UNIT * shown.vy[2];
  return {
    svg: table(0, floor, view.width, 34) + label("impulse / m g dt", wall, 16, "start", "axis-name") + [1, 2, 3].map((k) => line(wall + k * unit, 26, wall + k * unit, floor, "grid") + label(String(k), wall + k * unit, floor + 20, "middle", "tick")).join("") + line(wall, 26, wall, floor, "table-top") + balls.join("") + bars.join(""),
    words: `${said}. The contacts carry ${carried} m g dt.`,
    handles: [
      { name: "sweep", x: wall + shown.lam[0] * unit, y: floor - 10, r: 12, label: "the sweeps", value: at, text: `${plural(at, "contact")} mended` },
      { name: "top", x: x + PX + 12, y: tip, r: 12, label: "the speed of the uppermost ball before the sweeps", value: view.own.top, text: `${number(view.own.top - 1, 2)} g dt` },
    ],
    lit: at ? [["sweep", "lam = "]] : [],
  };
}

const last = COUNT * SWEEPS;
const time = clock(2, () => last);
const set = (view, at) => (view.own.time = within(0, Math.round(at), last));

export const figure = {
  title: "The sweeps, contact after contact",
  caption: "Each contact mends itself and disturbs its neighbours; drag the uppermost ball’s speed upwards, and the clamp stops its contact from pulling.",
  height: 260,
  start: () => ({ time: COUNT, top: 0 }),
  draw,
  drag(view, name, x, y) {
    view.stop();
    if (name === "top") Object.assign(view.own, { time: 0, top: tidy(within(-1, 1 + (view.height - 34 - 5 * PX - y) / UNIT, 3), 2) });
    else set(view, course(view.own.top).findIndex((each) => each.lam[0] >= (x - Math.max(150, view.width * 0.42)) / ((view.width - Math.max(150, view.width * 0.42) - 56) / 3.4) - 0.02));
  },
  nudge(view, name, dx, dy) {
    view.stop();
    if (name === "top") Object.assign(view.own, { time: 0, top: tidy(within(-1, view.own.top - 0.1 * dy, 3), 2) });
    else set(view, Math.floor(view.own.time) + dx - dy);
  },
  tick: time.tick,
  buttons: [
    time.button,
    { label: "One contact on", press: (view) => set(view, (Math.floor(view.own.time) + 1) % (last + 1)) },
  ],
};
