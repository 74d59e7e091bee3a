// From a program to blocks: the state for Blockly. Identities of statements become those of blocks.

import { argument, AT, doType, fresh, number, PARTS, readType, shadowOf, takesPlace } from "./capable.js";

/** Return the capabilities that a program uses and the robot does not have, derived from their use. */
export function unknown(program, capabilities) {
  const known = new Set(capabilities.map(({ name, modality }) => `${modality} ${name}`));
  const found = new Map();
  const add = (modality, name, parameters) => {
    const key = `${modality} ${name}`;
    if (known.has(key)) return;
    const copy = found.get(key) ?? { name, label: name, comment: "The robot that is connected cannot do this.", kinds: [], modality, parameters: [], ways: [], unknown: true };
    for (const one of parameters) if (!copy.parameters.some((other) => other.name === one)) copy.parameters.push({ name: one, label: one, type: "any" });
    found.set(key, copy);
  };
  const look = (part) => {
    if (Array.isArray(part)) part.forEach(look);
    else if (part && typeof part === "object") {
      if (part.block === "do") add("write", part.capability, Object.keys(part.arguments ?? {}));
      if (part.expression === "read") add("read", part.capability, [part.parameter]);
      Object.values(part).forEach(look);
    }
  };
  look(program.body ?? []);
  return [...found.values()];
}

/** Return the state of a workspace that shows a program. */
export function state(program, capabilities) {
  const writer = new Writer(capabilities);
  return { blocks: { languageVersion: 0, blocks: [{ type: "kg_start", id: "start", x: 24, y: 24, deletable: false, ...writer.next(program.body ?? []) }] } };
}

/** Return a program whose capabilities are called by their names, also if it uses their labels. */
export function named(program, capabilities) {
  const folded = (text) => text.toLowerCase().replace(/[^\p{L}\p{N}]+/gu, "");
  const same = (one, text) => [one.name, one.label, ...(one.alternatives ?? [])].some((other) => folded(other) === folded(text));
  const resolve = (part) => {
    if (Array.isArray(part)) return part.map(resolve);
    if (!part || typeof part !== "object") return part;
    const copy = Object.fromEntries(Object.entries(part).map(([key, value]) => [key, resolve(value)]));
    const modality = { do: "write" }[part.block] ?? { read: "read" }[part.expression];
    const capability = modality && capabilities.find((one) => one.modality === modality && same(one, part.capability));
    if (!capability) return copy;
    const parameter = (text) => capability.parameters.find((one) => same(one, text))?.name ?? text;
    copy.capability = capability.name;
    if (copy.parameter) copy.parameter = parameter(copy.parameter);
    if (copy.arguments) copy.arguments = Object.fromEntries(Object.entries(copy.arguments).map(([key, value]) => [parameter(key), value]));
    return copy;
  };
  return resolve(program);
}

class Writer {
  constructor(capabilities) {
    this.capabilities = new Map(capabilities.map((one) => [`${one.modality} ${one.name}`, one]));
  }

  next(statements) {
    const state = this.sequence(statements);
    return state ? { next: { block: state } } : {};
  }

  sequence([first, ...rest]) {
    if (!first) return null;
    const state = this.statement(first);
    if (first.id) state.id = first.id;
    if (first.comment) state.icons = { comment: { text: first.comment, pinned: false } };
    return rest.length ? { ...state, ...this.next(rest) } : state;
  }

  inputs(values, sequences = {}) {
    const filled = Object.entries(values).filter(([, one]) => one).map(([name, one]) => [name, this.input(one)]);
    const inside = Object.entries(sequences).map(([name, list]) => [name, this.sequence(list ?? [])]).filter(([, one]) => one);
    return Object.fromEntries([...filled, ...inside.map(([name, block]) => [name, { block }])]);
  }

  /** Return the state of an input: literal values become shadows, which blocks replace. */
  input(expression, shadow = null) {
    const block = this.expression(expression);
    if (expression.expression === "value" && (!shadow || shadow.type === block.type)) return { shadow: block };
    return shadow ? { block, shadow } : { block };
  }

  statement(one) {
    switch (one.block) {
      case "if": return {
        type: one.otherwise?.length ? "kg_if_else" : "kg_if",
        inputs: this.inputs({ IF: one.condition }, { THEN: one.then, ELSE: one.otherwise }),
      };
      case "while": return { type: "kg_while", inputs: this.inputs({ IF: one.condition }, { DO: one.body }) };
      case "forever": return { type: "kg_forever", inputs: this.inputs({}, { DO: one.body }) };
      case "repeat": return { type: "kg_repeat", inputs: this.inputs({ TIMES: one.times }, { DO: one.body }) };
      case "for": return this.loop(one);
      case "break": return { type: "kg_break" };
      case "wait": return { type: "kg_wait", inputs: this.inputs({ SECONDS: one.seconds }) };
      case "wait-until": return {
        type: one.otherwise ? "kg_until_else" : "kg_until",
        inputs: { ...this.inputs({ IF: one.condition }, { ELSE: one.otherwise }), ...this.time("SECONDS", one.seconds) },
      };
      case "parallel": return {
        type: "kg_parallel", fields: { MANY: String(Math.max(2, one.branches?.length ?? 0)) },
        inputs: this.inputs({}, Object.fromEntries((one.branches ?? []).map((branch, index) => [`DO${index}`, branch]))),
      };
      case "on-event": return {
        type: "kg_on", fields: { END: one.end ? "end" : "go" },
        inputs: this.inputs({ IF: one.condition }, { THEN: one.then, DO: one.body }),
      };
      case "log": return { type: "kg_log", inputs: this.inputs({ MESSAGE: one.message }) };
      case "stop": return { type: "kg_stop" };
      case "set": return { type: "kg_set", fields: { NAME: one.variable }, inputs: this.inputs({ VALUE: one.value }) };
      default: return this.capability(one);
    }
  }

  loop(one) {
    const fields = { NAME: one.variable };
    if (one.of) return { type: "kg_each", fields, inputs: this.inputs({ LIST: one.of }, { DO: one.body }) };
    const step = one.step ?? { expression: "value", value: 1 };
    return { type: "kg_for", fields, inputs: this.inputs({ FROM: one.start, TO: one.end, STEP: step }, { DO: one.body }) };
  }

  /** Return the state of an input for an optional time: a block, which can be removed. */
  time(name, seconds) {
    return seconds ? { [name]: { block: this.expression(seconds) } } : {};
  }

  capability(one) {
    const capability = this.capabilities.get(`write ${one.capability}`);
    const { inputs } = fresh(capability);
    delete inputs.SECONDS;
    for (const parameter of capability.parameters) {
      const given = one.arguments?.[parameter.name];
      if (given) inputs[argument(parameter.name)] = this.argument(given, shadowOf(capability, parameter), parameter);
      else if ((parameter.default ?? null) === null) delete inputs[argument(parameter.name)]; // an omitted value is not 0
    }
    Object.assign(inputs, this.time("SECONDS", one.seconds), this.time("WITHIN", one.within));
    const extraState = { times: ["SECONDS", "WITHIN"].filter((name) => inputs[name]) };
    const place = takesPlace(capability) && one.arguments?.[AT];
    if (place) {
      extraState.at = PARTS.filter((name) => one.arguments[name]);
      for (const name of PARTS) if (!one.arguments[name]) delete inputs[argument(name)];
      inputs[argument(AT)] = { block: this.expression(place) };
    }
    return { type: doType(one.capability), extraState, inputs };
  }

  /** Return the state of the input of an argument: a choice is a block of its own. */
  argument(given, shadow, { choices }) {
    if (choices?.includes(given.value)) return { shadow: { ...shadow, fields: { VALUE: given.value } } };
    return this.input(given, shadow);
  }

  expression(one) {
    switch (one.expression) {
      case "value": return literal(one);
      case "variable": return { type: "kg_variable", fields: { NAME: one.name } };
      case "read": return { type: readType(one.capability), fields: { PARAMETER: one.parameter } };
      case "place": return { type: "kg_place", extraState: { z: Boolean(one.z) }, inputs: this.inputs({ X: one.x, Y: one.y, Z: one.z, HEADING: one.heading }) };
      case "unary": return one.operator === "not"
        ? { type: "kg_not", inputs: this.inputs({ OF: one.of }) }
        : { type: "kg_of", fields: { OPERATOR: one.operator }, inputs: this.inputs({ OF: one.of }) };
      default: return this.binary(one);
    }
  }

  binary({ operator, left, right }) {
    const inputs = this.inputs({ LEFT: left, RIGHT: right });
    if (operator === "contains") return { type: "kg_contains", inputs };
    const type = ["and", "or"].includes(operator) ? "kg_logic" : "+-*/".includes(operator) ? "kg_count" : "kg_compare";
    return { type, fields: { OPERATOR: operator }, inputs };
  }
}

function literal({ value, unit }) {
  if (typeof value === "boolean") return { type: "kg_boolean", fields: { VALUE: String(value) } };
  if (typeof value === "string") return { type: "kg_text", fields: { VALUE: value } };
  return number(value, unit);
}
