"""One node of a bus: a `Connection`."""

from __future__ import annotations

import asyncio
from copy import deepcopy
from typing import TYPE_CHECKING

from kg.errors import RobotError
from kg.robot.clock import within
from kg.robot.connection import Received
from kg.robot.memory.actions import ActionServer, MemoryCanceller, MemoryGoal
from kg.robot.memory.services import Service
from kg.robot.memory.topics import MemoryPublication, MemorySubscription, Topic

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from kg.robot.clock import Clock
    from kg.robot.connection import Accepted, ComputationGraph, Value
    from kg.robot.memory.bus import Bus
    from kg.robot.messages import Types

__all__ = ["MemoryConnection"]


class MemoryConnection:
    """A node of a bus; `Bus.join` makes it."""

    def __init__(self, bus: Bus, name: str, types: Types) -> None:
        self.bus = bus
        self.name = name
        self.types = types
        self._lost: asyncio.Future[str] | None = None
        self._why: str | None = None
        self._left = False

    @property
    def ros(self) -> int:
        """The version of ROS that is spoken: 1 or 2."""
        return self.bus.ros

    @property
    def address(self) -> str:
        """Where it is connected to: `memory://NAME`."""
        return self.bus.address

    @property
    def clock(self) -> Clock:
        """The time of the robot, the same for all nodes."""
        return self.bus.clock

    def present(self) -> None:
        """Raise RobotError KG803 when the connection is lost, or closed."""
        if self._why is not None or self._left:
            raise RobotError("KG803", f"the robot at {self.address} is lost: {self._why or 'the connection is closed'}")

    async def graph(self) -> ComputationGraph:
        """Return the computation graph without our own node; RobotError KG802 when the connection is lost."""
        if self._why is not None or self._left:
            raise RobotError("KG802", f"the robot at {self.address} does not answer: {self._why or 'closed'}")
        return self.bus.graph(without=self.name)

    async def changes(self) -> AsyncIterator[ComputationGraph]:
        """Yield the graph as it is, and again each time that it has changed; it ends with the connection."""
        event = self.bus.watch()
        last: ComputationGraph | None = None
        try:
            while self._why is None and not self._left:
                event.clear()
                now = self.bus.graph(without=self.name)
                if now != last:
                    yield now
                    last = now
                await event.wait()
        finally:
            self.bus.unwatch(event)

    async def subscribe(self, topic: str, kind: str | None = None, *, queue: int = 10) -> MemorySubscription:
        """Receive the messages of a topic; RobotError KG804 or KG806 as every connection."""
        self.present()
        side = self.bus.topics.get(topic)
        if kind is None and (side is None or not (side.publications or side.subscriptions)):
            raise RobotError("KG804", f"no node reports the type of `{topic}`")
        side = self._side(topic, kind or (side.kind if side else ""))
        subscription = MemorySubscription(self, topic, side.kind, queue)
        for latched in (one.last for one in side.publications if one.last is not None):
            subscription.put(Received(deepcopy(latched.value), latched.at, latched.node))
        side.subscriptions.append(subscription)
        self.bus.changed()
        return subscription

    async def advertise(self, topic: str, kind: str, *, latch: bool = False) -> MemoryPublication:
        """Offer a topic; `latch` keeps the last message for those that come later."""
        self.present()
        side = self._side(topic, kind)
        publication = MemoryPublication(self, topic, kind, latch=latch)
        side.publications.append(publication)
        self.bus.changed()
        return publication

    def _side(self, topic: str, kind: str) -> Topic:
        side = self.bus.topics.setdefault(topic, Topic(kind))
        if not (side.publications or side.subscriptions):
            side.kind = kind
        if side.kind != kind:
            raise RobotError("KG806", f"`{topic}` is of the type {side.kind}, not {kind}")
        if not self.types.knows(kind):
            self._learn(kind, side)
        return side

    def _learn(self, kind: str, side: Topic) -> None:
        for one in side.publications:
            if one.types.knows(kind):
                self.types.define(kind, one.types.definition(kind))
                return
        self.types.fields(kind)  # says that it is not known

    async def call(self, service: str, kind: str | None, request: Value, *, seconds: float) -> Value:
        """Call a service and return the response; RobotError KG803, KG807 or KG808 as every connection."""
        self.present()
        found = self.bus.services.get(service)
        if found is None:
            raise RobotError("KG807", f"no node serves `{service}`")
        if kind is not None and kind != found.kind:
            raise RobotError("KG806", f"`{service}` is of the type {found.kind}, not {kind}")
        value = self.types.complete(f"{found.kind}_Request", request)
        try:
            return await within(self.clock, seconds, found.call(value))
        except TimeoutError:
            raise RobotError("KG803", f"`{service}` did not answer within {seconds:g} s") from None

    async def send_goal(
        self, action: str, kind: str, goal: Value, *, seconds: float, identity: str | None = None
    ) -> MemoryGoal:
        """Give an action a goal; RobotError KG807 when nobody serves it within so many seconds."""
        self.present()
        value = self.types.complete(f"{kind}_Goal", goal)
        try:
            server = await within(self.clock, seconds, self._server(action))
        except TimeoutError:
            raise RobotError("KG807", f"no action server for `{action}`") from None
        if kind != server.kind:
            raise RobotError("KG806", f"`{action}` is of the type {server.kind}, not {kind}")
        return server.accept(self, value, identity)

    async def canceller(self, action: str, kind: str) -> MemoryCanceller:  # noqa: ARG002 - all actions cancel alike
        """Return what cancels goals of an action."""
        self.present()
        return MemoryCanceller(self.bus, action)

    async def _server(self, action: str) -> ActionServer:
        event = self.bus.watch()
        try:
            while action not in self.bus.actions:
                event.clear()
                await event.wait()
            return self.bus.actions[action]
        finally:
            self.bus.unwatch(event)

    async def serve(self, service: str, kind: str, answer: Callable[[Value], Awaitable[Value]]) -> Service:
        """Answer a service; the newest of several that offer it is asked."""
        self.present()
        self.types.fields(f"{kind}_Request")
        self.bus.services[service] = Service(self, service, kind, answer)
        self.bus.changed()
        return self.bus.services[service]

    async def serve_action(
        self, action: str, kind: str, carry_out: Callable[[Accepted], Awaitable[Value]]
    ) -> ActionServer:
        """Carry out goals, one at a time."""
        self.present()
        self.types.fields(f"{kind}_Goal")
        self.bus.actions[action] = ActionServer(self, action, kind, carry_out)
        self.bus.changed()
        return self.bus.actions[action]

    async def wait_lost(self) -> str:
        """Return, when the connection is lost, why; never before."""
        if self._why is not None:
            return self._why
        if self._lost is None:
            self._lost = asyncio.get_running_loop().create_future()
        return await asyncio.shield(self._lost)

    def lose(self, why: str) -> None:
        """Be lost, as by a broken cable: what was open ends, and whoever waits learns why."""
        self._why = why
        if self._lost is not None and not self._lost.done():
            self._lost.set_result(why)
        self._leave()

    async def aclose(self) -> None:
        """Leave the graph; everything that was opened is closed."""
        self._left = True
        self._leave()

    def _leave(self) -> None:
        for side in self.bus.topics.values():
            for subscription in side.subscriptions:
                if subscription.node == self.name:
                    subscription.end()
            side.publications = [one for one in side.publications if one.node != self.name]
            side.subscriptions = [one for one in side.subscriptions if one.node != self.name]
        answering: list[Service | ActionServer] = [*self.bus.services.values(), *self.bus.actions.values()]
        for served in answering:
            if served.node == self.name:
                served.end()
        if self.bus.nodes.get(self.name) is self:
            del self.bus.nodes[self.name]
        self.bus.changed()
