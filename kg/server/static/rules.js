// The pages of rules: searching in the list, and the picture of which rules feed which.

import { url } from "./address.js";
import { draw } from "./graph.js";

/** Return rules and who feeds whom as graph.js takes them; `own` is marked by its group being left out. */
function asGraph({ nodes, edges }) {
  const families = [...new Set(nodes.map((node) => node.family))];
  return {
    nodes: nodes.map((node) => ({
      id: node.rule,
      label: node.rule.split("/").at(-1),
      kind: "rule",
      href: url(`/rule?name=${encodeURIComponent(node.rule)}`),
      group: `family ${node.family}`,
      detail: `${node.title}; stratum ${node.strata.join(", ")}${node.recursive ? ", feeds itself" : ""}`,
    })),
    edges: edges.filter((edge) => edge.from !== edge.to).map((edge) => ({
      source: edge.from,
      target: edge.to,
      label: nodes.length < 25 ? edge.terms.slice(0, 2).join(", ") + (edge.terms.length > 2 ? ", …" : "") : undefined,
      kind: edge.absent ? "absent" : "feeds",
    })),
    groups: families.map((family) => ({ id: `family ${family}`, label: family })),
  };
}

/** Draw the picture of all rules, or of those around the one that the page is about. */
async function picture(host) {
  const rule = host.dataset.rule;
  const data = asGraph(JSON.parse(document.getElementById("rules-data").textContent));
  const drawn = await draw(host, data, {
    name: rule ? rule.replace("/", "-") : "rules",
    height: host.dataset.height,
    collapsed: !rule && data.nodes.length > 40,
  });
  if (rule) drawn.select(rule);
}

/** Let the search field show the rules that hold all its words in their name, title or documentation. */
function search(field, words) {
  const rows = [...document.querySelectorAll("tr[data-text]")];
  const update = () => {
    const wanted = field.value.trim().toLowerCase().split(/\s+/);
    let shown = 0;
    for (const row of rows) {
      const text = row.dataset.text.toLowerCase();
      row.hidden = !wanted.every((word) => text.includes(word));
      shown += row.hidden ? 0 : 1;
    }
    for (const family of document.querySelectorAll(".family")) {
      family.hidden = !family.querySelector("tr[data-text]:not([hidden])");
      if (wanted[0]) family.open = true;
    }
    words.textContent = `${shown} of ${rows.length} rules`;
  };
  field.hidden = false;
  field.addEventListener("input", update);
  update();
}

const host = document.getElementById("rules-graph");
if (host) picture(host);
const field = document.getElementById("rules-filter");
if (field) search(field, document.getElementById("rules-count"));
