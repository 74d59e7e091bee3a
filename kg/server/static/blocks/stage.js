// What every workspace of blocks does: tell of changes, mark blocks, go to one, show more or less, take back.

import { adoptStyles, MEDIA } from "./loading.js";
import { theme, whenChanged } from "./look.js";

// How near a block has to come to another to be joined to it: as near as Blockly wants it, people drop blocks beside the rest.
const SNAPS = { snapRadius: 72, connectingSnapRadius: 88 };
const QUIET = 150;

/** Wait a moment. */
export const pause = () => new Promise((resolve) => { setTimeout(resolve, QUIET); });

/** Whoever extends this has `read()`, what the blocks say, and notes in `known` what is `told()` once it has shown something. */
export class Stage {
  /** `changed` is called after edits, `loose` with how many pieces hang loose; `inject` comes when the blocks are defined. */
  constructor(Blockly, { changed, loose }) {
    Object.assign(this, { Blockly, changed, loose });
    this.inner = null;
    this.known = "";
    this.waiting = 0;
    adoptStyles();
    Object.assign(Blockly.config, SNAPS);
    Blockly.ShortcutItems.registerNavigationShortcuts?.();
  }

  /** Put Blockly's own workspace into `host`, with what checks connections and what blocks are offered. */
  inject(host, checker, toolbox) {
    const { Blockly } = this;
    this.inner = Blockly.inject(host, {
      plugins: { connectionChecker: checker },
      toolbox, toolboxPosition: "end", renderer: "zelos", theme: theme(Blockly), media: MEDIA, sounds: false, trashcan: false,
      zoom: { controls: false, wheel: false, pinch: true, startScale: 0.75, minScale: 0.4, maxScale: 1.5 }, move: { wheel: true },
    });
    this.inner.addChangeListener(Blockly.Events.disableOrphans);
    this.inner.addChangeListener((event) => this.heard(event));
    whenChanged(() => this.inner.setTheme(theme(Blockly)));
    new ResizeObserver(() => this.resized()).observe(host);
  }

  heard(event) {
    if (event.isUiEvent) return;
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => {
      this.loose(this.inner.getTopBlocks().length - 1);
      this.settle();
    }, QUIET);
  }

  /** Tell at once of an edit that was not told yet, before something else is shown or run in its place. */
  settle() {
    const now = this.told();
    if (now === this.known) return;
    this.known = now;
    this.changed();
  }

  /** Wait until nobody has a block in the hand, a word of one included: what is shown anew would take it away. */
  async still() {
    while (this.held()) await pause();
  }

  /** Whether somebody drags a block, or chooses or writes what one is to say. */
  held() {
    const { DropDownDiv, WidgetDiv } = this.Blockly;
    return this.inner.isDragging() || WidgetDiv.isVisible() || DropDownDiv.isVisible();
  }

  /** Return what the blocks say, to compare: events also come of what was shown, and of blocks that only moved. */
  told() {
    return JSON.stringify(this.read());
  }

  /** Take another size; what was seen at the left stays there. */
  resized() {
    const { inner } = this;
    const { scrollX, scrollY } = inner;
    this.Blockly.svgResize(inner);
    inner.scroll(scrollX, scrollY);
  }

  /** Show what is wrong, { id, message }, at its blocks. */
  complain(findings) {
    const said = new Map();
    for (const { id, message } of findings) if (id) said.set(id, [...(said.get(id) ?? []), message]);
    for (const block of this.inner.getAllBlocks()) {
      const text = said.get(block.id)?.join("\n") ?? null;
      if ((block.kgWarning ?? null) !== text) block.setWarningText(text);
      block.kgWarning = text;
    }
  }

  /** Go to a block; returns whether there is one. */
  go(id) {
    const block = this.inner.getBlockById(id);
    if (!block) return false;
    this.inner.centerOnBlock(id);
    this.Blockly.getFocusManager().focusNode(block);
    return true;
  }

  zoom(step) {
    if (step) this.inner.zoomCenter(step);
    else this.inner.zoomToFit();
  }

  undo(redo) { this.inner.undo(redo); }
}
