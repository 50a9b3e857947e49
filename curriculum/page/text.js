/* lit's templates as text, for the stills that are drawn when the page is built: what listens is
 * left out, and what is no template itself is escaped. */
const escape = (text) => String(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
const told = (value) => value?.markup ?? (Array.isArray(value) ? value.map(told).join("")
  : escape(value ?? ""));

export function svg(strings, ...values) {
  let markup = "";
  strings.forEach((string, k) => {
    const listens = typeof values[k] === "function";
    const bare = /=$/.test(string) && !listens;
    const text = listens ? string.replace(/\s@\w+=$/, "") : string;
    markup += text + (k < values.length && !listens
      ? (bare ? `"${told(values[k])}"` : told(values[k])) : "");
  });
  return { markup: markup.replace(/\s+/g, " ") };
}

export const html = svg;
export const render = () => {};
export const textOf = told;
