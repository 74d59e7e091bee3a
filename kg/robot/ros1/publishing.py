"""Topics that our node writes to: one connection for each subscriber, with a queue that drops the oldest."""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Any, Final

from kg.robot.ros1.header import framed, pack
from kg.robot.ros1.names import shown
from kg.robot.tasks import spawn

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.connection import Value
    from kg.robot.ros1.node import Node

__all__ = ["Offer", "Ros1Publication"]

_QUEUE: Final = 100


class _Link:
    """A subscriber of a topic of ours."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.dropped = 0
        self._reader = reader
        self._writer = writer
        self._waiting: deque[bytes] = deque(maxlen=_QUEUE)
        self._news = asyncio.Event()

    def put(self, content: bytes) -> None:
        """Send a message, at once where nothing waits; the oldest makes room when the subscriber is too slow."""
        if not self._waiting and not self._writer.transport.get_write_buffer_size():
            self._writer.write(content)
            return
        self.dropped += len(self._waiting) == _QUEUE
        self._waiting.append(content)
        self._news.set()

    async def run(self) -> None:
        """Send what waits until the subscriber ends the connection, on which it says nothing."""
        sending = spawn(self._send(), "sending to a subscriber")
        try:
            while await self._reader.read(1 << 12):
                pass
        except OSError:
            return  # it broke off
        finally:
            sending.cancel()

    def close(self) -> None:
        """End the connection, after what waits: a subscriber that is slow is told to stand still all the same."""
        while self._waiting:
            self._writer.write(self._waiting.popleft())
        self._writer.close()

    async def _send(self) -> None:
        try:
            while True:
                self._news.clear()
                await self._news.wait()
                while self._waiting:
                    self._writer.write(self._waiting.popleft())
                    await self._writer.drain()
        except OSError:
            self._waiting.clear()


class Offer:
    """A topic that our node is registered for as a publisher."""

    def __init__(self, node: Node, topic: str, kind: str) -> None:
        self.topic = topic
        self.kind = kind
        self.users = 0
        self.latch = False
        self.links: dict[_Link, str] = {}
        self.registered: asyncio.Future[Any]
        self._node = node
        self._last: bytes | None = None

    @property
    def dropped(self) -> int:
        """How many messages were dropped for those who read too slowly and are still connected."""
        return sum(link.dropped for link in self.links)

    def put(self, value: Value) -> None:
        """Send a message to all; RobotError KG805 when it does not fit."""
        content = framed(self._node.types.encode(self.kind, value))
        if self.latch:
            self._last = content
        for link in self.links:
            link.put(content)

    async def serve(
        self, header: Mapping[str, str], reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        """Serve a subscriber that has sent its header, until it leaves."""
        types = self._node.types
        wanted = {"md5sum": types.md5(self.kind), "type": self.kind}
        for field, ours in wanted.items():
            if header.get(field, "*") not in {"*", ours}:
                words = f"`{self.topic}` is {self.kind} with {field} {ours}, not {shown(header[field])}"
                self._node.note("KG806", header.get("callerid", "?"), words)
                writer.write(pack({"error": words}))
                return
        told = {"callerid": self._node.name, "latching": str(int(self.latch)), "topic": self.topic, **wanted}
        writer.write(pack({**told, "message_definition": types.definition(self.kind)}))
        link = _Link(reader, writer)
        self.links[link] = shown(header.get("callerid", "?"))
        if self._last is not None:
            link.put(self._last)
        try:
            await link.run()
        finally:
            del self.links[link]

    def close(self) -> None:
        """End all connections."""
        for link in self.links:
            link.close()


class Ros1Publication:
    """A use of a topic: the topic is offered as long as one is open."""

    def __init__(self, node: Node, offer: Offer) -> None:
        self._node = node
        self._offer = offer
        self._open = True

    @property
    def peers(self) -> int:
        """How many subscribers are connected."""
        return len(self._offer.links)

    @property
    def dropped(self) -> int:
        """How many messages were dropped for subscribers that read too slowly."""
        return self._offer.dropped

    async def publish(self, value: Value) -> None:
        """Send a message; RobotError KG805 when the value does not fit the type, KG803 when the robot is lost.

        Links to subscribers outlive the master: a robot that moves can be told to stand still without it.
        """
        if not self._offer.links:
            self._node.present()
        self._offer.put(value)
        await asyncio.sleep(0)

    async def aclose(self) -> None:
        """Stop offering the topic."""
        if self._open:
            self._open = False
            await self._node.withdraw(self._offer)
