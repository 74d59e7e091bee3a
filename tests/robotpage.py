"""What tests of the robot page share: it is opened with a robot, written to, and waited for."""

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
    """Log in and open the page; wait until the robot is connected. At the end nothing may have gone wrong."""
    async with browser.visit(f"{site}/login", **options) as visit:
        await log_in(visit.page, site)
        visit.complaints.clear()
        # A page that listens is never at rest.
        await visit.page.goto(site + address, wait_until="load")
        await said(visit.page, "#connection", "^Connected", 60)
        if libraries():
            await visit.page.locator("#abilities [id$=-add]").first.wait_for(state="attached")
        # What the robot can do was just offered as blocks, with which the program is judged and shown anew.
        await visit.page.locator("#text-state[aria-busy=false]").wait_for(state="attached")
        await unfold(visit.page)
        yield visit
        assert await visit.troubles() == []


async def log_in(page: Page, site: str) -> None:
    """Log in on the page that asks for the token; return when the server has answered."""
    await page.locator("input[name=token]").fill(TOKEN)
    await page.get_by_role("button", name="Log in").click()
    await page.wait_for_url(f"{site}/")


async def still(page: Page, milliseconds: int = 200) -> None:
    """Return when the page has drawn what was done, and what it does after so long by itself.

    By its own clock: one that is slow has not done in a time of ours what it does in that time otherwise.
    """
    await page.evaluate(
        """(wait) => new Promise((done) => {
          setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done))), wait);
        })""",
        milliseconds,
    )


def visited(browser: Chromium, site: str, work: Work, address: str = "/robot", **options: Any) -> Any:
    """Return what `work` returns of the page; the robot stands still afterwards."""

    async def visit() -> Any:
        async with opened(browser, site, address, **options) as found:
            try:
                return await work(found)
            finally:
                await found.page.evaluate("fetch('/robot/stop', { method: 'POST' }).then(() => null)")

    return browser.run(visit())


async def said(page: Page, selector: str, pattern: str, seconds: float = 10) -> str:
    """Wait until an element says something; return what."""
    found = page.locator(selector).filter(has_text=re.compile(pattern)).first
    await found.wait_for(timeout=patient(seconds) * 1000)
    return str(await found.text_content())


async def wrote(page: Page, text: str) -> None:
    """Write the program as text, and wait until it was judged."""
    await unfold(page)
    await page.evaluate("document.getElementById('text').focus()")  # which is not folded any more
    await page.locator("#text").fill(text)
    await page.locator("#text-state[aria-busy=false]").wait_for(state="attached")


async def unfold(page: Page) -> None:
    """Show the text of the program, which is folded where there are blocks; at once, for the page folds it itself."""
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
    """Drag a block from where blocks are offered to a point of the program; `meanwhile` it is held there."""
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
    """Return a block as its category offers it."""
    await page.locator(".blocklyToolboxCategory", has_text=category).click()
    found = page.locator(".blocklyFlyout .blocklyDraggable", has_text=block).first
    await found.wait_for()
    await still(page)
    return found
