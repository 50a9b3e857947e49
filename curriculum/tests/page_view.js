/* The figures without a page, for tests: MADE is still.js, bundled. */
const drawn = (name, given = {}, own = {}, width = 640) => {
  const [figure, handles] = [MADE.figures[name], []];
  const view = MADE.viewOf(figure, given, width);
  Object.assign(view.own, own);
  view.grab = (what, shape) => {
    handles.push({ ...what, shape: MADE.textOf(shape) });
    return shape;
  };
  const { picture, words } = figure.draw(view);
  return { svg: MADE.textOf(picture), words, handles, height: view.height, own: view.own,
    caption: MADE.captionOf(figure, view), knobs: MADE.knobsOf(figure, view),
    end: figure.clock?.(view).end };
};
const MOST = 89; // letters of a figure's words
const several = (value) => (Array.isArray(value) ? value : [value]);

// What goes wrong where hands and knobs go to all their ends: handles that leave, texts that are
// none.
const lost = (name, given, width) => {
  const [found, first] = [new Set(), drawn(name, given, {}, width)];
  const ends = first.knobs.flatMap((knob) =>
    ["low", "high"].map((end) => ({ [knob]: MADE.QUANTITIES[knob][end] })));
  const places = first.handles.flatMap(({ value, low, high, also }) => [low, high].map((end) =>
    ({ ...also, ...Object.fromEntries(several(value).map((key, k) => [key, several(end)[k] ?? end])) })));
  for (const own of [{}, ...places].flatMap((place) =>
    [{}, ...ends].map((end) => ({ ...place, ...end })))) {
    const { svg, words, handles, height } = drawn(name, given, own, width);
    const said = JSON.stringify(own);
    if (/NaN|undefined|null|Infinity|not a number/.test(svg + words))
      found.add(`no number at ${said}`);
    if (words.length > MOST) found.add(`words that need a third line on a phone: ${words}`);
    for (const [, x, y] of svg.matchAll(/<circle cx="(\S+)" cy="(\S+)" r="\S+" class="mark /g))
      if (!(x >= -9 && x <= width + 9 && y >= -9 && y <= height)) found.add(`a mark at ${said}`);
    for (const { shape, label } of handles) {
      const [, x, y] = shape.match(/cx="(\S+)" cy="(\S+)"/) ?? [];
      if (!(x >= 0 && x <= width && y >= -1 && y <= height + 1)) found.add(`${label} at ${said}`);
    }
  }
  return [...found];
};
