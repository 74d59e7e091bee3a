// Rows of an answer as a table: sorted, filtered, a page at a time, with links, marks of what is inferred, lines, and why
// a row is there.

import { url } from "../address.js";
import { element } from "../table.js";
import { compare, isNumber, written } from "./terms.js";
import { view } from "./services.js";

const SIZES = [25, 50, 100, 500];
const LONG = 300;

/**
 * Return the element of a table: `columns` are names, `rows` lists of terms or null; `context` shortens IRIs, and has the
 * query where its rows can be explained.
 */
export function table(columns, rows, context) {
  return new Table(columns, rows, context).holder;
}

class Table {
  constructor(columns, rows, context) {
    Object.assign(this, { columns, all: rows, rows, context, first: 0, size: matchMedia("(max-width: 46rem)").matches ? 25 : 50, sorted: null, way: 1 });
    this.places = pairs(columns);
    this.lines = new Map(this.places);
    const beside = new Set(this.lines.values());
    this.visible = columns.map((_, index) => index).filter((index) => !beside.has(index));
    this.triple = columns.length === 3 && context.triples;
    this.filter = element("input", { type: "search", placeholder: "Filter these rows" });
    this.filter.setAttribute("aria-label", "Filter the rows");
    this.words = element("span");
    this.words.setAttribute("role", "status");
    this.before = this.button("Previous", () => this.turn(-1));
    this.after = this.button("Next", () => this.turn(1));
    this.sizes = element("select", {}, ...SIZES.map((size) => element("option", { value: size, selected: size === this.size }, `${size} a page`)));
    this.sizes.setAttribute("aria-label", "Rows on a page");
    this.body = element("tbody");
    this.explained = context.query && !this.triple;
    const reasons = this.explained ? [element("th", { scope: "col", className: "reason" }, element("span", { className: "unseen" }, "Why it is there"))] : [];
    this.headings = new Map(this.visible.map((index) => [index, this.heading(index)]));
    const head = element("tr", {}, ...this.headings.values(), ...reasons);
    const node = element("table", {}, element("thead", {}, head), this.body);
    node.style.setProperty("--columns", this.visible.length);
    const scrolls = element("div", { className: "scrolls", tabIndex: 0 }, node);
    scrolls.setAttribute("role", "region");
    scrolls.setAttribute("aria-label", "Rows of the answer");
    this.holder = element("div", {}, element("div", { className: "table-tools" }, this.filter, this.words, this.before, this.after, this.sizes), scrolls);
    this.filter.addEventListener("input", () => this.choose());
    this.sizes.addEventListener("change", () => { this.size = Number(this.sizes.value); this.turn(0); });
    this.draw();
  }

  button(text, work) {
    const node = element("button", { type: "button" }, text);
    node.addEventListener("click", work);
    return node;
  }

  heading(index) {
    const names = [index, this.lines.get(index)].filter((at) => at !== undefined).map((at) => this.columns[at]);
    const sort = element("button", { type: "button", className: "sort" }, names.join(":"));
    sort.addEventListener("click", () => this.sort(index));
    return element("th", { scope: "col", className: this.numeric(index) ? "number" : "" }, sort);
  }

  numeric(index) {
    return this.all.some((row) => row[index]) && this.all.every((row) => !row[index] || isNumber(row[index]));
  }

  sort(index) {
    this.way = this.sorted === index ? -this.way : 1;
    this.sorted = index;
    for (const [at, cell] of this.headings) {
      if (at === index) cell.setAttribute("aria-sort", this.way > 0 ? "ascending" : "descending");
      else cell.removeAttribute("aria-sort");
    }
    this.choose();
  }

  /** Order two rows by the column that is sorted by, and lines within their file. */
  compare(one, other) {
    const line = this.lines.get(this.sorted);
    return compare(one[this.sorted], other[this.sorted]) || (line === undefined ? 0 : compare(one[line], other[line]));
  }

  choose() {
    const wanted = this.filter.value.trim().toLowerCase();
    this.rows = wanted ? this.all.filter((row) => row.some((term) => term && this.shown(term).toLowerCase().includes(wanted))) : [...this.all];
    if (this.sorted !== null) this.rows.sort((one, other) => this.way * this.compare(one, other));
    this.first = 0;
    this.draw();
  }

  turn(by) {
    this.first = Math.max(0, this.first + by * this.size);
    this.first -= this.first % this.size;
    this.draw();
  }

  shown(term) {
    return term.type === "uri" ? this.context.shorten(term.value) : String(term.value);
  }

  draw() {
    const rows = this.rows.slice(this.first, this.first + this.size);
    const cells = rows.map((row) => row.map((term, index) => this.cell(term, index, row[this.lines.get(index)])));
    const reasons = rows.map((row, index) => (this.explained ? [this.reason(row, this.first + index + 1)] : []));
    this.body.replaceChildren(...cells.map((line, index) => element("tr", {}, ...this.visible.map((at) => line[at]), ...reasons[index])));
    const last = Math.min(this.first + this.size, this.rows.length);
    const range = this.rows.length > this.size ? `${(this.first + 1).toLocaleString("en")}–${last.toLocaleString("en")} of ` : "";
    const of = this.rows.length < this.all.length ? ` (of ${this.all.length.toLocaleString("en")})` : "";
    this.words.textContent = `${range}${this.rows.length.toLocaleString("en")} ${this.rows.length === 1 ? "row" : "rows"}${of}`;
    const few = this.all.length <= SIZES[0];
    this.filter.hidden = this.sizes.hidden = few;
    this.before.hidden = this.after.hidden = this.rows.length <= this.size;
    this.before.disabled = this.first === 0;
    this.after.disabled = last >= this.rows.length;
    this.mark(rows, cells);
  }

  cell(term, index, line) {
    const node = element("td", { className: this.headings.get(index)?.className ?? "" });
    if (line && term?.type === "literal") node.append(...evidence({ line: line.value }, term.value));
    else if (!term) node.append(element("span", { className: "unbound", title: "no value" }, "–"));
    else if (term.type === "uri") node.append(link(term.value, this.context.shorten(term.value)));
    else if (term.type === "literal") node.append(...literal(term));
    else node.append(written(term));
    return node;
  }

  /** Return the cell with the link to the proof of a row; blank nodes have no name for a request. */
  reason(row, number) {
    const bound = this.columns.map((name, index) => [name, row[index]]).filter(([, term]) => term && term.type !== "bnode");
    const values = Object.fromEntries(bound.map(([name, term]) => [name, written(term)]));
    const node = why("why", "/api/why_row", { query: this.context.query, row: JSON.stringify(values) });
    node.setAttribute("aria-label", `why row ${number} is there`);
    return element("td", { className: "reason" }, node);
  }

  /** Request the resources of the visible rows, and mark their cells. */
  async mark(rows, cells) {
    const iris = [...new Set(rows.flat().filter((term) => term?.type === "uri").map((term) => term.value))];
    const places = this.places.flatMap(([path, line]) => rows.map((row) => [row[path]?.value ?? "", row[line]?.value ?? ""]));
    const triples = this.triple ? rows.filter((row) => row.every(Boolean)) : [];
    if (!iris.length && !places.length) return;
    const found = await view("cells", { iris, places, triples: triples.map((row) => row.map(written)) }).catch(() => null);
    if (!found) return;
    const nodes = new Set(iris.filter((_, index) => found.nodes[index]));
    for (const node of this.body.querySelectorAll("a[data-iri]")) {
      if (nodes.has(node.dataset.iri)) node.href = url(`/node?iri=${encodeURIComponent(node.dataset.iri)}`);
    }
    this.places.forEach(([path], at) => rows.forEach((row, index) => {
      const place = found.places[at * rows.length + index];
      if (place && row[path]?.type === "literal") cells[index][path].replaceChildren(...evidence(place, row[path].value));
    }));
    triples.forEach((row, index) => found.inferred[index] && inferred(cells[rows.indexOf(row)], row));
  }
}

/** Return the pairs of columns that are a path and a line in it: `file` and `line`, `path` and `line`, `a_file` and `a_line`. */
function pairs(columns) {
  return columns.map((name, at) => {
    const match = /^(.*?)(file|path)$/i.exec(name);
    const line = match ? columns.findIndex((other) => other.toLowerCase() === `${match[1]}line`.toLowerCase()) : -1;
    return [at, line];
  }).filter(([, line]) => line >= 0);
}

/** Return the link to the page of a thing. */
function link(iri, label) {
  const node = element("a", { href: url(`/resource?iri=${encodeURIComponent(iri)}`), title: iri }, element("bdi", {}, label));
  node.dataset.iri = iri;
  return node;
}

function literal(term) {
  const parts = term.value.length > LONG ? [folded(term.value)] : breakable(term.value);
  const kind = term["xml:lang"] ? `@${term["xml:lang"]}` : "";
  if (kind) parts.push(element("span", { className: "quiet-text" }, ` ${kind}`));
  return parts;
}

/** Return the parts of a text with places between them where a line may end: behind the `/` and `_` of names, and between their words. */
function breakable(text) {
  return text.split(/(?<=[/_])(?=[^/_])|(?<=[a-z])(?=[A-Z])/).flatMap((part, index) => (index ? [element("wbr"), part] : [part]));
}

function folded(text) {
  return element("details", { className: "folded" }, element("summary", {}, `${text.slice(0, LONG)}…`), text);
}

/** Return the link to a line: the name of its file is enough, its path is in the title. */
function evidence(place, path) {
  const address = place.web ?? place.vscode;
  const shown = breakable(`${path.split("/").at(-1) || path}${place.line ? `:${place.line}` : ""}`);
  const parts = [element("span", { className: "evidence", title: path }, ...(address ? [element("a", { href: address }, ...shown)] : shown))];
  if (place.web && place.vscode) {
    const edit = element("a", { className: "editor", href: place.vscode }, "edit");
    edit.setAttribute("aria-label", `edit ${place.path}:${place.line}`);
    parts[0].append(" ", edit);
  }
  return parts;
}

function inferred(cells, row) {
  const [subject, predicate, object] = row.map(written);
  cells[2].append(" ", why("inferred: why", "/api/why", { subject, predicate, object }));
}

/** Return the link to a proof, which opens in the panel of the page. */
function why(text, path, values) {
  const query = new URLSearchParams(values);
  const node = element("a", { className: "why", href: url(`/why?${query}`) }, text);
  node.dataset.why = url(`${path}?${query}`);
  return node;
}
