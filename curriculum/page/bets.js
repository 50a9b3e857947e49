/* Bets: one click makes one and opens its answer, in its own box; the reason may be written after.
 * What was bet is kept in this browser. */
const KEY = "contact-chapter:";

// What `act` gives of the browser's storage; without one a bet lasts as long as the page is open.
function stored(act) {
  try {
    return act(localStorage);
  } catch {
    return null;
  }
}

export function startBet(box) {
  const [answer, why] = [box.querySelector(".answer"), box.querySelector("textarea")];
  const choices = [...box.querySelectorAll("[data-choice]")];
  let bet = {};
  function take(changes) {
    bet = { ...bet, ...changes };
    stored((held) => held.setItem(KEY + box.id, JSON.stringify(bet)));
    if (!bet.choice) return;
    for (const each of choices)
      each.setAttribute("aria-pressed", String(each.dataset.choice === bet.choice));
    const right = bet.choice === answer.dataset.right;
    box.querySelector(".verdict").textContent =
      right ? "You bet on it, and it is so." : "It comes out otherwise.";
    answer.open = true;
  }
  take(stored((held) => JSON.parse(held.getItem(KEY + box.id))));
  why.value = bet.why ?? "";
  why.addEventListener("input", () => take({ why: why.value }));
  for (const each of choices)
    each.addEventListener("click", () => {
      take({ choice: each.dataset.choice });
      answer.querySelector("summary").focus({ preventScroll: true });
    });
}
