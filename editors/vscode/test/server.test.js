// The real server, started as the extension starts it, over the protocol library that VS Code uses.
"use strict";

const assert = require("node:assert");
const fs = require("node:fs");
const { after, before, test } = require("node:test");
const protocol = require("vscode-languageserver-protocol/node");
const { LAUNCH, Session, makeWorkspace } = require("./workspace");

const FILE = "src/watch/launch/watch.launch";
let folder;
let session;

before(async () => {
  folder = makeWorkspace();
  session = new Session(folder);
});

after(async () => {
  fs.rmSync(folder, { recursive: true });
});

test("a session from a misspelt topic to its repair", async () => {
  const capabilities = await session.begin();
  for (const name of ["codeActionProvider", "referencesProvider", "renameProvider", "hoverProvider"]) {
    assert.ok(capabilities[name], name);
  }
  await session.open(FILE, "xml", LAUNCH);
  const [found] = await session.diagnostics(FILE, (each) => each.length);
  assert.strictEqual(found.code, "KG401");
  assert.match(found.codeDescription.href, /errors\.md#L\d+$/);
  assert.match(found.message, /\/image_raw is published/);

  const actions = await session.connection.sendRequest(protocol.CodeActionRequest.type, {
    textDocument: { uri: session.uri(FILE) },
    range: found.range,
    context: { diagnostics: [found] },
  });
  assert.strictEqual(actions[0].title, "Replace `images_raw` by `image_raw`");
  const [edit] = actions[0].edit.changes[session.uri(FILE)];
  assert.strictEqual(edit.newText, "image_raw");

  await session.save(FILE, LAUNCH.replace("images_raw", edit.newText));
  assert.deepStrictEqual(await session.diagnostics(FILE), []);

  const rule = "rules/mine/busy.rq";
  await session.open(rule, "kg-rule", "CONSTRUCT { ?n rnkg:busy true } WHERE { ?n rnkg:publishs ?t ; rnkg:subscribes ?t }");
  const findings = await session.diagnostics(rule);
  const [misspelt] = findings.filter((each) => each.message.includes("publishs"));
  assert.strictEqual(misspelt.data.fixes[0].text, "rnkg:publishes");
  const places = await session.connection.sendRequest(protocol.ReferencesRequest.type, {
    textDocument: { uri: session.uri(rule) },
    position: { line: 0, character: 13 },
    context: { includeDeclaration: true },
  });
  assert.strictEqual(places.length, 2);
  assert.strictEqual(await session.end(), 0);
});
