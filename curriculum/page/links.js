/* The text drives the figure: links that set its state, and numbers that can be dragged. Where the
 * figure does not stand beside the text, it comes up in a dock at the foot of the window. */
"use strict";

const Links = (() => {
  const { plain } = Plot;
  const root = document.getElementById("figure");
  const beside = window.matchMedia("(min-width: 64rem)");

  function dock() {
    if (beside.matches) return;
    const box = root.getBoundingClientRect();
    if (box.top < window.innerHeight * 0.4 && box.bottom > window.innerHeight * 0.6) return; // in sight
    root.parentElement.style.minHeight = `${box.height}px`;
    root.classList.add("docked");
  }

  function undock() {
    root.classList.remove("docked");
    root.parentElement.style.minHeight = "";
  }

  // ---- numbers that can be dragged

  function write(span, value) {
    span.dataset.value = String(value);
    span.textContent = plain(value);
    span.setAttribute("aria-valuenow", plain(value));
    span.setAttribute("aria-valuetext", `${plain(value)} ${State.KNOBS[span.dataset.knob].unit}`.trim());
  }

  // Move a number by some positions of its knob's slider, and the figure with it.
  function turn(span, from, by) {
    const name = span.dataset.knob;
    const range = State.sliderRange(State.KNOBS[name]);
    const position = Math.min(range.max, Math.max(range.min, from + by * range.step));
    const value = State.fromSlider(name, position);
    if (value === Number(span.dataset.value)) return;
    write(span, value);
    dock();
    Figure.set({ [name]: value });
  }

  const position = (span) => State.toSlider(span.dataset.knob, Number(span.dataset.value));

  function listenDrag(span) {
    let [startX, start] = [0, 0];
    span.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      span.focus({ preventScroll: true });
      span.setPointerCapture(event.pointerId);
      [startX, start] = [event.clientX, position(span)];
    });
    span.addEventListener("pointermove", (event) => {
      if (span.hasPointerCapture(event.pointerId))
        turn(span, start, Math.round((event.clientX - startX) / 2));
    });
    span.addEventListener("keydown", (event) => {
      const by = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 20, PageDown: -20 }[
        event.key
      ];
      if (!by) return;
      event.preventDefault();
      turn(span, position(span), by);
    });
  }

  function startDrag(span) {
    const knob = State.KNOBS[span.dataset.knob];
    const about = { role: "slider", tabindex: "0", "aria-valuemin": knob.low, "aria-valuemax": knob.high };
    for (const [name, value] of Object.entries(about)) span.setAttribute(name, value);
    span.setAttribute("aria-label", `${span.dataset.knob}: drag, or use the arrow keys`);
    span.title = "Drag to change";
    write(span, Number(span.dataset.value));
    listenDrag(span);
  }

  function start() {
    for (const link of document.querySelectorAll("a.try"))
      link.addEventListener("click", (event) => {
        event.preventDefault();
        Figure.follow(new URL(link.href, location.href).search);
        dock();
      });
    for (const span of document.querySelectorAll("span.drag")) startDrag(span);
    for (const button of document.querySelectorAll("button[data-dock]"))
      button.addEventListener("click", dock);
    document.getElementById("undock").addEventListener("click", undock);
    beside.addEventListener("change", undock);
    window.addEventListener("beforeprint", undock);
  }

  return { start, dock, undock };
})();
