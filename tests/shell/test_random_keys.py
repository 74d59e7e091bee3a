"""Random keys, with responses at random times, never crash the shell."""

from __future__ import annotations

import asyncio
import os
import random
import traceback
from typing import TYPE_CHECKING, Any, Final

import pytest
from patience import examples, patient
from shell.driving import current, make, run_query, until
from textual import screen
from textual.events import Key, Resize
from textual.geometry import Size

from kg.shell.actions import ACTIONS

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from pathlib import Path

    from textual.pilot import Pilot

    from kg.shell.app import Shell

pytestmark = pytest.mark.anyio

KEYS: Final = int(os.environ.get("KG_TEST_KEYS", examples(400, 2000)))
SEED: Final = int(os.environ.get("KG_TEST_SEED", "14"))
"""Another seed presses other keys; the one named by a failure repeats it."""

_ACTION_KEYS: Final = sorted({key for action in ACTIONS for key in action.keys if len(key) > 1})
_OFTEN: Final = ("enter", "escape", "enter", "escape", "up", "down", "left", "right", "tab", "shift+tab", "backspace")
_MOVES: Final = ("pageup", "pagedown", "home", "end", "shift+down", "ctrl+left", "delete", "ctrl+z")
_TEXT: Final = "aeorwyqibnu SELCTASK?s{}:.~*12é"
_QUERIES: Final = ("ASK {}", "SELECT * { ?s rnkg:name ?o } LIMIT 9", "SELECT ?s { ?s rnkg:nam 1 }", "SELECT {")


def keys(chance: random.Random) -> list[str]:
    """Return the next action of a user: one key, or the keys of a query that is then run."""
    kind = chance.random()
    if kind < 0.02:
        return [*chance.choice(_QUERIES), "f5"]
    if kind < 0.3:
        return [chance.choice(_TEXT)]
    if kind < 0.6:
        return [chance.choice(_OFTEN)]
    return [chance.choice(_MOVES if kind < 0.7 else _ACTION_KEYS)]


class Late:
    """Responses of the store that are held, and released one by one, in any order."""

    def __init__(self, chance: random.Random) -> None:
        self.held: list[asyncio.Event] = []
        self.waiting = 0
        self.is_open = False
        self._chance = chance

    def delayed(self, ask: Callable[..., Awaitable[Any]]) -> Callable[..., Awaitable[Any]]:
        """Return a function for requests whose responses, and errors, arrive when they are released."""

        async def asked(*values: Any, **named: Any) -> Any:
            self.waiting += 1
            try:
                answer = (await asyncio.gather(ask(*values, **named), return_exceptions=True))[0]
                if not self.is_open:
                    event = asyncio.Event()
                    self.held.append(event)
                    await event.wait()
            finally:
                self.waiting -= 1
            if isinstance(answer, BaseException):
                raise answer
            return answer

        return asked

    def let_go(self) -> None:
        """Release one response."""
        if self.held:
            self.held.pop(self._chance.randrange(len(self.held))).set()

    def open(self) -> None:
        """Release all responses, and future ones at once."""
        self.is_open = True
        while self.held:
            self.let_go()


async def press(app: Shell, pilot: Pilot[None], late: Late, chance: random.Random, pressed: list[str]) -> None:
    """Press keys, with responses before, between and after them, until an error."""
    while len(pressed) < KEYS and not app.failures and app.is_running:
        for key in keys(chance):
            pressed.append(key)
            app.post_message(Key(key, key if len(key) == 1 else None))
            for _ in range(chance.choice((0, 0, 1, 2, 5, 20))):
                if chance.random() < 0.2:
                    late.let_go()
                await asyncio.sleep(0)
        if chance.random() < 0.1:
            await pilot.pause()
        if chance.random() < 0.01:
            size = Size(chance.choice((40, 60, 100)), chance.choice((10, 16, 30)))
            app.post_message(Resize(size, size))


async def leave_screens(app: Shell, pilot: Pilot[None], late: Late) -> None:
    """Press Escape until only the first screen is left and no pending response might open another.

    Pending keys are processed first: on a busy machine the pauses of a pilot end before them.
    """
    taken = asyncio.Event()
    app.call_later(taken.set)
    await taken.wait()
    await pilot.pause()
    while late.waiting or app.screen is not app.main:
        if app.screen is not app.main:
            await pilot.press("escape")
        await pilot.pause(0.02)


async def test_no_key_and_no_late_answer_ends_the_shell(
    store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After 400 random keys, or 2,000 in a deep run, a query is answered, and no error was caught."""
    monkeypatch.chdir(tmp_path)
    for name, value in (("HOME", str(tmp_path)), ("EDITOR", "true"), ("VISUAL", "true")):
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(screen, "UPDATE_PERIOD", 0.5)  # the drawing is not checked
    chance = random.Random(SEED)  # noqa: S311 - to be pressed again
    pressed: list[str] = []
    app, late = make(store, tmp_path / "state"), Late(chance)
    async with app.run_test(size=(60, 16), notifications=True) as pilot:
        leave = app.exit
        monkeypatch.setattr(app, "exit", lambda *_, **__: None)
        monkeypatch.setattr(app.link, "call", late.delayed(app.link.call))
        monkeypatch.setattr(app.link, "ask", late.delayed(app.link.ask))
        try:
            await asyncio.wait_for(press(app, pilot, late, chance, pressed), patient(300))
            late.open()
            await asyncio.wait_for(leave_screens(app, pilot, late), patient(60))
            await until(lambda: current(app).editor.focus().has_focus)
            await run_query(app, pilot, "ASK {}")
            assert not app.failures
        except BaseException as error:
            for failure in app.failures:
                error.add_note("".join(traceback.format_exception(failure)))
            error.add_note(f"KG_TEST_SEED={SEED} KG_TEST_KEYS={KEYS}; {len(pressed)} pressed: {' '.join(pressed)}")
            raise
        finally:
            leave()
