/* What the pictures share: numbers as text, shapes, balls, arrows, charts. The CSS class m-NAME gives
 * a model its colour and its dash. */
import { svg } from "./lit.js";

export { svg };
export const within = (low, value, high) => Math.min(high, Math.max(low, value));
export const range = (count, each) => Array.from({ length: count }, (_, k) => each(k));
const FAR = 1e6; // px: nothing is drawn farther out
const px = (value) => Math.round(within(-FAR, value, FAR) * 10) / 10;

export const tenTo = (exponent) =>
  `10${String(exponent).replace(/./g, (c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)])}`;

// A number to three digits, with a power of ten only where it helps.
export function number(value, digits = 3) {
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
export const ms = (seconds) => `${plain(Number((1000 * seconds).toPrecision(3)))} ms`;

// Text; a tick is read with its axis, and not by a screen reader, to which the words tell more.
export const label = (text, x, y, anchor = "start", kind = "strong") =>
  svg`<text x=${px(x)} y=${px(y)} text-anchor=${anchor} class=${kind}
    aria-hidden=${String(kind === "tick")}>${text}</text>`;
export const line = (x1, y1, x2, y2, kind = "rule dashed") =>
  svg`<line x1=${px(x1)} y1=${px(y1)} x2=${px(x2)} y2=${px(y2)} class=${kind}/>`;
export const circle = (x, y, r, kind) =>
  svg`<circle cx=${px(x)} cy=${px(y)} r=${px(r)} class=${kind}/>`;
export const rect = (x, y, width, height, kind) =>
  svg`<rect x=${px(x)} y=${px(y)} width=${px(Math.max(0, width))} height=${px(Math.max(0, height))}
    class=${kind}/>`;
const way = (points) => (points.length ? `M${points.map((p) => p.map(px).join(" ")).join("L")}` : "");
export const path = (points, kind) => svg`<path d=${way(points)} class=${kind}/>`;
export const ball = (model, x, y, r, kind = "ball") => circle(x, y, r, `${kind} m-${model}`);
export const mark = (model, x, y, r = 6) => circle(x, y, r, `mark m-${model}`);

// What lies within a rectangle.
export const clipped = (x, y, width, height, ...inside) =>
  svg`<svg x=${px(x)} y=${px(y)} width=${px(Math.max(0, width))} height=${px(height)}
    viewBox="${px(x)} ${px(y)} ${px(Math.max(0, width))} ${px(height)}">${inside}</svg>`;

// The table: its top is the line, what lies below is hatched.
export const table = (x, y, width, height) => [
  rect(x, y, width, height, "ground"), rect(x, y, width, height, "hatch"),
  line(x, y, x + width, y, "table-top"),
];

/* The left part of a figure: the table, from `under` px above its end on, and over it a ball in the
 * middle of x, of which at(gap) is the height, its gap [r] drawn `larger` times; drawn(...inside). */
export function lane({ width, height }, { share = 0.32, under = 74, larger = 1 }) {
  const [left, floor] = [Math.round(share * width), Math.round(height - under)];
  const r = Math.min(70, 0.28 * left);
  const said = larger > 1 ? label(`gaps × ${larger}`, 4, 16, "start", "tick") : "";
  const drawn = (...inside) =>
    clipped(0, 0, left, height, table(0, floor, left, under), said, inside);
  return { left: left + 10, x: 0.45 * left, r, floor, larger, drawn, at: (gap) => floor - (gap * larger + 1) * r };
}

// An arrow from (x, y) by (dx, dy), none where it would be a dot.
export function arrow(kind, x, y, dx, dy) {
  const size = Math.hypot(dx, dy);
  if (!(size > 4)) return "";
  const [head, turn] = [Math.min(9, size), (Math.atan2(dy, dx) * 180) / Math.PI];
  return svg`<path class="arrow ${kind}"
    transform="translate(${px(x)} ${px(y)}) rotate(${px(turn)})"
    d="M0 0H${px(size - head)}m${head} 0l${-head} ${px(0.45 * head)}v${px(-0.9 * head)}z"/>`;
}

// From the domain of an axis to px; `back` leads from px to the domain.
export function scaleOf({ domain, log }, from, to) {
  const [first, last] = log ? domain.map(Math.log10) : domain;
  const straight = (v) => (log ? (v > 0 ? Math.max(first, Math.log10(v)) : first) : v);
  const scale = (v) => from + ((straight(v) - first) / (last - first)) * (to - from);
  scale.back = (at) => {
    const value = first + within(0, (at - from) / (to - from), 1) * (last - first);
    return log ? 10 ** value : value;
  };
  return scale;
}

// About `most` round numbers between low and high.
function steps(low, high, most = 5) {
  const size = 10 ** Math.floor(Math.log10((high - low) / most));
  const every = [1, 2, 5, 10].map((k) => k * size).find((each) => each >= 0.999 * (high - low) / most);
  const first = Math.ceil(low / every - 1e-9);
  return range(Math.floor(high / every + 1e-9) - first + 1, (k) => (first + k) * every);
}

// An axis with ticks at these values, or [value, text], or at round ones.
export const axis = (domain, name, ...at) => ({
  domain, label: name,
  ticks: (at.length ? at : steps(...domain)).map((each) => (Array.isArray(each) ? each : [each, plain(each)])),
});

export const logAxis = (...given) => ({ ...axis(...given), log: true });

/* A chart from `left` and `top` on, {picture, sx, sy, box, knob}: knob(value, name, step) stands on
 * the x axis and sets a value of the state. lines: {model, points, kind}, each up to where a value is
 * no number; with `layers`, drawn as each [kind, up to which x]. zero: a line where y is 0. */
export function plot(view, { left = 0, top = 0, x, y, lines = [], zero }) {
  const wide = Math.max(0, ...y.ticks.map(([, text]) => text.length));
  const box = {
    left: left + Math.max(26, 12 + 8.4 * wide), right: view.width - 12,
    top: top + (y.label ? 28 : 8), bottom: view.height - (x.label ? 46 : 28),
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
    return [line(at, box.bottom, at, box.bottom + 5, "axis"),
      room ? label(text, at, box.bottom + 21, "middle", "tick") : ""];
  });
  const inside = (right, drawn) =>
    clipped(box.left, box.top - 3, right - box.left, box.bottom - box.top + 6, drawn);
  const drawn = lines.map(({ model, points, kind = "", layers = [[kind, x.domain[1]]] }) => {
    const end = points.findIndex(([, value]) => !Number.isFinite(value));
    const places = points.slice(0, end < 0 ? points.length : end).map(([at, v]) => [sx(at), sy(v)]);
    return layers.filter(([, until]) => until > x.domain[0]).map(([each, until]) =>
      inside(sx(until), path(places, `line m-${model} ${each}`)));
  });
  const picture = [
    across, along, line(box.left, box.bottom, box.right, box.bottom, "axis"),
    zero ? line(box.left, sy(0), box.right, sy(0), "rule") : "",
    label(y.label, left, top + 14, "start", "axis-name"),
    label(x.label, box.right, view.height - 4, "end", "axis-name"), drawn,
  ];
  const knob = (value, name, step) => view.point(sx(view.own[value]), box.bottom,
    { label: name, value, low: x.domain[0], high: x.domain[1], step, at: sx.back });
  return { sx, sy, box, picture, knob };
}
