/* Exercise 2 in the page: the reader fills the two clamps, which are tried on the inputs that checks.py
 * uses, and then drop a ball. */
import { compile } from "./arithmetic.js";
import { number, plain } from "./draw.js";
import { MODELS, runModel, series } from "./engine.js";
import { knobsOf, sceneOf, startOf } from "./store.js";

const RIGHT = {
  penalty_normal_force: ({ depth, v_n, stiffness, damping }) => Math.max(0, stiffness * depth - damping * v_n),
  project_impulse: ({ lam, dlam }) => Math.max(0, lam + dlam),
};
// What the slips that one makes here give, and what to ask oneself then.
const SLIPS = {
  penalty_normal_force: [
    ["stiffness * depth - damping * v_n", "Where the ball leaves quickly this pulls it back. May a table pull?"],
    ["max(0, stiffness * depth + damping * v_n)", "v_n > 0 is separating: does a damper push harder then?"],
    ["max(0, stiffness * depth) - damping * v_n", "The spring is clamped, the damper is not: together they may still pull."],
  ],
  project_impulse: [
    ["lam + dlam", "The sum may become negative here: the contact would pull."],
    ["lam + max(0, dlam)", "This clamps the correction: too large a push can never be taken back."],
    ["max(0, dlam)", "This forgets the impulse that the contact has given already."],
  ],
};

const close = (a, b) => Math.abs(a - b) <= 1e-9 * Math.max(1, Math.abs(b));
const agrees = (f, g, cases) => cases.every((each) => close(f(each), g(each)));

// What to say of a formula: {right, words}.
function judge(name, formula, cases) {
  const names = Object.keys(cases[0]);
  const wrong = cases.find((each) => !close(formula(each), RIGHT[name](each)));
  if (!wrong) return { right: true, words: `Right, on all ${cases.length} inputs.` };
  const slip = SLIPS[name].find(([text]) => agrees(compile(text, names), formula, cases));
  const given = names.map((each) => `${each} = ${plain(wrong[each])}`).join(", ");
  const words = `For ${given} it gives ${number(formula(wrong))}, and ${number(RIGHT[name](wrong))} is right.`;
  return { right: false, words: slip ? `${words} ${slip[1]}` : words };
}

// How the drop ends with the reader's two lines in place of the page's own.
function tried(formulas) {
  const values = startOf("drop");
  const scene = sceneOf(values);
  const { penalty_normal_force: force, project_impulse: impulse } = formulas;
  const clampForce = force && ((depth, v_n, stiffness, damping) => force({ depth, v_n, stiffness, damping }));
  const project = impulse && ((lam, dlam) => impulse({ lam, dlam }));
  const ends = MODELS.slice(0, 2).map((model) => {
    const { gap } = series(runModel(model, scene, { ...knobsOf(values), clampForce, project }, 800), scene);
    return `${model} ends ${number(gap[800])} r above the table`.replace(/ −(\S+) r above/, " $1 r inside");
  });
  return `With your lines the drop of 1.6 s runs: ${ends.join(", ")}.`;
}

export function startBlank(form, cases) {
  const fields = [...form.querySelectorAll("input")];
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const formulas = {};
    let all = true;
    for (const field of fields) {
      const name = field.name;
      const said = document.getElementById(`${field.id}-said`);
      try {
        formulas[name] = compile(field.value, Object.keys(cases[name][0]));
        const { right, words } = judge(name, formulas[name], cases[name]);
        said.textContent = words;
        all = all && right;
      } catch (error) {
        said.textContent = error.message;
        all = false;
      }
      field.setAttribute("aria-invalid", String(!/^Right/.test(said.textContent)));
    }
    const both = fields.every((field) => formulas[field.name]);
    form.querySelector(".tried").textContent = both ? `${tried(formulas)}${all ? " Both clamps hold." : ""}` : "";
  });
}
