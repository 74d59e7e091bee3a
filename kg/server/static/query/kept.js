// What stays in this browser: tabs, history and settings. Without storage it holds until the page is left.

import { ROOT } from "../address.js";

const memory = new Map();

/** Return the key of a name; servers that one proxy publishes at several paths share the storage of a browser. */
function key(name) {
  return `kg-query${ROOT}-${name}`;
}

/** Return what is kept under a name, or `otherwise`; with `own` what this window kept, if it kept anything. */
export function kept(name, otherwise, { own = false } = {}) {
  try {
    const text = (own ? sessionStorage.getItem(key(name)) : null) ?? localStorage.getItem(key(name));
    return text === null ? otherwise : JSON.parse(text);
  } catch {
    return memory.get(name) ?? otherwise;
  }
}

/** Keep a value under a name; with `own` also for this window, whatever others keep afterwards. */
export function keep(name, value, { own = false } = {}) {
  memory.set(name, value);
  try {
    if (own) sessionStorage.setItem(key(name), JSON.stringify(value));
    localStorage.setItem(key(name), JSON.stringify(value));
  } catch {
    // Storage may be forbidden or full.
  }
}
