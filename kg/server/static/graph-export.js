// Pictures as files.

/** Hand a file to the browser's downloads. */
export function saveFile(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const escaped = (text) => String(text).replace(/[&<>"']/g, (sign) => `&#${sign.charCodeAt(0)};`);
const at = ({ x, y }) => `${x.toFixed(1)} ${y.toFixed(1)}`;

/** Return a picture as SVG, as it is drawn now. */
export function svg(cy, colors) {
  const box = cy.elements().boundingBox();
  const margin = 16;
  const view = [box.x1 - margin, box.y1 - margin, box.w + 2 * margin, box.h + 2 * margin].map((one) => one.toFixed(1));
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="${view.join(" ")}" width="${view[2]}" height="${view[3]}" font-size="12" font-family="sans-serif">`,
    `<rect x="${view[0]}" y="${view[1]}" width="${view[2]}" height="${view[3]}" fill="${colors.surface}"/>`,
    '<defs><marker id="to" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto-start-reverse">',
    `<path d="M0 0 8 4 0 8z" fill="${colors["line-strong"]}"/></marker></defs>`,
    ...cy.nodes(":parent").map((node) => box_(node, colors, 8)),
    ...cy.edges().map((edge) => line(edge)),
    ...cy.nodes().not(":parent").map((node) => box_(node, colors, node.hasClass("topic") ? 0 : 6)),
    "</svg>",
  ].join("\n");
}

function line(edge) {
  const bends = edge.controlPoints() ?? [];
  const end = edge.targetEndpoint();
  const rest = bends.length === 1 ? `Q${at(bends[0])} ${at(end)}` : [...bends, end].map((point) => `L${at(point)}`).join("");
  const dash = edge.style("line-style") === "dashed" ? ' stroke-dasharray="5 3"' : "";
  const label = edge.data("label");
  const middle = edge.midpoint();
  const text = label ? `<text x="${middle.x}" y="${middle.y}" text-anchor="middle" font-size="10" fill="${edge.style("color")}">${escaped(label)}</text>` : "";
  return `<path d="M${at(edge.sourceEndpoint())}${rest}" fill="none" stroke="${edge.style("line-color")}"${dash} marker-end="url(#to)"/>${text}`;
}

function box_(node, colors, round) {
  const bounds = node.boundingBox({ includeLabels: false, includeOverlays: false });
  const group = node.isParent();
  const size = `x="${bounds.x1}" y="${bounds.y1}" width="${bounds.w}" height="${bounds.h}" rx="${round}"`;
  const paint = `fill="${node.style("background-color")}" fill-opacity="${node.style("background-opacity")}" stroke="${node.style("border-color")}"`;
  const [x, y] = group ? [(bounds.x1 + bounds.x2) / 2, bounds.y1 - 4] : [node.position("x"), node.position("y") + 4];
  const text = escaped(group ? node.data("label") : node.data("text"));
  return `<rect ${size} ${paint}/><text x="${x}" y="${y}" text-anchor="middle" fill="${colors.text}">${text}</text>`;
}
