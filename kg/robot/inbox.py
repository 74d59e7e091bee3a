"""What is waited for: messages that come, and changes that are told."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncGenerator, AsyncIterator, Callable, Iterator
from contextlib import contextmanager
from typing import Final, Generic, NamedTuple, TypeVar

from kg.errors import RobotError
from kg.robot.connection import Received, Value

Item = TypeVar("Item")

_MOST_FEEDBACK: Final = 1000  # so much feedback waits for who may not read it


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


class Raw(NamedTuple):
    """A message as its bytes, with the time that it came at and the node that sent it, if it is known."""

    content: bytes
    at: float
    node: str | None


class Messages:
    """Messages of a topic that are decoded when they are read: what is dropped unread is not decoded either.

    `decode` makes a value of the bytes, `report` gets the error of what is none, with the node that sent it.
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
        """How many messages were dropped since they came faster than they were read."""
        return self._inbox.dropped

    async def __aiter__(self) -> AsyncIterator[Received]:
        async for raw in self._inbox:
            try:
                value = self._decode(raw.content)
            except RobotError as error:
                self._report(error, raw.node)
            else:
                yield Received(value, raw.at, raw.node)


class GoalProgress:
    """What the client of a goal waits for: feedback as it comes, and the result, or why there is none."""

    def __init__(self) -> None:
        self._told: Inbox[Value] = Inbox(_MOST_FEEDBACK, lambda: None)
        self._done: asyncio.Future[Value] = asyncio.get_running_loop().create_future()
        self._done.add_done_callback(lambda done: done.cancelled() or done.exception())  # nobody has to wait for it

    async def feedback(self) -> AsyncIterator[Value]:
        """Yield feedback as it comes, until the goal has ended."""
        async for value in self._told:
            yield value

    async def result(self) -> Value:
        """Return the result; RobotError KG809 with the status when the goal was aborted, rejected or cancelled."""
        return await asyncio.shield(self._done)

    def take_feedback(self, value: Value) -> None:
        """Take feedback of the server."""
        self._told.put(value)

    def end(self, outcome: Value | RobotError) -> None:
        """Take the result, or why there is none; the first one counts."""
        if not self._done.done():
            if isinstance(outcome, RobotError):
                self._done.set_exception(outcome)
            else:
                self._done.set_result(outcome)
        self._told.end()


class Changes:
    """Something that changes, for those who look at it whenever it may be another thing."""

    def __init__(self) -> None:
        self._watchers: set[asyncio.Event] = set()

    def tell(self) -> None:
        """Let everyone look again."""
        for watcher in self._watchers:
            watcher.set()

    @contextmanager
    def news(self) -> Iterator[asyncio.Event]:
        """Give an event that is set at each change."""
        news = asyncio.Event()
        self._watchers.add(news)
        try:
            yield news
        finally:
            self._watchers.discard(news)

    async def values(self, look: Callable[[], Item | None]) -> AsyncGenerator[Item]:
        """Yield what `look` gives, and again each time that it gives another thing; it ends with None."""
        last: Item | None = None
        with self.news() as news:
            while (found := look()) is not None:
                if found != last:
                    yield found
                    last = found
                    continue
                await news.wait()
                news.clear()
