/* The figures without a page, for tests: STORE, ENGINE and FIGURES are the bundled modules. */
// A view as stage.js gives it, of a figure in a section with these values and its own state.
const Section = STORE.Section, figures = FIGURES.figures;
const viewOf = (name, changes, own, width) => {
  const figure = figures[name], section = new Section("any", changes);
  const view = {
    own: { ...(figure.start ? figure.start() : {}), ...own }, width, figure, near: true,
    height: (width < 480 && figure.narrow) || figure.height, still: true, grabbed: null,
    get values() { return section.values; }, get: section.get, set: section.set,
    open: () => true, flick: () => [9999, -9999], stop() {}, run() {}, box: null,
    play() { const { from = 0, end } = figure.clock(view); view.own.time = (from + end) / 2; },
  };
  return view;
};
const drawn = (view) => {
  const { svg, words, handles } = view.figure.draw(view);
  return { svg, words, handles: handles.map(({ name, x, y }) => ({ name, x, y })) };
};
const lost = (name, width) => {
  const found = new Set(), view = viewOf(name, {}, {}, width);
  const look = (after) => {
    const { from = 0, end } = view.own.time > 0 ? view.figure.clock(view) : {};
    for (const share of end ? [0.1, 0.2, 0.4, 0.7, 1] : [0]) {
      if (end) view.own.time = from + share * (Math.min(end, 9e3) - from);
      for (const { name, x, y } of view.figure.draw(view).handles)
        if (!(x >= 0 && x <= width && y >= 0 && y <= view.height)) found.add(`${name} ${after}`);
    }
  };
  const hold = (handle, x, y) => {
    view.from = view.figure.draw(view).handles.find((each) => each.name === handle);
    view.grabbed = handle;
    if (view.from) view.from.drag(x, y);
  };
  const uses = new Set(view.figure.knobs), { get } = view;
  view.get = (knob) => get(uses.add(knob) && knob);
  const { handles } = view.figure.draw(view);
  const extremes = { dt: [0.0005, 0.064], stiffness: [100, 1e6], restitution: [0, 1],
    damping: [0, 300], baumgarte: [0, 1], iters: [1, 100], warm: [0, 1] };
  const used = Object.entries(extremes).filter(([knob]) => uses.has(knob));
  for (const handle of [...handles.slice(0, 2), handles[handles.length - 1]])
    for (const [x, y] of [[-900, -900], [1900, 1900]])
      for (const [knob, values] of [...used, ["dt", []]])
        for (const value of values.length ? values : [view.values[knob]]) {
          hold(handle.name, x, y);
          look(`held at ${x}, ${y}`);
          view.set({ [knob]: value });
          look(`held at ${x}, ${y} while ${knob} becomes ${value}`);
          view.figure.draw(view).handles.find((each) => each.name === view.grabbed)?.release?.();
          view.grabbed = null;
          look(`let go at ${x}, ${y} with ${knob} = ${value}`);
          if (values.length) view.set({ [knob]: values[0] });
          look(`let go at ${x}, ${y}, then ${knob} less`);
        }
  return [...found];
};
const still = (name) => {
  const view = viewOf(name, {}, {}, 640), shown = () => view.figure.draw(view).handles;
  const tellsOf = (label) => shown().find((each) => each.name === label)?.text;
  return shown().map(({ name: label }) => label).filter((label) => {
    const told = new Set([tellsOf(label)]);
    for (const way of [[0, -1], [0, 1], [0, 1], [1, 0], [-1, 0], [-1, 0]]) {
      shown().find((each) => each.name === label).nudge(...way);
      told.add(tellsOf(label));
    }
    return told.size === 1;
  });
};
