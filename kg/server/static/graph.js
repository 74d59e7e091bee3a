// Pictures of graphs, for all pages.
//
//   import { draw } from "/static/graph.js";
//   const picture = await draw(host, data, { name: "bringup", direction: "LR" });
//
// `host` is an empty element; it receives the tools, the picture and an equivalent list. `data` is
//
//   { nodes:  [{ id, label, kind, href?, group?, detail?, inferred?, marked? }],
//     edges:  [{ source, target, kind?, label?, inferred?, marked? }],
//     groups: [{ id, label, group? }] }
//
// `kind` gives the colour and shape: node, topic, service, action, parameter, package, hardware, rule, predicate,
// literal, resource. `group` is the id of a group (a namespace, a package); groups may lie in groups. `href` is where the
// node's page is, `detail` a line more about it. `inferred` is drawn dashed, `marked` (a finding) in the colour of errors.
//
// Options: `direction` is "LR" or "TB"; `collapsed` lists groups that are closed at first (or is true: all of them);
// `note` is a sentence below the picture while nothing is selected; `name` names exported files; `height` is a length of CSS; `onSelect(node or null)` receives the selection.
// `expand(node)` returns a promise of the data with the neighbours of a node, which the picture then offers for nodes with a page.
//
// The returned picture has fit(), zoom(factor), select(id or null), collapse(ids), replace(data), save(kind) with kind
// "png", "svg" or "json", and `cy`, the cytoscape instance: null where the libraries are not installed; the list is then
// all there is. Positions depend on the data alone: the same graph always looks the same.

import { saveFile, svg } from "./graph-export.js";
import { listed } from "./graph-list.js";
import { densest, loose, ordered, visible } from "./graph-model.js";
import { palette, sized, styled } from "./graph-style.js";
import { element } from "./table.js";

const STEP = 60;
const ZOOM = 1.25;
const LARGEST = 1.2;
// dagre fails where a bend of an edge falls on the middle of a node, which depends on how it breaks cycles.
const ATTEMPTS = [{}, { acyclicer: "greedy" }, { name: "breadthfirst", directed: true }];
const LEGIBLE = 0.45; // below that names cannot be read
const READ = 0.6;
const MARGIN = 24;
const LONGEST_SIDE = 8192; // browsers refuse larger pictures
const drawn = new Set();

/** Run a layout; return whether it could place everything. */
function ran(layout) {
  try {
    layout.run();
    return true;
  } catch {
    return false;
  }
}

/** Return cytoscape with its layout, or null where the libraries are not installed. */
async function library() {
  try {
    const [core, dagre] = await Promise.all([import("cytoscape"), import("cytoscape-dagre")]);
    if (!core.default.kgReady) {
      core.default.use(dagre.default);
      core.default.kgReady = true;
    }
    return core.default;
  } catch {
    return null;
  }
}

/** Draw a graph into an empty element; the head of this file describes parameters and result. */
export async function draw(host, data, options = {}) {
  host.setAttribute("aria-busy", "true");
  const picture = new Picture(host, data, options);
  const cytoscape = await library();
  for (const other of drawn) if (!other.host.isConnected) other.leave();
  picture.begin(cytoscape);
  host.setAttribute("aria-busy", "false");
  return picture;
}

class Picture {
  constructor(host, data, options) {
    this.host = host;
    this.options = { direction: "LR", name: "graph", collapsed: [], height: "", onSelect: () => {}, ...options };
    this.take(data);
    this.cy = null;
    this.size = {};
    this.moved = false; // by somebody, since all was laid out
    this.left = new AbortController();
    this.away = new Set(); // ids of hidden nodes
  }

  /** Return the data without hidden nodes. */
  get remaining() {
    if (!this.away.size) return this.data;
    const nodes = this.data.nodes.filter((node) => !this.away.has(node.id));
    return ordered({ ...this.data, nodes });
  }

  take(data) {
    this.data = ordered(data);
    const { collapsed } = this.options;
    this.collapsed = new Set(collapsed === true ? this.data.groups.map((group) => group.id) : collapsed || []);
  }

  begin(cytoscape) {
    this.host.classList.add("graph");
    this.canvas = element("div", { className: "graph-canvas", tabIndex: 0 });
    this.canvas.setAttribute("role", "group");
    if (this.options.height) this.canvas.style.height = this.options.height;
    this.words = element("p", { className: "graph-words" });
    this.words.setAttribute("role", "status");
    this.list = element("div");
    if (!cytoscape) {
      this.words.textContent = "No picture: the page libraries are not installed. The list has the same content.";
      this.host.replaceChildren(this.words, this.list);
      this.list.replaceChildren(listed(this.data, { open: true, onSelect: () => {} }));
      return;
    }
    this.host.replaceChildren(this.tools(), this.canvas, this.words, this.list);
    this.cy = cytoscape({
      container: this.canvas,
      minZoom: 0.05,
      maxZoom: 3,
      boxSelectionEnabled: false,
      style: styled(palette(this.host)),
    });
    this.listen();
    this.show();
  }

  /** Draw and lay out the visible part. */
  show() {
    const shown = visible(this.remaining, this.collapsed);
    const font = getComputedStyle(this.host).fontFamily;
    this.cy.elements().remove();
    this.cy.add(shown.groups.map((group) => ({ group: "nodes", data: { ...group, parent: group.group }, classes: "group" })));
    this.cy.add(shown.nodes.map((node) => ({
      group: "nodes",
      data: { ...node, parent: node.group, ...sized(node, font) },
      classes: classes(node),
    })));
    this.cy.add(shown.edges.map((edge, index) => ({ group: "edges", data: { id: `edge ${index}`, ...edge }, classes: classes(edge) })));
    this.place(shown);
    const nodes = shown.nodes.length;
    this.canvas.setAttribute("aria-label", `Picture of ${nodes} things and ${shown.edges.length} connections; the list after it says the same`);
    this.list.replaceChildren(listed(this.data, { open: false, onSelect: (id) => this.select(id) }));
    this.tell(null);
  }

  /** Lay out the visible part, and fit the view. */
  place(shown) {
    // Rows of unconnected nodes, by temporary edges between them during the layout.
    const rows = this.cy.add(loose(shown, this.options.direction).map(([source, target]) => ({ group: "edges", data: { source, target } })));
    const options = {
      name: "dagre", rankDir: this.options.direction, nodeSep: 14, rankSep: shown.edges.some((edge) => edge.label) ? 130 : 56, edgeSep: 8,
      fit: false, animate: false,
    };
    ATTEMPTS.some((other) => ran(this.cy.layout({ ...options, ...other })));
    rows.remove();
    this.look();
  }

  /** Fit the view to the graph; if that is too small to read, to its largest connected part. */
  look() {
    this.moved = false;
    this.near(this.cy.elements());
    if (this.cy.zoom() > LEGIBLE) return;
    const nodes = this.cy.nodes().filter((node) => node.degree() > 0);
    if (nodes.empty()) return void this.cy.zoom(READ).center(this.cy.nodes()[0]);
    const boxes = nodes.map((node) => ({ id: node.id(), ...node.boundingBox() }));
    const edges = this.cy.edges().map((edge) => edge.data());
    const seen = (length) => (length - 2 * MARGIN) / READ;
    const found = densest(boxes, edges, seen(this.cy.width()), seen(this.cy.height()));
    this.near(nodes.filter((node) => found.has(node.id())));
  }

  /** Fit the view to elements, up to a useful zoom. */
  near(elements) {
    this.cy.fit(elements, MARGIN);
    if (this.cy.zoom() > LARGEST) this.cy.zoom(LARGEST).center(elements);
  }

  listen() {
    this.cy.on("tap", (event) => {
      if (event.target === this.cy) this.select(null);
      else if (event.target.isNode() && !event.target.hasClass("group")) this.select(event.target.id());
    });
    this.cy.on("dbltap", "node", (event) => this.open(event.target));
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    const repaint = () => this.cy.style(styled(palette(this.host)));
    const { signal } = this.left;
    document.addEventListener("kg:theme", repaint, { signal });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint, { signal });
    this.cy.on("dragpan pinchzoom scrollzoom", () => { this.moved = true; });
    const sizes = new ResizeObserver(() => this.resized());
    sizes.observe(this.canvas);
    signal.addEventListener("abort", () => sizes.disconnect());
    drawn.add(this);
  }

  /** Release the page, which has removed the picture. */
  leave() {
    drawn.delete(this);
    this.left.abort();
    this.cy.destroy();
  }

  /** Adopt the current size of the element; a view moved by the user stays the same. */
  resized() {
    const { width, height } = this.size;
    this.size = { width: this.canvas.clientWidth, height: this.canvas.clientHeight };
    this.cy.resize();
    const other = width !== this.size.width || height !== this.size.height;
    if (other && !this.moved) this.look();
  }

  /** Follow a node to its page, or open and close a group. */
  open(node) {
    const { id, href, closed } = node.data();
    if (closed) this.collapsed.delete(id);
    else if (node.hasClass("group")) this.collapsed.add(id);
    else if (href) return void location.assign(href);
    else return;
    this.show();
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const moves = { ArrowLeft: [STEP, 0], ArrowRight: [-STEP, 0], ArrowUp: [0, STEP], ArrowDown: [0, -STEP] };
    if (moves[event.key]) this.pan(...moves[event.key]);
    else if (event.key === "+" || event.key === "=") this.zoom(ZOOM);
    else if (event.key === "-") this.zoom(1 / ZOOM);
    else if (event.key === "0") this.fit();
    else if (event.key === "Escape") this.select(null);
    else return;
    event.preventDefault();
  }

  fit() {
    this.moved = true;
    this.cy?.fit(undefined, MARGIN);
  }

  pan(x, y) {
    this.moved = true;
    this.cy.panBy({ x, y });
  }

  zoom(factor) {
    this.moved = true;
    this.cy?.zoom({ level: this.cy.zoom() * factor, renderedPosition: { x: this.cy.width() / 2, y: this.cy.height() / 2 } });
  }

  /** Mark a node and its neighbours; null marks nothing. */
  select(id) {
    if (!this.cy) return;
    this.cy.elements().removeClass("faded chosen");
    const node = id === null ? this.cy.collection() : this.cy.getElementById(this.within(id));
    if (node.nonempty()) {
      this.moved = true;
      const near = node.closedNeighborhood();
      this.cy.elements().not(near).not(near.ancestors()).not(node.descendants()).addClass("faded");
      node.addClass("chosen");
      const box = node.renderedBoundingBox();
      if (box.x1 < 0 || box.y1 < 0 || box.x2 > this.cy.width() || box.y2 > this.cy.height()) this.cy.center(node);
    }
    this.tell(node.nonempty() ? node.data() : null);
  }

  /** Return the id of a node, or of the closed group that it is drawn within. */
  within(id) {
    return visible(this.remaining, this.collapsed).within(id);
  }

  tell(node) {
    this.words.replaceChildren();
    if (node) {
      const degree = this.cy.getElementById(node.id).degree();
      this.words.append(element("strong", {}, node.label), ` ${node.kind ?? ""}${node.detail ? `, ${node.detail}` : ""}, ${degree} connections. `);
      if (node.href) this.words.append(element("a", { href: node.href }, "Open its page"), " ");
      if (node.closed) this.offer("Open the group", () => this.collapsed.delete(node.id));
      else this.offer("Hide it", () => this.away.add(node.id));
      if (node.href && this.options.expand) this.offer("Add its neighbours", () => this.grow(node));
    } else if (this.options.note) this.words.append(`${this.options.note} `);
    if (this.away.size) this.offer(`Show ${this.away.size} hidden`, () => this.away.clear());
    this.options.onSelect(node);
  }

  /** Add the neighbours of a node, which stays selected. */
  async grow(node) {
    this.host.setAttribute("aria-busy", "true");
    const data = await this.options.expand(node).catch(() => null);
    this.host.setAttribute("aria-busy", "false");
    if (data) this.data = ordered(data);
    return node;
  }

  /** Offer something to do below the picture, which is drawn again afterwards. */
  offer(text, work) {
    const button = element("button", { type: "button", className: "link" }, text);
    button.addEventListener("click", async () => {
      const selected = await work();
      this.show();
      if (selected?.id) this.select(selected.id);
    });
    this.words.append(button, " ");
  }

  /** Select the next node whose name has a text; its groups are opened. */
  find(text) {
    const wanted = text.trim().toLowerCase();
    const found = this.remaining.nodes.filter((node) => `${node.id} ${node.label}`.toLowerCase().includes(wanted)).map((node) => node.id);
    if (!wanted || !found.length) return void this.select(null);
    this.found = found[(found.indexOf(this.found) + 1) % found.length];
    for (let at = this.within(this.found); at !== this.found; at = this.within(this.found)) this.collapsed.delete(at);
    this.show();
    this.select(this.found);
  }

  collapse(ids) {
    this.collapsed = new Set(ids);
    if (this.cy) this.show();
  }

  replace(data) {
    this.take(data);
    if (this.cy) this.show();
    else this.list.replaceChildren(listed(this.data, { open: true, onSelect: () => {} }));
  }

  save(kind) {
    const { name } = this.options;
    if (kind === "json") {
      saveFile(`${name}.json`, new Blob([JSON.stringify(this.data, null, 2)], { type: "application/json" }));
    } else if (kind === "svg") {
      saveFile(`${name}.svg`, new Blob([svg(this.cy, palette(this.host))], { type: "image/svg+xml" }));
    } else {
      const back = palette(this.host).surface;
      const { w, h } = this.cy.elements().boundingBox();
      const scale = Math.min(2, LONGEST_SIDE / Math.max(w, h));
      saveFile(`${name}.png`, this.cy.png({ output: "blob", full: true, scale, bg: back }));
    }
  }

  tools() {
    const button = (text, label, work) => {
      const node = element("button", { type: "button", title: label }, text);
      if (text.length < 2) node.setAttribute("aria-label", label);
      node.addEventListener("click", work);
      return node;
    };
    const turn = () => {
      this.options.direction = this.options.direction === "LR" ? "TB" : "LR";
      this.show();
    };
    const groups = this.data.groups.length ? [
      button("Close groups", "Close all groups", () => this.collapse(this.data.groups.map((group) => group.id))),
      button("Open groups", "Open all groups", () => this.collapse([])),
    ] : [];
    const search = element("input", { type: "search", placeholder: "Find a name" });
    search.setAttribute("aria-label", "Find a name in the picture; Enter goes to the next");
    search.addEventListener("keydown", (event) => event.key === "Enter" && this.find(search.value));
    return element("div", { className: "graph-tools" },
      search,
      button("+", "Zoom in", () => this.zoom(ZOOM)),
      button("−", "Zoom out", () => this.zoom(1 / ZOOM)),
      button("Fit", "Show all of it", () => this.fit()),
      button("Turn", "Turn the direction of the picture", turn),
      ...groups,
      element("span", { className: "graph-gap" }),
      ...["png", "svg", "json"].map((kind) => button(kind.toUpperCase(), `Save the picture as ${kind.toUpperCase()}`, () => this.save(kind))));
  }
}

function classes(item) {
  return [item.kind, item.inferred && "inferred", item.marked && "marked", item.closed && "closed"].filter(Boolean).join(" ");
}
