// A workspace with a store, and a connection to the server that the extension would start in it.
"use strict";

const { spawn, execFileSync } = require("node:child_process");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { pathToFileURL } = require("node:url");
const protocol = require("vscode-languageserver-protocol/node");
const { initializationOptions, serverOptions } = require("../settings");

const KG = JSON.parse(process.env.KG_COMMAND || '["kg"]');
const CASE = path.join(__dirname, "../../../tests/lint/cases/watcher");
const LAUNCH = `<launch>
  <node pkg="watch" type="camera.py" name="camera"/>
  <node pkg="watch" type="viewer.py" name="viewer">
    <remap from="image" to="images_raw"/>
  </node>
</launch>
`;

/** Return a new folder with a small workspace, whose launch file misspells a topic, and its store. */
function makeWorkspace() {
  const folder = fs.realpathSync(fs.mkdtempSync(path.join(os.tmpdir(), "kg-vscode-")));
  fs.cpSync(CASE, path.join(folder, "src"), { recursive: true });
  fs.writeFileSync(path.join(folder, "src/watch/launch/watch.launch"), LAUNCH);
  execFileSync(KG[0], [...KG.slice(1), "build", "src"], { cwd: folder, stdio: "ignore" });
  return folder;
}

/** A client of the protocol without an editor; `settings` are those below `kg`. */
class Session {
  constructor(folder, settings = {}) {
    const setting = (name) => ({ command: KG, ...settings })[name];
    const { command, args, options } = serverOptions(setting, folder);
    this.folder = folder;
    this.options = initializationOptions(setting);
    this.process = spawn(command, args, { ...options, stdio: ["pipe", "pipe", "inherit"] });
    this.connection = protocol.createProtocolConnection(
      new protocol.StreamMessageReader(this.process.stdout),
      new protocol.StreamMessageWriter(this.process.stdin),
    );
    this.published = [];
    this.waiting = [];
    this.connection.onNotification(protocol.PublishDiagnosticsNotification.type, (params) => {
      this.published.push(params);
      this.waiting = this.waiting.filter((check) => !check());
    });
    this.connection.listen();
  }

  async begin() {
    const found = await this.connection.sendRequest(protocol.InitializeRequest.type, {
      processId: process.pid,
      rootUri: this.uri(""),
      workspaceFolders: [{ uri: this.uri(""), name: "workspace" }],
      capabilities: { workspace: { workspaceEdit: { documentChanges: true, resourceOperations: ["rename"] } } },
      initializationOptions: this.options,
    });
    await this.connection.sendNotification(protocol.InitializedNotification.type, {});
    return found.capabilities;
  }

  uri(name) {
    return pathToFileURL(path.join(this.folder, name)).href;
  }

  open(name, languageId, text) {
    const textDocument = { uri: this.uri(name), languageId, version: 1, text };
    return this.connection.sendNotification(protocol.DidOpenTextDocumentNotification.type, { textDocument });
  }

  /** Write a changed document to its file, as an editor does. */
  async save(name, text) {
    const uri = this.uri(name);
    await this.connection.sendNotification(protocol.DidChangeTextDocumentNotification.type, {
      textDocument: { uri, version: 2 },
      contentChanges: [{ text }],
    });
    fs.writeFileSync(path.join(this.folder, name), text);
    await this.connection.sendNotification(protocol.DidSaveTextDocumentNotification.type, { textDocument: { uri } });
  }

  /** Resolve to the next diagnostics of a file for which `fits` is true. */
  diagnostics(name, fits = () => true) {
    return new Promise((resolve) => {
      const check = () => {
        const number = this.published.findIndex((each) => each.uri === this.uri(name) && fits(each.diagnostics));
        if (number < 0) return false;
        resolve(this.published.splice(0, number + 1).at(-1).diagnostics);
        return true;
      };
      if (!check()) this.waiting.push(check);
    });
  }

  async end() {
    await this.connection.sendRequest(protocol.ShutdownRequest.type);
    const ended = new Promise((resolve) => this.process.once("exit", resolve));
    await this.connection.sendNotification(protocol.ExitNotification.type);
    this.connection.end();
    return ended;
  }
}

module.exports = { LAUNCH, Session, makeWorkspace };
