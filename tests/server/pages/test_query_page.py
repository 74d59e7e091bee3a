"""The query page: writing with completions, running, and working with the result."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final
from urllib.parse import urlencode

import httpx
import pytest
from browsing import Visit
from patience import patient
from querypage import NAMES, RUNAWAY, editing, idle, ran, told, typed, visited

if TYPE_CHECKING:
    from browsing import Chromium
    from listing import Shown

SUGGESTED: Final = ".cm-tooltip-autocomplete:not(.cm-tooltip-autocomplete-disabled) li[aria-selected]"


@editing
def test_completion_knows_the_class_and_declares_prefixes(browser: Chromium, site: str) -> None:
    """Keys alone complete a class and one of its properties, declare each prefix, and run the query."""

    async def write(visit: Visit) -> tuple[str, str, str]:
        await typed(visit, "SELECT * WHERE {\n?x ")
        for keys, wanted in (("a rnkg:NodeT", "^rnkg:NodeType"), (" ; publi", "^rnkg:publishes")):
            await visit.page.keyboard.type(keys, delay=20)
            chosen = visit.page.locator(SUGGESTED, has_text=re.compile(wanted))
            await chosen.wait_for()
            detail = await chosen.text_content()
            # The library ignores a completion shown only for a moment, to avoid accepting it unread.
            await visit.page.wait_for_timeout(150)
            await visit.page.keyboard.press("Tab")
        await visit.page.keyboard.type(" ?topic", delay=20)
        await visit.page.keyboard.press("Escape")
        await visit.page.keyboard.press("Control+End")
        await visit.page.keyboard.type(" }")
        await visit.page.keyboard.press("Control+Enter")
        return await visit.page.locator("#query-text").input_value(), str(detail), await ran(visit)

    text, detail, end = visited(browser, site, write)
    assert text.startswith(
        "PREFIX rnkg: <https://w3id.org/rnkg/ns#>\nSELECT * WHERE {\n?x a rnkg:NodeType ; rnkg:publishes ?topic"
    )
    assert re.search(r"rnkg:publishes\d+ of \d+ rnkg:NodeType", detail)
    assert re.match(r"\d+ rows in ", end)


@editing
def test_what_is_wrong_is_underlined(browser: Chromium, site: str) -> None:
    """The error is underlined after a tab and an emoji; its fix, applied by keyboard, corrects it (C33)."""

    async def mistake(visit: Visit) -> tuple[str, str, str, int]:
        await typed(visit, "SELECT * {\n\t?s ?p '\U0001f600' FILTR(?s != ?p) }")
        mark = visit.page.locator(".cm-lintRange-error")
        await mark.wait_for()
        under, problem = await mark.text_content(), await visit.page.locator("#problems").text_content()
        await visit.page.locator("#problems .fix").focus()
        await visit.page.keyboard.press("Enter")
        await mark.wait_for(state="detached")
        await visit.page.locator("#problems li").wait_for(state="detached")
        return (
            str(under),
            str(problem),
            await visit.page.locator("#query-text").input_value(),
            await visit.page.locator("#problems li").count(),
        )

    under, problem, text, left = visited(browser, site, mistake)
    assert under == "FILTR"
    assert "2:12 expected a pattern or }, found FILTR. Did you mean FILTER?" in problem
    assert "FILTER(?s != ?p)" in text
    assert left == 0


@editing
def test_names_are_explained(browser: Chromium, site: str) -> None:
    """Hovering over a name shows its description from the store."""

    async def point(visit: Visit) -> str:
        await typed(visit, "SELECT * { ?n rnkg:publishes ?t }")
        await visit.page.get_by_text("rnkg:publishes").first.hover()
        return str(await visit.page.locator(".kg-hover").text_content())

    assert "A topic that the node writes to" in visited(browser, site, point)


def test_rows_lead_to_code_and_things(browser: Chromium, site: str) -> None:
    """A stored query with a value runs at once; its lines and entities are links, its columns sort."""

    async def rows(visit: Visit) -> tuple[str, list[str], str, str, str]:
        end = await ran(visit)
        page = visit.page
        await page.wait_for_selector("#result .evidence, #result td")
        await page.locator("#result th button", has_text=re.compile("^node$")).click()
        nodes = await page.locator("#result tbody td:nth-child(3)").all_text_contents()
        form = await page.locator("#stored-form h3").text_content()
        value = await page.locator("#stored-form input").input_value()
        line = page.locator("#result .evidence a").first
        code = f"{await line.text_content()} {await line.get_attribute('href')}"
        return end, nodes, str(form), value, code

    end, nodes, form, value, code = visited(browser, site, rows, name="explore/who-publishes", topic="/scan_filtered")
    assert re.match(r"\d+ rows? in [\d.]+ s, snapshot \d+", end)
    assert nodes == sorted(nodes, key=str.lower)
    assert (form, value) == ("Publishers of a topic", "/scan_filtered")
    assert re.fullmatch(r"scan_filter_nodelet\.cpp:\d+ (vscode://file/|https://).*", code)


_ASKED: Final = {
    "interface-of-node": {"node": "flight_controller"},
    "parameters-of-node": {"node": "flight_controller"},
    "nodes-by-type": {"type": "sensor_msgs/LaserScan"},
}


@pytest.mark.parametrize("name", _ASKED)
def test_answers_of_the_first_questions_fit_a_laptop(browser: Chromium, site: str, name: str) -> None:
    """At 1280 pixels lines of code and reasons are next to the rest, and no cell is wider than its column."""

    async def look(visit: Visit) -> tuple[list[int], list[str], list[str]]:
        page = visit.page
        await page.set_viewport_size({"width": 1280, "height": 900})
        await page.locator("#result .evidence a").first.wait_for()
        sizes = await page.locator("#result .scrolls").evaluate("one => [one.scrollWidth, one.clientWidth]")
        over = await page.locator("#result td").evaluate_all(
            "all => all.filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => one.textContent)"
        )
        return sizes, over, await page.locator("#result th").all_text_contents()

    (whole, seen), over, headings = visited(browser, site, look, name=f"explore/{name}", **_ASKED[name])
    assert not over
    assert whole <= seen
    assert "file:line" in headings


_HIDDEN: Final = """() => [...document.querySelectorAll("#result tbody td:not(.reason)")].filter((cell) => {
  const why = cell.parentElement.querySelector(".reason").getBoundingClientRect();
  return cell.getBoundingClientRect().right > why.left + 1;
}).map((cell) => cell.textContent)"""


@pytest.mark.parametrize("width", [390, 1280])
def test_no_cell_lies_under_the_reasons(browser: Chromium, site: str, width: int) -> None:
    """Long names are cut, with the full name as title; two columns and the reasons fit a phone."""

    async def look(visit: Visit) -> tuple[list[str], list[int], str]:
        page = visit.page
        await page.set_viewport_size({"width": width, "height": 844})
        await page.locator("#result a.why").first.wait_for()
        sizes = await page.locator("#result .scrolls").evaluate("one => [one.scrollWidth, one.clientWidth]")
        title = await page.locator("#result a[data-iri]").first.get_attribute("title")
        return await page.evaluate(_HIDDEN), sizes, str(title)

    query = "SELECT ?node ?topic { ?node rnkg:publishes ?topic } LIMIT 20"
    hidden, (whole, seen), title = visited(browser, site, look, query=query)
    assert not hidden
    assert whole <= seen
    assert title.startswith("https://w3id.org/rnkg/")


LONG: Final = f"# {'long ' * 2000}\n{NAMES}"


@pytest.mark.parametrize("query", [NAMES, LONG], ids=["short", "too long for an address"])
def test_rows_say_why_they_are_there(browser: Chromium, site: str, query: str) -> None:
    """Each row has a link to the facts matched by the query, down to the line of code."""

    async def proof(visit: Visit) -> tuple[list[str], str, int]:
        await ran(visit)
        await visit.page.locator("#tab-new").click()
        await typed(visit, query)
        await visit.page.locator("#run").click()
        await visit.page.locator("#result a.why").first.click()
        await visit.page.wait_for_selector("#why[open] .proof")
        facts = await visit.page.locator("#why .fact").all_text_contents()
        row = await visit.page.locator("#why dl.facts").text_content()
        return facts, str(row), await visit.page.locator("#why .proof .evidence").count()

    facts, row, lines = visited(browser, site, proof, query="ASK {}")
    assert [fact.split()[1] for fact in facts] == ["rdf:type", "rnkg:name"]
    assert row.strip().startswith("?name")
    assert lines > 0


def test_rows_without_facts_of_their_own_say_so(site: str) -> None:
    """A row that cannot be traced back is not an error: the page suggests another question."""
    asked = {"query": NAMES, "row": '{"n": "<urn:x>"}'}
    with httpx.Client(base_url=site, timeout=patient(10)) as client:
        for answer in (client.get("/why", params=asked), client.post("/why", data=asked)):
            assert answer.status_code == 404
            assert "cannot be traced back to facts" in answer.text
        wrong = client.get("/why", params={"query": "SELECT ?n", "row": "{}"})
        assert wrong.status_code == 400
        assert "found the end of the text" in wrong.text
        of_group = client.get("/why", params={"query": "SELECT (COUNT(*) AS ?n) { ?s ?p ?o }", "row": "{}"})
        assert "one of 1,000 or more solutions" in of_group.text
        refused = client.get("/why", params={"query": NAMES, "row": "[]"}, headers={"Accept": "application/json"})
        assert refused.json()["code"] == "KG003"


def test_triples_say_which_are_inferred(browser: Chromium, site: str) -> None:
    """A graph is a picture and a table; in the table derived triples link to their proof."""

    async def graph(visit: Visit) -> tuple[int, int, str]:
        await ran(visit)
        pictures = await visit.page.locator(".query-picture").count()
        await visit.page.get_by_role("button", name="Table", exact=True).click()
        await visit.page.wait_for_selector("#result a.why")
        marked = await visit.page.locator("#result a.why").count()
        return pictures, marked, str(await visit.page.locator("#result a.why").first.get_attribute("data-why"))

    query = "CONSTRUCT { ?n rnkg:publishes ?t ; a rnkg:NodeType } WHERE { ?n a rnkg:NodeType ; rnkg:publishes ?t }"
    pictures, marked, address = visited(browser, site, graph, query=query)
    assert pictures == 1
    assert marked > 0
    found = httpx.get(f"{site}{address}", timeout=patient(10)).raise_for_status()
    assert found.json()["proofs"]


_PICTURED: Final = """() => document.querySelector("#result .graph-canvas")._cyreg.cy.nodes()
  .map((node) => [node.data("text") ?? node.data("label"), node.data("kind") ?? "group", node.data("parent") ?? ""])"""


@editing
def test_a_picture_calls_things_as_the_store_does(browser: Chromium, site: str) -> None:
    """A picture shows entities with their names and shapes even if the graph lacks both, grouped by node namespace."""

    async def graph(visit: Visit) -> list[list[str]]:
        await ran(visit)
        await visit.page.locator("#result .graph-canvas canvas").first.wait_for()
        return [list(one) for one in await visit.page.evaluate(_PICTURED)]

    pictured = visited(browser, site, graph, query="CONSTRUCT WHERE { ?n a rnkg:NodeInstance ; rnkg:publishes ?t }")
    assert ["flight_controller", "node", "/drone1"] in pictured
    assert ["camera/stabilized/compressed", "topic", "/drone1"] in pictured
    assert ["/drone1", "group", ""] in pictured


@editing
def test_a_stored_query_is_shown_behind_its_documentation(browser: Chromium, site: str) -> None:
    """The low editor of a stored query that runs at once begins at its first line of SPARQL."""

    async def look(visit: Visit) -> bool:
        await ran(visit)
        seen = visit.page.locator(".cm-line", has_text="SELECT ?topic").first
        box, editor = await seen.bounding_box(), await visit.page.locator("#editor").bounding_box()
        assert box is not None
        assert editor is not None
        return editor["y"] <= box["y"] + 1 < editor["y"] + editor["height"] / 2

    assert visited(browser, site, look, name="explore/who-publishes", topic="/scan_filtered")


@editing
def test_a_picture_grows_by_neighbours(browser: Chromium, site: str, things: Shown) -> None:
    """The page of a thing leads to its relations as a picture, which adds those of a selected thing, twice over."""

    async def grow(visit: Visit) -> list[list[list[str]]]:
        page = visit.page
        await page.get_by_role("link", name="Its relations as a picture").click()
        await ran(visit)
        await page.locator("#result .graph-canvas canvas").first.wait_for()
        seen = [await page.evaluate(_PICTURED)]
        for name in ("/scan_filtered", "rover_robot"):
            await page.locator(".graph-tools input").fill(name)
            await page.keyboard.press("Enter")
            await page.get_by_role("button", name="Add its neighbours").click()
            more = "(number) => document.querySelector('#result .graph-canvas')._cyreg.cy.nodes().length > number"
            await page.wait_for_function(more, arg=len(seen[-1]))
            seen.append(await page.evaluate(_PICTURED))
        return seen

    async def visit() -> list[list[list[str]]]:
        async with browser.visit(f"{site}/resource?iri={things['node']}", kept=True) as opened:
            found = await grow(opened)
            assert await opened.troubles() == []
            return found

    first, second, third = browser.run(visit())
    assert len(first) < len(second) < len(third)
    assert ["/scan_filtered", "topic", ""] in first


def test_cancel_ends_the_work(browser: Chromium, site: str) -> None:
    """A running query shows its seconds; Cancel, reached by Tab, ends it on the server, too (C15)."""

    async def stop(visit: Visit) -> tuple[str, str]:
        page = visit.page
        running = await told(visit, r"^[1-9]\d*\.\d s")
        await page.locator("#cancel").focus()
        await page.keyboard.press("Enter")
        return running, await ran(visit)

    async def visit() -> tuple[str, str]:
        async with browser.visit(f"{site}/query?name=explore/topics", kept=True) as opened:
            # Opened by its text in the field: a page that runs a query at once is never idle.
            await opened.page.goto(f"{site}/query?{urlencode({'query': RUNAWAY})}", wait_until="load")
            return await stop(opened)

    running, end = browser.run(visit())
    assert re.match(r"[\d.]+ s", running)
    assert end.startswith("cancelled after")
    assert idle(site) == []


def test_an_old_link_says_that_the_data_has_changed(browser: Chromium, site: str) -> None:
    """A link with another snapshot shows no rows until the user requests current ones (C31)."""

    async def follow(visit: Visit) -> tuple[str, int, str]:
        await ran(visit)
        notice = await visit.page.locator("#notices").text_content()
        rows = await visit.page.locator("#result td").count()
        await visit.page.get_by_role("button", name="Run it on the data as it is now").click()
        await visit.page.wait_for_selector("#result .yes-or-no")
        return str(notice), rows, str(await visit.page.locator("#result .yes-or-no").text_content())

    notice, rows, answer = visited(browser, site, follow, query="ASK { ?n a rnkg:NodeType }", snapshot="99")
    assert notice.startswith("The data has changed since this link was made (it was snapshot 99")
    assert (rows, answer) == (0, "Yes")


def test_a_query_is_shared_with_its_snapshot(browser: Chromium, site: str) -> None:
    """A shared link contains the query and its snapshot, and gives the same result."""

    async def share(visit: Visit) -> tuple[str, str, str]:
        end = await ran(visit)
        await visit.page.get_by_role("button", name="Share").click()
        link = await visit.page.locator("#share-link").input_value()
        await visit.page.goto(link, wait_until="load")
        return end, link, await ran(visit)

    end, link, again = visited(browser, site, share, query=NAMES)
    (snapshot,) = re.findall(r"snapshot (\d+)", end)
    assert link.endswith(f"&snapshot={snapshot}")
    assert again.split(" in ")[0] == end.split(" in ")[0]


@editing
def test_a_link_opens_the_tab_that_it_opened_before(browser: Chromium, site: str) -> None:
    """Following a link again opens no second tab; an edited query is preserved, with a notice."""

    async def follow(visit: Visit) -> tuple[list[str], str, str, list[str]]:
        page = visit.page
        await ran(visit)
        await page.reload(wait_until="load")
        await ran(visit)
        await typed(visit, "ASK {}")
        await page.reload(wait_until="load")
        notice = str(await page.locator("#notices p").text_content())
        tabs = await page.locator("#tabs [role=tab]").all_text_contents()
        kept = await page.locator("#query-text").input_value()
        await page.get_by_role("button", name="Run the query of the link").click()
        await ran(visit)
        return tabs, kept, notice, await page.locator("#tabs [role=tab]").all_text_contents()

    tabs, kept, notice, then = visited(browser, site, follow, query=NAMES)
    assert (tabs, kept, then) == (["Query 1"], "ASK {}", ["Query 1", "Query 2"])
    assert "was changed since in this tab" in notice


def test_errors_of_the_endpoint_are_told_with_their_place(browser: Chromium, site: str) -> None:
    """An error of the endpoint is shown with its code, its place and a suggestion."""

    async def fail(visit: Visit) -> str:
        await ran(visit)
        return str(await visit.page.locator("#notices").text_content())

    said = visited(browser, site, fail, query="SELECT * {\n ?s foaf:name ?o }")
    assert said == (
        "the prefix foaf: is not declared at line 2, column 5"
        "KG501 Declare it: PREFIX foaf: <http://xmlns.com/foaf/0.1/>"
    )


def test_more_rows_and_files(browser: Chromium, site: str) -> None:
    """A truncated result is marked and offers the next rows; links save all of it in each format."""

    async def more(visit: Visit) -> tuple[str, str, str, list[str]]:
        page = visit.page
        await ran(visit)
        await page.locator("#settings-panel summary").click()
        await page.locator("#set-limit").fill("3")
        await page.locator("#set-limit").press("Tab")
        await page.locator("#run").click()
        await page.wait_for_selector("#notices button")
        first = str(await page.locator("#progress").text_content())
        notice = str(await page.locator("#notices").text_content())
        await page.get_by_role("button", name="Get more").click()
        await told(visit, " 6 rows")
        links = await page.locator("#exports-rows a").evaluate_all("all => all.map((one) => one.href)")
        return first, notice, str(await page.locator("#progress").text_content()), links

    first, notice, then, links = visited(browser, site, more, query=NAMES)
    assert first.startswith("the first 3 rows in")
    assert notice.startswith("There are more than these 3")
    assert then.startswith("the first 6 rows in")
    for link in links:
        assert httpx.get(link, timeout=patient(10)).status_code == 200


def test_tabs_and_history_stay_in_the_browser(browser: Chromium, site: str) -> None:
    """Texts and past queries are restored when the page is opened again; the history can be searched."""

    async def reopen(visit: Visit) -> tuple[list[str], str, int, str]:
        page = visit.page
        await ran(visit)
        await page.locator("#tab-new").click()
        await page.keyboard.insert_text("ASK {}")
        await page.goto(f"{site}/query", wait_until="load")
        await page.locator("#tabs [role=tab]").nth(1).wait_for()
        tabs = await page.locator("#tabs [role=tab]").all_text_contents()
        text = await page.locator("#query-text").input_value()
        await page.locator("#history-panel summary").click()
        await page.locator("#history-filter").fill("nothing like it")
        none = await page.locator("#history-list .entry").count()
        await page.locator("#history-filter").fill("nodetype NAME")
        await page.locator("#history-list .entry").click()
        return tabs, text, none, await page.locator("#query-text").input_value()

    tabs, text, none, back = visited(browser, site, reopen, query=NAMES)
    assert tabs == ["Query 1", "Query 2"]
    assert (text, none, back) == ("ASK {}", 0, NAMES)


def test_stored_queries_take_values(browser: Chromium, site: str) -> None:
    """A stored query is found by its words, asks for its parameters, and runs with their values."""

    async def choose(visit: Visit) -> tuple[str, str]:
        page = visit.page
        await page.locator("#stored-filter").fill("subscribes topic")
        await page.locator("#stored-list .entry").first.click()
        await page.keyboard.insert_text("cmd_vel")
        await page.keyboard.press("Enter")
        end = await ran(visit)
        return await page.locator("#query-text").input_value(), end

    text, end = visited(browser, site, choose)
    assert 'VALUES ?topic { "/cmd_vel" }' in text
    assert " in " in end


def test_works_without_libraries(browser: Chromium, site: str) -> None:
    """Without the editor a plain field is used: problems, Ctrl-Enter and results work as usual."""

    async def plain() -> tuple[str, str, int]:
        async with browser.visit(f"{site}/rules", kept=True) as visit:
            await visit.page.route("**/vendor/**", lambda route: route.abort())
            await visit.page.goto(f"{site}/query", wait_until="load")
            await visit.page.wait_for_selector("#tabs [role=tab]")
            field = visit.page.locator("#query-text")
            await field.fill("ASK { ?x rnkg:publshes ?y }")
            await visit.page.wait_for_selector("#problems li")
            problem = str(await visit.page.locator("#problems li").text_content())
            await field.press("Control+Enter")
            await ran(visit)
            return (
                problem,
                str(await visit.page.locator(".yes-or-no").text_content()),
                await visit.page.locator(".cm-content").count(),
            )

    problem, answer, editors = browser.run(plain())
    assert "rnkg:publshes is not in the store. Did you mean rnkg:publishes" in problem
    assert (answer, editors) == ("No", 0)


def test_results_are_text(browser: Chromium, site: str) -> None:
    """Markup in literals is shown literally, and no IRI of data becomes the address of a link (C27)."""

    async def show(visit: Visit) -> tuple[list[str], list[str], bool]:
        await ran(visit)
        cells = await visit.page.locator("#result td:not(.reason)").all_text_contents()
        links = await visit.page.locator("#result td:not(.reason) a").evaluate_all(
            "all => all.map((one) => one.getAttribute('href'))"
        )
        return cells, links, bool(await visit.page.evaluate("window.kgBroken === undefined"))

    literal = "<img src=x onerror=window.kgBroken=1>"
    query = f'SELECT ("{literal}" AS ?text) (IRI("javascript:window.kgBroken=1") AS ?thing) {{}}'
    cells, links, whole = visited(browser, site, show, query=query)
    assert cells == [literal, "javascript:window.kgBroken=1"]
    assert links == ["/resource?iri=javascript%3Awindow.kgBroken%3D1"]
    assert whole


@editing
def test_each_window_keeps_its_own_tabs(browser: Chromium, site: str) -> None:
    """A second window starts with the tabs of the first; its edits do not affect those of the first."""

    async def both(visit: Visit) -> tuple[str, str, str]:
        field = visit.page.locator("#query-text")
        await typed(visit, "ASK { ?first ?p ?o }")
        second = await visit.page.context.new_page()
        await second.goto(f"{site}/query", wait_until="load")
        other = Visit(second, visit.address)
        begun = await second.locator("#query-text").input_value()
        await second.locator(".cm-content").wait_for()
        await typed(other, "ASK { ?second ?p ?o }")
        for page in (second, visit.page):
            await page.reload(wait_until="load")
        there = await second.locator("#query-text").input_value()
        await second.close()
        return begun, there, await field.input_value()

    assert visited(browser, site, both) == (
        "ASK { ?first ?p ?o }",
        "ASK { ?second ?p ?o }",
        "ASK { ?first ?p ?o }",
    )
