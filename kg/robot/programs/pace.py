"""How a program goes through time: pausing, waiting on the robot's clock, and not doing too much at once."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, Final, TypeVar

from kg.errors import RobotError
from kg.robot.tasks import ended, first

if TYPE_CHECKING:
    from collections.abc import Coroutine

    from kg.robot.clock import Clock

__all__ = ["MOST_STEPS", "Pace", "together"]

MOST_STEPS: Final = 20_000
"""How many statements may be carried out without one that waits or does something."""

_T = TypeVar("_T")


class Pace:
    """Time as a program sees it, which stands still while the program is paused."""

    def __init__(self, clock: Clock) -> None:
        """Begin to go."""
        self._clock = clock
        self._steps = 0
        self._going = asyncio.Event()
        self._paused = asyncio.Event()
        self._going.set()

    @property
    def paused(self) -> bool:
        """Whether the program is paused, or will be at the next border of a statement."""
        return self._paused.is_set()

    def pause(self) -> None:
        """Stand still from now on."""
        self._going.clear()
        self._paused.set()

    def resume(self) -> None:
        """Go on."""
        self._paused.clear()
        self._going.set()

    def waited(self) -> None:
        """Note that the program did wait, so that what comes next is no endless work."""
        self._steps = 0

    async def going(self) -> None:
        """Return at once, or when the program goes on."""
        await self._going.wait()

    async def step(self) -> None:
        """Pass the border of a statement; RobotError KG837 when there were too many without a wait."""
        self._steps += 1
        if self._steps > MOST_STEPS:
            hint = "Put `wait 0.1 s` into the loop."
            raise RobotError("KG837", f"more than {MOST_STEPS} statements without a wait", hint=hint)
        await self._going.wait()
        await asyncio.sleep(0)

    async def sleep(self, seconds: float) -> None:
        """Return when so much time has passed in which the program was not paused."""
        left = seconds
        while left > 0:
            await self._going.wait()
            begun = self._clock.now()
            if await self.until_paused(self._clock.sleep(left)) is not None:
                break
            left -= max(self._clock.now() - begun, 0.0)
        if seconds > 0:
            self.waited()

    async def until_paused(self, work: Coroutine[Any, Any, _T]) -> tuple[_T] | None:
        """Do some work and return what it gives in a tuple; None when a pause came first, and the work is cancelled."""
        return await first(work, self._paused.wait())


async def together(*work: Coroutine[Any, Any, None]) -> None:
    """Do things at a time and return when all are done; at the first error the others are cancelled."""
    tasks = [asyncio.ensure_future(one) for one in work]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_EXCEPTION) if tasks else (set(), set())
        for task in tasks:
            if task in done:
                task.result()
    finally:
        await ended(*tasks)
