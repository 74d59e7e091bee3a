// The pages of rules: the picture of which rules feed which.

import { url } from "./address.js";
import { draw } from "./graph.js";

/** Return rules and their dependencies as data of graph.js; `own` is marked by its missing group. */
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

/** Draw a picture of rules: of all with closed families, or of those around the rule that the page is about. */
async function picture(host, graph) {
  const rule = host.dataset.rule;
  const data = asGraph(graph);
  const drawn = await draw(host, data, {
    name: rule ? rule.replace("/", "-") : "rules",
    height: host.dataset.height,
    collapsed: !rule && data.nodes.length > 40,
  });
  if (rule) drawn.select(rule);
}

/** Request all rules and draw them; computing their dependencies takes a second or two after a start of the server. */
async function request(host) {
  host.setAttribute("aria-busy", "true");
  host.textContent = "Computing which rules feed which …";
  try {
    const response = await fetch(url("/api/rule_feeds"));
    if (!response.ok) throw new Error((await response.json()).message ?? response.statusText);
    await picture(host, (await response.json()).graph);
  } catch (error) {
    host.textContent = `The picture cannot be drawn: ${error.message}`;
  } finally {
    host.setAttribute("aria-busy", "false");
  }
}

const host = document.getElementById("rules-graph");
const folded = document.getElementById("rules-picture");
const data = document.getElementById("rules-data");
if (folded) {
  folded.hidden = false;
  folded.addEventListener("toggle", () => request(host), { once: true });
} else if (host && data) picture(host, JSON.parse(data.textContent));
