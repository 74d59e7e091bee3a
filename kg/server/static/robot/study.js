// The study of the onto-ros paper (section 4.3): tasks one after the other, with a clock, attempts, and results as CSV.

import { file } from "../blocks/storage.js";

const COLUMNS = ["participant", "robot", "exercise", "title", "seconds", "attempts", "ended", "blocks", "capabilities", "program"];
const KEY = "kg-robot-study";

/** Return how many blocks a program has, and how many capabilities it uses, as `kg robot convert --metrics` counts them. */
export function counted(program) {
  let blocks = 0;
  const used = new Set();
  const look = (part) => {
    if (Array.isArray(part)) part.forEach(look);
    else if (part && typeof part === "object") {
      if (part.block) blocks += 1;
      if (part.capability) used.add(part.capability);
      Object.values(part).forEach(look);
    }
  };
  look(program.body ?? []);
  return { blocks, capabilities: used.size };
}

/** Return rows as CSV (RFC 4180). */
export function csv(rows) {
  const cell = (value) => (/[",\r\n]/.test(String(value)) ? `"${String(value).replaceAll('"', '""')}"` : String(value));
  return [COLUMNS, ...rows.map((row) => COLUMNS.map((name) => row[name]))].map((row) => `${row.map(cell).join(",")}\r\n`).join("");
}

export class Study {
  /** `parts` are the elements of the page, `exercises` those of the server; `clear` empties the program. */
  constructor(parts, exercises, clear) {
    Object.assign(this, { parts, exercises, clear, row: null, running: null, begun: 0, ticking: 0 });
    this.rows = this.load();
    parts.start.addEventListener("submit", () => this.begin());
    // A dialog that closes moves the focus back to the button that opened it.
    parts.dialog.addEventListener("close", () => { if (this.row && !this.begun) parts.read.focus(); });
    parts.read.addEventListener("click", () => this.clock());
    parts.next.addEventListener("click", () => this.next());
    parts.end.addEventListener("click", () => this.end());
    parts.again.addEventListener("click", () => { this.rows = []; this.save(); this.results(); });
    this.results();
  }

  begin() {
    const { participant, robot } = this.parts;
    this.participant = participant.value.trim() || "1";
    this.robot = robot.value;
    this.at = -1;
    this.parts.panel.hidden = false;
    this.next();
  }

  /** Store the result, and show the next task. */
  next() {
    this.put();
    this.at += 1;
    if (this.at >= this.exercises.length) {
      this.end();
      return;
    }
    const { number, title, tasks } = this.exercises[this.at];
    this.row = { participant: this.participant, robot: this.robot, exercise: number, title, seconds: "", attempts: 0, ended: "", blocks: 0, capabilities: 0, program: "" };
    this.begun = 0;
    this.clear();
    const { task, read, next, clock } = this.parts;
    task.textContent = `${number}. ${title}: ${tasks[this.robot]}`;
    clock.textContent = "The clock starts when you have read the task.";
    read.hidden = false;
    next.disabled = true;
    next.textContent = this.at + 1 < this.exercises.length ? "Next task" : "Finish";
    if (!this.parts.dialog.open) read.focus();
  }

  /** Start the clock: the task was read. */
  clock() {
    this.begun = performance.now();
    this.parts.read.hidden = true;
    this.tick();
    this.ticking = setInterval(() => this.tick(), 1000);
  }

  tick() {
    const seconds = Math.floor((performance.now() - this.begun) / 1000);
    const tries = this.row.attempts === 1 ? "1 attempt" : `${this.row.attempts} attempts`;
    this.parts.clock.textContent = `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, "0")}, ${tries}`;
  }

  /** Record that a program is about to run: it may end before the server answers. Returns a function that undoes it. */
  starts() {
    const row = this.begun ? this.row : null;
    if (!row) return () => {};
    const { ended } = row;
    row.ended = "";
    this.running = row;
    return () => {
      row.ended = ended;
      this.running = null;
    };
  }

  /** Record the run of a program: the time of a task ends with its last execution. */
  ran(program, text) {
    if (!this.row || !this.begun) return;
    this.row.attempts += 1;
    Object.assign(this.row, { seconds: ((performance.now() - this.begun) / 1000).toFixed(1), program: text, ...counted(program) });
    this.tick();
    this.parts.next.disabled = false;
  }

  /** Record the end of the program for its task, which may be over. */
  ended(state) {
    if (!this.running) return;
    this.running.ended = state;
    this.running = null;
    this.save();
    this.results();
  }

  put() {
    clearInterval(this.ticking);
    if (this.row?.attempts) this.rows.push(this.row);
    this.row = null;
    this.save();
    this.results();
  }

  end() {
    this.put();
    this.parts.panel.hidden = true;
    this.parts.open();
  }

  results() {
    const { download, found, again } = this.parts;
    found.textContent = this.rows.length ? `${this.rows.length} ${this.rows.length === 1 ? "result is" : "results are"} kept in this browser.` : "No results yet.";
    again.hidden = !this.rows.length;
    download.replaceChildren(...(this.rows.length ? [Object.assign(file("study.csv", csv(this.rows), "text/csv"), { textContent: "Save results as CSV" })] : []));
  }

  load() {
    try {
      return JSON.parse(localStorage.getItem(KEY) ?? "[]");
    } catch {
      return [];
    }
  }

  save() {
    try {
      localStorage.setItem(KEY, JSON.stringify(this.rows));
    } catch {
      // Storage may be forbidden or full; the results hold until the page is left.
    }
  }
}
