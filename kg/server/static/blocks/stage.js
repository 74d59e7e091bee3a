// Common to all workspaces of blocks: report changes, mark blocks, go to one, zoom, undo.

import { adoptStyles, MEDIA } from "./loading.js";
import { theme, whenChanged } from "./look.js";

// How near a block has to come to another to be joined to it: with Blockly's own values, people drop blocks next to the rest.
const SNAPS = { snapRadius: 72, connectingSnapRadius: 88 };
const QUIET = 150;

/** Wait a moment. */
export const pause = () => new Promise((resolve) => { setTimeout(resolve, QUIET); });

/** Subclasses define `read()`, the content of the blocks, and set `reported` to `snapshot()` after showing something. */
export class Stage {
  /** `changed` is called after edits, `loose` with the number of loose pieces; call `inject` once the blocks are defined. */
  constructor(Blockly, { changed, loose }) {
    Object.assign(this, { Blockly, changed, loose });
    this.inner = null;
    this.reported = "";
    this.waiting = 0;
    adoptStyles();
    Object.assign(Blockly.config, SNAPS);
    Blockly.ShortcutItems.registerNavigationShortcuts?.();
  }

  /** Put Blockly's own workspace into `host`, with a connection checker and a toolbox. */
  inject(host, checker, toolbox) {
    const { Blockly } = this;
    this.inner = Blockly.inject(host, {
      plugins: { connectionChecker: checker },
      toolbox, toolboxPosition: "end", renderer: "zelos", theme: theme(Blockly), media: MEDIA, sounds: false, trashcan: false,
      zoom: { controls: false, wheel: false, pinch: true, startScale: 0.75, minScale: 0.4, maxScale: 1.5 }, move: { wheel: true },
    });
    this.inner.addChangeListener(Blockly.Events.disableOrphans);
    this.inner.addChangeListener((event) => this.onEvent(event));
    whenChanged(() => this.inner.setTheme(theme(Blockly)));
    new ResizeObserver(() => this.resized()).observe(host);
  }

  onEvent(event) {
    if (event.isUiEvent) return;
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => {
      this.loose(this.inner.getTopBlocks().length - 1);
      this.flush();
    }, QUIET);
  }

  /** Report a pending edit at once, before something else is shown or run in its place. */
  flush() {
    const now = this.snapshot();
    if (now === this.reported) return;
    this.reported = now;
    this.changed();
  }

  /** Wait until no block, or word of one, is being edited: showing the program again would remove it. */
  async still() {
    while (this.isEditing()) await pause();
  }

  /** Whether the user drags a block, or edits a field of one. */
  isEditing() {
    const { DropDownDiv, WidgetDiv } = this.Blockly;
    return this.inner.isDragging() || WidgetDiv.isVisible() || DropDownDiv.isVisible();
  }

  /** Return the content of the blocks, to compare: showing and moving blocks cause events, too. */
  snapshot() {
    return JSON.stringify(this.read());
  }

  /** Adopt another size; the left edge stays. */
  resized() {
    const { inner } = this;
    const { scrollX, scrollY } = inner;
    this.Blockly.svgResize(inner);
    inner.scroll(scrollX, scrollY);
  }

  /** Show problems, { id, message }, at their blocks. */
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
