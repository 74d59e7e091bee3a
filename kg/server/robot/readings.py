"""Values that pages follow: each capability is read once, however many look, and told at a pace for people."""

from __future__ import annotations

import asyncio
from functools import partial
from math import isfinite, isnan
from typing import TYPE_CHECKING, Any, Final

from kg.server.errors import problem
from kg.server.robot.ends import failure

if TYPE_CHECKING:
    from kg.robot.driving import Driver
    from kg.server.robot.listeners import Listeners

__all__ = ["Readings", "plain"]

_PACE: Final = 0.1
"""Seconds between two values of a capability that are told; the newest is never left out."""

_ELEMENTS: Final = 50
"""How many elements of a list are told."""


class Readings:
    """What is read for those who look on."""

    def __init__(self, listeners: Listeners) -> None:
        self._listeners = listeners
        self._driver: Driver | None = None
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._newest: dict[str, Any] = {}
        self._waiting: dict[str, asyncio.TimerHandle] = {}
        self._failed: set[str] = set()

    def follow(self, driver: Driver | None) -> None:
        """Read what is followed now, and nothing else, and again what could not be; without a driver nothing."""
        wanted = self._listeners.reads() if driver is not None else frozenset()
        kept = wanted - self._failed if driver is self._driver else frozenset()
        self._driver = driver
        self._failed.clear()
        for name in self._tasks.keys() - kept:
            self._tasks.pop(name).cancel()
            self._newest.pop(name, None)  # what waits to be told is of a robot, or for pages, that have gone
        if driver is not None:
            for name in wanted - self._tasks.keys():
                self._tasks[name] = asyncio.create_task(self._read(driver, name))
                self._tasks[name].add_done_callback(partial(self._over, name))

    async def aclose(self) -> None:
        """Read nothing more."""
        tasks = tuple(self._tasks.values())
        self.follow(None)
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _read(self, driver: Driver, name: str) -> None:
        async for value in driver.read(name):
            self._newest[name] = value
            if name not in self._waiting:
                self._tell(name)

    def _over(self, name: str, task: asyncio.Task[None]) -> None:
        error = failure(task, f"reading {name}")
        if error is not None and self._tasks.get(name) is task:
            self._failed.add(name)
            self._listeners.tell({"event": "value", "capability": name, "problem": problem(error)}, of=name)

    def _tell(self, name: str) -> None:
        """Tell the newest value, and after a while the one that has come by then."""
        self._waiting.pop(name, None)
        if (value := self._newest.pop(name, None)) is not None:
            self._listeners.tell({"event": "value", "capability": name, "value": plain(value)}, of=name)
            self._waiting[name] = asyncio.get_running_loop().call_later(_PACE, self._tell, name)


def plain(value: Any) -> Any:
    """Return a value as JSON has it, which knows neither infinity nor what is not a number."""
    if isinstance(value, float) and not isfinite(value):
        return None if isnan(value) else "∞" if value > 0 else "-∞"
    if isinstance(value, dict):
        return {key: plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [plain(one) for one in value[:_ELEMENTS]]
    return f"{len(value)} bytes" if isinstance(value, bytes) else value
