"""Shared by tests of the robot page: opening it with a robot, typing, waiting."""

from __future__ import annotations

import re
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient
from serving import TOKEN

from kg.server.libraries import HELP, libraries

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine

    from browsing import Chromium, Visit
    from playwright.async_api import Locator, Page

    Work = Callable[[Visit], Coroutine[Any, Any, Any]]

__all__ = ["dragged", "log_in", "needs_blocks", "offered", "opened", "reads", "said", "still", "visited", "wrote"]

needs_blocks = pytest.mark.skipif(not libraries(), reason=HELP)


@asynccontextmanager
async def opened(browser: Chromium, site: str, address: str = "/robot", **options: Any) -> AsyncIterator[Visit]:
    """Log in and open the page in a kept tab; wait until the robot is connected.

    The page must report no problem at the end.
    """
    async with browser.visit(f"{site}/login", **{"kept": True, **options}) as visit:
        await log_in(visit.page, site)
        visit.complaints.clear()
        # A page with an event stream is never idle.
        await visit.page.goto(site + address, wait_until="load")
        await said(visit.page, "#connection", "^Connected", 60)
        if libraries():
            await visit.page.locator("#abilities [id$=-add]").first.wait_for(state="attached")
        # The capabilities just arrived as blocks, which checks and redraws the program.
        await visit.page.locator("#text-state[aria-busy=false]").wait_for(state="attached")
        await unfold(visit.page)
        yield visit
        assert await visit.troubles() == []


async def log_in(page: Page, site: str) -> None:
    """Log in on the page that asks for the token; return after the response of the server."""
    await page.locator("input[name=token]").fill(TOKEN)
    await page.get_by_role("button", name="Log in").click()
    await page.wait_for_url(f"{site}/")


async def still(page: Page, milliseconds: int = 200) -> None:
    """Return when the page has drawn the last change and its effects within so many milliseconds.

    Measured by the clock of the page: a slow page does less in the same time.
    """
    await page.evaluate(
        """(wait) => new Promise((done) => {
          setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done))), wait);
        })""",
        milliseconds,
    )


def visited(browser: Chromium, site: str, work: Work, address: str = "/robot", **options: Any) -> Any:
    """Return the result of `work` on the page; the robot does not move afterwards."""

    async def visit() -> Any:
        async with opened(browser, site, address, **options) as found:
            try:
                return await work(found)
            finally:
                await found.page.evaluate("fetch('/robot/stop', { method: 'POST' }).then(() => null)")

    return browser.run(visit())


async def said(page: Page, selector: str, pattern: str, seconds: float = 10) -> str:
    """Wait until an element has text; return it."""
    found = page.locator(selector).filter(has_text=re.compile(pattern)).first
    await found.wait_for(timeout=patient(seconds) * 1000)
    return str(await found.text_content())


async def wrote(page: Page, text: str) -> None:
    """Write the program as text, and wait until it was checked."""
    await unfold(page)
    await page.evaluate("document.getElementById('text').focus()")  # no longer folded
    await page.locator("#text").fill(text)
    await page.locator("#text-state[aria-busy=false]").wait_for(state="attached")


async def unfold(page: Page) -> None:
    """Show the text of the program, which is folded next to blocks; at once, because the page folds it itself."""
    await page.evaluate("""() => {
      if (document.getElementById("text-part").hidden) document.getElementById("show-text").click();
    }""")


async def reads(page: Page, pattern: str) -> str:
    """Wait until the text of the program matches a pattern; return it."""
    await page.wait_for_function(
        "pattern => new RegExp(pattern, 's').test(document.getElementById('text').value)", arg=pattern
    )
    return str(await page.locator("#text").input_value())


async def dragged(page: Page, block: Locator, x: float, y: float, meanwhile: Awaitable[None] | None = None) -> None:
    """Drag a block from the palette to a point of the program; `meanwhile` runs before the drop."""
    box = await block.bounding_box()
    assert box is not None
    await page.mouse.move(box["x"] + 16, box["y"] + 8)
    await page.mouse.down()
    await page.mouse.move(box["x"] - 30, box["y"] + 20, steps=5)
    await page.mouse.move(x, y, steps=12)
    await still(page)
    if meanwhile:
        await meanwhile
    await page.mouse.up()


async def offered(page: Page, category: str, block: str) -> Locator:
    """Return a block of the palette by its category."""
    await page.locator(".blocklyToolboxCategory", has_text=category).click()
    found = page.locator(".blocklyFlyout .blocklyDraggable", has_text=block).first
    await found.wait_for()
    await still(page)
    return found
