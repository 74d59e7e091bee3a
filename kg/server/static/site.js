// Common to all pages: the theme switch, keys, dialogs, and sortable tables.

import { suggest } from "./find.js";
import { enhance } from "./table.js";

const THEMES = ["system", "light", "dark"];

/** Show the switch of the theme and store the choice. */
function themeSwitch(button) {
  const root = document.documentElement;
  const shown = () => root.dataset.theme ?? "system";
  const label = () => {
    const name = { system: "Auto", light: "Light", dark: "Dark" }[shown()];
    button.querySelector("span").textContent = name;
    button.setAttribute("aria-label", `${name}: switch between light and dark`);
  };
  button.addEventListener("click", () => {
    const next = THEMES[(THEMES.indexOf(shown()) + 1) % THEMES.length];
    if (next === "system") delete root.dataset.theme;
    else root.dataset.theme = next;
    try {
      if (next === "system") localStorage.removeItem("kg-theme");
      else localStorage.setItem("kg-theme", next);
    } catch {
      // Storage may be forbidden; the choice then holds for this page.
    }
    label();
    document.dispatchEvent(new CustomEvent("kg:theme"));
  });
  label();
  button.hidden = false;
}

/** Whether a key press is text for a field or an editor. */
function typing(target) {
  return target.isContentEditable || target.shadowRoot || /^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName);
}

function keys(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || typing(event.target)) return;
  if (event.key === "/") {
    event.preventDefault();
    const field = document.getElementById("find");
    field.focus();
    field.select();
  } else if (event.key === "?") {
    document.getElementById("keys").showModal();
  }
}

const panel = document.getElementById("why");
let latest = 0;

/** Open the proof of a derived fact in its panel; without why.js the link leads to the page that shows it. */
async function why(event) {
  const link = event.target.closest?.("a[data-why]");
  if (!link || event.ctrlKey || event.metaKey || event.shiftKey) return;
  event.preventDefault();
  const turn = ++latest;
  const { open } = panel;
  // The close event comes a little after the panel is closed.
  const wanted = () => turn === latest && (panel.open || !open);
  panel.setAttribute("aria-busy", "true");
  try {
    const { show } = await import("./why.js");
    await show(link.dataset.why, panel, document.getElementById("why-body"), wanted);
  } catch {
    if (wanted()) location.assign(link.href);
  }
  if (wanted()) panel.setAttribute("aria-busy", "false");
}

document.addEventListener("keydown", keys);
document.addEventListener("click", why);
panel.addEventListener("close", () => {
  latest += 1; // drop a pending answer
  panel.setAttribute("aria-busy", "false");
});
themeSwitch(document.getElementById("theme"));
for (const field of document.querySelectorAll("#find")) suggest(field); // the page that logs in has none
for (const button of document.querySelectorAll("[data-opens]")) {
  button.addEventListener("click", () => document.getElementById(button.dataset.opens).showModal());
  button.hidden = false;
}
for (const table of document.querySelectorAll("table[data-table]")) enhance(table);
