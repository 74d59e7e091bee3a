"""The clock of a robot: wall-clock time, or that of a simulation, which may run faster."""

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
_STALLED: Final = 10.0  # wall-clock seconds after which a stopped clock counts as stalled


class Clock(Protocol):
    """The clock for all waiting and measuring on a robot."""

    def now(self) -> float:
        """Return the time in seconds."""

    async def sleep(self, seconds: float) -> None:
        """Sleep for a duration of this clock."""


class WallClock:
    """The wall clock, in seconds since 1970."""

    def now(self) -> float:
        """Return the time in seconds."""
        return time.time()

    async def sleep(self, seconds: float) -> None:
        """Sleep for a number of seconds."""
        await asyncio.sleep(seconds)


class SimulatedClock:
    """The time published by a simulation; it stops between two messages (`use_sim_time`, topic `/clock`)."""

    def __init__(self) -> None:
        self._now = 0.0
        self._order = count()
        self._sleepers: list[tuple[float, int, asyncio.Future[None]]] = []

    def now(self) -> float:
        """Return the last published time in seconds; 0 before the first."""
        return self._now

    def set_time(self, seconds: float) -> None:
        """Set the time and wake sleepers; a time that goes back, after a reset, wakes all."""
        back = seconds < self._now
        self._now = seconds
        while self._sleepers and (back or self._sleepers[0][0] <= seconds):
            _, _, sleeper = heapq.heappop(self._sleepers)
            if not sleeper.done():
                sleeper.set_result(None)

    async def follow(self, ticks: AsyncIterable[Received]) -> None:
        """Follow the messages of the topic `/clock`."""
        async for tick in ticks:
            now = tick.value["clock"]
            self.set_time(now["sec"] + now["nanosec"] / 1e9)

    async def begun(self, seconds: float) -> None:
        """Return after the first message, or some wall-clock seconds: earlier measurements would start at 0."""
        with suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                await self.sleep(_INSTANT - self._now)

    async def sleep(self, seconds: float) -> None:
        """Sleep for a duration of simulated time."""
        if seconds <= 0:
            await asyncio.sleep(0)
            return
        sleeper: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        heapq.heappush(self._sleepers, (self._now + seconds, next(self._order), sleeper))
        await sleeper


def stamp(seconds: float) -> dict[str, int]:
    """Return a time in seconds as a message (`time`, builtin_interfaces/Time), where it cannot be negative."""
    whole = int(max(seconds, 0.0))
    return {"sec": whole, "nanosec": min(999_999_999, round((max(seconds, 0.0) - whole) * 1e9))}


async def within(clock: Clock, seconds: float, work: Awaitable[Result], *, pauses: bool = False) -> Result:
    """Return the result of `work`; TimeoutError, with the work cancelled, after some time of the clock.

    The work has ended in any case when this returns or raises, including its cleanup after cancellation. A clock that
    is stopped for ten wall-clock seconds times out too, unless it `pauses`: then the work may continue with the
    simulation.
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
    if late and task.cancelled():  # work that completed in spite of the cancellation counts
        raise TimeoutError
    return task.result()


async def _stalled(clock: Clock) -> None:
    """Return when the clock of a robot is stalled."""
    before = None
    while before != clock.now():
        before = clock.now()
        await asyncio.sleep(_STALLED)
