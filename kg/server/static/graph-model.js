// The visible part of a graph, independent of a screen: closed groups represent their content.

/** Return the data with everything in an order that does not depend on how they came, and without dangling edges. */
export function ordered({ nodes = [], edges = [], groups = [] }) {
  const by = (key) => (one, other) => (key(one) < key(other) ? -1 : key(one) > key(other) ? 1 : 0);
  const known = new Set(nodes.map((node) => node.id));
  const folders = new Set(groups.map((group) => group.id));
  const placed = (item) => (item.group !== undefined && item.group !== null && folders.has(item.group) ? item : { ...item, group: undefined });
  return {
    nodes: nodes.map(placed).sort(by((node) => node.id)),
    edges: edges.filter((edge) => known.has(edge.source) && known.has(edge.target))
      .sort(by((edge) => `${edge.source}\n${edge.target}\n${edge.kind ?? ""}\n${edge.label ?? ""}`)),
    groups: groups.map(placed).sort(by((group) => group.id)),
  };
}

/** Return { nodes, edges, groups, within }: the drawn part while the groups of the set `collapsed` are closed. */
export function visible(data, collapsed) {
  const parents = new Map(data.groups.map((group) => [group.id, group.group]));
  const owner = new Map(data.nodes.map((node) => [node.id, node.group]));
  const outermost = (group) => {
    let found;
    for (let at = group; at !== undefined; at = parents.get(at)) if (collapsed.has(at)) found = at;
    return found;
  };
  const within = (id) => (collapsed.has(id) && parents.has(id) ? outermost(id) : outermost(owner.get(id)) ?? id);
  const sizes = new Map();
  for (const node of data.nodes) {
    const at = within(node.id);
    sizes.set(at, (sizes.get(at) ?? 0) + 1);
  }
  const closed = data.groups
    .filter((group) => collapsed.has(group.id) && outermost(group.id) === group.id && sizes.has(group.id))
    .map((group) => ({ ...group, kind: "namespace", closed: true, label: `${group.label} (${sizes.get(group.id)})` }));
  return {
    nodes: [...closed, ...data.nodes.filter((node) => within(node.id) === node.id)],
    edges: joined(data.edges, within),
    groups: data.groups.filter((group) => outermost(group.id) === undefined),
    within,
  };
}

/** Return the edges between drawn nodes; parallel ones become one, with their number. */
function joined(edges, within) {
  const found = new Map();
  for (const edge of edges) {
    const [source, target] = [within(edge.source), within(edge.target)];
    const moved = source !== edge.source || target !== edge.target;
    if (moved && source === target) continue;
    const key = JSON.stringify(moved ? [source, target] : [source, target, edge.kind, edge.label, edge.inferred]);
    const same = found.get(key);
    if (!same) found.set(key, { ...edge, source, target, count: 1 });
    else {
      same.count += 1;
      same.marked ||= edge.marked;
      if (moved) same.label = String(same.count);
    }
  }
  return [...found.values()];
}

const WIDTH = 160;
const HEIGHT = { LR: 42, TB: 84 };
const SHAPE = { LR: 1.6, TB: 0.8 };

/**
 * Return pairs of ids that make rows of the nodes which no edge joins, those of a group by themselves, so that together
 * they have the shape of a screen instead of that of a line.
 */
export function loose({ nodes, edges }, direction) {
  const joined = new Set(edges.flatMap((edge) => [edge.source, edge.target]));
  const groups = new Map();
  for (const node of nodes) {
    if (!joined.has(node.id)) groups.set(node.group, [...(groups.get(node.group) ?? []), node.id]);
  }
  return [...groups.values()].flatMap((ids) => {
    const across = Math.sqrt((ids.length * SHAPE[direction] * HEIGHT[direction]) / WIDTH);
    const length = Math.max(1, Math.round(direction === "LR" ? across : ids.length / across));
    return ids.slice(1).map((id, index) => [ids[index], id]).filter((_, index) => (index + 1) % length);
  });
}

const EDGE = 3; // an edge with both its ends is worth more than another node

/**
 * Return the ids of the boxes, { id, x1, y1, x2, y2 }, that are seen whole together where most is to be seen, of them and
 * of the edges between them: in a window of that size, around the middle of one of them.
 */
export function densest(boxes, edges, width, height) {
  let found = { ids: new Set(), many: 0 };
  for (const { x1, y1, x2, y2 } of boxes) {
    const [x, y] = [(x1 + x2) / 2, (y1 + y2) / 2];
    const inside = (box) => box.x1 >= x - width / 2 && box.x2 <= x + width / 2 && box.y1 >= y - height / 2 && box.y2 <= y + height / 2;
    const ids = new Set(boxes.filter(inside).map((box) => box.id));
    const many = ids.size + EDGE * edges.filter(({ source, target }) => ids.has(source) && ids.has(target)).length;
    if (many > found.many) found = { ids, many };
  }
  return found.ids;
}
