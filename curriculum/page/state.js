/* What the reader has set: the scene and the knobs, by the names of contact.py's flags. Kept in the
 * address, so that a link shows the same. */
"use strict";

const State = (() => {
  const { plain } = Plot;
  const SCENES = Object.keys(PAGE.scenes);

  // A knob: its range, how its slider is scaled, the digits it is given in, and whose it is.
  const KNOBS = {
    dt: { low: 0.0005, high: 0.064, log: true, digits: 3, unit: "s" },
    stiffness: { low: 100, high: 1e6, log: true, digits: 3, unit: "N/m" },
    damping: { low: 0, high: 300, step: 1, digits: 3, unit: "N s/m" },
    baumgarte: { low: 0, high: 1, step: 0.01, digits: 2, unit: "" },
    iters: { low: 1, high: 100, step: 1, digits: 3, whole: true, unit: "" },
    restitution: { low: 0, high: 1, step: 0.01, digits: 2, unit: "" },
    impedance: { low: 0.5, high: 0.9999, soft: true, digits: 5, unit: "" },
  };
  const SLIDER = 400; // positions of a scaled slider

  const DEFAULTS = {
    scene: "drop",
    seed: 0,
    contact: "penalty",
    ...PAGE.defaults,
    impedance: null,
    solref: null,
  };
  const ownKnobs = (scene) => ({
    damping: PAGE.scenes[scene].damping,
    restitution: PAGE.scenes[scene].restitution,
  });

  // Soft's impedance where the reader has not set one: MuJoCo's, and nearly hard for a bounce.
  const shownValue = (state, name) =>
    name === "impedance" && state.impedance === null ? (state.restitution > 0 ? 0.9999 : 0.95) : state[name];

  // The knobs as the engine wants them.
  function knobsOf(state) {
    const { dt, stiffness, damping, restitution, iters, baumgarte, impedance: d } = state;
    const solimp = d === null ? undefined : [Number((2 * d - 1).toFixed(12)), d, 0.001, 0.5, 2];
    const solref = state.solref || undefined;
    return { dt, stiffness, damping, restitution, iters, baumgarte, solref, solimp };
  }

  function sceneOf(state) {
    const y = PAGE.scenes[state.scene].starts[state.seed];
    const same = (value) => y.map(() => value);
    return {
      x: same(0),
      y,
      vx: same(0),
      vy: same(0),
      mass: same(1),
      radius: same(PAGE.radius),
      restitution: state.restitution,
      damping: state.damping,
    };
  }

  // ---- sliders

  function toSlider(name, value) {
    const knob = KNOBS[name];
    if (knob.log) return Math.round((SLIDER * Math.log(value / knob.low)) / Math.log(knob.high / knob.low));
    if (!knob.soft) return value;
    return Math.round(
      (SLIDER * Math.log((1 - knob.low) / (1 - value))) / Math.log((1 - knob.low) / (1 - knob.high)),
    );
  }

  function fromSlider(name, position) {
    const knob = KNOBS[name];
    const share = position / SLIDER;
    if (knob.log) return Number((knob.low * (knob.high / knob.low) ** share).toPrecision(knob.digits));
    if (!knob.soft) return Number(position.toPrecision(6));
    const left = (1 - knob.low) * ((1 - knob.high) / (1 - knob.low)) ** share;
    return Number((1 - Number(left.toPrecision(3))).toPrecision(7));
  }

  const sliderRange = ({ low, high, step, log, soft }) =>
    log || soft ? { min: 0, max: SLIDER, step: 1 } : { min: low, max: high, step };

  // Whether a text is a value that the knob may take.
  function allowed(name, text) {
    const { low, high, whole } = KNOBS[name];
    const value = Number(text);
    return text.trim() !== "" && value >= low && value <= high && (!whole || Number.isInteger(value));
  }

  // ---- the address

  // The state that a query asks for, and the time it shows (or null). What is not allowed is left out.
  function read(query) {
    const given = new URLSearchParams(query);
    const scene = SCENES.includes(given.get("scene")) ? given.get("scene") : DEFAULTS.scene;
    const state = { ...DEFAULTS, scene, ...ownKnobs(scene) };
    for (const name of Object.keys(KNOBS))
      if (given.has(name) && allowed(name, given.get(name))) state[name] = Number(given.get(name));
    if (ContactEngine.MODELS.includes(given.get("contact"))) state.contact = given.get("contact");
    const solref = (given.get("solref") || "").split(",").map(Number);
    if (solref.length === 2 && solref.every((v) => Number.isFinite(v) && v > 0)) state.solref = solref;
    const seed = given.get("seed");
    if (/^\d+$/.test(seed || "") && Number(seed) < PAGE.scenes.drop.starts.length) state.seed = Number(seed);
    const at = given.get("t");
    return {
      state,
      time: at !== null && at.trim() !== "" && Number(at) >= 0 && Number(at) <= 4 ? Number(at) : null,
    };
  }

  function write(state, time) {
    const query = new URLSearchParams();
    const base = { ...DEFAULTS, ...ownKnobs(state.scene) };
    for (const name of ["scene", ...Object.keys(KNOBS), "seed", "contact"])
      if (state[name] !== base[name])
        query.set(name, typeof state[name] === "number" ? plain(state[name]) : state[name]);
    if (state.solref) query.set("solref", state.solref.map(plain).join(","));
    if (time !== null) query.set("t", plain(time));
    const text = query.toString();
    return text ? `?${text}` : "";
  }

  // The command that runs the same in a terminal.
  function command(state, steps) {
    const base = { ...DEFAULTS, ...ownKnobs(state.scene) };
    const flags = [`--scene ${state.scene}`];
    for (const name of ["dt", "stiffness", "damping", "restitution", "baumgarte", "iters", "seed"])
      if (state[name] !== base[name]) flags.push(`--${name} ${plain(state[name])}`);
    if (state.impedance !== null) flags.push(`--solimp ${knobsOf(state).solimp.map(plain).join(" ")}`);
    if (state.solref) flags.push(`--solref ${state.solref.map(plain).join(" ")}`);
    if (steps !== 2000) flags.push(`--steps ${steps}`);
    return `python contact.py ${flags.join(" ")}`;
  }

  return {
    KNOBS,
    DEFAULTS,
    ownKnobs,
    shownValue,
    knobsOf,
    sceneOf,
    toSlider,
    fromSlider,
    sliderRange,
    allowed,
    read,
    write,
    command,
  };
})();
