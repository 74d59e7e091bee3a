// The picture of a node: itself, its topics, services and actions, and the nodes at their other side.

import { draw } from "./graph.js";

const host = document.getElementById("node-graph");
if (host) {
  const data = JSON.parse(document.getElementById("node-data").textContent);
  const height = `${Math.min(40, Math.max(14, data.nodes.length * 0.95))}rem`;
  await draw(host, data, { name: host.dataset.name.replaceAll("/", "-"), direction: host.clientWidth < 640 ? "TB" : "LR", height });
}
