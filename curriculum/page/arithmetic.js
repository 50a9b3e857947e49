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
  const rest = [...text.trim().matchAll(TOKEN)].map(([, number, name, sign]) =>
    number === undefined ? name || sign : Number(number),
  );
  if (!rest.length) throw new Error("Nothing is written yet.");
  const take = (wanted) => {
    const where = rest.length ? ` before “${rest[0]}”` : " at the end";
    if (rest[0] !== wanted) throw new Error(`“${wanted}” is missing${where}.`);
    rest.shift();
  };
  const chain = (next, signs) => () => {
    let left = next();
    while (signs.includes(rest[0])) {
      const [sign, a, b] = [SIGNS[rest.shift()], left, next()];
      left = (v) => sign(a(v), b(v));
    }
    return left;
  };
  const product = chain(atom, ["*", "/"]);
  const sum = chain(product, ["+", "-"]);
  function call(name) {
    take("(");
    const given = [sum()];
    while (rest[0] === ",") {
      take(",");
      given.push(sum());
    }
    take(")");
    return (v) => CALLS[name](...given.map((each) => each(v)));
  }
  function atom() {
    const token = rest.shift();
    const name = names.includes(token) ? token : SHORT[token];
    if (typeof token === "number") return () => token;
    if (token === "+") return atom();
    if (token === "-") {
      const opposite = atom();
      return (v) => -opposite(v);
    }
    if (token === "(") {
      const inner = sum();
      take(")");
      return inner;
    }
    if (CALLS[token]) return call(token);
    if (names.includes(name)) return (v) => v[name];
    if (token === undefined) throw new Error("Something is missing at the end.");
    const known = `${names.join(", ")} + − * / ( ) max min`;
    throw new Error(`“${token}” is not known here; known: ${known}.`);
  }
  const found = sum();
  if (rest.length) throw new Error(`“${rest[0]}” is too much.`);
  return found;
}
