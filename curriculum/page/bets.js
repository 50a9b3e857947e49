/* Bets: one click makes one, and lifts the veils over what would have told the answer. The reason
 * may be written after. What was bet is kept in this browser. */

const KEY = "contact-chapter:";

// What `act` gives of the browser's storage; without one a bet lasts as long as the page is open.
function stored(act) {
  try {
    return act(localStorage);
  } catch {
    return null;
  }
}

export class Bets {
  #made = new Map(); // id: {choice, why} or {shown: true}
  #hear = () => {};

  constructor(ids) {
    for (const id of ids) {
      const before = stored((held) => JSON.parse(held.getItem(KEY + id)));
      if (before) this.#made.set(id, before);
      if (document.getElementById(id)) this.#listen(id, document.getElementById(id));
      if (before) this.#show(id);
    }
    document.addEventListener("click", (event) => {
      const button = event.target.closest("button[data-show]");
      if (button) this.#reveal(button);
    });
  }

  open = (id) => this.#made.has(id);
  onOpen = (hear) => (this.#hear = hear);

  #listen(id, box) {
    for (const button of box.querySelectorAll("button[data-choice]"))
      button.addEventListener("click", () => {
        this.make(id, { choice: button.dataset.choice });
        document.getElementById(`${id}-result`).focus({ preventScroll: true });
      });
    const why = box.querySelector("textarea");
    why.value = (this.#made.get(id) || {}).why || "";
    why.addEventListener("input", () => this.#keep(id, { ...this.#made.get(id), why: why.value }));
  }

  #keep(id, bet) {
    this.#made.set(id, bet);
    stored((held) => held.setItem(KEY + id, JSON.stringify(bet)));
  }

  make(id, bet) {
    this.#keep(id, bet);
    this.#show(id);
    this.#hear();
  }

  /* Open without a bet: what comes out from behind the veil stands where the bar was, whatever
   * opens above it, and takes the focus. */
  #reveal(button) {
    const veil = button.closest(".veiled");
    const { top } = veil.getBoundingClientRect();
    const { style } = document.documentElement;
    style.overflowAnchor = "none"; // the browser shall not correct it a second time
    this.make(button.dataset.show, { shown: true });
    window.scrollBy(0, veil.getBoundingClientRect().top - top);
    requestAnimationFrame(() => (style.overflowAnchor = ""));
    const answer = veil.querySelector(".answer");
    answer.tabIndex = -1;
    answer.focus({ preventScroll: true });
  }

  #show(id) {
    document.documentElement.classList.add(`open-${id}`);
    const box = document.getElementById(id);
    if (!box) return;
    const { choice } = this.#made.get(id);
    box.classList.add("decided");
    for (const button of box.querySelectorAll("button[data-choice]"))
      button.setAttribute("aria-pressed", String(button.dataset.choice === choice));
    for (const reason of box.querySelectorAll("[data-reason]"))
      reason.hidden = !(reason.dataset.reason === choice || "right" in reason.dataset);
    const right = box.querySelector("[data-right]").dataset.reason;
    const words = choice === right ? "You bet on it, and it is so." : "It comes out otherwise.";
    box.querySelector(".verdict").textContent = choice ? words : "This is how it comes out.";
  }
}
