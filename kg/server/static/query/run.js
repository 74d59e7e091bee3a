// A query that runs: how long it has been, how many rows there are so far, and its end when nobody wants to wait.

import { cancel, identity, job } from "./services.js";

const TICK = 100;
const POLL = 500;

export class Run {
  constructor({ run, cancel: stop, progress }) {
    Object.assign(this, { button: run, stop, progress, job: null, unwanted: false, began: 0, ended: 0, rows: null });
    stop.addEventListener("click", () => this.end());
    stop.addEventListener("keydown", (event) => { if (event.key === "Escape") this.end(); });
  }

  get running() { return this.job !== null; }

  /** Return the seconds that the query took, or has taken so far. */
  seconds() {
    return (((this.ended || performance.now()) - this.began) / 1000).toFixed(this.ended - this.began < 1000 ? 2 : 1);
  }

  say(words) { this.progress.textContent = words; }

  /** Return the result of `work(job)`; meanwhile show its progress. */
  async during(work) {
    const own = identity();
    this.job = own;
    this.unwanted = false;
    this.began = performance.now();
    this.ended = 0;
    this.rows = null;
    this.show(true);
    const clock = setInterval(() => this.tick(), TICK);
    const poll = setInterval(() => this.look(own), POLL);
    try {
      return await work(own);
    } finally {
      this.ended = performance.now();
      clearInterval(clock);
      clearInterval(poll);
      this.job = null;
      this.show(false);
    }
  }

  /** End the query. */
  end() {
    if (!this.job) return;
    this.unwanted = true;
    cancel(this.job);
  }

  /** Request the progress of a query. A cancelled one is cancelled again: the server may have received that before the query. */
  async look(own) {
    if (this.unwanted) return void await cancel(own);
    const rows = (await job(own))?.rows;
    if (own === this.job) this.rows = rows ?? this.rows;
  }

  show(runs) {
    const focused = document.activeElement === (runs ? this.button : this.stop);
    this.button.disabled = runs;
    this.stop.hidden = !runs;
    if (focused) (runs ? this.stop : this.button).focus();
  }

  tick() {
    if (!this.job) return;
    const rows = this.rows ? `, ${this.rows.toLocaleString("en")} rows so far` : "";
    this.say(`${((performance.now() - this.began) / 1000).toFixed(1)} s${rows}`);
  }
}
