// Terms of rules: their form in the field of a block, and their typed form.

const NUMBER = /^[+-]?(\d+|\d*\.\d+)(e[+-]?\d+)?$/i;

/** Return a term as the value of a field, and back. */
export const packed = (term) => JSON.stringify(term);
export const unpacked = (value) => JSON.parse(value);

/** Return a term as people read it. */
export function shown(term, vocabulary) {
  switch (term.term) {
    case "thing": return term.name;
    case "name": return vocabulary.label(term.name);
    case "text": return `“${short(term.value)}”${term.language ? ` (${term.language})` : ""}`;
    case "number": return term.value;
    default: return term.value ? "yes" : "no";
  }
}

/** Return a text on one line, not too long for a block. */
export function short(text, most = 44) {
  const line = text.replace(/\s+/g, " ").trim();
  return line.length > most ? `${line.slice(0, most - 1)}…` : line;
}

/** Return a valid name for a thing, from typed text. */
export function thingName(text) {
  const words = text.trim().replace(/^\?/, "").split(/[^\p{L}\p{N}_]+/u).filter(Boolean);
  const name = words.map((word, index) => (index ? word[0].toUpperCase() + word.slice(1) : word)).join("");
  return name && !/^\p{N}/u.test(name) ? name : name ? `x${name}` : "";
}

/** Return the term of a candidate of the completion service; null if it is not a value. */
export function termOf({ kind, insert }) {
  if (kind !== "value") return null;
  const text = insert.trim();
  if (/^(true|false)$/.test(text)) return { term: "truth", value: text === "true" };
  if (NUMBER.test(text)) return { term: "number", value: text };
  const literal = text.match(/^("(?:[^"\\]|\\.)*")(?:@([\w-]+)|\^\^(\S+))?$/s);
  if (literal) return literalOf(literal);
  return { term: "name", name: text };
}

function literalOf([, quoted, language, datatype]) {
  let value;
  try {
    value = JSON.parse(quoted);
  } catch {
    return null;
  }
  return { term: "text", value, ...(language ? { language } : {}), ...(datatype ? { datatype } : {}) };
}

/** Return the possible terms of a typed text in a place for `literal` values, things, or any. */
export function typed(text, { literal, things = true }) {
  const found = [];
  const plain = text.trim();
  if (!plain) return found;
  if (/^[\w-]+:[\w-]+$|^<[^<>\s]+>$/.test(plain)) found.push({ term: "name", name: plain });
  if (literal !== false && NUMBER.test(plain)) found.push({ term: "number", value: plain });
  if (literal !== false) found.push({ term: "text", value: text });
  const name = thingName(plain);
  if (things && name) found.push({ term: "thing", name });
  return literal === true ? found : found.sort((one, other) => (other.term === "thing") - (one.term === "thing"));
}
