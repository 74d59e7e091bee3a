"""Ends of topics and services by rclpy. Callbacks of its executor's thread are passed to the event loop."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from rclpy.duration import Duration
from rclpy.qos import ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message

from kg.errors import RobotError
from kg.robot.tasks import Tasks, call_in, outcome

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.robot.ros2.middleware import Deliver

Trimmed: TypeAlias = "Callable[[bytes], bytes]"
"""Removes what `serialize_message` leaves behind a message: its buffer is as long as Fast DDS estimates."""
_MOMENT: Final = 0.02  # seconds between checks for ends of other nodes, which rclpy does not report


class End:
    """Base of all ends: `count` returns the number of connected ends of others, `destroy` closes it for good."""

    def __init__(self, count: Callable[[], int], destroy: Callable[[], object]) -> None:
        self._count = count
        self._destroy = destroy
        self._closed = False

    @property
    def peers(self) -> int:
        """Number of connected ends of others."""
        return 0 if self._closed else self._count()

    async def ready(self) -> None:
        """Return when an end of another node is connected."""
        while not self._closed and not self.peers:  # noqa: ASYNC110 - rclpy has no event for it
            await asyncio.sleep(_MOMENT)

    def close(self) -> None:
        """Close it; closing it again does nothing."""
        if not self._closed:
            self._closed = True
            self._destroy()


class RclpyReader(End):
    """A subscriber of raw messages."""

    def __init__(self, node: Any, topic: str, kind: Any, qos: Any, deliver: Deliver) -> None:
        loop = asyncio.get_running_loop()

        def take(content: bytes) -> None:
            if not self._closed:
                deliver(content, None)

        subscription = node.create_subscription(kind, topic, lambda raw: call_in(loop, take, bytes(raw)), qos, raw=True)
        super().__init__(lambda: int(node.count_publishers(topic)), lambda: node.destroy_subscription(subscription))


class RclpyWriter(End):
    """A publisher of raw messages."""

    def __init__(self, node: Any, topic: str, kind: Any, qos: Any) -> None:
        self._node = node
        self._publisher = node.create_publisher(kind, topic, qos)
        super().__init__(self._publisher.get_subscription_count, lambda: node.destroy_publisher(self._publisher))

    @property
    def confirmed(self) -> bool:
        """Whether all subscribers are reliable and have confirmed all messages."""
        readers = self._node.get_subscriptions_info_by_topic(self._publisher.topic_name)
        reliable = all(one.qos_profile.reliability is ReliabilityPolicy.RELIABLE for one in readers)
        return reliable and not self._closed and bool(self._publisher.wait_for_all_acked(Duration()))

    def write(self, content: bytes) -> None:
        """Send a message; RobotError KG803 if that fails."""
        try:
            self._publisher.publish(content)
        except RuntimeError as error:  # rclpy's exception for all failures of the layers below
            raise RobotError("KG803", f"a message was not sent: {error}") from None


class RclpyCaller(End):
    """A client of a service."""

    def __init__(self, node: Any, service: str, kind: Any, trimmed: Trimmed) -> None:
        self._loop = asyncio.get_running_loop()
        self._kind = kind
        self._trimmed = trimmed
        self._client = node.create_client(kind, service)
        super().__init__(lambda: int(self._client.service_is_ready()), lambda: node.destroy_client(self._client))

    async def call(self, content: bytes) -> bytes:
        """Return the response to a request, once a server is connected."""
        await self.ready()
        answered: asyncio.Future[bytes] = self._loop.create_future()

        def answer(content: bytes) -> None:
            if not answered.done():
                answered.set_result(content)

        future = self._client.call_async(deserialize_message(content, self._kind.Request))
        future.add_done_callback(lambda done: call_in(self._loop, answer, serialize_message(done.result())))
        try:
            return self._trimmed(await answered)
        finally:
            self._client.remove_pending_request(future)


class RclpyServer(End):
    """A service server.

    rclpy sends the return value of a callback, and polls a callback that waits. So ours returns at once, and the
    response is sent when it is ready.
    """

    def __init__(
        self, node: Any, service: str, kind: Any, answer: Callable[[bytes], Awaitable[bytes]], trimmed: Trimmed
    ) -> None:
        loop = asyncio.get_running_loop()
        self._kind = kind
        self._answer = answer
        self._trimmed = trimmed
        self._tasks = Tasks()
        self._service = node.create_service(kind, service, self._ask)
        self._send = self._service.send_response
        self._service.send_response = lambda request, header: call_in(loop, self._begin, request, header)
        super().__init__(lambda: int(node.count_clients(service)), lambda: node.destroy_service(self._service))

    def _ask(self, request: Any, response: Any) -> bytes:
        del response
        return bytes(serialize_message(request))

    def _begin(self, request: bytes, header: Any) -> None:
        if not self._closed:
            self._tasks.spawn(self._respond(request, header), "answering a service")

    async def _respond(self, request: bytes, header: Any) -> None:
        response = await outcome(self._answered(request))
        if isinstance(response, bytes) and not self._closed:
            self._send(deserialize_message(response, self._kind.Response), header)

    async def _answered(self, request: bytes) -> bytes:
        return await self._answer(self._trimmed(request))

    def close(self) -> None:
        """Stop serving; pending requests get no response."""
        self._tasks.cancel()
        super().close()
