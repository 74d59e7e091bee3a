"""Topics of a bus: who writes, who reads, and the messages between them."""

from __future__ import annotations

import asyncio
from copy import deepcopy
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kg.errors import RobotError
from kg.robot.connection import Received
from kg.robot.inbox import Inbox

if TYPE_CHECKING:
    from kg.robot.connection import Value
    from kg.robot.memory.node import MemoryConnection
    from kg.robot.messages import Types

__all__ = ["MemoryPublication", "MemorySubscription", "Topic"]


@dataclass(slots=True)
class Topic:
    """The two sides of a topic; the first end says the type."""

    kind: str
    publications: list[MemoryPublication] = field(default_factory=list)
    subscriptions: list[MemorySubscription] = field(default_factory=list)


class MemorySubscription(Inbox[Received]):
    """Messages of a topic as they come."""

    def __init__(self, owner: MemoryConnection, topic: str, kind: str, queue: int) -> None:
        super().__init__(queue, self._leave)
        self.kind = kind
        self._owner = owner
        self._topic = topic

    @property
    def node(self) -> str:
        """The name of the node that reads."""
        return self._owner.name

    def _leave(self) -> None:
        side = self._owner.bus.topics[self._topic]
        side.subscriptions = [one for one in side.subscriptions if one is not self]
        self._owner.bus.changed()


class MemoryPublication:
    """A topic that a node writes to."""

    def __init__(self, owner: MemoryConnection, topic: str, kind: str, *, latch: bool) -> None:
        self.kind = kind
        self.last: Received | None = None
        self._owner = owner
        self._topic = topic
        self._latch = latch

    @property
    def node(self) -> str:
        """The name of the node that writes."""
        return self._owner.name

    @property
    def types(self) -> Types:
        """The types that its node knows."""
        return self._owner.types

    @property
    def peers(self) -> int:
        """How many subscribers are connected."""
        return len(self._side.subscriptions)

    @property
    def _side(self) -> Topic:
        return self._owner.bus.topics[self._topic]

    async def publish(self, value: Value) -> None:
        """Send a message; RobotError KG805 when the value does not fit the type, KG803 when the robot is lost."""
        self._owner.present()
        if self not in self._side.publications:
            raise RobotError("KG803", f"`{self._topic}` is not offered any more")
        sent = Received(self._owner.types.complete(self.kind, value), self._owner.clock.now(), self.node)
        if self._latch:
            self.last = sent
        for reader in self._side.subscriptions:
            reader.put(Received(deepcopy(sent.value), sent.at, sent.node))
        await asyncio.sleep(0)

    async def aclose(self) -> None:
        """Stop offering the topic."""
        self._side.publications = [one for one in self._side.publications if one is not self]
        self._owner.bus.changed()
