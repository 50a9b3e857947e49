/* Bets: choose, say why, commit, then see the measurement. What tells a bet's answer (the live
 * figure's first sight, and the text that follows the bet) is veiled until the reader has bet or has
 * asked to be shown. Kept in the browser's own store, under the page's name. */
"use strict";

const Bets = (() => {
  const { number } = Plot;
  const $ = (id) => document.getElementById(id);
  const STORE = "contact-chapter:";
  const shownNow = new Set(); // where the store is closed to us: until the page is closed

  function remember(id, value) {
    try {
      if (value === null) localStorage.removeItem(STORE + id);
      else localStorage.setItem(STORE + id, JSON.stringify(value));
    } catch {
      // a private window
    }
  }

  function recall(id) {
    try {
      return JSON.parse(localStorage.getItem(STORE + id));
    } catch {
      return null;
    }
  }

  // Whether the answer of an exercise may be seen. An exercise that is not on the page veils nothing.
  const open = (id) => shownNow.has(id) || !$(id) || recall(id) !== null;

  function lift(id) {
    shownNow.add(id);
    document.documentElement.classList.add(`open-${id}`);
    document.dispatchEvent(new Event("bet"));
  }

  function show(id) {
    remember(id, { shown: true });
    lift(id);
  }

  // The measurement an exercise is about, made now by the engine, as a table.
  function measure(id) {
    const { dt, steps, columns, shows } = PAGE.exercises[id];
    const state = { ...State.DEFAULTS, ...State.ownKnobs("drop"), dt };
    const measured = columns.map(([, model, mass]) => {
      const scene = { ...State.sceneOf(state), mass: [mass] };
      return ContactEngine.quality(
        ContactEngine.runModel(model, scene, State.knobsOf(state), steps),
        scene,
        null,
      );
    });
    const told = (q, name) => (name === "blew_up" ? (q.blew_up ? "EXPLODED" : "ok") : number(q[name]));
    const rows = shows.map(([name, words]) => [words, ...measured.map((q) => told(q, name))]);
    return Inside.tableOf(["measured", ...columns.map(([title]) => title)], rows);
  }

  // An element with a text of the reader's, which is never read as HTML.
  function texted(tag, text, className) {
    const node = document.createElement(tag);
    node.textContent = text;
    if (className) node.className = className;
    return node;
  }

  function table(id) {
    const node = document.createElement("div");
    node.innerHTML = measure(id);
    return node.firstChild;
  }

  function again(section, form, result) {
    const id = section.dataset.exercise;
    const button = texted("button", "Clear my answer");
    button.type = "button";
    button.addEventListener("click", () => {
      remember(id, null);
      delete form.dataset.done;
      form.reset();
      for (const input of form.elements) input.disabled = false;
      result.hidden = true;
      result.replaceChildren();
      form.querySelector("input").focus();
    });
    return button;
  }

  function reveal(section, answer, focus) {
    const id = section.dataset.exercise;
    const form = section.querySelector("form");
    const result = $(`${id}-result`);
    const copies = $(`${id}-reveal`).content.querySelectorAll("[data-why]");
    const reasons = [...copies].map((node) => Object.assign(node.cloneNode(true), { className: "why" }));
    const mine = reasons.find((node) => node.dataset.why === answer.choice);
    const right = reasons.find((node) => "right" in node.dataset);
    const others = reasons.filter((node) => node !== mine && node !== right);
    const told = mine === right ? "The measurement agrees." : `The measurement says ${right.dataset.why}.`;
    form.dataset.done = "";
    for (const input of form.elements) if (input.type !== "fieldset") input.disabled = true;
    result.replaceChildren(
      texted("h4", `You predicted ${answer.choice}. ${told}`),
      texted("p", `Your reason: ${answer.why}`, "yours"),
      table(id),
      texted("h4", "Why"),
      right,
      ...(mine === right ? [] : [texted("h4", "Why not what you chose"), mine]),
      ...(others.length ? [texted("h4", "Why not the others"), ...others] : []),
      again(section, form, result),
    );
    result.hidden = false;
    if (focus) result.focus();
  }

  function commit(section, form) {
    const id = section.dataset.exercise;
    const chosen = form.querySelector("input:checked");
    const why = $(`${id}-why`).value.trim();
    const error = $(`${id}-error`);
    error.textContent = "";
    if (!chosen) {
      error.textContent = "Choose one first: predicting after the run teaches nothing.";
      form.querySelector("input").focus();
    } else if (why.length < 10) {
      error.textContent = "Say in a sentence why you think so, then commit.";
      $(`${id}-why`).focus();
    } else {
      const answer = { choice: chosen.value, why };
      remember(id, answer);
      lift(id);
      reveal(section, answer, true);
    }
  }

  // A bet of an earlier visit.
  function restore(section, form) {
    const id = section.dataset.exercise;
    const kept = recall(id);
    if (!kept || !kept.choice) return;
    const radio = form.querySelector(`input[value="${CSS.escape(kept.choice)}"]`);
    if (!radio) return;
    radio.checked = true;
    $(`${id}-why`).value = kept.why;
    reveal(section, kept, false);
  }

  function start() {
    for (const section of document.querySelectorAll("[data-exercise]")) {
      const form = section.querySelector("form.bet");
      if (!form) continue;
      restore(section, form);
      form.addEventListener("submit", (event) => {
        event.preventDefault();
        commit(section, form);
      });
    }
    for (const button of document.querySelectorAll("button[data-show]"))
      button.addEventListener("click", () => show(button.dataset.show));
  }

  return { start, open, show };
})();
