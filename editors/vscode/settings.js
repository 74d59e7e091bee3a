// What the extension decides without the editor: how the server is started, and for which files.
"use strict";

/** Languages whose files have findings of `kg lint`, by the names of VS Code; `.launch` files are XML here. */
const LANGUAGES = ["kg-rule", "sparql", "turtle", "xml", "yaml", "python", "cpp", "c", "toml"];

/**
 * Return how the server is started in a folder.
 * @param {(name: string) => any} setting returns the value of a setting below `kg`
 * @param {string | undefined} folder the folder that the editor has open
 */
function serverOptions(setting, folder) {
  const [command, ...first] = setting("command") || ["kg"];
  const store = setting("store");
  const args = [...first, "rules", "lsp", ...(store ? ["--store", store] : [])];
  return { command, args, options: folder ? { cwd: folder } : {} };
}

/** Return what the server is told when it starts. */
function initializationOptions(setting) {
  return { build: setting("buildOnSave") !== false };
}

/** Return the files that the server gets. */
function documentSelector() {
  return [
    ...LANGUAGES.map((language) => ({ scheme: "file", language })),
    { scheme: "file", pattern: "**/*.{rq,srl,ttl,launch}" },
  ];
}

module.exports = { LANGUAGES, documentSelector, initializationOptions, serverOptions };
