/* The stage: it puts a figure into the page, hands it drags and arrow keys, and runs its clock.
 *
 * A figure is a plain object and touches no document, so the still picture that a reader without
 * scripts sees is the same drawing. figures/NAME.js has `export const figure = {...}`, or
 * `export const figures = {name: {...}}` where several have one form:
 *
 *   title, caption   its name in words; one sentence below it
 *   height, narrow   px; of the drawing, and of one narrower than 480 px
 *   knobs            names of the quantities that stand as sliders below it
 *   start()          its own state, a plain object: view.own
 *   draw(view)       {svg, words, handles, lit}; svg is text, words what is seen, in one sentence;
 *                    lit: names of LINES (lines.js), the lines of code that run now
 *   clock(view)      {from, end, rate, name}: own.time (null: not begun) runs from `from` to `end`,
 *                    `rate` s in a second, once the button of that name is pressed
 *   tick(view, s)    in place of a clock: so many real seconds passed; false ends it
 *   buttons          [[label, press(view)]]; the label may be a function of the view
 *
 * A handle is {name, x, y, label, value, text, drag(x, y), nudge(dx, dy), release()}: what can be
 * grabbed, mostly made by `grip` in kit.js. dx and dy are those of an arrow key, ten times as
 * much with shift; release() is called when it is let go, and at Enter.
 *   r      of a ball: all of it is grabbed; without r it is a point, and gets a knob
 *   hold   [x, y]: where drag(x, y) starts from, if that is not the middle
 * Whatever is drawn as `ball` must have a handle over it; what cannot be grabbed is drawn as
 * "seen", "body" or "ghost". The view is the stage. */
import { escape, inSentence, plain } from "./draw.js";
import { fitting, fromSlider, QUANTITIES, shown, sliderRange, toSlider } from "./store.js";

const NARROW = 480; // px: from this width on a drawing is wide
export const LEAST = 358; // px: on a screen smaller than a phone's it is drawn so, and made smaller
const NEAR = 600; // px beyond the window in which figures are drawn

export const heightOf = (figure, width) => (width < NARROW && figure.narrow) || figure.height;

// The view of a figure that nobody touches and that does not run: for the stills.
export const stillView = (figure, values, width) => ({
  own: figure.start ? figure.start() : {},
  values,
  width,
  height: heightOf(figure, width),
  get: (name) => shown(values, name),
  open: () => false,
});

// The buttons of a figure, that of its clock first.
export function buttonsOf({ clock, buttons = [] }) {
  const label = (view) => (view.running ? "Stop" : clock(view).name);
  const press = (view) => (view.running ? view.stop() : view.play());
  return clock ? [[label, press], ...buttons] : buttons;
}

// ---- handles

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const SVG = "http://www.w3.org/2000/svg";
const KNOB = 8; // px, of a point; the style gives it a halo of 22 px

// The handles of a drawing: shapes above it that stay when it is drawn anew, so that focus stays.
function showHandles(layer, handles) {
  const held = new Map([...layer.children].map((node) => [node.dataset.handle, node]));
  for (const handle of handles) {
    const { name, x, y, r, label, value, text } = handle;
    const node = held.get(name) || layer.appendChild(document.createElementNS(SVG, "circle"));
    held.delete(name);
    const about = {
      class: r ? "handle" : "handle point",
      cx: x,
      cy: y,
      r: r || KNOB,
      role: "slider",
      tabindex: 0,
      "aria-label": label,
      "aria-valuenow": Math.abs(value) < 1e-6 ? 0 : plain(value), // it may have no exponent
      "aria-valuetext": text,
      "data-handle": name,
    };
    for (const [key, wanted] of Object.entries(about))
      if (node.getAttribute(key) !== String(wanted)) node.setAttribute(key, wanted);
  }
  for (const node of held.values()) node.remove();
}

// ---- knobs: a slider and a number for one quantity

let knobs = 0;
function mountKnob(box, name, stage) {
  const each = QUANTITIES[name];
  const id = `knob-${++knobs}`;
  const { min, max, step } = sliderRange(each);
  const what = escape(each.label);
  box.insertAdjacentHTML(
    "beforeend",
    `<div class="knob" data-knob="${name}"><label for="${id}">${what}</label>
    <input type="range" id="${id}" min="${min}" max="${max}" step="${step}"><span class="field">
    <input type="text" inputmode="decimal" size="8" autocomplete="off"
    aria-label="${what}, as a number"> <span class="unit">${each.unit}</span></span></div>`,
  );
  const [range, field] = box.lastElementChild.querySelectorAll("input");
  const show = () => {
    const value = stage.section.get(name);
    range.value = toSlider(each, value);
    range.setAttribute("aria-valuetext", `${plain(value)} ${each.unit}`.trim());
    if (document.activeElement !== field) field.value = plain(value);
    field.removeAttribute("aria-invalid");
  };
  range.addEventListener("change", stage.redraw); // it is let go
  const turn = () => stage.set({ [name]: fromSlider(each, Number(range.value)) });
  range.addEventListener("input", turn);
  field.addEventListener("change", () => {
    const value = Number(field.value.replace(",", "."));
    const fits = field.value.trim() !== "" && value === fitting(each, value);
    if (fits) stage.set({ [name]: value });
    else field.setAttribute("aria-invalid", "true");
    field.title = fits ? "" : `${each.label}: ${each.low} to ${each.high}`;
  });
  field.addEventListener("blur", show);
  show();
  return show;
}

// ---- a figure in the page

/* A live figure in `box`, which holds .drawing with an svg, .words, .knobs and .buttons, as the
 * template makes them. page: {still, open(bet), light(name, lines)}; `section` is the one in which
 * it stands, whose values it shows. Figures use own, get(),
 * values, set(changes), width, height, play(), run(), stop(), running, flick(), still (nothing may
 * move by itself), dragging, grabbed (the name of the handle that is held), from (that handle as it
 * was when it was grabbed), open(bet). */
export class Stage {
  width = 0;
  height = 0;
  running = false;
  grabbed = null;
  #handles = [];
  #pending = 0;
  #last = 0; // ms, of the last frame
  #pointer = null; // that holds a handle: another finger moves nothing
  #trail = []; // of the pointer: [ms, x, y]

  constructor(box, name, figure, page, section) {
    const { open, still } = page;
    Object.assign(this, { box, name, figure, page, open, still, section });
    this.uses = new Set(figure.knobs); // quantities that it has asked for
    this.own = figure.start ? figure.start() : {};
    this.svg = box.querySelector(".drawing svg");
    this.words = box.querySelector(".words");
    const knobs = box.querySelector(".knobs");
    this.knobs = (figure.knobs || []).map((knob) => mountKnob(knobs, knob, this));
    this.buttons = buttonsOf(figure).map((button) => this.#button(button));
    this.#listen();
    new ResizeObserver(() => this.#resize()).observe(this.svg.parentElement);
    // a figure far from the window keeps its picture and does not run
    const seen = ([{ isIntersecting: near }]) => {
      this.near = near;
      if (near) this.redraw();
      else this.stop();
    };
    new IntersectionObserver(seen, { rootMargin: `${NEAR}px` }).observe(box);
  }

  get values() {
    return this.section.values;
  }

  get dragging() {
    return this.grabbed !== null || this.box.querySelector("input:active") !== null;
  }

  get = (name) => this.section.get(this.uses.add(name) && name);
  set = (changes) => this.section.set(changes);

  #resize() {
    const { clientWidth, clientHeight } = this.svg.parentElement; // the style says how high
    this.scale = Math.max(1, LEAST / (clientWidth || LEAST)); // of the drawing to the screen
    Object.assign(this, { width: this.scale * clientWidth, height: this.scale * clientHeight });
    this.draw(); // at once: the picture may not lag behind its frame
  }

  #button([label, press]) {
    const node = document.createElement("button");
    node.type = "button";
    node.addEventListener("click", () => {
      press(this);
      this.redraw();
    });
    this.box.querySelector(".buttons").append(node);
    const show = () => (node.textContent = typeof label === "function" ? label(this) : label);
    show();
    return show;
  }

  // ---- hands

  #listen() {
    const { svg } = this;
    svg.addEventListener("pointerdown", (event) => this.#grab(event));
    // a finger: within an SVG the style cannot say that a handle is no place to scroll from
    const stay = (event) => this.#handle(event.target.dataset.handle) && event.preventDefault();
    svg.addEventListener("touchstart", stay, { passive: false });
    svg.addEventListener("pointermove", (event) => this.#drag(event));
    for (const end of ["pointerup", "pointercancel"])
      svg.addEventListener(end, (event) => event.pointerId === this.#pointer && this.#letGo());
    svg.addEventListener("keydown", (event) => this.#key(event));
  }

  #handle = (name) => this.#handles.find((each) => each.name === name);

  #grab(event) {
    const handle = this.#handle(event.target.dataset.handle);
    if (!handle || event.button > 0 || this.grabbed !== null) return;
    event.preventDefault();
    event.target.focus({ preventScroll: true });
    this.#pointer = event.pointerId;
    this.svg.setPointerCapture(this.#pointer);
    this.grabbed = handle.name;
    this.from = handle;
    const [x, y] = handle.hold || [handle.x, handle.y];
    this.aside = [x - this.scale * event.clientX, y - this.scale * event.clientY]; // of the pointer
    this.#trail = [];
    if (this.figure.clock) this.stop();
    this.#drag(event);
  }

  #drag(event) {
    if (event.pointerId !== this.#pointer) return;
    const [x, y] = [event.clientX, event.clientY].map((at, k) => this.scale * at + this.aside[k]);
    this.#trail = [...this.#trail.slice(-4), [performance.now(), x, y]];
    this.#handle(this.grabbed)?.drag(x, y);
    this.redraw();
  }

  #letGo() {
    const handle = this.#handle(this.grabbed);
    this.grabbed = this.#pointer = null;
    handle?.release?.();
    this.redraw();
  }

  #key(event) {
    const handle = this.#handle(event.target.dataset.handle);
    const by = ARROWS[event.key]?.map((way) => (event.shiftKey ? 10 * way : way));
    const lets = event.key === "Enter" || event.key === " ";
    if (!handle || !(by || lets) || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    if (by) handle.nudge(...by);
    else handle.release?.();
    this.redraw();
  }

  // How fast a handle was let go, in px a second: 0 if it was held still.
  flick() {
    const [first, last] = [this.#trail[0], this.#trail[this.#trail.length - 1]];
    const span = first ? last[0] - first[0] : 0;
    if (span < 15 || performance.now() - last[0] > 100) return [0, 0];
    return [1, 2].map((k) => (1000 * (last[k] - first[k])) / span);
  }

  // ---- drawing

  redraw = () => (this.#pending ||= requestAnimationFrame(() => this.draw()));

  draw() {
    this.#pending = 0;
    if (!this.width || !this.near) return;
    const { svg, words, figure } = this;
    if (!svg.querySelector(":scope > .made")) svg.innerHTML = '<g class="made"></g><g></g>';
    const made = figure.draw(this);
    this.#handles = made.handles || [];
    svg.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
    svg.setAttribute("aria-label", `${figure.title}. ${made.words}`);
    svg.children[0].innerHTML = made.svg;
    showHandles(svg.children[1], this.#handles);
    for (const show of [...this.buttons, ...this.knobs]) show();
    this.#showChips();
    if (made.lit) this.page.light(this.name, made.lit);
    if (this.said !== made.words) words.innerHTML = inSentence(made.words);
    this.said = made.words;
  }

  // What differs from the text, each with a click that takes it back.
  #showChips() {
    const shown = ([name]) => name === "scene" || this.uses.has(name);
    const html = this.section.inWords().filter(shown).map(([name, words]) =>
      `<button type="button" class="chip" data-take="${name}" title="Take it back">` +
      `${escape(words)}</button>`).join("");
    const chips = this.box.querySelector(".chips");
    if (chips.innerHTML !== html) chips.innerHTML = html;
  }

  // ---- time

  // Run the figure's clock: on from where it stopped, or from its start.
  play = () => {
    const { from = 0, end } = this.figure.clock(this);
    const { own } = this;
    if (own.time === null || own.time >= end) own.time = from;
    if (this.still) own.time = end;
    else this.run();
  };

  run() {
    if (this.running) return;
    this.running = true;
    this.#last = performance.now();
    requestAnimationFrame((stamp) => this.#frame(stamp));
  }

  stop = () => (this.running = false);

  #frame(stamp) {
    const seconds = Math.min(0.1, Math.max(0, (stamp - this.#last) / 1000));
    this.#last = stamp;
    if (this.running) this.running = this.#tick(seconds);
    this.draw();
    if (this.running) requestAnimationFrame((next) => this.#frame(next));
  }

  #tick(seconds) {
    const { figure, own } = this;
    if (!figure.clock) return figure.tick(this, seconds) !== false;
    const { end, rate } = figure.clock(this);
    if (own.time === null) return false;
    own.time = Math.min(end, own.time + rate * seconds);
    return own.time < end;
  }
}
