"""Pictures of the shell, as SVG: fixed sizes, no times, no paths; `pytest --snapshot-update` updates them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from shell.driving import current, ended, make, opened, run_query, until
from textual.widgets import Static

from kg.shell.results import ResultView
from kg.shell.screens.listing import HelpScreen
from kg.shell.screens.main import Status
from kg.shell.screens.page import PageScreen, PageTree
from kg.shell.tree import KnowledgeTree

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from textual.pilot import Pilot

    from kg.shell.app import Shell

QUERY = """# Who listens to what
SELECT ?name ?topic {
  ?node a rnkg:NodeType ; rnkg:name ?name ; rnkg:subscribes ?t .
  ?t rdfs:label ?topic . FILTER(STRSTARTS(?topic, "/scan"))
}
ORDER BY ?name ?topic"""


async def ready(app: Shell) -> None:
    """Wait until the first level of the tree is loaded, and stop the cursor from blinking."""
    await until(lambda: current(app).editor.has_focus)
    await until(lambda: len(app.main.query_one(KnowledgeTree).root.children) > 1)
    current(app).editor.cursor_blink = False


@pytest.fixture(autouse=True)
def _still(monkeypatch: pytest.MonkeyPatch) -> None:
    """Remove varying parts where they are drawn: a clock or a late resize may draw them at any time."""
    monkeypatch.setattr(Status, "_draw", lambda self: self.update("snapshot 1  ·  ~/robot"))
    monkeypatch.setattr(ResultView, "_remark", lambda self, _: f"{len(self._rows)} rows")


def test_the_main_screen(store: Path, tmp_path: Path, snap_compare: Callable[..., bool]) -> None:
    """A query, its result and the tree, on a large terminal."""
    app = make(store, tmp_path)

    async def before(pilot: Pilot[Any]) -> None:
        await ready(app)
        await run_query(app, pilot, QUERY)
        # The table makes room for the row numbers when idle.
        table = current(app).results.table
        await until(lambda: not current(app).editor.has_focus)
        await until(lambda: table._label_column.content_width > 0)
        await pilot.pause()

    assert snap_compare(app, terminal_size=(110, 30), run_before=before)


def test_an_error_on_a_small_terminal(store: Path, tmp_path: Path, snap_compare: Callable[..., bool]) -> None:
    """An error below the right characters, at 80 columns and 24 lines."""
    app = make(store, tmp_path)

    async def before(pilot: Pilot[Any]) -> None:
        await ready(app)
        current(app).editor.text = QUERY.replace("rnkg:name", "rnk:name")
        await until(lambda: current(app).editor.problems)
        await ended(app, pilot, "f5")
        await pilot.pause()

    assert snap_compare(app, terminal_size=(80, 24), run_before=before)


def test_the_page_of_a_node(store: Path, tmp_path: Path, snap_compare: Callable[..., bool]) -> None:
    """Interfaces with their lines of code, and inferred facts."""
    app = make(store, tmp_path)

    async def before(pilot: Pilot[Any]) -> None:
        await ready(app)
        await run_query(app, pilot, "SELECT ?node { ?node a rnkg:NodeType ; rnkg:name 'scan_filter' }")
        await pilot.press("r")
        await opened(app, PageScreen)
        tree = app.screen.query_one(PageTree)
        await until(lambda: len(tree.root.children) > 1)
        await pilot.press("down", "down", "down", "down", "down")
        await until(lambda: tree.cursor_line == 5 and _told(app).startswith(tree.current().text))  # type: ignore[union-attr]  # line 5 is one

    assert snap_compare(app, terminal_size=(100, 30), run_before=before)


def _told(app: Shell) -> str:
    """Return the description of the line under the cursor."""
    return str(app.screen.query_one(".detail", Static).render())


def test_the_help(store: Path, tmp_path: Path, snap_compare: Callable[..., bool]) -> None:
    """The keys, in the colours of the terminal."""
    app = make(store, tmp_path)

    async def before(pilot: Pilot[Any]) -> None:
        await ready(app)
        app.theme = "ansi-light"
        current(app).results.say("0 rows")
        await pilot.press("f1")
        await opened(app, HelpScreen)
        await pilot.pause()

    assert snap_compare(app, terminal_size=(80, 30), run_before=before)
