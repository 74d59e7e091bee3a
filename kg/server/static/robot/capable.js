// The blocks of capabilities, and the toolbox with all blocks.

import { GROUPS, groupOf, PLACE } from "./kinds.js";

/** Return the type of the block of a capability. */
export const doType = (name) => `do ${name}`;
export const readType = (name) => `read ${name}`;
const choiceType = (capability, parameter) => `choice ${capability} ${parameter}`;

/** Define the blocks of capabilities. */
export function defineCapabilities(Blockly, units, capabilities) {
  for (const capability of capabilities) {
    if (capability.modality === "write") Blockly.Blocks[doType(capability.name)] = doBlock(Blockly, units, capability);
    else if (capability.parameters.length) Blockly.Blocks[readType(capability.name)] = readBlock(Blockly, units, capability);
  }
}

function doBlock(Blockly, units, capability) {
  for (const parameter of capability.parameters.filter(({ choices }) => choices?.length)) {
    Blockly.Blocks[choiceType(capability.name, parameter.name)] = {
      init() {
        this.appendDummyInput().appendField(new Blockly.FieldDropdown(parameter.choices.map((one) => [one, one])), "VALUE");
        this.setOutput(true, "String");
        this.setStyle("values");
      },
    };
  }
  return {
    init() {
      this.appendDummyInput().appendField(capability.label);
      for (const parameter of capability.parameters) {
        this.appendValueInput(argument(parameter.name)).setCheck(units.taken(parameter)).setAlign(Blockly.inputs.Align.RIGHT).appendField(parameter.name);
      }
      this.time(lasts(capability) ? "SECONDS" : "WITHIN");
      this.setPreviousStatement(true);
      this.setNextStatement(true);
      this.setInputsInline(capability.parameters.length < 3);
      this.setStyle(capability.unknown ? "unknown" : groupOf(capability).style);
      this.setTooltip(explained(capability));
    },
    time(name) {
      if (this.getInput(name)) return;
      const input = this.appendValueInput(name).setCheck(units.taken({ type: "number", unit: "s" }));
      input.setAlign(Blockly.inputs.Align.RIGHT).appendField(name === "SECONDS" ? "for" : "within");
    },
    /** Take a place instead of its parts, except the parts in `kept`. */
    place(kept) {
      for (const name of PARTS) if (!kept.includes(name)) this.removeInput(argument(name), true);
      if (this.getInput(argument(AT))) return;
      this.appendValueInput(argument(AT)).setCheck([PLACE]).setAlign(Blockly.inputs.Align.RIGHT).appendField("at");
      this.moveInputBefore(argument(AT), this.inputList[1].name);
    },
    saveExtraState() {
      const times = ["SECONDS", "WITHIN"].filter((name) => this.getInputTargetBlock(name));
      return this.getInput(argument(AT)) ? { times, at: PARTS.filter((name) => this.getInput(argument(name))) } : { times };
    },
    loadExtraState({ times = [], at }) {
      for (const name of times) this.time(name);
      if (at) this.place(at);
    },
  };
}

function readBlock(Blockly, units, capability) {
  const known = new Map(capability.parameters.map((one) => [one.name, one]));
  return {
    init() {
      const parameter = new Blockly.FieldDropdown(capability.parameters.map(({ name }) => [name, name]));
      parameter.setValidator((chosen) => { this.outputConnection?.setCheck(units.given(known.get(chosen))); });
      this.appendDummyInput().appendField(parameter, "PARAMETER").appendField(`of ${capability.label}`);
      this.setOutput(true, units.given(capability.parameters[0]));
      this.setStyle(capability.unknown ? "unknown" : groupOf(capability).style);
      this.setTooltip(explained(capability));
    },
  };
}

/** Return the description of a capability and of its parameters. */
function explained({ comment, label, parameters }) {
  const lines = parameters.filter((one) => one.label !== one.name).map((one) => `${one.name}: ${one.label}`);
  return [comment || label, ...lines].join("\n");
}

/** Return the name of the input of an argument. */
export const argument = (name) => `ARGUMENT ${name}`;

/** The argument for a place, and its meaning. */
export const AT = "at";
export const PARTS = ["x", "y", "z", "heading"];

/** Whether a capability goes to places. */
export const takesPlace = ({ modality, parameters }) => modality === "write" && ["x", "y"].every((part) => parameters.some(({ name }) => name === part)) && !parameters.some(({ name }) => name === AT);

/** Return the state of a new block of a capability that goes to the place of a name. */
export const going = (capability, name) => ({ type: doType(capability.name), extraState: { times: [], at: [] }, inputs: { [argument(AT)]: { block: variable(name) } } });
const variable = (name) => ({ type: "kg_variable", fields: { NAME: name } });

/** Return the state of a block that gives a place a name. */
export const naming = (name, place) => ({ type: "kg_set", fields: { NAME: name }, inputs: { VALUE: { block: place } } });

/** Whether a movement continues until it is ended. */
export const lasts = (capability) => capability.ways.some(({ rate }) => rate > 0);

/** Return the shadow in the input of a parameter, until a block replaces it. */
export function shadowOf(capability, parameter) {
  if (parameter.choices?.length) {
    return { type: choiceType(capability.name, parameter.name), fields: { VALUE: parameter.default ?? parameter.choices[0] } };
  }
  if (parameter.type === "boolean") return { type: "kg_boolean", fields: { VALUE: String(parameter.default ?? false) } };
  if (parameter.type === "text") return { type: "kg_text", fields: { VALUE: parameter.default ?? "" } };
  if (["list", "any"].includes(parameter.type)) return null;
  return number(parameter.default ?? 0, parameter.unit);
}

/** Return the state of a new block of a capability, as the toolbox and the list of capabilities offer it. */
export function fresh(capability) {
  const inputs = Object.fromEntries(capability.parameters.map((one) => [argument(one.name), { shadow: shadowOf(capability, one) }]).filter(([, { shadow }]) => shadow));
  if (lasts(capability)) inputs.SECONDS = { block: number(2, "s") };
  return { type: doType(capability.name), inputs };
}

/** Return the state of a number. */
export const number = (value, unit = "") => (unit ? { type: "kg_number", fields: { VALUE: value, UNIT: unit } } : { type: "kg_plain", fields: { VALUE: value } });

const shadowed = (type, inputs, more = {}) => ({
  kind: "block", type, inputs: Object.fromEntries(Object.entries(inputs).map(([name, shadow]) => [name, { shadow }])), ...more,
});
const text = (value) => ({ type: "kg_text", fields: { VALUE: value } });
const plain = (type) => ({ kind: "block", type });

/** Return the classes of a category: robot.css draws its sign. */
const look = (name) => ({ row: `blocklyToolboxCategory kg-category kg-${name}` });

/** Return the toolbox: the blocks by category, those of capabilities as the robot has them. */
export function toolbox(capabilities) {
  const category = (name, style, contents) => ({ kind: "category", name, categorystyle: style, cssConfig: look(style), contents });
  const groups = GROUPS.map((group) => category(group.short, group.style, capabilities
    .filter((one) => groupOf(one) === group).flatMap((one) => offered(one))));
  return {
    kind: "categoryToolbox",
    contents: [
      ...groups.filter(({ contents }) => contents.length),
      category("Control", "control", [
        plain("kg_if"), plain("kg_if_else"), shadowed("kg_repeat", { TIMES: number(3) }), shadowed("kg_wait", { SECONDS: number(1, "s") }),
        plain("kg_while"), plain("kg_forever"), plain("kg_until"),
        { kind: "block", type: "kg_until_else", inputs: { SECONDS: { block: number(10, "s") } } },
        shadowed("kg_for", { FROM: number(1), TO: number(5), STEP: number(1) }), plain("kg_each"), plain("kg_break"),
        plain("kg_parallel"), plain("kg_on"), shadowed("kg_log", { MESSAGE: text("hello") }), plain("kg_stop"),
      ]),
      category("Conditions", "conditions", [
        shadowed("kg_compare", { LEFT: number(0), RIGHT: number(1) }), plain("kg_logic"), plain("kg_not"), plain("kg_contains"),
      ]),
      category("Values", "values", [
        plain("kg_plain"), { kind: "block", ...number(1, "m") }, plain("kg_text"), plain("kg_boolean"),
        shadowed("kg_count", { LEFT: number(1), RIGHT: number(1) }), plain("kg_of"),
      ]),
      ...(capabilities.some(takesPlace) ? [{ kind: "category", name: "Places", categorystyle: "variables", cssConfig: look("places"), custom: "KG_PLACES" }] : []),
      { kind: "category", name: "Variables", categorystyle: "variables", cssConfig: look("variables"), custom: "KG_VARIABLES" },
    ],
  };
}

function offered(capability) {
  if (capability.modality === "write") return [{ kind: "block", ...fresh(capability) }];
  return capability.parameters.map(({ name }) => ({ kind: "block", type: readType(capability.name), fields: { PARAMETER: name } }));
}

/** Return the category of places: a new one, and going to those of the robot or of the program. */
export function placesOffered(workspace, capabilities, names) {
  const named = workspace.getBlocksByType("kg_set").filter((block) => block.getInputTargetBlock("VALUE")?.type === "kg_place");
  const all = [...new Set([...named.map((block) => block.getFieldValue("NAME")), ...names])];
  const place = { type: "kg_place", inputs: { X: { shadow: number(1, "m") }, Y: { shadow: number(1, "m") } } };
  return [
    { kind: "block", ...naming("place", place) }, { kind: "block", ...place },
    ...capabilities.filter(takesPlace).slice(0, 1).flatMap((one) => all.map((name) => ({ kind: "block", ...going(one, name) }))),
    ...all.map((name) => ({ kind: "block", ...variable(name) })),
  ];
}

/** Return the category of variables: a new one, and those of the program. */
export function variables(workspace) {
  const blocks = ["kg_set", "kg_for", "kg_each"].flatMap((type) => workspace.getBlocksByType(type));
  const names = [...new Set(blocks.map((block) => block.getFieldValue("NAME")))].sort();
  return [
    shadowed("kg_set", { VALUE: number(0) }),
    ...names.map((name) => ({ kind: "block", type: "kg_variable", fields: { NAME: name } })),
  ];
}
