// From blocks to the JSON of a rule. Identities of blocks become those of its parts.

import { termIn } from "./blocks.js";
import { unpacked } from "./terms.js";

/** Return { when, then, problems }: the content of the blocks, and the missing parts, each as { id, message }. */
export function read(workspace) {
  const reader = new Reader();
  const [top] = workspace.getBlocksByType("kr_rule");
  const when = reader.inside(top, "WHEN");
  const then = reader.inside(top, "THEN").filter((one) => ["fact", "is"].includes(one.block));
  return { when, then, problems: reader.problems };
}

class Reader {
  constructor() {
    this.problems = [];
  }

  inside(block, name) {
    const found = [];
    for (let at = block?.getInputTargetBlock(name); at; at = at.getNextBlock()) if (at.isEnabled()) found.push({ ...this.statement(at), id: at.id });
    return found;
  }

  statement(block) {
    const field = (name) => block.getFieldValue(name);
    switch (block.type) {
      case "kr_fact": return { block: "fact", subject: this.term(block, "SUBJECT"), property: field("PROPERTY"), object: this.term(block, "OBJECT") };
      case "kr_is": return { block: "is", subject: this.term(block, "SUBJECT"), kind: field("KIND") };
      case "kr_only": return { block: "only", test: this.needed(block, "TEST", "a test") };
      case "kr_let": return { block: "let", name: unpacked(field("NAME")).name ?? "value", value: this.needed(block, "VALUE") };
      case "kr_either": return { block: "either", branches: this.parts(block).map((name) => this.inside(block, name)) };
      case "kr_sparql": return { block: "sparql", text: field("TEXT") };
      default: return { block: block.type.replace("kr_", ""), when: this.inside(block, "WHEN") };
    }
  }

  parts(block) {
    return Array.from({ length: Number(block.getFieldValue("MANY")) }, (_, index) => `PART${index}`);
  }

  term(block, input) {
    return termIn(block, input) ?? this.missing(block, "a thing");
  }

  needed(block, input, what = "a value") {
    const found = block.getInputTargetBlock(input);
    return found ? this.expression(found) : this.missing(block, what);
  }

  missing(block, what) {
    this.problems.push({ id: block.id, message: `Here ${what} is missing: put a block into the empty place.` });
    return { term: "thing", name: "missing" };
  }

  expression(block) {
    const field = (name) => block.getFieldValue(name);
    const both = () => ({ left: this.needed(block, "LEFT"), right: this.needed(block, "RIGHT") });
    switch (block.type) {
      case "kr_term": return unpacked(field("TERM"));
      case "kr_join": return { term: "join", parts: this.parts(block).map((name) => this.needed(block, name)) };
      case "kr_of": return { term: "of", function: field("FUNCTION"), of: this.needed(block, "OF") };
      case "kr_reckon": return { term: "reckon", operator: field("OPERATOR"), ...both() };
      case "kr_formula": return { term: "formula", text: field("TEXT") };
      case "kr_compare": return { test: "compare", operator: field("OPERATOR"), ...both() };
      case "kr_match": return { test: "match", how: field("HOW"), value: this.needed(block, "VALUE"), text: this.needed(block, "TEXT") };
      case "kr_known": return { test: "known", name: unpacked(field("NAME")).name ?? "thing" };
      case "kr_logic": return { test: "logic", operator: field("OPERATOR"), ...both() };
      case "kr_not": return { test: "not", of: this.needed(block, "OF", "a test") };
      default: return { test: "formula", text: field("TEXT") };
    }
  }
}
