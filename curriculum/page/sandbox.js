/* The sandbox: throw balls, build a stack, choose the model. The step is the one the reader has read. */
"use strict";

const Sandbox = (() => {
  const { ball, table, number } = Plot;
  const $ = (id) => document.getElementById(id);
  const R = PAGE.radius;
  const MOST = 24; // balls
  const HEIGHT = 300; // pixels
  const SCALE = 150; // pixels a metre
  const FLOOR = HEIGHT - 22;
  let width = 560;
  let model = "soft";
  let state = { x: [], y: [], vx: [], vy: [] };
  let held = null; // {i, x, y}: the ball under the pointer, and where it is wanted
  let running = false;
  let last = 0;

  const sceneOf = () => {
    const same = (value) => state.y.map(() => value);
    return { mass: same(1), radius: same(R), restitution: Number($("sandbox-e").value) / 100, damping: 80 };
  };
  const knobsOf = () => ({ ...PAGE.defaults, damping: 80, restitution: Number($("sandbox-e").value) / 100 });

  // The side walls of the window: a ball that reaches one turns around.
  function keepInside() {
    const far = width / SCALE - R;
    state.x.forEach((x, i) => {
      if ((x < R && state.vx[i] < 0) || (x > far && state.vx[i] > 0)) state.vx[i] = -0.5 * state.vx[i];
      state.x[i] = Math.min(Math.max(x, R), far);
    });
  }

  function lead() {
    if (!held) return;
    const { i, x, y } = held;
    state.vx[i] = Math.max(-6, Math.min(6, 12 * (x - state.x[i])));
    state.vy[i] = Math.max(-6, Math.min(6, 12 * (y - state.y[i])));
  }

  function advance(seconds) {
    const { dt } = PAGE.defaults;
    for (let t = 0; t < seconds; t += dt) {
      lead();
      state = ContactEngine.STEP[model](state, sceneOf(), knobsOf());
      keepInside();
    }
  }

  function draw() {
    const balls = state.y.map((y, i) => ball(model, state.x[i] * SCALE, FLOOR - y * SCALE, R * SCALE));
    $("sandbox-picture").innerHTML = table(0, FLOOR, width, HEIGHT - FLOOR) + balls.join("");
    const speed = Math.max(0, ...state.y.map((_, i) => Math.hypot(state.vx[i], state.vy[i])));
    $("sandbox-words").textContent = state.y.length
      ? `${state.y.length} ball${state.y.length === 1 ? "" : "s"}, the fastest at ${number(speed, 2)} m/s.`
      : "Press Add a ball, or click into the picture.";
  }

  function frame(stamp) {
    if (!running) return;
    advance(Math.min(0.032, (stamp - last) / 1000));
    last = stamp;
    draw();
    requestAnimationFrame(frame);
  }

  function setRunning(on) {
    running = on;
    $("sandbox-run").textContent = on ? "Pause" : "Run";
    last = performance.now();
    if (on) requestAnimationFrame(frame);
  }

  function add(x, y) {
    if (state.y.length >= MOST) return ($("sandbox-words").textContent = `${MOST} balls are the most here.`);
    for (const [key, value] of Object.entries({ x, y, vx: 0, vy: 0 })) state[key] = [...state[key], value];
    draw();
  }

  function stack() {
    const x = width / SCALE / 2;
    state = { x: [], y: [], vx: [], vy: [] };
    for (let k = 0; k < 5; k++) add(x, (2 * k + 1) * R);
  }

  const pointed = (event) => {
    const box = $("sandbox-picture").getBoundingClientRect();
    return { x: (event.clientX - box.left) / SCALE, y: (FLOOR - (event.clientY - box.top)) / SCALE };
  };

  function listenPointer() {
    const picture = $("sandbox-picture");
    picture.addEventListener("pointerdown", (event) => {
      const at = pointed(event);
      const i = state.y.findIndex((y, k) => Math.hypot(state.x[k] - at.x, y - at.y) < 1.3 * R);
      if (i < 0) add(at.x, Math.max(R, at.y));
      held = { i: i < 0 ? state.y.length - 1 : i, ...at };
      picture.setPointerCapture(event.pointerId);
      if (!running) setRunning(true);
    });
    picture.addEventListener("pointermove", (event) => {
      if (held) Object.assign(held, pointed(event));
    });
    for (const kind of ["pointerup", "pointercancel"]) picture.addEventListener(kind, () => (held = null));
  }

  function measure() {
    width = Math.max(256, Math.min(640, Math.floor($("sandbox").clientWidth)));
    for (const [name, value] of Object.entries({ width, height: HEIGHT, viewBox: `0 0 ${width} ${HEIGHT}` }))
      $("sandbox-picture").setAttribute(name, value);
    draw();
  }

  function start() {
    if (!$("sandbox")) return;
    listenPointer();
    for (const radio of document.querySelectorAll('input[name="sandbox-model"]'))
      radio.addEventListener("change", () => {
        model = radio.value;
        draw();
      });
    const click = (id, action) => $(id).addEventListener("click", action);
    click("sandbox-run", () => setRunning(!running));
    click("sandbox-add", () => add(R + Math.random() * (width / SCALE - 2 * R), 1.6));
    click("sandbox-stack", stack);
    click("sandbox-clear", () => {
      state = { x: [], y: [], vx: [], vy: [] };
      draw();
    });
    new IntersectionObserver((entries) => {
      if (running && !entries.some((entry) => entry.isIntersecting)) setRunning(false);
    }).observe($("sandbox"));
    measure();
    stack();
    new ResizeObserver(measure).observe($("sandbox"));
  }

  return {
    start,
    advance,
    get state() {
      return state;
    },
  };
})();
