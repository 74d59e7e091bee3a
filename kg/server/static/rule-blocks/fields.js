// Fields of blocks that open a dialog: for a term, a property, a class, a piece of SPARQL.

/** Return the class of such fields. `display(value)` returns the text on the block, `open(field)` changes the value. */
export function chosenField(Blockly) {
  return class extends Blockly.Field {
    constructor(value, { display, open, tip }) {
      super(Blockly.Field.SKIP_SETUP);
      this.SERIALIZABLE = true;
      this.EDITABLE = true;
      this.CURSOR = "pointer";
      this.display = display;
      this.opened = open;
      this.setTooltip(() => tip?.(this.getValue()) ?? "");
      this.setValue(value);
    }

    getText_() { return this.display(this.getValue()); }

    /** Show the label of the value, which may be new in the vocabulary. */
    refresh() { this.forceRerender(); }

    showEditor_() { this.opened(this); }
  };
}
