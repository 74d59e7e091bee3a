// The queries that are open, as tabs. Each window has its own; a new one begins with those that were changed last.

import { element } from "../table.js";
import { load, save } from "./storage.js";

/** Tabs in `host`; `shown(text)` receives the text of the chosen one. */
export class Tabs {
  constructor(host, { add, close, shown }) {
    Object.assign(this, { host, shown });
    const found = load("tabs", null, { own: true });
    this.tabs = Array.isArray(found?.tabs) && found.tabs.length ? found.tabs : [{ name: "Query 1", text: "" }];
    this.active = Math.min(Math.max(found?.active ?? 0, 0), this.tabs.length - 1);
    add.addEventListener("click", () => this.open(""));
    close.addEventListener("click", () => this.close());
    host.addEventListener("keydown", (event) => this.key(event));
    host.parentElement.hidden = false;
    this.draw();
  }

  get current() { return this.tabs[this.active]; }

  name() {
    const numbers = this.tabs.map((tab) => Number(/^Query (\d+)$/.exec(tab.name)?.[1] ?? 0));
    return `Query ${Math.max(0, ...numbers) + 1}`;
  }

  /**
   * Show a text: in the tab that has it already, else the tab that the same `link` opened before, as it was changed since,
   * else in this one when it is empty, else in a new one.
   */
  open(text, name, link) {
    const opened = link ? this.tabs.findIndex((tab) => tab.link === link) : -1;
    const same = text ? this.tabs.findIndex((tab) => tab.text === text) : -1;
    if (opened >= 0 || same >= 0) this.active = same >= 0 ? same : opened;
    else if (text && !this.current.text.trim()) Object.assign(this.current, { text, name: name ?? this.current.name });
    else this.active = this.tabs.push({ name: name ?? this.name(), text }) - 1;
    if (link) this.current.link = link;
    this.changed();
  }

  /** Note the text of the tab that is shown. */
  write(text) {
    this.current.text = text;
    this.save();
  }

  close() {
    this.tabs.splice(this.active, 1);
    if (!this.tabs.length) this.tabs.push({ name: "Query 1", text: "" });
    this.active = Math.min(this.active, this.tabs.length - 1);
    this.changed();
  }

  choose(index, focus = false) {
    this.active = (index + this.tabs.length) % this.tabs.length;
    this.changed();
    if (focus) this.host.querySelector("[aria-selected=true]").focus();
  }

  key(event) {
    const to = { ArrowLeft: this.active - 1, ArrowRight: this.active + 1, Home: 0, End: this.tabs.length - 1 }[event.key];
    if (to !== undefined) this.choose(to, true);
    else if (event.key === "Delete") { this.close(); this.choose(this.active, true); }
    else return;
    event.preventDefault();
  }

  changed() {
    this.save();
    this.draw();
    this.shown(this.current.text);
  }

  save() { save("tabs", { tabs: this.tabs, active: this.active }, { own: true }); }

  draw() {
    this.host.replaceChildren(...this.tabs.map((tab, index) => {
      const chosen = index === this.active;
      const button = element("button", { type: "button", tabIndex: chosen ? 0 : -1 }, tab.name);
      button.setAttribute("role", "tab");
      button.setAttribute("aria-selected", String(chosen));
      button.setAttribute("aria-controls", "editor");
      button.addEventListener("click", () => this.choose(index));
      return button;
    }));
  }
}
