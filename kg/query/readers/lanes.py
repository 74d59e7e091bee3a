"""Who may run when: a number of slots, and those who wait for one."""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Final

from kg.errors import QueryError

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Lane"]

_TURNS: Final = 4
"""Of so many slots one goes to the oldest, however many wait."""


class Lane:
    """`slots` of which each is held by one at a time; at most `queue` wait.

    `niceness` is how much readers in it give way to others (nice(2)).

    Slots go to those who wait in turn, as long as few wait. When more wait than there are slots, three of four go to
    the newest: a flood from before does not keep it waiting, and a flood that comes behind does not keep the oldest.
    """

    def __init__(self, slots: int, queue: int, niceness: int = 0) -> None:
        self.slots = slots
        self.niceness = niceness
        self.held = 0
        self._queue = queue
        self._waiting: deque[asyncio.Future[None]] = deque()
        self._turn = 0

    @property
    def waiting(self) -> int:
        """How many wait."""
        return len(self._waiting)

    def try_take(self) -> bool:
        """Take a slot that nobody holds or waits for; false when there is none."""
        if self.held >= self.slots or self._waiting:
            return False
        self.held += 1
        return True

    async def take(self, tell: Callable[[asyncio.Future[None]], object]) -> None:
        """Take a slot, after waiting for one; `tell` is given what waits, an exception on which ends the waiting.

        Raises:
            QueryError: KG509 when as many wait as may.
        """
        if self.try_take():
            return
        if self.waiting >= self._queue:
            raise QueryError("KG509", f"{self.waiting} queries wait already", hint="Try again in a second.")
        place: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.append(place)
        tell(place)
        try:
            await place
        except BaseException:
            if place in self._waiting:
                self._waiting.remove(place)
            elif place.done() and not place.cancelled() and place.exception() is None:
                # The slot was given in the same moment as the waiting was ended.
                self.give_back()
            raise

    def give_back(self) -> None:
        """Let go of a slot; whose turn it is gets it."""
        while self._waiting:
            self._turn += 1
            newest = len(self._waiting) > self.slots and self._turn % _TURNS
            place = self._waiting.pop() if newest else self._waiting.popleft()
            if not place.done():
                place.set_result(None)
                return
        self.held -= 1
