/* The still pictures that a reader without scripts sees, drawn when the page is built. */
import { data } from "./data.js";
import { figures } from "./figures.js";
import { textOf } from "./lit.js";
import { asked, captionOf, fits, knobsOf, QUANTITIES, viewOf, worded } from "./stage.js";

const [WIDE, NARROW] = [640, 358]; // px
const CHOICES = { // words that a slot may set
  models: [...data.models, "implicit"], model: data.models, scene: Object.keys(data.scenes),
  knobs: Object.keys(QUANTITIES),
};

// What a slot may set: what the figure has, in its range or among its choices.
function check(figure, given) {
  const view = viewOf(figure, {});
  figure.draw(view); // which tells the ranges of its handles
  for (const [name, value] of Object.entries(given)) {
    const known = CHOICES[name];
    if (!(name in view.own))
      throw new Error(`${name} sets nothing; known: ${Object.keys(view.own).join(", ")}`);
    if (known && !String(value).split(",").every((word) => known.includes(word)))
      throw new Error(`${name}=${value}; allowed: ${known.join(", ")}`);
    if (name in view.ranges && !fits(figure, view, name, value))
      throw new Error(`${name}=${value}; allowed: from ${view.ranges[name].join(" to ")}`);
  }
}

// What a figure shows first, or the error that keeps it from being drawn.
function still([name, given]) {
  const figure = figures[name];
  if (!figure) return { error: `there is no figure ${name}; known: ${Object.keys(figures).join(", ")}` };
  try {
    check(figure, given);
    const view = viewOf(figure, given, WIDE);
    const { picture, words } = figure.draw(view);
    return { svg: textOf(picture), words: worded(words), caption: captionOf(figure, view),
      title: asked(figure.title, view.own),
      heights: [WIDE, NARROW].map((width) => figure.height(width)),
      knobs: figure.room ?? knobsOf(figure, view).length,
      buttons: figure.play || figure.switches?.(view.own).length ? 1 : 0 };
  } catch ({ message }) {
    return { error: `the figure ${name}: ${message}` };
  }
}

export const stills = (slots) => slots.map(still);
export { captionOf, figures, knobsOf, QUANTITIES, textOf, viewOf };
