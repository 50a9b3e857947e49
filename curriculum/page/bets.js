/* Bets: a click makes one and opens its answer; it stands until one takes it back. Without a bet the
 * answer opens at the second press. Nothing is kept: after a reload the next reader bets. */
export function startBet(box) {
  const [answer, back, summary, verdict] = [".answer", ".take-back", ".answer summary", ".verdict"]
    .map((part) => box.querySelector(part));
  const choices = [...box.querySelectorAll("[data-choice]")];
  let [choice, warned] = [null, false];
  function take(wanted) {
    [choice, warned, answer.open, back.hidden] = [wanted, false, Boolean(wanted), !wanted];
    for (const each of choices) {
      each.setAttribute("aria-pressed", String(each.dataset.choice === choice));
      each.disabled = Boolean(choice) && each.dataset.choice !== choice;
    }
    summary.textContent = "The answer";
    verdict.textContent = !choice ? "" : choice === answer.dataset.right
      ? "You bet on it, and it is so." : "It comes out otherwise.";
  }
  take(null); // Firefox keeps what was disabled before a reload
  back.addEventListener("click", () => {
    take(null);
    choices[0].focus();
  });
  for (const each of choices)
    each.addEventListener("click", () => {
      if (choice) return;
      take(each.dataset.choice);
      summary.focus({ preventScroll: true });
    });
  summary.addEventListener("click", (event) => {
    if (choice || warned || answer.open) return;
    event.preventDefault();
    [warned, summary.textContent] = [true, "You have not bet yet. Press again to see the answer."];
  });
}
