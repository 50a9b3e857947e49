/* The stage puts a figure into the page, hands it drags, keys and time, and keeps what was set. A figure
 * is a plain object in figures/NAME.js (its texts, too, as f(own)):
 *
 *   title, caption    its name; one sentence that says what it shows
 *   height(width)     px of its drawing
 *   knobs, room       names of QUANTITIES, sliders below it, at most two, if its state names no others
 *                     ("dt,mu"); how many may come
 *   start(given)      its own state, {name: number or text}; the slot in the text may set it
 *   draw(view)        {picture, words}: svg, and one sentence, of two lines on a phone
 *   clock(view)       {end, rate, step, loops, alone}: own.time runs from 0 to `end`, `rate` s in a
 *                     second; with loops it begins again, with alone it starts unasked
 *   play(own)         what the button says that lets it run
 *   switches(own)     buttons [[label, name, value]]: own[name] becomes value, or 0 if it was that
 *
 * The view has own, width, height, set(changes), and grab({label, value, low, high, step, at}, shape),
 * a shape that one can seize. A value is a name of the state, which at(x, y) gives. view.point is grab
 * with a knob at (x, y). */
import { html, nothing, render, svg } from "./lit.js";
import { circle, plain, within } from "./draw.js";
import { data } from "./data.js";

export const QUANTITIES = {
  dt: { low: 0.0005, high: 0.064, log: true, times: 1000, unit: "ms", label: "Time step dt" },
  stiffness: { low: 100, high: 1e6, log: true, unit: "N/m", label: "Stiffness k" },
  damping: { low: 0, high: 300, step: 1, unit: "N s/m", label: "Damping c" },
  iters: { low: 1, high: 100, step: 1, unit: "", label: "Sweeps" },
  impedance: { low: 0.5, high: 0.9999, step: 0.0001, unit: "", label: "Impedance d" },
  d0: { low: 0, high: 0.95, step: 0.01, unit: "", label: "Impedance d₀" },
  mu: { low: 0, high: 3, step: 0.01, unit: "", label: "Friction µ" },
};
const PLACES = 200; // of a slider whose steps are shares
const KEYS = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: 1, ArrowDown: -1, Home: -Infinity, End: Infinity };
const LEAST = 358; // px: on a screen smaller than a phone's it is drawn so, and made smaller

export const asked = (what, own) => (typeof what === "function" ? what(own) : what);
export const captionOf = ({ caption }, { own }) => worded(asked(caption, own));
export const knobsOf = ({ knobs = [] }, { own }) => own.knobs?.split(",") ?? asked(knobs, own);

// No line ends between a number and its unit.
export const worded = (words) =>
  words.replace(/ × |(?<=[\d⁰-⁹]) (?=%|(?:r|m?s|m?m|N|kg|m\/s|N\/m)\b)/g, (blank) =>
    blank.replaceAll(" ", "\u00a0"));

// The view of a figure that nobody touches; its state is its own with what the text sets.
export function viewOf(figure, given, width = 640) {
  const own = { ...data.defaults, time: 0, ...figure.start?.(given), ...given };
  const ranges = Object.fromEntries(knobsOf(figure, { own }).map((name) =>
    [name, [QUANTITIES[name].low, QUANTITIES[name].high]]));
  return {
    own, text: { ...own }, ranges, width, running: false,
    get height() { return figure.height(this.width); },
    grab({ value, low, high }, shape) {
      ranges[value] = [low, high];
      return shape;
    },
    point(x, y, what) {
      return this.grab(what, [circle(x, y, 22, "halo"), circle(x, y, 8, "knob-dot")]);
    },
  };
}

// Whether a link may set it, or a reload: a switch, or a number in its range.
export function fits(figure, { own, ranges }, name, value) {
  const switches = (figure.switches?.(own) ?? []).filter(([, key]) => key === name);
  if (switches.length) return value === 0 || switches.some(([, , to]) => to === value);
  return Object.hasOwn(ranges, name) && value >= ranges[name][0] && value <= ranges[name][1];
}

function slider(view, name) {
  const { low, high, step, log, unit, times = 1, label } = QUANTITIES[name];
  const [value, ratio] = [view.own[name], high / low];
  const place = log ? Math.round((PLACES * Math.log(value / low)) / Math.log(ratio)) : value;
  const put = ({ target }) => view.set({ [name]: log
    ? Number((low * ratio ** (target.value / PLACES)).toPrecision(3)) : Number(target.value) });
  const told = `${(value * times).toLocaleString("en", { maximumSignificantDigits: 4 })}\u00a0${unit}`;
  return html`<label class="knob"><span>${label}</span><input type="range" min=${log ? 0 : low}
    max=${log ? PLACES : high} step=${log ? 1 : step} .value=${String(place)} @input=${put}
    ><output aria-live="off">${told}</output></label>`;
}

/* What is grabbed: a hand changes its state from where it took hold, so that nothing jumps; the arrow
 * keys by `step`, or ten with shift. */
function hands(view, box) {
  let held = null; // by which pointer, and how far from the value's own place
  return ({ label, value, low, high, step, at }, shape) => {
    const put = (wanted) => view.set({ [value]: within(low, Number(wanted.toPrecision(5)), high) });
    const placeOf = ({ clientX, clientY }) => {
      const { left, top, width } = box.querySelector("svg").getBoundingClientRect();
      return at(...[clientX - left, clientY - top].map((px) => (px * view.width) / width));
    };
    const seize = (event) => {
      if (event.button > 0 || held) return;
      event.preventDefault();
      event.currentTarget.focus({ preventScroll: true });
      event.currentTarget.setPointerCapture(event.pointerId);
      held = { pointer: event.pointerId, off: view.own[value] - placeOf(event) };
      view.stop();
    };
    const drag = (event) => {
      if (held?.pointer === event.pointerId) put(placeOf(event) + held.off);
    };
    const letGo = (event) => {
      if (held?.pointer === event.pointerId) held = null;
    };
    const key = (event) => {
      if (!KEYS[event.key] || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      put(view.own[value] + KEYS[event.key] * (event.shiftKey ? 10 : 1) * step);
    };
    const stay = (event) => event.preventDefault(); // no finger moves the page
    return svg`<g class="handle" @pointerdown=${seize} @pointermove=${drag} @pointerup=${letGo}
      @pointercancel=${letGo} @touchstart=${stay} @keydown=${key} role="slider" tabindex="0"
      aria-label=${label} aria-valuemin=${low} aria-valuemax=${high}
      aria-valuenow=${within(low, view.own[value], high)}>${shape}</g>`;
  };
}

// Put a figure into its box; what is set there is kept in `settings`, by the box. Returns
// take({name: value}): as in the text, but for these.
export function stage(box, figure, given, still, settings) {
  const view = viewOf(figure, given);
  const { own, text } = view;
  let [frame, near, begun, last, soon] = [0, false, false, 0, 0];
  const ask = () => (frame ||= requestAnimationFrame(draw));
  const same = (name) => own[name] === text[name] || (name === "time" && figure.clock?.(view).loops);
  // the address leads here, with all that differs from the text; a reload finds the other figures'
  function remember() {
    settings[box.id] = Object.fromEntries(Object.entries(own).filter(([name, value]) =>
      !same(name) && fits(figure, view, name, value)));
    const query = new URLSearchParams(settings[box.id]).toString();
    history.replaceState(settings, "", `#${box.id}${query && `?${query}`}`);
  }
  const [hand, { grab }] = [hands(view, box), view];
  view.grab = (what, shape) => hand(what, grab(what, shape));
  view.set = (changes) => {
    Object.assign(own, changes);
    clearTimeout(soon);
    soon = setTimeout(remember, 300); // browsers count how often the address changes
    ask();
  };
  view.stop = () => {
    view.running = false;
    ask();
  };
  view.play = (from = own.time) => {
    [view.running, last] = [true, performance.now()];
    own.time = from >= figure.clock(view).end || from === text.time ? 0 : from;
    ask();
  };
  // the time that has passed since the last picture
  function goOn(now) {
    const { end, rate, loops } = figure.clock(view);
    const time = own.time + (rate * within(0, now - last, 100)) / 1000;
    [last, view.running] = [now, loops || time < end];
    own.time = loops ? time % end : Math.min(end, time);
    if (view.running) ask();
  }
  function take(set) {
    Object.assign(own, text);
    figure.draw(view); // which tells the ranges of its handles
    for (const [name, value] of Object.entries(set))
      if (fits(figure, view, name, value)) own[name] = value;
    view.stop();
  }
  const button = (words, act, pressed) => html`<button type="button" aria-pressed=${pressed ?? nothing}
    @click=${act}>${words}</button>`;
  function buttons() {
    const all = (figure.switches?.(own) ?? []).map(([words, name, value]) => {
      const on = own[name] === value;
      const next = on && typeof value === "number" ? 0 : value;
      return button(words, () => view.set({ [name]: next, time: 0 }), String(on));
    });
    if (!figure.play) return all;
    const { end, step } = figure.clock(view);
    const on = () => view.stop(view.set({ time: Math.min(end, own.time + step) }));
    return [view.running ? button("Stop", view.stop) : button(figure.play(own), () => view.play()),
      step ? button("Step", on) : "", ...all];
  }

  function draw(now) {
    frame = 0;
    if (!near) return;
    if (!begun) box.replaceChildren(); // the still
    begun = true;
    if (view.running) goOn(now);
    const { picture, words } = figure.draw(view);
    render(html`<svg class="plot" viewBox="0 0 ${view.width} ${view.height}" role="group"
      aria-label=${asked(figure.title, own)}>${picture}</svg>
      <figcaption>${captionOf(figure, view)}</figcaption><p class="words">${worded(words)}</p>
      <button type="button" class="back" title="As in the text" aria-label="As in the text"
      ?disabled=${Object.keys(text).every(same)} @click=${() => remember(take({}))}>↺</button>
      <div class="controls">${knobsOf(figure, view).map((name) => slider(view, name))}
      <div class="buttons">${buttons()}</div></div>`, box);
    for (const each of box.querySelectorAll("[role=slider], input")) // its own value, then the words
      each.setAttribute("aria-valuetext",
        `${each.nextElementSibling?.value ?? plain(Number(each.ariaValueNow))}: ${words}`);
  }
  new ResizeObserver(([{ contentRect: { width } }]) => {
    view.width = Math.max(LEAST, width);
    ask();
  }).observe(box);
  // a figure far from the window keeps its still, or waits: what runs goes on when it is back
  new IntersectionObserver((seen) => {
    near = seen[seen.length - 1].isIntersecting;
    if (!near) return;
    if (!begun && figure.clock?.(view).alone && !still) view.play();
    draw(performance.now());
  }, { rootMargin: "300px" }).observe(box);
  return take;
}
