/* Glances: where no live figure stands beside the text, a passage begins with a picture of what it
 * would show there, and a press calls it up. */
import { figures } from "./figures.js";
import { LEAST, stillView } from "./stage.js";

const HEIGHT = 300; // px of a picture, as the style has it
const NEAR = "600px"; // beyond the window: there pictures are drawn

// A fifth of the way through what a passage shows in the live figure.
export function seenLater(figure, view, changes) {
  figure.look(view, changes, true);
  const { from, to } = view.own;
  view.own.time = from + 0.2 * (to - from);
}

export class Glance {
  constructor({ node, section, look }, open) {
    Object.assign(this, { node, section, look, open });
    const label = "The models over one table: let them fall";
    node.innerHTML = `<button type="button" data-dock aria-label="${label}">
      <svg class="plot" preserveAspectRatio="xMidYMax"></svg>Let them fall</button>`;
    const seen = ([{ isIntersecting: near }]) => {
      this.near = near;
      this.redraw();
    };
    new IntersectionObserver(seen, { rootMargin: NEAR }).observe(node);
  }

  redraw() {
    const { node, section, open } = this;
    const svg = node.querySelector("svg");
    if (!this.near || !svg.clientWidth) return; // or the live figure stands beside
    const width = Math.max(LEAST, svg.clientWidth);
    const view = Object.assign(stillView(figures.lanes, section.values, width), { open });
    view.height = HEIGHT;
    seenLater(figures.lanes, view, Object.fromEntries(new URLSearchParams(this.look)));
    svg.setAttribute("viewBox", `0 0 ${width} ${HEIGHT}`);
    svg.innerHTML = figures.lanes.draw(view).svg;
  }
}
