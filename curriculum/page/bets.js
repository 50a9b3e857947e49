/* Bets: a click makes one and opens its answer, in its own box; it stands until one takes it back.
 * Without a bet the answer opens at the second press. What was bet is kept in this browser. */
const KEY = "contact-chapter:";
const SUMMARY = "The answer";

// What `act` gives of the browser's storage; without one a bet lasts as long as the page is open.
function stored(act) {
  try {
    return act(localStorage);
  } catch {
    return null;
  }
}

export function startBet(box) {
  const [answer, why, back] = [".answer", "textarea", ".take-back"].map((part) => box.querySelector(part));
  const [summary, verdict] = [answer.querySelector("summary"), answer.querySelector(".verdict")];
  const choices = [...box.querySelectorAll("[data-choice]")];
  let [bet, warned] = [{}, false];
  function show() {
    for (const each of choices) {
      each.setAttribute("aria-pressed", String(each.dataset.choice === bet.choice));
      each.disabled = Boolean(bet.choice) && each.dataset.choice !== bet.choice;
    }
    back.hidden = !bet.choice;
    [summary.textContent, warned] = [SUMMARY, false];
    verdict.textContent = !bet.choice ? "" : bet.choice === answer.dataset.right
      ? "You bet on it, and it is so." : "It comes out otherwise.";
  }
  function take(changes) {
    bet = { ...bet, ...changes };
    stored((held) => held.setItem(KEY + box.id, JSON.stringify(bet)));
    show();
  }
  const { choice, why: reason } = stored((held) => JSON.parse(held.getItem(KEY + box.id))) ?? {};
  if (choices.some((each) => each.dataset.choice === choice)) bet.choice = choice;
  if (typeof reason === "string") why.value = bet.why = reason;
  show();
  why.addEventListener("input", () => take({ why: why.value }));
  for (const each of choices)
    each.addEventListener("click", () => {
      if (bet.choice) return;
      take({ choice: each.dataset.choice });
      answer.open = true;
      summary.focus({ preventScroll: true });
    });
  back.addEventListener("click", () => {
    take({ choice: undefined });
    answer.open = false;
    choices[0].focus();
  });
  summary.addEventListener("click", (event) => {
    if (bet.choice || warned || answer.open) return;
    event.preventDefault();
    [summary.textContent, warned] = ["You have not bet yet. Press again to see the answer.", true];
  });
}

export function forgetBets({ currentTarget }) {
  stored((held) => Object.keys(held).filter((key) => key.startsWith(KEY))
    .forEach((key) => held.removeItem(key)));
  currentTarget.textContent = "Forgotten";
  setTimeout(() => location.reload(), 400);
}
