/* Reading: numbers that can be dragged, links that set something, the live figure that follows the
 * text, and on a small screen the dock in which it comes up. */
import { plain } from "./draw.js";
import { fromSlider, sliderRange, startOf, toSlider } from "./store.js";

const KEYS = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 20, PageDown: -20 };
const VIEW = ["models", "chart", "from", "to"]; // of what the text shows, what is no quantity

export class Reader {
  constructor(store, lanes) {
    Object.assign(this, { store, lanes, shown: null, called: null });
    this.marks = [...document.querySelectorAll(".show")];
    this.wide = [...document.querySelectorAll(".fig.alone")];
    this.live = document.getElementById("figure");
    this.beside = window.matchMedia("(min-width: 64rem)");
    for (const span of document.querySelectorAll(".drag")) this.#number(span);
    document.addEventListener("click", (event) => this.#clicked(event));
    window.addEventListener("scroll", () => this.#scrolled(), { passive: true });
    this.beside.addEventListener("change", () => this.undock());
    this.follow(!location.search);
  }

  #clicked(event) {
    const touched = event.target.closest("a.try, [data-dock], #undock, [data-copy]");
    if (!touched) return;
    if (touched.matches("a.try")) {
      event.preventDefault();
      this.#set(new URLSearchParams(new URL(touched.href).search), "act");
    }
    if (touched.matches("[data-copy]")) this.#copy(touched.closest(".code"));
    else if (touched.id === "undock") this.undock();
    else this.dock(touched);
  }

  // ---- what the text sets

  // Set the quantities of a query in the store, and the rest in the live figure.
  #set(given, how) {
    const { store, lanes } = this;
    const changes = store.asked(given);
    if (how === "act") {
      // a link shows what its sentence says: all else stands as in the chapter
      store.set(startOf(changes.scene || store.get("scene")), "text");
      store.set(changes);
    } else store.follow(changes);
    const own = VIEW.filter((name) => given.has(name)).map((name) => [name, given.get(name)]);
    lanes.figure.look(lanes, Object.fromEntries(own), how === "text");
    lanes.figure.replay(lanes);
    // the knobs that the text speaks of stand open, the others behind one word
    for (const knob of this.live.querySelectorAll(".knob"))
      knob.classList.toggle("spoken", given.has(knob.dataset.knob));
    lanes.redraw();
  }

  // The last mark above a line of the window says what is shown; and nothing is, while a figure
  // that takes the whole width is in sight.
  follow(set = true) {
    const { innerHeight } = window;
    const place = (each) => each.getBoundingClientRect();
    const seen = this.marks.filter((mark) => mark.offsetParent); // not behind a veil
    const line = this.beside.matches ? 0.7 : 1; // of the window; where no figure stands, at once
    const mark = seen.findLast((each) => place(each).top < line * innerHeight) || seen[0];
    if (!mark) return;
    const over = (box) => box.height > 0 && box.top < innerHeight && box.bottom > 0;
    const back = mark.dataset.show === "none" || this.wide.some((each) => over(place(each)));
    this.live.classList.toggle("back", back);
    if (mark === this.shown) return;
    this.shown = mark;
    if (set && mark.dataset.show !== "none")
      this.#set(new URLSearchParams(mark.dataset.show), "text");
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
    const { store } = this;
    const name = span.dataset.knob;
    const each = store.quantities[name];
    const range = sliderRange(each);
    const about = { role: "slider", tabindex: 0, "aria-label": each.label };
    Object.assign(about, { "aria-valuemin": each.low, "aria-valuemax": each.high });
    for (const [key, value] of Object.entries(about)) span.setAttribute(key, value);
    const show = () => {
      const value = store.get(name);
      span.textContent = value < 1e4 ? plain(value) : value.toLocaleString("en");
      span.setAttribute("aria-valuenow", plain(value));
      span.setAttribute("aria-valuetext", `${plain(value)} ${each.unit}`.trim());
    };
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
      if (!span.hasPointerCapture(event.pointerId)) return;
      turn(from, Math.round((event.clientX - startX) / 2), "drag");
    });
    for (const end of ["pointerup", "pointercancel"])
      span.addEventListener(end, () => this.store.drag(false));
    span.addEventListener("keydown", (event) => {
      if (!KEYS[event.key]) return;
      event.preventDefault();
      turn(position(), KEYS[event.key], "act");
      this.dock(span);
    });
  }

  // The code as it stands in the file.
  #copy(code) {
    const text = [...code.querySelectorAll("pre")].map((pre) => pre.textContent).join("\n\n");
    const said = document.getElementById("said");
    navigator.clipboard.writeText(text).then(
      () => (said.textContent = "Copied."),
      () => (said.textContent = "The browser does not let the page copy."),
    );
  }
}
