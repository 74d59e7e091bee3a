// From blocks to a program: the JSON for the server. Identities of blocks become those of statements.

import { argument, AT, doType, readType } from "./capable.js";

/** Return { program, problems }: without a program where blocks miss something; each problem is { id, message }. */
export function read(workspace, capabilities, { name, comment, seconds }) {
  const reader = new Reader(capabilities);
  const [start] = workspace.getBlocksByType("kg_start");
  const body = reader.sequence(start?.getNextBlock());
  const program = { version: 1, name, body };
  if (comment) program.comment = comment;
  if (seconds) program.seconds = seconds;
  return { program: reader.problems.length ? null : program, problems: reader.problems };
}

class Reader {
  constructor(capabilities) {
    this.problems = [];
    this.capabilities = capabilities;
    this.writes = new Map(capabilities.map((one) => [doType(one.name), one]));
    this.reads = new Map(capabilities.map((one) => [readType(one.name), one]));
  }

  /** Return the statements from a block on. */
  sequence(block) {
    const found = [];
    for (let at = block; at; at = at.getNextBlock()) {
      if (!at.isEnabled()) continue;
      const comment = at.getCommentText();
      found.push({ ...this.statement(at), id: at.id, ...(comment ? { comment } : {}) });
    }
    return found;
  }

  inside(block, name) {
    return this.sequence(block.getInputTargetBlock(name));
  }

  /** Return the expression in an input; a problem where there is none. */
  needed(block, name, what = "a value") {
    const found = block.getInputTargetBlock(name);
    if (found) return this.expression(found);
    this.problems.push({ id: block.id, message: `Here ${what} is missing: put a block into the empty place.` });
    return { expression: "value", value: 0 };
  }

  perhaps(block, name, member) {
    const found = block.getInputTargetBlock(name);
    return found ? { [member]: this.expression(found) } : {};
  }

  statement(block) {
    const condition = () => this.needed(block, "IF", "a condition");
    switch (block.type) {
      case "kg_if": return { block: "if", condition: condition(), then: this.inside(block, "THEN") };
      case "kg_if_else": return { block: "if", condition: condition(), then: this.inside(block, "THEN"), otherwise: this.inside(block, "ELSE") };
      case "kg_while": return { block: "while", condition: condition(), body: this.inside(block, "DO") };
      case "kg_forever": return { block: "forever", body: this.inside(block, "DO") };
      case "kg_repeat": return { block: "repeat", times: this.needed(block, "TIMES", "a number"), body: this.inside(block, "DO") };
      case "kg_for": return {
        block: "for", variable: block.getFieldValue("NAME"), start: this.needed(block, "FROM", "a number"), end: this.needed(block, "TO", "a number"),
        ...this.step(block), body: this.inside(block, "DO"),
      };
      case "kg_each": return { block: "for", variable: block.getFieldValue("NAME"), of: this.needed(block, "LIST", "a list"), body: this.inside(block, "DO") };
      case "kg_break": return { block: "break" };
      case "kg_wait": return { block: "wait", seconds: this.needed(block, "SECONDS", "a time") };
      case "kg_until": return { block: "wait-until", condition: condition(), ...this.perhaps(block, "SECONDS", "seconds") };
      case "kg_until_else": return { block: "wait-until", condition: condition(), ...this.perhaps(block, "SECONDS", "seconds"), otherwise: this.inside(block, "ELSE") };
      case "kg_on": return { block: "on-event", condition: condition(), then: this.inside(block, "THEN"), body: this.inside(block, "DO"), end: block.getFieldValue("END") === "end" };
      case "kg_log": return { block: "log", message: this.needed(block, "MESSAGE") };
      case "kg_stop": return { block: "stop" };
      case "kg_set": return { block: "set", variable: block.getFieldValue("NAME"), value: this.needed(block, "VALUE") };
      case "kg_parallel": return { block: "parallel", branches: this.branches(block) };
      default: return this.capability(block, this.writes.get(block.type));
    }
  }

  /** Return the step of a loop unless it is the default, 1. */
  step(block) {
    const found = block.getInputTargetBlock("STEP");
    if (found?.type === "kg_plain" && found.isShadow() && Number(found.getFieldValue("VALUE")) === 1) return {};
    return this.perhaps(block, "STEP", "step");
  }

  branches(block) {
    return Array.from({ length: Number(block.getFieldValue("MANY")) }, (_, index) => this.inside(block, `DO${index}`));
  }

  capability(block, capability) {
    const given = {};
    for (const parameter of capability.parameters) {
      const found = block.getInputTargetBlock(argument(parameter.name));
      if (found && !unchanged(found, parameter)) given[parameter.name] = this.expression(found);
    }
    if (block.getInput(argument(AT)) && !(AT in given)) given[AT] = this.needed(block, argument(AT), "a place");
    return { block: "do", capability: this.called(capability), arguments: given, ...this.perhaps(block, "SECONDS", "seconds"), ...this.perhaps(block, "WITHIN", "within") };
  }

  /** Return the label of a capability, unless another one has the same. */
  called({ name, label, modality }) {
    const same = this.capabilities.filter((one) => one.modality === modality && [one.label, one.name, ...(one.alternatives ?? [])].includes(label));
    return same.length === 1 ? label : name;
  }

  expression(block) {
    const both = (expression) => ({ ...expression, left: this.needed(block, "LEFT"), right: this.needed(block, "RIGHT") });
    const operator = block.getFieldValue("OPERATOR");
    switch (block.type) {
      case "kg_number": case "kg_plain": return written(block);
      case "kg_boolean": return { expression: "value", value: block.getFieldValue("VALUE") === "true" };
      case "kg_variable": return { expression: "variable", name: block.getFieldValue("NAME") };
      case "kg_compare": case "kg_logic": case "kg_count": return both({ expression: "binary", operator });
      case "kg_contains": return both({ expression: "binary", operator: "contains" });
      case "kg_not": return { expression: "unary", operator: "not", of: this.needed(block, "OF", "a condition") };
      case "kg_place": return {
        expression: "place", x: this.needed(block, "X", "a number"), y: this.needed(block, "Y", "a number"),
        ...this.perhaps(block, "Z", "z"), ...this.perhaps(block, "HEADING", "heading"),
      };
      case "kg_of": return { expression: "unary", operator, of: this.needed(block, "OF") };
      default: break;
    }
    const capability = this.reads.get(block.type);
    if (capability) return { expression: "read", capability: this.called(capability), parameter: block.getFieldValue("PARAMETER") };
    return { expression: "value", value: block.getFieldValue("VALUE") };
  }
}

function written(block) {
  const unit = block.getFieldValue("UNIT");
  return { expression: "value", value: Number(block.getFieldValue("VALUE")), ...(unit ? { unit } : {}) };
}

/** Whether a shadow shows the default value. */
function unchanged(block, parameter) {
  if (!block.isShadow() || parameter.default === undefined || parameter.default === null) return false;
  if (block.type === "kg_number" && (block.getFieldValue("UNIT") || undefined) !== (parameter.unit ?? undefined)) return false;
  return String(block.getFieldValue("VALUE")) === String(parameter.default);
}
