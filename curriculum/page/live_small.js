/* The small figures in the page: drawn when they come near, and again as their knobs move. */
"use strict";

const LiveSmall = (() => {
  const $ = (id) => document.getElementById(id);
  const POSITIONS = 120; // of a logarithmic knob

  function valueAt(knob, position) {
    if (!knob.log) return Number((knob.low + position * knob.step).toPrecision(10));
    return Number((knob.low * (knob.high / knob.low) ** (position / POSITIONS)).toPrecision(3));
  }

  function positionOf(knob, value) {
    if (!knob.log) return Math.round((value - knob.low) / knob.step);
    return Math.round((POSITIONS * Math.log(value / knob.low)) / Math.log(knob.high / knob.low));
  }

  const widthOf = (node) => Math.max(256, Math.min(560, Math.floor(node.clientWidth)));

  function mount(node, name) {
    const { knob } = SmallFigures.FIGURES[name];
    const slider = $(`${name}-slider`);
    const steps = knob.log ? POSITIONS : Math.round((knob.high - knob.low) / knob.step);
    Object.assign(slider, { min: "0", max: String(steps), step: "1" });
    slider.value = String(positionOf(knob, knob.value));
    let width = 0;
    const draw = () => {
      width = widthOf(node);
      const drawn = SmallFigures.render(name, valueAt(knob, Number(slider.value)), width, Bets.open);
      node.querySelector(".drawing").innerHTML = drawn.svg;
      $(`${name}-output`).textContent = drawn.output;
      $(`${name}-words`).textContent = drawn.words;
      slider.setAttribute("aria-valuetext", drawn.output);
    };
    slider.addEventListener("input", draw);
    document.addEventListener("bet", () => width && draw());
    new ResizeObserver(() => {
      if (width && widthOf(node) !== width) draw();
    }).observe(node);
    return draw;
  }

  function start() {
    for (const node of document.querySelectorAll("figure[data-small]")) {
      const draw = mount(node, node.dataset.small);
      const near = (entries, observer) => {
        if (!entries.some((entry) => entry.isIntersecting)) return;
        observer.disconnect();
        draw();
      };
      new IntersectionObserver(near, { rootMargin: "400px" }).observe(node);
    }
  }

  return { start, valueAt };
})();
