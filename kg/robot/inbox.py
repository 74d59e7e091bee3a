"""Messages that wait to be read."""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

__all__ = ["Inbox"]

Item = TypeVar("Item")


class Inbox(Generic[Item]):
    """A queue that drops the oldest when it is full; iterated until it is closed, by one reader at a time."""

    def __init__(self, size: int, on_close: Callable[[], None]) -> None:
        self.dropped = 0
        self._waiting: deque[Item] = deque(maxlen=max(size, 1))
        self._news = asyncio.Event()
        self._closed = False
        self._on_close = on_close

    def put(self, item: Item) -> None:
        """Take an item; the oldest makes room when too many wait."""
        self.dropped += len(self._waiting) == self._waiting.maxlen
        self._waiting.append(item)
        self._news.set()

    def end(self) -> None:
        """Let the iteration end after what waits."""
        self._closed = True
        self._news.set()

    async def __aiter__(self) -> AsyncIterator[Item]:
        while True:
            while self._waiting:
                yield self._waiting.popleft()
            if self._closed:
                return
            self._news.clear()
            await self._news.wait()

    async def aclose(self) -> None:
        """Take nothing more, and forget what waits."""
        self._waiting.clear()
        self.end()
        self._on_close()
