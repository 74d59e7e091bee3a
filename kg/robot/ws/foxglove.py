"""Client of the Foxglove WebSocket protocol (github.com/foxglove/ws-protocol, docs/spec.md, version 1).

Messages are the bytes of ROS 1 (`ros1`) or ROS 2 (`cdr`); the server provides definitions of types.
"""

from __future__ import annotations

import asyncio
import json
import struct
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from websockets.typing import Subprotocol

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connection import ComputationGraph, GraphProblem, LiveEnd, LiveNode, Value
from kg.robot.messages.types import learn, short
from kg.robot.ws.bridge import Bridge, Send

if TYPE_CHECKING:
    from kg.robot.messages import Types

SUBPROTOCOLS: Final = [Subprotocol("foxglove.sdk.v1"), Subprotocol("foxglove.websocket.v1")]
UNKNOWN: Final = "/_bridged"
"""Placeholder node if the bridge does not report the publishers."""
_UNNAMED: Final = "the bridge does not report nodes"
_ENCODINGS: Final = {"ros1": 1, "cdr": 2}
_MESSAGE: Final = struct.Struct("<BIQ")
_CALL: Final = struct.Struct("<BIII")
_SENT: Final = struct.Struct("<BI")
_GRAPH: Final = {
    "publishedTopics": ("publisherIds", Role.PUBLISHES),
    "subscribedTopics": ("subscriberIds", Role.SUBSCRIBES),
    "advertisedServices": ("providerIds", Role.SERVICES),
}
_QUIET: Final = 0.3  # seconds without news after which the list of channels is complete: it has no end marker


class Foxglove(Bridge):
    """A client of `foxglove_bridge`, or of another server with ROS topics."""

    def __init__(self, send: Send, types: Types | None) -> None:
        super().__init__(send, types)
        self._capabilities: set[str] = set()
        self._channels: dict[int, dict[str, Any]] = {}
        self._services: dict[int, dict[str, Any]] = {}
        self._ends: dict[tuple[Role, str], tuple[str, ...]] = {}
        self._topics: dict[int, str] = {}
        self._offered: dict[str, int] = {}
        self._news = asyncio.Event()

    async def begin(self) -> None:
        """Return when the bridged ROS is known; RobotError KG802 if there is none."""
        while not self._capabilities and self._types is None:
            await self._more()
        if "connectionGraph" in self._capabilities:
            await self._send_op("subscribeConnectionGraph")
        with suppress(TimeoutError):
            while True:
                await asyncio.wait_for(self._more(), _QUIET)
        if self._types is None:
            raise RobotError("KG802", "the bridge offers no messages of ROS 1 or ROS 2")

    async def _more(self) -> None:
        self._news.clear()
        await self._news.wait()

    def _take(self, message: str | bytes) -> None:
        if isinstance(message, bytes):
            self._take_bytes(message)
        else:
            self._take_object(json.loads(message))

    def _take_object(self, message: dict[str, Any]) -> None:
        match message["op"]:
            case "serverInfo":
                self._capabilities = {*message["capabilities"], "serverInfo"}
                self._decide(*(message.get("supportedEncodings") or ()))
            case "advertise":
                for one in message["channels"]:
                    self._channels[one["id"]] = one
                    self._decide(one["encoding"])
            case "unadvertise":
                for number in message["channelIds"]:
                    self._channels.pop(number, None)
            case "advertiseServices":
                self._services.update({one["id"]: one for one in message["services"]})
            case "unadvertiseServices":
                for number in message["serviceIds"]:
                    self._services.pop(number, None)
            case "connectionGraphUpdate":
                self._take_graph(message)
            case "serviceCallFailure":
                self._answer(message["callId"], RobotError("KG808", f"the bridge reports: {message['message']}"))
            case "status" if message["level"] > 0:
                self._report(GraphProblem("KG810", "the bridge", str(message["message"])[:500]))
        self._news.set()
        self.changed()

    def _decide(self, *encodings: str) -> None:
        """Set the version of ROS by the first ROS encoding."""
        for one in encodings:
            if self._types is None and one in _ENCODINGS:
                self._bridges(_ENCODINGS[one])

    def _take_graph(self, message: dict[str, Any]) -> None:
        for key, (field, role) in _GRAPH.items():
            for one in message.get(key, ()):
                self._ends[role, one["name"]] = tuple(one[field])
        for name in message.get("removedTopics", ()):
            self._ends.pop((Role.PUBLISHES, name), None)
            self._ends.pop((Role.SUBSCRIBES, name), None)
        for name in message.get("removedServices", ()):
            self._ends.pop((Role.SERVICES, name), None)

    def _take_bytes(self, content: bytes) -> None:
        if content[0] == 1:
            _, number, _ = _MESSAGE.unpack_from(content)
            topic = self._topics.get(number)
            if topic is not None:
                self._take_message(topic, content[_MESSAGE.size :])
        elif content[0] == 3:  # noqa: PLR2004 - the response of a service
            _, _, call, length = _CALL.unpack_from(content)
            self._answer(call, content[_CALL.size + length :])

    def _take_message(self, topic: str, content: bytes) -> None:
        try:
            value = self.types.decode(self._listening[topic], content)
        except RobotError as error:
            self._report(GraphProblem(error.code, topic, error.message))
            return
        self.deliver(topic, value)

    def graph(self) -> ComputationGraph:
        """Return the last reported graph; without one, a placeholder node publishes and serves everything."""
        ends = [
            LiveEnd(node, role, name, self._kind(role, name))
            for (role, name), nodes in self._ends.items()
            for node in nodes
        ]
        if "connectionGraph" not in self._capabilities:
            topics = {one["topic"] for one in self._channels.values()}
            ends = [LiveEnd(UNKNOWN, Role.PUBLISHES, one, self._kind(Role.PUBLISHES, one)) for one in topics]
            services = {one["name"] for one in self._services.values()}
            ends += [LiveEnd(UNKNOWN, Role.SERVICES, one, self._kind(Role.SERVICES, one)) for one in services]
        names = sorted({one.node for one in ends})
        return self._graph_of((LiveNode(one, None, _UNNAMED if one == UNKNOWN else None) for one in names), ends)

    def _kind(self, role: Role, name: str) -> str | None:
        if role is Role.SERVICES:
            return next((short(one["type"]) for one in self._services.values() if one["name"] == name), None)
        return next((short(one["schemaName"]) for one in self._channels.values() if one["topic"] == name), None)

    async def know(self, topic: str, kind: str | None) -> str:
        """Return the type of a topic, and learn it from the server."""
        channel = next((one for one in self._channels.values() if one["topic"] == topic), None)
        if channel is None and kind is None:
            raise RobotError("KG804", f"the bridge does not offer `{topic}`, so its type is unknown")
        if channel is None:
            self.types.fields(kind or "")
            return kind or ""
        type_name = short(channel["schemaName"])
        if kind is not None and type_name != kind:
            raise RobotError("KG806", f"`{topic}` is of the type {type_name}, not {kind}")
        if channel["encoding"] not in _ENCODINGS:
            raise RobotError("KG804", f"`{topic}` is encoded as {channel['encoding']}, which is none of ROS")
        if channel.get("schema"):
            learn(self.types, type_name, channel["schema"], idl=channel.get("schemaEncoding") in {"ros2idl", "omgidl"})
        self.types.fields(type_name)
        return type_name

    async def listen(self, topic: str, kind: str) -> None:
        """Subscribe to each current and future channel of a topic."""
        self._listening[topic] = kind
        subscribed: set[int] = set()
        while True:
            offered = {key for key, one in self._channels.items() if one["topic"] == topic}
            for channel in sorted(offered - subscribed):
                number = next(self._numbers)
                self._topics[number] = topic
                await self._send_op("subscribe", subscriptions=[{"id": number, "channelId": channel}])
            subscribed = offered
            await self._more()

    async def leave(self, topic: str) -> None:
        """Unsubscribe."""
        numbers = [number for number, one in self._topics.items() if one == topic]
        for number in numbers:
            del self._topics[number]
        await self._send_op("unsubscribe", subscriptionIds=numbers)

    async def offer(self, topic: str, kind: str, *, latch: bool) -> None:  # noqa: ARG002 - the protocol has none
        """Advertise a channel; RobotError KG852 if the server accepts none."""
        if "clientPublish" not in self._capabilities:
            raise RobotError("KG852", f"the bridge takes no messages, so that `{topic}` cannot be published")
        number = self._offered[topic] = next(self._numbers)
        encoding = "ros1" if self.types.ros == 1 else "cdr"
        channel = {"id": number, "topic": topic, "encoding": encoding, "schemaName": self._full(kind)}
        await self._send_op("advertise", channels=[channel])

    async def send(self, topic: str, kind: str, value: Value) -> None:
        """Publish a message."""
        await self._send(_SENT.pack(1, self._offered[topic]) + self.types.encode(kind, value))

    async def withdraw(self, topic: str) -> None:
        """Withdraw our channel."""
        await self._send_op("unadvertise", channelIds=[self._offered.pop(topic)])

    async def call(self, service: str, kind: str | None, request: Value) -> Value:
        """Call a service and return the response."""
        advertised = next((one for one in self._services.values() if one["name"] == service), None)
        if advertised is None:
            raise RobotError("KG807", f"the bridge offers no service `{service}`")
        type_name = short(advertised["type"])
        if kind is not None and kind != type_name:
            raise RobotError("KG806", f"`{service}` is of the type {type_name}, not {kind}")
        for part in ("request", "response"):
            text = (advertised.get(part) or {}).get("schema") or advertised.get(f"{part}Schema")
            if text:
                learn(self.types, f"{type_name}_{part.capitalize()}", text)
        content = self.types.encode(f"{type_name}_Request", request)
        encoding = b"ros1" if self.types.ros == 1 else b"cdr"
        number = next(self._numbers)
        asking = self._send(_CALL.pack(2, advertised["id"], number, len(encoding)) + encoding + content)
        return self.types.decode(f"{type_name}_Response", await self._answered(number, asking))

    def count_subscribers(self, topic: str) -> int:
        """Return the number of subscribers of a topic, 1 if the server does not report it."""
        if "connectionGraph" not in self._capabilities:
            return 1
        return super().count_subscribers(topic)

    def lose(self, error: RobotError) -> None:
        """Fail pending calls, and those to removed services."""
        super().lose(error)
        self._news.set()
