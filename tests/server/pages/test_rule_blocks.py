"""The block editor of rules: composing with the mouse, trying, downloading, and running the file."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

import pytest
from cli.program import Program

from kg.resources import folder
from kg.rules.blocks.read import read
from kg.rules.blocks.write import write
from kg.server.libraries import HELP, libraries

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from pathlib import Path
    from typing import TypeVar

    from browsing import Chromium, Visit
    from cli.program import Run
    from playwright.async_api import Locator, Page

    Found = TypeVar("Found")

pytestmark = pytest.mark.skipif(not libraries(), reason=HELP)

_WIDE: Final = {"width": 1500, "height": 1100}


def _visited(browser: Chromium, site: str, work: Callable[[Visit], Awaitable[Found]], path: str = "") -> Found:
    """Return the result of `work` on the page, which must report no problem."""

    async def visit() -> Found:
        async with browser.visit(f"{site}/rule-blocks{path}", kept=True, viewport=_WIDE) as visited:
            await _checked(visited.page)
            found = await work(visited)
            assert await visited.troubles() == []
            return found

    return browser.run(visit())


async def _checked(page: Page) -> str:
    """Return the status of the rule once it has been checked."""
    state = page.locator("#state[aria-busy=false]", has_text=re.compile(r"\w"))
    await state.wait_for()
    return await state.inner_text()


async def _begun(page: Page) -> None:
    """Start a new rule."""
    await page.click("#new")
    await page.locator("#state", has_text="start from an example").wait_for()


async def _dropped(page: Page, category: str, block: str, where: str, part: str) -> None:
    """Drag a block from the palette to the socket after a word of the rule, whose text then contains a part of it."""
    await page.locator(".blocklyToolboxCategory", has_text=re.compile(f"^{category}$")).click()
    offered = page.locator(".blocklyFlyout .blocklyDraggable", has_text=re.compile(block)).first
    await offered.hover()
    start = await offered.bounding_box()
    word = page.locator(".kr_rule > .blocklyLabelField", has_text=re.compile(f"^{where}$"))
    end = await word.first.bounding_box()
    assert start
    assert end
    await page.mouse.move(start["x"] + 6, start["y"] + start["height"] / 2)
    await page.mouse.down()
    await page.mouse.move(start["x"] - 30, start["y"] + 20, steps=5)
    await page.mouse.move(end["x"] + end["width"] + 24, end["y"] + 8, steps=12)
    await page.mouse.up()
    await _text(page, part)
    await _checked(page)


def _word(page: Page, text: str) -> Locator:
    """Return the last field of the blocks with this text."""
    return page.locator(
        ".blocklyBlockCanvas .blocklyEditableField", has_text=re.compile(f"^{text}$".replace(" ", "."))
    ).last


async def _chosen(page: Page, word: str, typed: str, choice: str) -> None:
    """Click a word of a block, type, and select an option of the dialog."""
    await _word(page, word).click()
    await page.fill("#choose-field", typed)
    await page.locator("#choose-list button", has_text=choice).first.click()
    await page.locator("#choose-dialog").wait_for(state="hidden")


async def _text(page: Page, part: str) -> str:
    """Return the text of the rule once it contains a part."""
    await page.wait_for_function("part => document.getElementById('text').value.includes(part)", arg=part)
    return await page.locator("#text").input_value()


async def _kept(page: Page, name: str, target: Path) -> Path:
    async with page.expect_download() as download:
        await page.get_by_role("button", name=re.compile(name)).click()
    path = target / (await download.value).suggested_filename
    await (await download.value).save_as(path)
    return path


def test_a_rule_is_composed_tried_and_run(browser: Chromium, site: str, store: Path, tmp_path: Path) -> None:
    """Blocks from the lists make a rule; it is tried, and the downloaded file passes `kg rules check` and `test`."""
    mine = tmp_path / "rules" / "mine"
    mine.mkdir(parents=True)

    async def compose(visit: Visit) -> tuple[str, str]:
        page = visit.page
        await _begun(page)
        await page.fill("#rule-name", "mine/talks-on")
        await page.fill("#rule-title", "Which laser scans a node sends")
        await page.fill("#rule-why", "Who sends scans?")
        await _dropped(page, "Conclusions", "new.relation", "then", "my:newRelation")
        await _dropped(page, "Topic", "has.message", "when", "rnkg:hasMessage")
        await _dropped(page, "Node", "publishes", "when", "rnkg:publishes")
        await _chosen(page, "new relation", "sends on", "my:sendsOn")
        await _text(page, "my:sendsOn")
        await _dropped(page, "Message type", "is.called", "when", "?type rdfs:label")
        await _chosen(page, "“name”", "laser", "sensor_msgs/LaserScan")
        text = await _text(page, "LaserScan")
        await page.click("#share")
        await page.locator("#share-dialog[open]").wait_for()
        return text, (await page.input_value("#share-link")).partition("/rule-blocks")[2]

    async def attempt(visit: Visit) -> tuple[str, str, int]:
        page = visit.page
        state = await _checked(page)
        await page.click("#try")
        found = await page.locator(".rule-found").inner_text()
        await page.locator(".rule-facts summary").first.click()
        reasons = await page.locator(".rule-facts details[open] li").count()
        await _kept(page, "Download .rq", mine)
        await _kept(page, "Download examples", mine)
        return state, found, reasons

    text, link = _visited(browser, site, compose)
    state, found, reasons = _visited(browser, site, attempt, link)
    assert "?node rnkg:publishes ?topic ." in text
    assert "?topic rnkg:hasMessage ?type ." in text
    assert '?type rdfs:label "sensor_msgs/LaserScan" .' in text
    assert "CONSTRUCT { ?node my:sendsOn ?topic }" in text
    assert state == "The rule can run; there are notes."
    assert reasons == 3
    assert found.startswith("2 facts, none of which the store has yet")
    assert sorted(path.name for path in mine.iterdir()) == ["talks-on.md", "talks-on.rq"]
    told = _kg("rules", "check", "mine/talks-on", "--level", "warning", rules=mine.parent, store=store)
    assert "1 rule checked" in told.err
    assert told.code == 0, told.out
    tested = _kg("rules", "test", "mine/talks-on", rules=mine.parent, store=store)
    assert tested.code == 0, tested.out
    assert "all passed" in tested.err


def _kg(*words: str, rules: Path, store: Path) -> Run:
    return Program(rules)("--store", str(store), *words, "--rules", str(rules))


def test_what_is_not_said_is_named_as_its_fields(browser: Chromium, site: str) -> None:
    """A finding about the documentation names the empty fields, and links to the first of them."""

    async def find(visit: Visit) -> tuple[str, str | None]:
        page = visit.page
        await page.fill("#rule-why", "")
        await page.press("#rule-why", "Tab")
        finding = page.locator("#findings li", has_text="Nothing is said")
        said = await finding.inner_text()
        await finding.locator("button").click()
        return said, await page.locator(":focus").get_attribute("id")

    said, focused = _visited(browser, site, find)
    assert "Nothing is said under “Why”." in said
    assert focused == "rule-why"


@pytest.mark.parametrize("name", ["capability/evokes", "architecture/near-miss-topic", "function/weighed"])
def test_rules_of_the_store_are_shown(browser: Chromium, site: str, name: str) -> None:
    """An existing rule is opened as blocks that give its text; parts without a block remain SPARQL."""

    async def look(visit: Visit) -> str:
        return await visit.page.input_value("#text")

    path = folder("rules") / f"{name}.rq"
    expected = write(read(path.read_text("utf-8"), name)).text
    assert _visited(browser, site, look, f"?name={name}") == expected


def test_text_becomes_blocks(browser: Chromium, site: str) -> None:
    """Typed text is shown as blocks; a syntax error is reported with its line, and the blocks remain."""
    header = "# T\n#\n# ## Why\n#\n# W\n#\n# since: 0.1\n\n"
    text = f"{header}CONSTRUCT {{ ?a rnkg:feeds ?b }} WHERE {{ ?a rnkg:calls ?c . ?b rnkg:provides ?c"

    async def write_text(visit: Visit) -> tuple[str, str, str, int]:
        page = visit.page
        await page.locator("#editor .cm-content").click()
        await page.keyboard.press("Control+a")
        await page.keyboard.press("Delete")
        await page.keyboard.insert_text(text)
        # A rule without any text, as in between, cannot be shown either.
        await page.locator("#state[aria-busy=false]", has_text="cannot be shown").wait_for()
        error = await page.locator("#findings li.error").inner_text()
        await page.keyboard.insert_text(" }")
        await _word(page, "provides").wait_for()
        title = await page.input_value("#rule-title")
        await page.locator("#state", has_text=re.compile("nothing wrong|notes")).wait_for()
        return error, title, await page.input_value("#text"), await page.locator("#blocks .kr_fact").count()

    error, title, kept, blocks = _visited(browser, site, write_text)
    assert "KG201" in error
    assert "line 9" in error
    assert title == "T"
    assert kept == f"{text} }}"
    assert blocks == 3


def test_rules_are_kept_and_things_renamed(browser: Chromium, site: str) -> None:
    """A variable is renamed everywhere; the rule is saved in the browser, opened again, and undone."""

    async def keep(visit: Visit) -> tuple[str, str, str]:
        page = visit.page
        await page.get_by_role("button", name="Examples").click()
        await page.get_by_role("button", name="Who listens to whom").click()
        await _text(page, "?speaker")
        await _word(page, "speaker").click()
        await page.fill("#choose-field", "talker")
        await page.get_by_role("button", name="everywhere").click()
        renamed = await _text(page, "?talker")
        await page.click("#save")
        await page.click("#new")
        await page.locator("#state", has_text="start from an example").wait_for()
        await page.click("#open")
        await page.locator("#open-list button").first.click()
        kept = await _text(page, "?talker")
        await page.click("#undo")
        return renamed, kept, await page.input_value("#rule-name")

    renamed, kept, name = _visited(browser, site, keep)
    assert renamed.count("?talker") == 3
    assert "speaker" not in renamed.partition("CONSTRUCT")[2]
    assert kept == renamed
    assert name == "wiring/listens-to"


_FITTING: Final = """async () => {
  const { Vocabulary } = await import("/static/rule-blocks/vocabulary.js");
  const known = await (await fetch("/api/blocks?fresh=1")).json();
  const vocabulary = new Vocabulary(known);
  const thing = (name) => ({ term: "thing", name });
  const fact = (id, property) => ({ block: "fact", id, subject: thing("node"), property, object: thing("topic") });
  const when = [fact("one", "rnkg:publishes"), fact("two", "rnkg:hasMessage")];
  const fits = (kind) => vocabulary.fits("rnkg:subscribes", "to", [[kind]]);
  return {
    misfits: vocabulary.misfits({ when, then: [] }).map(({ id, message }) => [id, message]),
    main: vocabulary.main(vocabulary.kinds({ when: when.slice(0, 1), then: [] }).get("topic")),
    first: vocabulary.of("ros:Topic").slice(0, 6).map(({ name }) => name),
    takes: [fits("ros:Topic"), fits("ros:Package")],
    instance: vocabulary.fits("rnkg:publishes", "from", [["rnkg:NodeInstance"]]),
  };
}"""


def test_connectors_take_what_fits(browser: Chromium, site: str) -> None:
    """The ontology gives the domain and range of a property; a subclass fits, any other block is explained in words."""

    async def ask(visit: Visit) -> dict[str, object]:
        found: dict[str, object] = await visit.page.evaluate(_FITTING)
        return found

    found = _visited(browser, site, ask)
    assert found["main"] == "ros:Topic"
    assert "rnkg:hasMessage" in str(found["first"])
    assert found["takes"] == [True, False]
    assert found["instance"] is True
    assert found["misfits"] == [
        ["one", "“publishes” is said of a node, and `node` is a topic"],
        ["one", "“publishes” leads to a topic, and `topic` is a message type"],
        ["two", "“has message” is said of a topic, and `node` is a node"],
        ["two", "“has message” leads to a message type, and `topic` is a topic"],
    ]


def test_without_libraries_the_text_is_there(browser: Chromium, site: str) -> None:
    """Without the libraries, a rule is written as text, checked and tried as usual."""

    async def use() -> tuple[bool, str]:
        async with browser.visit(f"{site}/search", kept=True) as visit:
            page = visit.page
            await page.route("**/vendor/**", lambda route: route.abort())
            await page.goto(f"{site}/rule-blocks", wait_until="load")
            await visit.rest()
            await _checked(page)
            await page.click("#try")
            return await page.locator("#blocks").is_visible(), await page.locator(".rule-found").inner_text()

    shown, found = browser.run(use())
    assert not shown
    assert found.startswith("38 facts")
