/* Reading: numbers that can be dragged, links that set something, the live figure that follows the
 * text, and on a small screen the dock in which it comes up. */
import { plain } from "./draw.js";
import { fromSlider, sliderRange, toSlider } from "./store.js";

const KEYS = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 20, PageDown: -20 };
const VIEW = ["models", "chart", "from", "to"]; // of a show, what is no quantity

export class Reader {
  constructor(store, lanes) {
    Object.assign(this, { store, lanes, shown: null });
    this.marks = [...document.querySelectorAll(".show")];
    this.live = document.getElementById("figure");
    this.beside = window.matchMedia("(min-width: 64rem)");
  }

  start() {
    for (const span of document.querySelectorAll(".drag")) this.#number(span);
    for (const link of document.querySelectorAll("a.try"))
      link.addEventListener("click", (event) => {
        event.preventDefault();
        this.#set(new URLSearchParams(new URL(link.href).search), "act");
        this.dock(link);
      });
    document.addEventListener("click", (event) => this.#copy(event.target.closest("button[data-copy]")));
    for (const button of document.querySelectorAll("[data-dock]")) button.addEventListener("click", () => this.dock(button));
    document.getElementById("undock").addEventListener("click", () => this.undock());
    window.addEventListener("scroll", () => this.#scrolled(), { passive: true });
    this.beside.addEventListener("change", () => this.undock());
    this.follow(!location.search);
  }

  // ---- what the text sets

  // Set the quantities of a query in the store, and the rest in the live figure.
  #set(given, how) {
    const changes = this.store.asked(given);
    if (how === "act") {        // a link shows what its sentence says: all else stands as in the chapter
      this.store.set(this.store.chapter(changes.scene || this.store.get("scene")), "text");
      this.store.set(changes);
    }
    else this.store.follow(changes);
    const own = Object.fromEntries(VIEW.filter((name) => given.has(name)).map((name) => [name, given.get(name)]));
    this.lanes.figure.look(this.lanes.view, own, how === "text");
    this.lanes.figure.replay(this.lanes.view);
    this.#spoken([...given.keys()]);
    this.lanes.redraw();
  }

  // The knobs that the text speaks of stand open, the others behind one word.
  #spoken(names) {
    for (const knob of this.live.querySelectorAll(".knob")) knob.classList.toggle("spoken", names.includes(knob.dataset.knob));
  }

  // The last mark above the middle of the window says what is shown.
  follow(set = true) {
    const seen = this.marks.filter((mark) => mark.offsetParent); // not behind a veil
    const mark = seen.findLast((each) => each.getBoundingClientRect().top < 0.55 * window.innerHeight) || seen[0];
    if (!mark || mark === this.shown) return;
    this.shown = mark;
    this.live.classList.toggle("back", mark.dataset.show === "none");
    if (set && mark.dataset.show !== "none") this.#set(new URLSearchParams(mark.dataset.show), "text");
  }

  #scrolled() {
    this.pending ||= requestAnimationFrame(() => {
      this.pending = 0;
      this.follow();
      if (this.docked !== undefined && Math.abs(window.scrollY - this.docked) > 0.4 * window.innerHeight) this.undock();
    });
  }

  // ---- the dock: half the window, and it closes as one reads on

  // Open it, and keep in sight what was touched.
  dock(touched) {
    this.live.classList.remove("back");
    if (this.beside.matches) return;
    this.live.classList.add("docked");
    const hidden = touched.getBoundingClientRect().bottom - 0.45 * window.innerHeight;
    if (hidden > 0) window.scrollBy(0, hidden);
    this.docked = window.scrollY;
  }

  undock() {
    this.docked = undefined;
    this.live.classList.remove("docked");
  }

  // ---- numbers to drag

  #number(span) {
    const { store } = this;
    const name = span.dataset.knob;
    const each = store.quantities[name];
    const unit = each.unit ? ` ${each.unit}` : "";
    const about = { role: "slider", tabindex: "0", "aria-valuemin": each.low, "aria-valuemax": each.high };
    for (const [key, value] of Object.entries(about)) span.setAttribute(key, value);
    span.setAttribute("aria-label", each.label);
    const show = () => {
      span.textContent = store.get(name) < 1e4 ? plain(store.get(name)) : store.get(name).toLocaleString("en");
      span.setAttribute("aria-valuenow", plain(store.get(name)));
      span.setAttribute("aria-valuetext", plain(store.get(name)) + unit);
    };
    const range = sliderRange(each);
    const turn = (from, by, how) => {
      const position = Math.min(range.max, Math.max(range.min, from + by * range.step));
      store.set({ [name]: fromSlider(each, position) }, how);
    };
    this.#grab(span, () => toSlider(each, store.get(name)), turn);
    store.on([name], show);
    show();
  }

  #grab(span, position, turn) {
    let [startX, from] = [0, 0];
    span.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      span.focus({ preventScroll: true });
      span.setPointerCapture(event.pointerId);
      [startX, from] = [event.clientX, position()];
      this.store.drag(true);
      this.dock(span);
    });
    span.addEventListener("pointermove", (event) => {
      if (span.hasPointerCapture(event.pointerId)) turn(from, Math.round((event.clientX - startX) / 2), "drag");
    });
    for (const end of ["pointerup", "pointercancel"]) span.addEventListener(end, () => this.store.drag(false));
    span.addEventListener("keydown", (event) => {
      if (!KEYS[event.key]) return;
      event.preventDefault();
      turn(position(), KEYS[event.key], "act");
      this.dock(span);
    });
  }

  #copy(button) {
    if (!button) return;
    const text = [...button.closest(".code").querySelectorAll("pre")].map((pre) => pre.textContent).join("\n\n");
    const said = document.getElementById("said");
    navigator.clipboard.writeText(text).then(
      () => (said.textContent = "Copied."),
      () => (said.textContent = "The browser does not let the page copy."),
    );
  }
}
