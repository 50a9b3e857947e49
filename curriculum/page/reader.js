/* Copying, the contents, and the start of everything. */
"use strict";

const Reader = (() => {
  const $ = (id) => document.getElementById(id);
  const say = (words) => ($("said").textContent = words);

  // Copying where the clipboard is closed to the page: through a text field.
  function copyOldWay(text, button) {
    const area = document.createElement("textarea");
    area.className = "hidden";
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    button.focus();
    return done;
  }

  async function copy(text, button) {
    let done = true;
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      done = copyOldWay(text, button);
    }
    const label = button.firstChild;
    if (!button.dataset.label) button.dataset.label = label.textContent;
    label.textContent = done ? "Copied" : "Not allowed here";
    say(done ? "Copied." : "The browser does not allow copying here.");
    setTimeout(() => (label.textContent = button.dataset.label), 2000);
  }

  function startCopying() {
    for (const button of document.querySelectorAll("button[data-copy]"))
      button.addEventListener("click", () => copy($(button.dataset.copy).textContent, button));
    $("copy-link").addEventListener("click", (event) => copy(Figure.address(), event.currentTarget));
  }

  // Mark the section being read in the contents.
  function startContents() {
    const links = new Map([...document.querySelectorAll(".contents a")].map((a) => [a.hash.slice(1), a]));
    const heads = [...links.keys()].map($).filter(Boolean);
    const mark = () => {
      const above = heads.filter((head) => head.getBoundingClientRect().top < 0.3 * window.innerHeight);
      const here = above.length ? above[above.length - 1].id : null;
      for (const [id, link] of links) {
        if (id === here) link.setAttribute("aria-current", "true");
        else link.removeAttribute("aria-current");
      }
    };
    let waiting = false;
    const later = () => {
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        mark();
      });
    };
    window.addEventListener("scroll", later, { passive: true });
    for (const link of links.values()) link.addEventListener("click", () => ($("contents").open = false));
    mark();
  }

  // On paper nothing can be unfolded: the commands of the exercises are, before it is printed.
  function startPrinting() {
    const folded = () => [...document.querySelectorAll("details.terminal:not([open])")];
    let opened = [];
    window.addEventListener("beforeprint", () => {
      opened = folded();
      for (const each of opened) each.open = true;
    });
    window.addEventListener("afterprint", () => {
      for (const each of opened) each.open = false;
    });
  }

  function start() {
    startCopying();
    startContents();
    startPrinting();
  }
  return { start };
})();

// What needs JavaScript is shown only where it runs to the end.
try {
  for (const part of [Figure, Bets, Links, LiveSmall, Puzzle, Blank, Sandbox, Reader]) part.start();
} catch (error) {
  document.documentElement.className = "no-js";
  throw error;
}
