/* The stage: it puts a figure into the page, hands it drags, keys and time. A figure is a plain
 * object in figures/NAME.js and touches no document:
 *
 *   title, caption  its name; one sentence that says what it shows, or caption(start) gives it
 *   height(width)   px of its drawing
 *   knobs           names of QUANTITIES that stand as sliders below it; or knobs(own) gives them
 *   start(given)    its own state, {name: number or text}; the slot in the text may set it
 *   draw(view)      {picture, words, values}: svg, one sentence, and the numbers that are drawn
 *   clock(view)     {end, rate}: own.time runs from 0 to `end`, `rate` s in a second
 *   play(own)       what the button says that lets it run
 *   buttons(view)   others, [[label, act, pressed]]
 *
 * The view has own, width, height, set(changes), and grab(what, shape): a shape around which one
 * can put a hand, where `what` is {label, value, low, high, step, at(x, y), also, seen, release}. A
 * value is a name of the figure's state, or two of them; at gives what belongs to a place, `also`
 * is set with it, and seen() is the value that one sees, where that is not the state's. view.point
 * is the same with a knob at (x, y). What a handle has done, the figure's words say, to a screen
 * reader, too: in at most two lines on a phone, so that nothing below them moves. */
import { html, nothing, render, svg } from "./lit.js";
import { circle, within } from "./draw.js";
import { data } from "./data.js";

export const QUANTITIES = {
  dt: { low: 0.0005, high: 0.064, log: true, unit: "s", label: "Time step dt" },
  stiffness: { low: 100, high: 1e6, log: true, unit: "N/m", label: "Stiffness k" },
  damping: { low: 0, high: 300, step: 1, unit: "N s/m", label: "Damping c" },
  baumgarte: { low: 0, high: 1, step: 0.01, unit: "", label: "Share β" },
  iters: { low: 1, high: 100, step: 1, unit: "", label: "Sweeps" },
  warm: { low: 0, high: 1, step: 0.05, unit: "", label: "Warm start" },
  restitution: { low: 0, high: 1, step: 0.01, unit: "", label: "Restitution e" },
  impedance: { low: 0.5, high: 0.9999, step: 0.0001, unit: "", label: "Impedance d" },
  mu: { low: 0, high: 3, step: 0.01, unit: "", label: "Friction µ" },
  balls: { low: 3, high: 30, step: 1, unit: "", label: "Balls" },
};
const PLACES = 200; // of a slider whose steps are shares
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const LEAST = 358; // px: on a screen smaller than a phone's it is drawn so, and made smaller

// The view of a figure that nobody touches; its state is its own with what the text sets.
export function viewOf(figure, given, width = 640) {
  const own = { ...data.defaults, time: 0, ...figure.start?.(given), ...given };
  return {
    own, text: { ...own }, width, running: false,
    get height() { return figure.height(this.width, own); },
    grab: (_, shape) => shape,
    point(x, y, what) {
      return this.grab(what, [circle(x, y, 22, "halo"), circle(x, y, 8, "knob-dot")]);
    },
  };
}

const asked = (what, state) => (typeof what === "function" ? what(state) : what);
export const knobsOf = ({ knobs = [] }, { own }) => asked(knobs, own);
export const captionOf = ({ caption }, { own }) => worded(asked(caption, own));

// Words in which v_n stands as a formula, and no line ends between a number and its unit.
export const worded = (words) =>
  words.replace(/ × |(?<=[\d⁰-⁹]) (?=%|(?:r|m?s|m?m|N|kg|m\/s|N\/m)\b)/g, (blank) =>
    blank.replaceAll(" ", "\u00a0")).split("v_n")
    .map((part, k) => (k ? html`<i>v<sub>n</sub></i>${part}` : part));

// ---- sliders

export const toSlider = ({ low, high, log }, value) =>
  (log ? Math.round((PLACES * Math.log(value / low)) / Math.log(high / low)) : value);

// Where the text's own value lies the slider takes it, to the last digit.
export function fromPlace(quantity, text, at) {
  const { low, high, log } = quantity;
  if (text !== undefined && toSlider(quantity, text) === at) return text;
  return log ? Number((low * (high / low) ** (at / PLACES)).toPrecision(3)) : at;
}

function slider(view, name) {
  const quantity = QUANTITIES[name];
  const { low, high, step } = quantity.log ? { low: 0, high: PLACES, step: 1 } : quantity;
  const value = view.own[name];
  const put = ({ target }) =>
    view.set({ [name]: fromPlace(quantity, view.text[name], Number(target.value)) });
  const told = `${value.toLocaleString("en", { maximumSignificantDigits: 4 })} ${quantity.unit}`;
  return html`<label class="knob"><span>${quantity.label}</span><input type="range" min=${low}
    max=${high} step=${step} .value=${String(toSlider(quantity, value))}
    @input=${put}><output aria-live="off">${told}</output></label>`;
}

// ---- hands

/* What is grabbed: its state is changed by where the hand is, from where it was taken hold of, so
 * that nothing jumps; by the arrow keys, `step` at a time and ten times that with shift. */
function grabbing(view, box) {
  let held = null; // by which pointer, and how far from the value's own place
  const from = ({ clientX, clientY }) => {
    const { left, top, width } = box.querySelector("svg").getBoundingClientRect();
    return [clientX - left, clientY - top].map((at) => (at * view.width) / width);
  };
  return ({ label, value, low, high, step, at, also, seen, release }, shape) => {
    const [names, lows, highs, sizes] = [value, low, high, step].map((each) => [each].flat());
    const now = () => (seen ? [seen()] : names.map((name) => view.own[name]));
    const put = (wanted) => {
      const fine = names.map((name, k) =>
        [name, Number(within(lows[k], wanted[k], highs[k]).toPrecision(5))]);
      view.set({ ...also, ...Object.fromEntries(fine) });
    };
    const seize = (event) => {
      if (event.button > 0 || held) return;
      event.preventDefault();
      event.currentTarget.focus({ preventScroll: true });
      event.currentTarget.setPointerCapture(event.pointerId);
      const [place, first] = [[at(...from(event))].flat(), now()];
      held = { pointer: event.pointerId, off: first.map((v, k) => v - place[k]) };
      view.stop();
      put(first);
    };
    const drag = (event) => {
      if (held?.pointer !== event.pointerId) return;
      put([at(...from(event))].flat().map((v, k) => v + held.off[k]));
    };
    const letGo = (event) => {
      if (held?.pointer !== event.pointerId) return;
      held = null;
      release?.();
    };
    const key = (event) => {
      const [across, up] = ARROWS[event.key] ?? [0, 0];
      const lets = release && (event.key === "Enter" || event.key === " ");
      if (!(across || up || lets) || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      if (lets) return release();
      const by = names.length > 1 ? [across, up] : [across + up];
      put(now().map((v, k) => v + by[k] * (event.shiftKey ? 10 : 1) * sizes[k % sizes.length]));
    };
    const stay = (event) => event.preventDefault(); // no finger moves the page
    return svg`<g class="handle" role="slider" tabindex="0" aria-label=${label}
      aria-valuemin=${lows[0]} aria-valuemax=${highs[0]} aria-valuenow=${now()[0]} @pointerdown=${seize} @pointermove=${drag} @pointerup=${letGo}
      @pointercancel=${letGo} @keydown=${key} @touchstart=${stay}>${shape}</g>`;
  };
}

// ---- the stage

export function stage(box, figure, given, still) {
  const view = viewOf(figure, given);
  let [frame, near, begun, last] = [0, false, false, 0];
  view.grab = grabbing(view, box);
  view.set = (changes) => {
    Object.assign(view.own, changes);
    frame ||= requestAnimationFrame(draw);
  };
  view.stop = () => {
    view.running = false;
    view.set({});
  };
  view.play = (from = view.own.time) => {
    const { end } = figure.clock(view);
    view.running = !still;
    last = performance.now();
    view.set({ time: still ? end : from >= end ? 0 : from });
  };
  // the time that has passed since the last picture
  function goOn(now) {
    const { end, rate, loops } = figure.clock(view);
    const time = view.own.time + (rate * within(0, now - last, 100)) / 1000;
    last = now;
    view.running = loops || time < end;
    view.set({ time: loops ? time % end : Math.min(end, time) });
  }
  const same = () => Object.keys(view.text).every((name) => view.own[name] === view.text[name]
    || (name === "time" && figure.clock?.(view).loops));
  const back = () => {
    Object.assign(view.own, view.text);
    view.stop();
  };

  function draw(now) {
    frame = 0;
    if (!near) return;
    if (!begun) box.replaceChildren(); // the still
    begun = true;
    if (view.running) goOn(now);
    const { picture, words } = figure.draw(view);
    const button = ([text, act, pressed]) => {
      const press = () => {
        act(view);
        view.set({});
      };
      return html`<button type="button" aria-pressed=${pressed ?? nothing} @click=${press}
        >${text}</button>`;
    };
    const play = figure.play && (view.running ? ["Stop", view.stop]
      : [figure.play(view.own), () => view.play()]);
    const buttons = [...(play ? [play] : []), ...(figure.buttons?.(view) ?? [])].map(button);
    render(html`<svg class="plot" viewBox="0 0 ${view.width} ${view.height}" role="group"
      aria-label=${figure.title}>${picture}</svg>
      <figcaption>${captionOf(figure, view)}</figcaption><p class="words">${worded(words)}</p>
      <button type="button" class="back" title="As in the text" aria-label="As in the text"
      ?disabled=${same()} @click=${back}>↺</button>
      <div class="controls">${knobsOf(figure, view).map((name) => slider(view, name))}
      <div class="buttons">${buttons}</div></div>`, box);
    for (const each of box.querySelectorAll(".handle, input")) // a slider says its own value first
      each.setAttribute("aria-valuetext", [each.nextElementSibling?.value, words].filter(Boolean).join(": "));
  }
  new ResizeObserver(([{ contentRect: { width } }]) => {
    view.width = Math.max(LEAST, width);
    view.set({});
  }).observe(box);
  // a figure far from the window keeps its still, or waits: what runs goes on when it is back
  new IntersectionObserver((seen) => {
    near = seen[seen.length - 1].isIntersecting;
    if (!near) return;
    if (!begun && figure.clock?.(view).alone && !still) view.play();
    draw(performance.now());
  }, { rootMargin: "300px" }).observe(box);
}
