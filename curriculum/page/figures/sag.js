/* A column at rest under lcp sags as on springs: a bar for the overlap of every contact, and the law. */
import { axis, ball, label, line, number, path, plot, range, rect, table } from "../draw.js";
import { column, G, inRow, kept, R, record } from "../runs.js";

const ROWS = 300; // steps until all is at rest: the run starts where the law has it

// The law: how deep each of so many balls is pressed into what is below it [r].
const lawOf = (count, { dt, iters, baumgarte, warm }) => range(count, (i) =>
  Math.min(1, (((1 - warm) / (baumgarte * iters)) * (count - 1 - i) * G * dt * dt) / R));

const sags = kept((count, knobs) => {
  let top = 0;
  const heights = lawOf(count, knobs).map((deep) => (top += (2 - deep) * R) - R);
  const run = record("lcp", column(heights), { ...knobs, restitution: 0 }, ROWS);
  const [before, depths] = [ROWS - 9, ROWS].map((row) => {
    const ys = inRow(run, "y", row);
    return ys.map((y, i) => (i ? 2 - (y - ys[i - 1]) / R : 1 - y / R));
  });
  const still = (deep, i) => Math.abs(deep - before[i]) < 1e-3 * Math.abs(deep) + 1e-9;
  return { depths, rests: depths.every(still) };
});

function draw(view) {
  const { own: { balls, dt, iters, baumgarte, warm }, width, height } = view;
  const knobs = { dt, iters, baumgarte, warm };
  const [{ depths, rests }, law] = [sags(balls, knobs), lawOf(balls, knobs)];
  const floor = height - 46;
  const r = Math.min(30, (floor - 10) / (2 * balls));
  const at = (i) => floor - 2 * i * r; // of a contact
  const most = 1.12 * Math.max(1e-9, ...depths, ...law);
  const { sx, box, picture } = plot(view, { left: 2 * r,
    x: axis([0, 1000 * most], "overlap (thousandths of r)"), y: { domain: [0, 1], label: "", ticks: [] } });
  const to = (deep) => sx(1000 * Math.max(0, deep));
  return {
    picture: [
      table(0, floor, box.left, 30), depths.map((deep, i) => [ball("lcp", box.left - r, at(i) - r, r),
        rect(sx(0), at(i) - 0.6 * r, to(deep) - sx(0), 0.8 * r, "bar-fill m-lcp")]),
      path(law.map((deep, i) => [to(deep), at(i) - 0.2 * r]), "rule dashed"),
      label("the law", Math.min(to(law[1]) + 14, width - 62), at(1) - 0.2 * r + 2),
      picture, line(sx(0), box.top, sx(0), box.bottom, "rule"),
    ],
    words: `The lowest of ${balls} is ${number(depths[0], 2)} r deep` +
      `${rests ? "" : ", and still moves"}; the law says ${number(law[0], 2)} r.`,
  };
}

export const figure = {
  title: "What unfinished sweeps leave",
  caption: "A bar for every contact of a column at rest: how deep it is. The dashed line is the law.",
  height: (width) => (width < 480 ? 280 : 360),
  knobs: ["iters", "dt"],
  start: () => ({ balls: 30 }),
  draw,
};
