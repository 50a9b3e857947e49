/* The knobs of the live figure, and what stands folded beneath it: measures, one step from inside. */
"use strict";

const Controls = (() => {
  const { plain } = Plot;
  const { KNOBS } = State;
  const $ = (id) => document.getElementById(id);

  function showKnob(name, state) {
    const value = State.shownValue(state, name);
    const slider = $(`${name}-range`);
    const field = $(`${name}-number`);
    slider.value = String(State.toSlider(name, value));
    slider.setAttribute("aria-valuetext", `${plain(value)} ${KNOBS[name].unit}`.trim());
    if (document.activeElement !== field) field.value = plain(value);
    field.setAttribute("aria-invalid", "false");
    $(`${name}-error`).textContent = "";
  }

  function show(state) {
    for (const name of Object.keys(KNOBS)) showKnob(name, state);
    for (const name of ["scene", "contact"]) {
      const radio = document.querySelector(`#figure input[name="${name}"][value="${state[name]}"]`);
      if (radio) radio.checked = true;
    }
    for (const knob of document.querySelectorAll("#figure .knob[data-models]"))
      knob.hidden = !knob.dataset.models.split(" ").includes(state.contact);
    $("no-knob").hidden = state.contact !== "exact" || state.restitution > 0;
    $("seed").value = String(state.seed);
  }

  function listenKnob(name, set) {
    const knob = KNOBS[name];
    const field = $(`${name}-number`);
    Object.assign($(`${name}-range`), State.sliderRange(knob));
    $(`${name}-range`).addEventListener("input", (event) =>
      set({ [name]: State.fromSlider(name, Number(event.target.value)) }),
    );
    field.addEventListener("change", () => {
      if (State.allowed(name, field.value)) return set({ [name]: Number(field.value) });
      field.setAttribute("aria-invalid", "true");
      const kind = knob.whole ? "a whole number from " : "";
      $(`${name}-error`).textContent =
        `${field.value || "Nothing"} is not allowed; allowed: ${kind}${plain(knob.low)} to ${plain(knob.high)}.`;
    });
    field.addEventListener("blur", () => {
      if (field.getAttribute("aria-invalid") !== "true")
        field.value = plain(State.shownValue(Figure.state, name));
    });
  }

  function listen(set) {
    for (const name of Object.keys(KNOBS)) listenKnob(name, set);
    for (const radio of document.querySelectorAll('#figure input[name="scene"]'))
      radio.addEventListener("change", () => set({ scene: radio.value, ...State.ownKnobs(radio.value) }));
    for (const radio of document.querySelectorAll('#figure input[name="contact"]'))
      radio.addEventListener("change", () => set({ contact: radio.value }));
    $("seed").addEventListener("change", (event) => set({ seed: Number(event.target.value) }));
    $("reset").addEventListener("click", () =>
      set({ ...State.DEFAULTS, ...State.ownKnobs(State.DEFAULTS.scene) }),
    );
  }

  return { show, listen };
})();

const Inside = (() => {
  const { number, plain, escape } = Plot;
  const { MODELS } = ContactEngine;
  const $ = (id) => document.getElementById(id);
  const opened = () => $("inside").open;

  const row = (cells, tag) =>
    `<tr><th scope="row">${cells[0]}</th>${cells
      .slice(1)
      .map((c) => `<${tag}>${c}</${tag}>`)
      .join("")}</tr>`;

  // A table as HTML text, in a box that scrolls by itself where it is narrow.
  function tableOf(head, rows) {
    const names = head.map((h) => `<th scope="col">${escape(h)}</th>`).join("");
    const body = rows.map((cells) => row(cells.map(escape), "td")).join("");
    return (
      `<div class="scroll" tabindex="0" role="group" aria-label="Table: ${escape(head.join(", "))}">` +
      `<table><thead><tr>${names}</tr></thead><tbody>${body}</tbody></table></div>`
    );
  }

  // What the figure still keeps to itself, these tables keep as well.
  const told = (model) => !Figure.hiddenBy() && !(model === "soft" && !Bets.open("ex4"));
  const LATER = "<p>After the bet.</p>";

  const MEASURES = [
    ["deepest / r", "max_penetration_frac"],
    ["rest gap / r", "rest_gap_frac"],
    ["energy above start", "energy_excess"],
    ["energy put in", "contact_energy"],
    ["height error / r", "height_error_frac"],
    ["of it in flight", "flight_error_frac"],
    ["jitter / r", "rest_jitter"],
  ];

  function verdict(q, dt) {
    return q.blew_up ? `EXPLODED at ${number(q.blew_up_step * dt)} s` : "ok";
  }

  // The measures of all models over the whole run.
  function results(state, now) {
    $("command").textContent = State.command(state, now.steps);
    if (!opened()) return;
    const shown = MODELS.filter(told);
    const rows = MEASURES.map(([words, key]) => [words, ...shown.map((m) => number(now.quality[m][key]))]);
    rows.push(["verdict", ...shown.map((m) => verdict(now.quality[m], state.dt))]);
    $("results").innerHTML = tableOf(["measured over 4 s", ...shown], rows);
  }

  const contactName = (c) => (c.j < 0 ? `${c.i + 1} on table` : `${c.j + 1} on ${c.i + 1}`);

  function penaltyInside(now, at) {
    const springs = [];
    ContactEngine.penaltyStep(ContactEngine.stateAt(now.runs.penalty, at), now.scene, now.knobs, springs);
    if (!springs.length) return "<p>No contact: only gravity acts.</p>";
    const rows = springs.map((s) => [contactName(s), number(1000 * s.gap), number(s.speed), number(s.force)]);
    return tableOf(["contact", "gap (mm)", "v_n (m/s)", "force (N)"], rows);
  }

  // The contacts of lcp or soft, and their impulses after every sweep.
  function sweepsInside(model, now, at) {
    const trace = {};
    ContactEngine.STEP[model](ContactEngine.stateAt(now.runs[model], at), now.scene, now.knobs, trace);
    if (!trace.contacts.length) return "<p>No contact: only gravity acts.</p>";
    const contacts = trace.contacts.map((c) => [
      contactName(c),
      number(1000 * c.gap),
      number(c.speed),
      number(c.target),
    ]);
    const shown = trace.sweeps.length > 30 ? trace.sweeps.slice(0, 30) : trace.sweeps;
    const sweeps = shown.map((lam, s) => [String(s + 1), ...lam.map((v) => number(v, 6))]);
    const names = trace.contacts.map((c) => `lam, ${contactName(c)}`);
    return (
      tableOf(["contact", "gap (mm)", "v_n (m/s)", "target (m/s)"], contacts) +
      tableOf(["sweep", ...names], sweeps) +
      `<p>${trace.sweeps.length} sweeps; lam is in N s.</p>`
    );
  }

  const eventWords = (e) => {
    const who = e.j < 0 ? `ball ${e.i + 1} meets the table` : `ball ${e.j + 1} meets ball ${e.i + 1}`;
    const then = e.leaving > 1e-7 ? `leaves at ${number(e.leaving)} m/s` : "stays";
    return `${number(e.t, 7)} s: ${who} at ${number(e.closing)} m/s, ${then}`;
  };

  function exactInside(now, at, dt) {
    const events = now.runs.exact.events.filter((e) => e.t > at * dt - 1e-12 && e.t <= (at + 1) * dt);
    if (!events.length) return "<p>No event in this step: every ball follows its path or stays at rest.</p>";
    const items = events.slice(0, 20).map((e) => `<li>${escape(eventWords(e))}</li>`);
    const more = events.length > 20 ? `<p>and ${events.length - 20} more impacts in this step</p>` : "";
    return `<ol>${items.join("")}</ol>${more}`;
  }

  // What each model does in the step that begins at row `at`.
  function write(state, now, at) {
    if (!opened()) return;
    results(state, now);
    const from = Math.min(at, now.steps - 1);
    $("inside-when").textContent =
      `The step from t = ${plain(from * state.dt)} s to ${plain((from + 1) * state.dt)} s. Balls are numbered from the table up.`;
    const inside = {
      penalty: () => penaltyInside(now, from),
      lcp: () => sweepsInside("lcp", now, from),
      soft: () => sweepsInside("soft", now, from),
      exact: () => exactInside(now, from, state.dt),
    };
    for (const model of MODELS) $(`inside-${model}`).innerHTML = told(model) ? inside[model]() : LATER;
  }

  return { write, results, tableOf, verdict };
})();
