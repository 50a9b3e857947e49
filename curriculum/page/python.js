/* What contact.py takes from Python: max and min as Python has them, NaN included, and so on. */
const max = (a, b) => (b > a ? b : a);
const min = (a, b) => (b < a ? b : a);
const of = (pick) => (all, other) => (all.length ? all.reduce(pick) : other);

export const $ = {
  max, min, maxOf: of(max), minOf: of(min),
  len: (all) => all.length,
  map: (f, all) => all.map((each) => f(each)),
  zip: (first, ...more) => first.map((each, k) => [each, ...more.map((all) => all[k])]),
  has: (all, one) => all.includes(one),
  put: (held, key, value) => (held instanceof Map ? held.set(key, value) : (held[key] = value)),
};
