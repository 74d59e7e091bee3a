// The extension itself, with stubs for VS Code and its client library: what it starts, and when.
"use strict";

const assert = require("node:assert");
const fs = require("node:fs");
const Module = require("node:module");
const path = require("node:path");
const { beforeEach, test } = require("node:test");
const textmate = require("vscode-textmate");
const oniguruma = require("vscode-oniguruma");
const manifest = require("../package.json");
const settings = require("../settings");

const ROOT = path.join(__dirname, "..");
const events = [];
const handlers = {};
let values;
let failing;

class LanguageClient {
  constructor(id, name, server, client) {
    Object.assign(this, { server, client, running: false });
    events.push(this);
  }

  async start() {
    if (failing) throw new Error(failing);
    this.running = true;
  }

  isRunning() {
    return this.running;
  }

  async stop() {
    this.running = false;
  }
}

const vscode = {
  workspace: {
    workspaceFolders: [{ uri: { fsPath: "/robot" } }],
    getConfiguration: (section) => ({ get: (name) => values[`${section}.${name}`] }),
    onDidChangeConfiguration: (handler) => (handlers.configuration = handler),
  },
  window: { showErrorMessage: (text) => events.push(text) },
  commands: { registerCommand: (name, handler) => (handlers[name] = handler) },
};
const load = Module._load;
Module._load = (name, ...rest) =>
  ({ vscode, "vscode-languageclient/node": { LanguageClient } })[name] ?? load(name, ...rest);
const extension = require("../extension");

beforeEach(() => {
  events.length = 0;
  failing = undefined;
  values = { "kg.command": ["kg"], "kg.store": "", "kg.buildOnSave": true };
});

test("the server is started in the folder of the workspace", async () => {
  await extension.activate({ subscriptions: [] });
  const [{ server, client, running }] = events;
  assert.deepStrictEqual(server, { command: "kg", args: ["rules", "lsp"], options: { cwd: "/robot" } });
  assert.deepStrictEqual(client.initializationOptions, { build: true });
  assert.ok(running);
});

test("settings choose the program, the store and whether saving builds", async () => {
  values = { "kg.command": ["python3", "-m", "kg"], "kg.store": "/data/kg", "kg.buildOnSave": false };
  await extension.activate({ subscriptions: [] });
  const [{ server, client }] = events;
  assert.deepStrictEqual([server.command, ...server.args], ["python3", "-m", "kg", "rules", "lsp", "--store", "/data/kg"]);
  assert.deepStrictEqual(client.initializationOptions, { build: false });
});

test("a changed setting and the command start it again, and stop the one before", async () => {
  await extension.activate({ subscriptions: [] });
  await handlers.configuration({ affectsConfiguration: (name) => name === "kg" });
  await handlers["kg.restart"]();
  assert.deepStrictEqual(events.map((each) => each.running), [false, false, true]);
});

test("changes of other settings do nothing", async () => {
  await extension.activate({ subscriptions: [] });
  await handlers.configuration({ affectsConfiguration: () => false });
  assert.strictEqual(events.length, 1);
});

test("where the program is missing, the editor shows what to do", async () => {
  failing = "spawn kg ENOENT";
  await extension.activate({ subscriptions: [] });
  assert.match(events[1], /spawn kg ENOENT.*pip install 'kg-ros\[lsp\]'/);
});

test("the manifest declares what the code reads", () => {
  const declared = Object.keys(manifest.contributes.configuration.properties);
  const code = fs.readFileSync(path.join(ROOT, "settings.js"), "utf8");
  const read = [...code.matchAll(/setting\("(\w+)"\)/g)].map((each) => `kg.${each[1]}`);
  assert.deepStrictEqual([...new Set(read)].filter((each) => !declared.includes(each)), []);
  const files = [manifest.main, ...manifest.contributes.grammars.map((each) => each.path)];
  files.push(...manifest.contributes.languages.flatMap((each) => each.configuration ?? []));
  for (const file of files) assert.ok(fs.existsSync(path.join(ROOT, file)), file);
  const own = manifest.contributes.languages.map((each) => each.id);
  assert.deepStrictEqual(own.filter((each) => !settings.LANGUAGES.includes(each)), []);
});

test("the grammar colours a rule", async () => {
  const wasm = fs.readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm")).buffer;
  await oniguruma.loadWASM(wasm);
  const file = path.join(ROOT, "syntaxes/kg-rule.tmLanguage.json");
  const registry = new textmate.Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (sources) => new oniguruma.OnigScanner(sources),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () => textmate.parseRawGrammar(fs.readFileSync(file, "utf8"), file),
  });
  const grammar = await registry.loadGrammar("source.kg-rule");
  const line = 'WHERE { ?x a rnkg:Node ; <urn:p> "#no" . FILTER(?x < 3) } # end';
  const { tokens } = grammar.tokenizeLine(line, textmate.INITIAL);
  const coloured = tokens
    .filter((each) => each.scopes.length > 1)
    .map((each) => [line.slice(each.startIndex, each.endIndex), each.scopes[1].split(".").slice(0, 2).join(".")]);
  assert.deepStrictEqual(coloured, [
    ["WHERE", "keyword.control"],
    ["?x", "variable.other"],
    ["a", "constant.language"],
    ["rnkg:Node", "entity.name"],
    ["<urn:p>", "constant.other"],
    ['"#no"', "string.quoted"],
    ["FILTER", "keyword.control"],
    ["?x", "variable.other"],
    ["3", "constant.numeric"],
    ["# end", "comment.line"],
  ]);
});
