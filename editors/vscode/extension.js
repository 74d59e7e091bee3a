// Starts `kg rules lsp` for the folder that is open; all else is done by the server and the library of VS Code.
"use strict";

const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");
const { documentSelector, initializationOptions, serverOptions } = require("./settings");

let client;

/** Start the server; an editor without a server shows why. */
async function start() {
  const folder = vscode.workspace.workspaceFolders?.[0]?.uri;
  const setting = (name) => vscode.workspace.getConfiguration("kg", folder).get(name);
  client = new LanguageClient("kg", "kg", serverOptions(setting, folder?.fsPath), {
    documentSelector: documentSelector(),
    initializationOptions: initializationOptions(setting),
  });
  try {
    await client.start();
  } catch (error) {
    const hint = "Install it with `pip install 'kg-ros[lsp]'`, or name the program in the setting `kg.command`.";
    void vscode.window.showErrorMessage(`kg does not start: ${error.message}. ${hint}`);
  }
}

async function stop() {
  const ending = client;
  client = undefined;
  if (ending?.isRunning()) await ending.stop();
}

async function activate(context) {
  context.subscriptions.push(
    vscode.commands.registerCommand("kg.restart", async () => {
      await stop();
      await start();
    }),
    vscode.workspace.onDidChangeConfiguration(async (change) => {
      if (!change.affectsConfiguration("kg") || change.affectsConfiguration("kg.trace")) return;
      await stop();
      await start();
    }),
  );
  await start();
}

module.exports = { activate, deactivate: stop };
