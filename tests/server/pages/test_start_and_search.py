"""The start page, search, and the common layout of pages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from serving import TOKEN, served

if TYPE_CHECKING:
    from pathlib import Path

    from browsing import Chromium


def test_a_question_is_one_press_away(browser: Chromium, site: str) -> None:
    """The page has eight questions; each leads to the query page with the value of its field."""

    async def ask() -> tuple[int, str]:
        async with browser.visit(site, kept=True) as visit:
            cards = await visit.page.locator(".questions > li").count()
            await visit.page.locator("input[name=topic]").first.fill("/scan_filtered")
            await visit.page.keyboard.press("Enter")
            await visit.page.wait_for_url("**/query?*")
            return cards, visit.page.url

    cards, address = browser.run(ask())
    assert cards == 8
    assert address.endswith("/query?name=explore%2Fwho-publishes&topic=%2Fscan_filtered")


def test_search_with_the_keyboard_alone(browser: Chromium, site: str) -> None:
    """A slash focuses the search box, Enter shows the hits, Tab and Enter open a node."""

    async def walk() -> str:
        async with browser.visit(f"{site}/rules", kept=True) as visit:
            await visit.page.keyboard.press("/")
            await visit.page.keyboard.type("laser scan")
            await visit.page.keyboard.press("Enter")
            await visit.page.wait_for_url("**/search?q=laser+scan")
            await visit.page.keyboard.press("Tab")
            await visit.page.keyboard.press("Enter")
            for _ in range(40):
                await visit.page.keyboard.press("Tab")
                if await visit.page.evaluate("document.activeElement.closest('.hits') !== null"):
                    break
            return str(await visit.page.evaluate("document.activeElement.getAttribute('href')"))

    assert browser.run(walk()).startswith("/node?iri=")


def test_names_are_offered_while_typing(browser: Chromium, site: str) -> None:
    """Typing offers things of all kinds by name; the arrows reach them, Escape closes them, Enter opens one."""

    async def walk() -> tuple[list[str], bool, str]:
        async with browser.visit(f"{site}/rules", kept=True) as visit:
            await visit.page.keyboard.press("/")
            await visit.page.keyboard.type("scan_fil")
            names = visit.page.locator(".suggested li")
            await names.first.wait_for()
            offered = await names.all_inner_texts()
            await visit.page.keyboard.press("ArrowDown")
            await visit.page.keyboard.press("Escape")
            closed = await visit.page.evaluate("document.activeElement.id === 'find'") and await names.first.is_hidden()
            await visit.page.keyboard.type("tered")
            await names.first.wait_for()
            assert await visit.violations() == []
            await visit.page.keyboard.press("ArrowDown")
            await visit.page.keyboard.press("Enter")
            await visit.page.wait_for_url("**/channel?*")
            return offered, closed, await visit.page.inner_text("h1")

    offered, closed, title = browser.run(walk())
    assert offered[0].startswith("scan_filter node · ")
    assert any(one.startswith("/scan_filtered topic · ") for one in offered)
    assert closed
    assert title == "/scan_filtered"


def test_the_skip_link_comes_first(browser: Chromium, site: str) -> None:
    """The first Tab shows the link to the content, which receives the focus."""

    async def walk() -> tuple[str, str]:
        async with browser.visit(site, kept=True) as visit:
            await visit.page.keyboard.press("Tab")
            first = await visit.page.evaluate("document.activeElement.className")
            await visit.page.keyboard.press("Enter")
            await visit.page.locator(":focus:not(.skip)").wait_for()
            return first, await visit.page.evaluate("document.activeElement.id")

    assert browser.run(walk()) == ("skip", "main")


def test_the_theme_is_kept(browser: Chromium, site: str) -> None:
    """The switch cycles through system, light and dark, and the choice applies to other pages."""

    async def switch() -> list[str]:
        async with browser.visit(site, kept=True, color_scheme="light") as visit:
            back = "getComputedStyle(document.body).backgroundColor"
            seen = [await visit.page.evaluate(back)]
            for _ in range(2):
                await visit.page.click("#theme")
                seen.append(await visit.page.evaluate(back))
            await visit.page.goto(f"{site}/search")
            return [*seen, await visit.page.evaluate(back)]

    system, light, dark, later = browser.run(switch())
    assert system == light
    assert dark == later != light


def test_typing_tells_nobody(browser: Chromium, site: str) -> None:
    """Text typed into search fields is sent only with the form, and never to another host (C28)."""

    async def type_words() -> list[str]:
        async with browser.visit(f"{site}/search?q=scan", kept=True) as visit:
            for field in ("#find", "#filter-hardware"):
                await visit.page.locator(field).press_sequentially("foaf:name http://private.example/")
            return await visit.troubles()

    assert browser.run(type_words()) == []


def test_filters_are_told_and_kept(browser: Chromium, site: str) -> None:
    """A filter is sent with the words, stays in its field, and narrows the hits."""

    async def narrow() -> tuple[int, int, str]:
        async with browser.visit(f"{site}/search?q=laser", kept=True) as visit:
            every = await visit.page.locator(".hits > li").count()
            await visit.page.fill("#filter-publishes", "PointCloud2")
            await visit.page.keyboard.press("Enter")
            await visit.page.wait_for_url("**publishes=PointCloud2**")
            found = await visit.page.locator(".hits > li").count()
            return every, found, await visit.page.input_value("#filter-publishes")

    every, found, kept = browser.run(narrow())
    assert every > found == 1
    assert kept == "PointCloud2"


def test_each_hit_has_its_evidence(browser: Chromium, site: str) -> None:
    """Every hit has its declaration, with a link that opens the line."""

    async def links() -> list[list[str]]:
        async with browser.visit(f"{site}/search?q=scan_filter", kept=True) as visit:
            hits = await visit.page.locator(".hits > li").all()
            return [await hit.locator(".evidence a").evaluate_all("all => all.map((one) => one.href)") for hit in hits]

    found = browser.run(links())
    assert found
    assert all(any(one.startswith(("vscode://", "https://")) for one in hit) for hit in found)


def test_a_link_with_the_token_logs_in(browser: Chromium, store: Path) -> None:
    """The link printed by `kg serve` leads to the start page; the token is removed from the address."""

    async def follow(address: str) -> tuple[str, int]:
        async with browser.visit(f"{address}/login#token={TOKEN}") as visit:
            await visit.page.locator("form[action='/logout']").wait_for()
            return visit.page.url, await visit.page.locator(".questions").count()

    with served(store, token=TOKEN, log="off") as server:
        assert browser.run(follow(server.address)) == (f"{server.address}/", 1)


def test_a_link_pasted_into_the_login_page_logs_in(browser: Chromium, store: Path) -> None:
    """The address then differs after `#` only, which loads no page."""

    async def paste(address: str) -> str:
        async with browser.visit(f"{address}/login") as visit:
            await visit.page.evaluate(f"location.hash = 'token={TOKEN}'")
            await visit.page.locator("form[action='/logout']").wait_for()
            return visit.page.url

    with served(store, token=TOKEN, log="off") as server:
        assert browser.run(paste(server.address)) == f"{server.address}/"
