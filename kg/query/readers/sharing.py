"""Sharing the processor among the readers of long queries."""

from __future__ import annotations

import asyncio
import time
from collections import defaultdict
from typing import TYPE_CHECKING, Final

from kg.errors import QueryError

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.query.readers.processes import Process

_TURN_SECONDS: Final = 0.1
"""Interval at which the running readers are chosen again."""
_NICE_SECONDS: Final = 0.1
"""Processor time after which a reader gets a lower priority, for good. It then takes no further query."""


class Sharing:
    """Readers of long queries. `slots` of them run at a time, the others are paused; at most `most` are held.

    Readers with the least run time run next: first by the time of all long queries of their client, then by their own.
    Times of single queries count as equal up to a factor of two, and then the oldest goes first. So queries of similar
    length run one after the other, and a longer query does not delay them.

    Time counts while a reader may run, working or waiting, so no reader can hold its turn by waiting.
    """

    def __init__(self, slots: int, most: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._slots = slots
        self._most = most
        self._clock = clock
        self._clients: dict[Process, str] = {}
        self._seconds: dict[Process, float] = {}
        self._running: set[Process] = set()
        self._since = 0.0
        self._timer: asyncio.TimerHandle | None = None

    @property
    def size(self) -> int:
        """Number of held readers, running and paused."""
        return len(self._clients)

    def add(self, process: Process, client: str) -> None:
        """Add a reader that runs a query of `client`.

        Raises:
            QueryError: KG509 if too many are held.
        """
        if self.size >= self._most:
            raise QueryError("KG509", f"{self.size} long queries are running", hint="Try again in a few seconds.")
        self._charge()
        self._clients[process] = client
        self._seconds[process] = 0.0
        self._running.add(process)
        self._choose()

    def remove(self, process: Process) -> None:
        """Remove a reader, if it is held; it may be paused."""
        if process in self._clients:
            self._charge()
            del self._clients[process], self._seconds[process]
            self._running.discard(process)
            self._choose()

    def turn(self) -> None:
        """Choose the readers that run next."""
        self._charge()
        self._choose()

    def _charge(self) -> None:
        now = self._clock()
        for process in self._running:
            self._seconds[process] += now - self._since
            if not process.nice and process.used() >= _NICE_SECONDS:
                process.give_way()
        self._since = now

    def _choose(self) -> None:
        of_client: defaultdict[str, float] = defaultdict(float)
        for process, client in self._clients.items():
            of_client[client] += self._seconds[process]
        order = sorted(self._clients, key=lambda one: (of_client[self._clients[one]], _level(self._seconds[one])))
        chosen = set(order[: self._slots])
        for process in self._running - chosen:
            process.pause()
        for process in chosen - self._running:
            process.resume()
        self._running = chosen
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if self.size:
            self._timer = asyncio.get_running_loop().call_later(_TURN_SECONDS, self.turn)


def _level(seconds: float) -> int:
    """Return 0 for less than a turn, and one more for each doubling of `seconds`."""
    return int(seconds / _TURN_SECONDS).bit_length()
