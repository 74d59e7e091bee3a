"""Publishers and subscribers of ROS 1.

A published topic has one connection for each subscriber, with a queue that drops the oldest messages. A subscribed
topic has one connection to each publisher, reopened while the publisher is listed.
"""

from __future__ import annotations

import asyncio
import fcntl
import struct
import sys
import termios
from collections import deque
from contextlib import asynccontextmanager
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.robot.inbox import Inbox, Messages, Raw
from kg.robot.ros1.header import framed, pack, read_header, read_message
from kg.robot.ros1.names import is_type, shown
from kg.robot.ros1.xmlrpc import ask
from kg.robot.tasks import spawn

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Iterable, Mapping

    from kg.robot.connection import Value
    from kg.robot.messages import Types
    from kg.robot.ros1.node import Node

_QUEUE: Final = 100
_INT: Final = struct.Struct("i")


class _Link:
    """The connection to a subscriber of our topic."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader = reader
        self._writer = writer
        self._waiting: deque[bytes] = deque(maxlen=_QUEUE)
        self._news = asyncio.Event()

    def put(self, content: bytes) -> None:
        """Send a message, at once if the queue is empty; the oldest is dropped if the subscriber is too slow."""
        if not self._waiting and not self._writer.transport.get_write_buffer_size():
            self._writer.write(content)
            return
        self._waiting.append(content)
        self._news.set()

    @property
    def confirmed(self) -> bool:
        """Whether the machine of the subscriber has confirmed all messages; only Linux reports that."""
        if self._waiting or self._writer.transport.get_write_buffer_size() or sys.platform != "linux":
            return False
        try:  # how many bytes the kernel holds until the other machine acknowledges them
            left = fcntl.ioctl(self._writer.get_extra_info("socket").fileno(), termios.TIOCOUTQ, bytes(_INT.size))
        except OSError:  # it was closed
            return False
        return left == bytes(_INT.size)

    async def run(self) -> None:
        """Send queued messages until the subscriber disconnects; it sends nothing."""
        sending = spawn(self._send(), "sending to a subscriber")
        try:
            while await self._reader.read(1 << 12):
                pass
        except OSError:
            return  # it disconnected
        finally:
            sending.cancel()

    def close(self) -> None:
        """Close the connection after sending the queue: a slow subscriber still receives the command to stop."""
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
    """A topic that our node publishes."""

    def __init__(self, node: Node, topic: str, kind: str) -> None:
        self.topic = topic
        self.kind = kind
        self.users = 0
        self.latch = False
        self.links: dict[_Link, str] = {}
        self.registered: asyncio.Future[Any]
        self._node = node
        self._last: bytes | None = None

    def put(self, value: Value) -> None:
        """Send a message to all subscribers; RobotError KG805 for an invalid value."""
        content = framed(self._node.types.encode(self.kind, value))
        if self.latch:
            self._last = content
        for link in self.links:
            link.put(content)

    async def serve(
        self, header: Mapping[str, str], reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        """Serve a subscriber after its header, until it disconnects."""
        types = self._node.types
        wanted = {"md5sum": types.md5(self.kind), "type": self.kind}
        for field, ours in wanted.items():
            if header.get(field, "*") not in {"*", ours}:
                words = f"`{self.topic}` is {self.kind} with {field} {ours}, not {shown(header[field])}"
                self._node.note("KG806", header.get("callerid", "?"), words)
                writer.write(pack({"error": words}))
                return
        answer = {"callerid": self._node.name, "latching": str(int(self.latch)), "topic": self.topic, **wanted}
        writer.write(pack({**answer, "message_definition": types.definition(self.kind)}))
        link = _Link(reader, writer)
        self.links[link] = shown(header.get("callerid", "?"))
        if self._last is not None:
            link.put(self._last)
        try:
            await link.run()
        finally:
            del self.links[link]

    def close(self) -> None:
        """Close all connections."""
        for link in self.links:
            link.close()


class Ros1Publication:
    """A use of a published topic, which is published while any use is open."""

    def __init__(self, node: Node, offer: Offer) -> None:
        self._node = node
        self._offer = offer
        self._open = True

    @property
    def peers(self) -> int:
        """Number of connected subscribers."""
        return len(self._offer.links)

    @property
    def confirmed(self) -> bool:
        """Whether the machines of all subscribers have confirmed all messages (TCP)."""
        return all(link.confirmed for link in self._offer.links)

    async def publish(self, value: Value) -> None:
        """Publish a message; RobotError KG805 if the value does not fit the type, KG803 if the robot is lost.

        Connections to subscribers survive the master, so a moving robot can be stopped without it.
        """
        if not self._offer.links:
            self._node.present()
        self._offer.put(value)
        await asyncio.sleep(0)

    async def aclose(self) -> None:
        """Stop publishing the topic."""
        if self._open:
            self._open = False
            await self._node.withdraw(self._offer)


_FIRST_PAUSE: Final = 0.1
_LONGEST_PAUSE: Final = 2.0
_SLOWEST: Final = 5.0


class Ros1Subscription(Messages):
    """The messages of a topic; the oldest are dropped if the queue is full."""

    def __init__(self, node: Node, topic: str, kind: str, queue: int) -> None:
        self.topic = topic
        self.kind = kind
        self.links: dict[str, asyncio.Task[None]] = {}
        self.connected: dict[str, str] = {}
        self._node = node
        self._closed = False
        super().__init__(Inbox(queue, self.end), partial(node.types.decode, kind), self._note)

    def update(self, publishers: Iterable[str]) -> None:
        """Connect to these publishers and no others."""
        wanted = set() if self._closed else set(publishers)
        for uri in self.links.keys() - wanted:
            self.links.pop(uri).cancel()
        for uri in wanted - self.links.keys():
            self.links[uri] = spawn(self._follow(uri), f"reading {self.topic}")

    def _note(self, error: RobotError, node: str | None) -> None:
        self._node.note(error.code, node or self.topic, error.message)

    async def aclose(self) -> None:
        """Close the subscription."""
        if not self._closed:
            await self._inbox.aclose()
            await self._node.leave(self)

    def end(self) -> None:
        """End the iteration after the queue, and close all connections at once."""
        self._closed = True
        self.update(())
        self._inbox.end()

    async def _follow(self, uri: str) -> None:
        pause = _FIRST_PAUSE
        while True:
            try:
                await self._receive(uri)
                pause = _FIRST_PAUSE
            except (RobotError, OSError, TimeoutError) as error:
                code, words = (error.code, error.message) if isinstance(error, RobotError) else ("KG803", str(error))
                self._node.note(code, self.connected.get(uri, uri), f"`{self.topic}`: {words}")
                if code in {"KG806", "KG812"}:
                    return  # it would refuse again while it is listed
            finally:
                self.connected.pop(uri, None)
            await asyncio.sleep(pause)
            pause = min(2 * pause, _LONGEST_PAUSE)

    async def _receive(self, uri: str) -> None:
        async with open_topic(self._node, uri, self.topic, self.kind) as (reader, publisher, latched):
            self.connected[uri] = publisher
            while (content := await read_message(reader)) is not None:
                self._inbox.put(Raw(content, self._node.clock.now(), publisher, latched))


@asynccontextmanager
async def open_topic(
    node: Node, uri: str, topic: str, kind: str
) -> AsyncIterator[tuple[asyncio.StreamReader, str, bool]]:
    """Connect to a publisher of a topic, and learn the type from it if it is unknown.

    Yields the reader, the name of the publisher, and whether it is latched.

    Raises:
        RobotError: those of `ask`; KG806 type or checksum differ, or the publisher refuses, KG810 it does not support
            TCPROS, or an invalid header or definition, KG804 no definition of an unknown type.
    """
    protocol = await ask(uri, "requestTopic", node.name, topic, [["TCPROS"]])
    if not isinstance(protocol, list) or [type(one) for one in protocol] != [str, str, int]:
        raise RobotError("KG810", f"{uri} offers `{topic}` by {shown(protocol)}, not by TCPROS")
    _, host, port = protocol
    async with asyncio.timeout(_SLOWEST):
        try:
            reader, writer = await asyncio.open_connection(host, port)
        except (ValueError, OverflowError):  # an invalid host or port
            raise RobotError("KG810", f"{uri} offers `{topic}` at {shown(host)}:{port}") from None
    try:
        ours = {"callerid": node.name, "topic": topic, "type": kind, "md5sum": "*", "tcp_nodelay": "1"}
        writer.write(pack(ours | {"message_definition": ""}))
        header = await read_header(reader)
        if "error" in header:
            raise RobotError("KG806", f"the publisher refuses: {shown(header['error'])}")
        _learn(node.types, kind, header)
        yield reader, shown(header.get("callerid", uri)), header.get("latching") == "1"
    finally:
        writer.close()


def _learn(types: Types, kind: str, header: Mapping[str, str]) -> None:
    """Compare a publisher's header with a type, or learn an unknown type from it."""
    sent, md5 = header.get("type", ""), header.get("md5sum", "")
    if not is_type(sent) or not md5:
        raise RobotError("KG810", f"a header has the type `{shown(sent)}` and the sum `{md5[:40]}`")
    if sent != kind:
        raise RobotError("KG806", f"it is {sent}, not {kind}")
    if types.has(kind) and types.md5(kind) == md5:
        return
    if "message_definition" in header:
        types.define(kind, header["message_definition"])
    if types.md5(kind) != md5:
        raise RobotError("KG806", f"{kind} has the sum {types.md5(kind)} here and {md5[:40]} there")
