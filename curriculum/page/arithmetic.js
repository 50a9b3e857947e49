/* Arithmetic as a reader writes it into a blank: numbers, names, + - * / ( ) , max min, read by
 * descent. A name may be short, as in the formulas of the text. */

const TOKEN = /\d+\.?\d*(?:e[-+]?\d+)?|\.\d+|[a-z_]\w*|\S/gi;
const SHORT = { k: "stiffness", c: "damping" };
const SIGNS = [
  { "+": (a, b) => a + b, "-": (a, b) => a - b },
  { "*": (a, b) => a * b, "/": (a, b) => a / b }, // which bind closer
];

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
  const take = (...wanted) => (wanted.includes(rest[0]) ? rest.shift() : refuse());
  function chain(signs, ...closer) {
    if (!signs) return atom();
    let left = chain(...closer);
    while (Object.hasOwn(signs, rest[0])) left = signs[rest.shift()](left, chain(...closer));
    return left;
  }
  function inBrackets(most) {
    const given = [];
    do {
      take(given.length ? "," : "(");
      given.push(chain(...SIGNS));
    } while (rest[0] === "," && given.length < most);
    take(")");
    return given;
  }
  function atom() {
    if (rest[0] === "(") return inBrackets(1)[0];
    if (/^\.?\d/.test(rest[0])) return Number(rest.shift());
    const name = names.includes(rest[0]) ? rest[0] : SHORT[rest[0]];
    const token = names.includes(name) ? rest.shift() : take("+", "-", "max", "min");
    if (names.includes(name)) return values[name];
    if (token === "+") return atom();
    return token === "-" ? -atom() : Math[token](...inBrackets(Infinity));
  }
  const value = chain(...SIGNS);
  if (rest.length) refuse();
  return value;
}
