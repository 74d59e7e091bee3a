// The types of connectors: a number of a quantity, a truth value, a text, a list, a place. They separate what cannot fit while
// blocks are put together; the server checks the whole program.

/** The type of truth values, texts, lists and places, by which Blockly's renderer chooses their shapes. */
export const BOOLEAN = "Boolean";
export const TEXT = "String";
export const LIST = "Array";
export const PLACE = "Place";
/** A number without a unit; it fits wherever a number does. */
export const NUMBER = "Number";

/** Units and dimensions: `units` is a list of { unit, dimension } from the server. */
export class Units {
  constructor(units) {
    this.all = units.map(({ unit }) => unit);
    this.dimensions = new Map(units.map(({ unit, dimension }) => [unit, dimension]));
  }

  /** Return the type of a number with this unit, or without one. */
  type(unit) {
    const dimension = unit && this.dimensions.get(unit);
    return dimension ? `${NUMBER} ${dimension}` : NUMBER;
  }

  /** Return all types of numbers: the result of arithmetic may be any. */
  numbers() {
    return [NUMBER, ...new Set(this.all.map((unit) => this.type(unit)))];
  }

  /** Return the units of the same quantity, itself first. */
  alike(unit) {
    const type = this.type(unit);
    return [unit, ...this.all.filter((one) => one !== unit && this.type(one) === type)];
  }

  /** Return the types accepted by an input for a parameter; null for all. */
  taken({ type, unit }) {
    if (type === "any") return null;
    if (type === "boolean") return [BOOLEAN];
    if (type === "text") return [TEXT];
    if (type === "list") return [LIST];
    return unit ? [NUMBER, this.type(unit)] : this.numbers();
  }

  /** Return the output types of a block that reads a parameter. */
  given({ type, unit }) {
    if (type === "any") return null;
    if (type === "boolean") return [BOOLEAN];
    if (type === "text") return [TEXT];
    if (type === "list") return [LIST];
    return [this.type(unit)];
  }
}

/** The group of a capability, by its most general kind, and its label. */
export const GROUPS = [
  { kind: "Movement", title: "How it moves", short: "Moves", style: "movement" },
  { kind: "Sensing", title: "What it senses", short: "Senses", style: "sensing" },
  { kind: "RobotKnowledge", title: "Knowledge", short: "Knows", style: "knowledge" },
];

/** Return the group of a capability; one without a listed kind is sensed or moved by its modality. */
export function groupOf(capability) {
  const plain = capability.kinds.map((kind) => kind.replace(/\s/g, "").toLowerCase());
  return GROUPS.find(({ kind }) => plain.includes(kind.toLowerCase())) ?? GROUPS[capability.modality === "write" ? 0 : 1];
}
