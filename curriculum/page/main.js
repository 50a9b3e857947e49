/* The start: figures, settings in the address, bets, and what is folded on a phone. */
import { startBet } from "./bets.js";
import { figures } from "./figures.js";
import { stage } from "./stage.js";

const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
const settings = history.state ?? {}; // of all figures, kept by each place of the history
const takes = Object.fromEntries([...document.querySelectorAll("[data-figure]")].map((box) =>
  [box.id, stage(box, figures[box.dataset.figure], JSON.parse(box.dataset.given), still, settings)]));

// What an address sets, #fig-cliff?dt=0.014: numbers, and the names of switches.
function follow() {
  const [id, query] = decodeURIComponent(location.hash.slice(1)).split("?");
  if (takes[id] && query) {
    settings[id] = Object.fromEntries([...new URLSearchParams(query)].map(([name, text]) =>
      [name, text.trim() && Number.isFinite(Number(text)) ? Number(text) : text]));
    takes[id](settings[id]);
    document.getElementById(id).scrollIntoView({ block: "center" });
  }
  history.replaceState(settings, "");
}
window.addEventListener("hashchange", follow);
if (!history.state) follow();
for (const [id, set] of Object.entries(settings)) takes[id]?.(set); // after a reload

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
