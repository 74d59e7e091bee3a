"""Late responses close no other screen, and the shell continues."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

import pytest
from shell.driving import current, opened, run_query, running, typed, until
from textual.widgets import Input, OptionList

from kg.shell.screens import listing
from kg.shell.screens.listing import ExportScreen, FormScreen, StoredScreen

if TYPE_CHECKING:
    from pathlib import Path

    from textual.pilot import Pilot

    from kg.shell.app import Shell

pytestmark = pytest.mark.anyio


@pytest.fixture
def anyio_backend() -> str:
    """Run on asyncio, as textual does."""
    return "asyncio"


async def filled_form(app: Shell, pilot: Pilot[Any]) -> None:
    """Open the form of a stored query and type a value."""
    await pilot.press("f3")
    await opened(app, StoredScreen)
    await until(lambda: app.screen.query_one(OptionList).option_count > 1)
    await typed(pilot, "who publishes")
    await until(lambda: app.screen.query_one(OptionList).option_count == 1)
    await pilot.press("enter")
    await opened(app, FormScreen)
    await typed(pilot, "scan_filtered")


class Held:
    """Calls of the store that wait until they are released; `asked` counts them."""

    def __init__(self, app: Shell, monkeypatch: pytest.MonkeyPatch) -> None:
        self.asked = 0
        self.go_on = asyncio.Event()
        self._call = app.link.call
        monkeypatch.setattr(app.link, "call", self)

    async def __call__(self, view: str, **arguments: Any) -> Any:
        """Wait, and then call."""
        self.asked += 1
        await self.go_on.wait()
        return await self._call(view, **arguments)


async def test_a_form_is_sent_twice(store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A second Enter during the request gives one query, like a single one."""
    async with running(store, tmp_path) as (app, pilot):
        await filled_form(app, pilot)
        held = Held(app, monkeypatch)
        await pilot.press("enter", "enter")
        await until(lambda: held.asked == 2)
        held.go_on.set()
        await until(lambda: app.screen is app.main and '"/scan_filtered"' in current(app).text)
        assert len(app.main.buffers.all) == 1


async def test_a_form_is_left_while_it_is_sent(store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Esc returns to the list at once, and the late response closes nothing."""
    async with running(store, tmp_path) as (app, pilot):
        await filled_form(app, pilot)
        held = Held(app, monkeypatch)
        await pilot.press("enter")
        await until(lambda: held.asked)
        await pilot.press("escape")
        await opened(app, StoredScreen)
        held.go_on.set()
        await pilot.pause()
        assert isinstance(app.screen, StoredScreen)
        assert current(app).text == ""


async def test_an_export_is_left_while_it_is_written(
    store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Esc while the file is being written returns to the main screen, and the shell continues."""
    app: Shell

    def written(*_: object) -> int:
        app.call_from_thread(app.pop_screen)
        return 1

    monkeypatch.setattr(listing, "to_file", written)
    async with running(store, tmp_path) as (app, pilot):
        await run_query(app, pilot, "ASK {}")
        await pilot.press("e")
        await opened(app, ExportScreen)
        app.screen.query_one(Input).value = str(tmp_path / "answer.json")
        await pilot.press("enter")
        await until(lambda: app.screen is app.main)
        await run_query(app, pilot, "ASK {}")
