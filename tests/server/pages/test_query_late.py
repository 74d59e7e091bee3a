"""The query page during pending work: repeated, premature and outdated actions."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

from querypage import NAMES, RUNAWAY, editing, idle, ran, told, typed, visited

if TYPE_CHECKING:
    from browsing import Chromium, Visit
    from playwright.async_api import Route

_WORDS: Final = "SELECT ?x { VALUES ?x { 'before' } }"


@editing
def test_the_page_can_be_used_before_its_editor_is_there(browser: Chromium, site: str) -> None:
    """A query is typed and run in the plain field; the editor adopts it with its tab, the focus and the caret."""

    async def hurry(visit: Visit) -> tuple[str, bool, str, list[str]]:
        page = visit.page
        there = asyncio.Event()

        async def hold(route: Route) -> None:
            await there.wait()
            await route.continue_()

        await page.route("**/vendor/@codemirror/**", hold)
        try:
            await page.goto(f"{site}/query", wait_until="domcontentloaded")
            await page.locator("#tab-new").click()
            await page.locator("#query-text").fill(_WORDS)
            await page.locator("#run").click()
            rows = await ran(visit)
            await page.locator("#query-text").press("End")
            await page.locator("#query-text").press("ArrowLeft")
        finally:
            there.set()
        await page.locator("#editor[aria-busy=false] .cm-content").wait_for()
        focused = await page.evaluate("document.activeElement.shadowRoot?.activeElement?.className ?? ''")
        await page.keyboard.insert_text(" ")
        text = await page.locator("#query-text").input_value()
        kept = await page.evaluate("JSON.parse(localStorage.getItem('kg-query-tabs')).tabs.map((tab) => tab.text)")
        return rows, "cm-content" in focused, text, kept

    rows, focused, text, kept = visited(browser, site, hurry)
    assert rows.startswith("1 row in")
    assert focused
    assert text == f"{_WORDS[:-1]} }}"
    assert kept[1] == text
    assert kept[0] != text


def test_a_cancel_that_comes_before_the_query_is_told_again(browser: Chromium, site: str) -> None:
    """A cancellation that reaches the server before its query is repeated, and the query ends."""
    early = """() => {
      const real = window.fetch;
      const cancelled = new Promise((resolve) => { window.kgCancelled = resolve; });
      window.fetch = async (path, init) => {
        if (path === "/sparql") await cancelled;
        const answer = await real(path, init);
        if (init?.method === "DELETE") window.kgCancelled();
        return answer;
      };
    }"""

    async def stop(visit: Visit) -> str:
        await visit.page.evaluate(early)
        await _typed(visit, RUNAWAY)
        await visit.page.locator("#run").click()
        await visit.page.locator("#cancel").click()
        return await told(visit, "cancelled|failed| in ")

    assert visited(browser, site, stop).startswith("cancelled after")
    assert idle(site) == []


async def _typed(visit: Visit, text: str) -> None:
    """Type a text into the current editor."""
    if await visit.page.locator(".cm-content").count():
        await typed(visit, text)
    else:
        await visit.page.locator("#query-text").fill(text)


def test_more_is_got_once(browser: Chromium, site: str) -> None:
    """A double click loads the next rows once."""

    async def more(visit: Visit) -> tuple[str, int]:
        page = visit.page
        await ran(visit)
        await page.evaluate("localStorage.setItem('kg-query-settings', JSON.stringify({ limit: 3 }))")
        await page.locator("#run").click()
        button = page.get_by_role("button", name="Get more")
        await button.evaluate("one => { one.click(); one.click(); }")
        said = await told(visit, "first [4-9] rows")
        return said, await page.locator("#result tbody tr").count()

    said, rows = visited(browser, site, more, query=NAMES)
    assert said.startswith("the first 6 rows")
    assert rows == 6


@editing
def test_a_fix_is_for_the_text_that_it_was_proposed_for(browser: Chromium, site: str) -> None:
    """Right after an edit, a fix of the former text has no effect; the next one works."""

    async def mend(visit: Visit) -> tuple[str, str]:
        page = visit.page
        await typed(visit, "SELECT * { ?s ?p ?o FILTR(?s != ?p) }")
        await page.locator("#problems .fix").wait_for()
        content = page.locator(".cm-content")
        await content.press("Control+Home")
        await page.evaluate("window.kgFix = document.querySelector('#problems .fix')")
        await page.keyboard.insert_text("# one line more\n")
        await page.evaluate("window.kgFix.click()")
        early = await page.locator("#query-text").input_value()
        await page.locator("#problems button", has_text="2:").wait_for()
        await page.locator("#problems .fix").click()
        await page.locator("#problems li").wait_for(state="detached")
        return early, await page.locator("#query-text").input_value()

    early, text = visited(browser, site, mend)
    assert "FILTR(?s" in early
    assert "SELECT * {" in early
    assert "FILTER(?s != ?p)" in text
    assert text.startswith("# one line more\n")


def test_an_answer_that_breaks_off_is_told(browser: Chromium, site: str) -> None:
    """If the connection breaks during a response, the page reports it, and the query can be run again."""
    broken = """() => {
      const real = window.fetch;
      window.fetch = async (path, init) => {
        if (path !== "/sparql") return real(path, init);
        window.fetch = real;
        const body = new ReadableStream({ start: (stream) => stream.error(new TypeError("network error")) });
        return new Response(body, { headers: { "Content-Type": "application/sparql-results+json" } });
      };
    }"""

    async def run(visit: Visit) -> tuple[str, str]:
        await ran(visit)
        await visit.page.evaluate(broken)
        await visit.page.locator("#run").click()
        await told(visit, "^failed")
        said = str(await visit.page.locator("#notices").text_content())
        await visit.page.locator("#run").click()
        return said, await told(visit, " in ")

    said, then = visited(browser, site, run, query="ASK {}")
    assert said.startswith("The answer of the server ended before it was whole")
    assert then.startswith("yes in")


def test_the_stored_query_asked_for_last_is_opened(browser: Chromium, site: str) -> None:
    """Of two stored queries the last requested one is opened, in any order of responses."""
    held = """() => {
      const real = window.fetch;
      window.kgHeld = [];
      window.fetch = async (path, init) => {
        const answer = await real(path, init);
        if (path === "/api/stored") await new Promise((resolve) => window.kgHeld.push(resolve));
        return answer;
      };
    }"""

    async def choose(visit: Visit) -> tuple[str, int]:
        page = visit.page
        await page.locator("#stored-list .entry").first.wait_for()
        await page.evaluate(held)
        for number, words in enumerate(("who publishes", "who subscribes")):
            await page.locator("#stored-filter").fill(words)
            await page.locator("#stored-list .entry").first.click()
            await page.get_by_role("button", name="Only show").click()
            await page.wait_for_function("count => window.kgHeld.length >= count", arg=number + 1)
        await page.evaluate("""async () => {
          for (const let_ of window.kgHeld.reverse()) {
            let_();
            await new Promise((resolve) => setTimeout(resolve));
          }
        }""")
        tabs = page.locator("#tabs [role=tab]")
        await tabs.nth(1).wait_for()
        return await page.locator("#query-text").input_value(), await tabs.count()

    text, tabs = visited(browser, site, choose)
    assert text.startswith("# Subscribers of a topic")
    assert tabs == 2


@editing
def test_pictures_that_are_gone_are_let_go(browser: Chromium, site: str) -> None:
    """A replaced picture is destroyed once another is drawn."""

    async def draw(visit: Visit) -> bool:
        page = visit.page
        await page.locator(".graph-canvas canvas").first.wait_for()
        # Return nothing, because the whole picture would be serialised.
        await page.evaluate("void (window.kgFirst = document.querySelector('.graph-canvas')._cyreg.cy)")
        await page.get_by_role("button", name="Table", exact=True).click()
        await page.get_by_role("button", name="Picture", exact=True).click()
        await page.locator(".graph[aria-busy=false] .graph-canvas canvas").first.wait_for()
        return bool(await page.evaluate("window.kgFirst.destroyed()"))

    query = "CONSTRUCT { ?n rnkg:publishes ?t } WHERE { ?n rnkg:publishes ?t }"
    assert visited(browser, site, draw, query=query)
