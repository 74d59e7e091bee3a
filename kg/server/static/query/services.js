// Requests of the page to its own server; it sends none to any other.

import { url } from "../address.js";

/** An error of the server: the members of its problem (RFC 9457), or those of an error of the browser. */
export class Problem extends Error {
  constructor(members) {
    super(members.message);
    this.members = members;
  }
}

async function problem(response) {
  try {
    const members = await response.json();
    if (members.message) return new Problem(members);
  } catch {
    // Not a problem of kg: use the status.
  }
  return new Problem({ code: "", message: `The server answered ${response.status} ${response.statusText}`, hint: "" });
}

/** Return the result of `take` on the answer to a request, an error or not. A missing or truncated answer is a problem. */
export async function fetched(take, ...request) {
  let response;
  try {
    response = await fetch(...request);
  } catch {
    throw new Problem({ code: "", message: "The server cannot be reached", hint: "Is `kg serve` still running?" });
  }
  try {
    return await take(response);
  } catch (error) {
    if (error instanceof Problem) throw error;
    throw new Problem({ code: "", message: "The answer of the server ended before it was whole", hint: "Ask again." });
  }
}

const sent = (take, ...request) => fetched(async (response) => {
  if (!response.ok) throw await problem(response);
  return take(response);
}, ...request);

/** Return the answer of a view; `values` are its arguments. */
export async function view(name, values = {}) {
  const headers = { "Content-Type": "application/json" };
  return sent((response) => response.json(), url(`/api/${name}`), { method: "POST", headers, body: JSON.stringify(values) });
}

const ACCEPT = "application/sparql-results+json, application/n-triples;q=0.9";

/** Run a query; returns the text of the answer, its type, and the values of its headers. */
export async function ask({ query, limit, offset = 0, seconds, snapshot, job }) {
  const form = new URLSearchParams({ query, limit, timeout: seconds, job });
  if (offset) form.set("offset", offset);
  if (snapshot) form.set("snapshot", snapshot);
  return sent(async (response) => ({
    type: response.headers.get("Content-Type").split(";")[0],
    text: await response.text(),
    snapshot: response.headers.get("X-Kg-Snapshot"),
    more: response.headers.get("X-Kg-Truncated") === "true",
  }), url("/sparql"), { method: "POST", headers: { Accept: ACCEPT }, body: form });
}

/** Return how far a job is, or null when it has ended. */
export async function job(identity) {
  return fetched((response) => (response.ok ? response.json() : null), url(`/jobs/${identity}`)).catch(() => null);
}

/** End a job. */
export async function cancel(identity) {
  await fetch(url(`/jobs/${identity}`), { method: "DELETE" }).catch(() => null);
}

/** Return an identity that nobody can guess. */
export function identity() {
  return [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** Return the address of the answer to a query in a format. */
export function address(query, format) {
  return url(`/sparql?${new URLSearchParams({ query, format })}`);
}
