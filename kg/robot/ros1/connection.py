"""A connection to a ROS 1 system: our node, with the interface of `kg.robot.connection.Connection`."""

from __future__ import annotations

import asyncio
import secrets
from typing import TYPE_CHECKING, Any, Final, TypeVar
from urllib.parse import urlsplit
from uuid import uuid4

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.clock import Clock, SimulatedClock, WallClock, stamp, within
from kg.robot.messages import Types
from kg.robot.ros1.actions import ActionClient, ActionServer, Ros1Goal, canceller
from kg.robot.ros1.graph import Analyzer, system_state, topic_types
from kg.robot.ros1.names import absolute, netloc
from kg.robot.ros1.node import Node
from kg.robot.ros1.services import call_service, probe
from kg.robot.ros1.topics import Offer, Ros1Publication, Ros1Subscription, open_topic
from kg.robot.ros1.xmlrpc import ask
from kg.robot.tasks import ended

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Mapping

    from kg.robot.connection import Accepted, Cancel, ComputationGraph, Level, Value

Result = TypeVar("Result")
_LEVELS: Final[Mapping[Level, int]] = {"info": 2, "warning": 4, "error": 8}  # constants of rosgraph_msgs/Log

_PORT: Final = 11311
_TICKING: Final = 2.0  # seconds to wait for a time on the topic `/clock`


async def connect(address: str, name: str, types: Types | None) -> Ros1Connection:
    """Join the system with the master at `ros1://HOST:PORT` as a node; see `kg.robot.connecting.connect`.

    If the name of the node is taken, it gets a suffix. With `/use_sim_time`, the clock is that of the topic `/clock`.
    """
    master = _master(address)
    try:
        await ask(master, "getPid", name)
        wanted = await _free(master, absolute(name))
        simulated = await _parameter(master, wanted, "/use_sim_time") is True
    except RobotError as error:
        if error.code == "KG812":
            raise
        raise RobotError("KG802", f"no master of ROS 1 answers at {address}: {error.message}") from None
    node = Node(master, wanted, types or Types(1), SimulatedClock() if simulated else WallClock())
    connection = Ros1Connection(node, address)
    try:
        await node.start()
        await connection.open_log()
        if simulated:
            await connection.follow_clock()
    except (RobotError, OSError, asyncio.CancelledError):
        await node.aclose()
        raise
    return connection


def _master(address: str) -> str:
    try:
        parts = urlsplit(address)
        host, port = parts.hostname, parts.port or _PORT
    except ValueError:
        host, port = None, 0
    if not host:
        raise RobotError("KG801", f"`{address}` is not an address of a master", hint="Write ros1://HOST:PORT.")
    return f"http://{netloc(host, port)}/"


async def _free(master: str, name: str) -> str:
    """Return an unused name, since the master would shut down a node of the same name."""
    try:
        await ask(await ask(master, "lookupNode", name, name), "getPid", name, seconds=1.0)
    except RobotError:
        return name
    return f"{name}_{secrets.token_hex(4)}"


async def _parameter(master: str, caller: str, name: str) -> Any:
    try:
        return await ask(master, "getParam", caller, name)
    except RobotError as error:
        if error.code != "KG813":
            raise
        return None


class Ros1Connection:
    """Our node in a ROS 1 system, with the methods of `kg.robot.connection.Connection`."""

    ros = 1

    def __init__(self, node: Node, address: str) -> None:
        self.node = node
        self.address = address
        self.name = node.name
        self.clock: Clock = node.clock
        self.types = node.types
        self._log: Offer | None = None
        self._analyzer = Analyzer(node)
        self._clients: dict[tuple[str, str], ActionClient] = {}
        self._opening = asyncio.Lock()

    async def graph(self) -> ComputationGraph:
        """Return the computation graph without our own node; RobotError KG802 if the master does not answer."""
        self.node.present()
        try:
            return await self._analyzer.read()
        except RobotError as error:
            raise RobotError("KG802", f"the master did not report the graph: {error.message}") from None

    def changes(self) -> AsyncIterator[ComputationGraph]:
        """Yield the current graph, and again after each change."""
        return Analyzer(self.node).changes()

    async def subscribe(self, topic: str, kind: str | None = None, *, queue: int = 10) -> Ros1Subscription:
        """Subscribe to a topic; without `kind`, its type is looked up."""
        self.node.present()
        topic = absolute(topic)
        published = (await topic_types(self.node.master, self.name))[0].get(topic)
        if kind is not None and published not in {None, kind}:
            raise RobotError("KG806", f"`{topic}` has the type {published}, not {kind}")
        kind = kind or published
        if kind is None:
            raise RobotError(
                "KG804", f"no node reports the type of `{topic}`", hint="Start the node that publishes it."
            )
        if not self.types.has(kind):
            await self._learn(topic, kind)
        subscription = Ros1Subscription(self.node, topic, kind, queue)
        await self.node.join(subscription)
        return subscription

    async def advertise(self, topic: str, kind: str, *, latch: bool = False) -> Ros1Publication:
        """Advertise a topic; `latch` keeps the last message for later subscribers."""
        self.node.present()
        offer = await self.node.offer(absolute(topic), kind)
        offer.latch = offer.latch or latch
        return Ros1Publication(self.node, offer)

    async def open_log(self) -> None:
        """Publish the log, as every node does."""
        self._log = await self.node.offer("/rosout", "rosgraph_msgs/Log")

    def log(self, level: Level, message: str) -> None:
        """Write a line to the log of the robot, the topic `/rosout`."""
        line = {
            "header": {"stamp": stamp(self.clock.now())},
            "level": _LEVELS[level],
            "name": self.name,
            "msg": message,
        }
        if self._log is not None:
            self._log.put(line)

    async def call(self, service: str, kind: str | None, request: Value, *, seconds: float) -> Value:
        """Call a service and return the response."""
        self.node.present()
        service = absolute(service)

        async def work() -> Value:
            try:
                uri = await self.node.ask("lookupService", service)
            except RobotError as error:
                if error.code != "KG813":
                    raise
                raise RobotError("KG807", f"no node offers `{service}`") from None
            sort = kind or await probe(self.name, uri, service)
            return await call_service(self.node, uri, service, sort, request)

        return await self._in_time(work(), seconds, RobotError("KG803", f"`{service}` did not answer in {seconds:g} s"))

    async def send_goal(
        self, action: str, kind: str, goal: Value, *, seconds: float, identity: str | None = None
    ) -> Ros1Goal:
        """Send a goal to an action."""
        self.node.present()
        action = absolute(action)
        self.types.encode(f"{kind}_Goal", goal)
        began = self.clock.now()
        client = await self._client(action, kind)
        nobody = RobotError("KG807", f"no action server for `{action}`")
        await self._in_time(client.ready(), seconds, nobody)
        left = max(seconds - (self.clock.now() - began), 1.0)
        silent = RobotError("KG803", f"`{action}` did not accept the goal within {seconds:g} s")
        return await self._in_time(client.send(goal, identity or uuid4().hex), left, silent)

    async def canceller(self, action: str) -> Cancel:
        """Return the function that cancels goals of an action."""
        return await canceller(self, action)

    async def _client(self, action: str, kind: str) -> ActionClient:
        """Return our client of an action, shared by all its goals."""
        async with self._opening:
            if (action, kind) not in self._clients:
                client = ActionClient(self, action, kind)
                await client.open()
                self._clients[action, kind] = client
            return self._clients[action, kind]

    async def serve(self, service: str, kind: str, answer: Callable[[Value], Awaitable[Value]]) -> None:
        """Serve a service; an exception of `answer` is reported to the client as a failure."""
        self.node.present()
        await self.node.serve(absolute(service), kind, answer)

    async def serve_action(self, action: str, kind: str, carry_out: Callable[[Accepted], Awaitable[Value]]) -> None:
        """Serve an action, one goal at a time."""
        self.node.present()
        await ActionServer(self, absolute(action), kind, carry_out).open()

    async def parameter_names(self) -> list[str]:
        """Return the names of all parameters of the parameter server; RobotError as `http.ask`."""
        reply = await self.node.ask("getParamNames")
        if not isinstance(reply, list):
            raise RobotError("KG810", "the master answers `getParamNames` with no list")
        return [one for one in reply if isinstance(one, str)]

    async def parameter(self, name: str) -> Any:
        """Return a parameter of the parameter server, None if it is not set; RobotError as `http.ask`."""
        return await _parameter(self.node.master, self.name, absolute(name))

    async def set_parameter(self, name: str, value: Any) -> None:
        """Set a parameter; RobotError KG805 for a value that XML-RPC cannot encode, and those of `http.ask`."""
        await self.node.ask("setParam", absolute(name), value)

    async def wait_lost(self) -> str:
        """Return the reason when the connection is lost; never before."""
        return await asyncio.shield(self.node.lost)

    async def aclose(self) -> None:
        """Leave the graph, and close everything."""
        await self.node.aclose()

    async def follow_clock(self) -> None:
        """Use the time of the topic `/clock`."""
        if isinstance(self.clock, SimulatedClock):
            ticks = await self.subscribe("/clock", "rosgraph_msgs/Clock", queue=1)
            self.node.spawn(self.clock.follow(ticks), "following /clock")
            if ticks.links:  # a publisher exists
                await self.clock.begun(_TICKING)

    async def _learn(self, topic: str, kind: str) -> None:
        """Learn a type from a publisher of the topic; RobotError KG804 without one."""
        state = await system_state(self.node.master, self.name)
        for one in state.ends.get((Role.PUBLISHES, topic), ()):
            try:
                uri = await self.node.ask("lookupNode", one)
                async with open_topic(self.node, uri, topic, kind):
                    return
            except (RobotError, OSError, TimeoutError) as error:
                self.node.note(getattr(error, "code", "KG803"), one, f"`{topic}`: {error}")
        raise RobotError("KG804", f"the message type `{kind}` of `{topic}` is unknown, and no node defines it")

    async def _in_time(self, work: Coroutine[Any, Any, Result], seconds: float, late: RobotError) -> Result:
        """Return the result of work; the error, if some time of the robot has passed or its clock has stopped."""
        task = asyncio.ensure_future(within(self.clock, seconds, work))
        try:
            await asyncio.wait((task, self.node.lost), return_when=asyncio.FIRST_COMPLETED)
            if not task.done():
                self.node.present()
            return await task
        except TimeoutError:
            raise late from None
        finally:
            await ended(task)
