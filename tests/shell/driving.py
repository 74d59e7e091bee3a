"""The shell without a terminal: started on a store, and driven by key presses."""

from __future__ import annotations

import asyncio
import time
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any, Final

from patience import patient
from textual.css.query import NoMatches

from kg.query.result import Graph, Solutions
from kg.settings import load
from kg.shell.app import Shell
from kg.shell.results import rows_of
from kg.shell.state import State
from kg.store.layout import Layout

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable
    from pathlib import Path

    from textual.pilot import Pilot
    from textual.screen import Screen

    from kg.shell.buffers import Buffer

__all__ = ["current", "ended", "make", "opened", "run_query", "running", "typed", "until"]

_SECONDS: Final = 25
_NAMES: Final = {
    " ": "space",
    "?": "question_mark",
    "{": "left_curly_bracket",
    "}": "right_curly_bracket",
    ":": "colon",
    ".": "full_stop",
    "_": "underscore",
    "/": "slash",
    "-": "minus",
}


def make(store: Path, folder: Path, **flags: Any) -> Shell:
    """Return a shell that stores its state in `folder`."""
    named = {"store": str(store), "timeout": str(patient(60)), **flags}
    settings = load(named, environment={}, folder=store.parent)
    return Shell(settings, Layout(store), State(folder, str(store)))


@asynccontextmanager
async def running(
    store: Path, folder: Path, size: tuple[int, int] = (100, 30), **flags: Any
) -> AsyncIterator[tuple[Shell, Pilot[None]]]:
    """Yield a running shell, and the pilot that presses its keys."""
    app = make(store, folder, **flags)
    async with app.run_test(size=size, notifications=True) as pilot:
        await until(lambda: current(app).editor.has_focus)
        yield app, pilot
        assert not app.failures
        app.exit()


async def until(condition: Callable[[], object]) -> None:
    """Wait until a condition holds, with a long time limit; a condition on a missing widget does not hold.

    Keys have been sent when `press` returns, but on a busy machine not always processed.
    """
    end = time.monotonic() + patient(_SECONDS)
    while not _holds(condition):
        assert time.monotonic() < end, "it did not come about"
        await asyncio.sleep(0.02)


def _holds(condition: Callable[[], object]) -> object:
    try:
        return condition()
    except NoMatches:
        return False


def current(app: Shell) -> Buffer:
    """Return the buffer on the screen; NoMatches while tabs change."""
    buffer = app.main.buffers.current
    if buffer is None:
        raise NoMatches("no buffer is on the screen")
    return buffer


async def opened(app: Shell, kind: type[Screen[Any]]) -> None:
    """Wait until a screen of a kind is on top and accepts keys: earlier keys would go elsewhere."""
    await until(
        lambda: isinstance(app.screen, kind) and app.screen.is_mounted and (app.focused or not app.screen.focus_chain),
    )


async def ended(app: Shell, pilot: Pilot[Any], *keys: str) -> None:
    """Press keys that run a query, and wait for its end."""
    before = len(app.state._lines())
    await pilot.press(*keys)
    await until(lambda: len(app.state._lines()) > before)


async def run_query(app: Shell, pilot: Pilot[Any], text: str) -> Buffer:
    """Put a query into the buffer, run it, and wait for its end; a table with rows then has the focus."""
    buffer = current(app)
    buffer.editor.text = text
    await ended(app, pilot, "f5")
    view = buffer.results
    empty = isinstance(view.result, Solutions | Graph) and not rows_of(view.result)
    await until(lambda: view.result is None or empty or view.table.has_focus)
    return buffer


async def typed(pilot: Pilot[Any], text: str) -> None:
    """Press the keys of a text."""
    for sign in text:
        await pilot.press(_NAMES.get(sign, sign))
