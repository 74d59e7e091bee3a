// The robot page: connects its parts. The server connects, checks and runs; this page shows and requests.

import { file, link, linked, TextStore } from "../blocks/storage.js";
import { Turns } from "../blocks/turns.js";
import { element } from "../table.js";
import { Abilities } from "./abilities.js";
import { examples } from "./examples.js";
import { Moving } from "./moving.js";
import { Places, pointOf } from "./places.js";
import { Output } from "./output.js";
import { ask, listen, Problem } from "./services.js";
import { Study } from "./study.js";
import { show, view } from "./view.js";
import { workspace } from "./workspace.js";

const $ = (id) => document.getElementById(id);
const programs = new TextStore("kg-robot-program ");
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

const output = new Output({ notices: $("notices"), problems: $("problems"), log: $("log"), values: $("values"), none: $("values-none") });
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
      await synced();
      const block = blocks.add(capability, parameter);
      output.log(parameter ? `Put “${block.toString()}” beside the program: move it to where a value is wanted.` : `Put “${capability.label}” into the program.`);
    },
  },
});

const places = new Places({
  host: $("places"),
  act: {
    go: (capability, values) => moving.hand(capability, values, null),
    add: async (capability, name) => {
      await synced();
      blocks.addGoing(capability, name);
      output.log(`Put “${capability.label}, ${name}” into the program.`);
    },
    name: async (name, place) => {
      await synced();
      if (blocks) blocks.addPlace(name, place);
      else open(named(name, place, $("text").value));
      output.log(`“${name}” is a place of the program now.`);
    },
  },
});

/** Return the text of a program that begins by naming a place. */
function named(name, { x, y }, before) {
  const [head, rest] = /^((?:\s*(?:#.*)?\n)*\s*program .*\n?)?([^]*)$/u.exec(before).slice(1);
  return `${head ?? ""}set '${name.replaceAll("'", "")}' to (x: ${x.value} m, y: ${y.value} m)\n${rest}`;
}

const study = new Study({
  dialog: $("study-dialog"), start: $("study-start"), participant: $("study-participant"), robot: $("study-robot"), panel: $("study-panel"), task: $("study-task"),
  clock: $("study-clock"), read: $("study-read"), next: $("study-next"), end: $("study-end"), found: $("study-found"),
  download: $("study-download"), again: $("study-again"), open: () => $("study-dialog").showModal(),
}, data.exercises, () => replace(`program "program"\n`));

/** Do something that the server may reject; returns whether it succeeded. */
async function tried(work) {
  try {
    await work();
    return true;
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    output.problem(error.members);
    return false;
  }
}

// The program, as blocks and as text

/** Show whether the check of the current text is pending. */
function busy(on) {
  $("text-state").setAttribute("aria-busy", String(on));
}

/** Start a new check of the program: pending answers are outdated; returns the turn. */
function begun() {
  busy(true);
  return ++newest;
}

/** Take the answer of a check: the problems, the places of statements in the text, and the other form. */
async function check(request) {
  const turn = begun();
  let answer = null;
  await tried(async () => { answer = await ask("/robot/check", request); });
  if (request.text !== undefined) await blocks?.still();
  blocks?.flush();
  if (turn !== newest) return;
  if (answer) judge(request, answer);
  else moving.ready(false, "the program could not be checked");
  busy(false);
}

function judge(request, answer) {
  lines = answer.lines;
  if (answer.program) program = { name: "program", ...answer.program };
  if (request.text === undefined) $("text").value = answer.text;
  else if (answer.program) {
    $("program-name").value = program.name;
    blocks?.show(program);
  }
  judged(answer.problems, request.text !== undefined && !answer.program);
}

function judged(problems, unread = false) {
  const wrong = problems.filter(({ severity }) => severity !== "warning");
  blocks?.complain(problems);
  output.problems(problems, (problem) => place(problem));
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

/** Report pieces that are not joined to the program: they do not run, though the program fits. */
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

/** Show a program from elsewhere, as text. */
function open(text) {
  $("text").value = text;
  return fromText();
}

/** Open another program once all actions on the current one are done. */
const replace = (text) => turns.replace(() => open(text));

$("text").addEventListener("input", () => {
  begun();
  clearTimeout(typing);
  typing = setTimeout(fromText, TYPING);
});
$("program-name").addEventListener("change", async () => {
  const name = $("program-name").value.trim() || "program";
  await synced();
  $("program-name").value = name;
  program = { ...program, name };
  blocks?.rename(name);
  pending = check({ program });
});

/** Wait until the current program, as text and as blocks, is checked. */
async function synced() {
  let last;
  do {
    if (typing) fromText();
    blocks?.flush();
    last = pending;
    await last;
  } while (typing || last !== pending);
}

async function run() {
  await synced();
  if (!moving.isReady) return;
  output.clearProblem();
  const undo = study.starts();
  if (await tried(() => ask("/robot/run", { program }))) study.ran(program, $("text").value);
  else undo();
}

// Events of the server

function onEvent(event) {
  if (event.event === "hello") ({ listener } = event);
  if (event.event === "hello" || event.event === "robot") refresh();
  else if (event.event === "view") show($("view"), event.picture, (across, down) => {
    const point = pointOf(event.picture, across, down);
    if (point) places.choose(point);
  });
  else if (event.event === "value") output.value(event, robot.capabilities);
  else if (event.event === "program") programme(event);
  else if (event.event === "step") step(event);
  else if (event.event === "hand") hand(event);
}

function programme(event) {
  moving.program(event);
  if (["done", "stopped", "failed"].includes(event.state)) study.ended(event.state);
  if (event.state !== "running" && event.state !== "paused") blocks?.mark([]);
  const words = { running: "runs", paused: "pauses", done: "is done", stopped: "was stopped", failed: "failed" }[event.state];
  output.log(`Program “${event.name}” ${words}${event.problem ? `: ${event.problem.message}` : ""}`, event.state === "failed" ? "error" : "");
  if (event.problem) {
    output.problem(event.problem);
    if (event.problem.id) blocks?.complain([event.problem]);
  }
}

function step(event) {
  if (event.variable !== undefined) output.variable(event);
  if (event.log !== undefined) output.log(event.log);
  if (event.running) {
    blocks?.mark(event.running);
    moving.at(event.running.map(line).filter(Boolean));
  }
}

/** Return the first line of a statement in the text. */
function line(id) {
  return $("text").value.split("\n")[lines[id] - 1]?.trim();
}

function hand(event) {
  const label = robot.capabilities.find(({ name }) => name === event.capability)?.label ?? event.capability;
  moving.handed(event, label);
  output.log({ doing: `${label} …`, done: `${label}: done`, stopped: `${label}: stopped`, "taken over": `${label}: taken over by another command`, failed: `${label}: ${event.problem?.message}` }[event.state], event.state === "failed" ? "error" : "");
  if (event.problem) output.problem(event.problem);
}

let shown = "";
let offers = 0;
let stale = false;
let refreshing = false;

/** Request the state of the robot, one request at a time: the last answer is never an outdated one. */
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

/** Offer the capabilities of the robot as blocks, once none is being edited, and check the program again. */
async function offer(able, names) {
  const turn = ++offers;
  await blocks?.still();
  if (turn !== offers) return;
  blocks?.offer(able, names);
  if (!typing) again();
}

/** Show whether the robot is connected, and report changes. */
function connection(before) {
  const { state, problem, address } = robot;
  const isRecording = address?.startsWith("bag:");
  const words = {
    connecting: problem ? `No robot answers at ${address} yet; it is tried again and again.` : `Connecting to ${address} …`,
    connected: `Connected to ${address}`,
    lost: isRecording ? `The recording ${address} was played, and is opened again.` : `The robot at ${address} does not answer any more; it is tried again until it is back.`,
    none: "No robot",
  }[state];
  $("connection").textContent = problem && state !== "connected" ? `${words} (${problem.message})` : words;
  $("connection").classList.toggle("robot-lost", state === "lost");
  if (state === before) return;
  if (state === "lost") output.log(isRecording ? "The recording was played to its end." : `The robot does not answer any more: ${problem?.message ?? ""}`, isRecording ? "" : "error");
  if (before !== "lost" || state !== "connected") return;
  output.log(isRecording ? "The recording begins again with the next value that is read." : "The robot is back.");
  output.clearProblem();
}

/** Check the program again, in the form that was edited last. */
function again() {
  if (blocks && !written) fromBlocks();
  else fromText();
}

// Programs to open, and their storage

/** Do something with the text of the current program, once that is checked. */
const take = (act) => turns.take(async () => { await synced(); await act($("text").value); });

$("new").addEventListener("click", () => { replace(`program "program"\n`); });
$("save").addEventListener("click", () => take(async (shown) => {
  const { name } = program;
  programs.save(name, shown);
  $("save-name").textContent = name;
  const plain = name.replace(/[^\p{L}\p{N}._-]+/gu, "-");
  const links = [[`${plain}.kgp`, shown, "text/plain", "Save as text"], [`${plain}.json`, `${JSON.stringify(program, null, 2)}\n`, "application/json", "Save as JSON"]];
  for (const [to, label] of robot.state === "connected" ? [["rospy", "Save as Python for ROS 1"], ["rclpy", "Save as Python for ROS 2"], ["bt", "Save as behaviour tree"]] : []) {
    // A program that does not fit the robot has no code; its problems are listed already.
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
$("open").addEventListener("click", listSaved);
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

function listSaved() {
  const entries = programs.all().map(([name, content]) => {
    const show = element("button", { type: "button" }, name);
    show.addEventListener("click", () => { $("open-dialog").close(); replace(content); });
    const drop = element("button", { type: "button", className: "link" }, "Forget");
    drop.setAttribute("aria-label", `Forget ${name}`);
    drop.addEventListener("click", () => { programs.remove(name); listSaved(); });
    return element("li", { className: "row" }, show, drop);
  });
  $("open-list").replaceChildren(...(entries.length ? entries : [element("li", {}, "None yet: Save keeps one.")]));
}

/** List the examples; with a robot, checked against its capabilities. */
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
  if (given !== null) output.log("The program of the link is shown. It does not run until you press Run.");
  window.addEventListener("hashchange", () => { const other = linked("program"); if (other !== null) replace(other); });
  if (data.address) listen(onEvent, () => { listener = null; $("connection").textContent = "The server cannot be reached …"; });
}

begin();
