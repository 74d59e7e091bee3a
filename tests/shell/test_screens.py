from __future__ import annotations

import json
from functools import partial
from typing import TYPE_CHECKING, Any

import pytest
from shell.driving import current, ended, opened, run_query, running, typed, until
from textual.command import CommandPalette
from textual.widgets import Input, Markdown, OptionList, Tree

from kg.shell.screens.find import FindScreen, HitTree, RulesScreen
from kg.shell.screens.listing import (
    ChoiceScreen,
    ExportScreen,
    FormScreen,
    HelpScreen,
    HistoryScreen,
    JumpScreen,
    StoredScreen,
)
from kg.shell.screens.page import PageScreen, PageTree, lines_of_row
from kg.shell.state import State
from kg.shell.tree import KnowledgeTree

if TYPE_CHECKING:
    from pathlib import Path

    from textual.pilot import Pilot
    from textual.widget import Widget
    from textual.widgets.tree import TreeNode

    from kg.shell.app import Shell

pytestmark = pytest.mark.anyio

PUBLISHERS = "SELECT ?node ?topic { ?node rnkg:publishes ?t . ?t rdfs:label ?topic . ?node rnkg:name 'scan_filter' }"


@pytest.fixture
def anyio_backend() -> str:
    """Run on asyncio, as textual does."""
    return "asyncio"


def labels(node: TreeNode[Any]) -> list[str]:
    """Return the labels below an entry, on all levels."""
    return [text for child in node.children for text in (str(child.label), *labels(child))]


def title(app: Shell) -> str:
    """Return the title of the page on the screen."""
    return str(app.screen.query_one(".title").render())


async def shown(app: Shell, kind: type[Any], words: str) -> list[str]:
    """Wait until a screen of a kind has a line with these words, and return all lines."""
    await opened(app, kind)
    tree = app.screen.query_one(PageTree if kind is PageScreen else Tree)
    await until(lambda: _has(tree, words))
    return labels(tree.root)


async def go_to(tree: Tree[Any], words: str) -> None:
    """Move the cursor of a tree to the first line with these words, once the tree has loaded its lines."""

    def moved() -> bool:
        found = next((node for node in _all(tree.root) if words in str(node.label)), None)
        if found is not None:
            tree.move_cursor(found)
        return found is not None and tree.cursor_node is found

    await until(moved)


def _all(node: TreeNode[Any]) -> list[TreeNode[Any]]:
    return [one for child in node.children for one in (child, *_all(child))]


def _has(tree: Tree[Any], words: str) -> bool:
    return any(words in line for line in labels(tree.root))


def _has_focus(widget: Widget) -> bool:
    return widget.has_focus


def found_by_palette(app: Shell) -> list[str]:
    """Return the titles of the palette's commands, in lower case."""
    options = app.screen.query_one(OptionList).options
    return [str(option.prompt).split("\n")[0].lower() for option in options]


async def taking_keys(tree: Tree[Any]) -> None:
    """Focus a tree for the next keys."""
    tree.focus()
    await until(lambda: tree.has_focus)


async def test_a_row_leads_to_the_line_of_code(store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Enter on a row shows its evidence, with rules and lines of code; these open in the editor."""
    started: list[list[str]] = []
    monkeypatch.setattr("kg.shell.app.Shell._start", lambda _app, command: started.append(command))
    monkeypatch.setenv("VISUAL", "vi")
    async with running(store, tmp_path) as (app, pilot):
        await run_query(app, pilot, PUBLISHERS)
        await pilot.press("enter")
        lines = await shown(app, PageScreen, "Rests on")
        assert any("by rule communication/publishes" in line for line in lines)
        tree = app.screen.query_one(PageTree)
        code = next(line for line in lines if ".cpp:" in line or ".launch:" in line)
        await go_to(tree, code)
        await pilot.press("o")
        await until(lambda: started)
        assert started[0][0] == "vi"
        assert started[0][1].startswith("+")
        assert started[0][2].endswith((".cpp", ".launch"))
        await go_to(tree, "node = ")
        await pilot.press("enter")
        await until(lambda: "Row" not in title(app))
        await pilot.press("backspace")
        await until(lambda: title(app) == "Row 1")
        await pilot.press("escape")
        await until(lambda: app.screen is app.main)


async def test_a_node_is_a_page_with_proofs(store: Path, tmp_path: Path) -> None:
    """The page of a node has interfaces with their lines; `w` proves inferred facts, Backspace goes back."""
    async with running(store, tmp_path) as (app, pilot):
        await run_query(app, pilot, "SELECT ?node { ?node a rnkg:NodeType ; rnkg:name 'scan_filter' }")
        await pilot.press("r")
        lines = await shown(app, PageScreen, "Interfaces")
        assert title(app) == "scan_filter, node of rover_robot"
        assert any("subscribes /scan" in line and "scan_filter_nodelet.cpp:" in line for line in lines)
        await go_to(app.screen.query_one(PageTree), "publishes /scan_filtered")
        await pilot.press("w")
        await until(lambda: title(app).startswith("Why"))
        await shown(app, PageScreen, "by rule")
        await pilot.press("backspace")
        await shown(app, PageScreen, "Interfaces")
        await pilot.press("q")
        await until(lambda: "/scan_filter>" in current(app).text)


async def test_the_tree_opens_level_by_level(store: Path, tmp_path: Path) -> None:
    """Packages contain nodes, nodes their interfaces; names go into the query, and an entry opens its page."""
    async with running(store, tmp_path) as (app, pilot):
        tree = app.main.query_one(KnowledgeTree)
        await until(lambda: "packages 5" in labels(tree.root))
        await taking_keys(tree)
        for words, below in (("packages", "rover_robot"), ("rover_robot", "scan_filter"), ("scan_filter", "publishes")):
            await go_to(tree, words)
            await pilot.press("space")
            await until(partial(_has, tree, below))
        await go_to(tree, "scan_filter")
        await pilot.press("i")
        await until(lambda: current(app).text.endswith("/scan_filter>") and current(app).editor.has_focus)
        await taking_keys(tree)
        await pilot.press("q")
        await until(lambda: "SELECT ?property ?value" in current(app).text and current(app).editor.has_focus)
        await taking_keys(tree)
        await pilot.press("enter")
        await shown(app, PageScreen, "Interfaces")


async def test_the_tree_is_read_again_while_it_is_being_read(store: Path, tmp_path: Path) -> None:
    """Entries loaded for a tree that was cleared in between do not reach the new one."""
    async with running(store, tmp_path) as (app, pilot):
        tree = app.main.query_one(KnowledgeTree)
        await until(lambda: "packages 5" in labels(tree.root))
        before = labels(tree.root)
        for _ in range(3):
            tree.reload()
            await pilot.pause()
        await until(lambda: "packages 5" in labels(tree.root))
        assert labels(tree.root) == before


async def test_search_and_rules_have_screens(store: Path, tmp_path: Path) -> None:
    """F2 finds nodes by words with reasons, F4 shows the documentation of rules; help and palette overlay both."""
    async with running(store, tmp_path) as (app, pilot):
        await pilot.press("f2")
        await opened(app, FindScreen)
        await typed(pilot, "laser scan filter")
        await pilot.press("enter")
        lines = await shown(app, FindScreen, "rover_robot/scan_filter")
        assert any("subscribes" in line for line in lines)
        await until(lambda: app.screen.query_one(HitTree).has_focus)
        await pilot.press("enter")
        await shown(app, PageScreen, "Interfaces")
        await pilot.press("f1")
        await opened(app, HelpScreen)
        await pilot.press("escape")
        await opened(app, PageScreen)
        await pilot.press("f4")
        await shown(app, RulesScreen, "communication")
        assert len(app.screen_stack) == 2
        tree = app.screen.query_one("#rule-tree", Tree)
        await go_to(tree, "copies")
        await pilot.press("space", "down")
        await until(lambda: "What it infers" in app.screen.query_one(Markdown).source)
        await pilot.press("escape")
        await until(lambda: app.screen is app.main)
        await pilot.press("ctrl+p")
        await opened(app, CommandPalette)
        await typed(pilot, "full results")
        await until(lambda: found_by_palette(app) == ["full results"])
        await pilot.press("enter")
        await until(lambda: app.main.has_class("full"))


async def test_stored_queries_ask_for_their_parameters(store: Path, tmp_path: Path) -> None:
    """F3 finds a stored query by letters of its title; the form explains its values and rejects invalid ones."""
    async with running(store, tmp_path) as (app, pilot):
        await pilot.press("f3")
        await opened(app, StoredScreen)
        await until(lambda: app.screen.query_one(OptionList).option_count > 1)
        await typed(pilot, "who publishes")
        await until(lambda: app.screen.query_one(OptionList).option_count == 1)
        await pilot.press("enter")
        await opened(app, FormScreen)
        await typed(pilot, "scan_filtered")
        await pilot.press("enter")
        await until(lambda: '"/scan_filtered"' in current(app).text and app.screen is app.main)
        await ended(app, pilot, "f5")
        assert current(app).results.table.row_count == 1
        await pilot.press("ctrl+r")
        await opened(app, HistoryScreen)
        assert app.screen.query_one(OptionList).option_count == 1
        await typed(pilot, "no such thing")
        await until(lambda: app.screen.query_one(OptionList).option_count == 0)
        app.screen.query_one(Input).value = "VALUES"
        await until(lambda: app.screen.query_one(OptionList).option_count == 1)
        await pilot.press("enter")
        await until(lambda: current(app).number == 2)


async def test_answers_are_copied_and_written(store: Path, tmp_path: Path) -> None:
    """`y` copies cell or rows in a format; `e` writes all rows, despite the limit, and overwrites only on request."""
    async with running(store, tmp_path / "state", limit="2") as (app, pilot):
        await run_query(app, pilot, "SELECT ?name { ?n a rnkg:NodeType ; rnkg:name ?name } ORDER BY ?name")
        await pilot.press("y")
        await opened(app, ChoiceScreen)
        await pilot.press("enter")
        await until(lambda: app.clipboard and app.screen is app.main)
        assert "\n" not in app.clipboard
        await pilot.press("y")
        await opened(app, ChoiceScreen)
        await pilot.press("down", "enter")
        await until(lambda: app.clipboard.startswith("?name\n") and app.screen is app.main)
        file = tmp_path / "answer.json"
        await exported(app, pilot, file)
        await until(lambda: app.screen is app.main)
        assert len(json.loads(file.read_text())["results"]["bindings"]) > 5
        file.write_text("")
        await exported(app, pilot, file)
        await until(lambda: "Enter again" in str(app.screen.query_one(".wrong").render()))
        assert file.read_text() == ""
        await pilot.press("enter")
        await until(lambda: app.screen is app.main)
        assert len(json.loads(file.read_text())["results"]["bindings"]) > 5
        await exported(app, pilot, tmp_path / "none" / "answer.csv")
        await until(lambda: "KG553" in str(app.screen.query_one(".wrong").render()))
        await pilot.press("escape")


async def exported(app: Shell, pilot: Pilot[Any], file: Path) -> None:
    """Request an export to a file."""
    await pilot.press("e")
    await opened(app, ExportScreen)
    app.screen.query_one(Input).value = str(file)
    await pilot.press("enter")


async def test_small_terminals_and_keys_alone_are_enough(store: Path, tmp_path: Path) -> None:
    """At 80 columns the tree is hidden until F9; letters lead to panels; the selected theme is restored."""
    async with running(store, tmp_path, size=(80, 24)) as (app, pilot):
        tree = app.main.query_one(KnowledgeTree)
        await until(lambda: not tree.display)
        await pilot.press("f9")
        await until(lambda: tree.display and tree.has_focus)
        for letter, panel in (("r", current(app).results.table), ("e", current(app).editor)):
            await pilot.press("ctrl+o")
            await opened(app, JumpScreen)
            await pilot.press(letter)
            await until(partial(_has_focus, panel))
        await pilot.press("f10")
        await until(lambda: not current(app).editor.display)
        await pilot.press("f10")
        await until(lambda: current(app).editor.display)
        app.theme = "ansi-light"
        await pilot.resize_terminal(120, 40)
        await until(lambda: app.main.has_class("-wide"))
        await pilot.press("f12")
        await until(lambda: isinstance(app.screen, CommandPalette))
    assert State(tmp_path, "").choice("theme", "") == "ansi-light"
    async with running(store, tmp_path) as (app, _):
        assert app.theme == "ansi-light"


async def test_a_row_of_many_solutions_says_so() -> None:
    """Below the facts of one solution is the number of solutions."""
    told = lines_of_row({"proofs": [], "conditions": ["FILTER(1)"], "remark": "this is one of 2"})
    (section,) = told
    assert [line.text for line in section.children] == ["where FILTER(1)", "this is one of 2"]
