"""The time of a robot: that of the wall, or that of a simulation, which may run faster."""

from __future__ import annotations

import asyncio
import heapq
import time
from contextlib import suppress
from itertools import count
from typing import TYPE_CHECKING, Final, Protocol, TypeVar

from kg.robot.tasks import ended

if TYPE_CHECKING:
    from collections.abc import AsyncIterable, Awaitable

    from kg.robot.connection import Received

Result = TypeVar("Result")

_INSTANT: Final = 1e-9
_STALLED: Final = 10.0
"""Seconds of the wall that the time of a robot may stand still before nobody waits for it any more."""


class Clock(Protocol):
    """What waits and measures on a robot asks, never the wall itself."""

    def now(self) -> float:
        """Return the time in seconds."""

    async def sleep(self, seconds: float) -> None:
        """Return when so much of this time has passed."""


class WallClock:
    """The time of the machine, in seconds since 1970."""

    def now(self) -> float:
        """Return the time in seconds."""
        return time.time()

    async def sleep(self, seconds: float) -> None:
        """Return when so many seconds have passed."""
        await asyncio.sleep(seconds)


class SimulatedClock:
    """The time that a simulation tells; it stands still between two tellings (`use_sim_time`, topic `/clock`)."""

    def __init__(self) -> None:
        self._now = 0.0
        self._order = count()
        self._sleepers: list[tuple[float, int, asyncio.Future[None]]] = []

    def now(self) -> float:
        """Return the time in seconds that was told last; 0 before any was."""
        return self._now

    def tell(self, seconds: float) -> None:
        """Set the time; who sleeps until then wakes up. A time that goes back, after a reset, wakes everyone."""
        back = seconds < self._now
        self._now = seconds
        while self._sleepers and (back or self._sleepers[0][0] <= seconds):
            _, _, sleeper = heapq.heappop(self._sleepers)
            if not sleeper.done():
                sleeper.set_result(None)

    async def follow(self, ticks: AsyncIterable[Received]) -> None:
        """Take the time of the messages of the topic `/clock` as they come."""
        async for tick in ticks:
            now = tick.value["clock"]
            self.tell(now["sec"] + now["nanosec"] / 1e9)

    async def begun(self, seconds: float) -> None:
        """Return when a time was told, or so many seconds of the wall have passed: who measures before starts at 0."""
        with suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                await self.sleep(_INSTANT - self._now)

    async def sleep(self, seconds: float) -> None:
        """Return when so many seconds have been told."""
        if seconds <= 0:
            await asyncio.sleep(0)
            return
        sleeper: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        heapq.heappush(self._sleepers, (self._now + seconds, next(self._order), sleeper))
        await sleeper


def stamp(seconds: float) -> dict[str, int]:
    """Return a time in seconds as messages have it (`time`, builtin_interfaces/Time); it cannot be negative there."""
    whole = int(max(seconds, 0.0))
    return {"sec": whole, "nanosec": min(999_999_999, round((max(seconds, 0.0) - whole) * 1e9))}


async def within(clock: Clock, seconds: float, work: Awaitable[Result], *, pauses: bool = False) -> Result:
    """Return what `work` gives; TimeoutError, and the work cancelled, when so much time of the clock has passed.

    The work has ended in any case when this returns or raises: what it does on being cancelled is waited for.
    A clock that stands still for ten seconds of the wall has no time left either, but where it `pauses`: what goes on
    when the simulation does is worth waiting for.
    """
    task = asyncio.ensure_future(work)
    ends = [asyncio.ensure_future(clock.sleep(seconds))]
    if not pauses:
        ends.append(asyncio.ensure_future(_stalled(clock)))
    try:
        await asyncio.wait((task, *ends), return_when=asyncio.FIRST_COMPLETED)
        late = not task.done()
    finally:
        await ended(task, *ends)
    if late and task.cancelled():
        raise TimeoutError
    return task.result()


async def _stalled(clock: Clock) -> None:
    """Return when the time of a robot has stood still for long."""
    before = None
    while before != clock.now():
        before = clock.now()
        await asyncio.sleep(_STALLED)
