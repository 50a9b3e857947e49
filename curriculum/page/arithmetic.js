/* Arithmetic as a reader types it: numbers, names, + - * / ( ), max and min. Read by descent into
 * functions; nothing a reader types is ever run as a program. */
"use strict";

const Arithmetic = (() => {
  const TOKEN = /\s*(?:(\d+\.?\d*(?:e[+-]?\d+)?|\.\d+(?:e[+-]?\d+)?)|([A-Za-z_]\w*)|(.))/gy;
  const CALLS = {
    max: (values) => values.reduce((a, b) => (b > a ? b : a)), // as Python's: the first of equals
    min: (values) => values.reduce((a, b) => (b < a ? b : a)),
  };

  function split(text) {
    const tokens = [];
    TOKEN.lastIndex = 0;
    for (let match; TOKEN.lastIndex < text.trimEnd().length && (match = TOKEN.exec(text));) {
      const [whole, digits, name, sign] = match;
      tokens.push({ at: TOKEN.lastIndex - whole.trimStart().length + 1, digits, name, sign });
    }
    return tokens;
  }

  // A place in the tokens that moves on, and complains where it stands.
  function reader(tokens) {
    let place = 0;
    const peek = () => tokens[place] || {};
    const take = (sign) => peek().sign === sign && ++place > 0;
    const fail = (what) => {
      throw new Error(tokens[place] ? `At character ${peek().at}: ${what}` : `At the end: ${what}`);
    };
    const need = (sign) => take(sign) || fail(`a ${sign} is missing.`);
    return { peek, take, fail, need, pass: () => place++, done: () => place === tokens.length };
  }

  /* A function of {name: number} from a text. Throws an Error whose message is meant for the reader. */
  function parse(text, names) {
    if (text.length > 200) throw new Error("That is longer than 200 characters; both answers fit into 50.");
    const tokens = split(text);
    if (!tokens.length) throw new Error("The blank is empty.");
    const { peek, take, fail, need, pass, done } = reader(tokens);

    function call(name) {
      need("(");
      const values = [sum()];
      while (take(",")) values.push(sum());
      need(")");
      if (values.length < 2) fail(`${name} compares two or more values, with a comma between them.`);
      return (inputs) => CALLS[name](values.map((value) => value(inputs)));
    }

    function atom() {
      const { digits, name } = peek();
      if (take("(")) {
        const inner = sum();
        need(")");
        return inner;
      }
      if (digits !== undefined) return (pass(), () => Number(digits));
      if (name === undefined) fail("a number, a name or a bracket is missing.");
      if (Object.hasOwn(CALLS, name)) return (pass(), call(name));
      if (!names.includes(name))
        fail(`${name} is not known here; known: ${[...names, ...Object.keys(CALLS)].join(", ")}.`);
      pass();
      return (inputs) => inputs[name];
    }

    function signed() {
      if (take("-")) {
        const value = signed();
        return (inputs) => -value(inputs);
      }
      return take("+") ? signed() : atom();
    }

    // A chain of one rank, from the left: product = signed (* or / signed)*, sum = product (+ or - product)*.
    const chain = (next, steps) => () => {
      let value = next();
      for (let sign; (sign = peek().sign) && Object.hasOwn(steps, sign);) {
        pass();
        const [left, right, step] = [value, next(), steps[sign]];
        value = (inputs) => step(left(inputs), right(inputs));
      }
      return value;
    };
    const product = chain(signed, { "*": (a, b) => a * b, "/": (a, b) => a / b });
    const sum = chain(product, { "+": (a, b) => a + b, "-": (a, b) => a - b });

    const whole = sum();
    if (!done()) fail(`${peek().sign || peek().name || peek().digits} does not belong here.`);
    return whole;
  }

  return { parse };
})();
