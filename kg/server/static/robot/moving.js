// Running, pausing and stopping, by buttons and keys; manual driving sends a sign of life to the server.

const HERE = 1000;

export class Moving {
  constructor(parts, { run, ask, listener }) {
    Object.assign(this, { parts, ask, listener });
    this.isReady = false;
    this.state = "none";
    this.hands = 0;
    this.beat = 0;
    this.words = "";
    parts.run.addEventListener("click", () => run());
    parts.pause.addEventListener("click", () => this.ask(this.state === "paused" ? "resume" : "pause"));
    parts.stop.addEventListener("click", () => this.stopAll());
    // Before all other listeners: a dialog or a field may consume keys, but not this one while the robot moves.
    window.addEventListener("keydown", (event) => {
      if (event.key === "Escape" && this.moves) {
        event.preventDefault();
        event.stopImmediatePropagation();
        this.stopAll();
      } else if (event.key === "Enter" && (event.ctrlKey || event.metaKey) && !event.target.closest?.(".robot-blocks")) {
        event.preventDefault();
        run();
      }
    }, { capture: true });
  }

  /** Whether anything moves, or may. */
  get moves() { return this.state === "running" || this.state === "paused" || this.hands > 0; }

  ready(yes, why) {
    this.isReady = yes;
    this.parts.run.title = yes ? "Run the program (Ctrl Enter)" : why;
    this.draw();
  }

  /** Take the state of the program from the server; its end is reported when it happens. */
  program({ state, name }, said = true) {
    this.state = state;
    this.name = name;
    if (this.words && (state === "running" || state === "paused")) this.at([this.words]);
    else this.words = "";
    if (!this.moves) this.parts.running.textContent = said ? { done: "Done", failed: "Failed", stopped: "Stopped" }[state] ?? "" : "";
    this.draw();
  }

  /** Show the current action. */
  at(words) {
    this.words = words.at(-1) ?? "…";
    this.parts.running.textContent = `${this.state === "paused" ? "Pauses at" : "Now"}: ${this.words}`;
  }

  draw() {
    const { run, pause } = this.parts;
    const busy = this.state === "running" || this.state === "paused";
    run.disabled = !this.isReady || busy;
    pause.disabled = !busy;
    pause.textContent = this.state === "paused" ? "Go on" : "Pause";
  }

  /** Do something by hand. */
  hand(capability, values, seconds) {
    return this.ask("do", { listener: this.listener(), capability: capability.name, arguments: values, ...(seconds === null ? {} : { seconds }) });
  }

  /** Take the state of manual actions from the server. */
  handed({ state, own }, label) {
    this.hands = Math.max(0, this.hands + (state === "doing" ? 1 : -1));
    if (state === "doing") this.parts.running.textContent = `By hand: ${label}`;
    else if (!this.moves) this.parts.running.textContent = "";
    clearInterval(this.beat);
    if (own && this.hands) this.beat = setInterval(() => this.ask("here", { listener: this.listener() }), HERE);
    this.draw();
  }

  stop() { return this.stopAll(); }

  stopAll() {
    this.parts.running.textContent = "Stopping …";
    return this.ask("stop");
  }
}
