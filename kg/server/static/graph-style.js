// How pictures look: the colours of the page, shapes by kind, sizes by text.

const COLORS = ["back", "surface", "raised", "line", "line-strong", "text", "quiet", "accent", "publisher", "subscriber",
  "service", "action", "parameter", "error", "warning", "note", "inferred"];

const SHAPES = {
  node: ["round-rectangle", "subscriber"], topic: ["rectangle", "publisher"], service: ["cut-rectangle", "service"],
  action: ["cut-rectangle", "action"], parameter: ["round-rectangle", "parameter"], package: ["rectangle", "note"],
  unknown: ["round-rectangle", "quiet"], namespace: ["round-rectangle", "quiet"], hardware: ["barrel", "warning"], rule: ["round-rectangle", "subscriber"],
  predicate: ["rectangle", "publisher"], literal: ["rectangle", "quiet"], resource: ["round-rectangle", "note"],
};

const MONO = new Set(["topic", "service", "action", "parameter", "predicate", "literal"]);
const LONGEST = 44;
const PADDING = 18;
const measure = document.createElement("canvas").getContext("2d");

/** Return the colours of the page in a form for a canvas, by their names in kg.css. */
export function palette(host) {
  const probe = document.createElement("span");
  host.append(probe);
  const found = { sans: getComputedStyle(host).fontFamily, mono: "" };
  for (const name of COLORS) {
    probe.style.color = `var(--${name})`;
    found[name] = getComputedStyle(probe).color;
  }
  probe.className = "mono";
  found.mono = getComputedStyle(probe).fontFamily;
  probe.remove();
  return found;
}

/** Return the text of a node, and its width and height. */
export function sized(node, font) {
  const text = node.label.length > LONGEST ? `${node.label.slice(0, LONGEST / 2 - 1)}…${node.label.slice(-LONGEST / 2)}` : node.label;
  measure.font = MONO.has(node.kind) ? "12px monospace" : `12px ${font}`;
  return { text, width: Math.ceil(measure.measureText(text).width) + PADDING, height: 28 };
}

/** Return the style of cytoscape for a palette. */
export function styled(colors) {
  const kinds = Object.entries(SHAPES).map(([kind, [shape, color]]) => ({
    selector: `node.${kind}`,
    style: {
      shape, "border-color": colors[color], "background-color": colors[color],
      "font-family": MONO.has(kind) ? colors.mono : colors.sans,
    },
  }));
  return [
    {
      selector: "node",
      style: {
        label: "data(text)", width: "data(width)", height: "data(height)", shape: "round-rectangle",
        "font-size": 12, "font-family": colors.sans, color: colors.text, "text-valign": "center", "text-halign": "center",
        "background-color": colors.note, "background-opacity": 0.13, "border-width": 1.25, "border-color": colors.note,
        "z-index-compare": "manual", "z-index": 2, "text-background-color": colors.surface, "text-background-opacity": 0.85,
        "text-background-padding": 1,
      },
    },
    ...kinds,
    { selector: "node.literal", style: { "background-opacity": 0, "border-width": 0 } },
    { selector: "node.unknown", style: { "border-style": "dashed" } },
    { selector: "node.closed", style: { "border-width": 3, "border-style": "double", "font-weight": "bold" } },
    {
      selector: "node.group",
      style: {
        label: "data(label)", shape: "round-rectangle", width: 10, height: 10, padding: 12, "text-valign": "top", color: colors.quiet,
        "font-size": 11, "background-color": colors.quiet, "background-opacity": 0.06, "border-color": colors.line,
        "border-width": 1, "text-margin-y": -3, "z-index": 0,
      },
    },
    {
      selector: "edge",
      style: {
        "z-index-compare": "manual", "z-index": 1,
        width: 1.25, "line-color": colors["line-strong"], "target-arrow-color": colors["line-strong"], "target-arrow-shape": "triangle",
        "arrow-scale": 0.8, "curve-style": "bezier", "font-size": 10, color: colors.quiet, "font-family": colors.sans,
        "text-background-color": colors.surface, "text-background-opacity": 0.9, "text-background-padding": 2,
      },
    },
    { selector: "edge[label]", style: { label: "data(label)" } },
    { selector: "node.inferred, edge.inferred", style: { "border-style": "dashed", "line-style": "dashed", "line-color": colors.inferred, "target-arrow-color": colors.inferred } },
    { selector: "node.marked", style: { "border-color": colors.error, "border-width": 2.5 } },
    { selector: "edge.marked", style: { "line-color": colors.error, "target-arrow-color": colors.error, width: 2 } },
    { selector: "node.chosen", style: { "border-width": 3, "background-opacity": 0.3 } },
    { selector: ".faded", style: { opacity: 0.22 } },
  ];
}
