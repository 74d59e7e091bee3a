// What stays in this browser: tabs, history and settings. Without storage it holds until the page is left.

import { ROOT } from "../address.js";

const memory = new Map();

/** Return the key of a name; servers that one proxy publishes at several paths share the storage of a browser. */
function key(name) {
  return `kg-query${ROOT}-${name}`;
}

/** Return what is kept under a name, or `otherwise`. */
export function kept(name, otherwise) {
  try {
    const text = localStorage.getItem(key(name));
    return text === null ? otherwise : JSON.parse(text);
  } catch {
    return memory.get(name) ?? otherwise;
  }
}

/** Keep a value under a name. */
export function keep(name, value) {
  memory.set(name, value);
  try {
    localStorage.setItem(key(name), JSON.stringify(value));
  } catch {
    // Storage may be forbidden or full.
  }
}
