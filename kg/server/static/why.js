// The panel with the proof of a fact or of a row: the content of the page /why, in a dialog of any page.

import { url } from "./address.js";

const STYLE = url("/static/why.css");
const LONGEST_ADDRESS = 7000;

/** Load the style of proofs once, or the panel flashes without it. */
function styled() {
  if (document.querySelector(`link[href="${STYLE}"]`)) return Promise.resolve();
  return new Promise((resolve) => {
    const link = Object.assign(document.createElement("link"), { rel: "stylesheet", href: STYLE });
    link.addEventListener("load", resolve);
    link.addEventListener("error", resolve);
    document.head.append(link);
  });
}

/** Ask for the page of a proof; one too long for an address is sent as a form. */
function request(address) {
  const headers = { Accept: "text/html" };
  const [, values] = address.split("?", 2);
  if (address.length < LONGEST_ADDRESS) return fetch(url(`/why?${values}`), { headers });
  return fetch(url("/why"), { method: "POST", headers, body: new URLSearchParams(values) });
}

/**
 * Show the proof at an address of /api/why or /api/why_row in a dialog, if it is `wanted()` still when it comes; throws
 * where there is none to be had.
 */
export async function show(address, dialog, body, wanted) {
  const answer = await request(address);
  const found = new DOMParser().parseFromString(await answer.text(), "text/html");
  const proof = found.getElementById("proof");
  if (!proof) throw new Error(`${answer.status}`);
  await styled();
  if (!wanted()) return;
  const inside = body.contains(document.activeElement);
  proof.removeAttribute("id");
  const page = document.createElement("p");
  if (answer.url.includes("?")) page.append(Object.assign(document.createElement("a"), { href: answer.url, textContent: "This proof on a page of its own" }));
  body.replaceChildren(document.adoptNode(proof), page);
  const title = dialog.querySelector("h2");
  title.textContent = found.querySelector("h1")?.textContent ?? "Why";
  if (!dialog.open) dialog.showModal();
  if (inside) title.focus(); // the focused element was replaced
  dialog.scrollTop = 0;
}
