// The page of queries: connects its parts.

import { url } from "../address.js";
import { element } from "../table.js";
import { edit, words } from "./editor.js";
import { load, save } from "./storage.js";
import { exports, read, show } from "./results.js";
import { Run } from "./run.js";
import { ask, view } from "./services.js";
import { History, stored } from "./side.js";
import { Tabs } from "./tabs.js";
import { edited, indented } from "./text.js";

const $ = (id) => document.getElementById(id);
const data = JSON.parse($("query-page").dataset.page);
data.text = data.text.replace(/\r\n?/g, "\n"); // as the editor has it
const EXAMPLE = "SELECT ?node ?topic WHERE {\n  ?node a rnkg:NodeType ;\n    rnkg:publishes/rdfs:label ?topic .\n}\nLIMIT 100\n";

const settings = () => ({ limit: data.limit, seconds: data.seconds, prefixes: true, ...load("settings", {}) });

let editor;
let last = null;
const history = new History({ list: $("history-list"), filter: $("history-filter"), clear: $("history-clear"), open: (text) => tabs.open(text) });
const tabs = new Tabs($("tabs"), { add: $("tab-new"), close: $("tab-close"), shown: (text) => { if (editor) { editor.text = text; editor.focus(); } } });
const run = new Run({ run: $("run"), cancel: $("cancel"), progress: $("progress") });

function notice(kind, ...content) {
  const box = element("div", { className: `notice ${kind}` }, ...content);
  box.setAttribute("role", kind === "error" ? "alert" : "status");
  $("notices").replaceChildren(box);
}

/** Return a text whose parts between backticks are code. */
function prose(text) {
  return text.split("`").map((part, index) => (index % 2 ? element("code", {}, part) : part));
}

/** Show an error of the endpoint, with its place and its fix. */
function failed({ members }, query = null) {
  const place = members.line ? element("button", { type: "button", className: "link" }, `line ${members.line}, column ${members.column}`) : null;
  place?.addEventListener("click", () => editor.go(spanOf(members, query)));
  const code = members.docs ? element("a", { href: members.docs }, members.code) : members.code;
  notice("error", element("p", {}, element("strong", {}, ...prose(members.message)), place ? " at " : "", place), element("p", {}, code, " ", ...prose(members.hint ?? "")));
}

function spanOf(members, query) {
  const offset = (line, column) => [...query.split("\n").slice(0, line - 1).join("\n")].length + (line > 1 ? 1 : 0) + column - 1;
  return { start: offset(members.line, members.column), end: offset(members.endLine ?? members.line, members.endColumn ?? members.column) };
}

/** Run the query in the editor; `snapshot` is the data to run it on. */
async function start(snapshot = null) {
  const query = editor.text;
  if (!query.trim() || run.running) return;
  const { limit, seconds } = settings();
  $("notices").replaceChildren();
  $("results").hidden = true;
  let answer;
  try {
    answer = await run.during((job) => ask({ query, limit, seconds: Math.min(seconds, data.seconds), snapshot, job }));
  } catch (error) {
    ended(error, query, snapshot);
    return;
  }
  last = { query, snapshot: answer.snapshot };
  const found = read(answer);
  const what = summary(found, answer);
  run.say(what);
  history.add({ text: query, when: Date.now(), what });
  results(found, answer, query);
  if (answer.more) more(query, answer, found);
}

function ended(error, query, snapshot) {
  if (!error.members) throw error;
  run.say(error.members.code === "KG510" ? `cancelled after ${run.seconds()} s` : "failed");
  if (error.members.code === "KG512") {
    const again = element("button", { type: "button", className: "primary" }, "Run it on the data as it is now");
    again.addEventListener("click", () => start());
    notice("warning", element("p", {}, element("strong", {}, "The data has changed since this link was made"), ` (it was snapshot ${snapshot}, this is ${data.snapshot}).`), again);
  } else if (error.members.code !== "KG510") {
    failed(error, query);
  }
}

function summary(found, answer) {
  const many = found.rows.length.toLocaleString("en");
  const unit = found.kind === "graph" ? ["triple", "triples"] : ["row", "rows"];
  const count = found.kind === "boolean" ? (found.value ? "yes" : "no") : `${answer.more ? "the first " : ""}${many} ${unit[found.rows.length === 1 ? 0 : 1]}`;
  return `${count} in ${run.seconds()} s, snapshot ${answer.snapshot}`;
}

function results(found, answer, query) {
  $("results").hidden = false;
  const graph = found.kind === "graph";
  $("exports-graph").hidden = !graph;
  $("exports-rows").hidden = graph;
  exports(document.querySelectorAll(".exports a"), query, failed);
  show(found, answer, { host: $("result"), head: $("views"), prefixes: data.prefixes, base: data.base, query });
}

/** Offer the rows behind those that were asked for. */
function more(query, answer, found) {
  const button = element("button", { type: "button" }, "Get more");
  const { limit, seconds } = settings();
  button.addEventListener("click", async () => {
    if (run.running) return;
    try {
      const next = await run.during((job) => ask({ query, limit, offset: found.rows.length, seconds: Math.min(seconds, data.seconds), snapshot: answer.snapshot, job }));
      found.rows.push(...read(next).rows);
      const whole = { ...answer, text: `${answer.text}\n${next.text}`, more: next.more };
      run.say(summary(found, whole));
      results(found, whole, query);
      $("notices").replaceChildren();
      if (next.more) more(query, whole, found);
    } catch (error) {
      ended(error, query, answer.snapshot);
    }
  });
  notice("", element("p", {}, `There are more than these ${found.rows.length.toLocaleString("en")}; what is saved below has up to ${data.rows.toLocaleString("en")}.`), button);
}

function problems(found) {
  const host = $("problems");
  const { text } = editor;
  const focused = host.contains(document.activeElement);
  host.hidden = !found.length;
  host.replaceChildren(...found.map((problem) => {
    const place = element("button", { type: "button", className: "link" }, `${problem.line}:${problem.column}`);
    place.title = `Go to line ${problem.line}, column ${problem.column}`;
    place.addEventListener("click", () => editor.go(problem));
    const fixes = problem.fixes.map((fix) => {
      const button = element("button", { type: "button", className: "fix" }, ...prose(fix.title));
      button.addEventListener("click", () => { mend(fix, text); editor.focus(); });
      return button;
    });
    return element("li", {}, element("span", { className: `tag ${problem.severity}` }, problem.severity), " ", place, " ", ...prose(words(problem)), " ", ...fixes);
  }));
  if (focused) (host.querySelector("button") ?? editor).focus();
}

/** Apply a proposed fix to a text; one edited since is checked again. */
function mend(fix, text) {
  if (editor.text !== text) return;
  editor.text = edited(editor.text, fix.edits);
  tabs.write(editor.text);
}

function indent() {
  editor.text = indented(editor.text);
  tabs.write(editor.text);
}

function share() {
  const query = editor.text;
  const snapshot = last?.query === query ? last.snapshot : String(data.snapshot);
  $("share-snapshot").textContent = snapshot;
  $("share-link").value = `${location.origin}${url("/query")}?${new URLSearchParams({ query, snapshot })}`;
  $("share-done").textContent = "";
  $("share-dialog").showModal();
  $("share-link").select();
}

async function copy() {
  $("share-link").select();
  try {
    await navigator.clipboard.writeText($("share-link").value);
  } catch {
    document.execCommand("copy");
  }
  $("share-done").textContent = "Copied";
}

function bindSettings() {
  const fields = { limit: $("set-limit"), seconds: $("set-seconds") };
  fields.limit.max = data.rows;
  fields.seconds.max = data.seconds;
  for (const [name, field] of Object.entries(fields)) {
    field.value = settings()[name];
    field.addEventListener("change", () => {
      if (field.validity.valid && field.value) save("settings", { ...settings(), [name]: Number(field.value) });
    });
  }
  $("set-prefixes").checked = settings().prefixes;
  $("set-prefixes").addEventListener("change", () => save("settings", { ...settings(), prefixes: $("set-prefixes").checked }));
}

/** Have the store counted for suggestions, once for each content, while nobody waits for it. */
async function count() {
  const late = setTimeout(() => run.running || $("progress").textContent || run.say("Counting the store, so that suggestions fit it …"), 1500);
  await view("complete", { text: "", fresh: "yes" }).catch(() => null);
  clearTimeout(late);
  if (!run.running && $("progress").textContent.startsWith("Counting")) run.say("");
}

/** Keep the editor low until it is used: users of a stored query look for the answer. It shows the query behind the documentation. */
function brief() {
  $("editor").classList.add("brief");
  $("editor").addEventListener("focusin", () => $("editor").classList.remove("brief"), { once: true });
}

/** Say that the tab of a link has another query by now, and offer that of the link. */
function changed() {
  const again = element("button", { type: "button", className: "primary" }, "Run the query of the link");
  again.addEventListener("click", () => { tabs.open(data.text); start(data.wanted || null); });
  notice("", element("p", {}, "This link was opened before, and its query was changed since in this tab."), again);
}

async function begin() {
  if (data.text) tabs.open(data.text, data.stored.split("/").at(-1) || undefined, location.search);
  else if (!tabs.current.text) tabs.write(EXAMPLE);
  $("query-text").value = tabs.current.text;
  $("editor").setAttribute("aria-busy", "true");
  if (data.run && data.stored) brief();
  editor = await edit($("editor"), $("query-text"), {
    begun: (plain) => { editor = plain; },
    changed: (text) => tabs.write(text),
    run: () => start(),
    indent,
    problems,
    fix: mend,
    prefixes: () => settings().prefixes,
    complete: (text, position) => view("complete", { text, position }),
    diagnose: async (text) => (await view("diagnose", { text })).problems,
  });
  $("editor").setAttribute("aria-busy", "false");
  if (data.run && data.stored) editor.reveal(Math.max(0, editor.text.search(/^(?!#|PREFIX|\s*$)/im)));
  bindSettings();
  stored({
    list: $("stored-list"), filter: $("stored-filter"), form: $("stored-form"), begin: data.stored, values: data.values, failed,
    open: (one, text, _, runs) => { tabs.open(text, one.query.split("/").at(-1)); if (runs) start(); },
  });
  count();
  if (data.run && tabs.current.text !== data.text) changed();
  else if (data.run) start(data.wanted || null);
}

$("query-form").addEventListener("submit", (event) => { event.preventDefault(); start(); });
$("indent").addEventListener("click", indent);
$("share").addEventListener("click", share);
$("share-copy").addEventListener("click", copy);
begin();
