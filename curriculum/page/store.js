/* One state for the whole page. Every number in a sentence, every knob, every figure and the
 * address read it and write it, so they agree at every moment.
 *
 * A quantity is {low, high, log, step, whole, digits, unit, label}, by the name of contact.py's
 * flag where it has one. Nothing here touches the document; main.js binds it to the address. */
import { data } from "./data.js";
import { plain } from "./draw.js";

export const QUANTITIES = {
  dt: { low: 0.0005, high: 0.064, log: true, digits: 3, unit: "s", label: "Time step dt" },
  stiffness: { low: 100, high: 1e6, log: true, digits: 3, unit: "N/m", label: "Stiffness k" },
  damping: { low: 0, high: 300, step: 1, digits: 3, unit: "N s/m", label: "Damping c" },
  baumgarte: { low: 0, high: 1, step: 0.01, digits: 2, unit: "", label: "Baumgarte β" },
  iters: { low: 1, high: 100, step: 1, whole: true, digits: 3, unit: "", label: "Sweeps" },
  warm: { low: 0, high: 1, step: 0.05, digits: 2, unit: "", label: "Warm start" },
  restitution: { low: 0, high: 1, step: 0.01, digits: 2, unit: "", label: "Restitution e" },
  impedance: { low: 0.5, high: 0.9999, near: 1, digits: 5, unit: "", label: "Impedance d" },
  timeconst: { low: 0.002, high: 0.5, log: true, digits: 3, unit: "s", label: "Time constant" },
  dampratio: { low: 0.1, high: 5, log: true, digits: 2, unit: "", label: "Damping ratio" },
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

export const sliderRange = ({ low, high, step, log, near }) =>
  log || near ? { min: 0, max: SLIDER, step: 1 } : { min: low, max: high, step: step || 1 };

export function toSlider({ low, high, log, near }, value) {
  if (log) return Math.round((SLIDER * Math.log(value / low)) / Math.log(high / low));
  if (!near) return value;
  const whole = Math.log((near - low) / (near - high));
  return Math.round((SLIDER * Math.log((near - low) / (near - value))) / whole);
}

export function fromSlider({ low, high, log, near, digits }, position) {
  const share = position / SLIDER;
  if (log) return Number((low * (high / low) ** share).toPrecision(digits));
  if (!near) return Number(position.toPrecision(6));
  const left = (near - low) * ((near - high) / (near - low)) ** share;
  return Number((near - Number(left.toPrecision(3))).toPrecision(7));
}

// The nearest value that a quantity may take.
export function fitting({ low, high, whole }, value) {
  const held = Math.min(high, Math.max(low, value));
  return whole ? Math.round(held) : held;
}

// ---- the store

export class Store {
  quantities = QUANTITIES;
  #values = startOf("drop");
  #listeners = [];
  #touched = new Set(); // what the reader has set by hand since the text last named it
  #dragging = false;

  all = () => this.#values;
  get = (name) => shown(this.#values, name);
  dragging = () => this.#dragging;

  allowed(name, value) {
    if (name === "scene") return SCENES.includes(value);
    const each = QUANTITIES[name];
    if (!each || value === null) return START[name] === null;
    return value === fitting(each, value);
  }

  // Call `hear(values, changed, how)` whenever one of `names` (null: any) changes.
  on(names, hear) {
    this.#listeners.push({ names, hear });
  }

  #tell(changed, how) {
    for (const { names, hear } of this.#listeners)
      if (!names || names.some((name) => changed.has(name))) hear(this.#values, changed, how);
  }

  // Set some values. `how`: "act" (one act of the reader), "drag" (one of many), "text", "address".
  set(changes, how = "act") {
    const next = { ...this.#values };
    if (SCENES.includes(changes.scene) && changes.scene !== next.scene)
      Object.assign(next, own(changes.scene));
    for (const [name, value] of Object.entries(changes))
      if (this.allowed(name, value)) next[name] = value;
    const changed = new Set(Object.keys(next).filter((name) => next[name] !== this.#values[name]));
    if (!changed.size) return;
    this.#values = next;
    const byHand = how === "act" || how === "drag";
    for (const name of changed) this.#touched[byHand ? "add" : "delete"](name);
    this.#tell(changed, how);
  }

  // A drag begins or ends. While it lasts figures draw coarsely; after it they draw once more.
  drag(underWay) {
    if (this.#dragging === underWay) return;
    this.#dragging = underWay;
    this.#tell(new Set(Object.keys(this.#values)), underWay ? "begin" : "end");
  }

  // What the text sets; what it does not name and nobody has touched returns to the chapter's.
  follow(changes) {
    for (const name of Object.keys(changes)) this.#touched.delete(name);
    const kept = Object.fromEntries([...this.#touched].map((name) => [name, this.#values[name]]));
    this.set({ ...startOf(changes.scene || kept.scene || "drop"), ...kept, ...changes }, "text");
  }

  reset = () => this.set(startOf("drop"));

  // What a query asks for; what is not allowed is left out.
  asked(query) {
    const found = {};
    for (const [name, text] of new URLSearchParams(query)) {
      const value = name === "scene" ? text : Number(text);
      if (text.trim() !== "" && this.allowed(name, value)) found[name] = value;
    }
    return found;
  }

  read(query, how = "address") {
    const found = this.asked(query);
    this.set({ ...startOf(found.scene || "drop"), ...found }, how);
  }

  // The values that differ from the chapter's, as an address has them.
  write() {
    const chapter = { ...startOf(this.#values.scene), scene: "drop" };
    const parts = Object.entries(this.#values)
      .filter(([name, value]) => value !== chapter[name])
      .map(([name, value]) => `${name}=${name === "scene" ? value : plain(value)}`);
    return parts.length ? `?${parts.join("&")}` : "";
  }
}

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
