/* Arithmetic as a reader writes it into a blank: numbers, names, + - * / ( ) , max min, read by
 * descent. A name may be short, as in the formulas of the text. */

const TOKEN = /\s*(?:(\d+\.?\d*(?:e[-+]?\d+)?|\.\d+)|([A-Za-z_]\w*)|(.))/giy;
const CALLS = { max: Math.max, min: Math.min };
const SHORT = { k: "stiffness", c: "damping" };
const SIGNS = {
  "+": (a, b) => a + b,
  "-": (a, b) => a - b,
  "*": (a, b) => a * b,
  "/": (a, b) => a / b,
};

/* The text as a function of an object of values. Throws Error, in a sentence, where it is none. */
export function compile(text, names) {
  const tokens = [...text.trim().matchAll(TOKEN)].map(([, number, name, sign]) =>
    number === undefined ? name || sign : Number(number),
  );
  if (!tokens.length) throw new Error("Nothing is written yet.");
  const formula = (values) => valueOf([...tokens], names, values);
  formula({}); // whatever is wrong with it is wrong with any values
  return formula;
}

// The value of what the tokens in `rest` say, which are taken one by one.
function valueOf(rest, names, values) {
  const take = (wanted) => {
    const where = rest.length ? ` before “${rest[0]}”` : " at the end";
    if (rest[0] !== wanted) throw new Error(`“${wanted}” is missing${where}.`);
    rest.shift();
  };
  const chain = (next, signs) => () => {
    let left = next();
    while (signs.includes(rest[0])) left = SIGNS[rest.shift()](left, next());
    return left;
  };
  const product = chain(atom, ["*", "/"]);
  const sum = chain(product, ["+", "-"]);
  function inBrackets() {
    const given = [];
    do {
      take(given.length ? "," : "(");
      given.push(sum());
    } while (rest[0] === ",");
    take(")");
    return given;
  }
  function atom() {
    const token = rest.shift();
    const name = names.includes(token) ? token : SHORT[token];
    if (typeof token === "number") return token;
    if (token === "+") return atom();
    if (token === "-") return -atom();
    if (CALLS[token]) return CALLS[token](...inBrackets());
    if (names.includes(name)) return values[name];
    if (token === "(") {
      const inner = sum();
      take(")");
      return inner;
    }
    if (token === undefined) throw new Error("Something is missing at the end.");
    const known = `${names.join(", ")} + − * / ( ) max min`;
    throw new Error(`“${token}” is not known here; known: ${known}.`);
  }
  const found = sum();
  if (rest.length) throw new Error(`“${rest[0]}” is too much.`);
  return found;
}
