/* The start: everything is bound together. */
import { Bets } from "./bets.js";
import { startBlank } from "./blank.js";
import { data } from "./data.js";
import { figures } from "./figures.js";
import { Glance } from "./glance.js";
import { LINES } from "./lines.js";
import { Reader } from "./reader.js";
import { Stage } from "./stage.js";
import { asked, Section } from "./store.js";

// ---- sections

/* The passages of the page: [{node, section, look}]. Each heading begins one, and so does each mark
 * of what the text shows (`none`: the live figure steps back). */
function findPassages() {
  const passages = [];
  let last = ""; // a section beside which the live figure stands goes on with what it showed
  for (const node of document.querySelectorAll("article :is(h2, h3)[id]:not(.exercise *), .show")) {
    const query = node.dataset.show || "none";
    if (node.dataset.show || !node.closest(".beside")) last = /^none/.test(query) ? "" : query;
    passages.push({ node, section: new Section(node.id, asked(query)), look: last });
  }
  return passages;
}

// The section in which something stands: of the last passage that begins above it.
function sectionIn(passages) {
  const above = (each) => ({ node }) => each.compareDocumentPosition(node) & 2;
  return (each) => (passages.findLast(above(each)) || passages[0]).section;
}

// ---- the address

// What the address asks for: of a section and its passages, or, without one, of all.
function read(sections) {
  const wanted = asked(location.search);
  const target = document.getElementById(location.hash.slice(1));
  const heading = (each) => each.id.replace(/\.\d+$/, "");
  for (const each of sections)
    if (!target || each.id === target.id || heading(each) === target.id) each.restore(wanted);
}

/* One entry of the history an act: a drag, or a run of arrow keys, is one. The address names the
 * section and what is changed there; the entry keeps that of all of them. */
function bindAddress(sections) {
  let [under, timer] = [false, 0]; // whether the newest entry is that of the act under way
  const state = () => Object.fromEntries(sections.map((each) => [each.id, each.changes()]));
  const write = (how, address) => {
    try {
      history[how](state(), "", address);
    } catch {
      // a frame without an address of its own: the state is kept until the page is closed
    }
  };
  const restore = (held) => sections.forEach((each) => each.restore(held[each.id] || {}));
  function acted(section, act) {
    if (!act) return;
    const { pathname } = location;
    const address = () => `${pathname}?${section.query()}#${section.id}`.replace("?#", "#");
    clearTimeout(timer);
    if (under) timer = setTimeout(() => write("replaceState", address()), 150);
    else write("pushState", address());
    under = true;
  }
  for (const each of sections) each.on(acted);
  for (const kind of ["pointerdown", "focusin", "click"])
    window.addEventListener(kind, () => (under = false), true);
  if (history.state) restore(history.state);
  else read(sections);
  write("replaceState", location.href);
  window.addEventListener("popstate", (event) => {
    clearTimeout(timer);
    under = false;
    if (event.state) restore(event.state);
    else write("replaceState", location.href); // a link within the page
  });
}

// ---- lines of code that run now

const lit = new Map();

// Light some of LINES, by name: those of the last call from `by` go out.
function light(by, names) {
  for (const line of lit.get(by) || []) line.classList.remove("lit");
  const lines = names.flatMap((name) => {
    const [region, text] = LINES[name];
    const all = [...document.querySelectorAll(`#code-${region} .ln`)];
    return all.filter((line) => line.textContent.includes(text));
  });
  for (const line of lines) line.classList.add("lit");
  lit.set(by, lines);
}

// ---- the page

const bets = new Bets(data.bets);
const page = {
  open: bets.open,
  still: window.matchMedia("(prefers-reduced-motion: reduce)").matches,
  light,
};
const passages = findPassages();
const sectionOf = sectionIn(passages);
const stages = [...document.querySelectorAll("[data-figure]")].map((box) => {
  const name = box.dataset.figure;
  return new Stage(box, name, figures[name], page, sectionOf(box));
});
const glances = passages
  .filter(({ node, look }) => look && node.matches(".show"))
  .map((passage) => new Glance(passage, page.open));
const drawn = [...stages, ...glances];
const sections = passages.map(({ section }) => section);
for (const each of sections)
  each.on(() => drawn.forEach((one) => one.section === each && one.redraw()));
bets.onOpen(() => drawn.forEach((one) => one.redraw()));
bindAddress(sections);
if (document.getElementById("blank")) startBlank(document.getElementById("blank"), data.blank);
new Reader(passages, sectionOf, stages.find(({ name }) => name === "lanes"));
document.documentElement.dataset.ready = "yes";
