// What stays in this browser: tabs, history and settings. Without storage it holds until the page is left.

const memory = new Map();

/** Return what is kept under a name, or `otherwise`. */
export function kept(name, otherwise) {
  try {
    const text = localStorage.getItem(`kg-query-${name}`);
    return text === null ? otherwise : JSON.parse(text);
  } catch {
    return memory.get(name) ?? otherwise;
  }
}

/** Keep a value under a name. */
export function keep(name, value) {
  memory.set(name, value);
  try {
    localStorage.setItem(`kg-query-${name}`, JSON.stringify(value));
  } catch {
    // Storage may be forbidden or full.
  }
}
