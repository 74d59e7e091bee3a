from __future__ import annotations

import asyncio
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest
from cli.program import Program
from shell.driving import current, ended, run_query, running, until
from textual.coordinate import Coordinate
from textual.filter import Monochrome

from kg.query.result import Boolean, Graph, Solutions
from kg.shell.results import PAGE_ROWS
from kg.shell.state import State
from kg.store.layout import Layout

if TYPE_CHECKING:
    from pathlib import Path

    from kg.shell.buffers import Buffer

pytestmark = pytest.mark.anyio

NODES = "SELECT ?node ?name { ?node a rnkg:NodeType ; rnkg:name ?name } ORDER BY ?name"
ENDLESS = "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . FILTER(?a != ?d && ?d != ?g && ?h != ?b) }"


@pytest.fixture
def anyio_backend() -> str:
    """Run on asyncio, as textual does."""
    return "asyncio"


def words(app: object, selector: str) -> str:
    """Return the text of a line of the screen."""
    return str(app.screen.query_one(selector).render())  # type: ignore[attr-defined]  # any application


def kind_of(buffer: Buffer) -> type[object]:
    """Return the kind of result shown by a buffer."""
    return type(buffer.results.result)


async def test_each_kind_of_answer_is_shown(store: Path, tmp_path: Path) -> None:
    """Rows and triples fill the table, a Boolean a line; the query at the cursor runs, or the selection."""
    async with running(store, tmp_path) as (app, pilot):
        buffer = await run_query(app, pilot, NODES)
        assert isinstance(buffer.results.result, Solutions)
        assert buffer.results.table.row_count == len(buffer.results.result.rows) > 5
        await run_query(app, pilot, "ASK {}\nCONSTRUCT { ?s a ?o } WHERE { ?s a ?o } LIMIT 4")
        assert words(app, ".remark").startswith("yes")
        buffer.editor.move_cursor((1, 5))
        await ended(app, pilot, "f5")
        assert kind_of(buffer) is Graph
        assert buffer.results.table.row_count == 4
        buffer.editor.select_line(0)
        await ended(app, pilot, "f5")
        assert kind_of(buffer) is Boolean
        await ended(app, pilot, "f6")
        assert "KG501" in words(app, ".remark")


async def test_iris_of_the_store_are_short(store: Path, tmp_path: Path) -> None:
    """IRIs below the base of the store are shown without it, to fit columns on small terminals."""
    async with running(store, tmp_path) as (app, pilot):
        buffer = await run_query(app, pilot, "SELECT ?node { ?node a rnkg:NodeType } LIMIT 1")
        assert str(buffer.results.table.get_cell_at(Coordinate(0, 0))).startswith("node/local/")


async def test_columns_leave_room_for_the_bar(store: Path, tmp_path: Path) -> None:
    """When rows scroll, fitted columns do not: the row numbers remain visible, at any width."""
    async with running(store, tmp_path, size=(80, 24)) as (app, pilot):
        buffer = await run_query(app, pilot, "SELECT ?node ?topic { ?node rnkg:publishes ?topic }")
        table = buffer.results.table
        await until(lambda: _fitted(buffer) and table.max_scroll_y > 0 and table.max_scroll_x == 0)
        narrow = table.virtual_size.width
        await pilot.resize_terminal(120, 40)
        await until(lambda: _fitted(buffer) and table.virtual_size.width > narrow)
        await until(lambda: table.max_scroll_y > 0 and table.max_scroll_x == 0)


def _fitted(buffer: Buffer) -> bool:
    """Whether the columns have been fitted to the current width of the table."""
    return buffer.results._room == buffer.results.table.size.width > 0


async def test_a_prefix_means_what_the_query_says(store: Path, tmp_path: Path) -> None:
    """A prefix redeclared by the query shortens only IRIs of its own namespace, even if it is a common one."""
    async with running(store, tmp_path) as (app, pilot):
        query = "SELECT (<http://data.mksmart.org/onto-ros/class#Topic> AS ?known) (ros:Topic AS ?own) {}"
        buffer = await run_query(app, pilot, f"PREFIX ros: <urn:x#> {query}")
        known, own = (str(buffer.results.table.get_cell_at(Coordinate(0, at))) for at in (0, 1))
        assert own == "ros:Topic"
        assert known.endswith("/class#Topic")


async def test_an_error_is_marked_where_it_is(store: Path, tmp_path: Path) -> None:
    """The characters of the error are marked, the cursor moves there, and a sentence suggests a fix."""
    async with running(store, tmp_path) as (app, pilot):
        buffer = await run_query(app, pilot, "# first\nASK {}\n\nSELECT * {\n  ?s rnkgg:name ?o }")
        buffer.editor.move_cursor((4, 0))
        await ended(app, pilot, "f5")
        assert "KG501" in words(app, ".remark")
        assert buffer.editor.cursor_location == (4, 5)
        assert buffer.editor.text[slice(*_span(buffer.editor.problems[0]))] == "rnkgg:name"
        assert "line 5, column 6" in words(app, ".remark")
        assert "Did you mean" in words(app, ".problem")
        await until(lambda: buffer.editor.has_focus)
        # Positions of lines are computed when they are painted.
        await until(lambda: any("underline" in str(span.style) for span in buffer.editor.get_line(4).spans))


async def test_an_empty_answer_keeps_what_was_probably_meant(store: Path, tmp_path: Path) -> None:
    """With no rows the mark of a misspelt name remains, its keys work from the table, and typing continues."""
    async with running(store, tmp_path) as (app, pilot):
        buffer = await run_query(app, pilot, "SELECT ?s { ?s rnkg:publishs ?o }")
        assert buffer.results.table.row_count == 0
        await until(lambda: "Did you mean" in words(app, ".problem"))
        assert buffer.editor.has_focus
        buffer.results.table.focus()
        await pilot.press("ctrl+g")
        await until(lambda: buffer.editor.cursor_location == (0, 15))
        buffer.results.table.focus()
        await pilot.press("ctrl+f")
        await until(lambda: "rnkg:publishes " in buffer.text)
        assert buffer.editor.has_focus


async def test_esc_in_the_editor_leaves_the_keys_there(store: Path, tmp_path: Path) -> None:
    """However often Esc is pressed in the editor, the next letters are typed into it."""
    async with running(store, tmp_path) as (app, pilot):
        await run_query(app, pilot, "ASK {}")
        await pilot.press("escape", "escape", "escape", "e", "y")
        await until(lambda: "ey" in current(app).text)
        assert app.screen is app.main


async def test_an_answer_does_not_take_keys_from_who_types(
    store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A user who types while a query runs keeps the focus."""
    async with running(store, tmp_path) as (app, pilot):
        held, ask = asyncio.Event(), app.link.ask

        async def late(*values: Any, **named: Any) -> Any:
            await held.wait()
            return await ask(*values, **named)

        monkeypatch.setattr(app.link, "ask", late)
        buffer = current(app)
        buffer.editor.text = "ASK {}"
        await pilot.press("f5", "#")
        held.set()
        await until(lambda: buffer.results.result is not None)
        await pilot.press("x")
        await until(lambda: buffer.text == "#xASK {}")


async def test_undo_shortens_a_text_above_its_cursor(store: Path, tmp_path: Path) -> None:
    """Undoing lines that needed a scroll bar puts the cursor back into the remaining text."""
    async with running(store, tmp_path / "state") as (app, pilot):
        editor = current(app).editor
        editor.insert("ASK {}" + "\n" * 60)
        await until(lambda: editor.show_vertical_scrollbar and editor.cursor_location == (60, 0))
        await pilot.press("ctrl+z")
        await until(lambda: not editor.show_vertical_scrollbar)
        assert (editor.text, editor.cursor_location) == ("", (0, 0))


async def test_leaving_while_a_buffer_opens_is_no_error(store: Path, tmp_path: Path) -> None:
    """Leaving the shell at any time while a buffer opens exits with 0, and its buffers are saved."""
    for turns in (0, 1, 2, 4, 7, 11):
        async with running(store, tmp_path / str(turns)) as (app, pilot):
            current(app).editor.text = "ASK {}"
            app.main.call_later(app.main.buffers.open, "SELECT")
            for _ in range(turns):
                await asyncio.sleep(0)
            await app.action_quit()
            await app.action_quit()
            await pilot.pause()
        assert not app.return_code
        assert "ASK {}" in State(tmp_path / str(turns), str(store)).buffers()


async def test_an_unexpected_error_is_shown_and_the_shell_goes_on(
    store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An error of a key, a message or a worker has its code, its traceback is saved, and keys still work."""

    def fail(*_: object) -> None:
        raise ValueError("a defect")

    async def fail_late() -> None:
        fail()

    async with running(store, tmp_path) as (app, pilot):
        monkeypatch.setattr(app.main, "action_toggle_tree", fail)
        await pilot.press("f9")
        current(app).editor.call_later(fail)
        app.main.run_worker(fail_late())
        await until(lambda: len(app.failures) == 3)
        assert "KG900" in {one.title for one in app._notifications}
        assert "a defect" in (tmp_path / "failure.txt").read_text()
        await run_query(app, pilot, "ASK {}")
        app.failures.clear()


def _span(problem: object) -> tuple[int, int]:
    return problem.start, problem.end  # type: ignore[attr-defined]  # a Problem


async def test_a_query_is_stopped(store: Path, tmp_path: Path) -> None:
    """Esc cancels an endless query; the status line shows its duration, and the next query runs."""
    async with running(store, tmp_path) as (app, pilot):
        buffer = current(app)
        buffer.editor.text = ENDLESS
        await pilot.press("f5")
        await until(lambda: "running" in words(app, "Status"))
        await pilot.press("f5")
        await ended(app, pilot, "escape")
        assert "KG510" in words(app, ".remark")
        await until(lambda: "running" not in words(app, "Status"))
        await run_query(app, pilot, "ASK {}")
        assert isinstance(buffer.results.result, Boolean)
        buffer.editor.text = ENDLESS
        await pilot.press("f5")
        await until(lambda: buffer.job and app.link.job(buffer.job))
        await ended(app, pilot, "ctrl+c")
        assert "KG510" in words(app, ".remark")
        assert [one.outcome for one in app.state.history()] == ["KG510", "ok"]


async def test_long_answers_come_in_pages(store: Path, tmp_path: Path) -> None:
    """The limit truncates with a notice; `a` fetches all; a page fills the table, `n` and the last row load more."""
    async with running(store, tmp_path, limit="250") as (app, pilot):
        buffer = await run_query(app, pilot, "SELECT * { ?s ?p ?o }")
        table = buffer.results.table
        assert table.row_count == PAGE_ROWS
        assert "only the first 250 rows" in words(app, ".remark")
        await pilot.press("n")
        await until(lambda: table.row_count == 50)
        assert "page 2 of 2" in words(app, ".remark")
        assert buffer.results.row_number() == PAGE_ROWS + 1
        await pilot.press("b")
        await until(lambda: table.row_count == PAGE_ROWS)
        table.move_cursor(row=PAGE_ROWS - 1)
        await pilot.press("down")
        await until(lambda: table.row_count == 50)
        await ended(app, pilot, "a")
        assert buffer.results.result is not None
        assert buffer.results.result.limit is None
        assert buffer.results.pages > 5


async def test_the_shell_follows_the_store(store: Path, tmp_path: Path) -> None:
    """A new generation is detected, a missing store is reported, and nothing breaks."""
    layout = Layout(tmp_path / "copy" / ".kg")
    shutil.copytree(store, layout.root)
    number = layout.current() or 0
    async with running(layout.root, tmp_path / "state") as (app, pilot):
        assert f"snapshot {number}" in words(app, "Status")
        layout.generation(number).rename(layout.generation(number + 1))
        layout.switch(number + 1)
        app.main.follow()
        assert f"snapshot {number + 1}" in words(app, "Status")
        assert "built again" in words(app, "Status")
        await run_query(app, pilot, "ASK {}")
        layout.root.rename(tmp_path / "gone")
        app.main.follow()
        assert "store is gone" in words(app, "Status")
        # A reader still at work may have created a cache in its place.
        shutil.rmtree(layout.root, ignore_errors=True)
        (tmp_path / "gone").rename(layout.root)
        app.main.follow()
        assert "gone" not in words(app, "Status")


async def test_buffers_come_and_go_and_are_kept(store: Path, tmp_path: Path) -> None:
    """Tabs open, close and switch; their texts are restored when the shell starts again."""
    async with running(store, tmp_path) as (app, pilot):
        current(app).editor.text = "ASK { <urn:a> a <urn:b> }"
        await pilot.press("ctrl+n")
        await until(lambda: current(app).number == 2)
        assert current(app).text == ""
        current(app).editor.text = "# second\nASK {}"
        await pilot.press("ctrl+n")
        await until(lambda: current(app).number == 3)
        await pilot.press("f8")
        await until(lambda: len(app.main.buffers.all) == 2 and current(app).number == 1)
        await pilot.press("ctrl+pageup")
        await until(lambda: current(app).number == 2)
        await pilot.press("ctrl+q")
        await until(lambda: app._exit)
    assert State(tmp_path, str(store)).buffers() == ["ASK { <urn:a> a <urn:b> }", "# second\nASK {}"]
    async with running(store, tmp_path) as (app, pilot):
        assert [one.text for one in app.main.buffers.all] == ["ASK { <urn:a> a <urn:b> }", "# second\nASK {}"]
        assert app.main.buffers.all[1].title == "2 second"
        await pilot.press("f8")
        await until(lambda: len(app.main.buffers.all) == 1 and current(app).editor.has_focus)
        current(app).editor.text = ""
        await pilot.press("ctrl+d")
        await until(lambda: app._exit)


def test_without_a_store_there_are_plain_words(tmp_path: Path) -> None:
    """KG301 is reported before the terminal is used."""
    run = Program(tmp_path)("shell")
    assert run.code == 4
    assert "KG301" in run.err


def test_without_a_terminal_there_is_a_way_out(store: Path, tmp_path: Path) -> None:
    """KG550 explains how scripts run queries."""
    run = Program(tmp_path)("--store", str(store), "shell")
    assert run.code == 2
    assert "KG550" in run.err
    assert "--once" in run.err


@pytest.mark.parametrize(
    ("query", "code"), [("SELECT ?n { ?n a rnkg:NodeType } LIMIT 2", 0), ("SELECT {", 5), ("no-such-query", 1)]
)
def test_once_answers_as_kg_query_does(store: Path, tmp_path: Path, query: str, code: int) -> None:
    """Rows, errors and exit codes are those of `kg query`."""
    kg = Program(tmp_path)
    asked = kg("--store", str(store), "shell", "--once", query)
    assert (asked.code, asked.out) == (code, kg("--store", str(store), "query", query).out)
    assert asked.code == code


def test_help_loads_no_terminal_library() -> None:
    """`kg --help` starts without textual."""
    check = "import sys; from kg.cli.app import app; sys.exit('textual' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", check], check=False).returncode == 0


async def test_colour_can_be_left_out(store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With NO_COLOR the screen is in greys."""
    monkeypatch.setenv("NO_COLOR", "1")
    async with running(store, tmp_path, size=(80, 24)) as (app, pilot):
        await run_query(app, pilot, NODES)
        assert app.no_color
        assert any(isinstance(one, Monochrome) for one in app._filters)


async def test_what_is_not_saved_is_told(store: Path, tmp_path: Path) -> None:
    """A folder that cannot be written is reported by a notice when something is to be saved."""
    (tmp_path / "file").write_text("")
    async with running(store, tmp_path / "file") as (app, pilot):
        await pilot.press("f8")
        await until(lambda: any("are not saved" in one.message for one in app._notifications))
