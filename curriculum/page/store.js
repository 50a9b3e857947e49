/* The state of the page, a section at a time: within one every number in a sentence, every knob,
 * every figure and the address agree at every moment; the next begins with what its own text says.
 *
 * A quantity is {low, high, step, near, digits, whole, unit, label}, by the name of contact.py's
 * flag where it has one; the steps of its slider are as long or get shorter towards `near`. Nothing
 * here touches the document; main.js binds it to the address. */
import { data } from "./data.js";
import { plain } from "./draw.js";

export const QUANTITIES = {
  dt: { low: 0.0005, high: 0.064, near: 0, digits: 3, unit: "s", label: "Time step dt" },
  stiffness: { low: 100, high: 1e6, near: 0, digits: 3, unit: "N/m", label: "Stiffness k" },
  damping: { low: 0, high: 300, step: 1, digits: 3, unit: "N s/m", label: "Damping c" },
  baumgarte: { low: 0, high: 1, step: 0.01, digits: 2, unit: "", label: "Baumgarte β" },
  iters: { low: 1, high: 100, step: 1, whole: true, digits: 3, unit: "", label: "Sweeps" },
  warm: { low: 0, high: 1, step: 0.05, digits: 2, unit: "", label: "Warm start" },
  restitution: { low: 0, high: 1, step: 0.01, digits: 2, unit: "", label: "Restitution e" },
  impedance: { low: 0.5, high: 0.9999, near: 1, digits: 3, unit: "", label: "Impedance d" },
  timeconst: { low: 0.002, high: 0.5, near: 0, digits: 3, unit: "s", label: "Time constant" },
  dampratio: { low: 0.1, high: 5, near: 0, digits: 2, unit: "", label: "Damping ratio" },
};
const SCENES = Object.keys(data.scenes);
const SLIDER = 400; // positions of a slider that is not plain

// The chapter's values; null stands for what the model takes by itself.
const START = { ...data.defaults, impedance: null, timeconst: null, dampratio: null };

// What a scene brings along.
function own(scene) {
  const { damping, restitution } = data.scenes[scene];
  return { scene, damping, restitution };
}
export const startOf = (scene) => ({ ...START, ...own(scene) });

// The value of a quantity, where nobody has set one: what the models take by themselves.
export function shown(values, name) {
  if (values[name] !== null) return values[name];
  return { impedance: values.restitution > 0 ? 0.9999 : 0.95, timeconst: 0.02, dampratio: 1 }[name];
}

// ---- sliders

export const sliderRange = ({ low, high, step }) =>
  step ? { min: low, max: high, step } : { min: 0, max: SLIDER, step: 1 };

export function toSlider({ low, high, step, near }, value) {
  if (step) return value;
  const [first, last] = [low - near, high - near];
  return Math.round((SLIDER * Math.log((value - near) / first)) / Math.log(last / first));
}

export function fromSlider({ low, high, step, near, digits }, position) {
  if (step) return Number(position.toPrecision(6));
  const [first, last] = [low - near, high - near];
  const away = Number((first * (last / first) ** (position / SLIDER)).toPrecision(digits));
  return Number((near + away).toPrecision(7));
}

// The nearest value that a quantity may take.
export function fitting({ low, high, whole }, value) {
  const held = Math.min(high, Math.max(low, value));
  return whole ? Math.round(held) : held;
}

// ---- a section

const known = (name) => name === "scene" || name in QUANTITIES;

function allowed(name, value) {
  if (name === "scene") return SCENES.includes(value);
  return value === null ? START[name] === null : value === fitting(QUANTITIES[name], value);
}

// What a query asks for; what is not allowed is left out.
export function asked(query) {
  const values = {};
  for (const [name, text] of new URLSearchParams(query)) {
    const value = name === "scene" ? text : Number(text);
    if (known(name) && text.trim() !== "" && allowed(name, value)) values[name] = value;
  }
  return values;
}

// These values, with some changed: another scene brings along its own.
function changed(values, changes) {
  const { scene } = changes;
  const moved = SCENES.includes(scene) && scene !== values.scene ? own(scene) : {};
  const fits = ([name, value]) => known(name) && allowed(name, value);
  return { ...values, ...moved, ...Object.fromEntries(Object.entries(changes).filter(fits)) };
}

/* A section of the chapter: `home`, what its text speaks of, and `values`, what the reader has made
 * of it. hear(section) is told of every change. */
export class Section {
  #hear = [];

  constructor(id, changes) {
    Object.assign(this, { id, home: changed(startOf("drop"), changes) });
    this.values = this.home;
  }

  on(hear) {
    this.#hear.push(hear);
  }

  #put(values, act) {
    const same = Object.keys(values).every((name) => values[name] === this.values[name]);
    this.values = values;
    if (!same) for (const hear of this.#hear) hear(this, act);
  }

  // The reader sets some values; `from`: what the others become.
  set = (changes, from = this.values) => this.#put(changed(from, changes), true);
  // An address or the back button does.
  restore = (changes) => this.#put(changed(this.home, changes), false);

  get = (name) => shown(this.values, name);

  // What the reader has changed, {name: value}.
  changes() {
    const differs = Object.entries(this.values).filter(([name, v]) => v !== this.home[name]);
    return Object.fromEntries(differs);
  }

  // That as an address has it.
  query() {
    const parts = Object.entries(this.changes()).filter(([, value]) => value !== null);
    return parts.map(([name, v]) => `${name}=${name === "scene" ? v : plain(v)}`).join("&");
  }

  // That in words: [name, "Stiffness k = 2,000, text: 10,000"].
  inWords() {
    return Object.keys(this.changes()).map((name) => {
      const say = (values) =>
        name === "scene" ? values[name] : grouped(shown(values, name));
      const label = name === "scene" ? "scene" : QUANTITIES[name].label;
      return [name, `${label} = ${say(this.values)}, text: ${say(this.home)}`];
    });
  }
}

// A number as a sentence has it.
export const grouped = (value) => (value < 1e3 ? plain(value) : value.toLocaleString("en"));

// ---- what the engine wants

export function knobsOf(values) {
  const { scene, impedance: d, timeconst, dampratio, ...knobs } = values;
  const set = timeconst !== null || dampratio !== null;
  const solref = set ? [shown(values, "timeconst"), shown(values, "dampratio")] : undefined;
  const solimp = d === null ? undefined : [Number((2 * d - 1).toFixed(12)), d, 0.001, 0.5, 2];
  return { ...knobs, solref, solimp };
}

export function sceneOf({ scene, restitution, damping }) {
  const y = data.scenes[scene].start;
  const [none, one, radius] = [0, 1, data.radius].map((value) => y.map(() => value));
  return { x: none, y, vx: none, vy: none, mass: one, radius, restitution, damping };
}
