/* The corner, three times: gap to the right, force upwards, what a model allows as a thick line,
 * and the state that runs along it while the ball is lifted or pressed into the table. Values: gap
 * [r] and force [m g]. */
import { arrow, axis, ball, circle, clipped, label, line, mark, number, path } from "../draw.js";
import { plot, svg, table, through, within } from "../draw.js";
import { Contact, FLOOR, soft_defaults, soften } from "../contact.js";
import { column, G, kept, R, record } from "../runs.js";

const WIDE = { low: -0.4, high: 1, most: 30, xs: [0, 0.5, 1], ys: [0, 10, 20, 30] };
const NEAR = { low: -0.03, high: 0.06, most: 12, xs: [-0.03, 0, 0.05], ys: [0, 4, 8, 12] };
const MORE = 12; // what the lens enlarges, which is needed where the ball goes in by little

/* law(own): {gap(load), curve, most}: the gap [r] under a load [m g], the line that is allowed, and
 * the hardest press in the picture; free(gap, time) is [gap, load] of the ball once it is let go,
 * below(x, y, height) what is seen under it. */
function corner(model, law, { shown = WIDE, hand = 0.5, ...about }) {
  function draw(view) {
    const { own, width, height } = view;
    const { gap: gapOf, curve, most = shown.most, free, below } = law(own);
    const hardest = Math.min(shown.most, most);
    const pressed = Math.max(0, -own.hand) * hardest; // m g
    const start = pressed > 0 ? gapOf(pressed) : own.hand * shown.high;
    const held = own.time === 0;
    const [gap, load] = held ? [start, pressed] : free(start, own.time);
    const [left, floor] = [Math.min(0.4 * width, 260), height - 74];
    const [r, x] = [Math.min(70, 0.3 * left), left / 2];
    const y = Math.min(floor - r - gap * r, height - 12);
    const { sx, sy, box, picture } = plot(view, {
      left: left + 12,
      x: axis([shown.low, shown.high], "gap / r", ...shown.xs),
      y: axis([-0.035 * shown.most, 1.07 * shown.most], "force / m g", ...shown.ys),
      lines: [{ model, points: curve, kind: "law plainly" }],
    });
    const what = {
      label: "the ball: lift it or press it", value: "hand", low: -1, high: 1, step: 0.05,
      at: (_, to) => -to / r, also: { time: 0 }, release: free && (() => view.play(0)),
      seen: () => (own.time === 0 ? own.hand : gap > 0 ? gap / shown.high : -load / hardest),
    };
    const long = 10 + 3 * Math.sqrt(held ? load : 1);
    const above = held && own.hand > 0 ? line(x, y, x, 0)
      : arrow("weight", x, y - r - 4 - long, 0, long);
    const depth = [table(4, 46, 80, 40),
      circle(44, 46 - (1 + gap) * MORE * r, MORE * r, `magnified m-${model}`)];
    const hold = pressed > 0 ? `Pressed with ${number(pressed, 2)} m g` : "Held by the hand";
    return {
      picture: [
        clipped(0, 0, left, height, table(0, floor, left, 74), above,
          below ? below(x, Math.max(y + r, floor), height) : "",
          arrow(`push m-${model}`, x + r + 12, floor, 0, -100 * Math.sqrt(load / shown.most))),
        view.grab(what, ball(model, x, y, r)),
        shown === NEAR
          ? [through(44, 46, 40, depth), label(`× ${MORE}`, 90, 22, "start", "tick")] : "",
        path([[box.right, sy(0)], [sx(0), sy(0)], [sx(0), box.top]], "allowed"), picture,
        mark(model, sx(within(shown.low, gap, shown.high)),
          sy(Math.min(1.05 * shown.most, load)), 7),
      ],
      words: `${held ? hold : "Let go"}: gap ${number(gap, 2)} r, force ${number(load, 2)} m g.`,
      values: { gap, load },
    };
  }
  return { height: (width) => (width < 480 ? 260 : 300), start: () => ({ hand }), draw, ...about };
}

const wall = () => ({ gap: () => 0, curve: [[WIDE.high, 0], [0, 0], [0, 1.07 * WIDE.most]] });

// ---- penalty: a ramp, and the ball once it is let go

const [DT, SECONDS] = [0.0005, 1.2];
const fall = kept((gap, stiffness, damping) =>
  record("penalty", column([(1 + gap) * R]), { dt: DT, stiffness, damping }, SECONDS / DT).y);

// A coil from top to bottom, the thicker the stiffer.
function coil(x, top, bottom, stiffness) {
  const turn = (_, k) => [x + (k % 2 ? -16 : 16), top + ((k + 0.5) * (bottom - top)) / 12];
  const wire = path([[x, top], ...Array.from({ length: 12 }, turn), [x, bottom]], "coil");
  return svg`<g stroke-width=${Math.log10(stiffness) - 0.5}>${wire}</g>`;
}

function ramp({ stiffness, damping }) {
  const [steep, top] = [(stiffness * R) / G, 1.07 * WIDE.most]; // weights a radius, weights
  return {
    gap: (load) => -load / steep,
    curve: [[WIDE.high, 0], [0, 0], [-top / steep, top]],
    most: -WIDE.low * steep,
    free(start, time) {
      const gap = fall(start, stiffness, damping)[Math.round(time / DT)] / R - 1;
      return [gap, Math.max(0, -gap * steep)];
    },
    below: (x, under, height) => coil(x, under, height - 4, stiffness),
  };
}

/* ---- soft: at rest the solver asks for no velocity where lam = target / R; how deep that is for a
 * load is found by halving. */

function rounded({ impedance: d, dt }) {
  const [solref, solimp] = soft_defaults(0, dt, null, [2 * d - 1, d, 0.001, 0.5, 2]);
  const load = (deep) => {
    const contact = new Contact(column([R])[0], FLOOR, 0, 1, deep * R);
    soften(contact, dt, solref, solimp);
    return contact.target / contact.softness / (G * dt);
  };
  const gap = (wanted, less = 0, more = 2) => {
    const middle = 0.5 * (less + more);
    if (middle === less || middle === more) return -more;
    return load(middle) > wanted ? gap(wanted, less, middle) : gap(wanted, middle, more);
  };
  const depths = Array.from({ length: 60 }, (_, k) => -0.02 * NEAR.low * (k + 1));
  const curve = [[NEAR.high, 0], [0, 0], ...depths.map((each) => [-each, load(each)])];
  return { gap, curve, most: load(-NEAR.low) };
}

export const figures = {
  corner: corner("exact", wall, {
    title: "The corner: gap to the right, force upwards",
    caption: "Lift the ball: a gap and no force. Press it: a force and no gap.",
  }),
  sponge: corner("penalty", ramp, {
    title: "A ball on a spring",
    caption: "A ramp beside the wall: the ball must get in before the table pushes.",
    hand: -0.5, knobs: ["stiffness"],
    clock: () => ({ end: SECONDS, rate: 0.25 }),
    play: () => "Let go",
  }),
  "corner-soft": corner("soft", rounded, {
    title: "soft rounds the corner off",
    caption: "The ball gives way at first, and the slope grows steeper with the depth.",
    hand: -0.5, shown: NEAR, knobs: ["impedance"],
  }),
};
