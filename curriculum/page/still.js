/* The still pictures that a reader without scripts sees, drawn when the page is built. */
import { figures } from "./figures.js";
import { textOf } from "./lit.js";
import { captionOf, fromPlace, knobsOf, QUANTITIES, toSlider, viewOf, worded } from "./stage.js";

const [WIDE, NARROW] = [640, 358]; // px

// What a slot may set: what the figure has, in its range.
function check(own, given) {
  for (const [name, value] of Object.entries(given)) {
    const { low = value, high = value } = QUANTITIES[name] ?? {};
    if (!(name in own))
      throw new Error(`${name} sets nothing; known: ${Object.keys(own).join(", ")}`);
    if (!(value >= low && value <= high))
      throw new Error(`${name}=${value}; allowed: from ${low} to ${high}`);
  }
}

// What a figure shows first.
function still([name, given]) {
  const figure = figures[name];
  if (!figure)
    throw new Error(`there is no figure ${name}; known: ${Object.keys(figures).join(", ")}`);
  try {
    check(viewOf(figure, {}).own, given);
    const view = viewOf(figure, given, WIDE);
    const { picture, words } = figure.draw(view);
    return {
      title: figure.title,
      svg: textOf(picture),
      words: textOf(worded(words)),
      caption: textOf(captionOf(figure, view)),
      heights: [WIDE, NARROW].map((width) => figure.height(width, view.own)),
      knobs: knobsOf(figure, view).length,
      buttons: figure.buttons || figure.play ? 1 : 0,
    };
  } catch (error) {
    throw new Error(`the figure ${name}: ${error.message}`);
  }
}

export const stills = (wanted) => wanted.map(still);
export { figures, fromPlace, knobsOf, QUANTITIES, textOf, toSlider, viewOf };
