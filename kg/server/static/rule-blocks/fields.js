// Fields of blocks that open a dialog: for a term, a property, a class, a piece of SPARQL.

/** Return the class of such fields. `told(value)` is what the block shows, `open(field)` changes the value. */
export function chosenField(Blockly) {
  return class extends Blockly.Field {
    constructor(value, { told, open, tip }) {
      super(Blockly.Field.SKIP_SETUP);
      this.SERIALIZABLE = true;
      this.EDITABLE = true;
      this.CURSOR = "pointer";
      this.told = told;
      this.opened = open;
      this.setTooltip(() => tip?.(this.getValue()) ?? "");
      this.setValue(value);
    }

    getText_() { return this.told(this.getValue()); }

    /** Show what the value is called, which the vocabulary may have come to know. */
    refresh() { this.forceRerender(); }

    showEditor_() { this.opened(this); }
  };
}
