/* Exercise 2 in the page: the reader fills the two clamps, which are tried on the inputs that
 * checks.py uses, and then drop a ball. */
import { compile } from "./arithmetic.js";
import { number, plain } from "./draw.js";
import { runModel, series } from "./engine.js";
import { knobsOf, sceneOf, startOf } from "./store.js";

const RIGHT = {
  penalty_normal_force: "max(0, k * depth - c * v_n)",
  project_impulse: "max(0, lam + dlam)",
};
// The slips that one makes here, and what to ask oneself then.
const SLIPS = {
  penalty_normal_force: [
    ["k * depth - c * v_n", "Where the ball leaves quickly this pulls it back. May a table pull?"],
    ["max(0, k * depth + c * v_n)", "v_n > 0 is separating: does a damper push harder then?"],
    [
      "max(0, k * depth) - c * v_n",
      "The spring is clamped, the damper is not: together they may still pull.",
    ],
  ],
  project_impulse: [
    ["lam + dlam", "The sum may become negative here: the contact would pull."],
    [
      "lam + max(0, dlam)",
      "This clamps the correction: too large a push can never be taken back.",
    ],
    ["max(0, dlam)", "This forgets the impulse that the contact has given already."],
  ],
};

const close = (a, b) => Math.abs(a - b) <= 1e-9 * Math.max(1, Math.abs(b));

// What to say of a formula: {right, words}.
function judge(name, formula, cases) {
  const names = Object.keys(cases[0]);
  const right = compile(RIGHT[name], names);
  const wrong = cases.find((each) => !close(formula(each), right(each)));
  if (!wrong) return { right: true, words: `Right, on all ${cases.length} inputs.` };
  const gives = (text) => cases.every((each) => close(compile(text, names)(each), formula(each)));
  const slip = SLIPS[name].find(([text]) => gives(text));
  const given = names.map((each) => `${each} = ${plain(wrong[each])}`).join(", ");
  const found = `it gives ${number(formula(wrong))}, and ${number(right(wrong))} is right.`;
  return { right: false, words: `For ${given} ${found} ${slip ? slip[1] : ""}` };
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
        formulas[field.name] = compile(field.value, Object.keys(cases[field.name][0]));
        return judge(field.name, formulas[field.name], cases[field.name]);
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
