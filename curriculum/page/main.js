/* The start: figures, bets, and links of the text that set a figure. */
import { startBet } from "./bets.js";
import { figures } from "./figures.js";
import { stage, stateOf } from "./stage.js";

const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
const parsed = (box) => JSON.parse(box.dataset.given);
const stages = [...document.querySelectorAll("[data-figure]")].map((box) =>
  ({ box, view: stage(box, figures[box.dataset.figure], parsed(box), still) }));
document.querySelectorAll(".exercise:has(.bet)").forEach(startBet);

// The nearest figure of that name above a link, or else below it.
document.addEventListener("click", (event) => {
  const link = event.target.closest("a.try");
  if (!link) return;
  event.preventDefault();
  const named = stages.filter(({ box }) => box.dataset.figure === link.dataset.name);
  const above = named.filter(({ box }) => box.compareDocumentPosition(link) & 4);
  const { box, view } = above[above.length - 1] ?? named[0];
  view.stop();
  view.set(stateOf(figures[link.dataset.name], parsed(link)));
  const { top, bottom } = box.getBoundingClientRect();
  if (bottom < 120 || top > window.innerHeight - 120) box.scrollIntoView({ block: "center" });
});

// On a phone folded: code, which is wider than the screen, and what asks for a terminal.
const narrow = window.matchMedia("(max-width: 40rem)");
const fold = (closed) => {
  for (const each of document.querySelectorAll("details.folds")) {
    each.open = !closed;
    each.querySelector("summary").tabIndex = closed ? 0 : -1;
  }
};
narrow.addEventListener("change", () => fold(narrow.matches));
fold(narrow.matches);

// On paper all is open that was read.
let opened = [];
window.addEventListener("beforeprint", () => {
  fold(false);
  opened = [...document.querySelectorAll("details.answer:not([open])")];
  for (const each of opened) each.open = true;
});
window.addEventListener("afterprint", () => {
  fold(narrow.matches);
  for (const each of opened) each.open = false;
});
document.documentElement.dataset.ready = "yes";
