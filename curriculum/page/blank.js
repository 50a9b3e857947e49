/* Exercise 2 in the page: the two clamps, typed by the reader, tried on the cases of checks.py and in
 * two scenes in which they matter, beside the right ones. */
"use strict";

const Blank = (() => {
  const { number, plain, plot, el, words, ball, arrow, table } = Plot;
  const $ = (id) => document.getElementById(id);
  const LAW = {
    penalty_normal_force: {
      names: ["depth", "v_n", "stiffness", "damping"],
      right: (a) => ContactEngine.penaltyNormalForce(a.depth, a.v_n, a.stiffness, a.damping),
    },
    project_impulse: {
      names: ["lam", "dlam"],
      right: (a) => ContactEngine.projectImpulse(a.lam, a.dlam),
    },
  };

  // The first case that a reader's function gets wrong, in words; null if it gets all right.
  function firstWrong(name, yours) {
    for (const inputs of PAGE.blank[name]) {
      const [got, wanted] = [yours(inputs), LAW[name].right(inputs)];
      if (Math.abs(got - wanted) <= 1e-9) continue;
      const told = LAW[name].names.map((key) => `${key} = ${plain(inputs[key])}`);
      return `With ${told.join(", ")} it gives ${number(got)}; right is ${number(wanted)}.`;
    }
    return null;
  }

  // ---- two scenes: a ball that should leave its spring, and a ball that falls into a groove

  function springPlot(force, width) {
    const state = { ...State.DEFAULTS, ...State.ownKnobs("drop"), dt: 0.001 };
    const scene = State.sceneOf(state);
    const clampForce = (depth, v_n, stiffness, damping) => force({ depth, v_n, stiffness, damping });
    const runs = [undefined, clampForce].map((law) =>
      ContactEngine.runModel("penalty", scene, { ...State.knobsOf(state), clampForce: law }, 1200),
    );
    const gap = (run) => Array.from(run.y, (y) => y / PAGE.radius - 1);
    const chart = plot({
      id: "blank-spring",
      width,
      height: 190,
      x: { domain: [0.4, 1.2], ticks: Plot.steps(0.4, 1.2, 4), label: "time (s)" },
      y: { domain: [-0.5, 1], ticks: Plot.steps(-0.5, 1, 3), label: "gap / r; dashed green: the right one" },
      rules: [{ y: 0 }],
      lines: [
        { model: "exact", xs: runs[0].t, ys: gap(runs[0]), class: "thin" },
        { model: "penalty", xs: runs[1].t, ys: gap(runs[1]) },
      ],
    });
    return Plot.picture(
      width,
      190,
      "The dropped ball by your spring, and by the right one (dashed)",
      chart.markup,
    );
  }

  function groove(project) {
    const [vx, vy] = [
      [0.5, 0, 0],
      [-1, 0, 0],
    ];
    const contacts = [1, 2].map((j) => ({ i: 0, j, nx: j === 1 ? 0.6 : -0.6, ny: 0.8, depth: 0 }));
    const rows = ContactEngine.makeRows(contacts, [1, Infinity, Infinity], [0, 0], [0, 0]);
    ContactEngine.solveContacts(rows, vx, vy, { iters: 50, project });
    return [vx[0], vy[0]];
  }

  function groovePlot(project, width) {
    const half = width / 2;
    const parts = [
      ["the right one", groove(ContactEngine.projectImpulse)],
      ["yours", groove((lam, dlam) => project({ lam, dlam }))],
    ].map(([title, [vx, vy]], k) => {
      const [x, y, r] = [half * (k + 0.5), 90, Math.min(27, half / 6)];
      const size = Math.hypot(vx, vy);
      const limit = Math.min(1, 1.5 / (size || 1)) * 60;
      return [
        words(title, { x, y: 16, class: "axis-name", "text-anchor": "middle" }),
        ...[-1, 1].map((side) => ball("fixed", x + side * 1.2 * r, y + 1.6 * r, r, "body")),
        ball("lcp", x, y, r),
        Number.isFinite(size) ? arrow("weight", x, y, limit * vx, -limit * vy) : "",
        words(`${number(size)} m/s`, { x, y: 176, class: "tick", "text-anchor": "middle" }),
      ].join("");
    });
    return Plot.picture(width, 190, "A ball that fell into a groove, its speed afterwards", ...parts);
  }

  const SCENES = { penalty_normal_force: springPlot, project_impulse: groovePlot };

  // Read one blank, say how it does, and draw its scene. Returns whether it is right.
  function tryOne(name) {
    const field = $(`blank-${name}`);
    const said = $(`blank-${name}-said`);
    const drawing = $(`blank-${name}-drawing`);
    let yours = null;
    try {
      yours = Arithmetic.parse(field.value, LAW[name].names);
    } catch (error) {
      said.textContent = error.message;
      drawing.innerHTML = "";
      field.setAttribute("aria-invalid", "true");
      return false;
    }
    const wrong = firstWrong(name, yours);
    field.setAttribute("aria-invalid", String(wrong !== null));
    said.textContent = wrong === null ? `Right in all ${PAGE.blank[name].length} cases.` : wrong;
    drawing.innerHTML = SCENES[name](yours, Math.max(256, Math.min(480, drawing.parentElement.clientWidth)));
    return wrong === null;
  }

  function start() {
    const form = $("blank");
    if (!form) return;
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const right = Object.keys(LAW).map(tryOne);
      $("blank-said").textContent = right.every(Boolean)
        ? "Both clamps hold. In the terminal, pytest checks.py -k ex2 asks the same."
        : "";
    });
  }

  return { start, firstWrong, LAW };
})();
