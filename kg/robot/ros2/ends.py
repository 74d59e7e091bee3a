"""Topics and services of ROS 2 above the middleware: messages, requests and responses as values."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final, TypeVar

from kg.errors import RobotError
from kg.facts import Qos, Role
from kg.robot.connection import GraphProblem, Value
from kg.robot.inbox import Inbox, Messages, Raw
from kg.robot.ros2.middleware import OFFERED, Caller, Handle
from kg.robot.tasks import outcome

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.robot.messages import Types
    from kg.robot.ros2.connection import Ros2Connection

Result = TypeVar("Result")
_ENCAPSULATION: Final = 4  # bytes before the first field of what CDR encodes


class Client:
    """Our client of a service."""

    def __init__(self, types: Types, kind: str, caller: Caller) -> None:
        self._types = types
        self._kind = kind
        self._caller = caller

    async def call(self, request: Value) -> Value:
        """Return the response; RobotError KG805, KG808, or KG816 for one that does not decode.

        Distributions differ in the results of actions, as Humble and Jazzy in that of `NavigateToPose`, but not in the
        status before it: of a result that does not decode, the status is returned, with an empty `result`.
        """
        content = self._types.encode(f"{self._kind}_Request", request)
        response = await self._caller.call(content)
        try:
            return self._types.decode(f"{self._kind}_Response", response)
        except RobotError as error:
            if self._kind.endswith("_GetResult") and len(response) > _ENCAPSULATION:
                return {"status": response[_ENCAPSULATION], "result": {}}
            raise RobotError("KG816", f"the response of a {self._kind} does not decode: {error.message}") from None

    def end(self) -> None:
        """Close the client."""
        self._caller.close()


class Service:
    """A service of our node."""

    def __init__(
        self, owner: Ros2Connection, name: str, kind: str, answer: Callable[[Value], Awaitable[Value]]
    ) -> None:
        self._owner = owner
        self._name = name
        self._kind = kind
        self._answer = answer
        self._handle = owner.wire.server(name, kind, self._respond)

    async def _respond(self, content: bytes) -> bytes:
        try:
            request = self._owner.types.decode(f"{self._kind}_Request", content)
        except RobotError as error:
            self._owner.watch.report(GraphProblem("KG816", self._name, f"a request does not decode: {error.message}"))
            raise
        result = await outcome(self._answer(request))
        if isinstance(result, BaseException):
            message = result.message if isinstance(result, RobotError) else str(result)
            self._owner.watch.report(GraphProblem("KG808", self._name, f"our own answer failed: {message}"))
            raise RobotError("KG808", message)
        return self._owner.types.encode(f"{self._kind}_Response", result)

    def end(self) -> None:
        """Stop serving."""
        self._handle.close()


_DEPTH: Final = 100  # minimum queue length in the middleware, which does not report messages that it drops


class Ros2Subscription(Messages):
    """The messages of a topic."""

    def __init__(self, owner: Ros2Connection, topic: str, kind: str, queue: int) -> None:
        self.kind = kind
        self._owner = owner
        self.topic = topic
        self._queue = max(queue, 1)
        super().__init__(Inbox(queue, self._shut), partial(owner.types.decode, kind), self._report_undecoded)
        self._qos: Qos | None = None
        self._handle: Handle | None = None

    def adapt(self) -> None:
        """Request a QoS that all known publishers offer; the reader is reopened if it changes."""
        offers = [one.qos for one in self._owner.ends(Role.PUBLISHES, self.topic) if one.qos]
        reliable = all(one.reliability != "best_effort" for one in offers)
        is_latched = bool(offers) and all(one.durability == "transient_local" for one in offers)
        wanted = replace(
            OFFERED,
            reliability="reliable" if reliable else "best_effort",
            durability="transient_local" if is_latched else "volatile",
            depth=max(self._queue, _DEPTH),
        )
        if wanted != self._qos:
            if self._handle is not None:
                self._handle.close()
            self._qos = self._handle = None  # until it is open: after a failure, the next graph tries again
            self._handle = self._owner.wire.reader(self.topic, self.kind, wanted, self._take)
            self._qos = wanted

    def _take(self, content: bytes, node: str | None) -> None:
        self._inbox.put(Raw(content, self._owner.clock.now(), node))

    def _report_undecoded(self, error: RobotError, node: str | None) -> None:
        message = f"a message on {self.topic} does not decode: {error.message}"
        self._owner.watch.report(GraphProblem("KG816", node or self.topic, message))

    async def aclose(self) -> None:
        """Close the subscription."""
        await self._inbox.aclose()

    def _shut(self) -> None:
        if self._handle is not None:
            self._handle.close()
        self._owner.forget(self)

    def end(self) -> None:
        """End the iteration, as when the connection is closed."""
        self._inbox.end()
        self._shut()


class Ros2Publication:
    """A topic that our node publishes."""

    def __init__(self, owner: Ros2Connection, topic: str, kind: str, qos: Qos) -> None:
        self._owner = owner
        self._topic = topic
        self._kind = kind
        self._writer = owner.wire.writer(topic, kind, qos)
        self._closed = False

    @property
    def peers(self) -> int:
        """Number of connected subscribers."""
        return 0 if self._closed else self._writer.peers

    @property
    def confirmed(self) -> bool:
        """Whether every subscriber has confirmed all messages, as far as the middleware reports it."""
        return not self._closed and self._writer.confirmed

    async def publish(self, value: Value) -> None:
        """Publish a message; RobotError KG805 if the value does not fit the type, KG803 if the topic is closed."""
        content = self._owner.types.encode(self._kind, value)
        if self._closed:
            raise RobotError("KG803", f"`{self._topic}` is not offered any more")
        self._writer.write(content)
        await asyncio.sleep(0)

    def end(self) -> None:
        """Stop publishing the topic."""
        self._closed = True
        self._writer.close()
        self._owner.forget(self)

    async def aclose(self) -> None:
        """Stop publishing the topic."""
        self.end()
