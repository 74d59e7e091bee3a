"""A robot inside this process, for tests and the simulation; `memory://NAME` names one.

    with Bus("office", ros=1, clock=SimulatedClock()) as bus:
        robot = bus.join("/robot")                  # a node; as many as are wanted
        face = await connect("memory://office")     # another one, as for any robot

Messages are validated and completed by their types, so errors are found as on a real middleware.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable
from copy import deepcopy
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self
from urllib.parse import urlsplit

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.clock import Clock, WallClock, within
from kg.robot.connection import (
    FAILURES,
    Accepted,
    Cancel,
    ComputationGraph,
    GraphProblem,
    Level,
    LiveEnd,
    LiveNode,
    Received,
    Value,
    goal_lost,
    reason,
)
from kg.robot.inbox import Changes, GoalProgress, Inbox
from kg.robot.messages import Types
from kg.robot.tasks import spawn


@dataclass(slots=True)
class Topic:
    """The two sides of a topic; the first end sets the type."""

    kind: str
    publications: list[MemoryPublication] = field(default_factory=list)
    subscriptions: list[MemorySubscription] = field(default_factory=list)


class MemorySubscription(Inbox[Received]):
    """The messages of a topic."""

    def __init__(self, owner: MemoryConnection, topic: str, kind: str, queue: int) -> None:
        super().__init__(queue, self._leave)
        self.kind = kind
        self._owner = owner
        self.node = owner.name
        self._topic = topic

    def _leave(self) -> None:
        side = self._owner.bus.topics[self._topic]
        side.subscriptions = [one for one in side.subscriptions if one is not self]
        self._owner.bus.changes.notify()


class MemoryPublication:
    """A topic that a node publishes."""

    def __init__(self, owner: MemoryConnection, topic: str, kind: str, *, latch: bool) -> None:
        self.kind = kind
        self.last: Received | None = None
        self._owner = owner
        self.node = owner.name
        self.types = owner.types
        self._topic = topic
        self._latch = latch

    @property
    def peers(self) -> int:
        """Number of connected subscribers."""
        return len(self._side.subscriptions)

    @property
    def confirmed(self) -> bool:
        """Whether all messages were received: subscribers get them at once."""
        return True

    @property
    def _side(self) -> Topic:
        return self._owner.bus.topics[self._topic]

    async def publish(self, value: Value) -> None:
        """Publish a message; RobotError KG805 if the value does not fit the type, KG803 if the robot is lost."""
        self._owner.present()
        if self not in self._side.publications:
            raise RobotError("KG803", f"`{self._topic}` is not offered any more")
        complete = self._owner.types.complete(self.kind, value)
        sent = Received(complete, self._owner.clock.now(), self.node, self._latch)
        if self._latch:
            self.last = sent
        for reader in self._side.subscriptions:  # copies, as over a network: a reader may change what it gets
            reader.put(replace(sent, value=deepcopy(sent.value)))
        await asyncio.sleep(0)

    async def aclose(self) -> None:
        """Stop publishing the topic."""
        self._side.publications = [one for one in self._side.publications if one is not self]
        self._owner.bus.changes.notify()


class Service:
    """A service that a node serves."""

    def __init__(
        self, owner: MemoryConnection, name: str, kind: str, answer: Callable[[Value], Awaitable[Value]]
    ) -> None:
        self.kind = kind
        self._owner = owner
        self.node = owner.name
        self._name = name
        self._answer = answer
        self._running: set[asyncio.Future[Value]] = set()

    async def call(self, request: Value) -> Value:
        """Return the response; RobotError KG808 if the server failed, KG803 if it was lost."""
        work = asyncio.ensure_future(self._respond(request))
        self._running.add(work)
        try:
            return await asyncio.shield(work)
        except asyncio.CancelledError:
            if not work.cancelled():
                raise  # the client gave up; the server continues
            raise RobotError("KG803", f"`{self.node}` was lost while it answered `{self._name}`") from None
        finally:
            work.add_done_callback(self._running.discard)

    async def _respond(self, request: Value) -> Value:
        types = self._owner.types
        try:
            return types.complete(f"{self.kind}_Response", await self._answer(request))
        except FAILURES as error:
            raise RobotError("KG808", f"`{self._name}` failed: {reason(error)}") from None

    def end(self) -> None:
        """Stop serving; waiting clients get an error."""
        for work in self._running:
            work.cancel()
        if self._owner.bus.services.get(self._name) is self:
            del self._owner.bus.services[self._name]


class MemoryGoal(GoalProgress):
    """The client's side of a goal."""

    def __init__(self, client: MemoryConnection, work: _Work) -> None:
        super().__init__()
        self._client = client
        self._work = work

    async def cancel(self) -> None:
        """Request cancellation of the goal."""
        self._client.present()
        self._work.cancelled = True
        await asyncio.sleep(0)


class _Work:
    """The server's side of a goal: `Accepted`."""

    def __init__(self, server: ActionServer, goal: Value, identity: str | None, client: MemoryConnection) -> None:
        self.identity = identity
        self.goal = goal
        self.cancelled = False
        self.failure: str | None = None
        self.client = MemoryGoal(client, self)
        self._server = server

    async def feedback(self, value: Value) -> None:
        """Send feedback to the client."""
        self.client.take_feedback(self._server.complete("Feedback", value))
        await asyncio.sleep(0)

    def abort(self, reason: str) -> None:
        """Record that the goal was aborted."""
        self.failure = reason


class ActionServer:
    """An action server of a node."""

    def __init__(
        self, owner: MemoryConnection, name: str, kind: str, carry_out: Callable[[Accepted], Awaitable[Value]]
    ) -> None:
        self.kind = kind
        self.clients: set[str] = set()
        self._owner = owner
        self.node = owner.name
        self._name = name
        self._carry_out = carry_out
        self._goals: deque[_Work] = deque()
        self._worker: asyncio.Task[None] | None = None

    def complete(self, name: str, value: Value) -> Value:
        """Return a message of the action, validated and completed."""
        return self._owner.types.complete(f"{self.kind}_{name}", value)

    def accept(self, client: MemoryConnection, goal: Value, identity: str | None) -> MemoryGoal:
        """Accept a goal; previous ones are cancelled."""
        work = _Work(self, goal, identity, client)
        for earlier in self._goals:
            earlier.cancelled = True
        self._goals.append(work)
        if client.name not in self.clients:
            self.clients.add(client.name)
            self._owner.bus.changes.notify()
        if self._worker is None or self._worker.done():
            self._worker = spawn(self._work(), f"carrying out {self._name}")
        return work.client

    def cancel(self, identity: str) -> None:
        """Cancel the goal of an identity."""
        for work in self._goals:
            work.cancelled = work.cancelled or work.identity == identity

    async def _work(self) -> None:
        while self._goals:
            work = self._goals[0]
            work.client.end(await self._outcome(work))
            self._goals.popleft()

    async def _outcome(self, work: _Work) -> Value | RobotError:
        try:
            result = None if work.cancelled else self.complete("Result", await self._carry_out(work))
        except FAILURES as error:
            return RobotError("KG809", f"the goal of `{self._name}` was aborted: {reason(error)}")
        if work.failure is not None:
            return RobotError("KG809", f"the goal of `{self._name}` was aborted: {work.failure}")
        if result is None or work.cancelled:
            return RobotError("KG809", f"the goal of `{self._name}` was cancelled")
        return result

    def end(self) -> None:
        """Stop executing goals; waiting clients get an error."""
        if self._worker is not None:
            self._worker.cancel()
        for work in self._goals:
            work.client.end(goal_lost(self._name, f"`{self.node}`"))
        self._goals.clear()
        if self._owner.bus.actions.get(self._name) is self:
            del self._owner.bus.actions[self._name]


class MemoryConnection:
    """A node of a bus, created by `Bus.join`."""

    def __init__(self, bus: Bus, name: str, types: Types) -> None:
        self.bus = bus
        self.ros = bus.ros
        self.address = bus.address
        self.name = name
        self.types = types
        self._lost: asyncio.Future[str] | None = None
        self._why: str | None = None
        self._left = False

    @property
    def clock(self) -> Clock:
        """The clock of the robot, shared by all nodes."""
        return self.bus.clock

    def present(self) -> None:
        """Raise RobotError KG803 if the connection is lost or closed."""
        if self._gone:
            raise RobotError("KG803", f"the robot at {self.address} is lost: {self._why or 'the connection is closed'}")

    async def graph(self) -> ComputationGraph:
        """Return the computation graph without our own node; RobotError KG802 if the connection is lost."""
        if self._gone:
            raise RobotError("KG802", f"the robot at {self.address} does not answer: {self._why or 'closed'}")
        return self.bus.graph(without=self.name)

    def changes(self) -> AsyncIterator[ComputationGraph]:
        """Yield the current graph, and again after each change; ends with the connection."""
        return self.bus.changes.values(lambda: None if self._gone else self.bus.graph(without=self.name))

    @property
    def _gone(self) -> bool:
        return self._why is not None or self._left

    async def subscribe(self, topic: str, kind: str | None = None, *, queue: int = 10) -> MemorySubscription:
        """Subscribe to a topic; RobotError KG804 or KG806 as every connection."""
        self.present()
        side = self.bus.topics.get(topic)
        if kind is None and (side is None or not (side.publications or side.subscriptions)):
            raise RobotError("KG804", f"no node reports the type of `{topic}`")
        side = self._side(topic, kind or (side.kind if side else ""))
        subscription = MemorySubscription(self, topic, side.kind, queue)
        for latched in (one.last for one in side.publications if one.last is not None):
            subscription.put(replace(latched, value=deepcopy(latched.value)))
        side.subscriptions.append(subscription)
        self.bus.changes.notify()
        return subscription

    async def advertise(self, topic: str, kind: str, *, latch: bool = False) -> MemoryPublication:
        """Advertise a topic; `latch` keeps the last message for later subscribers."""
        self.present()
        side = self._side(topic, kind)
        publication = MemoryPublication(self, topic, kind, latch=latch)
        side.publications.append(publication)
        self.bus.changes.notify()
        return publication

    def _side(self, topic: str, kind: str) -> Topic:
        side = self.bus.topics.setdefault(topic, Topic(kind))
        if not (side.publications or side.subscriptions):
            side.kind = kind
        if side.kind != kind:
            raise RobotError("KG806", f"`{topic}` is of the type {side.kind}, not {kind}")
        if not self.types.has(kind):
            publisher_types = next((one.types for one in side.publications if one.types.has(kind)), None)
            if publisher_types is not None:
                self.types.define(kind, publisher_types.definition(kind))
            self.types.fields(kind)  # raises if it is still unknown
        return side

    async def call(self, service: str, kind: str | None, request: Value, *, seconds: float) -> Value:
        """Call a service and return the response; RobotError KG803, KG807 or KG808 as every connection."""
        self.present()
        server = self.bus.services.get(service)
        if server is None:
            raise RobotError("KG807", f"no node offers `{service}`")
        if kind is not None and kind != server.kind:
            raise RobotError("KG806", f"`{service}` is of the type {server.kind}, not {kind}")
        value = self.types.complete(f"{server.kind}_Request", request)
        try:
            return await within(self.clock, seconds, server.call(value))
        except TimeoutError:
            raise RobotError("KG803", f"`{service}` did not answer within {seconds:g} s") from None

    async def send_goal(
        self, action: str, kind: str, goal: Value, *, seconds: float, identity: str | None = None
    ) -> MemoryGoal:
        """Send a goal to an action; RobotError KG807 if there is no server within some seconds."""
        self.present()
        value = self.types.complete(f"{kind}_Goal", goal)
        try:
            server = await within(self.clock, seconds, self._server(action))
        except TimeoutError:
            raise RobotError("KG807", f"no action server for `{action}`") from None
        if kind != server.kind:
            raise RobotError("KG806", f"`{action}` is of the type {server.kind}, not {kind}")
        return server.accept(self, value, identity)

    async def canceller(self, action: str) -> Cancel:
        """Return the function that cancels goals of an action."""
        self.present()

        async def cancel(identity: str) -> None:
            if server := self.bus.actions.get(action):
                server.cancel(identity)
            await asyncio.sleep(0)

        return cancel

    async def _server(self, action: str) -> ActionServer:
        with self.bus.changes.news() as news:
            while action not in self.bus.actions:
                news.clear()
                await news.wait()
            return self.bus.actions[action]

    async def serve(self, service: str, kind: str, answer: Callable[[Value], Awaitable[Value]]) -> None:
        """Serve a service; the newest of several servers is called."""
        self.present()
        self.types.fields(f"{kind}_Request")
        self.bus.services[service] = Service(self, service, kind, answer)
        self.bus.changes.notify()

    async def serve_action(self, action: str, kind: str, carry_out: Callable[[Accepted], Awaitable[Value]]) -> None:
        """Serve an action, one goal at a time."""
        self.present()
        self.types.fields(f"{kind}_Goal")
        self.bus.actions[action] = ActionServer(self, action, kind, carry_out)
        self.bus.changes.notify()

    def log(self, level: Level, message: str) -> None:
        """Do nothing: there is no log."""
        del level, message

    async def wait_lost(self) -> str:
        """Return the reason when the connection is lost; never before."""
        if self._why is not None:
            return self._why
        if self._lost is None:
            self._lost = asyncio.get_running_loop().create_future()
        return await asyncio.shield(self._lost)

    def lose(self, why: str) -> None:
        """Lose the connection, as by a broken cable: everything is closed, and waiters get the reason."""
        self._why = why
        if self._lost is not None and not self._lost.done():
            self._lost.set_result(why)
        self._leave()

    async def aclose(self) -> None:
        """Leave the graph, and close everything."""
        self._left = True
        self._leave()

    def _leave(self) -> None:
        for side in self.bus.topics.values():
            for subscription in side.subscriptions:
                if subscription.node == self.name:
                    subscription.end()
            side.publications = [one for one in side.publications if one.node != self.name]
            side.subscriptions = [one for one in side.subscriptions if one.node != self.name]
        serving: list[Service | ActionServer] = [*self.bus.services.values(), *self.bus.actions.values()]
        for served in serving:
            if served.node == self.name:
                served.end()
        if self.bus.nodes.get(self.name) is self:
            del self.bus.nodes[self.name]
        self.bus.changes.notify()


class Bus:
    """A system of nodes in this process, found by its name until it is closed.

    Args:
        name: that of `memory://NAME`.
        ros: the version of ROS whose messages are used.
        clock: the clock of all nodes, by default the wall clock.
        types: the message types of nodes that bring none.
    """

    named: ClassVar[dict[str, Bus]] = {}
    """The open ones by name."""

    def __init__(self, name: str, *, ros: int = 1, clock: Clock | None = None, types: Types | None = None) -> None:
        """Raise RobotError KG801 if another bus of that name is open."""
        if name in self.named:
            raise RobotError("KG801", f"this process already has a robot `memory://{name}`")
        self.name = name
        self.address = f"memory://{name}"
        self.ros = ros
        self.clock: Clock = clock or WallClock()
        self.types = types or Types(ros)
        self.nodes: dict[str, MemoryConnection] = {}
        self.topics: dict[str, Topic] = {}
        self.services: dict[str, Service] = {}
        self.actions: dict[str, ActionServer] = {}
        self.problems: list[GraphProblem] = []
        self.changes = Changes()
        self.named[name] = self

    def join(self, name: str, types: Types | None = None) -> MemoryConnection:
        """Join the bus as a node; like in ROS 1, a node of the same name is shut down."""
        absolute = name if name.startswith("/") else f"/{name}"
        self.cut(absolute, "another node with the same name joined")
        node = MemoryConnection(self, absolute, types or self.types)
        self.nodes[absolute] = node
        self.changes.notify()
        return node

    def cut(self, name: str, why: str) -> None:
        """Disconnect a node from outside, as a broken cable or a crash does; its connection is lost."""
        node = self.nodes.get(name)
        if node is not None:
            node.lose(why)

    def close(self) -> None:
        """Close the system: all nodes are lost, and the name is free."""
        for name in list(self.nodes):
            self.cut(name, "the system ended")
        self.named.pop(self.name, None)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def graph(self, without: str | None = None) -> ComputationGraph:
        """Return the computation graph, without the named node."""
        nodes = sorted(LiveNode(name, f"{self.address}{name}") for name in self.nodes if name != without)
        ends = {(one.name, one.role, one.node): one for one in self._ends() if one.node != without}
        return ComputationGraph(
            self.ros, tuple(nodes), tuple(ends[key] for key in sorted(ends)), tuple(sorted(self.problems))
        )

    def _ends(self) -> Iterable[LiveEnd]:
        for name, topic in self.topics.items():
            yield from (LiveEnd(one.node, Role.PUBLISHES, name, one.kind) for one in topic.publications)
            yield from (LiveEnd(one.node, Role.SUBSCRIBES, name, one.kind) for one in topic.subscriptions)
        for name, service in self.services.items():
            yield LiveEnd(service.node, Role.SERVICES, name, service.kind)
        for name, action in self.actions.items():
            yield LiveEnd(action.node, Role.ACTION_SERVERS, name, action.kind)
            yield from (LiveEnd(node, Role.ACTION_CLIENTS, name, action.kind) for node in action.clients)


async def connect(address: str, name: str, types: Types | None = None) -> MemoryConnection:
    """Join the bus of `memory://NAME` as a node; RobotError KG802 if this process has none of that name."""
    bus = Bus.named.get(urlsplit(address).netloc)
    if bus is None:
        raise RobotError("KG802", f"no robot `{address}` in this process")
    return bus.join(name, types)
