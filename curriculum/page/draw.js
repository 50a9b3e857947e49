/* What every figure of the page shares: the look of a model, numbers as text, and one small plotter.
 * A model is told apart three ways: colour (CSS class m-NAME), dash (same class), and marker (here). */
"use strict";

const Draw = (() => {
  const SVG = "http://www.w3.org/2000/svg";
  const MODELS = ContactEngine.MODELS;
  const ZERO_DECADES = 1; // room that a zero gets below the smallest decade of a log axis

  function svg(tag, attributes, ...children) {
    const node = document.createElementNS(SVG, tag);
    for (const [name, value] of Object.entries(attributes || {})) {
      if (value !== null && value !== undefined) node.setAttribute(name, value);
    }
    node.append(...children);
    return node;
  }

  function html(tag, attributes, ...children) {
    const node = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes || {})) {
      if (value !== null && value !== undefined) node.setAttribute(name, value);
    }
    node.append(...children);
    return node;
  }

  const round = (a) => Math.round(a * 100) / 100;

  // The marker of a model as a path around (x, y), as in the benchmark's figures: triangle, disc, star.
  function markerPath(model, x, y, r) {
    const corner = (turn, size) => {
      const angle = 2 * Math.PI * turn;
      return `${round(x + size * Math.sin(angle))} ${round(y - size * Math.cos(angle))}`;
    };
    if (model === "lcp") {
      return `M${round(x - r)} ${round(y)}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0Z`;
    }
    const corners =
      model === "penalty"
        ? [1 / 6, 1 / 2, 5 / 6].map((turn) => corner(turn, 1.35 * r))
        : Array.from({ length: 10 }, (_, k) => corner(k / 10, k % 2 ? 0.62 * r : 1.5 * r));
    return `M${corners.join("L")}Z`;
  }

  const NOISE = 5e-13; // contact.py prints twelve decimals; less is rounding

  // 98100 as 98,100
  const grouped = (whole) => String(whole).replace(/\B(?=(\d{3})+$)/g, ",");

  // A number as a reader wants it: three digits, powers of ten only where they help.
  function number(value, digits = 3) {
    if (value === null || value === undefined || Number.isNaN(value)) return "not a number";
    if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
    const size = Math.abs(value);
    if (size < NOISE) return "0";
    if (size < 1e-3 || size >= 1e6) {
      const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
      return `${mantissa}e${Number(exponent)}`.replace(/-/g, "−");
    }
    const text = size >= 10 ** (digits - 1) ? grouped(Math.round(value)) : value.toPrecision(digits);
    return text.replace("-", "−");
  }

  // A plain decimal for inputs and commands: the shortest that reads back as the same number.
  const plain = (value) => String(Number(value.toPrecision(12)));

  function scaleOf(axis, from, to) {
    const [low, high] = axis.domain;
    if (!axis.log) return (v) => from + ((v - low) / (high - low)) * (to - from);
    const base = Math.log10(low) - (axis.zero ? ZERO_DECADES : 0);
    const span = Math.log10(high) - base;
    return (v) => from + ((v > 0 ? Math.max(Math.log10(v) - base, 0) : 0) / span) * (to - from);
  }

  // A line through many points: at most one column's first, least, greatest and last value a pixel,
  // so that spikes survive. Values that are not finite end the line.
  function linePath(xs, ys, sx, sy, top, bottom) {
    let path = "";
    let column = null;
    let low = 0,
      high = 0,
      last = 0,
      pen = false;
    const clamp = (v) => Math.min(Math.max(v, top - 40), bottom + 40);
    const flush = () => {
      if (column === null) return;
      if (low !== high) path += `L${column} ${round(low)}V${round(high)}V${round(last)}`;
    };
    for (let i = 0; i < xs.length; i++) {
      if (!Number.isFinite(ys[i])) break;
      const px = Math.round(sx(xs[i]) * 2) / 2;
      const py = clamp(sy(ys[i]));
      if (px !== column) {
        flush();
        path += `${pen ? "L" : "M"}${px} ${round(py)}`;
        pen = true;
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

  /* Draw a plot into `node` (an svg element). options: {width, height, x, y, lines, rules, points}.
   * x and y: {domain: [low, high], log, zero, ticks: [[value, text]...], label}.
   * lines: {model, xs, ys, markers}; rules: {x or y, text, dashed, end}; points: {model, x, y}.
   * Returns {sx, sy, box}. Text is drawn at 14 px, so the svg must not be scaled. */
  let clips = 0;
  function plot(node, options) {
    const { width, height, x, y } = options;
    const wide = Math.max(...y.ticks.map(([, text]) => text.length));
    const box = {
      left: options.left || Math.max(30, 10 + 8 * wide),
      right: width - 10,
      top: options.top || 26,
      bottom: height - (x.ticks.length ? (x.label ? 42 : 24) : 6),
    };
    const sx = scaleOf(x, box.left, box.right);
    const sy = scaleOf(y, box.bottom, box.top);
    node.setAttribute("viewBox", `0 0 ${width} ${height}`);
    node.setAttribute("width", width);
    node.setAttribute("height", height);
    node.replaceChildren();
    const clip = `plot-clip-${++clips}`;
    node.append(
      svg(
        "clipPath",
        { id: clip },
        svg("rect", {
          x: box.left,
          y: box.top - 3,
          width: box.right - box.left,
          height: box.bottom - box.top + 6,
        }),
      ),
    );
    const text = (content, attributes) => svg("text", attributes, content);
    if (y.label) node.append(text(y.label, { x: 0, y: 14, class: "axis-name" }));
    for (const [value, label] of y.ticks) {
      const at = round(sy(value));
      node.append(svg("line", { x1: box.left, x2: box.right, y1: at, y2: at, class: "grid" }));
      node.append(text(label, { x: box.left - 6, y: at + 5, class: "tick", "text-anchor": "end" }));
    }
    for (const [value, label] of x.ticks) {
      const at = round(sx(value));
      node.append(svg("line", { x1: at, x2: at, y1: box.bottom, y2: box.bottom + 5, class: "axis" }));
      const anchor = at > box.right - 14 ? "end" : "middle";
      node.append(
        text(label, {
          x: anchor === "end" ? box.right : at,
          y: box.bottom + 20,
          class: "tick",
          "text-anchor": anchor,
        }),
      );
    }
    if (x.label)
      node.append(text(x.label, { x: box.right, y: height - 4, class: "axis-name", "text-anchor": "end" }));
    node.append(svg("line", { x1: box.left, x2: box.right, y1: box.bottom, y2: box.bottom, class: "axis" }));
    const inside = svg("g", { "clip-path": `url(#${clip})` });
    node.append(inside);
    for (const rule of options.rules || []) {
      const line =
        rule.x !== undefined
          ? { x1: sx(rule.x), x2: sx(rule.x), y1: box.top, y2: box.bottom }
          : { x1: box.left, x2: box.right, y1: sy(rule.y), y2: sy(rule.y) };
      for (const key of Object.keys(line)) line[key] = round(line[key]);
      inside.append(svg("line", { ...line, class: `rule ${rule.class || ""}` }));
      if (!rule.text) continue;
      if (rule.x !== undefined) {
        const left = rule.side ? rule.side === "end" : line.x1 > (box.left + box.right) / 2;
        node.append(
          text(rule.text, {
            x: line.x1 + (left ? -5 : 5),
            y: box.top + 12 + (rule.row || 0) * 18,
            class: "tick strong",
            "text-anchor": left ? "end" : "start",
          }),
        );
      } else {
        node.append(
          text(rule.text, { x: box.right - 4, y: line.y1 - 5, class: "tick strong", "text-anchor": "end" }),
        );
      }
    }
    const lines = options.lines || [];
    for (const line of lines) {
      const d = linePath(line.xs, line.ys, sx, sy, box.top, box.bottom);
      inside.append(svg("path", { d, class: `line m-${line.model} ${line.class || ""}` }));
    }
    // all markers over all lines, so that no line hides another model's marker
    for (const line of lines) {
      for (const at of line.markers || []) {
        if (!Number.isFinite(line.ys[at])) continue;
        const d = markerPath(line.model, sx(line.xs[at]), sy(line.ys[at]), 4.5);
        inside.append(svg("path", { d, class: `mark m-${line.model}` }));
      }
    }
    for (const point of options.points || []) {
      inside.append(
        svg("path", {
          d: markerPath(point.model, sx(point.x), sy(point.y), point.size || 5),
          class: `mark m-${point.model} ${point.class || ""}`,
        }),
      );
    }
    return { sx, sy, box, inside };
  }

  // The key of a model: a bit of its line with its marker on it, then its name.
  function key(model) {
    return svg(
      "svg",
      { class: `key m-${model}`, width: 34, height: 14, viewBox: "0 0 34 14", "aria-hidden": "true" },
      svg("path", { d: "M0 7H34", class: `line m-${model}` }),
      svg("path", { d: markerPath(model, 17, 7, 5), class: `mark m-${model}` }),
    );
  }

  // Decades from low to high as ticks of a log axis, at most `most` of them.
  function decades(low, high, most = 5) {
    const from = Math.ceil(Math.log10(low) - 1e-9),
      to = Math.floor(Math.log10(high) + 1e-9);
    const every = Math.max(1, Math.ceil((to - from + 1) / most));
    const ticks = [];
    for (let p = from; p <= to; p += every) {
      ticks.push([10 ** p, p >= -3 && p <= 3 ? plain(10 ** p) : `1e${p}`.replace("-", "−")]);
    }
    return ticks;
  }

  return { MODELS, svg, html, number, plain, plot, key, markerPath, decades, round };
})();
