"""A robot behind a handwritten rosbridge, since every rosbridge server needs an installation of ROS.

It follows the text of the protocol (rosbridge_suite, ROSBRIDGE_PROTOCOL.md, version 2): the operations subscribe,
unsubscribe, advertise, unadvertise, publish and call_service, with the services of `rosapi` used by kg. Messages are
the JSON of the protocol, handwritten in tests. `roslibpy`, an independent client, connects to it in
`test_rosbridge.py`, which rules out a mistake shared by kg and this server.
"""

from __future__ import annotations

import asyncio
import json
from contextlib import contextmanager, suppress
from threading import Condition, Event, Thread
from typing import TYPE_CHECKING, Any

from patience import patient
from websockets.asyncio.server import serve

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["Peer", "peer"]


class Peer:
    """The robot: nodes with their ends, types of topics, and the data received from clients."""

    def __init__(self, ros: int) -> None:
        self.ros = ros
        self.address = ""
        self.types: dict[str, str] = {"/rosout": self.full("rosgraph_msgs/Log" if ros == 1 else "rcl_interfaces/Log")}
        self.texts: dict[str, str] = {}
        self.nodes: dict[str, dict[str, list[str]]] = {}
        self.services: dict[str, tuple[str, Callable[[dict[str, Any]], dict[str, Any]]]] = {}
        self.came: list[tuple[str, Any]] = []
        self.offered: list[tuple[str, str, bool]] = []
        self.listening: list[str] = []
        self.rosapi = True
        self._clients: dict[Any, set[str]] = {}
        self._news = Condition()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._end: asyncio.Event | None = None

    def full(self, kind: str) -> str:
        """Return the name of a type in this version of ROS."""
        return kind if self.ros == 1 else kind.replace("/", "/msg/")

    def node(
        self, name: str, publishing: dict[str, str] | None = None, subscribing: dict[str, str] | None = None
    ) -> None:
        """Run a node that publishes and subscribes to topics of types."""
        topics = {**(publishing or {}), **(subscribing or {})}
        self.types |= {topic: self.full(kind) for topic, kind in topics.items()}
        self.nodes[name] = {
            "publishing": list(publishing or ()),
            "subscribing": list(subscribing or ()),
            "services": [],
        }

    def publish(self, topic: str, message: dict[str, Any]) -> None:
        """Send a message to its subscribers."""
        assert self._loop is not None
        asyncio.run_coroutine_threadsafe(self._publish(topic, message), self._loop).result(patient(5))

    async def _publish(self, topic: str, message: dict[str, Any]) -> None:
        text = json.dumps({"op": "publish", "topic": topic, "msg": message})
        for client, topics in list(self._clients.items()):
            if topic in topics:
                await client.send(text)

    def say(self, text: str) -> None:
        """Send other data to all clients."""
        assert self._loop is not None
        for client in list(self._clients):
            asyncio.run_coroutine_threadsafe(client.send(text), self._loop).result(patient(5))

    def until(self, true: Callable[[], bool]) -> None:
        """Return when a condition holds, which data from clients may fulfil."""
        with self._news:
            assert self._news.wait_for(true, patient(5)), self.came

    async def _handle(self, client: Any) -> None:
        self._clients[client] = set()
        try:
            async for text in client:
                asked = json.loads(text)
                answer = self._take(client, asked)
                if answer is not None:
                    await client.send(json.dumps(answer))
        finally:
            with self._news:
                for topic in self._clients.pop(client):
                    self.listening.remove(topic)

    def _take(self, client: Any, asked: dict[str, Any]) -> dict[str, Any] | None:
        with self._news:
            self._news.notify_all()
            match asked["op"]:
                case "subscribe":
                    self._clients[client].add(asked["topic"])
                    self.listening.append(asked["topic"])
                case "unsubscribe":
                    self._clients[client].discard(asked["topic"])
                    self.listening.remove(asked["topic"])
                case "advertise":
                    self.offered.append((asked["topic"], asked["type"], asked.get("latch", False)))
                case "unadvertise":
                    self.offered = [one for one in self.offered if one[0] != asked["topic"]]
                case "publish":
                    self.came.append((asked["topic"], asked["msg"]))
                case "call_service":
                    return self._call(asked)
        return None

    def _call(self, asked: dict[str, Any]) -> dict[str, Any] | None:
        service = asked["service"]
        answer = {"op": "service_response", "id": asked.get("id"), "service": service, "result": True}
        try:
            if service.startswith("/rosapi/"):
                return {**answer, "values": self._tell(service, asked.get("args") or {})} if self.rosapi else None
            return {**answer, "values": self.services[service][1](asked.get("args") or {})}
        except (KeyError, ValueError) as error:
            return {**answer, "result": False, "values": str(error)}

    def _tell(self, service: str, given: dict[str, Any]) -> dict[str, Any]:
        types = {"topics": list(self.types), "types": list(self.types.values())}
        match service.removeprefix("/rosapi/"):
            case "topics":
                return types
            case "topics_and_raw_types":
                return {**types, "typedefs_full_text": [self.texts.get(one, "") for one in self.types.values()]}
            case "nodes":
                return {"nodes": list(self.nodes)}
            case "node_details":
                return self.nodes[given["node"]]
            case "services":
                return {"services": list(self.services)}
            case "service_type":
                return {"type": self.services[given["service"]][0] if given["service"] in self.services else ""}
        raise KeyError(service)

    def stop(self) -> None:
        """Stop the server and all connections; stopping again has no effect."""
        if self._loop is not None and self._end is not None:
            with suppress(RuntimeError):  # the loop is closed
                self._loop.call_soon_threadsafe(self._end.set)

    async def run(self, ready: Event) -> None:
        """Serve until `stop`."""
        self._loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        async with serve(self._handle, "127.0.0.1", 0) as server:
            self.address = f"ws://127.0.0.1:{next(iter(server.sockets)).getsockname()[1]}"
            ready.set()
            await self._end.wait()


@contextmanager
def peer(ros: int = 1) -> Iterator[Peer]:
    """Run a robot behind rosbridge."""
    made, ready = Peer(ros), Event()
    thread = Thread(target=lambda: asyncio.run(made.run(ready)))
    thread.start()
    assert ready.wait(patient(5))
    try:
        yield made
    finally:
        made.stop()
        thread.join()
