// The list of examples: those that fit the robot first, and for the others what the robot lacks.

import { element } from "../table.js";
import { prose } from "./output.js";
import { ask } from "./services.js";
import { named, unknown } from "./writing.js";

/** Show examples in `list`; `open` receives the text of the chosen one. Without `capabilities` none is checked. */
export async function examples(list, all, capabilities, open) {
  const judged = await Promise.all(all.map(async (one) => ({ ...one, lacks: capabilities ? await lacks(one.text, capabilities) : "" })));
  const fit = judged.filter((one) => !one.lacks);
  const others = judged.filter((one) => one.lacks);
  list.replaceChildren(...[...fit, ...others].map((one) => entry(one, open)));
}

function entry({ name, comment, text, lacks: missing }, open) {
  const show = element("button", { type: "button" }, name);
  show.addEventListener("click", () => open(text));
  return element("li", {}, show, missing ? element("p", { className: "robot-lacks" }, missing) : null, comment ? element("p", {}, ...prose(comment)) : null);
}

/** Return what the robot lacks for a program in words, empty if it fits. */
async function lacks(text, capabilities) {
  const { program, problems } = await ask("/robot/check", { text });
  const wrong = problems.filter(({ severity }) => severity === "error");
  if (!wrong.length) return "";
  const missing = program ? unknown(named(program, capabilities), capabilities) : [];
  if (!missing.length) return `Does not fit this robot: ${wrong[0].message}`;
  return `This robot lacks: ${[...new Set(missing.map(({ name }) => words(name)))].join(", ")}.`;
}

/** Return the name of a capability as words: `takingOff` is taking off. */
const words = (name) => name.replace(/(\p{Ll})(\p{Lu})/gu, "$1 $2").toLowerCase();
