/* The still pictures that a reader without scripts sees, drawn when the page is built. */
import { data } from "./data.js";
import { figures } from "./figures.js";
import { textOf } from "./lit.js";
import { captionOf, fromPlace, knobsOf, QUANTITIES, toSlider, viewOf, worded } from "./stage.js";

const [WIDE, NARROW] = [640, 358]; // px
const CHOICES = { // words that a slot may set, where the figure has no choices of its own
  models: data.models, model: data.models, scene: Object.keys(data.scenes),
  knobs: Object.keys(QUANTITIES),
};

// What a slot may set: what the figure has, in its range or among its choices.
function check({ choices }, own, given) {
  for (const [name, value] of Object.entries(given)) {
    const { low = -Infinity, high = Infinity } = QUANTITIES[name] ?? {};
    const known = choices?.[name] ?? CHOICES[name];
    const allowed = known?.filter(Boolean).join(", ")
      ?? (name in QUANTITIES ? `from ${low} to ${high}` : "a number");
    if (!(name in own))
      throw new Error(`${name} sets nothing; known: ${Object.keys(own).join(", ")}`);
    if (known ? !String(value).split(",").every((word) => known.includes(word))
      : typeof own[name] === "number" && !(value >= low && value <= high))
      throw new Error(`${name}=${value}; allowed: ${allowed}`);
  }
}

// What a figure shows first.
function still([name, given]) {
  const figure = figures[name];
  if (!figure)
    throw new Error(`there is no figure ${name}; known: ${Object.keys(figures).join(", ")}`);
  try {
    check(figure, viewOf(figure, {}).own, given);
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

function errorOf(slot) {
  try {
    still(slot);
  } catch ({ message }) {
    return message;
  }
  return "";
}

export const errors = (slots) => slots.map(errorOf); // "" where a slot can be drawn
export const stills = (wanted) => wanted.map(still);
export { figures, fromPlace, knobsOf, QUANTITIES, textOf, toSlider, viewOf };
