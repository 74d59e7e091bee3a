"""The pages of rules, including the tables and pictures shared by all pages."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import httpx
import pytest
from patience import patient

from kg.server.libraries import HELP, libraries

if TYPE_CHECKING:
    from pathlib import Path

    from browsing import Chromium

_NEEDS_LIBRARIES = pytest.mark.skipif(not libraries(), reason=HELP)


_MOST = 40_000
"""Bytes of the index of rules."""


def test_the_index_of_rules_is_light(site: str) -> None:
    """The index lists families with counts, and leaves rules and their dependencies to other requests."""
    text = httpx.get(f"{site}/rules", timeout=patient(30)).text
    assert len(text) < _MOST
    assert "/rules?family=communication" in text
    assert "/rule?name=" not in text


def test_rules_can_be_searched(browser: Chromium, site: str) -> None:
    """The form finds rules by words of their documentation in all families, by keyboard and without JavaScript."""

    async def search() -> tuple[str, list[str]]:
        async with browser.visit(f"{site}/rules", java_script_enabled=False) as visit:
            await visit.page.get_by_label("Words").fill("wiring robot node")
            await visit.page.keyboard.press("Enter")
            await visit.page.wait_for_url("**/rules?q=*")
            names = await visit.page.locator("tbody th").all_inner_texts()
            return await visit.page.inner_text("#rules-count"), names

    words, shown = browser.run(search())
    assert 0 < len(shown) < 20
    assert words.startswith(f"{len(shown)} of ")
    assert all("/" in name for name in shown)


def test_families_lead_to_their_rules(browser: Chromium, site: str) -> None:
    """The name of a family opens the list of its rules, and of these the page of one rule; both lead back."""

    async def follow() -> tuple[str, str]:
        async with browser.visit(f"{site}/rules", kept=True) as visit:
            await visit.page.get_by_role("link", name="communication", exact=True).click()
            await visit.page.get_by_role("link", name="feeds", exact=True).click()
            rule = await visit.page.inner_text("h1")
            await visit.page.get_by_role("link", name="communication", exact=True).click()
            return rule, await visit.page.inner_text("h2 >> nth=0")

    rule, family = browser.run(follow())
    assert rule.replace("\u200b", "") == "communication/feeds"
    assert family == "communication"


def test_tables_sort(browser: Chromium, site: str) -> None:
    """The heading of a column sorts by it, numerically for numbers, and shows the direction."""

    async def sort() -> tuple[list[str], str | None]:
        async with browser.visit(f"{site}/rules?family=architecture", kept=True) as visit:
            table = visit.page.locator("table").first
            for _ in range(2):
                await table.get_by_role("button", name="Derived").click()
            cells = await table.locator("tbody tr td:nth-child(4)").all_inner_texts()
            return cells, await table.locator("th").nth(3).get_attribute("aria-sort")

    cells, way = browser.run(sort())
    numbers = [int(cell.replace(",", "")) for cell in cells if cell != "never fired"]
    assert way == "descending"
    assert numbers == sorted(numbers, reverse=True) != []


def test_a_rule_is_shown_whole(browser: Chromium, site: str) -> None:
    """The page has the documentation of `kg rules show`, numbered lines, the derived triples, and the link to why."""

    async def read() -> tuple[str, str, str]:
        async with browser.visit(f"{site}/rule?name=feeds", kept=True) as visit:
            text = await visit.page.inner_text("main")
            line = await visit.page.inner_text("#L20")
            return text, line, str(await visit.page.get_attribute("a.why >> nth=0", "data-why"))

    text, line, why = browser.run(read())
    assert "What it infers" in text
    assert "Known limits" in text
    assert "PREFIX rnkg:" in line
    assert why.startswith("/api/why?subject=%3Chttps")


@_NEEDS_LIBRARIES
def test_families_are_closed_until_a_rule_is_searched(browser: Chromium, site: str) -> None:
    """The picture of all rules begins with one thing for each family; searching for a rule opens its family."""

    async def search() -> tuple[str, str]:
        async with browser.visit(f"{site}/rules", kept=True) as visit:
            page = visit.page
            await page.get_by_text("Show the picture").click()
            closed = await page.get_attribute(".graph-canvas", "aria-label")
            await page.get_by_placeholder("Find a name").fill("communication/feeds")
            await page.keyboard.press("Enter")
            await page.locator(".graph-words strong").wait_for()
            assert await visit.troubles() == []
            return closed or "", await page.inner_text(".graph-words")

    closed, words = browser.run(search())
    assert closed.startswith("Picture of 9 things")
    assert words.startswith("feeds rule, Nodes feed the subscribers of their topics")


@_NEEDS_LIBRARIES
def test_a_picture_can_be_used(browser: Chromium, site: str, tmp_path: Path) -> None:
    """Keys move and zoom the picture, groups open, its list selects a rule, and it is saved as SVG, PNG and JSON."""

    async def use() -> tuple[list[int], str, list[Path]]:
        async with browser.visit(f"{site}/rule?name=feeds", kept=True) as visit:
            page = visit.page
            await page.focus(".graph-canvas")
            for key in ("ArrowLeft", "+", "0"):
                await page.keyboard.press(key)
            things = []
            for button in ("Close groups", "Open groups"):
                await page.get_by_role("button", name=button).click()
                label = await page.get_attribute(".graph-canvas", "aria-label")
                things.append(int(str(label).removeprefix("Picture of ").split()[0]))
            await page.locator(".graph-list summary").click()
            await page.get_by_role("button", name="Show feeds in the picture").click()
            files = []
            for kind in ("SVG", "PNG", "JSON"):
                async with page.expect_download() as download:
                    await page.get_by_role("button", name=kind, exact=True).click()
                files.append(tmp_path / (await download.value).suggested_filename)
                await (await download.value).save_as(files[-1])
            assert await visit.troubles() == []
            return things, await page.inner_text(".graph-words"), files

    (closed, opened), words, (drawn, painted, data) = browser.run(use())
    assert closed < opened
    assert words.startswith("feeds rule, Nodes feed the subscribers of their topics")
    assert drawn.read_text("utf-8").startswith("<svg xmlns=")
    assert painted.read_bytes().startswith(b"\x89PNG")
    assert {"nodes", "edges", "groups"} == json.loads(data.read_text("utf-8")).keys()


@_NEEDS_LIBRARIES
def test_a_picture_always_looks_the_same(browser: Chromium, site: str, tmp_path: Path) -> None:
    """Two visits draw the same picture."""

    async def draw(path: Path) -> None:
        async with browser.visit(f"{site}/rule?name=feeds", kept=True) as visit:
            async with visit.page.expect_download() as download:
                await visit.page.get_by_role("button", name="SVG", exact=True).click()
            await (await download.value).save_as(path)

    one, two = tmp_path / "one", tmp_path / "two"
    for path in (one, two):
        browser.run(draw(path))
    assert one.read_text("utf-8") == two.read_text("utf-8")


def test_without_libraries_the_list_says_it(browser: Chromium, site: str) -> None:
    """Without the libraries, the page reports that and shows the list in place of the picture."""

    async def read() -> str:
        async with browser.visit(f"{site}/search", kept=True) as visit:
            await visit.page.route("**/vendor/**", lambda route: route.abort())
            await visit.page.goto(f"{site}/rule?name=feeds", wait_until="load")
            await visit.rest()
            return await visit.page.inner_text(".graph")

    text = browser.run(read())
    assert "No picture: the page libraries" in text
    assert "communicates-through" in text
