// Blockly, from the server that the page came from; it is a classic script, not a module.

import { url } from "../address.js";

const FOLDER = url("/vendor/blockly/");

/** Return Blockly, or null where the libraries of the pages were not built. */
export async function load() {
  try {
    await script("blockly_compressed.js");
    await script("msg/en.js");
  } catch {
    return null;
  }
  return window.Blockly;
}

/** Where Blockly finds its pictures. */
export const MEDIA = `${FOLDER}media/`;

function script(name) {
  return new Promise((resolve, reject) => {
    const tag = document.createElement("script");
    tag.src = FOLDER + name;
    tag.addEventListener("load", resolve);
    tag.addEventListener("error", reject);
    document.head.append(tag);
  });
}

/**
 * Take style elements that Blockly puts first in the head as constructed style sheets.
 *
 * The policy of these pages allows no inline styles; Blockly writes two of them, when a workspace is made and when its theme
 * changes, always by `document.head.prepend`. Its rules are the same either way.
 */
export function adoptStyles() {
  const prepend = document.head.prepend.bind(document.head);
  document.head.prepend = (...nodes) => {
    for (const node of nodes) {
      if (!(node instanceof HTMLStyleElement)) {
        prepend(node);
        continue;
      }
      const sheet = new CSSStyleSheet();
      sheet.replaceSync(node.textContent);
      document.adoptedStyleSheets = [sheet, ...document.adoptedStyleSheets];
    }
  };
}
