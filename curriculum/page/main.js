/* The start: everything is bound together. */
import { Bets } from "./bets.js";
import { startBlank } from "./blank.js";
import { data } from "./data.js";
import { figures } from "./figures.js";
import { Reader } from "./reader.js";
import { Stage } from "./stage.js";
import { Store } from "./store.js";

// ---- the address

function bindAddress(store) {
  let [timer, begun] = [0, false];
  const write = (how) => {
    try {
      history[how](null, "", (store.write() || location.pathname) + location.hash);
    } catch {
      // a frame without an address of its own: the state is kept until the page is closed
    }
  };
  store.on(null, (values, changed, how) => {
    clearTimeout(timer);
    if (how === "act" || (how === "drag" && begun)) write("pushState");
    else if (how === "drag") timer = setTimeout(() => write("replaceState"), 100);
    else if (how === "text" || how === "end") write("replaceState");
    begun = how === "begin"; // a drag that changes nothing leaves no trace behind the back button
  });
  window.addEventListener("popstate", () => store.read(location.search));
  store.read(location.search);
}

// ---- lines of code that run now

const lit = new Map();

// Light some lines, [[region, text]]: those of the last call from `by` go out.
function light(by, lines) {
  for (const line of lit.get(by) || []) line.classList.remove("lit");
  const found = lines.flatMap(([region, text]) => {
    const all = [...document.querySelectorAll(`#code-${region} .ln`)];
    return all.filter((line) => line.textContent.includes(text));
  });
  for (const line of found) line.classList.add("lit");
  lit.set(by, found);
}

// ---- the page

const store = new Store();
const bets = new Bets(data.bets);
const page = {
  store,
  open: bets.open,
  still: window.matchMedia("(prefers-reduced-motion: reduce)").matches,
  light,
};
bindAddress(store);
const stages = {};
for (const box of document.querySelectorAll("[data-figure]")) {
  const name = box.dataset.figure;
  stages[name] = new Stage(box, name, figures[name], page);
}
bets.onOpen(() => Object.values(stages).forEach((stage) => stage.redraw()));
if (document.getElementById("blank")) startBlank(document.getElementById("blank"), data.blank);
new Reader(store, stages.lanes);
document.documentElement.dataset.ready = "yes";
