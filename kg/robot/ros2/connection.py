"""Our node in a ROS 2 system, over any middleware."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final, Protocol, Self
from uuid import uuid4

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.clock import Clock, SimulatedClock, WallClock, within
from kg.robot.connection import Accepted, Cancel, ComputationGraph, Goal, GraphProblem, Level, LiveEnd, Value
from kg.robot.lifecycle import States
from kg.robot.ros2.actions import ActionServer, canceller, send_goal
from kg.robot.ros2.ends import Client, Ros2Publication, Ros2Subscription, Service
from kg.robot.ros2.graph import Watch, is_hidden
from kg.robot.ros2.middleware import LATCHED, OFFERED, Middleware
from kg.robot.ros2.standard import NodeInterfaces
from kg.robot.ros2.types import describe
from kg.robot.tasks import outcome, spawn

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from kg.robot.messages import Types
    from kg.robot.ros2.address import Address


_STAYS: Final = 1.0  # seconds, once the graph is complete, after which our node offers what every node does


class _Open(Protocol):
    def end(self) -> None: ...


class Ros2Connection:
    """A `Connection` over any middleware of ROS 2.

    A ROS 2 robot has no server to lose: `wait_lost` returns when all nodes have been gone for two seconds. Open ends
    stay open, since restarted nodes are discovered again.
    """

    ros = 2

    def __init__(self, wire: Middleware, watch: Watch, address: Address, name: str) -> None:
        self.wire = wire
        self.watch = watch
        self.address = address.text
        self._settle = address.settle
        self.name = name
        self.clock: Clock = SimulatedClock() if address.simulated else WallClock()
        self._open: set[_Open] = set()
        self._clients: dict[tuple[str, str], Client] = {}
        self._adapting = spawn(self._adapt(), "following what publishers offer")
        self._ticking: asyncio.Task[None] | None = None
        self._states = States(self, watch.changed)
        self._interfaces = NodeInterfaces(self)
        self._open.add(self._interfaces)
        self._offering = spawn(self._offer_interfaces(), "serving parameters")
        watch.on_problem = lambda one: self.log("warning", f"[{one.code}] {one.subject}: {one.message}")

    @classmethod
    async def open(cls, wire: Middleware, address: Address, name: str) -> Self:
        """Return the connection of a node that has just joined; it watches the graph and the robot's clock."""
        watch = Watch(wire.neighbourhood, address.settle, address.quiet)
        wire.begin(watch)
        connection = cls(wire, watch, address, name)
        await connection.follow_clock()
        return connection

    @property
    def types(self) -> Types:
        """The known message types."""
        return self.wire.types

    async def follow_clock(self) -> None:
        """Use the time of the topic `/clock`, if the address requires it."""
        if isinstance(self.clock, SimulatedClock):
            ticks = await self.subscribe("/clock", "rosgraph_msgs/Clock", queue=1)
            self._ticking = spawn(self.clock.follow(ticks), "following /clock")
            await self.clock.begun(self._settle)

    async def _offer_interfaces(self) -> None:
        """Offer the interfaces of every node, unless ours leaves at once, as that of a short command."""
        await self.watch.wait_complete()
        await asyncio.sleep(_STAYS)
        await self._interfaces.serve()

    def log(self, level: Level, message: str) -> None:
        """Write a line to the log of the robot, the topic `/rosout`."""
        if not self.watch.closed:
            self._interfaces.log(level, message)

    async def _adapt(self) -> None:
        async def adapted(one: Ros2Subscription) -> None:
            if one in self._open:
                one.adapt()

        async for _ in self.watch.changes():
            for one in [one for one in self._open if isinstance(one, Ros2Subscription)]:
                error = await outcome(adapted(one))
                if isinstance(error, Exception):
                    self.watch.report(GraphProblem("KG803", one.topic, f"it cannot be read any more: {error}"))

    async def graph(self) -> ComputationGraph:
        """Return the computation graph without our own node, after it has been watched long enough to be complete."""
        self._present("KG802")
        self._follow_states()
        await self.watch.wait_complete()
        await self._states.wait_polled()
        return self.watch.now()

    def changes(self) -> AsyncIterator[ComputationGraph]:
        """Yield the current graph, complete or not, and again after each change."""
        self._follow_states()
        return self.watch.changes()

    def _follow_states(self) -> None:
        """Follow the states of managed nodes once the graph is read; a watchdog never reads it."""
        if self.watch.amend != self._states.of:
            self.watch.amend = self._states.of
            self.watch.changed()

    def ends(self, role: Role, name: str) -> list[LiveEnd]:
        """Return the currently known ends of others with a role and name, also those of the topics of an action."""
        ends = self.wire.neighbourhood().ends if is_hidden(name) else self.watch.now().ends
        return [one for one in ends if one.role is role and one.name == name]

    async def subscribe(self, topic: str, kind: str | None = None, *, queue: int = 10) -> Ros2Subscription:
        """Subscribe to a topic; RobotError KG804 or KG806 as every connection."""
        self._present()
        if kind is None:
            kind = await self._type_of(topic)
        types = {one.type for one in self.ends(Role.PUBLISHES, topic)} - {None}
        if types and kind not in types:
            raise RobotError("KG806", f"`{topic}` is of the type {min(map(str, types))}, not {kind}")
        await self.ensure_type(kind, kind, topic)
        subscription = Ros2Subscription(self, topic, kind, queue)
        subscription.adapt()
        self._open.add(subscription)
        return subscription

    async def _type_of(self, topic: str) -> str:
        """Return the type of a topic according to its publishers, or else its subscribers."""

        def reported() -> list[str]:
            ends = self.ends(Role.PUBLISHES, topic) or self.ends(Role.SUBSCRIBES, topic)
            return sorted(one.type for one in ends if one.type)

        await self.watch.until(lambda graph: bool(reported()) or graph.complete)
        if not reported():
            raise RobotError("KG804", f"no node reports the type of `{topic}`")
        return reported()[0]

    async def ensure_type(self, kind: str, message: str, name: str) -> None:
        """Ensure that a message type is known, asking peers if necessary; RobotError KG804 if that fails."""
        if self.types.has(message) or (await self.wire.learn(kind, name) and self.types.has(message)):
            return
        why = await describe(self, kind, name)
        if self.types.has(message):
            return
        package = kind.partition("/")[0]
        hint = f"Source a ROS 2 workspace that has the package `{package}`; kg reads its definition from there."
        because = f": {why}" if why else ""
        raise RobotError("KG804", f"the message type `{message}` is not known{because}", hint=hint)

    async def advertise(self, topic: str, kind: str, *, latch: bool = False) -> Ros2Publication:
        """Offer a topic; `latch` keeps the last message for those that come later (transient local).

        So does a subscriber that asks for it, which otherwise would get nothing.
        """
        self._present()
        await self.ensure_type(kind, kind, topic)
        requested = [one.qos for one in self.ends(Role.SUBSCRIBES, topic) if one.qos]
        is_latched = latch or any(one.durability == "transient_local" for one in requested)
        publication = Ros2Publication(self, topic, kind, LATCHED if is_latched else OFFERED)
        self._open.add(publication)
        return publication

    async def call(self, service: str, kind: str | None, request: Value, *, seconds: float) -> Value:
        """Call a service and return the response; RobotError KG803, KG807 or KG808 as every connection."""
        self._present()
        try:
            return await within(self.clock, seconds, self._called(service, kind, request))
        except TimeoutError:
            self._serving(service, kind)
            raise RobotError("KG803", f"`{service}` did not answer within {seconds:g} s") from None

    async def _called(self, service: str, kind: str | None, request: Value) -> Value:
        await self.watch.until(lambda graph: bool(self.ends(Role.SERVICES, service)) or graph.complete)
        return await (await self.client(service, self._serving(service, kind))).call(request)

    def _serving(self, service: str, kind: str | None) -> str:
        """Return the type of a service; RobotError KG807 without a server, KG806 for another type."""
        servers = self.ends(Role.SERVICES, service)
        if not servers:
            raise RobotError("KG807", f"no node offers `{service}`")
        types = {one.type for one in servers if one.type}
        if types and kind is not None and kind not in types:
            raise RobotError("KG806", f"`{service}` is of the type {min(types)}, not {kind}")
        if kind is None and not types:
            raise RobotError("KG804", f"no node reports the type of `{service}`")
        return kind or min(types)

    async def client(self, service: str, kind: str) -> Client:
        """Return our client of a service, which is reused, since its discovery by the server takes time."""
        client = self._clients.get((service, kind))
        if client is None:
            await self.ensure_type(kind, f"{kind}_Response", service)
            client = self._clients[service, kind] = Client(self.types, kind, self.wire.caller(service, kind))
            self._open.add(client)
        return client

    async def send_goal(
        self, action: str, kind: str, goal: Value, *, seconds: float, identity: str | None = None
    ) -> Goal:
        """Send a goal to an action; KG807 without a server within some seconds, KG809 if it is rejected."""
        self._present()
        return await send_goal(self, action, kind, goal, seconds=seconds, identity=identity or uuid4().hex)

    async def canceller(self, action: str) -> Cancel:
        """Return the function that cancels goals of an action."""
        self._present()
        return await canceller(self, action)

    async def serve(self, service: str, kind: str, answer: Callable[[Value], Awaitable[Value]]) -> None:
        """Serve a service; RobotError KG804 for an unknown type."""
        self._present()
        await self.ensure_type(kind, f"{kind}_Request", service)
        self._open.add(Service(self, service, kind, answer))

    async def serve_action(self, action: str, kind: str, carry_out: Callable[[Accepted], Awaitable[Value]]) -> None:
        """Serve an action, one goal at a time: a new goal cancels the previous one. `carry_out` returns the result."""
        self._present()
        await self.ensure_type(kind, f"{kind}_Goal", action)
        self._open.add(ActionServer(self, action, kind, carry_out))

    def forget(self, one: _Open) -> None:
        """Remove something that is already closed."""
        self._open.discard(one)

    def _present(self, code: str = "KG803") -> None:
        if self.watch.closed:
            raise RobotError(code, f"the connection to {self.address} is closed")

    async def wait_lost(self) -> str:
        """Return the reason when all nodes of the robot have left; never before."""
        return await asyncio.shield(self.watch.lost)

    async def aclose(self) -> None:
        """Leave the graph, and close everything."""
        if self.watch.closed:
            return
        self.watch.close()
        self._states.close()
        for task in (self._adapting, self._offering, self._ticking):
            if task is not None:
                task.cancel()
        for one in list(self._open):
            one.end()
        self._open.clear()
        self.wire.close()
        await asyncio.sleep(0)
