/* The still pictures that a reader without scripts sees, drawn when the page is built. */
import { figures } from "./figures.js";
import { textOf } from "./lit.js";
import { fromPlace, QUANTITIES, stateOf, toSlider, viewOf } from "./stage.js";

const [WIDE, NARROW] = [640, 358]; // px

// What a slot may set: what the figure has, in its range.
function check(own, given) {
  for (const [name, value] of Object.entries(given)) {
    const { low = value, high = value } = QUANTITIES[name] ?? {};
    if (!(name in own)) throw new Error(`${name} sets nothing; known: ${Object.keys(own).join(", ")}`);
    if (!(value >= low && value <= high)) throw new Error(`${name}=${value}; allowed: from ${low} to ${high}`);
  }
}

// What a figure shows first.
function still([name, given]) {
  const figure = figures[name];
  if (!figure) throw new Error(`there is no figure ${name}; known: ${Object.keys(figures).join(", ")}`);
  try {
    check(stateOf(figure, {}), given);
    const view = viewOf(figure, given, WIDE);
    const { picture, words } = figure.draw(view);
    const { title, caption, height, knobs = [] } = figure;
    const sliders = typeof knobs === "function" ? knobs(view.own) : knobs;
    const heights = [WIDE, NARROW].map((width) => height(width, view.own));
    return { svg: textOf(picture), words, title, caption, heights, knobs: sliders.length };
  } catch (error) {
    throw new Error(`the figure ${name}: ${error.message}`);
  }
}

export const stills = (wanted) => wanted.map(still);
export { figures, fromPlace, QUANTITIES, textOf, toSlider, viewOf };
