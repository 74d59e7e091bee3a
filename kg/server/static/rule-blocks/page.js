// The page of rules as blocks: blocks, text and documentation of one rule, what is wrong with it, what it would infer.

import { url } from "../address.js";
import { file, Kept, link, linked } from "../blocks/kept.js";
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
const rules = new Kept("kg-rule-blocks ");
const turns = new Turns();
const TYPING = 500;
const SAID = ["name", "title", "why", "infers", "mend", "limits", "references", "since"];
const EMPTY = { version: 1, name: "mine/rule", when: [], then: [] };
const NAME = /^[a-z0-9][a-z0-9_-]*(\/[a-z0-9][a-z0-9_-]*)+$/;
const BEGIN = "Drag conditions from the list next to the blocks to “when” and conclusions to “then”, or start from an example.";
/** The code of the note that nothing on this store passes a part: who composes a rule wants to see where. */
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

// What the page says

/** Return a text with what stands between backticks as code. */
function prose(text) {
  return text.split("`").map((part, index) => (index % 2 ? element("code", {}, part) : part));
}

/** Do something of which the server may say that it cannot be, which `host` then tells if it is `wanted()` still; returns whether it could. */
async function tried(work, host = $("notices"), wanted = () => true) {
  $("notices").replaceChildren();
  try {
    await work();
    return true;
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    if (!wanted()) return false;
    const { code, message, hint } = error.members;
    const made = element("div", { className: "notice error" }, element("p", {}, element("strong", {}, ...prose(message))), element("p", {}, code ? `${code}: ` : "", ...prose(hint ?? "")));
    made.setAttribute("role", "alert");
    host.replaceChildren(made);
    return false;
  }
}

function list(all) {
  findings = all;
  const held = [...$("findings").querySelectorAll("button, a")].indexOf(document.activeElement);
  const order = ["error", "warning", "note"];
  const sorted = [...all].sort((one, other) => order.indexOf(one.severity) - order.indexOf(other.severity));
  $("findings").replaceChildren(...sorted.map((one) => {
    const go = element("button", { type: "button", className: "link" }, one.lacks?.length ? "show the field" : one.id && blocks ? "show the block" : one.line ? `line ${one.line}` : "");
    go.setAttribute("aria-label", `${go.textContent}: ${one.message}`);
    go.addEventListener("click", () => place(one));
    return element("li", { className: one.severity }, element("span", { className: `tag ${one.severity}` }, one.severity), " ", ...prose(one.message), " ", go.textContent ? go : null, element("small", {}, ...prose(one.hint ?? ""), " ", one.code ? element("a", { href: url(`/errors/${one.code}`) }, one.code) : ""));
  }));
  if (held >= 0) [...$("findings").querySelectorAll("button, a")].slice(0, held + 1).at(-1)?.focus();
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

/** Show the documentation; what was written into the form since stays where it is to be `kept`. */
function form(kept) {
  for (const name of SAID) {
    if (kept && edited(name)) continue;
    $(`rule-${name}`).value = rule[name] ?? { since: "0.1" }[name] ?? "";
    formed[name] = $(`rule-${name}`).value;
  }
  if (!kept) named();
  $("rule-infers").placeholder = "Written for you as long as it is empty";
}

/** Whether something was written into a field of the form that the rule has not yet. */
const edited = (name) => $(`rule-${name}`).value !== formed[name];

function written(text) {
  setting = true;
  editor.text = text;
  setting = false;
  // The documentation comes first; what the blocks say stands at the end.
  const scrolled = $("editor").querySelector("div")?.shadowRoot?.querySelector(".cm-scroller");
  if (scrolled) requestAnimationFrame(() => { scrolled.scrollTop = scrolled.scrollHeight; });
}

/** Say whether what is seen is still to be judged. */
function busy(on) {
  $("state").setAttribute("aria-busy", String(on));
}

/** Begin anew to judge the rule: answers that are under way are of no use any more; returns the turn. */
function begun() {
  busy(true);
  return ++newest;
}

/** End to judge what is seen. */
function ended() {
  judged = newest;
  busy(false);
}

/** Return what the server says of the rule; null where it does not, or where the rule is another one by then. */
async function answered(turn, asked) {
  let answer = null;
  await tried(async () => { answer = await view("blocks_check", asked); }, $("notices"), () => turn === newest);
  await blocks?.still();
  blocks?.settle();
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

/** Take a rule in its other form, then have it checked; `asked` is { rule } or { text, name }. */
async function check(asked) {
  const turn = begun();
  say("Checking …");
  const answer = await answered(turn, { ...asked, brief: "1" });
  if (!answer) return;
  if (asked.text === undefined) written(answer.text);
  else if (answer.rule) {
    rule = { ...EMPTY, ...answer.rule };
    form(true);
    show();
  }
  draft();
  judge(turn, asked, answer);
}

/** Tell what is wrong with the rule, once the server has found it out. */
async function judge(turn, asked, first) {
  const answer = first.rule ? await answered(turn, { rule: plain() }) : first;
  if (!answer) return;
  ended();
  const own = answer.rule ? misfits() : [];
  const empty = asked.text === undefined && !rule.then.length;
  list([...(empty ? [] : answer.findings.map(told)), ...own]);
  if (empty) $("state").textContent = rule.when.length ? "Now put what follows from it under “then”: “Conclusions” has blocks for that." : BEGIN;
  if (asked.text !== undefined && !answer.rule) $("state").textContent = "This text cannot be shown as blocks yet; they stay as they were.";
  blocks?.complain(findings.filter(({ severity, code }) => severity !== "note" || code === UNMATCHED));
}

const misfits = () => vocabulary.misfits(rule).map((one) => ({ code: "", severity: "warning", hint: "", ...one }));

/** Return a finding as this page shows it: names of the rule's family as its prefix has them. */
function told(one) {
  const own = `https://example.org/${rule.name.split("/").slice(0, -1).join("/")}#`;
  if (one.lacks.length) return undocumented(one);
  return { ...one, message: one.message.replaceAll(new RegExp(`<${own.replaceAll(/[.*+?^$()|[\]\\]/g, "\\$&")}([\\w-]+)>`, "g"), "my:$1") };
}

/** Return what the documentation lacks by the names of the fields, instead of those of the text. */
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

/** Wait no longer for the end of typing. */
function unwritten() {
  clearTimeout(typing);
  typing = 0;
}

function fromText() {
  unwritten();
  wait(check({ text: editor.text, name: rule.name }));
}

/** Let what waits until all is settled wait for this too. */
function wait(work) {
  pending = Promise.all([pending, work]);
}

/** Return whether the name in the form is one, and say what names are where it is not. */
function named() {
  const right = NAME.test($("rule-name").value.trim());
  $("rule-name").setAttribute("aria-invalid", String(!right));
  $("name-help").textContent = right ? "" : "A family and a name, of small letters, digits and hyphens: mine/laser-driver";
  return right;
}

/** Take what the form says, once a text that was written before has become the rule. */
function fromForm() {
  if (typing) fromText();
  busy(true);
  wait(pending.then(async () => {
    if (!SAID.some(edited)) return busy(judged !== newest);
    for (const name of SAID) formed[name] = $(`rule-${name}`).value;
    rule = documented();
    await check({ rule: plain() });
  }));
}

/** Return the rule with the documentation that the form says. */
function documented() {
  const said = Object.fromEntries(SAID.map((name) => [name, $(`rule-${name}`).value.trim()]).filter(([, value]) => value));
  if (!named()) said.name = rule.name;
  if (!/^\S+$/.test(said.since ?? "0.1")) said.since = "0.1";
  return { version: 1, prefixes: rule.prefixes, severity: rule.severity, ...said, when: rule.when, then: rule.then };
}

/** Return the rule without what is not set. */
const plain = (of = rule) => Object.fromEntries(Object.entries(of).filter(([, value]) => value !== undefined && value !== ""));

/** Show a rule that comes from elsewhere, in the place of all that was written. */
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

/** Show another rule once nothing is done any more with the one that is seen. */
const replace = (other) => turns.replace(() => open(other));

/** Do something with the rule that is seen, once that is one rule. */
const take = (act) => turns.take(async () => { await settled(); await act(); });

/** Show the rule as blocks; their identities become those of its parts. */
function show() {
  if (!blocks) return;
  blocks.show(rule);
  const { when, then, problems } = blocks.read();
  if (!problems.length) rule = { ...rule, when, then };
}

/** Wait until what is seen, as blocks, text and documentation, is one rule. */
async function settled() {
  let last;
  do {
    if (typing) fromText();
    blocks?.settle();
    if (SAID.some(edited)) fromForm();
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

// What can be done with it

/** Try the rule that is seen; an older trial is of no use any more. */
async function attempt() {
  const turn = ++trial;
  const host = $("tried");
  host.setAttribute("aria-busy", "true");
  host.replaceChildren(element("p", { className: "quiet-text" }, "Trying …"));
  await settled();
  if (turn !== trial) return;
  let found = null;
  const asked = { text: editor.text, name: rule.name, limit: 50 };
  const could = await tried(async () => { found = await view("blocks_try", asked); }, host, () => turn === trial);
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
  const made = file(name, text, type);
  made.click();
  setTimeout(() => URL.revokeObjectURL(made.href), 1000);
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
  save: () => take(() => { rules.keep(rule.name, JSON.stringify(plain())); $("said").textContent = `Kept in this browser as ${rule.name}.`; }),
  download: () => take(() => { save(fileName(".rq"), editor.text, "application/sparql-query"); $("said").textContent = `Put it into rules/${rule.name.split("/").slice(0, -1).join("/")}/ and run \`kg rules check ${rule.name}\`.`; }),
  copy: () => take(() => copy(editor.text, $("said"))),
  share: () => take(() => { $("share-link").value = link("rule", JSON.stringify(plain())); $("share-done").textContent = ""; $("share-dialog").showModal(); $("share-link").select(); }),
  "share-copy": () => copy($("share-link").value, $("share-done")),
  try: attempt,
  undo: () => blocks.undo(false), redo: () => blocks.undo(true),
  smaller: () => blocks.zoom(-1), larger: () => blocks.zoom(1), fit: () => blocks.zoom(0),
};

function choices() {
  $("examples-list").replaceChildren(...known.examples.map((one) => entry(one.title, one.comment, $("examples-dialog"), () => replace(one.rule))));
  const mine = rules.all().map(([, text]) => parsed(text)).filter(Boolean).map((one) => {
    const made = entry(one.title || one.name, one.name, $("open-dialog"), () => replace(one));
    const drop = element("button", { type: "button", className: "link" }, "Forget");
    drop.setAttribute("aria-label", `Forget ${one.name}`);
    drop.addEventListener("click", () => { rules.forget(one.name); choices(); });
    made.append(drop);
    return made;
  });
  $("open-list").replaceChildren(...(mine.length ? mine : [element("li", {}, "None yet: Keep keeps one.")]));
  const words = $("open-filter").value.toLowerCase().split(/\s+/);
  const found = known.rules.filter(({ name, title }) => words.every((word) => `${name} ${title}`.toLowerCase().includes(word)));
  $("open-rules").replaceChildren(...found.map((one) => entry(one.name, one.title, $("open-dialog"), () => opened(one.name))));
}

/** Open a rule of the store, unless another is opened or the one that is shown is changed meanwhile. */
async function opened(name) {
  const own = ++opening;
  await settled();
  const turn = newest;
  let found = null;
  if (!await tried(async () => { found = await view("blocks_open", { name }); }, $("notices"), () => own === opening)) return;
  await blocks?.still();
  blocks?.settle();
  if (own !== opening) return;
  if (turn !== newest || SAID.some(edited)) $("said").textContent = `${name} was not opened: the rule that is shown was changed meanwhile.`;
  else open(found.rule);
}

function entry(title, comment, dialog, act) {
  const button = element("button", { type: "button" }, title);
  button.addEventListener("click", () => { dialog.close(); act(); });
  return element("li", {}, button, comment ? element("p", {}, ...prose(comment)) : null);
}

// The beginning

/** Let somebody write SPARQL in a dialog; null where they do not. */
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

/** Whether somebody is choosing what a block is to say. */
const choosing = () => $("choose-dialog").open || $("sparql-dialog").open;

/** Say that pieces are not joined to the rule. */
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
  for (const name of SAID) $(`rule-${name}`).addEventListener("change", fromForm);
  $("open").addEventListener("click", choices);
  $("open-filter").addEventListener("input", choices);
  choices();
  document.addEventListener("keydown", (event) => {
    // The editor has these keys too.
    if (event.key === "Enter" && (event.ctrlKey || event.metaKey) && !event.defaultPrevented) attempt();
  });
  const asked = $("rule-page").dataset.rule;
  const given = parsed(linked("rule"));
  window.addEventListener("hashchange", () => { const other = parsed(linked("rule")); if (other) replace(other); });
  window.addEventListener("pagehide", left);
  if (given) open(given);
  else if (asked) await opened(asked);
  else open(drafted() ?? known.examples.at(-1)?.rule ?? EMPTY);
}

/** Keep what was changed last, without asking whether it is right. */
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
