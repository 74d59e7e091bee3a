"""A robot behind a bridge of Foxglove, with the server of `foxglove-sdk`, which `foxglove_bridge` uses."""

from __future__ import annotations

from contextlib import contextmanager
from threading import Condition
from typing import TYPE_CHECKING, Any

import foxglove
from foxglove.websocket import Capability, MessageSchema, Service, ServiceSchema
from patience import patient

from kg.robot.messages import Types
from kg.robot.ros2.names import family

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["Peer", "peer"]


class Peer:
    """The robot: its publications, and the data received from clients, by topic."""

    def __init__(self, ros: int) -> None:
        self.ros = ros
        self.types = Types(ros)
        self.address = ""
        self.came: list[tuple[str, dict[str, Any]]] = []
        self.offered: dict[tuple[int, int], Any] = {}
        self.context = foxglove.Context()
        self.server: Any = None
        self._news = Condition()
        self._channels: dict[str, tuple[str, Any]] = {}
        self.listening: list[str] = []

    def channel(self, topic: str, kind: str) -> None:
        """Advertise a topic."""
        schema = self._schema(kind)
        encoding = "ros1" if self.ros == 1 else "cdr"
        made = foxglove.Channel(topic, schema=schema, message_encoding=encoding, context=self.context)
        self._channels[topic] = kind, made

    def _schema(self, kind: str) -> Any:
        text = self.types.definition(kind).encode()
        return foxglove.Schema(name=self._full(kind), encoding=f"ros{self.ros}msg", data=text)

    def _full(self, kind: str) -> str:
        package, _, name = kind.partition("/")
        return kind if self.ros == 1 else f"{package}/{family(kind)}/{name}"

    def close_channel(self, topic: str) -> None:
        """Remove a topic."""
        self._channels.pop(topic)[1].close()

    def publish(self, topic: str, value: dict[str, Any]) -> None:
        """Send a message."""
        kind, channel = self._channels[topic]
        channel.log(self.types.encode(kind, value))

    def graph(
        self,
        published: dict[str, list[str]],
        subscribed: dict[str, list[str]],
        served: dict[str, list[str]] | None = None,
    ) -> None:
        """Send the list of nodes to clients."""
        made = foxglove.ConnectionGraph()
        for topic, nodes in published.items():
            made.set_published_topic(topic, nodes)
        for topic, nodes in subscribed.items():
            made.set_subscribed_topic(topic, nodes)
        for service, nodes in (served or {}).items():
            made.set_advertised_service(service, nodes)
        self.server.publish_connection_graph(made)

    def serve(self, name: str, kind: str, answer: Callable[[dict[str, Any]], dict[str, Any]]) -> None:
        """Advertise a service."""
        encoding = "ros1" if self.ros == 1 else "cdr"

        def handler(request: Any) -> bytes:
            asked = self.types.decode(f"{kind}_Request", request.payload)
            return self.types.encode(f"{kind}_Response", answer(asked))

        parts = [
            MessageSchema(encoding=encoding, schema=self._schema(f"{kind}_{part}")) for part in ("Request", "Response")
        ]
        package, _, type_name = kind.partition("/")
        full = kind if self.ros == 1 else f"{package}/srv/{type_name}"
        schema = ServiceSchema(full, request=parts[0], response=parts[1])
        self.server.add_services([Service(name=name, schema=schema, handler=handler)])

    def until(self, true: Callable[[], bool]) -> None:
        """Return when a condition holds, which data from clients may fulfil."""
        with self._news:
            assert self._news.wait_for(true, patient(5)), self.came

    def on_subscribe(self, _client: Any, channel: Any) -> None:
        """Record a subscription."""
        with self._news:
            self.listening.append(channel.topic)
            self._news.notify_all()

    def on_unsubscribe(self, _client: Any, channel: Any) -> None:
        """Remove a subscription."""
        with self._news:
            self.listening.remove(channel.topic)
            self._news.notify_all()

    def on_client_advertise(self, client: Any, channel: Any) -> None:
        """Record a client's topic."""
        with self._news:
            self.offered[client.id, channel.id] = channel
            self._news.notify_all()

    def on_client_unadvertise(self, client: Any, number: int) -> None:
        """Remove a client's topic."""
        with self._news:
            del self.offered[client.id, number]
            self._news.notify_all()

    def on_message_data(self, client: Any, number: int, data: bytes) -> None:
        """Record a client's message."""
        with self._news:
            channel = self.offered[client.id, number]
            kind = channel.schema_name.replace("/msg/", "/")
            self.came.append((channel.topic, self.types.decode(kind, data)))
            self._news.notify_all()


@contextmanager
def peer(ros: int = 2, *, takes: bool = True, tells: bool = True) -> Iterator[Peer]:
    """Run a robot behind a bridge that accepts messages, and optionally sends the graph."""
    made = Peer(ros)
    listener: Any = made  # it has the interface of a listener of ROS topics
    capabilities = [Capability.Services]
    capabilities += [Capability.ClientPublish] * takes + [Capability.ConnectionGraph] * tells
    made.server = foxglove.start_server(
        name="test",
        port=0,
        capabilities=capabilities,
        server_listener=listener,
        supported_encodings=["ros1" if ros == 1 else "cdr"],
        context=made.context,
    )
    made.address = f"ws://127.0.0.1:{made.server.port}"
    try:
        yield made
    finally:
        made.server.stop()
