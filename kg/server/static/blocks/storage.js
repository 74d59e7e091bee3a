// Texts anchor of blocks, stored in this browser, in files, and in links.

import { ROOT } from "../address.js";

/** Texts by name in this browser, under keys that begin with `prefix`; without storage they last until the page is left. */
export class TextStore {
  constructor(prefix) {
    this.prefix = `${ROOT}${prefix}`; // servers that one proxy publishes at several paths share the storage of a browser
    this.memory = new Map();
  }

  save(name, text) {
    this.memory.set(name, text);
    try {
      localStorage.setItem(this.prefix + name, text);
    } catch {
      // Storage may be forbidden or full.
    }
  }

  remove(name) {
    this.memory.delete(name);
    try {
      localStorage.removeItem(this.prefix + name);
    } catch {
      // As above.
    }
  }

  /** Return all texts as [name, text], sorted by name. */
  all() {
    const found = new Map(this.memory);
    try {
      for (const key of Object.keys(localStorage)) if (key.startsWith(this.prefix)) found.set(key.slice(this.prefix.length), localStorage.getItem(key));
    } catch {
      // As above.
    }
    return [...found].sort(([one], [other]) => one.localeCompare(other));
  }
}

/** Return a link that saves a text as a file. */
export function file(name, text, type) {
  const anchor = document.createElement("a");
  anchor.className = "button";
  anchor.href = URL.createObjectURL(new Blob([text], { type }));
  anchor.download = name;
  return anchor;
}

/** Return the address of this page with a text under a name; the part after the # is not sent to any server. */
export function link(name, text) {
  const bytes = new TextEncoder().encode(text);
  const coded = btoa(Array.from(bytes, (byte) => String.fromCodePoint(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  return `${location.origin}${location.pathname}#${name}=${coded}`;
}

/** Return the text of that name in the address of this page, or null. */
export function linked(name) {
  const [found, coded] = location.hash.slice(1).split("=", 2);
  if (found !== name || !/^[\w-]*$/.test(coded ?? "?")) return null;
  try {
    const bytes = Uint8Array.from(atob(coded.replaceAll("-", "+").replaceAll("_", "/")), (sign) => sign.codePointAt(0));
    return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    return null;
  }
}
