// The picture of a system: switches for its parts, and findings that link into it.

import { draw } from "./graph.js";
import { ordered, visible } from "./graph-model.js";
import { enhance } from "./table.js";

const FEW = 6;
const MANY = 40;
const MOST = 120;
const CROWDED = 150; // with more edges the picture starts with its groups closed

const depth = (group) => group.id.split("/").length;

/** Return the namespaces to close at first: as few levels, the innermost first, as leave so much to be seen at once. */
function closed(data) {
  const known = ordered(data);
  const size = (groups) => visible(known, new Set(groups)).nodes.length;
  let found = [];
  for (let level = Math.max(0, ...known.groups.map(depth)); level > 0 && size(found) > MANY; level -= 1) {
    const further = known.groups.filter((group) => depth(group) >= level).map((group) => group.id);
    if (size(further) < FEW && size(found) <= MOST) break;
    found = further;
  }
  return found;
}

/** Return the ids of the groups that a node lies in. */
function around(data, node) {
  const parents = new Map(data.groups.map((group) => [group.id, group.group]));
  const found = new Set();
  for (let at = node.group; at; at = parents.get(at)) found.add(at);
  return found;
}

/** Return the visible part of a graph: `hidden` names the omitted parts, by flag or kind. */
function part(data, hidden) {
  const nodes = data.nodes.filter((node) => !hidden.some((what) => node[what] || node.kind === what));
  return { ...data, nodes };
}

/** Return a graph with packages for groups instead of namespaces; a channel lies in the one that all its nodes are of. */
function packaged(data) {
  const known = new Map(data.nodes.filter((node) => node.package).map((node) => [node.id, `package ${node.package}`]));
  const around = new Map();
  for (const { source, target } of data.edges) {
    for (const [one, other] of [[source, target], [target, source]]) {
      if (known.has(other)) around.set(one, new Set(around.get(one)).add(known.get(other)));
    }
  }
  const group = (node) => known.get(node.id) ?? (around.get(node.id)?.size === 1 ? [...around.get(node.id)][0] : undefined);
  const groups = [...new Set(known.values())].map((id) => ({ id, label: id.replace("package ", "") }));
  return { ...data, nodes: data.nodes.map((node) => ({ ...node, group: group(node) })), groups };
}

async function picture(host, switches) {
  const spaces = JSON.parse(document.getElementById("system-data").textContent);
  const packages = packaged(spaces);
  let data = spaces;
  const size = (hidden) => part(data, hidden).nodes.length;
  const hidden = new Set(["debug", "transforms"]);
  if (size([...hidden]) > MANY) hidden.add("loose");
  if (size([...hidden]) === 0) hidden.clear();
  const boxes = [...switches.querySelectorAll("input")];
  for (const box of boxes) {
    const count = data.nodes.filter((node) => node[box.dataset.hides] || node.kind === box.dataset.hides).length;
    box.parentElement.hidden = count === 0;
    box.checked = !hidden.has(box.dataset.hides);
  }
  const edges = ordered(part(data, [...hidden])).edges.length;
  const crowded = edges > CROWDED;
  if (crowded && !spaces.groups.length) data = packages;
  const shown = part(data, [...hidden]);
  const folded = crowded ? data.groups.map((group) => group.id) : closed(shown);
  const drawn = await draw(host, shown, {
    name: host.dataset.name.replaceAll("/", "-"), direction: host.clientWidth < 640 ? "TB" : "LR",
    height: `${Math.min(46, Math.max(18, visible(ordered(shown), new Set(folded)).nodes.length * 1.3))}rem`,
    collapsed: folded,
    note: crowded ? `${edges} connections: the groups start closed. Open one with a double click, or all with “Open groups”.` : "",
  });
  const update = () => {
    const off = boxes.filter((box) => !box.checked).map((box) => box.dataset.hides);
    drawn.options.collapsed = [...drawn.collapsed];
    drawn.replace(part(data, off));
  };
  for (const box of boxes) box.addEventListener("change", update);
  const by = switches.querySelector("select");
  by.value = data === packages ? "package" : "namespace";
  by.addEventListener("change", () => {
    data = by.value === "package" ? packages : spaces;
    drawn.collapsed = new Set(crowded ? data.groups.map((group) => group.id) : []);
    update();
  });
  switches.hidden = !drawn.cy;
  if (!drawn.cy) return;
  for (const button of document.querySelectorAll("[data-finding]")) {
    const node = data.nodes.find((one) => one.findings?.includes(Number(button.dataset.finding)));
    if (!node) continue;
    button.hidden = false;
    button.addEventListener("click", () => {
      for (const box of boxes) if (node[box.dataset.hides] || node.kind === box.dataset.hides) box.checked = true;
      const open = around(data, node);
      for (const group of open) drawn.collapsed.delete(group);
      update();
      drawn.select(node.id);
      host.scrollIntoView({ block: "start" });
    });
  }
}

/** Replace the link to a table on its own page by the table; if it cannot be loaded the link stays. */
export async function load(details) {
  if (details.getAttribute("aria-busy") === "true") return;
  details.setAttribute("aria-busy", "true");
  const text = await fetched(details.dataset.part);
  details.setAttribute("aria-busy", "false");
  const found = new DOMParser().parseFromString(text, "text/html").getElementById("part");
  if (!found) return;
  const focused = details.lastElementChild.contains(document.activeElement);
  details.lastElementChild.replaceWith(...document.adoptNode(found).children);
  for (const table of details.querySelectorAll("table[data-table]")) enhance(table);
  if (focused) details.querySelector("summary").focus();
  delete details.dataset.part;
}

/** Return the text of a page; none where it cannot be had. */
async function fetched(address) {
  const answer = await fetch(address, { headers: { Accept: "text/html" } }).catch(() => null);
  return answer?.ok ? answer.text().catch(() => "") : "";
}

for (const details of document.querySelectorAll("details[data-part]")) {
  details.addEventListener("toggle", () => details.open && details.dataset.part && load(details));
}

const host = document.getElementById("system-graph");
if (host) await picture(host, document.getElementById("system-switches"));
