"""Late or reordered responses never discard newer edits or requests."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Final

import pytest

from kg.server.libraries import HELP, libraries

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from browsing import Chromium, Visit
    from listing import Shown
    from playwright.async_api import Page

    Work = Callable[[Visit], Coroutine[Any, Any, Any]]

_NEEDS_LIBRARIES = pytest.mark.skipif(not libraries(), reason=HELP)
_WIDE: Final = {"width": 1500, "height": 1100}

# Responses from addresses with a part are held until the test releases one. Their content is then available at once, so
# the page processes a response in the same turn in which it receives it.
_HELD: Final = """(part) => {
  const real = window.fetch;
  window.kgHeld = [];
  window.fetch = async (path, init) => {
    const answer = await real(path, init);
    if (!String(path).includes(part)) return answer;
    const body = await answer.text();
    await new Promise((resolve) => window.kgHeld.push(resolve));
    const { ok, status, headers, url } = answer;
    return { ok, status, headers, url, text: async () => body, json: async () => JSON.parse(body) };
  };
}"""


async def _held(page: Page, count: int) -> None:
    """Wait until so many responses are held; one more may have arrived."""
    await page.wait_for_function("count => window.kgHeld.length >= count", arg=count)


async def _through(page: Page, number: int, act: str = "") -> None:
    """Release a response right after an action in the page; return when the page has processed it."""
    await page.evaluate(f"""async () => {{
      {act};
      window.kgHeld[{number}]();
      await new Promise((resolve) => setTimeout(resolve));
    }}""")


def _composed(browser: Chromium, site: str, work: Work) -> Any:
    """Return the result of `work` on the block editor of rules, with two rules opened one after the other."""

    async def visit() -> Any:
        async with browser.visit(f"{site}/rule-blocks?name=communication/feeds", kept=True, viewport=_WIDE) as visited:
            found = await work(visited)
            assert await visited.troubles() == []
            return found

    return browser.run(visit())


async def _judged(page: Page) -> str:
    """Return the text of the rule once no check is pending."""
    await page.locator("#state[aria-busy=false]").wait_for()
    return await page.locator("#text").input_value()


async def _written(page: Page, text: str) -> None:
    """Type at the end of the rule's text."""
    await page.locator("#editor .cm-content").click()
    await page.keyboard.press("Control+End")
    await page.keyboard.insert_text(text)


_UNDO: Final = "document.getElementById('undo').click()"


@_NEEDS_LIBRARIES
def test_a_block_is_not_lost_to_an_older_text(browser: Chromium, site: str) -> None:
    """An edit of blocks during the parsing of an older text is preserved, and the text contains it."""

    async def edit(visit: Visit) -> tuple[str, str]:
        page = visit.page
        await page.get_by_role("button", name="Examples").click()
        await page.get_by_role("button", name="Who listens to whom").click()
        await _judged(page)
        await page.evaluate(_HELD, "blocks_check")
        await _written(page, "\n# later")
        await _held(page, 1)
        await _through(page, 0, _UNDO)
        await _held(page, 2)
        await _through(page, 1)
        await _held(page, 3)
        await _through(page, 2)
        return await _judged(page), "".join(await page.locator("#blocks .blocklyBlockCanvas").all_text_contents())

    text, blocks = _composed(browser, site, edit)
    assert "later" not in text
    assert "speaker" not in text
    assert "speaker" not in blocks


@_NEEDS_LIBRARIES
def test_what_is_kept_is_what_was_seen_then(browser: Chromium, site: str) -> None:
    """Saving a rule and starting another at once saves the first one and shows the other."""

    async def edit(visit: Visit) -> tuple[str, str]:
        page = visit.page
        await page.evaluate(_HELD, "blocks_check")
        await page.fill("#rule-title", "Another title")
        await page.press("#rule-title", "Tab")
        await _held(page, 1)
        await page.evaluate("""() => {
          document.getElementById("save").click();
          document.getElementById("new").click();
          for (const answer of window.kgHeld) answer();
          window.kgHeld = { push: (answer) => answer() };
        }""")
        await page.wait_for_function("() => document.getElementById('rule-name').value === 'mine/rule'")
        await _judged(page)
        names = "Object.keys(localStorage).filter((name) => name.startsWith('kg-rule-blocks '))"
        return await page.locator("#rule-title").input_value(), await page.evaluate(names)

    title, kept = _composed(browser, site, edit)
    assert kept == ["kg-rule-blocks communication/feeds"]
    assert title == ""


@_NEEDS_LIBRARIES
def test_a_text_is_not_lost_to_older_blocks(browser: Chromium, site: str) -> None:
    """Text typed during the check of older blocks or an older form stays in the editor, and becomes the rule."""

    async def edit(visit: Visit) -> str:
        page = visit.page
        await page.evaluate(_HELD, "blocks_check")
        await page.fill("#rule-title", "Another title")
        await page.press("#rule-title", "Tab")
        await _held(page, 1)
        await _written(page, "\n# typed meanwhile")
        await _through(page, 0)
        text = await page.locator("#text").input_value()
        await _held(page, 2)
        return text

    assert _composed(browser, site, edit).endswith("# typed meanwhile")


@_NEEDS_LIBRARIES
def test_a_form_is_not_lost_to_an_older_text(browser: Chromium, site: str) -> None:
    """A form edited during the parsing of an older text is preserved, and the text adopts its value."""

    async def edit(visit: Visit) -> tuple[str, str, str]:
        page = visit.page
        await page.evaluate(_HELD, "blocks_check")
        await page.locator("#editor .cm-content").click()
        await page.keyboard.press("Control+Home")
        await page.keyboard.press("End")
        await page.keyboard.insert_text(" typed")
        await _held(page, 1)
        await page.fill("#rule-why", "Why not?")
        await _through(page, 0)
        await page.wait_for_function("() => document.getElementById('rule-title').value.endsWith(' typed')")
        why = await page.input_value("#rule-why")
        await page.press("#rule-why", "Tab")
        for number in (1, 2, 3):
            await _held(page, number + 1)
            await _through(page, number)
            if "Why not?" in await page.locator("#text").input_value():
                break
        return why, await page.input_value("#rule-title"), await page.locator("#text").input_value()

    why, title, text = _composed(browser, site, edit)
    assert why == "Why not?"
    assert title.endswith(" typed")
    assert "# Why not?" in text
    assert text.splitlines()[0].endswith(" typed")


@_NEEDS_LIBRARIES
def test_a_choice_is_not_lost_to_an_older_text(browser: Chromium, site: str) -> None:
    """While a user edits a field of a block, no redraw removes the block."""

    async def edit(visit: Visit) -> str:
        page = visit.page
        await page.evaluate(_HELD, "blocks_check")
        await _written(page, "\n# typed")
        await _held(page, 1)
        await page.locator(".kr_is .blocklyEditableField, .kr_fact .blocklyEditableField").last.click()
        await page.locator("#choose-dialog[open]").wait_for()
        await _through(page, 0)
        await page.fill("#choose-field", "chosen")
        await page.locator("#choose-list[aria-busy=false] button", has_text="chosen").first.click()
        await _held(page, 2)
        await _through(page, 1)
        return await page.locator("#text").input_value()

    assert "hosen" in _composed(browser, site, edit)


def test_what_is_tried_is_what_is_seen(browser: Chromium, site: str) -> None:
    """Keys run the rule once, with the title still being edited; results are never those of an older rule."""

    async def attempt(visit: Visit) -> tuple[list[str], list[int], str]:
        page = visit.page
        asked: list[str] = []
        page.on("request", lambda one: asked.append(one.post_data or "") if "blocks_try" in one.url else None)
        await page.locator("#editor .cm-content, #text:visible").first.click()
        await page.keyboard.press("Control+Enter")
        await page.locator(".rule-found").wait_for()
        many = [len(asked)]
        await page.evaluate(_HELD, "blocks_try")
        await page.locator("#rule-title").focus()
        await page.keyboard.press("End")
        await page.keyboard.insert_text(", seen")
        await page.keyboard.press("Control+Enter")
        await _held(page, 1)
        many.append(len(asked))
        await page.click("#new")
        await _through(page, 0)
        await _judged(page)
        return asked, many, await page.inner_text("#tried")

    asked, many, tried = _composed(browser, site, attempt)
    assert many == [1, 2]
    assert json.loads(asked[1])["text"].splitlines()[0].endswith(", seen")
    assert tried == ""


def test_the_rule_asked_for_last_is_opened(browser: Chromium, site: str) -> None:
    """Of two opened rules the second is shown, in any order of responses; a response after an edit is discarded."""

    async def choose(visit: Visit) -> tuple[str, str, str, str]:
        page = visit.page
        await page.evaluate(_HELD, "blocks_open")
        for number, name in enumerate(("capability/evokes", "function/weighed")):
            await page.evaluate(
                "name => [...document.querySelectorAll('#open-rules button')].find((one) => one.innerText === name"
                " || one.textContent === name).click()",
                name,
            )
            await _held(page, number + 1)
        await _through(page, 1)
        await _through(page, 0)
        await _judged(page)
        first = await page.input_value("#rule-name")
        await page.evaluate(
            "() => [...document.querySelectorAll('#open-rules button')].find((one) =>"
            " one.textContent === 'capability/evokes').click()"
        )
        await _held(page, 3)
        await page.fill("#rule-title", "Edited")
        await _through(page, 2)
        await page.locator("#message", has_text="was not opened").wait_for()
        return first, await page.input_value("#rule-name"), await page.input_value("#rule-title"), await _judged(page)

    first, name, title, _ = _composed(browser, site, choose)
    assert (first, name, title) == ("function/weighed", "function/weighed", "Edited")


def test_what_was_written_last_is_there_again(browser: Chromium, site: str) -> None:
    """After leaving the page during an edit and returning, the edit is present."""

    async def leave(visit: Visit) -> str:
        page = visit.page
        await page.goto(f"{site}/rule-blocks", wait_until="load")
        await _judged(page)
        await page.locator("#rule-title").fill("Half a title")
        await page.goto(f"{site}/rules", wait_until="load")
        await page.go_back(wait_until="load")
        await page.locator("#rule-page[aria-busy=false]").wait_for()
        return await page.input_value("#rule-title")

    assert _composed(browser, site, leave) == "Half a title"


def test_the_proof_asked_for_last_is_shown(browser: Chromium, site: str, things: Shown) -> None:
    """Of two proofs the second is shown, in any order of responses; a response after closing the panel is discarded."""

    async def prove() -> tuple[str, str, bool]:
        async with browser.visit(f"{site}/node?iri={things['node']}", kept=True) as visit:
            page = visit.page
            await page.evaluate(_HELD, "/why")
            links = page.locator("a.why")
            for number in range(2):
                await links.nth(number).evaluate("one => one.click()")
                await _held(page, number + 1)
            second = str(await links.nth(1).get_attribute("data-why"))
            await _through(page, 1)
            await page.locator("#why[open]").wait_for()
            await _through(page, 0)
            own = str(await page.locator("#why-body > p > a").get_attribute("href"))
            await page.locator("#why a[data-why], a.why").first.evaluate("one => one.click()")
            await _held(page, 3)
            await _through(page, 2, "document.getElementById('why').close()")
            return second.partition("?")[2], own.partition("?")[2], await page.locator("#why[open]").count() == 0

    second, own, closed = browser.run(prove())
    assert own == second
    assert closed
