"""Fair access to a limited number of slots."""

from __future__ import annotations

import asyncio
from collections import OrderedDict, deque
from typing import TYPE_CHECKING

from kg.errors import QueryError

if TYPE_CHECKING:
    from collections.abc import Callable


class Slots:
    """`slots`, each held by one request at a time; at most `queue` requests wait.

    Free slots go to the waiting clients in turn. Of the requests of one client, the oldest goes first. If more of them
    wait than there are slots, the newest and the oldest alternate. So a burst does not delay later requests for long,
    and each of its requests is served.

    If the queue is full, the client with the most waiting requests loses its newest one. So one client cannot fill the
    queue.
    """

    def __init__(self, slots: int, queue: int) -> None:
        self.used = 0
        self._slots = slots
        self._queue = queue
        self._newest = False
        self._waiting: OrderedDict[str, deque[asyncio.Future[None]]] = OrderedDict()

    @property
    def waiting(self) -> int:
        """Number of waiting requests."""
        return sum(map(len, self._waiting.values()))

    async def take(self, client: str, register: Callable[[asyncio.Future[None]], object]) -> None:
        """Take a slot, after waiting for one. `register` receives a future; an exception set on it ends the wait.

        Raises:
            QueryError: KG509 if the queue is full and no other client has more requests in it.
        """
        if self.used < self._slots and not self._waiting:
            self.used += 1
            return
        if self.waiting >= self._queue:
            self._make_room(client)
        place: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.setdefault(client, deque()).append(place)
        register(place)
        try:
            await place
        except BaseException:
            self._forget(client, place)
            if place.done() and not place.cancelled() and place.exception() is None:
                # The slot was granted at the moment when the wait ended.
                self.give_back()
            raise

    def give_back(self) -> None:
        """Release a slot, or pass it on to the next client."""
        while self._waiting:
            client, places = next(iter(self._waiting.items()))
            self._waiting.move_to_end(client)
            self._newest = not self._newest
            place = places[-1 if self._newest and len(places) > self._slots else 0]
            self._forget(client, place)
            if not place.done():
                place.set_result(None)
                return
        self.used -= 1

    def _make_room(self, client: str) -> None:
        """Remove the newest request of the client with the most waiting requests; KG509 if that is `client`."""
        busy = QueryError("KG509", f"{self.waiting} queries are waiting", hint="Try again in a second.")
        longest = max(self._waiting, key=lambda name: len(self._waiting[name]), default=client)
        if len(self._waiting.get(longest, ())) <= len(self._waiting.get(client, ())) + 1:
            raise busy
        place = self._waiting[longest][-1]
        self._forget(longest, place)
        if not place.done():
            place.set_exception(busy)

    def _forget(self, client: str, place: asyncio.Future[None]) -> None:
        places = self._waiting.get(client, deque())
        if place in places:
            places.remove(place)
        if not places:
            self._waiting.pop(client, None)
