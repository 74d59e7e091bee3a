"""Client of the rosbridge protocol, version 2 (rosbridge_suite, ROSBRIDGE_PROTOCOL.md), in JSON.

The services of the node `rosapi`, which runs with the bridge, report nodes, topics and types. In messages, arrays of
bytes are base64 texts, numbers that are not finite are null, times of ROS 1 have `secs` and `nsecs`
(`message_conversion.py`).
"""

from __future__ import annotations

import asyncio
import json
import math
from base64 import b64decode, b64encode
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connection import ComputationGraph, GraphProblem, LiveEnd, LiveNode, Value
from kg.robot.messages.types import learn, short
from kg.robot.tasks import spawn
from kg.robot.ws.bridge import Bridge, Send

if TYPE_CHECKING:
    from kg.robot.messages import Field, Types

_TIMES: Final = {"builtin_interfaces/Time", "builtin_interfaces/Duration"}
_BYTES: Final = {"uint8", "char", "octet"}
_SECONDS: Final = {1: ("secs", "nsecs"), 2: ("sec", "nanosec")}


def from_json(types: Types, kind: str, content: Any) -> Value:
    """Return the complete value of a message; RobotError KG805 if it does not fit, KG804 for an unknown type."""
    return types.complete(kind, _read(types, kind, content))


def _read(types: Types, kind: str, content: Any) -> Any:
    if not isinstance(content, dict):
        return content  # which `complete` refuses, with the field
    if kind in _TIMES:
        names = _SECONDS[1] if "secs" in content else _SECONDS[2]
        return {new: content.get(old, 0) for new, old in zip(_SECONDS[2], names, strict=True)}
    fields = {one.name: one for one in types.fields(kind)}
    return {name: _read_field(types, fields[name], one) if name in fields else one for name, one in content.items()}


def _read_field(types: Types, field: Field, content: Any) -> Any:
    if field.length is not None:
        if field.type in _BYTES and isinstance(content, str):
            return b64decode(content, validate=True)
        element = replace(field, length=None)
        return [_read_field(types, element, one) for one in content] if isinstance(content, list) else content
    if field.is_message:
        return _read(types, field.type, content)
    return math.nan if content is None and field.type.startswith("float") else content


def to_json(types: Types, kind: str, value: Value) -> dict[str, Any]:
    """Return the complete object of a message; RobotError KG805 and KG804 as `Types.complete`."""
    return _write(types, kind, types.complete(kind, value))


def _write(types: Types, kind: str, value: Value) -> dict[str, Any]:
    if kind in _TIMES:
        return dict(zip(_SECONDS[types.ros], (value["sec"], value["nanosec"]), strict=True))
    return {one.name: _write_field(types, one, value[one.name]) for one in types.fields(kind)}


def _write_field(types: Types, field: Field, value: Any) -> Any:
    if isinstance(value, bytes):
        return b64encode(value).decode()
    if field.length is not None:
        element = replace(field, length=None)
        return [_write_field(types, element, one) for one in value]
    if field.is_message:
        return _write(types, field.type, value)
    return None if isinstance(value, float) and not math.isfinite(value) else value


_PERIOD: Final = 1.0  # seconds between polls of nodes, topics and services
_WHOLE: Final = 5
"""Every so many polls, the ends of each node are requested too; otherwise only when a list has changed."""
_FAILED: Final = "# failed"
"""Prefix of the text that rosapi of ROS 2 returns instead of a missing definition."""
_FIELDS: Final = {"publishing": Role.PUBLISHES, "subscribing": Role.SUBSCRIBES, "services": Role.SERVICES}


class Rosbridge(Bridge):
    """A client of `rosbridge_server`, or of another server of the protocol."""

    def __init__(self, send: Send, types: Types | None) -> None:
        super().__init__(send, types)
        self._topics: dict[str, str] = {}
        self._services: dict[str, str] = {}
        self._nodes: dict[str, dict[str, list[str]]] = {}
        self._latched: dict[str, bool] = {}
        self._texts: dict[str, str] = {}
        self._polling: asyncio.Task[None] | None = None

    async def begin(self) -> None:
        """Return when the graph is known; RobotError KG802 if `rosapi` does not answer."""
        try:
            await self._look(whole=True)
        except RobotError as error:
            hint = "Start `rosapi` with the bridge, as rosbridge_websocket_launch.xml does."
            raise RobotError("KG802", f"rosapi does not report what is bridged: {error.message}", hint=hint) from None
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
        topics, nodes, services = await asyncio.gather(self._api("topics"), self._api("nodes"), self._api("services"))
        if self._types is None:
            self._bridges(2 if any("/msg/" in one for one in topics["types"]) else 1)
        before = self._topics, self._services, self._nodes
        self._topics = dict(zip(topics["topics"], map(short, topics["types"]), strict=True))
        names, offered = set(nodes["nodes"]), set(services["services"])
        if whole or self._topics != before[0] or names != set(self._nodes) or offered != set(self._services):
            ordered = sorted(names)
            details = await asyncio.gather(*(self._api("node_details", node=one) for one in ordered))
            self._nodes = dict(zip(ordered, details, strict=True))
            new = sorted(offered - set(self._services))
            kinds = await asyncio.gather(*(self._api("service_type", service=one) for one in new))
            remaining = {name: kind for name, kind in self._services.items() if name in offered}
            self._services = remaining | {name: short(one["type"]) for name, one in zip(new, kinds, strict=True)}
        return before != (self._topics, self._services, self._nodes)

    async def _api(self, name: str, /, **arguments: Any) -> dict[str, Any]:
        reply = await self._ask(f"/rosapi/{name}", arguments)
        if not isinstance(reply, dict):
            raise RobotError("KG810", f"/rosapi/{name} answered {str(reply)[:60]}")
        return reply

    async def _ask(self, service: str, arguments: dict[str, Any]) -> Any:
        """Return the raw response of a service; RobotError KG808 with its message on failure."""
        number = f"call:{next(self._numbers)}"
        asking = self._send_op("call_service", id=number, service=service, args=arguments)
        return await self._answered(number, asking)

    def _take(self, message: str | bytes) -> None:
        content = json.loads(message)
        match content["op"]:
            case "publish" if content["topic"] in self._listening:
                self._take_message(content["topic"], content["msg"])
            case "service_response" if content.get("result", True):
                self._answer(content.get("id"), content.get("values"))
            case "service_response":
                why = f"`{content.get('service')}` failed: {content.get('values')}"
                self._answer(content.get("id"), RobotError("KG808", why))
            case "status" if content.get("level") == "error":
                self._report(GraphProblem("KG810", "the bridge", str(content.get("msg"))[:500]))

    def _take_message(self, topic: str, content: Any) -> None:
        try:
            value = from_json(self.types, self._listening[topic], content)
        except (RobotError, ValueError) as error:
            self._report(GraphProblem("KG810", topic, f"a message cannot be read: {error}"))
            return
        self.deliver(topic, value)

    def graph(self) -> ComputationGraph:
        """Return the graph last reported by rosapi."""
        ends = [
            LiveEnd(node, role, name, (self._services if role is Role.SERVICES else self._topics).get(name) or None)
            for node, details in self._nodes.items()
            for field, role in _FIELDS.items()
            for name in dict.fromkeys(details.get(field, ()))
        ]
        return self._graph_of((LiveNode(one) for one in sorted(self._nodes)), ends)

    async def know(self, topic: str, kind: str | None) -> str:
        """Return the type of a topic, and learn it from rosapi."""
        if topic not in self._topics:
            await self._look(whole=False)
        reported = self._topics.get(topic)
        if reported is None and kind is None:
            raise RobotError("KG804", f"no node has `{topic}`, so its type is unknown")
        if kind is not None and reported not in {None, kind}:
            raise RobotError("KG806", f"`{topic}` is of the type {reported}, not {kind}")
        type_name = reported or kind or ""
        if reported is not None and reported not in self._texts:
            await self._learn()
            if self._texts.get(reported):
                learn(self.types, reported, self._texts[reported])
        self.types.fields(type_name)
        return type_name

    async def _learn(self) -> None:
        """Request the definitions of all types of topics; for those missing in rosapi, kg's own remain."""
        try:
            reply = await self._api("topics_and_raw_types")
        except RobotError:
            reply = {"types": [], "typedefs_full_text": []}
        for kind, text in zip(map(short, reply["types"]), reply["typedefs_full_text"], strict=True):
            self._texts[kind] = "" if text.startswith(_FAILED) else text
        for kind in self._topics.values():
            self._texts.setdefault(kind, "")

    async def listen(self, topic: str, kind: str) -> None:
        """Subscribe; the bridge follows changes of publishers."""
        self._listening[topic] = kind
        await self._send_op("subscribe", id=f"subscribe:{topic}", topic=topic, type=self._full(kind))

    async def leave(self, topic: str) -> None:
        """Unsubscribe."""
        self._listening.pop(topic, None)
        await self._send_op("unsubscribe", id=f"subscribe:{topic}", topic=topic)

    async def offer(self, topic: str, kind: str, *, latch: bool) -> None:
        """Advertise a topic."""
        self._latched[topic] = latch
        await self._send_op("advertise", id=f"advertise:{topic}", topic=topic, type=self._full(kind), latch=latch)

    async def send(self, topic: str, kind: str, value: Value) -> None:
        """Publish a message."""
        # Without `latch`, servers treat the message as one of a second publisher of the topic, and warn.
        await self._send_op("publish", topic=topic, msg=to_json(self.types, kind, value), latch=self._latched[topic])

    async def withdraw(self, topic: str) -> None:
        """Stop publishing a topic."""
        await self._send_op("unadvertise", id=f"advertise:{topic}", topic=topic)

    async def call(self, service: str, kind: str | None, request: Value) -> Value:
        """Call a service and return the response."""
        type_name = self._services.get(service) or short((await self._api("service_type", service=service))["type"])
        if not type_name:
            raise RobotError("KG807", f"no node offers `{service}`")
        if kind is not None and kind != type_name:
            raise RobotError("KG806", f"`{service}` is of the type {type_name}, not {kind}")
        answer = await self._ask(service, to_json(self.types, f"{type_name}_Request", request))
        return from_json(self.types, f"{type_name}_Response", answer or {})

    def lose(self, error: RobotError) -> None:
        """Fail pending calls, and stop polling."""
        if self._polling is not None:
            self._polling.cancel()
        super().lose(error)
