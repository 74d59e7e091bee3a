"""The protocol of rosbridge, version 2, as a client (rosbridge_suite, ROSBRIDGE_PROTOCOL.md), in JSON.

Which nodes, topics and types there are, services of the node `rosapi` tell, which runs beside the bridge.
"""

from __future__ import annotations

import asyncio
import json
from itertools import count
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connecting import of_robot
from kg.robot.connection import ComputationGraph, GraphProblem, LiveEnd, LiveNode
from kg.robot.messages import Types
from kg.robot.messages.foreign import learn, short
from kg.robot.ros1.graph import fold
from kg.robot.ros2.graph import computation_graph
from kg.robot.ros2.middleware import Neighbourhood
from kg.robot.ros2.names import family
from kg.robot.tasks import spawn
from kg.robot.ws.json_values import from_json, to_json

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.connection import Value
    from kg.robot.ws.bridge import Deliver, Send

__all__ = ["Rosbridge"]

_PERIOD: Final = 1.0
"""Seconds between two questions which nodes, topics and services there are."""
_WHOLE: Final = 5
"""Every so many of them each node is asked for its ends, too, which else is done where a list has changed."""
_FAILED: Final = "# failed"
"""What rosapi of ROS 2 writes in the place of a definition that it does not find begins so."""
_FIELDS: Final = {"publishing": Role.PUBLISHES, "subscribing": Role.SUBSCRIBES, "services": Role.SERVICES}


class Rosbridge:
    """A client of `rosbridge_server`, or of another server of the protocol."""

    def __init__(self, send: Send, types: Types | None) -> None:
        self.deliver: Deliver = lambda _topic, _value: None
        self.changed: Callable[[], None] = lambda: None
        self._send = send
        self._given = types
        self._types: Types | None = None
        self._topics: dict[str, str] = {}
        self._services: dict[str, str] = {}
        self._nodes: dict[str, dict[str, list[str]]] = {}
        self._listening: dict[str, str] = {}
        self._latched: dict[str, bool] = {}
        self._texts: dict[str, str] = {}
        self._calls: dict[str, asyncio.Future[Any]] = {}
        self._problems: dict[GraphProblem, None] = {}
        self._numbers = count(1)
        self._polling: asyncio.Task[None] | None = None

    @property
    def types(self) -> Types:
        """The types of the version of ROS that is bridged."""
        assert self._types is not None  # noqa: S101 - `begin` has come to its end
        return self._types

    async def begin(self) -> None:
        """Return when the graph is known; RobotError KG802 where no `rosapi` answers."""
        try:
            await self._look(whole=True)
        except RobotError as error:
            hint = "Start `rosapi` beside the bridge: rosbridge_websocket_launch.xml does."
            raise RobotError("KG802", f"rosapi does not tell what is bridged: {error.message}", hint=hint) from None
        self._polling = spawn(self._poll(), "asking rosapi")

    async def _poll(self) -> None:
        turn = 0
        while True:
            await asyncio.sleep(_PERIOD)
            turn += 1
            try:
                if await self._look(whole=turn % _WHOLE == 0):
                    self.changed()
            except RobotError as error:
                self._report(GraphProblem(error.code, "/rosapi", error.message))

    async def _look(self, *, whole: bool) -> bool:
        """Ask what there is; tell whether it has changed."""
        topics, nodes, services = await asyncio.gather(self._api("topics"), self._api("nodes"), self._api("services"))
        if self._types is None:
            ros = 2 if any("/msg/" in one for one in topics["types"]) else 1
            self._types = self._given if self._given and self._given.ros == ros else Types(ros)
        before = self._topics, self._services, self._nodes
        self._topics = dict(zip(topics["topics"], map(short, topics["types"]), strict=True))
        names, offered = set(nodes["nodes"]), set(services["services"])
        if whole or self._topics != before[0] or names != set(self._nodes) or offered != set(self._services):
            ordered = sorted(names)
            told = await asyncio.gather(*(self._api("node_details", node=one) for one in ordered))
            self._nodes = dict(zip(ordered, told, strict=True))
            new = sorted(offered - set(self._services))
            kinds = await asyncio.gather(*(self._api("service_type", service=one) for one in new))
            known = {name: kind for name, kind in self._services.items() if name in offered}
            self._services = known | {name: short(one["type"]) for name, one in zip(new, kinds, strict=True)}
        return before != (self._topics, self._services, self._nodes)

    async def _api(self, name: str, /, **arguments: Any) -> dict[str, Any]:
        told = await self._ask(f"/rosapi/{name}", arguments)
        if not isinstance(told, dict):
            raise RobotError("KG810", f"/rosapi/{name} answered {str(told)[:60]}")
        return told

    async def _ask(self, service: str, arguments: dict[str, Any]) -> Any:
        """Return what a service answers, as it is; RobotError KG808 with its words where it fails."""
        number = f"call:{next(self._numbers)}"
        waiting = self._calls[number] = asyncio.get_running_loop().create_future()
        try:
            await self._tell("call_service", id=number, service=service, args=arguments)
            return await waiting
        finally:
            del self._calls[number]

    async def _tell(self, op: str, **fields: Any) -> None:
        await self._send(json.dumps({"op": op, **fields}))

    def take(self, message: str | bytes) -> None:
        """Take what the server has sent; RobotError KG810 where that breaks the protocol."""
        try:
            told = json.loads(message)
            match told["op"]:
                case "publish" if told["topic"] in self._listening:
                    self._take_message(told["topic"], told["msg"])
                case "service_response":
                    self._answer(told)
                case "status" if told.get("level") == "error":
                    self._report(GraphProblem("KG810", "the bridge", str(told.get("msg"))[:500]))
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise RobotError("KG810", f"a message cannot be read: {error!r}") from None

    def _take_message(self, topic: str, told: Any) -> None:
        try:
            value = from_json(self.types, self._listening[topic], told)
        except (RobotError, ValueError) as error:
            self._report(GraphProblem("KG810", topic, f"a message cannot be read: {error}"))
            return
        self.deliver(topic, value)

    def _answer(self, told: dict[str, Any]) -> None:
        waiting = self._calls.get(str(told.get("id")))
        if waiting is None or waiting.done():
            return
        if told.get("result", True):
            waiting.set_result(told.get("values"))
        else:
            waiting.set_exception(RobotError("KG808", f"`{told.get('service')}` failed: {told.get('values')}"))

    def _report(self, problem: GraphProblem) -> None:
        if problem not in self._problems:
            self._problems[problem] = None
            self.changed()

    def graph(self) -> ComputationGraph:
        """Return the graph that rosapi told last."""
        ends = [
            LiveEnd(node, role, name, (self._services if role is Role.SERVICES else self._topics).get(name) or None)
            for node, told in self._nodes.items()
            for field, role in _FIELDS.items()
            for name in dict.fromkeys(told.get(field, ()))
        ]
        nodes = tuple(LiveNode(one) for one in sorted(self._nodes))
        problems = tuple(self._problems)
        if self.types.ros == 2:  # noqa: PLR2004 - the version
            return computation_graph(Neighbourhood(nodes, tuple(ends), problems), complete=True)
        ordered = sorted(fold(ends), key=lambda one: (one.name, one.role, one.node, one.type or ""))
        return ComputationGraph(1, nodes, tuple(ordered), tuple(sorted(problems)))

    async def know(self, topic: str, kind: str | None) -> str:
        """Return the type of a topic, and learn it from rosapi."""
        if topic not in self._topics:
            await self._look(whole=False)
        told = self._topics.get(topic)
        if told is None and kind is None:
            raise RobotError("KG804", f"no node has `{topic}`, so that nobody reports its type")
        if kind is not None and told not in {None, kind}:
            raise RobotError("KG806", f"`{topic}` is of the type {told}, not {kind}")
        found = told or kind or ""
        if told is not None and told not in self._texts:
            await self._learn()
            if self._texts.get(told):
                learn(self.types, told, self._texts[told])
        self.types.fields(found)
        return found

    async def _learn(self) -> None:
        """Ask for the definitions of all types of topics; a rosapi that knows them not leaves those that kg knows."""
        try:
            told = await self._api("topics_and_raw_types")
        except RobotError:
            told = {"types": [], "typedefs_full_text": []}
        for kind, text in zip(map(short, told["types"]), told["typedefs_full_text"], strict=True):
            self._texts[kind] = "" if text.startswith(_FAILED) else text
        for kind in self._topics.values():
            self._texts.setdefault(kind, "")

    async def listen(self, topic: str, kind: str) -> None:
        """Subscribe; the bridge follows publishers that come and go."""
        self._listening[topic] = kind
        await self._tell("subscribe", id=f"subscribe:{topic}", topic=topic, type=self._full(kind))

    async def leave(self, topic: str) -> None:
        """Unsubscribe."""
        self._listening.pop(topic, None)
        await self._tell("unsubscribe", id=f"subscribe:{topic}", topic=topic)

    def _full(self, kind: str) -> str:
        package, _, name = kind.partition("/")
        return kind if self.types.ros == 1 else f"{package}/{family(kind)}/{name}"

    async def offer(self, topic: str, kind: str, *, latch: bool) -> None:
        """Advertise a topic."""
        self._latched[topic] = latch
        await self._tell("advertise", id=f"advertise:{topic}", topic=topic, type=self._full(kind), latch=latch)

    async def send(self, topic: str, kind: str, value: Value) -> None:
        """Send a message."""
        # Servers take a message that does not say so for another, unlatched publisher of the topic, and warn.
        await self._tell("publish", topic=topic, msg=to_json(self.types, kind, value), latch=self._latched[topic])

    async def withdraw(self, topic: str) -> None:
        """Offer a topic no more."""
        await self._tell("unadvertise", id=f"advertise:{topic}", topic=topic)

    async def call(self, service: str, kind: str | None, request: Value) -> Value:
        """Call a service and return the response."""
        told = self._services.get(service) or short((await self._api("service_type", service=service))["type"])
        if not told:
            raise RobotError("KG807", f"no node serves `{service}`")
        if kind is not None and kind != told:
            raise RobotError("KG806", f"`{service}` is of the type {told}, not {kind}")
        answer = await self._ask(service, to_json(self.types, f"{told}_Request", request))
        return from_json(self.types, f"{told}_Response", answer or {})

    def hears(self, topic: str) -> int:
        """Return how many nodes subscribe to a topic."""
        return sum(one.name == topic and one.role is Role.SUBSCRIBES for one in of_robot(self.graph()).ends)

    def lose(self, error: RobotError) -> None:
        """Let calls fail that wait, and ask no more."""
        if self._polling is not None:
            self._polling.cancel()
        for waiting in self._calls.values():
            if not waiting.done():
                waiting.set_exception(error)
