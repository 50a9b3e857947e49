/* A third ball strikes two, e = 1: where they touch it is one impact, a micrometre apart it is two. */
import { arrow, ball, clipped, label, number, table } from "../draw.js";
import { Ball, Contact, solve_impacts } from "../contact.js";
import { R } from "../runs.js";

const [BEFORE, AFTER, GROUND] = [0.4, 0.8, 14]; // s that are shown, px
const ROWS = [["touching", [[0, 1]]], ["a micrometre apart", [[0], [1]]]]; // impacts in their order

// The velocities of the three balls [m/s] after impacts, each of these contacts (0: balls 1 and 2).
function struck(impacts) {
  const balls = [1, 0, 0].map((vx, k) => new Ball(2 * R * k, R, vx, 0, 1, R));
  for (const each of impacts)
    solve_impacts(each.map((k) => new Contact(balls[k + 1], balls[k], 1, 0, 0)), 1);
  return balls.map(({ vx }) => vx);
}

function draw(view) {
  const { own: { time }, width, height } = view;
  const [scale, tall, since] = [width / 1.95, height / 2, time - BEFORE]; // px for 1 m, px, s
  const r = R * scale;
  const after = ROWS.map(([, impacts]) => struck(impacts));
  const rows = ROWS.map(([name], k) => {
    const floor = (k + 1) * tall - GROUND - 2;
    return [table(0, floor, width, GROUND), label(name, 4, floor - tall + GROUND + 26),
      after[k].map((v, i) => {
        const now = since >= 0 ? v : Number(i === 0);
        const x = 0.385 * width + (2 * R * (i - 1) + now * since) * scale;
        return [ball("exact", x, floor - r, r), arrow("weight", x, floor - r, 1.6 * r * now, 0)];
      })];
  });
  const told = after.map((each) => each.map((v) => number(v, 2)).join(", "));
  return {
    picture: clipped(0, 0, width, height, rows),
    words: since >= 0 ? `Touching: ${told[0]} m/s. A micrometre apart: ${told[1]} m/s.`
      : "The first ball comes at 1 m/s; the others lie still.",
  };
}

export const figure = {
  title: "A row of balls is struck",
  caption: "The same row, touching and not quite.",
  height: (width) => (width < 480 ? 220 : 260),
  start: () => ({ time: BEFORE + AFTER }),
  clock: () => ({ end: BEFORE + AFTER, rate: 0.6 }),
  play: () => "Strike it",
  draw,
};
