"""Shared by tests of pages: a headless Chromium that records a page's requests and complaints."""

from __future__ import annotations

import asyncio
import io
import json
import shutil
import sys
import threading
import traceback
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any, Final, TypeVar

import pytest
from patience import patient
from repository import ROOT

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Coroutine, Iterator

    from playwright.async_api import Browser, BrowserContext, ConsoleMessage, Dialog, Page, Request

__all__ = ["Chromium", "Visit", "axe", "chromium"]

_PROGRAMS: Final = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
"""The first, Debian's Chromium without windows, needs a third of the processor time to open a page."""
_FLAGS: Final = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--js-flags=--no-opt --no-maglev",  # for short visits, compiling optimized code takes longer than it saves
)
_SECONDS: Final = 60
"""Time limit in seconds of a test's work with a page, on an idle machine."""
_STEP: Final = 30
"""Time limit in seconds of one step on a page."""
_LAST: Final = 5
"""Time limit in seconds for diagnosing and closing a page."""
_IDLE: Final = "new Promise((done) => requestIdleCallback(() => done(), { timeout: 5000 }))"
_IDLE_TIMES: Final = 2
"""The page may be idle once between the arrival of a response and its processing."""
_AXE: Final = ROOT / "frontend" / "node_modules" / "axe-core" / "axe.min.js"
_EXAMINE: Final = """async () => {
  const options = { resultTypes: ["violations"], preload: false };
  const found = await axe.run(document, { ...options, selectors: false });
  return found.violations.length ? axe.run(document, options) : found;
}"""
_WATCHING: Final = """
window.kgViolations = [];
document.addEventListener("securitypolicyviolation", (event) =>
  window.kgViolations.push(`${event.violatedDirective} ${event.blockedURI} ${event.sourceFile}:${event.lineNumber}`));
"""
_Found = TypeVar("_Found")


@dataclass
class Visit:
    """An open page: the addresses it requested, its console messages and its dialogs.

    `asking` holds the pending requests.
    """

    page: Page
    address: str
    status: int = 0
    requests: list[str] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)
    asking: set[Request] = field(default_factory=set)

    def listen(self) -> None:
        """Start recording the page's requests and messages."""
        for event, handler in self._handlers():
            self.page.on(event, handler)  # type: ignore[call-overload] # each has a literal type of its own

    def leave(self) -> None:
        """Stop recording."""
        for event, handler in self._handlers():
            self.page.remove_listener(event, handler)

    def _handlers(self) -> list[tuple[str, Callable[[Any], Any]]]:
        return [
            ("request", self.ask),
            ("requestfinished", self.answered),
            ("requestfailed", self.answered),
            ("console", self.hear),
            ("pageerror", self.fail),
            ("crash", self.crash),
            ("dialog", self.dismiss),
        ]

    def ask(self, request: Request) -> None:
        """Record a request; an event stream never completes."""
        self.requests.append(request.url)
        if request.resource_type != "eventsource" and request.url.startswith("http"):
            self.asking.add(request)

    def answered(self, request: Request) -> None:
        """Record that a request completed or failed."""
        self.asking.discard(request)

    def hear(self, message: ConsoleMessage) -> None:
        """Record a console error with its source."""
        if message.type == "error":
            self.complaints.append(f"{message.text} ({message.location.get('url')})")

    def fail(self, error: Exception) -> None:
        """Record an uncaught exception."""
        self.complaints.append(f"uncaught: {error}")

    def crash(self, _page: Page) -> None:
        """Record a crash."""
        self.complaints.append("the page crashed")

    async def dismiss(self, dialog: Dialog) -> None:
        """Record a dialog and close it, because an open dialog blocks the page and every call to it."""
        self.complaints.append(f"dialog: {dialog.message}")
        await dialog.dismiss()

    async def rest(self, *, scripts: bool = True) -> None:
        """Wait until the page is not busy, has no pending request, and has processed all responses.

        Playwright's `networkidle` is weaker and more expensive: a slow page is as quiet between two requests, and a
        browser without a graphics card computes half a second of processor time in the half second of the wait.
        """
        busy = self.page.locator("[aria-busy=true]")
        idle = 0
        while idle < _IDLE_TIMES:
            await busy.first.wait_for(state="detached")
            asked = len(self.requests)
            if not self.asking:
                if scripts:
                    await self.page.evaluate(_IDLE)
                if not self.asking and asked == len(self.requests) and not await busy.count():
                    idle += 1
                    continue
            idle = 0
            await asyncio.sleep(0.02)

    async def told(self) -> str:
        """Describe a failing page: its response and the start of its text."""
        try:
            async with asyncio.timeout(patient(_LAST)):
                text = await self.page.evaluate("document.documentElement.innerText")
        except Exception as error:  # noqa: BLE001 - what went wrong before is what is to be told
            text = f"nothing, for it does not answer: {error!r}"
        said = "; ".join(self.complaints) or "nothing"
        owed = ", ".join(sorted(one.url for one in self.asking)) or "nothing"
        head = f"{self.page.url} answered {self.status}, complained of {said}, waits for {owed}, and reads"
        return f"{head}:\n{str(text)[:2_000]}"

    async def troubles(self) -> list[str]:
        """Return the problems so far: errors, dialogs, policy violations, requests to other hosts."""
        violations = await self.page.evaluate("window.kgViolations")
        origin = "/".join(self.address.split("/")[:3])
        elsewhere = [one for one in self.requests if not one.startswith((f"{origin}/", "data:", "blob:"))]
        return [*self.complaints, *(f"policy: {one}" for one in violations), *(f"asked {one}" for one in elsewhere)]

    async def violations(self) -> list[str]:
        """Return the violations that axe reports, each with its first element.

        No rule in use needs style sheets or media loaded in advance. Selectors of elements take a quarter of the time,
        so they are only computed for violations.
        """
        if not await self.page.evaluate("'axe' in window"):
            await self.page.evaluate(_axe_script())
        found = await self.page.evaluate(_EXAMINE)
        return [f"{one['id']} ({one['impact']}): {one['help']}: {json.dumps(one['nodes'][0]['target'])} "
                f"{one['nodes'][0]['html'][:150]}" for one in found["violations"]]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Chromium:
    """A browser in a thread of its own, which leaves event loops to the tests."""

    browser: Browser
    loop: asyncio.AbstractEventLoop
    tabs: dict[str, Page] = field(default_factory=dict)
    """Empty tabs for visits that keep theirs, by the options of their context."""

    def run(self, work: Coroutine[Any, Any, _Found]) -> _Found:
        """Run a coroutine in the thread of the browser and return its result."""
        return _result(work, self.loop)

    @asynccontextmanager
    async def visit(self, address: str, *, kept: bool = False, **options: Any) -> AsyncIterator[Visit]:
        """Open a page and wait until it is idle.

        `options` are those of a context, such as `color_scheme`. A `kept` tab is emptied and used again, which takes
        half the processor time of a new one; it is for visits that do not open other tabs.
        """
        look = {"color_scheme": "light", "reduced_motion": "reduce"}
        size = {"width": 1200, "height": 800}
        changeable = {name: options.pop(name, value) for name, value in {**look, "viewport": size}.items()}
        tab = self.tabs.pop(repr(options), None) if kept else None
        page = tab or await _opened(await self.browser.new_context(**options, **changeable))
        if tab:
            await page.set_viewport_size(changeable["viewport"])
            await page.emulate_media(**{name: changeable[name] for name in look})
        try:
            visit = Visit(page, address)
            visit.listen()
            try:
                answer = await visit.page.goto(address, wait_until="load")
                visit.status = answer.status if answer else 0
                # In a sandbox without scripts, no callback arrives.
                sealed = "sandbox" in (answer.headers if answer else {}).get("content-security-policy", "")
                await visit.rest(scripts=options.get("java_script_enabled", True) and not sealed)
                yield visit
            except (Exception, asyncio.CancelledError) as error:
                error.add_note(await visit.told())
                raise
            if kept:
                visit.leave()
                await _emptied(visit)
                self.tabs[repr(options)] = page
        finally:
            if page not in self.tabs.values():
                async with asyncio.timeout(patient(_LAST)):
                    await page.context.close()


async def _opened(context: BrowserContext) -> Page:
    """Return an empty page."""
    await context.add_init_script(_WATCHING)
    context.set_default_timeout(patient(_STEP) * 1000)
    return await context.new_page()


async def _emptied(visit: Visit) -> None:
    """Empty a tab, on an address of the server that has no scripts."""
    page = visit.page
    await page.unroute_all(behavior="wait")
    await page.goto("/".join([*visit.address.split("/")[:3], "health"]))
    await page.evaluate("localStorage.clear(); sessionStorage.clear()")
    await page.context.clear_cookies()


def axe() -> bool:
    """Return whether axe-core is installed, with the tools of the pages."""
    return _AXE.is_file()


@cache
def _axe_script() -> str:
    return _AXE.read_text(encoding="utf-8")


@contextmanager
def chromium() -> Iterator[Chromium]:
    """Run a browser; skip the test if none is installed."""
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
        browser: Browser = await driver.chromium.launch(
            executable_path=program, args=list(_FLAGS), timeout=patient(_STEP) * 1000
        )
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
    """Return the result of a coroutine run in the loop of another thread.

    A coroutine that takes too long is cancelled, and the error shows where it waited. If cancelling fails, the error
    shows the state of the loop.
    """
    seconds = patient(_SECONDS)
    running = asyncio.run_coroutine_threadsafe(_within(seconds, work), loop)
    try:
        return running.result(seconds + 3 * patient(_LAST))
    except TimeoutError as error:
        if not running.done():
            error.add_note(f"It does not end either, after {seconds:.0f} s:\n{_doing(loop)}")
        raise
    finally:
        running.cancel()


async def _within(seconds: float, work: Coroutine[Any, Any, _Found]) -> _Found:
    try:
        async with asyncio.timeout(seconds):
            return await work
    except TimeoutError as error:  # which would lose its position on the way to the other thread
        raise AssertionError(f"it is not done within {seconds:.0f} s") from error


def _doing(loop: asyncio.AbstractEventLoop) -> str:
    """Return the positions of this process's threads and of a loop's tasks."""
    told = io.StringIO()
    for name, frame in sys._current_frames().items():
        traceback.print_stack(frame, file=told)
        told.write(f"in the thread {name}\n")
    for task in asyncio.all_tasks(loop):
        task.print_stack(file=told)
    return told.getvalue()
