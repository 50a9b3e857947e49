/* What a reader does with the page: copy, commit to a prediction, see where in the text they are. */
"use strict";

const Reader = (() => {
  const { html, number } = Draw;
  const $ = (id) => document.getElementById(id);
  const say = (words) => {
    $("said").textContent = words;
  };

  // ---- copying

  async function copy(text, button) {
    let done = true;
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      const area = html("textarea", { "aria-hidden": "true", class: "hidden" });
      area.value = text;
      document.body.append(area);
      area.select();
      done = document.execCommand("copy");
      area.remove();
      button.focus();
    }
    const label = button.firstChild;
    if (!button.dataset.label) button.dataset.label = label.textContent;
    label.textContent = done ? "Copied" : "Not allowed here";
    say(done ? "Copied." : "The browser does not allow copying here.");
    setTimeout(() => {
      label.textContent = button.dataset.label;
    }, 2000);
  }

  function startCopying() {
    for (const button of document.querySelectorAll("button[data-copy]")) {
      button.addEventListener("click", () => copy($(button.dataset.copy).textContent, button));
    }
    $("copy-link").addEventListener("click", (event) => copy(Figure.address(), event.currentTarget));
  }

  // ---- exercises: choose, say why, commit, then see the measurement

  const STORE = "contact-chapter:";
  const remember = (id, value) => {
    try {
      if (value === null) localStorage.removeItem(STORE + id);
      else localStorage.setItem(STORE + id, JSON.stringify(value));
    } catch {
      /* a private window: the answer is kept until the page is closed */
    }
  };
  const recall = (id) => {
    try {
      return JSON.parse(localStorage.getItem(STORE + id));
    } catch {
      return null;
    }
  };

  // The measurement an exercise is about, made now by the engine, in words and a table.
  function measure(id) {
    const { dt, steps } = PAGE.exercises[id];
    const data = PAGE.scenes.drop;
    const scene = {
      x: [0],
      y: data.starts[0],
      vx: [0],
      vy: [0],
      mass: [1],
      radius: [PAGE.radius],
      restitution: data.restitution,
    };
    const knobs = { ...PAGE.defaults, dt, damping: data.damping, restitution: data.restitution };
    const measured = ["penalty", "lcp"].map((model) =>
      ContactEngine.quality(ContactEngine.runModel(model, scene, knobs, steps), scene, null),
    );
    const rows = PAGE.exercises[id].shows.map(([name, words]) => [
      words,
      ...measured.map((q) => (name === "blew_up" ? (q.blew_up ? "EXPLODED" : "ok") : number(q[name]))),
    ]);
    return Figure.tableOf(["measured", "penalty", "lcp"], rows);
  }

  function reveal(section, answer, focus) {
    const id = section.dataset.exercise;
    const form = section.querySelector("form");
    const result = $(`${id}-result`);
    const reasons = [...$(`${id}-reveal`).content.querySelectorAll("[data-why]")].map((node) =>
      node.cloneNode(true),
    );
    const mine = reasons.find((node) => node.dataset.why === answer.choice);
    const right = reasons.find((node) => "right" in node.dataset);
    const good = mine === right;
    form.dataset.done = "";
    for (const input of form.elements) if (input.type !== "fieldset") input.disabled = true;
    const again = html("button", { type: "button" }, "Clear my answer");
    again.addEventListener("click", () => {
      remember(id, null);
      delete form.dataset.done;
      form.reset();
      for (const input of form.elements) input.disabled = false;
      result.hidden = true;
      result.replaceChildren();
      form.querySelector("input").focus();
    });
    const others = reasons.filter((node) => node !== mine && node !== right);
    result.replaceChildren(
      html(
        "h4",
        {},
        good
          ? `You predicted ${answer.choice}. The measurement agrees.`
          : `You predicted ${answer.choice}. The measurement says ${right.dataset.why}.`,
      ),
      html("p", { class: "yours" }, `Your reason: ${answer.why}`),
      measure(id),
      html("h4", {}, "Why"),
      wrap(right),
      ...(good ? [] : [html("h4", {}, "Why not what you chose"), wrap(mine)]),
      ...(others.length ? [html("h4", {}, "Why not the others"), ...others.map(wrap)] : []),
      again,
    );
    result.hidden = false;
    if (focus) result.focus();
  }

  function wrap(node) {
    node.className = "why";
    return node;
  }

  function startExercises() {
    for (const section of document.querySelectorAll("[data-exercise]")) {
      const form = section.querySelector("form");
      if (!form) continue;
      const id = section.dataset.exercise;
      const kept = recall(id);
      if (kept && kept.choice) {
        const radio = form.querySelector(`input[value="${CSS.escape(kept.choice)}"]`);
        if (radio) {
          radio.checked = true;
          $(`${id}-why`).value = kept.why;
          reveal(section, kept, false);
        }
      }
      form.addEventListener("submit", (event) => {
        event.preventDefault();
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
          reveal(section, answer, true);
        }
      });
    }
  }

  // ---- contents: mark the section being read

  function startContents() {
    const links = new Map([...document.querySelectorAll(".contents a")].map((a) => [a.hash.slice(1), a]));
    const heads = [...links.keys()].map($).filter(Boolean);
    const mark = () => {
      let here = null;
      for (const head of heads)
        if (head.getBoundingClientRect().top < 0.3 * window.innerHeight) here = head.id;
      if (window.innerHeight + window.scrollY > document.documentElement.scrollHeight - 4)
        here = heads[heads.length - 1].id;
      for (const [id, link] of links) {
        if (id === here) link.setAttribute("aria-current", "true");
        else link.removeAttribute("aria-current");
      }
    };
    let waiting = false;
    window.addEventListener(
      "scroll",
      () => {
        if (waiting) return;
        waiting = true;
        requestAnimationFrame(() => {
          waiting = false;
          mark();
        });
      },
      { passive: true },
    );
    mark();
  }

  function start() {
    startCopying();
    startExercises();
    startContents();
  }
  return { start };
})();

// What needs JavaScript is shown only where it runs to the end.
document.documentElement.className = "js";
try {
  Figure.start();
  Figures.start();
  Reader.start();
} catch (error) {
  document.documentElement.className = "no-js";
  throw error;
}
