/* Arithmetic as a reader writes it into a blank: numbers, names, + - * / ( ) , max min, read by descent. */

const TOKEN = /\s*(?:(\d+\.?\d*(?:e[-+]?\d+)?|\.\d+)|([A-Za-z_]\w*)|([-+*/(),]))/y;
const CALLS = { max: Math.max, min: Math.min };

function tokens(text) {
  const found = [];
  TOKEN.lastIndex = 0;
  while (TOKEN.lastIndex < text.trimEnd().length) {
    const at = TOKEN.lastIndex;
    const match = TOKEN.exec(text);
    if (!match) throw new Error(`“${text.slice(at).trim()[0]}” is not understood; allowed: + − * / ( ) max min`);
    found.push(match[1] !== undefined ? Number(match[1]) : match[2] || match[3]);
  }
  return found;
}

/* The text as a function of an object of values. Raises Error, in one sentence, where it is none. */
export function compile(text, names) {
  const rest = tokens(text);
  if (!rest.length) throw new Error("Nothing is written yet.");
  const take = (wanted) => {
    if (rest[0] !== wanted) throw new Error(`“${wanted}” is missing${rest.length ? ` before “${rest[0]}”` : " at the end"}.`);
    rest.shift();
  };
  const both = (next, signs) => () => {
    let left = next();
    while (signs.includes(rest[0])) {
      const [sign, a, b] = [rest.shift(), left, next()];
      left = { "+": (v) => a(v) + b(v), "-": (v) => a(v) - b(v), "*": (v) => a(v) * b(v), "/": (v) => a(v) / b(v) }[sign];
    }
    return left;
  };
  function call(name) {
    take("(");
    const given = [sum()];
    while (rest[0] === ",") {
      rest.shift();
      given.push(sum());
    }
    take(")");
    return (v) => CALLS[name](...given.map((each) => each(v)));
  }
  function atom() {
    const token = rest.shift();
    if (typeof token === "number") return () => token;
    if (token === "-" || token === "+") {
      const a = atom();
      return token === "-" ? (v) => -a(v) : a;
    }
    if (token === "(") {
      const inner = sum();
      take(")");
      return inner;
    }
    if (CALLS[token]) return call(token);
    if (names.includes(token)) return (v) => v[token];
    throw new Error(token === undefined ? "Something is missing at the end." : `“${token}” is not known here; known: ${names.join(", ")}.`);
  }
  const product = both(atom, ["*", "/"]);
  const sum = both(product, ["+", "-"]);
  const found = sum();
  if (rest.length) throw new Error(`“${rest[0]}” is too much.`);
  return found;
}
