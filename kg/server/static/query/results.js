// An answer in all its forms: table, picture, yes or no, as it came; and the links that save it.

import { url } from "../address.js";
import { element } from "../table.js";
import { picture } from "./picture.js";
import { address, fetched } from "./services.js";
import { table } from "./table.js";
import { shortener, triples } from "./terms.js";

const LONGEST_ADDRESS = 7000;

/** Return the content of an answer: its kind, and its rows of terms. */
export function read(answer) {
  if (answer.type !== "application/sparql-results+json") {
    return { kind: "graph", columns: ["subject", "predicate", "object"], rows: triples(answer.text) };
  }
  const found = JSON.parse(answer.text);
  if ("boolean" in found) return { kind: "boolean", value: found.boolean, columns: [], rows: [] };
  const columns = found.head.vars ?? [];
  return { kind: "rows", columns, rows: found.results.bindings.map((row) => columns.map((name) => row[name] ?? null)) };
}

/** Show an answer in `host`; `head` gets the buttons that switch between the ways to see it. */
export function show(found, answer, { host, head, prefixes, base, query }) {
  const shorten = shortener({ ...prefixes, ...declared(query) }, base);
  const context = {
    shorten, triples: found.kind === "graph" || /^s(ubject)?$/.test(found.columns[0] ?? ""),
    query: found.kind === "rows" ? query : "",
  };
  const ways = {
    graph: [["Picture", () => picture(found.rows, shorten)], ["Table", () => table(found.columns, found.rows, context)]],
    rows: [["Table", () => table(found.columns, found.rows, context)]],
    boolean: [["Answer", () => element("p", { className: "yes-or-no" }, found.value ? "Yes" : "No")]],
  }[found.kind];
  if (context.triples && found.kind === "rows" && found.columns.length === 3) ways.push(["Picture", () => picture(found.rows, shorten)]);
  ways.push(["Raw", () => raw(answer.text)]);
  const buttons = ways.map(([name, make]) => {
    const button = element("button", { type: "button" }, name);
    button.addEventListener("click", () => {
      for (const other of buttons) other.setAttribute("aria-pressed", String(other === button));
      host.replaceChildren(make());
    });
    return button;
  });
  head.replaceChildren(...buttons);
  buttons[0].click();
}

function declared(query) {
  return Object.fromEntries([...query.matchAll(/\bPREFIX\s+([\w-]*):\s*<([^>]*)>/gi)].map((match) => [match[1], match[2]]));
}

function raw(text) {
  const node = element("pre", { className: "raw", tabIndex: 0 }, text);
  node.setAttribute("role", "region");
  node.setAttribute("aria-label", "The answer as it came");
  return node;
}

/** Set the links that save an answer; texts too long for an address are requested when a link is followed, and `failed` receives an error. */
export function exports(links, query, failed) {
  for (const node of links) {
    const href = address(query, node.dataset.format);
    node.href = href.length < LONGEST_ADDRESS ? href : "#";
    node.download = `answer.${{ turtle: "ttl", ntriples: "nt", rdfxml: "rdf", markdown: "md" }[node.dataset.format] ?? node.dataset.format}`;
    node.onclick = href.length < LONGEST_ADDRESS ? null : (event) => { event.preventDefault(); save(node, query).catch(failed); };
  }
}

async function save(node, query) {
  const body = new URLSearchParams({ query, format: node.dataset.format });
  const [text, ok] = await fetched(async (answer) => [await answer.blob(), answer.ok], url("/sparql"), { method: "POST", body });
  // An error is not an answer: it is saved as an error.
  const download = ok ? node.download : "error.json";
  const link = element("a", { href: URL.createObjectURL(text), download });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
