"""Shared by tests of the query page: opening, typing, waiting."""

from __future__ import annotations

import re
import time
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import urlencode

import httpx
import pytest
from patience import patient

from kg.server.libraries import HELP, libraries

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from browsing import Chromium, Visit

    Work = Callable[[Visit], Coroutine[Any, Any, Any]]

__all__ = ["NAMES", "RUNAWAY", "editing", "idle", "ran", "told", "typed", "visited"]

editing = pytest.mark.skipif(not libraries(), reason=HELP)

RUNAWAY: Final = "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l }"
NAMES: Final = "SELECT ?name { ?n a rnkg:NodeType ; rnkg:name ?name }"


def visited(browser: Chromium, site: str, work: Work, **parameters: str) -> Any:
    """Return the result of `work` on the query page, in a kept tab; the page must report no problem."""

    async def visit() -> Any:
        async with browser.visit(f"{site}/query?{urlencode(parameters)}", kept=True) as opened:
            found = await work(opened)
            assert [one for one in await opened.troubles() if "the server responded with a status of" not in one] == []
            return found

    return browser.run(visit())


async def typed(visit: Visit, text: str) -> None:
    """Replace the text of the editor, without its completions."""
    await visit.page.locator(".cm-content").click()
    await visit.page.keyboard.press("Control+a")
    await visit.page.keyboard.press("Delete")
    await visit.page.keyboard.insert_text(text)


async def ran(visit: Visit) -> str:
    """Wait until a query has ended; return its status text."""
    return await told(visit, r" in [\d.]+ s, snapshot|failed|cancelled")


async def told(visit: Visit, pattern: str) -> str:
    """Wait until the status of a query matches a pattern; return it."""
    progress = visit.page.locator("#progress").filter(has_text=re.compile(pattern))
    await progress.wait_for()
    return str(await progress.text_content())


def idle(site: str) -> list[Any]:
    """Wait until a server runs nothing; return the work still running after a while."""
    end = time.monotonic() + patient(10)
    while (jobs := _jobs(site)) and time.monotonic() < end:
        time.sleep(0.1)
    return jobs


def _jobs(site: str) -> list[Any]:
    found: list[Any] = httpx.get(f"{site}/jobs", timeout=patient(10)).json()["jobs"]
    return found
