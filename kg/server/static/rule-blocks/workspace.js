// The workspace of blocks: it shows a rule, reports edits, and marks blocks.

import { load } from "../blocks/loading.js";
import { pause, Stage } from "../blocks/stage.js";
import { define } from "./blocks.js";
import { read } from "./reading.js";
import { packed, unpacked } from "./terms.js";
import { toolbox } from "./toolbox.js";
import { state } from "./writing.js";

/** Return a workspace in `host`, or null where the libraries of the pages were not built. */
export async function workspace(host, options) {
  const Blockly = await load();
  if (!Blockly) return null;
  options.ready();
  return new Workspace(Blockly, host, options);
}

class Workspace extends Stage {
  /**
   * `moved` is called when blocks change, `changed` after edits, `loose` with how many pieces hang loose; `choosing()` tells
   * whether somebody chooses what a block is to say; `offering(workspace)` makes what chooses.
   */
  constructor(Blockly, host, { vocabulary, offering, edit, changed, loose, moved, choosing }) {
    super(Blockly, { changed, loose });
    this.vocabulary = vocabulary;
    this.choosing = choosing;
    define(Blockly, { vocabulary, offering, edit, rename: (old, other) => this.rename(old, other) });
    this.inject(host, this.checker(), toolbox(vocabulary));
    this.inner.addChangeListener((event) => { if (!event.isUiEvent) moved(); });
    this.show({ when: [], then: [] });
  }

  isEditing() {
    return super.isEditing() || this.choosing();
  }

  /**
   * Return what checks connections: conclusions are facts, and a term stands where the ontology lets it. That holds for
   * what is in somebody's hand; what is shown, copied or brought back is as it was, and what is wrong with it is told.
   */
  checker() {
    const own = this;
    return class extends this.Blockly.ConnectionChecker {
      doDragChecks(one, other, distance) {
        return super.doDragChecks(one, other, distance) && own.fits(one, other) && own.fits(other, one);
      }
    };
  }

  /** Whether a block below or inside a connection may stand there. */
  fits(above, below) {
    const [parent, child] = [above.getSourceBlock(), below.getSourceBlock()];
    if (above.isSuperior() && !["kr_fact", "kr_is"].includes(child.type) && this.concludes(above)) return false;
    if (!above.isSuperior() || parent.type !== "kr_fact" || child.type !== "kr_term") return true;
    const side = above.getParentInput()?.name === "SUBJECT" ? "from" : "to";
    return this.takes(parent, side, unpacked(child.getFieldValue("TERM")));
  }

  /** Whether a block at a connection becomes a conclusion. */
  concludes(connection) {
    for (let at = connection; at;) {
      const block = at.getSourceBlock();
      if (block.type === "kr_rule") return at.getParentInput()?.name === "THEN";
      at = block.previousConnection?.targetConnection;
    }
    return false;
  }

  /** Whether a term may stand on a side of a fact. */
  takes(fact, side, term) {
    const property = this.vocabulary.byProperty.get(fact.getFieldValue("PROPERTY"));
    const value = ["text", "number", "truth"].includes(term.term);
    if (side === "from" && value) return false;
    if (!property || term.term === "name") return !(side === "to" && property?.literal);
    if (value) return property.literal || !property.to.length;
    return this.vocabulary.fits(property.name, side, this.vocabulary.kinds(this.read(), fact.id).get(term.name));
  }

  /** Return { when, then, problems } of the blocks. */
  read() {
    return read(this.inner);
  }

  /** Show a rule, without reporting a change. */
  show(rule) {
    const { Events, serialization } = this.Blockly;
    Events.setGroup(true);
    try {
      serialization.workspaces.load(state(rule), this.inner, { recordUndo: true });
    } finally {
      Events.setGroup(false);
    }
    this.reported = this.snapshot();
    this.loose(0);
  }

  /** Take the vocabulary of the store, once nobody browses the toolbox. */
  async know(vocabulary) {
    await this.still();
    while (this.inner.getFlyout()?.isVisible()) {
      await pause();
      await this.still();
    }
    Object.assign(this.vocabulary, vocabulary);
    this.inner.updateToolbox(toolbox(this.vocabulary));
    for (const block of this.inner.getAllBlocks()) for (const field of block.getFields()) field.refresh?.();
  }

  /** Give a thing another name, in all its places. */
  rename(old, other) {
    const { Events } = this.Blockly;
    Events.setGroup(true);
    for (const block of this.inner.getAllBlocks()) {
      for (const name of ["TERM", "NAME"]) {
        const value = block.getField(name)?.getValue();
        if (value?.startsWith("{") && unpacked(value).name === old && unpacked(value).term === "thing") block.setFieldValue(packed({ term: "thing", name: other }), name);
      }
    }
    Events.setGroup(false);
  }
}
