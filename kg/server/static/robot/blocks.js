// The blocks of the language: control, conditions, values and variables. Those of capabilities stand in capable.js.

import { BOOLEAN, LIST, NUMBER, PLACE, TEXT } from "./kinds.js";

// Blocks have the words of the text: readers of one form can read the other.
const COMPARED = ["<", "<=", "=", "!=", ">=", ">"].map((sign) => [sign, sign]);
const COUNTED = ["+", "-", "*", "/"].map((sign) => [sign, sign]);
const OF_ONE = ["absolute", "-", "round", "count"].map((word) => [word, word]);
const NAME = /[^\p{L}\p{N}_]+/gu;
const BRANCHES = 8;

/** Define the blocks; `units` are those of kinds.js, `lenience` is set while a program is being shown. */
export function define(Blockly, units, lenience) {
  const numbers = units.numbers();
  const time = [NUMBER, units.type("s")];
  const any = [...numbers, BOOLEAN, TEXT, LIST, PLACE];
  const value = (name, check) => ({ type: "input_value", name, check });
  const inside = (name) => ({ type: "input_statement", name });
  const name = { type: "field_input", name: "NAME", text: "x" };
  const statement = (type, rows, more = {}) => ({
    type, ...rowsOf(rows), previousStatement: null, nextStatement: null, style: "control", inputsInline: true, ...more,
  });
  const expression = (type, rows, output, more = {}) => ({ type, ...rowsOf(rows), output, style: "conditions", inputsInline: true, ...more });
  if (!Blockly.Extensions.isRegistered("kg_units")) Blockly.Extensions.register("kg_units", function () { alike(this, units, lenience); });
  Blockly.common.defineBlocksWithJsonArray([
    { type: "kg_start", message0: "when the program starts", nextStatement: null, style: "start", tooltip: "The program: what is joined below, from top to bottom" },
    statement("kg_if", [["if %1", value("IF", [BOOLEAN])], ["then %1", inside("THEN")]], { tooltip: "Does something only if a condition holds" }),
    statement("kg_if_else", [["if %1", value("IF", [BOOLEAN])], ["then %1", inside("THEN")], ["otherwise %1", inside("ELSE")]], { tooltip: "Does one thing if a condition holds, another if not" }),
    statement("kg_while", [["while %1", value("IF", [BOOLEAN])], ["do %1", inside("DO")]], { tooltip: "Does something again and again as long as a condition holds" }),
    statement("kg_forever", [["forever"], ["do %1", inside("DO")]], { tooltip: "Does something again and again, until break or stop" }),
    statement("kg_repeat", [["repeat %1 times", value("TIMES", [NUMBER])], ["do %1", inside("DO")]], { tooltip: "Does something a number of times" }),
    statement("kg_for", [["for %1 from %2 to %3 step %4", name, value("FROM", numbers), value("TO", numbers), value("STEP", numbers)], ["do %1", inside("DO")]], { tooltip: "Does something for each number, the last one too" }),
    statement("kg_each", [["for each %1 in %2", name, value("LIST", [LIST])], ["do %1", inside("DO")]], { tooltip: "Does something for each thing of a list" }),
    statement("kg_break", [["break"]], { tooltip: "Leaves the innermost loop and goes on below it", nextStatement: undefined }),
    statement("kg_wait", [["wait %1", value("SECONDS", time)]], { tooltip: "Waits; a movement that has ended does not begin again" }),
    statement("kg_until", [["wait until %1", value("IF", [BOOLEAN])], ["within %1", value("SECONDS", time)]], { tooltip: "Waits until a condition holds; when the time is over first, the program ends with an error" }),
    statement("kg_until_else", [["wait until %1", value("IF", [BOOLEAN])], ["within %1", value("SECONDS", time)], ["otherwise %1", inside("ELSE")]], { tooltip: "Waits until a condition holds; when the time is over first, something else is done" }),
    statement("kg_on", [["%1 %2", { type: "field_dropdown", name: "END", options: [["whenever", "go"], ["as soon as", "end"]] }, value("IF", [BOOLEAN])], ["do %1", inside("THEN")], ["during %1", inside("DO")]], { tooltip: "While the lower part runs, does the upper part when a condition begins to hold: whenever it does, or once, which ends the lower part" }),
    statement("kg_log", [["log %1", value("MESSAGE", any)]], { tooltip: "Writes a value into the log of this page" }),
    statement("kg_stop", [["stop"]], { nextStatement: undefined, tooltip: "Ends the program; the robot stops" }),
    statement("kg_set", [["set %1 to %2", name, value("VALUE", any)]], { style: "variables", tooltip: "Gives a value a name, to use it later" }),
    expression("kg_variable", [["%1", name]], null, { style: "variables", tooltip: "A value by its name" }),
    expression("kg_boolean", [["%1", { type: "field_dropdown", name: "VALUE", options: [["true", "true"], ["false", "false"]] }]], BOOLEAN, { style: "values" }),
    expression("kg_text", [["“ %1 ”", { type: "field_input", name: "VALUE", text: "" }]], TEXT, { style: "values", tooltip: "A text" }),
    expression("kg_compare", [["%1 %2 %3", value("LEFT", any), { type: "field_dropdown", name: "OPERATOR", options: COMPARED }, value("RIGHT", any)]], BOOLEAN, { extensions: ["kg_units"] }),
    expression("kg_logic", [["%1 %2 %3", value("LEFT", [BOOLEAN]), { type: "field_dropdown", name: "OPERATOR", options: [["and", "and"], ["or", "or"]] }, value("RIGHT", [BOOLEAN])]], BOOLEAN),
    expression("kg_not", [["not %1", value("OF", [BOOLEAN])]], BOOLEAN),
    expression("kg_contains", [["%1 contains %2", value("LEFT", [LIST, TEXT]), value("RIGHT", any)]], BOOLEAN),
    expression("kg_count", [["%1 %2 %3", value("LEFT", [...numbers, TEXT]), { type: "field_dropdown", name: "OPERATOR", options: COUNTED }, value("RIGHT", any)]], [...numbers, TEXT], { style: "values", extensions: ["kg_units"], tooltip: "Reckons with two values; a text + anything is a longer text" }),
    expression("kg_of", [["%1 %2", { type: "field_dropdown", name: "OPERATOR", options: OF_ONE }, value("OF", [...numbers, LIST, TEXT])]], numbers, { style: "values" }),
  ]);
  Blockly.Blocks.kg_plain = {
    init() {
      this.appendDummyInput().appendField(new Blockly.FieldNumber(0), "VALUE");
      this.setOutput(true, NUMBER);
      this.setStyle("values");
      this.setTooltip("A number without a unit");
    },
  };
  Blockly.Blocks.kg_number = numberBlock(Blockly, units, lenience);
  Blockly.Blocks.kg_place = placeBlock(units);
  Blockly.Blocks.kg_parallel = parallelBlock(Blockly);
}

const SAME = new Set(["<", "<=", "=", "!=", ">=", ">", "+", "-"]);

/** Give a plain number in a slot the unit of the value next to it, once that is attached. */
function alike(block, units, lenience) {
  block.setOnChange((event) => {
    if (lenience.on || event.type !== "move" || event.newParentId !== block.id || !SAME.has(block.getFieldValue("OPERATOR"))) return;
    for (const [name, other] of [["LEFT", "RIGHT"], ["RIGHT", "LEFT"]]) {
      const plain = block.getInputTargetBlock(name);
      const types = block.getInputTargetBlock(other)?.outputConnection.getCheck();
      const unit = plain?.type === "kg_plain" && types?.length === 1 && units.all.find((one) => units.type(one) === types[0] && types[0] !== NUMBER);
      if (!unit) continue;
      const shadow = { type: "kg_number", fields: { VALUE: Number(plain.getFieldValue("VALUE")), UNIT: unit } };
      if (!plain.isShadow()) plain.dispose();
      block.getInput(name).connection.setShadowState(shadow);
    }
  });
}

/** Return the members of a definition for its rows, each a text with its arguments. */
function rowsOf(rows) {
  return Object.fromEntries(rows.flatMap(([message, ...fills], index) => [[`message${index}`, message], [`args${index}`, fills]]));
}

/** A number with a unit: as a parameter it offers the units of that quantity. */
function numberBlock(Blockly, units, lenience) {
  const options = (field) => {
    const input = field.getSourceBlock()?.outputConnection?.targetConnection?.getCheck();
    const wanted = !lenience.on && input?.length === 2 && field.getSourceBlock().isShadow() ? input[1] : null;
    const given = field.getValue();
    const fitting = wanted && (!given || units.type(given) === wanted) ? units.all.filter((unit) => units.type(unit) === wanted) : units.all;
    return [[" ", ""], ...fitting.map((unit) => [unit, unit])];
  };
  return {
    init() {
      const unit = new Blockly.FieldDropdown(function () { return options(this); });
      unit.setValidator((chosen) => { this.outputConnection?.setCheck(units.type(chosen)); });
      this.appendDummyInput().appendField(new Blockly.FieldNumber(0), "VALUE").appendField(unit, "UNIT");
      this.setOutput(true, NUMBER);
      this.setStyle("values");
      this.setTooltip("A number, with its unit if it has one");
    },
  };
}

/** A place on the map; its height is shown only if a program sets it. */
function placeBlock(units) {
  return {
    init() {
      this.part("X", "x", "m");
      this.part("Y", "y", "m");
      this.part("HEADING", "heading", "rad");
      this.setInputsInline(true);
      this.setOutput(true, PLACE);
      this.setStyle("values");
      this.setTooltip("A place on the robot's map; where it looks to there may be left empty");
    },
    part(name, label, unit) {
      return this.appendValueInput(name).setCheck([NUMBER, units.type(unit)]).appendField(label);
    },
    saveExtraState() {
      return this.getInput("Z") ? { z: true } : null;
    },
    loadExtraState({ z }) {
      if (z && !this.getInput("Z")) this.part("Z", "z", "m");
    },
  };
}

/** Several sequences at a time; how many is chosen on the block. */
function parallelBlock(Blockly) {
  return {
    init() {
      const many = new Blockly.FieldDropdown(Array.from({ length: BRANCHES - 1 }, (_, index) => [`${index + 2}`, `${index + 2}`]));
      many.setValidator((chosen) => { this.shape(Number(chosen)); });
      this.appendDummyInput().appendField("at the same time").appendField(many, "MANY");
      this.setPreviousStatement(true);
      this.setNextStatement(true);
      this.setStyle("control");
      this.setTooltip("Does several things at a time, and goes on when all have ended");
      this.shape(2);
    },
    shape(many) {
      for (let index = 0; index < BRANCHES; index += 1) {
        const known = this.getInput(`DO${index}`);
        if (index < many && !known) this.appendStatementInput(`DO${index}`).appendField(index ? "also" : "");
        else if (index >= many && known) this.removeInput(`DO${index}`);
      }
    },
  };
}

/** Return a name that is valid in the language. */
export function nameOf(text) {
  const found = text.trim().replace(NAME, "_");
  return /^[\p{L}_]/u.test(found) ? found : `x${found}`;
}
