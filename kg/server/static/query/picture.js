// The picture of an answer that is a graph. What the answer does not call by a name is called as the store calls it, and
// what lies in namespaces of ROS is grouped by them.

import { url } from "../address.js";
import { draw } from "../graph.js";
import { element } from "../table.js";
import { view } from "./services.js";
import { written } from "./terms.js";

const MOST = 500;
const FEW = 40;
const TYPE = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type";
const LABEL = "http://www.w3.org/2000/01/rdf-schema#label";
const KINDS = { node: /Node(Type|Instance)?$/, topic: /Topic$/, service: /Service(Server)?$/, action: /Action(Server)?$/, package: /Package$/, parameter: /Parameter$/, hardware: /Hardware$|Device$/ };
const AROUND = 6; // neighbours of each property that are added at once
const ADDED = 40;
const UNSHOWN = /^http:\/\/(www\.w3\.org\/(ns\/prov#|1999\/02\/22-rdf-syntax-ns#)|purl\.org\/dc\/terms\/)/; // origins, classes, and relations that others imply
const SPACED = new Set(["node", "topic", "service", "action"]);

/** Return the picture of triples: literals that name a thing are its label, its class tells its colour. */
export function picture(rows, shorten) {
  const host = element("div", { className: "query-picture" });
  const shown = rows.slice(0, MOST);
  const cut = rows.length > MOST ? element("p", { className: "notice" }, `The picture has the first ${MOST} of ${rows.length.toLocaleString("en")} triples; the table has all.`) : null;
  fill(host, shown, shorten);
  return element("div", {}, cut, host);
}

async function fill(host, start, shorten) {
  let rows = start;
  const graph = await named(rows, shorten);
  const expand = async (node) => {
    rows = [...rows, ...await around(node.detail, rows)];
    return named(rows, shorten);
  };
  // The picture measures its element, which is in the page by now unless another answer was requested.
  if (host.isConnected) draw(host, graph, { name: "answer", height: "32rem", expand, note: "Select a thing to add its neighbours." });
}

/** Return the graph of triples, with the names of the store. */
async function named(rows, shorten) {
  const iris = [...new Set(rows.flatMap(([subject, , object]) => [subject, object]).filter((term) => term?.type === "uri").map((term) => term.value))];
  const found = await view("cells", { things: iris }).catch(() => null);
  const described = new Map(found ? iris.map((iri, index) => [iri, found.things[index]]) : []);
  return spaced(asGraph(rows, shorten, described));
}

/** Return new triples that join a thing to others with names, a few of each property. */
async function around(iri, rows) {
  const term = (value) => ({ type: "uri", value });
  const text = (row) => row.map((one) => one && written(one)).join(" ");
  const known = new Set(rows.map(text));
  const found = await view("resource", { iri, limit: String(AROUND) });
  const joined = (side, turned) => found[side].filter((group) => !UNSHOWN.test(group.predicate.iri))
    .flatMap((group) => group.facts.filter((fact) => fact.value.iri && !fact.value.label.includes("#")).map((fact) => turned(term(group.predicate.iri), term(fact.value.iri))));
  const all = [...joined("out", (property, other) => [term(iri), property, other]), ...joined("in", (property, other) => [other, property, term(iri)])];
  return all.filter((row) => !known.has(text(row))).slice(0, ADDED);
}

function asGraph(rows, shorten, described) {
  const nodes = new Map();
  const thing = (term) => {
    const id = written(term);
    if (!nodes.has(id)) nodes.set(id, term.type === "uri" ? resource(id, term.value, shorten, described.get(term.value)) : { id, kind: "literal", label: short(String(term.value)) });
    return nodes.get(id);
  };
  const edges = [];
  const predicates = new Set(rows.map((row) => row[1]?.value).filter((iri) => iri !== LABEL && iri !== TYPE));
  const names = predicates.size > 1 || rows.length < FEW;
  for (const [subject, predicate, object] of rows) {
    if (!subject || !predicate || !object) continue;
    const node = thing(subject);
    if (predicate.value === LABEL) node.label = object.value;
    else if (predicate.value === TYPE) node.kind = kind([object.value], node.kind);
    else edges.push({ source: node.id, target: thing(object).id, label: names ? shorten(predicate.value) : undefined });
  }
  return { nodes: [...nodes.values()], edges };
}

function resource(id, iri, shorten, described) {
  return {
    id, kind: kind(described?.types ?? [], "resource"), label: described?.label ?? shorten(iri), detail: iri,
    href: url(`/resource?iri=${encodeURIComponent(iri)}`),
  };
}

function kind(types, otherwise) {
  return Object.entries(KINDS).find(([, pattern]) => types.some((iri) => pattern.test(iri)))?.[0] ?? otherwise;
}

/** Return a graph with those namespaces as groups that more than one node of ROS lies in. */
function spaced({ nodes, edges }) {
  const above = (name) => name.slice(0, name.lastIndexOf("/"));
  const inside = new Map();
  for (const node of nodes) {
    if (node.kind !== "node" || !node.label.startsWith("/")) continue;
    for (let space = above(node.label); space; space = above(space)) inside.set(space, (inside.get(space) ?? 0) + 1);
  }
  const spaces = new Set([...inside].filter(([, number]) => number > 1).map(([space]) => space));
  const within = (name) => {
    let space = above(name);
    while (space && !spaces.has(space)) space = above(space);
    return space || undefined;
  };
  const placed = (node) => {
    const group = SPACED.has(node.kind) && node.label.startsWith("/") ? within(node.label) : undefined;
    return group ? { ...node, group, label: node.label.slice(group.length + 1) } : node;
  };
  return { nodes: nodes.map(placed), edges, groups: [...spaces].map((space) => ({ id: space, label: space.slice((within(space) ?? "").length), group: within(space) })) };
}

function short(text) {
  return text.length > 40 ? `${text.slice(0, 39)}…` : text;
}
