// Output of the page: problems of the program, errors, the log, and current values.

import { element } from "../table.js";

const MOST = 300;

/** Return a text whose parts between backticks are code. */
export function prose(text) {
  return text.split("`").map((part, index) => (index % 2 ? element("code", {}, part) : part));
}

export class Output {
  constructor(parts) {
    this.parts = parts;
    this.rows = new Map();
  }

  /** Show an error, which replaces the previous one. */
  problem({ code, message, hint, docs }) {
    this.clearProblem();
    const notice = element("div", { className: "notice error" }, element("p", {}, element("strong", {}, ...prose(message))),
      element("p", {}, docs ? element("a", { href: docs }, code) : code ?? "", " ", ...prose(hint ?? "")));
    notice.setAttribute("role", "alert");
    notice.dataset.error = "";
    this.parts.notices.append(notice);
  }

  clearProblem() {
    this.parts.notices.querySelector("[data-error]")?.remove();
  }

  /** List the problems of the program; `go` leads to the place of one. */
  problems(all, go) {
    this.parts.problems.hidden = !all.length;
    this.parts.problems.replaceChildren(...all.map((problem) => {
      const where = element("button", { type: "button", className: "link" }, problem.line ? `line ${problem.line}` : "show");
      where.setAttribute("aria-label", `Go to ${where.textContent}: ${problem.message}`);
      where.addEventListener("click", () => go(problem));
      return element("li", {}, ...prose(problem.message), " ", where, problem.hint ? element("small", {}, ...prose(problem.hint)) : null);
    }));
  }

  /** Add a line to the log. */
  log(text, kind = "") {
    const { log } = this.parts;
    const end = log.scrollHeight - log.scrollTop - log.clientHeight < 40;
    const time = element("time", {}, new Date().toLocaleTimeString("en-GB"));
    log.append(element("div", { className: kind }, time, text));
    while (log.childElementCount > MOST) log.firstElementChild.remove();
    if (end) log.scrollTop = log.scrollHeight;
  }

  /** Show the newest values of a capability. */
  value({ capability, value, problem }, capabilities) {
    const about = capabilities.find(({ name, modality }) => name === capability && modality === "read");
    const row = this.row(capability, about?.label ?? capability);
    row.latest = { ...row.latest, ...value };
    row.textContent = problem ? problem.message : Object.entries(row.latest).map(([name, one]) => valueText(name, one, about)).join(", ");
  }

  /** Show the newest value of a variable. */
  variable({ variable, shown }) {
    this.row(`variable ${variable}`, variable).textContent = shown;
  }

  row(key, label) {
    let row = this.rows.get(key);
    if (!row) {
      row = element("dd");
      this.rows.set(key, row);
      this.parts.none.hidden = true;
      this.parts.values.append(element("dt", {}, label), row);
    }
    return row;
  }
}

function valueText(name, value, about) {
  const parameter = about?.parameters.find((one) => one.name === name);
  const shown = typeof value === "number" ? String(Math.round(value * 1000) / 1000) : typeof value === "object" ? short(value) : String(value);
  return `${parameter?.label ?? name} ${shown}${parameter?.unit ? ` ${parameter.unit}` : ""}`;
}

function short(value) {
  const text = JSON.stringify(value);
  return text.length > 80 ? `${text.slice(0, 79)}…` : text;
}
