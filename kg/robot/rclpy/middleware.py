"""ROS 2 through rclpy: a node in a context of its own, whose executor runs in a thread.

Callbacks of the executor's thread are passed to the event loop, messages as bytes of CDR.
"""

from __future__ import annotations

import asyncio
import math
from contextlib import suppress
from functools import cache, partial
from importlib import import_module
from threading import Thread
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import rclpy
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, ShutdownException, SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.signals import SignalHandlerOptions

from kg.errors import RobotError
from kg.facts import Qos, Role
from kg.robot.connection import LiveEnd, LiveNode
from kg.robot.messages.types import learn_all, short
from kg.robot.ros2.middleware import Deliver, Neighbourhood
from kg.robot.tasks import Tasks, call_in, outcome

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterator

    from kg.robot.messages import Types
    from kg.robot.ros2.graph import Watch

_EVERY: Final = 0.2  # seconds between polls of the graph: rclpy does not report its changes
_BASE: Final = {"double": "float64", "float": "float32", "boolean": "bool", "octet": "byte"}
"""Names in `.msg` files of the base types of IDL."""


class RclpyMiddleware:
    """Our node of a domain, through the installed ROS 2."""

    def __init__(self, domain: int, name: str, types: Types) -> None:
        self.types = types
        self._name = name
        self._loop = asyncio.get_running_loop()
        self._seen = Neighbourhood()
        self._looking: asyncio.TimerHandle | None = None
        self._closed = False
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        namespace, _, own = name.rpartition("/")
        self._node = rclpy.create_node(
            own, namespace=namespace or "/", context=self._context, use_global_arguments=False,
            start_parameter_services=False, enable_rosout=False,
        )  # fmt: skip
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._thread = Thread(target=self._spin, name=f"rclpy of {name}", daemon=True)

    def _spin(self) -> None:
        while not self._closed:
            with suppress(ExternalShutdownException, ShutdownException):
                self._executor.spin_once()

    def begin(self, watch: Watch) -> None:
        """Watch the domain."""
        self._watch = watch
        self._thread.start()
        self._look()

    def _look(self) -> None:
        seen = self._neighbours()
        if seen != self._seen:
            self._seen = seen
            self._watch.changed()
        self._looking = self._loop.call_later(_EVERY, self._look)

    def _neighbours(self) -> Neighbourhood:
        names = [(name, space) for name, space, _ in self._node.get_node_names_and_namespaces_with_enclaves()]
        others = [one for one in names if _absolute(*one) != self._name]
        ends = [one for one in self._topic_ends() if one.node != self._name]
        for one in others:
            ends += self._service_ends(*one)
        return Neighbourhood(tuple(LiveNode(_absolute(*one)) for one in sorted(others)), tuple(sorted(ends, key=repr)))

    def _topic_ends(self) -> Iterator[LiveEnd]:
        for topic, _ in self._node.get_topic_names_and_types():
            sides = (
                (Role.PUBLISHES, self._node.get_publishers_info_by_topic(topic)),
                (Role.SUBSCRIBES, self._node.get_subscriptions_info_by_topic(topic)),
            )
            for role, infos in sides:
                for one in infos:
                    node = _absolute(one.node_name, one.node_namespace)
                    yield LiveEnd(node, role, topic, short(one.topic_type), _from_ros(one.qos_profile))

    def _service_ends(self, name: str, namespace: str) -> Iterator[LiveEnd]:
        sides = (
            (Role.SERVICES, self._node.get_service_names_and_types_by_node),
            (Role.CLIENTS, self._node.get_client_names_and_types_by_node),
        )
        for role, names_and_types in sides:
            with suppress(rclpy.node.NodeNameNonExistentError):  # it has left in the meantime
                for service, kinds in names_and_types(name, namespace):
                    yield LiveEnd(_absolute(name, namespace), role, service, short(kinds[0]))

    def neighbourhood(self) -> Neighbourhood:
        """Return the nodes and ends of others at the last poll."""
        return self._seen

    def reader(self, topic: str, kind: str, qos: Qos, deliver: Deliver) -> RclpyReader:
        """Open a reader of a topic."""
        return RclpyReader(self._node, topic, _class(kind), _to_ros(qos), deliver)

    def writer(self, topic: str, kind: str, qos: Qos) -> RclpyWriter:
        """Open a writer of a topic."""
        return RclpyWriter(self._node, topic, _class(kind), _to_ros(qos))

    def caller(self, service: str, kind: str) -> RclpyCaller:
        """Open a client of a service."""
        trimmed = partial(self.types.trimmed, f"{kind}_Response")
        return RclpyCaller(self._node, service, _service_class(kind), trimmed)

    def server(self, service: str, kind: str, answer: Callable[[bytes], Awaitable[bytes]]) -> RclpyServer:
        """Serve a service; ROS 2 cannot report failures, so a failed request has no response."""
        trimmed = partial(self.types.trimmed, f"{kind}_Request")
        return RclpyServer(self._node, service, _service_class(kind), answer, trimmed)

    def hashes(self, name: str) -> list[tuple[str, str]]:
        """Return nothing: a type that is not installed cannot be used, even with a description."""
        del name
        return []

    async def learn(self, kind: str, name: str) -> bool:
        """Learn a type, with its nested types, from installed packages of ROS 2."""
        del name
        texts: dict[str, str] = {}
        for one in [kind] if _installed(kind) else [f"{kind}_{part}" for part in _PARTS]:
            _describe(one, texts)
        learn_all(self.types, texts)
        return bool(texts)

    def close(self) -> None:
        """Leave the domain."""
        if self._closed:
            return
        self._closed = True
        if self._looking is not None:
            self._looking.cancel()
        self._executor.shutdown()  # wakes the thread, which then has nothing to wait for
        self._thread.join()
        self._node.destroy_node()
        self._context.try_shutdown()


_PARTS: Final = ("Request", "Response", "Goal", "Result", "Feedback")


def _absolute(name: str, namespace: str) -> str:
    return f"{namespace.rstrip('/')}/{name}"


@cache
def _import_class(kind: str, folder: str) -> Any:
    """Return the class of `package/Name` in a folder of its package; None if it is not installed."""
    package, _, name = kind.partition("/")
    try:
        return getattr(import_module(f"{package}.{folder}"), name, None)
    except ImportError:
        return None


def _part(kind: str) -> Any:
    package, _, name = kind.partition("/")
    own, _, part = name.partition("_")
    whole = f"{package}/{own}"
    if (service := _import_class(whole, "srv")) is not None:
        return getattr(service, part, None)
    action = _import_class(whole, "action")
    if action is None:
        return None
    if part == "FeedbackMessage":
        return action.Impl.FeedbackMessage
    outer, _, inner = part.partition("_")
    if outer in {"SendGoal", "GetResult"}:
        service_type = getattr(action.Impl, f"{outer}Service")
        return getattr(service_type, inner) if inner else service_type
    return getattr(action, part, None)


def _installed(kind: str) -> Any:
    return _part(kind) if "_" in kind.partition("/")[2] else _import_class(kind, "msg")


def _class(kind: str) -> Any:
    """Return the class of a message; RobotError KG804 if its package is not installed."""
    installed = _installed(kind)
    if installed is None:
        package = kind.partition("/")[0]
        hint = f"Install `{package}` for ROS 2, or source the workspace that has it."
        raise RobotError("KG804", f"the type `{kind}` is not installed for ROS 2", hint=hint)
    return installed


def _service_class(kind: str) -> Any:
    """Return the class of a service, also of one of an action; RobotError KG804 as `_class`."""
    return _import_class(kind, "srv") or _class(kind)


def _describe(kind: str, texts: dict[str, str]) -> None:
    """Add the definition of an installed type, and of those that it uses, in `.msg` form."""
    installed = _installed(kind)
    if installed is None or kind in texts:
        return
    texts[kind] = ""
    fields = installed.get_fields_and_field_types()
    for name, field_type in fields.items():
        element, array = _written(field_type)
        texts[kind] += f"{element}{array} {name}\n"
        if "/" in element:
            _describe(element, texts)


def _written(field_type: str) -> tuple[str, str]:
    """Return the type of an element and its array suffix: `sequence<double, 5>` is `float64` and `[<=5]`."""
    if field_type.startswith("sequence<"):
        element, _, most = field_type[len("sequence<") : -1].partition(", ")
        return _element(element), f"[<={most}]" if most else "[]"
    element, bracket, length = field_type.partition("[")
    return _element(element), bracket + length


def _element(field_type: str) -> str:
    return _BASE.get(field_type) or field_type.replace("string<", "string<=").rstrip(">")


def _to_ros(qos: Qos) -> QoSProfile:
    keep_all = qos.history == "keep_all"
    return QoSProfile(
        history=HistoryPolicy.KEEP_ALL if keep_all else HistoryPolicy.KEEP_LAST,
        depth=max(qos.depth or 1, 1),
        reliability=getattr(ReliabilityPolicy, (qos.reliability or "reliable").upper()),
        durability=getattr(DurabilityPolicy, (qos.durability or "volatile").upper()),
        lifespan=Duration(seconds=qos.lifespan or 0),  # zero is the middleware's default
    )


def _from_ros(profile: QoSProfile) -> Qos:
    def recognized(policy: Any, *names: str) -> str | None:
        name = policy.name.lower()
        return name if name in names else None

    def seconds(duration: Any) -> float | None:
        value = float(duration.nanoseconds) / 1e9
        return value if 0 < value < _FOREVER and math.isfinite(value) else None

    history = recognized(profile.history, "keep_last", "keep_all")
    return Qos(
        recognized(profile.reliability, "reliable", "best_effort"),
        recognized(profile.durability, "volatile", "transient_local"),
        history,
        profile.depth if history == "keep_last" else None,
        seconds(profile.deadline),
        seconds(profile.lifespan),
        recognized(profile.liveliness, "automatic", "manual_by_topic"),
        seconds(profile.liveliness_lease_duration),
    )


_FOREVER: Final = 9e9  # seconds from which a duration counts as infinite: middlewares report their maximum


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
