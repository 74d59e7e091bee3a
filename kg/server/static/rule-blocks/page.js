// The page of rules as blocks: blocks, text and documentation of one rule, its findings, its inferences.

import { url } from "../address.js";
import { file, link, linked, TextStore } from "../blocks/storage.js";
import { Turns } from "../blocks/turns.js";
import { edit } from "../query/editor.js";
import { Problem, view } from "../query/services.js";
import { element } from "../table.js";
import { Chooser } from "./choosing.js";
import { Offering } from "./offering.js";
import { results } from "./results.js";
import { every, Vocabulary } from "./vocabulary.js";
import { workspace } from "./workspace.js";

const $ = (id) => document.getElementById(id);
const rules = new TextStore("kg-rule-blocks ");
const turns = new Turns();
const TYPING = 500;
const FIELDS = ["name", "title", "why", "infers", "mend", "limits", "references", "since"];
const EMPTY = { version: 1, name: "mine/rule", when: [], then: [] };
const NAME = /^[a-z0-9][a-z0-9_-]*(\/[a-z0-9][a-z0-9_-]*)+$/;
const BEGIN = "Drag conditions from the list next to the blocks to “when” and conclusions to “then”, or start from an example.";
/** The code of the note that nothing on this store passes a part: authors of a rule want to see where. */
const UNMATCHED = "KG213";
const DRAFT = "kg-rule-blocks-draft";

let rule = EMPTY;
let vocabulary = new Vocabulary({ classes: [], properties: [] });
let known = { rules: [], examples: [] };
let blocks = null;
let editor = null;
let newest = 0;
let judged = 0;
let opening = 0;
let trial = 0;
let typing = 0;
let setting = false;
let findings = [];
let pending = Promise.resolve();
let formed = {};

// Messages of the page

/** Return a text whose parts between backticks are code. */
function prose(text) {
  return text.split("`").map((part, index) => (index % 2 ? element("code", {}, part) : part));
}

/** Do something that the server may reject, which `host` shows if it is `wanted()` still; returns whether it succeeded. */
async function tried(work, host = $("notices"), wanted = () => true) {
  $("notices").replaceChildren();
  try {
    await work();
    return true;
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    if (!wanted()) return false;
    const { code, message, hint } = error.members;
    const box = element("div", { className: "notice error" }, element("p", {}, element("strong", {}, ...prose(message))), element("p", {}, code ? `${code}: ` : "", ...prose(hint ?? "")));
    box.setAttribute("role", "alert");
    host.replaceChildren(box);
    return false;
  }
}

function list(all) {
  findings = all;
  const focused = [...$("findings").querySelectorAll("button, a")].indexOf(document.activeElement);
  const order = ["error", "warning", "note"];
  const sorted = [...all].sort((one, other) => order.indexOf(one.severity) - order.indexOf(other.severity));
  $("findings").replaceChildren(...sorted.map((one) => {
    const go = element("button", { type: "button", className: "link" }, one.lacks?.length ? "show the field" : one.id && blocks ? "show the block" : one.line ? `line ${one.line}` : "");
    go.setAttribute("aria-label", `${go.textContent}: ${one.message}`);
    go.addEventListener("click", () => place(one));
    return element("li", { className: one.severity }, element("span", { className: `tag ${one.severity}` }, one.severity), " ", ...prose(one.message), " ", go.textContent ? go : null, element("small", {}, ...prose(one.hint ?? ""), " ", one.code ? element("a", { href: url(`/errors/${one.code}`) }, one.code) : ""));
  }));
  if (focused >= 0) [...$("findings").querySelectorAll("button, a")].slice(0, focused + 1).at(-1)?.focus();
  const wrong = all.filter(({ severity }) => severity !== "note").length;
  $("state").textContent = wrong ? `${wrong === 1 ? "One thing needs" : `${wrong} things need`} your attention.` : all.length ? "The rule can run; there are notes." : rule.then.length ? "The check finds nothing wrong." : "";
  $("state").className = wrong ? "rule-wrong" : "quiet-text";
}

/** Go to where a finding is: its block, the field of its documentation, or its line. */
function place({ id, line, lacks }) {
  if (lacks?.length) {
    const field = $(`rule-${lacks[0]}`);
    field.closest("details")?.setAttribute("open", "");
    field.focus();
    return;
  }
  if (blocks && id && blocks.go(id)) return;
  if (!line) return;
  const before = editor.text.split("\n").slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
  const points = [...editor.text.slice(0, before)].length;
  const length = [...(editor.text.split("\n")[line - 1] ?? "")].length;
  editor.go({ start: points, end: points + length });
}

// One rule, as blocks, as text, and its documentation in a form

/** Show the documentation; if `kept`, fields edited since stay. */
function form(kept) {
  for (const name of FIELDS) {
    if (kept && edited(name)) continue;
    $(`rule-${name}`).value = rule[name] ?? { since: "0.1" }[name] ?? "";
    formed[name] = $(`rule-${name}`).value;
  }
  if (!kept) named();
  $("rule-infers").placeholder = "Written for you as long as it is empty";
}

/** Whether a field of the form has an edit that the rule does not have yet. */
const edited = (name) => $(`rule-${name}`).value !== formed[name];

function written(text) {
  setting = true;
  editor.text = text;
  setting = false;
  // The documentation comes first; the content of the blocks is at the end.
  const scrolled = $("editor").querySelector("div")?.shadowRoot?.querySelector(".cm-scroller");
  if (scrolled) requestAnimationFrame(() => { scrolled.scrollTop = scrolled.scrollHeight; });
}

/** Show whether the check of the current text is pending. */
function busy(on) {
  $("state").setAttribute("aria-busy", String(on));
}

/** Start a new check of the rule: pending answers are outdated; returns the turn. */
function begun() {
  busy(true);
  return ++newest;
}

/** End the check of the current rule. */
function ended() {
  judged = newest;
  busy(false);
}

/** Return the server's check of the rule; null if it fails, or if the rule has been replaced by then. */
async function checked(turn, request) {
  let answer = null;
  await tried(async () => { answer = await view("blocks_check", request); }, $("notices"), () => turn === newest);
  await blocks?.still();
  blocks?.flush();
  if (turn !== newest) return null;
  if (!answer) {
    say("The rule could not be checked.");
    ended();
  }
  return answer;
}

function say(words) {
  $("state").textContent = words;
  $("state").className = "quiet-text";
}

/** Take a rule in its other form, then check it; `request` is { rule } or { text, name }. */
async function check(request) {
  const turn = begun();
  say("Checking …");
  const answer = await checked(turn, { ...request, brief: "1" });
  if (!answer) return;
  if (request.text === undefined) written(answer.text);
  else if (answer.rule) {
    rule = { ...EMPTY, ...answer.rule };
    form(true);
    show();
  }
  draft();
  judge(turn, request, answer);
}

/** Show the findings on the rule, once the server has checked it. */
async function judge(turn, request, first) {
  const answer = first.rule ? await checked(turn, { rule: plain() }) : first;
  if (!answer) return;
  ended();
  const own = answer.rule ? misfits() : [];
  const empty = request.text === undefined && !rule.then.length;
  list([...(empty ? [] : answer.findings.map(withPrefix)), ...own]);
  if (empty) $("state").textContent = rule.when.length ? "Now put what follows from it under “then”: “Conclusions” has blocks for that." : BEGIN;
  if (request.text !== undefined && !answer.rule) $("state").textContent = "This text cannot be shown as blocks yet; they stay as they were.";
  blocks?.complain(findings.filter(({ severity, code }) => severity !== "note" || code === UNMATCHED));
}

const misfits = () => vocabulary.misfits(rule).map((one) => ({ code: "", severity: "warning", hint: "", ...one }));

/** Return a finding for this page: names of the rule's family have its prefix. */
function withPrefix(one) {
  const own = `https://example.org/${rule.name.split("/").slice(0, -1).join("/")}#`;
  if (one.lacks.length) return undocumented(one);
  return { ...one, message: one.message.replaceAll(new RegExp(`<${own.replaceAll(/[.*+?^$()|[\]\\]/g, "\\$&")}([\\w-]+)>`, "g"), "my:$1") };
}

/** Return the missing documentation by the names of the fields, instead of those of the text. */
function undocumented(one) {
  const fields = one.lacks.map((member) => `“${$(`rule-${member}`).labels[0].textContent.split(":")[0]}”`);
  return { ...one, line: 0, message: `Nothing is said under ${fields.join(" and ")}.`, hint: "Fill in the fields above the blocks; who reads the rule needs them." };
}

function fromBlocks() {
  unwritten();
  const { when, then, problems } = blocks.read();
  rule = { ...rule, when, then };
  if (!problems.length) {
    wait(check({ rule }));
    return;
  }
  begun();
  ended();
  list(problems.map((one) => ({ severity: "error", code: "", hint: "", ...one })));
  blocks.complain(problems);
  $("state").textContent = "The blocks are not complete; the text is as it was before.";
}

/** Stop waiting for the end of typing. */
function unwritten() {
  clearTimeout(typing);
  typing = 0;
}

function fromText() {
  unwritten();
  wait(check({ text: editor.text, name: rule.name }));
}

/** Make `synced` wait for this, too. */
function wait(work) {
  pending = Promise.all([pending, work]);
}

/** Return whether the name in the form is valid, and describe valid names if not. */
function named() {
  const right = NAME.test($("rule-name").value.trim());
  $("rule-name").setAttribute("aria-invalid", String(!right));
  $("name-help").textContent = right ? "" : "A family and a name, of small letters, digits and hyphens: mine/laser-driver";
  return right;
}

/** Take the content of the form, once a text edited before has become the rule. */
function fromForm() {
  if (typing) fromText();
  busy(true);
  wait(pending.then(async () => {
    if (!FIELDS.some(edited)) return busy(judged !== newest);
    for (const name of FIELDS) formed[name] = $(`rule-${name}`).value;
    rule = documented();
    await check({ rule: plain() });
  }));
}

/** Return the rule with the documentation of the form. */
function documented() {
  const texts = Object.fromEntries(FIELDS.map((name) => [name, $(`rule-${name}`).value.trim()]).filter(([, value]) => value));
  if (!named()) texts.name = rule.name;
  if (!/^\S+$/.test(texts.since ?? "0.1")) texts.since = "0.1";
  return { version: 1, prefixes: rule.prefixes, severity: rule.severity, ...texts, when: rule.when, then: rule.then };
}

/** Return the rule without unset members. */
const plain = (of = rule) => Object.fromEntries(Object.entries(of).filter(([, value]) => value !== undefined && value !== ""));

/** Show a rule from elsewhere, replacing all edits. */
function open(other) {
  unwritten();
  opening += 1;
  trial += 1;
  rule = { ...EMPTY, ...other };
  $("tried").replaceChildren();
  $("tried").setAttribute("aria-busy", "false");
  form(false);
  show();
  wait(check({ rule: plain() }));
}

/** Show another rule once all actions on the current one are done. */
const replace = (other) => turns.replace(() => open(other));

/** Do something with the current rule, once all its forms agree. */
const take = (act) => turns.take(async () => { await synced(); await act(); });

/** Show the rule as blocks; their identities become those of its parts. */
function show() {
  if (!blocks) return;
  blocks.show(rule);
  const { when, then, problems } = blocks.read();
  if (!problems.length) rule = { ...rule, when, then };
}

/** Wait until blocks, text and documentation agree on one rule. */
async function synced() {
  let last;
  do {
    if (typing) fromText();
    blocks?.flush();
    if (FIELDS.some(edited)) fromForm();
    last = pending;
    await last;
  } while (typing || last !== pending);
}

function draft(of = rule) {
  try {
    sessionStorage.setItem(DRAFT, JSON.stringify(plain(of)));
  } catch {
    // Storage may be forbidden or full.
  }
}

function drafted() {
  try {
    return JSON.parse(sessionStorage.getItem(DRAFT));
  } catch {
    return null;
  }
}

// Actions

/** Try the current rule; an older trial is outdated. */
async function attempt() {
  const turn = ++trial;
  const host = $("tried");
  host.setAttribute("aria-busy", "true");
  host.replaceChildren(element("p", { className: "quiet-text" }, "Trying …"));
  await synced();
  if (turn !== trial) return;
  let found = null;
  const request = { text: editor.text, name: rule.name, limit: 50 };
  const could = await tried(async () => { found = await view("blocks_try", request); }, host, () => turn === trial);
  if (turn !== trial) return;
  host.setAttribute("aria-busy", "false");
  if (!could) return;
  host.replaceChildren(...results(found, (name) => vocabulary.label(name)));
  if (found.examples) host.append(exampled(found.examples));
}

/** Return the button that saves examples for `kg rules test`. */
function exampled(text) {
  const button = element("button", { type: "button" }, `Download examples (${fileName(".md")})`);
  button.addEventListener("click", () => save(fileName(".md"), text, "text/markdown"));
  return element("p", {}, button, " ", element("span", { className: "quiet-text" }, "created from the first fact. Put the file next to the rule; then ", element("code", {}, "kg rules test"), " runs it."));
}

/** Save a text as a file. */
function save(name, text, type) {
  const anchor = file(name, text, type);
  anchor.click();
  setTimeout(() => URL.revokeObjectURL(anchor.href), 1000);
}

/** Return the rule of a text, or null where something else was written. */
function parsed(text) {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}

const fileName = (ending) => `${rule.name.split("/").at(-1)}${ending}`;

async function copy(text, told_) {
  try {
    await navigator.clipboard.writeText(text);
    told_.textContent = "Copied";
  } catch {
    told_.textContent = "Press Ctrl C";
  }
}

const ACTS = {
  new: () => replace(EMPTY),
  save: () => take(() => { rules.save(rule.name, JSON.stringify(plain())); $("message").textContent = `Kept in this browser as ${rule.name}.`; }),
  download: () => take(() => { save(fileName(".rq"), editor.text, "application/sparql-query"); $("message").textContent = `Put it into rules/${rule.name.split("/").slice(0, -1).join("/")}/ and run \`kg rules check ${rule.name}\`.`; }),
  copy: () => take(() => copy(editor.text, $("message"))),
  share: () => take(() => { $("share-link").value = link("rule", JSON.stringify(plain())); $("share-done").textContent = ""; $("share-dialog").showModal(); $("share-link").select(); }),
  "share-copy": () => copy($("share-link").value, $("share-done")),
  try: attempt,
  undo: () => blocks.undo(false), redo: () => blocks.undo(true),
  smaller: () => blocks.zoom(-1), larger: () => blocks.zoom(1), fit: () => blocks.zoom(0),
};

function choices() {
  $("examples-list").replaceChildren(...known.examples.map((one) => entry(one.title, one.comment, $("examples-dialog"), () => replace(one.rule))));
  const mine = rules.all().map(([, text]) => parsed(text)).filter(Boolean).map((one) => {
    const item = entry(one.title || one.name, one.name, $("open-dialog"), () => replace(one));
    const drop = element("button", { type: "button", className: "link" }, "Forget");
    drop.setAttribute("aria-label", `Forget ${one.name}`);
    drop.addEventListener("click", () => { rules.remove(one.name); choices(); });
    item.append(drop);
    return item;
  });
  $("open-list").replaceChildren(...(mine.length ? mine : [element("li", {}, "None yet: Keep keeps one.")]));
  const words = $("open-filter").value.toLowerCase().split(/\s+/);
  const found = known.rules.filter(({ name, title }) => words.every((word) => `${name} ${title}`.toLowerCase().includes(word)));
  $("open-rules").replaceChildren(...found.map((one) => entry(one.name, one.title, $("open-dialog"), () => opened(one.name))));
}

/** Open a rule of the store, unless another is opened or the current one is edited meanwhile. */
async function opened(name) {
  const own = ++opening;
  await synced();
  const turn = newest;
  let found = null;
  if (!await tried(async () => { found = await view("blocks_open", { name }); }, $("notices"), () => own === opening)) return;
  await blocks?.still();
  blocks?.flush();
  if (own !== opening) return;
  if (turn !== newest || FIELDS.some(edited)) $("message").textContent = `${name} was not opened: the rule that is shown was changed meanwhile.`;
  else open(found.rule);
}

function entry(title, comment, dialog, act) {
  const button = element("button", { type: "button" }, title);
  button.addEventListener("click", () => { dialog.close(); act(); });
  return element("li", {}, button, comment ? element("p", {}, ...prose(comment)) : null);
}

// The beginning

/** Edit SPARQL in a dialog; null if cancelled. */
function sparql(text) {
  $("sparql-text").value = text;
  $("sparql-dialog").returnValue = "";
  $("sparql-dialog").showModal();
  return new Promise((resolve) => {
    $("sparql-dialog").addEventListener("close", () => resolve($("sparql-dialog").returnValue === "take" ? $("sparql-text").value.trim() : null), { once: true });
  });
}

async function make() {
  const chooser = new Chooser({ dialog: $("choose-dialog"), title: $("choose-title"), help: $("choose-help"), field: $("choose-field"), list: $("choose-list"), count: $("choose-count") });
  const offering = new Offering(chooser, vocabulary, {
    rule: () => blocks?.read() ?? rule,
    complete: (text) => view("complete", { text }).catch(() => ({ items: [], more: false })),
  });
  blocks = await workspace($("blocks"), { vocabulary, offering, edit: sparql, changed: fromBlocks, loose, choosing, moved: () => busy(true), ready: () => { $("blocks").hidden = false; } });
  if (blocks) $("block-tools").hidden = false;
}

/** Whether a dialog for a block is open. */
const choosing = () => $("choose-dialog").open || $("sparql-dialog").open;

/** Report pieces that are not joined to the rule. */
function loose(many) {
  busy(judged !== newest);
  $("loose").hidden = many < 1;
  $("loose").textContent = `${many === 1 ? "A grey piece is" : `${many} grey pieces are`} not joined to the rule and not part of it: drag it under “when” or “then”.`;
}

async function begin() {
  const page = $("rule-page");
  page.inert = true;
  page.setAttribute("aria-busy", "true");
  say("Loading …");
  try {
    await ready();
  } finally {
    page.inert = false;
    page.setAttribute("aria-busy", "false");
  }
  if (!known.ready) count();
}

async function ready() {
  editor = await edit($("editor"), $("text"), {
    changed: () => {
      if (setting) return;
      begun();
      clearTimeout(typing);
      typing = setTimeout(fromText, TYPING);
    },
    run: attempt, indent: () => null, problems: () => null, fix: () => null, prefixes: () => true,
    complete: (text, position) => view("complete", { text, position }), diagnose: async () => [],
  });
  form(false);
  await tried(async () => { known = await view("blocks"); });
  vocabulary = new Vocabulary({ classes: known.classes ?? [], properties: known.properties ?? [] });
  await make();
  for (const [id, act] of Object.entries(ACTS)) $(id).addEventListener("click", act);
  for (const name of FIELDS) $(`rule-${name}`).addEventListener("change", fromForm);
  $("open").addEventListener("click", choices);
  $("open-filter").addEventListener("input", choices);
  choices();
  document.addEventListener("keydown", (event) => {
    // The editor has these keys too.
    if (event.key === "Enter" && (event.ctrlKey || event.metaKey) && !event.defaultPrevented) attempt();
  });
  const initial = $("rule-page").dataset.rule;
  const given = parsed(linked("rule"));
  window.addEventListener("hashchange", () => { const other = parsed(linked("rule")); if (other) replace(other); });
  window.addEventListener("pagehide", left);
  if (given) open(given);
  else if (initial) await opened(initial);
  else open(drafted() ?? known.examples.at(-1)?.rule ?? EMPTY);
}

/** Store the last edit, without checking it. */
function left() {
  const { problems, ...seen } = blocks?.read() ?? { problems: [] };
  draft({ ...documented(), ...(problems.length ? {} : seen) });
}

/** Have the store counted in the background, and take the figures. */
async function count() {
  const found = await view("blocks", { fresh: "1" }).catch(() => null);
  if (!found) return;
  known = found;
  choices();
  await blocks?.know(new Vocabulary(found));
}

begin();
