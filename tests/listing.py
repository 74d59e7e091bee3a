"""The tested pages, by name; add a line here for each new page."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, TypedDict
from urllib.parse import quote

from browsing import axe

if TYPE_CHECKING:
    import httpx
    from browsing import Chromium, Visit
    from playwright.async_api import Page
    from starlette.testclient import TestClient

__all__ = ["PAGES", "Examined", "Shown", "examine", "inspect", "listed", "shown"]

PAGES: Final = {
    "start": "/",
    "login": "/login",
    "search, empty": "/search",
    "search": "/search?q=laser+scan",
    "search, filtered": "/search?q=&publishes=LaserScan",
    "search, a name": "/search?q=scan_filtered",
    "search, nothing": "/search?q=zzzzzz",
    "search, wrong filter": "/search?q=scan&hardware=flux+capacitor",
    "robot, none connected": "/robot",
    "query": "/query",
    "query, rows": "/query?name=explore/who-publishes&topic=/scan_filtered",
    "query, graph": "/query?query=CONSTRUCT+WHERE+%7B+%3Fn+rnkg%3Apublishes+%3Ft+%7D",
    "rules": "/rules",
    "rules, a family": "/rules?family=communication",
    "rules, searched": "/rules?q=wiring+robot",
    "rules, nothing": "/rules?q=zzzzzz",
    "rules, no such family": "/rules?family=comunication",
    "rule": "/rule?name=communication/feeds",
    "rule made of blocks": "/rule-blocks",
    "rule made of blocks, of a rule": "/rule-blocks?name=communication/feeds",
    "rule, missing": "/rule?name=communication/fed",
    "address, missing": "/nothing",
    "node": "/node?iri={node}",
    "node, misspelt": "/node?name=scan_fliter",
    "why": "/why?subject={node}&predicate=rnkg:hasFunction&object=function:dataProcessing",
    "why, a row": "/why?query=SELECT+%3Fn+%7B+%3Fn+a+rnkg%3ANodeType+%7D&row=%7B%22n%22%3A+%22%3C{node}%3E%22%7D",
    "why not": "/why?subject={node}&predicate=rnkg:hasFunction&object=function:localization",
    "nodes": "/nodes?sort=-publishes&kind=executable",
    "packages": "/packages",
    "topics": "/topics?limit=5&offset=5",
    "services": "/services",
    "actions": "/actions",
    "types": "/types",
    "hardware": "/hardware",
    "functions": "/functions",
    "capabilities": "/capabilities",
    "systems": "/systems",
    "parameters": "/parameters",
    "findings": "/findings",
    "classes": "/classes",
    "properties": "/properties?subject=ros:Publisher",
    "nodes, nothing": "/nodes?q=zzzzzz",
    "system": "/system?name=drone.launch.py",
    "system, with a finding": "/system?name=mission.launch.xml&every=all",
    "system, a table of it": "/system?name=rover.launch&part=connections",
    "topic": "/channel?kind=topic&name=/scan_filtered",
    "package": "/resource?iri={package}",
    "type": "/resource?iri={type}",
    "kind of hardware": "/resource?iri=hardware:laserScanner",
    "finding": "/resource?iri={finding}",
    "resource": "/resource?iri=ros:Publisher",
    "resource, one property": "/resource?iri=ros:Publisher&predicate=rdf:type&direction=in&limit=5&offset=5",
}
"""Name to path; braces enclose a key of `Shown`."""

_PHONE: Final = 390
_LAPTOP: Final = 1024
_CUT: Final = """() => [...document.querySelectorAll(".scrolls:has(> table)")]
  .filter((one) => one.scrollWidth > one.clientWidth).map((one) => one.getAttribute("aria-label") ?? one.outerHTML)"""
_MOST: Final = 60
"""Number of elements reached by Tab; longer lists only repeat."""
_FOCUSABLE: Final = "a[href], button, input:not([type=hidden]), select, textarea, summary, [tabindex='0']"
_LISTEN: Final = f"""() => {{
  const all = [...document.querySelectorAll("{_FOCUSABLE}")].filter((one) =>
    one.checkVisibility({{visibilityProperty: true}}) && !one.disabled && one.tabIndex >= 0).slice(0, {_MOST});
  window.kgWalk = {{ all, seen: new Set(), ringless: [] }};
  document.addEventListener("focusin", ({{ target }}) => {{
    window.kgWalk.seen.add(target);
    // Editors and drawings show the focus by themselves.
    if (target.shadowRoot || target instanceof SVGElement) return;
    if (getComputedStyle(target).outlineStyle === "none") window.kgWalk.ringless.push(target);
  }});
  return all.length;
}}"""
_WALKED: Final = """() => {
  const { all, seen, ringless } = window.kgWalk;
  const shown = (list) => list.map((one) => one.outerHTML.slice(0, 120));
  const reached = (one) => [...seen].some((other) => one.contains(other));
  return [shown(all.filter((one) => !reached(one))), shown(ringless)];
}"""


class Shown(TypedDict):
    """Entities of the example workspace, quoted for addresses."""

    node: str
    package: str
    type: str
    finding: str


@dataclass(frozen=True, slots=True)
class Examined:
    """The findings about a page.

    `status`, problems (`Visit.troubles`), axe violations in light, and in dark on a phone, the number of links to the
    page as JSON, elements unreachable by Tab, elements without a visible focus, tables cut off on a small laptop, the
    width of the page on a phone.
    """

    status: int
    troubles: list[str]
    light: list[str]
    dark: list[str]
    twins: int
    missed: list[str]
    ringless: list[str]
    cut: list[str]
    width: int


def shown(client: httpx.Client | TestClient) -> Shown:
    """Ask the server for the entities shown by the pages."""
    (hit, *_) = client.get("/api/find", params={"text": "scan_filter"}).raise_for_status().json()["hits"]
    return {
        "node": quote(hit["iri"], safe=""),
        "package": _iri(client, "packages", "rover_core"),
        "type": _iri(client, "types", "rover_core/"),
        "finding": _iri(client, "findings", ""),
    }


def _iri(client: httpx.Client | TestClient, of: str, text: str) -> str:
    return quote(listed(client, of, text)["iri"], safe="")


def listed(client: httpx.Client | TestClient, of: str, text: str) -> dict[str, Any]:
    """Return the first row of a list with some words."""
    asked = {"of": of, "text": text, "limit": "1"}
    row: dict[str, Any] = client.get("/api/list", params=asked).raise_for_status().json()["rows"][0]
    return row


async def examine(browser: Chromium, address: str) -> Examined:
    """Open a page and examine it."""
    async with browser.visit(address, kept=True, color_scheme="light") as visit:
        return await inspect(visit)


async def inspect(visit: Visit) -> Examined:
    """Examine an open page, loaded in light."""
    light = await _accessible(visit)
    twins = await visit.page.locator("footer a[type='application/json']").count()
    missed, ringless = await _walked(visit.page)
    await visit.page.set_viewport_size({"width": _LAPTOP, "height": 800})
    cut = await visit.page.evaluate(_CUT)
    await visit.page.set_viewport_size({"width": _PHONE, "height": 800})
    width = await visit.page.evaluate("document.documentElement.scrollWidth")
    await visit.page.emulate_media(color_scheme="dark")
    dark = await _accessible(visit)
    return Examined(visit.status, await visit.troubles(), light, dark, twins, missed, ringless, cut, width)


async def _accessible(visit: Visit) -> list[str]:
    return await visit.violations() if axe() else []


async def _walked(page: Page) -> tuple[list[str], list[str]]:
    """Press Tab from the top; return the elements never reached, and those without a ring when focused.

    To wait for each press before the next takes twice the processor time.
    """
    await asyncio.gather(*(page.keyboard.press("Tab") for _ in range(await page.evaluate(_LISTEN) + 2)))
    missed, ringless = await page.evaluate(_WALKED)
    return missed, ringless
