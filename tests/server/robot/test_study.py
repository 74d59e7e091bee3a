"""The study on the robot page: tasks, clock, attempts, and results as CSV."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

from robotpage import needs_blocks, said, visited, wrote

if TYPE_CHECKING:
    from pathlib import Path

    from browsing import Chromium, Visit


_GAP = 8
"""Pixels between the task and the columns below it."""


@needs_blocks
def test_a_study_gives_results(browser: Chromium, robot_site: str, tmp_path: Path) -> None:
    """The clock starts after reading the task; each run counts; the saved results have the program and its size."""
    kept = tmp_path / "study.csv"

    async def study(visit: Visit) -> tuple[str, str]:
        page = visit.page
        await page.locator("#examples").click()
        await page.locator("#study").click()
        await page.get_by_label("Participant").fill('Ada "A"')
        await page.get_by_role("button", name="Start", exact=True).click()
        task = await said(page, "#study-task", "^1")
        await page.locator("#study-read").click()
        await said(page, "#study-clock", "0 attempts")
        await wrote(page, 'log "one"\nwait 10 ms\n')
        for attempts in ("1 attempt", "2 attempts"):
            await page.locator("#run:not([disabled])").click()
            await said(page, "#study-clock", attempts)
        await said(page, "#log", "is done.*is done")
        await page.locator("#study-next").click()
        second = await said(page, "#study-task", "^2")
        await page.locator("#study-end").click()
        async with page.expect_download() as saved:
            await page.get_by_role("link", name="Save results as CSV").click()
        await (await saved.value).save_as(kept)
        return task, second

    task, second = visited(browser, robot_site, study)
    assert (task, second[:2]) == ("1. Single command: Move to a room.", "2.")
    (row,) = csv.DictReader(io.StringIO(kept.read_text("utf-8")))
    assert float(row.pop("seconds")) > 0
    assert row.pop("program") == 'log "one"\nwait 10 ms\n'
    assert row == {
        "participant": 'Ada "A"', "robot": "office", "exercise": "1", "title": "Single command",
        "attempts": "2", "ended": "done", "blocks": "2", "capabilities": "0",
    }  # fmt: skip


@needs_blocks
def test_a_study_is_begun_by_keyboard(browser: Chromium, robot_site: str) -> None:
    """Enter in the dialog shows the task and focuses the button that starts the clock."""

    async def start(visit: Visit) -> str:
        page = visit.page
        await page.locator("#examples").click()
        await page.locator("#study").click()
        await page.get_by_label("Participant").press("Enter")
        await said(page, "#study-task", "^1")
        await page.locator("#study-read:focus").wait_for()
        gap = await page.evaluate(
            """() => document.querySelector('.robot-columns').getBoundingClientRect().top
              - document.getElementById('study-panel').getBoundingClientRect().bottom"""
        )
        assert gap >= _GAP
        await page.keyboard.press("Enter")
        return await said(page, "#study-clock", "0 attempts")

    assert visited(browser, robot_site, start).startswith("0:0")


@needs_blocks
def test_the_end_of_a_program_counts_for_its_task(browser: Chromium, robot_site: str) -> None:
    """A program that ends after the next task was shown is recorded with the task that it was run for."""

    async def hurry(visit: Visit) -> tuple[str, str]:
        page = visit.page
        await page.locator("#examples").click()
        await page.locator("#study").click()
        await page.get_by_role("button", name="Start", exact=True).click()
        await page.locator("#study-read").click()
        await wrote(page, "wait 2 s\n")
        await page.locator("#run:not([disabled])").click()
        await said(page, "#study-clock", "1 attempt")
        await page.locator("#study-next").click()
        await said(page, "#log", "is done")
        await page.locator("#study-end").click()
        kept = str(
            await page.evaluate("JSON.parse(localStorage.getItem('kg-robot-study')).map((row) => row.ended).join()")
        )
        return kept, await page.inner_text("#study-found")

    kept, found = visited(browser, robot_site, hurry)
    assert kept == "done"
    assert found == "1 result is kept in this browser."
