/* The still pictures that a reader without scripts sees, drawn when the page is built by the same code
 * that draws live. still.py runs this; the page does not hold it. */
"use strict";

const Stills = (() => {
  const { MODELS } = ContactEngine;
  const { number } = Plot;
  const state = { ...State.DEFAULTS, ...State.ownKnobs("drop") };
  const scene = State.sceneOf(state);
  const steps = Math.round(4 / state.dt);
  const runs = MODELS.map((model) => ContactEngine.runModel(model, scene, State.knobsOf(state), steps));
  const series = runs.map((run) => ContactEngine.series(run, scene));

  const first = Math.min(...series.map((each) => each.landing)) - 1; // just before the landing

  // The four lanes at one row: air and lens of each, and words.
  function lanes(row) {
    const gaps = series.map((each) => each.gap[row]);
    const reach = Lane.fittingLens(gaps);
    return MODELS.map((model, m) => {
      const run = runs[m];
      const trail = [];
      for (let k = 0; k < Math.min(row, series[m].landing); k += 25) trail.push(run.y[k]);
      const sink =
        model === "penalty" && row === steps ? -ContactEngine.GRAVITY / state.stiffness / PAGE.radius : null;
      const shown = { model, y: [run.y[row]], radius: PAGE.radius, push: series[m].push[row], trail, sink };
      const size = Math.abs(gaps[m]);
      const words = size < 1e-9 ? "touching" : `${number(size, 2)} r ${gaps[m] < 0 ? "in" : "up"}`;
      return {
        model,
        air: Lane.air(shown),
        lens: Lane.lens(shown, reach),
        words,
        push: `↑ ${number(series[m].push[row], 2)} m g`,
      };
    });
  }

  function small() {
    const found = {};
    for (const [name, figure] of Object.entries(SmallFigures.FIGURES)) {
      const { svg, words, output } = SmallFigures.render(name, figure.knob.value, 480);
      found[name] = { name, svg, words, output, title: figure.title, label: figure.label };
    }
    return found;
  }

  const keys = () => Object.fromEntries(MODELS.map((model) => [model, Plot.key(model)]));

  return {
    all: () => ({
      reach: Lane.fittingLens(series.map((each) => each.gap[first])),
      start: lanes(first),
      end: lanes(steps),
      small: small(),
      keys: keys(),
      knobs: Object.fromEntries(
        Object.entries(State.KNOBS).map(([name, { low, high }]) => [name, [low, high]]),
      ),
      size: { air: Lane.SIZE, lens: Lane.LENS },
    }),
  };
})();
