// The picture of a system: switches for what it shows, and findings that point into it.

import { draw } from "./graph.js";
import { ordered, visible } from "./graph-model.js";
import { enhance } from "./table.js";

const FEW = 6;
const MANY = 40;
const MOST = 120;

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

/** Return the part of a graph that is shown: `hidden` names what is left out, by flag or kind. */
function part(data, hidden) {
  const nodes = data.nodes.filter((node) => !hidden.some((what) => node[what] || node.kind === what));
  return { ...data, nodes };
}

async function picture(host, switches) {
  const data = JSON.parse(document.getElementById("system-data").textContent);
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
  const shown = part(data, [...hidden]);
  const folded = closed(shown);
  const drawn = await draw(host, shown, {
    name: host.dataset.name.replaceAll("/", "-"), direction: host.clientWidth < 640 ? "TB" : "LR",
    height: `${Math.min(46, Math.max(18, visible(ordered(shown), new Set(folded)).nodes.length * 1.3))}rem`,
    collapsed: folded,
  });
  const update = () => {
    const off = boxes.filter((box) => !box.checked).map((box) => box.dataset.hides);
    drawn.options.collapsed = [...drawn.collapsed];
    drawn.replace(part(data, off));
  };
  for (const box of boxes) box.addEventListener("change", update);
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

/** Put a table that is on a page of its own in the place of the link to it; where it does not come the link stays. */
export async function load(details) {
  if (details.getAttribute("aria-busy") === "true") return;
  details.setAttribute("aria-busy", "true");
  const text = await fetched(details.dataset.part);
  details.setAttribute("aria-busy", "false");
  const found = new DOMParser().parseFromString(text, "text/html").getElementById("part");
  if (!found) return;
  const held = details.lastElementChild.contains(document.activeElement);
  details.lastElementChild.replaceWith(...document.adoptNode(found).children);
  for (const table of details.querySelectorAll("table[data-table]")) enhance(table);
  if (held) details.querySelector("summary").focus();
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
