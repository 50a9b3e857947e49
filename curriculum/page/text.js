/* lit's templates as text, for the stills that are drawn when the page is built; what is no template
 * itself is escaped. */
const escape = (text) => String(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
const told = (value) => value?.markup ?? (Array.isArray(value) ? value.map(told).join("")
  : escape(value ?? ""));

export function svg(strings, ...values) {
  const parts = strings.map((string, k) => {
    const text = k < values.length ? told(values[k]) : "";
    return string + (string.endsWith("=") ? `"${text}"` : text);
  });
  return { markup: parts.join("").replace(/\s+/g, " ") };
}

export const html = svg;
export const render = () => {};
export const textOf = told;
