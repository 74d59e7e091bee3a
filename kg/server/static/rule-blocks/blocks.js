// The blocks of rules: patterns, tests, values, and the rule itself.

import { chosenField } from "./fields.js";
import { packed, short, shown, unpacked } from "./terms.js";

const COMPARED = [["is equal to", "="], ["is not", "!="], ["is less than", "<"], ["is at most", "<="], ["is more than", ">"], ["is at least", ">="]];
const MATCHED = [["has in it", "CONTAINS"], ["begins with", "STRSTARTS"], ["ends with", "STRENDS"], ["matches the pattern", "REGEX"]];
const COUNTED = [["+", "+"], ["−", "-"], ["×", "*"], ["÷", "/"]];
const FUNCTIONS = [["the text of", "STR"], ["small letters of", "LCASE"], ["capital letters of", "UCASE"], ["how long is", "STRLEN"], ["the size (without sign) of", "ABS"], ["rounded", "ROUND"]];
const MOST = 12;

/** The types of connectors: a term, a value made of others, a test; statements are conditions or conclusions. */
export const TERM = "Term";
export const VALUE = "Value";
export const TEST = "Test";
const ANY = [TERM, VALUE];

/** Define the blocks. `offering` chooses, `vocabulary` names, `rename(old, new)` gives a thing another name everywhere. */
export function define(Blockly, { vocabulary, offering, edit, rename }) {
  const Chosen = chosenField(Blockly);
  const value = (name, check = ANY) => ({ type: "input_value", name, check });
  const inside = (name) => ({ type: "input_statement", name });
  const block = (type, rows, more) => ({ type, ...rowsOf(rows), inputsInline: true, ...more });
  const statement = (type, rows, more) => block(type, rows, { previousStatement: null, nextStatement: null, ...more });
  Blockly.common.defineBlocksWithJsonArray([
    block("kr_rule", [["when %1", inside("WHEN")], ["then %1", inside("THEN")]], { style: "start", tooltip: "The rule: where all above holds, all below does" }),
    statement("kr_only", [["only if %1", value("TEST", [TEST])]], { style: "conditions", tooltip: "Keeps only what passes a test" }),
    statement("kr_absent", [["there is nothing such that"], ["%1", inside("WHEN")]], { style: "conditions", tooltip: "Holds where the store has nothing that matches what is inside" }),
    statement("kr_present", [["there is something such that"], ["%1", inside("WHEN")]], { style: "conditions", tooltip: "Holds where the store has something that matches what is inside, whatever it is" }),
    statement("kr_perhaps", [["if there is any, also"], ["%1", inside("WHEN")]], { style: "conditions", tooltip: "Takes along what is inside where it is there; what has none is kept" }),
    block("kr_compare", [["%1 %2 %3", value("LEFT"), { type: "field_dropdown", name: "OPERATOR", options: COMPARED }, value("RIGHT")]], { output: TEST, style: "conditions" }),
    block("kr_match", [["%1 %2 %3", value("VALUE"), { type: "field_dropdown", name: "HOW", options: MATCHED }, value("TEXT")]], { output: TEST, style: "conditions", tooltip: "Compares texts letter by letter; “small letters of” both sides makes capital letters the same" }),
    block("kr_logic", [["%1 %2 %3", value("LEFT", [TEST]), { type: "field_dropdown", name: "OPERATOR", options: [["and", "and"], ["or", "or"]] }, value("RIGHT", [TEST])]], { output: TEST, style: "conditions" }),
    block("kr_not", [["not %1", value("OF", [TEST])]], { output: TEST, style: "conditions" }),
    block("kr_of", [["%1 %2", { type: "field_dropdown", name: "FUNCTION", options: FUNCTIONS }, value("OF")]], { output: VALUE, style: "values" }),
    block("kr_reckon", [["%1 %2 %3", value("LEFT"), { type: "field_dropdown", name: "OPERATOR", options: COUNTED }, value("RIGHT")]], { output: VALUE, style: "values" }),
  ]);

  const term = (current, where) => new Chosen(packed(current), {
    display: (packedTerm) => shown(unpacked(packedTerm), vocabulary),
    tip: (packedTerm) => tip(unpacked(packedTerm)),
    open: async (field) => {
      const found = await offering.term({ current: unpacked(field.getValue()), ...where(field.getSourceBlock()) });
      if (found?.rename) rename(...found.rename);
      else if (found) field.setValue(packed(found.term));
    },
  });
  const named = (current, choose) => new Chosen(current, {
    display: (name) => vocabulary.label(name),
    tip: (name) => [name, (vocabulary.byProperty.get(name) ?? vocabulary.byClass.get(name))?.comment].filter(Boolean).join("\n"),
    open: async (field) => { const found = await choose(field); if (found) field.setValue(found); },
  });
  const sparql = (current) => new Chosen(current, {
    display: (text) => short(text, 60), tip: (text) => text,
    open: async (field) => { const found = await edit(field.getValue()); if (found) field.setValue(found); },
  });
  const thing = (name) => ({ term: "thing", name });
  const start = (type, style, make, output) => {
    Blockly.Blocks[type] = {
      init() {
        make.call(this);
        this.setInputsInline(true);
        this.setStyle(style);
        if (output) this.setOutput(true, output);
        else {
          this.setPreviousStatement(true);
          this.setNextStatement(true);
        }
      },
    };
  };
  start("kr_term", "variables", function () {
    const field = term(thing("thing"), place);
    field.setValidator((packedTerm) => { this.setStyle(STYLES[unpacked(packedTerm).term]); });
    this.appendDummyInput().appendField(field, "TERM");
  }, TERM);
  start("kr_fact", "movement", function () {
    this.appendValueInput("SUBJECT").setCheck([TERM]);
    this.appendDummyInput().appendField(named("rdfs:label", (field) => offering.property({
      subject: termIn(this, "SUBJECT"), current: field.getValue(), concluded: isConcluded(this),
    })), "PROPERTY");
    this.appendValueInput("OBJECT").setCheck([TERM]);
    this.setTooltip("Something has a relation to something else; click a word to choose another");
  });
  start("kr_is", "sensing", function () {
    this.appendValueInput("SUBJECT").setCheck([TERM]);
    this.appendDummyInput().appendField("is a").appendField(named("ros:Node", () => offering.kind({ concluded: isConcluded(this) })), "KIND");
    this.setTooltip("Something is of a kind; click the kind to choose another");
  });
  start("kr_let", "values", function () {
    this.appendValueInput("VALUE").setCheck(ANY).appendField("let").appendField(term(thing("value"), () => ({ side: "from" })), "NAME").appendField("be");
    this.setTooltip("Gives a value a name");
  });
  start("kr_known", "conditions", function () {
    this.appendDummyInput().appendField(term(thing("thing"), () => ({ side: "from" })), "NAME").appendField("was found");
    this.setTooltip("Whether an “if there is any” found something");
  }, TEST);
  start("kr_sparql", "unknown", function () { this.appendDummyInput().appendField("SPARQL").appendField(sparql("?thing rdfs:label ?label ."), "TEXT"); });
  start("kr_formula", "unknown", function () { this.appendDummyInput().appendField("SPARQL").appendField(sparql("STR(?thing)"), "TEXT"); }, VALUE);
  start("kr_says", "unknown", function () { this.appendDummyInput().appendField("SPARQL").appendField(sparql("BOUND(?thing)"), "TEXT"); }, TEST);
  Blockly.Blocks.kr_either = several(Blockly, {
    style: "conditions", tip: "Holds where one of the patterns does", before: "one of", after: "patterns",
    add(name, index) { this.appendStatementInput(name).appendField(index ? "or" : "either"); },
    ends() { this.setPreviousStatement(true); this.setNextStatement(true); },
  });
  Blockly.Blocks.kr_join = several(Blockly, {
    style: "values", tip: "Texts one behind the other", before: "join", after: "texts",
    add(name) { this.appendValueInput(name).setCheck(ANY); },
    ends() { this.setOutput(true, VALUE); this.setInputsInline(true); },
  });
}

/** The colour of a term, by its kind. */
export const STYLES = { thing: "variables", name: "knowledge", text: "values", number: "values", truth: "values" };

function tip(term) {
  if (term.term === "thing") return `${term.name}: whatever the pattern finds; the same name means the same thing. Click to change.`;
  return `${term.name ?? term.value}. Click to change.`;
}

/** Return the members of a definition for its rows, each a text with its arguments. */
function rowsOf(rows) {
  return Object.fromEntries(rows.flatMap(([message, ...fills], index) => [[`message${index}`, message], [`args${index}`, fills]]));
}

/** Return the place of the block of a term: the side of which property, and the term at the other. */
function place(block) {
  const connection = block?.outputConnection?.targetConnection;
  const parent = connection?.getSourceBlock();
  const side = parent && ({ SUBJECT: "from", OBJECT: "to" })[connection.getParentInput().name];
  if (parent?.type !== "kr_fact" || !side) return side ? { side } : {};
  return { side, property: parent.getFieldValue("PROPERTY"), subject: termIn(parent, "SUBJECT") };
}

/** Return the term in an input of a block. */
export function termIn(block, input) {
  const found = block.getInputTargetBlock(input);
  return found?.type === "kr_term" ? unpacked(found.getFieldValue("TERM")) : null;
}

/** Whether a block is in the conclusions of the rule. */
export function isConcluded(block) {
  let [at, parent] = [block, block.getSurroundParent()];
  while (parent && parent.type !== "kr_rule") [at, parent] = [parent, parent.getSurroundParent()];
  if (!parent) return false;
  for (let one = parent.getInputTargetBlock("THEN"); one; one = one.getNextBlock()) if (one === at) return true;
  return false;
}

/** A block with several inputs, of which one chooses how many. */
function several(Blockly, { style, tip, before, after, add, ends }) {
  return {
    init() {
      const many = new Blockly.FieldDropdown(Array.from({ length: MOST - 1 }, (_, index) => [`${index + 2}`, `${index + 2}`]));
      many.setValidator((chosen) => { this.shape(Number(chosen)); });
      this.appendDummyInput().appendField(before).appendField(many, "MANY").appendField(after);
      ends.call(this);
      this.setStyle(style);
      this.setTooltip(tip);
      this.shape(2);
    },
    shape(many) {
      for (let index = 0; index < MOST; index += 1) {
        const known = this.getInput(`PART${index}`);
        if (index < many && !known) add.call(this, `PART${index}`, index);
        else if (index >= many && known) this.removeInput(`PART${index}`);
      }
    },
  };
}

/** How many parts a block with several inputs may have. */
export const PARTS = MOST;
