/* Exercise 2 in the page: the reader fills the two clamps, which are tried on the inputs that
 * checks.py uses, beside the slips that it knows. */
import { compile } from "./arithmetic.js";
import { number, plain } from "./draw.js";

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

// The same of what a reader has written.
function judged(text, each) {
  try {
    return judge(compile(text, Object.keys(each.inputs[0])), each);
  } catch (error) {
    return { right: false, words: error.message };
  }
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
    const held = fields.map((field) => {
      const { right, words } = judged(field.value, cases[field.name]);
      document.getElementById(`${field.id}-said`).textContent = words;
      field.setAttribute("aria-invalid", String(!right));
      return right;
    });
    form.querySelector(".tried").textContent = held.every(Boolean) ? "Both clamps hold." : "";
  });
}
