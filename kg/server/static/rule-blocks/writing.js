// From the JSON of a rule to blocks: the state for Blockly.

import { PARTS, STYLES } from "./blocks.js";
import { packed } from "./terms.js";

/** Return the state of a workspace that shows a rule. */
export function state(rule) {
  const inputs = { ...chain("WHEN", rule.when), ...chain("THEN", rule.then) };
  return { blocks: { languageVersion: 0, blocks: [{ type: "kr_rule", x: 24, y: 24, deletable: false, inputs }] } };
}

/** Return the state of an input for statements. */
function chain(name, list = []) {
  const first = list.reduceRight((next, one) => ({ ...statement(one), ...(next ? { next: { block: next } } : {}) }), null);
  return first ? { [name]: { block: first } } : {};
}

/** Return the state of the block of a term. */
export const termBlock = (term) => ({ type: "kr_term", fields: { TERM: packed(term) } });
const shadow = (term) => ({ shadow: termBlock(term) });

/** Return the state of a part of a rule. */
export function statement(one) {
  const id = one.id ? { id: one.id } : {};
  switch (one.block) {
    case "fact": return { ...id, type: "kr_fact", fields: { PROPERTY: one.property }, inputs: { SUBJECT: shadow(one.subject), OBJECT: shadow(one.object) } };
    case "is": return { ...id, type: "kr_is", fields: { KIND: one.kind }, inputs: { SUBJECT: shadow(one.subject) } };
    case "only": return { ...id, type: "kr_only", inputs: { TEST: { block: test(one.test) } } };
    case "let": return { ...id, type: "kr_let", fields: { NAME: packed({ term: "thing", name: one.name }) }, inputs: { VALUE: input(one.value) } };
    case "either": return { ...id, ...either(one.branches) };
    case "sparql": return { ...id, type: "kr_sparql", fields: { TEXT: one.text } };
    default: return { ...id, type: `kr_${one.block}`, inputs: chain("WHEN", one.when) };
  }
}

/** Return the state of one of several patterns; more than a block can have stand in the last. */
function either(branches) {
  const shown = branches.length > PARTS ? [...branches.slice(0, PARTS - 1), [{ block: "either", branches: branches.slice(PARTS - 1) }]] : branches;
  return { type: "kr_either", fields: { MANY: String(shown.length) }, inputs: Object.assign({}, ...shown.map((branch, index) => chain(`PART${index}`, branch))) };
}

/** Return the state of an input for a value: a term is a shadow, which blocks can replace. */
const input = (value) => (value.term in STYLES ? shadow(value) : { block: expression(value) });

function expression(value) {
  switch (value.term) {
    case "join": return join(value.parts);
    case "of": return { type: "kr_of", fields: { FUNCTION: value.function }, inputs: { OF: input(value.of) } };
    case "reckon": return { type: "kr_reckon", fields: { OPERATOR: value.operator }, inputs: { LEFT: input(value.left), RIGHT: input(value.right) } };
    case "formula": return { type: "kr_formula", fields: { TEXT: value.text } };
    default: return termBlock(value);
  }
}

/** Return the state of texts joined; more than a block can have are joined in the last. */
function join(parts) {
  const texts = parts.length === 1 ? [...parts, { term: "text", value: "" }] : parts;
  const shown = texts.length > PARTS ? [...texts.slice(0, PARTS - 1), { term: "join", parts: texts.slice(PARTS - 1) }] : texts;
  return { type: "kr_join", fields: { MANY: String(shown.length) }, inputs: Object.fromEntries(shown.map((one, index) => [`PART${index}`, input(one)])) };
}

/** Return the state of a test. */
export function test(one) {
  switch (one.test) {
    case "compare": return { type: "kr_compare", fields: { OPERATOR: one.operator }, inputs: { LEFT: input(one.left), RIGHT: input(one.right) } };
    case "match": return { type: "kr_match", fields: { HOW: one.how }, inputs: { VALUE: input(one.value), TEXT: input(one.text) } };
    case "known": return { type: "kr_known", fields: { NAME: packed({ term: "thing", name: one.name }) } };
    case "logic": return { type: "kr_logic", fields: { OPERATOR: one.operator }, inputs: { LEFT: { block: test(one.left) }, RIGHT: { block: test(one.right) } } };
    case "not": return { type: "kr_not", inputs: { OF: { block: test(one.of) } } };
    default: return { type: "kr_says", fields: { TEXT: one.text } };
  }
}
