// Sortable, filterable and paged tables.
//
//   enhance(table, { page: 50 })            a table that the server wrote; `data-table` on it does the same
//   const built = build({ columns, rows })   a table from data; put `built.element` into the page
//
// A column is { name, label?, number?, cell? }; `cell(value, row)` returns a text or a node. Data are shown as text.
// Tables of fewer than ten rows, and those with data-tools="none", get no filter and no pages. Cells sort by `data-sort` where they have it, else by their text.

const COLLATOR = new Intl.Collator(undefined, { numeric: true, sensitivity: "base" });
const FEW = 10;

/** Return an element with properties and children; children that are texts stay texts. */
export function element(name, properties = {}, ...children) {
  const created = Object.assign(document.createElement(name), properties);
  created.append(...children.filter((child) => child !== null && child !== undefined));
  return created;
}

const key = (row, column) => row.cells[column]?.dataset.sort ?? row.cells[column]?.textContent.trim() ?? "";

/** Give a table its tools; returns { refresh }, to be called when its rows have changed. */
export function enhance(table, { page = Number(table.dataset.page) || 50 } = {}) {
  const body = table.tBodies[0];
  if (!body || table.dataset.enhanced) return { refresh() {} };
  table.dataset.enhanced = "yes";
  let rows = [...body.rows];
  let first = 0;
  let sorted = null;
  const name = table.caption?.textContent.trim() || table.getAttribute("aria-label") || "the table";
  const filter = element("input", { type: "search", placeholder: "Filter these rows" });
  filter.setAttribute("aria-label", `Filter ${name}`);
  const words = element("span");
  words.setAttribute("role", "status");
  const before = element("button", { type: "button" }, "Previous");
  const after = element("button", { type: "button" }, "Next");
  const tools = element("div", { className: "table-tools" }, filter, words, before, after);

  const shown = () => {
    const wanted = filter.value.trim().toLowerCase();
    return wanted ? rows.filter((row) => row.textContent.toLowerCase().includes(wanted)) : rows;
  };
  const draw = () => {
    const found = shown();
    first = Math.min(first, Math.max(0, found.length - 1));
    first -= first % page;
    body.replaceChildren(...found.slice(first, first + page));
    const last = Math.min(first + page, found.length);
    const range = found.length > page ? `${first + 1}–${last} of ` : "";
    const all = found.length < rows.length ? ` (of ${rows.length.toLocaleString("en")})` : "";
    words.textContent = `${range}${found.length.toLocaleString("en")} ${found.length === 1 ? "row" : "rows"}${all}`;
    before.hidden = after.hidden = found.length <= page;
    before.disabled = first === 0;
    after.disabled = last >= found.length;
  };
  const sort = (heading, column) => {
    const way = sorted === column && heading.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", way > 0 ? "ascending" : "descending");
    sorted = column;
    rows.sort((one, other) => way * COLLATOR.compare(key(one, column), key(other, column)));
    first = 0;
    draw();
  };
  const headings = () => {
    [...(table.tHead?.rows[0]?.cells ?? [])].forEach((heading, column) => {
      if (heading.dataset.plain !== undefined || !heading.textContent.trim()) return;
      const button = element("button", { type: "button", className: "sort" }, ...heading.childNodes);
      button.addEventListener("click", () => sort(heading, column));
      heading.replaceChildren(button);
    });
  };

  filter.addEventListener("input", () => { first = 0; draw(); });
  before.addEventListener("click", () => { first -= page; draw(); });
  after.addEventListener("click", () => { first += page; draw(); });
  if (rows.length > 1) headings();
  if (rows.length >= FEW && table.dataset.tools !== "none") {
    (table.closest(".scrolls") ?? table).before(tools);
    draw();
  }
  return { refresh() { rows = [...body.rows]; draw(); } };
}

/** Return { element, table } of a table made from data. `caption` names it; `page` is how many rows are shown at once. */
export function build({ columns, rows, caption = "", page = 50 }) {
  const head = element("tr", {}, ...columns.map((column) => {
    const cell = element("th", { scope: "col", className: column.number ? "number" : "" }, column.label ?? column.name);
    return cell;
  }));
  const body = element("tbody", {}, ...rows.map((row) => element("tr", {}, ...columns.map((column, index) => {
    const value = Array.isArray(row) ? row[index] : row[column.name];
    const cell = element("td", { className: column.number ? "number" : "" });
    cell.append(column.cell ? column.cell(value, row) : String(value ?? ""));
    return cell;
  }))));
  const table = element("table", {}, caption ? element("caption", {}, caption) : null, element("thead", {}, head), body);
  const scrolls = element("div", { className: "scrolls", tabIndex: 0 }, table);
  scrolls.setAttribute("role", "region");
  scrolls.setAttribute("aria-label", caption || "Table");
  const holder = element("div", {}, scrolls);
  enhance(table, { page });
  return { element: holder, table };
}
