/* The stage: it puts a figure into the page, hands it drags and arrow keys, and runs its clock.
 *
 * A figure is a plain object and touches no document, so the still picture that a reader without
 * scripts sees is the same drawing. curriculum/page/figures/NAME.js has `export const figure = {...}`:
 *
 *   title, caption   its name in words; one sentence below it
 *   height, narrow   px; of the drawing, and where it is narrower than 480 px (`height` if left out)
 *   knobs            names of the quantities that stand as sliders below it, at most two
 *   uses             names of further quantities that it shows
 *   quantities       quantities that it brings along: {name: {low, high, ..., start}}
 *   start(values)    its own state, a plain object (what belongs to no quantity: a time, a height)
 *   draw(view)       {svg, words, handles, lit}; svg is text, words what is seen, in one sentence;
 *                    handles: [{name, x, y, r, label, value, text}] can be grabbed;
 *                    lit: [[region, text of a line]], the lines of code that run now
 *   drag(view, name, x, y)      a handle is at (x, y) of the drawing; also the first time, on grabbing
 *   nudge(view, name, dx, dy)   an arrow key: dx, dy are -1, 0 or 1, ten times that with shift
 *   release(view, name)         it was let go; enter(view): Enter or space on the handle
 *   tick(view, seconds)         so many real seconds passed; false stops the clock
 *   buttons          [{label, press(view)}]; label may be a function of the view
 *   jobs             {name(args)}: what takes long, computed in a worker (view.result)
 *
 * The view: {own, values, get(name), set(changes), width, height, run(), stop(), running(), still, coarse,
 * grabbed, flick(), result(job, args), open(bet)}. `still`: nothing may move by itself. `coarse`: a drag is under way. */
import { escape, plain } from "./draw.js";
import { fitting, fromSlider, shown, sliderRange, toSlider } from "./store.js";

const NARROW = 480; // px: from this width on a drawing is wide
const NEAR = 600; // px beyond the window in which figures are drawn

export const heightOf = (figure, width) => (width < NARROW && figure.narrow) || figure.height;
export const namesOf = (figure) => [
  ...(figure.knobs || []),
  ...(figure.uses || []),
  ...Object.keys(figure.quantities || {}),
];

// The view of a figure whose drawing stays as it is: for the stills.
export function stillView(figure, values, width) {
  const view = {
    own: figure.start ? figure.start(values) : {},
    values,
    get: (name) => shown(values, name),
    set: () => {},
    width,
    height: heightOf(figure, width),
    run: () => {},
    stop: () => {},
    running: () => false,
    still: true,
    coarse: false,
    grabbed: null,
    result: (job, args) => figure.jobs[job](args),
    open: () => false,
  };
  return view;
}

// ---- grabbing

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const SVG = "http://www.w3.org/2000/svg";

// The handles of a drawing: circles above it that stay when it is drawn anew, so that focus stays.
function showHandles(layer, handles) {
  const held = new Map([...layer.children].map((node) => [node.dataset.handle, node]));
  for (const { name, x, y, r, label, value, text } of handles) {
    const node = held.get(name) || layer.appendChild(document.createElementNS(SVG, "circle"));
    held.delete(name);
    const about = { class: "handle", role: "slider", tabindex: 0, cx: x, cy: y, r: Math.max(r, 14) };
    Object.assign(about, { "aria-label": label, "aria-valuenow": plain(value), "aria-valuetext": text });
    for (const [key, wanted] of Object.entries(about))
      if (node.getAttribute(key) !== String(wanted)) node.setAttribute(key, wanted);
    node.dataset.handle = name;
  }
  for (const node of held.values()) node.remove();
}

// Mouse, touch and arrow keys on the handles of `svg`. `on` has grab, drag, release and nudge.
export function listenDrag(svg, sizeOf, on) {
  let name = null;
  const place = (event) => {
    const box = svg.getBoundingClientRect();
    const { width, height } = sizeOf();
    return [((event.clientX - box.left) * width) / box.width, ((event.clientY - box.top) * height) / box.height];
  };
  svg.addEventListener("pointerdown", (event) => {
    const handle = event.target.closest("[data-handle]");
    if (!handle || event.button > 0) return;
    event.preventDefault();
    handle.focus({ preventScroll: true });
    svg.setPointerCapture(event.pointerId);
    name = handle.dataset.handle;
    on.grab(name, ...place(event));
  });
  svg.addEventListener("pointermove", (event) => name !== null && on.drag(name, ...place(event)));
  const end = () => {
    if (name === null) return;
    const held = name;
    name = null;
    on.release(held);
  };
  svg.addEventListener("pointerup", end);
  svg.addEventListener("pointercancel", end);
  svg.addEventListener("keydown", (event) => {
    const handle = event.target.closest("[data-handle]");
    const arrow = ARROWS[event.key];
    if (handle && (event.key === "Enter" || event.key === " ")) {
      event.preventDefault();
      on.enter(handle.dataset.handle);
    }
    if (!handle || !arrow || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    const by = event.shiftKey ? 10 : 1;
    on.nudge(handle.dataset.handle, by * arrow[0], by * arrow[1]);
  });
}

// ---- knobs: a slider and a number for one quantity

let knobs = 0;
export function mountKnob(box, name, store) {
  const each = store.quantities[name];
  const id = `knob-${++knobs}`;
  const { min, max, step } = sliderRange(each);
  box.insertAdjacentHTML(
    "beforeend",
    `<div class="knob" data-knob="${name}"><label for="${id}">${escape(each.label)}</label>` +
      `<input type="range" id="${id}" min="${min}" max="${max}" step="${step}">` +
      `<span class="field"><input type="text" inputmode="decimal" size="8" autocomplete="off" aria-label="${escape(each.label)}, as a number"> ` +
      `<span class="unit">${each.unit || ""}</span></span></div>`,
  );
  const [range, field] = box.lastElementChild.querySelectorAll("input");
  const show = () => {
    const value = store.get(name);
    range.value = toSlider(each, value);
    range.setAttribute("aria-valuetext", `${plain(value)} ${each.unit || ""}`.trim());
    if (document.activeElement !== field) field.value = plain(value);
    field.removeAttribute("aria-invalid");
  };
  range.addEventListener("pointerdown", () => store.drag(true));
  for (const end of ["pointerup", "pointercancel", "blur"]) range.addEventListener(end, () => store.drag(false));
  range.addEventListener("input", () =>
    store.set({ [name]: fromSlider(each, Number(range.value)) }, store.dragging() ? "drag" : "act"),
  );
  field.addEventListener("change", () => {
    const value = Number(field.value.replace(",", "."));
    const fits = field.value.trim() !== "" && value === fitting(each, value);
    if (fits) store.set({ [name]: value });
    else field.setAttribute("aria-invalid", "true");
    field.title = fits ? "" : `${each.label}: ${each.low} to ${each.high}`;
  });
  field.addEventListener("blur", show);
  store.on([name], show);
  show();
}

// ---- a figure in the page

/* A live figure in `box`, which holds .drawing with an svg, .words, .knobs and .buttons, as the template
 * makes them. page: {store, still, worker(figure, job, args, done), open(bet), light(name, lines)}. */
export class Stage {
  #results = new Map();
  #pending = 0;
  #running = false;
  #last = 0;
  #trail = []; // of the pointer: [ms, x, y]

  constructor(box, name, figure, page) {
    Object.assign(this, { box, name, figure, page, width: 0, height: 0 });
    this.svg = box.querySelector(".drawing svg");
    this.words = box.querySelector(".words");
    this.view = this.#makeView();
    listenDrag(this.svg, () => this.view, this.#hands());
    for (const knob of figure.knobs || []) mountKnob(box.querySelector(".knobs"), knob, page.store);
    this.buttons = (figure.buttons || []).map((button) => this.#button(button));
    page.store.on(namesOf(figure), this.redraw);
    new ResizeObserver(() => this.resize()).observe(this.svg.parentElement);
    const seen = ([{ isIntersecting }]) => this.#sight(isIntersecting);
    new IntersectionObserver(seen, { rootMargin: `${NEAR}px` }).observe(box);
  }

  // A figure far from the window keeps its picture and does not run; near it, it is drawn.
  #sight(near) {
    this.near = near;
    if (near) this.redraw();
    else this.#running = false;
  }

  #makeView() {
    const { figure, page } = this;
    const { store } = page;
    const stage = this;
    return {
      own: figure.start ? figure.start(store.all()) : {},
      box: this.box,
      grabbed: null,
      still: page.still,
      open: page.open,
      reset: () => store.reset(),
      get: store.get,
      set: (changes) => store.set(changes, store.dragging() ? "drag" : "act"),
      run: () => this.run(),
      stop: () => (this.#running = false),
      running: () => this.#running,
      flick: () => this.#flick(),
      result: (job, args) => this.result(job, args),
      get values() {
        return store.all();
      },
      get coarse() {
        return store.dragging();
      },
      get width() {
        return stage.width;
      },
      get height() {
        return stage.height;
      },
    };
  }

  // What drags and arrow keys do.
  #hands() {
    const { store } = this.page;
    return {
      grab: (handle, x, y) => {
        this.view.grabbed = handle;
        this.#trail = [];
        store.drag(true);
        this.#act("drag", handle, x, y);
      },
      drag: (handle, x, y) => {
        this.#trail = [...this.#trail.slice(-4), [performance.now(), x, y]];
        this.#act("drag", handle, x, y);
      },
      release: (handle) => {
        this.view.grabbed = null;
        this.#act("release", handle);
        store.drag(false);
      },
      nudge: (handle, dx, dy) => this.#act("nudge", handle, dx, dy),
      enter: (handle) => this.#act("enter", handle),
    };
  }

  // How fast a handle was let go, in px a second: 0 if it was held still.
  #flick() {
    const [first, last] = [this.#trail[0], this.#trail[this.#trail.length - 1]];
    const span = first ? last[0] - first[0] : 0;
    if (span < 15 || performance.now() - last[0] > 100) return [0, 0];
    return [1, 2].map((k) => (1000 * (last[k] - first[k])) / span);
  }

  #act(call, ...given) {
    if (this.figure[call]) this.figure[call](this.view, ...given);
    this.redraw();
  }

  #button({ label, press }) {
    const node = document.createElement("button");
    node.type = "button";
    node.addEventListener("click", () => {
      press(this.view);
      this.redraw();
    });
    this.box.querySelector(".buttons").append(node);
    const show = () => (node.textContent = typeof label === "function" ? label(this.view) : label);
    show();
    return show;
  }

  resize() {
    const { clientWidth, clientHeight } = this.svg.parentElement;
    Object.assign(this, { width: clientWidth, height: clientHeight }); // the style says how high
    this.draw(); // at once: the picture may not lag behind its frame
  }

  redraw = () => (this.#pending ||= requestAnimationFrame(() => this.draw()));

  draw() {
    this.#pending = 0;
    if (!this.width || !this.near) return;
    if (!this.svg.querySelector(":scope > .made")) this.svg.innerHTML = '<g class="made"></g><g></g>';
    const made = this.figure.draw(this.view);
    const [layer, handles] = this.svg.children;
    this.svg.setAttribute("viewBox", `0 0 ${this.width} ${this.view.height}`);
    layer.innerHTML = made.svg;
    showHandles(handles, made.handles || []);
    for (const show of this.buttons) show();
    if (made.lit) this.page.light(this.name, made.lit);
    this.svg.setAttribute("aria-label", `${this.figure.title}. ${made.words || ""}`);
    if (this.words.textContent !== made.words) this.words.textContent = made.words || "";
  }

  run() {
    if (this.#running || !this.figure.tick) return;
    this.#running = true;
    this.#last = performance.now();
    requestAnimationFrame((stamp) => this.#frame(stamp));
  }

  #frame(stamp) {
    const seconds = Math.min(0.1, Math.max(0, (stamp - this.#last) / 1000));
    this.#last = stamp;
    if (this.#running) this.#running = this.figure.tick(this.view, seconds) !== false && this.#running;
    this.draw();
    if (this.#running) requestAnimationFrame((next) => this.#frame(next));
  }

  // What a job of the figure gives for these arguments: now, or the last that is known (null: nothing
  // yet) and the figure is drawn again when it is there.
  result(job, args) {
    const key = JSON.stringify(args);
    const held = this.#results.get(job) || { value: null };
    if (held.wanted !== key) {
      this.#results.set(job, { ...held, wanted: key });
      this.page.worker(this.name, job, args, (value) => {
        if (this.#results.get(job).wanted !== key) return;
        this.#results.set(job, { wanted: key, value });
        this.redraw();
      });
    }
    return this.#results.get(job).value;
  }
}
