"""The time of a recording that is played."""

from __future__ import annotations

import asyncio
from typing import Final

__all__ = ["BagClock"]

_LEAD: Final = 0.2
"""Seconds of the wall between the first subscription and the first message: others subscribe at the same time."""


class BagClock:
    """Stands still at the first moment until it is begun; then goes on, `speed` times as fast as the wall's."""

    def __init__(self, start: float, speed: float) -> None:
        self._start = start
        self._speed = speed
        self._begun: float | None = None

    def begin(self) -> None:
        """Let the time go on in a moment; beginning again is nothing."""
        if self._begun is None:
            self._begun = asyncio.get_running_loop().time() + _LEAD

    @property
    def begun(self) -> bool:
        """Whether it goes on."""
        return self._begun is not None

    def now(self) -> float:
        """Return the time of the recording in seconds since 1970."""
        if self._begun is None:
            return self._start
        return self._start + max(asyncio.get_running_loop().time() - self._begun, 0.0) * self._speed

    async def sleep(self, seconds: float) -> None:
        """Return when so many seconds of the recording have passed."""
        await asyncio.sleep(max(seconds, 0) / self._speed)

    async def until(self, moment: float) -> None:
        """Return when a moment of the recording has come; others get their turn also where it has already."""
        loop = asyncio.get_running_loop()
        due = (loop.time() if self._begun is None else self._begun) + (moment - self._start) / self._speed
        await asyncio.sleep(max(due - loop.time(), 0))
