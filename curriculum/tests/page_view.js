/* The figures without a page, for tests: MADE is still.js, bundled. */
const MOST = 89; // letters of a figure's words: two lines on a phone

const drawn = (name, given = {}, own = {}, width = 640) => {
  const [figure, handles] = [MADE.figures[name], []];
  const view = MADE.viewOf(figure, given, width);
  Object.assign(view.own, own);
  view.grab = (what, shape) => {
    handles.push({ ...what, shape: MADE.textOf(shape) });
    return shape;
  };
  const { picture, words } = figure.draw(view);
  return { svg: MADE.textOf(picture), words, handles, height: view.height,
    caption: MADE.captionOf(figure, view), knobs: MADE.knobsOf(figure, view) };
};

// What goes wrong where hands and knobs go to all their ends.
const lost = (name, given, width) => {
  const [found, first] = [new Set(), drawn(name, given, {}, width)];
  const knobs = first.knobs.flatMap((knob) =>
    ["low", "high"].map((end) => ({ [knob]: MADE.QUANTITIES[knob][end] })));
  const hands = first.handles.flatMap(({ value, low, high }) =>
    [low, high].map((end) => ({ [value]: end })));
  for (const own of [{}, ...hands].flatMap((hand) => [{}, ...knobs].map((knob) => ({ ...hand, ...knob })))) {
    const { svg, words, handles, height } = drawn(name, given, own, width);
    const outside = ([, x, y], by) => !(x >= -by && x <= width + by && y >= -by && y <= height + 1);
    const see = (wrong, what) => wrong && found.add(`${what} at ${JSON.stringify(own)}`);
    see(/NaN|undefined|null|Infinity/.test(svg + words), "no number");
    see(words.length > MOST, `a third line of words on a phone: ${words}`);
    for (const place of svg.matchAll(/<circle cx="(\S+)" cy="(\S+)" r="\S+" class="mark /g))
      see(outside(place, 9), "a mark");
    for (const { shape, label } of handles)
      see(outside(shape.match(/cx="(\S+)" cy="(\S+)"/) ?? [], 1), label);
  }
  return [...found];
};
