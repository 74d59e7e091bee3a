"""The robot page in a browser: programs by mouse, keys and text, run on a moving robot, and stopped."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

import httpx
from browsing import axe
from listing import inspect
from patience import patient
from robotpage import dragged, log_in, needs_blocks, offered, opened, reads, said, still, visited, wrote

from kg.server.libraries import libraries

if TYPE_CHECKING:
    from browsing import Chromium, Visit
    from playwright.async_api import Page

SLOW: Final = "move at a velocity forward: 0.2 for 600 s\n"
PROGRAM: Final = """program "to and fro"
repeat 2 times
  drivingAtVelocity forward: 0.2 m/s for 0.5 s
  drivingAtVelocity forward: -0.2 m/s for 0.5 s
end
log "there"
"""


def test_why_it_can_is_shown_step_by_step(browser: Chromium, robot_site: str) -> None:
    """The proof is below the words as nested lists, down to the observed node; filtering keeps it open."""

    async def look(visit: Visit) -> tuple[str, int, str]:
        page = visit.page
        of = page.locator("details[data-key=write-drivingAtVelocity]")
        await of.locator("summary").first.click()
        await of.get_by_text("Why it can").click()
        await of.get_by_text("Step by step").click()
        top = await said(page, "#abilities .proof > li > .fact", "has capability")
        depth = await page.locator("#abilities .proof ul ul li").count()
        leaf = await said(page, "#abilities .proof ul .by", "seen since")
        await page.locator("#abilities-filter").fill("move")
        await said(page, "details[data-key=write-drivingAtVelocity] .proof .by", "seen since")
        opened = await page.locator("#abilities .robot-proof[open]").count()
        return top, min(depth, opened), leaf

    top, shown, leaf = visited(browser, robot_site, look)
    assert (top, shown) == ("/base has capability move at a velocity", 1)
    assert leaf.startswith("/base at ")


EXAMPLES: Final = """async () => {
  const { examples } = await import("/static/robot/examples.js");
  const list = document.createElement("ul");
  const fast = "move at a velocity forward: 9 for 1 s";
  const all = ["landing", "pickingUp x: 1 m, y: 2 m within 9 s", fast, "wait for 1 s"];
  const { capabilities } = await (await fetch("/api/robot")).json();
  await examples(list, all.map((text) => ({ name: text.split(" ")[0], comment: "", text })), capabilities, () => null);
  return [...list.children].map((one) => [...one.children].map(({ textContent }) => textContent));
}"""


def test_examples_that_fit_come_first(browser: Chromium, robot_site: str) -> None:
    """The list of examples starts with those the robot can run, and names the missing capabilities of the others."""

    async def look(visit: Visit) -> tuple[list[list[str]], list[str]]:
        page = visit.page
        await page.locator("#examples").click()
        await said(page, "#examples-list .robot-lacks", "lacks: ")
        return await page.evaluate(EXAMPLES), await page.locator(".robot-lacks").all_text_contents()

    made, shipped = visited(browser, robot_site, look)
    assert made[:3] == [
        ["wait"],
        ["landing", "This robot lacks: landing."],
        ["pickingUp", "This robot lacks: picking up."],
    ]
    assert re.match("Does not fit this robot: .* at most 1", made[3][1])
    assert any("landing" in one for one in shipped)


@needs_blocks
def test_blocks_that_hang_loose_are_told(browser: Chromium, robot_site: str) -> None:
    """A block dropped near the program joins it; one dropped far away is marked as having no effect."""

    async def build(visit: Visit) -> tuple[str, str, bool]:
        page = visit.page
        box = await page.locator("#blocks").bounding_box()
        assert box is not None
        await dragged(page, await offered(page, "Control", "repeat"), box["x"] + 75, box["y"] + 105)
        near = await reads(page, "^repeat 3 times\nend")
        await dragged(page, await offered(page, "Control", "wait"), box["x"] + 60, box["y"] + 400)
        told = await said(page, "#loose", "not joined")
        await page.locator("#undo").click()
        await page.locator("#loose").wait_for(state="hidden")
        return near, told, await page.locator("#text").input_value() == near

    near, told, same = visited(browser, robot_site, build)
    assert near.startswith("repeat 3 times")
    assert told.startswith("A grey piece is not joined to the program and will not run")
    assert same


@needs_blocks
def test_another_size_leaves_the_blocks_in_sight(browser: Chromium, robot_site: str) -> None:
    """When the window is resized, the blocks stay in place, or return into view."""
    place = """() => {
      const box = (one) => document.querySelector(one).getBoundingClientRect();
      const [block, room] = [box(".blocklyBlockCanvas .blocklyDraggable"), box("#blocks")];
      return [Math.round(block.left - room.left), Math.round(block.top - room.top), Math.round(room.width)];
    }"""

    async def change(visit: Visit) -> list[list[int]]:
        page = visit.page

        async def become(width: int) -> list[int]:
            await page.set_viewport_size({"width": width, "height": 900})
            await page.wait_for_function("width => window.innerWidth === width", arg=width)
            await still(page)
            return [int(one) for one in await page.evaluate(place)]

        await wrote(page, PROGRAM)
        found = [await become(width) for width in (1440, 700, 1440)]
        box = await page.locator("#blocks").bounding_box()
        assert box is not None
        await page.mouse.move(box["x"] + 200, box["y"] + 250)
        await page.mouse.wheel(-300, 0)
        await page.wait_for_function(f"left => ({place})()[0] > left + 200", arg=found[0][0])
        await still(page)
        found.append(await page.evaluate(place))
        return [*found, await become(390)]

    first, small, again, moved, smallest = visited(browser, robot_site, change)
    assert first == again
    assert first[:2] == small[:2]
    assert moved[0] > first[0] + 200
    assert 0 <= smallest[0] < smallest[2] / 2


def test_a_robot_that_is_lost_is_told_and_met_again(browser: Chromium, robot_site: str) -> None:
    """While the robot is lost the page reports it and moves nothing; after reconnecting, programs run as before."""
    hello = 'retry: 300\ndata: {"event": "hello", "listener": "x"}\n\n'

    async def lose(visit: Visit) -> tuple[bool, bool, str]:
        page = visit.page
        there = await page.evaluate("fetch('/api/robot').then((answer) => answer.json())")
        gone = {**there, "state": "lost", "problem": {"code": "KG803", "message": "the cable broke"}, "view": None}
        answers = [there]
        await page.route("**/api/robot", lambda route: route.fulfill(json=answers[-1]))
        await page.route("**/robot/events", lambda route: route.fulfill(content_type="text/event-stream", body=hello))
        await page.reload(wait_until="load")
        await wrote(page, "wait for 1 s\n")
        await page.locator("#run:enabled").wait_for()
        answers.append(gone)
        await said(page, "#connection", "does not answer any more.*the cable broke")
        await said(page, "#log", "does not answer any more: the cable broke")
        disabled = await page.locator("[id$=-do], #run").evaluate_all("all => all.every((one) => one.disabled)")
        answers.append(there)
        await page.locator("#run:enabled").wait_for()
        enabled = await page.locator("[id$=-do]").first.is_enabled()
        return disabled, enabled, await said(page, "#log", "The robot is back")

    disabled, enabled, _ = visited(browser, robot_site, lose)
    assert (disabled, enabled) == (True, True)


async def apart(page: Page) -> bool:
    """Whether the notice is separated from its neighbours above and below, on a screen and on a phone."""
    gaps = """() => {
      const box = (one) => document.querySelector(one).getBoundingClientRect();
      const [above, notice, below] = [box("#connection"), box(".notice"), box("#abilities-title")];
      return Math.min(notice.top - above.bottom, below.top - notice.bottom);
    }"""
    found = []
    for width in (1440, 1000, 390):
        await page.set_viewport_size({"width": width, "height": 900})
        found.append(await page.evaluate(gaps) >= 8)
    return all(found)


def test_says_nothing_wrong_and_is_accessible(browser: Chromium, robot_site: str) -> None:
    """With a robot: no complaint, no policy violation, no finding of axe in light and dark, and it fits a phone."""

    async def look(visit: Visit) -> Any:
        await wrote(visit.page, PROGRAM)
        return await inspect(visit)

    found = visited(browser, robot_site, look, color_scheme="light")
    assert found.troubles == []
    assert (found.light, found.dark) == ([], []) or not axe()
    assert (found.missed, found.ringless) == ([], [])
    assert found.twins == 1
    assert found.width <= 390


def test_what_it_can_do_is_searched_and_explained(browser: Chromium, robot_site: str) -> None:
    """Words find capabilities by their names; each shows why the robot has it, in units and limits."""

    async def search(visit: Visit) -> tuple[list[str], str, str]:
        page = visit.page
        await page.locator("#abilities-filter").fill("turning speed")
        found = await page.locator("#abilities summary").all_text_contents()
        limits = await page.locator("#write-drivingAtVelocity-turn-limits").text_content()
        await page.get_by_text("Why it can").first.click()
        reason = await page.locator("#abilities details details li").first.text_content()
        await page.locator("#abilities-filter").fill("zzz")
        await page.get_by_text("Nothing that fits these words.").wait_for()
        return found, str(limits), str(reason)

    found, limits, reason = visited(browser, robot_site, search)
    assert "move at a velocity" in found
    assert limits.startswith("-2 to 2 rad/s")
    assert reason.startswith("Its node /base subscribes to /cmd_vel") or "`/base`" in reason


@needs_blocks
def test_a_program_by_mouse(browser: Chromium, robot_site: str) -> None:
    """Dragged blocks form the program, at once as text; undo removes the last one."""

    async def build(visit: Visit) -> tuple[str, str]:
        page = visit.page
        box = await page.locator("#blocks").bounding_box()
        assert box is not None
        await dragged(page, await offered(page, "Control", "repeat"), box["x"] + 40, box["y"] + 80)
        await reads(page, "^repeat 3 times\nend")
        await dragged(page, await offered(page, "Moves", "move at a velocity"), box["x"] + 62, box["y"] + 118)
        text = await reads(page, "move")
        await page.locator("#undo").click()
        return text, await reads(page, "^repeat 3 times\nend")

    text, undone = visited(browser, robot_site, build, viewport={"width": 1500, "height": 950})
    assert text.split() == ["repeat", "3", "times", "move", "at", "a", "velocity", "for", "2", "s", "end"]
    assert undone == "repeat 3 times\nend\n"


KEPT: Final = """() => {
  const running = document.getElementById("running");
  window.kgRunning = [];
  new MutationObserver(() => window.kgRunning.push(running.textContent)).observe(running, { childList: true });
}"""
"""Records the status of a running program, because some of it is visible only briefly."""


@needs_blocks
def test_a_program_by_keys_is_run(browser: Chromium, robot_site: str) -> None:
    """Without a mouse: a block is added, its number changed, the program run, and the robot has moved."""

    async def build(visit: Visit) -> tuple[str, str, list[str]]:
        page = visit.page
        await page.locator("#abilities-filter").focus()
        for key in ("Tab", "Enter"):
            await page.keyboard.press(key)
        await page.locator("#write-drivingAtVelocity-add").focus()
        await page.keyboard.press("Enter")
        await reads(page, "move at a velocity +for 2 s")
        await page.locator(".blocklyToolbox").first.wait_for()
        await page.locator("#fit").focus()
        # Past the palette into the program; down to the block, right to its first number.
        for key in ("Tab", "w", "ArrowDown", "ArrowDown", "ArrowRight", "ArrowRight", "Enter"):
            await page.keyboard.press(key)
            await still(page)
        await page.locator(".blocklyHtmlInput").wait_for()
        await page.keyboard.press("Control+a")
        await page.keyboard.type("0.4")
        await page.keyboard.press("Enter")
        text = await reads(page, "forward: 0.4")
        await page.locator("#program-name").focus()
        await page.evaluate(KEPT)
        await page.keyboard.press("Control+Enter")
        await said(page, "#log", "runs")
        await said(page, "#log", "is done", 20)
        return text, await page.evaluate("window.kgRunning"), await page.locator("#log > div").all_text_contents()

    text, running, log = visited(browser, robot_site, build)
    assert f"Now: {text.strip()}" in running
    assert "Done" in running
    assert len(log) >= 2


@needs_blocks
def test_text_and_blocks_are_one_program(browser: Chromium, robot_site: str) -> None:
    """A program written as text is shown as blocks; a type error is reported at both."""

    async def write(visit: Visit) -> tuple[int, str, list[str], int, list[str]]:
        page = visit.page
        await wrote(page, PROGRAM)
        blocks = await page.locator("#blocks .blocklyBlockCanvas g.blocklyDraggable").count()
        name = await page.locator("#program-name").input_value()
        await wrote(page, "wait for 2 m\nfly to the moon\n")
        problems = await page.locator("#problems li").all_text_contents()
        icons = await page.locator("#blocks .blocklyWarningIcon, #blocks .blocklyIconGroup").count()
        return blocks, name, problems, icons, await visit.violations() if axe() else []

    blocks, name, problems, icons, found = visited(browser, robot_site, write)
    assert name == "to and fro"
    assert blocks >= 5
    assert found == []
    assert len(problems) == 2
    assert "this should be a time" in problems[0]
    assert icons == 2


@needs_blocks
def test_places_have_names(browser: Chromium, robot_site: str) -> None:
    """The robot's places are destinations by click, by blocks and in the text; a point of the picture can be named."""

    async def go(visit: Visit) -> tuple[str, str, list[str], str]:
        page = visit.page
        await page.get_by_role("button", name="Add block: go to a pose, the desk").click()
        first = await reads(page, "the desk")
        await page.wait_for_function("() => document.querySelector('#view img')?.naturalWidth > 0")
        await page.locator("#view img").click(position={"x": 20, "y": 20})
        await page.locator("#place-name").fill("corner")
        await page.get_by_role("button", name="Name it in the program").click()
        named = await reads(page, "set corner")
        await wrote(page, named + "log corner\ngo to a pose  at: nowhere\n")
        problems = await page.locator("#problems li").all_text_contents()
        await wrote(page, named + "log corner\ngo to a pose  at: corner, heading: 0\n")
        await page.locator("#program-name").fill("there")
        await page.locator("#program-name").press("Tab")
        back = await reads(page, "there")
        assert back.partition("\n")[2] == named + "log corner\ngo to a pose  at: corner, heading: 0\n"
        await page.locator("#run").click()
        log = await said(page, "#log", r"\(x: ")
        await said(page, "#log", "is done")
        await page.get_by_role("button", name="Go there: the desk").click()
        await said(page, "#log", "go to a pose: done")
        return first, named, problems, log

    first, named, problems, log = visited(browser, robot_site, go)
    assert first == "go to a pose  at: 'the desk'\n"
    point = re.match(r"set corner to \(x: ([\d.]+) m, y: ([\d.]+) m\)\n", named)
    assert point is not None
    assert 0 < float(point[1]) < 2
    assert 7 < float(point[2]) < 9
    assert [one.partition(" line")[0] for one in problems] == ["no place is called nowhere"]
    assert f"(x: {point[1]} m, y: {point[2]} m)" in log


@needs_blocks
def test_a_goal_that_is_not_said_is_missing(browser: Chromium, robot_site: str) -> None:
    """A goal without a place gets a block with empty places, which remain empty when others are added."""

    async def write(visit: Visit) -> tuple[list[str], str, list[str]]:
        page = visit.page
        await wrote(page, "go to a pose\n")
        first = await page.locator("#problems li").all_text_contents()
        await page.locator("#write-drivingAtVelocity-add").evaluate("one => one.click()")
        text = await reads(page, "move at a velocity")
        await page.locator("#text-state[aria-busy=false]").wait_for()
        return first, text, await page.locator("#problems li").all_text_contents()

    first, text, second = visited(browser, robot_site, write)
    assert text == "go to a pose\nmove at a velocity for 2 s\n"
    assert (
        [one.partition("its ")[2][0] for one in first] == ["x", "y"] == [one.partition("its ")[2][0] for one in second]
    )


def test_running_marks_pauses_and_stops(browser: Chromium, robot_site: str) -> None:
    """The running block is marked; the program pauses and resumes; Escape stops it, wherever the focus is."""

    async def run(visit: Visit) -> tuple[int, str, str, int]:
        page = visit.page
        await wrote(page, SLOW)
        await page.locator("#run").click()
        await said(page, "#running", "^Now")
        marked = await page.locator("#blocks .runs").count()
        await page.locator("#pause").click()
        pausing = await said(page, "#pause", "Go on")
        await said(page, "#running", "^Pauses at: move at a velocity")
        await page.locator("#pause").click()
        await said(page, "#pause", "Pause")
        await page.locator("#text").focus()
        await page.keyboard.press("Escape")
        stopped = await said(page, "#running", "^Stopped$")
        return marked, pausing, stopped, await page.locator("#blocks .runs").count()

    marked, pausing, stopped, left = visited(browser, robot_site, run)
    assert (marked, left) == ((1, 0) if libraries() else (0, 0))
    assert (pausing, stopped) == ("Go on", "Stopped")


def test_driving_by_hand_shows_values_and_ends_with_the_page(browser: Chromium, robot_site: str) -> None:
    """By hand the robot moves, its pose is shown live; when the page is closed the robot stops (C38)."""

    async def drive(visit: Visit) -> tuple[str, str]:
        page = visit.page
        for key in ("write-drivingAtVelocity", "read-sensingPose"):
            await page.locator(f"details[data-key={key}] > summary").click()
        await page.locator("#read-sensingPose-follow").click()
        before = await said(page, "#values", "x of the place")
        await page.locator("#write-drivingAtVelocity-forward").fill("0.5")
        await page.locator("#write-drivingAtVelocity-for").fill("50")
        await page.locator("#write-drivingAtVelocity-do").click()
        await said(page, "#running", "^By hand")
        await page.wait_for_function("before => document.getElementById('values').textContent !== before", arg=before)
        after = str(await page.locator("#values").text_content())
        return before, after

    async def close() -> tuple[str, str]:
        async with opened(browser, robot_site, kept=False) as visit:
            return await drive(visit)

    async def look(visit: Visit) -> str:
        await visit.page.locator("details[data-key=read-sensingVelocity] > summary").click()
        await visit.page.locator("#read-sensingVelocity-follow").click()
        return await said(visit.page, "#values", "forward speed 0 m/s", 20)

    before, after = browser.run(close())
    assert before != after
    assert visited(browser, robot_site, look)


def test_programs_are_kept_and_shared(browser: Chromium, robot_site: str) -> None:
    """A program is stored in the browser and saved as files, and a link shows it without running it."""

    async def keep(visit: Visit) -> tuple[list[str], str, str, str]:
        page = visit.page
        await wrote(page, PROGRAM)
        await page.locator("#save").click()
        await page.locator("#save-dialog").wait_for()
        files = await page.locator("#save-files a").evaluate_all("all => all.map((one) => one.download)")
        await page.locator("#save-dialog").get_by_role("button", name="Close").click()
        await page.locator("#share").click()
        await page.locator("#share-dialog[open]").wait_for()
        link = await page.locator("#share-link").input_value()
        await page.locator("#share-dialog").get_by_role("button", name="Close").click()
        await page.locator("#new").click()
        await reads(page, '^program "program"\n$')
        await page.locator("#open").click()
        await page.locator("#open-list").get_by_role("button", name="to and fro", exact=True).click()
        opened_again = await reads(page, "fro")
        await page.goto("about:blank")
        await page.goto(link, wait_until="load")
        shared = await reads(page, "fro")
        await said(page, "#log", "does not run until")
        return files, opened_again, shared, str(await page.locator("#running").text_content())

    files, again, shared, running = visited(browser, robot_site, keep)
    assert files == [
        "to-and-fro.kgp",
        "to-and-fro.json",
        "to-and-fro-rospy.py",
        "to-and-fro-rclpy.py",
        "to-and-fro.xml",
    ]
    assert again == shared == PROGRAM
    assert running == ""


def test_without_libraries_the_text_is_enough(browser: Chromium, robot_site: str) -> None:
    """If Blockly cannot be loaded, programs are written as text, checked and run as usual."""

    async def run() -> tuple[bool, list[str]]:
        async with browser.visit(f"{robot_site}/login") as visit:
            page = visit.page
            await page.route("**/vendor/blockly/**", lambda route: route.fulfill(status=404))
            await log_in(page, robot_site)
            await page.goto(f"{robot_site}/robot", wait_until="load")
            await said(page, "#connection", "^Connected", 60)
            await wrote(page, 'log "words are enough"\n')
            await page.locator("#run").click()
            await said(page, "#log", "is done")
            return await page.locator("#blocks").is_hidden(), await page.locator("#log > div").all_text_contents()

    hidden, log = browser.run(run())
    assert hidden
    assert any("words are enough" in line for line in log)


def test_nothing_of_the_robot_becomes_code(browser: Chromium, robot_site: str) -> None:
    """Markup printed by a program is shown as text; a script in a picture of the robot never runs (C40)."""

    async def show(visit: Visit) -> tuple[str, bool, bool]:
        page = visit.page
        await page.wait_for_function("() => document.querySelector('#view img')?.naturalWidth > 0")
        await wrote(page, "log \"<img src=x onerror='top.owned = true'>\"\n")
        await page.locator("#run").click()
        line = await said(page, "#log", "onerror")
        return line, await page.evaluate("Boolean(window.owned)"), bool(await page.locator("#log img").count())

    async def alone() -> bool:
        async with browser.visit(f"{robot_site}/robot/view") as visit:
            return bool(await visit.page.evaluate("Boolean(window.owned)"))

    line, owned, made = visited(browser, robot_site, show)
    assert "<img src=x onerror='top.owned = true'>" in line
    assert (owned, made, browser.run(alone())) == (False, False, False)
    policy = httpx.get(f"{robot_site}/robot/view", timeout=patient(10)).headers["content-security-policy"]
    assert "sandbox" in policy
    assert "script-src" not in policy


def test_who_has_not_logged_in_only_looks(browser: Chromium, robot_site: str) -> None:
    """Without the token the page shows everything, moves nothing, and explains how to log in (C37)."""

    async def look() -> tuple[bool, str, bool]:
        async with browser.visit(f"{robot_site}/login") as visit:
            await visit.page.goto(f"{robot_site}/robot", wait_until="load")
            await said(visit.page, "#connection", "^Connected", 60)
            await visit.page.locator("#write-drivingAtVelocity-do").wait_for(state="attached")
            buttons = visit.page.locator("[id$=-do], #run")
            disabled = await buttons.evaluate_all("all => all.every((one) => one.disabled)")
            return disabled, str(await visit.page.locator("#notices a").get_attribute("href")), await apart(visit.page)

    assert browser.run(look()) == (True, "/login?next=/robot", True)
    assert httpx.post(f"{robot_site}/robot/run", json={"program": {}}, timeout=patient(10)).status_code == 401
