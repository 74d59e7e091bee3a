"""What tests of pages share: a headless Chromium that writes down what pages ask for and complain about."""

from __future__ import annotations

import asyncio
import json
import shutil
import threading
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, TypeVar

import pytest
from patience import patient
from repository import ROOT

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Coroutine, Iterator
    from pathlib import Path

    from playwright.async_api import Browser, ConsoleMessage, Page

__all__ = ["Chromium", "Visit", "axe", "chromium"]

_PROGRAMS: Final = ("chromium", "chromium-browser", "google-chrome")
_FLAGS: Final = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
_SECONDS: Final = 60
"""What a test does with a page, on an idle machine."""
_STEP: Final = 30
"""What a page takes to do one thing."""
_WATCHING: Final = """
window.kgViolations = [];
document.addEventListener("securitypolicyviolation", (event) =>
  window.kgViolations.push(`${event.violatedDirective} ${event.blockedURI} ${event.sourceFile}:${event.lineNumber}`));
"""
_Found = TypeVar("_Found")


@dataclass
class Visit:
    """A page that is open: the addresses that it asked for, and what it said to the console or by dialogs."""

    page: Page
    address: str
    status: int = 0
    requests: list[str] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)

    def hear(self, message: ConsoleMessage) -> None:
        """Write down an error of the console, with where it came from."""
        if message.type == "error":
            self.complaints.append(f"{message.text} ({message.location.get('url')})")

    async def told(self) -> str:
        """Return what is known of a page on which something was not found: how it answered, and how it begins."""
        text = await self.page.evaluate("document.documentElement.innerText")
        said = "; ".join(self.complaints) or "nothing"
        return f"{self.page.url} answered {self.status}, complained of {said}, and reads:\n{text[:2_000]}"

    async def troubles(self) -> list[str]:
        """Return what went wrong by now: errors, dialogs, violations of the policy, requests to others."""
        violations = await self.page.evaluate("window.kgViolations")
        origin = "/".join(self.address.split("/")[:3])
        elsewhere = [one for one in self.requests if not one.startswith((f"{origin}/", "data:", "blob:"))]
        return [*self.complaints, *(f"policy: {one}" for one in violations), *(f"asked {one}" for one in elsewhere)]

    async def violations(self) -> list[str]:
        """Return what axe finds wrong, each with the first element that it is about."""
        found = await self.page.evaluate("axe.run(document, {resultTypes: ['violations']})")
        return [f"{one['id']} ({one['impact']}): {one['help']}: {json.dumps(one['nodes'][0]['target'])} "
                f"{one['nodes'][0]['html'][:150]}" for one in found["violations"]]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Chromium:
    """A browser that runs in a thread of its own, so that other tests can have event loops."""

    browser: Browser
    loop: asyncio.AbstractEventLoop

    def run(self, work: Coroutine[Any, Any, _Found]) -> _Found:
        """Return what a coroutine returns that runs beside the browser."""
        return _result(work, self.loop)

    @asynccontextmanager
    async def visit(self, address: str, *, tools: bool = False, **options: Any) -> AsyncIterator[Visit]:
        """Open a page and wait until it is at rest, with nothing busy.

        `options` are those of a context, such as `color_scheme`. With `tools` the page has axe, for `Visit.violations`.
        """
        context = await self.browser.new_context(
            **{"viewport": {"width": 1200, "height": 800}, "reduced_motion": "reduce", **options}
        )
        await context.add_init_script(_WATCHING)
        for script in axe() if tools else ():
            await context.add_init_script(path=script)
        context.set_default_timeout(patient(_STEP) * 1000)
        try:
            page = await context.new_page()
            visit = Visit(page, address)
            page.on("request", lambda request: visit.requests.append(request.url))
            page.on("console", visit.hear)
            page.on("pageerror", lambda error: visit.complaints.append(f"uncaught: {error}"))
            page.on("dialog", lambda dialog: visit.complaints.append(f"dialog: {dialog.message}"))
            answer = await page.goto(address, wait_until="networkidle")
            visit.status = answer.status if answer else 0
            try:
                await page.locator("[aria-busy=true]").first.wait_for(state="detached")
                yield visit
            except Exception as error:
                error.add_note(await visit.told())
                raise
        finally:
            await context.close()


def axe() -> list[Path]:
    """Return the script of axe-core; nothing where the tools of the pages were not installed."""
    script = ROOT / "frontend" / "node_modules" / "axe-core" / "axe.min.js"
    return [script] if script.is_file() else []


@contextmanager
def chromium() -> Iterator[Chromium]:
    """Run a browser; the test is skipped where there is none."""
    program = next((found for name in _PROGRAMS if (found := shutil.which(name))), None)
    if program is None:
        pytest.skip("Chromium is not installed")
    playwright = pytest.importorskip("playwright.async_api", reason="playwright is not installed")
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, daemon=True)
    thread.start()
    manager = playwright.async_playwright()

    async def start() -> Browser:
        driver = await manager.start()
        browser: Browser = await driver.chromium.launch(executable_path=program, args=list(_FLAGS))
        return browser

    try:
        browser = _result(start(), loop)
        yield Chromium(browser, loop)
        _result(browser.close(), loop)
    finally:
        _result(manager.__aexit__(), loop)
        loop.call_soon_threadsafe(loop.stop)
        thread.join(patient(_SECONDS))


def _result(work: Coroutine[Any, Any, _Found], loop: asyncio.AbstractEventLoop) -> _Found:
    """Return what a coroutine returns in a loop that runs in a thread; it is ended when that takes too long."""
    running = asyncio.run_coroutine_threadsafe(work, loop)
    try:
        return running.result(patient(_SECONDS))
    finally:
        running.cancel()
