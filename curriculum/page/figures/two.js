/* The question of the first bet: what force does the table apply? */
import { number, table } from "../draw.js";
import { BELOW, GROUND, handlesOf, lane, nowOf, placeWords, shownOf } from "../falls.js";
import { R, START } from "../kit.js";
import { startOf } from "../store.js";

const ASKED = { models: ["penalty", "lcp"], from: 0, to: 1.6 }; // s
const FIRST = 0.39; // s, of the still
const SLOW = 6; // times slower than it happens

// Both runs are the chapter's own drop, whatever is set elsewhere: the bet is about them.
const timeOf = ({ own }) => own.time ?? (own.lift ? 0 : FIRST);
function askedOf({ own, open }) {
  const asked = { ...ASKED, time: timeOf({ own }), lift: own.lift };
  return shownOf({ own: asked, values: startOf("drop"), open });
}

function draw(view) {
  const shown = askedOf(view);
  const [floor, wide] = [view.height - BELOW, view.width / 2];
  const high = ((floor - 8) * R) / Math.min(74, 0.28 * wide); // a radius is 74 px
  const sight = { floor, wide, scale: (floor - 8) / high };
  const held = shown.filter((each) => nowOf(each)[0] < high);
  const place = (each) => placeWords(each, true);
  const text = (each) => (each.waits ? "and now?" : place(each));
  const drawn = shown.map((each, k) => lane(each, k, text(each), sight));
  const places = `${shown.map((each) => `${each.model} is ${place(each)}`).join(", ")}.`;
  const asked = "Both are about to touch. What happens now is your first bet.";
  const now = `At ${timeOf(view).toFixed(2)} s`;
  const above = number(nowOf(shown[0])[0] / R - 1, 2);
  const falling = `Both are ${above} r above the table, and fall side by side.`;
  const landed = shown.every(({ row, landing }) => row >= landing - 1);
  return {
    svg: table(0, floor, view.width, GROUND) + drawn.join(""),
    words: landed ? `${now}: ${view.open("ex1") ? places : asked}` : falling,
    // they are held above the table, so that no bet is told
    handles: handlesOf(view, held, sight, [1.3 * R - START, high - R]),
  };
}

export const figure = {
  title: "Two balls fall onto two tables",
  caption:
    `The same ball, the same gravity, the same drop, ${SLOW} times slower than it happens. They ` +
    "differ in one thing: the force that the table applies.",
  height: 346,
  narrow: 280,
  start: () => ({ time: null, lift: 0 }),
  clock(view) {
    const [{ landing, run }] = askedOf(view);
    const end = view.open("ex1") ? ASKED.to : (landing + 2) * run.dt;
    return { from: view.own.lift ? 0 : 0.3, end, rate: 1 / SLOW, name: "Drop both" };
  },
  draw,
};
