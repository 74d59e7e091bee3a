// Places with names: those of the robot or of the server's file, and a point clicked in the picture from above.

import { element } from "../table.js";
import { takesPlace } from "./capable.js";

const number = (value, unit) => ({ expression: "value", value, unit });
const PICTURE = /<svg[^>]* data-left="(-?[\d.]+)" data-top="(-?[\d.]+)" data-scale="([\d.]+)"/;

/** Return the point of the world, in metres, that is shown at a share of the picture's width and height; null if it has no scale. */
export function pointOf(picture, across, down) {
  const [, left, top, scale] = picture.match(PICTURE)?.map(Number) ?? [];
  const [, width, height] = picture.match(/viewBox="0 0 (\d+) (\d+)"/)?.map(Number) ?? [];
  if (!scale || !width) return null;
  const round = (value) => Math.round(value * 100) / 100;
  return { x: round(left + across * width / scale), y: round(top - down * height / scale) };
}

/** The list of places. `act` has go(capability, values), add(capability, name), name(name, place). */
export class Places {
  constructor({ host, act }) {
    Object.assign(this, { host, act });
    this.places = {};
    this.point = null;
    this.name = "";
  }

  /** Show places; `capabilities` are those of the robot. */
  show(places, capabilities, { mayMove, blocks }) {
    Object.assign(this, { places, mayMove, blocks, goes: capabilities.find(takesPlace) });
    this.draw();
  }

  /** Offer a clicked point. */
  choose(point) {
    Object.assign(this, { point, name: "place" });
    this.draw();
    this.host.querySelector("input")?.focus();
  }

  draw() {
    const known = Object.entries(this.places);
    this.host.hidden = !this.goes || (!known.length && !this.point);
    if (this.host.hidden) return;
    const before = this.host.querySelector("input");
    const [typing, from, to] = [before !== null && before === document.activeElement, before?.selectionStart, before?.selectionEnd];
    this.host.replaceChildren(
      element("h3", {}, "Places"),
      ...(this.point ? [this.chosen(this.point)] : []),
      element("ul", { className: "plain" }, ...known.map(([name, place]) => element("li", { className: "row" }, element("span", {}, name), ...this.buttons(name, place)))),
    );
    if (!typing) return;
    const now = this.host.querySelector("input");
    now?.focus();
    now?.setSelectionRange(from, to);
  }

  buttons(name, place) {
    const go = element("button", { type: "button", disabled: !this.mayMove }, "Go there");
    go.setAttribute("aria-label", `Go there: ${name}`);
    const said = this.goes.parameters.filter((parameter) => place[parameter.name]).map((parameter) => [parameter.name, place[parameter.name]]);
    const values = Object.fromEntries(said.map(([part, { value, unit }]) => [part, `${value} ${unit}`]));
    go.addEventListener("click", () => this.act.go(this.goes, values));
    const add = element("button", { type: "button", className: "link", title: "Put a block that goes there into the program" }, "Add block");
    add.setAttribute("aria-label", `Add block: ${this.goes.label}, ${name}`);
    add.addEventListener("click", () => this.act.add(this.goes, name));
    return this.blocks ? [go, add] : [go];
  }

  /** Return the form for a clicked point: go there, or name it in the program. */
  chosen({ x, y }) {
    const place = { x: number(x, "m"), y: number(y, "m") };
    const form = element("form", { className: "robot-point" });
    const name = element("input", { id: "place-name", value: this.name, maxLength: 40, autocomplete: "off" });
    const label = element("label", { htmlFor: "place-name" }, `The point x ${x} m, y ${y} m as`);
    const [go] = this.buttons(`x ${x} m, y ${y} m`, place);
    name.addEventListener("input", () => { this.name = name.value; });
    form.append(label, name, element("div", { className: "row" }, element("button", {}, "Name it in the program"), go));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.act.name(name.value.trim() || "place", { expression: "place", ...place });
      this.point = null;
      this.draw();
    });
    return form;
  }
}
