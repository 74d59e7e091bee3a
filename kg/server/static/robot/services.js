// Requests of the page to its own server; it sends none to any other.

import { url } from "../address.js";

/** An error of the server: the members of its problem (RFC 9457), or those of an error of the browser. */
export class Problem extends Error {
  constructor(members) {
    super(members.message);
    this.members = members;
  }
}

/** Ask an endpoint of the server; with a body by POST. Returns the answer as JSON, null for none. */
export async function ask(path, body) {
  const request = body === undefined ? {} : { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) };
  let response;
  try {
    response = await fetch(url(path), request);
  } catch {
    throw new Problem({ code: "", message: "The server cannot be reached.", hint: "Is `kg serve` still running?" });
  }
  if (response.ok) return response.status === 204 ? null : response.json();
  let members = null;
  try {
    members = await response.json();
  } catch {
    // Not a problem of kg: use the status.
  }
  throw new Problem(members?.message ? members : { code: "", message: `The server answered ${response.status}.`, hint: "" });
}

/** Listen to what happens on the robot: `onEvent` receives each event, `onSilence` is called while the server is unreachable. */
export function listen(onEvent, onSilence) {
  const source = new EventSource(url("/robot/events"));
  source.addEventListener("message", ({ data }) => onEvent(JSON.parse(data)));
  source.addEventListener("error", () => {
    onSilence();
    // A browser gives up for good when the answer was not a stream, as while the server starts again.
    if (source.readyState === EventSource.CLOSED) setTimeout(() => listen(onEvent, onSilence), 3000);
  });
}
