"""The shell without a terminal: started on a store, and pressed keys at."""

from __future__ import annotations

import time
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any

from kg.settings import load
from kg.shell.app import Shell
from kg.shell.state import State
from kg.store.layout import Layout

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable
    from pathlib import Path

    from textual.pilot import Pilot

    from kg.shell.buffers import Buffer

__all__ = ["current", "make", "run_query", "running", "typed", "until"]

_SECONDS = 90.0
_NAMES = {
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
    """Return a shell that keeps its state in `folder`."""
    settings = load({"store": str(store), **flags}, environment={}, folder=store.parent)
    return Shell(settings, Layout(store), State(folder, str(store)))


@asynccontextmanager
async def running(
    store: Path, folder: Path, size: tuple[int, int] = (100, 30), **flags: Any
) -> AsyncIterator[tuple[Shell, Pilot[None]]]:
    """Yield a shell that runs, and what presses its keys."""
    app = make(store, folder, **flags)
    async with app.run_test(size=size, notifications=True) as pilot:
        await until(pilot, lambda: app.main.buffers.current is not None and app.main.buffers.current.editor.has_focus)
        yield app, pilot
        app.exit()


async def until(pilot: Pilot[Any], condition: Callable[[], object]) -> None:
    """Wait until something holds, with much patience."""
    end = time.monotonic() + _SECONDS
    while not condition():
        assert time.monotonic() < end, "it did not come about"
        await pilot.pause(0.02)


def current(app: Shell) -> Buffer:
    """Return the buffer on the screen."""
    buffer = app.main.buffers.current
    assert buffer is not None
    return buffer


async def run_query(app: Shell, pilot: Pilot[Any], text: str) -> Buffer:
    """Put a query into the buffer, run it, and wait for its end."""
    buffer = current(app)
    buffer.editor.text = text
    await pilot.press("f5")
    await until(pilot, lambda: buffer.job is None)
    await pilot.pause()
    return buffer


async def typed(pilot: Pilot[Any], text: str) -> None:
    """Press the keys of a text."""
    for sign in text:
        await pilot.press(_NAMES.get(sign, sign))
