/* Reading: numbers that can be dragged, links that set something, the live figure that takes the
 * section in sight, and on a small screen the dock in which it comes up. */
import { plain, within } from "./draw.js";
import { asked, fromSlider, grouped, QUANTITIES, sliderRange, toSlider } from "./store.js";

const KEYS = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 20, PageDown: -20 };
const VIEW = ["models", "from", "to"]; // of what the text shows, what is no quantity

export class Reader {
  // passages: [{node, section, look}] in the order of the page; look: what the live figure shows
  constructor(passages, sectionOf, lanes) {
    Object.assign(this, { passages, sectionOf, lanes, shown: null, called: null });
    this.live = document.getElementById("figure");
    this.beside = window.matchMedia("(min-width: 78rem)");
    for (const span of document.querySelectorAll(".drag")) this.#number(span);
    for (const link of document.querySelectorAll("a.try")) link.hash = sectionOf(link).id;
    document.addEventListener("click", (event) => this.#clicked(event));
    window.addEventListener("scroll", () => this.#scrolled(), { passive: true });
    this.beside.addEventListener("change", () => this.undock());
    this.follow();
  }

  #clicked(event) {
    const touched = event.target.closest("a, [data-dock], #undock, [data-take]");
    if (!touched) return;
    const { take } = touched.dataset;
    if (touched.matches("a.try")) {
      event.preventDefault();
      this.#try(touched);
    } else if (take) {
      const section = touched.closest("#figure") ? this.lanes.section : this.sectionOf(touched);
      section.set({ [take]: section.home[take] });
    } else if (touched.id === "undock") this.undock();
    else if (touched.matches("[data-dock]")) this.#glanced(touched);
    else if (touched.matches('a[href^="#"]')) showVeil(touched.hash);
  }

  // ---- what the text sets

  // A link shows what its sentence says: all else stands as in the section's text.
  #try(link) {
    const section = this.sectionOf(link);
    section.set(asked(link.search), section.home);
    this.#look(section, link.search, false);
    this.dock(link);
  }

  // A glance calls up what it shows.
  #glanced(button) {
    const { section, look } = this.passages.find(({ node }) => node.contains(button));
    this.#look(section, look, true);
    this.dock(button);
  }

  // The live figure shows a section, and of it what a query says.
  #look(section, query, anew) {
    const { lanes } = this;
    const given = new URLSearchParams(query);
    lanes.section = section;
    const own = VIEW.filter((name) => given.has(name)).map((name) => [name, given.get(name)]);
    lanes.figure.look(lanes, Object.fromEntries(own), anew);
    lanes.figure.replay(lanes);
    // the knobs that the text speaks of stand open, the others behind one word
    for (const knob of this.live.querySelectorAll(".knob"))
      knob.classList.toggle("spoken", given.has(knob.dataset.knob));
    lanes.redraw();
  }

  // The last passage that begins above a line of the window is in sight. The live figure steps back
  // where that has no use for it.
  follow() {
    const { innerHeight } = window;
    const seen = this.passages.filter(({ node }) => node.offsetParent); // not behind a veil
    const line = this.beside.matches ? 0.7 : 1; // of the window; where no figure stands, at once
    const begins = ({ node }) => node.getBoundingClientRect().top < line * innerHeight;
    const last = seen.findLast(begins) || seen[0];
    if (!last) return;
    this.live.classList.toggle("back", !last.look);
    if (last === this.shown) return;
    this.shown = last;
    if (last.look) this.#look(last.section, last.look, true);
  }

  #scrolled() {
    this.pending ||= requestAnimationFrame(() => {
      this.pending = 0;
      const far = Math.abs(window.scrollY - this.called) > 0.4 * window.innerHeight;
      if (this.called !== null && !far) return;
      this.undock();
      this.follow();
    });
  }

  // ---- what was called up stays until one has read on; on a small screen it comes up in a dock

  // Show the live figure, and keep in sight what was touched.
  dock(touched) {
    this.live.classList.remove("back");
    if (!this.beside.matches) {
      this.live.classList.add("docked");
      const hidden = touched.getBoundingClientRect().bottom - 0.45 * window.innerHeight;
      if (hidden > 0) window.scrollBy(0, hidden);
    }
    this.called = window.scrollY;
  }

  undock() {
    this.called = null;
    this.live.classList.remove("docked");
  }

  // ---- numbers to drag

  #number(span) {
    const section = this.sectionOf(span);
    const name = span.dataset.knob;
    const each = QUANTITIES[name];
    const { min, max, step } = sliderRange(each);
    const about = { role: "slider", tabindex: 0, "aria-label": each.label };
    Object.assign(about, { "aria-valuemin": each.low, "aria-valuemax": each.high });
    for (const [key, value] of Object.entries(about)) span.setAttribute(key, value);
    const held = `<button class="chip" data-take="${name}" hidden></button>`;
    span.insertAdjacentHTML("afterend", held);
    const chip = span.nextElementSibling;
    const show = () => {
      const value = section.get(name);
      span.textContent = grouped(value);
      span.setAttribute("aria-valuenow", plain(value));
      span.setAttribute("aria-valuetext", `${plain(value)} ${each.unit}`.trim());
      chip.hidden = section.values[name] === section.home[name];
      chip.textContent = `text: ${grouped(section.home[name])}`;
    };
    const position = () => toSlider(each, section.get(name));
    const turn = (from, by) =>
      section.set({ [name]: fromSlider(each, within(min, from + by * step, max)) });
    this.#grab(span, section, position, turn);
    section.on(show);
    show();
  }

  #grab(span, section, position, turn) {
    let [startX, start] = [0, 0]; // where it is grabbed
    span.addEventListener("pointerdown", (event) => {
      if (event.button > 0) return;
      event.preventDefault();
      span.focus({ preventScroll: true });
      span.setPointerCapture(event.pointerId);
      [startX, start] = [event.clientX, position()];
      this.#call(span, section);
    });
    span.addEventListener("pointermove", (event) => {
      if (span.hasPointerCapture(event.pointerId))
        turn(start, Math.round((event.clientX - startX) / 2));
    });
    span.addEventListener("keydown", (event) => {
      if (!KEYS[event.key]) return;
      event.preventDefault();
      turn(position(), KEYS[event.key]);
      this.#call(span, section);
    });
  }

  // Call the live figure to a number, if it is one of a passage that speaks of it.
  #call(span, section) {
    if (this.lanes.section !== section) {
      const passage = this.passages.find((each) => each.section === section);
      this.#look(section, passage.look || "", true);
    }
    this.dock(span);
  }
}

// Where what a link leads to waits behind a veil, its bar comes into sight.
function showVeil(hash) {
  const veil = document.getElementById(hash.slice(1))?.closest(".veiled");
  for (let each = veil; each; each = each.parentElement.closest(".veiled"))
    if (each.querySelector(":scope > .veil-bar").offsetParent)
      each.scrollIntoView({ block: "center" });
}
