/* What every picture of the page shares: numbers as text, the look of a model, a small plotter, and
 * balls, tables and arrows. All of it makes SVG as text and touches no document, so the same code
 * draws in a reader's browser and, when the page is built, the still pictures that need no script.
 * A model is told apart three ways: colour and dash (CSS class m-NAME), and marker (here). */

const RAISED = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹";
const NOISE = 5e-13; // contact.py prints twelve decimals; less is rounding

export const round = (a) => Math.round(a * 100) / 100;
export const within = (low, value, high) => Math.min(high, Math.max(low, value));
export const escape = (text) => String(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

// One element as text; children are text already. Numbers are rounded to a hundredth of a pixel.
export function el(tag, attributes, ...children) {
  const written = Object.entries(attributes)
    .map(([name, value]) => [name, typeof value === "number" ? round(value) : escape(value)])
    .map(([name, value]) => ` ${name}="${value}"`);
  return `<${tag}${written.join("")}>${children.join("")}</${tag}>`;
}

// v_n and m g as formulas have them, in escaped text; `low` and `up` lead to the n and back.
const typeset = (text, italic, low, up) =>
  escape(text)
    .replace(/\bv_n\b/g, `${italic("v")}${low}n${up}`)
    .replace(/\bm g\b/g, italic("mg"));
const slanted = (text) => `<tspan font-style="italic">${text}</tspan>`;
export const inSentence = (text) =>
  typeset(text.replace(/ × /g, "\u00a0×\u00a0"), (a) => `<i>${a}</i>`, "<sub>", "</sub>");

export const label = (text, x, y, anchor = "start", kind = "tick strong") => {
  const low = '<tspan dy="4" font-size="75%">';
  const set = typeset(text, slanted, low, '</tspan><tspan dy="-4">\u200b</tspan>');
  return el("text", { x, y, class: kind, "text-anchor": anchor }, set);
};
export const line = (x1, y1, x2, y2, kind = "rule dashed") =>
  el("line", { x1, y1, x2, y2, class: kind });
export const circle = (cx, cy, r, kind) => el("circle", { cx, cy, r, class: kind });
export const rect = (x, y, width, height, kind) =>
  el("rect", { x, y, width: Math.max(0, width), height, class: kind });
export const shift = (x, y, ...children) =>
  el("g", { transform: `translate(${round(x)} ${round(y)})` }, ...children);
export const path = (points, kind) =>
  el("path", { d: `M${points.map((point) => point.map(round).join(" ")).join("L")}`, class: kind });

// What lies within a rectangle.
export function clipped(x, y, width, height, ...children) {
  const viewBox = [x, y, width, height].map(round).join(" ");
  return el("svg", { x, y, width, height, viewBox }, ...children);
}

// ---- numbers

export const whole = (count) => String(count).replace(/\B(?=(\d{3})+$)/g, ",");
export const plural = (count, word) => `${whole(count)} ${word}${count === 1 ? "" : "s"}`;

// A power of ten.
export const tenTo = (exponent) =>
  `10${String(exponent).replace(/./g, (c) => RAISED["-0123456789".indexOf(c)])}`;

// A number as a reader wants it: three digits, powers of ten only where they help.
export function number(value, digits = 3) {
  if (Number.isNaN(value)) return "not a number";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const size = Math.abs(value);
  if (size < NOISE) return "0";
  if (size < 1e-3 || size >= 1e6) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    return `${mantissa} × ${tenTo(Number(exponent))}`.replace("-", "−");
  }
  const long = size >= 10 ** (digits - 1);
  return (value < 0 ? "−" : "") + (long ? whole(Math.round(size)) : size.toPrecision(digits));
}

// A plain decimal for inputs and commands: the shortest that reads back as the same number.
export const plain = (value) => String(Number(value.toPrecision(12)));

// ---- models

// The marker of a model around (x, y): triangle, disc, cross, square, star.
function markerPath(model, x, y, r) {
  const ring = (count, size, first = 0) =>
    Array.from({ length: count }, (_, k) => {
      const angle = 2 * Math.PI * (first + k / count);
      const far = typeof size === "number" ? size : size[k % 2];
      return `${round(x + far * r * Math.sin(angle))} ${round(y - far * r * Math.cos(angle))}`;
    });
  const half = (way) => `a${r} ${r} 0 1 0 ${2 * way * r} 0`;
  if (model === "lcp") return `M${round(x - r)} ${round(y)}${half(1)}${half(-1)}Z`;
  if (model === "leapfrog") {
    const [a, b] = [0.45 * r, 0.85 * r]; // half of an arm's width, its length
    const sides = `h${2 * a}v${b}h${b}v${2 * a}h${-b}v${b}h${-2 * a}v${-b}h${-b}v${-2 * a}h${b}`;
    return `M${round(x - a)} ${round(y - a - b)}${sides}Z`;
  }
  const corners = { penalty: [3, 1.35, 1 / 6], soft: [4, 1.3, 1 / 8], exact: [10, [1.5, 0.62]] };
  return `M${ring(...corners[model]).join("L")}Z`;
}

export const mark = (model, x, y, r = 4.5) =>
  el("path", { d: markerPath(model, x, y, r), class: `mark m-${model}` });

// ---- scales

// From the domain of an axis to px; `back` leads from px to the domain.
function scaleOf({ domain, log }, from, to) {
  const [first, last] = log ? domain.map(Math.log10) : domain;
  const straight = (v) => (log ? (v > 0 ? Math.max(first, Math.log10(v)) : first) : v);
  const scale = (v) => from + ((straight(v) - first) / (last - first)) * (to - from);
  scale.back = (px) => {
    const at = first + within(0, (px - from) / (to - from), 1) * (last - first);
    return log ? 10 ** at : at;
  };
  return scale;
}

// An axis over a domain, with ticks at these values; [value, text] stays as it is.
export const axis = (domain, name, ...at) => ({
  domain,
  label: name,
  ticks: at.map((each) => (Array.isArray(each) ? each : [each, plain(each).replace("-", "−")])),
});

// About `most` round numbers between low and high for a plain axis.
export function steps(low, high, most = 5) {
  const rough = (high - low) / most;
  const size = 10 ** Math.floor(Math.log10(rough));
  const every = [1, 2, 5, 10].map((k) => k * size).find((step) => step >= rough * 0.999);
  const ticks = [];
  for (let k = Math.ceil(low / every - 1e-9); k * every <= high + 1e-9 * every; k++)
    ticks.push(k * every);
  return ticks;
}

// ---- the plotter

/* A line through many points: of those in half a pixel the first, the least, the greatest and the
 * last, so that spikes survive. Values that are not finite end the line. */
function linePath({ xs, ys, from = 0, to = xs.length }, { sx, sy, box }) {
  const columns = new Map();
  for (let i = from; i < to && Number.isFinite(ys[i]); i++) {
    const x = Math.round(2 * sx(xs[i])) / 2;
    if (!columns.has(x)) columns.set(x, []);
    columns.get(x).push(round(within(box.top - 40, sy(ys[i]), box.bottom + 40)));
  }
  const drawn = [...columns].map(([x, all]) => {
    const few = [all[0], Math.min(...all), Math.max(...all), all[all.length - 1]];
    return `${x} ${few[1] < few[2] ? few.join("V") : few[0]}`;
  });
  return drawn.length ? `M${drawn.join("L")}` : "";
}

function frame({ x, y }, { sx, sy, box }) {
  const { left, right, top, bottom, low } = box;
  const across = y.ticks.map(([value, text]) => {
    const at = sy(value);
    return line(left, at, right, at, "grid") + label(text, left - 6, at + 5, "end", "tick");
  });
  let free = -Infinity; // from here on there is room for a tick's text
  const along = x.ticks.map(([value, text]) => {
    const [at, half] = [sx(value), 4.2 * text.length];
    const place = Math.min(at, right + 4 - half);
    const drawn = line(at, bottom, at, bottom + 5, "axis");
    if (place - half < free) return drawn;
    free = place + half + 6;
    return drawn + label(text, place, bottom + 20, "middle", "tick");
  });
  if (y.label) across.push(label(y.label, box.edge, top - 12, "start", "axis-name"));
  if (x.label) along.push(label(x.label, right, low - 4, "end", "axis-name"));
  return [...across, ...along, line(left, bottom, right, bottom, "axis")].join("");
}

// A straight line across the plot at one x or one y, and its words beside it.
function ruleOf({ x, y, text = "", kind = "", side = "start", row = 0 }, { sx, sy, box }) {
  const at = x === undefined ? sy(y) : sx(x);
  const shown = `rule ${kind}`;
  if (x === undefined)
    return [line(box.left, at, box.right, at, shown), label(text, box.right - 4, at - 5, "end")];
  const place = at + (side === "end" ? -5 : 5);
  return [
    line(at, box.top, at, box.bottom, shown),
    label(text, place, box.top + 12 + row * 18, side),
  ];
}

/* A plot within the rectangle [left, top, width, height] of the drawing: {svg, sx, sy, box}.
 * x and y: {domain: [low, high], log, ticks: [[value, text]...], label};
 * lines: {model, xs, ys, markers, from, to, kind}; rules: {x or y, text, kind, side, row};
 * points: {model, x, y, size}; margin: px left of it; under(chart): what is drawn beneath. */
export function plot([edge, above, width, height], options) {
  const { x, y, lines = [], rules = [], points = [], under = () => "" } = options;
  const wide = Math.max(0, ...y.ticks.map(([, text]) => text.length));
  const box = {
    edge,
    low: above + height,
    left: edge + (options.margin || Math.max(30, 10 + 8 * wide)),
    right: edge + width - 10,
    top: above + (y.label ? 26 : 8),
    bottom: above + height - (x.ticks.length ? (x.label ? 42 : 24) : 6),
  };
  const sx = scaleOf(x, box.left, box.right);
  const chart = { box, sx, sy: scaleOf(y, box.bottom, box.top) };
  const { sy } = chart;
  const ruled = rules.map((rule) => ruleOf(rule, chart));
  const marked = ({ model, xs, ys, markers = [] }) =>
    markers.map((at) => (Number.isFinite(ys[at]) ? mark(model, sx(xs[at]), sy(ys[at])) : ""));
  const inside = [
    ...ruled.map(([drawn]) => drawn),
    ...lines.map((each) =>
      el("path", { d: linePath(each, chart), class: `line m-${each.model} ${each.kind || ""}` }),
    ),
    ...lines.flatMap(marked),
    ...points.map((each) => mark(each.model, sx(each.x), sy(each.y), each.size)),
  ];
  const [across, down] = [box.right - box.left, box.bottom - box.top];
  const svg = [
    under(chart),
    frame(options, chart),
    clipped(box.left, box.top - 3, across, down + 6, ...inside),
    ...ruled.map(([, text]) => text),
  ].join("");
  return { ...chart, svg };
}

// ---- balls, tables, arrows

export function ball(model, x, y, r, kind = "ball") {
  const disc = circle(x, y, r, `${kind} m-${model}`);
  if (kind !== "ball" || r < 7) return disc;
  const d = markerPath(model, x, y, Math.min(8, r * 0.4));
  return disc + el("path", { d, class: "ball-mark" });
}

// The table: its top is the line, what lies below is hatched, by a pattern of the page.
export const table = (x, y, width, height) =>
  rect(x, y, width, height, "ground") + rect(x, y, width, height, "hatch") +
  line(x, y, x + width, y, "table-top");

// An arrow from (x, y) by (dx, dy).
export function arrow(kind, x, y, dx, dy) {
  const size = Math.hypot(dx, dy);
  if (!(size > 0.5)) return "";
  const head = Math.min(9, size);
  const along = (far, aside) =>
    `${round(x + (far * dx - aside * dy) / size)} ${round(y + (far * dy + aside * dx) / size)}`;
  const back = size - head;
  const point = [along(size, 0), along(back, 0.45 * head), along(back, -0.45 * head)];
  const d = `M${along(0, 0)}L${along(back, 0)}M${point.join("L")}Z`;
  return el("path", { d, class: `arrow ${kind}` });
}
