// Beside the editor: stored queries with a form for their parameters, the history, settings.

import { element } from "../table.js";
import { load, save } from "./storage.js";
import { view } from "./services.js";

const MOST = 200;
const SHOWN = 60;
const TYPES = { integer: "number" };
let newest = 0;

/** List the stored queries; `open(stored, text, values, run)` receives the one to put into the editor. */
export async function stored({ list, filter, form, begin, values, open, failed }) {
  let queries;
  try {
    ({ queries } = await view("stored"));
  } catch (error) {
    failed(error);
    return;
  }
  const choose = (one, given = {}, focus = true) => parameters(form, one, given, open, failed, focus);
  const draw = () => {
    const words = filter.value.trim().toLowerCase().split(/\s+/);
    const found = queries.filter((one) => words.every((word) => `${one.query} ${one.title} ${one.description}`.toLowerCase().includes(word)));
    const families = [...new Set(found.map((one) => one.query.split("/")[0]))].sort((one, other) => rank(one) - rank(other));
    list.replaceChildren(...families.flatMap((family) => [
      element("h3", {}, family),
      element("ul", { className: "plain" }, ...found.filter((one) => one.query.split("/")[0] === family).map((one) => item(one.title, one.query, () => choose(one)))),
    ]));
    if (!found.length) list.replaceChildren(element("p", { className: "quiet-text" }, "None has these words."));
  };
  filter.addEventListener("input", draw);
  draw();
  const chosen = queries.find((one) => one.query === begin);
  if (chosen) choose(chosen, values, false);
}

const FIRST = ["demo", "explore"];

/** Return the position of a family of queries: those for beginners first. */
function rank(family) {
  const at = FIRST.indexOf(family);
  return at < 0 ? FIRST.length : at;
}

function item(title, detail, work) {
  const button = element("button", { type: "button", className: "entry" }, element("span", {}, title), element("small", {}, detail));
  button.addEventListener("click", work);
  return element("li", {}, button);
}

function parameters(host, one, values, open, failed, focus) {
  const fields = one.parameters.map((parameter) => field(parameter, values[parameter.name] ?? ""));
  const run = element("button", { className: "primary" }, "Run");
  const insert = element("button", { type: "button" }, "Only show");
  const close = element("button", { type: "button" }, "Close");
  const form = element("form", { className: "stored-form" },
    element("h3", {}, one.title), one.description ? element("p", { className: "quiet-text" }, one.description) : null,
    ...fields.map((each) => each.holder), element("div", { className: "row" }, run, insert, close));
  form.setAttribute("aria-label", one.title);
  const take = async (runs) => {
    const turn = ++newest;
    const given = Object.fromEntries(fields.map((each) => [each.name, each.value()]).filter(([, value]) => value));
    try {
      const { bound } = await view("stored", { name: one.query, values: JSON.stringify(given) });
      if (turn === newest) open(one, bound, given, runs);
    } catch (error) {
      if (turn === newest) failed(error);
    }
  };
  form.addEventListener("submit", (event) => { event.preventDefault(); take(true); });
  insert.addEventListener("click", () => take(false));
  close.addEventListener("click", () => { newest += 1; host.replaceChildren(); });
  newest += 1;
  host.replaceChildren(form);
  if (focus) (form.querySelector("input, select") ?? run).focus();
}

function field(parameter, value) {
  const id = `parameter-${parameter.name}`;
  const input = parameter.type === "boolean"
    ? element("select", { id }, ...["", "true", "false"].map((each) => element("option", { value: each, selected: each === value }, each || "either")))
    : element("input", { id, type: TYPES[parameter.type] ?? "text", value, placeholder: parameter.example, autocomplete: "off", spellcheck: false, className: "mono" });
  const label = element("label", { htmlFor: id }, parameter.name, element("small", {}, ` ${parameter.description}`));
  return { name: parameter.name, value: () => input.value.trim(), holder: element("div", { className: "field" }, label, input) };
}

/** The queries that ran before, newest first; `open(text)` receives the one to restore. */
export class History {
  constructor({ list, filter, clear, open }) {
    Object.assign(this, { list, filter, open });
    filter.addEventListener("input", () => this.draw());
    clear.addEventListener("click", () => { save("history", []); this.draw(); });
    this.draw();
  }

  add(entry) {
    const others = load("history", []).filter((each) => each.text !== entry.text);
    save("history", [entry, ...others].slice(0, MOST));
    this.draw();
  }

  draw() {
    const words = this.filter.value.trim().toLowerCase().split(/\s+/);
    const found = load("history", []).filter((each) => words.every((word) => each.text.toLowerCase().includes(word)));
    const items = found.slice(0, SHOWN).map((each) => item(gist(each.text), `${moment(each.when)} · ${each.what}`, () => this.open(each.text)));
    this.list.replaceChildren(items.length ? element("ul", { className: "plain" }, ...items) : element("p", { className: "quiet-text" }, "Nothing yet."));
  }
}

/** Return a query in a few words: without comments and declarations. */
export function gist(text) {
  const bare = text.replace(/^\s*#.*$/gm, "").replace(/^\s*(PREFIX\s+\S+|BASE)\s+<[^>]*>/gim, "").replace(/\s+/g, " ").trim();
  return bare.length > 90 ? `${bare.slice(0, 89)}…` : bare || "an empty query";
}

function moment(when) {
  return new Date(when).toLocaleString("en-GB", { day: "numeric", month: "short", hour: "2-digit", minute: "2-digit" });
}
