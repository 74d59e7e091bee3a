// The start page: launch configurations with findings, which take a while to count, are filled in later.

import { url } from "./address.js";
import { element } from "./table.js";

const MOST = 12;
const LEVELS = ["error", "warning", "note"];

function weight(system) {
  return (system.findings.error ?? 0) * 1e6 + (system.findings.warning ?? 0) * 1e3 + (system.findings.note ?? 0);
}

function card(system) {
  const tags = LEVELS.filter((level) => system.findings[level]).flatMap((level) => [
    element("span", { className: `tag ${level}` }, `${system.findings[level]} ${level}${system.findings[level] === 1 ? "" : "s"}`), " ",
  ]);
  const address = url(`/system?${new URLSearchParams({ name: system.name, repository: system.repository })}`);
  return element("li", {}, element("a", { href: address }, system.name), " ", element("span", { className: "quiet-text" }, system.repository), " ", ...tags);
}

async function findings(section, list) {
  const answer = await fetch(url("/api/systems?limit=1000")).catch(() => null);
  if (!answer?.ok) return void answer?.body?.cancel();
  const { systems } = await answer.json().catch(() => ({ systems: [] }));
  const found = systems.filter((system) => !system.included && weight(system) > 0).sort((one, other) => weight(other) - weight(one));
  if (!found.length) return;
  const rest = found.length > MOST ? element("p", {}, element("a", { href: url("/systems") }, `All ${found.length} systems with findings`)) : null;
  list.replaceChildren(...[element("ul", { className: "plain systems" }, ...found.slice(0, MOST).map(card)), rest].filter(Boolean));
  section.hidden = false;
}

const section = document.getElementById("findings");
if (section) findings(section, document.getElementById("findings-list"));
