"""Edits of the robot page during the check of an older one: none is lost, by blocks or by text."""

from __future__ import annotations

import asyncio
import json
from typing import TYPE_CHECKING, Any, Final

from robotpage import dragged, needs_blocks, offered, reads, said, still, visited, wrote

if TYPE_CHECKING:
    from browsing import Chromium, Visit
    from playwright.async_api import Page, Route

# Responses of checks are held until the test releases them, in the same turn of the page's loop as its next action.
HELD: Final = """() => {
  const real = window.fetch;
  const open = new Promise((resolve) => { window.kgLet = resolve; });
  window.kgHeld = 0;
  window.fetch = async (path, ...more) => {
    const answer = await real(path, ...more);
    if (path !== "/robot/check") return answer;
    const text = await answer.text();
    window.kgHeld += 1;
    await open;
    return new Response(text, { headers: { "Content-Type": "application/json" } });
  };
}"""


async def held(page: Page, text: str) -> None:
    """Write a program as text whose check has finished, with its response held."""
    await page.evaluate(HELD)
    await page.locator("#text").fill(text)
    await page.wait_for_function("() => window.kgHeld >= 1")


async def let_through(page: Page, act: str = "") -> str:
    """Act in the page and release the responses at once; return the text after all checks."""
    await page.evaluate(f"() => {{ {act}; window.kgLet(); }}")
    await still(page, 600)
    await page.locator("#text-state[aria-busy=false]").wait_for()
    return str(await page.locator("#text").input_value())


@needs_blocks
def test_a_block_is_not_lost_to_an_older_text(browser: Chromium, robot_site: str) -> None:
    """An edit of blocks during the check of an older text is preserved, and the text contains it."""

    async def edit(visit: Visit) -> str:
        page = visit.page
        await wrote(page, "wait for 1 s\n")
        await wrote(page, "wait for 2 s\n")
        await held(page, "wait for 3 s\n")
        return await let_through(page, "document.getElementById('undo').click()")

    assert visited(browser, robot_site, edit) == "wait 1 s\n"


@needs_blocks
def test_a_block_is_added_to_the_text_that_is_seen(browser: Chromium, robot_site: str) -> None:
    """Adding a block waits for the pending check of the text, and extends that text."""

    async def edit(visit: Visit) -> str:
        page = visit.page
        await held(page, "wait for 3 s\n")
        return await let_through(page, "document.getElementById('write-drivingAtVelocity-add').click()")

    assert visited(browser, robot_site, edit) == "wait 3 s\nmove at a velocity for 2 s\n"


@needs_blocks
def test_a_text_is_not_lost_to_older_blocks(browser: Chromium, robot_site: str) -> None:
    """Text typed during the check of older blocks stays in the field, and becomes the blocks."""

    async def edit(visit: Visit) -> tuple[str, int]:
        page = visit.page
        await wrote(page, "wait for 1 s\n")
        await page.evaluate(HELD)
        await page.locator("#write-drivingAtVelocity-add").evaluate("one => one.click()")
        await page.wait_for_function("() => window.kgHeld >= 1")
        await page.locator("#text").press("Control+End")
        await page.keyboard.type("log 'there'")
        text = await let_through(page)
        return text, await page.locator("#blocks .blocklyBlockCanvas .blocklyDraggable").count()

    text, blocks = visited(browser, robot_site, edit)
    assert text.split() == ["wait", "for", "1", "s", "log", "'there'"]
    assert blocks >= 3


@needs_blocks
def test_a_text_is_not_lost_to_blocks_that_come_late(browser: Chromium, robot_site: str) -> None:
    """Text written before the blocks are loaded is preserved, and becomes blocks."""

    async def hurry(visit: Visit) -> tuple[str, int]:
        page = visit.page
        there = asyncio.Event()

        async def hold(route: Route) -> None:
            await there.wait()
            await route.continue_()

        await page.route("**/vendor/blockly/**", hold)
        try:
            await page.reload(wait_until="domcontentloaded")
            await wrote(page, "wait 3 s\n")
        finally:
            there.set()
        await page.locator("#run:enabled").wait_for()
        await page.locator("#text-state[aria-busy=false]").wait_for()
        text = str(await page.locator("#text").input_value())
        return text, await page.locator("#blocks .blocklyBlockCanvas .blocklyDraggable").count()

    text, blocks = visited(browser, robot_site, hurry)
    assert text == "wait 3 s\n"
    assert blocks >= 2


@needs_blocks
def test_what_runs_is_what_is_seen(browser: Chromium, robot_site: str) -> None:
    """Changing a block and running at once runs the changed program."""

    async def run(visit: Visit) -> tuple[Any, str]:
        page = visit.page
        await wrote(page, "wait for 1 s\n")
        await wrote(page, "wait for 2 s\n")
        async with page.expect_request("**/robot/run") as asked:
            await page.evaluate("() => ['undo', 'run'].forEach((id) => document.getElementById(id).click())")
        request = await asked.value
        return json.loads(request.post_data or "")["program"]["body"], await reads(page, "wait 1 s")

    body, text = visited(browser, robot_site, run)
    assert text == "wait 1 s\n"
    assert "1" in json.dumps(body)
    assert "2" not in json.dumps([one["seconds"] for one in body])


@needs_blocks
def test_what_is_saved_is_what_was_seen_then(browser: Chromium, robot_site: str) -> None:
    """Saving a program and starting another at once saves the first one and shows the other."""

    async def edit(visit: Visit) -> tuple[str, str]:
        page = visit.page
        await held(page, "wait for 3 s\n")
        both = "for (const act of ['save', 'new']) document.getElementById(act).click()"
        text = await let_through(page, both)
        await page.locator("#save-dialog[open]").wait_for()
        return text, await page.evaluate("localStorage.getItem('kg-robot-program program')")

    text, kept = visited(browser, robot_site, edit)
    assert kept == "wait for 3 s\n"
    assert "wait" not in text


@needs_blocks
def test_undo_brings_a_program_back_that_does_not_fit(browser: Chromium, robot_site: str) -> None:
    """Undo restores a program completely, even if its blocks could not be joined by hand."""
    wrong = "wait 2 m\nlog there\n"

    async def undo(visit: Visit) -> tuple[str, bool]:
        page = visit.page
        await wrote(page, wrong)
        await wrote(page, "wait 1 s\n")
        await page.locator("#undo").click()
        text = await reads(page, "2 m")
        return text, await page.locator("#loose").is_visible()

    assert visited(browser, robot_site, undo) == (wrong, False)


async def answered(page: Page) -> list[dict[str, Any]]:
    """Make the page request the robot every 300 ms; it receives the last of the returned responses."""
    hello = 'retry: 300\ndata: {"event": "hello", "listener": "x"}\n\n'
    answers = [await page.evaluate("fetch('/api/robot').then((answer) => answer.json())")]
    await page.route("**/api/robot", lambda route: route.fulfill(json=answers[-1]))
    await page.route("**/robot/events", lambda route: route.fulfill(content_type="text/event-stream", body=hello))
    await page.reload(wait_until="load")
    await page.locator("#run:enabled").wait_for()
    return answers


def at_the_door(robot: dict[str, Any]) -> dict[str, Any]:
    """Return the description of a robot with an additional place."""
    return {**robot, "places": {**robot["places"], "the door": robot["places"]["the desk"]}}


@needs_blocks
def test_a_block_stays_in_the_hand_when_the_robot_changes(browser: Chromium, robot_site: str) -> None:
    """A dragged block is not replaced while the page updates its description of the robot."""

    async def drag(visit: Visit) -> str:
        page = visit.page
        answers = await answered(page)
        box = await page.locator("#blocks").bounding_box()
        assert box is not None

        async def change() -> None:
            answers.append(at_the_door(answers[0]))
            await page.get_by_role("button", name="Go there: the door").wait_for()

        block = await offered(page, "Control", "repeat")
        await dragged(page, block, box["x"] + 75, box["y"] + 105, meanwhile=change())
        return await reads(page, "^repeat 3 times\nend")

    assert visited(browser, robot_site, drag) == "repeat 3 times\nend\n"


@needs_blocks
def test_a_number_is_written_while_the_robot_changes(browser: Chromium, robot_site: str) -> None:
    """While a number of a block is edited, the page reports the loss of the robot, and the number stays open."""

    async def write(visit: Visit) -> str:
        page = visit.page
        await wrote(page, "wait 2 s\n")
        answers = await answered(page)
        await wrote(page, "wait 2 s\n")
        await page.locator(
            ".blocklyBlockCanvas .blocklyNumberInput, .blocklyBlockCanvas .blocklyEditableField"
        ).first.click()
        field = page.locator(".blocklyHtmlInput")
        await field.fill("7")
        answers.append({**answers[0], "state": "lost", "problem": {"code": "KG803", "message": "the cable broke"}})
        await said(page, "#connection", "does not answer any more")
        answers.append(at_the_door(answers[0]))
        await page.get_by_role("button", name="Go there: the door").wait_for()
        await field.press("End")
        await page.keyboard.type("1")
        await field.press("Enter")
        return await reads(page, "71")

    assert visited(browser, robot_site, write) == "wait 71 s\n"
