/* Bets: a click makes one and opens its answer; it stands until one takes it back. Without a bet the
 * answer opens at the second press. What was bet is kept in this browser. */
const KEY = "contact-chapter:";

// What `act` gives of the browser's storage, if there is one.
function stored(act) {
  try {
    return act(localStorage);
  } catch {
    return null;
  }
}

export function startBet(box) {
  const [answer, back, summary, verdict] = [".answer", ".take-back", ".answer summary", ".verdict"]
    .map((part) => box.querySelector(part));
  const choices = [...box.querySelectorAll("[data-choice]")];
  let [choice, warned] = [null, false];
  function show() {
    for (const each of choices) {
      each.setAttribute("aria-pressed", String(each.dataset.choice === choice));
      each.disabled = Boolean(choice) && each.dataset.choice !== choice;
    }
    [back.hidden, warned, summary.textContent] = [!choice, false, "The answer"];
    verdict.textContent = !choice ? "" : choice === answer.dataset.right
      ? "You bet on it, and it is so." : "It comes out otherwise.";
  }
  function take(wanted) {
    [choice, answer.open] = [wanted, Boolean(wanted)];
    stored((held) => held.setItem(KEY + box.id, wanted ?? ""));
    show();
  }
  const before = stored((held) => held.getItem(KEY + box.id));
  if (choices.some((each) => each.dataset.choice === before)) choice = before;
  show();
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

export function forgetBets() {
  stored((held) => Object.keys(held).filter((key) => key.startsWith(KEY))
    .forEach((key) => held.removeItem(key)));
  location.reload();
}
