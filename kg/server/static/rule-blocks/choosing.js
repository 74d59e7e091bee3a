// Choosing in a dialog: of things, values, properties and classes, by words; typed text can be chosen, too.

import { element } from "../table.js";

const MOST = 60;
const WAIT = 250;

export class Chooser {
  /** `parts`: dialog, title, help, field, list, count; all of them elements of the page. */
  constructor(parts) {
    this.parts = parts;
    this.done = null;
    this.turn = 0;
    this.waiting = 0;
    parts.field.addEventListener("input", () => {
      clearTimeout(this.waiting);
      this.waiting = setTimeout(() => this.draw(), parts.field.value ? WAIT / 2 : 0);
    });
    parts.field.addEventListener("keydown", (event) => this.key(event));
    parts.list.addEventListener("keydown", (event) => this.walk(event));
    parts.dialog.addEventListener("close", () => { if (!parts.dialog.open) this.end(null); });
  }

  /**
   * Return what somebody chooses, null for nothing. `find(text)` returns groups, [{ title, items }], perhaps later;
   * an item is { value, label, detail, count, comment }.
   */
  choose({ title, help = "", placeholder = "", find }) {
    const { dialog, field } = this.parts;
    this.parts.title.textContent = title;
    this.parts.help.textContent = help;
    this.parts.help.hidden = !help;
    field.placeholder = placeholder;
    field.value = "";
    this.find = find;
    this.parts.list.replaceChildren();
    this.draw();
    if (!dialog.open) dialog.showModal();
    field.focus();
    return new Promise((resolve) => { this.done = resolve; });
  }

  /** Show the choices; returns whether they are still wanted when they arrive. */
  async draw() {
    const turn = ++this.turn;
    this.parts.list.setAttribute("aria-busy", "true");
    const groups = await this.find(this.parts.field.value);
    if (turn !== this.turn) return false;
    this.parts.list.setAttribute("aria-busy", "false");
    const shown = groups.filter(({ items }) => items.length);
    this.parts.list.replaceChildren(...shown.flatMap((group) => this.group(group)));
    const many = shown.reduce((sum, { items }) => sum + items.length, 0);
    this.parts.count.textContent = many ? `${many} to choose from` : "Nothing like that is known.";
    return true;
  }

  group({ title, items }) {
    const list = element("ul", { className: "plain" }, ...items.slice(0, MOST).map((item) => element("li", {}, this.item(item))));
    return [element("h3", {}, title), list];
  }

  item({ value, label, detail = "", count = null, comment = "" }) {
    const button = element("button", { type: "button", className: "rule-choice" },
      element("span", { className: "rule-choice-label" }, label),
      element("span", { className: "rule-choice-detail" }, [detail, count === null ? "" : count.toLocaleString("en")].filter(Boolean).join(" · ")),
      comment ? element("span", { className: "rule-choice-comment" }, comment) : null);
    button.addEventListener("click", () => { this.end(value); });
    return button;
  }

  key(event) {
    const first = this.parts.list.querySelector("button");
    if (event.key === "ArrowDown" && first) {
      event.preventDefault();
      first.focus();
    } else if (event.key === "Enter") {
      event.preventDefault();
      clearTimeout(this.waiting);
      this.draw().then((wanted) => wanted && this.parts.list.querySelector("button")?.click());
    }
  }

  walk(event) {
    if (event.key !== "ArrowDown" && event.key !== "ArrowUp") return;
    event.preventDefault();
    const all = [...this.parts.list.querySelectorAll("button")];
    const next = all.indexOf(document.activeElement) + (event.key === "ArrowDown" ? 1 : -1);
    (all[next] ?? (next < 0 ? this.parts.field : all.at(-1))).focus();
  }

  end(value) {
    const { done } = this;
    this.done = null;
    clearTimeout(this.waiting);
    this.turn += 1;
    this.parts.list.setAttribute("aria-busy", "false");
    if (this.parts.dialog.open) this.parts.dialog.close();
    done?.(value);
  }
}

/** Return the items whose label, detail or comment has all words of a text; those that begin with it first. */
export function matching(items, text) {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  if (!words.length) return items;
  const hay = (item) => `${item.label} ${item.detail ?? ""} ${item.comment ?? ""}`.toLowerCase();
  const rank = (item) => (item.label.toLowerCase().startsWith(words[0]) ? 0 : item.label.toLowerCase().includes(words[0]) ? 1 : 2);
  return items.filter((item) => words.every((word) => hay(item).includes(word))).sort((one, other) => rank(one) - rank(other));
}
