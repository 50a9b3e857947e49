/* The start: in the page, everything is bound together; in a worker, figures compute what takes long. */
import { Bets } from "./bets.js";
import { startBlank } from "./blank.js";
import { data } from "./data.js";
import { figures } from "./figures.js";
import { Reader } from "./reader.js";
import { Stage } from "./stage.js";
import { Store } from "./store.js";

// ---- the worker: the same script, without a document

function work({ data: { figure, job, args, ticket } }) {
  self.postMessage({ ticket, value: figures[figure].jobs[job](args) });
}

// Computes a figure's job beside the page; where no worker can be had, in the page.
class Helper {
  #waiting = new Map();
  #ticket = 0;

  constructor(source) {
    try {
      this.worker = new Worker(URL.createObjectURL(new Blob([source], { type: "text/javascript" })));
      this.worker.onmessage = ({ data: { ticket, value } }) => this.#waiting.get(ticket)(value);
      this.worker.onerror = () => (this.worker = null);
    } catch {
      this.worker = null;
    }
  }

  compute = (figure, job, args, done) => {
    if (!this.worker) return void setTimeout(() => done(figures[figure].jobs[job](args)));
    this.#waiting.set(++this.#ticket, done);
    this.worker.postMessage({ figure, job, args, ticket: this.#ticket });
  };
}

// ---- the address

function bindAddress(store) {
  let timer = 0;
  const write = (how) => {
    try {
      history[how](null, "", (store.write() || location.pathname) + location.hash);
    } catch {
      // a frame without an address of its own: the state is kept until the page is closed
    }
  };
  store.on(null, (values, changed, how) => {
    clearTimeout(timer);
    if (how === "act" || how === "begin") write("pushState");
    else if (how === "drag") timer = setTimeout(() => write("replaceState"), 100);
    else if (how !== "address") write("replaceState");
  });
  window.addEventListener("popstate", () => store.read(location.search));
  store.read(location.search);
}

// ---- lines of code that run now

const lit = new Map();

// Light some lines, [[region, text]]: those of the last call from `by` go out.
function light(by, lines) {
  for (const line of lit.get(by) || []) line.classList.remove("lit");
  const found = lines.flatMap(([region, text]) =>
    [...document.querySelectorAll(`#code-${region} .ln`)].filter((line) => line.textContent.includes(text)),
  );
  for (const line of found) line.classList.add("lit");
  lit.set(by, found);
}

function start() {
  const store = new Store(Object.assign({}, ...Object.values(figures).map((each) => each.quantities || {})));
  const bets = new Bets(data.bets);
  const helper = new Helper(document.getElementById("script").textContent);
  const page = {
    store,
    open: bets.open,
    still: window.matchMedia("(prefers-reduced-motion: reduce)").matches,
    worker: helper.compute,
    light,
  };
  bindAddress(store);
  const stages = new Map();
  for (const box of document.querySelectorAll("[data-figure]"))
    stages.set(box.dataset.figure, new Stage(box, box.dataset.figure, figures[box.dataset.figure], page));
  bets.onOpen(() => stages.forEach((stage) => stage.redraw()));
  if (document.getElementById("blank")) startBlank(document.getElementById("blank"), data.blank);
  const reader = new Reader(store, stages.get("lanes"));
  reader.start();
  document.documentElement.dataset.ready = "yes";
}

if (typeof document === "undefined") self.onmessage = work;
else start();
