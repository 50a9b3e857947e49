/* Arithmetic as a reader writes it into a blank: numbers, names, + - * / ( ) , max min, read by
 * descent. A name may be short, as in the formulas of the text. */

const TOKEN = /\d+\.?\d*(?:e[-+]?\d+)?|\.\d+|[a-z_]\w*|\S/gi;
// what a value may begin with, beside a number, a name and a bracket
const FIRST = {
  __proto__: null,
  "+": (atom) => atom(),
  "-": (atom) => -atom(),
  max: (atom, inBrackets) => Math.max(...inBrackets(Infinity)),
  min: (atom, inBrackets) => Math.min(...inBrackets(Infinity)),
};
const SHORT = { k: "stiffness", c: "damping" };
const SIGNS = {
  "+": (a, b) => a + b,
  "-": (a, b) => a - b,
  "*": (a, b) => a * b,
  "/": (a, b) => a / b,
};

/* The text as a function of an object of values. Throws Error, in a sentence, where it is none. */
export function compile(text, names) {
  const tokens = text.match(TOKEN) || [];
  const formula = (values) => valueOf([...tokens], names, values);
  formula({}); // whatever is wrong with it is wrong with any values
  return formula;
}

// The value of what the tokens in `rest` say, which are taken one by one.
function valueOf(rest, names, values) {
  const refuse = () => {
    const known = `${names.join(", ")} + − * / ( ) max min`;
    if (!rest.length) throw new Error("Something is missing at the end.");
    throw new Error(`“${rest[0]}” does not fit here; known: ${known}.`);
  };
  const take = (wanted) => (rest[0] === wanted ? rest.shift() : refuse());
  const chain = (next, signs) => () => {
    let left = next();
    while (signs.includes(rest[0])) left = SIGNS[rest.shift()](left, next());
    return left;
  };
  const product = chain(atom, ["*", "/"]);
  const sum = chain(product, ["+", "-"]);
  function inBrackets(most) {
    const given = [];
    do {
      take(given.length ? "," : "(");
      given.push(sum());
    } while (rest[0] === "," && given.length < most);
    take(")");
    return given;
  }
  function atom() {
    const token = rest[0];
    const name = names.includes(token) ? token : SHORT[token];
    if (token === "(") return inBrackets(1)[0];
    if (!names.includes(name) && !(token in FIRST) && !/^\.?\d/.test(token)) refuse();
    rest.shift();
    if (FIRST[token]) return FIRST[token](atom, inBrackets);
    return names.includes(name) ? values[name] : Number(token);
  }
  const found = sum();
  if (rest.length) refuse();
  return found;
}
