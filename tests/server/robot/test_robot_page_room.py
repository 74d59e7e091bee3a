"""The space of the program on the robot page, and units that slots of blocks take from their neighbours."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from robotpage import needs_blocks, reads, said, still, visited, wrote

if TYPE_CHECKING:
    from browsing import Chromium, Visit

WIDE = 'if x of "sense its pose" < 50 cm and not y of "sense its pose" - 2 m > 3 m then\n  stop\nend\n'
ROOM = """() => {
  const width = (selector) => document.querySelector(selector).getBoundingClientRect().width;
  return [width("#blocks") - width(".blocklyToolbox"), width(".kg_logic > .blocklyPath")];
}"""


@needs_blocks
@pytest.mark.parametrize(("width", "least"), [(1440, 900), (1024, 500), (390, 200)])
def test_the_program_has_the_room(browser: Chromium, robot_site: str, width: int, least: int) -> None:
    """With the text folded, the program fills most of the page; a condition of several parts wraps into it."""

    async def look(visit: Visit) -> tuple[float, float]:
        page = visit.page
        await wrote(page, WIDE)
        await page.locator("#show-text").click()
        await still(page)
        room, condition = await page.evaluate(ROOM)
        return room, condition

    room, condition = visited(browser, robot_site, look, viewport={"width": width, "height": 900})
    assert room >= least
    assert condition <= 520  # 621, and more for longer ones, when all parts were in one row


@needs_blocks
def test_the_text_is_folded_until_it_is_wanted(browser: Chromium, robot_site: str) -> None:
    """A button shows and folds the text, and is labelled accordingly; text with a syntax error is shown."""

    async def fold(visit: Visit) -> list[tuple[str | None, bool]]:
        page = visit.page
        button, text = page.locator("#show-text"), page.locator("#text")
        found = [(await button.get_attribute("aria-expanded"), await text.is_visible())]
        await button.press("Enter")
        found.append((await button.get_attribute("aria-expanded"), await text.is_visible()))
        await page.evaluate("location.hash = 'program=aWY'")
        await said(page, "#text-state", "cannot be read")
        found.append((await button.get_attribute("aria-expanded"), await text.is_visible()))
        return found

    assert visited(browser, robot_site, fold) == [("true", True), ("false", False), ("true", True)]


@needs_blocks
def test_a_number_takes_the_unit_of_its_neighbour(browser: Chromium, robot_site: str) -> None:
    """In a comparison with a length, a plain number is in metres; the text has the unit."""

    async def put(visit: Visit) -> str:
        page = visit.page
        await wrote(page, "if 1 < 2 then\n  stop\nend\n")
        await page.locator(".kg_compare").wait_for()
        await page.evaluate("""() => {
          const { Blockly } = window;
          const inner = Blockly.getMainWorkspace();
          const [compare] = inner.getBlocksByType("kg_compare");
          const read = inner.newBlock("read sensingPose");
          read.initSvg();
          compare.getInput("LEFT").connection.connect(read.outputConnection);
        }""")
        return await reads(page, "x of .* < 2 m then")

    assert "if x of" in visited(browser, robot_site, put)


def test_hints_name_what_the_page_has(browser: Chromium, robot_site: str) -> None:
    """The hint about an unnamed place omits terminal commands, which are unavailable on the page."""

    async def write(visit: Visit) -> str:
        await wrote(visit.page, "go to a pose  at: nowhere\n")
        return await said(visit.page, "#problems", "no place is called")

    hint = visited(browser, robot_site, write)
    assert "click into the picture" in hint
    assert "--" not in hint
