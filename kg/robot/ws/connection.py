"""A `Connection` over a bridge, for both protocols."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NoReturn

from websockets.exceptions import ConnectionClosed

from kg.errors import RobotError
from kg.robot.clock import Clock, WallClock
from kg.robot.connecting import of_robot
from kg.robot.connection import ComputationGraph, Level, Received, Value
from kg.robot.inbox import Changes, Inbox
from kg.robot.lifecycle import States
from kg.robot.tasks import Tasks, ended, first, spawn

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Coroutine

    from websockets.asyncio.client import ClientConnection

    from kg.robot.messages import Types
    from kg.robot.ws.foxglove import Foxglove
    from kg.robot.ws.rosbridge import Rosbridge


class BridgeConnection:
    """A client of a bridge, created by `connect`. Nodes of bridges count as our own: they are not in the graph."""

    def __init__(self, socket: ClientConnection, bridge: Foxglove | Rosbridge, address: str, name: str) -> None:
        self.address = address
        self.name = name
        self._socket = socket
        self.bridge = bridge
        self.clock: Clock = WallClock()  # bridges report none
        self._inboxes: dict[str, list[Inbox[Received]]] = {}
        self._offered: dict[str, _Publication] = {}
        self._changes = Changes()
        self._lost: asyncio.Future[str] = asyncio.get_running_loop().create_future()
        self._listening: dict[str, asyncio.Task[None]] = {}
        self._tasks = Tasks()
        self._closed = False
        self._states = States(self, self._changes.notify)
        bridge.deliver, bridge.changed = self._deliver, self._changes.notify
        self._receiving = spawn(self._receive(), f"receiving from {address}")

    async def begin(self) -> None:
        """Return when the bridge has reported its topics; RobotError KG802 if it does not bridge ROS, or is gone."""

        async def lost() -> None:
            raise RobotError("KG802", f"{self.address} {await self.wait_lost()}")

        await first(self.bridge.begin(), lost())

    @property
    def ros(self) -> int:
        """The version of the bridged ROS."""
        return self.bridge.types.ros

    @property
    def types(self) -> Types:
        """The known message types."""
        return self.bridge.types

    async def _receive(self) -> None:
        why = "has closed the connection"
        try:
            async for message in self._socket:
                self.bridge.take(message)
        except ConnectionClosed as error:
            why = f"was lost: {error}"
        except RobotError as error:
            why = f"breaks the protocol: {error.message}"
        finally:
            self._lost.set_result(why)
            self.bridge.lose(RobotError("KG803", f"the bridge at {self.address} {why}"))
            for inbox in [one for each in self._inboxes.values() for one in each]:
                inbox.end()
            self._changes.notify()

    def present(self) -> None:
        """Raise RobotError KG803 if the connection is lost or closed."""
        if self._closed or self._lost.done():
            why = self._lost.result() if self._lost.done() and not self._closed else "is not connected any more"
            raise RobotError("KG803", f"the bridge at {self.address} {why}")

    async def graph(self) -> ComputationGraph:
        """Return the computation graph without nodes of bridges; RobotError KG802 if the bridge is lost."""
        if self._closed or self._lost.done():
            raise RobotError("KG802", f"the bridge at {self.address} is not connected any more")
        self._now()
        await self._states.wait_polled()
        return self._now()

    def _now(self) -> ComputationGraph:
        return self._states.of(of_robot(self.bridge.graph()))

    def changes(self) -> AsyncIterator[ComputationGraph]:
        """Yield the current graph, and again after each change; ends with the connection."""
        return self._changes.values(lambda: None if self._closed or self._lost.done() else self._now())

    async def subscribe(self, topic: str, kind: str | None = None, *, queue: int = 10) -> Inbox[Received]:
        """Subscribe to a topic; RobotError KG804 or KG806 as every connection.

        A bridge sends each topic once: of two subscriptions, only the first gets a message latched before.
        """
        self.present()
        learned = await self.bridge.know(topic, kind)
        inbox: Inbox[Received] = Inbox(queue, lambda: self._leave(topic, inbox))
        others = self._inboxes.setdefault(topic, [])
        others.append(inbox)
        if len(others) == 1:
            self._listening[topic] = spawn(_unless_lost(self.bridge.listen(topic, learned)), f"listening to `{topic}`")
            await asyncio.sleep(0)  # its first message is already in transit
        return inbox

    def _leave(self, topic: str, inbox: Inbox[Received]) -> None:
        inboxes = self._inboxes.get(topic, [])
        if inbox in inboxes:
            inboxes.remove(inbox)
            if not inboxes:
                del self._inboxes[topic]
                self._listening.pop(topic).cancel()
                self._tasks.spawn(_unless_lost(self.bridge.leave(topic)), f"leaving `{topic}`")

    def _deliver(self, topic: str, value: Value) -> None:
        for inbox in self._inboxes.get(topic, ()):
            inbox.put(Received(value, self.clock.now()))

    async def advertise(self, topic: str, kind: str, *, latch: bool = False) -> _Publication:
        """Advertise a topic; RobotError KG804 for an unknown type, KG852 if the bridge accepts no messages."""
        self.present()
        self.types.fields(kind)
        publication = self._offered.get(topic)
        if publication is None:
            await self.bridge.offer(topic, kind, latch=latch)
            publication = self._offered[topic] = _Publication(self, topic, kind)
        elif publication.kind != kind:
            raise RobotError("KG806", f"`{topic}` is of the type {publication.kind}, not {kind}")
        publication.users += 1
        return publication

    async def withdraw(self, topic: str) -> None:
        """Stop publishing a topic."""
        del self._offered[topic]
        with suppress(ConnectionClosed):
            await self.bridge.withdraw(topic)

    def count_subscribers(self, topic: str) -> int:
        """Return the number of subscribers of a topic."""
        return 0 if self._lost.done() else self.bridge.count_subscribers(topic)

    async def call(self, service: str, kind: str | None, request: Value, *, seconds: float) -> Value:
        """Call a service and return the response; RobotError KG803, KG806 to KG808 as every connection."""
        self.present()
        try:
            return await asyncio.wait_for(self.bridge.call(service, kind, request), seconds)
        except TimeoutError:
            raise RobotError("KG803", f"`{service}` did not answer within {seconds:g} s") from None
        except ConnectionClosed:
            raise RobotError("KG803", f"the bridge at {self.address} is lost") from None

    async def _impossible(self, *_given: Any, **_options: Any) -> NoReturn:
        """Raise RobotError KG852: bridges support topics and services only."""
        raise RobotError("KG852", f"{self.address} is a bridge; kg cannot send goals or offer services over it")

    send_goal = canceller = serve = serve_action = _impossible

    def log(self, level: Level, message: str) -> None:
        """Do nothing: bridges have no log."""
        del level, message

    async def wait_lost(self) -> str:
        """Return the reason when the connection is lost; never before."""
        return await asyncio.shield(self._lost)

    async def aclose(self) -> None:
        """Disconnect; the bridge then withdraws our topics."""
        if self._closed:
            return
        self._closed = True
        self._states.close()
        await ended(*self._listening.values())
        await self._tasks.done()
        for inbox in [one for each in self._inboxes.values() for one in each]:
            inbox.end()
        await self._socket.close()
        await asyncio.wait((self._receiving,))


async def _unless_lost(work: Coroutine[Any, Any, None]) -> None:
    """Send a notification to a server, ignoring a lost connection."""
    with suppress(ConnectionClosed):
        await work


class _Publication:
    """A topic that this client publishes, shared by all its uses."""

    def __init__(self, connection: BridgeConnection, topic: str, kind: str) -> None:
        self.topic = topic
        self.kind = kind
        self.users = 0
        self._connection = connection

    @property
    def peers(self) -> int:
        """Number of subscribers."""
        return self._connection.count_subscribers(self.topic)

    @property
    def confirmed(self) -> bool:
        """Whether messages arrived: bridges do not report it."""
        return False

    async def publish(self, value: Value) -> None:
        """Publish a message; RobotError KG803, KG805."""
        self._connection.present()
        try:
            await self._connection.bridge.send(self.topic, self.kind, value)
        except ConnectionClosed:
            raise RobotError("KG803", f"the bridge at {self._connection.address} is lost") from None

    async def aclose(self) -> None:
        """Stop publishing the topic."""
        self.users -= 1
        if self.users == 0:
            await self._connection.withdraw(self.topic)
