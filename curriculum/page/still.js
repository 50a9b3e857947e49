/* The still pictures that a reader without scripts sees, drawn when the page is built (still.py). */
import { key } from "./draw.js";
import { figures } from "./figures.js";
import { stillView, heightOf } from "./stage.js";
import { MODELS, QUANTITIES, startOf } from "./store.js";

const WIDTH = 640;

// What a figure shows first: {svg, words, height, narrow, ...}. `more` are all figures' quantities.
function still(figure, more) {
  const values = { ...startOf("drop"), ...more, ...(figure.shows || {}) };
  const made = figure.draw(stillView(figure, values, WIDTH));
  const { title, caption = "", knobs = [], buttons = [] } = figure;
  const [height, narrow] = [heightOf(figure, WIDTH), heightOf(figure, 1)];
  const counts = { knobs: knobs.length, buttons: buttons.length };
  return { svg: made.svg, words: made.words || "", title, caption, width: WIDTH, height, narrow, ...counts };
}

// The same, and what is wrong where a figure cannot be drawn.
function tried(name, figure, more) {
  try {
    return still(figure, more);
  } catch (error) {
    return { error: `curriculum/page/figures/${name}.js: ${error}` };
  }
}

export function stills() {
  const brought = Object.assign({}, ...Object.values(figures).map((each) => each.quantities || {}));
  const quantities = { ...QUANTITIES, ...brought };
  const more = Object.fromEntries(Object.entries(brought).map(([name, { start }]) => [name, start]));
  return {
    figures: Object.fromEntries(Object.entries(figures).map(([name, figure]) => [name, tried(name, figure, more)])),
    keys: Object.fromEntries(MODELS.map((model) => [model, key(model)])),
    ranges: Object.fromEntries(Object.entries(quantities).map(([name, { low, high }]) => [name, [low, high]])),
  };
}
