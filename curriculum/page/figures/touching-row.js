/* A row of two balls is struck by a third, with e = 1: above they touch, so that it is one impact
 * of two contacts; below they are a micrometre apart, so that it is two impacts. Values: the
 * velocities after it [m/s], of both rows. */
import { arrow, ball, label, number, table } from "../draw.js";
import { Ball, Contact, solve_impacts } from "../contact.js";
import { R } from "../runs.js";

const [AFTER, GROUND] = [0.8, 14]; // s that are shown after the impact, px
const ROWS = [["touching", [[0, 1]]], ["a micrometre apart", [[0], [1]]]]; // impacts, one after another

// The velocities of the three balls after impacts, each of these contacts (0: balls 1 and 2).
function struck(impacts) {
  const balls = [1, 0, 0].map((vx, k) => new Ball(2 * R * k, R, vx, 0, 1, R));
  for (const each of impacts)
    solve_impacts(each.map((k) => new Contact(balls[k + 1], balls[k], 1, 0, 0)), 1);
  return balls.map(({ vx }) => vx);
}

function draw(view) {
  const { own: { time, from }, width, height } = view;
  const [scale, lane] = [width / 2.6, height / 2]; // px for 1 m
  const r = R * scale;
  const when = from - 2 * R; // s, at 1 m/s
  const after = ROWS.map(([, impacts]) => struck(impacts));
  const hit = time >= when;
  const what = { label: "the first ball: from where it comes", value: "from", low: 0.25, high: 0.9,
    step: 0.05, at: (x) => (0.5 * width - x) / scale, also: { time: 0 }, release: () => view.play(0) };
  const rows = ROWS.map(([name], k) => {
    const floor = (k + 1) * lane - GROUND - 2;
    const at = (i) => (hit ? 2 * R * (i - 1) + after[k][i] * (time - when)
      : i ? 2 * R * (i - 1) : time - from);
    const balls = [0, 1, 2].map((i) => {
      const [x, v] = [0.5 * width + at(i) * scale, hit ? after[k][i] : Number(i === 0)];
      const drawn = ball("exact", x, floor - r, r);
      return [i || k ? drawn : view.grab(what, drawn), arrow("weight", x, floor - r, 1.6 * r * v, 0)];
    });
    return [table(0, floor, width, GROUND), label(name, 4, floor - lane + GROUND + 26), balls];
  });
  const told = after.map((each) => each.map((v) => number(v, 2)).join(", "));
  return {
    picture: rows,
    words: hit ? `Touching: ${told[0]} m/s. A micrometre apart: ${told[1]} m/s.`
      : "The first ball comes at 1 m/s; the others lie still.",
    values: { after, hit },
  };
}

export const figure = {
  title: "A row of balls is struck",
  caption: "The same row, touching and not quite.",
  height: (width) => (width < 480 ? 220 : 260),
  start: () => ({ from: 0.6, time: 0.4 + AFTER }),
  clock: ({ own }) => ({ end: own.from - 2 * R + AFTER, rate: 0.6 }),
  play: () => "Strike it",
  draw,
};
