"""The pages of nodes, systems and resources: proofs with and without scripts, pictures, unknown names."""

from __future__ import annotations

import re
from html import unescape
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import quote

import pytest
from listing import listed

from kg.server.libraries import HELP, libraries
from kg.server.pages import search
from kg.server.pages import system as systems
from kg.server.rendering import environment, view

if TYPE_CHECKING:
    from browsing import Chromium
    from listing import Shown
    from starlette.requests import Request
    from starlette.testclient import TestClient

_NEEDS_LIBRARIES = pytest.mark.skipif(not libraries(), reason=HELP)


def test_why_opens_by_keyboard(browser: Chromium, site: str, things: Shown) -> None:
    """Enter on `why` opens the proof in a panel, down to the line; Escape closes it and restores the focus."""

    async def prove() -> tuple[str, bool, str]:
        async with browser.visit(f"{site}/node?iri={things['node']}", kept=True) as visit:
            await visit.page.locator("table a.why").first.focus()
            await visit.page.keyboard.press("Enter")
            await visit.page.locator("#why[open]").wait_for()
            text = await visit.page.inner_text("#why")
            await visit.page.keyboard.press("Escape")
            closed = await visit.page.locator("#why[open]").count() == 0
            return text, closed, await visit.page.evaluate("document.activeElement.className")

    text, closed, focused = browser.run(prove())
    assert "by the rule communication/" in text
    assert "scan_filter_nodelet.cpp" in text
    assert (closed, focused) == (True, "why")


def test_why_is_a_link_without_scripts(browser: Chromium, site: str, things: Shown) -> None:
    """Without scripts `why` leads to a page with the same proof."""

    async def follow() -> tuple[str, str]:
        async with browser.visit(f"{site}/node?iri={things['node']}", java_script_enabled=False) as visit:
            await visit.page.locator("aside a.why").first.click()
            text = await visit.page.inner_text("#proof")
            return visit.page.url, text

    address, text = browser.run(follow())
    assert "/why?subject=" in address
    assert "by the rule" in text


_WIDER: Final = """() => [...document.querySelectorAll(".scrolls")]
  .filter((part) => part.scrollWidth > part.clientWidth).map((part) => part.querySelector("table").ariaLabel)"""
_NAVIGATION: Final = "[...document.querySelectorAll('.bar nav a')].map((link) => link.getBoundingClientRect().top)"


@pytest.mark.parametrize("width", [1200, 390])
def test_tables_of_a_node_fit_a_laptop_and_a_phone(browser: Chromium, site: str, things: Shown, width: int) -> None:
    """The last column of each table, with the lines of code, needs no scrolling; a count of one is singular."""

    async def look() -> tuple[list[str], str]:
        viewport = {"width": width, "height": 900}
        async with browser.visit(f"{site}/node?iri={things['node']}", kept=True, viewport=viewport) as visit:
            wider = await visit.page.evaluate(_WIDER)
            return wider, await visit.page.inner_text("#more-parameters")

    assert browser.run(look()) == ([], "1 parameter created by frameworks")


def test_a_phone_shows_first_what_a_node_is_about(browser: Chromium, site: str, things: Shown) -> None:
    """The first screen has function and hardware without weak ones, and the page links take one line of it."""

    async def look() -> tuple[list[str], set[float], float]:
        async with browser.visit(
            f"{site}/node?iri={things['node']}", kept=True, viewport={"width": 390, "height": 800}
        ) as visit:
            about = visit.page.locator(".narrow .tag")
            heights = await visit.page.evaluate(_NAVIGATION)
            box = await about.last.bounding_box()
            return await about.all_text_contents(), set(heights), box["y"] if box else 800

    about, heights, end = browser.run(look())
    assert {"data processing", "laser scanner"} <= set(about)
    assert "arm" not in about
    assert len(heights) == 1
    assert end < 500


_LOADED: Final = """async () => {
  const { load } = await import("/static/system.js");
  const host = document.body.appendChild(document.createElement("details"));
  host.id = "loaded";
  host.open = true;
  host.dataset.part = "/system?name=rover.launch&part=connections";
  host.innerHTML = `<summary>connections</summary><p><a href="${host.dataset.part}">a page</a></p>`;
  await load(host);
}"""
_DRAWN: Final = """async () => {
  const { draw } = await import("/static/graph.js");
  const host = document.body.appendChild(document.createElement("div"));
  const nodes = [...Array(100).keys()].map((number) => ({ id: `n${number}`, label: `node ${number}`, kind: "node" }));
  const picture = await draw(host, { nodes, edges: [{ source: "n0", target: "n1" }] });
  const box = picture.cy.nodes().boundingBox();
  return { shape: [box.w, box.h], zoom: picture.cy.zoom(), edges: picture.cy.edges().length };
}"""

_SEEN: Final = """async () => {
  const { cy } = document.querySelector(".graph-canvas")._cyreg;
  const view = cy.extent();
  const whole = ({ x1, y1, x2, y2 }) => x1 >= view.x1 && y1 >= view.y1 && x2 <= view.x2 && y2 <= view.y2;
  const seen = cy.nodes().filter((node) => node.isChildless() && whole(node.boundingBox()));
  return [seen.length, seen.edgesWith(seen).length];
}"""


@_NEEDS_LIBRARIES
def test_the_picture_of_a_system_is_switched(browser: Chromium, site: str) -> None:
    """Implicit interfaces are hidden by default; the list contains exactly the content of the picture."""

    async def switch() -> tuple[str, str]:
        async with browser.visit(f"{site}/system?name=rover.launch", kept=True) as visit:
            await visit.page.locator("#system-switches input").first.wait_for()
            before = await visit.page.inner_text(".graph-list summary")
            await visit.page.get_by_label("created by frameworks").check()
            return before, await visit.page.inner_text(".graph-list summary")

    before, after = (int(text.strip(")").rpartition("(")[2]) for text in browser.run(switch()))
    assert after > before > 0


@_NEEDS_LIBRARIES
def test_a_finding_is_shown_in_the_picture(browser: Chromium, site: str) -> None:
    """The button of a finding selects its subject, wherever it is."""

    async def show() -> str:
        async with browser.visit(f"{site}/system?name=mission.launch.xml", kept=True) as visit:
            await visit.page.locator("[data-finding]:visible").first.click()
            return await visit.page.inner_text(".graph-words")

    assert "connection" in browser.run(show())


def test_long_tables_are_pages_of_their_own(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """A table of many rows is absent from the page of its system, which links to the page of the table."""
    monkeypatch.setattr(systems, "_LONG", 10)
    text = client.get("/system", params={"name": "rover.launch"}).text
    address = "/system?name=rover.launch&amp;part=connections"
    assert f'<details data-part="{address}">' in text
    assert 'aria-label="Connections"' not in text
    assert 'aria-label="Connections"' in client.get(address.replace("&amp;", "&")).text


def test_long_tables_come_when_they_are_opened(browser: Chromium, site: str) -> None:
    """On opening, the link to such a table is replaced with the table and its tools."""

    async def load() -> tuple[int, int, int]:
        async with browser.visit(f"{site}/system?name=rover.launch", kept=True) as visit:
            await visit.page.evaluate(_LOADED)
            found = visit.page.locator("#loaded")
            counted = [await found.locator(one).count() for one in ("tbody tr", "a[href*=part]", "input[type=search]")]
            return counted[0], counted[1], counted[2]

    rows, links, filters = browser.run(load())
    assert rows > 10
    assert (links, filters) == (0, 1)


@_NEEDS_LIBRARIES
def test_what_nobody_joins_stands_in_rows(browser: Chromium, site: str) -> None:
    """Unconnected entities together fill a screen, and the view is never too small to read."""

    async def measure() -> tuple[list[float], float, int]:
        async with browser.visit(f"{site}/query", kept=True, viewport={"width": 390, "height": 800}) as visit:
            found = await visit.page.evaluate(_DRAWN)
            return found["shape"], found["zoom"], found["edges"]

    (width, height), zoom, edges = browser.run(measure())
    assert 0.3 < width / height < 3
    assert zoom > 0.4
    assert edges == 1


@_NEEDS_LIBRARIES
@pytest.mark.parametrize("width", [390, 1280])
def test_a_picture_opens_on_what_is_connected(browser: Chromium, site: str, width: int) -> None:
    """If a system is too large to read as a whole, several nodes and an edge between them are fully visible."""

    async def measure() -> list[int]:
        viewport = {"width": width, "height": 844}
        async with browser.visit(f"{site}/system?name=rover.launch", kept=True, viewport=viewport) as visit:
            await visit.page.locator(".graph-canvas canvas").first.wait_for()
            found: list[int] = await visit.page.evaluate(_SEEN)
            return found

    nodes, edges = browser.run(measure())
    assert nodes >= 4
    assert edges >= 3


def test_other_things_have_their_own_page(client: TestClient) -> None:
    """The page of nodes links to that of resources."""
    answer = client.get("/node", params={"iri": "https://w3id.org/rnkg/topic/scan_filtered"})
    assert answer.status_code == 303
    assert answer.headers["location"].startswith("/resource?iri=")


def _main(client: TestClient, address: str) -> str:
    """Return a page from its heading on to its folded facts."""
    text = client.get(address).text.partition("<h1>")[2]
    assert '<summary id="facts">All facts' in text
    return text.partition("<details>")[0].replace("<wbr>", "")


def test_a_package_begins_with_what_it_has_and_needs(client: TestClient) -> None:
    """Its nodes, launch files and types are lists, dependencies in the store are links, and facts are folded."""
    found = listed(client, "packages", "rover_robot")
    text = _main(client, f"/resource?iri={found['iri']}")
    assert text.count('href="/node?iri=') == found["nodes"] == 6
    assert 'href="/nodes?package=rover_robot&amp;repository=' in text
    assert 'href="/system?name=' in text
    (needed,) = re.findall(r"<dt>Needs</dt>\s*<dd>(.*)</dd>", text)
    assert ">rover_core</a>" in needed
    assert "catkin" not in needed
    assert re.search(r"<dt>Needs to build</dt>\s*<dd>catkin</dd>", text)
    assert re.search(r"From its README and manual.*callbacks as member function.*README\.md:\d+", text, re.DOTALL)
    assert 'href="/topics?package=rover_robot"' in text
    other = listed(client, "packages", "rover_core")
    assert other["definitions"] == 3
    assert ">rover_robot</a>" in _main(client, f"/resource?iri={other['iri']}")


def test_a_type_begins_with_its_fields_and_users(client: TestClient) -> None:
    """The definition in the store is a table with lines of code; nodes and topics of the type are lists."""
    found = listed(client, "types", "rover_core/WheelSpeeds")
    text = _main(client, f"/resource?iri={found['iri']}")
    assert "WheelSpeeds.msg:" in text
    assert text.count('href="/node?iri=') == found["nodes"] > 0
    assert 'href="/channel?kind=topic' in text


@pytest.mark.parametrize(("iri", "name"), [("hardware:laserScanner", "laser scanner"), ("function:control", "control")])
def test_a_class_begins_with_its_nodes(client: TestClient, iri: str, name: str) -> None:
    """Hardware and functions show their nodes, without the properties that select words and weights."""
    text = _main(client, f"/resource?iri={iri}")
    assert text.startswith(name)
    assert 'href="/node?iri=' in text
    assert "rnkg:least" not in text


def test_a_finding_has_its_line_and_what_to_do(client: TestClient) -> None:
    """The message is the title; launch file, code, rule and line follow."""
    found = listed(client, "findings", "")
    text = _main(client, f"/resource?iri={quote(found['iri'], safe='')}")
    assert text.startswith(unescape(found["message"])[:20])
    assert f'href="/errors/{found["code"]}"' in text
    assert f'href="/rule?name={found["rule"].replace("/", "%2F")}"' in text
    assert f"{found['file']}:{found['line']}" in text


def test_the_name_of_a_link_to_the_editor_begins_with_its_text() -> None:
    """A person who says the visible word to a browser chooses the link (WCAG 2.5.3)."""
    macros: Any = environment().get_template("macros.html").module
    place = dict.fromkeys(("repository", "commit")) | {"path": "src/a.cpp", "line": 3, "file": "/src/a.cpp"}
    text = str(macros.evidence(place | {"web": "https://example.org/a.cpp", "vscode": "vscode://file/src/a.cpp:3"}))
    assert 'aria-label="Edit src/a.cpp:3">edit</a>' in text


def test_the_page_of_a_topic(client: TestClient) -> None:
    """A resolved name has its nodes and launch files; systems and resources link to it; several matches are listed."""
    name = "/rover1/mux/cmd_vel"
    text = client.get("/channel", params={"name": name}).text
    assert "/rover1/base_controller" in text.replace("<wbr>", "")
    assert 'href="/system?name=rover_robot%2Flaunch%2Frover.launch"' in text
    address = 'href="/channel?kind=topic&amp;name=%2Frover1%2Fmux%2Fcmd_vel"'
    assert address in client.get("/system", params={"name": "rover.launch"}).text
    assert address in client.get("/channel", params={"name": "cmd_vel"}).text
    iri = "https://w3id.org/rnkg/topic/scan_filtered"
    assert 'href="/channel?name=https' in client.get("/resource", params={"iri": iri}).text
    assert client.get("/channel", params={"name": iri}).text.count("/scan_filtered") > 1


def test_code_that_may_have_a_name_and_definitions_are_shown(client: TestClient) -> None:
    """A name that no end has for certain shows the code that may have it; a type of the store has its line."""
    text = client.get("/channel", params={"name": "/ground/winch/report"}).text.replace("<wbr>", "")
    assert "perhaps, as" in text
    state = client.get("/channel", params={"name": "/drone1/state"}).text.replace("<wbr>", "")
    assert "FlightState.msg:1" in state


@pytest.mark.parametrize(
    ("address", "meant"),
    [
        ("/node?name=scan_fliter", 'href="/node?name=scan_filter"'),
        ("/system?name=rovr.launch", 'href="/system?name=rover.launch"'),
        ("/channel?kind=topic&name=/odomm", 'href="/channel?kind=topic&amp;name=%2Fodom"'),
        ("/resource?iri=https%3A%2F%2Fw3id.org%2Frnkg%2Ftopic%2Fscan_fliterd", ">/scan_filtered</a>"),
    ],
)
def test_names_that_are_not_there(client: TestClient, address: str, meant: str) -> None:
    """The page has status 404 and suggests similar names."""
    answer = client.get(address)
    assert answer.status_code == 404
    assert meant in answer.text


@pytest.mark.parametrize(
    ("address", "whole"), [("/node", "/search"), ("/channel", "/search"), ("/system", "/systems"), ("/rule", "/rules")]
)
def test_addresses_without_a_name(client: TestClient, address: str, whole: str) -> None:
    """An address without a name redirects to a list to choose from."""
    answer = client.get(address, follow_redirects=False)
    assert answer.status_code == 303
    assert answer.headers["location"] == whole


@pytest.mark.parametrize("address", ["/rule?name=zzzz", "/resource?iri=zzzz"])
def test_code_in_texts_of_errors(client: TestClient, address: str) -> None:
    """Code is marked as code; backticks are for terminals."""
    text = client.get(address, headers={"Accept": "text/html"}).text
    assert "<code>zzzz</code>" in text
    assert "`" not in text.split("<main", 1)[1]


def test_several_of_a_name(client: TestClient) -> None:
    """A name that is the end of several launch files lists all of them."""
    assert client.get("/system", params={"name": "launch"}).status_code == 404
    assert client.get("/api/system", params={"name": "nothing.launch"}).status_code == 404


def test_a_property_is_paged(client: TestClient) -> None:
    """The pages of a property link to the next and the previous one."""
    asked = {"iri": "ros:Publisher", "predicate": "rdf:type", "direction": "in", "limit": "5"}
    first = client.get("/resource", params=asked).text
    assert ">Next</a>" in first
    assert ">Previous</a>" not in first
    assert ">Previous</a>" in client.get("/resource", params={**asked, "offset": "5"}).text


def test_a_fact_that_does_not_hold(client: TestClient) -> None:
    """For a fact that does not hold, the page lists the missing conditions of each rule."""
    asked = {"subject": "scan_filter", "predicate": "rnkg:publishes", "object": "/odom"}
    answer = client.get("/why", params=asked)
    assert answer.status_code == 200
    assert "Why not:" in answer.text
    assert "fails" in answer.text


def test_a_fact_that_lacks_a_part(client: TestClient) -> None:
    """The parts of a fact are explained, with an example."""
    answer = client.get("/why", params={"subject": "patrol"})
    assert answer.status_code == 400
    assert "predicate=subscribes" in answer.text


def test_the_start_page_of_a_store_without_nodes(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """Counts of a store without nodes are zero."""

    async def bare(request: Request, name: str) -> Any:
        found = await view(request, name)
        return {**found, "counts": {}, "sources": [{**found["sources"][0], "nodes": 0, "packages": 1}]}

    monkeypatch.setattr(search, "view", bare)
    answer = client.get("/")
    assert answer.status_code == 200
    assert "0 ROS nodes in 1 package<" in answer.text
    assert "being counted" in answer.text
