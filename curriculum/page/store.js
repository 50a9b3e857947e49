/* One state for the whole page. Every number in a sentence, every knob, every figure and the address
 * read it and write it, so they agree at every moment.
 *
 * A quantity is {low, high, log, step, whole, digits, unit, label, start}, by the name of contact.py's
 * flag where it has one. Figures may bring quantities of their own (`quantities` of a figure).
 * Nothing here touches the document; main.js binds the store to the address. */
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
export const MODELS = ["penalty", "lcp", "soft", "exact"];
const SCENES = Object.keys(data.scenes);
const SLIDER = 400; // positions of a slider that is not plain

const START = {
  scene: "drop",
  ...data.defaults,
  impedance: null, // null: what the model takes by itself
  timeconst: null,
  dampratio: null,
};

// What a scene brings along.
const own = ({ damping, restitution }) => ({ damping, restitution });
export const startOf = (scene) => ({ ...START, scene, ...own(data.scenes[scene]) });

// The value of a quantity that is shown where nobody has set one: what the models take by themselves.
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
  return Math.round((SLIDER * Math.log((near - low) / (near - value))) / Math.log((near - low) / (near - high)));
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
  #values;
  #listeners = new Set();
  #touched = new Set(); // what the reader has set by hand since the text last named it
  #dragging = false;

  constructor(more = {}) {
    this.quantities = { ...QUANTITIES, ...more };
    this.extra = Object.fromEntries(Object.entries(more).map(([name, { start }]) => [name, start]));
    this.#values = this.chapter("drop");
  }

  // The chapter's values, with a scene.
  chapter = (scene) => ({ ...startOf(scene), ...this.extra });
  all = () => this.#values;
  get = (name) => shown(this.#values, name);
  dragging = () => this.#dragging;

  allowed(name, value) {
    if (name === "scene") return SCENES.includes(value);
    const each = this.quantities[name];
    if (!each) return false;
    if (value === null) return START[name] === null;
    return value >= each.low && value <= each.high && (!each.whole || Number.isInteger(value));
  }

  // Call `hear(values, changed, how)` whenever one of `names` (null: any) changes. Returns how to stop.
  on(names, hear) {
    const listener = { names, hear };
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  #tell(changed, how) {
    for (const { names, hear } of [...this.#listeners])
      if (!names || names.some((name) => changed.has(name))) hear(this.#values, changed, how);
  }

  // Set some values. `how`: "act" (one act of the reader), "drag" (one of many), "text", "address".
  set(changes, how = "act") {
    const next = { ...this.#values };
    if (SCENES.includes(changes.scene) && changes.scene !== next.scene)
      Object.assign(next, own(data.scenes[changes.scene]));
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

  // What the text sets; what it does not name and the reader has not touched returns to the chapter's.
  follow(changes) {
    for (const name of Object.keys(changes)) this.#touched.delete(name);
    const kept = Object.fromEntries([...this.#touched].map((name) => [name, this.#values[name]]));
    this.set({ ...this.chapter(changes.scene || kept.scene || "drop"), ...kept, ...changes }, "text");
  }

  reset = () => this.set(this.chapter("drop"));

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
    this.set({ ...this.chapter(found.scene || "drop"), ...found }, how);
  }

  // The values that differ from the chapter's, as an address has them.
  write() {
    const chapter = this.chapter(this.#values.scene);
    const differs = (name, value) => (name === "scene" ? value !== "drop" : value !== chapter[name]);
    const parts = Object.entries(this.#values)
      .filter(([name, value]) => differs(name, value))
      .map(([name, value]) => `${name}=${typeof value === "number" ? plain(value) : value}`);
    return parts.length ? `?${parts.join("&")}` : "";
  }
}

// ---- what the engine wants

export function knobsOf(values) {
  const { dt, stiffness, damping, restitution, iters, baumgarte, warm, impedance: d, timeconst, dampratio } = values;
  const solimp = d === null ? undefined : [Number((2 * d - 1).toFixed(12)), d, 0.001, 0.5, 2];
  const set = timeconst !== null || dampratio !== null;
  const solref = set ? [shown(values, "timeconst"), shown(values, "dampratio")] : undefined;
  return { dt, stiffness, damping, restitution, iters, baumgarte, warm, solref, solimp };
}

export function sceneOf(values) {
  const y = data.scenes[values.scene].start;
  const same = (value) => y.map(() => value);
  return {
    x: same(0),
    y,
    vx: same(0),
    vy: same(0),
    mass: same(1),
    radius: same(data.radius),
    restitution: values.restitution,
    damping: values.damping,
  };
}
