// The robot page: what its parts tell each other. The server connects, checks and runs; this page shows and asks.

import { file, Kept, link, linked } from "../blocks/kept.js";
import { Turns } from "../blocks/turns.js";
import { element } from "../table.js";
import { Abilities } from "./abilities.js";
import { examples } from "./examples.js";
import { Moving } from "./moving.js";
import { Places, pointOf } from "./places.js";
import { Said } from "./said.js";
import { ask, listen, Problem } from "./services.js";
import { Study } from "./study.js";
import { show, view } from "./view.js";
import { workspace } from "./workspace.js";

const $ = (id) => document.getElementById(id);
const programs = new Kept("kg-robot-program ");
const turns = new Turns();
const data = JSON.parse($("robot-page").dataset.page);
const TYPING = 400;
const EMPTY = { version: 1, name: "program", body: [] };

let robot = { state: data.address ? "connecting" : "none", capabilities: [], may_move: false };
let listener = null;
let program = EMPTY;
let lines = {};
let newest = 0;
let typing = 0;
let written = true;
let pending = Promise.resolve();
let blocks = null;

const said = new Said({ notices: $("notices"), problems: $("problems"), log: $("log"), values: $("values"), none: $("values-none") });
const moving = new Moving({ run: $("run"), pause: $("pause"), stop: $("stop"), running: $("running") }, {
  run, ask: (path, body = {}) => tried(() => ask(`/robot/${path}`, body)), listener: () => listener,
});
const abilities = new Abilities({
  list: $("abilities"), filter: $("abilities-filter"), found: $("abilities-found"),
  act: {
    do: (capability, values, seconds) => moving.hand(capability, values, seconds),
    end: () => moving.stop(),
    follow: (names) => tried(() => ask("/robot/read", { listener, capabilities: names })),
    add: async (capability, parameter) => {
      await settled();
      const block = blocks.add(capability, parameter);
      said.log(parameter ? `Put “${block.toString()}” beside the program: move it to where a value is wanted.` : `Put “${capability.label}” into the program.`);
    },
  },
});

const places = new Places({
  host: $("places"),
  act: {
    go: (capability, values) => moving.hand(capability, values, null),
    add: async (capability, name) => {
      await settled();
      blocks.addGoing(capability, name);
      said.log(`Put “${capability.label}, ${name}” into the program.`);
    },
    name: async (name, place) => {
      await settled();
      if (blocks) blocks.addPlace(name, place);
      else open(named(name, place, $("text").value));
      said.log(`“${name}” is a place of the program now.`);
    },
  },
});

/** Return the text of a program that gives a place a name before it does anything. */
function named(name, { x, y }, before) {
  const [head, rest] = /^((?:\s*(?:#.*)?\n)*\s*program .*\n?)?([^]*)$/u.exec(before).slice(1);
  return `${head ?? ""}set '${name.replaceAll("'", "")}' to (x: ${x.value} m, y: ${y.value} m)\n${rest}`;
}

const study = new Study({
  dialog: $("study-dialog"), start: $("study-start"), participant: $("study-participant"), robot: $("study-robot"), panel: $("study-panel"), task: $("study-task"),
  clock: $("study-clock"), read: $("study-read"), next: $("study-next"), end: $("study-end"), found: $("study-found"),
  download: $("study-download"), again: $("study-again"), open: () => $("study-dialog").showModal(),
}, data.exercises, () => replace(`program "program"\n`));

/** Do something of which the server may say that it cannot be; returns whether it could. */
async function tried(work) {
  try {
    await work();
    return true;
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    said.problem(error.members);
    return false;
  }
}

// The program, as blocks and as text

/** Say whether what is seen is still to be judged. */
function busy(on) {
  $("text-state").setAttribute("aria-busy", String(on));
}

/** Begin anew to judge the program: answers that are under way are of no use any more; returns the turn. */
function begun() {
  busy(true);
  return ++newest;
}

/** Take the answer of a check: the problems, the places of statements in the text, and the other form. */
async function check(asked) {
  const turn = begun();
  let answer = null;
  await tried(async () => { answer = await ask("/robot/check", asked); });
  if (asked.text !== undefined) await blocks?.still();
  blocks?.settle();
  if (turn !== newest) return;
  if (answer) judge(asked, answer);
  else moving.ready(false, "the program could not be checked");
  busy(false);
}

function judge(asked, answer) {
  lines = answer.lines;
  if (answer.program) program = { name: "program", ...answer.program };
  if (asked.text === undefined) $("text").value = answer.text;
  else if (answer.program) {
    $("program-name").value = program.name;
    blocks?.show(program);
  }
  judged(answer.problems, asked.text !== undefined && !answer.program);
}

function judged(problems, unread = false) {
  const wrong = problems.filter(({ severity }) => severity !== "warning");
  blocks?.complain(problems);
  said.problems(problems, (problem) => place(problem));
  if (unread) text(true);
  const many = problems.length === 1 ? "1 problem" : `${problems.length} problems`;
  $("text-state").textContent = unread ? "This cannot be read yet; the blocks show what could be read last." : problems.length ? `${many}, listed below.` : "Fits the robot.".repeat(robot.state === "connected" ? 1 : 0);
  moving.ready(!wrong.length && !unread && robot.state === "connected" && robot.may_move, why(wrong));
}

/** Show the text of the program, or fold it: with blocks it is folded until somebody wants it. */
function text(open) {
  $("text-part").hidden = !open;
  $("show-text").setAttribute("aria-expanded", String(open));
}

function why(problems) {
  if (robot.state !== "connected") return "no robot is connected";
  if (!robot.may_move) return "log in first";
  return problems.length ? "the program has problems" : "";
}

/** Go to where a problem is: its block, else its line of the text. */
function place({ id, line, column }) {
  if (blocks && id && blocks.go(id)) return;
  text(true);
  const field = $("text");
  const at = line ?? lines[id];
  if (!at) return;
  const start = field.value.split("\n").slice(0, at - 1).join("\n").length + (at > 1 ? 1 : 0) + (column ?? 1) - 1;
  field.focus();
  field.setSelectionRange(start, Math.max(start, field.value.indexOf("\n", start)));
}

function fromBlocks() {
  written = false;
  const read = blocks.read();
  if (read.program) pending = check({ program: read.program });
  else {
    begun();
    judged(read.problems);
    busy(false);
    $("text-state").textContent = "The blocks are not complete; the text is as it was before.";
  }
}

/** Say that pieces are not joined to the program: they do not run, though the program fits. */
function loose(many) {
  $("loose").hidden = many < 1;
  $("loose").textContent = `${many === 1 ? "A grey piece is" : `${many} grey pieces are`} not joined to the program and will not run: drag what should run below a block of the program.`;
}

function fromText() {
  clearTimeout(typing);
  typing = 0;
  written = true;
  pending = check({ text: $("text").value });
  return pending;
}

/** Show a program that comes from elsewhere, as text. */
function open(text) {
  $("text").value = text;
  return fromText();
}

/** Open another program once nothing is done any more with the one that is seen. */
const replace = (text) => turns.replace(() => open(text));

$("text").addEventListener("input", () => {
  begun();
  clearTimeout(typing);
  typing = setTimeout(fromText, TYPING);
});
$("program-name").addEventListener("change", async () => {
  const name = $("program-name").value.trim() || "program";
  await settled();
  $("program-name").value = name;
  program = { ...program, name };
  blocks?.rename(name);
  pending = check({ program });
});

/** Wait until the program that is seen, as text and as blocks, was judged. */
async function settled() {
  let last;
  do {
    if (typing) fromText();
    blocks?.settle();
    last = pending;
    await last;
  } while (typing || last !== pending);
}

async function run() {
  await settled();
  if (!moving.isReady) return;
  said.clearProblem();
  const undo = study.starts();
  if (await tried(() => ask("/robot/run", { program }))) study.ran(program, $("text").value);
  else undo();
}

// What the server tells

function heard(event) {
  if (event.event === "hello") ({ listener } = event);
  if (event.event === "hello" || event.event === "robot") refresh();
  else if (event.event === "view") show($("view"), event.picture, (across, down) => {
    const point = pointOf(event.picture, across, down);
    if (point) places.choose(point);
  });
  else if (event.event === "value") said.value(event, robot.capabilities);
  else if (event.event === "program") programme(event);
  else if (event.event === "step") step(event);
  else if (event.event === "hand") hand(event);
}

function programme(event) {
  moving.program(event);
  if (["done", "stopped", "failed"].includes(event.state)) study.ended(event.state);
  if (event.state !== "running" && event.state !== "paused") blocks?.mark([]);
  const words = { running: "runs", paused: "pauses", done: "is done", stopped: "was stopped", failed: "failed" }[event.state];
  said.log(`Program “${event.name}” ${words}${event.problem ? `: ${event.problem.message}` : ""}`, event.state === "failed" ? "error" : "");
  if (event.problem) {
    said.problem(event.problem);
    if (event.problem.id) blocks?.complain([event.problem]);
  }
}

function step(event) {
  if (event.variable !== undefined) said.variable(event);
  if (event.log !== undefined) said.log(event.log);
  if (event.running) {
    blocks?.mark(event.running);
    moving.at(event.running.map(line).filter(Boolean));
  }
}

/** Return the line of the text that a statement begins with. */
function line(id) {
  return $("text").value.split("\n")[lines[id] - 1]?.trim();
}

function hand(event) {
  const label = robot.capabilities.find(({ name }) => name === event.capability)?.label ?? event.capability;
  moving.handed(event, label);
  said.log({ doing: `${label} …`, done: `${label}: done`, stopped: `${label}: stopped`, "taken over": `${label}: taken over by another command`, failed: `${label}: ${event.problem?.message}` }[event.state], event.state === "failed" ? "error" : "");
  if (event.problem) said.problem(event.problem);
}

let shown = "";
let offers = 0;
let stale = false;
let refreshing = false;

/** Take what the robot is now, one question after the other, so that an older answer is never the last one. */
async function refresh() {
  stale = true;
  if (refreshing) return;
  refreshing = true;
  try {
    while (stale) {
      stale = false;
      await renew();
    }
  } finally {
    refreshing = false;
  }
}

async function renew() {
  let found = null;
  if (!await tried(async () => { found = await ask("/api/robot"); })) return;
  const before = robot.state;
  robot = found;
  connection(before);
  moving.program(robot.program ?? { state: "none" }, false);
  const able = robot.capabilities.filter(({ ways }) => ways.length);
  const now = JSON.stringify([robot.state, able, robot.may_move, robot.places, robot.doubts]);
  if (now !== shown) {
    shown = now;
    const connected = robot.state === "connected";
    if (able.length || connected) abilities.show(able, { mayMove: robot.may_move && connected, blocks: Boolean(blocks) });
    places.show(robot.places ?? {}, connected ? able : [], { mayMove: robot.may_move, blocks: Boolean(blocks) });
    if (connected) offer(able, Object.keys(robot.places));
    else judged([]);
  }
  if (robot.state === "connected" && abilities.followed.size) ask("/robot/read", { listener, capabilities: [...abilities.followed] }).catch(() => null);
  if (robot.program?.running) blocks?.mark(robot.program.running);
  view($("view"), robot);
}

/** Offer what the robot can do as blocks, once nobody has one in the hand, and judge the program anew. */
async function offer(able, names) {
  const turn = ++offers;
  await blocks?.still();
  if (turn !== offers) return;
  blocks?.offer(able, names);
  if (!typing) again();
}

/** Say whether the robot is there, and when that changes. */
function connection(before) {
  const { state, problem, address } = robot;
  const words = {
    connecting: problem ? `No robot answers at ${address} yet; it is tried again and again.` : `Connecting to ${address} …`,
    connected: `Connected to ${address}`,
    lost: `The robot at ${address} does not answer any more; it is tried again until it is back.`,
    none: "No robot",
  }[state];
  $("connection").textContent = problem && state !== "connected" ? `${words} (${problem.message})` : words;
  $("connection").classList.toggle("robot-lost", state === "lost");
  if (state === before) return;
  if (state === "lost") said.log(`The robot does not answer any more: ${problem?.message ?? ""}`, "error");
  if (before !== "lost" || state !== "connected") return;
  said.log("The robot is back.");
  said.clearProblem();
}

/** Judge the program anew, in the form in which somebody has changed it last. */
function again() {
  if (blocks && !written) fromBlocks();
  else fromText();
}

// Programs to open, and where they are kept

/** Do something with the text of the program that is seen, once that was judged. */
const take = (act) => turns.take(async () => { await settled(); await act($("text").value); });

$("new").addEventListener("click", () => { replace(`program "program"\n`); });
$("save").addEventListener("click", () => take(async (shown) => {
  const { name } = program;
  programs.keep(name, shown);
  $("save-name").textContent = name;
  const plain = name.replace(/[^\p{L}\p{N}._-]+/gu, "-");
  const links = [[`${plain}.kgp`, shown, "text/plain", "Save as text"], [`${plain}.json`, `${JSON.stringify(program, null, 2)}\n`, "application/json", "Save as JSON"]];
  for (const [to, label] of robot.state === "connected" ? [["rospy", "Save as Python for ROS 1"], ["rclpy", "Save as Python for ROS 2"], ["bt", "Save as behaviour tree"]] : []) {
    // A program that does not fit the robot has no code; what is wrong with it is listed already.
    const code = await ask("/robot/convert", { program, to }).catch(() => null);
    if (code) links.push(to === "bt" ? [`${plain}.xml`, code.text, "application/xml", label] : [`${plain}-${to}.py`, code.text, "text/x-python", label]);
  }
  $("save-files").replaceChildren(...links.map(([as, content, type, label]) => Object.assign(file(as, content, type), { textContent: label })));
  $("save-dialog").showModal();
}));
$("share").addEventListener("click", () => take((shown) => {
  $("share-link").value = link("program", shown);
  $("share-done").textContent = "";
  $("share-dialog").showModal();
}));
$("share-copy").addEventListener("click", async () => {
  try {
    await navigator.clipboard.writeText($("share-link").value);
    $("share-done").textContent = "Copied";
  } catch {
    $("share-link").select();
    $("share-done").textContent = "Press Ctrl C";
  }
});
$("open").addEventListener("click", kept);
$("open-file").addEventListener("change", async ({ target }) => {
  const [chosen] = target.files;
  if (!chosen) return;
  const content = await chosen.text();
  target.value = "";
  $("open-dialog").close();
  if (content.trimStart().startsWith("<")) tried(async () => replace((await ask("/robot/convert", { bt: content })).text));
  else if (!content.trimStart().startsWith("{")) replace(content);
  else tried(async () => replace((await ask("/robot/convert", { program: parsed(content), to: "text" })).text));
});

function parsed(content) {
  try {
    return JSON.parse(content);
  } catch {
    throw new Problem({ code: "", message: "The file is neither the text nor the JSON of a program.", hint: "" });
  }
}

function kept() {
  const entries = programs.all().map(([name, content]) => {
    const show = element("button", { type: "button" }, name);
    show.addEventListener("click", () => { $("open-dialog").close(); replace(content); });
    const drop = element("button", { type: "button", className: "link" }, "Forget");
    drop.setAttribute("aria-label", `Forget ${name}`);
    drop.addEventListener("click", () => { programs.forget(name); kept(); });
    return element("li", { className: "row" }, show, drop);
  });
  $("open-list").replaceChildren(...(entries.length ? entries : [element("li", {}, "None yet: Save keeps one.")]));
}

/** List the examples; when a robot is there, judged by what it can do. */
function list() {
  const able = robot.state === "connected" ? robot.capabilities.filter(({ ways }) => ways.length) : null;
  return tried(() => examples($("examples-list"), data.examples, able, (content) => { $("examples-dialog").close(); replace(content); }));
}

// The beginning

async function begin() {
  const given = linked("program");
  $("text").value = given ?? `program "program"\n`;
  $("examples").hidden = !data.examples.length;
  $("open").hidden = false;
  $("study").addEventListener("click", () => {
    $("examples-dialog").close();
    $("study-dialog").showModal();
  });
  $("examples").addEventListener("click", list);
  list();
  blocks = await workspace($("blocks"), { units: data.units, changed: fromBlocks, loose, ready: () => { $("blocks").hidden = false; } });
  if (blocks) {
    $("block-tools").hidden = false;
    $("show-text").hidden = false;
    $("show-text").addEventListener("click", () => text($("text-part").hidden));
    if (document.activeElement !== $("text")) text(false);
    for (const [id, act] of Object.entries({ undo: () => blocks.undo(false), redo: () => blocks.undo(true), smaller: () => blocks.zoom(-1), larger: () => blocks.zoom(1), fit: () => blocks.zoom(0) })) $(id).addEventListener("click", act);
  }
  await fromText(); // which somebody may have changed while the blocks came
  if (given !== null) said.log("The program of the link is shown. It does not run until you press Run.");
  window.addEventListener("hashchange", () => { const other = linked("program"); if (other !== null) replace(other); });
  if (data.address) listen(heard, () => { listener = null; $("connection").textContent = "The server cannot be reached …"; });
}

begin();
