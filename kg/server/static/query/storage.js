// Tabs, history and settings, stored in this browser. Without storage they last until the page is left.

import { ROOT } from "../address.js";

const memory = new Map();

/** Return the key of a name; servers that one proxy publishes at several paths share the storage of a browser. */
function key(name) {
  return `kg-query${ROOT}-${name}`;
}

/** Return the value stored under a name, or `otherwise`; with `own` the value that this window stored, if any. */
export function load(name, otherwise, { own = false } = {}) {
  try {
    const text = (own ? sessionStorage.getItem(key(name)) : null) ?? localStorage.getItem(key(name));
    return text === null ? otherwise : JSON.parse(text);
  } catch {
    return memory.get(name) ?? otherwise;
  }
}

/** Store a value under a name; with `own` also for this window, whatever other windows store afterwards. */
export function save(name, value, { own = false } = {}) {
  memory.set(name, value);
  try {
    if (own) sessionStorage.setItem(key(name), JSON.stringify(value));
    localStorage.setItem(key(name), JSON.stringify(value));
  } catch {
    // Storage may be forbidden or full.
  }
}
