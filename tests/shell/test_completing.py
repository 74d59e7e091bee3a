from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from shell.driving import current, running, typed, until
from textual._xterm_parser import XTermParser
from textual.events import Key

from kg.shell.actions import ACTIONS
from kg.shell.state import State

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.anyio


@pytest.fixture
def anyio_backend() -> str:
    """Run on asyncio, as textual does."""
    return "asyncio"


async def test_what_fits_is_offered_while_typing(store: Path, tmp_path: Path) -> None:
    """Properties of this store are offered after a pause; Tab accepts one, Esc closes the list and nothing else."""
    async with running(store, tmp_path) as (app, pilot):
        offered = app.main.completions
        await typed(pilot, "SELECT * { ?node rnkg:pub")
        # The list of the text before the last letter may be there before the awaited one.
        await until(lambda: offered.display and offered._text == current(app).text)
        assert "rnkg:publishes" in str(offered.get_option_at_index(0).prompt)
        await pilot.press("escape")
        await until(lambda: not offered.display)
        assert current(app).editor.has_focus
        await pilot.press("ctrl+space")
        await until(lambda: offered.display)
        await pilot.press("down", "up", "tab")
        await until(lambda: current(app).text.endswith("SELECT * { ?node rnkg:publishes"))
        await typed(pilot, " ")
        await until(lambda: not offered.display)


async def test_the_second_query_of_a_buffer_is_completed(store: Path, tmp_path: Path) -> None:
    """Positions are those of the edited query, whatever precedes it."""
    async with running(store, tmp_path) as (app, pilot):
        editor = current(app).editor
        editor.text = "ASK { ?x ?y 'é' }\n\nSELECT * { ?node rnkg:pub }"
        editor.move_cursor((2, 25))
        await pilot.press("ctrl+space")
        await until(lambda: app.main.completions.display)
        await pilot.press("enter")
        await until(lambda: editor.text.splitlines()[-1] == "SELECT * { ?node rnkg:publishes }")
        assert editor.text.startswith("ASK { ?x ?y 'é' }\n")


async def test_problems_are_marked_while_typing(store: Path, tmp_path: Path) -> None:
    """A misspelt prefix is marked and explained; Ctrl+G goes there, Ctrl+F fixes it, and comments are toggled."""
    async with running(store, tmp_path) as (app, pilot):
        buffer = current(app)
        editor = buffer.editor
        editor.text = "ASK {}\nSELECT * { ?s rnkgg:name ?name }"
        await until(lambda: editor.problems)
        assert "rnkgg:name" in editor.text[editor.problems[0].start : editor.problems[0].end]
        editor.move_cursor((0, 0))
        await pilot.press("ctrl+g")
        await until(lambda: editor.cursor_location == (1, 14))
        await pilot.press("ctrl+f")
        await until(lambda: not editor.problems)
        assert editor.text.endswith("SELECT * { ?s rnkg:name ?name }")
        editor.select_all()
        await pilot.press("ctrl+slash")
        await until(lambda: editor.text == "# ASK {}\n# SELECT * { ?s rnkg:name ?name }")
        await pilot.press("ctrl+slash")
        await until(lambda: editor.text.startswith("ASK {}\nSELECT"))


@pytest.mark.parametrize(("name", "sent"), [("next_problem", "\x07"), ("fix", "\x06")])
def test_keys_of_problems_are_those_that_terminals_send(name: str, sent: str) -> None:
    """The codes sent by every terminal for these keys are recognised, and insert nothing."""
    (action,) = (one for one in ACTIONS if one.name == name)
    (event,) = XTermParser().feed(sent)
    assert isinstance(event, Key)
    assert event.key in action.keys
    assert not event.is_printable


async def test_a_buffer_closes_while_it_is_checked(store: Path, tmp_path: Path) -> None:
    """Closing a buffer just after a change to it leaves the shell and the other buffers unaffected."""
    async with running(store, tmp_path) as (app, pilot):
        await typed(pilot, "ASK {}")
        for pause in (0.0, 0.3):
            await pilot.press("ctrl+n")
            await until(lambda: len(app.main.buffers.all) == 2 and current(app).text == "")
            await until(lambda: current(app).editor.has_focus)
            await typed(pilot, "SELECT * { ?s rnkgg:na")
            await pilot.pause(pause)
            await pilot.press("ctrl+slash", "f8")
            await until(lambda: len(app.main.buffers.all) == 1)
            await pilot.pause(0.5)
        await until(lambda: current(app).text == "ASK {}")


async def test_a_buffer_that_is_being_closed_is_left_alone(store: Path, tmp_path: Path) -> None:
    """Saving and checking all buffers tolerates one whose parts are already removed."""
    async with running(store, tmp_path) as (app, pilot):
        closing = current(app)
        closing.editor.text = "ASK {}"
        await pilot.press("ctrl+n")
        await until(lambda: current(app).number == 2)
        current(app).editor.text = "SELECT"
        await closing.query("*").remove()
        app.main.check_text(closing)
        assert State(tmp_path, str(store)).buffers() == ["SELECT"]


async def test_what_is_typed_is_kept_soon(store: Path, tmp_path: Path) -> None:
    """After a pause the text is on disk, so closing the terminal loses nothing."""
    async with running(store, tmp_path) as (_, pilot):
        await typed(pilot, "ASK {}")
        await until(lambda: State(tmp_path, str(store)).buffers() == ["ASK {}"])
