// The workspace of blocks: it shows a program, reports edits, and marks blocks.

import { load } from "../blocks/loading.js";
import { Stage } from "../blocks/stage.js";
import { define } from "./blocks.js";
import { defineCapabilities, fresh, going, naming, number, placesOffered, readType, toolbox, variables } from "./capable.js";
import { Units } from "./kinds.js";
import { read } from "./reading.js";
import { named, state, unknown } from "./writing.js";

/** Return a workspace in `host`, or null where the libraries of the pages were not built; `changed` is called after edits, `loose` with how many pieces hang loose. */
export async function workspace(host, { units, changed, loose, ready }) {
  const Blockly = await load();
  if (!Blockly) return null;
  ready();
  return new Workspace(Blockly, host, new Units(units), { changed, loose });
}

/** Return the connection checker: all are allowed while a program is shown or restored, as the server reports what does not fit. */
function lenient(Blockly) {
  const lenience = { on: false };
  class Checker extends Blockly.ConnectionChecker {
    doTypeChecks(one, other) { return lenience.on || super.doTypeChecks(one, other); }
  }
  return { lenience, Checker };
}

const WIDE = 400;
const WRAPS = new Set(["kg_compare", "kg_logic", "kg_count", "kg_contains", "kg_for", "kg_place"]);

/** Wrap a block and all within it, the innermost first, for their widths decide. */
function wrapped(block) {
  for (const child of block.getChildren(true)) wrapped(child);
  if (!WRAPS.has(block.type)) return;
  const values = block.inputList.map(({ connection }) => connection?.targetBlock()).filter((one) => one?.outputConnection);
  const inline = values.reduce((sum, one) => sum + one.getHeightWidth().width, 0) <= WIDE;
  if (block.getInputsInline() !== inline) block.setInputsInline(inline);
}

class Workspace extends Stage {
  constructor(Blockly, host, units, { changed, loose }) {
    super(Blockly, { changed, loose });
    this.units = units;
    this.capabilities = [];
    this.places = [];
    this.meta = { name: "program" };
    const checker = lenient(Blockly);
    this.lenience = checker.lenience;
    define(Blockly, units, this.lenience);
    this.inject(host, checker.Checker, toolbox([]));
    this.inner.registerToolboxCategoryCallback("KG_VARIABLES", variables);
    this.inner.registerToolboxCategoryCallback("KG_PLACES", (inner) => placesOffered(inner, this.capabilities, this.places));
    this.show({ version: 1, name: "program", body: [] });
  }

  /** Take other capabilities, and names of places: offer their blocks, and show the program again with them. */
  offer(capabilities, places) {
    this.flush();
    this.places = places;
    const { program } = this.read();
    this.capabilities = capabilities;
    defineCapabilities(this.Blockly, this.units, capabilities);
    this.inner.updateToolbox(toolbox(capabilities));
    if (program) this.show(program);
  }

  /** Return { program, problems } of the blocks. */
  read() {
    return read(this.inner, [...this.capabilities, ...(this.strangers ?? [])], this.meta);
  }

  /** Show a program, without reporting a change. */
  show(given) {
    const program = named(given, this.capabilities);
    const { name, comment, seconds } = program;
    this.meta = { name, comment, seconds };
    this.strangers = unknown(program, this.capabilities);
    defineCapabilities(this.Blockly, this.units, this.strangers);
    const { Events, serialization } = this.Blockly;
    this.lenience.on = true;
    Events.setGroup(true);
    try {
      serialization.workspaces.load(state(program, [...this.capabilities, ...this.strangers]), this.inner, { recordUndo: true });
    } finally {
      Events.setGroup(false);
      this.lenience.on = false;
    }
    this.wrap();
    this.reported = this.snapshot();
  }

  /** Put the values of wide blocks below each other, those of narrow ones next to each other. */
  wrap() {
    const { Events } = this.Blockly;
    Events.disable();
    try {
      for (const top of this.inner.getTopBlocks()) wrapped(top);
    } finally {
      Events.enable();
    }
  }

  onEvent(event) {
    super.onEvent(event);
    if (event.isUiEvent || this.wrapping) return;
    this.wrapping = setTimeout(() => {
      this.wrapping = 0;
      if (!this.inner.isDragging()) this.wrap();
    }, 0);
  }

  /** Give the program another name, without reporting a change. */
  rename(name) {
    this.flush();
    this.meta.name = name;
    this.reported = this.snapshot();
  }

  /** Put a new block for a capability after the selected one, else at the end; `parameter` is the one to read. */
  add(capability, parameter) {
    const { Blockly } = this;
    const description = capability.modality === "write" ? fresh(capability) : { type: readType(capability.name), fields: { PARAMETER: parameter } };
    return this.put(description, capability.modality === "write" ? this.end(Blockly.getSelected()) : null);
  }

  /** Put a block that goes to a named place after the selected one, else at the end. */
  addGoing(capability, name) {
    return this.put(going(capability, name), this.end(this.Blockly.getSelected()));
  }

  /** Give a place a name at the beginning of the program. */
  addPlace(name, { x, y }) {
    const place = { type: "kg_place", inputs: { X: { shadow: number(x.value, x.unit) }, Y: { shadow: number(y.value, y.unit) } } };
    return this.put(naming(name, place), this.inner.getBlocksByType("kg_start")[0]);
  }

  /** Undo or redo the last step; the program need not fit. */
  undo(redo) {
    this.lenience.on = true;
    try {
      super.undo(redo);
    } finally {
      this.lenience.on = false;
    }
  }

  /** Put a new block below another one, or, if that is null, next to the program. */
  put(description, above) {
    const { Blockly, inner } = this;
    Blockly.Events.setGroup(true);
    const block = Blockly.serialization.blocks.append(description, inner, { recordUndo: true });
    above?.nextConnection.connect(block.previousConnection);
    Blockly.Events.setGroup(false);
    if (!this.inSight(block)) inner.centerOnBlock(block.id);
    return block;
  }

  /** Return the statement behind which a new one goes. */
  end(selected) {
    const chosen = selected?.nextConnection && selected.type !== "kg_start" && selected.workspace === this.inner && selected.isEnabled() ? selected : null;
    let at = chosen ?? this.inner.getBlocksByType("kg_start")[0];
    while (!chosen && at.getNextBlock()?.nextConnection) at = at.getNextBlock();
    return at;
  }

  /** Mark the blocks that run. */
  mark(identities) {
    const running = new Set(identities);
    for (const block of this.inner.getAllBlocks()) block.getSvgRoot().classList.toggle("runs", running.has(block.id));
    const last = [...running].at(-1);
    const block = last && this.inner.getBlockById(last);
    if (block && !this.visible(block)) this.inner.scroll(this.inner.scrollX, 60 - block.getRelativeToSurfaceXY().y * this.inner.scale);
  }

  /** Adopt another size; if no block is visible, show the first. */
  resized() {
    super.resized();
    if (!this.inner.getTopBlocks().some((block) => this.inSight(block))) this.home();
  }

  /** Show the beginning of the program. */
  home() {
    this.inner.scroll(0, 0);
  }

  /** Whether the upper left corner of a block, or of one attached to it, is visible. */
  inSight(block) {
    const box = block.getSvgRoot().getBoundingClientRect();
    const room = this.inner.getParentSvg().getBoundingClientRect();
    const { width } = this.inner.getMetricsManager().getViewMetrics();
    return box.left >= room.left && box.left < room.left + width && box.bottom > room.top && box.top < room.bottom;
  }

  visible(block) {
    const box = block.getSvgRoot().getBoundingClientRect();
    const room = this.inner.getParentSvg().getBoundingClientRect();
    return box.top >= room.top && box.top <= room.bottom - 20;
  }
}
