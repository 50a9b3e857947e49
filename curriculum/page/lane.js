/* The lanes of the live figure: one model each, its balls over the table, and a lens on the lowest
 * contact beside them, never over them. Pure drawing, as plot.js: a state in, SVG text out. */
"use strict";

const Lane = (() => {
  const { el, ball, table, arrow, round } = Plot;
  const SIZE = { width: 120, height: 168, floor: 152, scale: 126 }; // scale: pixels a metre
  const LENS = { width: 120, height: 84 };
  const WIDER = 160; // a lane may be wider than its picture: the table goes on
  const LENSES = [0.02, 0.1, 0.5, 3]; // what a lens can show above and below the surface [r]

  // The narrowest lens that still shows the lowest balls of all lanes.
  function fittingLens(gaps) {
    const far = Math.max(...gaps.map((gap) => (Number.isFinite(gap) && gap < 3 ? Math.abs(gap) : 0)));
    if (gaps.every((gap) => !(gap < 3))) return 0.5;
    return LENSES.find((lens) => far <= 0.9 * lens) || LENSES[LENSES.length - 1];
  }

  // An arrow's length grows with the square root of the force: impacts are hundreds of weights.
  const length = (weights) => Math.min(118, 17 * Math.sqrt(Math.max(weights, 0)));

  /* One lane. shown: {model, y: heights of the centres, radius, push: in weights, trail: [heights]}. */
  function air(shown) {
    const { model, y, radius, push, trail } = shown;
    const r = radius * SIZE.scale;
    const x = SIZE.width / 2;
    const at = (height) => SIZE.floor - height * SIZE.scale;
    const seen = y.filter((height) => Number.isFinite(height) && at(height) > -r);
    const lowest = seen.length ? Math.min(...seen) : NaN;
    const parts = [table(-WIDER, SIZE.floor, SIZE.width + 2 * WIDER, SIZE.height - SIZE.floor)];
    for (const height of trail) parts.push(ball(model, x, at(height), r, "strobe"));
    for (const height of seen) parts.push(ball(model, x, Math.min(at(height), 2000), r));
    if (seen.length < y.length)
      parts.push(el("path", { d: `M${x} 6l14 22h-9v22h-10v-22h-9z`, class: `ball m-${model}` }));
    if (Number.isFinite(lowest) && push !== null) {
      parts.push(arrow("weight", x - 22, at(lowest), 0, length(1)));
      parts.push(arrow(`push m-${model}`, x + 22, SIZE.floor, 0, -length(push)));
    }
    return parts.join("");
  }

  /* The lens of a lane: `reach` radii above and below the table's top, with a scale on its edge. */
  function lens(shown, reach) {
    const { model, y, radius, sink } = shown;
    const middle = LENS.height / 2;
    const zoom = middle / reach; // pixels a radius
    const parts = [table(-WIDER, middle, LENS.width + 2 * WIDER, middle)];
    const gap = Math.min(...y) / radius - 1;
    if (Number.isFinite(gap) && Math.abs(gap) < 40 * reach)
      parts.push(ball(model, LENS.width / 2, middle - gap * zoom - zoom, zoom, "ball plainly"));
    if (sink !== null && sink < reach)
      parts.push(
        el("line", {
          x1: -WIDER,
          x2: LENS.width + WIDER,
          y1: middle + sink * zoom,
          y2: middle + sink * zoom,
          class: "sink-line",
        }),
      );
    const ticks = [-1, -0.5, 0, 0.5, 1].map((share) => {
      const at = Math.min(Math.max(middle + share * middle, 0.75), LENS.height - 0.75);
      return `M0 ${round(at)}h${share % 1 === 0 ? 10 : 6}`;
    });
    parts.push(el("path", { d: ticks.join(""), class: "scale" }));
    return parts.join("");
  }

  return { SIZE, LENS, LENSES, fittingLens, air, lens };
})();
