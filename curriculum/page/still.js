/* The still pictures that a reader without scripts sees, drawn when the page is built. */
import { figures } from "./figures.js";
import { buttonsOf, heightOf, stillView } from "./stage.js";
import { QUANTITIES, startOf } from "./store.js";

const WIDTH = 640;

// What a figure shows first: {svg, words, height, narrow, ...}.
function still([name, figure]) {
  const { title, caption = "", knobs = [], shows = {} } = figure;
  try {
    const made = figure.draw(stillView(figure, { ...startOf("drop"), ...shows }, WIDTH));
    const [height, narrow] = [heightOf(figure, WIDTH), heightOf(figure, 1)];
    const counts = { knobs: knobs.length, buttons: buttonsOf(figure).length };
    const { svg, words = "" } = made;
    return [name, { svg, words, title, caption, width: WIDTH, height, narrow, ...counts }];
  } catch (error) {
    throw new Error(`curriculum/page/figures, ${name}: ${error}`);
  }
}

export const stills = () => ({
  figures: Object.fromEntries(Object.entries(figures).map(still)),
  ranges: Object.fromEntries(
    Object.entries(QUANTITIES).map(([name, { low, high }]) => [name, [low, high]]),
  ),
});
