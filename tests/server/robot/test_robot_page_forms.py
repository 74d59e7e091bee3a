"""Stacking of elements on the robot page, and the fields of its forms."""

from __future__ import annotations

from typing import TYPE_CHECKING

from robotpage import needs_blocks, visited

if TYPE_CHECKING:
    from browsing import Chromium, Visit

ABOVE = """() => {
  const offered = document.querySelector(".blocklyToolbox");
  const bar = document.querySelector(".robot-bar");
  window.scrollBy(0, offered.getBoundingClientRect().top - bar.getBoundingClientRect().top);
  const { left, top, width, height } = bar.getBoundingClientRect();
  const right = offered.getBoundingClientRect();
  const hit = document.elementFromPoint(right.left + right.width / 2, top + height / 2);
  return [right.top < top + height && right.bottom > top, bar.contains(hit)];
}"""


@needs_blocks
def test_the_bar_with_stop_lies_above_the_blocks(browser: Chromium, robot_site: str) -> None:
    """When scrolled, the palette of blocks is below the bar."""

    async def scroll(visit: Visit) -> list[bool]:
        found: list[bool] = await visit.page.evaluate(ABOVE)
        return found

    assert visited(browser, robot_site, scroll, viewport={"width": 1400, "height": 600}) == [True, True]


def test_a_goal_is_not_sent_without_its_place(browser: Chromium, robot_site: str) -> None:
    """The form has no default place, and asks for one if it is submitted without."""

    async def send(visit: Visit) -> tuple[str, str, str]:
        page = visit.page
        await page.locator("details[data-key=write-goingToPose] > summary").click()
        before = await page.locator("#write-goingToPose-x").input_value()
        await page.locator("#write-goingToPose-do").click()
        asked = await page.evaluate("document.activeElement.id + ' ' + document.activeElement.validity.valueMissing")
        return before, asked, str(await page.locator("#log").text_content()).strip()

    assert visited(browser, robot_site, send) == ("", "write-goingToPose-x true", "")
