// The choices at a place of a rule: from the rule itself, the vocabulary, and the store.

import { matching } from "./choosing.js";
import { shown, termOf, thingName, typed } from "./terms.js";
import { every } from "./vocabulary.js";

const FAMILY = "my:";

export class Offering {
  /** `rule()` returns the current rule, `complete(text)` the completions at the end of a query. */
  constructor(chooser, vocabulary, { rule, complete }) {
    this.chooser = chooser;
    this.vocabulary = vocabulary;
    this.rule = rule;
    this.complete = complete;
  }

  /** Return the class of a thing of the rule, empty if unknown. */
  kindOf(term) {
    return term?.term === "thing" ? this.vocabulary.main(this.vocabulary.kinds(this.rule()).get(term.name)) : "";
  }

  /** Choose the property of a fact; `concluded`: the rule infers it. */
  property({ subject, current, concluded }) {
    const kind = this.kindOf(subject);
    const { vocabulary } = this;
    const item = (one) => ({ value: one.name, label: one.label, detail: one.name, count: one.number ?? one.count, comment: one.comment });
    const fitting = kind ? vocabulary.of(kind) : [];
    const names = new Set(fitting.map(({ name }) => name));
    const others = vocabulary.properties.filter(({ name }) => !names.has(name));
    return this.chooser.choose({
      title: concluded ? "What does the rule say?" : "Which relation?",
      help: kind ? `Those of ${vocabulary.words([kind])} come first, with how many have it on this store.` : "",
      placeholder: "publishes, name, has function …",
      find: async (text) => [
        ...(concluded ? [{ title: "A new relation of yours", items: newTerm(text, false) }] : []),
        { title: kind ? `Of ${vocabulary.words([kind])}` : "Relations", items: matching(fitting.map(item), text) },
        { title: kind ? "Of other things" : "Relations", items: matching(others.map(item), text) },
        { title: "As SPARQL writes it", items: path(text, current) },
      ],
    });
  }

  /** Choose a class. */
  kind({ concluded }) {
    const items = this.vocabulary.classes.map((one) => ({ value: one.name, label: one.label, detail: one.name, count: one.count, comment: one.comment }));
    return this.chooser.choose({
      title: concluded ? "What does the rule say it is?" : "What is it?",
      placeholder: "node, topic, message type …",
      find: async (text) => [
        ...(concluded ? [{ title: "A new kind of yours", items: newTerm(text, true) }] : []),
        { title: "Kinds of things", items: matching(items, text) },
        { title: "As SPARQL writes it", items: path(text, "") },
      ],
    });
  }

  /** Choose a term: a thing of the rule, a certain one, a text, a number. Returns { term } or { rename: [old, new] }. */
  term({ current, side, subject, property }) {
    const known = property ? this.vocabulary.byProperty.get(property) : null;
    const literal = side === "to" && known ? known.literal : side === "from" ? false : undefined;
    return this.chooser.choose({
      title: side === "to" && known ? `${known.label} …` : "Which thing?",
      help: this.help(side, known),
      placeholder: "a name, or a value",
      find: async (text) => [
        { title: "Things of this rule", items: matching(this.things(side, property), text) },
        { title: "What you typed", items: this.written(text, current, literal) },
        { title: side === "to" && known ? "What this store has here" : "Certain things", items: await this.values(text, { side, subject, property, literal }) },
      ],
    });
  }

  help(side, known) {
    if (side === "to" && known?.literal) return "A value that the store has, one that you type, or a name for whatever it is.";
    if (side === "to" && known?.to.length) return `It leads to ${this.vocabulary.words(known.to)}: one that the rule names, or a certain one.`;
    return "The same name means the same thing everywhere in the rule.";
  }

  things(side, property) {
    const kinds = this.vocabulary.kinds(this.rule());
    const names = [...new Set([...every(this.rule())].flatMap((one) => [one.subject, one.object, one.name && { term: "thing", name: one.name }]).filter((one) => one?.term === "thing").map(({ name }) => name))];
    return names.filter((name) => !property || this.vocabulary.fits(property, side, kinds.get(name)))
      .map((name) => ({ value: { term: { term: "thing", name } }, label: name, detail: this.vocabulary.main(kinds.get(name)) ? this.vocabulary.words([this.vocabulary.main(kinds.get(name))]) : "" }));
  }

  written(text, current, literal) {
    const found = typed(text, { literal }).map((term) => ({ value: { term }, label: shown(term, this.vocabulary), detail: { thing: "a thing of this name", text: "this text", number: "this number", name: "this very thing" }[term.term] }));
    const name = thingName(text);
    if (current?.term === "thing" && name && name !== current.name) {
      found.push({ value: { rename: [current.name, name] }, label: name, detail: `call “${current.name}” so everywhere` });
    }
    return found;
  }

  /** Return the values of the store at a place, from the completion service of queries. */
  async values(text, { side, subject, property, literal }) {
    if (side !== "to" || !property || /[^\w:.<>/#-]/.test(property)) return [];
    const kind = this.kindOf(subject);
    const begin = `SELECT * WHERE { ?x ${kind ? `a ${kind} ; ` : ""}${property} `;
    const answers = [await this.complete(begin)];
    if (answers[0].more && text.trim()) answers.push(await this.complete(`${begin}${literal ? `"${text.replace(/["\\]/g, "")}` : text.replace(/\s/g, "")}`));
    const items = answers.flatMap(({ items: all }) => all).map((one) => ({ one, term: termOf(one) })).filter(({ term }) => term);
    const distinct = new Map(items.map(({ one, term }) => [one.insert, { value: { term }, label: shown(term, this.vocabulary), detail: term.term === "name" ? term.name : "", count: one.count, comment: one.documentation }]));
    return matching([...distinct.values()], text);
  }
}

/** Return a typed text as a new term of the rule's family. */
function newTerm(text, isClass) {
  const words = text.trim().split(/[^\p{L}\p{N}]+/u).filter(Boolean);
  if (!words.length || /^\d/.test(words[0]) || text.includes(":")) return [];
  const joined = words.map((word) => word[0].toUpperCase() + word.slice(1)).join("");
  const name = FAMILY + (isClass ? joined : joined[0].toLowerCase() + joined.slice(1));
  return [{ value: name, label: words.join(" "), detail: name }];
}

/** Return a typed SPARQL expression: a name with a prefix, or a path. */
function path(text, current) {
  const plain = text.trim();
  const items = /[:<]/.test(plain) ? [{ value: plain, label: plain, detail: "" }] : [];
  return current && /[/|^*+?()!]/.test(current) && !plain ? [{ value: current, label: current, detail: "as it is" }] : items;
}
