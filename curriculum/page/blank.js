/* Exercise 2 in the page: the reader fills the two clamps, which are tried on the inputs that
 * checks.py uses, beside the slips that it knows, and then drop a ball. */
import { compile } from "./arithmetic.js";
import { number, plain } from "./draw.js";
import { runModel, series } from "./engine.js";
import { knobsOf, sceneOf, startOf } from "./store.js";

const close = (a, b, within) => Math.abs(a - b) <= within * Math.max(1, Math.abs(b));

// What to say of a formula: {right, words}. A slip is known by what it gives.
function judge(formula, { inputs, right, slips }) {
  const results = inputs.map(formula);
  const at = results.findIndex((value, k) => !close(value, right[k], 1e-9));
  if (at < 0) return { right: true, words: `Right, on all ${inputs.length} inputs.` };
  const same = ([values]) => values.every((value, k) => close(results[k], value, 1e-3));
  const [, meaning = "a slip that this page does not know"] = slips.find(same) || [];
  const given = Object.entries(inputs[at]).map(([name, value]) => `${name} = ${plain(value)}`);
  const wrong = `it gives ${number(results[at])}, and ${number(right[at])} is right`;
  return { right: false, words: `For ${given.join(", ")} ${wrong}: ${meaning}.` };
}

// How the drop ends with the reader's two lines in place of the page's own.
function tried({ penalty_normal_force: force, project_impulse: impulse }) {
  const values = startOf("drop");
  const scene = sceneOf(values);
  const own = {
    clampForce: (depth, v_n, stiffness, damping) => force({ depth, v_n, stiffness, damping }),
    project: (lam, dlam) => impulse({ lam, dlam }),
  };
  const ends = ["penalty", "lcp"].map((model) => {
    const { gap } = series(runModel(model, scene, { ...knobsOf(values), ...own }, 800), scene);
    const where = gap[800] < 0 ? "r inside" : "r above the table";
    return `${model} ends ${number(Math.abs(gap[800]))} ${where}`;
  });
  return `With your lines the drop of 1.6 s runs: ${ends.join(", ")}.`;
}

export function startBlank(form, cases) {
  const fields = [...form.querySelectorAll("textarea")];
  form.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" || event.target.tagName !== "TEXTAREA") return;
    event.preventDefault();
    form.requestSubmit();
  });
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const formulas = {};
    const verdicts = fields.map((field) => {
      try {
        const each = cases[field.name];
        formulas[field.name] = compile(field.value, Object.keys(each.inputs[0]));
        return judge(formulas[field.name], each);
      } catch (error) {
        return { right: false, words: error.message };
      }
    });
    fields.forEach((field, k) => {
      document.getElementById(`${field.id}-said`).textContent = verdicts[k].words;
      field.setAttribute("aria-invalid", String(!verdicts[k].right));
    });
    const end = verdicts.every(({ right }) => right) ? " Both clamps hold." : "";
    const both = fields.every(({ name }) => formulas[name]);
    form.querySelector(".tried").textContent = both ? `${tried(formulas)}${end}` : "";
  });
}
