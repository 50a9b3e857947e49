/* The still pictures that a reader without scripts sees, drawn when the page is built. */
import { inSentence } from "./draw.js";
import { figures } from "./figures.js";
import { seenLater } from "./glance.js";
import { LINES } from "./lines.js";
import { buttonsOf, heightOf, stillView } from "./stage.js";
import { data } from "./data.js";
import { QUANTITIES, Section, startOf } from "./store.js";

const WIDTH = 640;

// What a figure shows first in a section: {svg, words, height, narrow, ...}.
function still([id, [name, changes]]) {
  try {
    const figure = figures[name] ?? {};
    const { title, caption = "", knobs = [] } = figure;
    const view = stillView(figure, new Section(id, changes).values, WIDTH);
    if (id.endsWith("-still")) {
      // the live figure without a script and on paper: with all answers
      Object.assign(view, { height: 380, open: () => true });
      seenLater(figure, view, changes);
    }
    const made = figure.draw(view);
    for (const part of ["title", "height", "svg", "words"])
      if (!(part in { ...figure, ...made })) throw new Error(`it has no ${part}`);
    const [height, narrow] = [view.height, heightOf(figure, 1)];
    const counts = { knobs: knobs.length, buttons: buttonsOf(figure).length };
    const { svg, words } = made;
    const texts = { words, sentence: inSentence(words), title, caption: inSentence(caption) };
    return [id, { svg, ...texts, width: WIDTH, height, narrow, ...counts }];
  } catch (error) {
    throw new Error(`the figure ${name}: ${error}`);
  }
}

// Of figures {id: [name, what its section sets]}.
export const stills = (wanted) => ({
  figures: Object.fromEntries(Object.entries(wanted).map(still)),
});

// What the text may set: {quantity: [low, high]}, and every value as a scene has it at first.
export const settable = () => ({
  names: Object.keys(figures),
  lines: LINES,
  starts: Object.fromEntries(Object.keys(data.scenes).map((scene) => [scene, startOf(scene)])),
  ranges: Object.fromEntries(
    Object.entries(QUANTITIES).map(([name, { low, high }]) => [name, [low, high]]),
  ),
});
