/* What every picture of the page shares: numbers as text, a model's look, scales and charts, balls,
 * tables, arrows. `svg` is lit's in a browser and makes text when the page is built (text.js). A
 * model is told apart three ways: colour and dash (CSS class m-NAME), and marker (here). */
import { svg } from "./lit.js";

export { svg };
export const within = (low, value, high) => Math.min(high, Math.max(low, value));
const FAR = 1e6; // px
const px = (value) => Math.round(value * 100) / 100;

// ---- numbers

const RAISED = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹";
export const tenTo = (exponent) =>
  `10${String(exponent).replace(/./g, (c) => RAISED["-0123456789".indexOf(c)])}`;

// A number as a reader wants it: three digits, powers of ten only where they help.
export function number(value, digits = 3) {
  if (Number.isNaN(value)) return "not a number";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const size = Math.abs(value);
  if (size < 5e-13) return "0"; // contact.py prints twelve decimals; less is rounding
  if (size < 1e-3 || size >= 1e6) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    return `${mantissa} × ${tenTo(Number(exponent))}`.replace("-", "−");
  }
  const long = size >= 10 ** (digits - 1);
  return (value < 0 ? "−" : "") + (long ? Math.round(size).toLocaleString("en") : size.toPrecision(digits));
}

// A plain decimal: the shortest that reads back as the same number.
export const plain = (value) => String(Number(value.toPrecision(12))).replace("-", "−");

// ---- shapes

// Text in which v_n stands as a formula.
const worded = (text) => text.split("v_n").map((part, k) => (k ? svg`<tspan class="formula">v<tspan
    class="sub" dy="4">n</tspan></tspan><tspan dy="-4">${part}</tspan>` : part));
export const label = (text, x, y, anchor = "start", kind = "strong") =>
  svg`<text x=${px(x)} y=${px(y)} text-anchor=${anchor} class=${kind}>${worded(text)}</text>`;
export const line = (x1, y1, x2, y2, kind = "rule dashed") =>
  svg`<line x1=${px(x1)} y1=${px(y1)} x2=${px(x2)} y2=${px(y2)} class=${kind}/>`;
export const circle = (x, y, r, kind) =>
  svg`<circle cx=${px(x)} cy=${px(y)} r=${px(r)} class=${kind}/>`;
export const rect = (x, y, width, height, kind) =>
  svg`<rect x=${px(x)} y=${px(y)} width=${px(Math.max(0, width))} height=${px(Math.max(0, height))}
    class=${kind}/>`;
const way = (points) => points.map((point) => point.map(px).join(" ")).join("L");
export const path = (points, kind) =>
  svg`<path d=${points.length ? `M${way(points)}` : ""} class=${kind}/>`;
export const area = (points, kind) => svg`<path d="M${way(points)}Z" class=${kind}/>`;

// What lies within a rectangle.
export const clipped = (x, y, width, height, ...inside) =>
  svg`<svg x=${px(x)} y=${px(y)} width=${px(width)} height=${px(height)}
    viewBox="${px(x)} ${px(y)} ${px(width)} ${px(height)}">${inside}</svg>`;

// The marker of a model around (x, y): triangle, disc, cross, square, star.
function markerPath(model, x, y, r) {
  const ring = (count, size, first = 0) =>
    Array.from({ length: count }, (_, k) => {
      const angle = 2 * Math.PI * (first + k / count);
      const far = r * (Array.isArray(size) ? size[k % 2] : size);
      return [x + far * Math.sin(angle), y - far * Math.cos(angle)];
    });
  const cross = [1, 3, 3, 1, 1, -1, -1, -3, -3, -1, -1, 1].map((a) => 0.43 * r * a);
  const corners = {
    penalty: () => ring(3, 1.35, 1 / 6), soft: () => ring(4, 1.3, 1 / 8),
    exact: () => ring(10, [1.5, 0.62]), lcp: () => ring(24, 1),
    leapfrog: () => cross.map((a, k) => [x + a, y + cross[(k + 9) % 12]]),
  };
  return `M${way((corners[model] ?? corners.lcp)())}Z`;
}

export const mark = (model, x, y, r = 4.5) =>
  svg`<path d=${markerPath(model, x, y, r)} class="mark m-${model}"/>`;

export const ball = (model, x, y, r, kind = "ball") => [
  circle(x, y, r, `${kind} m-${model}`),
  kind === "ball" && r >= 7 && model !== "fixed"
    ? svg`<path d=${markerPath(model, x, y, Math.min(8, 0.4 * r))} class="ball-mark"/>`
    : "",
];

// The table: its top is the line, what lies below is hatched.
export const table = (x, y, width, height) => [
  rect(x, y, width, height, "ground"), rect(x, y, width, height, "hatch"),
  line(x, y, x + width, y, "table-top"),
];

// An arrow from (x, y) by (dx, dy), none where it would be a dot.
export function arrow(kind, x, y, dx, dy) {
  const size = Math.hypot(dx, dy);
  if (!(size > 4)) return "";
  const [head, turn] = [Math.min(9, size), (Math.atan2(dy, dx) * 180) / Math.PI];
  return svg`<path class="arrow ${kind}"
    transform="translate(${px(x)} ${px(y)}) rotate(${px(turn)})"
    d="M0 0H${px(size - head)}m${head} 0l${-head} ${px(0.45 * head)}v${px(-0.9 * head)}z"/>`;
}

// What is seen through a lens of `size` px around (x, y).
export const through = (x, y, size, ...inside) =>
  svg`<g style="clip-path: circle(${px(size)}px at ${px(x)}px ${px(y)}px) view-box">
    ${circle(x, y, size, "lens-ground")}
    ${clipped(x - size, y - size, 2 * size, 2 * size, inside)}</g>
    ${circle(x, y, size, "lens-rim")}`; // clipped, or a large circle makes Firefox's page wider

// ---- charts

// From the domain of an axis to px; `back` leads from px to the domain.
function scaleOf({ domain, log }, from, to) {
  const [first, last] = log ? domain.map(Math.log10) : domain;
  const straight = (v) => (log ? (v > 0 ? Math.max(first, Math.log10(v)) : first) : v);
  const scale = (v) => from + ((straight(v) - first) / (last - first)) * (to - from);
  scale.back = (at) => {
    const value = first + within(0, (at - from) / (to - from), 1) * (last - first);
    return log ? 10 ** value : value;
  };
  return scale;
}

// An axis over a domain, with ticks at these values; [value, text] stays as it is.
export const axis = (domain, name, ...at) => ({
  domain, label: name, ticks: at.map((each) => (Array.isArray(each) ? each : [each, plain(each)])),
});

// An axis of powers of ten, from 10^low to 10^high, with a tick at each of so many.
export function tens(low, high, name, every = 1) {
  const powers = Array.from({ length: (high - low) / every + 1 }, (_, k) => low + k * every);
  const ticks = powers.map((p) => [10 ** p, tenTo(p)]);
  return { ...axis([10 ** low, 10 ** high], name, ...ticks), log: true };
}

// An axis of time steps.
export const timeSteps = (low, high) => ({
  ...axis([low, high], "time step dt (ms)",
    ...[0.5, 1, 2, 4, 8, 16, 32, 64].map((ms) => [ms / 1000, plain(ms)])
      .filter(([dt]) => dt >= low && dt <= high)),
  log: true,
});

// About `most` round numbers between low and high.
export function steps(low, high, most = 5) {
  const rough = (high - low) / most;
  const size = 10 ** Math.floor(Math.log10(rough));
  const every = [1, 2, 5, 10].map((k) => k * size).find((step) => step >= rough * 0.999);
  const [first, last] = [Math.ceil(low / every - 1e-9), Math.floor(high / every + 1e-9)];
  return Array.from({ length: last - first + 1 }, (_, k) => (first + k) * every);
}

/* A chart in a view's picture, from `left` and `top` on: {picture, sx, sy, box, knob}, where
 * knob(value, name, step) is a knob on the axis that sets a value of the state. x and y: axes;
 * lines: {model, points, kind, marks}, each up to where a value is no number; zero: whether a line
 * shows where y is 0. */
export function plot(view, { left = 0, top = 0, x, y, lines = [], zero, ...more }) {
  const wide = Math.max(0, ...y.ticks.map(([, text]) => text.length));
  const bottom = more.height ?? view.height;
  const box = {
    left: left + Math.max(26, 12 + 8.4 * wide), right: view.width - 12,
    top: top + (y.label ? 28 : 8), bottom: bottom - 46,
  };
  const [sx, sy] = [scaleOf(x, box.left, box.right), scaleOf(y, box.bottom, box.top)];
  const across = y.ticks.map(([value, text]) => [
    line(box.left, sy(value), box.right, sy(value), "grid"),
    label(text, box.left - 7, sy(value) + 5, "end", "tick"),
  ]);
  let free = -Infinity; // from here on there is room for a tick's text
  const along = x.ticks.map(([value, text]) => {
    const [at, half] = [sx(value), 4.4 * text.length];
    const room = at - half >= free;
    if (room) free = at + half + 8;
    const tick = line(at, box.bottom, at, box.bottom + 5, "axis");
    return [tick, room ? label(text, at, box.bottom + 21, "middle", "tick") : ""];
  });
  const drawn = lines.map(({ model, points, kind = "", marks = [] }) => {
    const end = points.findIndex(([, value]) => !Number.isFinite(value));
    const places = points.slice(0, end < 0 ? points.length : end).map(([at, value]) =>
      [sx(at), within(-FAR, sy(value), FAR)]); // what is outside is cut, and no slope changes
    return [path(places, `line m-${model} ${kind}`),
      marks.map((k) => places[k] ?? [0, -Infinity])
        .filter(([, at]) => at >= box.top && at <= box.bottom)
        .map((place) => mark(model, ...place))];
  });
  const picture = [
    across, along, line(box.left, box.bottom, box.right, box.bottom, "axis"),
    zero ? line(box.left, sy(0), box.right, sy(0), "rule") : "",
    label(y.label, left, top + 14, "start", "axis-name"),
    label(x.label, box.right, bottom - 4, "end", "axis-name"),
    clipped(box.left, box.top - 3, box.right - box.left, box.bottom - box.top + 6, drawn),
  ];
  const knob = (value, name, step) => view.point(sx(view.own[value]), box.bottom,
    { label: name, value, low: x.domain[0], high: x.domain[1], step, at: sx.back });
  return { sx, sy, box, picture, knob };
}
