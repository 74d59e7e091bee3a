"""Observation while driving: the newest messages of topics, whether the robot moves, and other controllers.

Each topic is subscribed to once for all capabilities.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connection import ComputationGraph, Connection, GraphProblem, Received, Subscription
from kg.robot.driving.watchdog import NODES
from kg.robot.ros2.graph import NAMELESS
from kg.robot.tasks import ended, spawn

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping

    from kg.robot.clock import Clock
    from kg.robot.driving.routes import Route

_EARLY: Final = 0.1  # fraction of a period by which a message may be early


class Throttle:
    """Rate limiter for messages; without a rate it takes all."""

    def __init__(self, rate: float | None) -> None:
        self._period = 1 / rate if rate else None
        self._due: float | None = None

    def takes(self, at: float) -> bool:
        """Return whether to take a message of a time; a clock that is set back restarts it."""
        if self._period is None:
            return True
        early = 0.0 if self._due is None else self._due - at
        if _EARLY * self._period < early <= self._period:
            return False
        on_time = self._due is not None and abs(early) <= self._period
        self._due = (self._due if self._due is not None and on_time else at) + self._period
        return True


class Newest:
    """The newest message of a topic."""

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
        """Return the newest message, waiting for the first one; None if the topic has ended."""
        while self.newest is None and not self.ended:
            await self.news()
        return self.newest

    async def news(self) -> None:
        """Return at the next message, at the end of the topic, or when `ring` is called."""
        self._news.clear()
        await self._news.wait()

    def ring(self) -> None:
        """Wake all waiters."""
        self._news.set()

    async def aclose(self) -> None:
        """Close the subscription."""
        await self._subscription.aclose()
        await ended(self._task)


class NewestMessages:
    """The newest messages over a connection, by topic."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._by_topic: dict[str, asyncio.Task[Newest]] = {}

    async def of(self, topic: str, kind: str) -> Newest:
        """Return the messages of a topic, which is subscribed to on first use.

        Raises:
            RobotError: KG803 closed at the same time, and those of subscribing.
        """
        entry = self._by_topic.get(topic)
        if entry is None or (entry.done() and (entry.cancelled() or entry.exception() or entry.result().ended)):
            entry = self._by_topic[topic] = asyncio.ensure_future(self._subscribe(topic, kind))
        await asyncio.wait((entry,))  # other waiters might not be cancelled
        if entry.cancelled():
            raise RobotError("KG803", f"the subscription to `{topic}` was closed")
        return entry.result()

    async def _subscribe(self, topic: str, kind: str) -> Newest:
        return Newest(await self._connection.subscribe(topic, kind, queue=1))

    async def keep(self, topics: Container[str]) -> None:
        """Close the subscriptions to other topics, and cancel pending ones, such as to a dead peer.

        Waiters on the remaining topics are woken.
        """
        tasks = [self._by_topic.pop(topic) for topic in set(self._by_topic) if topic not in topics]
        for task in tasks:
            task.cancel()
        for closing in await asyncio.gather(*tasks, return_exceptions=True):
            if isinstance(closing, Newest):
                await closing.aclose()
        for pending in self._by_topic.values():
            if pending.done() and not pending.cancelled() and pending.exception() is None:
                pending.result().ring()


_VELOCITY: Final = "sensingVelocity"
"""The capability whose parameters measure the commanded parameters of the same names."""
MEASURED: Final = frozenset({_VELOCITY, "sensingPose"})
"""The capabilities that show whether a robot moves."""
_BEGINS: Final = 0.5  # seconds of the robot's time within which a movement should begin
_SLOWEST: Final = 0.1  # fraction of a commanded speed that counts as moving: a standing robot may slide
_NOISE: Final = 0.15  # metres or radians by which the measured pose of a standing robot may vary
_ENOUGH: Final = 2  # number of measurements without speed after which a robot is not moving
_NO_CONTROLLERS: Final = (NODES, NAMELESS)


class Observation:
    """Compares commanded with measured speeds, while `watch` runs.

    A changing pose shows movement too, since not all odometry includes speeds.
    """

    def __init__(self, commanded: Mapping[str, Any]) -> None:
        self._commanded = {name: value for name, value in commanded.items() if isinstance(value, float) and value}
        self._first: dict[str, Any] | None = None
        self._still = 0
        self._moved = False

    @property
    def moved(self) -> bool | None:
        """Whether the robot moved; None without enough measurements."""
        return True if self._moved else False if self._still >= _ENOUGH else None

    async def watch(self, measuring: Route, newest: NewestMessages, clock: Clock) -> None:
        """Follow the measurements until the robot moves; unreadable ones are ignored."""
        begun = clock.now()
        with suppress(RobotError):
            following = await newest.of(measuring.way.name, measuring.way.type)
            while not self._moved and not following.ended:
                await following.news()
                if following.newest is None:
                    continue
                measured = measuring.values(following.newest.value)
                seconds = clock.now() - begun
                way = seconds * max(map(abs, self._commanded.values()), default=0.0)
                if measuring.capability.name != _VELOCITY:
                    self._take_place(measured, way)
                elif seconds >= _BEGINS and way >= 2 * _NOISE:
                    self._take_speeds(measured)

    def _take_place(self, measured: dict[str, Any], way: float) -> None:
        """Compare a pose with the first one; its axes may differ from those of the commands."""
        self._first = self._first or measured
        pairs = [(self._first[name], measured[name]) for name in measured]
        least = max(_NOISE, _SLOWEST * way)
        self._moved |= any(None not in pair and abs(pair[0] - pair[1]) >= least for pair in pairs)

    def _take_speeds(self, measured: Mapping[str, Any]) -> None:
        speeds = [(self._commanded[name], measured[name]) for name in self._commanded if measured.get(name) is not None]
        if any(abs(speed) >= _SLOWEST * abs(commanded) for commanded, speed in speeds):
            self._moved = True
        elif speeds:
            self._still += 1


def other_controllers(topic: str, graph: ComputationGraph) -> Iterator[GraphProblem]:
    """Yield a problem KG829 for each other node that publishes to a topic that moves a robot.

    A node that executes goals, such as navigation, publishes while it has one and is not a controller of its own.
    """
    left_out = {one.name for one in graph.nodes if one.problem is not None}
    left_out |= {one.node for one in graph.ends if one.role is Role.ACTION_SERVERS}
    for end in graph.ends:
        publishes = (end.name, end.role) == (topic, Role.PUBLISHES)
        if publishes and end.node not in left_out and not end.node.startswith(_NO_CONTROLLERS):
            yield GraphProblem("KG829", end.node, f"it publishes to `{topic}`, too")
