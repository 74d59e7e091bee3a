// The list for a picture: each thing with its targets, for keyboards and screen readers.

import { element } from "./table.js";

/** Return the list of a graph; `onSelect(id)` is called for the marked button of a thing. */
export function listed(data, { open, onSelect }) {
  const labels = new Map(data.nodes.map((node) => [node.id, node.label]));
  const leads = new Map();
  for (const edge of data.edges) {
    if (!leads.has(edge.source)) leads.set(edge.source, []);
    leads.get(edge.source).push(edge);
  }
  const rows = data.nodes.map((node) => {
    const item = element("li");
    const name = node.href ? element("a", { href: node.href }, node.label) : element("span", {}, node.label);
    const show = element("button", { type: "button", className: "link" }, "show");
    show.setAttribute("aria-label", `Show ${node.label} in the picture`);
    show.addEventListener("click", () => onSelect(node.id));
    item.append(name, ` ${node.kind ?? ""} `, ...(open ? [] : [show]));
    const edges = leads.get(node.id) ?? [];
    if (edges.length) {
      item.append(element("ul", {}, ...edges.map((edge) => element("li", {},
        `${edge.label ?? "→"} `, labels.get(edge.target), edge.inferred ? " (inferred)" : "", edge.marked ? " (a finding)" : ""))));
    }
    return item;
  });
  const filter = element("input", { type: "search", placeholder: "Filter the list" });
  filter.setAttribute("aria-label", "Filter the list of the picture");
  filter.addEventListener("input", () => {
    const wanted = filter.value.trim().toLowerCase();
    for (const row of rows) row.hidden = !row.textContent.toLowerCase().includes(wanted);
  });
  return element("details", { className: "graph-list", open },
    element("summary", {}, `The picture as a list (${data.nodes.length})`), filter, element("ul", {}, ...rows));
}
