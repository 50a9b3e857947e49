/* What every picture of the page shares: numbers as text, the look of a model, a small plotter, and
 * balls, tables and arrows. All of it makes SVG as text and touches no document, so the same code
 * draws in a reader's browser and, when the page is built, the still pictures that need no script.
 * A model is told apart three ways: colour (CSS class m-NAME), dash (same class), and marker (here). */

const ZERO_DECADES = 1; // room that a zero gets below the smallest decade of a log axis
const NOISE = 5e-13; // contact.py prints twelve decimals; less is rounding

export const round = (a) => Math.round(a * 100) / 100;
export const escape = (text) =>
  String(text).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);

// One element as text; children are text already. Numbers are rounded to a hundredth of a pixel.
export function el(tag, attributes, ...children) {
  const written = Object.entries(attributes || {})
    .filter(([, value]) => value !== null && value !== undefined)
    .map(([name, value]) => ` ${name}="${typeof value === "number" ? round(value) : escape(value)}"`);
  return `<${tag}${written.join("")}>${children.join("")}</${tag}>`;
}

export const words = (content, attributes) => el("text", attributes, escape(content));

// ---- numbers

const grouped = (whole) => String(whole).replace(/\B(?=(\d{3})+$)/g, ",");

// A number as a reader wants it: three digits, powers of ten only where they help.
export function number(value, digits = 3) {
  if (value === null || value === undefined || Number.isNaN(value)) return "not a number";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const size = Math.abs(value);
  if (size < NOISE) return "0";
  if (size < 1e-3 || size >= 1e6) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    return `${mantissa}e${Number(exponent)}`.replace(/-/g, "−");
  }
  const whole = size >= 10 ** (digits - 1);
  const text = whole ? grouped(Math.round(size)) : size.toPrecision(digits);
  return (value < 0 ? "−" : "") + text;
}

// A plain decimal for inputs and commands: the shortest that reads back as the same number.
export const plain = (value) => String(Number(value.toPrecision(12)));

// ---- models

// The marker of a model around (x, y): triangle, disc, square, star.
export function markerPath(model, x, y, r) {
  const corner = (turn, size) => {
    const angle = 2 * Math.PI * turn;
    return `${round(x + size * Math.sin(angle))} ${round(y - size * Math.cos(angle))}`;
  };
  if (model === "lcp")
    return `M${round(x - r)} ${round(y)}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0Z`;
  const turns = {
    penalty: [1 / 6, 1 / 2, 5 / 6].map((turn) => corner(turn, 1.35 * r)),
    soft: [0.125, 0.375, 0.625, 0.875].map((turn) => corner(turn, 1.3 * r)),
    exact: Array.from({ length: 10 }, (_, k) => corner(k / 10, k % 2 ? 0.62 * r : 1.5 * r)),
  };
  return `M${turns[model].join("L")}Z`;
}

export const mark = (model, x, y, r = 4.5, kind = "") =>
  el("path", { d: markerPath(model, x, y, r), class: `mark m-${model} ${kind}` });

// The key of a model: a bit of its line with its marker on it.
export function key(model) {
  const look = {
    class: `key m-${model}`,
    width: 34,
    height: 14,
    viewBox: "0 0 34 14",
    "aria-hidden": "true",
  };
  return el("svg", look, el("path", { d: "M0 7H34", class: `line m-${model}` }), mark(model, 17, 7, 5));
}

// ---- scales

export function scaleOf(axis, from, to) {
  const [low, high] = axis.domain;
  if (axis.root) return (v) => from + (Math.sqrt(Math.max(v, 0)) / Math.sqrt(high)) * (to - from);
  if (!axis.log) return (v) => from + ((v - low) / (high - low)) * (to - from);
  const base = Math.log10(low) - (axis.zero ? ZERO_DECADES : 0);
  const span = Math.log10(high) - base;
  return (v) => from + ((v > 0 ? Math.max(Math.log10(v) - base, 0) : 0) / span) * (to - from);
}

// Decades from low to high as ticks of a log axis, at most `most` of them.
export function decades(low, high, most = 5) {
  const from = Math.ceil(Math.log10(low) - 1e-9);
  const to = Math.floor(Math.log10(high) + 1e-9);
  const every = Math.max(1, Math.ceil((to - from + 1) / most));
  const ticks = [];
  for (let p = from; p <= to; p += every)
    ticks.push([10 ** p, p >= -3 && p <= 3 ? plain(10 ** p) : `1e${p}`.replace("-", "−")]);
  return ticks;
}

// About `most` round numbers between low and high as ticks of a plain axis.
export function steps(low, high, most = 5) {
  const rough = (high - low) / most;
  const size = 10 ** Math.floor(Math.log10(rough));
  const every = [1, 2, 5, 10].map((k) => k * size).find((step) => step >= rough * 0.999);
  const ticks = [];
  for (let k = Math.ceil(low / every - 1e-9); k * every <= high + 1e-9 * every; k++)
    ticks.push([k * every, plain(k * every).replace("-", "−")]);
  return ticks;
}

// A line through many points: at most one column's first, least, greatest and last value a pixel,
// so that spikes survive. Values that are not finite end the line.
export function linePath(xs, ys, sx, sy, [top, bottom], from = 0, to = xs.length) {
  const clamp = (v) => Math.min(Math.max(v, top - 40), bottom + 40);
  let path = "";
  let column = null;
  let [low, high, last] = [0, 0, 0];
  const flush = () => {
    if (column !== null && low !== high) path += `L${column} ${round(low)}V${round(high)}V${round(last)}`;
  };
  for (let i = from; i < to; i++) {
    if (!Number.isFinite(ys[i])) break;
    const px = Math.round(sx(xs[i]) * 2) / 2;
    const py = clamp(sy(ys[i]));
    if (px !== column) {
      flush();
      path += `${path ? "L" : "M"}${px} ${round(py)}`;
      column = px;
      low = high = py;
    }
    low = Math.min(low, py);
    high = Math.max(high, py);
    last = py;
  }
  flush();
  return path;
}

// ---- the plotter

function frame(options, box, sx, sy) {
  const { height, x, y } = options;
  const parts = [];
  if (y.label) parts.push(words(y.label, { x: 0, y: 14, class: "axis-name" }));
  for (const [value, label] of y.ticks) {
    const at = sy(value);
    parts.push(el("line", { x1: box.left, x2: box.right, y1: at, y2: at, class: "grid" }));
    parts.push(words(label, { x: box.left - 6, y: at + 5, class: "tick", "text-anchor": "end" }));
  }
  for (const [value, label] of x.ticks) {
    const at = sx(value);
    const anchor = at > box.right - 14 ? "end" : "middle";
    const left = anchor === "end" ? box.right : at;
    parts.push(el("line", { x1: at, x2: at, y1: box.bottom, y2: box.bottom + 5, class: "axis" }));
    parts.push(words(label, { x: left, y: box.bottom + 20, class: "tick", "text-anchor": anchor }));
  }
  if (x.label)
    parts.push(words(x.label, { x: box.right, y: height - 4, class: "axis-name", "text-anchor": "end" }));
  parts.push(el("line", { x1: box.left, x2: box.right, y1: box.bottom, y2: box.bottom, class: "axis" }));
  return parts.join("");
}

// A straight line across the plot at one x or one y, with its words beside it.
function ruleOf(rule, box, sx, sy) {
  const upright = rule.x !== undefined;
  const at = upright ? sx(rule.x) : sy(rule.y);
  const line = upright
    ? { x1: at, x2: at, y1: box.top, y2: box.bottom }
    : { x1: box.left, x2: box.right, y1: at, y2: at };
  const drawn = el("line", { ...line, class: `rule ${rule.class || ""}` });
  if (!rule.text) return [drawn, ""];
  const left = rule.side ? rule.side === "end" : !upright || at > (box.left + box.right) / 2;
  const place = upright
    ? { x: at + (left ? -5 : 5), y: box.top + 12 + (rule.row || 0) * 18 }
    : { x: box.right - 4, y: at - 5 };
  return [
    drawn,
    words(rule.text, { ...place, class: "tick strong", "text-anchor": left ? "end" : "start" }),
  ];
}

/* A plot. options: {width, height, x, y, lines, rules, points, left, top, id}.
 * x and y: {domain: [low, high], log, zero, root, ticks: [[value, text]...], label}.
 * lines: {model, xs, ys, markers, from, to}; rules: {x or y, text, class, side, row};
 * points: {model, x, y, size, class}. Returns {markup, sx, sy, box}. */
export function plot(options) {
  const { width, height, x, y } = options;
  const wide = Math.max(0, ...y.ticks.map(([, text]) => text.length));
  const box = {
    left: options.left || Math.max(30, 10 + 8 * wide),
    right: width - 10,
    top: options.top || (y.label ? 26 : 8),
    bottom: height - (x.ticks.length ? (x.label ? 42 : 24) : 6),
  };
  const sx = scaleOf(x, box.left, box.right);
  const sy = scaleOf(y, box.bottom, box.top);
  const clip = `clip-${options.id}`;
  const area = {
    x: box.left,
    y: box.top - 3,
    width: box.right - box.left,
    height: box.bottom - box.top + 6,
  };
  const rules = (options.rules || []).map((rule) => ruleOf(rule, box, sx, sy));
  const lines = options.lines || [];
  const inside = [
    ...rules.map(([drawn]) => drawn),
    ...lines.map((line) =>
      el("path", {
        d: linePath(line.xs, line.ys, sx, sy, [box.top, box.bottom], line.from, line.to),
        class: `line m-${line.model} ${line.class || ""}`,
      }),
    ),
    ...lines.flatMap((line) =>
      (line.markers || [])
        .filter((at) => Number.isFinite(line.ys[at]))
        .map((at) => mark(line.model, sx(line.xs[at]), sy(line.ys[at]))),
    ),
    ...(options.points || []).map((p) => mark(p.model, sx(p.x), sy(p.y), p.size || 5, p.class)),
  ];
  const markup = [
    el("clipPath", { id: clip }, el("rect", area)),
    frame(options, box, sx, sy),
    el("g", { "clip-path": `url(#${clip})` }, ...inside),
    ...rules.map(([, text]) => text),
  ].join("");
  return { markup, sx, sy, box };
}

// ---- balls, tables, arrows

export function ball(model, x, y, r, kind = "ball") {
  const disc = el("circle", { cx: x, cy: y, r, class: `${kind} m-${model}` });
  if (kind !== "ball" || r < 7) return disc;
  return disc + el("path", { d: markerPath(model, x, y, Math.min(8, r * 0.4)), class: "ball-mark" });
}

// The table: its top is the line, what lies below is hatched.
export function table(x, y, width, height) {
  const strokes = [];
  for (let at = -height; at < width; at += 9) {
    const from = Math.max(0, -at);
    const to = Math.min(height, width - at);
    strokes.push(
      `M${round(x + at + from)} ${round(y + height - from)}L${round(x + at + to)} ${round(y + height - to)}`,
    );
  }
  return (
    el("rect", { x, y, width, height, class: "ground" }) +
    el("path", { d: strokes.join(""), class: "hatch-line" }) +
    el("line", { x1: x, x2: x + width, y1: y, y2: y, class: "table-top" })
  );
}

// An arrow from (x, y) by (dx, dy), with its words at the point.
export function arrow(kind, x, y, dx, dy, text = "", side = 1) {
  const size = Math.hypot(dx, dy);
  if (!(size > 0.5)) return "";
  const [ux, uy] = [dx / size, dy / size];
  const head = Math.min(9, size);
  const [tx, ty] = [x + dx, y + dy];
  const [bx, by] = [tx - head * ux, ty - head * uy];
  const half = 0.45 * head;
  const path =
    `M${round(x)} ${round(y)}L${round(bx)} ${round(by)}` +
    `M${round(tx)} ${round(ty)}L${round(bx - half * uy)} ${round(by + half * ux)}` +
    `L${round(bx + half * uy)} ${round(by - half * ux)}Z`;
  const label = text
    ? words(text, {
        x: tx + 7 * side,
        y: ty + (dy > 0 ? 0 : 10),
        class: "tick strong",
        "text-anchor": side > 0 ? "start" : "end",
      })
    : "";
  return el("path", { d: path, class: `arrow ${kind}` }) + label;
}
