/* The start: figures, bets, and what is folded on a phone. */
import { startBet } from "./bets.js";
import { figures } from "./figures.js";
import { stage } from "./stage.js";

const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
for (const box of document.querySelectorAll("[data-figure]"))
  stage(box, figures[box.dataset.figure], JSON.parse(box.dataset.given), still);
document.querySelectorAll(".exercise:has(.bet)").forEach(startBet);

// On a phone folded: code, which is wider than the screen, and what asks for a terminal.
const folds = [...document.querySelectorAll("details.folds")];
const narrow = window.matchMedia("(max-width: 40rem)");
const fold = () => {
  for (const each of folds) {
    each.open = !narrow.matches;
    each.querySelector("summary").tabIndex = narrow.matches ? 0 : -1;
  }
};
narrow.addEventListener("change", fold);
fold();
document.documentElement.dataset.ready = "yes";
