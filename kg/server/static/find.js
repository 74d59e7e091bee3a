// Names below the search box while somebody types; each leads to its page. Enter searches as without them.

import { url } from "./address.js";

const PAUSE = 150;

/** Offer the names that fit the text of `field`, in a list after it. */
export function suggest(field) {
  const list = document.createElement("div");
  list.className = "suggested";
  list.hidden = true;
  const status = document.createElement("span");
  status.className = "unseen";
  status.setAttribute("role", "status");
  field.after(list, status);
  let waiting;
  let wanted = "";

  const links = () => [...list.querySelectorAll("a")];
  function close() {
    wanted = "";
    list.hidden = true;
    status.textContent = "";
  }
  async function open() {
    const text = field.value.trim();
    wanted = text;
    if (text.length < 2) { close(); return; }
    const answer = await fetch(url(`/search?names=1&q=${encodeURIComponent(text)}`)).catch(() => null);
    const body = answer?.ok ? await answer.text().catch(() => "") : "";
    if (wanted !== text) return;
    list.replaceChildren(...new DOMParser().parseFromString(body, "text/html").body.children);
    const number = links().length;
    list.hidden = !number;
    status.textContent = number ? `${number} ${number === 1 ? "name" : "names"}; press the down arrow for them` : "";
  }
  function move(event) {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (event.key === "Escape" && !list.hidden) {
      event.preventDefault();
      close();
      field.focus();
    } else if (step && !list.hidden) {
      event.preventDefault();
      const every = [field, ...links()];
      every[(every.indexOf(document.activeElement) + step + every.length) % every.length].focus();
    }
  }

  field.addEventListener("input", () => { clearTimeout(waiting); waiting = setTimeout(open, PAUSE); });
  field.form.addEventListener("keydown", move);
  field.form.addEventListener("submit", () => { clearTimeout(waiting); close(); });
  field.form.addEventListener("focusout", (event) => { if (!field.form.contains(event.relatedTarget)) { clearTimeout(waiting); close(); } });
}
