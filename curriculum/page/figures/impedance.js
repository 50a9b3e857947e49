/* MuJoCo's impedance: how large a share of a hard contact's answer a soft one gives, by its depth.
 * Values: depth [widths] and d. */
import { arrow, axis, ball, clipped, label, mark, number, plot, table } from "../draw.js";
import { impedance, soft_defaults } from "../contact.js";

const [WIDTH, MOST, HARD, PRESS] = [0.001, 1.5, 120, 24]; // m; widths; px: a share of 1, a width

function draw(view) {
  const { own, width, height } = view;
  const { depth, impedance: d1 } = own;
  const [, solimp] = soft_defaults(0, 0.002, null, [2 * d1 - 1, d1, WIDTH, 0.5, 2]);
  const at = (x) => impedance(x * WIDTH, solimp);
  const d = at(depth);
  const [left, floor] = [Math.round(0.4 * width), height - 60];
  const [r, x] = [Math.min(50, 0.22 * left), left / 2 - 16];
  const ticks = [solimp[0], at(0.5), d1].map((v) => [v, v.toFixed(d1 > 0.99 ? 4 : 3)]);
  const points = Array.from({ length: 61 }, (_, k) => [k / 40, at(k / 40)]);
  const { sx, sy, picture, knob } = plot(view, {
    left: left + 12,
    x: axis([0, MOST], "depth / mm", 0, 0.5, 1, 1.5),
    y: axis([solimp[0] - 0.01, d1 + 0.01], "impedance d", ...ticks),
    lines: [{ model: "soft", points, kind: "plainly" }],
  });
  const share = `${(100 * d).toPrecision(d > 0.99 ? 4 : 3)} %`;
  const what = { label: "the ball’s depth", value: "depth", low: 0, high: MOST, step: 0.05,
    at: (_, y) => y / PRESS };
  return {
    picture: [
      clipped(0, 0, left, height, table(0, floor, left, 60)),
      view.grab(what, ball("soft", x, floor + PRESS * depth - r, r)),
      arrow("push m-soft weaker", x + r + 14, floor, 0, -HARD),
      arrow("push m-soft", x + r + 30, floor, 0, -HARD * d),
      label("hard", x + r + 14, floor + 22, "middle", "tick"),
      label(share, x + r + 26, floor - HARD - 10, "middle"),
      picture, mark("soft", sx(depth), sy(d), 7), knob("depth", "the depth", 0.05),
    ],
    words: `${number(depth * WIDTH * 1000, 2)} mm deep, it gives ${share} of the acceleration ` +
      "that a hard contact gives.",
    values: { depth, d },
  };
}

export const figure = {
  title: "MuJoCo’s impedance",
  caption: "The deeper the ball, the larger its share of a hard contact’s answer.",
  height: (width) => (width < 480 ? 230 : 260),
  knobs: ["impedance"],
  start: () => ({ depth: 0.5 }),
  draw,
};
