"""Queues of messages and notifications of changes."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncGenerator, AsyncIterator, Callable, Iterator
from contextlib import contextmanager
from typing import Final, Generic, NamedTuple, TypeVar

from kg.errors import RobotError
from kg.robot.connection import Received, Value

Item = TypeVar("Item")

_MOST_FEEDBACK: Final = 1000  # maximum number of queued feedback messages


class Inbox(Generic[Item]):
    """A queue that drops the oldest item when it is full; iterated until it is closed, by one reader at a time."""

    def __init__(self, size: int, on_close: Callable[[], None]) -> None:
        self.dropped = 0
        self._waiting: deque[Item] = deque(maxlen=max(size, 1))
        self._news = asyncio.Event()
        self._closed = False
        self._on_close = on_close

    def put(self, item: Item) -> None:
        """Add an item; the oldest is dropped if the queue is full."""
        self.dropped += len(self._waiting) == self._waiting.maxlen
        self._waiting.append(item)
        self._news.set()

    def end(self) -> None:
        """End the iteration after the queued items."""
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
        """Close the queue and discard its items."""
        self._waiting.clear()
        self.end()
        self._on_close()


class Raw(NamedTuple):
    """An encoded message, with the fields of `Received`."""

    content: bytes
    at: float
    node: str | None
    latched: bool = False


class Messages:
    """Messages of a topic that are decoded when they are read; dropped ones are not decoded.

    `decode` converts the bytes, `report` receives the error of an invalid message, with the node that sent it.
    """

    def __init__(
        self,
        inbox: Inbox[Raw],
        decode: Callable[[bytes], Value],
        report: Callable[[RobotError, str | None], None],
    ) -> None:
        self._inbox = inbox
        self._decode = decode
        self._report = report

    @property
    def dropped(self) -> int:
        """Number of messages dropped because they arrived faster than they were read."""
        return self._inbox.dropped

    async def __aiter__(self) -> AsyncIterator[Received]:
        async for raw in self._inbox:
            try:
                value = self._decode(raw.content)
            except RobotError as error:
                self._report(error, raw.node)
            else:
                yield Received(value, raw.at, raw.node, raw.latched)


class GoalProgress:
    """The client's side of a goal: its feedback, and the result or the reason for its absence."""

    def __init__(self) -> None:
        self._feedback: Inbox[Value] = Inbox(_MOST_FEEDBACK, lambda: None)
        self._done: asyncio.Future[Value] = asyncio.get_running_loop().create_future()
        self._done.add_done_callback(lambda done: done.cancelled() or done.exception())  # it may never be awaited

    async def feedback(self) -> AsyncIterator[Value]:
        """Yield feedback until the goal has ended."""
        async for value in self._feedback:
            yield value

    async def result(self) -> Value:
        """Return the result; RobotError KG809 with the status if the goal was aborted, rejected or cancelled."""
        return await asyncio.shield(self._done)

    def take_feedback(self, value: Value) -> None:
        """Add feedback of the server."""
        self._feedback.put(value)

    def end(self, outcome: Value | BaseException) -> None:
        """Set the result, or the reason for its absence; the first one counts."""
        if not self._done.done():
            if isinstance(outcome, BaseException):
                self._done.set_exception(outcome)
            else:
                self._done.set_result(outcome)
        self._feedback.end()


class Changes:
    """Notification of changes to a value."""

    def __init__(self) -> None:
        self._watchers: set[asyncio.Event] = set()

    def notify(self) -> None:
        """Notify all watchers."""
        for watcher in self._watchers:
            watcher.set()

    @contextmanager
    def news(self) -> Iterator[asyncio.Event]:
        """Yield an event that is set at each change."""
        news = asyncio.Event()
        self._watchers.add(news)
        try:
            yield news
        finally:
            self._watchers.discard(news)

    async def values(self, look: Callable[[], Item | None]) -> AsyncGenerator[Item]:
        """Yield the result of `look`, and again whenever it changes; ends with None."""
        last: Item | None = None
        with self.news() as news:
            while (value := look()) is not None:
                if value != last:
                    yield value
                    last = value
                    continue  # it may have changed again while the caller worked
                await news.wait()
                news.clear()
