// The editor of a query: CodeMirror where its libraries are installed, else the field of the form.
//
//   const editor = await edit(host, field, { begun(plain), changed(text), run(), complete, diagnose, prefixes() });
//   editor.text, editor.text = "..."; editor.focus(); editor.mark(problems); editor.go(problem); editor.reveal(position)
//
// `begun` receives the field at once, which is an editor until the libraries are loaded. A shadow root contains it: there its libraries may add style sheets without permission for inline styles.

import { toPoints, toUnits } from "./text.js";

/** Return an editor in `host` instead of the text area `field`. */
export async function edit(host, field, options) {
  const plain = new Field(field, options);
  options.begun?.(plain);
  let libraries;
  try {
    libraries = await load();
  } catch {
    return plain;
  }
  return new Editor(host, field, options, libraries);
}

async function load() {
  const [view, state, commands, complete, lint, language, search, sparql, highlight] = await Promise.all([
    import("@codemirror/view"), import("@codemirror/state"), import("@codemirror/commands"),
    import("@codemirror/autocomplete"), import("@codemirror/lint"), import("@codemirror/language"),
    import("@codemirror/search"), import("codemirror-lang-sparql"), import("@lezer/highlight"),
  ]);
  return { view, state, commands, complete, lint, language, search, sparql, highlight };
}

/** The text area: until the libraries are loaded, and for browsers without them. */
class Field {
  constructor(field, options) {
    this.field = field;
    this.options = options;
    let waiting = 0;
    const diagnose = async () => {
      const { text } = this;
      const problems = await options.diagnose(text).catch(() => []);
      if (text === this.text && !field.hidden) this.mark(problems);
    };
    field.addEventListener("input", () => {
      options.changed(this.text);
      clearTimeout(waiting);
      waiting = setTimeout(diagnose, 500);
    });
    field.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) {
        event.preventDefault();
        options.run();
      }
    });
  }

  get text() { return this.field.value; }

  set text(text) { this.field.value = text; }

  focus() { this.field.focus(); }

  mark(problems) { this.options.problems(problems); }

  reveal() {} // a text area begins at its first line

  go(problem) {
    this.field.focus();
    this.field.setSelectionRange(toUnits(this.text, problem.start), toUnits(this.text, problem.end));
  }
}

const KINDS = { prefix: "namespace", value: "constant", graph: "text", query: "text" };
const OPENS = /(?:\ba|\b(?:graph|from|named|prefix)|[\w>"] ?;|\^)\s$/i;

class Editor {
  constructor(host, field, options, libraries) {
    this.options = options;
    this.libraries = libraries;
    this.busy = Promise.resolve();
    const shadow = document.createElement("div");
    const written = document.activeElement === field ? { selection: { anchor: field.selectionStart, head: field.selectionEnd } } : null;
    field.hidden = true;
    host.append(shadow);
    const root = shadow.attachShadow({ mode: "open", delegatesFocus: true });
    const { EditorView } = libraries.view;
    this.view = new EditorView({
      root, parent: root, doc: field.value, ...written, extensions: this.extensions(libraries),
    });
    this.field = field;
    if (written) this.focus();
  }

  extensions({ view, state, commands, complete, lint, language, search, sparql, highlight }) {
    const keys = [
      { key: "Mod-Enter", run: () => { this.options.run(); return true; } },
      { key: "Alt-Shift-f", run: () => { this.options.indent(); return true; } },
      // While a suggestion is shown or requested, Tab stays in the editor, though it cannot accept one yet.
      { key: "Tab", run: (shown) => complete.acceptCompletion(shown) || complete.completionStatus(shown.state) !== null },
    ];
    return [
      state.Prec.highest(view.keymap.of(keys)),
      view.lineNumbers(), view.highlightSpecialChars(), commands.history(), view.drawSelection(),
      state.EditorState.allowMultipleSelections.of(true), language.indentOnInput(), language.bracketMatching(),
      complete.closeBrackets(), view.highlightActiveLine(), search.highlightSelectionMatches(),
      new language.LanguageSupport(sparql.SparqlLanguage.configure({ props: [highlight.styleTags({ Pname_ln: highlight.tags.propertyName, Pname_ns: highlight.tags.namespace, A_predicate: highlight.tags.keyword })] })),
      language.syntaxHighlighting(colours(this.libraries)), view.EditorView.theme(LOOK), view.EditorView.lineWrapping,
      view.keymap.of([
        ...complete.closeBracketsKeymap, ...commands.defaultKeymap, ...search.searchKeymap, ...commands.historyKeymap,
        ...complete.completionKeymap, ...lint.lintKeymap,
      ]),
      complete.autocompletion({ override: [(context) => this.complete(context)], maxRenderedOptions: 100, icons: true }),
      lint.linter((shown) => this.lint(shown), { delay: 400 }), lint.lintGutter(),
      view.hoverTooltip((shown, at) => this.hover(shown, at)),
      view.placeholder("SELECT …"),
      view.EditorView.contentAttributes.of({ "aria-label": "SPARQL query", tabindex: "0", spellcheck: "false", autocapitalize: "off" }),
      view.EditorView.updateListener.of((update) => {
        if (!update.docChanged) return;
        this.field.value = this.text;
        this.options.changed(this.text);
      }),
    ];
  }

  get text() { return this.view.state.doc.toString(); }

  set text(text) {
    if (text === this.text) return;
    this.view.dispatch({ changes: { from: 0, to: this.view.state.doc.length, insert: text }, selection: { anchor: text.length } });
  }

  focus() { this.view.focus(); }

  mark(problems) {
    this.view.dispatch(this.libraries.lint.setDiagnostics(this.view.state, this.diagnostics(problems)));
    this.options.problems(problems);
  }

  /** Scroll to a position, in units of the text, without the focus. */
  reveal(position) {
    this.view.dispatch({ effects: this.libraries.view.EditorView.scrollIntoView(position, { y: "start" }) });
  }

  go(problem) {
    const [from, to] = this.span(problem);
    this.view.dispatch({ selection: { anchor: from, head: to }, scrollIntoView: true });
    this.view.focus();
  }

  span({ start, end }) {
    const { text } = this;
    let [from, to] = [toUnits(text, start), toUnits(text, end)];
    if (from === to) {
      // What is missing at the end is shown at the last character that is there.
      from = Math.max(0, text.slice(0, from).trimEnd().length - 1);
      to = Math.min(text.length, Math.max(to, from + 1));
    }
    return [from, to];
  }

  diagnostics(problems) {
    const { text } = this;
    return problems.map((problem) => {
      const [from, to] = this.span(problem);
      const actions = problem.fixes.map((fix) => ({ name: fix.title, apply: () => this.options.fix(fix, text) }));
      return { from, to, severity: problem.severity, message: words(problem), actions };
    });
  }

  async lint() {
    const { text } = this;
    const problems = await this.options.diagnose(text).catch(() => []);
    if (text !== this.text) return [];
    this.options.problems(problems);
    return this.diagnostics(problems);
  }

  /** Return the completions for CodeMirror; requests run one after the other, and outdated ones are dropped. */
  async complete(context) {
    const { text } = this;
    const before = text.slice(0, context.pos);
    if (!context.explicit && !/[\w:?$"'/]$/.test(before) && !OPENS.test(before)) return null;
    const pending = this.busy.then(() => context.aborted ? null : this.options.complete(text, toPoints(text, context.pos)));
    this.busy = pending.catch(() => null);
    const found = await pending.catch(() => null);
    if (!found?.items.length || context.aborted) return null;
    const exact = found.items.length === 1 && found.items[0].insert === before.slice(toUnits(text, found.range.start));
    if (exact && !context.explicit) return null;
    const [from, to] = [toUnits(text, found.range.start), toUnits(text, found.range.end)];
    return { from, to, filter: false, options: found.items.map((item) => this.option(item, text, to)) };
  }

  option(item, text, to) {
    return {
      label: item.label,
      detail: item.count === null || item.kind === "variable" ? item.detail : item.detail || item.count.toLocaleString("en"),
      type: KINDS[item.kind] ?? item.kind,
      info: item.documentation || undefined,
      apply: (view, _, from) => this.insert(view, item, text, from, Math.max(to, view.state.selection.main.head)),
    };
  }

  insert(view, item, text, from, to) {
    const { complete } = this.libraries;
    const edits = this.options.prefixes() || item.kind === "prefix" ? item.edits : [];
    let template = item.insert.replace(/[\\]/g, "\\\\");
    for (const hole of [...item.holes].reverse()) template = `${template.slice(0, hole)}\${}${template.slice(hole)}`;
    if (item.holes.length) {
      complete.snippet(template)(view, { label: item.label }, from, to);
    } else {
      view.dispatch({
        changes: { from, to, insert: item.insert }, selection: { anchor: from + item.insert.length },
        userEvent: "input.complete", annotations: complete.pickedCompletion.of({ label: item.label }),
      });
    }
    const changes = edits.map((edit) => ({ from: toUnits(text, edit.start), to: toUnits(text, edit.end), insert: edit.text }));
    if (changes.length) view.dispatch({ changes, userEvent: "input.complete" });
    if (item.insert.endsWith(":")) complete.startCompletion(view);
  }

  /** Show the documentation of the name under the pointer. */
  async hover(view, at) {
    const { text } = this;
    const word = [...text.matchAll(/[A-Za-z][\w-]*:[\w-]+|\b[A-Za-z]{2,}\b/g)].find((match) => match.index <= at && at <= match.index + match[0].length);
    if (!word) return null;
    const end = word.index + word[0].length;
    const found = await this.options.complete(text, toPoints(text, end)).catch(() => null);
    const item = found?.items.find((each) => each.label.toLowerCase() === word[0].toLowerCase());
    if (!item || !(item.documentation || item.detail) || text !== this.text) return null;
    return { pos: word.index, end, above: true, create: () => ({ dom: infoElement(item) }) };
  }
}

/** Return a problem as one text. */
export function words(problem) {
  return problem.hint ? `${problem.message}. ${problem.hint}` : problem.message;
}

function infoElement(item) {
  const box = document.createElement("div");
  box.className = "kg-hover";
  const name = document.createElement("strong");
  name.textContent = item.label;
  box.append(name, ` ${item.detail}`);
  if (item.documentation) {
    const text = document.createElement("p");
    text.textContent = item.documentation;
    box.append(text);
  }
  return box;
}

function colours({ language, highlight: { tags } }) {
  return language.HighlightStyle.define([
    { tag: [tags.keyword, tags.operatorKeyword, tags.definitionKeyword, tags.modifier, tags.controlKeyword], color: "var(--service)", fontWeight: "600" },
    { tag: [tags.variableName, tags.special(tags.variableName), tags.local(tags.variableName)], color: "var(--action)" },
    { tag: [tags.namespace, tags.typeName, tags.propertyName, tags.name, tags.className, tags.labelName], color: "var(--subscriber)" },
    { tag: [tags.string, tags.url, tags.link], color: "var(--publisher)" },
    { tag: [tags.number, tags.bool, tags.literal, tags.atom], color: "var(--warning)" },
    { tag: [tags.comment, tags.lineComment], color: "var(--quiet)", fontStyle: "italic" },
    { tag: [tags.function(tags.variableName), tags.function(tags.name)], color: "var(--note)" },
    { tag: tags.invalid, color: "inherit" },
  ]);
}

// Letters, since not every system has the signs that the library shows.
const LETTERS = { class: "C", property: "p", keyword: "k", function: "f", variable: "?", namespace: ":", constant: "=", text: "#" };

const LOOK = {
  "&": { backgroundColor: "var(--surface)", color: "var(--text)", fontSize: "0.875rem", minHeight: "var(--editor-least)", maxHeight: "var(--editor-most)", borderRadius: "8px" },
  "&.cm-focused": { outline: "0" },
  ".cm-scroller": { fontFamily: "var(--mono)", lineHeight: "1.55", minHeight: "var(--editor-least)", overflow: "auto" },
  ".cm-content": { caretColor: "var(--text)", padding: "0.5rem 0" },
  ".cm-gutters": { backgroundColor: "var(--surface)", color: "var(--quiet)", border: "0" },
  ".cm-activeLine": { backgroundColor: "color-mix(in srgb, var(--accent) 5%, transparent)" },
  ".cm-cursor, .cm-dropCursor": { borderLeftColor: "var(--text)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground": { backgroundColor: "color-mix(in srgb, var(--accent) 25%, transparent)" },
  ".cm-placeholder": { color: "var(--quiet)" },
  "&.cm-focused .cm-matchingBracket": { backgroundColor: "color-mix(in srgb, var(--ok) 25%, transparent)", outline: "0" },
  ".cm-selectionMatch": { backgroundColor: "var(--mark)" },
  ".cm-tooltip": { backgroundColor: "var(--surface)", color: "var(--text)", border: "1px solid var(--line-strong)", borderRadius: "6px", boxShadow: "0 4px 16px rgb(10 16 24 / 20%)", overflow: "hidden" },
  ".cm-tooltip.cm-tooltip-autocomplete > ul": { fontFamily: "var(--mono)", maxHeight: "16rem", maxWidth: "min(46rem, 92vw)" },
  ".cm-tooltip.cm-tooltip-autocomplete > ul > li": { padding: "0.15rem 0.5rem", lineHeight: "1.5" },
  ".cm-tooltip-autocomplete ul li[aria-selected]": { backgroundColor: "var(--accent)", color: "var(--on-accent)" },
  ".cm-completionDetail": { color: "var(--quiet)", fontStyle: "normal", fontFamily: "var(--sans)", fontSize: "0.8125rem", marginLeft: "1rem" },
  ".cm-tooltip-autocomplete ul li[aria-selected] .cm-completionDetail": { color: "inherit" },
  ".cm-completionMatchedText": { textDecoration: "none", fontWeight: "700" },
  ".cm-completionIcon": { color: "var(--quiet)", opacity: "1", width: "1.2em" },
  ".cm-tooltip-autocomplete ul li[aria-selected] .cm-completionIcon": { color: "inherit" },
  ...Object.fromEntries(Object.entries(LETTERS).map(([kind, letter]) => [`.cm-completionIcon-${kind}:after`, { content: `"${letter}"` }])),
  ".cm-tooltip.cm-completionInfo": { padding: "0.5rem 0.75rem", maxWidth: "22rem", overflow: "auto" },
  ".cm-diagnostic": { padding: "0.35rem 0.6rem", fontFamily: "var(--sans)" },
  ".cm-diagnostic-error": { borderLeft: "4px solid var(--error)" },
  ".cm-diagnostic-warning": { borderLeft: "4px solid var(--warning)" },
  ".cm-diagnosticAction": { backgroundColor: "var(--accent)", color: "var(--on-accent)", font: "inherit", fontSize: "0.8125rem", padding: "0.1rem 0.5rem", borderRadius: "4px" },
  ".cm-lintRange-error": { backgroundImage: "none", textDecoration: "underline wavy var(--error)", textUnderlineOffset: "3px" },
  ".cm-lintRange-warning": { backgroundImage: "none", textDecoration: "underline wavy var(--warning)", textUnderlineOffset: "3px" },
  ".cm-panels": { backgroundColor: "var(--raised)", color: "var(--text)" },
  ".cm-panel.cm-panel-lint ul [aria-selected]": { backgroundColor: "color-mix(in srgb, var(--accent) 16%, var(--surface))" },
  ".cm-textfield": { backgroundColor: "var(--surface)", border: "1px solid var(--line-strong)", color: "inherit" },
  ".cm-button": { backgroundImage: "none", backgroundColor: "var(--surface)", border: "1px solid var(--line-strong)", color: "inherit" },
  ".kg-hover": { padding: "0.4rem 0.7rem", maxWidth: "28rem", fontSize: "0.875rem" },
  ".kg-hover p": { margin: "0.25rem 0 0" },
};
