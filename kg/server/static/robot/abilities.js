// The left side: the capabilities of the robot, by groups, with a search, each to be tried at once.

import { element } from "../table.js";
import { GROUPS, groupOf } from "./kinds.js";
import { lasts } from "./capable.js";
import { proofs } from "./proving.js";

/** The list of capabilities. `act` has do(capability, values, seconds), end(), follow(capability, on), add(capability, parameter). */
export class Abilities {
  constructor({ list, filter, found, act }) {
    Object.assign(this, { list, filter, found, act });
    this.all = [];
    this.followed = new Set();
    this.mayMove = false;
    filter.addEventListener("input", () => this.draw());
  }

  /** Show other capabilities; open entries stay open, and fields keep their content. */
  show(capabilities, { mayMove, blocks }) {
    this.all = capabilities;
    this.mayMove = mayMove;
    this.blocks = blocks;
    this.draw();
  }

  draw() {
    const open = new Set([...this.list.querySelectorAll("details[open]")].map((one) => one.dataset.key));
    const written = new Map([...this.list.querySelectorAll("[data-field]")].map((one) => [one.id, one.type === "checkbox" ? one.checked : one.value]));
    const focus = document.activeElement?.id;
    const words = this.filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const shown = this.all.filter((one) => fits(one, words));
    const groups = GROUPS.map((group) => [group, shown.filter((one) => groupOf(one) === group)]).filter(([, members]) => members.length);
    this.list.replaceChildren(...groups.flatMap(([group, members]) => [
      element("h3", {}, group.title), ...members.map((one) => this.entry(one, group)),
    ]));
    if (!shown.length) this.list.append(element("p", { className: "quiet-text" }, this.all.length ? "Nothing that fits these words." : "Nothing yet. The robot offers nothing that we understand."));
    for (const one of this.list.querySelectorAll("details")) one.open = open.has(one.dataset.key) || (one.matches(".robot-ability") && words.length > 0 && shown.length < 3);
    for (const one of this.list.querySelectorAll("[data-field]")) {
      if (!written.has(one.id)) continue;
      if (one.type === "checkbox") one.checked = written.get(one.id);
      else one.value = written.get(one.id);
    }
    if (focus) document.getElementById(focus)?.focus();
    this.found.textContent = words.length ? `${shown.length} found` : "";
  }

  entry(capability, group) {
    const key = `${capability.modality}-${capability.name}`;
    const node = element("details", { className: `robot-ability ${group.style}` }, element("summary", { id: `${key}-summary` }, capability.label, capability.unavailable ? element("small", { className: "quiet-text" }, " (not now)") : null));
    node.dataset.key = key;
    const idle = capability.unavailable ? element("p", { className: "notice warning" }, `Not available now: ${capability.unavailable}.`) : null;
    const body = element("div", {}, capability.comment ? element("p", {}, capability.comment) : null, idle);
    if (capability.modality === "write") body.append(this.form(capability, key));
    else body.append(this.reading(capability, key));
    body.append(why(capability, key));
    node.append(body);
    return node;
  }

  form(capability, key) {
    const fields = capability.parameters.map((parameter) => field(parameter, `${key}-${parameter.name}`));
    const time = lasts(capability) ? field({ name: "seconds", label: "for how long", type: "number", unit: "s", default: 1, minimum: 0.1, maximum: 60 }, `${key}-for`) : null;
    const form = element("form", {}, ...fields.map(({ holder }) => holder), time?.holder ?? null);
    const go = element("button", { className: "primary", disabled: !this.mayMove || Boolean(capability.unavailable), id: `${key}-do` }, "Do it now");
    const end = element("button", { type: "button", id: `${key}-end` }, "Stop");
    end.addEventListener("click", () => this.act.end());
    form.append(element("div", { className: "row" }, go, end, this.blocks ? this.adder(capability, key) : null));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const values = Object.fromEntries(fields.map(({ name, value }) => [name, value()]).filter(([, value]) => value !== null));
      this.act.do(capability, values, time?.value() ?? null);
    });
    return form;
  }

  reading(capability, key) {
    const follow = element("button", { type: "button", id: `${key}-follow` }, "Show live values");
    follow.setAttribute("aria-pressed", String(this.followed.has(capability.name)));
    follow.addEventListener("click", () => {
      const on = !this.followed.has(capability.name);
      if (on) this.followed.add(capability.name);
      else this.followed.delete(capability.name);
      follow.setAttribute("aria-pressed", String(on));
      this.act.follow([...this.followed]);
    });
    const list = element("ul", {}, ...capability.parameters.map((one) => element("li", {}, element("strong", {}, one.unit ? `${one.label} (${one.unit})` : one.label),
      one.comment ? `: ${one.comment}` : "", " ", this.blocks ? this.adder(capability, `${key}-${one.name}`, one.name) : null)));
    return element("div", {}, list, element("p", {}, follow));
  }

  adder(capability, key, parameter) {
    const node = element("button", { type: "button", id: `${key}-add`, title: "Put a block for this into the program" }, "Add block");
    if (parameter) node.className = "link";
    const called = parameter ? `${capability.label}, ${capability.parameters.find(({ name }) => name === parameter).label}` : capability.label;
    node.setAttribute("aria-label", `Add block: ${called}`);
    node.addEventListener("click", () => this.act.add(capability, parameter));
    return node;
  }
}

function fits(capability, words) {
  const parameters = (capability.parameters ?? []).flatMap(({ name, label }) => [name, label]);
  const text = [capability.name, capability.label, capability.comment, ...(capability.alternatives ?? []), ...capability.kinds, ...parameters].join(" ").toLowerCase();
  return words.every((word) => text.includes(word));
}

/** Return { name, holder, value } of the field of a parameter. */
function field({ name, label, comment, type = "number", unit, default: start, minimum, maximum, choices }, id) {
  const limits = [minimum, maximum].some((one) => one !== undefined && one !== null);
  const range = limits ? `${minimum ?? "any"} to ${maximum ?? "any"}${unit ? ` ${unit}` : ""}` : "";
  let input;
  if (type === "boolean") input = element("input", { type: "checkbox", checked: start === true });
  else if (choices?.length) input = element("select", {}, ...choices.map((one) => element("option", { value: one, selected: one === start }, one)));
  else if (type === "number" || type === "integer") {
    input = element("input", { type: "number", step: type === "integer" ? "1" : "any", value: start ?? "", required: start === undefined || start === null });
    if (minimum !== undefined && minimum !== null) input.min = minimum;
    if (maximum !== undefined && maximum !== null) input.max = maximum;
  } else input = element("input", { type: "text", value: start ?? "" });
  input.id = id;
  input.dataset.field = name;
  const named = element("label", {}, unit ? `${label} (${unit})` : label);
  named.htmlFor = id;
  const said = element("span", { className: "limits", id: `${id}-limits` }, [range, comment].filter(Boolean).join(" · "));
  if (said.textContent) input.setAttribute("aria-describedby", said.id);
  return { name, holder: element("div", { className: "field" }, named, input, said.textContent ? said : null), value: () => valueOf(input, type) };
}

function valueOf(input, type) {
  if (type === "boolean") return input.checked;
  if (type === "number" || type === "integer") return input.value === "" ? null : Number(input.value);
  return input.value;
}

/** Why the robot can do this: in words, and behind these step by step. */
function why(capability, key) {
  const { because = [], implied_by: implied = [] } = capability;
  const reasons = because.map((one) => element("li", {}, one));
  if (implied.length) reasons.push(element("li", {}, `It follows from: ${implied.join(", ")}.`));
  const node = element("details", {}, element("summary", { id: `${key}-why` }, "Why it can"), element("ul", {}, ...reasons), proofs(capability, `${key}-proof`));
  node.dataset.key = `${key}-why`;
  return node;
}
