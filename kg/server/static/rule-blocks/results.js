// Inferences of the rule: facts, each with its premises and their sources.

import { url } from "../address.js";
import { element } from "../table.js";

const WORDS = { "rdf:type": "is a", "rdfs:label": "is called" };
const SCHEMES = new Set(["http:", "https:", "vscode:"]);

/** Return the answer of a trial as elements; `spoken(name)` returns a property in words. */
export function results(found, spoken) {
  return [element("p", { className: "rule-found" }, ...summary(found)), facts(found, spoken)];
}

function summary({ facts: all, looked, fresh, whole, recursive, seconds }) {
  if (!all.length && !whole) return ["Nothing was found in the time of a trial, but not everything was looked at. kg rules diff has no such limit."];
  if (!all.length) return ["No matches in this store. The check above names the first part without matches."];
  const many = `${whole ? "" : "At least "}${looked.toLocaleString("en")} ${looked === 1 ? "fact" : "facts"}`;
  const news = fresh === looked ? "none of which the store has yet" : fresh ? `${fresh.toLocaleString("en")} of which the store has not yet` : "all of which the store has already";
  const shown = all.length < looked ? ` The first ${all.length} are shown.` : "";
  const again = recursive ? " The rule reads what it infers, so running it gives more, step by step." : "";
  return [element("strong", {}, many), `, ${news}, in ${seconds.toFixed(2)} s. Nothing was written.${shown}${again}`];
}

function facts({ facts: all }, spoken) {
  return element("ul", { className: "plain rule-facts" }, ...all.map((one) => element("li", {}, fact(one, spoken))));
}

function fact(one, spoken) {
  const state = element("span", { className: `tag ${one.known ? "note" : "inferred"}` }, one.known ? "known" : "new");
  const below = [...one.premises.map((premise) => element("li", {}, ...premiseParts(premise, spoken))), ...one.conditions.map(({ text }) => element("li", { className: "quiet-text" }, `and it holds that ${text}`))];
  const things = [one.subject, one.object].filter(({ term }) => term.startsWith("<"));
  const pages = things.flatMap(({ term, label }, index) => [index ? " and " : "Pages of ", element("a", { href: url(`/resource?iri=${encodeURIComponent(term.slice(1, -1))}`) }, label)]);
  return element("details", {}, element("summary", {}, sentence(one, spoken), " ", state),
    element("p", { className: "quiet-text" }, "because"), element("ul", {}, ...below), element("p", {}, ...pages));
}

function sentence({ subject, predicate, object, text }, spoken) {
  return element("span", { title: text }, `${subject.label} ${WORDS[predicate.short] ?? spoken(predicate.short)} ${object.label}`);
}

function premiseParts(premise, spoken) {
  const where = premise.evidence ? place(premise.evidence) : null;
  return [sentence(premise, spoken), " ", where ?? (premise.inferred ? why(premise) : null)];
}

function place({ path, line, web, vscode, repository }) {
  const shown = line ? `${path}:${line}` : path;
  const address = [web, vscode].find((one) => one && SCHEMES.has(new URL(one, location.href).protocol));
  return element("span", { className: "evidence", title: repository ?? "" }, address ? element("a", { href: address }, shown) : shown);
}

function why({ subject, predicate, object }) {
  const values = new URLSearchParams({ subject: subject.term, predicate: predicate.term, object: object.term });
  const link = element("a", { className: "why", href: url(`/why?${values}`) }, "why");
  link.dataset.why = url(`/api/why?${values}`);
  return link;
}
