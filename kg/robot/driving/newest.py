"""The newest messages of topics: each is subscribed once, however many capabilities are read from it."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

from kg.errors import RobotError
from kg.robot.tasks import ended, spawn

if TYPE_CHECKING:
    from collections.abc import Container

    from kg.robot.connection import Connection, Received, Subscription

__all__ = ["Newest", "NewestMessages", "Throttle"]

_EARLY: Final = 0.1
"""The part of a period by which a message may come early and still be its turn."""


class Throttle:
    """Whose turn it is when only so many messages a second are wanted; all of them without a rate."""

    def __init__(self, rate: float | None) -> None:
        self._period = 1 / rate if rate else None
        self._due: float | None = None

    def takes(self, at: float) -> bool:
        """Tell whether the message of a time is one that is wanted; a clock that is set back begins anew."""
        if self._period is None:
            return True
        early = 0.0 if self._due is None else self._due - at
        if _EARLY * self._period < early <= self._period:
            return False
        on_time = self._due is not None and abs(early) <= self._period
        self._due = (self._due if self._due is not None and on_time else at) + self._period
        return True


class Newest:
    """The newest message of a topic, from the first on."""

    def __init__(self, subscription: Subscription) -> None:
        self.newest: Received | None = None
        self.ended = False
        self._news = asyncio.Event()
        self._subscription = subscription
        self._task = spawn(self._listen(), "listening")

    async def _listen(self) -> None:
        try:
            async for received in self._subscription:
                self.newest = received
                self._news.set()
        finally:
            self.ended = True
            self._news.set()

    async def first(self) -> Received | None:
        """Return the newest message, or the first one when none has come yet; None when the topic has ended."""
        while self.newest is None and not self.ended:
            await self.news()
        return self.newest

    async def news(self) -> None:
        """Return when another message has come, the topic has ended, or `ring` was called."""
        self._news.clear()
        await self._news.wait()

    def ring(self) -> None:
        """Let those look again who wait for news."""
        self._news.set()

    async def aclose(self) -> None:
        """Stop listening."""
        await self._subscription.aclose()
        await ended(self._task)


class NewestMessages:
    """The newest messages that come over a connection, by topic."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._by_topic: dict[str, asyncio.Task[Newest]] = {}

    async def of(self, topic: str, kind: str) -> Newest:
        """Return that of a topic, which is subscribed when it is asked for first.

        Raises:
            RobotError: KG803 when they are closed meanwhile, and those of subscribing.
        """
        known = self._by_topic.get(topic)
        if known is None or (known.done() and (known.cancelled() or known.exception() or known.result().ended)):
            known = self._by_topic[topic] = asyncio.ensure_future(self._subscribe(topic, kind))
        await asyncio.wait((known,))  # others may wait for it who are not cancelled
        if known.cancelled():
            raise RobotError("KG803", f"the subscription to `{topic}` was closed")
        return known.result()

    async def _subscribe(self, topic: str, kind: str) -> Newest:
        return Newest(await self._connection.subscribe(topic, kind, queue=1))

    async def aclose(self) -> None:
        """Stop listening to everything."""
        await self.keep(())

    async def keep(self, topics: Container[str]) -> None:
        """Stop listening to other topics; a subscription that is not made yet, as to a dead peer, is given up.

        Those who wait for news of the topics that are kept look again.
        """
        tasks = [self._by_topic.pop(topic) for topic in set(self._by_topic) if topic not in topics]
        for task in tasks:
            task.cancel()
        for found in await asyncio.gather(*tasks, return_exceptions=True):
            if isinstance(found, Newest):
                await found.aclose()
        for known in self._by_topic.values():
            if known.done() and not known.cancelled() and known.exception() is None:
                known.result().ring()
