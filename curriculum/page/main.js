/* The start: figures, bets, and what is folded on a phone and open on paper. */
import { startBet } from "./bets.js";
import { figures } from "./figures.js";
import { stage } from "./stage.js";

const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
for (const box of document.querySelectorAll("[data-figure]"))
  stage(box, figures[box.dataset.figure], JSON.parse(box.dataset.given), still);
document.querySelectorAll(".exercise:has(.bet)").forEach(startBet);

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
